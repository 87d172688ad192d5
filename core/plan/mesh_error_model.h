// How far a mesh is from the sea, in expectation: what its cells filter away, and what straight edges cut off.
//
// A wave k of unit height, filtered by the weight w(k) of a cell (filter.h) and drawn by the mesh, differs from itself by
//
//   e² = 1 − 2 w A(k) + w² B(k),
//
// A being the mean over the surface of the drawn wave times the wave, B that of the drawn wave squared. Both are closed forms
// of a square lattice's basis functions. With a = k·x̂ s, b = k·ŷ s of cells s:
//
//   triangles      A = sinc(a/2) sinc(b/2) sinc((a+b)/2),          B = ½ + (cos a + cos b + cos(a+b))/6
//   a limit surface through the points (fitted_cage.h)
//                  A = Π sinc⁴(a/2) 3/(2 + cos a),                  B = Π m(a) (3/(2 + cos a))²,
//
// m(a) = (2416 + 2382 cos a + 240 cos 2a + 2 cos 3a)/5040 (Fourier series of the B-splines of degree 1, 3 and 7; Unser, Aldroubi,
// Eden 1993). The squared distance of the surface is ∫ S (1 + λ² coth²(kd)) e² dk over the spectrum S, λ the choppiness.
#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "core/plan/prepared_scene.h"
#include "core/surface/rest_surface.h"

namespace pelagic {

enum class Drawn { Triangles, LimitSurface };

class MeshErrorModel {
  public:
    explicit MeshErrorModel(const PreparedScene& prepared);

    // RMS distance over Hs of a mesh of cells cell_m > 0 from the sea, or from the sea as pixels of pixel_m show it
    // (0: without a footprint). 0 for a calm.
    double error(double cell_m, double pixel_m, Drawn drawn) const;

    // The same of a surface's points, RMS over them; of surfaces that are made for a camera, against what its pixels show. The
    // largest of these frames.
    double error(const RestSurface& surface, const Camera& camera, std::span<const int> frames) const;

  private:
    struct Wave {
        double kx, ky, k;  // [rad/m]
        double energy;     // of the displacement in three dimensions, over Hs²
    };
    double tabled(double cell_m, double pixel_m, Drawn drawn) const;

    std::vector<Wave> waves_;
    mutable std::map<std::tuple<int, int, Drawn>, double> table_;  // by tabled()
};

}  // namespace pelagic
