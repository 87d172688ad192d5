// Maps and tiles: the sea over a square of texels, as OpenEXR files.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/waves/whitecaps.h"
#include "plugin/format/exr/exr.h"

namespace pelagic {

// One level of a mip pyramid over a square, n × n texels at the corners of the texels of its own level, y
// rising.
template <class Value>
struct MipLevel {
    int n = 0;
    std::vector<Value> texels;
};

// How coarser texels are made of finer ones: the texel at i·L/n of the coarse level sums the fine ones round
// it under a tent as wide as its own spacing to either side, which keeps corners on corners. Past the edge
// the map goes on where it is periodic; where it isn't, the tent ends there.
struct TentWeights {
    struct Tap {
        int texel;
        double weight;
    };
    std::vector<std::vector<Tap>> taps;  // by coarse texel; each sums to 1
};
TentWeights tent_weights(int fine, int coarse, bool periodic);

// A whole map: n × n texels, the caller's.
template <class Value>
struct FullMap {
    int n = 0;
    std::span<const Value> texels;
    bool periodic = false;
};

// The levels below a whitecap map, the largest first, from the moments of J: mean, variance and third
// cumulant under the tent by the law of total cumulance, never from coverage.
std::vector<MipLevel<JacobianMoments<float>>> moment_mips(const FullMap<JacobianMoments<float>>& full);

// The levels below a map of three quantities that are means already.
std::vector<MipLevel<glm::vec3>> mean_mips(const FullMap<glm::vec3>& full);

// The levels below a map of unit normals, the largest first: the mean normal, unit again. What its shortening
// hides is in the slope-variance map's levels.
std::vector<MipLevel<glm::vec3>> normal_mips(const FullMap<glm::vec3>& full);

}  // namespace pelagic
