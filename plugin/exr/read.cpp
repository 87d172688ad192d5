#include "plugin/exr/read.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <stdexcept>
#include <string>

namespace pelagic::exr {
namespace {

constexpr int kLargestSide = 32768;  // [pixels] 16 times a usual sky's; damaged headers may claim anything

// Why a file is refused. read_rgb() adds its name.
struct Refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

std::string channel_names(const Imf::ChannelList& channels) {
    std::string names;
    for (auto c = channels.begin(); c != channels.end(); ++c)
        names += (names.empty() ? "" : ", ") + std::string(c.name());
    return names.empty() ? "none" : names;
}

// The channels of red, green and blue.
std::array<const char*, 3> rgb_channels(const Imf::ChannelList& channels) {
    const auto has = [&](const char* name) { return channels.findChannel(name) != nullptr; };
    std::array<const char*, 3> names{"R", "G", "B"};
    const bool grey = has("Y") && !has("RY") && !has("BY");
    if (!(has("R") && has("G") && has("B"))) {
        if (!grey)
            throw Refusal("has the channels " + channel_names(channels) +
                          "; R, G, B or Y alone are accepted");
        names.fill("Y");
    }
    for (const char* name : names) {
        const Imf::Channel& channel = channels[name];
        if (channel.type != Imf::HALF && channel.type != Imf::FLOAT)
            throw Refusal("has integers in channel " + std::string(name) + "; half and float are accepted");
        if (channel.xSampling != 1 || channel.ySampling != 1)
            throw Refusal("has fewer samples than pixels in channel " + std::string(name) +
                          "; one sample a pixel is accepted");
    }
    return names;
}

RgbPixels read_first_part(const std::string& path) {
    Imf::MultiPartInputFile file(path.c_str(), 0);
    const Imf::Header& header = file.header(0);
    if (header.hasType() && Imf::isDeepData(header.type()))
        throw Refusal("has deep pixels; flat ones, as scan lines or tiles, are accepted");
    const std::array<const char*, 3> names = rgb_channels(header.channels());

    const Imath::Box2i window = header.dataWindow();
    if (window != header.displayWindow())
        throw Refusal(
            "holds only a part of its picture, or more (its data window isn't its display window); "
            "whole pictures are accepted");
    // 64-bit: corners may lie anywhere in the range of int.
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width > kLargestSide || height > kLargestSide)
        throw Refusal("is " + std::to_string(width) + " x " + std::to_string(height) +
                      " pixels; up to 32768 a side are accepted");

    RgbPixels out{static_cast<int>(width), static_cast<int>(height), {}};
    out.pixels.resize(static_cast<std::size_t>(width * height));
    // The library reads each channel into one slice only: a grey one is copied.
    const bool grey = names[0] == names[1];
    Imf::FrameBuffer buffer;
    constexpr std::size_t kStep = sizeof(std::array<float, 3>);
    for (std::size_t c = 0; c < (grey ? 1u : 3u); ++c)
        buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, out.pixels.data()->data() + c, window, kStep,
                                                 kStep * static_cast<std::size_t>(width)));
    Imf::InputPart part(file, 0);
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
    if (grey)
        for (auto& pixel : out.pixels) pixel[1] = pixel[2] = pixel[0];
    return out;
}

}  // namespace

RgbPixels read_rgb(const std::filesystem::path& path) {
    try {
        return read_first_part(path.string());
    } catch (const Refusal& refusal) {
        throw std::runtime_error("'" + path.string() + "' " + refusal.what());
    } catch (const std::exception& error) {
        throw std::runtime_error("'" + path.string() +
                                 "' can't be read as an OpenEXR picture: " + error.what() +
                                 "; accepted is a whole file of half or float channels R, G, B or Y");
    }
}

bool ends_whole(const std::filesystem::path& file) {
    try {
        Imf::InputFile input(file.c_str());
        if (!input.isComplete()) return false;
        // Lines are written from the top: the last one stands at the file's end.
        const char* data = nullptr;
        int bytes = 0;
        input.rawPixelData(input.header().dataWindow().max.y, data, bytes);
        return bytes > 0;
    } catch (const std::exception&) {
        return false;
    }
}

}  // namespace pelagic::exr
