// The price list of sampling: for seas that a patch lies on and doesn't lie on, each quality level's error
// and time. Errors are against the level "reference" (double, quintic spline, four nodes per Nyquist sample),
// whose own error comes from adding up all waves, one by one, at a few points.

#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <string>

#include "core/base/constants.h"
#include "core/evaluate/evaluate.h"
#include "core/plan/mode_lattice.h"
#include "core/scene/names.h"
#include "core/surface/patch.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr double kTime_s = 3.0;

// A scene and the patch that it is seen on.
struct Case {
    std::string name;
    Scene scene;
    PatchLattice patch;

    Plan plan(QualityLevel level) const {
        Scene at_level = scene;
        at_level.quality.level = level;
        Query query;
        query.name = "patch";
        query.products =
            products(Product::Position, Product::Normal, Product::SlopeVariance, Product::Breaking);
        query.cell_m = query.pixel_m = {patch.spacing_m};
        query.lattice = Lattice{patch.first_m, patch.spacing_m, -patch.first_m};
        return make_plan(at_level, {query});
    }
};

struct Answers {
    std::vector<glm::dvec3> position, normal;
    std::vector<double> coverage;
};

template <class T>
struct Level {
    Frame<T> frame;
    std::vector<glm::vec<2, T>> points;
    std::vector<glm::vec<3, T>> position, normal, variance;
    std::vector<T> coverage;

    Level(const Case& at, QualityLevel level)
        : frame(std::make_shared<const Sea<T>>(at.plan(level))),
          points(rest_points<T>(at.patch)),
          position(points.size()),
          normal(points.size()),
          variance(points.size()),
          coverage(points.size()) {}
    void set() { frame.set(kTime_s); }
    void sample() {
        Results<T> results;
        results.set(Product::Position, {position.data()});
        results.set(Product::Normal, {normal.data()});
        results.set(Product::SlopeVariance, {variance.data()});
        results.set(Product::Breaking, {coverage.data()});
        evaluate(frame, 0, Points<T>{.count = points.size(), .rest_m = {points.data()}}, results);
    }
    Answers answers() const {
        Answers a;
        for (const auto& p : position) a.position.emplace_back(p);
        for (const auto& n : normal) a.normal.emplace_back(n);
        for (const T c : coverage) a.coverage.push_back(static_cast<double>(c));
        return a;
    }
    std::string sampling() const {
        std::string text;
        const Plan& plan = frame.sea().plan();
        for (const CascadePlan& cascade : plan.cascades)
            for (const Grid& grid : cascade.grids)
                text += (text.empty() ? "" : " + ") + std::to_string(grid.resolution) + "^2" +
                        (grid.sampling == Sampling::Nodes ? " nodes"
                         : plan.knobs.spline_taps == 6    ? " quintic"
                                                          : " cubic");
        return text;
    }
};

double squared(glm::dvec3 v) {
    return v.x * v.x + v.y * v.y + v.z * v.z;
}

// The reference's positions against the sum over all waves (Tessendorf 2001, Eq. 19 and 29, its
// displacement towards the crests), rms [m].
double error_of_reference_m(const Level<double>& reference) {
    constexpr std::size_t kPoints = 50;
    const Sea<double>& sea = reference.frame.sea();
    const double footprint_m = sea.plan().queries[0].query.cell_m[0];
    double sum = 0.0;
    for (std::size_t p = 0; p < kPoints; ++p) {
        const std::size_t at = (p + 1) * 7919 * 104729 % reference.points.size();
        const glm::dvec2 x = reference.points[at];
        glm::dvec3 position(x.x, x.y, 0.0);
        for (const Cascade<double>& cascade : sea.cascades()) {
            const double step = kTwoPi / cascade.size_m;
            for (int mx = 0; mx < cascade.radius; ++mx)
                for (int my = -half_height(cascade.radius, mx); my <= half_height(cascade.radius, mx); ++my) {
                    if (!counts_as_wave(mx, my)) continue;
                    const std::size_t mode = cascade.middle(mx) + my;
                    const double kx = mx * step, ky = my * step;
                    const double weight = sea.plan().filter.weight(std::hypot(kx, ky), footprint_m);
                    const auto turn = std::polar(1.0, -kTwoPi * cascade.cycles_per_s[mode] * kTime_s);
                    const std::complex<double> forward(cascade.forward_re[mode], cascade.forward_im[mode]),
                        backward(cascade.backward_re[mode], cascade.backward_im[mode]);
                    const std::complex<double> wave = 2.0 * weight *
                                                      (forward * turn + backward * std::conj(turn)) *
                                                      std::polar(1.0, kx * x.x + ky * x.y);
                    const double across = cascade.chop[mode] * wave.imag();
                    position += glm::dvec3(-kx * across, -ky * across, wave.real());
                }
        }
        sum += squared(position - reference.position[at]);
    }
    return std::sqrt(sum / kPoints);
}

void table(const Case& at, Level<float>& own_grid) {
    Level<double> reference(at, QualityLevel::Reference);
    reference.set();
    reference.sample();
    const Answers exact = reference.answers();
    const double height_m = reference.frame.sea().total().significant_height_m();
    std::printf("\n%s; the reference itself: %.0e\n", at.name.c_str(),
                error_of_reference_m(reference) / height_m);
    const auto levels = std::array{QualityLevel::Final, QualityLevel::Preview, QualityLevel::Draft};
    const auto names = std::array{"final", "preview", "draft"};
    std::vector<std::unique_ptr<Level<float>>> made;
    for (const QualityLevel level : levels) made.push_back(std::make_unique<Level<float>>(at, level));
    std::printf("  %-8s %-28s %10s %10s %10s %10s\n", "quality", "grids", "pos rms/Hs", "pos max/Hs",
                "normal rms", "cover rms");
    for (std::size_t i = 0; i < made.size(); ++i) {
        made[i]->set();
        made[i]->sample();
        const Answers a = made[i]->answers();
        double position = 0.0, normal = 0.0, coverage = 0.0, worst = 0.0;
        for (std::size_t j = 0; j < a.position.size(); ++j) {
            position += squared(a.position[j] - exact.position[j]);
            worst = std::max(worst, squared(a.position[j] - exact.position[j]));
            normal += squared(a.normal[j] - exact.normal[j]);
            coverage += (a.coverage[j] - exact.coverage[j]) * (a.coverage[j] - exact.coverage[j]);
        }
        const auto n = static_cast<double>(a.position.size());
        std::printf("  %-8s %-28s %10.1e %10.1e %10.1e %10.1e\n", names[i], made[i]->sampling().c_str(),
                    std::sqrt(position / n) / height_m, std::sqrt(worst) / height_m, std::sqrt(normal / n),
                    std::sqrt(coverage / n));
    }
    std::printf("  %-8s %8s %16s %16s %20s\n", "", "threads", "set ns/vertex", "evaluate",
                "both, x own grid");
    for (const int threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        std::vector<Timed> timed;
        const auto add = [&](Level<float>& level) {
            timed.push_back({"set", [&] { level.set(); }});
            timed.push_back({"evaluate", [&] { level.sample(); }});
        };
        add(own_grid);
        for (auto& level : made) add(*level);
        interleave(timed, 9);
        const auto per_vertex = [&](std::size_t row, const Level<float>& level) {
            return 1e6 * timed[row].median() / static_cast<double>(level.points.size());
        };
        const double own = per_vertex(0, own_grid) + per_vertex(1, own_grid);
        for (std::size_t i = 0; i < made.size(); ++i) {
            const double set = per_vertex(2 * i + 2, *made[i]), read = per_vertex(2 * i + 3, *made[i]);
            std::printf("  %-8s %8d %16.1f %16.1f %20.2f\n", names[i], threads, set, read,
                        (set + read) / own);
        }
    }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    using namespace pelagic;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a table takes a while
    constexpr int kQuads = 1024;
    const auto patch = [](double size_m, int quads) {
        return PatchLattice{.per_side = quads + 1, .spacing_m = size_m / quads, .first_m = -0.5 * size_m};
    };
    bench::Case own{"One cascade, 1024^2, on its own grid", {}, patch(400.0, kQuads)};
    own.scene.waves.cascades = {{.size_m = 400.0, .resolution = kQuads}};
    bench::Case between = own;
    between.name = "The same cascade, on none of its nodes";
    between.patch.first_m += 0.3 * between.patch.spacing_m;
    bench::Case two = own;
    two.name = "Two cascades, 1024^2 each, on neither's grid";
    two.patch = patch(387.0, kQuads);
    two.scene.waves.cascades.push_back({.size_m = 94.4, .resolution = kQuads});
    const bench::Case usual{"The default sea, four cascades, on nobody's grid", {}, patch(200.0, 512)};

    std::printf(
        "Sampling: positions, normals, slope variance and coverage; waves down to two quads. Errors against "
        "the reference's\n");
    bench::Level<float> own_grid(own, QualityLevel::Final);
    for (const bench::Case& at : {own, between, two, usual}) bench::table(at, own_grid);
}
