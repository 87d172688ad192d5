// The layers of a picture's EXR, beside R, G, B: the light by its source, and what a compositor computes with. One
// table: the files, `--layers` and Python follow it.
//
// Names. Nuke takes `layer.channel` as it stands, Z as depth.Z, forward and backward as its own motion vectors [px].
// Blender reads the same files as multilayer: Z is its pass Depth, each layer a pass, and Vector, in the order and
// with the signs of Cycles, is what its node Vector Blur takes as Speed.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>

#include "core/lighting/lighting.h"

namespace pelagic {

enum class PictureLayer {
    Sun,
    Sky,
    Sea,
    Foam,
    Air,
    Depth,
    Position,
    Normal,
    Motion,
    Vector,
    Coverage,
    Breaking,
    FoamAge,
    SlopeVariance,
    // Of shots with objects
    Object,
    Reflection,
    Shadow,
    Cryptomatte
};

struct PictureLayerRow {
    PictureLayer layer;
    std::string_view name;  // for people: "depth"
    glm::vec3 SeaRadiance::*
        light;     // its share of R, G, B, averaged over the pixel; nullptr: not a layer of the light
    bool is_half;  // of those that aren't light: as half floats
    std::size_t components;                // 1 … 12
    std::array<const char*, 12> channels;  // in the file
    const char* description;               // with its unit
    bool of_objects = false;               // of shots with objects alone
};

// Where there is no sea: a finite depth that is behind everything, as Blender's own.
inline constexpr float kSkyDepth_m = 1e10f;

// clang-format off
inline constexpr auto kPictureLayers = std::to_array<PictureLayerRow>({
    {PictureLayer::Sun, "sun", &SeaRadiance::sun, false, 3, {"sun.R", "sun.G", "sun.B"},
     "the sun's light, reflected"},
    {PictureLayer::Sky, "sky", &SeaRadiance::sky, false, 3, {"sky.R", "sky.G", "sky.B"},
     "the sky's, reflected; beside the sea the sky itself with the sun's disc"},
    {PictureLayer::Sea, "sea", &SeaRadiance::sea, false, 3, {"sea.R", "sea.G", "sea.B"},
     "light from the water"},
    {PictureLayer::Foam, "foam", &SeaRadiance::foam, false, 3, {"foam.R", "foam.G", "foam.B"},
     "light from whitecaps"},
    {PictureLayer::Air, "air", &SeaRadiance::air, false, 3, {"air.R", "air.G", "air.B"},
     "light that the air and the spray before the sea scatter into view; they have dimmed the other layers"},
    {PictureLayer::Depth, "depth", nullptr, false, 1, {"Z"},
     "along the camera's axis [m]; 1e10 in the sky"},
    {PictureLayer::Position, "position", nullptr, false, 3, {"P.X", "P.Y", "P.Z"},
     "of the sea in the world, z up [m]; 0 in the sky"},
    {PictureLayer::Normal, "normal", nullptr, true, 3, {"N.X", "N.Y", "N.Z"},
     "of the waves that the pixel resolves, in the world, unit; 0 in the sky"},
    {PictureLayer::Motion, "motion", nullptr, false, 4, {"forward.u", "forward.v", "backward.u", "backward.v"},
     "from here to where the next frame, and the one before, shows the point: u right, v up [px]"},
    {PictureLayer::Vector, "vector", nullptr, false, 4, {"Vector.X", "Vector.Y", "Vector.Z", "Vector.W"},
     "the same as Blender has it: from here to the frame before, and from the next frame to here [px]"},
    {PictureLayer::Coverage, "coverage", nullptr, true, 1, {"coverage.X"},
     "the share of the sea that whitecaps cover, 0 to 1"},
    {PictureLayer::Breaking, "foam_active", nullptr, true, 1, {"foam_active.X"},
     "the share of the sea where waves break now, 0 to 1; the rest of the coverage is what broke before"},
    {PictureLayer::FoamAge, "foam_age", nullptr, true, 1, {"foam_age.X"},
     "the mean age of the foam that is there [s]; 0 without effects.foam_decay_s"},
    {PictureLayer::SlopeVariance, "slope_variance", nullptr, false, 3,
     {"slope_variance.X", "slope_variance.Y", "slope_variance.Z"},
     "of the waves that the pixel hides: xx, yy and xy of their slopes in the world"},
    {PictureLayer::Object, "object", nullptr, false, 3, {"object.R", "object.G", "object.B"},
     "light from objects", true},
    {PictureLayer::Reflection, "reflection", nullptr, false, 3, {"reflection.R", "reflection.G", "reflection.B"},
     "what the sea mirrors and shows of objects, less what it would have shown in their place: also below 0", true},
    {PictureLayer::Shadow, "shadow", nullptr, true, 1, {"shadow.X"},
     "the share of the sun that no object hides, 0 to 1; 1 in the sky", true},
    {PictureLayer::Cryptomatte, "cryptomatte", nullptr, false, 12,
     {"CryptoObject00.r", "CryptoObject00.g", "CryptoObject00.b", "CryptoObject00.a",
      "CryptoObject01.r", "CryptoObject01.g", "CryptoObject01.b", "CryptoObject01.a",
      "CryptoObject02.r", "CryptoObject02.g", "CryptoObject02.b", "CryptoObject02.a"},
     "a Cryptomatte of the objects and the sea: six ranks of identifier and share of the pixel", true},
});
// clang-format on

inline constexpr std::size_t kPictureLayerCount = kPictureLayers.size();
using PictureLayerSet = std::bitset<kPictureLayerCount>;

constexpr std::size_t index(PictureLayer layer) {
    return static_cast<std::size_t>(layer);
}

// The rows stand in the order of their enumerators.
static_assert([] {
    for (std::size_t i = 0; i < kPictureLayerCount; ++i)
        if (index(kPictureLayers[i].layer) != i) return false;
    return true;
}());

// Those of objects are the last: shots without any leave them out of the text of their layers (picture_files.cpp).
static_assert([] {
    bool of_objects = false;
    for (const PictureLayerRow& row : kPictureLayers) {
        if (of_objects && !row.of_objects) return false;
        of_objects = row.of_objects;
    }
    return true;
}());

// Whether R, G, B are the sum of this and others.
constexpr bool is_light(const PictureLayerRow& row) {
    return row.light || row.layer == PictureLayer::Object || row.layer == PictureLayer::Reflection;
}

// Those that files have unless others are asked for: the light's.
PictureLayerSet light_layers();

// Of these, those that a shot has, with objects or without.
PictureLayerSet layers_of(bool has_objects, PictureLayerSet layers);

// "sun,depth": these alone; "none"; "all". Throws std::invalid_argument, which says what is accepted.
PictureLayerSet parse_picture_layers(const std::string& text);

// What the renderer computes for these beside the light, of shots without objects or with them: floats a pixel.
std::size_t data_components(PictureLayerSet layers);
bool needs_motion(PictureLayerSet layers);

}  // namespace pelagic
