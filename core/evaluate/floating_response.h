// How a body moves in the sea by its own mass: heave, pitch and roll as linear theory has them of a box that floats
// (objects[].buoyancy = "response").
//
// A wave a e^{i(k·x − ωt)} presses on the box with ρg a e^{i(k·x − ωt)} cosh k(z + d)/cosh kd, as if the box weren't there (Froude and
// Krylov; Newman 1977, "Marine hydrodynamics", §6.16). On length L, beam B and draught T, over ρ g L B a, with sinc q = sin q/q,
// j₁(q) = sin q/q² − cos q/q, qx = kx L/2, qy = ky B/2, e = cosh k(d − T)/cosh kd and J = ∫ (z − z_G) cosh k(z + d)/cosh kd dz over the
// draught:
//   heave  e sinc qx sinc qy
//   trim   i sinc qy (½ L e j₁(qx) + 2 J sin qx/L)        the slope along the body; a long wave's is i kx a
//   heel   i sinc qx (½ B e j₁(qy) + 2 J sin qy/B)        the slope across it, to port
// The box answers as a damped oscillator at the frequency with which it meets the wave, ω_e = ω − k·U: its motion is the pull over
// C − M ω_e² − i b ω_e. So a frame alone is that frame of a run: there is no state.
//
// Added masses are half of a flat strip's in unbounded water (Lamb 1932, §71), πρB²/8 and πρB⁴/256 a metre of length. By rule of thumb, of
// a displacement ship: the radii of gyration are a quarter of the length and 0.35 of the beam, or 0.6 of the draught where that is more; the
// damping of heave and pitch is 0.2 of the critical; the centre of gravity leaves a metacentric height of a tenth of the smaller side, or of
// the draught, but is no higher over the water than half the draught. With that damping a beam sea lifts a ship of 7.5 m beam by up to 1.5
// times its waves, about as an estimate by Ursell's half circle (1949) and Haskind's relation has it: diffraction, which isn't there, takes a
// third of the pull, and less is radiated. Nor are there sway, surge and yaw, what is not linear (slamming, a roll's own damping), and the
// wakes of vessels.
#pragma once

#include <glm/vec2.hpp>

#include "core/scene/object_pose.h"
#include "core/waves/frame.h"
#include "pelagic/scene.h"

namespace pelagic {

// Of one of its three motions, over ρ L B: C − M ω² − i b ω.
struct Oscillator {
    double stiffness = 0.0, mass = 0.0, damping = 0.0;
};
struct FloatingModel {
    FloatingBox box;
    double gravity_m = 0.0;        // height of the centre of gravity over the water
    Oscillator heave, trim, heel;  // [m/s²]; [m²/s²]: angles, over ρ L B
};
// heel_damping: over the critical.
FloatingModel floating_model(const FloatingBox& box, double heel_damping = 0.1);

struct FloatingMotion {
    double heave_m = 0.0;   // of the box's middle
    glm::dvec2 slope{0.0};  // ahead and to port
};

// Where a box is in the waves, and how it meets them.
struct FloatingCourse {
    glm::dvec2 middle_m{0.0};      // its place over the sea
    glm::dvec2 ahead{1.0, 0.0};    // a unit vector
    glm::dvec2 velocity_mps{0.0};  // over the sea
    double cell_m = 0.0;           // the footprint of the waves that it feels
    double late_s = 0.0;           // after the frame's time
};

// O(modes that it feels), on the calling thread: the same bits on any number of them.
template <class T>
FloatingMotion floating_motion(const Frame<T>& state, const FloatingModel& model,
                               const FloatingCourse& course);

}  // namespace pelagic
