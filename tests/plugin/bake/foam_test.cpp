// Foam that lives, in what a bake writes.
#include <gtest/gtest.h>
#include <unistd.h>

#include <ImfChannelList.h>
#include <tbb/global_control.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/scene/names.h"
#include "core/scene/validate.h"
#include "core/waves/whitecaps.h"
#include "plugin/bake/bake.h"
#include "plugin/bake/sequence.h"
#include "tests/plugin/bake/closure_shots.h"
#include "tests/plugin/bake/read_exr.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

Scene scene_of(SurfaceKind kind) {
    Scene scene;
    scene.shot.last_frame = 8;
    scene.sea.wind_speed_mps = 14.0;
    scene.effects.foam_decay_s = 1.5;
    scene.surface.kind = kind;
    scene.surface.size_m = 60.0;
    scene.surface.resolution = 64;
    scene.camera.resolution = {160, 90};
    if (kind == SurfaceKind::Cage) scene.surface.cage = std::make_shared<const Cage>(test::small_cage());
    return scene;
}

std::string text_of_file(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

// On every kind of surface, and on one thread.
TEST(BakedFoam, OfAFrameAloneIsThatOfARun) {
    for (const auto& [kind, word] : words_of(SurfaceKind())) {
        SCOPED_TRACE(word);
        const Scene scene = scene_of(kind);
        ASSERT_TRUE(validate(scene).empty());
        const Plan plan = plan_bake(scene);
        FrameSlot run_slot, alone_slot;
        const auto run = make_sequence(plan), alone = make_sequence(plan);
        for (int frame = 1; frame <= 8; ++frame) run->compute(frame, run_slot);
        {
            const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
            alone->compute(8, alone_slot);
        }
        const OutputSlot &in_run = *run_slot.outputs.front(), &cold = *alone_slot.outputs.front();
        const std::vector<float>& total = cold.values.numbers(Product::Coverage);
        EXPECT_EQ(in_run.values.numbers(Product::Coverage), total);
        EXPECT_EQ(in_run.foam_active, cold.foam_active);
        EXPECT_EQ(in_run.foam_age_s, cold.foam_age_s);
        ASSERT_EQ(cold.foam_age_s.size(), total.size());
        ASSERT_GT(total.size(), 100u);
        for (std::size_t i = 0; i < total.size(); ++i) {
            EXPECT_GE(total[i], cold.foam_active[i]);
            EXPECT_LE(total[i], 1.0f);
            EXPECT_TRUE(cold.foam_age_s[i] >= 0.0f && cold.foam_age_s[i] <= 3.0f * 1.5f);
        }
    }
}

// A frame alone has a past to go through: a bake that is cancelled meanwhile ends.
TEST(BakedFoam, IsCancelledInItsPast) {
    const Plan plan = plan_bake(scene_of(SurfaceKind::Patch));
    std::atomic<bool> enough = false;
    const auto sequence = make_sequence(plan, {.progress = {}, .cancel = &enough});
    FrameSlot slot;
    enough = true;
    EXPECT_THROW(sequence->compute(1, slot), BuildCancelled);
    enough = false;
    sequence->compute(1, slot);
    FrameSlot other;
    make_sequence(plan)->compute(1, other);
    EXPECT_EQ(slot.outputs.front()->foam_age_s, other.outputs.front()->foam_age_s);
}

// And it says how far it is, over all of its parts; a run's next frame has nothing long to go through.
TEST(BakedFoam, SaysHowFarItsPastIs) {
    Scene scene = scene_of(SurfaceKind::Patch);
    scene.output.maps = {MapKind::Whitecaps, MapKind::Displacement, MapKind::Normal};
    scene.output.map_resolution = 32;
    const auto sequence = make_sequence(plan_bake(scene));
    FrameSlot slot;
    std::vector<double> told;
    const auto tell = [&](double done) { told.push_back(done); };
    sequence->compute(1, slot, tell);
    EXPECT_GT(told.size(), 5u);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_GT(told.front(), 0.0);
    EXPECT_NEAR(told.back(), 1.0, 0.05);  // though there are maps that have no foam
    told.clear();
    sequence->compute(2, slot, tell);
    EXPECT_TRUE(told.empty());

    const fs::path folder = fs::temp_directory_path() / ("pelagic-foam-past-" + std::to_string(getpid()));
    scene.shot.last_frame = 1;
    int during = 0;
    double last = 1.0;
    bake(scene, {.out = folder, .frames = {}, .progress = [&](const RunProgress& now) {
                     during += now.stage == RunStage::Frames && now.done == 0 && now.share > 0.0;
                     last = now.share;
                 }});
    fs::remove_all(folder);
    EXPECT_GT(during, 5);
    EXPECT_EQ(last, 0.0);
}

TEST(BakedFoam, IsInFilesOnlyWhereItLives) {
    const fs::path folder = fs::temp_directory_path() / ("pelagic-foam-" + std::to_string(getpid()));
    Scene scene = scene_of(SurfaceKind::Patch);
    scene.shot.last_frame = 1;
    scene.output.mesh = MeshFormat::Usda;
    scene.output.maps = {MapKind::Whitecaps};
    scene.output.map_resolution = 128;
    for (const double decay_s : {0.0, 1.5}) {
        fs::remove_all(folder);
        scene.effects.foam_decay_s = decay_s;
        bake(scene, {.out = folder, .frames = {}, .progress = {}, .cancel = nullptr});
        const bool lives = decay_s > 0.0;
        for (const char* file : {"mesh/sea.0001.usda", "mesh/sea.manifest.usda"})
            for (const char* name : {"primvars:foamAge", "primvars:foamActive"})
                EXPECT_EQ(text_of_file(folder / file).find(name) != std::string::npos, lives) << file;
        const fs::path map = folder / "maps/sea.whitecaps.0001.exr";
        const Imf::TiledInputFile opened(map.c_str());
        EXPECT_EQ(opened.header().channels().findChannel("foamAge") != nullptr, lives);
        if (!lives) continue;
        // At each level coverage is what breaks and what is left, and its mean stays.
        double before = 0.0;
        for (const int level : {0, 1, 2, 3}) {
            const auto total = test::read_level(map, "R", level),
                       active = test::read_level(map, "foamActive", level),
                       residual = test::read_level(map, "foamResidual", level);
            double mean = 0.0;
            for (std::size_t i = 0; i < total.values.size(); ++i) {
                EXPECT_NEAR(total.values[i], active.values[i] + residual.values[i], 2e-3);
                mean += double(residual.values[i]) / static_cast<double>(total.values.size());
            }
            EXPECT_GT(mean, 0.0);
            if (level > 0) {
                EXPECT_NEAR(mean / before, 1.0, 0.06);
            }
            before = mean;
        }
    }
    fs::remove_all(folder);
}

// The record's mean coverage is that of all foam: the law's.
TEST(BakedFoam, HasTheLawsCoverageInTheRecord) {
    Scene scene = scene_of(SurfaceKind::Patch);
    scene.surface.size_m = 1500.0;
    scene.surface.resolution = 250;
    FrameSlot slot;
    const auto sequence = make_sequence(plan_bake(scene));
    sequence->compute(1, slot);
    sequence->encode(slot);
    EXPECT_NEAR(*slot.outputs.front()->coverage / law_coverage(scene), 1.0, 0.1);
}

}  // namespace
}  // namespace pelagic
