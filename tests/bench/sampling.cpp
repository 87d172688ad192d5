// The price list of sampling: for each quality level, the error against the reference level and the time.

#include <cmath>
#include <cstdio>
#include <string>

#include "core/evaluate/evaluate.h"
#include "core/scene/names.h"
#include "core/surface/patch.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

struct Answers {
    std::vector<glm::dvec3> position, normal;
    std::vector<double> coverage;
    double significant_height_m = 0.0;
};

template <class T>
struct Level {
    Frame<T> frame;
    std::vector<glm::vec<2, T>> points;
    std::vector<glm::vec<3, T>> position, normal;
    std::vector<T> coverage;

    Level(const Scene& scene, const Plan& plan, const PatchLattice& lattice)
        : frame(std::make_shared<const Sea<T>>(scene, plan)),
          points(rest_points<T>(lattice)),
          position(points.size()),
          normal(points.size()),
          coverage(points.size()) {}
    void set() { frame.set(3.0); }
    void sample() {
        Results<T> results;
        results.position = {position.data()};
        results.normal = {normal.data()};
        results.coverage = {coverage.data()};
        evaluate(frame, 0, Points<T>{.count = points.size(), .rest_m = {points.data()}}, results);
    }
    Answers answers() const {
        Answers a;
        for (const auto& p : position) a.position.emplace_back(p);
        for (const auto& n : normal) a.normal.emplace_back(n);
        for (const T c : coverage) a.coverage.push_back(static_cast<double>(c));
        a.significant_height_m = frame.sea().total().significant_height_m();
        return a;
    }
};

void table() {
    constexpr int kQuads = 512;
    Scene scene;
    scene.surface = {.size_m = 200.0, .resolution = kQuads};
    const PatchLattice lattice{.per_side = kQuads + 1, .spacing_m = 200.0 / kQuads, .first_m = -100.0};
    const auto level_of = [&]<class T>(QualityLevel level, T) {
        scene.quality.level = level;
        return std::make_unique<Level<T>>(scene, make_plan(scene), lattice);
    };
    const auto reference = level_of(QualityLevel::Reference, double());
    const auto draft = level_of(QualityLevel::Draft, float()),
               preview = level_of(QualityLevel::Preview, float()),
               final_level = level_of(QualityLevel::Final, float());
    std::vector<Timed> timed;
    const auto add = [&](const char* name, auto& level) {
        timed.push_back({std::string(name) + " set", [&] { level->set(); }});
        timed.push_back({std::string(name) + " sample", [&] { level->sample(); }});
    };
    add("reference", reference);
    add("draft", draft);
    add("preview", preview);
    add("final", final_level);
    interleave(timed, 5);

    const Answers exact = reference->answers();
    const auto print = [&](const char* name, const Answers& a, std::size_t row) {
        double position = 0.0, normal = 0.0, coverage = 0.0, worst = 0.0;
        const auto squared = [](glm::dvec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; };
        for (std::size_t i = 0; i < a.position.size(); ++i) {
            position += squared(a.position[i] - exact.position[i]);
            worst = std::max(worst, squared(a.position[i] - exact.position[i]));
            normal += squared(a.normal[i] - exact.normal[i]);
            coverage += (a.coverage[i] - exact.coverage[i]) * (a.coverage[i] - exact.coverage[i]);
        }
        const auto n = static_cast<double>(a.position.size());
        std::printf("  %-10s %12.2e %12.2e %12.2e %12.2e %10.2f %10.2f\n", name,
                    std::sqrt(position / n) / exact.significant_height_m,
                    std::sqrt(worst) / exact.significant_height_m, std::sqrt(normal / n),
                    std::sqrt(coverage / n), timed[row].median() / timed[0].median(),
                    timed[row + 1].median() / timed[1].median());
    };
    std::printf(
        "\nSampling, default sea, %d^2 quads over 200 m on no cascade's grid; errors against \"reference\" "
        "(double, quintic)\n  %-10s %12s %12s %12s %12s %10s %10s\n",
        kQuads, "quality", "pos rms/Hs", "pos max/Hs", "normal rms", "cover rms", "set ratio", "read ratio");
    print("reference", exact, 0);
    print("final", final_level->answers(), 6);
    print("preview", preview->answers(), 4);
    print("draft", draft->answers(), 2);
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    pelagic::bench::table();
}
