// A bake as a whole: the record, frames on their own, a real sea.

#include "plugin/bake/bake.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/evaluate.h"
#include "core/surface/projected_grid.h"
#include "plugin/bake/sequence.h"
#include "plugin/format/shot/ndbc.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"

namespace {

using namespace pelagic;
namespace fs = std::filesystem;

class Bakes : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-bake-" + std::to_string(getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    nlohmann::json bake_and_read(const Scene& scene, std::vector<int> frames = {}) {
        const RunReport report =
            bake(scene, {.out = folder_, .frames = std::move(frames), .progress = {}, .cancel = nullptr});
        std::ifstream stream(report.record);
        return nlohmann::json::parse(stream);
    }
    fs::path folder_;
};

Scene small_scene() {
    Scene scene;
    scene.shot.last_frame = 3;
    scene.surface.size_m = 100.0;
    scene.surface.resolution = 8;
    return scene;
}

TEST_F(Bakes, RecordSaysWhatTheSpectrumAndTheSeaHold) {
    Scene scene = small_scene();
    scene.surface.resolution = 32;  // cells that show most of the waves
    const auto record = bake_and_read(scene);
    EXPECT_EQ(record.at("frames").size(), 3u);
    const double spectrum_hs = record.at("spectrum").at("hs_m").get<double>();
    // One realisation of ten peak waves a side: its m0 scatters by 7 %, Hs by half of that; four deviations.
    // The mesh's cells hide a little more.
    EXPECT_NEAR(record.at("frames").at("2").at("hs_m").get<double>() / spectrum_hs, 1.0, 0.15);
    const auto& frame = record.at("frames").at("2");
    const double mss = frame.at("mss_resolved").get<double>() + frame.at("mss_residual").get<double>();
    EXPECT_NEAR(mss / record.at("spectrum").at("mss").get<double>(), 1.0, 0.05);
    EXPECT_GT(record.at("observed").at("cox_munk_1954_mss").get<double>(), 0.04);
}

TEST_F(Bakes, FramesOutsideTheShotAreRefused) {
    EXPECT_THROW(bake_and_read(small_scene(), {4}), std::invalid_argument);
    EXPECT_THROW(bake_and_read(small_scene(), {2, 1}), std::invalid_argument);
    EXPECT_FALSE(fs::exists(folder_));
}

// A product's row names its attribute; the writer's lists know it as well, or it would be missing in silence.
TEST_F(Bakes, AMeshHasEachAttributeOfTheProductsThatItAsksFor) {
    Scene scene = small_scene();
    scene.shot.last_frame = 1;
    scene.output.mesh = MeshFormat::Usda;
    bake_and_read(scene);
    std::ifstream stream(folder_ / "mesh" / (scene.shot.name + ".0001.usda"));
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const Plan plan = plan_bake(scene);
    const ProductSet asked = plan.queries[plan.outputs.front().query].query.products;
    for (const ProductRow& row : kProductTable)
        if (asked[index(row.product)] && row.in_meshes) {
            EXPECT_NE(text.find(std::string(" ") + row.in_meshes + ".timeSamples"), std::string::npos)
                << row.in_meshes;
        }
    EXPECT_EQ(asked.count(), 7u);  // those of a default mesh
}

// A map of another size leaves the mesh as it is: the frames that weren't asked for are stale all the same.
TEST_F(Bakes, FramesWithOneStaleOutputAreReported) {
    Scene scene = small_scene();
    scene.output.maps = {MapKind::Displacement};
    scene.output.map_resolution = 8;
    bake_and_read(scene);
    scene.output.map_resolution = 16;
    const RunReport report = bake(scene, {.out = folder_, .frames = {1}, .progress = {}, .cancel = nullptr});
    EXPECT_EQ(report.stale, (std::vector<int>{2, 3}));
}

Scene camera_scene() {
    Scene scene;
    scene.shot.last_frame = 2;
    scene.surface.kind = SurfaceKind::ProjectedGrid;
    scene.camera.resolution = {160, 90};
    // The second frame looks steeply down: it needs more columns than the first.
    scene.camera.keys = {{.frame = 1, .position_m = {2e3, -60.0, 9.0}, .look_at_m = {2e3, 0.0, 2.0}},
                         {.frame = 2, .position_m = {2e3, -50.0, 30.0}, .look_at_m = {2e3, -45.0, 0.0}}};
    scene.output.mesh = MeshFormat::Usda;
    return scene;
}

// The mesh of each frame is the core's answer for that frame's own grid, with the footprints of its points.
TEST(ProjectedGridBake, IsWhatTheCameraSeesAtEachFrame) {
    Scene scene = camera_scene();
    scene.surface.earth_curvature = false;  // the query's answer is that over a flat sea
    const Plan plan = plan_bake(scene);
    const auto sequence = make_sequence(plan);
    Frame<float> frame(std::make_shared<const Sea<float>>(plan));
    ProjectedGridOptions options = projected_grid_options(*prepare(scene));
    options.has_levels = true;
    const auto alone = [&](int f) { return projected_grid_needs(view_at(scene.camera, f), options).size; };
    ASSERT_FALSE(alone(1) == alone(2));
    EXPECT_EQ(plan.queries.front().query.points, points_of({std::max(alone(1).columns, alone(2).columns),
                                                            std::max(alone(1).rows, alone(2).rows)}));
    FrameSlot slot;
    for (const int f : {1, 2}) {
        sequence->compute(f, slot);
        const Values& mesh = slot.outputs.front()->values;
        const ProjectedGridSize size = alone(f);
        const ProjectedGrid grid = projected_grid(view_at(scene.camera, f), options);
        const std::size_t count = points_of(size);
        ASSERT_EQ(grid.rest_m.size(), count);
        for (const std::size_t got :
             {mesh.vectors(Product::Position).size(), mesh.vectors(Product::Normal).size(),
              mesh.vectors(Product::Velocity).size(), mesh.vectors(Product::SlopeVariance).size(),
              mesh.numbers(Product::Coverage).size()})
            EXPECT_EQ(got, count);
        std::vector<glm::vec3> position(count), normal(count), variance(count);
        frame.set(scene.shot.time_s(f));
        Results<float> results;
        results.set(Product::Position, {position.data()});
        results.set(Product::Normal, {normal.data()});
        results.set(Product::SlopeVariance, {variance.data()});
        evaluate(frame, 0,
                 Points<float>{.origin_m = grid.origin_m,
                               .count = count,
                               .rest_m = {grid.rest_m.data()},
                               .cell_m = {grid.cell_m.data()},
                               .pixel_m = {grid.cell_m.data()},
                               .cell_axis_m = {grid.cell_axis_m.data()},
                               .pixel_axis_m = {grid.cell_axis_m.data()}},
                 results);
        float nearest_m = 1e9f;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3 p = mesh.vectors(Product::Position)[i], v = mesh.vectors(Product::Velocity)[i];
            ASSERT_TRUE(
                std::isfinite(p.x + p.y + p.z + v.x + v.y + v.z + mesh.numbers(Product::Coverage)[i]));
            // In the world: the camera's nadir away from where the grid has its origin; the sum is rounded
            // once.
            EXPECT_EQ(p, glm::vec3(static_cast<float>(grid.origin_m.x + static_cast<double>(position[i].x)),
                                   static_cast<float>(grid.origin_m.y + static_cast<double>(position[i].y)),
                                   position[i].z));
            EXPECT_EQ(mesh.vectors(Product::Normal)[i], normal[i]);
            EXPECT_EQ(mesh.vectors(Product::SlopeVariance)[i], variance[i]);
            nearest_m = std::min(nearest_m, std::hypot(p.x - 2e3f, p.y - (f == 1 ? -60.0f : -50.0f)));
        }
        EXPECT_LT(nearest_m, 60.0f);
        // Far away everything is hidden, near by much is shown: footprints differ from point to point. Near by what is
        // hidden rides on the waves that are shown, so that it is their mean that counts.
        const auto rows_mean = [&](std::size_t first) {
            double sum = 0.0;
            for (std::size_t i = 0; i < count / 4; ++i)
                sum += mesh.vectors(Product::SlopeVariance)[first + i].x;
            return sum / static_cast<double>(count / 4);
        };
        EXPECT_LT(rows_mean(0), 0.95 * rows_mean(count - count / 4));
    }
}

// A renderer blurs over seconds of the screen.
TEST(MeshOfAFrame, ShowsTheShotsClockAndMovesByIt) {
    Scene scene;
    scene.surface.resolution = 16;
    scene.shot.time_scale = 0.25;
    scene.shot.time_offset_s = 100.0;
    Scene plain = scene;  // the same sea time at frame 1
    plain.shot.time_scale = 1.0;
    FrameSlot slow, fast;
    make_sequence(plan_bake(scene))->compute(1, slow);
    make_sequence(plan_bake(plain))->compute(1, fast);
    EXPECT_EQ(slow.record.time_s, 100.0);
    const Values &a = slow.outputs.front()->values, &b = fast.outputs.front()->values;
    EXPECT_EQ(a.vectors(Product::Position), b.vectors(Product::Position));
    ASSERT_FALSE(a.vectors(Product::Velocity).empty());
    for (std::size_t i = 0; i < a.vectors(Product::Velocity).size(); ++i)
        EXPECT_EQ(a.vectors(Product::Velocity)[i], 0.25f * b.vectors(Product::Velocity)[i]);
    make_sequence(plan_bake(scene))->compute(97, slow);  // four seconds later, one of the sea
    EXPECT_EQ(slow.record.time_s, 101.0);
}

TEST_F(Bakes, AProjectedGridIsTheCamerasOwn) {
    Scene scene = camera_scene();
    auto record = bake_and_read(scene);
    EXPECT_EQ(record.at("frames").size(), 2u);
    EXPECT_FALSE(record.at("frames").at("1").contains("mesh_hs_m"));
    for (const char* file :
         {"mesh/sea.topology.usda", "mesh/sea.0001.usda", "mesh/sea.0002.usda", "sea.usda"})
        EXPECT_TRUE(fs::exists(folder_ / file)) << file;
    // Another pose is another mesh, at the frame that has it; to a patch it is nothing.
    const RunOptions again{.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr};
    EXPECT_EQ(bake(scene, again).kept, 2);
    scene.camera.keys.back().position_m.z += 1.0;
    EXPECT_EQ(bake(scene, again).kept, 1);
    scene.surface.kind = SurfaceKind::Patch;
    scene.surface.size_m = 100.0;
    scene.surface.resolution = 8;
    bake(scene, again);
    scene.camera.keys.back().position_m.z += 1.0;
    EXPECT_EQ(bake(scene, again).kept, 2);
}

TEST(ParseFrames, TakesFramesRangesAndSteps) {
    const Shot shot{.first_frame = -3, .last_frame = 20};
    EXPECT_EQ(parse_frames("7", shot), (std::vector<int>{7}));
    EXPECT_EQ(parse_frames("1-4", shot), (std::vector<int>{1, 2, 3, 4}));
    EXPECT_EQ(parse_frames("1-12x5", shot), (std::vector<int>{1, 6, 11}));
    EXPECT_EQ(parse_frames("-3--1", shot), (std::vector<int>{-3, -2, -1}));
    EXPECT_EQ(parse_frames("9,1,4-8x2,-3--1,9,3-5", shot),
              (std::vector<int>{-3, -2, -1, 1, 3, 4, 5, 6, 8, 9}));
    for (const char* wrong : {"", "a", "5-1", "1-21", "-4", "1-4x0", "1-4x", "1-4x2y", "1,", ",1", "1,,2",
                              "1,2y", "1,21", "99999999999"})
        EXPECT_THROW(parse_frames(wrong, shot), std::invalid_argument) << wrong;
}

// The baked sea's Hs, Tm−1,0 and mean direction against those of the buoy's own file, over some seeds.
void expect_the_buoys_sea(const std::function<nlohmann::json(const Scene&)>& baked, const fs::path& w_file,
                          const std::string& hour) {
    const std::string text =
        "spectrum = \"file\"\nspectrum_file = \"" + w_file.string() + "\"\nspectrum_time = " + hour + "\n";
    Scene scene = parse_shot("[sea]\n" + text, "buoy.toml", check_scene);
    scene.shot.last_frame = 1;
    scene.surface.size_m = 100.0;
    scene.surface.resolution = 200;
    scene.output.attributes = {};
    const MeasuredSpectrum& buoy = *scene.sea.measured;
    // The buoy's own numbers, by the rule that NDBC states: each bin counts over half the way to its
    // neighbours.
    double m0 = 0.0, m_minus1 = 0.0, east = 0.0, north = 0.0;
    for (std::size_t i = 0; i < buoy.bins.size(); ++i) {
        const auto& bin = buoy.bins[i];
        const double low =
            i > 0 ? 0.5 * (buoy.bins[i - 1].frequency_hz + bin.frequency_hz) : bin.frequency_hz;
        const double high = i + 1 < buoy.bins.size()
                                ? 0.5 * (buoy.bins[i + 1].frequency_hz + bin.frequency_hz)
                                : bin.frequency_hz;
        const double energy = bin.density_m2_per_hz * (high - low);
        m0 += energy;
        m_minus1 += energy / (kTwoPi * bin.frequency_hz);
        east += energy * bin.c1_re;
        north += energy * bin.c1_im;
    }
    double baked_m0 = 0.0, period = 0.0, baked_east = 0.0, baked_north = 0.0;
    constexpr int kSeeds = 8;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        scene.shot.seed = static_cast<std::uint64_t>(seed);
        const auto frame = baked(scene).at("frames").at("1");
        const double hs = frame.at("hs_m").get<double>(),
                     direction = frame.at("mean_direction_deg").get<double>() * kPi / 180.0;
        baked_m0 += hs * hs / 16.0 / kSeeds;
        period += frame.at("tm_minus1_0_s").get<double>() / kSeeds;
        baked_east += std::cos(direction);
        baked_north += std::sin(direction);
    }
    // Eight tiles of ten peak waves: m0 scatters by 7 %/√8 = 2.5 %, so Hs by 1.3 %; the tail beyond the
    // buoy's last bin adds about a percent and shortens the period a little. Directions within a few degrees.
    EXPECT_NEAR(4.0 * std::sqrt(baked_m0) / (4.0 * std::sqrt(m0)), 1.0, 0.05);
    EXPECT_NEAR(period / (kTwoPi * m_minus1 / m0), 1.0, 0.05);
    const double turn = std::remainder(std::atan2(baked_north, baked_east) - std::atan2(north, east), kTwoPi);
    EXPECT_NEAR(turn * 180.0 / kPi, 0.0, 6.0);
}

TEST_F(Bakes, AMadeUpBuoysSeaComesBack) {
    const fs::path data = fs::path(PELAGIC_SOURCE_DIR) / "examples" / "data" / "made-up-99002w2024.txt";
    expect_the_buoys_sea([&](const Scene& scene) { return bake_and_read(scene); }, data,
                         "2024-10-03T06:00:00Z");
}

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_F(Bakes, MeshesAreInTheFormatThatIsAskedForAndThePagesAreText) {
    for (const auto& [format, extension, begin] :
         {std::tuple{MeshFormat::Usdc, ".usdc", "PXR-USDC"}, {MeshFormat::Usda, ".usda", "#usda 1.0"}}) {
        Scene scene = small_scene();
        scene.output.mesh = format;
        const auto record = bake_and_read(scene);
        for (const char* name : {"mesh/sea.topology", "mesh/sea.0001", "mesh/sea.0003"})
            EXPECT_TRUE(bytes_of(folder_ / (std::string(name) + extension)).starts_with(begin)) << name;
        for (const char* name : {"sea.usda", "mesh/sea.manifest.usda"})
            EXPECT_TRUE(bytes_of(folder_ / name).starts_with("#usda 1.0")) << name;
        const std::string root = bytes_of(folder_ / "sea.usda");
        EXPECT_NE(root.find("./mesh/sea.####" + std::string(extension)), std::string::npos);
        EXPECT_NE(root.find("./mesh/sea.topology" + std::string(extension)), std::string::npos);
        const auto files = record.at("frames").at("2").at("files");
        EXPECT_EQ(files.size(), 1u);
        const std::string file = "mesh/sea.0002" + std::string(extension);
        EXPECT_EQ(files.at(file).at("bytes").get<std::uintmax_t>(), fs::file_size(folder_ / file));
        EXPECT_EQ(bake(scene, {.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr}).kept, 3);
    }
}

// What a run leaves that was killed before it recorded its frames: crates of the same name and size.
TEST_F(Bakes, CratesThatAnUnrecordedRunHasReplacedAreBakedAgain) {
    Scene scene = small_scene();
    scene.output.mesh = MeshFormat::Usdc;
    bake_and_read(scene);
    const std::string first = bytes_of(folder_ / "mesh/sea.0002.usdc");
    fs::copy_file(folder_ / "sea.json", folder_ / "kept.json");
    scene.shot.seed = 2;
    bake_and_read(scene);
    ASSERT_EQ(bytes_of(folder_ / "mesh/sea.0002.usdc").size(), first.size());
    ASSERT_NE(bytes_of(folder_ / "mesh/sea.0002.usdc"), first);
    fs::rename(folder_ / "kept.json", folder_ / "sea.json");
    scene.shot.seed = 1;
    EXPECT_EQ(bake(scene, {.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr}).kept, 0);
    EXPECT_EQ(bytes_of(folder_ / "mesh/sea.0002.usdc"), first);
}

TEST(TimeText, SaysWhichStageWasBusyAndWhoWasWaitedFor) {
    RunReport report;
    EXPECT_EQ(time_text(report), "");
    report.done = 3;
    report.times = {.wall_s = 10.0,
                    .compute_busy_s = 4.1,
                    .encode_busy_s = 2.2,
                    .write_busy_s = 9.7,
                    .waiting_for_write_s = 3.0,
                    .waiting_for_encode_s = 0.3};
    const std::string busy = "compute 41 %, encode 22 %, write 97 % of the time busy; ";
    EXPECT_EQ(time_text(report), busy + "the disk was the bottleneck");
    report.times.waiting_for_encode_s = 5.0;
    EXPECT_EQ(time_text(report), busy + "no stage alone was the bottleneck");
    report.times.compute_busy_s = 7.1;
    EXPECT_EQ(time_text(report),
              "compute 71 %, encode 22 %, write 97 % of the time busy; computing was the bottleneck");
    report.times.encode_busy_s = 8.0;
    EXPECT_EQ(time_text(report),
              "compute 71 %, encode 80 %, write 97 % of the time busy; encoding was the bottleneck");
}

// One run bakes frames 2 and 3 while another is between its frame and its end: neither forgets the other's.
TEST_F(Bakes, RunsSideBySideRecordTheFramesOfBoth) {
    bool begun = false;
    const auto meanwhile = [&](const RunProgress& progress) {
        if (begun || progress.done == 0) return;
        begun = true;
        bake(small_scene(), {.out = folder_, .frames = {2, 3}, .progress = {}, .cancel = nullptr});
    };
    bake(small_scene(), {.out = folder_, .frames = {1}, .progress = meanwhile, .cancel = nullptr});
    EXPECT_EQ(bake(small_scene(), {.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr}).kept, 3);
}

TEST_F(Bakes, RecordKeepsEveryOneOfAList) {
    Scene scene = small_scene();
    scene.sea.swell = {{1.0, 9.0, 10.0}, {0.5, 7.0, 90.0}};
    const auto settings = bake_and_read(scene).at("settings");
    EXPECT_EQ(settings.at("sea.swell").size(), 2u);
    EXPECT_EQ(settings.at("sea.wind_speed_mps"), 10);
}

TEST_F(Bakes, TheBuoysSeaComesBack) {
    const fs::path data = fs::path(PELAGIC_SOURCE_DIR) / ".." / "shared" / "data" / "ndbc-41010w2019.txt";
    if (!fs::exists(data)) GTEST_SKIP() << "no " << data << ": the real buoy's data isn't here";
    for (const char* hour : {"2019-02-06T00:40:00Z", "2019-02-07T12:40:00Z"}) {
        SCOPED_TRACE(hour);
        expect_the_buoys_sea([&](const Scene& scene) { return bake_and_read(scene); }, data, hour);
    }
}

}  // namespace
