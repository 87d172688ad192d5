// Sweeps of meshes, of the numbers in files, and of whitecaps.
#include <Imath/half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <utility>

#include "core/lighting/lighting.h"
#include "core/plan/effects.h"
#include "core/surface/fitted_cage.h"
#include "core/surface/patch.h"
#include "plugin/accuracy/rows.h"
#include "plugin/accuracy/sea_answers.h"
#include "plugin/format/exr/exr.h"
#include "plugin/light/light.h"

namespace pelagic::rows {
namespace {

constexpr std::array<int, 6> kQuads{16, 32, 64, 128, 256, 512};

// Vertices of a mesh over the shot's patch, with rings of points outside it.
SweepPoints mesh_points(const Scene& shot, int quads, int rings) {
    const double spacing_m = shot.surface.size_m / quads;
    SweepPoints points;
    points.per_side = quads + 1 + 2 * rings;
    points.spacing_m = spacing_m;
    points.time_s = middle_time_s(shot);
    points.rest_m = rest_points<double>({.per_side = points.per_side,
                                         .spacing_m = spacing_m,
                                         .first_m = -0.5 * shot.surface.size_m - rings * spacing_m});
    return points;
}

// Where a point lies among the quads, and how far into its own.
struct InQuad {
    int x, y;
    double u, v;
};
InQuad in_quad(glm::dvec2 rest_m, double size_m, int quads) {
    const glm::dvec2 at = (rest_m / size_m + 0.5) * static_cast<double>(quads);
    const auto cell = [&](double a) { return std::clamp(static_cast<int>(std::floor(a)), 0, quads - 1); };
    return {cell(at.x), cell(at.y), at.x - cell(at.x), at.y - cell(at.y)};
}

// As renderers draw a mesh: two triangles a quad.
glm::dvec3 on_mesh(const std::vector<glm::dvec3>& vertices, int quads, const InQuad& at) {
    const std::size_t a = static_cast<std::size_t>(at.y) * static_cast<std::size_t>(quads + 1) +
                          static_cast<std::size_t>(at.x),
                      b = a + 1, c = b + static_cast<std::size_t>(quads) + 1, d = c - 1;
    return at.u >= at.v ? (1.0 - at.u) * vertices[a] + (at.u - at.v) * vertices[b] + at.v * vertices[c]
                        : (1.0 - at.v) * vertices[a] + at.u * vertices[c] + (at.v - at.u) * vertices[d];
}

// The limit surface of a regular cage: the uniform bicubic B-spline.
glm::dvec3 on_limit(const std::vector<glm::vec3>& cage, int per_side, const InQuad& at) {
    const auto weights = [](double t) {
        const double s = 1.0 - t;
        return std::array{s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                          (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
    };
    const auto across = weights(at.u), along = weights(at.v);
    glm::dvec3 sum(0.0);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            sum += along[static_cast<std::size_t>(j)] * across[static_cast<std::size_t>(i)] *
                   glm::dvec3(cage[static_cast<std::size_t>(at.y + j) * static_cast<std::size_t>(per_side) +
                                   static_cast<std::size_t>(at.x + i)]);
    return sum;
}

// Cells of so many points a side: the cell of each point, and the cells' middles.
std::size_t cell_of(const SweepPoints& fine, int parts, std::size_t i) {
    const auto side = static_cast<std::size_t>(fine.per_side), p = static_cast<std::size_t>(parts);
    return i / side / p * (side / p) + i % side / p;
}
SweepPoints cells_of(const SweepPoints& fine, int parts) {
    const int cells = fine.per_side / parts;
    SweepPoints at{
        .rest_m = {}, .per_side = cells, .spacing_m = fine.spacing_m * parts, .time_s = fine.time_s};
    for (int c = 0; c < cells * cells; ++c)
        at.rest_m.push_back(
            fine.rest_m[static_cast<std::size_t>((c / cells * fine.per_side + c % cells) * parts)] +
            0.5 * (parts - 1) * fine.spacing_m);
    return at;
}

// The sea as it is, without any footprint.
struct ExactSea {
    SweepPoints at;
    std::vector<glm::dvec3> position;
    double height_m;
};
std::shared_ptr<const ExactSea> exact_sea(const Scene& shot) {
    auto exact = std::make_shared<ExactSea>();
    exact->at = sweep_points(shot);
    SeaAnswers sea(shot, products(Product::Position), 0.0, exact->at);
    sea.run();
    exact->position = sea.vectors(Product::Position);
    exact->height_m = std::max(sea.significant_height_m(), 1e-12);
    return exact;
}

constexpr int kVertexBytes = 12;

// Meshes, or cages' limit surfaces, of the shot's patch. Each run() is a frame of its vertices.
Trials of_patches(const Scene& shot, bool is_cage) {
    const auto exact = exact_sea(shot);
    Trials trials;
    for (const int quads : kQuads) {
        const FittedCage cage{quads};
        const SweepPoints at = mesh_points(shot, quads, is_cage ? FittedCage::kMargin : 0);
        const auto sea = std::make_shared<SeaAnswers>(
            shot, is_cage ? products(Product::Position) : products(Product::Position, Product::Normal),
            at.spacing_m, at);
        const auto vertices = std::make_shared<std::vector<glm::vec3>>();
        const int per_side = is_cage ? cage.vertices_per_side() : at.per_side;
        const bool is_kind = is_cage ? shot.output.mesh_scheme == MeshScheme::CatmullClark
                                     : shot.surface.kind == SurfaceKind::Patch;
        trials.trials.push_back(
            {.setting = std::to_string(quads) + " quads a side",
             .is_shots = is_kind && quads == shot.surface.resolution,
             .run =
                 [=] {
                     sea->run();
                     if (!is_cage) return;
                     const std::vector<glm::dvec3> wide = sea->vectors(Product::Position);
                     cage.fit(std::vector<glm::vec3>(wide.begin(), wide.end()), *vertices);
                 },
             .errors =
                 [=, size_m = shot.surface.size_m] {
                     const std::vector<glm::dvec3> mesh = sea->vectors(Product::Position);
                     std::vector<glm::dvec3> drawn;
                     for (const glm::dvec2& rest_m : exact->at.rest_m) {
                         const InQuad in = in_quad(rest_m, size_m, quads);
                         drawn.push_back(is_cage ? on_limit(*vertices, per_side, in)
                                                 : on_mesh(mesh, quads, in));
                     }
                     return std::vector<double>{rms(drawn, exact->position) / exact->height_m};
                 },
             .bytes =
                 static_cast<std::size_t>(per_side) * static_cast<std::size_t>(per_side) * kVertexBytes});
    }
    return trials;
}

}  // namespace

Trials mesh_spacing(const Scene& shot) {
    return of_patches(shot, false);
}

Trials fitted_cages(const Scene& shot) {
    return of_patches(shot, true);
}

namespace {

// Light of a patch as an eye sees it that is far away.
struct SeenPatch {
    Sky sky;
    WaterBody water;
    glm::vec3 to_eye;

    explicit SeenPatch(const Scene& shot) : sky(make_sky(shot)), water(make_water(shot)) {
        // Along the shot's line of sight, but from well above the horizon, where no wave hides another.
        const glm::dvec3 back = shot.camera.position_m - shot.camera.look_at_m;
        const double flat = std::hypot(back.x, back.y);
        constexpr double kFromVertical = 1.0;  // rad
        const glm::dvec2 along = flat > 0.0 ? glm::dvec2(back) / flat : glm::dvec2(0.0, -1.0);
        to_eye = glm::vec3(std::sin(kFromVertical) * along.x, std::sin(kFromVertical) * along.y,
                           std::cos(kFromVertical));
    }
    std::vector<double> luminance(const std::vector<glm::dvec3>& normal,
                                  const std::vector<glm::dvec3>& variance, bool with_variance) const {
        std::vector<SeaPoint> points(normal.size());
        std::vector<SeaRadiance> radiance(normal.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i].to_eye = to_eye;
            points[i].normal = glm::vec3(normal[i]);
            if (with_variance)
                points[i].slope_variance = points[i].slope_variance_at_rest = glm::vec3(variance[i]);
        }
        shade_sea({.whitecaps = false, .air = false}, sky, water, points, radiance);
        std::vector<double> seen;
        for (const SeaRadiance& r : radiance) {
            const glm::vec3 all = r.sun + r.sky + r.sea;
            seen.push_back(static_cast<double>(0.2126f * all.x + 0.7152f * all.y + 0.0722f * all.z));
        }
        return seen;
    }
};

}  // namespace

Trials mesh_variance(const Scene& shot) {
    // Each cell's light against the mean of what its parts send, weighted by what the eye sees of them.
    constexpr int kCells = 64, kParts = 8;
    const ProductSet wanted = products(Product::Normal, Product::SlopeVariance);
    const auto patch = std::make_shared<const SeenPatch>(shot);
    Scene square = shot;
    row_of(Effect::LivingFoam).turn_off(square);  // it has a price of its own
    square.surface.resolution = kCells * kParts;
    const SweepPoints fine = sweep_points(square, kCells * kParts);
    SeaAnswers parts(square, wanted, fine.spacing_m, fine);
    parts.run();
    const std::vector<glm::dvec3> normal = parts.vectors(Product::Normal);
    const std::vector<double> light = patch->luminance(normal, parts.vectors(Product::SlopeVariance), true);
    Trials trials;
    for (const int cells : {8, 16, 32, kCells}) {
        square.surface.resolution = cells;
        const int ratio = kCells * kParts / cells;
        const SweepPoints at = cells_of(fine, ratio);
        std::vector<double> mean(at.rest_m.size(), 0.0), weight(at.rest_m.size(), 0.0);
        for (std::size_t i = 0; i < fine.rest_m.size(); ++i) {
            const std::size_t c = cell_of(fine, ratio, i);
            const double seen =
                std::max(glm::dot(normal[i], glm::dvec3(patch->to_eye)), 0.0) / std::max(normal[i].z, 1e-3);
            mean[c] += seen * light[i];
            weight[c] += seen;
        }
        double all = 0.0;
        for (std::size_t c = 0; c < mean.size(); ++c) {
            mean[c] /= std::max(weight[c], 1e-12);
            all += mean[c] / static_cast<double>(mean.size());
        }
        for (const bool with_variance : {true, false}) {
            const auto sea = std::make_shared<SeaAnswers>(square, wanted, at.spacing_m, at);
            const auto seen = std::make_shared<std::vector<double>>();
            trials.trials.push_back(
                {.setting =
                     std::to_string(cells) + (with_variance ? " cells with variance" : " cells without"),
                 .is_shots = false,
                 .run =
                     [=] {
                         sea->run();
                         *seen = patch->luminance(sea->vectors(Product::Normal),
                                                  sea->vectors(Product::SlopeVariance), with_variance);
                     },
                 .errors =
                     [=] {
                         double bias = 0.0;
                         for (std::size_t c = 0; c < mean.size(); ++c)
                             bias += ((*seen)[c] - mean[c]) / static_cast<double>(mean.size());
                         const double scale = std::max(all, 1e-12);
                         return std::vector<double>{rms(*seen, mean) / scale, std::abs(bias) / scale};
                     }});
        }
    }
    return trials;
}

Trials file_numbers(const Scene& shot) {
    const SweepPoints at = sweep_points(shot);
    SeaAnswers sea(shot, products(Product::Displacement, Product::Normal), at.spacing_m, at);
    sea.run();
    const double height_m = std::max(sea.significant_height_m(), 1e-12);
    struct Map {
        std::vector<glm::vec3> displacement, normal;
        std::string bytes;
    };
    const auto map = std::make_shared<Map>();
    for (const glm::dvec3& d : sea.vectors(Product::Displacement)) map->displacement.emplace_back(d);
    for (const glm::dvec3& n : sea.vectors(Product::Normal)) map->normal.emplace_back(n);
    const auto encode = [map, n = at.per_side](exr::PixelType type) {
        exr::Image image{.width = n, .height = n, .channels = {}};
        const auto add = [&](const char* name, const float* data) {
            image.channels.push_back({.name = name,
                                      .data = data,
                                      .pixel_stride_bytes = sizeof(glm::vec3),
                                      .row_stride_bytes = 0,
                                      .type = type});
        };
        for (int c = 0; c < 3; ++c) {
            static constexpr const char* kDisplacement[]{"R", "G", "B"};
            static constexpr const char* kNormal[]{"normal.X", "normal.Y", "normal.Z"};
            add(kDisplacement[c], &map->displacement[0][c]);
            add(kNormal[c], &map->normal[0][c]);
        }
        return exr::encode_scanline({}, image);
    };
    Trials trials;
    for (const auto& [name, type] :
         {std::pair{"half", exr::PixelType::Half}, std::pair{"float", exr::PixelType::Float}}) {
        const auto bytes = std::make_shared<std::string>();
        const bool is_half = type == exr::PixelType::Half;
        trials.trials.push_back(
            {.setting = name,
             .is_shots = !is_half,
             .run = [=, type = type] { *bytes = encode(type); },
             .errors =
                 [=] {
                     const auto off = [&](const std::vector<glm::vec3>& values) {
                         double sum = 0.0;
                         for (const glm::vec3& v : values)
                             for (int c = 0; c < 3; ++c) {
                                 const float kept = is_half ? static_cast<float>(Imath::half(v[c])) : v[c];
                                 const double e = static_cast<double>(kept - v[c]);
                                 sum += e * e;
                             }
                         return std::sqrt(sum / static_cast<double>(values.size()));
                     };
                     return std::vector<double>{off(map->displacement) / height_m, off(map->normal)};
                 },
             .bytes = encode(type).size()});
    }
    return trials;
}

Trials whitecap_moments(const Scene& shot) {
    if (!is_on(Effect::Whitecaps, shot)) return {{}, "has nothing to sweep: the shot has no whitecaps"};
    constexpr int kCells = 32, kParts = 16;
    Scene square = shot;
    square.surface.resolution = kCells * kParts;
    const SweepPoints fine = sweep_points(square, kCells * kParts);
    SeaAnswers parts(square, products(Product::Breaking), fine.spacing_m, fine);
    parts.run();
    const std::vector<double> whitecaps = parts.numbers(Product::Breaking);
    const SweepPoints at = cells_of(fine, kParts);
    const auto mean = std::make_shared<std::vector<double>>(at.rest_m.size(), 0.0);
    double all = 0.0;
    for (std::size_t i = 0; i < whitecaps.size(); ++i) {
        (*mean)[cell_of(fine, kParts, i)] += whitecaps[i] / (kParts * kParts);
        all += whitecaps[i] / static_cast<double>(whitecaps.size());
    }
    const Knobs own = make_plan(shot, {}).knobs;
    Trials trials;
    for (const bool third : {true, false}) {
        Knobs knobs = own;
        knobs.third_moment = third;
        const auto sea = std::make_shared<SeaAnswers>(square, products(Product::Breaking), at.spacing_m, at,
                                                      PlanOptions{.knobs = knobs});
        trials.trials.push_back(
            {.setting = third ? "three moments" : "two moments",
             .is_shots = third == own.third_moment,
             .run = [sea] { sea->run(); },
             .errors =
                 [=] {
                     const std::vector<double> coverage = sea->numbers(Product::Breaking);
                     double bias = 0.0;
                     for (std::size_t c = 0; c < coverage.size(); ++c)
                         bias += (coverage[c] - (*mean)[c]) / static_cast<double>(coverage.size());
                     return std::vector<double>{rms(coverage, *mean), std::abs(bias) / std::max(all, 1e-12)};
                 },
             .bytes = sea->bytes()});
    }
    return trials;
}

}  // namespace pelagic::rows
