// Where a scene's bodies are, in calm water and in waves.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/evaluate/object_place.h"
#include "core/plan/plan.h"
#include "core/scene/object_pose.h"
#include "core/waves/sea_over_time.h"
#include "plugin/budget/budget.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/watch.h"

namespace pelagic::python {

namespace py = pybind11;

const SceneObject& object_at(const Scene& scene, py::ssize_t index) {
    const auto count = static_cast<py::ssize_t>(scene.objects.size());
    if (count == 0) throw py::index_error("objects[" + std::to_string(index) + "]: the scene has no objects");
    if (index < 0 || index >= count)
        throw py::index_error("objects[" + std::to_string(index) + "]: accepted: 0 … " +
                              std::to_string(count) + ", without its end");
    return scene.objects[static_cast<std::size_t>(index)];
}

namespace {

py::array_t<double> matrices(const std::vector<ObjectPose>& poses) {
    py::array_t<double> out({static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
    auto at = out.mutable_unchecked<3>();
    for (py::ssize_t i = 0; i < at.shape(0); ++i) {
        const ObjectPose& pose = poses[static_cast<std::size_t>(i)];
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column) {
                if (row == 3)
                    at(i, row, column) = column == 3 ? 1.0 : 0.0;
                else
                    at(i, row, column) =
                        column == 3 ? pose.place_m[row] : pose.scale * pose.turn[column][row];
            }
    }
    return out;
}

void require_frame(const Scene& scene, py::ssize_t index, double frame) {
    // Without a mesh, too: who writes one asks first where it is to be.
    const SceneObject& object = object_at(scene, index);
    if (object.vessel > static_cast<int>(scene.waves.vessels.size()) || !std::isfinite(frame))
        throw py::value_error("objects[" + std::to_string(index) +
                              "] has vessel = " + std::to_string(object.vessel) + " at frame " +
                              std::to_string(frame) + "; accepted: one of waves.vessels, and a number");
}

py::array_t<double> calm_pose(const Scene& scene, py::ssize_t index, double frame) {
    require_frame(scene, index, frame);
    return matrices({object_pose(scene, object_at(scene, index), frame)}).reshape({4, 4});
}

py::array_t<double> poses_in_waves(const Scene& scene, py::ssize_t index, const std::vector<double>& frames,
                                   const py::object& progress, const py::object& cancel) {
    for (const double frame : frames) require_frame(scene, index, frame);
    require_valid(scene);
    if (scene.surface.kind == SurfaceKind::Cage)
        throw py::value_error(
            "surface.kind = \"cage\": a body lies on its water there; accepted: a sea that rests level");
    // Copies: other threads may change the caller's meanwhile.
    const Scene own = settle(scene, Purpose::Mesh, with_rates(recorded_rates())).scene;
    const SceneObject object = object_at(own, index);
    if (object.floats && !object.mesh)
        throw py::value_error("objects[" + std::to_string(index) +
                              "] floats, by the size of its mesh, and has none");
    std::vector<ObjectPose> poses;
    Watch watch{progress, cancel};
    beside_others(
        watch,
        [&] {
            if (!object.floats) {
                for (const double frame : frames) poses.push_back(object_pose(own, object, frame));
                return;
            }
            Query query;
            query.name = "objects";
            query.products = products(Product::Position);
            query.cell_m = query.pixel_m = {floating_cell_m(object)};
            const BuildWatch building{.progress = {}, .cancel = watch.flag()};
            Frame<float> state(std::make_shared<const SeaOverTime<float>>(
                make_plan(prepare(own), {query}, {.double_precision = false}), building));
            for (const double frame : frames) {
                state.set(own.shot.time_s(frame), watch.flag());
                poses.push_back(place_object(state, own, object, {.query = 0, .frame = frame}).pose);
                watch.tell(static_cast<double>(poses.size()) / static_cast<double>(frames.size()));
            }
        },
        "finding poses was cancelled");
    return matrices(poses);
}

}  // namespace

void add_objects(py::class_<Scene, std::shared_ptr<Scene>>& scene) {
    scene
        .def(
            "object_pose", &calm_pose, py::arg("index"), py::arg("frame"),
            "Where a body of objects is at a frame, also between two, in a calm sea: float64 (4, 4), from its mesh's coordinates to the "
            "sea's [m]. What floats moves with the waves on top of that: object_poses(). It needs no mesh. IndexError for a body that isn't "
            "there, ValueError for one of a vessel that isn't.")
        .def(
            "object_poses", &poses_in_waves, py::arg("index"), py::arg("frames"), py::kw_only(),
            py::arg("progress") = py::none(), py::arg("cancel") = py::none(),
            "Where a body of objects is at each of these frames, also between two, with the waves where it floats: float64 (n, 4, 4), as "
            "object_pose(), for whoever draws it elsewhere beside a bake. As in bakes and pictures, to what their grids round "
            "(millimetres). Takes a sea, and a frame of it for each. progress: called with the share that is done, 0 … 1, from any "
            "thread. cancel: a Cancel, or a callable that is asked as often; Cancelled is then raised. IndexError and ValueError as there; "
            "ValueError for a sea that rests on a cage, ShotError for a scene that can't be.");
}

}  // namespace pelagic::python
