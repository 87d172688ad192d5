#include "tests/core/waves/reference_sea.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/base/constants.h"
#include "core/base/random.h"
#include "core/plan/mode_lattice.h"
#include "tests/core/spectrum/cell_energy.h"

namespace pelagic::oracle {
namespace {

struct LevelPair {
    double footprint_a, footprint_b;
    SpectralMoments* sum;
};

}  // namespace

ReferenceSea reference_sea(const Plan& plan) {
    const Scene& scene = plan.from->scene;
    const DirectionalSpectrum& spectrum = plan.from->spectrum;
    ReferenceSea sea;
    for (const PlannedQuery& planned : plan.queries) {
        const std::size_t levels = planned.query.pixel_m.size();
        sea.resolved.emplace_back(levels);
        sea.resolved_next.emplace_back(levels - 1);
    }
    for (std::size_t c = 0; c < plan.cascades.size(); ++c) {
        const CascadePlan& planned = plan.cascades[c];
        const int radius = planned.amplitude_radius(), columns = planned.mode_radius;
        std::vector<std::size_t> middle(radius);
        std::size_t count = 0;
        for (int mx = 0; mx < radius; ++mx) {
            middle[mx] = count + half_height(radius, mx);
            count += column_length(radius, mx);
        }
        ReferenceCascade cascade;
        cascade.forward.resize(count);
        cascade.backward.resize(count);
        std::vector<LevelPair> pairs;
        for (std::size_t q = 0; q < plan.queries.size(); ++q) {
            const Query& query = plan.queries[q].query;
            if (query.only_cascade && *query.only_cascade != static_cast<int>(c)) continue;
            for (std::size_t i = 0; i < query.pixel_m.size(); ++i) {
                pairs.push_back({query.pixel_m[i], query.pixel_m[i], &sea.resolved[q][i]});
                if (i + 1 < query.pixel_m.size())
                    pairs.push_back({query.pixel_m[i], query.pixel_m[i + 1], &sea.resolved_next[q][i]});
            }
        }
        const double step = kTwoPi / planned.size_m;
        std::vector<double> column_m0(columns, 0.0);
        std::vector<std::vector<SpectralMoments>> column_sums(columns,
                                                              std::vector<SpectralMoments>(pairs.size()));
        tbb::parallel_for(0, columns, [&](int mx) {
            const int generated = mx < radius ? half_height(radius, mx) : -1;
            const int counted = half_height(columns, mx);
            for (int my = -counted; my <= counted; ++my) {
                if (mx == 0 && my == 0) continue;
                const glm::dvec2 k(mx * step, my * step);
                const double length = std::hypot(k.x, k.y);
                const double omega = spectrum.dispersion().omega(length);
                const double chop =
                    scene.waves.choppiness * spectrum.dispersion().horizontal_ratio(length) / length;
                const auto energy_at = [&](double sign) {
                    const double x = sign * k.x, y = sign * k.y;
                    return cell_energy(spectrum, {.kx0 = x - 0.5 * step,
                                                  .kx1 = x + 0.5 * step,
                                                  .ky0 = y - 0.5 * step,
                                                  .ky1 = y + 0.5 * step,
                                                  .k_lo = planned.k_lower,
                                                  .k_hi = planned.k_upper});
                };
                const double energy = energy_at(+1.0), mirrored = energy_at(-1.0);
                if (std::abs(my) <= generated) {
                    const auto amplitude = [&](double e, int x, int y) {
                        const auto xi =
                            normal_pair({static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(x),
                                         static_cast<std::uint32_t>(y), 0u},
                                        scene.shot.seed);
                        return 0.5 * std::sqrt(e) * std::complex<double>(xi[0], xi[1]);
                    };
                    cascade.forward[middle[mx] + my] = amplitude(energy, mx, my);
                    cascade.backward[middle[mx] + my] = std::conj(amplitude(mirrored, -mx, -my));
                }
                if (!counts_as_wave(mx, my)) continue;
                column_m0[mx] += energy + mirrored;
                for (std::size_t p = 0; p < pairs.size(); ++p) {
                    const double weight = plan.filter.weight(length, pairs[p].footprint_a) *
                                          plan.filter.weight(length, pairs[p].footprint_b);
                    if (!(weight > 0.0)) continue;
                    SpectralMoments part = moments_of({k, weight * (energy + mirrored), omega, chop});
                    part.east = weight * (energy - mirrored) * k.x / length;
                    part.north = weight * (energy - mirrored) * k.y / length;
                    column_sums[mx][p] += part;
                }
            }
        });
        for (int mx = 0; mx < columns; ++mx) {
            cascade.expected_m0 += column_m0[mx];
            for (std::size_t p = 0; p < pairs.size(); ++p) *pairs[p].sum += column_sums[mx][p];
        }
        sea.cascades.push_back(std::move(cascade));
    }
    return sea;
}

}  // namespace pelagic::oracle
