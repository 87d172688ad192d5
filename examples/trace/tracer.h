// Pictures of a shot by rays: its sea, and an object that floats in it.
//
// Visibility: rays decide what hides what; the sea is shaded as `pelagic render` shades it, by the same functions (sea_light.h), and
// so is the object, by the sun and a sky without obstacles.
//
// Traced: on top of that shadows of the sun, and what mirrored and refracted rays meet in place of sky and open water. Where
// they meet neither sea nor object, nothing is added and no noise comes in: the sea's own shading has integrated the sky over its
// hidden slopes already.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pelagic/scene.h"
#include "plugin/render/render.h"
#include "scene.h"

namespace pelagic::trace {

struct TraceOptions {
    RenderOptions picture;  // terms of the light, samples
    bool traced = false;
    const FloatingObject* object = nullptr;
    Placement placement{};
};

struct TracedPicture {
    Picture picture;                   // the object's light is in the layer `sea`
    std::vector<std::uint8_t> object;  // by pixel: 1 where any of its rays meets the object
};

class Tracer {
  public:
    // The scene must be valid; of frames that are rendered. Throws std::runtime_error, std::invalid_argument.
    Tracer(const Scene& scene, const TraceOptions& options, Sky sky, int frame);
    ~Tracer();
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    // progress: 0 … 1. On all threads of the calling arena; the same bits whatever their number.
    TracedPicture render(const std::function<void(double)>& progress = {});

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pelagic::trace
