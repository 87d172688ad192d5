#include "plugin/render/picture_files.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <tuple>
#include <utility>

#include "core/lighting/air.h"
#include "core/lighting/primaries.h"
#include "core/lighting/tone.h"
#include "core/plan/effects.h"
#include "core/plan/fingerprint.h"
#include "core/scene/canonical.h"
#include "core/scene/keys.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/surface/view.h"
#include "pelagic/version.h"
#include "plugin/format/exr/exr.h"
#include "plugin/format/png/png.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/render/cryptomatte.h"
#include "plugin/render/drawn_sea.h"
#include "plugin/render/glare.h"
#include "plugin/render/passes.h"
#include "plugin/run/part.h"
#include "plugin/run/seals.h"

namespace pelagic {
namespace {

constexpr float kLargestHalf = 65504.0f;

float largest(glm::vec3 c) {
    return std::max({c.x, c.y, c.z});
}

// Whether some camera of the shot sees places whose sun is higher than that below it (core/lighting/place.glsl).
bool sees_other_suns(const Scene& scene, const Sky& sky) {
    const auto is_high = [](const glm::dvec3& position_m) { return position_m.z > kLightByPlaceFrom_m; };
    return sky.air && scene.surface.earth_curvature &&
           (is_high(scene.camera.position_m) ||
            std::any_of(scene.camera.keys.begin(), scene.camera.keys.end(),
                        [&](const CameraKey& key) { return is_high(key.position_m); }));
}

// Whether the sun's light, and all of the light, fits into halves: nothing that the sea sends back is
// brighter than what falls on it, nor than a white surface under it.
struct Ranges {
    exr::PixelType sun, whole;
};

// Radiance over the sun's and its radius squared: π times the largest value of what droplets scatter ahead, small ones and large.
constexpr float kMostOfSpray = 20.6f, kMostOfTornSpray = 101.0f;

Ranges ranges_of(const Scene& scene, const Sky& sky, bool has_spray) {
    if (sees_other_suns(scene, sky)) return {.sun = exr::PixelType::Float, .whole = exr::PixelType::Float};
    const auto type = [](float most) {
        return most < kLargestHalf ? exr::PixelType::Half : exr::PixelType::Float;
    };
    float most = largest(sky.sun_irradiance + sky.sky_irradiance);
    double glow_cd_m2 = 0.0;
    for (const SceneObject& object : scene.objects) glow_cd_m2 = std::max(glow_cd_m2, object.glow_cd_m2);
    most += static_cast<float>(1e-3 * glow_cd_m2);
    // Before the sun itself spray is brighter than a white surface.
    if (has_spray)
        most += (scene.effects.spray_law == SpraySource::Monahan1986 ? kMostOfSpray : kMostOfTornSpray) *
                largest(sky.sun_radiance) * sky.sun_angular_radius * sky.sun_angular_radius;
    if (sky.map.level_count() > 0)
        for (const glm::vec3& texel : sky.map.level(0)) most = std::max(most, largest(texel));
    // The air takes less from the disc's upper limb than from the mean.
    const glm::vec3 limb = glm::max(glm::max(sky.limb_low, sky.limb_middle), glm::max(sky.limb_high, 1.0f));
    return {.sun = type(most + largest(limb * sky.sun_radiance)), .whole = type(most)};
}

std::string objects_text(const Scene& scene) {
    if (scene.objects.empty()) return "";
    const bool has_lamps = std::any_of(scene.objects.begin(), scene.objects.end(),
                                       [](const SceneObject& object) { return object.glow_cd_m2 > 0.0; });
    return " objects " + std::to_string(kObjectsRevision) +
           (has_lamps ? " lamps " + std::to_string(kLampsRevision) : "");
}

// What a picture depends on, besides the camera at its frame.
KeyPartSet parts_beside_the_view(const RenderOptions& options) {
    KeyPartSet fed = key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Grid, KeyPart::Light, KeyPart::Water,
                               KeyPart::Objects);
    for (const EffectRow& row : effect_table()) fed |= row.key_parts;
    if (options.lighting.spray) fed |= key_parts(KeyPart::Spray);
    return fed;
}

std::array<float, 3> packed(glm::vec3 v) {
    return {v.x, v.y, v.z};
}

// Which pixels there are, where it isn't the display window's own; with an overscan those are others, too.
std::string window_text(glm::ivec2 display, const RenderOptions& options) {
    const PixelWindow data = data_window(display, options);
    if (data == PixelWindow{.high = display} && options.overscan_px == glm::ivec2(0)) return {};
    std::string text = " window";
    for (const glm::ivec2 at : {options.overscan_px, data.low, data.high})
        text += ' ' + std::to_string(at.x) + ' ' + std::to_string(at.y);
    return text;
}

// The light's layers of a shot with objects or without as they stand in a sentence.
std::string light_names(bool has_objects) {
    std::string names, last;
    for (const PictureLayerRow& row : kPictureLayers) {
        if (!is_light(row) || (row.of_objects && !has_objects)) continue;
        if (!last.empty()) names += (names.empty() ? "" : ", ") + last;
        last = row.name;
    }
    return names + " and " + last;
}

// Right, up and forward become x, y and z: OpenEXR's camera space, which is left-handed.
glm::dmat4 camera_from_world(const View& view) {
    const glm::dmat3 turned = glm::transpose(glm::dmat3(view.right, view.up, view.forward));
    return glm::dmat4(turned) * glm::translate(glm::dmat4(1.0), -view.position_m);
}

// (0, 0) is the picture's upper left corner, (1, 1) its lower right one; z is 1 - 1 m over the distance along the axis.
glm::dmat4 ndc_from_world(const View& view) {
    const glm::dvec2 size = 2.0 * view.half_tangents() * glm::dvec2(1.0, -1.0);
    const glm::dvec2 offset = 0.5 - view.middle_tangents() / size;
    glm::dmat4 ndc_from_camera(0.0);  // columns
    ndc_from_camera[0][0] = 1.0 / size.x;
    ndc_from_camera[1][1] = 1.0 / size.y;
    ndc_from_camera[2] = glm::dvec4(offset, 1.0, 1.0);
    ndc_from_camera[3][2] = -1.0;
    return ndc_from_camera * camera_from_world(view);
}

exr::Matrix packed(const glm::dmat4& matrix) {
    exr::Matrix rows;  // of row vectors: our columns
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) rows[i][j] = static_cast<float>(matrix[i][j]);
    return rows;
}

// What a picture's file says of all that its layers don't.
std::vector<exr::Attribute> common_attributes(const PictureContext& context, int frame,
                                              const std::string& content, const std::string& name) {
    const Scene scene = portable(context.scene);
    const View view = view_at(scene.camera, frame);
    std::vector<exr::Attribute> attributes{
        {"content", content},
        {"time", scene.shot.time_s(frame)},
        {"fps", scene.shot.fps},
        {"frame", frame},
        {"cameraPosition_m", packed(glm::vec3(view.position_m))},
        {"cameraForward", packed(glm::vec3(view.forward))},
        {"horizontalFieldOfView_deg", view.fov_deg()},
        {"worldToCamera", packed(camera_from_world(view))},
        {"worldToNDC", packed(ndc_from_world(view))},
        {"framesPerSecond", exr::FramesPerSecond{scene.shot.fps}},
        {"sunDirection", packed(context.sky.sun_direction)},
        {"exposure", static_cast<double>(context.exposure)},
        {"samplesPerPixel", context.options.samples * context.options.samples},
        {"shutter_frames", context.options.shutter_frames},
        {"fingerprint", context.made_of},
        {"software", std::string("pelagic " PELAGIC_VERSION)}};
    constexpr int kDay_s = 24 * 3600;
    if (const int fps = static_cast<int>(std::lround(scene.shot.fps));
        frame >= 0 && fps >= 1 && fps <= 30 && frame / fps < kDay_s)
        attributes.push_back({"timeCode", exr::TimeCode{frame, fps}});
    if (!context.chosen.empty()) attributes.push_back({"chosen", context.chosen});
    for (exr::Attribute& attribute : radiance_attributes(scene, context.colours.acescg))
        attributes.push_back(std::move(attribute));
    for (exr::Attribute& attribute : seal_attributes(name)) attributes.push_back(std::move(attribute));
    // The camera is described above, as it is at this frame.
    describe(scene, parts_beside_the_view(context.options), attributes);
    // The sea between two keys is no sea of plain numbers.
    for (const KeyedNumber& number : context.shot ? context.shot->keyed : std::vector<KeyedNumber>())
        for (exr::Attribute& attribute : attributes)
            if (const Key& key = key_of(table_key(number));
                is_of_sea(number) && attribute.name == "pelagic." + key.path)
                attribute.value = value_text(key, value_of(*context.shot, key));
    return attributes;
}

std::vector<std::pair<std::string, std::string>> mattes_of(const Scene& scene) {
    std::vector<std::string> names;
    for (const SceneObject& object : scene.objects) names.push_back(object.called());
    return matte_attributes(names);
}

std::vector<exr::Attribute> attributes_of(const PictureContext& context, int frame) {
    const Scene& scene = context.scene;
    std::vector<exr::Attribute> attributes = common_attributes(
        context, frame, "radiance; the layers " + light_names(!scene.objects.empty()) + " add up to R, G, B",
        picture_file(scene.shot, frame, "exr"));
    const PictureLayerSet layers = layers_of(!scene.objects.empty(), context.options.layers);
    for (const PictureLayerRow& row : kPictureLayers)
        if (!row.light && layers[index(row.layer)])
            attributes.push_back({"layer." + std::string(row.name), std::string(row.description)});
    if (layers[index(PictureLayer::Cryptomatte)])
        for (auto& [name, value] : mattes_of(scene)) attributes.push_back({name, value});
    return attributes;
}

// One digit a layer, those of objects where a shot has some: other shots' pictures stay whole.
std::string layers_text(const Scene& scene, PictureLayerSet layers) {
    const std::string all = layers.to_string();  // the last layer first
    const auto of_objects =
        static_cast<std::size_t>(std::count_if(kPictureLayers.begin(), kPictureLayers.end(),
                                               [](const PictureLayerRow& row) { return row.of_objects; }));
    return scene.objects.empty() ? all.substr(of_objects) : all;
}

}  // namespace

std::string picture_file(const Shot& shot, int frame, const char* extension) {
    return FilePattern{shot.name + '.', std::string(".") + extension}.file(frame);
}

std::string deep_file(const Shot& shot, int frame) {
    return FilePattern{shot.name + ".deep.", ".exr"}.file(frame);
}

PictureFingerprint::PictureFingerprint(const PictureSource& source)
    : shot_(source.scene.shot), camera_(source.scene.camera), options_(source.options) {
    keyed_.keyed = source.scene.keyed;
    const LightingChoice& lighting = options_.lighting;
    const auto digit = [](auto value) { return std::to_string(static_cast<int>(value)); };
    // What the plan says of a view is the same whichever frames it is for.
    const Plan plan = picture_plan(source.scene, std::array{source.scene.shot.first_frame}, options_);
    Fingerprint hash;
    hash.add(source.drawn_by_gpu ? "drawn picture" : "picture")
        .add("revision " + std::to_string(kPictureRevision))
        .add(source.scene.shot.name)  // a picture says its own file's name
        .add(canonical(portable(without_keyed(source.scene)), parts_beside_the_view(options_)))
        .add(plan_text(plan, 0))
        .add(source.picture_content)
        .add("samples " + std::to_string(options_.samples) + " terms " + digit(lighting.sun) +
             digit(lighting.sky) + digit(lighting.water) + digit(lighting.whitecaps) + digit(lighting.air) +
             " sky " + digit(lighting.sky_quality) + " fresnel " + digit(lighting.fresnel))
        .add("exposure " + number_text(source.exposure_stops))
        .add(source.colours.shown_by + (source.colours.acescg ? " acescg" : ""))
        .add("shutter " + number_text(options_.shutter_frames) + (options_.alpha ? " alpha" : "") +
             " layers " + layers_text(source.scene, options_.layers) +
             (lighting.spray ? " smooth spray" : "") + objects_text(source.scene) +
             window_text(source.scene.camera.resolution, options_));
    if (plan.from->weather) {
        hash.add(weather_plan_text(plan, true));
        weather_ = plan;
    }
    if (const DrawnSea drawn(*plan.from, false); !drawn.made_of().empty()) hash.add(drawn.made_of());
    for (const View& view : metered_views(source.scene))
        hash.add(pose_text(view));  // what the exposure comes from
    source_ = hash.text();
}

std::string PictureFingerprint::of(int frame) const {
    Fingerprint hash;
    hash.add(source_).add("frame " + std::to_string(frame));
    if (!keyed_.keyed.empty()) hash.add(keyed_text(keyed_, parts_beside_the_view(options_), frame));
    for (const PicturePass& pass : passes_of(camera_, frame, options_).all) {
        hash.add(pose_text(view_of(camera_, pass)));
        if (weather_) hash.add(weather_time_text(*weather_, 0, shot_.time_s(pass.frame)));
        // Which time of a loop a frame shows isn't in any key.
        if (shot_.loop_s > 0.0) hash.add("time " + number_text(shot_.time_s(pass.frame)));
    }
    if (needs_motion(options_.layers))
        for (const double beside : {frame - 1.0, frame + 1.0}) hash.add(pose_text(view_at(camera_, beside)));
    return hash.text();
}

namespace {

// What encode_png() needs of those pixels.
Picture cut_to(const Picture& picture, const PixelWindow& window) {
    Picture cut{.resolution = window.size(), .layers = {}, .sea = {}};
    cut.low = window.low;
    cut.display = picture.display;
    const auto width = static_cast<std::size_t>(picture.resolution.x),
               cut_width = static_cast<std::size_t>(cut.resolution.x);
    const glm::ivec2 from = window.low - picture.low;
    const auto first = [&](int row) {
        return width * static_cast<std::size_t>(from.y + row) + static_cast<std::size_t>(from.x);
    };
    for (int row = 0; row < cut.resolution.y; ++row) {
        const auto take = [&](const auto& values, auto& to, std::size_t components = 1) {
            if (values.empty()) return;
            const auto begin = values.begin() + static_cast<std::ptrdiff_t>(components * first(row));
            to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(components * cut_width));
        };
        take(picture.layers, cut.layers);
        take(picture.alpha, cut.alpha);
        for (const PictureLayer layer : {PictureLayer::Object, PictureLayer::Reflection})
            take(picture.data[index(layer)], cut.data[index(layer)], 3);
        auto both = std::lower_bound(picture.skyline.begin(), picture.skyline.end(), first(row),
                                     [](const SkylinePixel& of, std::size_t i) { return of.pixel < i; });
        for (; both != picture.skyline.end() && both->pixel < first(row) + cut_width; ++both) {
            cut.skyline.push_back(*both);
            cut.skyline.back().pixel = cut_width * static_cast<std::size_t>(row) + (both->pixel - first(row));
        }
    }
    return cut;
}

}  // namespace

std::string encode_exr(const PictureContext& context, const Picture& rendered, int frame) {
    Picture converted;
    if (context.colours.acescg) {
        converted = rendered;
        const glm::mat3 to_acescg(conversion(kRec709, kAcesCg));
        for (SeaRadiance& layers : converted.layers)
            for (const PictureLayerRow& row : kPictureLayers)
                if (row.light) layers.*row.light = to_acescg * (layers.*row.light);
        for (const PictureLayer layer : {PictureLayer::Object, PictureLayer::Reflection}) {
            std::vector<float>& of = converted.data[index(layer)];
            for (std::size_t i = 0; i + 2 < of.size(); i += 3) {
                const glm::vec3 light = to_acescg * glm::vec3(of[i], of[i + 1], of[i + 2]);
                for (int c = 0; c < 3; ++c) of[i + c] = light[c];
            }
        }
    }
    const Picture& picture = context.colours.acescg ? converted : rendered;
    const auto width = static_cast<std::ptrdiff_t>(picture.resolution.x);
    const std::ptrdiff_t height = picture.resolution.y;
    std::vector<glm::vec3> sum(picture.layers.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = light_of(picture, i);

    const Ranges ranges = ranges_of(context.scene, context.sky, context.options.lighting.spray);
    exr::Image image{.width = picture.resolution.x,
                     .height = picture.resolution.y,
                     .channels = {},
                     .x = picture.low.x,
                     .y = picture.low.y};
    if (picture.display) image.display = {picture.display->x, picture.display->y};
    // Rows from the top, where the writer counts from the bottom: from the last row backwards.
    const auto add = [&](std::span<const char* const> names, const float& first, std::ptrdiff_t pixel_bytes,
                         exr::PixelType type) {
        const auto* last_row = reinterpret_cast<const float*>(reinterpret_cast<const char*>(&first) +
                                                              pixel_bytes * width * (height - 1));
        for (std::size_t c = 0; c < names.size(); ++c)
            image.channels.push_back({.name = names[c],
                                      .data = last_row + c,
                                      .pixel_stride_bytes = pixel_bytes,
                                      .row_stride_bytes = -pixel_bytes * width,
                                      .type = type});
    };
    constexpr std::array kColours{"R", "G", "B"};
    constexpr std::array kAlpha{"A"};
    add(kColours, sum.front().x, sizeof(glm::vec3), ranges.sun);
    if (!picture.alpha.empty()) add(kAlpha, picture.alpha.front(), sizeof(float), exr::PixelType::Half);
    const PictureLayerSet layers = layers_of(!context.scene.objects.empty(), context.options.layers);
    for (const PictureLayerRow& row : kPictureLayers) {
        if (!layers[index(row.layer)]) continue;
        const std::span names(row.channels.data(), row.components);
        if (row.light) {
            // The sky's has the disc beside the sea.
            const bool is_sun = row.layer == PictureLayer::Sun || row.layer == PictureLayer::Sky;
            add(names, (picture.layers.front().*row.light).x, sizeof(SeaRadiance),
                is_sun ? ranges.sun : ranges.whole);
        } else {
            add(names, picture.data[index(row.layer)].front(),
                static_cast<std::ptrdiff_t>(sizeof(float) * row.components),
                is_light(row) ? ranges.sun
                : row.is_half ? exr::PixelType::Half
                              : exr::PixelType::Float);
        }
    }
    const exr::Header header{.attributes = attributes_of(context, frame),
                             .compression = exr::Compression::Zip};
    std::string file = exr::encode_scanline(header, image);
    seal(file);
    return file;
}

std::string encode_deep(const PictureContext& context, const Picture& picture, int frame) {
    std::vector<DeepSample> converted;
    if (context.colours.acescg) {
        const glm::mat3 to_acescg(conversion(kRec709, kAcesCg));
        converted = picture.deep.samples;
        for (DeepSample& sample : converted) sample.light = to_acescg * sample.light;
    }
    const std::vector<DeepSample>& samples = context.colours.acescg ? converted : picture.deep.samples;
    exr::DeepImage image{.width = picture.resolution.x,
                         .height = picture.resolution.y,
                         .counts = picture.deep.counts,
                         .channels = {},
                         .x = picture.low.x,
                         .y = picture.low.y};
    if (picture.display) image.display = {picture.display->x, picture.display->y};
    constexpr DeepSample kNone;
    const DeepSample& first = samples.empty() ? kNone : samples.front();
    const exr::PixelType light = ranges_of(context.scene, context.sky, context.options.lighting.spray).sun;
    for (const auto& [name, data, type] : {std::tuple("R", &first.light.x, light),
                                           {"G", &first.light.y, light},
                                           {"B", &first.light.z, light},
                                           {"A", &first.alpha, exr::PixelType::Float},
                                           {"Z", &first.z_m, exr::PixelType::Float},
                                           {"ZBack", &first.z_back_m, exr::PixelType::Float},
                                           {"id", &first.id, exr::PixelType::Float}})
        image.channels.push_back(
            {.name = name, .data = data, .pixel_stride_bytes = sizeof(DeepSample), .type = type});
    exr::Header header{
        .attributes = common_attributes(
            context, frame,
            "deep radiance times alpha; laid over each other the samples are the picture's R, G, B, A",
            deep_file(context.scene.shot, frame))};
    for (const auto& [name, value] : mattes_of(context.scene))
        if (name.ends_with("/manifest")) header.attributes.push_back({"manifest", value});
    std::string file = exr::encode_deep_scanline(header, image);
    seal(file);
    return file;
}

std::vector<glm::vec3> glaring_light(const Camera& camera, const Picture& picture, int frame) {
    std::vector<glm::vec3> light;
    if (!(camera.glare > 0.0)) return light;
    light.resize(picture.layers.size());
    for (std::size_t i = 0; i < light.size(); ++i) light[i] = light_of(picture, i);
    add_glare(light, picture.resolution,
              {.share = camera.glare,
               .pixel_tangent = 2.0 * view_at(camera, frame).tan_half_width / display_size(picture).x});
    return light;
}

std::string encode_png(const PictureContext& context, const Picture& rendered, int frame) {
    const PixelWindow data{rendered.low, rendered.low + rendered.resolution},
        shown = intersection(data, {.high = display_size(rendered)});
    std::optional<Picture> cut;
    if (shown != data) cut = cut_to(rendered, shown);
    const Picture& picture = cut ? *cut : rendered;
    const bool has_alpha = !picture.alpha.empty();
    const std::size_t components = has_alpha ? 4 : 3;
    std::vector<std::uint8_t> bytes(picture.layers.size() * components);
    const Camera& camera = context.scene.camera;
    const glm::mat3 balance = white_balance(camera.white_balance_k);
    const std::vector<glm::vec3> glaring = glaring_light(camera, picture, frame);
    // Makes light what a display shows of it.
    const auto show = [&](std::span<glm::vec3> lights) {
        for (glm::vec3& light : lights)
            light = context.colours.show ? light * context.exposure : display_colour(light, context.exposure);
        if (context.colours.show) context.colours.show(lights);
    };
    // A pixel of the skyline is the mean of what is shown of its sea and of its sky. A bright sky is several times as bright as white:
    // of their mean light a tenth of it in a pixel would be shown white, and an edge have steps for all its samples.
    tbb::parallel_for(0, picture.resolution.y, [&](int row) {
        const auto width = static_cast<std::size_t>(picture.resolution.x);
        std::vector<glm::vec3> lights(width);
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t i = width * row + x;
            const float alpha = has_alpha ? picture.alpha[i] : 1.0f;
            const glm::vec3 light = glaring.empty() ? light_of(picture, i) : glaring[i];
            lights[x] = balance * (light / (alpha > 0.0f ? alpha : 1.0f));
        }
        show(lights);
        const auto from =
            std::lower_bound(picture.skyline.begin(), picture.skyline.end(), width * row,
                             [](const SkylinePixel& of, std::size_t i) { return of.pixel < i; });
        for (auto both = from; both != picture.skyline.end() && both->pixel < width * (row + 1); ++both) {
            const glm::vec3 light = light_of(picture, both->pixel);
            std::array parts{(light - both->light) / (1.0f - both->sky), both->light / both->sky};
            // Each has its own light less what is scattered of it, and what is scattered of others.
            const float own = glaring.empty() ? 1.0f : 1.0f - static_cast<float>(camera.glare);
            const glm::vec3 others =
                glaring.empty() ? glm::vec3(0.0f) : glm::max(glaring[both->pixel] - own * light, 0.0f);
            for (glm::vec3& part : parts) part = balance * glm::max(own * part + others, 0.0f);
            show(parts);
            lights[both->pixel - width * row] = glm::mix(parts[0], parts[1], both->sky);
        }
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t i = width * row + x;
            const glm::ivec2 pixel = picture.low + glm::ivec2(static_cast<int>(x), row);
            const auto seen = dithered_bytes(lights[x], pixel);
            std::copy(seen.begin(), seen.end(), bytes.begin() + static_cast<std::ptrdiff_t>(components * i));
            if (has_alpha)
                bytes[components * i + 3] = static_cast<std::uint8_t>(std::lround(255.0f * picture.alpha[i]));
        }
    });
    return png::encode(
        {.width = picture.resolution.x,
         .height = picture.resolution.y,
         .bytes = bytes,
         .has_alpha = has_alpha,
         .comment = png_comment(picture_file(context.scene.shot, frame, "png"), context.made_of)});
}

}  // namespace pelagic
