#include "core/plan/weather.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "core/base/constants.h"
#include "core/plan/choppiness.h"
#include "core/plan/effects.h"
#include "core/scene/canonical.h"
#include "core/scene/keys.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/spectrum/gauss.h"

namespace pelagic {
namespace {

double blended(double first, double second, double share) {
    return (1.0 - share) * first + share * second;
}

// Of variances that are linear.
Extent blended(const Extent& first, const Extent& second, double share) {
    const auto root = [share](double a, double b) { return std::sqrt(blended(a * a, b * b, share)); };
    Extent extent{.height_m = root(first.height_m, second.height_m),
                  .reach_m = root(first.reach_m, second.reach_m),
                  .significant_height_m = root(first.significant_height_m, second.significant_height_m)};
    for (std::size_t cell = 0; cell < extent.unresolved.deviation_m.size(); ++cell)
        extent.unresolved.deviation_m[cell] =
            root(first.unresolved.deviation_m[cell], second.unresolved.deviation_m[cell]);
    return extent;
}

void widen(Extent& extent, const Extent& by) {
    const auto take = [](double& a, double b) { a = std::max(a, b); };
    take(extent.height_m, by.height_m);
    take(extent.reach_m, by.reach_m);
    take(extent.significant_height_m, by.significant_height_m);
    for (std::size_t cell = 0; cell < extent.unresolved.deviation_m.size(); ++cell)
        take(extent.unresolved.deviation_m[cell], by.unresolved.deviation_m[cell]);
}

// What the sea's numbers are at a frame.
std::string numbers_text(const Scene& scene, double frame) {
    std::string text;
    for (const KeyedNumber& number : scene.keyed)
        if (is_of_sea(number))
            text += number.path + " = " +
                    number_text(value_at(number.keys, key_of(number.path).is_angle, frame)) + '\n';
    return text;
}

// The numbers of the displacement, whose keys change no waves.
struct DisplacementNumber {
    std::string_view path;
    double Waves::*member;
};
constexpr std::array kDisplacementNumbers{DisplacementNumber{"waves.choppiness", &Waves::choppiness},
                                          DisplacementNumber{"waves.lean_deg", &Waves::lean_deg},
                                          DisplacementNumber{"waves.second_order", &Waves::second_order}};

const KeyedNumber* keyed_of(const Scene& scene, std::string_view path) {
    const auto found = std::ranges::find(scene.keyed, path, &KeyedNumber::path);
    return found == scene.keyed.end() ? nullptr : &*found;
}

// A moment of a shot, displaced as the shot is planned.
Scene as_planned(Scene moment, const Scene& shot) {
    for (const DisplacementNumber& number : kDisplacementNumbers)
        moment.waves.*number.member = shot.waves.*number.member;
    return moment;
}

}  // namespace

double frame_at(const Shot& shot, double t_s) {
    const double frame = 1.0 + (t_s - shot.time_offset_s) / shot.time_scale * shot.fps,
                 whole = std::round(frame);
    return shot.time_s(whole) == t_s ? whole
                                     : frame;  // which rounding may miss, and keys are at whole frames
}

Weather::Blend Weather::at(double t_s) const {
    const auto after = std::upper_bound(keys.begin(), keys.end(), t_s,
                                        [](double t, const Key& key) { return t < key.time_s; });
    const auto second = static_cast<std::size_t>(after - keys.begin());
    if (second == 0) return {};
    const std::size_t first = second - 1;
    if (second == keys.size() || t_s == keys[first].time_s || keys[first].sea == keys[second].sea)
        return {first, first, 0.0, 0.0};
    const double lasts_s = keys[second].time_s - keys[first].time_s, t = (t_s - keys[first].time_s) / lasts_s;
    return {first, second, is_smooth ? t * t * (3.0 - 2.0 * t) : t,
            (is_smooth ? 6.0 * t * (1.0 - t) : 1.0) / lasts_s};
}

std::shared_ptr<const PreparedScene> prepared_at(const std::shared_ptr<const PreparedScene>& shot,
                                                 double t_s) {
    if (!shot->weather) return shot;
    const Weather& weather = *shot->weather;
    const Weather::Blend blend = weather.at(t_s);
    const PreparedScene &first = *weather.keys[blend.first].sea, &second = *weather.keys[blend.second].sea;
    if (blend.first == blend.second) return weather.keys[blend.first].sea;
    const std::array parts{DirectionalSpectrum::Part{&first.spectrum, 1.0 - blend.share},
                           DirectionalSpectrum::Part{&second.spectrum, blend.share}};
    Scene moment = scene_at(shot->scene, frame_at(shot->scene.shot, t_s));
    const Dispersion dispersion{moment.sea.depth_m};
    return std::make_shared<const PreparedScene>(
        PreparedScene{.scene = std::move(moment),
                      .spectrum = DirectionalSpectrum(parts, dispersion),
                      .second_order = shot->second_order,
                      .extent = blended(first.extent, second.extent, blend.share),
                      .masks = shot->masks,
                      .weather = nullptr,
                      .wind = first.wind});
}

double wind_way_m(const PreparedScene& from, double t_s) {
    const Shot& shot = from.scene.shot;
    const auto wind_mps = [&](double frame) { return value_at(*from.wind, false, frame); };
    const double begin = frame_at(shot, 0.0), end = frame_at(shot, t_s);
    std::vector<double> frames{std::min(begin, end)};
    for (const NumberKeys::Key& key : from.wind->keys)
        if (key.frame > frames.front() && key.frame < std::max(begin, end)) frames.push_back(key.frame);
    frames.push_back(std::max(begin, end));
    double way = 0.0;
    // Simpson's rule has no error for cubics, as all is between two keys.
    for (std::size_t i = 0; i + 1 < frames.size(); ++i)
        way += (frames[i + 1] - frames[i]) / 6.0 *
               (wind_mps(frames[i]) + 4.0 * wind_mps(0.5 * (frames[i] + frames[i + 1])) +
                wind_mps(frames[i + 1]));
    return std::copysign(way, t_s) * shot.time_scale / shot.fps;
}

std::optional<DisplacementAt> displacement_at(const PreparedScene& shot, double t_s) {
    const Scene& scene = shot.scene;
    const auto is_keyed = [&](const DisplacementNumber& number) { return keyed_of(scene, number.path); };
    if (!shot.weather || std::ranges::none_of(kDisplacementNumbers, is_keyed)) return std::nullopt;
    const double frame = frame_at(scene.shot, t_s), frames_per_s = scene.shot.fps / scene.shot.time_scale;
    struct Now {
        double value, per_s;
    };
    const auto now = [&](const DisplacementNumber& number) -> Now {
        const KeyedNumber* keyed = keyed_of(scene, number.path);
        if (!keyed) return {scene.waves.*number.member, 0.0};
        return {value_at(keyed->keys, false, frame), rate_at(keyed->keys, frame) * frames_per_s};
    };
    const auto [choppiness, lean, second] = kDisplacementNumbers;
    DisplacementAt at;
    // Less than the least would be a displacement gradient of few digits, and is seen as little as none.
    if (const double most = scene.waves.choppiness; most >= Choppiness::kLeastShown) {
        const Now of = now(choppiness);
        at.share = std::max(of.value, Choppiness::kLeastShown) / most;
        at.share_per_s = of.per_s / most;
    }
    if (const double most = scene.waves.second_order; most > 0.0) {
        const Now of = now(second);
        at.pairs = of.value / most * at.share;
        at.pairs_per_s = of.per_s / most * at.share + of.value / most * at.share_per_s;
    }
    constexpr double kPerDegree = kPi / 180.0;
    const Now of = now(lean);
    at.lean_rad = of.value * kPerDegree;
    at.lean_rad_per_s = of.per_s * kPerDegree;
    return at;
}

// The ends of the parts of a way between two keys in each of which ω is nearly a polynomial. ω goes as the depth's root where that is small, so
// they are cut where the depth changes much, or fast for how deep it is: an eighth inside an end it has changed 1.4 times.
static std::vector<double> ends_of_depth(const NumberKeys& depth, double from, double to) {
    const auto depth_m = [&](double frame) { return value_at(depth, false, frame); };
    const double first_m = depth_m(from), last_m = depth_m(to), eighth = 0.125 * (to - from);
    if (std::max(first_m, last_m) <= 4.0 * std::min(first_m, last_m) &&
        depth_m(from + eighth) <= 1.4 * first_m && depth_m(to - eighth) <= 1.4 * last_m)
        return {to};
    const double middle_m = std::sqrt(first_m * last_m);
    double before = from, after = to;
    for (int i = 0; i < 50; ++i) {  // it rises or falls all the way
        const double middle = 0.5 * (before + after);
        ((depth_m(middle) > middle_m) == (first_m > last_m) ? before : after) = middle;
    }
    std::vector<double> ends = ends_of_depth(depth, from, before);
    const std::vector<double> later = ends_of_depth(depth, before, to);
    ends.insert(ends.end(), later.begin(), later.end());
    return ends;
}

// From a key on until a time before the next. The integral of the polynomial through ω at Gauss's points, by Legendre's polynomials P:
// of the one that is 1 at point j, w_j/2 (1 + x + Σ P_m(x_j) (P_{m+1} − P_{m−1})(x)). To the end, x = 1, that is Gauss's rule.
static std::vector<DepthAt::Part> depths_after(const PreparedScene& shot, std::size_t key, double t_s) {
    constexpr std::size_t kPoints = 12;  // its rate is a frequency that is right to 1e-4
    const NumberKeys& depth = keyed_of(shot.scene, "sea.depth_m")->keys;
    const std::vector<Weather::Key>& keys = shot.weather->keys;
    const auto depth_m = [&](double frame) { return value_at(depth, false, frame); };
    const double first_s = keys[key].time_s, first_m = depth_m(keys[key].frame);
    if (t_s <= first_s || key + 1 == keys.size() || depth_m(keys[key + 1].frame) == first_m)
        return {{first_m, t_s - first_s}};
    const auto legendre = [](double x) {
        std::array<double, kPoints + 1> p{1.0, x};
        for (std::size_t m = 2; m < p.size(); ++m) {
            const auto degree = static_cast<double>(m);
            p[m] = ((2.0 * degree - 1.0) * x * p[m - 1] - (degree - 1.0) * p[m - 2]) / degree;
        }
        return p;
    };
    const double frames = static_cast<double>(keys[key + 1].frame) - keys[key].frame,
                 seconds_a_frame = (keys[key + 1].time_s - first_s) / frames;
    const auto& rule = GaussLegendre<kPoints>::rule();
    std::vector<DepthAt::Part> parts;
    double from = keys[key].frame;
    for (const double to : ends_of_depth(depth, from, keys[key + 1].frame)) {
        const double begins_s = first_s + (from - keys[key].frame) * seconds_a_frame,
                     lasts_s = (to - from) * seconds_a_frame;
        if (t_s <= begins_s) break;
        const double x = std::min(2.0 * (t_s - begins_s) / lasts_s - 1.0, 1.0);
        const auto until = legendre(x);
        for (std::size_t j = 0; j < kPoints; ++j) {
            const auto here = legendre(rule.node[j]);
            double sum = 1.0 + x;
            for (std::size_t m = 1; m < kPoints; ++m) sum += here[m] * (until[m + 1] - until[m - 1]);
            parts.push_back({depth_m(from + 0.5 * (1.0 + rule.node[j]) * (to - from)),
                             0.25 * lasts_s * rule.weight[j] * sum});
        }
        from = to;
    }
    return parts;
}

std::vector<DepthAt::Part> depth_until(const PreparedScene& shot, std::size_t key) {
    return depths_after(shot, key - 1, shot.weather->keys[key].time_s);
}

std::optional<DepthAt> depth_at(const PreparedScene& shot, double t_s) {
    const Scene& scene = shot.scene;
    const KeyedNumber* keyed = shot.weather ? keyed_of(scene, "sea.depth_m") : nullptr;
    if (!keyed) return std::nullopt;
    const std::vector<Weather::Key>& keys = shot.weather->keys;
    const double frame = frame_at(scene.shot, t_s);
    DepthAt at{.key = 0,
               .parts = {},
               .depth_m = value_at(keyed->keys, false, frame),
               .depth_mps = rate_at(keyed->keys, frame) * scene.shot.fps / scene.shot.time_scale};
    while (at.key + 1 < keys.size() && keys[at.key + 1].time_s <= t_s) ++at.key;
    at.parts = depths_after(shot, at.key, t_s);
    return at;
}

std::string weather_text(const PreparedScene& shot, double t_s, double past_s, double ahead_s) {
    if (!shot.weather) return {};
    const Weather& weather = *shot.weather;
    const Weather::Blend blend = weather.at(t_s);
    if (past_s > 0.0) {
        std::string text = weather.is_smooth ? "smooth" : "linear";
        const std::size_t last = weather.at(t_s + ahead_s).second;
        for (std::size_t key = weather.at(t_s - past_s).first; key <= last; ++key) {
            const double frame = weather.keys[key].frame;
            text += " at " + number_text(weather.keys[key].time_s) + '\n' + numbers_text(shot.scene, frame);
            // Smooth keys' slopes come from keys beyond these: two values between them say which cubic it is.
            for (const double share : {1.0 / 3.0, 2.0 / 3.0})
                if (key < last)
                    text += numbers_text(shot.scene, blended(frame, weather.keys[key + 1].frame, share));
        }
        return text + weather_text(shot, t_s);
    }
    std::string text = numbers_text(shot.scene, weather.keys[blend.first].frame);
    // Spray remembers how far the wind has blown.
    if (const auto& wind = weather.keys[blend.first].sea->wind; wind && is_on(Effect::Spray, shot.scene))
        text += "way " + number_text(wind_way_m(*weather.keys[blend.first].sea, t_s)) + '\n';
    if (const auto at = displacement_at(shot, t_s))
        for (const double value :
             {at->share, at->share_per_s, at->pairs, at->pairs_per_s, at->lean_rad, at->lean_rad_per_s})
            text += "displaced " + number_text(value) + '\n';
    // Phases are sums over all that has been, from key to key. The depth goes to its next key, a smooth one by the key after that, too.
    if (const KeyedNumber* depth = keyed_of(shot.scene, "sea.depth_m")) {
        NumberKeys known = depth->keys;
        const double frame = frame_at(shot.scene.shot, t_s);
        const auto next =
            std::ranges::find_if(known.keys, [&](const NumberKeys::Key& key) { return key.frame > frame; });
        const bool is_between = next != known.keys.begin() && std::prev(next)->frame < frame,
                   needs_slope = is_between && known.interpolation == CameraInterpolation::Smooth;
        known.keys.erase(next + std::min<std::ptrdiff_t>(needs_slope ? 2 : 1, known.keys.end() - next),
                         known.keys.end());
        text += value_text(key_of(depth->path), known);
        for (const Weather::Key& key : weather.keys) {
            text += ' ' + std::to_string(key.frame);
            if (key.time_s > t_s) break;
        }
        text += '\n';
    }
    if (blend.first == blend.second) return text;
    return text + numbers_text(shot.scene, weather.keys[blend.second].frame) +
           numbers_text(shot.scene, frame_at(shot.scene.shot, t_s)) + number_text(blend.share) + ' ' +
           number_text(blend.rate_per_s);
}

std::shared_ptr<const PreparedScene> prepare_weather(Scene scene) {
    Weather weather;
    for (const KeyedNumber& number : scene.keyed)
        weather.is_smooth |= is_of_sea(number) && number.keys.interpolation == CameraInterpolation::Smooth;
    const auto wind = std::ranges::find(scene.keyed, "sea.wind_speed_mps", &KeyedNumber::path);
    // The largest of their keys, also where somebody has filled Scene::keyed by hand.
    for (const DisplacementNumber& number : kDisplacementNumbers)
        if (const KeyedNumber* keyed = keyed_of(scene, number.path))
            scene.waves.*number.member = standing_for(keyed->keys, false);
    const auto prepared_moment = [&](int frame) {
        Scene numbers = scene_at(scene, frame);
        PreparedScene moment = *prepare(as_planned(numbers, scene));
        if (const KeyedNumber* depth = keyed_of(scene, "sea.depth_m")) {
            // Water goes farthest to the side where it is shallowest.
            const double least_m =
                std::ranges::min_element(depth->keys.keys, {}, &NumberKeys::Key::value)->value;
            const DirectionalSpectrum::Part all{&moment.spectrum, 1.0};
            moment.extent = extent_of(moment.scene, DirectionalSpectrum({&all, 1}, Dispersion{least_m}),
                                      moment.second_order, moment.masks);
        }
        moment.scene = std::move(numbers);
        if (wind != scene.keyed.end()) moment.wind = wind->keys;
        return std::make_shared<const PreparedScene>(std::move(moment));
    };
    std::string before;
    std::map<std::string, std::size_t> first_with;  // these waves
    for (const int frame : frames_of_sea(scene)) {
        std::string numbers = numbers_text(scene, frame);
        const auto sea = numbers == before ? weather.keys.back().sea : prepared_moment(frame);
        const auto found = first_with.try_emplace(
            canonical(as_planned(sea->scene, scene), key_parts(KeyPart::Waves)), weather.keys.size());
        weather.keys.push_back({frame, scene.shot.time_s(frame), sea, found.first->second});
        before = std::move(numbers);
    }
    std::vector<DirectionalSpectrum::Part> parts;
    Extent extent;
    for (const Weather::Key& key : weather.keys) {
        parts.push_back({&key.sea->spectrum, 1.0 / static_cast<double>(weather.keys.size())});
        widen(extent, key.sea->extent);
    }
    // Over the deepest of its depths, where waves of a frequency are longest: tiles and trains must hold them.
    DirectionalSpectrum mean(parts, Dispersion{scene.sea.depth_m});
    const SecondOrder second = is_on(Effect::SecondOrder, scene) ? second_order(mean) : SecondOrder();
    std::optional<MasksPlan> masks = masks_of(scene, mean);
    return std::make_shared<const PreparedScene>(
        PreparedScene{.scene = std::move(scene),
                      .spectrum = std::move(mean),
                      .second_order = second,
                      .extent = extent,
                      .masks = std::move(masks),
                      .weather = std::make_shared<const Weather>(std::move(weather)),
                      .wind = std::nullopt});
}

}  // namespace pelagic
