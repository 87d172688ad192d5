// bake_expected SHOT.toml FILE [LINE…]: what OpenUSD must hand back of a bake of this shot, computed by the core
// alone, as read-stage.mjs takes it with --expect. The lines must stand in the flattened stage as well.

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/effects/sea_at_time.h"
#include "core/evaluate/evaluate.h"
#include "core/surface/rest_surface.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"

namespace {

using namespace pelagic;

std::string number_text(double value) {
    char number[32];
    const auto [end, error] = std::to_chars(number, number + sizeof number, value);
    if (error != std::errc()) throw std::runtime_error("a number does not fit its buffer");
    return std::string(number, end);
}

// Of floats as of doubles: JSON's reader rounds them back.
template <class Number>
std::string json_array(const Number* values, std::size_t count) {
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i)
        text += (i > 0 ? "," : "") + number_text(static_cast<double>(values[i]));
    return text + "]";
}
template <glm::length_t L>
std::string json_array(const std::vector<glm::vec<L, float>>& values) {
    return json_array(&values[0].x, static_cast<std::size_t>(L) * values.size());
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) result += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    return result + "\"";
}

// As Hydra draws faces: triangles from each one's first corner on.
struct Triangles {
    std::vector<std::int32_t> indices;
    std::vector<glm::vec2> st;  // where each corner has its own, that of each triangle's corners
};
Triangles triangles_of(const Faces& faces) {
    Triangles triangles;
    std::size_t first = 0;
    for (const std::int32_t count : faces.counts) {
        const auto corners = static_cast<std::size_t>(count);
        for (std::size_t k = 1; k + 1 < corners; ++k)
            for (const std::size_t corner : {first, first + k, first + k + 1}) {
                triangles.indices.push_back(faces.indices[corner]);
                if (faces.is_st_of_corners) triangles.st.push_back(faces.st[corner]);
            }
        first += corners;
    }
    return triangles;
}

// The frames of the mesh, one after another.
class Mesh {
  public:
    explicit Mesh(const Scene& scene)
        : scene_(scene), sea_(std::make_shared<const Sea<float>>(plan_bake(scene))), state_(sea_) {}

    // {"points": […], …} of a frame.
    std::string at(int frame) {
        const RestSurface& surface = *sea_->plan().surface;
        RestPoints<float> at;
        surface.points_at(frame, at);
        const std::size_t count = at.rest_m.size();
        std::vector<glm::vec3> position(count), normal(count), velocity(count), variance(count);
        std::vector<float> whitecaps(count);
        state_.set(scene_.shot.time_s(frame));
        Results<float> results;
        results.set(Product::Position, {position.data()});
        const std::optional<FittedCage> cage = surface.fitted();
        if (!cage) results.set(Product::Normal, {normal.data()});
        results.set(Product::Velocity, {velocity.data()});
        results.set(Product::SlopeVariance, {variance.data()});
        results.set(Product::Coverage, {whitecaps.data()});
        Points<float> points{.origin_m = at.origin_m, .count = count, .rest_m = {at.rest_m.data()}};
        if (!at.cell_m.empty()) points.cell_m = {at.cell_m.data()};
        if (!at.pixel_m.empty()) points.pixel_m = {at.pixel_m.data()};
        if (!at.normal.empty()) points.rest_normal = {at.normal.data()};
        state_.evaluate(0, points, results);
        for (std::size_t i = 0; i < at.height_m.size(); ++i)
            position[i].z =
                static_cast<float>(static_cast<double>(position[i].z) + static_cast<double>(at.height_m[i]));
        std::string text;
        if (surface.has_origin()) {
            const double finest_m =
                static_cast<double>(*std::min_element(at.cell_m.begin(), at.cell_m.end()));
            const glm::dvec3 from_m(at.origin_m, 0.0), to_m = local_origin(from_m, finest_m);
            for (glm::vec3& p : position) p = from_m - to_m + glm::dvec3(p);
            const double transform[] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, to_m.x, to_m.y, to_m.z, 1};
            text += "\"transform\": " + json_array(transform, 16) + ", ";
        }
        if (cage) {
            // The limit surface has normals of its own, and Hydra hands over no texture coordinates that are "varying".
            position = fitted(*cage, position);
            velocity = fitted(*cage, velocity);
            variance = kept(*cage, variance);
            whitecaps = kept(*cage, whitecaps);
        } else {
            Faces faces;
            surface.faces_at(frame, faces);
            const Triangles triangles = triangles_of(faces);
            text += "\"normals\": " + json_array(normal) +
                    ", \"indices\": " + json_array(triangles.indices.data(), triangles.indices.size()) +
                    ", \"st\": " + json_array(faces.is_st_of_corners ? triangles.st : faces.st) + ", ";
        }
        return "{" + text + "\"points\": " + json_array(position) +
               ", \"velocities\": " + json_array(velocity) + ", \"slopeVariance\": " + json_array(variance) +
               ", \"whitecapCoverage\": " + json_array(whitecaps.data(), whitecaps.size()) + "}";
    }

  private:
    static std::vector<glm::vec3> fitted(const FittedCage& cage, const std::vector<glm::vec3>& values) {
        std::vector<glm::vec3> vertices;
        cage.fit(values, vertices);
        return vertices;
    }
    template <class Value>
    static std::vector<Value> kept(const FittedCage& cage, const std::vector<Value>& values) {
        std::vector<Value> vertices;
        cage.crop<Value>(values, FittedCage::kReach, vertices);
        return vertices;
    }

    const Scene& scene_;
    std::shared_ptr<const Sea<float>> sea_;
    SeaAtTime<float> state_;
};

// What the stage says of the scene's volumes.
struct Volumes {
    std::string prims, files;
    std::vector<std::string> lines;
};
Volumes volumes_of(const Scene& scene, const std::string& root) {
    Volumes volumes;
    if (scene.output.volumes.empty()) return volumes;
    volumes.prims = ", \"" + root + "/Volumes\": \"Scope\"";
    const auto add = [&](const std::string& prim, const std::string& word,
                         std::initializer_list<std::pair<const char*, const char*>> fields) {
        const std::string path = root + "/Volumes/" + prim;
        volumes.prims += ", \"" + path + "\": \"Volume\"";
        for (const auto& [field, field_class] : fields) {
            const std::string field_path = path + "/" + field;
            volumes.prims += ", \"" + field_path + "\": \"OpenVDBAsset\"";
            volumes.lines.push_back(std::string("rel field:") + field + " = <" + field_path + ">");
            volumes.lines.push_back(std::string("token fieldClass = \"") + field_class + "\"");
            volumes.lines.push_back(std::string("token fieldName = \"") + field + "\"");
            volumes.files += (volumes.files.empty() ? "\"" : ", \"") + field_path + ".filePath\": {";
            for (int frame = scene.shot.first_frame; frame <= scene.shot.last_frame; ++frame) {
                char digits[16];
                std::snprintf(digits, sizeof digits, "%04d", frame);
                volumes.files += (frame > scene.shot.first_frame ? ", \"" : "\"") + std::to_string(frame) +
                                 "\": \"volumes/" + scene.shot.name + "." + word + "." + digits + ".vdb\"";
            }
            volumes.files += "}";
        }
    };
    for (const VolumeKind kind : scene.output.volumes) switch (kind) {
            case VolumeKind::Spray:
                add("Spray", "spray", {{"density", "fogVolume"}, {"velocity", "unknown"}});
                break;
            case VolumeKind::LevelSet:
                add("LevelSet", "level-set", {{"surface", "levelSet"}});
                break;
        }
    return volumes;
}

void write_expected(const std::string& shot_file, const std::string& file, std::vector<std::string> lines) {
    const Scene scene = load_shot(shot_file, check_scene);
    std::string name = scene.shot.name;
    std::replace(name.begin(), name.end(), '-', '_');
    const std::string root = "/" + name;
    const Volumes volumes = volumes_of(scene, root);
    lines.insert(lines.end(), volumes.lines.begin(), volumes.lines.end());
    Mesh mesh(scene);
    std::string frames;
    for (int f = scene.shot.first_frame; f <= scene.shot.last_frame; ++f)
        frames += (frames.empty() ? "\"" : ",\n\"") + std::to_string(f) + "\": {\"" + root +
                  "/Sea\": " + mesh.at(f) + "}";
    std::string flattened;
    for (const std::string& line : lines) flattened += (flattened.empty() ? "" : ",\n  ") + quoted(line);
    // Of a share of the tests the bake before it may be another share's.
    std::filesystem::create_directories(std::filesystem::path(file).parent_path());
    std::ofstream out(file);
    out << "{\"stage\": {\"startTimeCode\": " << scene.shot.first_frame
        << ", \"endTimeCode\": " << scene.shot.last_frame
        << ", \"timeCodesPerSecond\": " << number_text(scene.shot.fps) << "},\n\"prims\": {\"" << root
        << "\": \"Xform\"";
    for (const auto& [prim, type] : {std::pair("Sea", "Mesh"),
                                     {"Camera", "Camera"},
                                     {"Sun", "DistantLight"},
                                     {"Sky", "DomeLight"},
                                     {"Materials/Water", "Material"}})
        out << ", \"" << root << "/" << prim << "\": \"" << type << "\"";
    out << volumes.prims << "},\n\"files\": {" << volumes.files << "},\n\"root\": [\"defaultPrim = \\\""
        << name << "\\\"\", \"upAxis = \\\"Z\\\"\", \"metersPerUnit = 1\"],\n\"flattened\": [" << flattened
        << "],\n\"frames\": {" << frames << "}}\n";
    if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc < 3) throw std::runtime_error("usage: bake_expected SHOT.toml FILE [LINE…]");
        write_expected(argv[1], argv[2], {argv + 3, argv + argc});
    } catch (const std::exception& error) {
        std::cerr << error.what() << "\n";
        return 1;
    }
}
