// Rays against a sea of wave trains without choppiness: Darles, Crespin, Ghazanfarpour 2007, Tables 1 and 2.
//
// Pierson-Moskowitz at 10 m/s, trains from 0.3 m to twice the peak's wavelength, a camera 640 × 480 with 50°, every 48th row. Brute
// force steps by a quarter of the shortest wave from where a ray enters the layer of waves. All others find the hit to a
// quarter of a pixel. All evaluate trains with the same vectors, on one thread; the paper gives time only.
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/sphere_tracing.h"
#include "tests/bench/timing.h"
#include "tests/bench/traced_ways.h"

namespace pelagic::bench {
namespace {

constexpr double kShortest_m = 0.3, kWind_mps = 10.0, kFov_deg = 50.0, kFps = 24.0;
constexpr int kWidth = 640, kHeight = 480, kEveryRow = 48;

constexpr std::size_t kSorted = 2;  // that row

struct View {
    const char* name;
    double height_m, down_deg;
};

Frame<float> frame_of(int trains) {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.choppiness = 0.0;
    scene.sea.spectrum = SpectrumKind::PiersonMoskowitz;
    scene.sea.short_waves = ShortWaves::None;
    scene.sea.wind_speed_mps = kWind_mps;
    scene.waves.trains = trains;
    scene.waves.shortest_m = kShortest_m;
    scene.waves.longest_m = 2.0 * kTwoPi / prepare(scene)->spectrum.peak_wavenumber();
    Query query;
    query.name = "rays";
    query.products = products(Product::Position);
    Frame<float> frame(std::make_shared<const Sea<float>>(make_plan(scene, {query})));
    frame.set(0.0);
    return frame;
}

Picture picture_of(const View& view) {
    Picture picture;
    picture.origin_m = {0.0, 0.0, view.height_m};
    picture.width = kWidth;
    const double half = std::tan(0.5 * kFov_deg * kPi / 180.0), pixel = 2.0 * half / kWidth,
                 down = view.down_deg * kPi / 180.0;
    for (int row = 0; row < kHeight; row += kEveryRow)
        for (int column = 0; column < kWidth; ++column) {
            const double x = (column + 0.5) * pixel - half, y = (row + 0.5 - 0.5 * kHeight) * pixel;
            const glm::dvec3 d(x, std::cos(down) - y * std::sin(down), -std::sin(down) - y * std::cos(down));
            if (d.z > -0.01) break;  // to a degree below the horizon
            picture.direction.push_back(glm::vec3(d / std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z)));
        }
    picture.tolerance_per_m = 0.25 * pixel;
    picture.brute_step_m = 0.25 * kShortest_m;
    return picture;
}

struct Row {
    std::string name;
    Ways ways;
    bool is_core = false;
    std::vector<Spheres> kept{};
    SeenSpheres seen{};
    std::vector<double> distance_m{};
    double evaluated = 0.0;  // with `temporal` the mean of all frames but the first
    int frame = 0;
};

// A row's frame: the next one where the last is reused, the first again where it isn't.
void trace(Row& row, Frame<float>& frame, const Picture& picture) {
    frame.set(row.ways.temporal ? row.frame++ / kFps : 0.0);
    const SphereTracing tracing(frame);
    const auto count_of = [&](std::size_t evaluated) {
        const auto now = static_cast<double>(evaluated);
        // The first frame has nothing to reuse.
        row.evaluated = row.frame > 2 ? row.evaluated + (now - row.evaluated) / (row.frame - 1) : now;
    };
    if (!row.is_core) {
        count_of(trace_by(row.ways, tracing.trains(), picture, row.kept, row.distance_m));
        return;
    }
    const std::size_t count = picture.direction.size();
    const std::vector<float> tolerance_m(count, static_cast<float>(picture.tolerance_m)),
        tolerance_per_m(count, static_cast<float>(picture.tolerance_per_m));
    row.distance_m.resize(count);
    count_of(tracing.trace({.count = count,
                            .origin_m = picture.origin_m,
                            .direction = {picture.direction.data()},
                            .tolerance_m = {tolerance_m.data()},
                            .tolerance_per_m = {tolerance_per_m.data()}},
                           {row.distance_m.data()}, row.ways.temporal ? &row.seen : nullptr));
}

void table(const View& view, int trains) {
    Frame<float> frame = frame_of(trains);
    const Picture picture = picture_of(view);
    std::vector<Row> rows{{"brute force", {.bounds = Bounds::Brute}},
                          {"plain sphere tracing", {.bounds = Bounds::Plain}},
                          {"Algorithm 1, sorted at each step", {.bounds = Bounds::Sorted}},
                          {"efficient bounds, by wavelength", {.bounds = Bounds::Efficient}},
                          {"  and spatial", {.bounds = Bounds::Efficient, .spatial = true}},
                          {"  and image", {.bounds = Bounds::Efficient, .image = true}},
                          {"  and temporal", {.bounds = Bounds::Efficient, .temporal = true}},
                          {"curved bounds", {.bounds = Bounds::Curved}},
                          {"  and spatial", {.bounds = Bounds::Curved, .spatial = true}},
                          {"  and image", {.bounds = Bounds::Curved, .image = true}},
                          {"SphereTracing, the core's: curved", {}, true},
                          {"  and temporal", {.temporal = true}, true}};
    if (trains > 50) rows.erase(rows.begin() + kSorted);  // it would take most of the time
    std::vector<Timed> timed;
    for (Row& row : rows) timed.push_back({row.name, [&] { trace(row, frame, picture); }});
    interleave(timed, 5);
    for (Row& row : rows)
        while (row.ways.temporal && row.frame < kFps) trace(row, frame, picture);  // a second, for the mean

    const auto rays = static_cast<double>(picture.direction.size());
    std::printf("\n%s, %d trains, %.0f rays\n  %-34s %10s %8s %8s %10s %8s %8s   %s\n", view.name, trains,
                rays, "", "trains/ray", "brute:", "plain:", "ns/ray", "brute:", "plain:", "mean m");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        double mean_m = 0.0;
        for (const double m : rows[i].distance_m) mean_m += m / rays;
        std::printf("  %-34s %10.1f %8.2f %8.2f %10.0f %8.2f %8.2f   %.3f\n", rows[i].name.c_str(),
                    rows[i].evaluated / rays, rows[0].evaluated / rows[i].evaluated,
                    rows[1].evaluated / rows[i].evaluated, 1e6 * timed[i].median() / rays,
                    timed[0].median() / timed[i].median(), timed[1].median() / timed[i].median(), mean_m);
    }
    const std::size_t temporal = rows.size() - 1, best = temporal - 1;
    const auto target = [&](const char* name, std::size_t of, std::size_t by, double least) {
        const double ratio = rows[of].evaluated / rows[by].evaluated;
        std::printf("  %-46s trains %6.1f x (target %4.1f: %s), time %5.2f x\n", name, ratio, least,
                    verdict(ratio >= least), timed[of].median() / timed[by].median());
    };
    target("the core's against brute force", 0, best, 10.0);
    target("the core's against plain sphere tracing", 1, best, 2.0);
    target("temporal reuse against none", best, temporal, 1.4);
    const SeenSpheres& seen = rows[temporal].seen;
    std::printf(
        "  which keeps %.0f bytes a ray\n",
        static_cast<double>(seen.rays.capacity() * sizeof(SeenSpheres::Ray) +
                            (seen.spheres.capacity() + seen.next.capacity()) * sizeof(SeenSpheres::Sphere)) /
            rays);
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    for (const int trains : {10, 50, 100, 200})
        pelagic::bench::table({"from 10 m, 20 degrees down", 10.0, 20.0}, trains);
    pelagic::bench::table({"from 4 m, to a degree below the horizon", 4.0, 8.0}, 50);
}
