#include "core/evaluate/evaluate.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/plan/tables.h"
#include "core/waves/spline.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

template <class T>
using Sums = std::array<T, kFieldCount>;

// A point's place on a ladder of footprints: (1 − t) of the lower rung and t of the next.
template <class T>
struct Rung {
    std::size_t lower = 0;
    T t = T(0);
};

template <class T>
Rung<T> rung_of(const std::vector<double>& ladder_m, const Strided<const T>& footprint_m, std::size_t point) {
    if (!footprint_m || ladder_m.size() == 1) return {};
    const double wanted = std::min(static_cast<double>(footprint_m[point]), ladder_m.back());
    if (!(wanted > ladder_m.front())) return {};  // the finest rung, for a footprint that is no number, too
    const auto above = std::upper_bound(ladder_m.begin() + 1, ladder_m.end() - 1, wanted);
    const std::size_t upper = static_cast<std::size_t>(above - ladder_m.begin());
    const double lower_m = ladder_m[upper - 1], upper_m = ladder_m[upper];
    return {upper - 1, static_cast<T>((wanted - lower_m) / (upper_m - lower_m))};
}

// One grid, ready to be read.
template <class T>
struct Reader {
    const Frame<T>* frame;
    int cascade, grid_index;
    const Grid* grid;
    double nodes_per_m, origin_nodes_x, origin_nodes_y;
};

// Adds weight × (the grid's fields) at a point; cell fields by one weight, pixel fields by the other.
template <int P, class T>
void add_spline(const Reader<T>& reader, glm::dvec2 node, const Sums<T>& weight, Sums<T>& sums) {
    const int n = reader.grid->resolution;
    const double base_x = std::floor(node.x), base_y = std::floor(node.y);
    T wx[P], wy[P];
    bspline_weights<P, T>(static_cast<T>(node.x - base_x), wx);
    bspline_weights<P, T>(static_cast<T>(node.y - base_y), wy);
    std::size_t column[P], row[P];
    for (int i = 0; i < P; ++i) {
        const int offset = i - P / 2 + 1;
        column[i] = static_cast<std::size_t>((static_cast<int>(base_x) + offset + n) % n);
        row[i] = static_cast<std::size_t>((static_cast<int>(base_y) + offset + n) % n) *
                 static_cast<std::size_t>(n);
    }
    for (std::size_t t = 0; t < reader.grid->transforms.size(); ++t) {
        const auto [first, second] = reader.grid->transforms[t];
        const T first_weight = weight[index(*first)], second_weight = second ? weight[index(*second)] : T(0);
        if (first_weight == T(0) && second_weight == T(0)) continue;
        const std::complex<T>* samples =
            reader.frame->samples(reader.cascade, reader.grid_index, static_cast<int>(t));
        T real = T(0), imaginary = T(0);
        for (int j = 0; j < P; ++j) {
            T row_real = T(0), row_imaginary = T(0);
            for (int i = 0; i < P; ++i) {
                const std::complex<T> value = samples[row[j] + column[i]];
                row_real += wx[i] * value.real();
                row_imaginary += wx[i] * value.imag();
            }
            real += wy[j] * row_real;
            imaginary += wy[j] * row_imaginary;
        }
        sums[index(*first)] += first_weight * real;
        if (second) sums[index(*second)] += second_weight * imaginary;
    }
}

template <class T>
void add_node(const Reader<T>& reader, glm::dvec2 node, const Sums<T>& weight, Sums<T>& sums) {
    const int n = reader.grid->resolution;
    const auto column = static_cast<std::size_t>(static_cast<int>(std::lround(node.x)) % n);
    const auto row = static_cast<std::size_t>(static_cast<int>(std::lround(node.y)) % n);
    for (std::size_t t = 0; t < reader.grid->transforms.size(); ++t) {
        const auto [first, second] = reader.grid->transforms[t];
        const std::complex<T> value =
            reader.frame->samples(reader.cascade, reader.grid_index,
                                  static_cast<int>(t))[row * static_cast<std::size_t>(n) + column];
        sums[index(*first)] += weight[index(*first)] * value.real();
        if (second) sums[index(*second)] += weight[index(*second)] * value.imag();
    }
}

template <class T>
void add_grid(const Reader<T>& reader, glm::dvec2 relative_m, int taps, const Sums<T>& weight,
              Sums<T>& sums) {
    const double n = reader.grid->resolution;
    const auto wrap = [n](double nodes) {
        const double inside = nodes - n * std::floor(nodes / n);
        // −1e-20 rounds up to n itself; a place that is no number, or so far that nothing of it is left,
        // becomes 0.
        return inside >= 0.0 && inside < n ? inside : 0.0;
    };
    const glm::dvec2 node(wrap(reader.origin_nodes_x + relative_m.x * reader.nodes_per_m),
                          wrap(reader.origin_nodes_y + relative_m.y * reader.nodes_per_m));
    if (reader.grid->sampling == Sampling::Nodes)
        add_node(reader, node, weight, sums);
    else if (taps == 6)
        add_spline<6>(reader, node, weight, sums);
    else
        add_spline<4>(reader, node, weight, sums);
}

// What the pixel footprint hides: the whole spectrum less what passes, never negative.
struct Hidden {
    double xx, yy, xy;
    HiddenStrain<double> strain;
};

template <class T>
Hidden hidden_at(const Sea<T>& sea, int query, const Rung<T>& rung) {
    const QueryStatistics& statistics = sea.statistics(query);
    const SpectralMoments& total = statistics.whole;
    const double t = static_cast<double>(rung.t);
    // ((1−t) w_a + t w_b)², expanded.
    const auto resolved = [&](double SpectralMoments::*m) {
        double sum = (1.0 - t) * (1.0 - t) * (statistics.resolved[rung.lower].*m);
        if (t > 0.0)
            sum += 2.0 * t * (1.0 - t) * (statistics.resolved_next[rung.lower].*m) +
                   t * t * (statistics.resolved[rung.lower + 1].*m);
        return sum;
    };
    const auto variance = [&](double SpectralMoments::*m) { return std::max(total.*m - resolved(m), 0.0); };
    const auto covariance = [&](double SpectralMoments::*m, double a, double b) {
        const double bound = std::sqrt(a * b);
        return std::clamp(total.*m - resolved(m), -bound, bound);
    };
    using M = SpectralMoments;
    Hidden hidden{};
    hidden.xx = variance(&M::xx);
    hidden.yy = variance(&M::yy);
    hidden.xy = covariance(&M::xy, hidden.xx, hidden.yy);
    HiddenStrain<double>& v = hidden.strain;
    v.xxxx = variance(&M::xxxx);
    v.yyyy = variance(&M::yyyy);
    v.xxyy = std::min(variance(&M::xxyy), std::sqrt(v.xxxx * v.yyyy));
    v.xxxy = covariance(&M::xxxy, v.xxxx, v.xxyy);
    v.xyyy = covariance(&M::xyyy, v.yyyy, v.xxyy);
    return hidden;
}

template <class T>
ProductSet given_by(const Results<T>& results) {
    ProductSet given;
    given[index(Product::Position)] = static_cast<bool>(results.position);
    given[index(Product::Displacement)] = static_cast<bool>(results.displacement);
    given[index(Product::Normal)] = static_cast<bool>(results.normal);
    given[index(Product::Velocity)] = static_cast<bool>(results.velocity);
    given[index(Product::SlopeVariance)] = static_cast<bool>(results.slope_variance);
    given[index(Product::JacobianMoments)] = static_cast<bool>(results.jacobian);
    given[index(Product::Coverage)] = static_cast<bool>(results.coverage);
    return given;
}

}  // namespace

template <class T>
void evaluate(const Frame<T>& frame, int query_index, const Points<T>& points, const Results<T>& results) {
    using Vec3 = glm::vec<3, T>;
    const Sea<T>& sea = frame.sea();
    const Plan& plan = sea.plan();
    const PlannedQuery& planned = plan.queries.at(query_index);
    const Query& query = planned.query;
    if (!frame.is_set()) throw std::invalid_argument("the frame has no time yet: call set() first");
    const ProductSet given = given_by(results);
    for (const ProductRow& row : kProductTable)
        if (given[index(row.product)] && !query.products[index(row.product)])
            throw std::invalid_argument("query \"" + query.name + "\" does not hold \"" + row.name +
                                        "\": ask for it when the plan is made");

    const FieldSet cell_group = cell_fields();
    const bool jacobian_wanted = results.jacobian || results.coverage;
    const bool hidden_wanted = jacobian_wanted || results.slope_variance;
    const T threshold = static_cast<T>(sea.whitecap_threshold());
    const bool uniform = !points.pixel_m || query.pixel_m.size() == 1;
    const Hidden uniform_hidden =
        uniform && hidden_wanted ? hidden_at(sea, query_index, Rung<T>{}) : Hidden{};

    const auto reader_of = [&](int cascade, int level) {
        const CascadePlan& cascade_plan = plan.cascades[cascade];
        const int grid_index = cascade_plan.grid_of_level[level];
        Reader<T> reader{&frame, cascade, grid_index, nullptr, 0.0, 0.0, 0.0};
        if (grid_index < 0) return reader;
        reader.grid = &cascade_plan.grids[grid_index];
        reader.nodes_per_m = reader.grid->resolution / cascade_plan.size_m;
        // The origin's own phase within the tile, in double: the rest of the way is short.
        const auto phase = [&](double x) {
            const double tiles = x / cascade_plan.size_m;
            return (tiles - std::floor(tiles)) * reader.grid->resolution;
        };
        reader.origin_nodes_x = phase(points.origin_m.x);
        reader.origin_nodes_y = phase(points.origin_m.y);
        return reader;
    };
    // By level, cascade after cascade; a reader without a grid has nothing to add.
    std::vector<std::vector<Reader<T>>> readers(plan.levels.size());
    for (const std::vector<int>* levels : {&planned.cell_levels, &planned.pixel_levels})
        for (int level : *levels)
            if (readers[level].empty())
                for (int c = 0; c < static_cast<int>(plan.cascades.size()); ++c)
                    if (const Reader<T> reader = reader_of(c, level); reader.grid)
                        readers[level].push_back(reader);

    const FieldSet needed = fields_of(given);
    const auto evaluate_point = [&](std::size_t i) {
        const glm::vec<2, T> rest = points.rest_m[i];
        const Rung<T> cell = rung_of(query.cell_m, points.cell_m, i),
                      pixel = rung_of(query.pixel_m, points.pixel_m, i);
        Sums<T> sums{};
        const auto read = [&](int level, T cell_weight, T pixel_weight) {
            if (readers[level].empty() || (cell_weight == T(0) && pixel_weight == T(0))) return;
            Sums<T> weight;
            for (std::size_t f = 0; f < kFieldCount; ++f)
                weight[f] = !needed[f] ? T(0) : cell_group[f] ? cell_weight : pixel_weight;
            for (const Reader<T>& reader : readers[level])
                add_grid(reader, glm::dvec2(rest), plan.knobs.spline_taps, weight, sums);
        };
        if (planned.cell_levels == planned.pixel_levels && cell.lower == pixel.lower && cell.t == pixel.t) {
            read(planned.cell_levels[cell.lower], T(1) - cell.t, T(1) - cell.t);
            if (cell.t > T(0)) read(planned.cell_levels[cell.lower + 1], cell.t, cell.t);
        } else {
            read(planned.cell_levels[cell.lower], T(1) - cell.t, T(0));
            if (cell.t > T(0)) read(planned.cell_levels[cell.lower + 1], cell.t, T(0));
            read(planned.pixel_levels[pixel.lower], T(0), T(1) - pixel.t);
            if (pixel.t > T(0)) read(planned.pixel_levels[pixel.lower + 1], T(0), pixel.t);
        }

        const auto at = [&](Field field) { return sums[index(field)]; };
        const Vec3 displacement(at(Field::Dx), at(Field::Dy), at(Field::Height));
        if (results.displacement) results.displacement[i] = displacement;
        if (results.position) results.position[i] = displacement + Vec3(rest, T(0));
        if (results.velocity)
            results.velocity[i] = Vec3(at(Field::VelocityX), at(Field::VelocityY), at(Field::VelocityZ));
        const T dxx = at(Field::Dxx), dyy = at(Field::Dyy), dxy = at(Field::Dxy);
        if (results.normal) {
            // T_x × T_y, T_x = (1 + Dxx, Dxy, ηx), T_y = (Dxy, 1 + Dyy, ηy): its z is J, finite however J
            // vanishes.
            const T sx = at(Field::SlopeX), sy = at(Field::SlopeY);
            const Vec3 n(dxy * sy - sx * (T(1) + dyy), sx * dxy - sy * (T(1) + dxx),
                         (T(1) + dxx) * (T(1) + dyy) - dxy * dxy);
            const T length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
            // Both tangents parallel: no normal exists; up is as good as any.
            results.normal[i] = length > T(0) ? n / length : Vec3(T(0), T(0), T(1));
        }
        if (!hidden_wanted) return;
        const Hidden hidden = uniform ? uniform_hidden : hidden_at(sea, query_index, pixel);
        if (results.slope_variance)
            results.slope_variance[i] =
                Vec3(static_cast<T>(hidden.xx), static_cast<T>(hidden.yy), static_cast<T>(hidden.xy));
        if (!jacobian_wanted) return;
        const HiddenStrain<double>& v = hidden.strain;
        const JacobianMoments<T> j =
            jacobian_moments<T>(dxx, dyy, dxy,
                                {static_cast<T>(v.xxxx), static_cast<T>(v.xxxy), static_cast<T>(v.xxyy),
                                 static_cast<T>(v.xyyy), static_cast<T>(v.yyyy)});
        if (results.jacobian) results.jacobian[i] = Vec3(j.mean, j.variance, j.third);
        if (results.coverage) results.coverage[i] = coverage(j, threshold, plan.knobs.third_moment);
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.count, 512),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) evaluate_point(i);
                      });
}

template void evaluate(const Frame<float>&, int, const Points<float>&, const Results<float>&);
template void evaluate(const Frame<double>&, int, const Points<double>&, const Results<double>&);

}  // namespace pelagic
