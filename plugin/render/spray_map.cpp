#include "plugin/render/spray_map.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/constants.h"
#include "core/effects/spray.h"
#include "core/evaluate/places.h"
#include "core/plan/spray.h"
#include "core/plan/wind_profile.h"
#include "core/surface/earth.h"
#include "core/surface/footprint_levels.h"
#include "plugin/render/seen_drops.h"

namespace pelagic {
namespace {

constexpr int kQuery = 0;  // the plan's only one

// Of drops of some 100 µm: half of what they take is bent by a fraction of a degree, here into a lobe about as narrow as sight and
// the map tell apart; the rest by refraction. Together 0.85, as Hansen and Travis 1974 have it.
constexpr glm::vec2 kTornForward{0.95f, 0.75f};

// Azimuths from the first, counter-clockwise; the whole circle where the span is 2π.
struct Span {
    double first_rad = 0.0, rad = kTwoPi;
};

bool sees(const View& view, const glm::dvec3& direction) {
    const double ahead = glm::dot(direction, view.forward);
    const glm::dvec2 half = view.half_tangents(), middle = view.middle_tangents();
    return ahead > 0.0 && std::abs(glm::dot(direction, view.right) - middle.x * ahead) <= half.x * ahead &&
           std::abs(glm::dot(direction, view.up) - middle.y * ahead) <= half.y * ahead;
}

// Without a pole in the picture the azimuth is continuous in it, and its extremes are on the edge.
Span seen_azimuths(const View& view) {
    constexpr Span kAll{};
    constexpr int kSteps = 64;  // along each side
    if (sees(view, {0.0, 0.0, 1.0}) || sees(view, {0.0, 0.0, -1.0})) return kAll;
    const glm::dvec2 size(view.resolution);
    const std::array<glm::dvec2, 5> corners{glm::dvec2(0.0), glm::dvec2(size.x, 0.0), size,
                                            glm::dvec2(0.0, size.y), glm::dvec2(0.0)};
    std::optional<double> before;
    double turned = 0.0, least = 0.0, most = 0.0, first = 0.0;
    for (std::size_t side = 0; side + 1 < corners.size(); ++side)
        for (int i = 0; i <= kSteps; ++i) {
            const glm::dvec3 to =
                view.direction(glm::mix(corners[side], corners[side + 1], double(i) / kSteps));
            constexpr double kBesideAPole = 0.02;
            if (std::hypot(to.x, to.y) < kBesideAPole) return kAll;
            const double azimuth = std::atan2(to.y, to.x);
            if (before)
                turned += std::remainder(azimuth - *before, kTwoPi);
            else
                first = azimuth;
            before = azimuth;
            least = std::min(least, turned);
            most = std::max(most, turned);
        }
    const double margin = 0.02 * (most - least) + 1e-3;
    if (most - least + 2.0 * margin >= kTwoPi) return kAll;
    return {first + least - margin, most - least + 2.0 * margin};
}

// The steepest way down that the picture shows, as a slope.
double steepest(const View& view) {
    if (sees(view, {0.0, 0.0, -1.0})) return std::numeric_limits<double>::infinity();
    const glm::dvec2 size(view.resolution);
    double most = 1e-3;
    constexpr int kSteps =
        16;  // along each side: without the nadir in the picture it is somewhere on the edge
    for (int i = 0; i <= kSteps; ++i) {
        const glm::dvec2 along = size * (static_cast<double>(i) / kSteps);
        for (const glm::dvec2 at : {glm::dvec2(along.x, 0.0), glm::dvec2(along.x, size.y),
                                    glm::dvec2(0.0, along.y), glm::dvec2(size.x, along.y)}) {
            const glm::dvec3 to = view.direction(at);
            most = std::max(most, -to.z / std::max(std::hypot(to.x, to.y), 1e-9));
        }
    }
    return most;
}

// Horizontal distances of the rows.
struct Radii {
    double first_m, last_m;
};
Radii radii_of(const View& view, double curvature_per_m) {
    const double eye_m = view.position_m.z;
    constexpr double kNearest_m = 0.5, kPart = 0.2;  // of the eye's height: rays nearer by are steep
    constexpr double kLayer_m = 20.0;                // crests and the spray over them
    constexpr double kFlat_m = 2.5e4, kOfHeight = 20.0;
    const double height_m = std::max(eye_m, 0.0);
    double last_m = std::max(kFlat_m, kOfHeight * height_m);
    if (curvature_per_m > 0.0) {
        const auto horizon_rad = [&](double above_m) {
            return std::acos(1.0 / (1.0 + above_m * curvature_per_m));
        };
        constexpr double kMost_rad = 1.4;  // beyond it rows would lie one above the other
        last_m =
            std::sin(std::min(horizon_rad(height_m) + horizon_rad(kLayer_m), kMost_rad)) / curvature_per_m;
    }
    double first_m = std::max(kPart * height_m, kNearest_m);
    // An eye above the layer sees nothing of it nearer than what its steepest ray meets.
    constexpr double kAbove_m = 2.0 * kLayer_m, kSlack = 0.5;
    if (height_m > kAbove_m) first_m = std::max(first_m, kSlack * height_m / steepest(view));
    return {std::min(first_m, 0.1 * last_m), last_m};
}

}  // namespace

SprayMapSize spray_map_size(int picture_width) {
    // Rows are mostly farther apart than columns: what lies aslant crosses many of them.
    constexpr double kColumns = 0.2, kRows = 0.8;  // of the picture's width
    constexpr int kNarrowest = 160, kWidest = 1280, kMostRows = 512;
    const int width = std::clamp(picture_width, kNarrowest, kWidest);
    return {.columns = static_cast<int>(kColumns * width),
            .rows = std::min(static_cast<int>(kRows * width), kMostRows)};
}

namespace {

// Texels that are computed at once.
constexpr int kBand = 4096;
int rows_of_band(SprayMapSize size) {
    return std::clamp(kBand / size.columns, 1, size.rows);
}

}  // namespace

std::size_t spray_map_bytes(SprayMapSize size) {
    // In double, of a band: places, points at rest, footprints and their axes, displacement, what breaks, a residual; cells, extinctions,
    // and most of that once more for what lies upwind. Of all texels: shares and lifts, the height, and the texel.
    const auto columns = static_cast<std::size_t>(size.columns), rows = static_cast<std::size_t>(size.rows);
    return columns * (static_cast<std::size_t>(rows_of_band(size)) * 44 * sizeof(double) +
                      rows * (sizeof(glm::dvec4) + sizeof(float) + 2 * sizeof(glm::vec4)));
}

Spray spray_by(const SprayLaw& law) {
    return {.is_torn = law.is_torn(),
            .scale_m = static_cast<float>((law.is_torn() ? law.haze : law.over_foam).scale_m),
            .step_m = static_cast<float>(law.ribbons.step_m),
            .haze_per_m = static_cast<float>(law.haze.extinction_per_m),
            .forward = law.is_torn() ? kTornForward : Spray{}.forward};
}

namespace {

SprayThreads threads_by(const SprayVeil& veil, const View& view) {
    if (!veil.is_torn()) return {};
    const glm::dvec2 downwind = veil.downwind(), eye_m(view.position_m);
    const glm::dvec2 at(glm::dot(eye_m, downwind) / kThreadLong_m,
                        (eye_m.y * downwind.x - eye_m.x * downwind.y) / kThreadBroad_m);
    const glm::dvec2 whole = glm::floor(at);
    const auto wrapped = [](double cell) { return cell - 65536.0 * std::floor(cell / 65536.0); };
    const WindProfile wind(veil.wind_speed_mps());
    const auto [young, old] = veil.generations();
    return {.cell = {wrapped(whole.x), wrapped(whole.y), at.x - whole.x, at.y - whole.y},
            .wind = glm::vec4(
                glm::dvec4(downwind, wind.friction_mps() / WindProfile::kKarman, 1.0 / wind.roughness_m())),
            .born = glm::vec4(glm::dvec4(young.age_s, old.age_s, young.weight, old.weight)),
            .names = {static_cast<float>(young.name), static_cast<float>(old.name)},
            .per_m = static_cast<float>(veil.law().ribbons.extinction_per_m.x * veil.whole()),
            .pixel_rad = static_cast<float>(view.pixel_tangent())};
}

// The mean of a line's values round each of them, by a normal distribution of this standard deviation [values]: of those that
// there are, or round a circle.
void smooth_line(std::vector<glm::dvec4>& line, double sigma, bool is_circle) {
    constexpr double kFarthest = 2.5;  // standard deviations
    const auto count = static_cast<int>(line.size());
    const int reach = std::min(static_cast<int>(std::ceil(kFarthest * sigma)), (count - 1) / 2);
    std::vector<double> weights;
    for (int i = 0; i <= reach; ++i) weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    const std::vector<glm::dvec4> from = line;
    for (int i = 0; i < count; ++i) {
        glm::dvec4 sum(0.0);
        double whole = 0.0;
        for (int by = -reach; by <= reach; ++by) {
            int at = i + by;
            if (is_circle)
                at = (at + count) % count;
            else if (at < 0 || at >= count)
                continue;
            const double weight = weights[static_cast<std::size_t>(std::abs(by))];
            sum += weight * from[static_cast<std::size_t>(at)];
            whole += weight;
        }
        line[static_cast<std::size_t>(i)] = sum / whole;
    }
}

// As wide in both directions as the map's places are apart in the one where they are farther apart. sigma: in columns, in rows.
void smooth_map(std::vector<glm::dvec4>& map, SprayMapSize size, glm::dvec2 sigma, bool is_circle) {
    const auto columns = static_cast<std::size_t>(size.columns), rows = static_cast<std::size_t>(size.rows);
    tbb::parallel_for(std::size_t{0}, columns, [&](std::size_t column) {
        std::vector<glm::dvec4> line;
        for (std::size_t row = 0; row < rows; ++row) line.push_back(map[row * columns + column]);
        smooth_line(line, sigma.y, false);
        for (std::size_t row = 0; row < rows; ++row) map[row * columns + column] = line[row];
    });
    tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
        const auto begin = map.begin() + static_cast<std::ptrdiff_t>(row * columns);
        const auto end = begin + static_cast<std::ptrdiff_t>(columns);
        // The last column of a circle is the first.
        std::vector<glm::dvec4> line(begin, is_circle ? end - 1 : end);
        smooth_line(line, sigma.x, is_circle);
        std::copy(line.begin(), line.end(), begin);
        if (is_circle) *(end - 1) = *begin;
    });
}

}  // namespace

template <class T>
Spray make_spray_map(const Frame<T>& frame, const View& view, const ProjectedGridOptions& options,
                     SprayMapSize size, bool drops) {
    const SprayVeil veil(frame);
    if (veil.empty()) return {};
    const double curvature = options.curvature_per_m;
    const Span span = seen_azimuths(view);
    const Radii radii = radii_of(view, curvature);
    const double step = std::log(radii.last_m / radii.first_m) / (size.rows - 1);
    const double turn = span.rad / (size.columns - 1);
    const SprayLaw& law = veil.law();
    const bool of_foam = !veil.is_torn();
    Spray spray = spray_by(law);
    spray.columns = size.columns;
    spray.rows = size.rows;
    spray.azimuth = glm::vec2(glm::dvec2(std::cos(span.first_rad), std::sin(span.first_rad)));
    spray.columns_per_rad = static_cast<float>(1.0 / turn);
    spray.first_m = static_cast<float>(radii.first_m);
    spray.row_step = static_cast<float>(step);
    spray.eye_m = static_cast<float>(view.position_m.z);
    spray.threads = threads_by(veil, view);

    const auto columns = static_cast<std::size_t>(size.columns), rows = static_cast<std::size_t>(size.rows);
    const std::size_t count = columns * rows;
    constexpr double kSmoothest_m = 2.0;
    double finest_m = 0.0;
    if (frame.sea().plan().queries[kQuery].query.cell_m.size() > 1) {
        // The same levels whichever other frames the plan is for.
        const ProjectedGridNeeds own = projected_grid_needs(view, options);
        finest_m = first_level_m(std::max(own.finest_cell_m, own.finest_pixel_m));
    }
    const PreparedQuery<T> query(frame, kQuery, products(Product::Displacement, Product::Breaking),
                                 glm::dvec2(view.position_m));
    // How thick such ribbons are straight up, in steps.
    const auto thickness = [&](glm::dvec3 shares) {
        return SprayRibbons{.extinction_per_m = law.ribbons.extinction_per_m * shares}.optical_thickness();
    };

    std::vector<float> surface_m(count);
    std::vector<glm::dvec4> veiled(count);  // shares, and lifts times thickness
    std::vector<double> thicker(rows, law.with_drops());
    const auto band_rows = static_cast<std::size_t>(rows_of_band(size));
    using Vec = glm::vec<2, T>;
    std::vector<Vec> places, axes;
    std::vector<T> widths, spreads, breaking;
    std::vector<double> cells, lifts_m;
    std::vector<glm::vec<3, T>> displacement;
    std::vector<glm::dvec3> shares;
    for (std::size_t first = 0; first < rows; first += band_rows) {
        const std::size_t in_band = columns * std::min(band_rows, rows - first);
        places.clear();
        axes.clear();
        widths.clear();
        spreads.clear();
        cells.clear();
        for (std::size_t row = first; row < std::min(first + band_rows, rows); ++row) {
            const double radius_m = radii.first_m * std::exp(step * static_cast<double>(row));
            // Along the earth.
            const double arc_m = curvature > 0.0 ? std::asin(radius_m * curvature) / curvature : radius_m;
            const double away_m = arc_m * step, beside_m = arc_m * turn;
            if (drops)
                thicker[row] =
                    std::lerp(law.with_drops(), 1.0, drops_share(std::hypot(arc_m, view.position_m.z)));
            const auto width = static_cast<T>(std::max(std::min(away_m, beside_m), finest_m));
            // Ribbons lie aslant: finer than rows are apart they would be combs and pillars.
            const double finest_ribbon_m = of_foam ? 0.0 : std::max(away_m, beside_m);
            for (int column = 0; column < size.columns; ++column) {
                const double azimuth = span.first_rad + turn * column;
                const Vec away(glm::dvec2(std::cos(azimuth), std::sin(azimuth)));
                places.push_back(static_cast<T>(arc_m) * away);
                widths.push_back(width);
                spreads.push_back(
                    std::max({width, static_cast<T>(kSmoothest_m), static_cast<T>(finest_ribbon_m)}));
                cells.push_back(1.5 * finest_ribbon_m);
                axes.push_back(away_m >= beside_m ? static_cast<T>(away_m) * away
                                                  : static_cast<T>(beside_m) * Vec(-away.y, away.x));
            }
        }
        const Points<T> points{.origin_m = glm::dvec2(view.position_m),
                               .count = in_band,
                               .rest_m = {places.data()},
                               .cell_m = {widths.data()},
                               .pixel_m = {spreads.data()},
                               .cell_axis_m = {axes.data()},
                               .pixel_axis_m = {axes.data()}};
        // Texels are metres wide but beside the camera.
        constexpr PlaceSearch kSearch{.tolerance_m = 0.02, .most_steps = 16};
        displacement.resize(in_band);
        breaking.resize(in_band);
        shares.resize(in_band);
        lifts_m.resize(in_band);
        Results<T> results;
        results.set(Product::Displacement, {displacement.data()});
        results.set(Product::Breaking, {breaking.data()});
        evaluate_at(query, points, kSearch, results);
        veil.shares<T>(query, points, breaking, displacement, cells, shares, lifts_m);
        for (std::size_t i = 0; i < in_band; ++i) {
            const glm::dvec3 at(glm::dvec2(places[i]), static_cast<double>(displacement[i].z));
            surface_m[first * columns + i] = static_cast<float>(on_earth(at, curvature).z);
            veiled[first * columns + i] =
                glm::dvec4(shares[i], of_foam ? 0.0 : lifts_m[i] * thickness(shares[i]));
        }
    }
    // The noise that tears ribbons also shifts and folds them, finer than rows are apart. Aslant they would be a row of puffs, one
    // where they cross each row of the map: rays take them as linear between its places.
    if (!of_foam)
        smooth_map(veiled, size, glm::max(glm::dvec2(step / turn, turn / step), 1.0), span.rad >= kTwoPi);

    spray.texels.resize(of_foam ? count : 2 * count);
    spray.top_m = -std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
        spray.top_m = std::max(spray.top_m, surface_m[i]);
        const glm::dvec3 share(veiled[i]);
        if (of_foam) {
            spray.texels[i] = {surface_m[i], static_cast<float>(law.over_foam.extinction_per_m * share.x),
                               0.0f, 0.0f};
            continue;
        }
        const double thick = thickness(share),
                     lift = thick > 0.0
                                ? std::min(veiled[i].w / thick / law.ribbons.step_m, SprayRibbons::kMostLift)
                                : 0.0;
        spray.texels[i] = {surface_m[i],
                           glm::vec3(SprayRibbons::thinned(law.ribbons.extinction_per_m * share, lift) *
                                     thicker[i / columns] * law.ribbons.extinction_per_m * share)};
        spray.texels[count + i] = glm::vec4(static_cast<float>(lift), 0.0f, 0.0f, 0.0f);
    }
    return spray;
}

template Spray make_spray_map(const Frame<float>&, const View&, const ProjectedGridOptions&, SprayMapSize,
                              bool);
template Spray make_spray_map(const Frame<double>&, const View&, const ProjectedGridOptions&, SprayMapSize,
                              bool);

}  // namespace pelagic
