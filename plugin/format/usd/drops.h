// The layers of a shot's drops of spray: points with widths and velocities, a crate for each frame, and the layer whose value clips
// join them.
//
//   DIR/NAME.drops.usda            "/Drops", which the root references as "/ROOT/Drops"
//   DIR/drops/NAME.manifest.usda   names and types of what varies
//   DIR/drops/NAME.####.usdc       one frame's points, a layer that stands by itself as well
//
// Each frame has points of its own: ids say which are the same. Between two frames USD holds the first one's points, but where both
// have as many it mixes them, which means nothing: blur by velocities.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "plugin/format/usd/layers.h"

namespace pelagic::usd {

inline constexpr std::string_view kDropsName = "Drops";

// One frame. All arrays are as long as points. In the world, in metres and seconds of the shot.
struct DropsSample {
    int frame = 1;
    double fps = 24.0;               // > 0
    std::string_view fingerprint{};  // in customLayerData
    std::span<const glm::vec3> points{};
    std::span<const glm::vec3> velocities{};
    std::span<const float> widths{};
    std::span<const float>
        opacities{};  // primvars:displayOpacity: of the middle of a parcel that wide with that section
    std::span<const float>
        sections{};  // primvars:extinctionSection: what its drops take of light's cross-section [m²]
    std::span<const std::int64_t> ids{};
};

struct DropsShot {
    std::string name;                     // of the shot
    double fps = 24.0;                    // > 0
    int first_frame = 1, last_frame = 1;  // of the shot, both included
};

// Paths relative to the root layer's folder.
std::string drops_file(std::string_view shot_name);
std::string drops_manifest_file(std::string_view shot_name);
std::string drops_frame_prefix(std::string_view shot_name);  // before the number and ".usdc"

std::string drops_text(const DropsShot& shot);
std::string drops_manifest_text(const DropsShot& shot);
// Hands each array to the sink in one piece, from the caller's memory. Throws std::invalid_argument for lengths that differ and for
// what isn't finite, before it calls the sink.
void write_drops_crate(const DropsSample& sample, const Sink& sink);

}  // namespace pelagic::usd
