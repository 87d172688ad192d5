// A sea whose numbers have keys: between two keys its energy goes from one sea's to the other's, with the same random phases.
//
// Each frame at which a number of the sea has a key is a key of the whole sea: the sea that the numbers give there. Between two, with the
// share w of the later one, Ψ = (1 − w) Ψ₀ + w Ψ₁: so variances, slopes and what footprints hide are linear in w, and a mode's amplitude
// is √((1 − w) a₀² + w a₁²). Blended amplitudes would lose half of the energy of waves that only one of the seas has.
// w goes by the sea's time, from key to key, on a straight line where all the sea's keys are linear, else as w = t² (3 − 2t), which
// stands still at keys: waves that grow from nothing grow as √w, and only so with a finite speed. The numbers themselves, which decide
// about foam, are those of the frame (scene_at()).
//
// Everything that must not change from frame to frame is planned for the keys' mean spectrum: wave vectors, cascades' sizes, trains and
// their directions, where breaking is filtered, and what pairs of waves add. The extent is the largest of the keys'.
//
// Choppiness, lean and the gain of the second order are no waves: seas are built with the largest of their keys, and each time has its
// share of that (DisplacementAt), which is the frame's number, with its rate.
//
// Over a depth that changes a mode keeps its wavenumber and has the frequency of the depth of now: its phase is ∫ ω(k, d(s)) ds, between two
// keys by Gauss's rule over points that the keys alone decide (DepthAt). As if until the first key, and from t = 0, there had been its depth.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/plan/prepared_scene.h"

namespace pelagic {

struct Weather {
    struct Key {
        int frame;
        double time_s;
        std::shared_ptr<const PreparedScene>
            sea;            // of plain numbers; keys that follow each other and are alike have one
        std::size_t waves;  // the first key with the same waves, whatever foam and gusts are
    };
    std::vector<Key> keys;  // by rising time
    bool is_smooth = false;

    // The seas of two neighbouring keys, and the share w of the second with its rate [1/s]. At a key, before the first, after the last
    // and between two that are alike: one sea twice, and both 0. So a corner of energies has no rate: the mean of its sides would be of three seas.
    struct Blend {
        std::size_t first = 0, second = 0;
        double share = 0.0, rate_per_s = 0.0;
    };
    Blend at(double t_s) const;
};

// What a time has of the displacement that its shot is planned with. Each with its rate.
struct DisplacementAt {
    double share = 1.0, share_per_s = 0.0;  // of the horizontal displacement: the choppiness over the plan's
    double pairs = 1.0, pairs_per_s = 0.0;  // of what pairs of waves add
    double lean_rad = 0.0, lean_rad_per_s = 0.0;  // Plan::lean_rad in its place
};
// None where no key of waves.choppiness, waves.lean_deg or waves.second_order changes it.
std::optional<DisplacementAt> displacement_at(const PreparedScene& shot, double t_s);

// Where sea.depth_m has keys: waves go on from what they have turned by at a key, by ω(k, depth) × time of each of these parts.
struct DepthAt {
    struct Part {
        double depth_m, time_s;
    };
    std::size_t key = 0;
    std::vector<Part> parts;
    double depth_m = 0.0, depth_mps = 0.0;  // of the time, and its rate
};
std::optional<DepthAt> depth_at(const PreparedScene& shot, double t_s);
// The parts of all the way to a key from the one before it.
std::vector<DepthAt::Part> depth_until(const PreparedScene& shot, std::size_t key);

// The frame that shows a time of the sea, also between two; shot.time_scale > 0.
double frame_at(const Shot& shot, double t_s);

// What a shot with weather is at a time: its plain numbers and its spectrum. Else the same as is given.
std::shared_ptr<const PreparedScene> prepared_at(const std::shared_ptr<const PreparedScene>& shot,
                                                 double t_s);

// What a frame's files depend on by the sea's keys, for fingerprints: the two seas that it is between, and how far; with a past of
// `past_s` all that it goes through, and `ahead_s` beyond. Empty without weather.
std::string weather_text(const PreparedScene& shot, double t_s, double past_s = 0.0, double ahead_s = 0.0);

// Of a valid scene whose sea has keys: prepare().
std::shared_ptr<const PreparedScene> prepare_weather(Scene scene);

}  // namespace pelagic
