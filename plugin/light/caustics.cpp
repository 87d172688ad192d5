#include "plugin/light/caustics.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "core/base/build_watch.h"
#include "core/evaluate/evaluate.h"
#include "core/plan/plan.h"

namespace pelagic {
namespace {

constexpr double kIndex = 1.34;  // as kWaterIndex of fresnel.glsl
constexpr int kRowsAtOnce = 64;
constexpr int kParts = 4;   // of the sea, always as many, so that sums are the same on any number of threads
constexpr int kSplits = 4;  // of a cell's side: its light falls as so many points
constexpr double kLeastRise = 1e-3;  // of mirrored light, over its way
// Less, over a level sea's, doesn't make it more: waves are before what goes along them.
constexpr double kLeastRiseOfSun = 0.25;

// The sun as the waves refract or mirror it. `away`: the horizontal direction in which its light goes.
struct Beam {
    glm::dvec3 to_sun{0.0, 0.0, 1.0};
    glm::dvec2 away{1.0, 0.0};
    double tangent = 0.0;       // of its way below a level sea, or above it
    double cosine_there = 1.0;  // of that
    glm::dmat2 per_slope{1.0};  // how far a slope moves it on a floor 1 m deep
    double radius = 0.0;
    bool is_mirrored = false;
    double index = kIndex;  // that bends it
};

Beam beam_of(const SunThroughWaves& sun) {
    Beam beam;
    beam.to_sun = glm::dvec3(sun.to_sun);
    beam.radius = static_cast<double>(sun.angular_radius);
    const double level = glm::length(glm::dvec2(beam.to_sun));
    beam.away = level > 1e-6 ? -glm::dvec2(beam.to_sun) / level : glm::dvec2(1.0, 0.0);
    beam.is_mirrored = sun.is_mirrored;
    double bend = -2.0;  // a mirror turns a ray by twice its own angle
    if (beam.is_mirrored) {
        beam.index = 1.0;
        beam.cosine_there = std::max(beam.to_sun.z, kLeastRise);
        beam.tangent = level / beam.cosine_there;
    } else {
        const double sine = level / kIndex;
        beam.cosine_there = std::sqrt(1.0 - sine * sine);
        beam.tangent = sine / beam.cosine_there;
        // A slope s tilts the normal by −s and with it the ray by (c_t − c_i/n) s: along its plane and across it.
        bend = (beam.cosine_there - beam.to_sun.z / kIndex) / beam.cosine_there;
    }
    const glm::dmat2 along = glm::outerProduct(beam.away, beam.away);
    beam.per_slope = bend * (glm::dmat2(1.0) + beam.tangent * beam.tangent * along);
    return beam;
}

double transmitted(double cosine) {
    const double there = std::sqrt(1.0 - (1.0 - cosine * cosine) / (kIndex * kIndex));
    const double across = (cosine - kIndex * there) / (cosine + kIndex * there),
                 along = (there - kIndex * cosine) / (there + kIndex * cosine);
    return 1.0 - 0.5 * (across * across + along * along);
}

// Where a facet of that normal (unit) sends the light: the horizontal way per metre of depth or height. far: by how much it is no more than
// that from a level sea's, where the light is mirrored.
glm::dvec2 way_from(const Beam& beam, const glm::dvec3& n, double facing, double far) {
    if (beam.is_mirrored) {
        const glm::dvec3 ray = 2.0 * facing * n - beam.to_sun;
        const glm::dvec2 level = beam.tangent * beam.away,
                         aside = glm::dvec2(ray) / std::max(ray.z, kLeastRise) - level;
        return level + aside * std::min(far / std::max(glm::length(aside), 1e-12), 1.0);
    }
    const double there = std::sqrt(1.0 - (1.0 - facing * facing) / (kIndex * kIndex));
    const glm::dvec3 ray = -beam.to_sun / kIndex - (there - facing / kIndex) * n;
    return glm::dvec2(ray) / std::max(-ray.z, 0.05);
}

// The part of a beam that a facet mirrors onto an upright wall that faces it, over the level area through which it goes. None where it goes
// farther aside.
double mirrored_on(const Beam& beam, const glm::dvec3& n, double facing, double far) {
    const glm::dvec3 ray = 2.0 * facing * n - beam.to_sun;
    const double level = glm::length(glm::dvec2(ray));
    if (!(ray.z > kLeastRise) || glm::length(glm::dvec2(ray) / ray.z - beam.tangent * beam.away) > far)
        return 0.0;
    return (1.0 - transmitted(facing)) * level / std::max(ray.z, kLeastRiseOfSun * beam.to_sun.z);
}

// A slope moves mirrored light along its way the more, the less that rises: by how many times as much as that of a level sea, by powers of 2
// from ¼ to 4. Light of a width between two is a part of either's.
constexpr int kWidths = 5;
double width_of(const Beam& beam, double rise) {
    constexpr double kMiddle = kWidths / 2;
    return std::clamp(kMiddle + 2.0 * std::log2(beam.to_sun.z / std::max(rise, kLeastRise)), 0.0,
                      2.0 * kMiddle);
}
double part_of_width(double width, int of) {
    return std::max(1.0 - std::abs(width - of), 0.0);
}

// Where light falls, in a map's texels, and how much of it, by cells of the sea.
struct Falls {
    int columns = 0, rows = 0;  // of the cells; places have one more
    std::vector<glm::vec2> place;
    std::vector<float> light;
    std::vector<float> width;  // of mirrored light: width_of()
};

template <class T>
Falls falls_on(const CausticsMap& map, const Floor& floor, const Frame<T>& frame, int query, const Beam& beam,
               const CausticsOn& on, double margin_m, double range_m, const std::atomic<bool>* cancel) {
    const double depth_m = on.depth_m, far = margin_m / std::max(depth_m, 1e-9);
    const double s = map.texel_m;
    const glm::dvec2 right = map.along, up(-right.y, right.x);
    const int margin = static_cast<int>(std::ceil(margin_m / s));
    Falls falls{.columns = map.side + 2 * margin,
                .rows = map.side + 2 * margin,
                .place = {},
                .light = {},
                .width = {}};
    const auto width = static_cast<std::size_t>(falls.columns) + 1;
    falls.place.resize(width * (static_cast<std::size_t>(falls.rows) + 1));
    falls.light.resize(static_cast<std::size_t>(falls.columns) * static_cast<std::size_t>(falls.rows));
    if (beam.is_mirrored) falls.width.resize(falls.light.size());
    const glm::dvec2 from_m =
        map.from_m - depth_m * beam.tangent * beam.away - margin * s * right - margin * s * up;
    std::vector<glm::vec<2, T>> rest;
    std::vector<glm::vec<3, T>> position, normal;
    std::vector<glm::vec2> mirrored;  // what a square metre sends, and its width
    for (int row = 0; row < falls.rows; row += kRowsAtOnce) {
        stop_if(cancel);
        const int rows = std::min(kRowsAtOnce, falls.rows - row);
        const std::size_t count = width * (static_cast<std::size_t>(rows) + 1);
        rest.resize(count);
        position.resize(count);
        normal.resize(count);
        if (beam.is_mirrored) mirrored.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            rest[i] = glm::vec<2, T>(static_cast<double>(i % width) * s * right +
                                     static_cast<double>(i / width) * s * up);
        const glm::dvec2 origin = from_m + row * s * up;
        Results<T> results;
        results.set(Product::Position, {position.data()});
        results.set(Product::Normal, {normal.data()});
        const std::vector<T> pixels(count, static_cast<T>(s)),
            cells(count, static_cast<T>(std::max(s, on.finest_cell_m)));
        evaluate(frame, query,
                 Points<T>{.origin_m = origin,
                           .count = count,
                           .rest_m = {rest.data()},
                           .cell_m = {cells.data()},
                           .pixel_m = {pixels.data()}},
                 results);
        const std::size_t first = width * static_cast<std::size_t>(row);
        using Range = tbb::blocked_range<std::size_t>;
        tbb::parallel_for(Range(0, count, 1024), [&](const Range& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const glm::dvec3 n(normal[i]);
                if (beam.is_mirrored) {
                    const double facing = glm::dot(n, beam.to_sun);
                    if (facing > 0.0 && n.z > 0.0)
                        mirrored[i] = glm::vec2(facing / n.z * mirrored_on(beam, n, facing, far),
                                                width_of(beam, 2.0 * facing * n.z - beam.to_sun.z));
                    else
                        mirrored[i] = glm::vec2(0.0f);
                }
                const glm::dvec2 along = way_from(beam, n, std::max(glm::dot(n, beam.to_sun), 0.0), far);
                const glm::dvec2 at = origin + glm::dvec2(position[i]);
                const double height = static_cast<double>(position[i].z) - on.level_m;
                // The floor's height hardly changes over the way of the light.
                double local_m = depth_m;
                if (floor.has_depths())
                    local_m =
                        std::clamp(floor.depth_m(at + depth_m * along), depth_m - range_m, depth_m + range_m);
                const double way_m = beam.is_mirrored ? local_m - height : local_m + height;
                const glm::dvec2 hit = at + std::max(way_m, 0.0) * along - map.from_m;
                falls.place[first + i] = glm::vec2(glm::dvec2(glm::dot(hit, right), glm::dot(hit, up)) / s);
            }
        });
        tbb::parallel_for(0, rows, [&](int y) {
            for (int x = 0; x < falls.columns; ++x) {
                const std::size_t i = width * static_cast<std::size_t>(y) + static_cast<std::size_t>(x);
                // The cell's area by its diagonals, normal to it.
                const glm::dvec3 area = 0.5 * glm::cross(glm::dvec3(position[i + width + 1] - position[i]),
                                                         glm::dvec3(position[i + width] - position[i + 1]));
                const std::size_t cell =
                    static_cast<std::size_t>(falls.columns) * static_cast<std::size_t>(row + y) +
                    static_cast<std::size_t>(x);
                if (beam.is_mirrored) {
                    // By the corners' normals: their variance is known, and much of the light is that of steep ones.
                    float light = 0.0f, width_light = 0.0f;
                    for (const std::size_t corner : {i, i + 1, i + width, i + width + 1}) {
                        light += mirrored[corner].x;
                        width_light += mirrored[corner].x * mirrored[corner].y;
                    }
                    // Of a folded sheet what lies upside down sends none.
                    falls.light[cell] = 0.25f * std::max(static_cast<float>(area.z), 0.0f) * light;
                    if (light > 0.0f) falls.width[cell] = width_light / light;
                    continue;
                }
                const double across = glm::dot(area, beam.to_sun), size = glm::length(area);
                double light = 0.0;
                if (across > 0.0) light = across * transmitted(std::min(across / size, 1.0));
                falls.light[cell] = static_cast<float>(light);
            }
        });
    }
    return falls;
}

// Adds each cell's light, of one width where there are some, to the texels on which it falls, over `mean`, that of a cell.
void gather(const Falls& falls, const CausticsMap& map, double mean, int width_there = 0) {
    const auto scale = static_cast<float>(1.0 / (mean * kSplits * kSplits));
    const auto width = static_cast<std::size_t>(falls.columns) + 1;
    // With a texel round the map, for light that falls on its edge.
    const auto side = static_cast<std::size_t>(map.side), padded = side + 2;
    std::array<std::vector<float>, kParts> parts;
    tbb::parallel_for(0, kParts, [&](int part) {
        std::vector<float>& sums = parts[static_cast<std::size_t>(part)];
        sums.assign(padded * padded, 0.0f);
        const int first = falls.rows * part / kParts, last = falls.rows * (part + 1) / kParts;
        const auto most = static_cast<float>(side + 1);
        for (int y = first; y < last; ++y)
            for (int x = 0; x < falls.columns; ++x) {
                const std::size_t i = width * static_cast<std::size_t>(y) + static_cast<std::size_t>(x);
                const std::size_t cell =
                    static_cast<std::size_t>(falls.columns) * static_cast<std::size_t>(y) +
                    static_cast<std::size_t>(x);
                float light = scale * falls.light[cell];
                if (!falls.width.empty())
                    light *= static_cast<float>(
                        part_of_width(static_cast<double>(falls.width[cell]), width_there));
                if (light == 0.0f) continue;
                for (int v = 0; v < kSplits; ++v)
                    for (int u = 0; u < kSplits; ++u) {
                        const float a = (static_cast<float>(u) + 0.5f) / kSplits,
                                    b = (static_cast<float>(v) + 0.5f) / kSplits;
                        const glm::vec2 at =
                            glm::mix(glm::mix(falls.place[i], falls.place[i + 1], a),
                                     glm::mix(falls.place[i + width], falls.place[i + width + 1], a), b) +
                            0.5f;
                        if (!(at.x >= 0.0f && at.y >= 0.0f && at.x < most && at.y < most)) continue;
                        const auto column = static_cast<std::size_t>(at.x),
                                   row = static_cast<std::size_t>(at.y);
                        const float right = at.x - static_cast<float>(column),
                                    up = at.y - static_cast<float>(row);
                        float* const texel = sums.data() + row * padded + column;
                        texel[0] += light * (1.0f - right) * (1.0f - up);
                        texel[1] += light * right * (1.0f - up);
                        texel[padded] += light * (1.0f - right) * up;
                        texel[padded + 1] += light * right * up;
                    }
            }
    });
    for (std::size_t row = 0; row < side; ++row)
        for (std::size_t column = 0; column < side; ++column) {
            float sum = 0.0f;
            for (const std::vector<float>& sums : parts) sum += sums[(row + 1) * padded + column + 1];
            map.texels[row * side + column] = sum;
        }
}

// What a square metre of the sea at rest lets in of a beam of 1, in the mean over waves of this slope variance towards the sun.
double mean_light(const Beam& beam, double variance) {
    const double level = std::sqrt(std::max(1.0 - beam.to_sun.z * beam.to_sun.z, 0.0)),
                 deviation = std::sqrt(std::max(variance, 0.0));
    constexpr int kSteps = 24;
    double sum = 0.0, weights = 0.0;
    for (int i = -kSteps; i <= kSteps; ++i) {
        const double z = 4.0 * i / kSteps, slope = deviation * z, weight = std::exp(-0.5 * z * z);
        const double across = beam.to_sun.z + slope * level;  // the slope falls towards the sun
        weights += weight;
        if (across > 0.0)
            sum += weight * across * transmitted(std::min(across / std::sqrt(1.0 + slope * slope), 1.0));
    }
    return sum / weights;
}

// The same of a sea that mirrors it, over waves of these slope variances: of what counts, which part that is of all, and which parts have which widths.
struct MeanMirrored {
    double light = 1.0, share = 0.0;
    std::array<double, kWidths> of_width{};  // of `light`
};
MeanMirrored mean_mirrored(const Beam& beam, const glm::dmat2& variance, double far) {
    // By two independent slopes: along the beam, and what is left across it.
    const glm::dvec2 side(-beam.away.y, beam.away.x);
    const double along = std::sqrt(std::max(glm::dot(beam.away, variance * beam.away), 0.0)),
                 both = along > 0.0 ? glm::dot(side, variance * beam.away) / along : 0.0,
                 across = std::sqrt(std::max(glm::dot(side, variance * side) - both * both, 0.0));
    constexpr int kAlong = 160, kAcross = 24;  // a low sun's light rises steeply with the slope along it
    double near = 0.0, all = 0.0, weights = 0.0;
    std::array<double, kWidths> of_width{};
    for (int i = -kAlong; i <= kAlong; ++i)
        for (int j = -kAcross; j <= kAcross; ++j) {
            const double u = 4.0 * i / kAlong, v = 4.0 * j / kAcross,
                         weight = std::exp(-0.5 * (u * u + v * v));
            const glm::dvec2 slope = along * u * beam.away + (both * u + across * v) * side;
            const glm::dvec3 area(-slope, 1.0);
            const double facing = glm::dot(area, beam.to_sun), size = glm::length(area);
            weights += weight;
            if (!(facing > 0.0)) continue;
            const glm::dvec3 n = area / size;
            const double cosine = std::min(facing / size, 1.0);
            const double sent = weight * facing * mirrored_on(beam, n, cosine, far),
                         width = width_of(beam, 2.0 * cosine * n.z - beam.to_sun.z);
            near += sent;
            for (int of = 0; of < kWidths; ++of)
                of_width[static_cast<std::size_t>(of)] += sent * part_of_width(width, of);
            all += weight * facing * mirrored_on(beam, n, cosine, std::numeric_limits<double>::infinity());
        }
    if (!(near > 0.0)) return {};
    for (double& of : of_width) of /= near;
    return {near / weights, std::min(near / all, 1.0), of_width};
}

// Variances of the slopes that the map's texels don't resolve: the mean over some places of it.
template <class T>
glm::dmat2 hidden_slopes(const Frame<T>& frame, int query, const CausticsMap& map) {
    constexpr int kPlaces = 16;  // a side
    std::vector<glm::vec<2, T>> rest;
    for (int i = 0; i < kPlaces * kPlaces; ++i)
        rest.push_back(
            static_cast<T>(map.side * map.texel_m / kPlaces) *
            glm::vec<2, T>(static_cast<double>(i % kPlaces) * map.along +
                           static_cast<double>(i / kPlaces) * glm::dvec2(-map.along.y, map.along.x)));
    const std::vector<T> width(rest.size(), static_cast<T>(map.texel_m));
    std::vector<glm::vec<3, T>> hidden(rest.size());
    Results<T> results;
    results.set(Product::SlopeVariance, {hidden.data()});
    evaluate(
        frame, query,
        Points<T>{
            .origin_m = map.from_m, .count = rest.size(), .rest_m = {rest.data()}, .pixel_m = {width.data()}},
        results);
    glm::dvec3 mean(0.0);
    for (const glm::vec<3, T>& one : hidden) mean += glm::dvec3(one) / static_cast<double>(hidden.size());
    return {mean.x, mean.z, mean.z, mean.y};
}

// A normal distribution of that deviation [texels], along one axis; beyond the map light is even.
void blur(const CausticsMap& map, int axis, double deviation, float even) {
    const int reach = static_cast<int>(std::min(std::ceil(3.0 * deviation), 0.5 * map.side));
    if (deviation < 0.05 || reach < 1) return;
    std::vector<float> weight(static_cast<std::size_t>(2 * reach) + 1);
    float sum = 0.0f;
    for (int i = -reach; i <= reach; ++i)
        sum += weight[static_cast<std::size_t>(i + reach)] =
            static_cast<float>(std::exp(-0.5 * (i / deviation) * (i / deviation)));
    for (float& w : weight) w /= sum;
    const std::ptrdiff_t side = map.side, step = axis == 0 ? 1 : side, across = axis == 0 ? side : 1;
    tbb::parallel_for(std::ptrdiff_t{0}, side, [&](std::ptrdiff_t line) {
        std::vector<float> before(static_cast<std::size_t>(side + 2 * reach), even);
        float* const first = map.texels.data() + line * across;
        for (std::ptrdiff_t i = 0; i < side; ++i)
            before[static_cast<std::size_t>(i + reach)] = first[i * step];
        for (std::ptrdiff_t i = 0; map.is_periodic && i < reach; ++i) {
            before[static_cast<std::size_t>(i)] = first[(side - reach + i) * step];
            before[static_cast<std::size_t>(side + reach + i)] = first[i * step];
        }
        for (std::ptrdiff_t i = 0; i < side; ++i) {
            float value = 0.0f;
            for (std::size_t k = 0; k < weight.size(); ++k)
                value += weight[k] * before[static_cast<std::size_t>(i) + k];
            first[i * step] = value;
        }
    });
}

// How far waves throw light aside: 3 deviations of their slopes and their heights.
double waves_reach_m(const SunThroughWaves& sun, const Beam& beam, double m0, const CausticsOn& on) {
    const double per_slope = on.depth_m * glm::length(glm::dvec2(beam.per_slope[0][0], beam.per_slope[1][1]));
    const double variance = 0.5 * static_cast<double>(sun.waves.x + sun.waves.y);
    return std::min(3.0 * std::sqrt(variance) * per_slope + 3.0 * std::sqrt(m0) * (1.0 + beam.tangent),
                    on.most_margin_m);
}

constexpr double kLeastTangent = 0.02;  // light of a sun in the zenith goes astray as well

}  // namespace

double caustics_share(const SunThroughWaves& sun) {
    constexpr float kLowSun = 0.02f, kNoLowSun = 0.06f;  // sines of its elevation
    return static_cast<double>(glm::smoothstep(kLowSun, kNoLowSun, sun.to_sun.z));
}

glm::dvec2 level_way(const SunThroughWaves& sun) {
    const Beam beam = beam_of(sun);
    return beam.tangent * beam.away;
}

double caustics_margin_m(const SunThroughWaves& sun, const Floor& floor, double m0, const CausticsOn& on) {
    const Beam beam = beam_of(sun);
    double margin_m = waves_reach_m(sun, beam, m0, on);
    if (floor.has_depths()) margin_m += std::max(beam.tangent, kLeastTangent) * on.uneven_m;
    return std::min(margin_m, on.most_margin_m);
}

std::size_t caustics_bytes(int side, double margin, bool is_mirrored) {
    const auto texels = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    const double with_margins = (1.0 + 2.0 * margin) * (1.0 + 2.0 * margin);
    // Falls, and what some rows of cells are asked for.
    const std::size_t of_point = 10 * sizeof(double) + (is_mirrored ? sizeof(glm::vec2) : 0),
                      of_cell = sizeof(glm::vec2) + (is_mirrored ? 2 : 1) * sizeof(float);
    const std::size_t rows = static_cast<std::size_t>(kRowsAtOnce + 1) *
                             static_cast<std::size_t>(static_cast<double>(side) * (1.0 + 2.0 * margin) + 2.0);
    // The map of one width is beside the others.
    return texels * (kParts + (is_mirrored ? 1 : 0)) * sizeof(float) +
           static_cast<std::size_t>(static_cast<double>(texels) * with_margins) * of_cell + rows * of_point;
}

template <class T>
void find_caustics(const CausticsMap& map, const Floor& floor, const Frame<T>& frame, int query,
                   const SunThroughWaves& sun, const CausticsOn& on, const std::atomic<bool>* cancel) {
    const Beam beam = beam_of(sun);
    const double m0 = frame.sea().plan().from->spectrum.m0();
    double margin_m = caustics_margin_m(sun, floor, m0, on);
    if (beam.is_mirrored) margin_m = std::max(margin_m, 2.0 * map.texel_m);  // a calm has no slopes
    // Light comes from within the margin as long as the floor there isn't much deeper, nor less deep, than on.depth_m.
    const double range_m =
        std::max(margin_m - waves_reach_m(sun, beam, m0, on), 0.0) / std::max(beam.tangent, kLeastTangent);
    const glm::dmat2 hidden = hidden_slopes(frame, query, map);
    const glm::dvec3 all(sun.waves);
    const glm::dmat2 waves(all.x, all.z, all.z, all.y);
    const double towards_sun = glm::dot(beam.away, (waves - hidden) * beam.away);
    const double depth_m = on.depth_m;
    const Falls falls = falls_on(map, floor, frame, query, beam, on, margin_m, range_m, cancel);
    const glm::dmat2 in_map(map.along.x, -map.along.y, map.along.y, map.along.x);
    const glm::dvec2 away = in_map * beam.away;
    const glm::dmat2 spread = in_map *
                              (depth_m * depth_m * beam.per_slope * hidden * glm::transpose(beam.per_slope)) *
                              glm::transpose(in_map);
    // The sun's disc: a uniform one's variance is a quarter of its radius' square.
    const double c = beam.cosine_there;
    const double disc = depth_m * beam.radius / (2.0 * beam.index * c);
    const double along = disc * beam.to_sun.z / (c * c);
    // wider: how many times along the light's way.
    const auto spread_out = [&](const CausticsMap& of, double wider, float even) {
        const glm::dmat2 widened = glm::dmat2(1.0) + (wider - 1.0) * glm::outerProduct(away, away);
        const glm::dmat2 turned = widened * spread * widened;
        for (int axis = 0; axis < 2; ++axis) {
            const double part = away[axis] * away[axis];
            // Never less than this: cells send their light as so many points, which show where a sheet of them is folded.
            constexpr double kLeast_texels = 0.6;
            const double least_m = kLeast_texels * map.texel_m;
            const double variance = least_m * least_m + turned[axis][axis] +
                                    wider * wider * along * along * part + disc * disc * (1.0 - part);
            blur(of, axis, std::sqrt(std::max(variance, 0.0)) / map.texel_m, even);
        }
    };
    const double cell_m2 = map.texel_m * map.texel_m;
    if (!beam.is_mirrored) {
        gather(falls, map, mean_light(beam, towards_sun) * cell_m2);
        spread_out(map, 1.0, 1.0f);
        return;
    }
    const MeanMirrored mean = mean_mirrored(beam, waves - hidden, margin_m / std::max(depth_m, 1e-9));
    std::vector<float> of_width(map.texels.size());
    CausticsMap one = map;
    one.texels = of_width;
    std::ranges::fill(map.texels, 1.0f - static_cast<float>(mean.share));
    for (int width = 0; width < kWidths; ++width) {
        stop_if(cancel);
        gather(falls, one, mean.light * cell_m2, width);
        spread_out(one, std::exp2(width - kWidths / 2),
                   static_cast<float>(mean.of_width[static_cast<std::size_t>(width)]));
        for (std::size_t i = 0; i < of_width.size(); ++i)
            map.texels[i] += static_cast<float>(mean.share) * of_width[i];
    }
}

template void find_caustics(const CausticsMap&, const Floor&, const Frame<float>&, int,
                            const SunThroughWaves&, const CausticsOn&, const std::atomic<bool>*);
template void find_caustics(const CausticsMap&, const Floor&, const Frame<double>&, int,
                            const SunThroughWaves&, const CausticsOn&, const std::atomic<bool>*);

}  // namespace pelagic
