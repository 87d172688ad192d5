#include "core/lighting/foam_structure.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "core/base/random.h"

namespace pelagic {
namespace {

constexpr double kRepeat = 65536.0;                         // cells
constexpr std::uint32_t kStream = 0x666f616du;              // of the shot's random numbers
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
    // Most cameras stand near the origin: there the pattern would have the same bare patch in every shot.
    const auto moved =
        look.seed == 0 ? std::array<std::uint32_t, 4>{} : philox({0, 0, 0, kStream}, look.seed);
    for (int i = 0; i < 3; ++i) {
        const double cells = at_m[i] * per_m[i];
        const double whole = std::floor(cells),
                     in_pattern = whole + moved[static_cast<std::size_t>(i)] % 65536;
        pattern.cell[i] = static_cast<float>(in_pattern - kRepeat * std::floor(in_pattern / kRepeat));
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
