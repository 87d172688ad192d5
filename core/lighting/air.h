// The air between an eye and the sea (aerial perspective): what it takes from the sea's light and what it adds, as a table
// for all directions and distances from an eye at one height. air.glsl says how it is laid out and read.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/lighting/atmosphere.h"
#include "core/lighting/lighting.h"
#include "core/lighting/sky_map.h"

namespace pelagic {

// Heights of an eye [m] from which the light at places begins to be of their own sun, and from which it wholly is
// (place.glsl).
inline constexpr double kLightByPlaceFrom_m = 500.0, kLightByPlaceWhole_m = 4000.0;

// Empty: there is no air.
struct Air {
    static constexpr int kLayers = 3, kColumns = 32, kRows = 48, kHorizonRow = 39, kSkyRows = 64,
                         kPlaceRows = 2;
    static constexpr int kWidth = kLayers * kColumns, kHeight = kRows + kSkyRows + kPlaceRows;
    glm::vec2 azimuth{1.0f, 0.0f};
    glm::vec3 to_sun{0.0f, 0.0f, 1.0f};
    float nearest_m = 0.0f, horizon_m = 0.0f, farthest_m = 0.0f, dip = 0.0f, sky_span = 1.0f;
    bool has_sky = false;  // otherwise the sky is the map's alone
    // How far the light of a place is that of its own sun (place.glsl): 0 for eyes so low that all they see has one.
    float by_place = 0.0f;
    // kWidth × kHeight, x fastest. Rows of places (place.glsl); before them in-scattered light by air, by haze, and more than once, each with one
    // channel of the mean extinction [1/m] as its fourth number.
    std::vector<glm::vec4> texels;
    bool empty() const { return texels.empty(); }
};

// The air of a light: which air lies before an eye depends on its height. Immutable, for any threads.
class AirModel {
  public:
    virtual ~AirModel() = default;
    // height_m: of the eye above the sea at rest; below 0.1 m it counts as 0.1 m. Milliseconds. Finite, whatever the
    // finite height.
    virtual Air seen_from(double height_m) const = 0;
    virtual bool has_sky() const = 0;  // Air::has_sky of each
};

// The air of daylight, by the atmosphere's own model. azimuth_rad: the sun's, counter-clockwise from +x. The first
// eye from higher up than the atmosphere is made for waits for another one.
std::shared_ptr<const AirModel> daylight_air(std::shared_ptr<const Atmosphere> atmosphere,
                                             double azimuth_rad);

// The air of a picture of a sky, in which a black object is visible against the horizon at most this far [m], > 0.
// Koschmieder 1924: its contrast has fallen to 2 %, so extinction at sea level is 3.912/visibility. It falls with height as
// that of haze. In every direction the air adds towards the picture's own horizon.
std::shared_ptr<const AirModel> picture_air(const SkyMap& map, double visibility_m);

// What an eye sees of radiance[i] through the air: distances to the points [m], directions from them to the eye (unit).
// Its own light goes into the layer `air`. Each depends on its point and the arguments alone. Throws
// std::invalid_argument if the spans differ in length. Without air nothing changes.
void see_through(const Air& air, std::span<const glm::vec3> to_eye, std::span<const float> distance_m,
                 std::span<SeaRadiance> radiance);

// The sky in a direction (unit) from the air's eye, without the sun's disc; of an air that has it. Finite.
glm::vec3 sky_through(const Air& air, glm::vec3 direction);

}  // namespace pelagic
