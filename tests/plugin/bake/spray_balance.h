// The spray over a square of sea beside the formulas, and beside how much of that sea breaks, which is found another way: at
// points at rest, each by the area of sea that it stands for.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/effects/spray.h"
#include "core/evaluate/values.h"
#include "core/plan/prepared_scene.h"
#include "core/plan/spray.h"
#include "core/waves/whitecaps.h"
#include "plugin/bake/bake.h"
#include "plugin/bake/sequence.h"
#include "plugin/files/files.h"
#include "tests/plugin/bake/read_vdb.h"

namespace pelagic::test {

// Each over what the formulas say of the mean sea.
struct SprayBalance {
    double mass_flux = 0.0;          // as the record has it
    double optical_thickness = 0.0;  // of the file, as OpenVDB reads it
    double breaking = 0.0;           // what breaks in this square
};

inline double breaking_in_square(const Scene& scene) {
    const int a_side = static_cast<int>(scene.surface.size_m / scene.output.voxel_m);
    const double spacing_m = scene.surface.size_m / a_side;
    Query query;
    query.name = "breaking";
    query.products = products(Product::Breaking, Product::JacobianMoments);
    query.cell_m = query.pixel_m = {spacing_m};
    const auto sea = std::make_shared<const Sea<float>>(make_plan(scene, {query}));
    Frame<float> frame(sea);
    frame.set(scene.shot.time_s(scene.shot.first_frame));
    std::vector<glm::vec2> rest_m;
    for (int y = 0; y < a_side; ++y)
        for (int x = 0; x < a_side; ++x)
            rest_m.emplace_back((x + 0.5) * spacing_m - 0.5 * scene.surface.size_m,
                                (y + 0.5) * spacing_m - 0.5 * scene.surface.size_m);
    Values values;
    QueryRunner<float>().run(frame, 0, Points<float>{.count = rest_m.size(), .rest_m = {rest_m.data()}},
                             values);
    double foam = 0.0, area = 0.0;
    for (std::size_t i = 0; i < rest_m.size(); ++i) {
        const glm::vec3 j = values.vectors(Product::JacobianMoments)[i];
        const auto of = static_cast<double>(
            sea_area(JacobianMoments<float>{j.x, j.y, j.z}, sea->plan().knobs.third_moment));
        foam += of * static_cast<double>(values.numbers(Product::Breaking)[i]);
        area += of;
    }
    return foam / area / mean_breaking(*sea);
}

// The scene's only output is spray.
inline SprayBalance spray_balance(const Scene& scene) {
    namespace fs = std::filesystem;
    const fs::path file =
        fs::temp_directory_path() / ("pelagic-balance-" + std::to_string(getpid()) + ".vdb");
    const int frame = scene.shot.first_frame;
    const std::unique_ptr<Sequence> sequence = make_sequence(plan_bake(scene));
    FrameSlot slot;
    sequence->compute(frame, slot);
    sequence->encode(slot);
    sequence->write(slot, [&](const FileJob& job) { files::write_atomically(file, job.content); });
    const SprayLaw law = spray_law(scene, prepare(scene)->extent.significant_height_m);
    const double area_m2 = scene.surface.size_m * scene.surface.size_m;
    SprayBalance balance;
    for (const auto& [path, recorded] : slot.record.files)
        balance.mass_flux = recorded.spray->mass_flux_kg_per_s / (law.mass_flux_kg_per_m2_s * area_m2);
    double sum = 0.0;  // of extinctions
    read_vdb(file).front().for_each(
        [&](glm::ivec3, glm::vec3 value) { sum += static_cast<double>(value.x); });
    balance.optical_thickness = sum * std::pow(scene.output.voxel_m, 3.0) / area_m2 /
                                (law.optical_thickness() - law.haze.optical_thickness());
    balance.breaking = breaking_in_square(scene);
    fs::remove(file);
    return balance;
}

inline Scene spray_shot(double wind_speed_mps, double size_m, double voxel_m) {
    Scene scene;
    scene.shot.last_frame = 1;
    scene.sea.wind_speed_mps = wind_speed_mps;
    scene.surface.size_m = size_m;
    scene.effects.spray = true;
    scene.effects.spray_law = SpraySource::Monahan1986;
    scene.output.mesh = MeshFormat::None;
    scene.output.volumes = {VolumeKind::Spray};
    scene.output.voxel_m = voxel_m;
    return scene;
}

}  // namespace pelagic::test
