// OpenEXR's own reader, for tests: a channel of a level as floats, rows by rising y.
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfTiledInputFile.h>

#include <filesystem>
#include <string>
#include <vector>

namespace pelagic::test {

struct Plane {
    int n = 0;
    std::vector<float> values;  // y rising, x fastest
    float at(int x, int y) const { return values[static_cast<std::size_t>(y) * n + x]; }
};

inline Plane upside_down(const Plane& plane) {
    Plane turned{plane.n, {}};
    for (int y = plane.n - 1; y >= 0; --y)
        turned.values.insert(turned.values.end(), plane.values.begin() + y * plane.n,
                             plane.values.begin() + (y + 1) * plane.n);
    return turned;
}

inline Imf::Slice slice_into(Plane& plane) {
    return Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.values.data()), sizeof(float),
                      sizeof(float) * static_cast<std::size_t>(plane.n));
}

inline Plane read_scanlines(const std::filesystem::path& path, const std::string& channel) {
    Imf::InputFile file(path.c_str());
    Plane plane{file.header().dataWindow().max.x + 1, {}};
    plane.values.resize(static_cast<std::size_t>(plane.n) * plane.n);
    Imf::FrameBuffer buffer;
    buffer.insert(channel, slice_into(plane));
    file.setFrameBuffer(buffer);
    file.readPixels(0, plane.n - 1);
    return upside_down(plane);
}

inline Plane read_level(const std::filesystem::path& path, const std::string& channel, int level) {
    Imf::TiledInputFile file(path.c_str());
    Plane plane{file.levelWidth(level), {}};
    plane.values.resize(static_cast<std::size_t>(plane.n) * plane.n);
    Imf::FrameBuffer buffer;
    buffer.insert(channel, slice_into(plane));
    file.setFrameBuffer(buffer);
    file.readTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    return upside_down(plane);
}

}  // namespace pelagic::test
