#include "core/evaluate/floating_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/random_tiling.h"

namespace pelagic {
namespace {

// Of a displacement ship, by rule of thumb (floating_response.h).
constexpr double kMetacentricShare = 0.1, kHighestGravityShare = 0.5, kTrimGyration = 0.25,
                 kHeelGyration = 0.35, kDeepGyration = 0.6;
constexpr double kHeaveDamping = 0.2, kTrimDamping = 0.2;

double sinc(double q) {
    return std::abs(q) < 1e-4 ? 1.0 - q * q / 6.0 : std::sin(q) / q;
}

double spherical_j1(double q) {
    return std::abs(q) < 1e-2 ? q / 3.0 * (1.0 - q * q / 10.0) : (std::sin(q) / q - std::cos(q)) / q;
}

// The pressure of a wave on the box, with the place of its ends left out.
struct Pressure {
    double keel = 0.0;    // e
    double moment = 0.0;  // J [m²]
};

Pressure pressure_of(double k, double depth_m, const FloatingModel& model) {
    const double draught_m = std::min(model.box.draught_m, depth_m);
    // cosh k(z + d)/cosh kd and sinh k(z + d)/cosh kd at z = −T, in decaying exponentials.
    const double bottom = std::exp(-2.0 * k * depth_m), here = std::exp(-k * draught_m),
                 below = std::exp(-2.0 * k * (depth_m - draught_m));
    const double cosh = here * (1.0 + below) / (1.0 + bottom), sinh = here * (1.0 - below) / (1.0 + bottom),
                 surface = (1.0 - bottom) / (1.0 + bottom);
    const double g = model.gravity_m;
    return {cosh, (-g * surface + (draught_m + g) * sinh) / k - (1.0 - cosh) / (k * k)};
}

// The sums over modes.
struct Motions {
    double heave = 0.0, trim = 0.0, heel = 0.0;
};

class Response {
  public:
    Response(const FloatingModel& model, const FootprintFilter& filter, double depth_m,
             const FloatingCourse& course)
        : model_(model), filter_(filter), depth_m_(depth_m), course_(course) {}

    double most_k() const { return filter_.cutoff(course_.cell_m); }

    // Waves along k [rad/m].
    void take(glm::dvec2 k) {
        const glm::dvec2 ahead = course_.ahead;
        const double kx = glm::dot(k, ahead), ky = k.y * ahead.x - k.x * ahead.y;
        const FloatingBox& box = model_.box;
        const double qx = 0.5 * kx * box.length_m, qy = 0.5 * ky * box.beam_m;
        const double sx = sinc(qx), sy = sinc(qy);
        const Pressure p = pressure_of(glm::length(k), depth_m_, model_);
        const double gravity = kGravity * filter_.weight(glm::length(k), course_.cell_m);
        heave_ = gravity * p.keel * sx * sy;
        trim_ =
            gravity * sy *
            (0.5 * box.length_m * p.keel * spherical_j1(qx) + 2.0 * p.moment * std::sin(qx) / box.length_m);
        heel_ = gravity * sx *
                (0.5 * box.beam_m * p.keel * spherical_j1(qy) + 2.0 * p.moment * std::sin(qy) / box.beam_m);
        met_ = glm::dot(k, course_.velocity_mps);
    }
    // Adds the answer to Re a e^{i(k·x − ωt)}, whose value here and now is `value`.
    void add(std::complex<double> value, double omega, Motions& sums) const {
        const double w = omega - met_;
        sums.heave += answer(model_.heave, w, value, heave_).real();
        sums.trim -= answer(model_.trim, w, value, trim_).imag();  // of i times that
        sums.heel -= answer(model_.heel, w, value, heel_).imag();
    }

  private:
    static std::complex<double> answer(const Oscillator& of, double w, std::complex<double> value,
                                       double pull) {
        const double re = of.stiffness - of.mass * w * w, im = -of.damping * w;
        const double scale = pull / (re * re + im * im);
        return {scale * (value.real() * re + value.imag() * im),
                scale * (value.imag() * re - value.real() * im)};
    }

    const FloatingModel& model_;
    const FootprintFilter& filter_;
    double depth_m_;
    const FloatingCourse& course_;
    double heave_ = 0.0, trim_ = 0.0, heel_ = 0.0, met_ = 0.0;
};

std::complex<double> turn(double cycles) {
    const double angle = kTwoPi * (cycles - std::floor(cycles));
    return {std::cos(angle), std::sin(angle)};
}

// Where a place lies in a cascade's tile, in tiles, and with what weight (core/plan/random_tiling.h).
struct TileCopy {
    glm::dvec2 at{0.0};
    double weight = 1.0;
};
std::vector<TileCopy> copies_at(const Plan& plan, int c, glm::dvec2 place_m) {
    const glm::dvec2 tiles = place_m / plan.cascades[static_cast<std::size_t>(c)].size_m;
    if (!plan.cascades[static_cast<std::size_t>(c)].has_random_tiling) return {{tiles, 1.0}};
    const uint key = tiling_key(plan.from->scene.shot.seed, c);
    const std::array<TilePlace, 2> place{tile_place(tiles.x), tile_place(tiles.y)};
    std::vector<TileCopy> copies;
    for (const bool next_x : {false, true})
        for (const bool next_y : {false, true}) {
            std::array<std::int64_t, 2> cell{};
            double weight = 1.0;
            for (const int axis : {0, 1}) {
                const TilePlace& of = place[static_cast<std::size_t>(axis)];
                const BlendWeights<double> weights = blend_weights(std::abs(of.from_middle));
                const bool is_next = axis == 0 ? next_x : next_y;
                weight *= is_next ? weights.next : weights.own;
                cell[static_cast<std::size_t>(axis)] =
                    of.cell + (is_next ? (of.from_middle < 0.0 ? -1 : 1) : 0);
            }
            if (weight < 1e-12) continue;  // tiles that are told of where none blends
            const TileOffset<double> offset =
                tile_offset<double>(key, static_cast<uint>(cell[0]), static_cast<uint>(cell[1]));
            copies.push_back({tiles + glm::dvec2(offset.x, offset.y), weight});
        }
    return copies;
}

template <class T>
void add_cascade(const Cascade<T>& cascade, const std::vector<TileCopy>& copies, double time_s,
                 Response& response, Motions& sums) {
    const double step = kTwoPi / cascade.size_m;
    const int most = std::min(cascade.radius - 1, static_cast<int>(std::min(response.most_k() / step, 1e6)));
    if (most < 1) return;
    // e^{2πi m x} of each copy.
    const auto powers = [&](double x) {
        std::vector<std::complex<double>> at(static_cast<std::size_t>(most) + 1);
        for (int m = 0; m <= most; ++m) at[static_cast<std::size_t>(m)] = turn(m * (x - std::floor(x)));
        return at;
    };
    std::vector<std::array<std::vector<std::complex<double>>, 2>> waves;
    for (const TileCopy& copy : copies) waves.push_back({powers(copy.at.x), powers(copy.at.y)});
    for (int mx = 0; mx <= most; ++mx) {
        const int height = std::min(half_height(cascade.radius, mx),
                                    static_cast<int>(std::sqrt(double(most) * most - double(mx) * mx)));
        for (int my = -height; my <= height; ++my) {
            if (!counts_as_wave(mx, my)) continue;
            const std::size_t i = cascade.middle(mx) + static_cast<std::size_t>(my);
            std::complex<double> here = 0.0;
            for (std::size_t n = 0; n < copies.size(); ++n) {
                const std::complex<double> y = waves[n][1][static_cast<std::size_t>(std::abs(my))];
                here += copies[n].weight * waves[n][0][static_cast<std::size_t>(mx)] *
                        (my < 0 ? std::conj(y) : y);
            }
            const double cycles = cascade.cycles_per_s[i];
            const std::complex<double> late = turn(-cycles * time_s);
            response.take(step * glm::dvec2(mx, my));
            // A mode stands for its mirror image as well.
            const std::complex<double> forward(cascade.forward_re[i], cascade.forward_im[i]),
                backward(cascade.backward_re[i], cascade.backward_im[i]);
            response.add(2.0 * forward * late * here, kTwoPi * cycles, sums);
            response.add(2.0 * backward * std::conj(late) * here, -kTwoPi * cycles, sums);
        }
    }
}

}  // namespace

FloatingModel floating_model(const FloatingBox& box, double heel_damping) {
    const double length = box.length_m, beam = box.beam_m, draught = box.draught_m;
    FloatingModel model;
    model.box = box;
    const double side = std::min(length, beam);
    model.gravity_m = std::min(side * side / (12.0 * std::max(draught, 1e-9)) - 0.5 * draught -
                                   kMetacentricShare * std::max(side, draught),
                               kHighestGravityShare * draught);
    const auto righting = [&](double width) {
        return kGravity * (width * width / 12.0 - draught * (0.5 * draught + model.gravity_m));
    };
    const auto damped = [](double stiffness, double mass, double share) {
        return Oscillator{stiffness, mass, 2.0 * share * std::sqrt(stiffness * mass)};
    };
    const double strip = kPi * beam / 8.0;  // added mass of heave over ρ L B
    const double trim_radius = std::max(kTrimGyration * length, kDeepGyration * draught),
                 heel_radius = std::max(kHeelGyration * beam, kDeepGyration * draught);
    model.heave = damped(kGravity, draught + strip, kHeaveDamping);
    model.trim = damped(righting(length),
                        draught * trim_radius * trim_radius + strip * length * length / 12.0, kTrimDamping);
    model.heel = damped(righting(beam),
                        draught * heel_radius * heel_radius + kPi * beam * beam * beam / 256.0, heel_damping);
    return model;
}

template <class T>
FloatingMotion floating_motion(const Frame<T>& state, const FloatingModel& model,
                               const FloatingCourse& course) {
    const Sea<T>& sea = state.sea();
    const Plan& plan = sea.plan();
    const double time_s = state.time_within_loop_s() + course.late_s;
    const glm::dvec2 middle_m = course.middle_m;
    Response response(model, plan.filter, plan.from->scene.sea.depth_m, course);
    Motions sums;
    for (std::size_t c = 0; c < plan.sea_cascades(); ++c)
        add_cascade(sea.cascades()[c], copies_at(plan, static_cast<int>(c), middle_m), time_s, response,
                    sums);
    if (plan.trains) {
        const Trains<T>& trains = sea.trains();
        for (std::size_t i = 0; i < trains.count(); ++i) {
            const glm::dvec2 cycles_per_m(trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]);
            if (kTwoPi * glm::length(cycles_per_m) > response.most_k()) continue;
            response.take(kTwoPi * cycles_per_m);
            response.add(trains.height_m[i] * turn(glm::dot(cycles_per_m, middle_m) - trains.start_cycles[i] -
                                                   trains.cycles_per_s[i] * time_s),
                         kTwoPi * trains.cycles_per_s[i], sums);
        }
    }
    const double gain = plan.masks ? plan.masks->at(middle_m).waves : 1.0;
    return {gain * sums.heave, gain * glm::dvec2(sums.trim, sums.heel)};
}
template FloatingMotion floating_motion(const Frame<float>&, const FloatingModel&, const FloatingCourse&);
template FloatingMotion floating_motion(const Frame<double>&, const FloatingModel&, const FloatingCourse&);

}  // namespace pelagic
