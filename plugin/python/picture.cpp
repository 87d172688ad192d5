// pelagic.render: what `pelagic render` draws, as arrays.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <tbb/task_arena.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/plan/budget.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/python/arrays.h"
#include "plugin/python/bindings.h"
#include "plugin/python/light.h"
#include "plugin/python/watch.h"
#include "plugin/render/picture_budget.h"
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

// Those beside the light's, which are there in any case.
PictureLayerSet data_layers_of(const std::vector<std::string>& names) {
    PictureLayerSet layers;
    for (const std::string& name : names) layers |= parse_picture_layers(name);
    return layers;
}

py::dict render_frame(const Scene& scene, int frame, const std::optional<std::array<int, 2>>& size,
                      std::optional<int> samples, const std::optional<std::string>& sky_quality,
                      const std::vector<std::string>& layers, double shutter, bool alpha,
                      const py::object& progress, const py::object& cancel,
                      std::optional<std::size_t> max_memory_bytes) {
    Scene kept = scene;
    if (size) kept.camera.resolution = {(*size)[0], (*size)[1]};
    require_valid(kept);
    const auto watch = shared_watch(progress, cancel);
    RenderOptions options = render_options(kept);
    if (has_budget(kept.quality)) {
        FixedSettings fixed{.samples = samples, .shutter_frames = shutter, .layers = data_layers_of(layers)};
        if (sky_quality) fixed.sky_quality = sky_quality_of(*sky_quality);
        const auto found = std::make_shared<PictureBudget>();
        try {
            beside_others(watch, [=] {
                *found = picture_budget(kept, fixed, max_memory_bytes.value_or(0),
                                        {.progress = {}, .cancel = watch->flag()});
            });
        } catch (const BuildCancelled&) {
            watch->rethrow();
            throw Cancelled("rendering was cancelled");
        }
        const PictureBudget& budget = *found;
        if (!budget.holds) throw py::value_error(budget.text + "; raise the budget");
        kept = budget.scene;
        options = budget.options;
    }
    if (samples) options.samples = *samples;
    if (sky_quality) options.lighting.sky_quality = sky_quality_of(*sky_quality);
    options.layers = data_layers_of(layers);
    options.shutter_frames = shutter;
    options.alpha = alpha;
    check_render(kept, options);
    struct Drawn {
        Picture picture;
        bool is_whole = false;
    };
    const auto drawn = std::make_shared<Drawn>();
    try {
        beside_others(watch, [=] {
            const std::array frames{frame};
            require_memory(
                render_memory(kept, options, frames, std::nullopt, tbb::this_task_arena::max_concurrency()),
                machine::memory_limit_or(max_memory_bytes.value_or(0)), "this picture");
            // Half of the way is the sea's: the first frame is about as long in the making.
            Renderer renderer(
                kept, options, make_sky(kept), frames,
                {.progress = [&](double done) { watch->tell(0.5 * done); }, .cancel = watch->flag()});
            drawn->is_whole = renderer.render(
                frame, drawn->picture,
                {.progress = [&](double done) { watch->tell(0.5 + 0.5 * done); }, .cancel = watch->flag()});
        });
    } catch (const BuildCancelled&) {
        drawn->is_whole = false;
    }
    watch->rethrow();
    if (!drawn->is_whole) throw Cancelled("rendering was cancelled");
    auto picture = std::make_unique<Picture>(std::move(drawn->picture));
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

void add_picture(py::module_& module) {
    module.def(
        "render", &render_frame, py::arg("scene"), py::arg("frame"), py::arg("size") = py::none(),
        py::arg("samples") = py::none(), py::kw_only(), py::arg("sky_quality") = py::none(),
        py::arg("layers") = std::vector<std::string>(), py::arg("shutter") = 0.0, py::arg("alpha") = false,
        py::arg("progress") = py::none(), py::arg("cancel") = py::none(),
        py::arg("max_memory_bytes") = py::none(),
        "A frame through the scene's camera, as `pelagic render` draws it: a dict of float32 (height, width, 3), "
        "rows from the top, in the sky's units, whose sum is the picture: \"sun\", \"sky\", \"sea\", \"foam\", \"air\", by "
        "the source of the light (beside the sea \"sky\" is the sky itself with the sun's disc); and "
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
