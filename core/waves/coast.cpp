#include "core/waves/coast.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "core/base/constants.h"
#include "core/plan/choppiness.h"
#include "core/spectrum/dispersion.h"

namespace pelagic {
namespace {

constexpr double kMostFadeChange = 0.2;  // of the least wavenumber, where a phase fades
constexpr double kSteepestRay = 0.26;    // least cosine of the angle between a ray and the march: 75°

// Wavenumber and group speed by depth, linear between nodes that are 1 % apart.
class OfDepth {
  public:
    static constexpr double kStep = 0.01;
    // Where a depth stands among the nodes; what is shallower than the shore's counts as that.
    static double place(double depth_m) {
        return std::log(std::max(depth_m, kCoastShore_m) / kCoastShore_m) / kStep;
    }
    OfDepth(double omega, double deepest_place) {
        const auto nodes = static_cast<std::size_t>(deepest_place) + 2;
        for (std::size_t i = 0; i < nodes; ++i) {
            const Dispersion at{kCoastShore_m * std::exp(kStep * static_cast<double>(i))};
            k_.push_back(at.wavenumber(omega));
            speed_.push_back(at.domega_dk(k_.back()));
        }
    }
    double wavenumber(double place) const { return of(k_, place); }
    double group_speed(double place) const { return of(speed_, place); }

  private:
    static double of(const std::vector<double>& values, double place) {
        const auto i = static_cast<std::size_t>(place);
        const double t = place - static_cast<double>(i);
        return values[i] + t * (values[i + 1] - values[i]);
    }
    std::vector<double> k_, speed_;
};

double smaller(double a, double b) {  // 0 where their signs differ
    if (a * b <= 0.0) return 0.0;
    return std::abs(a) < std::abs(b) ? a : b;
}

// The map as a march sees it: `u` along it, `v` across.
struct March {
    const CoastDepths& depths;
    bool along_y, backwards;
    int steps, width;
    double du, dv;

    March(const CoastDepths& of, glm::dvec2 direction)
        : depths(of),
          along_y(coast_goes_along_y(of, direction)),
          backwards((along_y ? direction.y : direction.x) < 0.0),
          steps(along_y ? of.count.y : of.count.x),
          width(along_y ? of.count.x : of.count.y),
          du(along_y ? of.cell_m.y : of.cell_m.x),
          dv(along_y ? of.cell_m.x : of.cell_m.y) {}
    std::size_t cell(int u, int v) const {
        const int along = backwards ? steps - 1 - u : u;
        return along_y ? depths.at(v, along) : depths.at(along, v);
    }
    glm::dvec2 in_world(double u, double v) const {
        const double along = backwards ? -u : u;
        return along_y ? glm::dvec2(v, along) : glm::dvec2(along, v);
    }
};

// One line across a march: S − k₀·x and the flux along it.
class Front {
  public:
    std::vector<double> phase, flux;

    Front(const March& march, const OfDepth& of, glm::dvec2 k0, double incoming)
        : phase(static_cast<std::size_t>(march.width), 0.0),
          flux(static_cast<std::size_t>(march.width), incoming),
          march_(march),
          of_(of),
          ku0_(std::abs(march.along_y ? k0.y : k0.x)),
          kv0_(march.along_y ? k0.x : k0.y),
          k0_(glm::length(k0)),
          turn_(phase.size()),
          rate_(phase.size()),
          later_(phase.size()),
          across_(phase.size()),
          diagonal_(phase.size()),
          faces_(phase.size() + 1) {}

    // From one line of depths' places to another, du apart.
    void step(const std::vector<double>& from, const std::vector<double>& to, double du) {
        constexpr int kMostParts = 16;
        const std::size_t width = phase.size();
        take_rates(phase, from);
        double steepest = 0.0;
        for (const double turn : turn_) steepest = std::max(steepest, std::abs(turn));
        const int parts =
            std::clamp(static_cast<int>(std::ceil(2.0 * steepest * du / march_.dv)), 1, kMostParts);
        const double part = du / parts;
        std::vector<double> begin(width), end(width);
        for (int p = 0; p < parts; ++p) {
            for (std::size_t v = 0; v < width; ++v) {
                // Between land and water there are no depths between.
                const bool is_shore = !(from[v] > 0.0) || !(to[v] > 0.0);
                const auto between = [&](double t) {
                    return is_shore ? (t < 0.5 ? from[v] : to[v]) : from[v] + (to[v] - from[v]) * t;
                };
                begin[v] = between(static_cast<double>(p) / parts);
                end[v] = between((p + 1.0) / parts);
            }
            for (std::size_t v = 0; v < width; ++v) across_[v] = slope_across(v);
            take_rates(phase, begin);
            for (std::size_t v = 0; v < width; ++v) later_[v] = phase[v] + part * rate_[v];
            const std::vector<double> first = rate_, first_turn = turn_;
            take_rates(later_, end);
            for (std::size_t v = 0; v < width; ++v) {
                phase[v] += 0.5 * part * (first[v] + rate_[v]);
                turn_[v] = 0.5 * (first_turn[v] + turn_[v]);
            }
            hold_to_first(end);
            move_flux(part, end);
            spread_flux(part, end);
        }
    }

    // Of the front as it is: S_u and S_v.
    glm::dvec2 gradient(std::size_t v, double place) const { return towards(phase, v, wavenumber(place)); }

  private:
    // On land that of the deep: what comes round it finds the phase hardly torn.
    double wavenumber(double place) const { return place > 0.0 ? of_.wavenumber(place) : k0_; }
    // |S_v| of the front, of first order.
    double slope_across(std::size_t v) const {
        const double before = kv0_ + (v > 0 ? phase[v] - phase[v - 1] : 0.0) / march_.dv,
                     after = kv0_ + (v + 1 < phase.size() ? phase[v + 1] - phase[v] : 0.0) / march_.dv;
        return std::max({before, -after, 0.0});
    }
    // The earliest arrival, if need be along the line: |S_v| ≤ k.
    void hold_to_first(const std::vector<double>& places) {
        const std::size_t width = phase.size();
        for (std::size_t v = 1; v < width; ++v)
            phase[v] = std::min(phase[v], phase[v - 1] + (wavenumber(places[v]) - kv0_) * march_.dv);
        for (std::size_t v = width - 1; v-- > 0;)
            phase[v] = std::min(phase[v], phase[v + 1] + (wavenumber(places[v]) + kv0_) * march_.dv);
    }
    // S_v from both sides; Godunov's for S_u = √(k² − S_v²).
    glm::dvec2 towards(const std::vector<double>& s, std::size_t v, double k) const {
        const auto last = static_cast<std::ptrdiff_t>(s.size()) - 1;
        const auto at = [&](std::ptrdiff_t i) {
            return s[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, last))];
        };
        const auto i = static_cast<std::ptrdiff_t>(v);
        const double a = at(i - 2), b = at(i - 1), c = at(i), d = at(i + 1), e = at(i + 2);
        const double curve_before = c - 2.0 * b + a, curve = d - 2.0 * c + b, curve_after = e - 2.0 * d + c;
        const double before = kv0_ + (c - b + 0.5 * smaller(curve_before, curve)) / march_.dv,
                     after = kv0_ + (d - c - 0.5 * smaller(curve, curve_after)) / march_.dv;
        const double up = std::max(before, 0.0), down = std::min(after, 0.0);
        const double across = up > -down ? up : down;
        return {std::sqrt(std::max(k * k - across * across, kSteepestRay * kSteepestRay * k * k)), across};
    }
    void take_rates(const std::vector<double>& s, const std::vector<double>& places) {
        for (std::size_t v = 0; v < s.size(); ++v) {
            const glm::dvec2 k = towards(s, v, wavenumber(places[v]));
            rate_[v] = k.x - ku0_;
            turn_[v] = std::clamp(k.y / k.x, -1.0 / kSteepestRay, 1.0 / kSteepestRay);
        }
    }
    // ∂f/∂u + ∂(f S_v/S_u)/∂v = 0.
    void move_flux(double du, const std::vector<double>& places) {
        const std::size_t width = flux.size();
        const auto slope = [&](std::size_t v) {
            if (v == 0 || v + 1 == width) return 0.0;
            return smaller(flux[v + 1] - flux[v], flux[v] - flux[v - 1]);
        };
        for (std::size_t face = 0; face <= width; ++face) {
            const std::size_t below = face == 0 ? 0 : face - 1, above = std::min(face, width - 1);
            const double turn = 0.5 * (turn_[below] + turn_[above]),
                         part = 0.5 * std::abs(turn) * du / march_.dv;
            const double carried = turn > 0.0 ? flux[below] + (0.5 - part) * slope(below)
                                              : flux[above] - (0.5 - part) * slope(above);
            faces_[face] = turn * carried;
        }
        for (std::size_t v = 0; v < width; ++v) {
            constexpr double kRounding = 1e-6;
            const bool ends =
                !(places[v] > 0.0) || across_[v] > (1.0 + kRounding) * of_.wavenumber(places[v]);
            flux[v] = ends ? 0.0 : std::max(flux[v] - du / march_.dv * (faces_[v + 1] - faces_[v]), 0.0);
        }
    }

    // ∂f/∂u = ∂/∂v(D ∂f/∂v), implicit: none goes ashore or out at the sides. D = 1/(2k) of waves along the march; of others it is over cos³ of
    // their angle, since ways are longer and lines across are cut obliquely.
    void spread_flux(double du, const std::vector<double>& places) {
        const std::size_t width = flux.size();
        const double scale = 0.5 * du / (march_.dv * march_.dv) * std::pow(k0_ / ku0_, 3.0);
        const auto per_k = [&](std::size_t v) { return 1.0 / of_.wavenumber(places[v]); };
        faces_.front() = faces_.back() = 0.0;
        for (std::size_t face = 1; face < width; ++face) {
            const bool is_water = places[face - 1] > 0.0 && places[face] > 0.0;
            faces_[face] = is_water ? scale * 0.5 * (per_k(face - 1) + per_k(face)) : 0.0;
        }
        // Thomas' algorithm.
        for (std::size_t v = 0; v < width; ++v) {
            diagonal_[v] = 1.0 + faces_[v] + faces_[v + 1];
            if (v == 0) continue;
            const double part = faces_[v] / diagonal_[v - 1];
            diagonal_[v] -= part * faces_[v];
            flux[v] += part * flux[v - 1];
        }
        flux[width - 1] /= diagonal_[width - 1];
        for (std::size_t v = width - 1; v-- > 0;)
            flux[v] = (flux[v] + faces_[v + 1] * flux[v + 1]) / diagonal_[v];
    }

    const March& march_;
    const OfDepth& of_;
    double ku0_, kv0_, k0_;
    std::vector<double> turn_, rate_, later_, across_, diagonal_, faces_;
};

// Over these cells, ends included. A spline lies between the coefficients that it reads, its derivative between their differences.
template <class T>
CoastRange range_of_cells(const Coast<T>& coast, std::size_t train, glm::ivec2 first, glm::ivec2 last) {
    const glm::ivec2 from = glm::max(first - 1, 0), to = glm::min(last + 1, coast.count - 1);
    CoastRange range{.phase_lo = 1e300, .phase_hi = -1e300, .gain_lo = 1e300, .gain_hi = -1e300};
    glm::dvec2 rate_lo(0.0), rate_hi(0.0);  // also beyond the map's edges
    const bool feels = train < coast.feeling;
    const auto phase_at = [&](int x, int y) {
        return static_cast<double>(coast.phase[coast.cell(x, y) * coast.stride + train]);
    };
    const auto include = [](double value, double& low, double& high) {
        low = std::min(low, value);
        high = std::max(high, value);
    };
    bool any_x = false, any_y = false;
    for (int y = from.y; y <= to.y; ++y)
        for (int x = from.x; x <= to.x; ++x) {
            include(static_cast<double>(feels ? coast.gain[coast.cell(x, y) * coast.stride + train]
                                              : coast.others[coast.cell(x, y)]),
                    range.gain_lo, range.gain_hi);
            if (!feels) continue;
            const double here = phase_at(x, y);
            include(here, range.phase_lo, range.phase_hi);
            const auto slope = [&](bool is_there, double next, double cell_m, double& low, double& high,
                                   bool& any) {
                if (!is_there) return;
                const double rate = kTwoPi * (next - here) / cell_m;
                if (!any) low = high = rate;
                any = true;
                include(rate, low, high);
            };
            slope(x < to.x, x < to.x ? phase_at(x + 1, y) : 0.0, coast.cell_m.x, rate_lo.x, rate_hi.x, any_x);
            slope(y < to.y, y < to.y ? phase_at(x, y + 1) : 0.0, coast.cell_m.y, rate_lo.y, rate_hi.y, any_y);
        }
    if (!feels) range.phase_lo = range.phase_hi = 0.0;
    for (int axis = 0; axis < 2; ++axis)
        if (first[axis] == 0 || last[axis] == coast.count[axis] - 1)
            include(0.0, rate_lo[axis], rate_hi[axis]);
    const glm::dvec2 k0(coast.kx[train], coast.ky[train]);
    range.k_lo = k0 + rate_lo;
    range.k_hi = k0 + rate_hi;
    return range;
}

}  // namespace

bool coast_goes_along_y(const CoastDepths& of, glm::dvec2 direction) {
    constexpr double kDeepest_m = 40.0, kClearly = 1.5, kLeastFall = 0.05, kLeastAlong = 0.35;
    const auto felt_m = [&](int x, int y) { return std::clamp(of.depth_m[of.at(x, y)], 0.0, kDeepest_m); };
    glm::dvec2 fall(0.0);
    double deepest_m = 0.0;
    for (int y = 0; y < of.count.y; ++y) fall.x += felt_m(of.count.x - 1, y) - felt_m(0, y);
    for (int x = 0; x < of.count.x; ++x) fall.y += felt_m(x, of.count.y - 1) - felt_m(x, 0);
    for (const double depth_m : of.depth_m) deepest_m = std::max(deepest_m, std::min(depth_m, kDeepest_m));
    const glm::dvec2 size_m = glm::dvec2(of.count) * of.cell_m, ways = glm::abs(direction),
                     slope = glm::abs(fall) / glm::dvec2(of.count.y, of.count.x) / size_m;
    const bool nearest = ways.y > ways.x, steepest = slope.y > slope.x;
    const double larger = std::max(slope.x, slope.y), smaller = std::min(slope.x, slope.y);
    const double size_along_m = steepest ? size_m.y : size_m.x;
    const bool is_clear = larger > kClearly * smaller && larger * size_along_m > kLeastFall * deepest_m;
    return is_clear && (steepest ? ways.y : ways.x) >= kLeastAlong ? steepest : nearest;
}

CoastWave march_coast(const CoastDepths& depths, double depth_m, double omega, glm::dvec2 direction) {
    const March march(depths, direction);
    std::vector<double> places(depths.depth_m.size());
    std::ranges::transform(depths.depth_m, places.begin(), OfDepth::place);
    const OfDepth of(omega, *std::ranges::max_element(places));
    const Dispersion far{depth_m};
    const double k0 = far.wavenumber(omega);
    const double along = std::abs(march.along_y ? direction.y : direction.x);
    CoastWave wave;
    wave.phase.resize(places.size());
    wave.energy.resize(places.size());
    wave.flux.resize(places.size());
    Front front(march, of, k0 * direction, far.domega_dk(k0) * along);
    const auto width = static_cast<std::size_t>(march.width);
    std::vector<double> from(width), to(width);
    const auto line = [&](int u, std::vector<double>& out) {
        for (std::size_t v = 0; v < width; ++v) out[v] = places[march.cell(u, static_cast<int>(v))];
    };
    line(0, from);
    for (int u = 0; u < march.steps; ++u) {
        line(u, to);
        front.step(from, to, u == 0 ? 0.5 * march.du : march.du);
        for (std::size_t v = 0; v < width; ++v) {
            const std::size_t cell = march.cell(u, static_cast<int>(v));
            const double k = of.wavenumber(to[v]), speed = of.group_speed(to[v]);
            const glm::dvec2 gradient = front.gradient(v, to[v]);
            const double cosine = gradient.x / k;
            wave.phase[cell] = front.phase[v];
            wave.energy[cell] = std::min(front.flux[v] / (speed * cosine), kMostCoastEnergy);
            const double turn = std::clamp(gradient.y / gradient.x, -1.0 / kSteepestRay, 1.0 / kSteepestRay);
            wave.flux[cell] = wave.energy[cell] * speed * cosine * march.in_world(1.0, turn);
        }
        from.swap(to);
    }
    return wave;
}

CoastBreaking break_on_coast(const CoastDepths& depths, std::span<const double> m0,
                             std::span<const glm::dvec2> flux, glm::dvec2 towards, double peak_hz) {
    constexpr double kMostTurn = 1.0 / kSteepestRay;
    const double scale = 3.0 * std::sqrt(kPi) / 16.0 * peak_hz / std::pow(kSurfGamma, 4.0);
    const March march(depths, towards);
    CoastBreaking breaking;
    breaking.left.assign(m0.size(), 1.0);
    breaking.broken.assign(m0.size(), 0.0);
    for (int u = 0; u < march.steps; ++u)
        for (int v = 0; v < march.width; ++v) {
            const std::size_t cell = march.cell(u, v);
            const double depth_m = depths.depth_m[cell];
            if (!(depth_m > kCoastShore_m)) {  // all that comes ashore has broken
                breaking.left[cell] = 0.0;
                continue;
            }
            const glm::dvec2 of = flux[cell];
            const double along = (march.backwards ? -1.0 : 1.0) * (march.along_y ? of.y : of.x),
                         across = march.along_y ? of.x : of.y;
            double before = 1.0;
            const bool moves = along > 0.0 && m0[cell] > 0.0;
            if (u > 0) {
                const double turn = moves ? std::clamp(across / along, -kMostTurn, kMostTurn) : 0.0;
                const double place = std::clamp(v - turn * march.du / march.dv, 0.0, march.width - 1.0);
                const int low = std::min(static_cast<int>(place), march.width - 1),
                          high = std::min(low + 1, march.width - 1);
                const double t = place - low;
                // What comes over land has nothing of its own to lose.
                const double a = breaking.left[march.cell(u - 1, low)],
                             b = breaking.left[march.cell(u - 1, high)];
                before = a > 0.0 && b > 0.0 ? a + t * (b - a) : std::max(a, b);
                if (!(before > 0.0)) before = 1.0;
            }
            double left = before;
            if (moves) {
                const double loss = scale * std::pow(8.0 * m0[cell], 3.5) / std::pow(depth_m, 5.0);
                const double step = u == 0 ? 0.5 * march.du : march.du;
                left = std::pow(std::pow(before, -2.5) + 2.5 * loss * step / along, -0.4);
            }
            breaking.left[cell] = left;
            breaking.broken[cell] = surf_share(std::sqrt(8.0 * m0[cell] * left), depth_m);
        }
    return breaking;
}

template <class T>
Coast<T> make_coast(const PreparedScene& prepared, const TrainsPlan& plan, const Trains<T>& trains,
                    const Breaking& breaking) {
    const Scene& scene = prepared.scene;
    const Dispersion& dispersion = prepared.spectrum.dispersion();
    const double choppiness = Choppiness::asked(scene).built().largest(),
                 of_breaking = breaking.choppiness.largest();
    const CoastDepths depths = coast_depths(*scene.waves.coast_depths, plan.coast_cells);
    const std::size_t cells = depths.depth_m.size();
    Coast<T> coast;
    coast.count = depths.count;
    coast.from_m = depths.from_m;
    coast.cell_m = depths.cell_m;
    constexpr std::size_t kVector = 64 / sizeof(T);
    coast.feeling = static_cast<std::size_t>(plan.coast_trains);
    coast.stride = (coast.feeling + kVector - 1) / kVector * kVector;
    coast.phase.assign(cells * coast.stride, T(0));
    coast.gain.assign(cells * coast.stride, T(0));
    coast.others.assign(cells, T(0));
    coast.broken.assign(cells, T(0));
    coast.deviation_m.assign(cells, T(0));
    double most = -1.0, peak_hz = 0.0;
    glm::dvec2 towards(0.0);
    for (std::size_t i = 0; i < trains.count(); ++i) {
        const double k = kTwoPi / trains.wavelength_m[i], ratio = dispersion.horizontal_ratio(k),
                     omega = dispersion.omega(k);
        const glm::dvec2 way(trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]);
        coast.kx.push_back(static_cast<T>(kTwoPi * way.x));
        coast.ky.push_back(static_cast<T>(kTwoPi * way.y));
        coast.height_m.push_back(static_cast<T>(trains.height_m[i]));
        coast.omega.push_back(static_cast<T>(kTwoPi * trains.cycles_per_s[i]));
        coast.sideways_m.push_back(static_cast<T>(choppiness * ratio / k));
        coast.breaking_sideways_m.push_back(static_cast<T>(of_breaking * ratio / k));
        coast.breaking.push_back(trains.breaking[i]);
        coast.longest_m.push_back(
            static_cast<T>(std::max(trains.wavelength_m[i], kTwoPi / Dispersion{}.wavenumber(omega)) /
                           (1.0 - kMostFadeChange)));
        const double energy = 0.5 * trains.height_m[i] * trains.height_m[i];
        towards += energy * dispersion.domega_dk(k) * trains.wavelength_m[i] * way;
        if (energy > most) {
            most = energy;
            peak_hz = omega / kTwoPi;
            coast.peak_per_m = k;
        }
    }
    for (std::vector<T>* of : {&coast.kx, &coast.ky, &coast.height_m, &coast.omega, &coast.sideways_m,
                               &coast.breaking_sideways_m, &coast.breaking})
        of->resize(trains.count() + kVector, T(0));
    // Some at a time, then added up in their order: the same whatever the number of threads.
    constexpr std::size_t kAtOnce = 16;
    std::vector<double> m0(cells, 0.0);
    std::vector<glm::dvec2> flux(cells, glm::dvec2(0.0));
    for (std::size_t first = 0; first < coast.feeling; first += kAtOnce) {
        const std::size_t last = std::min(first + kAtOnce, coast.feeling);
        std::array<CoastWave, kAtOnce> waves;
        tbb::parallel_for(first, last, [&](std::size_t i) {
            const glm::dvec2 direction =
                trains.wavelength_m[i] * glm::dvec2(trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]);
            const double omega = dispersion.omega(kTwoPi / trains.wavelength_m[i]);
            waves[i - first] = march_coast(depths, dispersion.depth_m, omega, direction);
        });
        for (std::size_t i = first; i < last; ++i) {
            const CoastWave& wave = waves[i - first];
            const double energy = 0.5 * trains.height_m[i] * trains.height_m[i];
            for (std::size_t cell = 0; cell < cells; ++cell) {
                coast.phase[cell * coast.stride + i] = static_cast<T>(wave.phase[cell] / kTwoPi);
                coast.gain[cell * coast.stride + i] = static_cast<T>(std::sqrt(wave.energy[cell]));
                m0[cell] += energy * wave.energy[cell];
                flux[cell] += energy * wave.flux[cell];
            }
        }
    }
    // One train alone is no random sea.
    CoastBreaking broken;
    if (trains.count() > 1) broken = break_on_coast(depths, m0, flux, towards, peak_hz);
    constexpr double kShortFade_m = 0.5;  // of depth, within which waves too short to feel it fade
    tbb::parallel_for(std::size_t(0), cells, [&](std::size_t cell) {
        const double depth_m = depths.depth_m[cell],
                     left = broken.left.empty() ? 1.0 : std::sqrt(broken.left[cell]);
        T* gain = &coast.gain[cell * coast.stride];
        const double highest_m = depth_m > kCoastShore_m ? 0.5 * kMostCoastHeight * depth_m : 0.0;
        for (std::size_t i = 0; i < coast.feeling; ++i) {
            const double own = static_cast<double>(gain[i]) * left, height_m = own * trains.height_m[i];
            gain[i] = static_cast<T>(height_m > highest_m ? highest_m / trains.height_m[i] : own);
        }
        const double fade = std::clamp((depth_m - kCoastShore_m) / kShortFade_m, 0.0, 1.0);
        coast.others[cell] = static_cast<T>(left * fade * fade * (3.0 - 2.0 * fade));
        if (!broken.broken.empty()) coast.broken[cell] = static_cast<T>(broken.broken[cell]);
        coast.deviation_m[cell] = static_cast<T>(left * std::sqrt(m0[cell]));
    });
    // Beyond the map, C¹.
    constexpr double kSteepestFade = 1.5;
    coast.fade_m = coast_fade_m(glm::dvec2(coast.count) * coast.cell_m);
    coast.phase_fade_per_m.assign(coast.feeling + kVector, T(0));
    tbb::parallel_for(std::size_t(0), coast.feeling, [&](std::size_t i) {
        double most_phase = 0.0;
        const auto look = [&](int x, int y) {
            most_phase = std::max(
                most_phase,
                std::abs(kTwoPi * static_cast<double>(coast.phase[coast.cell(x, y) * coast.stride + i])));
        };
        for (int x = 0; x < coast.count.x; ++x)
            for (const int y : {0, coast.count.y - 1}) look(x, y);
        for (int y = 0; y < coast.count.y; ++y)
            for (const int x : {0, coast.count.x - 1}) look(x, y);
        const double k = Dispersion{}.wavenumber(static_cast<double>(coast.omega[i]));
        coast.phase_fade_per_m[i] =
            static_cast<T>(1.0 / std::max(coast.fade_m, kSteepestFade * most_phase / (kMostFadeChange * k)));
    });
    // For bounds: over the nine cells that a place reads.
    coast.most_gain.assign(coast.feeling + 1, 0.0);
    coast.most_sideways.assign(coast.feeling + 1, 0.0);
    for (const T gain : coast.others)
        coast.most_gain.back() = std::max({coast.most_gain.back(), static_cast<double>(gain), 1.0});
    tbb::parallel_for(std::size_t(0), coast.feeling, [&](std::size_t i) {
        for (int y = 0; y < coast.count.y; ++y)
            for (int x = 0; x < coast.count.x; ++x) {
                const CoastRange at = range_of_cells(coast, i, {x, y}, {x, y});
                coast.most_gain[i] = std::max(coast.most_gain[i], at.gain_hi);
                // Beyond the edges, where gains may rise to 1 and wavenumbers change by so much more.
                const bool is_edge = x == 0 || y == 0 || x == coast.count.x - 1 || y == coast.count.y - 1;
                const double more =
                    is_edge ? kMostFadeChange * Dispersion{}.wavenumber(static_cast<double>(coast.omega[i]))
                            : 0.0;
                coast.most_sideways[i] =
                    std::max(coast.most_sideways[i],
                             std::max(at.gain_hi, is_edge ? 1.0 : 0.0) * (at.most_wavenumber() + more));
            }
        coast.most_gain[i] = std::max(coast.most_gain[i], 1.0);
    });
    return coast;
}

double quick_deviate(double share) {
    if (!(share > 0.0)) return kLeastDeviate;
    return std::clamp(std::log(share / (1.0 - std::min(share, 0.999999))) / kLogistic, kLeastDeviate,
                      -kLeastDeviate);
}

template <class T>
double coast_foam(const CoastSurf<T>& coast, glm::dvec2 place_m, double height_m, double cell_m,
                  const FootprintFilter& filter) {
    const double left = coast_fade(glm::length(coast.beyond_m(place_m)) / coast.fade_m).left;
    if (!(left > 0.0)) return 0.0;  // also at a place that is no number
    // Linear between cells' middles: foam has no slope.
    const glm::dvec2 at = glm::clamp((place_m - coast.from_m) / coast.cell_m - 0.5, glm::dvec2(0.0),
                                     glm::dvec2(coast.count - 1));
    const glm::ivec2 low(at), high = glm::min(low + 1, coast.count - 1);
    const glm::dvec2 t = at - glm::dvec2(low);
    const auto between = [&](const std::vector<T>& of) {
        const auto value = [&](int x, int y) { return static_cast<double>(of[coast.cell(x, y)]); };
        return glm::mix(glm::mix(value(low.x, low.y), value(high.x, low.y), t.x),
                        glm::mix(value(low.x, high.y), value(high.x, high.y), t.x), t.y);
    };
    const double share = left * kRoller * between(coast.broken), deviation_m = between(coast.deviation_m);
    if (!(share > kLeastSurf && deviation_m > 0.0)) return 0.0;
    const double crest =
        0.5 * std::erfc(-kSurfSharpness * (height_m / deviation_m + quick_deviate(share)) / std::sqrt(2.0));
    const double shown = filter.weight(coast.peak_per_m, cell_m);
    return shown * crest + (1.0 - shown) * share;
}

template double coast_foam(const CoastSurf<float>&, glm::dvec2, double, double, const FootprintFilter&);
template double coast_foam(const CoastSurf<double>&, glm::dvec2, double, double, const FootprintFilter&);

double CoastRange::most_wavenumber() const {
    return glm::length(glm::max(glm::abs(k_lo), glm::abs(k_hi)));
}

template <class T>
CoastRange coast_range(const Coast<T>& coast, std::size_t train, glm::dvec2 min_m, glm::dvec2 max_m) {
    constexpr double kMostCells = 16.0;  // a side, that are looked at one by one
    const glm::dvec2 k0(coast.kx[train], coast.ky[train]);
    const std::size_t own = std::min(train, coast.feeling);
    CoastRange all{.is_anything = true, .gain_hi = coast.most_gain[own], .k_lo = k0, .k_hi = k0};
    if (coast.beyond_m(min_m) != glm::dvec2(0.0) || coast.beyond_m(max_m) != glm::dvec2(0.0)) {
        // Far outside it is a plain train. Between anything is possible, as far as this goes.
        const double far_m =
            1e-6 +
            (train < coast.feeling ? 1.0 / static_cast<double>(coast.phase_fade_per_m[train]) : coast.fade_m);
        const glm::dvec2 to_m = coast.from_m + glm::dvec2(coast.count) * coast.cell_m,
                         apart_m = glm::max(glm::max(coast.from_m - max_m, min_m - to_m), glm::dvec2(0.0));
        all.most_sideways =
            train < coast.feeling ? coast.most_sideways[train] : all.gain_hi * glm::length(k0);
        all.is_anything = train < coast.feeling;
        if (glm::length(apart_m) > (1.0 + 1e-5) * far_m)
            return {.gain_lo = 1.0, .gain_hi = 1.0, .k_lo = k0, .k_hi = k0, .most_sideways = glm::length(k0)};
        return all;
    }
    const glm::dvec2 low = (min_m - coast.from_m) / coast.cell_m,
                     high = (max_m - coast.from_m) / coast.cell_m,
                     within_low = glm::clamp(low, glm::dvec2(0.0), glm::dvec2(coast.count)),
                     within_high = glm::clamp(high, glm::dvec2(0.0), glm::dvec2(coast.count));
    all.most_sideways = train < coast.feeling ? coast.most_sideways[train] : all.gain_hi * glm::length(k0);
    const glm::dvec2 cells = within_high - within_low;
    if (train >= coast.feeling) all.is_anything = false;
    if (!(std::max(cells.x, cells.y) < kMostCells)) return all;
    // A place between two cells may be told to belong to either.
    constexpr double kSlack = 1e-6;
    const glm::ivec2 last = coast.count - 1;
    const CoastRange here = range_of_cells(
        coast, train, glm::clamp(glm::ivec2(glm::floor(within_low - kSlack)), glm::ivec2(0), last),
        glm::clamp(glm::ivec2(glm::floor(within_high + kSlack)), glm::ivec2(0), last));
    CoastRange out = here;
    out.most_sideways = std::min(all.most_sideways, here.gain_hi * here.most_wavenumber());
    return out;
}

template CoastRange coast_range(const Coast<float>&, std::size_t, glm::dvec2, glm::dvec2);
template CoastRange coast_range(const Coast<double>&, std::size_t, glm::dvec2, glm::dvec2);
template Coast<float> make_coast(const PreparedScene&, const TrainsPlan&, const Trains<float>&,
                                 const Breaking&);
template Coast<double> make_coast(const PreparedScene&, const TrainsPlan&, const Trains<double>&,
                                  const Breaking&);

}  // namespace pelagic
