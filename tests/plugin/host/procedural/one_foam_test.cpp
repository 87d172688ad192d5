// One place's foam, asked of everybody who says it: coverage means all foam, wherever it stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "core/effects/sea_at_time.h"
#include "plugin/bake/sequence.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/plugin/host/procedural/first_version.h"
#include "tests/plugin/host/procedural/opened.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

using namespace test;

constexpr int kFrame = 73;  // 3 s
constexpr double kCell_m = 1.0;

// Waves below four metres don't break: footprints of up to two metres have the same foam.
std::string shot_text(double decay_s) {
    return "[shot]\nedition = 1\nframes = [1, 96]\n[quality]\nlevel = \"preview\"\n[sea]\nwind_speed_mps = 16.0\n"
           "[effects]\nbreaking_from_m = 4.0\nfoam_decay_s = " +
           std::to_string(decay_s) +
           "\n[surface]\nsize_m = 64.0\nresolution = 64\n"
           "[output]\nattributes = [\"whitecaps\"]\nmaps = [\"whitecaps\"]\nmap_resolution = 64\n"
           "[camera]\nresolution = [33, 33]\nfov_deg = 2.0\n";
}

struct Foam {
    double coverage = 0.0, breaking = 0.0;
};

// At a place at rest, by the function that C++ asks.
class Asked {
  public:
    explicit Asked(const Scene& scene)
        : sea_(std::make_shared<const Sea<float>>(make_plan(scene, {query()}))) {
        sea_.set(scene.shot.time_s(kFrame));
    }
    Foam at(glm::vec2 rest_m, glm::vec3* position_m = nullptr) const {
        glm::vec3 position;
        float coverage = 0.0f, breaking = 0.0f;
        Results<float> results;
        results.set(Product::Position, {&position});
        results.set(Product::Coverage, {&coverage});
        results.set(Product::Breaking, {&breaking});
        sea_.evaluate(0, {.count = 1, .rest_m = {&rest_m}}, results);
        if (position_m) *position_m = position;
        return {coverage, breaking};
    }

  private:
    static Query query() {
        Query query;
        query.products = foam_products() | products(Product::Position);
        query.cell_m = query.pixel_m = {kCell_m};
        return query;
    }
    SeaAtTime<float> sea_;
};

// A node of the patch and of the map, where old foam and new lie on each other.
struct Node {
    std::size_t index = 0;
    glm::vec2 rest_m{0.0f};
};
Node foamy_node(const Values& mesh) {
    const auto &all = mesh.numbers(Product::Coverage), &now = mesh.numbers(Product::Breaking);
    Node best;
    double most = -1.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double both = std::min(static_cast<double>(all[i] - now[i]), static_cast<double>(now[i]));
        if (both > most && all[i] < 0.9f) {
            most = both;
            best = {i, {static_cast<float>(i % 65) - 32.0f, static_cast<float>(i / 65) - 32.0f}};
        }
    }
    return best;
}

double in_python(const Scene& scene, const std::string& text, glm::vec2 rest_m) {
    char place[64];
    std::snprintf(place, sizeof place, "[[%.9g, %.9g]]", static_cast<double>(rest_m.x),
                  static_cast<double>(rest_m.y));
    const std::string program =
        "import pelagic\n"
        "scene = pelagic.Scene.from_text('''" +
        text +
        "''')\n"
        "frame = pelagic.Frame(pelagic.Sea(scene, ('coverage',), cell_m=1.0, pixel_m=1.0))\n"
        "frame.set(" +
        std::to_string(scene.shot.time_s(kFrame)) +
        ")\n"
        "import numpy\n"
        "print(float(frame.evaluate(numpy.array(" +
        place + ", 'f'))['coverage'][0]))\n";
    std::string command = PELAGIC_PYTHON_COMMAND " -c \"";
    for (const char c : program) command += c == '"' ? "\\\"" : std::string(1, c);
    command += '"';
    FILE* pipe = popen(command.c_str(), "r");
    char answer[64] = "";
    const bool is_read = pipe && std::fgets(answer, sizeof answer, pipe);
    EXPECT_TRUE(is_read && pclose(pipe) == 0);
    return std::strtod(answer, nullptr);
}

TEST(OneFoam, IsOneNumberWhoeverIsAsked) {
    const std::string text = shot_text(3.0);
    const Scene scene = parse_shot(text, "shot.toml", check_scene);
    FrameSlot slot;
    make_sequence(plan_bake(scene))->compute(kFrame, slot);
    const Values &mesh = slot.outputs.at(0)->values, &map = slot.outputs.at(1)->values;
    const Node node = foamy_node(mesh);
    const Asked asked(scene);
    glm::vec3 position_m;
    const Foam foam = asked.at(node.rest_m, &position_m);
    // The three meanings that it could have are far from each other.
    EXPECT_GT(foam.breaking, 0.1);
    EXPECT_GT(foam.coverage - foam.breaking, 0.1);
    constexpr double kSplines = 5e-3;  // of hosts with other levels of cells
    EXPECT_NEAR(mesh.numbers(Product::Coverage)[node.index], foam.coverage, kSplines);
    EXPECT_NEAR(mesh.numbers(Product::Breaking)[node.index], foam.breaking, kSplines);
    const std::size_t texel = node.index / 65 * 64 + node.index % 65;
    EXPECT_NEAR(map.numbers(Product::Coverage)[texel], foam.coverage, kSplines);
    EXPECT_NEAR(in_python(scene, text, node.rest_m), foam.coverage, 1e-6);

    // The pixel in the middle looks at the place.
    Scene seen = scene;
    seen.camera.look_at_m = glm::dvec3(position_m);
    seen.camera.position_m = seen.camera.look_at_m + glm::dvec3(3.0, 4.0, 60.0);
    RenderOptions options = render_options(seen);
    options.samples = 1;
    for (const PictureLayer layer : {PictureLayer::Coverage, PictureLayer::Breaking})
        options.layers.set(index(layer));
    Renderer renderer(seen, options, uniform_sky(), std::array{kFrame});
    Picture picture;
    renderer.render(kFrame, picture);
    const std::size_t middle = 16 * 33 + 16;
    EXPECT_NEAR(picture.data[index(PictureLayer::Coverage)][middle], foam.coverage, 2.0 * kSplines);
    EXPECT_NEAR(picture.data[index(PictureLayer::Breaking)][middle], foam.breaking, 2.0 * kSplines);

    // The C interface: the point, and a ray that meets it.
    const FrameHandle frame = frame_of(open_text(text), scene.shot.time_s(kFrame), scene.shot.time_s(kFrame));
    const auto cell_m = static_cast<float>(kCell_m);
    float coverage = 0.0f, breaking = 0.0f, met_coverage = 0.0f;
    glm::vec2 met_rest_m;
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.count = 1;
    points.rest_m = &node.rest_m.x;
    points.cell_m = points.pixel_m = &cell_m;
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.coverage = &coverage;
    values.breaking = &breaking;
    pelagic_error error;
    ASSERT_EQ(pelagic_prepare(frame.get(), &points, &error), PELAGIC_OK) << error.message;
    ASSERT_EQ(pelagic_evaluate(frame.get(), &points, &values, &error), PELAGIC_OK) << error.message;
    EXPECT_NEAR(coverage, foam.coverage, kSplines);
    EXPECT_NEAR(breaking, foam.breaking, kSplines);
    const float down[3] = {0.0f, 0.0f, -1.0f}, width_m = 0.25f;
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    for (int axis = 0; axis < 3; ++axis)
        rays.origin_m[axis] = static_cast<double>(position_m[axis]) + (axis == 2 ? 20.0 : 0.0);
    rays.count = 1;
    rays.direction = down;
    rays.footprint_m = &width_m;
    values.coverage = &met_coverage;
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    hits.rest_m = &met_rest_m.x;
    hits.values = &values;
    ASSERT_EQ(pelagic_intersect(frame.get(), &rays, &hits, &error), PELAGIC_OK) << error.message;
    const glm::vec2 met_at_m = met_rest_m + glm::vec2(position_m);
    EXPECT_NEAR(met_coverage, asked.at(met_at_m).coverage, kSplines);
    EXPECT_NEAR(met_coverage, foam.coverage, 0.1);
}

// A host of version 0.1.0 gets what it got: what breaks now, as if no foam were persistent, and of hits as well.
TEST(OneFoam, OfAHostOfTheFirstVersionIsWhatItWas) {
    std::vector<float> rest_m;
    for (int i = 0; i < 400; ++i) {
        rest_m.push_back(1.7f * static_cast<float>(i % 20));
        rest_m.push_back(1.3f * static_cast<float>(i / 20));
    }
    for (const char* gusts : {"0", "0.6"}) {
        const auto text_of = [&](double decay_s) {
            std::string text = shot_text(decay_s);
            return text.replace(text.find("[effects]"), 0, std::string("gust_strength = ") + gusts + '\n');
        };
        const FirstVersion lasting = ask_as_first_version(text_of(3.0).c_str(), 3.0, rest_m, 0.7f),
                           without = ask_as_first_version(text_of(0.0).c_str(), 3.0, rest_m, 0.7f);
        ASSERT_EQ(lasting.coverage.size(), 400u);
        EXPECT_EQ(lasting.coverage, without.coverage);
        EXPECT_EQ(lasting.of_hits, without.of_hits);
        EXPECT_EQ(lasting.frame_bytes, without.frame_bytes);
        EXPECT_GT(*std::max_element(lasting.coverage.begin(), lasting.coverage.end()), 0.3f);
        EXPECT_GT(*std::max_element(lasting.of_hits.begin(), lasting.of_hits.end()), 0.3f);
    }
}

}  // namespace
}  // namespace pelagic
