#include <array>

#include "core/plan/plan.h"
#include "core/surface/projected_grid.h"
#include "core/surface/rungs.h"
#include "core/surface/view.h"
#include "plugin/light/light.h"
#include "plugin/preview/offscreen.h"

namespace pelagic {

OffscreenPicture render_offscreen(const Scene& scene, const Sky& sky, int frame, glm::ivec2 size) {
    Scene seen = scene;
    if (size.x > 0 && size.y > 0) seen.camera.resolution = size;
    const auto sea = std::make_shared<const Sea<float>>(picture_plan(seen, std::array{frame}));
    Frame<float> state(sea);
    state.set(seen.shot.time_s(frame));
    PackedFrame packed(sea, 0);
    packed.pack(state);

    SeaRenderer renderer;
    renderer.set_sky(sky, make_water(seen));
    renderer.upload(packed);
    const View view = view_at(seen.camera, frame);
    const ProjectedGridOptions options = projected_grid_options(*sea->plan().from);
    ProjectedGrid grid = projected_grid(view, options);
    if (sea->plan().queries.front().query.pixel_m.size() > 1)
        keep_to_rungs(grid, projected_grid_needs(view, options));
    renderer.draw(view, grid, {.lighting = render_options(seen).lighting, .layers = true});
    OffscreenPicture drawn{renderer.read_layers(), renderer.device(), {}};
    if (sea->plan().knobs.double_precision)
        drawn.note =
            "the preview computes in single precision, quality.level \"reference\" in double: "
            "use pelagic render for that";
    return drawn;
}

}  // namespace pelagic
