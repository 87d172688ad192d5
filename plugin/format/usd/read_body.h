// The meshes of a crate (usdc), of any program, where they stand: for bodies that pictures show. What moves stands as its default values
// say.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace pelagic::usd {

// One Mesh prim: metres, z up, its parents' transforms and the layer's upAxis and metersPerUnit applied.
struct BodyMesh {
    std::vector<glm::dvec3> points_m;
    std::vector<std::int32_t> counts,
        indices;                      // of faces, counter-clockwise seen from outside; whole, and in range
    std::vector<glm::dvec3> normals;  // of each corner, of any length; empty: none
    glm::dvec3 colour{0.8};           // linear Rec. 709, 0 … 1
};
struct Body {
    std::vector<BodyMesh> meshes;
    std::vector<std::string> notes;  // what was passed over though it would be seen, a sentence each
};

// Meshes that are visible and of purpose render or default, with faces and a default value of points; displayColor where it is one colour,
// the mean of several. Its faces are those of the cage where it is a subdivision surface. Passed over with a note: references, instances and
// variants, other prims that have a shape, materials. Throws ReadError for what is no whole crate, for arrays that don't fit together, numbers
// that aren't finite, and more than so many corners.
Body read_body(std::string_view bytes, std::size_t most_corners);

}  // namespace pelagic::usd
