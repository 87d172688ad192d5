// pelagic.SprayDrops: the large drops of the spray, as pictures show them and bakes write them.
#include "core/effects/spray_drops.h"

#include <pybind11/stl.h>
#include <tbb/task_arena.h>

#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/scene/limits.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/sea.h"
#include "plugin/host/python/watch.h"
#include "plugin/render/seen_drops.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

py::dict arrays_of(const std::vector<SprayDrop>& drops) {
    const std::size_t count = drops.size();
    std::vector<glm::dvec3> positions(count);
    std::vector<glm::vec3> velocities(count);
    std::vector<float> widths(count), sections(count), opacities(count);
    std::vector<std::int64_t> ids(count);
    for (std::size_t i = 0; i < count; ++i) {
        positions[i] = drops[i].position_m;
        velocities[i] = glm::vec3(drops[i].velocity_mps);
        widths[i] = static_cast<float>(drops[i].width_m);
        sections[i] = static_cast<float>(drops[i].section_m2);
        opacities[i] = static_cast<float>(drops[i].opacity());
        ids[i] = drops[i].id;
    }
    py::dict made;
    made["position"] = array_of<double>(std::move(positions));
    made["velocity"] = array_of<float>(std::move(velocities));
    made["width_m"] = array_of<float>(std::move(widths));
    made["section_m2"] = array_of<float>(std::move(sections));
    made["opacity"] = array_of<float>(std::move(opacities));
    made["id"] = array_of<std::int64_t>(std::move(ids));
    return made;
}

class PythonDrops {
  public:
    PythonDrops(const PythonSea& sea, std::optional<double> size_m)
        : sea_(sea.sea->first()), size_m_(size_m.value_or(kDropsSquare_m)) {
        if (!limits::kSurfaceSize_m.holds(size_m_))
            throw py::value_error("size_m: accepted: " + text_of(limits::kSurfaceSize_m) + ", or None");
    }

    py::dict in_air(double t_s, std::array<double, 2> middle_m,
                    const std::optional<std::array<double, 3>>& eye_m) {
        const glm::dvec3 eye = eye_m ? glm::dvec3((*eye_m)[0], (*eye_m)[1], (*eye_m)[2])
                                     : glm::dvec3(middle_m[0], middle_m[1], 0.0);
        if (!std::isfinite(t_s)) throw py::value_error("t: accepted: a finite time [s]");
        for (const double each : {eye.x, eye.y, eye.z})
            if (!limits::kCameraCoordinate_m.holds(each))
                throw py::value_error("middle, eye: accepted: " + text_of(limits::kCameraCoordinate_m));
        std::vector<SprayDrop> drops;
        Watch watch{py::none(), py::none()};
        beside_others(
            watch, [&] { find(t_s, glm::dvec2(eye), drops, watch.flag()); }, "finding drops was cancelled");
        if (eye_m) {
            for (SprayDrop& drop : drops)
                drop.section_m2 *= parcel_share(glm::distance(drop.position_m, eye));
            std::erase_if(drops, [](const SprayDrop& drop) { return !(drop.section_m2 > 0.0); });
        }
        return arrays_of(drops);
    }

    double size_m() const { return size_m_; }

  private:
    void find(double t_s, glm::dvec2 middle_m, std::vector<SprayDrop>& drops,
              const std::atomic<bool>* cancel) {
        const std::lock_guard lock(mutex_);
        // As for a frame: this thread takes up nobody else's work while it waits for its own.
        tbb::this_task_arena::isolate([&] {
            if (!drops_) drops_.emplace(*sea_, size_m_, BuildWatch{.progress = {}, .cancel = cancel});
            drops_->at(t_s, middle_m, drops, cancel);
        });
    }

    std::shared_ptr<const Sea<float>> sea_;
    double size_m_;
    std::mutex mutex_;
    std::optional<SprayDrops<float>> drops_;  // once they are asked for
};

}  // namespace

void add_drops(py::module_& module) {
    py::class_<PythonDrops> drops(
        module, "SprayDrops", py::module_local(),
        "The large drops of a sea's spray, effects.spray_drops, as parcels of drops in the air: the same ones as bakes write and "
        "pictures show. What is found of a time is kept for those beside it.\n\n"
        "sea: of a scene with such drops; otherwise there are none. size_m: the side of the square over which they are, [m], "
        "which also says how fine they are; None: as far as pictures show them round an eye.");
    drops
        .def(py::init<const PythonSea&, std::optional<double>>(), py::arg("sea"),
             py::arg("size_m") = py::none())
        .def(
            "in_air", &PythonDrops::in_air, py::arg("t"), py::arg("middle") = std::array{0.0, 0.0},
            py::kw_only(), py::arg("eye") = py::none(),
            "A dict of those in the air at time t [s], over the square round middle [m]: position, float64 (n, 3), in the "
            "world; velocity, float32 (n, 3), per second of the sea's time; width_m, across a parcel; section_m2, what its drops take of the "
            "light's cross-section, which comes and goes with its age; opacity, of a disc of that width that hides as much; id, int64, "
            "the same at all times.\n\n"
            "eye: (x, y, z) [m], the square's middle instead: sections are as a picture from there shows them, less from 48 m on and "
            "none beyond 96 m, where they are in the veil.")
        .def_property_readonly("size_m", &PythonDrops::size_m, "The side of the square [m].");
}

}  // namespace pelagic::python
