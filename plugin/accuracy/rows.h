// The functions that lay out the trials of each row of approximation_table(), by what they sweep.
#pragma once

#include "plugin/accuracy/accuracy.h"

namespace pelagic::rows {

// Of the sum of waves, at points of the shot's patch.
Trials cascade_resolution(const Scene& shot);
Trials cascade_number(const Scene& shot);
Trials interpolation(const Scene& shot);
Trials precision(const Scene& shot);
Trials train_number(const Scene& shot);
Trials instruction_sets(const Scene& shot);

// Of meshes, files and foam.
Trials mesh_spacing(const Scene& shot);
Trials mesh_variance(const Scene& shot);
Trials fitted_cages(const Scene& shot);
Trials file_numbers(const Scene& shot);
Trials whitecap_moments(const Scene& shot);

// Of surfaces that are made for the shot's camera.
Trials near_far(const Scene& shot);
Trials camera_grid(const Scene& shot);

// Of cages, rays and transforms.
Trials cage_levels(const Scene& shot);
Trials ray_tolerance(const Scene& shot);
Trials planning_modes(const Scene& shot);

// Of pictures through the shot's camera.
Trials sky_lookups(const Scene& shot);
Trials fresnel_terms(const Scene& shot);
Trials samples(const Scene& shot);
Trials grid_cells(const Scene& shot);
Trials footprint_filter(const Scene& shot);
Trials picture_interpolation(const Scene& shot);
Trials foam_structure(const Scene& shot);
Trials air(const Scene& shot);
Trials second_reflection(const Scene& shot);
Trials masking(const Scene& shot);
Trials ellipses(const Scene& shot);
Trials foam_times(const Scene& shot);

// Of effects that are on.
Trials picture_steps(const Scene& shot);
Trials picture_effects(const Scene& shot);
Trials bake_effects(const Scene& shot);

}  // namespace pelagic::rows
