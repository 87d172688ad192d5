// What the record of a bake says about a frame's spray.
#pragma once

namespace pelagic {

// Over the patch's square.
struct SprayRecord {
    double breaking_over_mean = 0.0;  // what breaks there now over what breaks now on average
    double mass_flux_kg_per_s = 0.0;  // of droplets, upwards
    double optical_thickness = 0.0;   // straight up, on average
};

}  // namespace pelagic
