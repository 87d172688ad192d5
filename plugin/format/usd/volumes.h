// The layer of a shot's volumes: UsdVol prims whose fields are OpenVDB files, one a frame.
//
//   DIR/NAME.volumes.usda          "/Volumes", which the root references as "/ROOT/Volumes"
//   DIR/volumes/NAME.VOLUME.####.vdb
//
// A field's file is a time sample at each frame: USD holds it until the next one.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/format/usd/layers.h"

namespace pelagic::usd {

// The prim that holds the volumes: "/Volumes" in their layer.
inline constexpr std::string_view kVolumesName = "Volumes";

// A grid of a volume's files: "field:NAME", and the grid's name in the file.
struct VolumeField {
    std::string name;         // an identifier
    std::string field_class;  // "fogVolume", "levelSet", "unknown"
    bool is_vector = false;   // of float3, otherwise of float
};

struct Volume {
    std::string prim;         // "Spray"
    std::string file_prefix;  // a frame's file is this, its number and ".vdb", relative to the layer's folder
    std::vector<VolumeField> fields;
    Extent extent{};  // round the volume at all frames [m]
    // Of a fog whose field "density" is its extinction [1/m] and that absorbs nothing: the mean cosine of what it scatters. Such a volume has
    // a material, MaterialX's: UsdPreviewSurface has none for volumes.
    std::optional<float> mean_cosine{};
};

struct VolumeLayer {
    double fps = 24.0;                    // > 0
    int first_frame = 1, last_frame = 1;  // of the shot, both included
    std::vector<int> frames;              // that have files, rising
    std::vector<Volume> volumes;
};

std::string volumes_file(std::string_view shot_name);

// Hands the layer to the sink about a megabyte at a time: it has a line for each frame and field.
void write_volumes_text(const VolumeLayer& layer, const Sink& sink);

}  // namespace pelagic::usd
