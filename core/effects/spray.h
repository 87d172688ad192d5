// How much spray a place has: the law's (core/plan/spray.h) times what breaks there over what breaks on average, for young spray now,
// for what the wind has blown off where it came from.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <span>

#include "core/evaluate/places.h"
#include "core/plan/spray.h"
#include "core/waves/sea.h"

namespace pelagic {

// The share of the sea's area that breaks now, in expectation: the mean of evaluate()'s coverage, without what
// earlier breaking has left (core/effects/foam_history.h). 0 where no wave breaks. In the mean wind.
template <class T>
double mean_breaking(const Sea<T>& sea);

// Spray of one moment: how much places have at the heights of the ribbons, over the sea's mean.
//
// Spray of some age was over a crest that breaks: the wind has carried it on, the crest has followed. So a place has what breaks now so far
// upwind as wind and crest have come apart, of some ages together: ribbons that begin at crests. The older is the higher: ribbons lean
// downwind. They fall slowly: where the sea falls off in front of a crest they stay up. A noise of three octaves tears them, at each height its own: drawn out along the wind, moving with it; it also shifts from where spray
// came. It is lognormal, and its mean is exactly 1 at every place; where a cell doesn't resolve it it is 1. All of that is known
// from place and time.
//
// monahan-1986 has spray over what breaks, whole: as in the first edition. That is the share at height 0.
class SprayVeil {
  public:
    // Of a frame. Empty without spray, and where no wave breaks.
    template <class T>
    explicit SprayVeil(const Frame<T>& frame);

    bool empty() const { return !(mean_breaking_ > 0.0); }
    const SprayLaw& law() const { return law_; }
    bool is_torn() const { return law_.is_torn(); }

    // Writes the places' shares at the three heights, each 1 on average, and how far up ribbons stay there [m] (SprayRibbons). breaking, displacement_m: the
    // query's there. mean_cell_m: the side of a place's cell. The query holds Product::Breaking and Displacement, and places are those of the world, as
    // evaluate_at() takes them. On all threads of the calling arena.
    template <class T>
    void shares(const PreparedQuery<T>& query, const Points<T>& places, std::span<const T> breaking,
                std::span<const glm::vec<3, T>> displacement_m, std::span<const double> mean_cell_m,
                std::span<glm::dvec3> shares, std::span<double> lifts_m) const;

    // At height 0, 1 or 2, at a place of the world: the noise, mean 1, and how far spray there has strayed [m].
    struct Torn {
        double factor = 1.0;
        glm::dvec2 strayed_m{0.0};
    };
    Torn torn(int height, glm::dvec2 place_m, double cell_m) const;

    // What a place would have at the surface that breaks whole, over the sea's mean.
    double whole() const { return 1.0 / mean_breaking_; }
    glm::dvec2 downwind() const { return downwind_; }
    double wind_speed_mps() const { return wind_mps_; }

    // Two generations of a noise that take turns: squares of weights add up to 1, and one that has none is replaced. A loop has a whole number of
    // them.
    struct Generation {
        double age_s = 0.0, weight = 1.0;
        std::uint32_t name = 0;  // random, less than 2^24
    };
    std::array<Generation, 2> generations() const;

  private:
    Torn drawn(int height, int octave, glm::dvec2 place_m, double time_s, double strength) const;

    SprayLaw law_;
    double mean_breaking_ = 0.0;  // 0: empty
    double wind_mps_ = 0.0, time_s_ = 0.0, loop_s_ = 0.0;
    std::optional<double> wind_way_m_;  // how far it has blown by then, where it changes
    glm::dvec2 downwind_{1.0, 0.0};
    std::uint64_t seed_ = 0;
};

}  // namespace pelagic
