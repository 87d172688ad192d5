// output.mesh_scheme = "catmullClark": the cage's limit surface against the sea, beside a plain mesh of as many bytes in a
// frame's crate, and at 1/4, 1/16 and 1/64 of the mesh's vertices. The sea's shortest wave is four of the mesh's cells long.
//
// Errors are at random points of the water, a tenth of them on the patch's edges: of the surface the distance from the sea
// along its normal, of normals the angle to it. A mesh is drawn as renderers do: two triangles a quad, and normals
// interpolated in them.
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/evaluate/values.h"
#include "core/plan/plan.h"
#include "core/surface/fitted_cage.h"
#include "core/waves/frame.h"
#include "plugin/format/usd/crate.h"
#include "tests/bench/timing.h"

namespace {

using namespace pelagic;

constexpr double kSize_m = 200.0, kTime_s = 3.0;
constexpr int kModes = 128;         // of the only cascade: its shortest wave is 2 · 200 m/128 long
constexpr int kQuads = 2 * kModes;  // four cells to that wave
constexpr std::size_t kPoints = 200000;

Scene scene_of(int quads, MeshScheme scheme, double choppiness) {
    Scene scene;
    scene.waves.choppiness = choppiness;
    scene.waves.cascades = {{.size_m = kSize_m, .resolution = kModes}};
    scene.waves.tiling = Tiling::Periodic;
    scene.surface.size_m = kSize_m;
    scene.surface.resolution = quads;
    scene.output.mesh_scheme = scheme;
    return scene;
}

struct Place {
    glm::dvec2 rest_m;
    glm::dvec3 position_m, normal;  // of the sea
};

// The sea itself, without any footprint.
std::vector<Place> places(double choppiness) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> across(-0.5 * kSize_m, 0.5 * kSize_m);
    std::vector<glm::dvec2> rest(kPoints);
    for (std::size_t i = 0; i < rest.size(); ++i) {
        rest[i] = {across(random), across(random)};
        if (i % 10 == 0) rest[i][static_cast<int>(i / 10 % 2)] = i % 40 < 20 ? -0.5 * kSize_m : 0.5 * kSize_m;
    }
    Query query;
    query.name = "exact";
    query.products = products(Product::Position, Product::Normal);
    query.points = kPoints;
    Scene scene = scene_of(kQuads, MeshScheme::None, choppiness);
    scene.quality.level = QualityLevel::Reference;
    const Plan plan = make_plan(scene, {query}, {.double_precision = true});
    Frame<double> sea(std::make_shared<const Sea<double>>(plan));
    sea.set(kTime_s);
    std::vector<glm::dvec3> position(kPoints), normal(kPoints);
    Results<double> results;
    results.set(Product::Position, {position.data()});
    results.set(Product::Normal, {normal.data()});
    evaluate(sea, 0, {.count = kPoints, .rest_m = {rest.data()}}, results);
    std::vector<Place> made;
    for (std::size_t i = 0; i < kPoints; ++i) made.push_back({rest[i], position[i], normal[i]});
    return made;
}

// A surface over the water: where it has a point, and its normal there.
struct OnSurface {
    glm::dvec3 position_m, normal;
};

// The crate of a frame as a bake writes it, in bytes.
std::size_t bytes_of(const usd::MeshSample& sample) {
    std::size_t bytes = 0;
    usd::write_frame_crate(sample, [&](std::string_view piece) { bytes += piece.size(); });
    return bytes;
}

struct Errors {
    double surface_mm = 0.0, normal_deg = 0.0, edge_mm = 0.0, edge_deg = 0.0;
    std::size_t vertices = 0, bytes = 0,
                bytes_shape = 0;  // with all attributes; of points, and a mesh's normals
    double fit_ms = 0.0;
};

template <class At>
void add_errors(const std::vector<Place>& sea, const At& at, Errors& errors) {
    double surface = 0.0, angle = 0.0, edge = 0.0, edge_angle = 0.0;
    for (std::size_t i = 0; i < sea.size(); ++i) {
        const OnSurface here = at(sea[i].rest_m);
        const double off = glm::dot(here.position_m - sea[i].position_m, sea[i].normal);
        const double turned = std::atan2(glm::length(glm::cross(here.normal, sea[i].normal)),
                                         glm::dot(here.normal, sea[i].normal));
        surface += off * off;
        angle += turned * turned;
        if (i % 10 == 0) {
            edge += off * off;
            edge_angle += turned * turned;
        }
    }
    const auto rms = [](double sum, std::size_t count) {
        return std::sqrt(sum / static_cast<double>(count));
    };
    constexpr double kDegrees = 57.29577951308232;
    errors.surface_mm = 1e3 * rms(surface, sea.size());
    errors.normal_deg = kDegrees * rms(angle, sea.size());
    errors.edge_mm = 1e3 * rms(edge, sea.size() / 10);
    errors.edge_deg = kDegrees * rms(edge_angle, sea.size() / 10);
}

// The cell that a place lies in, and where in it, 0 … 1.
struct InCell {
    int x, y;
    double u, v;
};
InCell in_cell(glm::dvec2 rest_m, int quads) {
    const glm::dvec2 at = (rest_m / kSize_m + 0.5) * static_cast<double>(quads);
    const int x = std::min(static_cast<int>(at.x), quads - 1),
              y = std::min(static_cast<int>(at.y), quads - 1);
    return {x, y, at.x - x, at.y - y};
}

Errors errors_of(int quads, MeshScheme scheme, double choppiness, const std::vector<Place>& sea) {
    const Plan plan = plan_bake(scene_of(quads, scheme, choppiness));
    Frame<float> frame(std::make_shared<const Sea<float>>(plan));
    frame.set(kTime_s);
    RestPoints<float> rest;
    plan.surface->points_at(1, rest);
    Values values;
    QueryRunner<float> runner;
    const int query = plan.outputs.front().query;
    const ProductSet held = plan.queries[query].query.products | products(Product::Breaking);
    runner.run(frame, query, {.count = rest.rest_m.size(), .rest_m = {rest.rest_m.data()}},
               held & ~lasting_products(), values);
    const auto& position = values.vectors(Product::Position);
    usd::MeshSample sample{.points = position,
                           .normals = values.vectors(Product::Normal),
                           .velocities = values.vectors(Product::Velocity),
                           .slope_variance = values.vectors(Product::SlopeVariance),
                           .whitecap_coverage = values.numbers(Product::Breaking)};
    Errors errors;
    if (const auto cage = plan.surface->fitted()) {
        std::vector<glm::vec3> vertices, velocities, variance;
        std::vector<float> coverage;
        std::vector<bench::Timed> fit{{"fit", [&] { cage->fit(position, vertices); }}};
        bench::interleave(fit, 5);
        errors.fit_ms = fit[0].median();
        velocities = vertices;  // as many bytes
        cage->crop<glm::vec3>(values.vectors(Product::SlopeVariance), FittedCage::kReach, variance);
        cage->crop<float>(values.numbers(Product::Breaking), FittedCage::kReach, coverage);
        sample.points = vertices;
        sample.velocities = velocities;
        sample.slope_variance = variance;
        sample.whitecap_coverage = coverage;
        errors.vertices = vertices.size();
        errors.bytes = bytes_of(sample);
        errors.bytes_shape = bytes_of({.points = vertices});
        const double cell_m = kSize_m / quads;
        add_errors(
            sea,
            [&](glm::dvec2 rest_m) {
                const InCell at = in_cell(rest_m, quads);
                const auto weights = [](double t) {
                    const double s = 1.0 - t;
                    return std::array{s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                                      (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
                };
                const auto slopes = [&](double t) {
                    const double s = 1.0 - t;
                    return std::array{-0.5 * s * s / cell_m, (1.5 * t * t - 2.0 * t) / cell_m,
                                      (-1.5 * s * s + 2.0 * s) / cell_m, 0.5 * t * t / cell_m};
                };
                const auto wu = weights(at.u), wv = weights(at.v), su = slopes(at.u), sv = slopes(at.v);
                glm::dvec3 point(0.0), along_u(0.0), along_v(0.0);
                for (int j = 0; j < 4; ++j)
                    for (int i = 0; i < 4; ++i) {
                        const glm::dvec3 vertex(vertices[static_cast<std::size_t>(
                            (at.y + j) * cage->vertices_per_side() + at.x + i)]);
                        point += wu[i] * wv[j] * vertex;
                        along_u += su[i] * wv[j] * vertex;
                        along_v += wu[i] * sv[j] * vertex;
                    }
                return OnSurface{point, glm::normalize(glm::cross(along_u, along_v))};
            },
            errors);
        return errors;
    }
    errors.vertices = position.size();
    errors.bytes = bytes_of(sample);
    errors.bytes_shape = bytes_of({.points = position, .normals = values.vectors(Product::Normal)});
    const auto& normal = values.vectors(Product::Normal);
    add_errors(
        sea,
        [&](glm::dvec2 rest_m) {
            const InCell at = in_cell(rest_m, quads);
            const std::size_t a = static_cast<std::size_t>(at.y) * static_cast<std::size_t>(quads + 1) +
                                  static_cast<std::size_t>(at.x),
                              b = a + 1, c = b + static_cast<std::size_t>(quads) + 1, d = c - 1;
            const auto mixed = [&](const std::vector<glm::vec3>& of) {
                return at.u >= at.v ? (1.0 - at.u) * glm::dvec3(of[a]) + (at.u - at.v) * glm::dvec3(of[b]) +
                                          at.v * glm::dvec3(of[c])
                                    : (1.0 - at.v) * glm::dvec3(of[a]) + at.u * glm::dvec3(of[c]) +
                                          (at.v - at.u) * glm::dvec3(of[d]);
            };
            return OnSurface{mixed(position), glm::normalize(mixed(normal))};
        },
        errors);
    return errors;
}

void print(const char* name, const Errors& at, const Errors& mesh) {
    std::printf("  %-34s %9zu %9zu %9zu %9.3f %8.4f %9.3f %8.4f %9.3f %8.3f", name, at.vertices, at.bytes,
                at.bytes_shape, at.surface_mm, at.normal_deg, at.edge_mm, at.edge_deg,
                at.surface_mm / mesh.surface_mm, at.normal_deg / mesh.normal_deg);
    std::printf(at.fit_ms > 0.0 ? " %8.2f\n" : "\n", at.fit_ms);
}

void run(double choppiness) {
    const std::vector<Place> sea = places(choppiness);
    std::printf(
        "\nchoppiness %.1f, shortest wave %.3g m, patch of %.0f m\n  %-34s %9s %9s %9s %9s %8s %9s %8s %9s %8s %8s\n",
        choppiness, 2.0 * kSize_m / kModes, kSize_m, "", "vertices", "bytes", "shape's", "RMS mm", "deg",
        "edge mm", "deg", "of mesh's", "normals'", "fit ms");
    const Errors mesh = errors_of(kQuads, MeshScheme::None, choppiness, sea);
    print("mesh", mesh, mesh);
    // The largest cages of no more bytes: with all attributes, and of the shape alone.
    const auto quads_within = [](double bytes, double bytes_a_vertex) {
        return static_cast<int>(std::sqrt(bytes / bytes_a_vertex)) - 3;
    };
    const Errors same = errors_of(kQuads, MeshScheme::CatmullClark, choppiness, sea);
    const double vertex = static_cast<double>(same.bytes) / static_cast<double>(same.vertices);
    const double vertex_shape = static_cast<double>(same.bytes_shape) / static_cast<double>(same.vertices);
    const Errors equal = errors_of(quads_within(static_cast<double>(mesh.bytes), vertex),
                                   MeshScheme::CatmullClark, choppiness, sea);
    print("cage, as many bytes", equal, mesh);
    print("cage, as many bytes of shape",
          errors_of(quads_within(static_cast<double>(mesh.bytes_shape), vertex_shape),
                    MeshScheme::CatmullClark, choppiness, sea),
          mesh);
    print("cage, as many quads", same, mesh);
    for (const int less : {2, 4, 8}) {
        const std::string share = " of 1/" + std::to_string(less * less) + " of the vertices";
        print(("mesh" + share).c_str(), errors_of(kQuads / less, MeshScheme::None, choppiness, sea), mesh);
        print(("cage" + share).c_str(), errors_of(kQuads / less, MeshScheme::CatmullClark, choppiness, sea),
              mesh);
    }
    std::printf(
        "  as many bytes: surface 1/%.0f of the mesh's, target 1/20: %s; normals 1/%.0f, target 1/8: %s; on the edges "
        "1/%.0f and 1/%.0f\n",
        mesh.surface_mm / equal.surface_mm, bench::verdict(equal.surface_mm <= mesh.surface_mm / 20.0),
        mesh.normal_deg / equal.normal_deg, bench::verdict(equal.normal_deg <= mesh.normal_deg / 8.0),
        mesh.edge_mm / equal.edge_mm, mesh.edge_deg / equal.edge_deg);
}

}  // namespace

int main() {
    std::printf("A fitted cage's limit surface against the sea, beside a plain mesh.\n");
    for (const double choppiness : {0.0, 1.0}) run(choppiness);
}
