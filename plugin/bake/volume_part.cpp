#include "plugin/bake/volume_part.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/lighting/spray.h"
#include "core/plan/spray.h"
#include "plugin/bake/volumes.h"

namespace pelagic {

double spray_top_m(const SprayLaw& law) {
    return std::max(
        law.over_foam.extinction_per_m > 0.0 ? -law.over_foam.scale_m * std::log(kNegligibleSpray) : 0.0,
        law.ribbons.top_m());
}

FilePattern volume_pattern(const Scene& scene, VolumeKind volume) {
    return {"volumes/" + scene.shot.name + '.' + std::string(word_of(volume)) + '.', ".vdb"};
}

usd::Volume volume_prim(const Plan& plan, VolumeKind volume) {
    const Scene& scene = plan.from->scene;
    const double half_m = 0.5 * scene.surface.size_m, voxel_m = scene.output.voxel_m;
    const double height_m = plan.from->extent.height_m;
    const auto round = [](const glm::dvec3& low_m, const glm::dvec3& high_m) {
        return usd::Extent{glm::vec3(low_m), glm::vec3(high_m)};
    };
    if (volume == VolumeKind::Spray)
        return {
            .prim = "Spray",
            .file_prefix = {},
            .fields = {{"density", "fogVolume"}, {"velocity", "unknown", true}, {"v", "unknown", true}},
            .extent = round(
                {-half_m, -half_m, -height_m - voxel_m},
                {half_m + voxel_m, half_m + voxel_m,
                 height_m + spray_top_m(spray_law(scene, plan.from->extent.significant_height_m)) + voxel_m}),
            .mean_cosine = Spray{}.forward.x};
    const double beside_m = kHalfWidth_voxels * voxel_m;
    return {.prim = "LevelSet",
            .file_prefix = {},
            .fields = {{"surface", "levelSet"}},
            .extent = round({-half_m - beside_m, -half_m - beside_m,
                             -height_m - (kBelow_voxels + 1.0) * voxel_m - beside_m},
                            {half_m + beside_m, half_m + beside_m, height_m + beside_m})};
}

std::unique_ptr<OutputPart> make_volume_part(const Plan& plan, const PlannedOutput& output,
                                             const std::shared_ptr<SquareCache>&) {
    switch (*output.volume) {
        case VolumeKind::Spray:
            return make_spray_part(plan, output);
        case VolumeKind::LevelSet:
            return make_level_set_part(plan, output);
    }
    throw std::logic_error("a volume of no kind");
}

}  // namespace pelagic
