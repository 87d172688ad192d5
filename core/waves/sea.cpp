#include "core/waves/sea.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/base/constants.h"
#include "core/base/random.h"
#include "core/plan/mode_lattice.h"
#include "core/spectrum/cell_energy.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

// The weights that a pair of levels gives a mode, and where their sum is kept.
struct LevelPair {
    double footprint_a, footprint_b;
    SpectralMoments* sum;
};

void scale_strain(SpectralMoments& moments, double factor) {
    for (double* m : {&moments.xxxx, &moments.xxxy, &moments.xxyy, &moments.xyyy, &moments.yyyy})
        *m *= factor;
}

// What one mode (and its mirror image −k) holds, `energy` being both together.
void add_mode(SpectralMoments& sum, glm::dvec2 k, double energy, double omega, double chop) {
    const double along = chop * chop * energy;  // (choppiness coth(kd) / k)² E
    sum.m0 += energy;
    sum.m_minus1 += energy / omega;
    sum.xx += k.x * k.x * energy;
    sum.xy += k.x * k.y * energy;
    sum.yy += k.y * k.y * energy;
    sum.xxxx += along * k.x * k.x * k.x * k.x;
    sum.xxxy += along * k.x * k.x * k.x * k.y;
    sum.xxyy += along * k.x * k.x * k.y * k.y;
    sum.xyyy += along * k.x * k.y * k.y * k.y;
    sum.yyyy += along * k.y * k.y * k.y * k.y;
}

void accumulate(SpectralMoments& sum, const SpectralMoments& part) {
    sum.m0 += part.m0;
    sum.m_minus1 += part.m_minus1;
    sum.xx += part.xx;
    sum.xy += part.xy;
    sum.yy += part.yy;
    sum.xxxx += part.xxxx;
    sum.xxxy += part.xxxy;
    sum.xxyy += part.xxyy;
    sum.xyyy += part.xyyy;
    sum.yyyy += part.yyyy;
}

// ω in cycles per second. In a loop of T seconds every wave makes a whole number of cycles (Tessendorf 2001,
// §4), and at least one, so that slow waves don't freeze.
double cycles_per_s(double omega, double loop_s) {
    const double cycles = omega / kTwoPi;
    return loop_s > 0.0 ? std::max(1.0, std::round(cycles * loop_s)) / loop_s : cycles;
}

}  // namespace

template <class T>
Sea<T>::Sea(const Scene& scene, const Plan& plan) : plan_(plan), loop_s_(scene.shot.exact_loop_s()) {
    const DirectionalSpectrum spectrum(scene.sea);
    const double choppiness = scene.waves.choppiness;
    total_ = moments(spectrum, 0.0, std::numeric_limits<double>::infinity());
    scale_strain(total_, choppiness * choppiness);
    whitecap_threshold_ = calibrated_threshold(total_, scene.sea.wind_speed_mps, plan_.knobs.third_moment);

    for (const PlannedQuery& planned : plan_.queries) {
        const std::size_t levels = planned.pixel_levels.size();
        SpectralMoments whole = total_;
        if (planned.query.only_cascade) {
            const CascadePlan& band = plan_.cascades[*planned.query.only_cascade];
            whole = moments(spectrum, band.k_lower, band.k_upper);
            scale_strain(whole, choppiness * choppiness);
        }
        statistics_.push_back(
            {whole, std::vector<SpectralMoments>(levels), std::vector<SpectralMoments>(levels - 1)});
    }

    for (std::size_t c = 0; c < plan_.cascades.size(); ++c) {
        const CascadePlan& planned = plan_.cascades[c];
        Cascade<T> cascade;
        cascade.size_m = planned.size_m;
        cascade.radius = planned.grids.empty() ? 0 : planned.mode_radius;
        const std::size_t count = half_plane_modes(cascade.radius);
        cascade.forward.resize(count);
        cascade.backward.resize(count);
        cascade.cycles_per_s.resize(count);
        if (choppiness > 0.0) cascade.chop.resize(count);

        std::vector<LevelPair> pairs;
        for (std::size_t q = 0; q < plan_.queries.size(); ++q) {
            const Query& query = plan_.queries[q].query;
            if (query.only_cascade && *query.only_cascade != static_cast<int>(c)) continue;
            for (std::size_t i = 0; i < query.pixel_m.size(); ++i) {
                pairs.push_back({query.pixel_m[i], query.pixel_m[i], &statistics_[q].resolved[i]});
                if (i + 1 < query.pixel_m.size())
                    pairs.push_back(
                        {query.pixel_m[i], query.pixel_m[i + 1], &statistics_[q].resolved_next[i]});
            }
        }

        // Rows side by side; their sums are added up in the order of the rows, whoever computed them.
        const double step = kTwoPi / planned.size_m;
        // Without a grid the modes are only counted: what they hold of the hidden statistics.
        const bool generated = cascade.radius > 0;
        const int rows = planned.mode_radius > 0 ? planned.mode_radius + 1 : 0;
        std::vector<std::size_t> row_offset(rows + 1, 0);
        for (int my = 0; my < rows; ++my)
            row_offset[my + 1] = row_offset[my] + row_length(planned.mode_radius, my);
        std::vector<double> row_m0(rows, 0.0);
        std::vector<std::vector<SpectralMoments>> row_sums(rows, std::vector<SpectralMoments>(pairs.size()));
        tbb::parallel_for(0, rows, [&](int my) {
            std::size_t at = row_offset[my];
            for (int i = 0; i < row_length(planned.mode_radius, my); ++i, ++at) {
                const int mx = row_first(planned.mode_radius, my) + i;
                const glm::dvec2 k(mx * step, my * step);
                const double length = std::hypot(k.x, k.y);
                const double omega = spectrum.dispersion().omega(length);
                const double chop = choppiness * spectrum.dispersion().horizontal_ratio(length) / length;
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
                if (generated) {
                    // h0(k) = ½ (ξr + iξi) √E(k) (Tessendorf 2001, Eq. 25, with the ½ that makes Var(η) =
                    // ΣE).
                    const auto amplitude = [&](double e, int x, int y) {
                        const auto xi =
                            normal_pair({static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(x),
                                         static_cast<std::uint32_t>(y), 0u},
                                        scene.shot.seed);
                        return 0.5 * std::sqrt(e) * std::complex<double>(xi[0], xi[1]);
                    };
                    const std::complex<double> h0 = energy > 0.0 ? amplitude(energy, mx, my) : 0.0;
                    const std::complex<double> h0_mirrored =
                        mirrored > 0.0 ? amplitude(mirrored, -mx, -my) : 0.0;
                    cascade.forward[at] = std::complex<T>(h0);
                    cascade.backward[at] = std::complex<T>(std::conj(h0_mirrored));
                    cascade.cycles_per_s[at] = cycles_per_s(omega, loop_s_);
                    if (!cascade.chop.empty()) cascade.chop[at] = static_cast<T>(chop);
                }
                row_m0[my] += energy + mirrored;
                for (std::size_t p = 0; p < pairs.size(); ++p) {
                    const double weight = plan_.filter.weight(length, pairs[p].footprint_a) *
                                          plan_.filter.weight(length, pairs[p].footprint_b);
                    if (weight > 0.0) add_mode(row_sums[my][p], k, weight * (energy + mirrored), omega, chop);
                }
            }
        });
        double m0 = 0.0;
        for (int my = 0; my < rows; ++my) {
            m0 += row_m0[my];
            for (std::size_t p = 0; p < pairs.size(); ++p) accumulate(*pairs[p].sum, row_sums[my][p]);
        }
        expected_m0_.push_back(m0);
        cascades_.push_back(std::move(cascade));
    }
}

template class Sea<float>;
template class Sea<double>;

}  // namespace pelagic
