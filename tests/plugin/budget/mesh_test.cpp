// Budgets of meshes: over shots that nothing was fitted to, a dozen at night, the settings that were chosen hold what they promise, and none
// at half the cost would have. Errors are measured on the mesh as a bake computes it, against the sea itself.
#include "plugin/budget/budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <random>

#include "core/base/precision.h"
#include "core/evaluate/evaluate.h"
#include "core/plan/mesh_error_model.h"
#include "core/plan/plan.h"
#include "core/plan/quality.h"
#include "core/scene/budget.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/scene/validate.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"
#include "core/waves/sea.h"
#include "plugin/accuracy/accuracy.h"
#include "plugin/accuracy/sea_answers.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

struct BudgetShot {
    const char* name;
    void (*change)(Scene&);
    double max_error;
};

// Winds, swells, depths, models and surfaces unlike those of the examples.
constexpr std::size_t kDaily = 4;  // of them: the first
const std::array kShots = std::to_array<BudgetShot>({
    {"steep gale",
     [](Scene& s) { s.sea.wind_speed_mps = 17.0, s.waves.choppiness = 1.3, s.surface.size_m = 150.0; }, 0.01},
    {"fitted cage",
     [](Scene& s) {
         s.sea.wind_speed_mps = 11.0, s.output.mesh_scheme = MeshScheme::CatmullClark,
         s.surface.size_m = 120.0;
     },
     0.01},
    {"wave trains",
     [](Scene& s) {
         s.sea.wind_speed_mps = 8.0, s.waves.model = WaveModel::Trochoid, s.surface.size_m = 120.0;
     },
     0.03},
    {"projected grid",
     [](Scene& s) {
         s.sea.wind_speed_mps = 13.0, s.surface.kind = SurfaceKind::ProjectedGrid,
         s.camera.resolution = {320, 180};
     },
     0.08},
    {"light breeze", [](Scene& s) { s.sea.wind_speed_mps = 4.0, s.surface.size_m = 60.0; }, 0.03},
    {"fresh breeze, coarse", [](Scene& s) { s.sea.wind_speed_mps = 10.0, s.surface.size_m = 300.0; }, 0.05},
    {"fresh breeze, fine", [](Scene& s) { s.sea.wind_speed_mps = 10.0, s.surface.size_m = 100.0; }, 0.006},
    {"gale", [](Scene& s) { s.sea.wind_speed_mps = 19.0, s.surface.size_m = 500.0; }, 0.02},
    {"swell alone",
     [](Scene& s) {
         s.sea.wind_speed_mps = 0.0, s.sea.swell = {{2.0, 9.0, 40.0}}, s.surface.size_m = 400.0;
     },
     0.01},
    {"two seas",
     [](Scene& s) {
         s.sea.wind_speed_mps = 7.0, s.sea.swell = {{3.0, 12.0, 160.0}}, s.surface.size_m = 250.0;
     },
     0.012},
    {"shallow",
     [](Scene& s) {
         s.sea.wind_speed_mps = 9.0, s.sea.depth_m = 3.0, s.sea.spectrum = SpectrumKind::Tma,
         s.surface.size_m = 80.0;
     },
     0.02},
    {"not pressed",
     [](Scene& s) { s.sea.wind_speed_mps = 12.0, s.waves.choppiness = 0.0, s.surface.size_m = 200.0; }, 0.02},
    {"near and far",
     [](Scene& s) {
         s.sea.wind_speed_mps = 11.0, s.surface.kind = SurfaceKind::NearFar, s.surface.size_m = 60.0;
     },
     0.2},
});

Scene scene_of(const BudgetShot& shot) {
    Scene scene;
    scene.shot.last_frame = 9;
    shot.change(scene);
    scene.quality.max_error = shot.max_error;
    return scene;
}

// A place on the drawn surface: what it is there, and where the sea is to be asked.
struct Samples {
    std::vector<glm::vec2> rest_m;
    std::vector<glm::dvec3> drawn;
    std::vector<float> pixel_m;
};

// Four a face: corners of random triangles of it, or places of the limit surface.
Samples samples_of(const RestSurface& surface, const Scene& scene, int frame, const RestPoints<float>& points,
                   const std::vector<glm::vec3>& vertices) {
    std::minstd_rand random(7);
    std::uniform_real_distribution<double> uniform;
    Samples samples;
    if (const auto cage = surface.fitted()) {
        std::vector<glm::vec3> cage_points;
        cage->fit(vertices, cage_points);
        const double spacing_m = scene.surface.size_m / cage->quads, first_m = -0.5 * scene.surface.size_m;
        const auto weights = [](double t) {
            const double s = 1.0 - t;
            return std::array{s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                              (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
        };
        for (int y = 0; y < cage->quads; ++y)
            for (int x = 0; x < cage->quads; ++x) {
                const double u = uniform(random), v = uniform(random);
                const auto across = weights(u), along = weights(v);
                glm::dvec3 place(0.0);
                for (int j = 0; j < 4; ++j)
                    for (int i = 0; i < 4; ++i)
                        place += along[static_cast<std::size_t>(j)] * across[static_cast<std::size_t>(i)] *
                                 glm::dvec3(cage_points[static_cast<std::size_t>(
                                     (y + j) * cage->vertices_per_side() + x + i)]);
                samples.drawn.push_back(place);
                samples.rest_m.push_back(
                    glm::vec2(first_m + (x + u) * spacing_m, first_m + (y + v) * spacing_m));
                samples.pixel_m.push_back(0.0f);
            }
        return samples;
    }
    Faces faces;
    surface.faces_at(frame, faces);
    const View view = view_at(scene.camera, frame);
    const auto triangle = [&](std::array<int, 3> corners) {
        double a = uniform(random), b = uniform(random);
        if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
        const std::array weight{1.0 - a - b, a, b};
        glm::dvec2 rest(0.0);
        glm::dvec3 drawn(0.0);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto corner = static_cast<std::size_t>(corners[i]);
            rest += weight[i] * glm::dvec2(points.rest_m[corner]);
            drawn += weight[i] * glm::dvec3(vertices[corner]);
        }
        samples.rest_m.emplace_back(rest);
        samples.drawn.push_back(drawn);
        const double away_m = glm::length(glm::dvec3(rest + points.origin_m, 0.0) - view.position_m);
        samples.pixel_m.push_back(surface.shaped_by(frame) ? static_cast<float>(view.pixel_tangent() * away_m)
                                                           : 0.0f);
    };
    std::size_t corner = 0;
    for (const int count : faces.counts) {
        for (int i = 2; i < count; ++i)
            triangle({faces.indices[corner], faces.indices[corner + static_cast<std::size_t>(i) - 1],
                      faces.indices[corner + static_cast<std::size_t>(i)]});
        corner += static_cast<std::size_t>(count);
    }
    return samples;
}

// Positions relative to the points' origin.
template <class T>
std::vector<glm::vec3> positions(const Plan& plan, int query, const Scene& scene, int frame,
                                 const RestPoints<T>& at) {
    Frame<T> sea(std::make_shared<const Sea<T>>(plan));
    sea.set(scene.shot.time_s(frame));
    std::vector<glm::vec3> result(at.rest_m.size());
    Points<T> points{.origin_m = at.origin_m, .count = at.rest_m.size(), .rest_m = {at.rest_m.data()}};
    if (!at.cell_m.empty()) points.cell_m = {at.cell_m.data()};
    if (!at.pixel_m.empty()) points.pixel_m = {at.pixel_m.data()};
    if (!at.cell_axis_m.empty()) points.cell_axis_m = {at.cell_axis_m.data()};
    if (!at.pixel_axis_m.empty()) points.pixel_axis_m = {at.pixel_axis_m.data()};
    Results<T> results;
    std::vector<glm::vec<3, T>> values(at.rest_m.size());
    results.set(Product::Position, {values.data()});
    evaluate(sea, query, points, results);
    std::copy(values.begin(), values.end(), result.begin());
    return result;
}

// RMS distance over Hs of the mesh that a bake of this scene would write.
double measured_error(const Scene& scene) {
    const int frame = middle_frame(scene);
    const auto prepared = prepare(scene);
    const Plan plan = plan_bake(prepared, std::span(&frame, 1));
    const RestSurface& surface = *plan.surface;
    RestPoints<float> points;
    surface.points_at(frame, points);
    std::vector<glm::vec3> vertices;
    with_precision(plan.knobs.double_precision, [&]<class T>(T) {
        RestPoints<T> at;
        surface.points_at(frame, at);
        vertices = positions<T>(plan, plan.outputs.front().query, scene, frame, at);
    });
    const Samples samples = samples_of(surface, scene, frame, points, vertices);

    Query query = view_query(
        *prepared, {.products = products(Product::Position), .finest_cell_m = 1e-3, .finest_pixel_m = 1e-3});
    const bool is_seen = surface.shaped_by(frame).has_value();
    if (!is_seen) query.cell_m = query.pixel_m = {0.0}, query.is_view = false;
    // Its own reading errs by 3e-5 of Hs.
    const Plan exact =
        make_plan(prepared, {query}, {.knobs = Knobs{.spline_taps = 6, .double_precision = true}});
    RestPoints<double> at{.origin_m = points.origin_m};
    at.rest_m.assign(samples.rest_m.begin(), samples.rest_m.end());
    if (is_seen) {
        at.cell_m.assign(samples.pixel_m.begin(), samples.pixel_m.end());
        at.pixel_m = at.cell_m;
    }
    const std::vector<glm::vec3> sea = positions<double>(exact, 0, scene, frame, at);
    double sum = 0.0;
    for (std::size_t i = 0; i < sea.size(); ++i) {
        const glm::dvec3 off = samples.drawn[i] - glm::dvec3(sea[i]);
        sum += glm::dot(off, off);
    }
    return std::sqrt(sum / static_cast<double>(sea.size())) / prepared->extent.significant_height_m;
}

// Of a sea of one realisation: patches hold few of the longest waves, and their heights are what they are.
constexpr double kRealisation = 1.1;

class BudgetOfMesh : public testing::TestWithParam<BudgetShot> {};

TEST_P(BudgetOfMesh, HoldsAndHalfTheCostWouldNot) {
    const Scene scene = scene_of(GetParam());
    ASSERT_TRUE(validate(scene).empty());
    const Settled settled = settle(scene, Purpose::Mesh);
    ASSERT_TRUE(settled.holds) << settled.text;
    EXPECT_FALSE(has_budget(settled.scene.quality));
    const double most = *scene.quality.max_error;
    const double found = measured_error(settled.scene);
    RecordProperty("error", number_text(found));
    EXPECT_LE(found, kRealisation * most) << settled.text;

    // Of each level, the finest surface at half the cost.
    const std::vector<Surface> surfaces = rising_fineness(scene);
    const auto ms = [&](Scene at, const Surface& surface) {
        at.surface = surface;
        return cost_ms(work_of(plan_bake(at)));
    };
    const double half_ms = 0.5 * ms(settled.scene, settled.scene.surface);
    for (const QualityLevel level : {QualityLevel::Draft, QualityLevel::Preview, QualityLevel::Final}) {
        Scene cheap = settled.scene;
        cheap.quality.level = level;
        const auto too_dear = std::partition_point(
            surfaces.begin(), surfaces.end(), [&](const Surface& at) { return ms(cheap, at) <= half_ms; });
        if (too_dear == surfaces.begin()) continue;
        cheap.surface = *(too_dear - 1);
        EXPECT_GT(measured_error(cheap), most) << settled.text;
    }
}

// Of time: what is chosen costs no more, and is the most accurate of a list of all that cost no more.
TEST(BudgetOfMeshes, OfTimeIsSpent) {
    for (const Tiling tiling : {Tiling::Random, Tiling::Periodic})
        for (const double most_ms : {1.0, 4.0, 20.0}) {
            Scene scene;
            scene.waves.tiling = tiling;
            scene.waves.cascades = {{128.0, 256}, {16.0, 128}};
            scene.surface.size_m = 128.0;
            scene.quality.frame_ms = most_ms;
            const Settled settled = settle(scene, Purpose::Mesh, with_rates(recorded_rates()));
            ASSERT_TRUE(settled.holds) << settled.text;
            EXPECT_LE(cost_ms(work_of(plan_bake(settled.scene))), 1.001 * most_ms) << settled.text;
            const MeshErrorModel model(*prepare(settled.scene));
            const auto spacing_error = [&](const Surface& at) {
                return model.error(at.size_m / at.resolution, 0.0, Drawn::Triangles);
            };
            for (const Surface& surface : rising_fineness(scene)) {
                Scene other = settled.scene;
                other.surface = surface;
                if (cost_ms(work_of(plan_bake(other))) > most_ms) continue;
                EXPECT_GE(spacing_error(surface), 0.999 * spacing_error(settled.scene.surface))
                    << settled.text << ", and " << surface.resolution << " costs no more";
            }
        }
}

// The recorded errors of reading, over every example that has grids.
TEST(NightlyBudgetOfMeshes, ReadingErrsByNoMoreThanIsRecorded) {
    const auto table = approximation_table();
    const auto row = std::find_if(table.begin(), table.end(), [](const ApproximationRow& each) {
        return std::string(each.name) == "interpolation";
    });
    ASSERT_NE(row, table.end());
    int compared = 0;
    for (const auto& entry : std::filesystem::directory_iterator(PELAGIC_SOURCE_DIR "/examples")) {
        if (entry.path().extension() != ".toml") continue;
        Scene scene = load_shot(entry.path(), check_scene);
        if (!frames_of_sea(scene).empty())
            scene = scene_at(scene, scene.shot.first_frame);  // its grids are the same at each
        const MeasuredRow measured = sweep(*row, scene, 1, {});
        for (const MeasuredSetting& setting : measured.settings)
            for (const QualityRow& level : quality_table()) {
                const std::string name = (level.spline_taps == 4 ? "cubic, " : "quintic, ") +
                                         number_text(level.oversampling) + " nodes a sample";
                if (setting.setting != name) continue;
                EXPECT_LE(setting.errors.front(), level.read_error) << entry.path() << ", " << name;
                ++compared;
            }
    }
    EXPECT_GE(compared, 3 * 7) << "seven examples have grids, and three levels are swept";
}

// A calm has no error, whatever its mesh; a bake without a mesh has no surface to choose.
TEST(BudgetOfMeshes, OfACalmAndOfMapsAlone) {
    Scene calm;
    calm.sea.wind_speed_mps = 0.0;
    calm.quality.max_error = 1e-6;
    const Settled flat = settle(calm, Purpose::Mesh);
    EXPECT_TRUE(flat.holds);
    EXPECT_EQ(flat.scene.quality.level, QualityLevel::Draft) << flat.text;
    Scene maps;
    maps.output.mesh = MeshFormat::None;
    maps.output.maps = {MapKind::Displacement};
    maps.quality.max_error = 0.001;
    const Settled settled = settle(maps, Purpose::Mesh);
    EXPECT_TRUE(settled.holds) << settled.text;
    EXPECT_EQ(settled.scene.surface.resolution, maps.surface.resolution);
    EXPECT_EQ(settled.scene.quality.level, QualityLevel::Preview) << settled.text;
}

std::string name_of(const testing::TestParamInfo<BudgetShot>& shot) {
    std::string name = shot.param.name;
    std::erase_if(name, [](char c) { return c == ' ' || c == ','; });
    return name;
}
INSTANTIATE_TEST_SUITE_P(Daily, BudgetOfMesh, testing::ValuesIn(kShots.begin(), kShots.begin() + kDaily),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Nightly, BudgetOfMesh, testing::ValuesIn(kShots.begin() + kDaily, kShots.end()),
                         name_of);

}  // namespace
}  // namespace pelagic
