// A shot that bakes in a moment. See small_shot.h.
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {

std::string text_of(const SmallShot& shot) {
    return "[shot]\nname = \"" + shot.name + "\"\nframes = [1, " + std::to_string(shot.frames) +
           "]\nseed = " + std::to_string(shot.seed) +
           "\n[waves]\ncascades = [ { size_m = 60.0, resolution = 32 } ]\n"
           "[surface]\nsize_m = 40\nresolution = " +
           std::to_string(shot.quads) + "\n[output]\nmesh = \"" + (shot.mesh ? "usda" : "none") +
           "\"\nmaps = [" + shot.maps + "]\nmap_resolution = 8\nvolumes = [" + shot.volumes +
           "]\nvoxel_m = 2\n" + (shot.volumes.empty() ? "" : "[effects]\nspray = true\n");
}

}  // namespace pelagic::test
