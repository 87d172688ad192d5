// Which wave trains a scene has: how many, and between which wavelengths.
//
// The bins' edges are a geometric progression (as the trains of Bruneton, Neyret, Holzschuch 2010, §7.1): the range
// from longest_m down to shortest_m is cut into `count` bins of equal ratio. A train has the energy of its bin and the
// mean wavenumber there, weighted by energy: in the middle of a wide bin, where few trains have much to stand for, it
// would be steeper than the waves that it stands for. What the spectrum holds outside the range is not sampled: it is
// integrated and kept as variance (core/waves/trains.h), as is the slope that a bin has and its train hasn't, so that
// nothing is missing, however the range is chosen.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "core/plan/prepared_scene.h"

namespace pelagic {

// For each hero of a sea. Far from all of them the trains are 1/√(2 kHeroTrains) of a hero's height, rms.
inline constexpr int kHeroTrains = 200;
// Of the sea's energy: the waves that count in a hero's height, and those of which heroes are made and that are level at their tops.
// Shorter ones ride on them.
inline constexpr double kHeroHeightEnergy = 0.9998, kHeroEnergy = 0.9975;

// The wavenumbers where they end [rad/m].
struct HeroEnds {
    double height = 0.0, level = 0.0;
};

// On a coast (core/waves/coast.h): the height of a train over the depth.
inline constexpr double kMostCoastHeight = 0.78;

struct TrainsPlan {
    int count = 0;
    double longest_m = 0.0, shortest_m = 0.0;  // the bins' outer edges
    int below_pixel = 0;  // trains too short for the finest footprint: they are never resolved

    // Bin i, 0 … count − 1, longest first: its longer edge (edge_m(count) is shortest_m), and its train.
    double edge_m(int i) const;
    std::vector<double> wavelengths_m{};

    int hero_trains = 0;   // besides those: of waves.heroes
    HeroEnds hero_ends{};  // up to where heroes know the sea
    // Whose spectrum's directions they have: of a shot with weather (core/plan/weather.h); null: the sea's own.
    std::shared_ptr<const PreparedScene> shot{};

    // With waves.coast: cells of the depths that they are marched over, and how many of the trains, the longest, feel them.
    glm::ivec2 coast_cells{0};
    int coast_trains = 0;
    std::size_t coast_bytes(bool double_precision) const;

    // What a Sea holds of them (Trains<T>, core/waves/trains.h).
    std::size_t sea_bytes(bool double_precision) const;
};

// The scene's own range, or the spectrum's where it says nothing:
//   longest   all but 0.1 % of m0 is shorter;
//   shortest  2 cm, the paper's, or shorter so that ten trains (half of them, where there are
//             fewer than twenty) are below the finest pixel's Nyquist wavelength: the fewest whose
//             slopes add up to a Gaussian (§3.2). With explicit cascades, which hold everything shorter: the longest wave of the largest
//             tile's grid.
// A scene that gives one end keeps it, and the other stays a factor of ten away. A given range may leave
// fewer than ten trains, or none, below the pixel: then what a pixel hides is mostly the integrated
// remainder. finest_footprint_m ≥ 0, of all queries; 0 (nothing is filtered) or infinite: nobody looks, 2 cm.
// With the fft model only heroes have trains: count is 0, and both edges are infinite, so that all of the spectrum is outside.
// None: the scene has neither.
std::optional<TrainsPlan> resolve_trains(const PreparedScene& prepared, double finest_footprint_m);

}  // namespace pelagic
