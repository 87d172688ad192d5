#include "core/waves/sea.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <limits>
#include <mutex>
#include <utility>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/random_tiling.h"
#include "core/scene/number_keys.h"
#include "core/spectrum/cell_energies.h"
#include "core/waves/breaking_rate.h"
#include "core/waves/hero_waves.h"
#include "core/waves/level_sums.h"
#include "core/waves/mode_kernels.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

// Columns that a task builds: enough for its sums and arrays to be worth making.
constexpr int kTaskColumns = 16;
// Modes that one blends.
constexpr std::size_t kTaskModes = 4096;

// Of one column at a time.
struct ColumnScratch {
    explicit ColumnScratch(int height)
        : stride_(height + 1 + kDensitySlack),
          values_(11 * stride_),
          modes_(2 * (2 * height + 1 + kDensitySlack)) {}

    // By my from 0 up.
    FourWays energies() { return {row(0), row(1), row(2), row(3)}; }
    ColumnSums sums() {
        return {.even = row(4),
                .odd = row(5),
                .east = row(6),
                .north = row(7),
                .per_k = row(8),
                .per_omega = row(9),
                .chop2 = row(10)};
    }
    // By my from −H up: E(k) and E(−k).
    double* forward() { return modes_.data(); }
    double* backward() { return modes_.data() + modes_.size() / 2; }
    // From the energies.
    void lay_out(int height) {
        const FourWays energy = energies();
        for (int my = 0; my <= height; ++my) {
            forward()[height - my] = energy.below[my];
            backward()[height - my] = energy.above[my];
        }
        std::copy_n(energy.same, height + 1, forward() + height);
        std::copy_n(energy.opposite, height + 1, backward() + height);
    }

  private:
    double* row(std::size_t i) { return values_.data() + i * stride_; }

    std::size_t stride_;
    std::vector<double> values_, modes_;
};

// With room for its modes.
template <class T>
Cascade<T> empty_cascade(const CascadePlan& planned, bool has_gradients) {
    Cascade<T> cascade;
    cascade.size_m = planned.size_m;
    cascade.radius = planned.amplitude_radius();
    for (int mx = 0; mx < cascade.radius; ++mx) {
        if (mx == 0) cascade.columns.push_back(0);
        cascade.columns.push_back(cascade.columns.back() + column_length(cascade.radius, mx));
    }
    const std::size_t count = lattice_modes(cascade.radius);
    for (Buffer<T>* values :
         {&cascade.forward_re, &cascade.forward_im, &cascade.backward_re, &cascade.backward_im})
        *values = Buffer<T>::uncleared(count);
    cascade.cycles_per_s = Buffer<double>::uncleared(count);
    if (has_gradients) cascade.chop = Buffer<T>::uncleared(count);
    return cascade;
}

// A mode's random numbers are those of both seas: each amplitude is the root of the energies' blend, with their sign. In double,
// so that no square is lost.
template <class T>
Cascade<T> blended(const Cascade<T>& first, const Cascade<T>& second, double share, double rate_per_s,
                   bool has_rates) {
    Cascade<T> cascade;
    cascade.size_m = first.size_m;
    cascade.radius = first.radius;
    cascade.columns = first.columns;
    const auto copy = []<class V>(const Buffer<V>& from) {
        Buffer<V> to = Buffer<V>::uncleared(from.size());
        std::copy_n(from.data(), from.size(), to.data());
        return to;
    };
    if (!first.chop.empty()) cascade.chop = copy(first.chop);
    cascade.cycles_per_s = copy(first.cycles_per_s);
    if (first.forward_re.empty()) return cascade;  // a vessel's
    constexpr std::array kAmplitudes{&Cascade<T>::forward_re, &Cascade<T>::forward_im,
                                     &Cascade<T>::backward_re, &Cascade<T>::backward_im};
    const std::size_t count = first.modes();
    for (std::size_t part = 0; part < kAmplitudes.size(); ++part) {
        (cascade.*kAmplitudes[part]) = Buffer<T>::uncleared(count);
        if (has_rates) cascade.growth[part] = Buffer<T>::uncleared(count);
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kTaskModes), [&](const auto& range) {
        for (std::size_t part = 0; part < kAmplitudes.size(); ++part) {
            const T *a = (first.*kAmplitudes[part]).data(), *b = (second.*kAmplitudes[part]).data();
            T* to = (cascade.*kAmplitudes[part]).data();
            T* rates = has_rates ? cascade.growth[part].data() : nullptr;
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const double of_first = static_cast<double>(a[i]), of_second = static_cast<double>(b[i]);
                const double before = of_first * of_first, after = of_second * of_second;
                const double root =
                    std::copysign(std::sqrt((1.0 - share) * before + share * after), of_first + of_second);
                to[i] = static_cast<T>(root);
                if (rates)
                    rates[i] =
                        root != 0.0 ? static_cast<T>(0.5 * rate_per_s * (after - before) / root) : T(0);
            }
        }
    });
    return cascade;
}

// Gives modes the frequencies and the displacement of a depth, and turns their amplitudes so that at its time they are where they have come to.
template <class T>
void turn(Cascade<T>& cascade, const CascadePlan& planned, const OverDepth& over,
          const Buffer<double>& turns) {
    const ModeKernels<T> kernels = mode_kernels<T>();
    const double step = kTwoPi / cascade.size_m;
    const bool widens = planned.moves() && !cascade.chop.empty() && over.depth_mps != 0.0;
    if (widens) cascade.widening = Buffer<T>::uncleared(cascade.modes());
    tbb::parallel_for(0, cascade.radius, [&](int mx) {
        const std::size_t at = cascade.columns[mx], end = cascade.columns[mx + 1];
        const int first_my = -half_height(cascade.radius, mx);
        kernels.frequencies({.mx = mx,
                             .first_my = first_my,
                             .count = end - at,
                             .step = step,
                             .dispersion = {over.depth_m},
                             .loop_s = 0.0,
                             .choppiness = planned.choppiness,
                             .cycles_per_s = cascade.cycles_per_s.data() + at,
                             .chop = cascade.chop.empty() ? nullptr : cascade.chop.data() + at});
        for (std::size_t i = at; i < end; ++i) {
            const double angle =
                kTwoPi * (turns[i] - fraction_of_product(cascade.cycles_per_s[i], over.time_s));
            const T cosine = static_cast<T>(std::cos(angle)), sine = static_cast<T>(std::sin(angle));
            const auto turn_one = [&](T& re, T& im, T by) {
                const T before = re;
                re = cosine * re - by * im;
                im = cosine * im + by * before;
            };
            turn_one(cascade.forward_re[i], cascade.forward_im[i], -sine);
            turn_one(cascade.backward_re[i], cascade.backward_im[i], sine);
            if (!cascade.growth[0].empty()) {
                turn_one(cascade.growth[0][i], cascade.growth[1][i], -sine);
                turn_one(cascade.growth[2][i], cascade.growth[3][i], sine);
            }
            if (!widens) continue;
            const double k = step * std::hypot(mx, first_my + static_cast<int>(i - at));
            cascade.widening[i] =
                k > 0.0 ? static_cast<T>(over.ratio_per_s(k) * std::tanh(k * over.depth_m)) : T(0);
        }
    });
}

SpectralMoments between(SpectralMoments first, SpectralMoments second, double share) {
    return (first *= 1.0 - share) += second *= share;
}

// What a narrow band of a spectrum has of moments.
struct BandMoments {
    double k;
    SpectralMoments moments;
};
// Of the tiles of a sea between two over other depths: what its displacement gradients, which have coth(kd) of the depth of now, are more than the
// blend of theirs. A panel of the spectra, a few per cent wide, is a band.
std::vector<BandMoments> gradients_by_depth(const Plan& first, const Plan& second, double share,
                                            const Dispersion& now) {
    std::vector<BandMoments> bands;
    const std::array depths_m{first.from->spectrum.dispersion().depth_m,
                              second.from->spectrum.dispersion().depth_m};
    if (first.trains || depths_m[0] == depths_m[1]) return bands;
    const double deep_k = Dispersion::kDeep / std::min(depths_m[0], depths_m[1]);
    for (const auto& [plan, part] : {std::pair(&first, 1.0 - share), std::pair(&second, share)}) {
        const DirectionalSpectrum& spectrum = plan->from->spectrum;
        const auto add = [&](double from, double to) {
            const double k = 0.5 * (from + to),
                         ratio = now.horizontal_ratio(k) / spectrum.dispersion().horizontal_ratio(k);
            SpectralMoments more;
            more.take_gradients(moments_pressed(spectrum, from, to, plan->breaking.choppiness));
            bands.push_back({k, more.scale_gradients(part * (ratio * ratio - 1.0))});
        };
        spectrum.for_panels(0.0, std::min(deep_k, plan->breaking.k_end()), [&](double from, double to) {
            add(from, 0.5 * (from + to));
            add(0.5 * (from + to), to);
        });
    }
    return bands;
}

// The share of the planned displacement.
double share_of(const std::optional<DisplacementAt>& displacement) {
    return displacement ? displacement->share : 1.0;
}

// Of a sea whose moments are these, and which has this share of the planned displacement.
Whitecaps whitecaps_of(const Plan& plan, const SpectralMoments& total, const FoamLife& life, double share) {
    const bool third = plan.knobs.third_moment;
    const double law = law_coverage(plan.from->scene),
                 choppiness = share * mean_choppiness(plan.from->spectrum, plan.breaking);
    Whitecaps found{.threshold = calibrated_threshold(total, law, choppiness, third, life)};
    const auto j = jacobian_moments<double>(0.0, 0.0, 0.0, 0.0,
                                            {total.xxxx, total.xxxy, total.xxyy, total.xyyy, total.yyyy});
    double left = 0.0;
    if (life.lasting_s > 0.0 && std::isfinite(found.threshold)) {
        const double deviate = breaking_deviate(j, found.threshold, third);
        found.left_per_s = life.left_per_s(deviate);
        left = found.left_per_s * life.lasting_s;
        found.left_coverage = pelagic::left_coverage(deviate, left);
        found.residual_coverage = residual_foam(found.left_coverage, coverage(j, found.threshold, third));
    }
    if (plan.gusts) {
        GustsPlan gusts = *plan.gusts;  // of the whole shot
        gusts.strength = plan.from->scene.sea.gust_strength;
        found.gusts =
            make_gusts(gusts, {.j = j, .left = left, .third_moment = third, .choppiness = choppiness},
                       found.threshold, plan.from->scene);
    }
    return found;
}

// What a cascade's waves up to these ends have at a place at rest: a sum over its modes for each tile that is blended there.
template <class T>
LocalWaves local_waves(const Cascade<T>& cascade, const CascadePlan& planned, uint tiling_key,
                       double lean_rad, const Dispersion& dispersion, glm::dvec2 place_m, double time_s,
                       const HeroEnds& ends) {
    LocalWaves sum;
    if (cascade.radius == 0) return sum;
    struct Tile {
        std::int64_t cell;
        double weight, slope_per_m;
    };
    const auto tiles = [&](double at_m) {
        const TilePlace place = tile_place(at_m / cascade.size_m);
        if (!planned.has_random_tiling) return std::vector<Tile>{{0, 1.0, 0.0}};
        const double side = place.from_middle < 0.0 ? -1.0 : 1.0;
        const BlendWeights<double> weights = blend_weights(std::abs(place.from_middle));
        const double rate_per_m = side * weights.rate / cascade.size_m;
        std::vector<Tile> found{{place.cell, weights.own, -weights.next * rate_per_m}};
        if (weights.next > 0.0)
            found.push_back(
                {place.cell + static_cast<std::int64_t>(side), weights.next, weights.own * rate_per_m});
        return found;
    };
    const double step = kTwoPi / cascade.size_m;
    const std::complex<double> leaning = std::polar(1.0, lean_rad);
    for (const Tile& x : tiles(place_m.x))
        for (const Tile& y : tiles(place_m.y)) {
            const TileOffset<double> offset =
                planned.has_random_tiling
                    ? tile_offset<double>(tiling_key, static_cast<uint>(x.cell), static_cast<uint>(y.cell))
                    : TileOffset<double>(0.0, 0.0);
            const auto part_of_turn = [](double turns) { return kTwoPi * (turns - std::floor(turns)); };
            const double at_x = part_of_turn(place_m.x / cascade.size_m + offset.x),
                         at_y = part_of_turn(place_m.y / cascade.size_m + offset.y);
            std::vector<LocalWaves> columns(static_cast<std::size_t>(cascade.radius));
            tbb::parallel_for(0, cascade.radius, [&](int mx) {
                LocalWaves& column = columns[static_cast<std::size_t>(mx)];
                const int height = half_height(cascade.radius, mx);
                for (int my = -height; my <= height; ++my) {
                    const glm::dvec2 k = step * glm::dvec2(mx, my);
                    const double length = glm::length(k);
                    if (!counts_as_wave(mx, my) || length > ends.height) continue;
                    const std::size_t mode = cascade.middle(mx) + my;
                    const double turns = cascade.cycles_per_s[mode] * time_s;
                    const std::complex<double> turn = std::polar(1.0, -part_of_turn(turns)),
                                               forward(cascade.forward_re[mode], cascade.forward_im[mode]),
                                               backward(cascade.backward_re[mode], cascade.backward_im[mode]),
                                               place = std::polar(2.0, mx * at_x + my * at_y);
                    const std::complex<double> wave = (forward * turn + backward * std::conj(turn)) * place;
                    column.height_m += wave.real();
                    if (length > ends.level) continue;
                    const std::complex<double> later = (forward * turn * std::conj(leaning) +
                                                        backward * std::conj(turn) * leaning) *
                                                       place,
                                               rate = std::complex<double>(
                                                          0.0, kTwoPi * cascade.cycles_per_s[mode]) *
                                                      (backward * std::conj(turn) - forward * turn) * place;
                    column += {.slope = -wave.imag() * k,
                               .rate_mps = rate.real(),
                               .displacement_m = -planned.choppiness * dispersion.horizontal_ratio(length) /
                                                 length * later.imag() * k};
                }
            });
            LocalWaves tile;
            for (const LocalWaves& column : columns) tile += column;
            const double weight = x.weight * y.weight;
            sum += {.height_m = weight * tile.height_m,
                    .slope = weight * tile.slope +
                             tile.height_m * glm::dvec2(x.slope_per_m * y.weight, x.weight * y.slope_per_m),
                    .rate_mps = weight * tile.rate_mps,
                    .displacement_m = weight * tile.displacement_m};
        }
    return sum;
}

}  // namespace

// Counts finished work and reports it.
template <class T>
class Sea<T>::Progress {
  public:
    Progress(const BuildWatch& watch, const Plan& plan) : watch_(watch) {
        for (const CascadePlan& cascade : plan.cascades)
            if (!cascade.vessel) all_ += lattice_modes(cascade.mode_radius);
    }
    void done(std::size_t modes) {
        stop_if(watch_.cancel);
        if (!watch_.progress) return;
        const std::lock_guard lock(mutex_);
        done_ += modes;
        // While the callback waits for tasks of its own, this thread must not take up ours: they would wait for this
        // lock.
        tbb::this_task_arena::isolate(
            [&] { watch_.progress(static_cast<double>(done_) / static_cast<double>(all_)); });
    }

  private:
    const BuildWatch& watch_;
    std::mutex mutex_;
    std::size_t done_ = 0, all_ = 0;
};

template <class T>
Sea<T>::Sea(Plan plan, const BuildWatch& watch, std::shared_ptr<const SpectrumTable> table,
            std::shared_ptr<const Coast<T>> coast)
    : plan_(std::move(plan)), table_(std::move(table)), loop_s_(plan_.from->scene.shot.sea_loop_s()) {
    if (plan_.from->weather) refuse_keyed_sea(plan_.from->scene);
    const DirectionalSpectrum& spectrum = plan_.from->spectrum;
    if (!table_) table_ = std::make_shared<const SpectrumTable>(spectrum);
    if (plan_.trains) {
        trains_ = make_trains<T>(*plan_.from, *plan_.trains, plan_.filter, plan_.breaking);
        total_ = pelagic::total(trains_);
        const auto is_for = [&](const Coast<T>& of) {
            return std::equal(trains_.breaking.begin(), trains_.breaking.end(), of.breaking.begin());
        };
        if (coast && is_for(*coast))
            coast_ = std::move(coast);
        else if (plan_.trains->coast_cells.x > 0)
            coast_ = std::make_shared<const Coast<T>>(
                make_coast(*plan_.from, *plan_.trains, trains_, plan_.breaking));
    } else {
        total_ =
            moments_with_breaking(spectrum, 0.0, std::numeric_limits<double>::infinity(), plan_.breaking);
    }
    whitecaps_ = whitecaps(foam_life(plan_));
    if (plan_.masks && plan_.masks->calms_ripples) slick_ = slick_moments(spectrum, plan_.filter);

    for (const PlannedQuery& planned : plan_.queries) {
        const std::size_t levels = planned.pixel_levels.size();
        SpectralMoments whole = total_;
        if (planned.query.only_cascade) {
            const CascadePlan& band = plan_.cascades[*planned.query.only_cascade];
            whole = moments_with_breaking(spectrum, band.k_lower, band.k_upper, plan_.breaking);
        }
        statistics_.push_back(
            {whole, std::vector<SpectralMoments>(levels), std::vector<SpectralMoments>(levels - 1)});
        ellipses_.push_back(has_ellipse_table(plan_, planned.query) ? EllipseMoments(plan_, planned.query)
                                                                    : EllipseMoments());
    }

    Progress progress(watch, plan_);
    std::vector<QueryStatistics> breaking = statistics_;  // through the breaking levels
    std::vector<Cascade<T>> cascades;
    for (int c = 0; c < static_cast<int>(plan_.cascades.size()); ++c)
        cascades.push_back(build(c, breaking, progress));
    cascades_ = std::make_shared<const std::vector<Cascade<T>>>(std::move(cascades));
    for (std::size_t q = 0; q < statistics_.size(); ++q) {
        if (plan_.queries[q].breaking_levels.empty()) continue;
        QueryStatistics& to = statistics_[q];
        for (std::size_t i = 0; i < to.resolved.size(); ++i)
            to.resolved[i].take_gradients(breaking[q].resolved[i]);
        for (std::size_t i = 0; i < to.resolved_next.size(); ++i)
            to.resolved_next[i].take_gradients(breaking[q].resolved_next[i]);
    }
    if (plan_.trains && plan_.trains->hero_trains > 0) raise_heroes();
}

template <class T>
void Sea<T>::raise_heroes() {
    const Scene& scene = plan_.from->scene;
    const Dispersion& dispersion = plan_.from->spectrum.dispersion();
    const auto seed = static_cast<std::uint64_t>(scene.shot.seed);
    const HeroEnds ends = plan_.trains->hero_ends;
    std::vector<LocalWaves> around;
    for (const HeroWave& hero : scene.waves.heroes) {
        const glm::dvec2 place_m(hero.east_m, hero.north_m);
        const double time_s = hero_time_s(scene, hero);
        LocalWaves there = local_waves(trains_, place_m, time_s, ends);
        for (int c = 0; c < static_cast<int>(plan_.sea_cascades()); ++c)
            there += local_waves((*cascades_)[c], plan_.cascades[c], tiling_key(seed, c), plan_.lean_rad,
                                 dispersion, place_m, time_s, ends);
        around.push_back(there);
    }
    pelagic::add_heroes(trains_, hero_trains(*plan_.from, around), plan_.filter, plan_.breaking, dispersion);
}

template <class T>
Sea<T>::Sea(const Sea& first, const Sea& second, double share, double rate_per_s,
            std::shared_ptr<const PreparedScene> from, const std::optional<DisplacementAt>& displacement,
            const OverDepth* over)
    : plan_(first.plan_), loop_s_(first.loop_s_), displacement_(displacement) {
    plan_.from = std::move(from);
    total_ = total_between(first, second, share, rate_per_s, plan_, displacement, over, &trains_);
    const double gradients = share_of(displacement) * share_of(displacement);
    std::vector<BandMoments> more =
        gradients_by_depth(first.plan_, second.plan_, share, plan_.from->spectrum.dispersion());
    for (BandMoments& band : more) total_ += band.moments.scale_gradients(gradients);
    whitecaps_ = whitecaps(foam_life(plan_));
    slick_ = between(first.slick_, second.slick_, share);
    for (std::size_t q = 0; q < plan_.queries.size(); ++q) {
        const QueryStatistics &a = first.statistics_[q], &b = second.statistics_[q];
        QueryStatistics& made = statistics_.emplace_back();
        const auto now = [&](const SpectralMoments& before, const SpectralMoments& after) {
            return between(before, after, share).scale_gradients(gradients);
        };
        made.whole = plan_.queries[q].query.only_cascade ? now(a.whole, b.whole) : total_;
        for (std::size_t i = 0; i < a.resolved.size(); ++i)
            made.resolved.push_back(now(a.resolved[i], b.resolved[i]));
        for (std::size_t i = 0; i < a.resolved_next.size(); ++i)
            made.resolved_next.push_back(now(a.resolved_next[i], b.resolved_next[i]));
        ellipses_.emplace_back(first.ellipses_[q], second.ellipses_[q], share, gradients);
        const PlannedQuery& planned = plan_.queries[q];
        const std::vector<int>& levels =
            planned.breaking_levels.empty() ? planned.pixel_levels : planned.breaking_levels;
        const auto weight = [&](std::size_t level, double k) {
            return plan_.filter.weight(k, plan_.levels[levels[level]].footprint_m);
        };
        const auto add = [](SpectralMoments& to, SpectralMoments moments, double part) {
            to += moments.scale_gradients(part);
        };
        for (const BandMoments& band : more) {
            if (const auto& only = planned.query.only_cascade) {
                const CascadePlan& cascade = plan_.cascades[*only];
                if (!(band.k >= cascade.k_lower && band.k < cascade.k_upper)) continue;
                made.whole += band.moments;
            }
            for (std::size_t i = 0; i < made.resolved.size(); ++i)
                add(made.resolved[i], band.moments, weight(i, band.k) * weight(i, band.k));
            for (std::size_t i = 0; i < made.resolved_next.size(); ++i)
                add(made.resolved_next[i], band.moments, weight(i, band.k) * weight(i + 1, band.k));
        }
    }
    for (std::size_t c = 0; c < plan_.cascades.size(); ++c)
        expected_m0_.push_back((1.0 - share) * first.expected_m0_[c] + share * second.expected_m0_[c]);
    if (first.cascades_ == second.cascades_ && !over) {
        cascades_ = first.cascades_;
        return;
    }
    std::vector<Cascade<T>> cascades;
    for (std::size_t c = 0; c < plan_.cascades.size(); ++c) {
        cascades.push_back(blended((*first.cascades_)[c], (*second.cascades_)[c], share, rate_per_s,
                                   plan_.cascades[c].moves()));
        if (over) turn(cascades.back(), plan_.cascades[c], *over, over->turns.modes[c]);
    }
    cascades_ = std::make_shared<const std::vector<Cascade<T>>>(std::move(cascades));
}

template <class T>
Turns Sea<T>::turned(const Turns* before, std::span<const DepthAt::Part> parts) const {
    Turns turns;
    const ModeKernels<T> kernels = mode_kernels<T>();
    for (std::size_t c = 0; c < cascades_->size(); ++c) {
        const Cascade<T>& cascade = (*cascades_)[c];
        Buffer<double>& to = turns.modes.emplace_back(cascade.modes());
        if (before) std::copy_n(before->modes[c].data(), cascade.modes(), to.data());
        tbb::parallel_for(0, cascade.radius, [&](int mx) {
            const std::size_t at = cascade.columns[mx], count = cascade.columns[mx + 1] - at;
            Buffer<double> cycles_per_s(count);
            for (const DepthAt::Part& part : parts) {
                kernels.frequencies({.mx = mx,
                                     .first_my = -half_height(cascade.radius, mx),
                                     .count = count,
                                     .step = kTwoPi / cascade.size_m,
                                     .dispersion = {part.depth_m},
                                     .loop_s = 0.0,
                                     .choppiness = 0.0,
                                     .cycles_per_s = cycles_per_s.data(),
                                     .chop = nullptr});
                // The only part may be a long time; one of several is within two keys.
                if (parts.size() == 1)
                    for (std::size_t i = 0; i < count; ++i)
                        to[at + i] += fraction_of_product(cycles_per_s[i], part.time_s);
                else
                    for (std::size_t i = 0; i < count; ++i) to[at + i] += cycles_per_s[i] * part.time_s;
            }
            for (std::size_t i = at; i < at + count; ++i) to[i] -= std::round(to[i]);
        });
    }
    turns.trains = before ? before->trains : std::vector<double>(trains_.count());
    for (std::size_t i = 0; i < trains_.count(); ++i) {
        double& to = turns.trains[i];
        for (const DepthAt::Part& part : parts)
            to += fraction_of_product(
                Dispersion{part.depth_m}.omega(kTwoPi / trains_.wavelength_m[i]) / kTwoPi, part.time_s);
        to -= std::round(to);
    }
    return turns;
}

template <class T>
Sea<T>::Sea(const Sea& waves, std::shared_ptr<const PreparedScene> from) : Sea(waves) {
    plan_.from = std::move(from);
    whitecaps_ = whitecaps(foam_life(plan_));
}

template <class T>
Whitecaps Sea<T>::whitecaps(const FoamLife& life) const {
    return whitecaps_of(plan_, total_, life, share_of(displacement_));
}

template <class T>
SpectralMoments Sea<T>::total_between(const Sea& first, const Sea& second, double share, double rate_per_s,
                                      const Plan& plan, const std::optional<DisplacementAt>& displacement,
                                      const OverDepth* over, Trains<T>* made) {
    const double displaced = share_of(displacement);
    if (!plan.trains)
        return between(first.total_, second.total_, share).scale_gradients(displaced * displaced);
    Trains<T> trains = blended(
        first.trains_, second.trains_,
        {.share = share,
         .rate_per_s = rate_per_s,
         .choppiness = displaced * plan.choppiness.largest(),
         .choppiness_per_s = displacement ? displacement->share_per_s * plan.choppiness.largest() : 0.0,
         .breaking = displaced,
         .over = over},
        plan.from->spectrum.dispersion(), plan.breaking);
    const SpectralMoments total = pelagic::total(trains);
    if (made) *made = std::move(trains);
    return total;
}

template <class T>
Whitecaps Sea<T>::whitecaps_between(const Sea& first, const Sea& second, double share,
                                    std::shared_ptr<const PreparedScene> from,
                                    const std::optional<DisplacementAt>& displacement) {
    Plan plan = first.plan_;
    plan.from = std::move(from);
    SpectralMoments total = total_between(first, second, share, 0.0, plan, displacement);
    const double gradients = share_of(displacement) * share_of(displacement);
    for (BandMoments& band :
         gradients_by_depth(first.plan_, second.plan_, share, plan.from->spectrum.dispersion()))
        total += band.moments.scale_gradients(gradients);
    return whitecaps_of(plan, total, foam_life(plan), share_of(displacement));
}

template <class T>
std::vector<FootprintPair> Sea<T>::pairs_of(int c, std::vector<QueryStatistics>& breaking) {
    const CascadePlan& planned = plan_.cascades[c];
    std::vector<FootprintPair> pairs;
    for (std::size_t q = 0; q < plan_.queries.size(); ++q) {
        const Query& query = plan_.queries[q].query;
        if (query.only_cascade && *query.only_cascade != c) continue;
        const auto add = [&](const std::vector<int>& through, QueryStatistics& sums) {
            const auto footprint_m = [&](std::size_t level) {
                return plan_.levels[through[level]].footprint_m;
            };
            const auto radius = [&](std::size_t level) { return planned.radius_of_level[through[level]]; };
            for (std::size_t i = 0; i < through.size(); ++i) {
                pairs.push_back({footprint_m(i), footprint_m(i), radius(i), &sums.resolved[i]});
                if (i + 1 < through.size())
                    pairs.push_back({footprint_m(i), footprint_m(i + 1), std::min(radius(i), radius(i + 1)),
                                     &sums.resolved_next[i]});
            }
        };
        add(plan_.queries[q].pixel_levels, statistics_[q]);
        add(plan_.queries[q].breaking_levels, breaking[q]);
    }
    return pairs;
}

template <class T>
Cascade<T> Sea<T>::build(int c, std::vector<QueryStatistics>& breaking, Progress& progress) {
    const Scene& scene = plan_.from->scene;
    const Dispersion& dispersion = plan_.from->spectrum.dispersion();
    const CascadePlan& planned = plan_.cascades[c];
    Cascade<T> cascade = empty_cascade<T>(planned, plan_.has_gradients());
    if (planned.vessel) {
        for (Buffer<T>* values :
             {&cascade.forward_re, &cascade.forward_im, &cascade.backward_re, &cascade.backward_im})
            *values = {};
        const ModeKernels<T> modes = mode_kernels<T>();
        for (int mx = 0; mx < cascade.radius; ++mx)
            modes.frequencies(
                {.mx = mx,
                 .first_my = -half_height(cascade.radius, mx),
                 .count = cascade.columns[mx + 1] - cascade.columns[mx],
                 .step = kTwoPi / planned.size_m,
                 .dispersion = dispersion,
                 .loop_s = loop_s_,
                 .choppiness = planned.choppiness,
                 .cycles_per_s = cascade.cycles_per_s.data() + cascade.columns[mx],
                 .chop = cascade.chop.empty() ? nullptr : cascade.chop.data() + cascade.columns[mx]});
        expected_m0_.push_back(0.0);
        return cascade;
    }
    const LevelSums levels(planned.size_m, planned.mode_radius, plan_.filter, pairs_of(c, breaking));
    const CellEnergies energies(*table_, planned.size_m, planned.k_lower, planned.k_upper);
    const ModeKernels<T> kernels = mode_kernels<T>();
    const double step = kTwoPi / planned.size_m;

    // Blocks of columns side by side; their sums are added up in their order, whoever computed them.
    const int blocks = (planned.mode_radius + kTaskColumns - 1) / kTaskColumns;
    std::vector<LevelSums::Part> parts(blocks);
    tbb::parallel_for(
        tbb::blocked_range<int>(0, blocks, 1),
        [&](const tbb::blocked_range<int>& range) {
            for (int block = range.begin(); block < range.end(); ++block) {
                const int first = block * kTaskColumns;
                const int end = std::min(first + kTaskColumns, planned.mode_radius);
                ColumnScratch scratch(half_height(planned.mode_radius, first));
                LevelSums::Part& part = parts[block] = levels.part();
                std::size_t modes = 0;
                for (int mx = first; mx < end; ++mx) {
                    // Modes beyond the grids' radius have no amplitudes. They only count in the unresolved
                    // statistics.
                    const int counted = half_height(planned.mode_radius, mx);
                    const FourWays energy = scratch.energies();
                    energies.column(mx, counted, energy);
                    kernels.column({.same = energy.same,
                                    .opposite = energy.opposite,
                                    .below = energy.below,
                                    .above = energy.above,
                                    .mx = mx,
                                    .count = static_cast<std::size_t>(counted) + 1,
                                    .step = step,
                                    .dispersion = dispersion,
                                    .choppiness = planned.choppiness,
                                    .out = scratch.sums()});
                    levels.add(kernels.moments, scratch.sums(), mx, counted, part);
                    modes += column_length(planned.mode_radius, mx);
                    if (mx >= cascade.radius) continue;

                    const int height = half_height(cascade.radius, mx);
                    scratch.lay_out(height);
                    const std::size_t at = cascade.columns[mx], length = cascade.columns[mx + 1] - at;
                    kernels.amplitudes({.energy = scratch.forward(),
                                        .opposite = scratch.backward(),
                                        .mx = mx,
                                        .first_my = -height,
                                        .count = length,
                                        .cascade = static_cast<std::uint32_t>(c),
                                        .seed = static_cast<std::uint64_t>(scene.shot.seed),
                                        .forward_re = cascade.forward_re.data() + at,
                                        .forward_im = cascade.forward_im.data() + at,
                                        .backward_re = cascade.backward_re.data() + at,
                                        .backward_im = cascade.backward_im.data() + at});
                    kernels.frequencies({.mx = mx,
                                         .first_my = -height,
                                         .count = length,
                                         .step = step,
                                         .dispersion = dispersion,
                                         .loop_s = loop_s_,
                                         .choppiness = planned.choppiness,
                                         .cycles_per_s = cascade.cycles_per_s.data() + at,
                                         .chop = cascade.chop.empty() ? nullptr : cascade.chop.data() + at});
                }
                progress.done(modes);
            }
        },
        tbb::simple_partitioner());
    expected_m0_.push_back(levels.finish(parts).m0);
    return cascade;
}

template <class T>
SpectralMoments Sea<T>::resolved_moments(int query) const {
    const Query& asked = plan_.queries.at(query).query;
    SpectralMoments moments = statistics(query).resolved.front();
    if (plan_.trains && !asked.only_cascade)
        moments += resolved(trains_, plan_.filter, asked.pixel_m.front());
    return moments;
}

template class Sea<float>;
template class Sea<double>;

}  // namespace pelagic
