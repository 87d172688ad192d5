// The preview's camera in an artist's hand: it turns round what it looks at, slides, comes nearer, and flies.
// Pure geometry, no window.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/surface/view.h"

namespace pelagic {

// Heights above the sea at rest that a hand can reach [m]. A shot's own camera may be anywhere.
inline constexpr double kLowest_m = 0.5, kHighest_m = 20e3;

// A pose without roll: heading and pitch, so that looking straight down is a pitch like any other, with the
// heading as the picture's up.
class OrbitCamera {
  public:
    // The view's place and direction; its roll, which a shot's camera never has, is dropped. Turns go round
    // the point of the sea at rest in the middle of the picture, or where there is none, or it is beyond
    // reach, round one straight ahead.
    void take(const View& view);
    // The pose through a lens: lens's resolution and tangent, this camera's place and directions.
    View view(const View& lens) const;

    // All of these leave the height within kLowest_m … kHighest_m, and everything finite for finite numbers.
    // Angles [rad]: x turns counter-clockwise seen from above, y lifts the gaze.
    void orbit(glm::dvec2 angle);  // round the middle of the picture, which stays where it is
    void look(glm::dvec2 angle);   // on the spot
    // By pixels, x to the right and y down: what is as far away as the middle of the picture follows the
    // hand.
    void pan(glm::dvec2 pixels, const View& lens);
    // Each step goes 15 % of the way to the middle of the picture; negative ones go back as they came.
    void zoom(double steps);
    // For a time, with steering −1 … 1 to the right, ahead and up the world's z; `haste` multiplies the
    // speed, which is a camera's own height a second, so that a flight looks alike from everywhere.
    struct Flight {
        glm::dvec3 steering{0.0};
        double seconds = 0.0;
        double haste = 1.0;
    };
    void fly(const Flight& flight);

    glm::dvec3 position_m() const { return position_m_; }
    glm::dvec3 middle_m() const;  // what orbit() turns round
    double distance_m() const { return distance_m_; }

  private:
    glm::dvec3 right() const;
    glm::dvec3 forward() const;
    void keep_height();

    glm::dvec3 position_m_{0.0, -60.0, 4.0};
    double heading_ = 1.5707963267948966;  // of the gaze, counter-clockwise from +x
    double pitch_ = 0.0;                   // of the gaze above the horizontal, −π/2 … π/2
    double distance_m_ = 60.0;             // to the middle
};

}  // namespace pelagic
