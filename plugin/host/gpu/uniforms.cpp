#include "plugin/host/gpu/uniforms.h"

#include "core/lighting/background.h"

namespace pelagic {
namespace {

Uniform number(const char* name, double value) {
    return {name, 1, glm::vec4(static_cast<float>(value), 0.0f, 0.0f, 0.0f)};
}
Uniform vector(const char* name, const glm::vec3& value) {
    return {name, 3, glm::vec4(value, 0.0f)};
}

}  // namespace

std::vector<Uniform> query_uniforms(const SeaLayout& layout) {
    std::vector<Uniform> uniforms{
        number("whitecap_threshold", layout.sea().whitecap_threshold()),
        number("breaking_footprint_m", layout.sea().plan().breaking.footprint_m),
        {"finest_m", 2,
         glm::vec4(static_cast<float>(layout.cells().footprints_m.front()),
                   static_cast<float>(layout.pixels().footprints_m.front()), 0.0f, 0.0f)}};
    const FootprintFilter& filter = layout.sea().plan().filter;
    if (layout.has_gusts())
        uniforms.push_back({"gust_filter", 2,
                            glm::vec4(static_cast<float>(filter.n_min),
                                      static_cast<float>(1.0 / (filter.n_max - filter.n_min)), 0.0f, 0.0f)});
    if (!layout.has_trains()) return uniforms;
    uniforms.push_back({.name = "train_count",
                        .value = glm::vec4(static_cast<float>(layout.sea().trains().count())),
                        .is_integer = true});
    uniforms.push_back(
        {"train_filter", 4,
         glm::vec4(static_cast<float>(filter.n_min), static_cast<float>(1.0 / (filter.n_max - filter.n_min)),
                   static_cast<float>(1.0 / filter.n_max), static_cast<float>(1.0 / filter.n_min))});
    return uniforms;
}

std::vector<Uniform> light_uniforms(const Sky& sky) {
    const SunDisc disc = sun_disc(sky);
    return {vector("sun_direction", sky.sun_direction),
            vector("sun_radiance", sky.sun_radiance),
            number("sun_angular_radius", static_cast<double>(sky.sun_angular_radius)),
            vector("sun_irradiance", sky.sun_irradiance),
            vector("sun_centre", disc.centre),
            vector("sun_low", disc.low),
            vector("sun_middle", disc.middle),
            vector("sun_high", disc.high),
            vector("sky_irradiance", sky.sky_irradiance)};
}

std::vector<Uniform> water_uniforms(const WaterBody& water) {
    return {vector("water_reflectance", water.reflectance),
            vector("water_absorption_shorter", water.absorption.shorter),
            vector("water_absorption_longer", water.absorption.longer),
            vector("water_backscatter_shorter", water.backscatter.shorter),
            vector("water_backscatter_longer", water.backscatter.longer),
            vector("water_scattering_shorter", water.scattering.shorter),
            vector("water_scattering_longer", water.scattering.longer),
            vector("water_floor_shorter", water.floor_colour.shorter),
            vector("water_floor_longer", water.floor_colour.longer),
            vector("water_waves", water.waves),
            {"water_body_look", 4,
             glm::vec4(water.has_body ? 1.0f : 0.0f, water.floor_m, water.crest_light, water.crest_per_m)},
            {"water_bubbles", 2, glm::vec4(water.bubbles, water.bubbles_m, 0.0f, 0.0f)}};
}

std::vector<Uniform> floor_uniforms(const FloorSeen& floor) {
    return {{"floor_level", 4,
             glm::vec4(floor.is_seen ? 1.0f : 0.0f, floor.z_m, floor.curvature_per_m, floor.pixel)},
            number("floor_lowest_m", static_cast<double>(floor.lowest_m)),
            {"floor_depths", 4, floor.depths},
            {"floor_depths_per_m", 4, floor.depths_per_m},
            {"floor_colours", 4, floor.colours},
            number("floor_colours_first", static_cast<double>(floor.colours_first)),
            {"floor_light_maps", 4, floor.light},
            {"floor_coarse", 4, floor.coarse},
            {"floor_shafts", 4, floor.shafts},
            vector("floor_shafts_look", floor.shafts_look)};
}

std::vector<Uniform> foam_uniforms(const FoamPattern& pattern) {
    return {vector("foam_pattern_cell", pattern.cell),
            vector("foam_pattern_rest", pattern.rest),
            {"foam_pattern_axes", 4, pattern.axes},
            {"foam_pattern_look", 4, pattern.look},
            {"foam_pattern_white", 2, glm::vec4(pattern.white, 0.0f, 0.0f)},
            {"foam_pattern_image", 4, pattern.image}};
}

std::vector<Uniform> air_uniforms(const Air& air) {
    return {{"air_azimuth", 2, glm::vec4(air.azimuth, 0.0f, 0.0f)},
            vector("air_to_sun", air.to_sun),
            number("air_by_place", static_cast<double>(air.by_place)),
            vector("air_reach_m", {air.nearest_m, air.horizon_m, air.farthest_m}),
            {"air_sky_rows", 2, glm::vec4(air.dip, air.sky_span, 0.0f, 0.0f)}};
}

std::vector<Uniform> surroundings_uniforms(const ObjectSurroundings& light) {
    return {vector("object_flat_part", light.flat_part),
            vector("object_x", light.x),
            vector("object_y", light.y),
            vector("object_z", light.z),
            vector("object_xy", light.xy),
            vector("object_yz", light.yz),
            vector("object_zz", light.zz),
            vector("object_xz", light.xz),
            vector("object_xx_yy", light.xx_yy),
            vector("object_water", light.water)};
}

std::vector<Uniform> spray_uniforms(const Spray& spray) {
    return {vector("spray_azimuth", glm::vec3(spray.azimuth, spray.columns_per_rad)),
            vector("spray_rows", glm::vec3(spray.first_m, spray.row_step, spray.eye_m)),
            {.name = "spray_is_torn", .value = glm::vec4(spray.is_torn ? 1.0f : 0.0f), .is_integer = true},
            vector("spray_scales", {spray.scale_m, spray.step_m, spray.haze_per_m}),
            vector("spray_forward", glm::vec3(spray.forward, 0.0f)),
            number("spray_top_m", static_cast<double>(spray.top_m)),
            vector("spray_to_sun", spray.to_sun),
            vector("spray_sun", spray.sun),
            vector("spray_above", spray.above),
            vector("spray_below", spray.below),
            vector("spray_low_ahead", spray.low_ahead),
            vector("spray_low_beside", spray.low_beside),
            vector("spray_low_behind", spray.low_behind),
            {"spray_threads_cell", 4, spray.threads.cell},
            {"spray_threads_wind", 4, spray.threads.wind},
            {"spray_threads_born", 4, spray.threads.born},
            {"spray_threads_look", 4,
             glm::vec4(spray.threads.names, spray.threads.per_m, spray.threads.pixel_rad)}};
}

}  // namespace pelagic
