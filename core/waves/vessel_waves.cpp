#include "core/waves/vessel_waves.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "core/base/build_watch.h"
#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/waves/sea.h"

namespace pelagic {
namespace {

constexpr int kBlockColumns = 16;
constexpr double kOff = 0.02;  // of the shortest wave: how far a straight step may be off its path

double rise(double x) {
    const double t = std::clamp(x, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

}  // namespace

TileFade tile_fade(double from_m, double size_m) {
    const double edge_m = VesselPlan::kEdge * size_m;
    const double t = std::clamp((0.5 * size_m - std::abs(from_m)) / edge_m, 0.0, 1.0);
    return {rise(t), (from_m < 0.0 ? 6.0 : -6.0) * t * (1.0 - t) / edge_m};
}

template <class T>
VesselWaves::VesselWaves(const Cascade<T>& cascade, const VesselPlan& plan, const Dispersion& dispersion)
    : plan_(plan), kernels_(vessel_kernels()), radius_(cascade.radius), columns_(cascade.columns) {
    const std::size_t count = cascade.modes();
    remembered_ = Buffer<float>::uncleared(4 * VesselPlan::kBlocks * count);
    cycles_per_s_ = Buffer<double>(count);
    std::copy_n(cascade.cycles_per_s.data(), count, cycles_per_s_.data());
    for (Buffer<float>* buffer : {&omega_, &depth_, &group_x_, &group_y_, &turn_re_, &turn_im_})
        *buffer = Buffer<float>(count);
    for (int n = 0; n < VesselPlan::kStepLengths; ++n)
        for (Buffer<float>* buffer : {&cosine_[n], &sine_[n]}) *buffer = Buffer<float>(count);
    fastest_mps_.assign(static_cast<std::size_t>(radius_), 0.0);
    ky_ = Buffer<float>(2 * static_cast<std::size_t>(radius_) - 1);
    const double step = kTwoPi / plan_.size_m;
    constexpr double kParabola = 2.0 / 3.0;  // of what is round it
    const double hull_m =
        plan_.waves * kParabola * plan_.beam_m * plan_.length_m / (plan_.size_m * plan_.size_m);
    for (int my = 1 - radius_; my < radius_; ++my)
        ky_[static_cast<std::size_t>(my + radius_ - 1)] = static_cast<float>(my * step);
    tbb::parallel_for(0, radius_, [&](int mx) {
        const int height = half_height(radius_, mx);
        for (int my = -height; my <= height; ++my) {
            const std::size_t i = cascade.middle(mx) + static_cast<std::size_t>(my);
            const double k = step * std::hypot(mx, my), omega = kTwoPi * cycles_per_s_[i];
            const double fast_mps = k > 0.0 ? dispersion.domega_dk(k) : 0.0,
                         group = k > 0.0 ? fast_mps / k * step : 0.0;
            double& fastest_mps = fastest_mps_[static_cast<std::size_t>(mx)];
            fastest_mps = std::max(fastest_mps, fast_mps);
            omega_[i] = static_cast<float>(omega);
            depth_[i] = static_cast<float>(hull_m * below_water_m(k, plan_.draught_m));
            group_x_[i] = static_cast<float>(group * mx);
            group_y_[i] = static_cast<float>(group * my);
            std::complex<double> turn = std::polar(1.0, 0.5 * omega * plan_.block_s / VesselPlan::kMostSteps);
            for (int n = VesselPlan::kStepLengths - 1; n >= 0; --n, turn *= turn) {
                cosine_[n][i] = static_cast<float>(turn.real());
                sine_[n][i] = static_cast<float>(turn.imag());
            }
            turn_re_[i] = static_cast<float>(turn.real());
            turn_im_[i] = static_cast<float>(turn.imag());
        }
    });
}

VesselWaves::Phases VesselWaves::phases(glm::dvec2 place_m) const {
    Phases made;
    // Each by itself: a mode is the same however many there are.
    const auto powers = [&](double metres, int first, std::vector<float>& re, std::vector<float>& im) {
        const double turns = metres / plan_.size_m, rest = turns - std::floor(turns);
        re.resize(static_cast<std::size_t>(radius_ - first) +
                  Buffer<float>::kSlack);  // kernels read whole vectors
        im.resize(re.size());
        for (int m = 0; m < radius_; ++m) {
            const double phase = -kTwoPi * std::remainder(rest * m, 1.0);
            const auto at = static_cast<std::size_t>(m - first);
            re[at] = static_cast<float>(std::cos(phase));
            im[at] = static_cast<float>(std::sin(phase));
            if (first == 0 || m == 0) continue;
            re[at - 2 * static_cast<std::size_t>(m)] = re[at];
            im[at - 2 * static_cast<std::size_t>(m)] = -im[at];
        }
    };
    powers(place_m.x, 0, made.x_re, made.x_im);
    powers(place_m.y, 1 - radius_, made.y_re, made.y_im);
    return made;
}

PlanePhase VesselWaves::phase(const Phases& of, int mx) const {
    const auto first = static_cast<std::size_t>(radius_ - 1 - half_height(radius_, mx));
    const auto x = static_cast<std::size_t>(mx);
    return {of.x_re[x], of.x_im[x], of.y_re.data() + first, of.y_im.data() + first};
}

const float* VesselWaves::ky_of(int mx) const {
    return ky_.data() + (radius_ - 1 - half_height(radius_, mx));
}

// So many that no straight one is off by more than a part of the shortest wave that any vessel's tile of this side has.
int VesselWaves::steps_of(double from_s, double lasts_s, double part, int most) const {
    const double most_m = part * plan_.size_m / VesselPlan::kRadius;
    const auto at = [&](int of, int in) { return plan_.path.at(from_s + lasts_s * of / in); };
    const auto are_straight = [&](int steps) {
        for (int i = 0; i < steps; ++i)
            for (const int quarter : {1, 2, 3})
                if (glm::distance(at(4 * i + quarter, 4 * steps),
                                  glm::mix(at(i, steps), at(i + 1, steps), 0.25 * quarter)) > most_m)
                    return false;
        return true;
    };
    int steps = 1;
    while (steps < most && !are_straight(steps)) steps *= 2;
    return steps;
}

int VesselWaves::steps_of(std::int64_t block) const {
    return steps_of(static_cast<double>(block) * plan_.block_s, plan_.block_s, kOff, VesselPlan::kMostSteps);
}

VesselWaves::Sums VesselWaves::remembered(std::int64_t block) {
    const std::size_t count = omega_.size();
    const auto slot =
        static_cast<std::size_t>((block % VesselPlan::kBlocks + VesselPlan::kBlocks) % VesselPlan::kBlocks);
    float* first = remembered_.data() + 4 * slot * count;
    return {first, first + count, first + 2 * count, first + 3 * count};
}

void VesselWaves::head(Step& step, double at_s) const {
    const glm::dvec2 velocity = plan_.path.velocity_mps(at_s);
    if (glm::length(velocity) > 0.0) step.along = glm::normalize(velocity);
    step.bow = phases(-0.5 * plan_.length_m * step.along);
    step.board = phases(0.5 * plan_.beam_m * glm::dvec2(step.along.y, -step.along.x));
}

VesselWaves::Leg VesselWaves::leg(double from_s, double step_s, int steps) const {
    Leg made;
    made.from_s = from_s;
    made.end_s = from_s + steps * step_s;
    made.table = std::countr_zero(static_cast<unsigned>(
        std::clamp(static_cast<int>(std::lround(plan_.block_s / step_s)), 1, VesselPlan::kMostSteps)));
    const VesselPath& path = plan_.path;
    const glm::dvec2 end_m = path.at(made.end_s);
    made.middle_m = path.at(0.5 * (from_s + made.end_s));
    made.place = phases(end_m);
    for (int i = 0; i < steps; ++i) {
        const double begin_s = from_s + i * step_s;
        const glm::dvec2 a = path.at(begin_s), b = i + 1 < steps ? path.at(begin_s + step_s) : end_m;
        Step& step = made.steps.emplace_back();
        step.velocity_mps = (b - a) / step_s;
        head(step, begin_s + 0.5 * step_s);
        step.place = phases(0.5 * (a + b) - end_m);
        step.half_way = phases(0.5 * (a - b));
    }
    return made;
}

HullArgs VesselWaves::hull(const Step& step, int mx) const {
    return {.ahead_x = static_cast<float>(step.along.x),
            .ahead_y = static_cast<float>(step.along.y),
            .half_length_m = static_cast<float>(0.5 * plan_.length_m),
            .half_beam_m = static_cast<float>(0.5 * plan_.beam_m),
            .depth = depth_.data() + first_of(mx),
            .bow = phase(step.bow, mx),
            .board = phase(step.board, mx)};
}

void VesselWaves::sum_up(const Leg& leg, int mx, const float* cosine, const float* sine,
                         const Sums& sums) const {
    const std::size_t count = count_of(mx);
    for (float* sum : {sums.later_re, sums.later_im, sums.earlier_re, sums.earlier_im})
        std::fill_n(sum, count, 0.0f);
    for (const Step& step : leg.steps)
        kernels_.stretch({.count = count,
                          .kx = static_cast<float>(mx * kTwoPi / plan_.size_m),
                          .ux = static_cast<float>(step.velocity_mps.x),
                          .uy = static_cast<float>(step.velocity_mps.y),
                          .half_s = static_cast<float>(0.5 * (leg.end_s - leg.from_s) /
                                                       static_cast<double>(leg.steps.size())),
                          .ky = ky_of(mx),
                          .omega = omega_.data() + first_of(mx),
                          .cosine = cosine,
                          .sine = sine,
                          .place = phase(step.place, mx),
                          .half_way = phase(step.half_way, mx),
                          .hull = hull(step, mx),
                          .later_re = sums.later_re,
                          .later_im = sums.later_im,
                          .earlier_re = sums.earlier_re,
                          .earlier_im = sums.earlier_im});
}

void VesselWaves::set(double t_s, const std::atomic<bool>* cancel) {
    t_s_ = t_s;
    const auto last = static_cast<std::int64_t>(std::floor(t_s / plan_.block_s)),
               first = last - VesselPlan::kBlocks;
    std::erase_if(blocks_, [&](const auto& block) { return block.first < first || block.first >= last; });
    std::vector<Leg*> missing;
    order_.clear();
    try {
        for (std::int64_t b = first; b < last; ++b) {
            auto found = blocks_.find(b);
            if (found == blocks_.end()) {
                const double from_s = static_cast<double>(b) * plan_.block_s;
                const int steps = steps_of(b);
                found = blocks_.emplace(b, leg(from_s, plan_.block_s / steps, steps)).first;
                found->second.sums = remembered(b);
                missing.push_back(&found->second);
            }
            order_.push_back(&found->second);
        }
        const int tasks = (radius_ + kBlockColumns - 1) / kBlockColumns;
        tbb::parallel_for(0, tasks * static_cast<int>(missing.size()), [&](int task) {
            stop_if(cancel);
            Leg& leg = *missing[static_cast<std::size_t>(task / tasks)];
            const int from = task % tasks * kBlockColumns, end = std::min(from + kBlockColumns, radius_);
            // A column's kernels write beyond its end, where the next one's values are not yet.
            for (int mx = from; mx < end; ++mx) {
                const std::size_t at = first_of(mx), count = count_of(mx);
                thread_local Buffer<float> own[4];
                for (Buffer<float>& sum : own)
                    if (sum.size() < count) sum = Buffer<float>(2 * static_cast<std::size_t>(radius_));
                sum_up(leg, mx, cosine_[leg.table].data() + at, sine_[leg.table].data() + at,
                       {own[0].data(), own[1].data(), own[2].data(), own[3].data()});
                const Sums to = leg.sums.from(at);
                std::copy_n(own[0].data(), count, to.later_re);
                std::copy_n(own[1].data(), count, to.later_im);
                std::copy_n(own[2].data(), count, to.earlier_re);
                std::copy_n(own[3].data(), count, to.earlier_im);
            }
        });
    } catch (...) {
        blocks_.clear();  // some aren't whole
        order_.clear();
        throw;
    }
    for (Leg* leg : missing) leg->steps = {};  // nobody asks for them again
    // Steps on the same lattice: as time goes on, only the last one changes.
    const double begin_s = static_cast<double>(last) * plan_.block_s, step_s = plan_.block_s / steps_of(last);
    const int over =
        static_cast<int>(std::clamp((t_s - begin_s) / step_s, 0.0, VesselPlan::kMostSteps - 1.0));
    begun_ = leg(begin_s, step_s, over);
    // The last step's line turns as it grows, and what it has made with it: velocities don't have that. Cut at so much finer they are
    // within a thousandth of positions' differences; as finely as that in a tight turn, where eight parts are enough, too.
    constexpr double kPart = kOff / 32.0;
    constexpr int kMostParts = 8;
    const double since_s = std::max(t_s - begun_.end_s, 1e-9 * step_s);
    const int parts = steps_of(begun_.end_s, since_s, kPart, kMostParts);
    last_ = leg(begun_.end_s, since_s / parts, parts);
    now_ = {};
    now_.velocity_mps = plan_.path.velocity_mps(t_s);
    head(now_, t_s);
    middle_m_ = plan_.middle_m(t_s);
}

bool VesselWaves::reaches_tile(const Leg& leg, int mx) const {
    const glm::dvec2 off_m = glm::max(glm::abs(leg.middle_m - middle_m_) - 0.5 * plan_.size_m, 0.0);
    const double age_s = t_s_ - 0.5 * (leg.from_s + leg.end_s);
    return glm::length(off_m) <= 1.001 * age_s * fastest_mps_[static_cast<std::size_t>(mx)];
}

template <class T>
void VesselWaves::heights(int first_mx, int columns, T* re, T* im, T* rate_re, T* rate_im) const {
    struct Own {
        Buffer<float> later_re, later_im, earlier_re, earlier_im, cosine, sine;
        Buffer<float> of_begun[4], begun_re, begun_im, of_last[4], last_re, last_im;
        std::vector<Block> blocks;
    };
    thread_local Own own;
    const std::size_t most = 2 * static_cast<std::size_t>(radius_);
    if (own.last_im.size() < most) {
        for (Buffer<float>* sums : {own.of_begun, own.of_last})
            for (int part = 0; part < 4; ++part) sums[part] = Buffer<float>(most);
        for (Buffer<float>* buffer :
             {&own.later_re, &own.later_im, &own.earlier_re, &own.earlier_im, &own.cosine, &own.sine,
              &own.begun_re, &own.begun_im, &own.last_re, &own.last_im})
            *buffer = Buffer<float>(most);
    }
    const double oldest_s = VesselPlan::kBlocks * plan_.block_s, fading_s = 0.25 * oldest_s;
    for (int mx = first_mx; mx < first_mx + columns; ++mx) {
        const std::size_t first = first_of(mx), count = count_of(mx);
        own.blocks.clear();
        const auto add = [&](const Leg& leg, const float* turn_re, const float* turn_im, const Sums& of) {
            const glm::dvec2 from_m = leg.middle_m - middle_m_;
            const double age_s = t_s_ - 0.5 * (leg.from_s + leg.end_s);
            own.blocks.push_back({.from_x = static_cast<float>(from_m.x),
                                  .from_y = static_cast<float>(from_m.y),
                                  .age_s = static_cast<float>(age_s),
                                  .share = static_cast<float>(rise((oldest_s - age_s) / fading_s)),
                                  .place = phase(leg.place, mx),
                                  .turn_re = turn_re,
                                  .turn_im = turn_im,
                                  .later_re = of.later_re,
                                  .later_im = of.later_im,
                                  .earlier_re = of.earlier_re,
                                  .earlier_im = of.earlier_im});
        };
        for (const Leg* block : order_)
            // The oldest have left, but for fast waves.
            if (!own.blocks.empty() || reaches_tile(*block, mx))
                add(*block, turn_re_.data() + first, turn_im_.data() + first, block->sums.from(first));
        const auto add_begun = [&](const Leg& leg, const float* cosine, const float* sine,
                                   Buffer<float>(&of)[4], Buffer<float>& turn_re, Buffer<float>& turn_im) {
            for (std::size_t i = 0; i < count; ++i) {
                const float c = cosine[i], s = sine[i], step_re = c * c - s * s, step_im = 2.0f * c * s;
                turn_re[i] = step_re;
                turn_im[i] = step_im;
                for (std::size_t n = 1; n < leg.steps.size(); ++n) {
                    const float before = turn_re[i];
                    turn_re[i] = before * step_re - turn_im[i] * step_im;
                    turn_im[i] = before * step_im + turn_im[i] * step_re;
                }
            }
            const Sums sums{of[0].data(), of[1].data(), of[2].data(), of[3].data()};
            sum_up(leg, mx, cosine, sine, sums);
            add(leg, turn_re.data(), turn_im.data(), sums);
        };
        if (!begun_.steps.empty())
            add_begun(begun_, cosine_[begun_.table].data() + first, sine_[begun_.table].data() + first,
                      own.of_begun, own.begun_re, own.begun_im);
        kernels_.turn(
            {.count = count,
             .duration_s = 0.5 * (last_.end_s - last_.from_s) / static_cast<double>(last_.steps.size()),
             .cycles_per_s = cycles_per_s_.data() + first,
             .cosine = own.cosine.data(),
             .sine = own.sine.data()});
        add_begun(last_, own.cosine.data(), own.sine.data(), own.of_last, own.last_re, own.last_im);
        kernels_.blocks({.count = count,
                         .blocks = own.blocks,
                         .half_m = static_cast<float>((0.5 - 0.25 * VesselPlan::kEdge) * plan_.size_m),
                         .per_edge_m = static_cast<float>(1.0 / (1.5 * VesselPlan::kEdge * plan_.size_m)),
                         .group_x = group_x_.data() + first,
                         .group_y = group_y_.data() + first,
                         .later_re = own.later_re.data(),
                         .later_im = own.later_im.data(),
                         .earlier_re = own.earlier_re.data(),
                         .earlier_im = own.earlier_im.data()});
        float *lift_re = own.of_last[0].data(), *lift_im = own.of_last[1].data();  // has been added
        if (rate_re) {
            std::fill_n(lift_re, count, 0.0f);
            std::fill_n(lift_im, count, 0.0f);
            kernels_.lift({.count = count,
                           .kx = static_cast<float>(mx * kTwoPi / plan_.size_m),
                           .ux = static_cast<float>(now_.velocity_mps.x),
                           .uy = static_cast<float>(now_.velocity_mps.y),
                           .ky = ky_of(mx),
                           .place = phase(last_.place, mx),
                           .hull = hull(now_, mx),
                           .re = lift_re,
                           .im = lift_im});
        }
        const std::size_t to = first - first_of(first_mx);
        for (std::size_t i = 0; i < count; ++i) {
            re[to + i] = static_cast<T>(own.later_re[i] + own.earlier_re[i]);
            im[to + i] = static_cast<T>(own.later_im[i] + own.earlier_im[i]);
            if (!rate_re) continue;
            const float omega = omega_[first + i];
            rate_re[to + i] = static_cast<T>(omega * (own.earlier_im[i] - own.later_im[i]) + lift_re[i]);
            rate_im[to + i] = static_cast<T>(omega * (own.later_re[i] - own.earlier_re[i]) + lift_im[i]);
        }
    }
}

template VesselWaves::VesselWaves(const Cascade<float>&, const VesselPlan&, const Dispersion&);
template VesselWaves::VesselWaves(const Cascade<double>&, const VesselPlan&, const Dispersion&);
template void VesselWaves::heights(int, int, float*, float*, float*, float*) const;
template void VesselWaves::heights(int, int, double*, double*, double*, double*) const;

}  // namespace pelagic
