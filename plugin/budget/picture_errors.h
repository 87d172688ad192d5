// How far pictures of a shot are from what they should be, by how they are computed.
//
// It differs between shots by more than ten, and hardly with the picture's size: so the shot is measured on a small picture of its
// own, with four numbers of samples, and what lies between follows. Nothing is timed, and the waves are in double precision, whose
// last digits no choice depends on: every machine measures the same.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/base/build_watch.h"
#include "pelagic/scene.h"
#include "plugin/render/render.h"

namespace pelagic {

// Cells of pictures with a budget [pixels]: finer ones change little, and coarser ones save little.
inline constexpr double kPictureCell_px = 2.0;
inline constexpr std::array kMeasuredSamples{1, 2, 4, 6};

// Relative errors (below): by the number of samples (kMeasuredSamples) with nine lookups against eight times eight, and by the
// lookups alone. Percentiles don't add like this, but their root of squares is rarely exceeded.
struct MeasuredErrors {
    std::array<double, kMeasuredSamples.size()> by_samples{};
    double of_nine = 0.0;
    std::size_t bytes = 0;  // that measuring them held

    double at(int samples) const;  // between the numbers that were measured, as a power of them
};

// Seconds. Frames whose camera is under water aren't measured. Throws BuildCancelled, NotEnoughMemory (0: what the system gives), and
// std::invalid_argument where no picture can be made: all cameras are under water.
MeasuredErrors measured_errors(const Scene& scene, std::size_t max_memory_bytes, const BuildWatch& watch);

// The frames that stand for a shot's pictures: of a camera that stands still the one in the middle.
std::vector<int> frames_to_measure(const Scene& scene);

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
