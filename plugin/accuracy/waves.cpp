// Sweeps of the sum of waves: how many, how they are read between their grids' nodes, and in which arithmetic.
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <utility>

#include "core/base/constants.h"
#include "core/base/instruction_set.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/prepared_scene.h"
#include "core/scene/cascade_bands.h"
#include "core/scene/text.h"
#include "plugin/accuracy/rows.h"
#include "plugin/accuracy/sea_answers.h"

namespace pelagic::rows {
namespace {

const ProductSet kShape = products(Product::Position, Product::Normal);

// The shot as a sum of waves: without blended tiles, pairs of waves and lean, which grids read as they read all else, and without
// heroes, which no grid holds.
Scene plain_waves(Scene shot) {
    shot.waves.tiling = Tiling::Periodic;
    shot.waves.second_order = shot.waves.lean_deg = 0.0;
    shot.waves.heroes.clear();
    shot.waves.vessels.clear();
    return shot;
}

const char* const kTrainsOnly = "has nothing to sweep: the shot's waves are trains alone";

bool has_cascades(const Scene& shot) {
    return shot.waves.model != WaveModel::Trochoid || !shot.waves.cascades.empty();
}

// The shot with the cascades that it resolves to, however it gives them.
Scene resolved(const Scene& shot) {
    Scene scene = plain_waves(shot);
    scene.waves.cascades = resolve_cascades(*prepare(scene), 0.0);
    return scene;
}

// Positions as the sum of all waves, one by one, in double precision (Tessendorf 2001, Eqs. 19 and 29, displaced towards
// the crests): what grids and splines stand for.
std::vector<glm::dvec3> summed_positions(const Scene& scene, const std::vector<glm::dvec2>& rest_m,
                                         double time_s) {
    Query query;
    query.name = "sum";
    query.products = products(Product::Position);
    const Sea<double> sea(make_plan(scene, {query}, {.knobs = Knobs{.double_precision = true}}));
    std::vector<glm::dvec3> positions(rest_m.size());
    tbb::parallel_for(std::size_t{0}, rest_m.size(), [&](std::size_t p) {
        const glm::dvec2 x = rest_m[p];
        glm::dvec3 position(x, 0.0);
        for (const Cascade<double>& cascade : sea.cascades()) {
            if (cascade.radius == 0) continue;
            const double step = kTwoPi / cascade.size_m;
            // e^{i k·x} of a mode is the product of its row's and its column's.
            std::vector<std::complex<double>> along_y(2 * static_cast<std::size_t>(cascade.radius) - 1);
            for (int my = 1 - cascade.radius; my < cascade.radius; ++my)
                along_y[static_cast<std::size_t>(my + cascade.radius - 1)] = std::polar(1.0, my * step * x.y);
            for (int mx = 0; mx < cascade.radius; ++mx) {
                const std::complex<double> along_x = std::polar(1.0, mx * step * x.x);
                const int height = half_height(cascade.radius, mx);
                for (int my = -height; my <= height; ++my) {
                    if (!counts_as_wave(mx, my)) continue;
                    const std::size_t mode = cascade.middle(mx) + my;
                    const std::complex<double> turn =
                        std::polar(1.0, -kTwoPi * std::fmod(cascade.cycles_per_s[mode] * time_s, 1.0));
                    const std::complex<double> forward(cascade.forward_re[mode], cascade.forward_im[mode]),
                        backward(cascade.backward_re[mode], cascade.backward_im[mode]);
                    const std::complex<double> wave =
                        2.0 * (forward * turn + backward * std::conj(turn)) * along_x *
                        along_y[static_cast<std::size_t>(my + cascade.radius - 1)];
                    const double across = cascade.chop.empty() ? 0.0 : cascade.chop[mode] * wave.imag();
                    position += glm::dvec3(-mx * step * across, -my * step * across, wave.real());
                }
            }
        }
        positions[p] = position;
    });
    return positions;
}

// At most so many of the points, far from each other.
SweepPoints some_of(const SweepPoints& all, std::size_t most) {
    SweepPoints some = all;
    some.rest_m.clear();
    const std::size_t step = std::max<std::size_t>(all.rest_m.size() / most, 1) | 1;
    for (std::size_t i = step / 2; i < all.rest_m.size(); i += step) some.rest_m.push_back(all.rest_m[i]);
    return some;
}

// Relative errors of the mean square slope and of the significant height.
std::vector<double> moment_errors(const SpectralMoments& resolved, const SpectralMoments& whole) {
    const auto off = [](double is, double should_be) {
        return should_be > 0.0 ? std::abs(1.0 - is / should_be) : 0.0;
    };
    return {off(resolved.mss(), whole.mss()),
            off(resolved.significant_height_m(), whole.significant_height_m())};
}

}  // namespace

Trials cascade_resolution(const Scene& shot) {
    if (!has_cascades(shot)) return {{}, kTrainsOnly};
    const Scene own = resolved(shot);
    constexpr int kReference = 4096;
    Scene fine = own;
    fine.waves.cascades.back().resolution = std::max(kReference, own.waves.cascades.back().resolution);
    const SweepPoints at = sweep_points(own), some = some_of(at, 64);
    const auto exact =
        std::make_shared<const std::vector<glm::dvec3>>(summed_positions(fine, some.rest_m, at.time_s));
    const SpectralMoments whole =
        moments(prepare(own)->spectrum, 0.0, std::numeric_limits<double>::infinity());
    const double height_m = std::max(whole.significant_height_m(), 1e-12);
    Trials trials;
    for (const int resolution : {32, 64, 128, 256, 512, 1024, 2048}) {
        Scene scene = own;
        scene.waves.cascades.back().resolution = resolution;
        const auto sea = std::make_shared<SeaAnswers>(scene, kShape, 0.0, at);
        trials.trials.push_back({.setting = std::to_string(resolution) + "²",
                                 .is_shots = resolution == own.waves.cascades.back().resolution,
                                 .run = [sea] { sea->run(); },
                                 .errors =
                                     [=] {
                                         SeaAnswers there(scene, products(Product::Position), 0.0, some);
                                         there.run();
                                         const SpectralMoments resolved = sea->resolved_moments();
                                         return std::vector<double>{
                                             rms(there.vectors(Product::Position), *exact) / height_m,
                                             1.0 - resolved.significant_height_m() / height_m,
                                             whole.mss() > 0.0 ? 1.0 - resolved.mss() / whole.mss() : 0.0};
                                     },
                                 .bytes = sea->bytes()});
    }
    return trials;
}

Trials cascade_number(const Scene& shot) {
    if (!has_cascades(shot)) return {{}, kTrainsOnly};
    const Scene own = resolved(shot);
    // All have the shot's largest period and shortest wave; what differs is where the grids in between lie.
    const double largest_m = own.waves.cascades.front().size_m;
    const CascadeSize finest = own.waves.cascades.back();
    const double shortest_m = 2.0 * finest.size_m / finest.resolution;
    const SpectralMoments whole = moments(prepare(own)->spectrum, 0.0, kTwoPi / shortest_m);
    const SweepPoints at = sweep_points(own);
    Trials trials;
    for (const int count : {1, 2, 3, 4, 5}) {
        const double ratio = std::pow(largest_m / finest.size_m, 1.0 / std::max(count - 1, 1));
        std::vector<double> sizes_m;
        for (int i = 0; i < count; ++i) sizes_m.push_back(largest_m / std::pow(ratio, i));
        const std::vector<double> edges = lower_edges(sizes_m);
        Scene scene = own;
        scene.waves.cascades.clear();
        constexpr int kLargest = 4096;
        for (int i = 0; i < count; ++i) {
            const double size_m = sizes_m[static_cast<std::size_t>(i)];
            const double ends = i + 1 < count ? edges[static_cast<std::size_t>(i) + 1] : kTwoPi / shortest_m;
            const double needed =
                i + 1 < count ? sufficient_resolution(size_m, ends) : 2.0 * std::ceil(size_m / shortest_m);
            scene.waves.cascades.push_back(
                {size_m,
                 static_cast<int>(std::clamp(needed, double{kMinCascadeResolution}, double{kLargest}))});
        }
        const auto sea = std::make_shared<SeaAnswers>(scene, kShape, 0.0, at);
        trials.trials.push_back({.setting = std::to_string(count) + (count == 1 ? " cascade" : " cascades"),
                                 .is_shots = count == static_cast<int>(own.waves.cascades.size()),
                                 .run = [sea] { sea->run(); },
                                 .errors = [=] { return moment_errors(sea->resolved_moments(), whole); },
                                 .bytes = sea->bytes()});
    }
    return trials;
}

namespace {

// The sea in double precision, read as exactly as it can be.
struct InDouble {
    Scene scene;
    SweepPoints at;
    std::vector<glm::dvec3> position, normal;
    double height_m;

    explicit InDouble(Scene of) : scene(std::move(of)), at(sweep_points(scene)) {
        SeaAnswers exact(scene, kShape, 0.0, at,
                         {.knobs = Knobs{.spline_taps = 6, .oversampling = 4.0, .double_precision = true}});
        exact.run();
        position = exact.vectors(Product::Position);
        normal = exact.vectors(Product::Normal);
        height_m = std::max(exact.significant_height_m(), 1e-12);
    }
    std::shared_ptr<SeaAnswers> sea(const Knobs& knobs) const {
        return std::make_shared<SeaAnswers>(scene, kShape, 0.0, at, PlanOptions{.knobs = knobs});
    }
    std::vector<double> errors(const SeaAnswers& of) const {
        return {rms(of.vectors(Product::Position), position) / height_m,
                rms(of.vectors(Product::Normal), normal)};
    }
};

Trials against_double(const Scene& shot, const std::vector<std::pair<std::string, Knobs>>& settings) {
    const auto exact = std::make_shared<const InDouble>(resolved(shot));
    Knobs shots = make_plan(exact->scene, {}).knobs;
    shots.light_oversampling = Knobs().light_oversampling;  // these points are no picture's
    Trials trials;
    for (const auto& [name, knobs] : settings) {
        const auto sea = exact->sea(knobs);
        trials.trials.push_back({.setting = name,
                                 .is_shots = knobs == shots,
                                 .run = [sea] { sea->run(); },
                                 .errors = [=] { return exact->errors(*sea); },
                                 .bytes = sea->bytes()});
    }
    return trials;
}

}  // namespace

Trials interpolation(const Scene& shot) {
    if (!has_cascades(shot)) return {{}, kTrainsOnly};
    std::vector<std::pair<std::string, Knobs>> settings;
    for (const auto& [taps, name] : {std::pair{4, "cubic"}, std::pair{6, "quintic"}})
        for (const double oversampling : {1.0, 1.25, 1.5, 2.0, 3.0})
            settings.push_back({std::string(name) + ", " + number_text(oversampling) + " nodes a sample",
                                {.spline_taps = taps, .oversampling = oversampling}});
    return against_double(shot, settings);
}

Trials precision(const Scene& shot) {
    if (!has_cascades(shot)) return {{}, kTrainsOnly};
    return against_double(shot,
                          {{"single", {.spline_taps = 6, .oversampling = 4.0}},
                           {"double", {.spline_taps = 6, .oversampling = 4.0, .double_precision = true}}});
}

Trials train_number(const Scene& shot) {
    Scene trains = shot;
    trains.waves.model = WaveModel::Trochoid;
    trains.waves.cascades.clear();
    const auto prepared = prepare(trains);
    const SweepPoints at = sweep_points(trains, 128);
    Trials trials;
    for (const int count : {10, 20, 30, 60, 120, 240, 480}) {
        Scene scene = trains;
        scene.waves.trains = count;
        const auto sea = std::make_shared<SeaAnswers>(scene, kShape, 0.0, at);
        const TrainsPlan& plan = *sea->plan().trains;
        const SpectralMoments whole =
            moments(prepared->spectrum, kTwoPi / plan.longest_m, kTwoPi / plan.shortest_m);
        trials.trials.push_back(
            {.setting = std::to_string(count) + " trains",
             .is_shots = shot.waves.model == WaveModel::Trochoid && shot.waves.trains == count,
             .run = [sea] { sea->run(); },
             .errors = [=] { return moment_errors(sea->resolved_moments(), whole); },
             .bytes = sea->bytes()});
    }
    return trials;
}

Trials instruction_sets(const Scene& shot) {
    const auto exact = std::make_shared<const InDouble>(plain_waves(shot));
    const std::string best = instruction_set();
    Trials trials;
    for (const std::string& name : pelagic::instruction_sets()) {
        use_instruction_set(name);
        const auto sea = exact->sea({.spline_taps = 6, .oversampling = 4.0});
        trials.trials.push_back({.setting = name,
                                 .is_shots = name == best,
                                 .run =
                                     [=] {
                                         use_instruction_set(name);
                                         sea->run();
                                         use_instruction_set(best);
                                     },
                                 .errors = [=] { return exact->errors(*sea); }});
    }
    use_instruction_set(best);
    return trials;
}

}  // namespace pelagic::rows
