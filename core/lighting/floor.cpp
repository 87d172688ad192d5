#include "core/lighting/floor.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <stdexcept>
#include <string>

namespace pelagic {
namespace {

namespace floor_shading {
using namespace glm;

struct Shading {
    std::span<const float> values;
    float floor_value(int i) const { return values[static_cast<std::size_t>(i)]; }
#include "core/lighting/floor.glsl"
};

}  // namespace floor_shading

floor_shading::Shading::FloorView glsl(const FloorSeen& seen) {
    return {true,        seen.z_m,          seen.curvature_per_m, seen.pixel,         seen.lowest_m,
            seen.depths, seen.depths_per_m, seen.colours,         seen.colours_first, seen.light,
            seen.coarse, seen.shafts,       seen.shafts_look};
}

void require(bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("a floor's map: ") + what);
}

}  // namespace

void Floor::set_depths(glm::ivec2 columns_rows, std::vector<float> depths_m, glm::dvec2 from_m,
                       glm::dvec2 size_m) {
    require(columns_rows.x >= 1 && columns_rows.y >= 1 && size_m.x > 0.0 && size_m.y > 0.0, "has no size");
    require(depths_m.size() ==
                static_cast<std::size_t>(columns_rows.x) * static_cast<std::size_t>(columns_rows.y),
            "has another number of depths");
    require(depths_m.size() <= kMostFloorValues / 4, "is too large");
    require(std::all_of(depths_m.begin(), depths_m.end(), [](float depth) { return depth > 0.0f; }),
            "has depths that aren't positive");
    require(values_.empty(), "has depths, colours or light already");
    values_ = std::move(depths_m);
    lowest_m_ =
        std::min(z_m_, rest_m_ - static_cast<double>(*std::max_element(values_.begin(), values_.end())));
    depth_size_ = columns_rows;
    depth_from_m_ = from_m;
    depth_per_m_ = glm::dvec2(columns_rows) / size_m;
    colours_first_ = light_first_ = values_.size();
}

void Floor::set_colours(int side, std::span<const glm::vec3> colours, double size_m) {
    require(side >= 1 && (side & (side - 1)) == 0 && size_m > 0.0, "has a side that is no power of two");
    require(colours.size() == static_cast<std::size_t>(side) * static_cast<std::size_t>(side),
            "has another number of colours");
    require(6 * colours.size() <= kMostFloorValues / 2, "is too large");
    require(light_first_ == values_.size() && colour_side_ == 0, "has colours or light already");
    std::vector<glm::vec3> level(colours.begin(), colours.end());
    for (int n = side;; n /= 2) {
        for (int channel = 0; channel < 3; ++channel)
            for (const glm::vec3& colour : level) values_.push_back(colour[channel]);
        if (n == 1) break;
        std::vector<glm::vec3> half;
        half.reserve(level.size() / 4);
        for (std::size_t y = 0; y < level.size() / static_cast<std::size_t>(n); y += 2)
            for (std::size_t x = 0; x < static_cast<std::size_t>(n); x += 2) {
                const std::size_t at = y * static_cast<std::size_t>(n) + x;
                half.push_back(0.25f * (level[at] + level[at + 1] + level[at + static_cast<std::size_t>(n)] +
                                        level[at + static_cast<std::size_t>(n) + 1]));
            }
        level = std::move(half);
    }
    colour_side_ = side;
    colour_m_ = size_m;
    light_first_ = values_.size();
}

std::span<float> Floor::set_light(const Light& light) {
    light_ = light;
    const auto side = static_cast<std::size_t>(light.side);
    shafts_ = {};
    shafts_first_ = light_first_ + 2 * side * side;
    values_.resize(shafts_first_);
    return std::span(values_).subspan(light_first_);
}

std::span<float> Floor::set_shafts(const Shafts& shafts) {
    require((shafts.side & (shafts.side - 1)) == 0, "has a side that is no power of two");
    shafts_ = shafts;
    shafts_first_ =
        light_first_ + 2 * static_cast<std::size_t>(light_.side) * static_cast<std::size_t>(light_.side);
    const auto side = static_cast<std::size_t>(shafts.side);
    values_.reserve(shafts_first_ + (4 * side * side - 1) / 3);  // with halve_shafts()'s
    values_.resize(shafts_first_ + side * side);
    return std::span(values_).subspan(shafts_first_);
}

void Floor::halve_shafts() {
    std::size_t first = shafts_first_;
    for (auto side = static_cast<std::size_t>(shafts_.side); side > 1; side /= 2) {
        for (std::size_t y = 0; y < side; y += 2)
            for (std::size_t x = 0; x < side; x += 2) {
                const float* const at = values_.data() + first + y * side + x;
                values_.push_back(0.25f * (at[0] + at[1] + at[side] + at[side + 1]));
            }
        first += side * side;
    }
}

double Floor::depth_m(glm::dvec2 place_m) const {
    if (!has_depths()) return rest_m_ - z_m_;
    const FloorSeen seen = seen_from({.position_m = glm::dvec3(place_m, rest_m_)});
    floor_shading::Shading shading{seen.values};
    return -static_cast<double>(shading.floor_height(glm::vec2(0.0f), glsl(seen)));
}

double Floor::distance_m(const glm::dvec3& eye_m, const glm::dvec3& direction) const {
    const FloorSeen seen = seen_from({.position_m = eye_m});
    floor_shading::Shading shading{seen.values};
    const double down = std::max(-direction.z, 1e-6);
    const auto there =
        shading.seen_floor(glm::vec3(0.0f), glm::vec2(glm::dvec2(direction) / down), 0.0f, 0.0f, glsl(seen));
    return static_cast<double>(there.depth_m) / down;
}

FloorSeen Floor::seen_from(const FloorEye& from) const {
    const glm::dvec3& eye_m = from.position_m;
    const glm::dvec2 eye(eye_m);
    FloorSeen seen{.is_seen = true,
                   .z_m = static_cast<float>(z_m_ - eye_m.z),
                   .curvature_per_m = static_cast<float>(from.curvature_per_m),
                   .pixel = static_cast<float>(from.pixel_tangent),
                   .lowest_m = static_cast<float>(lowest_m_ - eye_m.z),
                   .values = values_};
    if (has_depths()) {
        seen.depths = glm::vec4(depth_from_m_ - eye, depth_size_);
        seen.depths_per_m = glm::vec4(glm::vec2(depth_per_m_), static_cast<float>(rest_m_ - eye_m.z), 0.0f);
    }
    if (colour_side_ > 0) {
        // Within the picture, so that a single's precision is that of its texels far out at sea, too.
        const glm::dvec2 in_picture = eye / colour_m_ - glm::floor(eye / colour_m_);
        const double side = colour_side_;
        seen.colours = glm::vec4(glm::vec2(in_picture * side), static_cast<float>(side / colour_m_),
                                 static_cast<float>(side));
        seen.colours_first = static_cast<float>(colours_first_);
    }
    if (has_light()) {
        seen.light = glm::vec4(glm::vec2(light_.from_m[0] - eye), static_cast<float>(1.0 / light_.texel_m),
                               static_cast<float>(light_.side));
        seen.coarse =
            glm::vec4(glm::vec2(light_.from_m[1] - eye), static_cast<float>(light_first_), light_.gain);
    }
    if (has_shafts()) {
        seen.shafts = glm::vec4(glm::vec2(shafts_.from_m - eye), static_cast<float>(1.0 / shafts_.texel_m),
                                static_cast<float>(shafts_.depth_m));
        seen.shafts_look = {static_cast<float>(shafts_first_), static_cast<float>(shafts_.side),
                            static_cast<float>(shafts_.gain)};
    }
    return seen;
}

}  // namespace pelagic
