// A shot that bakes in a moment: one small cascade, a mesh with every attribute, two kinds of map.
#pragma once

#include <string>

namespace pelagic::test {

struct SmallShot {
    std::string name = "small";
    int frames = 4;
    int seed = 1;
    int quads = 8;  // per side
    bool mesh = true;
    std::string maps = "\"displacement\", \"whitecaps\"";
    std::string volumes = "";  // of 20 × 20 voxels
};
std::string text_of(const SmallShot& shot);

}  // namespace pelagic::test
