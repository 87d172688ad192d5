// A budget of pictures: quality.max_error or quality.frame_ms, turned into what a render takes.
//
// How much pictures of a sea err differs between shots by more than ten, and hardly with the picture's size: so the shot is
// measured on a small picture of its own, with four numbers of samples, and what lies between follows. Nothing is timed, and the
// waves are in double precision, whose last digits no choice depends on: every machine chooses alike.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "plugin/render/render.h"

namespace pelagic {

struct PricedSetting {
    RenderOptions options;
    double error = 0.0, ms = 0.0;  // as PictureBudget's
};

struct PictureBudget {
    Scene scene;  // with the quality.level and surface.cell_px that it asks for, and without a budget
    RenderOptions options;  // render_options(scene), with what was chosen and what is fixed
    // Expected: the relative error of radiance that 95 % of the water's pixels don't exceed, against 8 × 8 samples of the
    // integral of the sky, with cells of half a pixel. NaN where only time was asked for.
    double error = 0.0;
    double ms = 0.0;  // of a picture, by the cost model
    bool holds = true;
    std::size_t measuring_bytes = 0;        // that measuring the shot held; 0 where nothing was measured
    std::string text{};                     // for people: what was chosen, and why; empty without a budget
    std::vector<PricedSetting> settings{};  // all that it was chosen from
};

// What isn't left to the budget. Nothing of which frames are made: a farm's tasks choose alike, and a frame's time is that of a run
// through the shot, which goes on with the foam of the frame before.
struct FixedSettings {
    std::optional<int> samples{};
    std::optional<SkyQuality> sky_quality{};
    double shutter_frames = 0.0;  // as RenderOptions'
    PictureLayerSet layers = light_layers();
};

// max_error: the cheapest settings that err by no more; frame_ms: the most accurate ones that cost no more. The scene must be
// valid. Without a budget, or with everything fixed, at once; with max_error, seconds. Frames whose camera is under water aren't
// measured. Throws BuildCancelled, NotEnoughMemory (0: what the system gives), and std::invalid_argument where no picture can be
// made: all cameras are under water, or even one sample a pixel is too many.
PictureBudget picture_budget(const Scene& scene, const FixedSettings& fixed = {},
                             std::size_t max_memory_bytes = 0, const BuildWatch& watch = {});

// Of the pixels of water in both pictures: |L − L′|/|L′| of the radiance, L′ being the reference's: what 95 % of them don't exceed, and
// the mean. A reference without light counts what is there as it is.
struct RelativeError {
    double most = 0.0, mean = 0.0;
};
RelativeError relative_error(const Picture& picture, const Picture& reference);

// What errors of pictures are against: 8 × 8 samples of the integral of the sky and of the exact Fresnel term, over cells of
// half a pixel.
struct PictureSettings {
    Scene scene;
    RenderOptions options;
};
PictureSettings reference_settings(const Scene& scene);

}  // namespace pelagic
