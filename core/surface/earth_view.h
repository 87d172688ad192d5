// What an eye sees of the sea on the earth's sphere (earth.h), in terms of a flat sea below the same eye: each ray that meets
// both meets them at the same azimuth, but at other distances. Distances [m] are from the eye's nadir: along the sphere ("arc"),
// or on the plane ("flat"). A curvature of 0 makes both the same.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace pelagic {

class EarthView {
  public:
    // crest_m: the highest wave. An eye at or below the sea at rest sees the plane, as far as crests rise behind it.
    EarthView(double height_m, double curvature_per_m, double crest_m)
        : height_m_(height_m), curvature_per_m_(curvature_per_m) {
        if (!is_round()) return;
        horizon_m_ = to_horizon_m(height_m);
        farthest_m_ = horizon_m_ + to_horizon_m(std::max(crest_m, 0.01));
    }

    bool is_round() const { return curvature_per_m_ != 0.0; }
    // Arcs to the horizon of the sea at rest, and to the farthest crest that may rise over it; infinite where it is flat.
    double horizon_m() const { return horizon_m_; }
    double farthest_m() const { return farthest_m_; }

    // The arc to what the eye sees where a flat sea would be; the farthest where that would be over the horizon.
    double arc_of(double flat_m) const {
        if (!is_round() || height_m_ <= 0.0) return flat_m;
        const double slope = std::hypot(flat_m, height_m_);
        const double sine = flat_m / slope, cosine = height_m_ / slope;  // of the angle from the nadir
        const double radius_m = 1.0 / curvature_per_m_, eye_m = radius_m + height_m_;
        const double inside = (radius_m - eye_m * sine) * (radius_m + eye_m * sine);
        if (!(inside > 0.0)) return farthest_m_;
        const double way_m = height_m_ * (radius_m + eye_m) / (eye_m * cosine + std::sqrt(inside));
        return radius_m * std::atan2(way_m * sine, eye_m - way_m * cosine);
    }
    // The inverse; infinite over the horizon.
    double flat_of(double arc_m) const {
        if (!is_round() || height_m_ <= 0.0) return arc_m;
        if (arc_m >= horizon_m_) return std::numeric_limits<double>::infinity();
        return height_m_ * across_m(arc_m) / (height_m_ + drop_m(arc_m));
    }

    // The angle [rad] between two places, seen from this height over the same nadir.
    double angle_between(double height_m, double first_m, double last_m) const {
        const double x1 = across_m(first_m), x2 = across_m(last_m);
        const double z1 = height_m + drop_m(first_m), z2 = height_m + drop_m(last_m);
        return std::abs(std::atan2(x2 * z1 - x1 * z2, x1 * x2 + z1 * z2));
    }
    double distance_m(double height_m, double arc_m) const {
        return std::hypot(across_m(arc_m), height_m + drop_m(arc_m));
    }

  private:
    double to_horizon_m(double height_m) const {
        if (height_m <= 0.0) return 0.0;
        return std::atan(std::sqrt(height_m * curvature_per_m_ * (2.0 + height_m * curvature_per_m_))) /
               curvature_per_m_;
    }
    // Of a place at rest: its distance from the vertical through the eye, and its depth below the nadir.
    double across_m(double arc_m) const {
        return is_round() ? std::sin(arc_m * curvature_per_m_) / curvature_per_m_ : arc_m;
    }
    double drop_m(double arc_m) const {
        if (!is_round()) return 0.0;
        const double half = std::sin(0.5 * arc_m * curvature_per_m_);
        return 2.0 * half * half / curvature_per_m_;
    }

    double height_m_, curvature_per_m_;
    double horizon_m_ = std::numeric_limits<double>::infinity(), farthest_m_ = horizon_m_;
};

}  // namespace pelagic
