// pelagic.render: what `pelagic render` draws, as arrays.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/budget.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/light.h"
#include "plugin/host/python/picture.h"
#include "plugin/host/python/watch.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/render/render.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

// A layer of the picture: a view of memory that it keeps alive.
py::array layer_of(const py::capsule& owner, const Picture& picture, glm::vec3 SeaRadiance::*layer) {
    constexpr auto kPixel = static_cast<py::ssize_t>(sizeof(SeaRadiance));
    const py::ssize_t width = picture.resolution.x, height = picture.resolution.y;
    return py::array_t<float>({height, width, py::ssize_t{3}},
                              {kPixel * width, kPixel, static_cast<py::ssize_t>(sizeof(float))},
                              &(picture.layers.front().*layer).x, owner);
}

py::dict render_frame(const Scene& scene, int frame, const PictureSize& size, std::optional<int> samples,
                      const std::optional<std::string>& sky_quality, const std::vector<std::string>& layers,
                      double shutter, bool alpha, const py::object& progress, const py::object& cancel,
                      std::optional<std::size_t> max_memory_bytes) {
    PictureRequest asked = picture_request(scene, size, samples, sky_quality, layers, shutter, alpha);
    asked.options.layers &= ~light_layers();  // which are there in any case
    const auto watch = shared_watch(progress, cancel);
    const auto drawn = std::make_shared<Picture>();
    const auto draw = [=] {
        PictureOrder order = asked;
        const std::size_t most_bytes = max_memory_bytes.value_or(0);
        held(settle(order.scene, Purpose::Pictures,
                    {.fixed = asked.fixed,
                     .max_memory_bytes = most_bytes,
                     .watch = {.progress = {}, .cancel = watch->flag()},
                     .rates = recorded_rates()}),
             kByName)
            .apply(order);
        const std::array frames{frame};
        require_memory(render_memory(order.scene, order.options, frames, std::nullopt,
                                     tbb::this_task_arena::max_concurrency()),
                       machine::memory_limit_or(most_bytes), "this picture");
        // Half of the way is the sea's: the first frame is about as long in the making.
        Renderer renderer(
            order.scene, order.options, make_sky(scene_at(order.scene, frame)), frames,
            {.progress = [&](double done) { watch->tell(0.5 * done); }, .cancel = watch->flag()});
        renderer.render(
            frame, *drawn,
            {.progress = [&](double done) { watch->tell(0.5 + 0.5 * done); }, .cancel = watch->flag()});
    };
    beside_others(watch, draw, "rendering was cancelled");
    auto picture = std::make_unique<Picture>(std::move(*drawn));
    py::dict answer;
    const Picture& made = *picture;
    const py::capsule owner(picture.release(), [](void* held) { delete static_cast<Picture*>(held); });
    for (const auto& [name, layer] : kLayers) answer[name] = layer_of(owner, made, layer);
    const py::ssize_t height = made.resolution.y, width = made.resolution.x;
    answer["is_sea"] =
        py::array_t<bool>({height, width}, reinterpret_cast<const bool*>(made.sea.data()), owner);
    if (alpha) answer["alpha"] = py::array_t<float>({height, width}, made.alpha.data(), owner);
    for (const PictureLayerRow& row : kPictureLayers) {
        const std::vector<float>& values = made.data[index(row.layer)];
        if (values.empty()) continue;
        std::vector<py::ssize_t> shape{height, width};
        if (row.components > 1) shape.push_back(static_cast<py::ssize_t>(row.components));
        answer[std::string(row.name).c_str()] = py::array_t<float>(shape, values.data(), owner);
    }
    return answer;
}

}  // namespace

PictureRequest picture_request(const Scene& scene, const PictureSize& size, std::optional<int> samples,
                               const std::optional<std::string>& sky_quality,
                               const std::vector<std::string>& layers, double shutter, bool alpha,
                               double exposure) {
    PictureRequest order{{.scene = scene, .options = {}, .exposure_stops = exposure}, {.samples = samples}};
    FixedSettings& fixed = order.fixed;
    if (sky_quality) fixed.sky_quality = sky_quality_of(*sky_quality);
    if (size) order.scene.camera.resolution = {(*size)[0], (*size)[1]};
    require_valid(order.scene);
    if (!(std::abs(exposure) <= kMostStops))
        throw py::value_error("exposure " + number_text(exposure) + "; accepted: stops, " +
                              number_text(-kMostStops) + " to " + number_text(kMostStops));
    RenderOptions& options = order.options = render_options(order.scene);
    options.samples = samples.value_or(options.samples);
    options.lighting.sky_quality = fixed.sky_quality.value_or(options.lighting.sky_quality);
    for (const std::string& name : layers) options.layers |= parse_picture_layers(name);
    options.shutter_frames = fixed.shutter_frames = shutter;
    fixed.layers = options.layers;
    options.alpha = alpha;
    if (!has_budget(order.scene.quality)) check_render(order.scene, options);
    return order;
}

void add_picture(py::module_& module) {
    module.def(
        "render", &render_frame, py::arg("scene"), py::arg("frame"), py::arg("size") = py::none(),
        py::arg("samples") = py::none(), py::kw_only(), py::arg("sky_quality") = py::none(),
        py::arg("layers") = std::vector<std::string>(), py::arg("shutter") = 0.0, py::arg("alpha") = false,
        py::arg("progress") = py::none(), py::arg("cancel") = py::none(),
        py::arg("max_memory_bytes") = py::none(),
        "A frame through the scene's camera, as `pelagic render` draws it: a dict of float32 (height, width, 3), "
        "rows from the top, in the sky's units, whose sum is the picture: \"sun\", \"sky\", \"sea\", \"foam\", \"air\", by "
        "the source of the light (beside the sea \"sky\" is the sky itself with the sun's disc), with objects \"object\" and \"reflection\" as well; and "
        "\"is_sea\", bool (height, width).\n\n"
        "size: (width, height), by default the camera's. samples: N of N × N a pixel; sky_quality: \"one\", "
        "\"nine\" or \"integral\"; by default the quality level's. layers: further ones, "
        "\"depth\", \"coverage\" and whatever else `pelagic render --help` lists: float32 (height, width) or (height, width, components). shutter: how long it is open, in frames, 0 to 4. "
        "alpha: no sky beside the sea, and \"alpha\", float32 (height, width), by which the light is multiplied. "
        "progress: called with the share that is "
        "done, 0 … 1. cancel: a Cancel, or a callable; Cancelled is then raised. "
        "max_memory_bytes: MemoryError, before any work, for a picture that needs more; by default what the "
        "system gives this process.");
}

}  // namespace pelagic::python
