// Sweeps of the surfaces that are made for a camera: how far their faces are from the sea, in pixels.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "core/scene/text.h"
#include "plugin/accuracy/mesh_error.h"
#include "plugin/accuracy/rows.h"
#include "plugin/accuracy/sea_answers.h"

namespace pelagic::rows {
namespace {

struct SurfaceSetting {
    std::string name;
    bool is_shots;
    Surface surface;
};

Trials of_surfaces(const Scene& shot, const std::vector<SurfaceSetting>& settings) {
    const int frame = middle_frame(shot);
    const double time_s = middle_time_s(shot);
    const auto seen = std::make_shared<SeenSurface>(seen_surface(shot, view_at(shot.camera, frame)));
    seen->sea->set(time_s);
    Trials trials;
    for (const SurfaceSetting& setting : settings) {
        Scene scene = shot;
        scene.surface = setting.surface;
        const auto points = std::make_shared<RestPoints<float>>();
        const auto faces = std::make_shared<Faces>();
        const auto rest = make_surface(scene, seen->prepared->extent);
        rest->points_at(frame, *points);
        rest->faces_at(frame, *faces);
        trials.trials.push_back(
            {.setting = setting.name,
             .is_shots = setting.is_shots,
             .run = [=] { positions_of(*seen, *points); },
             .errors =
                 [=] {
                     const MeshPicture picture(*seen, *points);
                     const FaceSamples samples = samples_of(*seen, *points, *faces, picture);
                     return std::vector<double>{error_px(*seen, *points, picture, samples, 0.95),
                                                error_px(*seen, *points, picture, samples, 0.5)};
                 },
             .bytes = points->rest_m.size() * 3 * sizeof(float)});
    }
    return trials;
}

}  // namespace

Trials near_far(const Scene& shot) {
    Surface surface = shot.surface;
    const bool is_shots = surface.kind == SurfaceKind::NearFar;
    // The size with the least error for its vertices lies between six and ten of the eye's heights.
    constexpr double kHeights = 8.0, kLeast_m = 8.0;
    if (!is_shots)
        surface.size_m = std::max(kHeights * view_at(shot.camera, middle_frame(shot)).position_m.z, kLeast_m);
    surface.kind = SurfaceKind::NearFar;
    std::vector<SurfaceSetting> settings;
    for (const int resolution : {32, 64, 128, 256, 512}) {
        surface.resolution = resolution;
        settings.push_back({std::to_string(resolution) + " quads a side",
                            is_shots && shot.surface.resolution == resolution, surface});
    }
    return of_surfaces(shot, settings);
}

Trials camera_grid(const Scene& shot) {
    Surface surface = shot.surface;
    surface.kind = SurfaceKind::ProjectedGrid;
    std::vector<SurfaceSetting> settings;
    for (const double cell_px : {1.0, 2.0, 4.0, 8.0, 16.0}) {
        surface.cell_px = cell_px;
        settings.push_back(
            {number_text(cell_px) + " px",
             shot.surface.kind == SurfaceKind::ProjectedGrid && shot.surface.cell_px == cell_px, surface});
    }
    return of_surfaces(shot, settings);
}

}  // namespace pelagic::rows
