// What the pictures of a shot need, before any of them is rendered.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/constants.h"
#include "core/base/precision.h"
#include "core/plan/effects.h"
#include "core/plan/hulls.h"
#include "core/plan/quality.h"
#include "core/plan/spray.h"
#include "core/scene/hull.h"
#include "core/scene/text.h"
#include "core/surface/view.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/render/batch.h"
#include "plugin/render/drawn_sea.h"
#include "plugin/render/floor_light.h"
#include "plugin/render/glare.h"
#include "plugin/render/mirrored_sun.h"
#include "plugin/render/objects.h"
#include "plugin/render/passes.h"
#include "plugin/render/render.h"
#include "plugin/render/seen_drops.h"
#include "plugin/render/spray_map.h"

namespace pelagic {

RenderOptions render_options(const Scene& scene) {
    const QualityRow& quality = quality_of(scene.quality.level);
    RenderOptions options;
    options.lighting.whitecaps = is_on(Effect::Whitecaps, scene);
    options.lighting.spray = has_spray(scene) && shows_open_sea(scene.surface);
    switch (quality.sky) {
        case SkyLookups::One:
            options.lighting.sky_quality = SkyQuality::One;
            break;
        case SkyLookups::Nine:
            options.lighting.sky_quality = SkyQuality::Nine;
            break;
        case SkyLookups::Integral:
            options.lighting.sky_quality = SkyQuality::Integral;
            break;
    }
    options.lighting.fresnel = quality.fitted_fresnel ? FresnelFit::Exact : FresnelFit::Paper;
    options.samples = quality.samples;
    return options;
}

Plan picture_plan(const Scene& scene, std::span<const int> frames, const RenderOptions& options) {
    Scene shown = scene;
    if (!options.lighting.spray) row_of(Effect::Spray).turn_off(shown);
    auto prepared = prepare(std::move(shown));
    if (frames.empty()) throw std::invalid_argument("a plan of pictures needs at least one frame");
    std::vector<glm::ivec2> overscans;
    for (const PicturePart& part : picture_parts(scene.camera.resolution / options.samples, options))
        overscans.push_back(part.overscan_px * options.samples);
    std::vector<SeaView> seen;
    for (const int frame : frames)
        for (const PicturePass& pass : passes_of(scene.camera, frame, options).all)
            for (const glm::ivec2 overscan : overscans)
                seen.push_back({view_of(scene.camera, pass, overscan), frame});
    const DrawnSea::Needs needs = DrawnSea(*prepared, false).needs(seen);
    Query query = view_query(*prepared, {.products = {},
                                         .finest_cell_m = needs.finest_cell_m,
                                         .finest_pixel_m = needs.finest_pixel_m,
                                         .points = needs.points,
                                         .filter = options.filter});
    query.products |= products(Product::SlopeVarianceAtRest);
    if (needs_motion(options.layers)) query.products |= products(Product::Velocity);
    std::vector<Query> queries{std::move(query)};
    if (auto hulls = hulls_query_of_picture(prepared->scene)) queries.push_back(std::move(*hulls));
    return make_plan(std::move(prepared), queries, {.knobs = options.knobs, .filter = options.filter});
}

PixelWindow data_window(glm::ivec2 display, const RenderOptions& options) {
    const PixelWindow whole{-options.overscan_px, display + options.overscan_px};
    return options.region ? intersection(*options.region, whole) : whole;
}

std::vector<PicturePart> picture_parts(glm::ivec2 display, const RenderOptions& options) {
    const PixelWindow data = data_window(display, options);
    const PixelWindow inside = intersection(data, {.high = display});
    std::vector<PicturePart> parts{{.windows = {inside}}};
    PicturePart beyond{options.overscan_px, {}};
    for (const PixelWindow& side : {PixelWindow{data.low, {data.high.x, inside.low.y}},
                                    {{data.low.x, inside.low.y}, {inside.low.x, inside.high.y}},
                                    {{inside.high.x, inside.low.y}, {data.high.x, inside.high.y}},
                                    {{data.low.x, inside.high.y}, data.high}})
        if (!side.is_empty()) beyond.windows.push_back(side);
    if (!beyond.windows.empty()) parts.push_back(std::move(beyond));
    return parts;
}

void check_window(glm::ivec2 display, const RenderOptions& options) {
    const auto text = [](glm::ivec2 at) { return std::to_string(at.x) + ',' + std::to_string(at.y); };
    const glm::ivec2 most = display / 2;
    if (std::min(options.overscan_px.x, options.overscan_px.y) < 0 || options.overscan_px.x > most.x ||
        options.overscan_px.y > most.y)
        throw std::invalid_argument("an overscan of " + text(options.overscan_px) + " pixels of " +
                                    text(display) + ": up to half of the picture on each side, " +
                                    text(most) + ", is accepted");
    if (options.region) {
        const PixelWindow whole{-options.overscan_px, display + options.overscan_px};
        if (data_window(display, options) != *options.region ||
            intersection(*options.region, {.high = display}).is_empty())
            throw std::invalid_argument("a region of " + text(options.region->low) + ',' +
                                        text(options.region->high) + ": accepted are the pixels from " +
                                        text(whole.low) + " on, before " + text(whole.high) +
                                        ", and some of the picture's own");
    }
}

void check_render(const Scene& scene, const RenderOptions& options) {
    if (options.samples < 1 || options.samples > kMostSamples)
        throw std::invalid_argument(std::to_string(options.samples) + " x " +
                                    std::to_string(options.samples) + " samples a pixel: 1 to " +
                                    std::to_string(kMostSamples) + " a side are accepted");
    if (!(options.shutter_frames >= 0.0 && options.shutter_frames <= kLongestShutter_frames))
        throw std::invalid_argument("a shutter that is open for " + number_text(options.shutter_frames) +
                                    " frames: 0 to " + number_text(kLongestShutter_frames) + " are accepted");
    if (options.deep && !options.alpha)
        throw std::invalid_argument(
            "deep pixels without alpha: what they lie over isn't in them; alpha is accepted with them");
    if (options.deep && options.samples > 1 && (options.shutter_frames > 0.0 || scene.camera.f_stop > 0.0))
        throw std::invalid_argument(
            "deep pixels of a blurred picture: no shutter, and no camera.f_stop, or 1 sample a pixel, are accepted with them");
    const glm::ivec2 display = scene.camera.resolution;
    check_window(display, options);
    const glm::ivec2 all = (display + 2 * options.overscan_px) * options.samples;
    if (std::max(all.x, all.y) > Rasteriser::kLargestSide)
        throw std::invalid_argument("a picture of " + std::to_string(all.x) + " x " + std::to_string(all.y) +
                                    " samples: up to " + std::to_string(Rasteriser::kLargestSide) +
                                    " a side are accepted; ask for a smaller picture or fewer samples");
}

namespace {

std::size_t pixels_of(const PixelWindow& window) {
    const glm::ivec2 size = window.size();
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
}

// [bytes] of what encode_png() cuts out where there are pixels round the display window.
std::size_t cut_bytes(glm::ivec2 display, const RenderOptions& options, bool has_objects) {
    const PixelWindow data = data_window(display, options), shown = intersection(data, {.high = display});
    if (shown == data) return 0;
    return pixels_of(shown) * (sizeof(SeaRadiance) + (has_objects ? 2 * sizeof(glm::vec3) : 0) +
                               (options.alpha ? sizeof(float) : 0));
}

// [bytes/pixel] of a picture; of its two files, where layers that are packed take half of their halves; and of what
// encode_exr() and encode_png() hold beside them.
std::size_t picture_bytes(const RenderOptions& options, bool has_objects) {
    const PictureLayerSet layers = layers_of(has_objects, options.layers);
    return sizeof(SeaRadiance) + 1 + (has_objects ? 2 * sizeof(glm::vec3) : 0) +
           sizeof(float) * (data_components(layers) + (options.alpha ? 1 : 0));
}
std::size_t file_bytes(const RenderOptions& options, bool has_objects) {
    const PictureLayerSet layers = layers_of(has_objects, options.layers);
    const std::size_t light = (layers & light_layers()).count() + 1;
    return light * 3 * 2 / 2 + 2 + sizeof(float) * data_components(layers) + (options.alpha ? 3 : 0);
}
constexpr std::size_t kEncodingBytes = sizeof(glm::vec3) + 4;

// [bytes/pixel] of deep pixels at most: with the rows that they come from, and with what is encoded of them.
std::size_t deep_bytes(const Scene& scene, const RenderOptions& options) {
    const auto places = static_cast<std::size_t>(options.samples * options.samples);
    const bool has_drops = options.lighting.spray && scene.effects.spray_drops;
    const std::size_t most =
        most_deep_samples(has_drops ? 2 * places : places, scene.objects.size(), options.lighting.spray);
    return sizeof(std::uint32_t) + most * sizeof(DeepSample);
}

// [bytes] of a point of the grid: as it is laid out, with the one of the frame before, in T, displaced, on the screen
// and in triangles. Of the rasteriser's pieces of triangles, which are fewer where most lie outside the picture, and
// need more room while their vector grows, as many as there are triangles.
template <class T>
constexpr std::size_t kPointBytes = 2 * (3 * sizeof(glm::vec2) + 2 * sizeof(float)) + 2 * sizeof(double) +
                                    6 * sizeof(std::uint32_t) + 19 * sizeof(T) + sizeof(glm::vec3) +
                                    sizeof(glm::dvec4) +
                                    2 * (Rasteriser::kPieceBytes + sizeof(std::uint32_t));

// [bytes] of any sample of a batch, and of one that shows the sea: Batch<T>, with its answers, in double beside those in single.
constexpr std::size_t kAnySampleBytes = sizeof(std::uint32_t) + sizeof(PixelPlace) + sizeof(SeaRadiance);
template <class T>
constexpr std::size_t kSampleBytes = sizeof(std::uint32_t) + sizeof(PixelPlace) + 2 * sizeof(SeaRadiance) +
                                     2 * sizeof(std::size_t) + sizeof(double) + sizeof(MeniscusSight) +
                                     2 * sizeof(std::uint8_t) + 5 * sizeof(T) + 2 * sizeof(glm::vec3) +
                                     2 * sizeof(float) + sizeof(glm::vec3) + sizeof(SeaPoint) +
                                     13 * sizeof(float) + (sizeof(T) > sizeof(float) ? 10 * sizeof(T) : 0);

// A camera as it is at a frame, but for its roll.
void stand_still(Camera& camera, int frame) {
    const View view = view_at(camera, frame);
    camera.keys.clear();
    camera.position_m = view.position_m;
    camera.look_at_m = view.position_m + view.forward;
    camera.fov_deg = std::atan(view.tan_half_width) * (360.0 / kPi);
    camera.focal_length_mm.reset();
}

// The largest share of the samples of a batch of so many rows that may show the sea: those that look below the horizon, or so little
// above it that waves may stand before them.
double most_of_sea(const Scene& sampled, double waves_m, std::span<const int> frames, int rows) {
    constexpr int kColumns = 16, kRows = 64;
    constexpr double kRise =
        0.03;  // sine of 1.7°: the camera is above all waves, and rows are some degree wide
    if (sampled.surface.kind == SurfaceKind::Cage) return 1.0;
    const int at_once = std::clamp(rows * kRows / sampled.camera.resolution.y, 1, kRows);
    int most = 0;
    // Of a camera without keys one frame says all; of a long way some do.
    constexpr std::size_t kMostFrames = 1000;
    const std::size_t stride =
        sampled.camera.keys.empty() ? frames.size() : std::max<std::size_t>(frames.size() / kMostFrames, 1);
    for (std::size_t i = 0; i < frames.size(); i += stride) {
        const View view = view_at(sampled.camera, frames[i]);
        if (view.position_m.z < 2.0 * waves_m) return 1.0;
        std::array<int, kRows> of_row{};
        for (int y = 0; y < kRows; ++y)
            for (int x = 0; x < kColumns; ++x)
                if (view.direction((glm::dvec2(x, y) + 0.5) / glm::dvec2(kColumns, kRows) *
                                   glm::dvec2(view.resolution))
                        .z < kRise)
                    ++of_row[y];
        for (int first = 0; first + at_once <= kRows; ++first)
            most =
                std::max(most, std::accumulate(of_row.begin() + first, of_row.begin() + first + at_once, 0));
    }
    return static_cast<double>(most) / (at_once * kColumns);
}

}  // namespace

MemoryNeed render_memory(const Scene& scene, const RenderOptions& options, std::span<const int> frames,
                         std::optional<int> in_flight, int threads) {
    Scene sampled = of_samples(scene, options.samples);
    // A frame alone is no run, whatever the shot has beside it.
    if (frames.size() == 1) {
        sampled.shot.first_frame = sampled.shot.last_frame = frames.front();
        stand_still(sampled.camera, frames.front());
    }
    const Plan plan = picture_plan(sampled, frames, options);
    const PixelWindow data = data_window(scene.camera.resolution, options);
    MemoryNeed need;
    std::size_t later = 0;  // of what is there once the floor's light is made
    machine::add_program(need);
    machine::add_sky(need);
    add_sea(need, plan, threads);
    with_precision(plan.knobs.double_precision, [&]<class T>(T) {
        const std::size_t points = plan.queries[0].query.points;
        need.add("the camera's grid of points",
                 points * (kPointBytes<T> + (needs_motion(options.layers) ? 3 * sizeof(T) : 0)),
                 "raise surface.cell_px, or ask for a smaller picture (--size)");
        std::size_t at_hand = 0;
        int rows_at_hand = 0;
        for (const PicturePart& part : picture_parts(scene.camera.resolution, options))
            for (const PixelWindow& window : part.windows) {
                const glm::ivec2 samples = window.size() * options.samples;
                const int rows = std::min(rows_of_batch(samples.x, options.samples), samples.y);
                at_hand =
                    std::max(at_hand, static_cast<std::size_t>(rows) * static_cast<std::size_t>(samples.x));
                rows_at_hand = std::max(rows_at_hand, rows);
            }
        const bool is_whole = !options.region && options.overscan_px == glm::ivec2(0);
        const double of_sea =
            is_whole ? most_of_sea(sampled, plan.from->extent.height_m, frames, rows_at_hand) : 1.0;
        later = at_hand * kAnySampleBytes + static_cast<std::size_t>(of_sea * static_cast<double>(at_hand)) *
                                                (kSampleBytes<T> - kAnySampleBytes);
        need.add("the pixels at hand", later, "ask for a smaller picture (--size) or fewer --samples");
        if (sampled.surface.kind == SurfaceKind::Cage)
            need.add("the cage's surface",
                     DrawnSea(*plan.from, false).surface_bytes(points) + at_hand * 3 * sizeof(T),
                     "lower surface.cage_level, or raise surface.cell_px");
    });
    const FloorLightNeeds floor = most_floor_light_needs(scene, plan);
    const char* const floor_remedy = "set water.caustics to 0";
    need.add("the sun's light on the floor", floor.held_bytes, floor_remedy);
    if (const std::size_t pictures = floor_bytes(scene); pictures > 0)
        need.add("the floor's pictures", pictures, "give smaller ones");
    std::size_t meshes = 0;
    std::set<const ObjectMesh*> counted;  // bodies of one file share its mesh
    for (const SceneObject& object : scene.objects)
        if (counted.insert(object.mesh.get()).second) meshes += object.mesh->bytes();
    if (meshes > 0) need.add("the objects' meshes", meshes, "give coarser ones, or smaller pictures on them");
    const bool has_objects = !scene.objects.empty();
    if (has_objects) {
        const auto rows = static_cast<std::size_t>(std::min(
            rows_of_batch(sampled.camera.resolution.x, options.samples), sampled.camera.resolution.y));
        const std::size_t a_sample = sizeof(RayHit) + sizeof(glm::vec3) + sizeof(BodiesInSea) +
                                     sizeof(SeaRadiance) + sizeof(std::uint8_t) + sizeof(float) +
                                     (Lamps::bytes(scene) > 0 ? sizeof(glm::vec3) : 0);
        need.add("the objects",
                 LitObjects::bytes(scene) + hulls_bytes(scene) +
                     rows * static_cast<std::size_t>(sampled.camera.resolution.x) * a_sample,
                 "give meshes of fewer triangles");
    }
    const auto gathering = static_cast<std::size_t>(std::ranges::count_if(
        scene.objects, [](const SceneObject& object) { return object.caustics > 0.0; }));
    if (gathering > 0)
        // They are found one after the other.
        need.add("the sun's light that waves mirror onto objects",
                 gathering * MirroredSun::bytes() + MirroredSun::finding_bytes(),
                 "set objects[].caustics to 0");
    const std::size_t before = need.bytes();
    if (options.lighting.spray) {
        need.add("the map of the spray",
                 spray_map_bytes(spray_map_size(scene.camera.resolution.x + 2 * options.overscan_px.x)),
                 "set effects.spray to false");
        add_seen_drops(need, plan);
    }
    if (in_flight && scene.camera.glare > 0.0)
        need.add("the lens' glare",
                 static_cast<std::size_t>(*in_flight) *
                     glare_bytes(intersection(data, {.high = scene.camera.resolution}).size()),
                 "set camera.glare to 0");
    const std::size_t pixels = pixels_of(data);
    if (options.deep)
        need.add(
            "deep pixels",
            pixels * deep_bytes(scene, options) * (2 * static_cast<std::size_t>(in_flight.value_or(0)) + 2),
            "leave --deep out, or ask for a smaller picture (--size)");
    need.add(
        "pictures",
        pixels * (in_flight ? static_cast<std::size_t>(*in_flight) * (picture_bytes(options, has_objects) +
                                                                      file_bytes(options, has_objects)) +
                                  kEncodingBytes
                            : picture_bytes(options, has_objects)) +
            (in_flight ? cut_bytes(scene.camera.resolution, options, has_objects) : 0),
        "ask for a smaller picture (--size)");
    // Of a frame alone, without blur, the floor's light is made before there are pixels.
    const bool is_alone =
        frames.size() == 1 && passes_of(scene.camera, frames.front(), options).all.size() == 1;
    later = is_alone ? later + need.bytes() - before : 0;
    need.add("the sun's light on the floor", floor.making_bytes - std::min(floor.making_bytes, later),
             floor_remedy);
    return need;
}

}  // namespace pelagic
