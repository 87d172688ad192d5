// The query on the GPU against evaluate(), with the same points, footprints and fields.
//
// Both are in single precision. The GPU's positions are as exact as evaluate()'s doubles (places.glsl). What
// remains is the rounding of sums of some hundred terms in another order, 1e-7 of the largest, and the
// precision of the driver's sines. The bounds are ten times llvmpipe's errors.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/scene/limits.h"
#include "plugin/host/gpu/sea_layout.h"
#include "plugin/host/gpu/shader_variants.h"
#include "plugin/host/preview/sea_textures.h"
#include "tests/plugin/host/preview/gpu.h"

namespace pelagic {
namespace {

Scene scene_of_model(WaveModel model) {
    Scene scene;
    scene.sea.wind_speed_mps = 12.0;
    scene.waves.model = model;
    if (model == WaveModel::Fft) scene.waves.cascades = {{200.0, 128}, {37.3, 96}};
    scene.waves.trains = 40;
    scene.effects.foam_decay_s = 0.0;  // all foam breaks now
    return scene;
}

Query picture_query() {
    Query query;
    query.name = "picture";
    query.products = products(Product::Position, Product::Normal, Product::SlopeVariance, Product::Coverage);
    query.cell_m = {0.6, 1.2, 2.4, 4.8, 9.6, 19.2, 38.4};
    query.pixel_m = {0.3, 0.6, 1.2, 2.4, 4.8, 9.6, 19.2, 38.4};
    return query;
}

struct Answers {
    std::vector<glm::vec3> position, normal, slope_variance;
    std::vector<float> coverage;
    explicit Answers(std::size_t n) : position(n), normal(n), slope_variance(n), coverage(n) {}
};

// The points asked of both: rest [m], cell and pixel [m].
struct Asked {
    std::vector<glm::vec2> rest_m, cell_axis_m, pixel_axis_m;
    std::vector<float> cell_m, pixel_m;
};

// Footprints from below the levels to beyond it, at distances where such pixels occur: round ones, and ellipses up to
// thirty times as long as wide.
Asked points(std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    Asked asked;
    for (std::size_t i = 0; i < count; ++i) {
        const float pixel_m = 0.1f * std::pow(1000.0f, unit(random));
        const float distance_m = 500.0f * pixel_m * unit(random), angle = 6.2831853f * unit(random);
        asked.rest_m.emplace_back(distance_m * std::cos(angle), distance_m * std::sin(angle));
        asked.pixel_m.push_back(pixel_m);
        asked.cell_m.push_back(8.0f * pixel_m);
        const float turn = 6.2831853f * unit(random),
                    ratio = i % 3 == 0 ? 0.0f : std::pow(30.0f, unit(random));
        asked.pixel_axis_m.push_back(ratio * pixel_m * glm::vec2(std::cos(turn), std::sin(turn)));
        asked.cell_axis_m.push_back(8.0f * asked.pixel_axis_m.back());
    }
    return asked;
}

struct Compared {
    glm::dvec2 origin_m{0.0};
    double time_s = 12.5;
    float unresolved_mss = 2e-6f;  // that the unresolved slopes may differ by
    bool cells_are_pixels =
        false;  // foam of surf lies on crests as a cell shows them, in pictures as a pixel does
};

void compare(const Scene& scene, const Query& query, const Compared& at, std::size_t count = 20000) {
    const auto sea = std::make_shared<const Sea<float>>(make_plan(scene, {query}));
    Frame<float> frame(sea);
    frame.set(at.time_s);
    Asked asked = points(count);
    if (at.cells_are_pixels) {
        asked.cell_m = asked.pixel_m;
        asked.cell_axis_m = asked.pixel_axis_m;
    }
    const bool asks_coverage = query.products[index(Product::Coverage)];
    Answers cpu(count);
    Results<float> results;
    results.set(Product::Position, {cpu.position.data()});
    results.set(Product::Normal, {cpu.normal.data()});
    results.set(Product::SlopeVariance, {cpu.slope_variance.data()});
    if (asks_coverage) results.set(Product::Breaking, {cpu.coverage.data()});
    evaluate(frame, 0,
             Points<float>{.origin_m = at.origin_m,
                           .count = count,
                           .rest_m = {asked.rest_m.data()},
                           .cell_m = {asked.cell_m.data()},
                           .pixel_m = {asked.pixel_m.data()},
                           .cell_axis_m = {asked.cell_axis_m.data()},
                           .pixel_axis_m = {asked.pixel_axis_m.data()}},
             results);

    gpu::need_context();
    PackedFrame packed(sea, 0);
    packed.pack(frame);
    SeaTextures textures;
    textures.upload(packed);
    std::vector<glm::vec4> inputs;
    for (std::size_t i = 0; i < count; ++i) {
        inputs.emplace_back(asked.rest_m[i], asked.cell_m[i], asked.pixel_m[i]);
        inputs.emplace_back(asked.cell_axis_m[i], asked.pixel_axis_m[i]);
    }
    ShaderSource query_source;
    query_source.add_constants(query_constants(*packed.layout(), asks_coverage));
    query_source.add_files(query_files());
    const auto ask = [&](std::string_view body) {
        const ShaderProgram program = gpu::program_of(gpu::caller(query_source, "", body));
        program.use();
        textures.bind(program, at.origin_m);
        return gpu::run(program, inputs, 2);
    };
    const auto cells =
        ask("vec4 p = given(0); vec3 d = query_cell(vec2(p.x, p.y), vec3(p.z, given(1).xy));\n"
            "answer = vec4(p.x + d.y, p.y + d.z, d.x, 1.0);");
    const auto pixels =
        ask("vec4 p = given(0); PixelAnswer a = query_pixel(vec2(p.x, p.y), vec3(p.w, given(1).zw));\n"
            "answer = vec4(a.normal, a.coverage);");
    const auto unresolved =
        ask("vec4 p = given(0); PixelAnswer a = query_pixel(vec2(p.x, p.y), vec3(p.w, given(1).zw));\n"
            "answer = vec4(a.slope_variance, a.level);");

    if (!frame.strips().empty()) {
        const auto strips = ask(
            "vec4 p = given(0); AllFoam a = with_strips(AllFoam(0.1, 0.05, 3.0, -1.0), vec2(p.x, p.y), p.w);\n"
            "answer = vec4(a.coverage, a.age_s, kMasked ? masks_at(vec2(p.x, p.y)).ripples : 1.0, a.breaking);");
        double most_white = 0.0, most_calm = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
            double coverage = 0.1, age_s = 3.0, ripples = 1.0;
            for (const WakeStrip& strip : frame.strips()) {
                const glm::dvec2 place_m = at.origin_m + glm::dvec2(asked.rest_m[i]);
                const WakeWater<double> water = strip.at(place_m, static_cast<double>(asked.pixel_m[i]));
                coverage = with_wake_foam(coverage, water.foam);
                age_s = with_wake_age(age_s, water);
                ripples *= 1.0 - strip.at(place_m, kSlick_m).calm;
            }
            most_white = std::max(most_white, coverage);
            most_calm = std::max(most_calm, 1.0 - ripples);
            ASSERT_NEAR(static_cast<double>(strips[i].x), coverage, 1e-4) << i;
            ASSERT_NEAR(static_cast<double>(strips[i].y), age_s, 1e-3 * age_s) << i;
            ASSERT_NEAR(static_cast<double>(strips[i].z), ripples, 1e-4) << i;
            ASSERT_EQ(strips[i].w, 0.05f);
        }
        EXPECT_GT(most_white, 0.5);
        EXPECT_GT(most_calm, 0.5);
    }
    const auto hs_m = static_cast<float>(4.0 * std::sqrt(sea->total().m0));
    const auto mss = static_cast<float>(sea->total().xx + sea->total().yy);
    std::vector<float> normal_error, coverage_error;
    float position_error = 0.0f, unresolved_error = 0.0f, steepest = 0.0f, most_unresolved = 0.0f,
          most_foam = 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        // The spacing of floats at this distance is no error of the waves.
        const float step_m = 2e-7f * glm::length(asked.rest_m[i]);
        position_error =
            std::max(position_error,
                     std::max(glm::distance(glm::vec3(cells[i]), cpu.position[i]) - step_m, 0.0f) / hs_m);
        normal_error.push_back(glm::distance(glm::vec3(pixels[i]), cpu.normal[i]));
        coverage_error.push_back(std::abs(pixels[i].w - cpu.coverage[i]));
        unresolved_error =
            std::max(unresolved_error, glm::distance(glm::vec3(unresolved[i]), cpu.slope_variance[i]) / mss);
        steepest = std::max(steepest, 1.0f - cpu.normal[i].z);
        most_unresolved = std::max(most_unresolved, cpu.slope_variance[i].x);
        most_foam = std::max(most_foam, cpu.coverage[i]);
    }
    std::sort(normal_error.begin(), normal_error.end());
    std::sort(coverage_error.begin(), coverage_error.end());
    const std::size_t last = count - 1;
    std::printf(
        "    position %.2e Hs, normal median %.2e 99.9 %% %.2e, coverage 99.9 %% %.2e worst %.2e, unresolved "
        "%.2e mss\n",
        position_error, normal_error[count / 2], normal_error[count - count / 1000],
        coverage_error[count - count / 1000], coverage_error[last], unresolved_error);
    // The scene has waves, so that the comparison means something.
    EXPECT_GT(steepest, 0.01f);
    EXPECT_GT(most_unresolved, 0.005f);
    EXPECT_LT(position_error, 5e-6f);
    EXPECT_LT(unresolved_error,
              gpu::is_software() ? at.unresolved_mss : 2.0f * at.unresolved_mss);  // 1.3 times, on an H200
    EXPECT_LT(normal_error[count - count / 1000], 3e-6f);
    EXPECT_LT(normal_error[count / 2], 1e-6f);
    if (!asks_coverage) return;
    EXPECT_GT(most_foam, 0.02f);
    // A hundredth of the choppiness leaves two digits less of J − 1.
    EXPECT_LT(coverage_error[count - count / 1000], scene.waves.choppiness > 0.0 ? 3e-5f : 1e-3f);
}

TEST(QueryOnTheGpu, OfCascadesIsEvaluates) {
    compare(scene_of_model(WaveModel::Fft), picture_query(), {});
}
TEST(QueryOnTheGpu, OfCascadesIsEvaluatesAMillionMetresAway) {
    compare(scene_of_model(WaveModel::Fft), picture_query(),
            {.origin_m = {1e6 + 0.3, -1e6 + 0.7}, .time_s = 1e7});
}
// Copies at random offsets: inside their cells, where two blend, and in corners, near and far, with and without what else
// makes a difference.
Scene copied(WaveModel model) {
    Scene scene = scene_of_model(model);
    scene.waves.cascades = {{60.0, 128}, {11.3, 48}};  // the points lie in thousands of cells
    scene.waves.tiling = Tiling::Random;
    return scene;
}
TEST(QueryOnTheGpu, OfCopiesIsEvaluates) {
    compare(copied(WaveModel::Fft), picture_query(), {});
}
TEST(QueryOnTheGpu, OfCopiesIsEvaluatesFarAway) {
    compare(copied(WaveModel::Fft), picture_query(), {.origin_m = {1e6 + 0.3, -1e6 + 0.7}, .time_s = 1e7});
    compare(copied(WaveModel::Fft), picture_query(), {.origin_m = {-1e8 + 0.3, 1e8 + 0.7}}, 5000);
}
TEST(QueryOnTheGpu, OfCopiesAndTrainsTogetherIsEvaluates) {
    compare(copied(WaveModel::Trochoid), picture_query(), {}, 5000);
}
TEST(QueryOnTheGpu, OfCopiesInDraftsIsEvaluates) {
    Scene scene = copied(WaveModel::Fft);
    scene.quality.level = QualityLevel::Draft;
    compare(scene, picture_query(), {}, 5000);
}
TEST(QueryOnTheGpu, OfCopiesWithoutChoppinessIsEvaluates) {
    Scene scene = copied(WaveModel::Fft);
    scene.waves.choppiness = 0.0;
    compare(scene, picture_query(), {}, 5000);
    Query query = picture_query();
    query.products[index(Product::Coverage)] = false;
    scene.effects.whitecaps = false;
    compare(scene, query, {}, 5000);
}
TEST(QueryOnTheGpu, OfCopiesOfOtherWavesThatBreakIsEvaluates) {
    for (const double breaking_from_m : {0.3, 7.0}) {
        Scene scene = copied(WaveModel::Fft);
        scene.effects.breaking_from_m = breaking_from_m;
        compare(scene, picture_query(), {}, 5000);
    }
}
TEST(QueryOnTheGpu, OfTrainsIsEvaluates) {
    compare(scene_of_model(WaveModel::Trochoid), picture_query(), {});
}
TEST(QueryOnTheGpu, OfTrainsIsEvaluatesAMillionMetresAway) {
    compare(scene_of_model(WaveModel::Trochoid), picture_query(),
            {.origin_m = {1e6 + 0.3, -1e6 + 0.7}, .time_s = 1e7});
}
TEST(QueryOnTheGpu, OfTrainsAndCascadesTogetherIsEvaluates) {
    Scene scene = scene_of_model(WaveModel::Trochoid);
    scene.waves.cascades = {{20.0, 128}};
    compare(scene, picture_query(), {});
}
TEST(QueryOnTheGpu, OfHeroesIsEvaluates) {
    for (Scene scene :
         {scene_of_model(WaveModel::Fft), scene_of_model(WaveModel::Trochoid), copied(WaveModel::Fft)}) {
        scene.waves.heroes = {{.frame = 20.0, .height_m = 3.0},
                              {.frame = 1.0, .east_m = 20.0, .height_m = 2.0}};
        compare(scene, picture_query(), {}, 5000);
    }
}
TEST(QueryOnTheGpu, OfCalmAndRoughPlacesIsEvaluates) {
    Query fine = picture_query();
    fine.cell_m = {0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0};
    fine.pixel_m = fine.cell_m;
    const std::vector<WaveMask> masks{
        {.east_m = 10.0,
         .length_m = 300.0,
         .width_m = 60.0,
         .direction_deg = 35.0,
         .edge_m = 60.0,
         .waves = 0.3},
        {.north_m = 40.0, .edge_m = 70.0, .waves = 1.4, .foam = 0.5},
        {.east_m = -20.0, .length_m = 70.0, .width_m = 40.0, .edge_m = 15.0, .ripples = 0.3}};
    const Compared at{.unresolved_mss = 4e-6f};  // in a rough place there is twice as much of them
    Scene scene = copied(WaveModel::Fft);
    scene.waves.masks = masks;
    // With pictures beside them, one coarser than its edge.
    const auto picture = [](int width, int height) {
        std::vector<float> shares;
        for (int i = 0; i < width * height; ++i)
            shares.push_back(static_cast<float>(0.5 + 0.5 * std::sin(1.7 * i)));
        return std::make_shared<const MaskPicture>(width, height, std::move(shares));
    };
    scene.waves.masks.push_back({.north_m = -30.0,
                                 .length_m = 250.0,
                                 .width_m = 90.0,
                                 .direction_deg = -35.0,
                                 .edge_m = 40.0,
                                 .waves = 1.3,
                                 .picture = "fine"});
    scene.waves.masks.push_back({.east_m = 20.0,
                                 .north_m = 5.0,
                                 .length_m = 70.0,
                                 .width_m = 80.0,
                                 .edge_m = 15.0,
                                 .ripples = 0.4,
                                 .foam = 0.2,
                                 .picture = "coarse"});
    scene.waves.mask_pictures = {{"fine", picture(64, 48)}, {"coarse", picture(3, 5)}};
    compare(scene, fine, at, 3000);
    scene.waves.mask_pictures.clear();
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
        scene = scene_of_model(model);
        scene.waves.tiling = Tiling::Periodic;
        scene.waves.masks = {masks[0], masks[1]};
        compare(scene, picture_query(), at, 3000);
    }
}
// One turns, one crosses its wake: in copies beside a mask, and far away where longer waves break. Nothing else looks at a wake on the GPU away from a
// camera.
TEST(QueryOnTheGpu, OfWakesIsEvaluates) {
    const std::vector<Vessel> vessels{
        {.path = "-400 -90 -30, 1 -20 0, 180 35 20, 360 20 75",
         .length_m = 14.0,
         .beam_m = 4.0,
         .draught_m = 1.5},
        {.path = "1 60 -80, 300 -10 20", .length_m = 9.0, .beam_m = 3.0, .draught_m = 1.0, .foam = 0.8}};
    Query fine = picture_query();
    fine.cell_m = {0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0};
    fine.pixel_m = fine.cell_m;
    const Compared at{.unresolved_mss = 6e-6f};
    Scene scene = copied(WaveModel::Fft);
    scene.waves.vessels = vessels;
    scene.waves.masks = {{.north_m = 40.0, .edge_m = 70.0, .waves = 0.7}};
    compare(scene, fine, at, 3000);
    scene = scene_of_model(WaveModel::Fft);
    scene.waves.vessels = vessels;
    scene.waves.vessels.pop_back();
    scene.effects.breaking_from_m = 7.0;
    scene.waves.vessels[0].path = "-400 999910 -1000030, 1 999980 -1000000, 180 1000015 -999990";
    compare(scene, picture_query(), {.origin_m = {1e6 + 0.3, -1e6 + 0.7}, .unresolved_mss = 6e-6f}, 3000);
}
TEST(QueryOnTheGpu, OfFourTapsAndTwoMomentsIsEvaluates) {
    Scene scene = scene_of_model(WaveModel::Fft);
    scene.quality.level = QualityLevel::Draft;
    compare(scene, picture_query(), {});
}
TEST(QueryOnTheGpu, WithoutChoppinessIsEvaluates) {
    Scene scene = scene_of_model(WaveModel::Fft);
    scene.waves.choppiness = 0.0;
    compare(scene, picture_query(), {});
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.cascades.clear();
    compare(scene, picture_query(), {});
    Query query = picture_query();
    query.products[index(Product::Coverage)] = false;
    scene.effects.whitecaps = false;
    compare(scene, query, {});
}
// A tile of its own choppiness, and one without any, whose displacements have no planes.
TEST(QueryOnTheGpu, OfCascadesOfDifferentChoppinessIsEvaluates) {
    for (const Scene& sea : {scene_of_model(WaveModel::Fft), copied(WaveModel::Fft)})
        for (const std::size_t zero : {0, 1}) {
            Scene scene = sea;
            scene.waves.cascades[zero].choppiness = 0.0;
            scene.waves.cascades[1 - zero].choppiness = 1.3;
            compare(scene, picture_query(), {}, 5000);
        }
}
// Waves that break are longer or shorter than the pixels, on one of the levels or between two.
TEST(QueryOnTheGpu, OfOtherWavesThatBreakIsEvaluates) {
    for (const double breaking_from_m : {0.3, 7.0})
        for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
            Scene scene = scene_of_model(model);
            scene.effects.breaking_from_m = breaking_from_m;
            compare(scene, picture_query(), {}, 5000);
        }
}
// Single precision leaves a gust's phase some 1e-4 of a cycle 50 km from the grid's origin, wherever that is.
TEST(QueryOnTheGpu, OfGustsIsEvaluates) {
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid})
        for (const double far_m : {0.0, 1e8}) {
            Scene scene = scene_of_model(model);
            scene.sea.gust_strength = 1.0;
            compare(
                scene, picture_query(),
                {.origin_m = {far_m, -far_m}, .time_s = far_m > 0.0 ? 1e5 : 12.5, .unresolved_mss = 2e-4f});
        }
}
// Across their edges and where two of them overlap, also far away.
TEST(QueryOnTheGpu, OfGustsFrontsIsEvaluates) {
    for (const auto& [strength, far_m] : {std::pair(0.6, 0.0), std::pair(0.0, 1e6)}) {
        Scene scene = scene_of_model(WaveModel::Fft);
        scene.sea.gust_strength = strength;
        scene.sea.gust_size_m = 40.0;
        scene.sea.gust_fronts = {{.frame = 1.0,
                                  .east_m = far_m,
                                  .north_m = -far_m,
                                  .direction_deg = 30.0,
                                  .speed_mps = 0.5,
                                  .length_m = 40.0,
                                  .width_m = 200.0,
                                  .edge_m = 60.0,
                                  .wind = 2.5},
                                 {.frame = 1.0,
                                  .east_m = far_m,
                                  .north_m = -far_m,
                                  .direction_deg = 120.0,
                                  .speed_mps = 0.0,
                                  .edge_m = 30.0,
                                  .wind = 0.4}};
        compare(scene, picture_query(),
                {.origin_m = {far_m, -far_m}, .time_s = 12.5, .unresolved_mss = 5e-5f}, 5000);
    }
}
TEST(QueryOnTheGpu, WithOneFootprintForAllIsEvaluates) {
    Query query = picture_query();
    query.cell_m = query.pixel_m = {0.8};
    compare(scene_of_model(WaveModel::Fft), query, {});
}

// OpenGL 3.3 promises 16 KiB of uniforms in a block.
TEST(SeaTables, OfSizesChosenForTheSceneFitEverywhere) {
    std::vector<Scene> scenes(5);
    scenes[1].sea.wind_speed_mps = 30.0;
    scenes[2].sea.wind_speed_mps = 3.0;
    scenes[2].sea.fetch_m = 500.0;
    scenes[3].sea.gust_strength = 0.5;
    scenes[3].sea.gust_fronts.resize(limits::kGustFronts);
    scenes[3].waves.masks.resize(limits::kMasks, {.waves = 0.5});
    scenes[4].sea.swell = {{3.0, 20.0, 0.0}};
    for (const Scene& scene : scenes)
        for (const double finest_m : {0.0, 1e-3, 0.01, 1.0}) {
            const auto prepared = prepare(scene);
            const Query query =
                view_query(*prepared, {.finest_cell_m = finest_m, .finest_pixel_m = finest_m});
            const SeaLayout layout(std::make_shared<const Sea<float>>(make_plan(prepared, {query})), 0);
            EXPECT_LE(layout.tables(glm::dvec2(0.0), 0.0).size(), 16384u) << finest_m;
        }
}

// A beach that falls to the west, with a bar, a channel and land in the east: 4 km by 0.8.
std::shared_ptr<const DepthMap> beach() {
    constexpr glm::ivec2 kSize(200, 40);
    std::vector<float> depths_m;
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x)
            depths_m.push_back(0.07f * static_cast<float>(180 - x) -
                               2.0f * std::exp(-0.01f * static_cast<float>((x - 110) * (x - 110))) +
                               std::sin(0.1f * static_cast<float>(y)));
    return std::make_shared<const DepthMap>(kSize, depths_m, glm::dvec2(100.0, -50.0),
                                            glm::dvec2(4000.0, 800.0));
}

// Far from the map's corner, beside a mask and a gust's front, whose rows stand before the coast's.
TEST(QueryOnTheGpu, OfWavesThatFeelTheFloor) {
    for (const WaveModel model : {WaveModel::Trochoid, WaveModel::Fft}) {
        Scene scene = scene_of_model(model);
        scene.sea.depth_m = 12.0;
        scene.sea.depth_file = "beach.exr";
        scene.sea.gust_fronts = {{.east_m = 1300.0, .length_m = 400.0, .width_m = 300.0, .wind = 1.5}};
        scene.waves.coast = true;
        scene.waves.coast_depths = beach();
        scene.waves.masks = {
            {.east_m = 1400.0, .length_m = 300.0, .width_m = 200.0, .edge_m = 100.0, .waves = 0.5}};
        Query query = picture_query();
        query.cell_m = query.pixel_m;
        // Where trains' phases fade beyond the map they hide some times the slopes of the sea that comes in, by wavenumbers that are sums of
        // phases of a hundred cycles: two digits less.
        const float unresolved_mss = model == WaveModel::Trochoid ? 2e-4f : 2e-6f;
        compare(scene, query,
                {.origin_m = {1350.0, 20.0}, .unresolved_mss = unresolved_mss, .cells_are_pixels = true},
                3000);
    }
}

TEST(SeaLayout, OfACalmHasNoCoast) {
    Scene scene = scene_of_model(WaveModel::Fft);
    scene.sea.wind_speed_mps = 0.0;
    scene.sea.depth_file = "beach.exr";
    scene.waves.coast = true;
    scene.waves.coast_depths = beach();
    const SeaLayout layout(std::make_shared<const Sea<float>>(make_plan(scene, {picture_query()})), 0);
    EXPECT_FALSE(layout.has_surf());
    EXPECT_EQ(layout.coast_sizes().bytes(), 0u);
}

// The levels' tiles are halves of each other; the driver holds what lies between them as well.
TEST(SeaLayout, LeavesLittleOfItsTexturesEmpty) {
    struct Case {
        double wind_mps, finest_m, least;  // least: of small textures, which have less to choose from, less
    };
    for (const auto& [wind_mps, finest_m, least] :
         {Case{20.0, 0.03, 0.89}, {12.0, 0.05, 0.84}, {12.0, 0.3, 0.84}}) {
        Scene scene;
        scene.sea.wind_speed_mps = wind_mps;
        const auto prepared = prepare(scene);
        const Query query =
            view_query(*prepared, {.finest_cell_m = 4.0 * finest_m, .finest_pixel_m = finest_m});
        const SeaLayout layout(std::make_shared<const Sea<float>>(make_plan(prepared, {query})), 0);
        for (const SeaLayout::Plane& plane : layout.planes()) {
            double taken = 0.0;
            const std::vector<SeaLayout::Tile> tiles = layout.tiles_of(plane);
            for (std::size_t i = 0; i < tiles.size(); ++i) {
                const glm::ivec2 side(layout.side_of(tiles[i])), first = tiles[i].first;
                EXPECT_TRUE(glm::all(glm::lessThanEqual(first + side, plane.size)));
                taken += static_cast<double>(side.x) * side.y;
                for (std::size_t j = 0; j < i; ++j) {
                    const glm::ivec2 other = tiles[j].first, end = other + layout.side_of(tiles[j]);
                    EXPECT_TRUE(glm::any(glm::lessThanEqual(first + side, other)) ||
                                glm::any(glm::lessThanEqual(end, first)))
                        << "tiles " << i << " and " << j;
                }
            }
            EXPECT_GT(taken, least * plane.size.x * plane.size.y) << wind_mps << " m/s, " << finest_m;
        }
    }
}

// As many explicit cascades as a shot may have need more: who draws them refuses where the driver has less.
TEST(SeaTables, ThatTheDriverCannotHoldAreRefused) {
    gpu::need_context();
    Scene scene;
    for (int i = 0; i < limits::kCascades; ++i)
        scene.waves.cascades.push_back({1000.0 * std::pow(0.6, i), 64});
    bool refused = false;
    for (const int levels : {4, 100}) {
        Query query = picture_query();
        query.cell_m.clear();
        for (int i = 0; i < levels; ++i) query.cell_m.push_back(0.5 * std::pow(1.1, i));
        query.pixel_m = query.cell_m;
        const auto sea = std::make_shared<const Sea<float>>(make_plan(scene, {query}));
        Frame<float> frame(sea);
        frame.set(0.0);
        PackedFrame packed(sea, 0);
        packed.pack(frame);
        GLint largest = 0;
        glGetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &largest);
        const bool is_too_large =
            packed.layout()->tables(glm::dvec2(0.0), 0.0).size() > static_cast<std::size_t>(largest);
        SeaTextures textures;
        try {
            textures.upload(packed);
            EXPECT_FALSE(is_too_large) << levels;
        } catch (const PreviewError& error) {
            refused = true;
            EXPECT_TRUE(is_too_large) << levels;
            EXPECT_NE(std::string(error.what()).find("ask for fewer cascades"), std::string::npos)
                << error.what();
        }
    }
    if (!refused) GTEST_SKIP() << "this driver holds the tables of every shot";
}

}  // namespace
}  // namespace pelagic
