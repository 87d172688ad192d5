#include "core/waves/folding.h"
#include "core/plan/effects.h"
#include "core/plan/spray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/plan/breaking.h"
#include "core/plan/masks.h"
#include "core/plan/random_tiling.h"
#include "core/plan/vessels.h"
#include "core/plan/weather.h"
#include "core/scene/canonical.h"
#include "core/scene/cascade_bands.h"
#include "core/scene/keys.h"
#include "core/scene/text.h"
#include "core/spectrum/spectral_moments.h"
#include "core/waves/coast.h"
#include "core/waves/hero_waves.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

// 1 − J at a hero's top beyond which its sides cross.
constexpr double kSteepestHero = 0.9;
// In deviations: one crest in exp(½·5²) ≈ 270 000 waves is higher.
constexpr double kHighestHero = 5.0;
// What heroes add together over what they would add one by one, in energy: beyond it the sea round them is twice as high as they.
constexpr double kMostRaised = 4.0;

// Of a sea with these moments, whose displacement gradient is multiplied by `gain`.
double share_of(const SpectralMoments& all, double gain) {
    const double c = gain * gain;
    const auto j = jacobian_moments<double>(
        0.0, 0.0, 0.0, 0.0, {c * all.xxxx, c * all.xxxy, c * all.xxyy, c * all.xyyy, c * all.yyyy});
    if (!(j.variance > 0.0)) return 0.0;
    const double sigma = std::sqrt(j.variance);
    const double y = whitecaps_detail::to_normal(-j.mean / sigma, j.third / (j.variance * sigma)).y;
    return 0.5 * std::erfc(-y / std::sqrt(2.0));
}

SpectralMoments all_of(const DirectionalSpectrum& spectrum, const Choppiness& choppiness) {
    return moments_pressed(spectrum, 0.0, std::numeric_limits<double>::infinity(), choppiness);
}

// Two digits: "8.2".
std::string percent_text(double share) {
    const double percent = 100.0 * share;
    const double parts = percent < 10.0 ? 10.0 : 1.0;
    return number_text(std::round(percent * parts) / parts);
}

// Linear waves may dip below the bed. The deepest of so many troughs is √(2 ln n) standard deviations deep
// (Rayleigh).
std::vector<std::string> trough_warning(const PreparedScene& prepared) {
    constexpr double kTroughs = 1000.0;
    const double depth_m = prepared.scene.sea.depth_m;
    const double deepest_m =
        0.25 * prepared.extent.significant_height_m * std::sqrt(2.0 * std::log(kTroughs));
    if (!(deepest_m > depth_m)) return {};
    return {"one trough in a thousand is " + number_text(std::round(10.0 * deepest_m) / 10.0) +
            " m deep and would lie under the bed, in water of " + number_text(depth_m) +
            " m (sea.depth_m): all waves together are " +
            number_text(std::round(10.0 * prepared.extent.significant_height_m) / 10.0) + " m high"};
}

std::vector<std::string> map_warning(const PreparedScene& prepared) {
    if (prepared.scene.sea.depth_file == SeaState{}.depth_file) return {};
    if (prepared.scene.waves.coast) return {};
    return {
        "waves don't feel the depths of sea.depth_file: the floor is seen there, and waves are those of " +
        number_text(prepared.scene.sea.depth_m) + " m (sea.depth_m); waves.coast lets them feel it"};
}

// Waves come over a map's edge as they are in sea.depth_m, and over cells that hold them.
std::vector<std::string> coast_warning(const PreparedScene& prepared) {
    constexpr double kMuch = 0.1, kSurf_m = 2.0;
    const Scene& scene = prepared.scene;
    const DirectionalSpectrum& spectrum = prepared.spectrum;
    if (!scene.waves.coast || scene.waves.model != WaveModel::Trochoid || !scene.waves.coast_depths ||
        spectrum.is_calm())
        return {};
    const DepthMap& map = *scene.waves.coast_depths;
    std::vector<std::string> warnings;
    // Where the peak goes.
    const double peak = spectrum.longest_peak_wavenumber(), omega = spectrum.dispersion().omega(peak);
    double most = -1.0;
    glm::dvec2 towards(1.0, 0.0);
    for (int i = 0; i < 72; ++i) {
        const double angle = i * kTwoPi / 72.0, energy = spectrum.polar(peak, angle);
        if (!(energy > most)) continue;
        most = energy;
        towards = {std::cos(angle), std::sin(angle)};
    }
    const glm::dvec2 from_m = map.from_m(), to_m = from_m + map.size_m();
    // The mean of what is wet of the edge that they come over.
    constexpr int kPlaces = 200;
    const bool along_y = coast_goes_along_y(coast_depths(map, glm::ivec2(kPlaces)), towards);
    const bool is_low = (along_y ? towards.y : towards.x) > 0.0;
    double sum_m = 0.0;
    int wet = 0;
    for (int i = 0; i < kPlaces; ++i) {
        const glm::dvec2 on = glm::mix(from_m, to_m, (i + 0.5) / kPlaces), edge_m = is_low ? from_m : to_m;
        const glm::dvec2 place_m = along_y ? glm::dvec2(on.x, edge_m.y) : glm::dvec2(edge_m.x, on.y);
        const double depth_m = map.mean_m(place_m, place_m);
        if (!(depth_m > kCoastShore_m)) continue;
        sum_m += depth_m;
        ++wet;
    }
    const std::string edge = along_y ? (is_low ? "southern" : "northern") : (is_low ? "western" : "eastern");
    const std::string deep = number_text(scene.sea.depth_m);
    if (wet == 0) {
        warnings.push_back("no waves come in: the " + edge +
                           " edge of sea.depth_file, where they would, is dry; a map that reaches out to " +
                           deep + " m (sea.depth_m), or another direction");
    } else {
        const double edge_m = sum_m / wet, change = Dispersion{edge_m}.wavenumber(omega) / peak - 1.0;
        if (std::abs(change) > kMuch)
            warnings.push_back("the " + edge + " edge of sea.depth_file, where waves come in, is " +
                               rough_text(edge_m) + " m deep on the mean, and they come from " + deep +
                               " m: there their lengths jump by " + percent_text(std::abs(change)) +
                               " %; sea.depth_m = " + rough_text(edge_m) + ", or a map that reaches out to " +
                               deep + " m");
    }
    const double enough_m = 0.5 * kTwoPi / Dispersion{kSurf_m}.wavenumber(omega),
                 cell_m = coast_cell_m(map.size_m());
    if (cell_m > enough_m)
        warnings.push_back("waves feel sea.depth_file in cells of " + rough_text(cell_m) +
                           " m, more than half of their length where it is " + number_text(kSurf_m) +
                           " m deep: surf is coarse; a map of at most " +
                           rough_text(std::max(map.size_m().x, map.size_m().y) * enough_m / cell_m) +
                           " m a side has cells small enough");
    return warnings;
}

std::vector<std::string> folding_warning(const PreparedScene& prepared) {
    constexpr double kMuch = 0.05;
    const Choppiness asked = Choppiness::asked(prepared.scene);
    const SpectralMoments all = all_of(prepared.spectrum, asked);
    const double share = share_of(all, 1.0);
    if (!(share > kMuch)) return {};
    double less = 0.0, more = 1.0;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (less + more);
        (share_of(all, middle) > kMuch ? more : less) = middle;
    }
    const std::string folds = "the surface folds over itself on " + percent_text(share) + " % of its area; ";
    const auto& cascades = prepared.scene.waves.cascades;
    if (std::any_of(cascades.begin(), cascades.end(), [](const CascadeSize& c) { return c.choppiness; }))
        return {folds + "each cascade's choppiness times " + number_text(std::floor(100.0 * less) / 100.0) +
                " leaves 5 %"};
    return {folds + "waves.choppiness = " + number_text(std::floor(100.0 * less * asked.largest()) / 100.0) +
            " leaves 5 %"};
}

// Explicit tiles that repeat: where a patch shows that or, on surfaces as large as the view, a tile has few waves of the peak.
std::vector<std::string> repeats_warning(const PreparedScene& prepared) {
    constexpr double kFewWaves = 10.0;
    const Scene& scene = prepared.scene;
    if (scene.waves.tiling != Tiling::Periodic || scene.waves.model != WaveModel::Fft ||
        scene.waves.cascades.empty() || prepared.spectrum.is_calm())
        return {};
    const double size_m = scene.waves.cascades.front().size_m;
    const double peak_m = kTwoPi / prepared.spectrum.longest_peak_wavenumber();
    const bool is_patch = scene.surface.kind == SurfaceKind::Patch;
    if (is_patch ? !(scene.surface.size_m > size_m) : !(size_m < kFewWaves * peak_m)) return {};
    const std::string why =
        is_patch ? "the patch of " + number_text(scene.surface.size_m) + " m shows it more than once"
                 : "that is fewer than " + number_text(kFewWaves) + " of its " +
                       number_text(std::round(10.0 * peak_m) / 10.0) + " m waves";
    return {"the largest cascade repeats after " + number_text(size_m) + " m, which is seen from the air: " +
            why + "; waves.tiling = \"random\" shows copies at random offsets"};
}

// What the gradient of the blending weights adds to the slopes of a cascade's waves, as a share of their own. A tile
// has no modes longer than itself; their cells begin at waves of two tiles.
double gained_by_blending(const DirectionalSpectrum& spectrum, double size_m, double k_end) {
    const SpectralMoments own = moments(spectrum, kPi / size_m, k_end);
    const double mss = std::max(own.mss(), own.m0 * std::pow(kTwoPi / size_m, 2.0));
    return mss > 0.0 ? 2.0 * kBlendSlopes * own.m0 / (size_m * size_m * mss) : 0.0;
}

// The largest cascade alone: at least kBandModes of the others' waves fit into their tiles, which gain 1.6 % at most. Sizes
// chosen for the scene hold enough waves.
std::vector<std::string> blending_warning(const PreparedScene& prepared) {
    constexpr double kMuch = 0.05;
    const Waves& waves = prepared.scene.waves;
    if (waves.tiling != Tiling::Random || waves.model != WaveModel::Fft || waves.cascades.empty()) return {};
    const double given_m = waves.cascades.front().size_m;
    const int given_resolution = waves.cascades.front().resolution;
    // A larger tile must have all waves down to the next cascade's, or down to those that it has now.
    const double k_last = kPi * given_resolution / given_m;
    const auto resolution_of = [&](double size_m) {
        const int needed =
            waves.cascades.size() > 1
                ? sufficient_resolution(size_m, lower_edges(std::array{size_m, waves.cascades[1].size_m})[1])
                : static_cast<int>(std::min(2.0 * std::ceil(0.5 * size_m * k_last / kPi), 1e9));
        return std::max(given_resolution, needed);
    };
    const auto share_with = [&](double size_m) {
        double k_end = k_last;
        if (waves.cascades.size() > 1)
            k_end = std::min(kPi * resolution_of(size_m) / size_m,
                             lower_edges(std::array{size_m, waves.cascades[1].size_m})[1]);
        return gained_by_blending(prepared.spectrum, size_m, k_end);
    };
    const double share = share_with(given_m);
    if (!(share > kMuch)) return {};
    double enough_m = given_m;
    for (double left = share; left > kMuch; left = share_with(enough_m))
        enough_m *= std::max(std::sqrt(left / kMuch), 1.01);
    const double digit_m = std::pow(10.0, std::floor(std::log10(enough_m)) - 1.0);
    const double size_m = std::ceil(enough_m / digit_m) * digit_m;
    const int resolution = resolution_of(size_m);
    std::string larger = "with size_m = " + number_text(size_m);
    if (resolution > given_resolution) larger += " and resolution = " + std::to_string(resolution);
    larger = resolution <= kMaxCascadeResolution ? larger + " it adds 5 %, " : std::string();
    return {"the largest cascade, of " + number_text(given_m) +
            " m, holds few of its waves: where its copies blend they are steeper, which adds " +
            percent_text(share) + " % to its mean square slope; " + larger +
            "with waves.tiling = \"periodic\" nothing"};
}

// Cascades with their own choppiness, of which those that hold the breaking waves have none.
std::vector<std::string> unpressed_warning(const PreparedScene& prepared) {
    const Scene& scene = prepared.scene;
    const Breaking breaking = breaking_of(scene, FootprintFilter());
    if (!is_on(Effect::Whitecaps, scene) || !(law_coverage(scene) > 0.0) || breaking.choppiness.is_of_all())
        return {};
    const auto presses = [&](const Choppiness& choppiness) {
        const SpectralMoments all = moments_pressed(prepared.spectrum, 0.0, breaking.k_end(), choppiness);
        return all.xxxx + all.yyyy > 0.0;
    };
    if (presses(breaking.choppiness) || !presses(1.0)) return {};
    return {"there is no foam: the cascades whose waves break, those of more than " +
            number_text(scene.effects.breaking_from_m) +
            " m (effects.breaking_from_m), have no choppiness; waves.cascades[].choppiness gives them some"};
}

std::vector<std::string> hero_warning(const PreparedScene& prepared) {
    const std::vector<HeroWave>& heroes = prepared.scene.waves.heroes;
    if (heroes.empty()) return {};
    if (prepared.spectrum.is_calm())
        return {"the sea is calm and has no wave to raise: waves.heroes has nothing to stand in"};
    std::vector<std::string> warnings;
    const auto tenths = [](double value) { return number_text(std::round(10.0 * value) / 10.0); };
    const double deviation_m = std::sqrt(prepared.spectrum.m0());
    const std::vector<HeroTrain> trains = hero_trains(prepared, std::vector<LocalWaves>(heroes.size()));
    double wanted_m2 = 0.0, raised_m2 = 0.0;
    for (std::size_t h = 0; h < heroes.size(); ++h) {
        const HeroWave& hero = heroes[h];
        const double raise = hero_mask(prepared.masks, hero).raise, raised_m = raise * hero.height_m;
        wanted_m2 += raised_m * raised_m;
        const std::string name =
            "waves.heroes[" + std::to_string(h) + "].height_m = " + number_text(hero.height_m) + ": ";
        const double stands =
            prepared.masks ? raise * prepared.masks->at({hero.east_m, hero.north_m}).waves : 1.0;
        if (stands < 0.99)
            warnings.push_back(name + "stands where less than a tenth of the waves is left, and is " +
                               number_text(std::round(100.0 * stands * hero.height_m) / 100.0) + " m high");
        const HeroShape shape =
            hero_shape(trains, {hero.east_m, hero.north_m}, hero_time_s(prepared.scene, hero));
        if (std::abs(shape.height_m - raised_m) > 0.05 * std::abs(raised_m))
            warnings.push_back(name + "heroes before it are too near, in place and time, and make it " +
                               tenths(shape.height_m / raise) + " m high");
        else if (shape.compression > raise * kSteepestHero)
            warnings.push_back(name + "the crest folds over itself at its top; at most " +
                               tenths(raise * kSteepestHero / shape.compression * hero.height_m) +
                               " m in this sea, or a lower waves.choppiness");
        else if (std::abs(raised_m) > kHighestHero * deviation_m)
            warnings.push_back(name + "no such sea has one as high; at most " +
                               tenths(kHighestHero * deviation_m / raise) + " m is met, or a higher sea");
    }
    // Of heroes far apart the sums are equal.
    for (const HeroTrain& train : trains)
        raised_m2 += static_cast<double>(trains.size()) * train.height_m * train.height_m;
    if (raised_m2 > kMostRaised * wanted_m2)
        warnings.push_back(
            "waves.heroes: some contradict each other, crest and trough within a part of a wave, and the sea round them is " +
            tenths(std::sqrt(raised_m2 / wanted_m2)) +
            " times as high as they are; stand them farther apart");
    return warnings;
}

std::vector<std::string> vessel_warning(const PreparedScene& prepared) {
    std::vector<std::string> warnings;
    const Scene& scene = prepared.scene;
    for (std::size_t i = 0; i < scene.waves.vessels.size(); ++i) {
        const Vessel& vessel = scene.waves.vessels[i];
        const double fastest_mps = path_of(scene.shot, vessel).fastest_mps(),
                     least_mps = least_wake_mps(vessel);
        if (fastest_mps > least_mps) continue;
        warnings.push_back("waves.vessels[" + std::to_string(i) + "].path goes at up to " +
                           rough_text(fastest_mps) + " m/s, too slow for a wake: a hull of " +
                           number_text(vessel.length_m) + " m has one from " + rough_text(least_mps) +
                           " m/s on");
    }
    return warnings;
}

// Of a picture, whose pixels may be coarser than its edge.
double shown_edge_m(const Waves& waves, const WaveMask& mask) {
    const MaskPicture* picture = picture_of(waves, mask);
    if (!picture) return mask.edge_m;
    return std::max(mask.edge_m,
                    2.0 * std::min(mask.length_m / picture->size().x, mask.width_m / picture->size().y));
}

// A sea that is cut off within half a wave shows it.
std::vector<std::string> mask_warning(const PreparedScene& prepared) {
    const Scene& scene = prepared.scene;
    const std::optional<MasksPlan> plan = plan_masks(scene);
    if (!plan || prepared.spectrum.is_calm()) return {};
    std::vector<std::string> warnings;
    const double longest_m = kTwoPi / prepared.spectrum.longest_peak_wavenumber();
    for (std::size_t i = 0; i < scene.waves.masks.size(); ++i) {
        const WaveMask& mask = scene.waves.masks[i];
        const double enough_m = std::ceil(0.5 * longest_m);
        if (mask.waves == 1.0 || shown_edge_m(scene.waves, mask) >= 0.5 * longest_m) continue;
        warnings.push_back(
            "waves.masks[" + std::to_string(i) + "].edge_m = " + number_text(mask.edge_m) +
            ": narrower than half the longest waves, of " + number_text(std::round(longest_m)) +
            " m, which will be seen to end there; edge_m = " + number_text(enough_m) + " would do");
    }
    // Where waves are rougher than a sea that doesn't fold.
    constexpr double kMuch = 0.05;
    const SpectralMoments all = all_of(prepared.spectrum, Choppiness::asked(scene));
    for (const MasksPlan::Mask& mask : plan->masks) {
        if (!(mask.strongest > 1.0) || share_of(all, 1.0) > kMuch) continue;
        // Others may overlap it.
        const double others = plan->at(mask.strongest_m).waves / mask.strongest;
        const double gain = mask.strongest * others, share = share_of(all, gain);
        if (!(share > kMuch)) continue;
        double less = 1.0, more = gain;
        for (int step = 0; step < 40; ++step) {
            const double middle = 0.5 * (less + more);
            (share_of(all, middle) > kMuch ? more : less) = middle;
        }
        // Of a picture that holds nowhere whole.
        const double as_asked =
                         mask.strongest == mask.waves ? 1.0 : (mask.waves - 1.0) / (mask.strongest - 1.0),
                     enough = as_asked == 1.0 ? less / others : 1.0 + as_asked * (less / others - 1.0);
        warnings.push_back("waves.masks[" + std::to_string(mask.number) +
                           "].waves = " + number_text(mask.waves) + ": the surface folds over itself on " +
                           percent_text(share) + " % of that place; " +
                           number_text(std::floor(100.0 * enough) / 100.0) + " leaves 5 %");
    }
    return warnings;
}

}  // namespace

double folded_share(const DirectionalSpectrum& spectrum, const Choppiness& choppiness) {
    return share_of(all_of(spectrum, choppiness), 1.0);
}

namespace {

// Of one sea, whatever sails on it.
std::vector<std::string> still_warnings(const PreparedScene& prepared) {
    std::vector<std::string> warnings = folding_warning(prepared);
    for (auto* more : {&map_warning, &coast_warning, &trough_warning, &unpressed_warning, &repeats_warning,
                       &blending_warning, &hero_warning, &mask_warning})
        for (std::string& warning : more(prepared)) warnings.push_back(std::move(warning));
    if (std::string thin = spray_warning(prepared.scene, prepared.extent.significant_height_m); !thin.empty())
        warnings.push_back(std::move(thin));
    return warnings;
}

// What makes a sea's waves, but for rain, and for how far they displace it.
std::string dry_waves(const PreparedScene& prepared) {
    Scene scene = prepared.scene;
    scene.sea.rain_mm_h = scene.waves.choppiness = scene.waves.lean_deg = scene.waves.second_order = 0.0;
    return canonical(scene, key_parts(KeyPart::Waves));
}

// Of a sea that changes: those of its keys, and keys between which it changes faster than seas do.
std::vector<std::string> weather_warnings(const Weather& weather) {
    // Of the longest peak: 6 % of the water's speed is then the amplitudes' own change. Of choppiness that comes from nothing 1, with 16 % of
    // that to the side.
    constexpr double kPeriods = 10.0;
    std::vector<std::string> warnings;
    for (const Weather::Key& key : weather.keys)
        for (const std::string& warning : still_warnings(*key.sea))
            warnings.push_back("at frame " + std::to_string(key.frame) + ' ' + warning);
    for (std::size_t i = 0; i + 1 < weather.keys.size(); ++i) {
        const Weather::Key &key = weather.keys[i], &next = weather.keys[i + 1];
        double period_s = 0.0;
        for (const DirectionalSpectrum* of : {&key.sea->spectrum, &next.sea->spectrum})
            if (!of->is_calm())
                period_s = std::max(period_s, kTwoPi / of->dispersion().omega(of->longest_peak_wavenumber()));
        const double lasts_s = next.time_s - key.time_s, before = key.sea->scene.waves.choppiness,
                     after = next.sea->scene.waves.choppiness,
                     enough_s = period_s * std::abs(after - before) /
                                std::max({before, after, Choppiness::kLeastShown});
        if (lasts_s < enough_s)
            warnings.push_back("from frame " + std::to_string(key.frame) + " to " +
                               std::to_string(next.frame) + " waves.choppiness changes within " +
                               number_text(std::round(10.0 * lasts_s) / 10.0) +
                               " s of the sea's time, and water is seen to be pushed aside; keys " +
                               number_text(std::ceil(enough_s)) + " s apart push it slowly");
        if (key.waves == next.waves || dry_waves(*key.sea) == dry_waves(*next.sea))
            continue;  // a shower may be short
        if (lasts_s < kPeriods * period_s)
            warnings.push_back("from frame " + std::to_string(key.frame) + " to " +
                               std::to_string(next.frame) + " the sea changes within " +
                               number_text(std::round(10.0 * lasts_s) / 10.0) +
                               " s of its time, faster than waves of " + number_text(std::round(period_s)) +
                               " s grow; keys " + number_text(std::ceil(kPeriods * period_s)) +
                               " s apart look like weather");
    }
    return warnings;
}

}  // namespace

std::vector<std::string> sea_warnings(const PreparedScene& prepared) {
    std::vector<std::string> warnings =
        prepared.weather ? weather_warnings(*prepared.weather) : still_warnings(prepared);
    for (std::string& warning : vessel_warning(prepared)) warnings.push_back(std::move(warning));
    return warnings;
}

}  // namespace pelagic
