// Traces paths from the eye. See path_tracer.h.
#include "tests/bench/reference/path_tracer.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "core/base/random.h"
#include "core/evaluate/evaluate.h"

namespace pelagic::bench {
namespace {

// Unpolarised reflectance of water at this cosine of incidence (Hu 2006, Eq. 2) for n = 1.34. Independent of the
// code that the reference judges.
double fresnel(double cosine) {
    constexpr double n = 1.34;
    const double c = std::min(std::max(cosine, 0.0), 1.0);
    const double g = std::sqrt(n * n - 1.0 + c * c);
    const double ratio = (g - c) / (g + c), p = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * ratio * ratio * (1.0 + p * p);
}

// A path in progress, with its throughput.
struct Path {
    SeaRay ray;
    SeaHit hit;
    double weight = 1.0;
};

double disc(const Sky& sky, glm::vec3 direction) {
    const double chord = static_cast<double>(glm::length(direction - sky.sun_direction));
    return chord < 2.0 * std::sin(0.5 * static_cast<double>(sky.sun_angular_radius))
               ? luminance(sky.sun_radiance)
               : 0.0;
}

class Tracer {
  public:
    Tracer(const WaveTile& tile, const FinestSea& sea, const View& view, const Sky& sky, const Sky& wide,
           const PathOptions& options)
        : tile_(tile), sea_(sea), view_(view), sky_(sky), wide_(wide), options_(options) {}

    // The sums over the samples of one line and pass.
    struct Sums {
        Line single, all, small_sun;
        double rays = 0.0, missed = 0.0, blocked = 0.0, turned_away = 0.0;
    };
    Sums line(int pass, int row) const {
        Sums sums;
        std::vector<Path> paths = from_eye(pass, row);
        sums.rays = static_cast<double>(paths.size());
        const auto drop_missed = [&](auto&& on_miss) {
            std::erase_if(paths, [&](Path& path) {
                if (sea_.trace(path.ray, path.hit)) return false;
                on_miss(path);
                return true;
            });
        };
        drop_missed([&](const Path&) { sums.missed += 1.0; });
        for (int bounce = 0; bounce < options_.bounces && !paths.empty(); ++bounce) {
            const bool first = bounce == 0;
            reflect(paths, first, sums);
            drop_missed([&](const Path& path) {
                if (!(path.ray.direction.z > 0.0f)) return;  // beyond the last tile
                const double light =
                    path.weight * luminance(sky_.map.radiance(sky_map_place(path.ray.direction), 0.0f));
                const double wide_sun = path.weight * disc(wide_, path.ray.direction);
                sums.all.term[kSky] += light;
                sums.all.term[kSun] += wide_sun;
                sums.small_sun.term[kSun] += path.weight * disc(sky_, path.ray.direction);
                if (!first) return;
                sums.single.term[kSky] += light;
                sums.single.term[kSun] += wide_sun;
            });
            if (first) sums.blocked = static_cast<double>(paths.size());
        }
        return sums;
    }

  private:
    std::vector<Path> from_eye(int pass, int row) const {
        const int strata = options_.strata, width = view_.resolution.x;
        std::vector<Path> paths(static_cast<std::size_t>(width) * strata * strata);
        std::size_t at = 0;
        const glm::vec3 eye(view_.position_m);
        for (int column = 0; column < width; ++column)
            for (int j = 0; j < strata; ++j)
                for (int i = 0; i < strata; ++i) {
                    const auto random =
                        philox({static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row),
                                static_cast<std::uint32_t>(pass), static_cast<std::uint32_t>(j * strata + i)},
                               options_.seed);
                    const auto place = [&](int pixel, int stratum, std::uint32_t jitter) {
                        return pixel + (stratum + (jitter + 0.5) * 0x1p-32) / strata;
                    };
                    paths[at++].ray = {.origin_m = eye,
                                       .direction = glm::vec3(view_.direction(
                                           {place(column, i, random[0]), place(row, j, random[1])}))};
                }
        return paths;
    }

    // At each path's hit: adds the light from the water, and makes the reflected ray.
    void reflect(std::vector<Path>& paths, bool first, Sums& sums) const {
        std::vector<glm::vec2> rest_m;
        std::vector<glm::vec3> normals(paths.size());
        for (const Path& path : paths) rest_m.push_back(path.hit.rest_m);
        if (options_.facet_normals)
            for (std::size_t i = 0; i < paths.size(); ++i) normals[i] = paths[i].hit.facet_normal;
        else {
            Results<float> results;
            results.set(Product::Normal, {normals.data()});
            evaluate(tile_.frame(), kWhole, Points<float>{.count = rest_m.size(), .rest_m = {rest_m.data()}},
                     results);
        }
        for (std::size_t i = 0; i < paths.size(); ++i) {
            Path& path = paths[i];
            float cosine = -glm::dot(normals[i], path.ray.direction);
            if (cosine <= 0.0f) {
                // At a crest's outline the facet may face the eye and the waves' normal not: uses the
                // facet's.
                normals[i] = path.hit.facet_normal;
                cosine = -glm::dot(normals[i], path.ray.direction);
                sums.turned_away += 1.0;
            }
            const double reflected = fresnel(static_cast<double>(cosine));
            const double up = path.weight * (1.0 - reflected) * options_.refracted;
            sums.all.term[kRefracted] += up;
            if (first) sums.single.term[kRefracted] += up;
            path.weight *= reflected;
            // Starts away from the facet by more than the rounding error at this distance from the eye, and
            // past the neighbouring facets, which approximate a smooth surface.
            const float off_m = 2e-4f + 2e-6f * path.hit.distance_m;
            path.ray.origin_m += path.hit.distance_m * path.ray.direction + off_m * path.hit.facet_normal;
            path.ray.direction = glm::normalize(path.ray.direction + 2.0f * cosine * normals[i]);
            path.ray.from_m = sea_.cell_m();
        }
    }

    const WaveTile& tile_;
    const FinestSea& sea_;
    const View& view_;
    const Sky &sky_, &wide_;
    const PathOptions& options_;
};

}  // namespace

std::vector<PathPass> trace_paths(const WaveTile& tile, const FinestSea& sea, const View& view,
                                  const Sky& sky, const Sky& wide, const PathOptions& options) {
    const Tracer tracer(tile, sea, view, sky, wide, options);
    const int rows = view.resolution.y - options.first_row;
    std::vector<PathPass> passes(static_cast<std::size_t>(options.passes));
    for (int p = 0; p < options.passes; ++p) {
        std::vector<Tracer::Sums> lines(static_cast<std::size_t>(rows));
        tbb::parallel_for(0, rows, [&](int row) {
            // Isolated: while a row waits for its points, the thread must not start another row.
            tbb::this_task_arena::isolate([&] { lines[row] = tracer.line(p, options.first_row + row); });
        });
        PathPass& pass = passes[p];
        for (const Tracer::Sums& sums : lines) {
            const auto mean = [&](Line line) {
                for (double& term : line.term) term /= sums.rays;
                return line;
            };
            pass.single.push_back(mean(sums.single));
            pass.all.push_back(mean(sums.all));
            pass.small_sun.push_back(mean(sums.small_sun));
            pass.rays += sums.rays;
            pass.missed += sums.missed;
            pass.blocked += sums.blocked;
            pass.turned_away += sums.turned_away;
        }
    }
    return passes;
}

}  // namespace pelagic::bench
