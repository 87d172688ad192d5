#include "core/spectrum/wave_system.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "core/base/constants.h"
#include "core/spectrum/cox_munk.h"
#include "core/spectrum/directed.h"
#include "core/spectrum/gauss.h"
#include "core/spectrum/viscous_cutoff.h"

namespace pelagic {

namespace {

constexpr double kRadiansPerDegree = kPi / 180.0;

// Below this wind [m/s] there is no wind sea: Pierson–Moskowitz' Hs would be 2e-8 m.
constexpr double kCalmWind = 1e-3;

// Where the blend into the short waves begins, in peak wavenumbers, and where it ends, relative to that. Below 3 the
// spectra are what was measured; from some 10 on slopes depend on the wind alone.
constexpr double kJoinFrom = 3.0, kJoinWidth = 10.0 / 3.0;
// Directionality is that of the energy: from one to two and a half peaks it ends. Slopes are those of shorter waves.
constexpr double kTurnedFrom = 1.0, kTurnedTo = 2.5;
// The short waves' energy is that which gives the glitter's slopes with what the longer ones have, by no more than this factor and
// its inverse; without it they are off by −17 … 33 % at 3 … 25 m/s.
constexpr double kLeastRipples = 0.5;
// Below this wind [m/s] the glitter's law, which leaves a calm some slope, counts less and less.
constexpr double kGlittered = 3.0;
// ω̃p ∝ ε̃^−0.3 on the way of growth (Kahma & Calkoen 1992: X̃^−0.27 and X̃^0.9).
constexpr double kPeakByEnergy = growth::kPeakExponent / growth::kEnergyExponent;
// A sea of next to no height has its peak no further up than this [rad/m], 10 cm: waves begin as ripples.
constexpr double kShortestPeak = 60.0;
// Elfouhaily's sea is given from full development to this inverse wave age (Eq. 3).
constexpr double kOldest = 0.84, kYoungest = 5.0;

template <class Law>
concept InWavenumber = requires(const Law& law) {
    law.density_k(1.0);
};

template <class Law>
concept SpreadsInWavenumber = requires(const Law& law) {
    law.at_wavenumber(1.0);
};

// Calls use(shape) with the spreading's shape at this wavenumber.
template <class Use>
auto with_shape(const SpreadingLaw& law, const WavePoint& point, Use&& use) {
    return std::visit(
        [&]<class Law>(const Law& spreading) {
            if constexpr (SpreadsInWavenumber<Law>) {
                return use(spreading.at_wavenumber(point.k));
            } else {
                return use(spreading.at(point.omega));
            }
        },
        law);
}

// The same with this directionality.
template <class Use>
auto with_directed(const SpreadingLaw& law, const WavePoint& point, double directionality, Use&& use) {
    return with_shape(law, point, [&](const auto& shape) {
        return directionality == 1.0 ? use(shape) : use(Directed(shape, directionality));
    });
}

JonswapShape jonswap(const SeaState& sea) {
    if (sea.growth == GrowthLaw::Height) return JonswapByHeight(sea.wind_speed_mps, sea.fetch_m);
    return Jonswap(sea.wind_speed_mps, sea.fetch_m);
}

EnergyLaw energy_law(const SeaState& sea) {
    switch (sea.spectrum) {
        case SpectrumKind::PiersonMoskowitz:
            return PiersonMoskowitz(sea.wind_speed_mps);
        case SpectrumKind::Jonswap:
            return jonswap(sea);
        case SpectrumKind::Jonswap1973:
            return Jonswap1973(sea.wind_speed_mps, sea.fetch_m);
        case SpectrumKind::Tma:
            return Tma(jonswap(sea), sea.depth_m);
        case SpectrumKind::Elfouhaily:
            return Elfouhaily(sea.wind_speed_mps, sea.fetch_m);
        case SpectrumKind::Omega2:
            return Omega2(sea.wind_speed_mps);
        case SpectrumKind::Phillips:
            return Phillips(sea.wind_speed_mps);
        case SpectrumKind::File:
            break;
    }
    if (!sea.measured) {
        throw std::invalid_argument(
            "spectrum = \"file\" without a measured spectrum: give spectrum_file and spectrum_time");
    }
    return MeasuredEnergy(*sea.measured);
}

SpreadingLaw spreading_law(const SeaState& sea, double peak_wavenumber, const Dispersion& dispersion) {
    if (sea.spectrum == SpectrumKind::File)
        return MeasuredSpreading(*sea.measured, sea.wind_direction_deg * kRadiansPerDegree);
    const double peak_omega = dispersion.omega(peak_wavenumber);
    switch (sea.spreading) {
        case SpreadingKind::DonelanBanner:
            return DonelanBannerSpreading{peak_omega};
        case SpreadingKind::Cosine:
            return CosineSpreading{};
        case SpreadingKind::Elfouhaily:
            return ElfouhailySpreading(sea.wind_speed_mps, elfouhaily::phase_speed(peak_wavenumber));
        case SpreadingKind::Hasselmann:
            break;
    }
    // Measured in deep water, and used with its wave age there: with the slow waves of a puddle U/cp would be so
    // large that the sea would be isotropic.
    const double deep_peak_speed = peak_omega / Dispersion{}.wavenumber(peak_omega);
    return HasselmannSpreading(peak_omega, sea.wind_speed_mps / deep_peak_speed);
}

// The law of a sea under the same wind whose peak's frequency is `ratio` of this one's. What was measured stays as it is.
EnergyLaw aged(const EnergyLaw& law, double ratio) {
    struct Aged {
        double ratio;
        EnergyLaw operator()(PiersonMoskowitz law) const { return law.omega0 *= ratio, law; }
        EnergyLaw operator()(JonswapShape law) const { return law.omega_p *= ratio, law; }
        EnergyLaw operator()(Tma law) const { return law.jonswap.omega_p *= ratio, law; }
        EnergyLaw operator()(const Elfouhaily& law) const { return law.aged(ratio); }
        EnergyLaw operator()(Omega2 law) const { return law.cutoff_omega *= ratio, law; }
        EnergyLaw operator()(Phillips law) const { return law.length_m /= ratio * ratio, law; }
        EnergyLaw operator()(const SwellEnergy& law) const { return law; }
        EnergyLaw operator()(const MeasuredEnergy& law) const { return law; }
        EnergyLaw operator()(const RainRings& law) const { return law; }
    };
    return std::visit(Aged{ratio}, law);
}

}  // namespace

double peak_wavenumber(const EnergyLaw& law, const Dispersion& dispersion) {
    return std::visit(
        [&]<class Law>(const Law& energy) {
            if constexpr (InWavenumber<Law>) {
                return energy.peak_wavenumber();
            } else {
                return dispersion.wavenumber(energy.peak_omega());
            }
        },
        law);
}

WaveSystem WaveSystem::swell(const Swell& swell, const Dispersion& dispersion) {
    const SwellEnergy energy(swell);
    return {energy, SwellSpreading{energy.omega_p}, swell.direction_deg * kRadiansPerDegree, dispersion};
}

WaveSystem WaveSystem::rings(double rain_mm_h, const Dispersion& dispersion) {
    return {RainRings(rain_mm_h), IsotropicSpreading{}, 0.0, dispersion};
}

std::vector<WaveSystem> WaveSystem::with_short_waves(const SeaState& sea, const EnergyLaw& energy,
                                                     const Dispersion& dispersion) {
    const bool is_measured = sea.spectrum == SpectrumKind::File,
               is_by_height = sea.growth == GrowthLaw::Height;
    const double peak = pelagic::peak_wavenumber(energy, dispersion);
    const SpreadingLaw spreading = spreading_law(sea, peak, dispersion);
    const double wind_direction = sea.wind_direction_deg * kRadiansPerDegree;
    const double direction = is_measured ? 0.0 : wind_direction;  // a buoy's directions are absolute
    const auto waves = [&](const Edges& edges) {
        return WaveSystem(energy, spreading, direction, dispersion, edges);
    };

    // One system, unless its long waves alone are changed.
    const bool is_turned = sea.directionality != 1.0;
    const bool is_elfouhaily = sea.spectrum == SpectrumKind::Elfouhaily &&
                               sea.spreading == SpreadingKind::Elfouhaily &&
                               (is_by_height || !(is_turned || sea.significant_height_m));
    if (sea.short_waves == ShortWaves::None || sea.wind_speed_mps < kCalmWind || is_elfouhaily)
        return {waves({}).directed(sea.directionality)};

    Edge join{kJoinFrom * peak, 0.0};
    if (const auto* buoy = std::get_if<MeasuredEnergy>(&energy))
        join.from = std::max(join.from, dispersion.wavenumber(buoy->edge_omegas().back()));
    join.to = kJoinWidth * join.from;
    std::vector<WaveSystem> systems;
    if (is_by_height || !is_turned) {
        systems = {waves({.upper = join}).directed(sea.directionality)};
    } else {
        const Edge end{kTurnedFrom * peak, kTurnedTo * peak};
        systems = {waves({.upper = end}).directed(sea.directionality), waves({.lower = end, .upper = join})};
    }
    if (!(systems.front().m0() > 0.0)) return {};  // a buoy's hour without waves is a calm, whatever the wind

    const double age = sea.wind_speed_mps * dispersion.omega(peak) / kGravity;  // U/cp, in deep water
    const auto* whole = std::get_if<Elfouhaily>(&energy);
    const Elfouhaily tail =
        whole ? *whole : Elfouhaily(sea.wind_speed_mps, Elfouhaily::Age{std::clamp(age, kOldest, kYoungest)});
    WaveSystem ripples(tail, ElfouhailySpreading(sea.wind_speed_mps, tail.c_p), wind_direction, dispersion,
                       {.lower = join});
    ripples.peak_wavenumber_ = peak;
    systems.push_back(is_by_height ? ripples.directed(sea.directionality) : std::move(ripples));
    return systems;
}

std::vector<WaveSystem> WaveSystem::sea(const SeaState& sea, const Dispersion& dispersion) {
    if (sea.spectrum != SpectrumKind::File && sea.wind_speed_mps < kCalmWind) return {};
    const auto m0_of = [](double height_m) { return height_m * height_m / 16.0; };
    const bool is_by_height = sea.growth == GrowthLaw::Height;
    const EnergyLaw energy = energy_law(sea);
    std::vector<WaveSystem> systems = with_short_waves(sea, energy, dispersion);
    if (systems.empty()) return {};

    // Of the longer ones, and of the wind's short ones.
    const auto totals = [&] {
        std::array<double, 2> m0{}, mss{};
        for (std::size_t i = 0; i < systems.size(); ++i) {
            const std::size_t part = i > 0 && i + 1 == systems.size() ? 1 : 0;
            m0[part] += systems[i].m0();
            mss[part] += systems[i].mss();
        }
        return std::pair(m0, mss);
    };
    const double glitter = CoxMunk::at_wind(sea.wind_speed_mps).total;
    auto [m0, mss] = totals();
    double ripples = 1.0;
    const double glittered = std::min(1.0, sea.wind_speed_mps / kGlittered);
    const auto bounded = [&](double gain) {
        return std::pow(std::clamp(gain, kLeastRipples, 1.0 / kLeastRipples), glittered);
    };
    // Who asks for Elfouhaily's spectrum has his short waves as they are.
    const bool is_theirs = is_by_height || std::holds_alternative<Elfouhaily>(energy);
    if (!is_theirs && mss[1] > 0.0) ripples = bounded((glitter - mss[0]) / mss[1]);
    const double own = m0[0] + ripples * m0[1];
    double wanted = own;
    if (sea.significant_height_m) {
        wanted = m0_of(*sea.significant_height_m);
        if (!is_by_height && wanted > 0.0 && own > 0.0) {
            // A sea of another height is one of another age. Its ripples and its longer waves have two numbers to hold.
            const double youngest =
                std::sqrt(std::max(1.0, kShortestPeak / pelagic::peak_wavenumber(energy, dispersion)));
            const double ratio = std::min(std::pow(wanted / own, -kPeakByEnergy), youngest);
            systems = with_short_waves(sea, aged(energy, ratio), dispersion);
            std::tie(m0, mss) = totals();
            if (!is_theirs && mss[1] > 0.0)
                ripples = bounded((m0[0] * glitter - mss[0] * wanted) / (m0[0] * mss[1] - mss[0] * m0[1]));
        }
    }
    wanted = std::min(wanted, m0_of(kMostHeightOverDepth * sea.depth_m));
    if (wanted != own) {
        // The wind's short waves stay as they are, unless they alone are higher than half of what is wanted.
        if (m0[1] > 0.0) ripples = std::min(ripples, 0.5 * wanted / m0[1]);
        for (std::size_t i = 0; i == 0 || i + 1 < systems.size(); ++i)
            systems[i] = systems[i].scaled((wanted - ripples * m0[1]) / m0[0]);
    }
    if (m0[1] > 0.0 && ripples != 1.0) systems.back() = systems.back().scaled(ripples);
    return systems;
}

WaveSystem WaveSystem::scaled(double energy_factor) const {
    WaveSystem out = *this;
    out.scale_ *= energy_factor;
    out.m0_ *= energy_factor;
    out.mss_ *= energy_factor;
    return out;
}

WaveSystem WaveSystem::gained(const BandGains& gains, const Dispersion& dispersion) const {
    WaveSystem out = *this;
    out.gains_ = gains;
    out.find_energy(dispersion);
    return out;
}

WaveSystem WaveSystem::rained_on(const RainDamping& rain, const Dispersion& dispersion) const {
    WaveSystem out = *this;
    if (may_be_swell()) return out;
    out.rain_ = rain;
    out.find_energy(dispersion);
    return out;
}

WaveSystem WaveSystem::directed(double directionality) const {
    WaveSystem out = *this;
    out.directionality_ = directionality;
    return out;
}

double Edge::rise(double k) const {
    const double x = std::clamp(std::log(k / from) / std::log(to / from), 0.0, 1.0);
    return x * x * x * (10.0 - x * (15.0 - 6.0 * x));
}

double Edges::share(double k) const {
    return (lower ? lower->rise(k) : 1.0) * (upper ? 1.0 - upper->rise(k) : 1.0);
}

WaveSystem::WaveSystem(EnergyLaw energy, SpreadingLaw spreading, double direction,
                       const Dispersion& dispersion, Edges edges)
    : energy_(std::move(energy)), spreading_(std::move(spreading)), direction_(direction), edges_(edges) {
    peak_wavenumber_ = pelagic::peak_wavenumber(energy_, dispersion);
    find_energy(dispersion);
}

void WaveSystem::find_energy(const Dispersion& dispersion) {
    panels_.clear();
    kinks_.clear();
    m0_ = mss_ = 0.0;
    find_panels(dispersion);
    const auto& rule = GaussLegendre<8>::rule();
    for (std::size_t i = 1; i < panels_.size(); ++i) {
        const auto moment = [&](int power) {
            return rule.integrate(panels_[i - 1], panels_[i], [&](double k) {
                return this->energy(wave_point(dispersion, k)) * (power == 0 ? 1.0 : k * k);
            });
        };
        m0_ += moment(0);
        mss_ += moment(2);
    }
}

double WaveSystem::energy(const WavePoint& point) const {
    const bool counted = !panels_.empty() && point.k >= panels_.front() && point.k <= panels_.back();
    return counted ? law_energy(point) : 0.0;
}

double WaveSystem::law_energy(const WavePoint& point) const {
    double counted = scale_ * edges_.share(point.k);
    if (!gains_.empty()) counted *= gains_.of_energy(point.k);
    if (rain_) counted *= rain_->of_energy(point);
    if (!(counted > 0.0)) return 0.0;
    const double undamped = std::visit(
        [&]<class Law>(const Law& law) {
            if constexpr (InWavenumber<Law>) {
                return law.density_k(point.k);
            } else {
                return law.density(point.omega) * point.domega_dk;
            }
        },
        energy_);
    return counted * undamped * viscous_cutoff(point.k);
}

double WaveSystem::density(const WavePoint& point, double theta) const {
    return with_directed(spreading_, point, directionality_,
                         [&](const auto& shape) { return shape.density(theta - direction_); });
}

double WaveSystem::share(const WavePoint& point, double theta0, double theta1) const {
    return with_directed(spreading_, point, directionality_, [&](const auto& shape) {
        return shape.cumulative(theta1 - direction_) - shape.cumulative(theta0 - direction_);
    });
}

Harmonics WaveSystem::harmonics(const WavePoint& point) const {
    return with_directed(spreading_, point, directionality_,
                         [](const auto& shape) { return harmonics_of(shape); })
        .turned(direction_);
}

AngularShape WaveSystem::shape(const WavePoint& point) const {
    return with_shape(spreading_, point, [](const auto& shape) { return AngularShape(shape); });
}

void WaveSystem::find_panels(const Dispersion& dispersion) {
    // Log-spaced, narrower than the width of the narrowest peak (a swell's 0.14 in k), from far below the
    // peak to where the viscous cutoff has left 1e-16.
    constexpr double kRatio = 1.12;
    constexpr double kFarBelow = 1e-5;  // of the peak
    constexpr double kEnd = 6.0 * kViscousWavenumber;
    constexpr double kNegligible = 1e-15;  // of the largest k S_k: 300 panels of it are below 1e-12 of m0

    std::vector<double> grid;
    for (double k = peak_wavenumber_ * kFarBelow; k < kEnd * kRatio; k *= kRatio) grid.push_back(k);
    std::vector<double> content(grid.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
        content[i] = grid[i] * law_energy(wave_point(dispersion, grid[i]));
        largest = std::max(largest, content[i]);
    }
    if (!(largest > 0.0) || !std::isfinite(largest)) return;

    const auto counts = [&](double value) { return value > kNegligible * largest; };
    const auto first = std::find_if(content.begin(), content.end(), counts) - content.begin();
    const auto last = content.rend() - std::find_if(content.rbegin(), content.rend(), counts) - 1;
    const double lo = grid[std::max<std::ptrdiff_t>(first - 1, 0)];
    const double hi = grid[std::min<std::ptrdiff_t>(last + 1, std::ssize(grid) - 1)];

    // Where the laws are not smooth.
    std::vector<double> kinks;
    const auto kink_at = [&](double omega) { kinks.push_back(dispersion.wavenumber(omega)); };
    if (std::holds_alternative<JonswapShape>(energy_) || std::holds_alternative<Omega2>(energy_)) {
        kinks.push_back(peak_wavenumber_);
    } else if (const auto* tma = std::get_if<Tma>(&energy_)) {
        kinks.push_back(peak_wavenumber_);
        kink_at(1.0 / tma->sqrt_depth_over_g);
        kink_at(2.0 / tma->sqrt_depth_over_g);
    } else if (const auto* buoy = std::get_if<MeasuredEnergy>(&energy_)) {
        for (double omega : buoy->edge_omegas()) kink_at(omega);
    }
    for (const std::optional<Edge>& edge : {edges_.lower, edges_.upper})
        if (edge) kinks.insert(kinks.end(), {edge->from, edge->to});
    for (const double k : gains_.kinks()) kinks.push_back(k);
    if (const auto* hasselmann = std::get_if<HasselmannSpreading>(&spreading_)) {
        kink_at(hasselmann->meeting_omega());
    } else if (const auto* donelan = std::get_if<DonelanBannerSpreading>(&spreading_)) {
        for (double x : {0.56, 0.95, 1.6}) kink_at(x * donelan->omega_p);
    }

    const auto inside = [&](double k) { return k > lo && k < hi; };
    std::copy_if(kinks.begin(), kinks.end(), std::back_inserter(kinks_), inside);
    std::copy_if(grid.begin(), grid.end(), std::back_inserter(panels_), inside);
    panels_.insert(panels_.end(), kinks_.begin(), kinks_.end());
    panels_.insert(panels_.end(), {lo, hi});
    for (auto* list : {&kinks_, &panels_}) {
        std::sort(list->begin(), list->end());
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
}

}  // namespace pelagic
