#include "plugin/light/light.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string_view>

#include "core/base/constants.h"
#include "core/lighting/air.h"
#include "core/plan/fingerprint.h"
#include "core/scene/canonical.h"
#include "core/scene/text.h"
#include "core/scene/validate.h"
#include "core/spectrum/possible.h"
#include "core/waves/whitecaps.h"
#include "plugin/format/exr/read.h"

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

// ITU-R BT.709, whose white is D65.
constexpr exr::Chromaticities kRec709{
    .red = {0.64f, 0.33f}, .green = {0.30f, 0.60f}, .blue = {0.15f, 0.06f}, .white = {0.3127f, 0.3290f}};

bool is_in_kcd_m2(const Scene& scene) {
    return scene.light.sky == Light{}.sky;
}

// `problem` may have names from the file in it.
Problem sky_problem(const Scene& scene, const std::string& problem, const std::string& accepted) {
    return {"light.sky", quoted_text(scene.light.sky), line_text(problem), accepted};
}

}  // namespace

Sky make_sky(const Scene& scene) {
    const Light& light = scene.light;
    if (light.sky == Light{}.sky)
        return daylight_sky({.sun_elevation_deg = light.sun_elevation_deg,
                             .sun_azimuth_deg = light.sun_azimuth_deg,
                             .turbidity = light.turbidity});
    try {
        const exr::RgbFile file(light.sky);
        LatLongRows rows{.width = file.width(),
                         .height = file.height(),
                         .rows_in_piece = file.rows_in_piece(),
                         .rotation_rad = std::remainder(light.sky_rotation_deg, 360.0) * kPi / 180.0,
                         .read = [&](int first_row, std::span<glm::vec3> radiance) {
                             file.read(first_row, {&radiance.data()->x, 3 * radiance.size()});
                             for (glm::vec3& value : radiance) value *= static_cast<float>(light.sky_gain);
                         }};
        Sky sky = picture_sky(rows);
        if (light.visibility_km) sky.air = picture_air(sky.map, 1e3 * *light.visibility_km);
        return sky;
    } catch (const exr::ReadError& error) {
        throw std::invalid_argument(text_of(sky_problem(scene, error.problem(), error.accepted())));
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument("light.sky = " + quoted_text(light.sky) + ": " + error.what());
    }
}

std::vector<Problem> check_sky(const Scene& scene) {
    if (scene.light.sky == Light{}.sky) return {};
    try {
        const exr::RgbFile looked_at(scene.light.sky);
        return {};
    } catch (const exr::ReadError& error) {
        return {sky_problem(scene, error.problem(), error.accepted())};
    }
}

std::vector<Problem> check_scene(const Scene& scene) {
    std::vector<Problem> problems = check_sky(scene);
    if (!validate(scene).empty()) return problems;
    for (Problem& problem : impossible_waves(scene.sea)) problems.push_back(std::move(problem));
    return problems;
}

std::string sky_content(const Scene& scene) {
    if (scene.light.sky == Light{}.sky) return {};
    for (const Problem& problem : check_sky(scene)) throw std::invalid_argument(text_of(problem));
    std::ifstream stream(scene.light.sky, std::ios::binary);
    Fingerprint hash;
    std::string piece(std::size_t{1} << 20, '\0');
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0)
        hash.add(std::string_view(piece).substr(0, static_cast<std::size_t>(stream.gcount())));
    if (!stream.eof())
        throw std::invalid_argument(
            text_of(sky_problem(scene, "can't be read", "a lat-long picture in OpenEXR")));
    return hash.text();
}

Scene portable(Scene scene) {
    if (scene.light.sky != Light{}.sky)
        scene.light.sky = std::filesystem::path(scene.light.sky).filename().string();
    return scene;
}

std::string radiance_unit(const Scene& scene) {
    return is_in_kcd_m2(scene) ? "kcd/m2, linear Rec. 709" : "the sky picture's own, linear";
}

std::vector<exr::Attribute> radiance_attributes(const Scene& scene) {
    std::vector<exr::Attribute> attributes{{"unit", radiance_unit(scene)}, {"chromaticities", kRec709}};
    if (is_in_kcd_m2(scene)) attributes.push_back({"whiteLuminance", 1000.0f});  // [cd/m²]
    return attributes;
}

WaterBody make_water(const Scene& scene) {
    return water_body(
        {.kind = kind_of(scene.water.type), .chlorophyll_mg_m3 = scene.water.chlorophyll_mg_m3});
}

std::string light_content(const Scene& scene) {
    Scene light = scene;
    const Effects usual;
    light.effects.foam_structure = usual.foam_structure;
    light.effects.foam_streaks = usual.foam_streaks;
    light.effects.foam_fresh_albedo = usual.foam_fresh_albedo;
    light.effects.foam_old_albedo = usual.foam_old_albedo;
    light.effects.foam_fresh_opacity = usual.foam_fresh_opacity;
    light.effects.foam_old_opacity = usual.foam_old_opacity;
    return canonical(light, key_parts(KeyPart::Light, KeyPart::Water));
}

double active_foam(const Scene& scene, double residual_coverage) {
    const double law = law_coverage(scene);
    return law > 0.0 ? std::clamp(1.0 - residual_coverage / law, 0.0, 1.0) : 1.0;
}

FoamLook make_foam(const Scene& scene, double active) {
    const Effects& effects = scene.effects;
    FoamLook look{.structure = effects.foam_structure,
                  .streaks = effects.foam_streaks,
                  .wind_direction_deg = scene.sea.wind_direction_deg,
                  .fresh_albedo = static_cast<float>(effects.foam_fresh_albedo),
                  .old_albedo = static_cast<float>(effects.foam_old_albedo)};
    constexpr double kMean = 0.4;  // of all ages: Koepke 1984
    // Koepke's patches lose reflectance while they grow; how foam that still breaks compares with what is left isn't told apart
    // there. This makes what breaks as white as dense foam wherever a tenth of the foam does.
    constexpr double kOldOverFresh = 0.4;
    const double left = 1.0 - active;
    double fresh = effects.foam_fresh_opacity, old = effects.foam_old_opacity;
    if (fresh == 0.0)
        fresh = old == 0.0   ? kMean / (active + left * kOldOverFresh)
                : active > 0 ? (kMean - left * old) / active
                             : kMean;
    fresh = std::clamp(fresh, 0.0, 1.0);
    if (old == 0.0) old = left > 0.0 ? std::clamp((kMean - active * fresh) / left, 0.0, 1.0) : fresh;
    look.fresh_opacity = static_cast<float>(fresh);
    look.old_opacity = static_cast<float>(old);
    return look;
}

}  // namespace pelagic
