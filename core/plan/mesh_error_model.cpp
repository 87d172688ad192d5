#include "core/plan/mesh_error_model.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/base/constants.h"
#include "core/plan/choppiness.h"
#include "core/plan/filter.h"
#include "core/spectrum/gauss.h"
#include "core/surface/view.h"

namespace pelagic {
namespace {

constexpr int kDirections = 16;  // of each wavenumber, over the circle

double sinc(double x) {
    return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

// What a basis does to a wave whose phase moves by a and b from point to point.
struct Response {
    double overlap, power;  // A and B
};

Response of_triangles(double a, double b) {
    return {sinc(0.5 * a) * sinc(0.5 * b) * sinc(0.5 * (a + b)),
            0.5 + (std::cos(a) + std::cos(b) + std::cos(a + b)) / 6.0};
}

Response of_spline(double a) {
    const double inverse = 3.0 / (2.0 + std::cos(a)), s = sinc(0.5 * a);
    const double power =
        (2416.0 + 2382.0 * std::cos(a) + 240.0 * std::cos(2.0 * a) + 2.0 * std::cos(3.0 * a)) / 5040.0;
    return {s * s * s * s * inverse, power * inverse * inverse};
}

Response of_limit_surface(double a, double b) {
    const Response across = of_spline(a), along = of_spline(b);
    return {across.overlap * along.overlap, across.power * along.power};
}

}  // namespace

MeshErrorModel::MeshErrorModel(const PreparedScene& prepared) {
    const DirectionalSpectrum& spectrum = prepared.spectrum;
    if (!(spectrum.m0() > 0.0)) return;
    const double height_m2 = 16.0 * spectrum.m0();
    const Choppiness choppiness = Choppiness::asked(prepared.scene).built();
    const auto& rule = GaussLegendre<3>::rule();
    const auto add = [&](double from, double to, double by) {
        for (std::size_t node = 0; node < rule.node.size(); ++node) {
            const double half = 0.5 * (to - from);
            const double k = from + half * (1.0 + rule.node[node]);
            const double moved = by * choppiness.largest() * spectrum.dispersion().horizontal_ratio(k);
            const double share = half * rule.weight[node] * (1.0 + moved * moved) / height_m2;
            for (int d = 0; d < kDirections; ++d) {
                const double theta0 = kTwoPi * d / kDirections, theta1 = kTwoPi * (d + 1) / kDirections;
                const double energy = share * spectrum.arc(k, theta0, theta1),
                             theta = 0.5 * (theta0 + theta1);
                if (energy > 0.0) waves_.push_back({k * std::cos(theta), k * std::sin(theta), k, energy});
            }
        }
    };
    choppiness.for_panels(spectrum, 0.0, std::numeric_limits<double>::infinity(), add);
}

double MeshErrorModel::error(double cell_m, double pixel_m, Drawn drawn) const {
    const FootprintFilter filter;
    double sum = 0.0;
    for (const Wave& wave : waves_) {
        const double resolved = filter.weight(wave.k, cell_m), seen = filter.weight(wave.k, pixel_m);
        if (resolved == 0.0) {
            sum += wave.energy * seen * seen;
            continue;
        }
        const double a = wave.kx * cell_m, b = wave.ky * cell_m;
        const Response response = drawn == Drawn::Triangles ? of_triangles(a, b) : of_limit_surface(a, b);
        sum += wave.energy * (seen * seen - 2.0 * seen * resolved * response.overlap +
                              resolved * resolved * response.power);
    }
    return std::sqrt(std::max(sum, 0.0));
}

// Between half octaves of the cell, linearly in its logarithm; the pixel at the nearest octave below the cell.
double MeshErrorModel::tabled(double cell_m, double pixel_m, Drawn drawn) const {
    constexpr int kNoPixel = -64;
    const double at = 2.0 * std::log2(cell_m);
    const int below = static_cast<int>(std::floor(at));
    const int octaves =
        pixel_m > 0.0 ? static_cast<int>(std::lround(std::clamp(std::log2(pixel_m / cell_m), -12.0, 4.0)))
                      : kNoPixel;
    const auto node = [&](int i) {
        const auto [found, is_new] = table_.try_emplace({i, octaves, drawn}, 0.0);
        const double cell = std::exp2(0.5 * i);
        if (is_new) found->second = error(cell, octaves == kNoPixel ? 0.0 : std::ldexp(cell, octaves), drawn);
        return found->second;
    };
    return std::lerp(node(below), node(below + 1), at - below);
}

double MeshErrorModel::error(const RestSurface& surface, const Camera& camera,
                             std::span<const int> frames) const {
    const Drawn drawn = surface.fitted() ? Drawn::LimitSurface : Drawn::Triangles;
    if (!surface.needs(frames).own_footprints) return error(surface.needs(frames).finest_cell_m, 0.0, drawn);
    double largest = 0.0;
    for (const int frame : frames) {
        RestPoints<float> points;
        surface.points_at(frame, points);
        const View view = view_at(camera, frame);
        double sum = 0.0;
        for (std::size_t i = 0; i < points.rest_m.size(); ++i) {
            const glm::dvec3 place(glm::dvec2(points.rest_m[i]) + points.origin_m,
                                   points.height_m.empty() ? 0.0 : points.height_m[i]);
            const double pixel_m =
                surface.shaped_by(frame) ? view.pixel_tangent() * glm::length(place - view.position_m) : 0.0;
            // An ellipse counts as the circle of its area.
            const double cell_m = points.cell_m[i];
            const double long_m =
                points.cell_axis_m.empty() ? 0.0 : glm::length(glm::dvec2(points.cell_axis_m[i]));
            const double off = tabled(std::sqrt(cell_m * std::max(cell_m, long_m)), pixel_m, drawn);
            sum += off * off;
        }
        largest = std::max(
            largest, std::sqrt(sum / static_cast<double>(std::max<std::size_t>(points.rest_m.size(), 1))));
    }
    return largest;
}

}  // namespace pelagic
