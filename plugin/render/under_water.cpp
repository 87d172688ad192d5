#include "plugin/render/under_water.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "core/evaluate/surface_above.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/surface/footprint_levels.h"
#include "plugin/render/drawn_sea.h"

namespace pelagic {

bool is_among_waves(const View& view, const ProjectedGridOptions& options) {
    return !(view.position_m.z > options.bounds.height_m);
}

template <class T>
std::optional<double> surface_above_camera(const Frame<T>& frame, const View& view,
                                           const ProjectedGridOptions& options) {
    if (!is_among_waves(view, options)) return std::nullopt;
    const double finest_m = projected_grid_needs(view, options).finest_cell_m;
    const bool has_levels = frame.sea().plan().queries.front().query.pixel_m.size() > 1;
    return surface_above(frame, 0, view.position_m, has_levels ? first_level_m(finest_m) : finest_m);
}

namespace {

std::string metres(double z_m) {
    return number_text(std::round(z_m * 1e3) / 1e3) + " m";
}

std::string camera_at(const Scene& scene, double frame) {
    return std::string(scene.camera.keys.empty() ? "camera.position_m" : "camera.keys") + ": at frame " +
           number_text(frame) + " the camera is ";
}

}  // namespace

void throw_under_water(const Scene& scene, double frame, double surface_m) {
    const bool is_open = scene.surface.kind != SurfaceKind::Cage && shows_open_sea(scene.surface);
    throw std::invalid_argument(
        camera_at(scene, frame) +
        "under water: it is at z = " + metres(view_at(scene.camera, frame).position_m.z) +
        ", and the surface there at z = " + metres(surface_m) + "; " +
        (!is_open            ? "the water of a cage or of a patch in nothing is drawn from above only"
         : !scene.water.body ? "the sea is drawn from below where its water has a body (water.body = true)"
                             : "only pelagic render draws what is seen from there") +
        ": raise the camera, or leave such frames out");
}

void refuse_in_floor(const Scene& scene, double frame, const Floor& floor) {
    const glm::dvec3 eye_m = view_at(scene.camera, frame).position_m;
    const double floor_z_m =
        -(floor.has_depths() ? floor.depth_m(glm::dvec2(eye_m)) : scene_at(scene, frame).sea.depth_m);
    if (eye_m.z > floor_z_m) return;
    throw std::invalid_argument(camera_at(scene, frame) + "in the sea's floor: it is at z = " +
                                metres(eye_m.z) + ", and the floor at z = " + metres(floor_z_m) + " (" +
                                (floor.has_depths() ? "sea.depth_file" : "sea.depth_m") +
                                "): raise the camera, or make the sea deeper");
}

template <class T>
void refuse_under_water(const Frame<T>& state, const Scene& scene, double frame,
                        const ProjectedGridOptions& options) {
    if (const auto surface_m = surface_above_camera(state, view_at(scene.camera, frame), options))
        throw_under_water(scene, frame, *surface_m);
}

template std::optional<double> surface_above_camera(const Frame<float>&, const View&,
                                                    const ProjectedGridOptions&);
template std::optional<double> surface_above_camera(const Frame<double>&, const View&,
                                                    const ProjectedGridOptions&);
template void refuse_under_water(const Frame<float>&, const Scene&, double, const ProjectedGridOptions&);
template void refuse_under_water(const Frame<double>&, const Scene&, double, const ProjectedGridOptions&);

}  // namespace pelagic
