// Helpers for the tests of waves and of the query: a sea in a few lines, query results as arrays, fields by
// node, and sums over modes in double that use neither transforms nor splines.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/values.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/plan.h"
#include "core/scene/validate.h"
#include "core/surface/patch.h"
#include "core/waves/frame.h"

namespace pelagic::test {

// samples.vectors(Displacement). JacobianMoments is a type as well, so not that one.
using Product::Coverage, Product::Displacement, Product::Normal, Product::Position, Product::SlopeVariance,
    Product::SlopeVarianceAtRest, Product::Velocity;

template <class T>
Frame<T> frame_of(const Scene& scene, const Plan& plan, double t_s = 0.0) {
    for (const Problem& problem : validate(scene)) throw std::invalid_argument(text_of(problem));
    Frame<T> frame(std::make_shared<const Sea<T>>(plan));
    frame.set(t_s);
    return frame;
}
template <class T>
Frame<T> frame_of(const Scene& scene, const std::vector<Query>& queries, double t_s = 0.0) {
    return frame_of<T>(scene, make_plan(scene, queries), t_s);
}

// A sea of what its formulas are of: each wave by itself, the displacement a quarter of a period from the height.
inline Scene first_order(Scene scene = {}) {
    scene.waves.second_order = 0.0;
    scene.waves.lean_deg = 0.0;
    return scene;
}

inline Query unfiltered(ProductSet wanted) {
    Query query;
    query.name = "points";
    query.products = wanted;
    return query;  // footprints of 0
}
inline Query filtered(ProductSet wanted, double footprint_m) {
    Query query = unfiltered(wanted);
    query.cell_m = query.pixel_m = {footprint_m};
    return query;
}
// The nodes of one cascade's tile, n × n.
inline Query tile(ProductSet wanted, int cascade, double size_m, int n) {
    Query query = unfiltered(wanted);
    query.name = "tile";
    query.lattice = Lattice{0.0, size_m / n};
    query.only_cascade = cascade;
    return query;
}

template <class T>
std::vector<glm::vec<2, T>> tile_points(double size_m, int n) {
    return rest_points<T>({.per_side = n, .spacing_m = size_m / n, .first_m = 0.0});
}
// Random points in a square of this size around the origin.
template <class T>
std::vector<glm::vec<2, T>> random_points(double size_m, int count, unsigned seed = 1) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> inside(-0.5 * size_m, 0.5 * size_m);
    std::vector<glm::vec<2, T>> points;
    for (int i = 0; i < count; ++i) {
        const double x = inside(generator), y = inside(generator);
        points.emplace_back(x, y);
    }
    return points;
}

template <class T>
struct Where {
    glm::dvec2 origin_m{0.0};
    std::vector<T> cell_m, pixel_m;  // empty: the query's first
};

// Everything that the query holds and a frame knows, at each point.
template <class T>
ProductArrays<T> sample(const Frame<T>& frame, int query, const std::vector<glm::vec<2, T>>& rest,
                        const Where<T>& where = {}) {
    ProductArrays<T> samples;
    samples.resize(frame.sea().plan().queries.at(query).query.products & ~lasting_products(), rest.size());
    Points<T> points{.origin_m = where.origin_m,
                     .count = rest.size(),
                     .rest_m = {rest.data()},
                     .cell_m = {},
                     .pixel_m = {}};
    if (!where.cell_m.empty()) points.cell_m = {where.cell_m.data()};
    if (!where.pixel_m.empty()) points.pixel_m = {where.pixel_m.data()};
    evaluate(frame, query, points, samples.results());
    return samples;
}

// A field at the nodes of its grid, x fastest. The grid must be read at its nodes.
template <class T>
std::vector<double> field_at_nodes(const Frame<T>& frame, int cascade, Field field) {
    const Grid& grid = frame.sea().plan().cascades.at(cascade).grids.at(0);
    if (grid.sampling != Sampling::Nodes) throw std::logic_error("the grid is not read at its nodes");
    if (const T* samples = frame.samples(cascade, 0, field)) {
        std::vector<double> result;
        for (int y = 0; y < grid.resolution; ++y)
            for (int x = 0; x < grid.resolution; ++x)
                result.push_back(static_cast<double>(samples[y * line_stride<T>(grid.resolution) + x]));
        return result;
    }
    throw std::logic_error("the grid doesn't hold the field");
}

// A mode at time t from the sea's amplitudes, with phases in long double.
struct Mode {
    int mx, my;
    double k, omega;
    std::complex<double> height;  // h(k,t); −k has the conjugate
};

template <class T>
std::vector<Mode> modes_of(const Sea<T>& sea, int cascade, double t_s) {
    const Cascade<T>& waves = sea.cascades()[cascade];
    std::vector<Mode> modes;
    for (int mx = 0; mx < waves.radius; ++mx)
        for (int my = -half_height(waves.radius, mx); my <= half_height(waves.radius, mx); ++my) {
            if (!counts_as_wave(mx, my)) continue;
            const std::size_t at = waves.middle(mx) + my;
            const long double cycles = static_cast<long double>(waves.cycles_per_s[at]) * t_s;
            const double phase =
                static_cast<double>(2.0L * std::numbers::pi_v<long double> * (cycles - std::floor(cycles)));
            const std::complex<double> turn = std::polar(1.0, phase);
            const std::complex<double> forward(waves.forward_re[at], waves.forward_im[at]);
            const std::complex<double> backward(waves.backward_re[at], waves.backward_im[at]);
            modes.push_back({mx, my, 2.0 * kPi / waves.size_m * std::hypot(mx, my),
                             2.0 * kPi * waves.cycles_per_s[at],
                             forward * std::conj(turn) + backward * turn});
        }
    return modes;
}

// η at one point: the direct sum over every mode of one cascade, weighted by the footprint's filter.
inline double direct_height(const std::vector<Mode>& modes, double size_m, glm::dvec2 x,
                            double footprint_m = 0.0) {
    double sum = 0.0;
    for (const Mode& mode : modes) {
        const double phase = 2.0 * kPi * (mode.mx * x.x + mode.my * x.y) / size_m;
        sum += 2.0 * FootprintFilter{}.weight(mode.k, footprint_m) *
               (mode.height.real() * std::cos(phase) - mode.height.imag() * std::sin(phase));
    }
    return sum;
}

template <class Values, class Of>
double mean_of(const Values& values, Of&& of) {
    double sum = 0.0;
    for (const auto& value : values) sum += static_cast<double>(of(value));
    return sum / static_cast<double>(values.size());
}

struct Estimate {
    double mean = 0.0, standard_error = 0.0;
};
inline Estimate estimate(const std::vector<double>& values) {
    const double n = static_cast<double>(values.size());
    const double mean = mean_of(values, [](double v) { return v; });
    const double variance =
        mean_of(values, [&](double v) { return (v - mean) * (v - mean); }) * n / (n - 1.0);
    return {mean, std::sqrt(variance / n)};
}

}  // namespace pelagic::test
