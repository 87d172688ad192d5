#include "plugin/light/light.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "core/plan/fingerprint.h"
#include "plugin/exr/read.h"

namespace pelagic {
namespace {

WaterKind kind_of(WaterType type) {
    switch (type) {
        case WaterType::Ocean:
            return WaterKind::Ocean;
        case WaterType::Coastal:
            return WaterKind::Coastal;
        case WaterType::Turbid:
            return WaterKind::Turbid;
    }
    throw std::invalid_argument("water of no type");
}

LatLong read_picture(const std::string& file) {
    const exr::RgbPixels pixels = [&] {
        try {
            return exr::read_rgb(file);
        } catch (const std::runtime_error& error) {
            throw std::invalid_argument(error.what());  // the message names the file
        }
    }();
    LatLong picture{.width = pixels.width, .height = pixels.height, .radiance = {}};
    picture.radiance.reserve(pixels.pixels.size());
    for (const auto& [r, g, b] : pixels.pixels) picture.radiance.emplace_back(r, g, b);
    return picture;
}

}  // namespace

Sky make_sky(const Scene& scene) {
    const Light& light = scene.light;
    if (light.sky == Light{}.sky)
        return daylight_sky({.sun_elevation_deg = light.sun_elevation_deg,
                             .sun_azimuth_deg = light.sun_azimuth_deg,
                             .turbidity = light.turbidity});
    const LatLong picture = read_picture(light.sky);
    try {
        return picture_sky(picture);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(light.sky + ": " + error.what());
    }
}

std::string sky_content(const Scene& scene) {
    if (scene.light.sky == Light{}.sky) return {};
    std::ifstream stream(scene.light.sky, std::ios::binary);
    Fingerprint hash;
    std::string piece(std::size_t{1} << 20, '\0');
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0)
        hash.add(std::string_view(piece).substr(0, static_cast<std::size_t>(stream.gcount())));
    if (!stream.eof())
        throw std::invalid_argument(scene.light.sky + ": can't be read; accepted: a picture in OpenEXR");
    return hash.text();
}

Scene portable(Scene scene) {
    if (scene.light.sky != Light{}.sky)
        scene.light.sky = std::filesystem::path(scene.light.sky).filename().string();
    return scene;
}

std::string radiance_unit(const Scene& scene) {
    return scene.light.sky == Light{}.sky ? "kcd/m2, linear Rec. 709" : "the sky picture's own, linear";
}

WaterBody make_water(const Scene& scene) {
    return water_body(
        {.kind = kind_of(scene.water.type), .chlorophyll_mg_m3 = scene.water.chlorophyll_mg_m3});
}

}  // namespace pelagic
