#include "core/lighting/foam_structure.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace pelagic {
namespace {

constexpr double kRepeat = 65536.0;                         // cells
constexpr double kNetStretch = 1.0, kStreakStretch = 16.0;  // along the wind, at the strongest

}  // namespace

FoamPattern foam_pattern(const FoamLook& look, glm::dvec2 origin_m) {
    const double angle = glm::radians(look.wind_direction_deg);
    const glm::dvec2 wind(std::cos(angle), std::sin(angle));
    const glm::dvec3 per_m(1.0 / (kFoamCell_m * (1.0 + kNetStretch * look.streaks)),
                           1.0 / (kFoamCell_m * (1.0 + kStreakStretch * look.streaks)), 1.0 / kFoamCell_m);
    const double along = glm::dot(wind, origin_m);
    const double across = wind.x * origin_m.y - wind.y * origin_m.x;
    FoamPattern pattern;
    const glm::dvec3 at_m(along, along, across);
    for (int i = 0; i < 3; ++i) {
        const double cells = at_m[i] * per_m[i];
        const double whole = std::floor(cells);
        pattern.cell[i] = static_cast<float>(whole - kRepeat * std::floor(whole / kRepeat));
        pattern.rest[i] = static_cast<float>(cells - whole);
    }
    pattern.axes = glm::vec4(wind, per_m.x, per_m.y);
    pattern.look = glm::vec4(look.structure, look.streaks, look.fresh_opacity, look.old_opacity);
    pattern.white = glm::vec2(look.fresh_albedo, look.old_albedo);
    if (look.image) {
        pattern.picture = look.image.get();
        const auto in_tile = [&](double at) { return at / look.image_m - std::floor(at / look.image_m); };
        pattern.image = glm::vec4(static_cast<double>(look.image->side), 1.0 / look.image_m, in_tile(along),
                                  in_tile(across));
    }
    return pattern;
}

}  // namespace pelagic
