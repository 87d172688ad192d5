// The uniforms of the shaders that aren't of a view, by name.
#pragma once

#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "core/lighting/air.h"
#include "core/lighting/floor.h"
#include "core/lighting/foam_structure.h"
#include "core/lighting/object.h"
#include "core/lighting/sky.h"
#include "core/lighting/spray.h"
#include "core/lighting/water.h"
#include "plugin/host/gpu/sea_layout.h"

namespace pelagic {

struct Uniform {
    std::string name;
    int components = 1;  // of `value` that count
    glm::vec4 value{0.0f};
    bool is_integer = false;
};

// Of query.glsl and trains.glsl.
std::vector<Uniform> query_uniforms(const SeaLayout& layout);
// Of light_uniforms.glsl.
std::vector<Uniform> light_uniforms(const Sky& sky);
std::vector<Uniform> water_uniforms(const WaterBody& water);
// Of floor_uniforms.glsl; floor_maps is a picture of that many columns.
std::vector<Uniform> floor_uniforms(const FloorSeen& floor);
inline constexpr int kFloorColumns = 2048;
// Of foam_uniforms.glsl.
std::vector<Uniform> foam_uniforms(const FoamPattern& pattern);
// Of air_table.glsl.
std::vector<Uniform> air_uniforms(const Air& air);
// Of object_fragment.glsl.
std::vector<Uniform> surroundings_uniforms(const ObjectSurroundings& light);
// Of spray_map.glsl.
std::vector<Uniform> spray_uniforms(const Spray& spray);

}  // namespace pelagic
