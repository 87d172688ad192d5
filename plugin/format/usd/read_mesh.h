// Reads back what crate.h and text.h wrote: the mesh's frames and topologies, as crates or as text. Other
// programs' layers are refused: reading all of USD is OpenUSD's work. Nothing here opens a file.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "plugin/format/usd/layers.h"

namespace pelagic::usd {

// what() is the end of a sentence that begins with the file's name: "is cut short".
class ReadError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct MeshArray {
    std::string name;  // USD's: "points", "primvars:st"
    int components = 1;
    std::variant<std::vector<float>, std::vector<std::int32_t>> values{};  // components side by side
};

struct MeshLayer {
    std::optional<double> frame{};  // when its samples are; none: its values don't vary
    std::optional<glm::dvec3> origin_m{};
    std::vector<MeshArray> arrays{};
};

// All arrays of the layer's mesh that layers.h knows, but the extent. They fit together: finite, as long as
// points, faces with corners that exist.
// Throws ReadError for anything else, whatever the bytes are.
MeshLayer read_mesh_layer(std::string_view bytes);

// For read_mesh_layer(): a layer's arrays as they stand there, unchecked but for the file's own structure.
inline constexpr std::string_view kCrateMagic = "PXR-USDC", kTextMagic = "#usda 1.0\n";
MeshLayer read_crate(std::string_view bytes);
MeshLayer read_text(std::string_view bytes);

// Whether it is the one that holds the points' origin.
inline bool is_origin(std::string_view name, std::string_view type) {
    return name == kOrigin && type == kOriginType;
}
// The attribute of this name and type, as text declares it ("point3f[]"); nullopt for others and the extent.
std::optional<VaryingAttribute> mesh_attribute(std::string_view name, std::string_view array_type);
bool is_integer(const VaryingAttribute& attribute);
// Throws ReadError if an array of this name, or the origin, is there already. Asked before another is read: a small file may refer to
// a large array very often.
void refuse_twice(const MeshLayer& layer, std::string_view name);

}  // namespace pelagic::usd
