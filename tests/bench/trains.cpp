// What wave trains cost as seen from near and far: the cost is that of the resolved ones.
//
// The view of Bruneton, Neyret, Holzschuch 2010, §7.3: horizontal, 1024 × 768 pixels, cells of 8 × 8 pixels,
// from 4 m, 1000 m and 8000 m above the sea. Points are projected onto the plane of the sea at rest; a
// pixel's (a cell's) footprint is its longer side there, δ d²/height at distance d. Two workloads: all fields
// at the cells' corners, and the paper's: positions at the corners, normals and what is unresolved at each pixel.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/trains.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr int kWidth = 1024, kHeight = 768, kCell_px = 8;
constexpr double kFov_deg = 50.0;

// Points below the horizon, a screen row after the other, in chunks.
struct View {
    std::vector<float> x, y, pixel_m, cell_m;

    View(double height_m, int step_px) {
        const double half_width = std::tan(0.5 * kFov_deg * kPi / 180.0), pixel = 2.0 * half_width / kWidth;
        for (int row = 0; 2 * row < kHeight; row += step_px)
            for (int column = 0; column < kWidth; column += step_px) {
                // On the image plane one metre ahead; rows count from the picture's lower edge.
                const double right = (column + 0.5) * pixel - half_width;
                const double down = 0.5 * kHeight * pixel - (row + 0.5) * pixel;
                const double ahead_m = height_m / down,
                             distance2 = ahead_m * ahead_m * (1.0 + right * right + down * down);
                x.push_back(static_cast<float>(right * ahead_m));
                y.push_back(static_cast<float>(ahead_m));
                const double angle = pixel / (1.0 + right * right + down * down);
                pixel_m.push_back(static_cast<float>(angle * distance2 / height_m));
                cell_m.push_back(static_cast<float>(kCell_px * angle * distance2 / height_m));
            }
    }
};

struct Load {
    View view;
    FieldSet wanted;
    bool unresolved, filtered;
    std::size_t evaluated = 0;
};

void run(Load& load, const Trains<float>& trains, const std::vector<double>& start_cycles) {
    static Chunk<float> chunk;
    static UnresolvedChunk<float> unresolved;
    static std::array<float, Chunk<float>::kPoints> cell_m, pixel_m;
    load.evaluated = 0;
    for (std::size_t first = 0; first < load.view.x.size(); first += Chunk<float>::kPoints) {
        chunk.count = std::min(Chunk<float>::kPoints, load.view.x.size() - first);
        for (auto& sum : chunk.sums) sum.fill(0.0f);
        for (std::size_t i = 0; i < chunk.count; ++i) {
            chunk.rest_x[i] = load.view.x[first + i];
            chunk.rest_y[i] = load.view.y[first + i];
            cell_m[i] = load.view.cell_m[first + i];
            pixel_m[i] = load.view.pixel_m[first + i];
        }
        load.evaluated += add_trains<float>({.trains = &trains,
                                             .start_cycles = start_cycles.data(),
                                             .wanted = load.wanted,
                                             .cell_of = load.filtered ? cell_m.data() : nullptr,
                                             .pixel_of = load.filtered ? pixel_m.data() : nullptr,
                                             .unresolved = load.unresolved ? &unresolved : nullptr},
                                            chunk);
    }
}

void table() {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    const auto prepared = prepare(scene);
    const TrainsPlan plan = resolve_trains(*prepared, 0.03);
    const auto trains = make_trains<float>(*prepared, plan);
    const auto start = phases_at(trains, {0.0, 0.0}, 1.0);
    const FieldSet all = FieldSet().set();
    const FieldSet positions = fields(Field::Height, Field::Dx, Field::Dy);
    const FieldSet normals = fields(Field::SlopeX, Field::SlopeY, Field::Dxx, Field::Dyy, Field::Dxy);

    std::vector<std::pair<std::string, std::vector<Load>>> rows;
    for (const double height_m : {4.0, 1000.0, 8000.0}) {
        const std::string from = "from " + std::to_string(static_cast<int>(height_m)) + " m";
        rows.push_back({"all fields and unresolved moments at cells, " + from,
                        {{View(height_m, kCell_px), all, true, true}}});
        rows.push_back(
            {"positions at cells, normals at pixels, " + from,
             {{View(height_m, kCell_px), positions, false, true}, {View(height_m, 1), normals, true, true}}});
    }
    rows.push_back(
        {"all fields at cells, every train everywhere", {{View(4.0, kCell_px), all, false, false}}});
    std::vector<Timed> timed;
    for (auto& [name, loads] : rows)
        timed.push_back({name, [&l = loads, &trains, &start] {
                             for (Load& load : l) run(load, trains, start);
                         }});
    interleave(timed, 15);

    std::printf(
        "\nWave trains, %d of them, %.3g m ... %.3g m, one thread, medians of 15 interleaved repeats\n"
        "(in the paper a whole frame, shading included, takes 2.5 times as long at 4 m as at 8000 m)\n",
        plan.count, plan.shortest_m, plan.longest_m);
    std::printf("  %-58s %8s %10s %14s %9s\n", "", "ms", "ns/point", "trains/point", "4 m : it");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::size_t points = 0, evaluated = 0;
        for (const Load& load : rows[i].second) {
            points += load.view.x.size();
            evaluated += load.evaluated;
        }
        const double ms = timed[i].median();
        std::printf("  %-58s %8.3f %10.2f %14.1f %9.2f\n", rows[i].first.c_str(), ms,
                    1e6 * ms / static_cast<double>(points),
                    static_cast<double>(evaluated) / static_cast<double>(points), timed[i % 2].median() / ms);
    }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    pelagic::bench::table();
}
