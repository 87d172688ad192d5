// A sea that plays while another is built: drawing never waits, the latest request wins, and errors are
// reported.
//
// Gates steer the threads, not clocks: a build waits until the test lets it continue, so that counts don't
// depend on speed. Waits for events have a time limit, which only a failing test reaches.
#include "plugin/host/preview/live.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/plan/plan.h"
#include "core/surface/projected_grid.h"
#include "plugin/host/gpu/foam_worker.h"
#include "plugin/host/gpu/sea_layout.h"
#include "plugin/machine/memory.h"
#include "plugin/render/seen_drops.h"

namespace pelagic {
namespace {

// A sea of a few hundred modes.
Scene small_scene(double wind_mps = 8.0) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.waves.cascades = {{100.0, 16}};
    return scene;
}

std::shared_ptr<const LiveBuild> small_build(const Scene& scene) {
    Query query;
    query.products = products(Product::Position, Product::Normal, Product::SlopeVariance);
    LiveBuild made;
    made.scene = scene;
    made.sea = std::make_shared<const SeaOverTime<float>>(make_plan(scene, {query}));
    return std::make_shared<const LiveBuild>(std::move(made));
}

// Waits until `happened`, or for much longer than that takes.
bool wait_for(const std::function<bool()>& happened) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!happened()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

// Lets builds wait at a gate, except that of the first sea.
class Gate {
  public:
    LiveSea::Build build() {
        return [this](const Scene& scene) {
            {
                std::unique_lock lock(mutex_);
                begun_.push_back(scene.sea.wind_speed_mps);
                ++inside_;
                open_.wait(lock, [this] { return let_through_ > 0 || begun_.size() == 1; });
                if (begun_.size() > 1) --let_through_;
                --inside_;
            }
            return small_build(scene);
        };
    }
    // Opens the gate for good when destroyed, which is before the sea whose build may still wait: a failing
    // test must not hang.
    struct Opener {
        Gate& gate;
        ~Opener() { gate.let_through(1000000); }
    };
    void let_one_through() { let_through(1); }
    void let_through(int builds) {
        {
            const std::lock_guard lock(mutex_);
            let_through_ += builds;
        }
        open_.notify_all();
    }
    bool is_waiting() const {
        const std::lock_guard lock(mutex_);
        return inside_ > 0;
    }
    std::vector<double> winds_begun() const {
        const std::lock_guard lock(mutex_);
        return begun_;
    }

  private:
    mutable std::mutex mutex_;
    std::condition_variable open_;
    std::vector<double> begun_;
    int let_through_ = 0, inside_ = 0;
};

// Does what a window does for each picture: requests the next time and takes the latest frame.
class Player {
  public:
    explicit Player(LiveSea& sea) : sea_(sea) {}
    // The frame shown after one more picture; null before the first.
    const LiveFrame* picture() {
        sea_.show(++time_s_);
        return sea_.newest();
    }
    // Draws pictures until a frame of this wind appears; returns false if it never does.
    bool play_until_wind(double wind_mps) {
        return wait_for([&] {
            const LiveFrame* frame = picture();
            return frame != nullptr && frame->build->scene.sea.wind_speed_mps == wind_mps;
        });
    }
    double time_s() const { return time_s_; }

  private:
    LiveSea& sea_;
    double time_s_ = 0.0;
};

TEST(LiveSea, FramesOfTheOldSeaKeepComingWhileTheNewOneIsBuilt) {
    Gate gate;
    LiveSea sea(gate.build());
    const Gate::Opener opener{gate};
    Player player(sea);
    sea.ask(small_scene(8.0));
    ASSERT_TRUE(player.play_until_wind(8.0));

    sea.ask(small_scene(12.0));
    ASSERT_TRUE(wait_for([&] { return gate.is_waiting(); }));
    EXPECT_TRUE(sea.status().building);
    // The build can't finish before the gate opens: all these frames are computed during it.
    long last = player.picture()->number;
    for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(wait_for([&] { return player.picture()->number > last; })) << "after " << i;
        const LiveFrame* frame = sea.newest();
        EXPECT_EQ(frame->build->scene.sea.wind_speed_mps, 8.0);
        last = frame->number;
    }
    EXPECT_TRUE(gate.is_waiting());
    gate.let_one_through();
    EXPECT_TRUE(player.play_until_wind(12.0));
    EXPECT_GT(player.picture()->number, last) << "numbers go on over the change";
    EXPECT_EQ(sea.status().seas, 2);
    EXPECT_TRUE(wait_for([&] { return !sea.status().building; }));
}

TEST(LiveSea, OfManyRequestsOnlyTheLatestIsBuilt) {
    Gate gate;
    LiveSea sea(gate.build());
    const Gate::Opener opener{gate};
    Player player(sea);
    sea.ask(small_scene(8.0));
    ASSERT_TRUE(player.play_until_wind(8.0));
    sea.ask(small_scene(9.0));
    ASSERT_TRUE(wait_for([&] { return gate.is_waiting(); }));
    for (double wind_mps = 9.1; wind_mps < 14.0; wind_mps += 0.1) sea.ask(small_scene(wind_mps));  // a slider
    sea.ask(small_scene(14.0));
    gate.let_one_through();
    gate.let_one_through();
    EXPECT_TRUE(player.play_until_wind(14.0));
    EXPECT_EQ(gate.winds_begun(), (std::vector<double>{8.0, 9.0, 14.0}));
}

TEST(LiveSea, WhatChangesNoWaveBuildsNothing) {
    Gate gate;
    LiveSea sea(gate.build());
    const Gate::Opener opener{gate};
    Player player(sea);
    Scene scene = small_scene();
    sea.ask(scene);
    ASSERT_TRUE(player.play_until_wind(8.0));
    scene.light.sun_elevation_deg = 70.0;
    scene.water.type = WaterType::Turbid;
    scene.camera.position_m.z = 100.0;
    scene.surface.cell_px = 3.0;
    sea.ask(scene);
    sea.ask(scene);
    EXPECT_FALSE(sea.status().building);
    EXPECT_EQ(gate.winds_begun().size(), 1u);
}

TEST(LiveSea, EveryKeyOfTheWavesIsAnotherSea) {
    const std::vector<std::function<void(Scene&)>> changes{
        [](Scene& s) { s.sea.wind_speed_mps = 9.0; },
        [](Scene& s) { s.sea.wind_direction_deg = 5.0; },
        [](Scene& s) { s.sea.fetch_m = 2e5; },
        [](Scene& s) { s.sea.depth_m = 10.0; },
        [](Scene& s) { s.waves.choppiness = 0.5; },
        [](Scene& s) { s.sea.swell = {Swell{}}; },
        [](Scene& s) { s.effects.whitecaps = false; },
        [](Scene& s) { s.effects.breaking_from_m = 2.0; },
        [](Scene& s) { s.effects.whitecap_amount = 2.0; },
        [](Scene& s) { s.shot.seed = 2; },
        [](Scene& s) { s.quality.level = QualityLevel::Draft; },
        [](Scene& s) { s.shot.loop_s = 1.0; },
        [](Scene& s) { s.effects.spray = true; },
        [](Scene& s) { s.effects.spray_gain = 3.0; },
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Scene changed = small_scene();
        EXPECT_TRUE(same_sea(changed, small_scene()));
        changes[i](changed);
        EXPECT_FALSE(same_sea(changed, small_scene())) << i;
    }
}

// Each frame is packed with the tables of its own time.
TEST(LiveSea, ThatChangesIsThatOfEachTime) {
    Scene scene = small_scene(8.0);
    scene.keyed = {{.path = "sea.wind_speed_mps", .keys = {.keys = {{1, 8.0}, {49, 20.0}}}}};
    LiveSea sea([](const Scene& asked) { return build_live(asked, {}); });
    sea.ask(scene);
    const auto mss_at = [&](double time_s) {
        double mss = 0.0;
        EXPECT_TRUE(wait_for([&] {
            sea.show(time_s);
            const LiveFrame* const frame = sea.newest();
            if (!frame || frame->packed->time_s() != time_s) return false;
            mss = frame->packed->layout()->sea().total().mss();
            return true;
        }));
        return mss;
    };
    const double breeze = mss_at(0.0), between = mss_at(1.0), gale = mss_at(2.0);
    EXPECT_LT(breeze, 0.9 * between);
    EXPECT_LT(between, 0.9 * gale);
    EXPECT_EQ(mss_at(1.0), between);
    EXPECT_EQ(sea.status().error, "");
}

// Its map follows the camera, over a sea that plays and over one that stands still.
TEST(LiveSea, HasTheSprayBeforeTheLatestCamera) {
    Scene scene = small_scene(20.0);
    scene.effects.spray = true;
    LiveSea sea([](const Scene& asked) { return build_live(asked, {}); });
    sea.ask(scene);
    View view = view_at(scene.camera, 1);
    const auto is_seen_from = [&](double time_s, double height_m) {
        view.position_m.z = height_m;
        return wait_for([&] {
            sea.show(time_s, {}, view);
            const auto spray = sea.newest_spray();
            return spray && spray->eye_m == static_cast<float>(height_m);
        });
    };
    EXPECT_TRUE(is_seen_from(1.0, 8.0));
    EXPECT_FALSE(sea.newest_spray()->empty());
    EXPECT_TRUE(is_seen_from(1.0, 9.0));
    EXPECT_TRUE(is_seen_from(2.0, 10.0));
    sea.show(2.0);
    EXPECT_EQ(sea.newest_spray(), nullptr);
    EXPECT_EQ(sea.status().error, "");
}

// Drops follow it on a thread of their own.
TEST(LiveSea, HasTheDropsRoundTheLatestCamera) {
    Scene scene = small_scene(20.0);
    scene.effects.foam_decay_s = 0.0;
    scene.effects.spray = scene.effects.spray_drops = true;
    LiveSea sea([](const Scene& asked) { return build_live(asked, {}); });
    sea.ask(scene);
    View view = view_at(scene.camera, 1);
    std::shared_ptr<const LiveDrops> drops;
    view.position_m = {1000.0, 0.0, 8.0};
    const auto are_of = [&](double time_s) {
        return wait_for([&] {
            sea.show(time_s, {}, view);
            drops = sea.newest_drops();
            return drops && drops->time_s == time_s && drops->drops.size() > 100 &&
                   std::abs(drops->drops.front().position_m.x - 1000.0) <= 0.5 * kDropsSquare_m;
        });
    };
    EXPECT_TRUE(are_of(1.0));
    EXPECT_TRUE(are_of(1.1));
    // From so high none is seen, and none is asked for.
    view.position_m.z = 2.0 * kDropsReach_m;
    sea.show(1.1, {}, view);
    EXPECT_EQ(sea.newest_drops(), nullptr);
    EXPECT_EQ(sea.status().error, "");
}

TEST(LiveSea, TheFrameIsOfTheTimeAskedForAndOfItAlone) {
    LiveSea sea(small_build);
    Player player(sea);
    sea.ask(small_scene());
    ASSERT_TRUE(player.play_until_wind(8.0));
    for (const double time_s : {3.25, 0.0, -2.0, 1e6}) {
        sea.show(time_s);
        ASSERT_TRUE(wait_for([&] { return sea.newest()->packed->time_s() == time_s; }));
        const auto build = sea.newest()->build;
        Frame<float> frame(build->sea);
        frame.set(time_s);
        PackedFrame alone(build->sea->first(), build->query);
        alone.pack(frame);
        EXPECT_EQ(sea.newest()->packed->planes(), alone.planes()) << time_s;
    }
    // Time stands still, so nothing more is computed. This many checks would notice now and then if it were.
    const long frames = sea.status().frames;
    for (int i = 0; i < 50; ++i) {
        sea.show(1e6);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(sea.status().frames, frames);
}

TEST(LiveSea, ItTellsOfAnEyeUnderWaterWithoutAnotherFrame) {
    LiveSea sea;
    sea.ask(small_scene());
    ASSERT_TRUE(wait_for([&] {
        sea.show(1.0);
        return sea.newest() != nullptr;
    }));
    const long frames = sea.status().frames;
    View eye = view_at(small_scene().camera, 1);
    const auto tells = [&](double z_m, bool is_under) {
        eye.position_m.z = z_m;
        return wait_for([&] {
            sea.show(1.0, eye);
            return sea.water_over_eye().has_value() == is_under;
        });
    };
    EXPECT_FALSE(sea.water_over_eye());
    EXPECT_TRUE(tells(-9.0, true));
    EXPECT_LT(std::abs(*sea.water_over_eye()), 5.0);
    EXPECT_TRUE(tells(9.0, false));
    EXPECT_TRUE(tells(-9.0, true));
    sea.show(1.0);
    EXPECT_FALSE(sea.water_over_eye());
    EXPECT_EQ(sea.status().frames, frames);
}

TEST(LiveSea, AFrameStaysAsItIsUntilTheNextIsTaken) {
    LiveSea sea(small_build);
    Player player(sea);
    sea.ask(small_scene());
    ASSERT_TRUE(player.play_until_wind(8.0));
    for (int i = 0; i < 20; ++i) {
        const LiveFrame* taken = player.picture();
        const auto planes = taken->packed->planes();
        const long number = taken->number, finished = sea.status().frames;
        // Many more are finished meanwhile, each in another slot.
        double time_s = 1000.0 * i;
        ASSERT_TRUE(wait_for([&] {
            sea.show(++time_s);
            return sea.status().frames > finished + 4;
        }));
        EXPECT_EQ(taken->number, number);
        EXPECT_EQ(taken->packed->planes(), planes);
        EXPECT_GT(sea.newest()->number, finished) << "the newest, not the next";
    }
}

TEST(LiveSea, ABuildThatFailsIsToldAndTheOldSeaPlaysOn) {
    LiveSea sea([](const Scene& scene) {
        if (scene.sea.wind_speed_mps == 13.0) throw std::runtime_error("thirteen is unlucky");
        if (scene.sea.wind_speed_mps == 14.0) throw std::bad_alloc();
        return small_build(scene);
    });
    Player player(sea);
    sea.ask(small_scene(8.0));
    ASSERT_TRUE(player.play_until_wind(8.0));
    EXPECT_EQ(sea.status().error, "");
    sea.ask(small_scene(13.0));
    EXPECT_TRUE(wait_for([&] { return sea.status().error == "thirteen is unlucky"; }));
    const long frames = sea.status().frames;
    EXPECT_TRUE(wait_for([&] {
        player.picture();
        return sea.status().frames > frames;
    }));
    EXPECT_EQ(sea.newest()->build->scene.sea.wind_speed_mps, 8.0);
    sea.ask(small_scene(14.0));
    EXPECT_TRUE(wait_for([&] { return sea.status().error.starts_with("out of memory"); }));
    sea.ask(small_scene(15.0));
    EXPECT_TRUE(player.play_until_wind(15.0));
    EXPECT_EQ(sea.status().error, "");
}

TEST(LiveSea, AFrameThatFailsIsToldAndTheNextOneComes) {
    LiveSea sea(small_build);
    Player player(sea);
    sea.ask(small_scene());
    ASSERT_TRUE(player.play_until_wind(8.0));
    sea.show(10.0 * Frame<float>::kLatest_s);
    EXPECT_TRUE(wait_for([&] { return !sea.status().error.empty(); }));
    EXPECT_NE(sea.newest(), nullptr) << "the last good one is there";
    sea.show(1.5);
    EXPECT_TRUE(wait_for([&] { return sea.newest()->packed->time_s() == 1.5; }));
    EXPECT_EQ(sea.status().error, "");
}

TEST(LiveSea, AnImpossibleSceneIsRefusedInWords) {
    LiveSea sea;
    Scene scene = small_scene();
    scene.sea.wind_speed_mps = -3.0;
    sea.ask(scene);
    EXPECT_TRUE(wait_for([&] { return !sea.status().error.empty(); }));
    EXPECT_NE(sea.status().error.find("sea.wind_speed_mps = -3"), std::string::npos) << sea.status().error;
    EXPECT_EQ(sea.newest(), nullptr);
}

TEST(LiveBuild, SaysThatASeaFoldsOver) {
    Scene scene = small_scene();
    scene.waves.choppiness = 6.0;
    const auto folding = build_live(scene, {});
    EXPECT_NE(folding->note.find("folds over itself"), std::string::npos) << folding->note;
}

// What doesn't fit the driver's textures or the memory is drawn without its shortest waves, and the window says so.
TEST(LiveBuild, LeavesOutTheShortestWavesWhereTheSeaDoesNotFit) {
    Scene scene;
    scene.waves.cascades = {{.size_m = 400.0, .resolution = 256}};
    scene.effects.foam_decay_s = 0.0;  // so that waves are most of what is held
    const auto whole = build_live(scene, {});
    EXPECT_EQ(whole->note, "");
    LiveLimits small_textures;
    small_textures.texture = 300;
    LiveLimits little_memory;
    MemoryNeed beside;
    machine::add_program(beside);
    machine::add_sky(beside);
    little_memory.memory = {beside.bytes() + whole->sea->plan().frame_bytes(), "this machine has"};
    for (const LiveLimits& limits : {small_textures, little_memory}) {
        const auto less = build_live(scene, limits);
        EXPECT_NE(less->note.find("waves below "), std::string::npos) << less->note;
        EXPECT_LT(less->sea->plan().frame_bytes(), whole->sea->plan().frame_bytes());
        EXPECT_GT(less->sea->plan().transforms_per_frame(), 0);
        for (const SeaLayout::Plane& plane : SeaLayout::planes_of(less->sea->plan(), less->query))
            EXPECT_LE(std::max(plane.size.x, plane.size.y), limits.texture);
    }
    LiveLimits none;
    none.memory = {1, "this machine has"};
    EXPECT_THROW(build_live(scene, none), NotEnoughMemory);
}

TEST(LiveSea, ItCanBeClosedAtAnyMoment) {
    { LiveSea never_used(small_build); }
    for (int i = 0; i < 20; ++i) {
        LiveSea sea(small_build);
        Player player(sea);
        for (int j = 0; j < i; ++j) {
            sea.ask(small_scene(8.0 + j));
            player.picture();
        }
    }
}

TEST(LiveWorker, TakesTurnsAndHandsEachThingOverOnce) {
    std::atomic<int> running = 0, most = 0;
    LiveWorker<int, int> worker([&](int asked) {
        most = std::max(most.load(), ++running);
        --running;
        return std::make_shared<const int>(asked * 2);
    });
    EXPECT_EQ(worker.take(), nullptr);
    for (int i = 1; i <= 100; ++i) worker.ask(i);
    std::shared_ptr<const int> made;
    EXPECT_TRUE(wait_for([&] {
        if (auto now = worker.take()) made = now;
        return made != nullptr && *made == 200;
    }));
    EXPECT_EQ(worker.take(), nullptr);
    EXPECT_FALSE(worker.is_busy());
    EXPECT_EQ(most, 1);
}

// Of points that are no whole grid's, as where a patch is cut out of it: the tiles of a grid's cells are those of its points, or
// more.
TEST(LiveFoam, IsAskedForByPointsToo) {
    Scene scene = small_scene(16.0);
    scene.effects.foam_decay_s = 4.0;
    const auto prepared = prepare(scene);
    const Plan plan =
        make_plan(prepared, {view_query(*prepared, {.finest_cell_m = 0.5, .finest_pixel_m = 0.2})}, {});
    ProjectedGrid grid = projected_grid(view_at(scene.camera, 1), projected_grid_options(*prepared));
    const auto places = [&] {
        std::set<std::array<std::int64_t, 3>> all;
        for (const FoamPlace& place : foam_places(*plan.foam, 20.0, grid))
            all.insert({place.level, place.x, place.y});
        return all;
    };
    const auto of_cells = places();
    grid.columns = grid.rows = 0;
    const auto of_points = places();
    ASSERT_FALSE(of_cells.empty());
    std::size_t missing = 0;
    for (const auto& place : of_cells) missing += !of_points.contains(place);
    std::printf("    of %zu tiles %zu are missing among %zu\n", of_cells.size(), missing, of_points.size());
    EXPECT_LT(static_cast<double>(missing), 0.01 * static_cast<double>(of_cells.size()));
    EXPECT_LT(of_points.size(), 3 * of_cells.size());
}

// Where a new sea comes the old one's foam is let go of on the drawing thread, in the middle of looking for the tiles that
// a view shows as well as of its past.
TEST(LiveFoam, IsLeftBehindWithoutWaiting) {
    Scene scene = small_scene(16.0);
    scene.effects.foam_decay_s = 4.0;
    scene.camera.resolution = {640, 360};
    const auto prepared = prepare(scene);
    const auto sea = std::make_shared<const Sea<float>>(
        make_plan(prepared, {view_query(*prepared, {.finest_cell_m = 0.5, .finest_pixel_m = 0.2})},
                  {.double_precision = false}));
    const auto grid = std::make_shared<const ProjectedGrid>(
        projected_grid(view_at(scene.camera, 1), projected_grid_options(*prepared)));
    const auto seconds_of = [](const auto& work) {
        const auto start = std::chrono::steady_clock::now();
        work();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    constexpr int kGrids = 30;
    const double looking_s =
        kGrids * seconds_of([&] { EXPECT_FALSE(foam_places(*sea->plan().foam, 20.0, *grid).empty()); });
    auto worker = std::make_unique<FoamWorker>(std::make_shared<const SeaOverTime<float>>(sea));
    worker->ask(20.0, FoamWorker::Grids(kGrids, grid));
    std::this_thread::sleep_for(std::chrono::duration<double>(0.1 * looking_s));
    ASSERT_TRUE(worker->is_busy());
    EXPECT_LT(seconds_of([&] { worker.reset(); }), 0.25 * looking_s);
}

}  // namespace
}  // namespace pelagic
