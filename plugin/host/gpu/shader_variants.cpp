#include "plugin/host/gpu/shader_variants.h"

#include <algorithm>
#include <utility>

#include "core/lighting/air.h"
#include "core/lighting/foam_structure.h"
#include "core/lighting/lighting.h"
#include "core/lighting/spray.h"
#include "core/plan/taps.h"
#include "plugin/host/gpu/packed_foam.h"
#include "plugin/host/gpu/packed_hulls.h"
#include "plugin/host/gpu/uniforms.h"

namespace pelagic {
namespace {

std::string constant(const char* name, bool value) {
    return std::string("const bool ") + name + " = " + (value ? "true" : "false") + ";\n";
}
std::string constant(const char* name, int value) {
    return std::string("const int ") + name + " = " + std::to_string(value) + ";\n";
}
std::string constant(const char* name, double value) {
    return std::string("const float ") + name + " = " + std::to_string(value) + ";\n";
}

std::vector<std::string_view> joined(std::initializer_list<std::vector<std::string_view>> lists) {
    std::vector<std::string_view> all;
    for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
    return all;
}

// Where the sky's map is, and where the light goes.
const char* sky_file(const DrawOptions& options) {
    return options.for_host ? "plugin/host/gpu/sky_atlas.glsl" : "plugin/host/gpu/sky_texture.glsl";
}
std::vector<std::string_view> output_files(const DrawOptions& options) {
    if (options.for_host) return {"core/lighting/tone.glsl", "plugin/host/gpu/host_outputs.glsl"};
    return {"plugin/host/gpu/sea_outputs.glsl"};
}

// After air.glsl.
std::vector<std::string_view> spray_files(const LightingChoice& lighting) {
    if (!lighting.spray) return {"plugin/host/gpu/spray_none.glsl"};
    return {"plugin/host/gpu/spray_map.glsl", "core/lighting/spray.glsl", "plugin/host/gpu/spray_seen.glsl"};
}

const char* vertex_file(const DrawOptions& options) {
    return options.for_host ? "plugin/host/gpu/host_vertex.glsl" : "plugin/host/gpu/sea_vertex.glsl";
}
const char* shape_file(bool is_shaped, const char* shaped) {
    return is_shaped ? shaped : "plugin/host/gpu/shape_flat.glsl";
}
constexpr const char *kShapeOfVertex = "plugin/host/gpu/shape_vertex.glsl",
                     *kShapeOfFragment = "plugin/host/gpu/shape_fragment.glsl";
constexpr const char* kCrests = "plugin/host/gpu/crests.glsl";
std::vector<std::string_view> mirror_files(bool has_objects, bool for_host = false) {
    if (!has_objects) return {"plugin/host/gpu/sky_alone.glsl"};
    return {for_host ? "plugin/host/gpu/mirror_atlas.glsl" : "plugin/host/gpu/mirror_texture.glsl",
            "plugin/host/gpu/sky_with_objects.glsl"};
}
std::vector<std::string_view> sun_files(bool has_objects, bool for_host = false) {
    if (!has_objects) return {"plugin/host/gpu/sun_alone.glsl"};
    return {for_host ? "plugin/host/gpu/host_shadow_compare.glsl" : "plugin/host/gpu/shadow_compare.glsl",
            "plugin/host/gpu/sun_shadow.glsl"};
}
// Of pictures with objects alone, so that others have the variants that they had.
std::string object_constants(bool has_objects) {
    return has_objects ? constant("kObjects", true) + constant("kObjectBoxes", kObjectBoxes) +
                             constant("kIsObject", kIsObject)
                       : std::string();
}
std::string hull_constants(bool has_objects) {
    return has_objects
               ? constant("kHullColumns", kHullColumns) + constant("kHullPlaceColumns", kHullPlaceColumns) +
                     constant("kHullTexels", kHullTexels) + constant("kHullLevels", Hull::kLevels) +
                     constant("kHullFull_mps", Hulls::kFull_mps)
               : std::string();
}
// What the sea's first or only pass leaves out, and the foam along it.
std::vector<std::string_view> hull_files(bool has_objects, bool for_host) {
    if (!has_objects) return {"plugin/host/gpu/hulls_none.glsl"};
    return {"plugin/host/gpu/hulls.glsl",
            for_host ? "plugin/host/gpu/hulls_left_out.glsl" : "plugin/host/gpu/hulls_behind.glsl"};
}
const char* points_file(const DrawOptions& options) {
    return is_lit_afterwards(options) ? "plugin/host/gpu/sea_points_texture.glsl"
                                      : "plugin/host/gpu/sea_points_in.glsl";
}

// The constants that the shaders of sea and sky share.
std::string picture_constants(const DrawOptions& options) {
    return constant("kLayers", options.layers) + constant("kWireframe", options.wireframe) +
           constant("kFalseColour", static_cast<int>(options.false_colour)) +
           constant("kAirSky", options.sky_from_air) + constant("kFromBelow", options.from_below) +
           constant("kThreadLong_m", kThreadLong_m) + constant("kThreadBroad_m", kThreadBroad_m);
}

std::string foam_constants() {
    return constant("kFoamLevels", FoamPlan::kLevels) + constant("kFoamTileCells", FoamPlan::kTileCells) +
           constant("kFoamTilesAcross", PackedFoam::kTilesAcross);
}

}  // namespace

const std::vector<std::string_view>& lighting_files() {
    static const std::vector<std::string_view> files{"core/lighting/level.glsl",
                                                     "core/lighting/fresnel.glsl",
                                                     "core/lighting/slopes.glsl",
                                                     "core/lighting/sun.glsl",
                                                     "core/lighting/sky.glsl",
                                                     "plugin/host/gpu/floor_uniforms.glsl",
                                                     "core/lighting/floor.glsl",
                                                     "core/base/bubbles.inl",
                                                     "core/lighting/water.glsl",
                                                     "core/lighting/foam.glsl",
                                                     "plugin/host/gpu/foam_uniforms.glsl",
                                                     "core/lighting/foam_structure.glsl",
                                                     "core/lighting/sea.glsl",
                                                     "core/lighting/below.glsl"};
    return files;
}

const std::vector<std::string_view>& query_files() {
    static const std::vector<std::string_view> files{
        "core/lighting/special.glsl",  "plugin/host/gpu/prelude.glsl",
        "core/plan/filter.inl",        "core/plan/masks.inl",
        "core/plan/wake_strip.inl",    "core/plan/taps.inl",
        "core/plan/random_tiling.inl", "core/waves/spline.inl",
        "core/waves/whitecaps.inl",    "core/waves/gusts.inl",
        "core/evaluate/surface.inl",   "core/evaluate/rest_normal.inl",
        "core/waves/trains.inl",       "core/evaluate/unresolved.inl",
        "core/surface/earth.inl",      "core/surface/pixel_footprint.inl",
        "plugin/host/gpu/places.glsl", "plugin/host/gpu/cascades.glsl",
        "plugin/host/gpu/wakes.glsl",  "plugin/host/gpu/trains.glsl",
        "plugin/host/gpu/coast.glsl",  "plugin/host/gpu/gusts.glsl",
        "plugin/host/gpu/masks.glsl",  "plugin/host/gpu/query.glsl"};
    return files;
}

std::string query_constants(const SeaLayout& layout, bool coverage, bool is_shaped) {
    return constant("kShaped", is_shaped) + constant("kCrestFootprint_m", kCrestFootprint_m) +
           constant("kCascades", layout.cascades()) + constant("kVessels", layout.vessels()) +
           constant("kTileCascades", std::max(layout.cascades(), 1)) +
           constant("kCellLevels", static_cast<int>(layout.cells().footprints_m.size())) +
           constant("kPixelLevels", static_cast<int>(layout.pixels().footprints_m.size())) +
           constant("kBreakingLevels", static_cast<int>(layout.breaking().footprints_m.size())) +
           constant("P", layout.sea().plan().knobs.spline_taps) + constant("kChoppy", layout.is_choppy()) +
           constant("kRandomTiling", layout.has_random_tiling()) + constant("kCoverage", coverage) +
           constant("kThirdMoment", layout.sea().plan().knobs.third_moment) +
           constant("kTrains", layout.has_trains()) + constant("kGusts", layout.has_gusts()) +
           constant("kFronts", layout.fronts()) + constant("kFrontRows", layout.front_rows()) +
           constant("kCoast", layout.has_coast()) + constant("kSurf", layout.has_surf()) +
           constant("kCoastRows", layout.coast_rows()) + constant("kCoastRow", layout.coast_row()) +
           constant("kRoller", kRoller) + constant("kLeastSurf", kLeastSurf) +
           constant("kSurfSharpness", kSurfSharpness) + constant("kLogistic", kLogistic) +
           constant("kLeastDeviate", kLeastDeviate) + constant("kFrontBends", Gusts::kBends) +
           constant("kMasks", layout.masks()) + constant("kMaskRows", layout.mask_rows()) +
           constant("kMaskPictures", layout.has_mask_pictures()) + constant("kMasked", layout.is_masked()) +
           constant("kStrips", layout.has_strips()) + constant("kVesselRows", SeaLayout::kVesselRows) +
           constant("kWakeTableRows", SeaLayout::kWakeTableRows) +
           constant("kWakeBox", WakeStrip::kBoxSteps) + constant("kSlopeBlocks", Frame<float>::kSlopeBlocks) +
           constant("kCalmCell", layout.calm_cell()) + constant("kCalmPixel", layout.calm_pixel()) +
           constant("kSlick_m", kSlick_m) + constant("kGustRows", SeaLayout::kGustRows) +
           constant("kGustWaves", GustsPlan::kWaves) + constant("kGustLevelTerms", Gusts::kLevelTerms) +
           constant("kGustKeptTerms", Gusts::kKeptTerms) +
           constant("kNodesALevel", EllipseTable::kNodesALevel) +
           constant("kNodesAnOctave", EllipseTable::kNodesAnOctave) +
           constant("kRatios", EllipseTable::kRatios) + constant("kDirections", EllipseTable::kDirections) +
           constant("kLongestEllipse", layout.sea().plan().knobs.longest_ellipse);
}

std::string lighting_constants(const LightingChoice& choice, int sky_map_size, bool floor_maps) {
    const int lookups = choice.sky_quality == SkyQuality::One    ? 1
                        : choice.sky_quality == SkyQuality::Nine ? 9
                                                                 : 0;
    return constant("kSun", choice.sun) + constant("kSky", choice.sky) + constant("kWater", choice.water) +
           constant("kWhitecaps", choice.whitecaps) + constant("kAir", choice.air) +
           constant("kFoamCell_m", kFoamCell_m) + constant("kFloorColumns", kFloorColumns) +
           constant("kFloorMaps", floor_maps) + constant("kAirColumns", Air::kColumns) +
           constant("kAirRows", Air::kRows) + constant("kAirHorizonRow", Air::kHorizonRow) +
           constant("kAirSkyRows", Air::kSkyRows) + constant("kSkyLookups", lookups) +
           constant("kExactFresnel", choice.fresnel == FresnelFit::Exact) +
           constant("kSecondReflection", choice.second_reflection) +
           constant("kMeshMasking", choice.mesh_masking) +
           "const float kSkyMapSize = " + std::to_string(sky_map_size) + ".0;\n";
}

bool is_lit_afterwards(const DrawOptions& options) {
    return !options.for_host && !options.wireframe && !options.is_shaped;
}

ShaderVariant::ShaderVariant(std::string constants, std::vector<std::string_view> vertex,
                             std::vector<std::string_view> fragment)
    : constants_(std::move(constants)), vertex_(std::move(vertex)), fragment_(std::move(fragment)) {
    key_ = constants_;
    for (const auto* files : {&vertex_, &fragment_})
        for (const std::string_view file : *files) key_ += file;
}

ShaderSource ShaderVariant::source(const std::vector<std::string_view>& files) const {
    ShaderSource source;
    source.add_constants(constants_);
    source.add_files(files);
    return source;
}

ShaderVariant ShaderVariant::of_sea(const SeaLayout& layout, const DrawOptions& options, int sky_map_size) {
    LightingChoice lighting = options.lighting;
    lighting.whitecaps = lighting.whitecaps && layout.has_coverage();
    lighting.sky = lighting.sky && sky_map_size > 0;
    lighting.spray = lighting.spray && !options.for_host;
    const bool coverage =
        layout.has_coverage() && (lighting.whitecaps || options.false_colour == FalseColour::Coverage);
    const bool lives = coverage && layout.has_living_foam();
    const bool has_objects = options.has_objects && !options.from_below;
    return {query_constants(layout, coverage, options.is_shaped) +
                lighting_constants(lighting, sky_map_size, !options.for_host) + picture_constants(options) +
                object_constants(has_objects) + hull_constants(has_objects) +
                (lives ? foam_constants() : std::string()),
            is_lit_afterwards(options)
                ? std::vector<std::string_view>{"plugin/host/gpu/full_vertex.glsl"}
                : joined({query_files(),
                          {shape_file(options.is_shaped, kShapeOfVertex), kCrests, vertex_file(options)}}),
            joined({query_files(),
                    {lives ? "plugin/host/gpu/foam_history.glsl" : "plugin/host/gpu/foam_breaking.glsl"},
                    {"plugin/host/gpu/light_uniforms.glsl", sky_file(options), "core/lighting/sky_map.glsl"},
                    mirror_files(has_objects, options.for_host),
                    lighting_files(),
                    {"plugin/host/gpu/sea_light.glsl", "plugin/host/gpu/air_table.glsl",
                     "core/lighting/air.glsl"},
                    spray_files(lighting),
                    {"core/lighting/place.glsl"},
                    sun_files(has_objects, options.for_host),
                    hull_files(has_objects, options.for_host),
                    {has_objects ? "plugin/host/gpu/objects_in_water.glsl"
                                 : "plugin/host/gpu/objects_in_water_none.glsl",
                     "plugin/host/gpu/rays.glsl"},
                    output_files(options),
                    {"plugin/host/gpu/false_colour.glsl", points_file(options),
                     shape_file(options.is_shaped, kShapeOfFragment), "plugin/host/gpu/sea_fragment.glsl"}})};
}

ShaderVariant ShaderVariant::of_points(const SeaLayout& layout, bool is_shaped, bool has_objects) {
    return {query_constants(layout, false, is_shaped) + hull_constants(has_objects),
            joined({query_files(), {shape_file(is_shaped, kShapeOfVertex), kCrests, vertex_file({})}}),
            joined({query_files(),
                    hull_files(has_objects, false),
                    {"plugin/host/gpu/rays.glsl", "plugin/host/gpu/sea_points_in.glsl",
                     "plugin/host/gpu/sea_points_fragment.glsl"}})};
}

ShaderVariant ShaderVariant::of_sky(const DrawOptions& options, int sky_map_size) {
    LightingChoice lighting = options.lighting;
    lighting.sky = lighting.sky && sky_map_size > 0;
    lighting.spray = lighting.spray && !options.for_host;
    return {lighting_constants(lighting, sky_map_size, !options.for_host) + picture_constants(options),
            {"plugin/host/gpu/full_vertex.glsl"},
            joined({{"core/lighting/special.glsl", "plugin/host/gpu/light_uniforms.glsl", sky_file(options),
                     "core/lighting/sky_map.glsl"},
                    mirror_files(false),
                    lighting_files(),
                    {"plugin/host/gpu/sea_light.glsl", "plugin/host/gpu/air_table.glsl",
                     "core/lighting/air.glsl"},
                    spray_files(lighting),
                    {"core/lighting/background.glsl", "plugin/host/gpu/rays.glsl"},
                    output_files(options),
                    {"plugin/host/gpu/sky_fragment.glsl"}})};
}

ShaderVariant ShaderVariant::of_object(const DrawOptions& options, int sky_map_size, ObjectPicture picture) {
    LightingChoice lighting = options.lighting;
    lighting.sky = lighting.sky && sky_map_size > 0;
    DrawOptions drawn = options;
    drawn.layers = drawn.layers && picture == ObjectPicture::Seen;
    drawn.for_host = false;  // its light, not its colours
    lighting.spray = lighting.spray && !options.for_host;
    return {lighting_constants(lighting, sky_map_size) + picture_constants(drawn) + object_constants(true) +
                constant("kMirrored", picture == ObjectPicture::Mirrored) +
                constant("kInWater", picture == ObjectPicture::InWater),
            {options.has_images ? "plugin/host/gpu/object_image_vertex.glsl"
                                : "plugin/host/gpu/object_plain_vertex.glsl",
             "plugin/host/gpu/object_vertex.glsl"},
            joined({{"core/lighting/special.glsl", "plugin/host/gpu/light_uniforms.glsl", sky_file(options),
                     "core/lighting/sky_map.glsl"},
                    mirror_files(false),
                    lighting_files(),
                    {"plugin/host/gpu/sea_light.glsl", "core/lighting/object.glsl",
                     "plugin/host/gpu/air_table.glsl", "core/lighting/air.glsl"},
                    spray_files(lighting),
                    sun_files(true, options.for_host),
                    output_files(drawn),
                    {options.has_images ? "plugin/host/gpu/object_image_fragment.glsl"
                                        : "plugin/host/gpu/object_plain_fragment.glsl",
                     "plugin/host/gpu/object_fragment.glsl"}})};
}

ShaderVariant ShaderVariant::of_object_shadow() {
    return {
        {}, {"plugin/host/gpu/object_shadow_vertex.glsl"}, {"plugin/host/gpu/object_shadow_fragment.glsl"}};
}

ShaderVariant ShaderVariant::of_drops(bool layers) {
    return {constant("kLayers", layers),
            {"plugin/host/gpu/drops_vertex.glsl"},
            {"core/lighting/spray_drop.glsl", "plugin/host/gpu/rays.glsl", "plugin/host/gpu/sea_outputs.glsl",
             "plugin/host/gpu/drops_fragment.glsl"}};
}

ShaderVariant ShaderVariant::of_screen(bool layers, bool plain) {
    return {constant("kLayers", layers) + constant("kPlain", plain),
            {"plugin/host/gpu/full_vertex.glsl"},
            {"core/lighting/tone.glsl", "plugin/host/gpu/show_fragment.glsl"}};
}

}  // namespace pelagic
