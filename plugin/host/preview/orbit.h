// The preview's camera, controlled by hand: orbit, look, pan, zoom and fly. Pure geometry, without a window.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/surface/view.h"

namespace pelagic {

// The range of heights above the sea at rest [m] for this camera. A shot's own camera may be anywhere.
inline constexpr double kLowest_m = 0.5, kHighest_m = 20e3;

// A pose without roll, given by heading and pitch. So looking straight down is an ordinary pitch, and the
// heading is the up direction of the picture.
class OrbitCamera {
  public:
    // Takes over a view's place and direction, without roll (which a shot's camera never has). The pivot
    // becomes the point of the sea at rest in the middle of the picture; if there is none in range, a point
    // straight ahead.
    void take(const View& view);
    // The view from this camera's place and direction with the lens's resolution and field of view.
    View view(const View& lens) const;

    // All of these keep the height within kLowest_m … kHighest_m, and everything finite for finite arguments.
    // Angles [rad]: x turns counter-clockwise seen from above, y raises the pitch.
    void orbit(glm::dvec2 angle);  // round the pivot, which stays in the middle of the picture
    void look(glm::dvec2 angle);   // on the spot
    // By pixels, x to the right and y down. Points as far away as the pivot follow the mouse.
    void pan(glm::dvec2 pixels, const View& lens);
    // Each step goes 15 % of the way to the pivot; a negative step undoes a positive one.
    void zoom(double steps);
    // Steering is −1 … 1 to the right, ahead and along the world's z. The speed is the camera's height per
    // second, so that a flight looks alike at any height; `haste` multiplies it.
    struct Flight {
        glm::dvec3 steering{0.0};
        double seconds = 0.0;
        double haste = 1.0;
    };
    void fly(const Flight& flight);

    glm::dvec3 position_m() const { return position_m_; }
    glm::dvec3 middle_m() const;  // the pivot of orbit()
    double distance_m() const { return distance_m_; }

  private:
    glm::dvec3 right() const;
    glm::dvec3 forward() const;
    void keep_height();

    glm::dvec3 position_m_{0.0, -60.0, 4.0};
    double heading_ = 1.5707963267948966;  // counter-clockwise from +x
    double pitch_ = 0.0;                   // above the horizontal, −π/2 … π/2
    double distance_m_ = 60.0;             // to the pivot
};

}  // namespace pelagic
