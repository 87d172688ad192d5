// What somebody asks of the sea: the points' products and how fine they are.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/plan/products.h"
#include "core/surface/rest_surface.h"

namespace pelagic {

// A batch of points that somebody will hand to evaluate(): what is wanted there, and how fine.
struct Query {
    std::string name;     // for explain(): "mesh", "map normal", …
    ProductSet products;  // evaluate() writes these and no others
    // Footprints [m], rising: one for points that all have the same, or several levels between which each point's own
    // footprint is blended. 0: nothing is filtered. `cell_m` filters positions and velocities, `pixel_m` everything
    // that comes from derivatives.
    std::vector<double> cell_m{0.0};
    std::vector<double> pixel_m{0.0};
    std::size_t points = 0;           // how many at a time, for explain()'s account of memory
    std::optional<Lattice> lattice;   // where the points are known to lie on one: no error of sampling
    std::optional<int> only_cascade;  // a cascade's own tile: the others count as unresolved
    // Of a camera, whose place must not decide which wave trains there are: pictures from near and far, and
    // bakes, are of one sea.
    bool is_view = false;
    // What comes from derivatives is for light alone, which a spline's error changes less than other things do
    // (`pelagic accuracy --rows picture-interpolation`): Knobs::light_oversampling.
    bool is_picture = false;

    // Whether it asks for what earlier breaking has left. A cascade's own tile is a part of the sea: all its foam
    // breaks now.
    bool asks_for_past() const { return (products & lasting_products()).any() && !only_cascade; }
};

}  // namespace pelagic
