// Each hard case through the reader, the core, every writer, the pictures and the rays: finite, at its limit, or refused in words.
#include "tests/hard_cases/hard_pictures.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/precision.h"
#include "core/effects/sea_at_time.h"
#include "core/evaluate/values.h"
#include "core/plan/plan.h"
#include "pelagic/procedural.h"
#include "plugin/bake/bake.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"

namespace pelagic {
namespace {

using test::HardCase;

class HardCases : public testing::TestWithParam<HardCase> {
  protected:
    Scene scene() const { return load_shot(GetParam().file, check_scene); }
    int frame() const { return 1; }

    void expect_baked(MeshFormat format) const {
        if (!GetParam().loads()) return;
        const std::filesystem::path out =
            std::filesystem::temp_directory_path() / ("pelagic-hard-" + std::to_string(getpid()));
        Scene shot = scene();
        shot.output.mesh = format;
        std::filesystem::remove_all(out);
        const RunReport report = bake(shot, {.out = out, .frames = {}, .progress = {}, .cancel = nullptr});
        EXPECT_EQ(report.done, 1);
        std::filesystem::remove_all(out);
    }

    void expect_pictures(SkyQuality quality) const {
        if (!GetParam().loads()) return;
        const Scene shot = scene();
        const std::array frames{frame()};
        RenderOptions options = render_options(shot);
        options.samples = 1;
        options.lighting.sky_quality = quality;
        options.layers.set();
        std::string message;
        Picture picture;
        try {
            Renderer renderer(shot, options, make_sky(shot), frames);
            renderer.render(frame(), picture);
        } catch (const std::invalid_argument& error) {
            message = error.what();
        }
        test::expect_as_told(GetParam(), message, picture);
        for (const std::vector<float>& layer : picture.data)
            for (const float value : layer) ASSERT_TRUE(std::isfinite(value));
    }
};

void expect_finite(const std::vector<glm::vec3>& values, const char* what) {
    for (const glm::vec3& v : values)
        ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) << what;
}

TEST_P(HardCases, AreRefusedWithTheKeyOrLoaded) {
    std::string message;
    try {
        scene();
    } catch (const ShotError& error) {
        message = error.what();
    }
    if (GetParam().loads()) {
        EXPECT_EQ(message, "");
    } else {
        EXPECT_NE(message.find(GetParam().load), std::string::npos) << message;
    }
}

// is_double: by the query that a bake has; otherwise with all waves that there are.
void expect_values(const HardCase& hard, bool is_double) {
    if (!hard.loads()) return;
    Scene shot = load_shot(hard.file, check_scene);
    // What foam remembers is most of the work: where that isn't what is hard, it forgets soon.
    if (hard.file.filename().string().find("foam") == std::string::npos)
        shot.effects.foam_decay_s = std::min(shot.effects.foam_decay_s, 0.2);
    Plan plan = plan_bake(shot);
    if (!is_double) {
        Query all = plan.queries[plan.outputs.front().query].query;
        all.cell_m = all.pixel_m = {0.0};
        all.lattice.reset();
        plan = make_plan(shot, {all});
    }
    const int asked = is_double ? plan.outputs.front().query : 0;
    with_precision(is_double, [&]<class T>(T) {
        SeaAtTime<T> sea(std::make_shared<const Sea<T>>(plan));
        sea.set(plan.from->scene.shot.time_s(1));
        const Query& query = plan.queries[asked].query;
        std::vector<glm::vec<2, T>> rest;
        std::vector<T> cell;
        const double reach_m = plan.from->scene.surface.size_m;
        const double coarsest_m = query.pixel_m.back(), finest_m = query.pixel_m.front();
        for (int i = 0; i < 400; ++i) {
            rest.emplace_back(reach_m * (i % 20 - 9.7) / 20.0, reach_m * (i / 20 - 9.3) / 20.0);
            cell.push_back(static_cast<T>(finest_m + (coarsest_m - finest_m) * i / 400.0));
        }
        ProductArrays<T> arrays;
        arrays.resize(query.products, rest.size());
        sea.evaluate(asked,
                     {.count = rest.size(),
                      .rest_m = {rest.data()},
                      .cell_m = {cell.data()},
                      .pixel_m = {cell.data()}},
                     arrays.results());
        for (const ProductRow& row : kProductTable) {
            if (!query.products[index(row.product)]) continue;
            if (row.components == 1) {
                for (const T value : arrays.numbers(NumberProduct::checked(row.product))) {
                    ASSERT_TRUE(std::isfinite(value)) << row.name;
                    if (row.product == Product::Coverage) {
                        ASSERT_TRUE(value >= T(0) && value <= T(1)) << value;
                    }
                }
                continue;
            }
            for (const auto& v : arrays.vectors(VectorProduct::checked(row.product))) {
                ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) << row.name;
                if (row.product == Product::SlopeVariance) {
                    ASSERT_TRUE(v.x >= T(0) && v.y >= T(0) &&
                                v.x * v.y - v.z * v.z >= -T(1e-6) * (v.x * v.y + T(1e-30)))
                        << v.x << ' ' << v.y << ' ' << v.z;
                }
                if (row.product == Product::Normal) {
                    ASSERT_NEAR(std::hypot(static_cast<double>(v.x), static_cast<double>(v.y),
                                           static_cast<double>(v.z)),
                                1.0, 1e-5);
                    if (hard.limit == "flat") {
                        ASSERT_EQ(v, (glm::vec<3, T>(T(0), T(0), T(1))));
                    }
                }
                if (row.product == Product::Position) {
                    if (hard.limit == "flat") {
                        ASSERT_EQ(v.z, T(0));
                    }
                    if (hard.limit == "calm") {
                        ASSERT_LT(std::abs(v.z), T(0.1));
                    }
                }
            }
        }
        const SpectralMoments shown = sea.sea().resolved_moments(asked), total = sea.sea().total();
        EXPECT_LE(shown.m0, total.m0 * (1.0 + 1e-6));
        // A mode has the energy of its cell at the wavenumber in the cell's middle: of slopes, which grow with it, that is not
        // quite the cell's mean.
        EXPECT_LE(shown.mss(), total.mss() * (1.0 + 2e-3));
    });
}

TEST_P(HardCases, HaveFiniteValuesAtTheirLimit) {
    expect_values(GetParam(), false);
}
TEST_P(HardCases, HaveFiniteValuesInDouble) {
    expect_values(GetParam(), true);
}

// Writers refuse what isn't finite by throwing.
TEST_P(HardCases, AreBakedWhole) {
    expect_baked(MeshFormat::Usdc);
}
TEST_P(HardCases, AreBakedWholeAsText) {
    expect_baked(MeshFormat::Usda);
}

TEST_P(HardCases, ArePicturesOfFiniteLight) {
    expect_pictures(SkyQuality::Nine);
}
TEST_P(HardCases, ArePicturesOfFiniteLightByEachSky) {
    expect_pictures(SkyQuality::One);
    expect_pictures(SkyQuality::Integral);
}

// Every status is one of the interface's, and answers are finite: rays from the camera in all directions, and points.
TEST_P(HardCases, AnswerPointsAndRays) {
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    const std::string path = GetParam().file.string();
    source.path = path.c_str();
    pelagic_error error;
    pelagic_sea* sea = nullptr;
    const pelagic_status opened = pelagic_open(&source, nullptr, &sea, &error);
    if (!GetParam().loads()) {
        EXPECT_EQ(opened, PELAGIC_SHOT_REFUSED);
        EXPECT_NE(std::string(error.message).find(GetParam().load), std::string::npos) << error.message;
        return;
    }
    ASSERT_EQ(opened, PELAGIC_OK) << error.message;
    pelagic_frame* frame = nullptr;
    double time_s = 0.0;
    ASSERT_EQ(pelagic_time_of_frame(sea, 1.0, &time_s, &error), PELAGIC_OK) << error.message;
    ASSERT_EQ(pelagic_frame_create(sea, time_s, time_s, &frame, &error), PELAGIC_OK) << error.message;
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    ASSERT_EQ(pelagic_shot_camera(sea, 1.0, &camera, &error), PELAGIC_OK) << error.message;
    std::vector<glm::vec3> direction;
    for (int i = -4; i <= 4; ++i)
        for (int j = 0; j < 8; ++j)
            direction.emplace_back(
                std::cos(0.785f * static_cast<float>(j)) * std::cos(0.39f * static_cast<float>(i)),
                std::sin(0.785f * static_cast<float>(j)) * std::cos(0.39f * static_cast<float>(i)),
                std::sin(0.39f * static_cast<float>(i)));
    const std::size_t count = direction.size();
    std::vector<float> distance(count), spread(count, 0.05f), coverage(count);
    std::vector<glm::vec2> rest(count);
    std::vector<glm::vec3> position(count), normal(count), velocity(count), variance(count);
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = &position[0].x;
    values.normal = &normal[0].x;
    values.velocity_mps = &velocity[0].x;
    values.slope_variance = &variance[0].x;
    values.coverage = coverage.data();
    for (const int on_earth : {0, 1}) {
        pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
        std::copy_n(camera.position_m, 3, rays.origin_m);
        if (on_earth) rays.origin_m[0] = rays.origin_m[1] = 0.0;
        rays.count = count;
        rays.direction = &direction[0].x;
        rays.spread = spread.data();
        rays.on_earth = on_earth;
        pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
        hits.distance = distance.data();
        hits.rest_m = &rest[0].x;
        hits.values = &values;
        ASSERT_EQ(pelagic_intersect(frame, &rays, &hits, &error), PELAGIC_OK) << error.message;
        for (std::size_t i = 0; i < count; ++i)
            EXPECT_TRUE(distance[i] >= 0.0f && std::isfinite(rest[i].x) && std::isfinite(rest[i].y))
                << distance[i];
        expect_finite(position, "position");
        expect_finite(normal, "normal");
        expect_finite(velocity, "velocity");
        expect_finite(variance, "variance");
        for (const float w : coverage) EXPECT_TRUE(w >= 0.0f && w <= 1.0f);
        // A sea without waves is met where it is at rest.
        if (GetParam().limit != "flat" || on_earth || camera.position_m[2] < 1.0) continue;
        for (std::size_t i = 0; i < count; ++i)
            if (direction[i].z < -0.3f) {
                EXPECT_NEAR(static_cast<double>(distance[i]),
                            camera.position_m[2] / -static_cast<double>(direction[i].z),
                            1e-2 * camera.position_m[2]);
            }
    }
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.count = count;
    points.rest_m = &rest[0].x;
    ASSERT_EQ(pelagic_evaluate(frame, &points, &values, &error), PELAGIC_OK) << error.message;
    expect_finite(position, "position");
    expect_finite(normal, "normal");
    pelagic_frame_release(frame);
    pelagic_close(sea);
}

INSTANTIATE_TEST_SUITE_P(Shot, HardCases, testing::ValuesIn(test::hard_cases()),
                         [](const auto& of) { return test::name_of(of.param); });

}  // namespace
}  // namespace pelagic
