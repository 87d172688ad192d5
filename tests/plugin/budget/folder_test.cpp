// A folder that several runs fill has one answer to a budget: the one that its files say.
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>

#include "core/plan/prepared_scene.h"
#include "plugin/bake/bake.h"
#include "plugin/budget/budget.h"
#include "tests/plugin/host/cli/program.h"

namespace pelagic::test {
namespace {

Scene small_shot() {
    Scene scene;
    scene.shot.name = "s";
    scene.shot.last_frame = 3;
    scene.waves.cascades = {{200.0, 64, {}}};
    scene.surface.size_m = 100.0;
    scene.effects.foam_decay_s = 0.0;
    scene.camera.resolution = {32, 18};
    return scene;
}

// A machine on which everything takes so many times as long as recorded.
SettleOptions on_machine(double times) {
    Rates rates = recorded_rates();
    for (double& rate : rates) rate *= times;
    return with_rates(rates);
}

std::string refusal(const std::function<void()>& work) {
    try {
        work();
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return {};
}

class FolderOf : public testing::TestWithParam<Purpose> {
  protected:
    void SetUp() override {
        scene_ = small_shot();
        scene_.quality.frame_ms = GetParam() == Purpose::Mesh ? 2.0 : 30.0;
        whole_.out = first_.out = folder_.path() / "s";
        first_.frames = {1};
    }
    // As hosts do.
    void make(const RunOptions& asked, const Settled& settled) const {
        RunOptions options = asked;
        settled.apply(options);
        make_of(settled, options);
    }
    void make_of(const Settled& settled, const RunOptions& options) const {
        if (GetParam() == Purpose::Mesh) {
            bake(settled.scene, options);
        } else {
            PictureOrder order{.scene = scene_, .options = settled.options};
            settled.apply(order);
            render_files(order, options);
        }
    }
    Settled settled(const RunOptions& run, double times = 1.0) const {
        return settle_for(run, scene_, GetParam(), on_machine(times));
    }

    TempFolder folder_;
    Scene scene_;
    RunOptions whole_, first_;
};

TEST_P(FolderOf, KeepsWhatItsFilesSay) {
    const std::string refused = refusal([&] { settled(first_); });
    for (const char* part :
         {"quality.frame_ms = ", "isn't settled yet", "begin with a run of all frames", "quality.level = "})
        EXPECT_TRUE(has(refused, part)) << refused;
    EXPECT_FALSE(std::filesystem::exists(whole_.out));

    const Settled begun = settled(whole_);
    EXPECT_FALSE(begun.is_recorded);
    make(whole_, begun);
    for (const RunOptions& run : {whole_, first_}) {
        const Settled again = settled(run);
        EXPECT_TRUE(again.is_recorded);
        EXPECT_EQ(again.settings, begun.settings);
        EXPECT_EQ(again.note, "");
        const Settled elsewhere = settled(run, 3.0);
        EXPECT_EQ(elsewhere.settings, begun.settings);
        EXPECT_NE(settle(scene_, GetParam(), on_machine(3.0)).settings, begun.settings);
        EXPECT_TRUE(has(elsewhere.note, settle(scene_, GetParam(), on_machine(3.0)).settings))
            << elsewhere.note;
    }
    // Another budget is another question.
    *scene_.quality.frame_ms *= 3.0;
    EXPECT_FALSE(settled(whole_).is_recorded);
    EXPECT_NE(refusal([&] { settled(first_); }), "");
    // And without one, nothing is asked.
    scene_.quality.frame_ms.reset();
    EXPECT_EQ(settled(first_).chosen(), "");
}

// Another version's words, or those of another kind of surface.
TEST_P(FolderOf, IsMadeAnewAndAPartRefusedWhereItsWordsAreUnknown) {
    const Settled begun = settled(whole_);
    RunOptions options = whole_;
    options.chosen = begun.budget + ": quality.level = \"dreadful\"";
    make_of(begun, options);
    const Settled anew = settled(whole_);
    EXPECT_FALSE(anew.is_recorded);
    EXPECT_EQ(anew.settings, begun.settings);
    const std::string refused = refusal([&] { settled(first_); });
    for (const std::string& part :
         {GetParam() == Purpose::Mesh ? options.chosen : "s.0001.exr", std::string("made anew")}) {
        EXPECT_TRUE(has(anew.note, part)) << anew.note;
        EXPECT_TRUE(has(refused, part)) << refused;
    }
    // Of another budget they are no answer.
    *scene_.quality.frame_ms *= 3.0;
    EXPECT_FALSE(settled(whole_).is_recorded);
}

INSTANTIATE_TEST_SUITE_P(Of, FolderOf, testing::Values(Purpose::Mesh, Purpose::Pictures),
                         [](const auto& purpose) {
                             return purpose.param == Purpose::Mesh ? "Bakes" : "Pictures";
                         });

// Two machines settle in an empty folder before either has begun.
TEST(Budget, OfTwoRunsThatBeginAtOnceIsTheFirstOnes) {
    const TempFolder folder;
    RunOptions run;
    run.out = folder.path() / "s";
    Scene scene = small_shot();
    scene.quality.frame_ms = 2.0;
    const auto settled = [&](double times) {
        return settle_for(run, scene, Purpose::Mesh, on_machine(times));
    };
    const auto make = [&](const Settled& with) {
        RunOptions options = run;
        with.apply(options);
        return bake(with.scene, options);
    };
    const Settled fast = settled(1.0), slow = settled(3.0);
    ASSERT_NE(fast.settings, slow.settings);
    make(fast);
    const auto file_state = [&] {
        return std::pair(read_file(run.out / "s.json"), read_file(run.out / "s.usda"));
    };
    const auto before = file_state();
    const std::string refused = refusal([&] { make(slow); });
    for (const std::string& part : {fast.chosen(), slow.settings, std::string("run the same command again")})
        EXPECT_TRUE(has(refused, part)) << refused;
    EXPECT_EQ(file_state(), before);
    const Settled again = settled(3.0);
    EXPECT_EQ(again.settings, fast.settings);
    EXPECT_EQ(make(again).kept, 3);
    // Another budget replaces what was chosen, unless another run has done so since.
    scene.quality.frame_ms = 6.0;
    const Settled more = settled(1.0), less = settled(3.0);
    ASSERT_NE(more.settings, less.settings);
    make(less);
    EXPECT_TRUE(has(refusal([&] { make(more); }), "has begun meanwhile"));
}

// The short waves of less wind need finer quads than the folder has.
TEST(Budget, OfAnErrorIsHeldByANewShotInAnOldFolder) {
    const TempFolder folder;
    RunOptions run;
    run.out = folder.path() / "s";
    Scene scene = small_shot();
    scene.quality.max_error = 0.1;
    scene.sea.wind_speed_mps = 20.0;
    const Settled strong = settle_for(run, scene, Purpose::Mesh);
    strong.apply(run);
    bake(strong.scene, run);
    EXPECT_TRUE(settle_for(run, scene, Purpose::Mesh).is_recorded);
    scene.sea.wind_speed_mps = 6.0;
    const Settled weak = settle_for(run, scene, Purpose::Mesh);
    EXPECT_FALSE(weak.is_recorded);
    EXPECT_EQ(weak.settings, settle(scene, Purpose::Mesh).settings);
    EXPECT_NE(weak.settings, strong.settings);
    EXPECT_LE(weak.error, 0.1);
}

TEST(Budget, IsNoSettingOfAPlan) {
    Scene scene = small_shot();
    scene.quality.max_error = 0.05;
    const std::string refused = refusal([&] { prepare(scene); });
    EXPECT_TRUE(has(refused, "quality.max_error isn't resolved yet")) << refused;
}

}  // namespace
}  // namespace pelagic::test
