// bake_expected SHOT.toml FILE: what OpenUSD must hand back of a bake of this shot, computed by the core
// alone, as read-stage.mjs takes it with --expect.

#include <charconv>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <stdexcept>

#include "core/effects/foam_history.h"
#include "core/evaluate/evaluate.h"
#include "core/surface/patch.h"
#include "plugin/light/light.h"
#include "plugin/shot/shot.h"

namespace {

using namespace pelagic;

std::string json_array(const float* values, std::size_t count) {
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) {
        char number[32];
        const auto [end, error] =
            std::to_chars(number, number + sizeof number, static_cast<double>(values[i]));
        if (error != std::errc()) throw std::runtime_error("a number does not fit its buffer");
        text += (i > 0 ? "," : "") + std::string(number, end);
    }
    return text + "]";
}

void write_expected(const std::string& shot_file, const std::string& file) {
    const Scene scene = load_shot(shot_file, check_scene);
    const auto sea = std::make_shared<const Sea<float>>(plan_bake(scene));
    Frame<float> frame(sea);
    const int quads = scene.surface.resolution;
    const auto rest = rest_points<float>({.per_side = quads + 1,
                                          .spacing_m = scene.surface.size_m / quads,
                                          .first_m = -0.5 * scene.surface.size_m});
    std::vector<glm::vec3> position(rest.size()), normal(rest.size()), velocity(rest.size()),
        variance(rest.size());
    std::vector<float> whitecaps(rest.size());
    std::optional<FoamHistory<float>> history;
    if (sea->plan().foam) history.emplace(sea);
    std::string frames;
    for (int f = scene.shot.first_frame; f <= scene.shot.last_frame; ++f) {
        frame.set(scene.shot.time_s(f));
        Results<float> results;
        results.set(Product::Position, {position.data()});
        results.set(Product::Normal, {normal.data()});
        results.set(Product::Velocity, {velocity.data()});
        results.set(Product::SlopeVariance, {variance.data()});
        results.set(Product::Coverage, {whitecaps.data()});
        const Points<float> points{.count = rest.size(), .rest_m = {rest.data()}};
        evaluate(frame, 0, points, results);
        if (history) {
            history->set(frame.time_s());
            history->add(points, 0, {.coverage = {whitecaps.data()}});
        }
        const auto vectors = [&](const std::vector<glm::vec3>& v) {
            return json_array(&v[0].x, 3 * v.size());
        };
        frames += (frames.empty() ? "" : ",\n") + ("\"" + std::to_string(f)) +
                  "\": {\"/a_stage/Sea\": {\"points\": " + vectors(position) +
                  ", \"normals\": " + vectors(normal) + ", \"velocities\": " + vectors(velocity) +
                  ", \"slopeVariance\": " + vectors(variance) +
                  ", \"whitecapCoverage\": " + json_array(whitecaps.data(), whitecaps.size()) + "}}";
    }
    std::ofstream out(file);
    out << R"json({"stage": {"startTimeCode": 1, "endTimeCode": 3, "timeCodesPerSecond": 24},
"prims": {"/a_stage": "Xform", "/a_stage/Sea": "Mesh", "/a_stage/Camera": "Camera", "/a_stage/Sun": "DistantLight",
  "/a_stage/Sky": "DomeLight", "/a_stage/Materials/Water": "Material", "/a_stage/Volumes": "Scope",
  "/a_stage/Volumes/Spray": "Volume", "/a_stage/Volumes/Spray/density": "OpenVDBAsset",
  "/a_stage/Volumes/Spray/velocity": "OpenVDBAsset", "/a_stage/Volumes/LevelSet": "Volume",
  "/a_stage/Volumes/LevelSet/surface": "OpenVDBAsset"},
"root": ["defaultPrim = \"a_stage\"", "upAxis = \"Z\"", "metersPerUnit = 1"],
"flattened": ["1: (90, 0, 0),", "2: (90, 0, 45),", "3: (90, 0, 90),", "1: (0, -60, 4),", "2: (20, -60, 4),",
  "3: (40, -60, 4),", "rel field:density = </a_stage/Volumes/Spray/density>",
  "rel field:surface = </a_stage/Volumes/LevelSet/surface>", "token fieldClass = \"fogVolume\"",
  "token fieldClass = \"levelSet\""],
"frames": {)json"
        << frames << "}}\n";
    if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 3) throw std::runtime_error("usage: bake_expected SHOT.toml FILE");
        write_expected(argv[1], argv[2]);
    } catch (const std::exception& error) {
        std::cerr << error.what() << "\n";
        return 1;
    }
}
