// Pictures from the CPU: the sea of a shot through its camera, lit by core/lighting. The same picture that
// the preview draws, and the one that it is measured against:
//
//   projected grid, or a cage (drawn_sea.h) → evaluate() at its points, filtered by their cells → triangles (raster.h) → in each pixel
//   evaluate() again at the place at rest that the pixel shows, filtered by the pixel → shade_sea()
//
// and where there is no sea, the sky (core/lighting/background.glsl).
//
// A renderer holds its plan's sea and one frame of it, the projected grid and the pixels at hand: render_memory()
// says how much, and with it what the pictures themselves and their files take.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/build_watch.h"
#include "core/lighting/lighting.h"
#include "core/lighting/sky.h"
#include "core/plan/memory.h"
#include "core/plan/plan.h"
#include "core/waves/sea.h"
#include "pelagic/scene.h"
#include "plugin/render/deep.h"
#include "plugin/render/layers.h"
#include "plugin/render/picture_window.h"

namespace pelagic {

// Where the preview's view volume begins [m]: far enough for the depth buffers of GPUs. A rendered picture's begins at
// the eye: wide lenses close to the water see much of it at less than this depth. Where it may be under water both begin at the
// front glass (waterline.h).
inline constexpr double kNear_m = 0.05;

// A pixel that shows both sea and sky.
struct SkylinePixel {
    std::size_t pixel = 0;
    float sky = 0.0f;       // its share
    glm::vec3 light{0.0f};  // of that part, and of the sea's: both add up to the picture's
};

// One frame, HDR, rows from the top, x fastest; in the sky's units. The layers, with those of objects, add up to the picture:
// `sky` is the sky that the sea reflects and, beside the sea, the sky itself with the sun's disc.
struct Picture {
    glm::ivec2 resolution{0};
    std::vector<SeaRadiance> layers;
    std::vector<std::uint8_t> sea;  // 1: sea in the middle of the pixel, 0: sky
    // What RenderOptions ask for, otherwise empty. Alpha is the sea's and the objects' share of the pixel, and what spray before the sky hides of that. Layers that aren't light
    // (kPictureLayers) hold their row's components side by side; they are those of the sample in the middle of the
    // pixel at the frame's own time, since a mean of depths or of normals is none that is there.
    std::vector<float> alpha{};
    // Of shots with objects the light from these, Object and Reflection, is there always.
    std::array<std::vector<float>, kPictureLayerCount> data{};
    // In rising order, of pictures that aren't blurred and have their sky.
    std::vector<SkylinePixel> skyline{};
    DeepPixels deep{};  // where RenderOptions ask for them
    // Of the first pixel, where it isn't the display window's; and that one's size, where the picture isn't all of it.
    glm::ivec2 low{0};
    std::optional<glm::ivec2> display{};
};

inline glm::ivec2 display_size(const Picture& picture) {
    return picture.display.value_or(picture.resolution);
}

// The layers' sum.
inline glm::vec3 radiance_of(const SeaRadiance& layers) {
    return layers.sun + layers.sky + layers.sea + layers.foam + layers.air;
}

// All that a pixel shows.
inline glm::vec3 light_of(const Picture& picture, std::size_t pixel) {
    glm::vec3 light = radiance_of(picture.layers[pixel]);
    for (const PictureLayer layer : {PictureLayer::Object, PictureLayer::Reflection})
        if (const std::vector<float>& of = picture.data[index(layer)]; !of.empty())
            light += glm::vec3(of[3 * pixel], of[3 * pixel + 1], of[3 * pixel + 2]);
    return light;
}

struct RenderOptions {
    LightingChoice lighting;
    int samples = 1;  // N × N a pixel, averaged before any tone mapping: 1 … 16
    // How long the shutter is open [frames], around the frame's own time: 0 … 4. Beyond 0, and with camera.f_stop, each of
    // a pixel's samples has a moment and a place in the aperture of its own (passes.h), with the sea and the camera as they
    // are then; one sample a pixel is sharp.
    double shutter_frames = 0.0;
    bool alpha =
        false;  // transparent where there is no sea, nor spray, nor object; the light is then multiplied by alpha
    // Deep pixels as well: needs alpha, without a shutter or an aperture (check_render()).
    bool deep = false;
    PictureLayerSet layers = light_layers();
    // Computed round the display window: at the left and the right, above and below [pixels], each no more than half of it. The
    // camera's keys are those of the display window, and so are the exposure, the lens and motion vectors.
    glm::ivec2 overscan_px{0};
    std::optional<PixelWindow> region{};  // only these pixels, of the display window and its overscan
    // Of the waves' sums, without as the quality level has them; and of footprints. To measure what others would cost.
    std::optional<Knobs> knobs{};
    FootprintFilter filter{};
};

inline constexpr double kLongestShutter_frames = 4.0;

inline constexpr int kMostSamples = 16;

// What the shot's quality level means for its pictures, for the preview as well; effects that are off are off
// here.
RenderOptions render_options(const Scene& scene);

// The pixels that pictures of a display window of this size have.
PixelWindow data_window(glm::ivec2 display, const RenderOptions& options);

// Some of them, with the overscan of the view that draws them. The display window's pixels are drawn as if there were no other ones:
// the mesh of a wider view has other points, and on a rough sea every pixel would get another light. Those round it are of the wider
// view, so that one picture has them all.
struct PicturePart {
    glm::ivec2 overscan_px{0};
    std::vector<PixelWindow> windows;  // without a pixel in common
};
std::vector<PicturePart> picture_parts(glm::ivec2 display, const RenderOptions& options);

// Throws std::invalid_argument, saying what is accepted, for an overscan out of range, a region that reaches beyond it, and one that
// shows nothing of a display window of this size.
void check_window(glm::ivec2 display, const RenderOptions& options);

// Throws as check_window(), and std::invalid_argument, saying what is accepted, for options out of range or more samples a side than
// a picture can have.
void check_render(const Scene& scene, const RenderOptions& options);

// The sea that pictures of the shot need: one query, number 0, for the grid's points and the pixels alike, whose
// levels are as fine as these frames need. The frames decide nothing about any frame's bits. With an overscan the scene is that
// of the samples (of_samples()).
Plan picture_plan(const Scene& scene, std::span<const int> frames, const RenderOptions& options = {});

// A picture is computed while the one before is encoded and written.
inline constexpr int kPicturesInFlight = 2;

// What rendering these frames holds at most, on so many threads: the renderer and the picture, or so many pictures in
// flight with their encoded files.
MemoryNeed render_memory(const Scene& scene, const RenderOptions& options, std::span<const int> frames,
                         std::optional<int> in_flight, int threads);

class Renderer {
  public:
    // The scene must be valid; its own sky (make_sky()), or another one, which frames of a scene whose light has keys replace by their
    // own; the frames that will be rendered, at
    // least one. Seconds for the largest seas. Throws as check_render(), and
    // BuildCancelled.
    Renderer(const Scene& scene, const RenderOptions& options, Sky sky, std::span<const int> frames,
             const BuildWatch& watch = {});
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    // One frame of the shot, the data window of the camera's resolution, into a picture whose memory is used again. On all
    // threads of the calling arena; the same bits whatever their number and whichever frame came before.
    // Every value is finite. `watch` is told from the calling thread. Throws BuildCancelled, the picture being only
    // partly there, and std::invalid_argument for a camera under water where that can't be drawn
    // (plugin/render/under_water.h), or in the sea's floor.
    void render(int frame, Picture& picture, const BuildWatch& watch = {});

    // Throws what render() would throw for the first of these frames whose camera it refuses, before hours are spent on the
    // others. Where the sea is drawn from below as well, and for frames whose camera is above the highest crest to be
    // expected, that costs nothing, for each other one its transforms. Throws BuildCancelled.
    void check_cameras(std::span<const int> frames, const BuildWatch& watch = {});

    const Plan& plan() const;
    const Sky& sky() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pelagic
