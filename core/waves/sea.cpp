#include "core/waves/sea.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "core/base/constants.h"
#include "core/base/random.h"
#include "core/plan/mode_lattice.h"
#include "core/spectrum/cell_energy.h"
#include "core/waves/loop.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

// The weights that a pair of levels gives a mode, and where their sum is kept.
struct LevelPair {
    double footprint_a, footprint_b;
    SpectralMoments* sum;
};

}  // namespace

template <class T>
Sea<T>::Sea(Plan plan) : plan_(std::move(plan)), loop_s_(plan_.from->scene.shot.exact_loop_s()) {
    const Scene& scene = plan_.from->scene;
    const DirectionalSpectrum& spectrum = plan_.from->spectrum;
    const double choppiness = scene.waves.choppiness;
    if (plan_.trains) {
        trains_ = make_trains<T>(*plan_.from, *plan_.trains);
        total_ = pelagic::total(trains_);
    } else {
        total_ = moments(spectrum, 0.0, std::numeric_limits<double>::infinity());
        total_.scale_strain(choppiness * choppiness);
    }
    whitecap_threshold_ = calibrated_threshold(total_, scene.sea.wind_speed_mps, plan_.knobs.third_moment);

    for (const PlannedQuery& planned : plan_.queries) {
        const std::size_t levels = planned.pixel_levels.size();
        SpectralMoments whole = total_;
        if (planned.query.only_cascade) {
            const CascadePlan& band = plan_.cascades[*planned.query.only_cascade];
            whole = moments(spectrum, band.k_lower, band.k_upper);
            whole.scale_strain(choppiness * choppiness);
        }
        statistics_.push_back(
            {whole, std::vector<SpectralMoments>(levels), std::vector<SpectralMoments>(levels - 1)});
    }

    for (std::size_t c = 0; c < plan_.cascades.size(); ++c) {
        const CascadePlan& planned = plan_.cascades[c];
        Cascade<T> cascade;
        cascade.size_m = planned.size_m;
        cascade.radius = planned.grid_radius();
        for (int mx = 0; mx < cascade.radius; ++mx) {
            if (mx == 0) cascade.columns.push_back(0);
            cascade.columns.push_back(cascade.columns.back() + column_length(cascade.radius, mx));
        }
        const std::size_t count = lattice_modes(cascade.radius);
        for (Buffer<T>* values :
             {&cascade.forward_re, &cascade.forward_im, &cascade.backward_re, &cascade.backward_im})
            *values = Buffer<T>(count);
        cascade.cycles_per_s = Buffer<double>(count);
        if (choppiness > 0.0) cascade.chop = Buffer<T>(count);

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

        // Columns side by side; their sums are added up in their order, whoever computed them.
        const double step = kTwoPi / planned.size_m;
        const int columns = planned.mode_radius;
        std::vector<double> column_m0(columns, 0.0);
        std::vector<std::vector<SpectralMoments>> column_sums(columns,
                                                              std::vector<SpectralMoments>(pairs.size()));
        tbb::parallel_for(0, columns, [&](int mx) {
            // Beyond the grids' radius modes are only counted: what they hold of the hidden statistics.
            const int generated = mx < cascade.radius ? half_height(cascade.radius, mx) : -1;
            const int counted = half_height(planned.mode_radius, mx);
            for (int my = -counted; my <= counted; ++my) {
                if (mx == 0 && my == 0) continue;
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
                if (std::abs(my) <= generated) {
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
                    const std::size_t at = cascade.middle(mx) + my;
                    cascade.forward_re[at] = static_cast<T>(h0.real());
                    cascade.forward_im[at] = static_cast<T>(h0.imag());
                    cascade.backward_re[at] = static_cast<T>(h0_mirrored.real());
                    cascade.backward_im[at] = static_cast<T>(-h0_mirrored.imag());
                    cascade.cycles_per_s[at] = looped_cycles_per_s(omega, loop_s_);
                    if (!cascade.chop.empty()) cascade.chop[at] = static_cast<T>(chop);
                }
                if (!counts_as_wave(mx, my)) continue;
                column_m0[mx] += energy + mirrored;
                for (std::size_t p = 0; p < pairs.size(); ++p) {
                    const double weight = plan_.filter.weight(length, pairs[p].footprint_a) *
                                          plan_.filter.weight(length, pairs[p].footprint_b);
                    if (weight > 0.0)
                        column_sums[mx][p] += moments_of({k, weight * (energy + mirrored), omega, chop});
                }
            }
        });
        double m0 = 0.0;
        for (int mx = 0; mx < columns; ++mx) {
            m0 += column_m0[mx];
            for (std::size_t p = 0; p < pairs.size(); ++p) *pairs[p].sum += column_sums[mx][p];
        }
        expected_m0_.push_back(m0);
        cascades_.push_back(std::move(cascade));
    }
}

template <class T>
SpectralMoments Sea<T>::shown(int query) const {
    const Query& asked = plan_.queries.at(query).query;
    SpectralMoments moments = statistics(query).resolved.front();
    if (plan_.trains && !asked.only_cascade)
        moments += resolved(trains_, plan_.filter, asked.pixel_m.front());
    return moments;
}

template class Sea<float>;
template class Sea<double>;

}  // namespace pelagic
