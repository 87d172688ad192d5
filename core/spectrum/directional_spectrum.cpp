#include "core/spectrum/directional_spectrum.h"

#include <algorithm>
#include <limits>

namespace pelagic {

namespace {

// A system with less than this share of m0 says nothing about the sea's longest waves.
constexpr double kNotableShare = 0.02;

// What rain leaves of a sea's own waves. A height that is asked for is that in the rain.
void rain_on(std::vector<WaveSystem>& systems, const SeaState& sea, const Dispersion& dispersion) {
    const auto energy = [&] {
        double sum = 0.0;
        for (const WaveSystem& system : systems) sum += system.m0();
        return sum;
    };
    const double dry = energy();
    const RainDamping rain(sea.rain_mm_h, sea.wind_speed_mps);
    for (WaveSystem& system : systems) system = system.rained_on(rain, dispersion);
    const double left = energy();
    if (sea.significant_height_m && left > 0.0)
        for (WaveSystem& system : systems) system = system.scaled(dry / left);
}

}  // namespace

DirectionalSpectrum::DirectionalSpectrum(const SeaState& sea, std::span<const BandGain> gains)
    : dispersion_{sea.depth_m}, systems_(WaveSystem::sea(sea, dispersion_)) {
    if (sea.rain_mm_h > 0.0) rain_on(systems_, sea, dispersion_);
    for (const Swell& swell : sea.swell) {
        if (swell.height_m > 0.0)
            systems_.push_back(WaveSystem::swell(swell, dispersion_).directed(sea.directionality));
    }
    if (sea.rain_mm_h > 0.0) systems_.push_back(WaveSystem::rings(sea.rain_mm_h, dispersion_));
    if (!gains.empty())
        for (WaveSystem& system : systems_) system = system.gained(BandGains(gains), dispersion_);
    add_up();
}

DirectionalSpectrum::DirectionalSpectrum(std::span<const Part> parts, const Dispersion& dispersion)
    : dispersion_(dispersion) {
    for (const Part& part : parts)
        for (const WaveSystem& system : part.sea->systems()) systems_.push_back(system.scaled(part.share));
    add_up();
}

void DirectionalSpectrum::add_up() {
    std::erase_if(systems_, [](const WaveSystem& system) { return !(system.m0() > 0.0); });

    for (const WaveSystem& system : systems_) {
        m0_ += system.m0();
        panels_.insert(panels_.end(), system.panels().begin(), system.panels().end());
        kinks_.insert(kinks_.end(), system.kinks().begin(), system.kinks().end());
    }
    for (auto* list : {&kinks_, &panels_}) {
        std::sort(list->begin(), list->end());
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
}

double DirectionalSpectrum::omnidirectional(double k) const {
    if (!(k > 0.0)) return 0.0;
    const WavePoint point = wave_point(dispersion_, k);
    double sum = 0.0;
    for (const WaveSystem& system : systems_) sum += system.energy(point);
    return sum;
}

double DirectionalSpectrum::polar(double k, double theta) const {
    if (!(k > 0.0)) return 0.0;
    const WavePoint point = wave_point(dispersion_, k);
    double sum = 0.0;
    for (const WaveSystem& system : systems_) {
        const double energy = system.energy(point);
        if (energy > 0.0) sum += energy * system.density(point, theta);
    }
    return sum;
}

double DirectionalSpectrum::arc(double k, double theta0, double theta1) const {
    if (!(k > 0.0)) return 0.0;
    const WavePoint point = wave_point(dispersion_, k);
    double sum = 0.0;
    for (const WaveSystem& system : systems_) {
        const double energy = system.energy(point);
        if (energy > 0.0) sum += energy * system.share(point, theta0, theta1);
    }
    return sum;
}

bool DirectionalSpectrum::is_calm() const {
    return std::ranges::all_of(systems_, &WaveSystem::is_rings);
}

double DirectionalSpectrum::peak_wavenumber() const {
    if (is_calm()) return kCalmPeakWavenumber;
    return std::ranges::max_element(
               systems_, {}, [](const WaveSystem& system) { return system.is_rings() ? 0.0 : system.m0(); })
        ->peak_wavenumber();
}

double DirectionalSpectrum::longest_peak_wavenumber() const {
    if (is_calm()) return kCalmPeakWavenumber;
    double m0 = 0.0, longest = std::numeric_limits<double>::infinity();
    for (const WaveSystem& system : systems_) m0 += system.is_rings() ? 0.0 : system.m0();
    for (const WaveSystem& system : systems_)
        if (!system.is_rings() && system.m0() >= kNotableShare * m0)
            longest = std::min(longest, system.peak_wavenumber());
    return longest;
}

}  // namespace pelagic
