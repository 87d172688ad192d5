// Calm and rough places (waves.masks): the sea's amplitude as a function of the place at rest, m(x), the product of all masks.
//
// The surface is η = m h, its displacement m D, both of the sea without masks. So slopes are m ∇h + h ∇m, the gradient of the displacement
// likewise (∂Dx/∂y and ∂Dy/∂x then differ), velocities m times theirs; of what a pixel hides slopes have m² Σ + (∇m ⊗ ∇m) m0, displacement
// gradients m² V. Whitecaps keep their threshold: a calm has none, nor had it any before. m is C¹, so that normals are continuous.
//
// A picture's share is a sum of quadratic B-splines (Schoenberg 1946): of its means over cells at least half an edge and a pixel wide, and of
// nothing round it. They are positive and add up to 1, so it stays within 0 … 1; one cell's difference is 1 at most, so along each side of
// the picture, in cells of h, |∂m| ≤ |gain − 1|/h ≤ 2 |gain − 1|/edge and |∂²m| ≤ 2 |gain − 1|/h² ≤ 8 |gain − 1|/edge². A step is two cells
// wide, half of it on either side of the border.
//
// Ripples, waves below 50 cm, have a gain of their own, r: what kSlick_m's footprint lets through stays, of the rest r times its
// amplitude is left. Its gradient isn't counted: ripples are millimetres high.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/number.h"
#include "core/plan/coast.h"
#include "core/plan/filter.h"
#include "core/spectrum/spectral_moments.h"
#include "pelagic/scene.h"

namespace pelagic {

#include "core/plan/masks.inl"

// The footprint through which a slick's waves pass [m]: whole from 50 cm on, none below 25 cm. A level of views, all of which are powers of
// two; the mean square slope that it leaves is that of Cox and Munk's slicks (1954), 0.008 + 1.56e-3 U, within 0.002 from 5 to 14 m/s.
inline constexpr double kSlick_m = 0.125;

struct MasksPlan {
    struct Mask {
        std::size_t number = 0;  // in waves.masks
        glm::dvec2 middle_m{0.0}, along{1.0, 0.0};
        glm::dvec2 inner_per_m{0.0}, outer_per_m{0.0};  // one over an ellipse's half axes
        std::shared_ptr<const MaskCells> cells{};       // of a picture, in the ellipse's place
        glm::dvec2 cells_per_m{0.0};
        double whole = 1.0;    // how much of a picture smaller than its edge is left where it holds whole
        double reach_m = 0.0;  // from the middle: beyond it there is none
        double waves = 1.0, ripples = 1.0, foam = 1.0;
        // The gain of waves where it holds most, about strongest_m, which may be the least or the largest. A coast is on both sides of 1:
        // strongest is then its least, and other_way its largest, of waves that rise before they break.
        double strongest = 1.0, other_way = 1.0;
        glm::dvec2 strongest_m{0.0};
    };
    std::vector<Mask> masks;  // those that change something, and last the coast, if tiles feel one
    std::shared_ptr<const CoastSurf<double>> surf{};  // of that coast
    bool changes_waves = false, calms_ripples = false, calms_foam = false;
    bool has_strips = false;  // of vessels, which calm ripples as well (core/plan/wake_strip.h)

    // The least and the largest gain of waves in a rectangle, or beyond.
    struct Gains {
        double least = 1.0, largest = 1.0;
    };
    Gains gains_in(glm::dvec2 min_m, glm::dvec2 max_m) const;
    double largest() const;
    MaskGains<double> at(glm::dvec2 place_m) const;
    std::size_t picture_texels() const;  // in the cells of pictures
    std::size_t coast_bytes() const;
    bool is_coast(const Mask& mask) const { return surf && &mask == &masks.back(); }
};

// A picture's share at u, v [m] from its middle, along its width and its height.
template <class T>
MaskShare<T> picture_share(const MaskCells& cells, T u, T v, T per_m_u, T per_m_v, T whole) {
    const T column = u * per_m_u + T(0.5) * static_cast<T>(cells.count.x),
            row = v * per_m_v + T(0.5) * static_cast<T>(cells.count.y);
    // Also where it is no number.
    if (!(column > T(-1) && row > T(-1) && column < static_cast<T>(cells.count.x + 1) &&
          row < static_cast<T>(cells.count.y + 1)))
        return {};
    const T first_column = std::floor(column), first_row = std::floor(row);
    const MaskWeights<T> along = mask_weights(column - first_column - T(0.5)),
                         across = mask_weights(row - first_row - T(0.5));
    const std::array<T, 3> along_weights{along.before, along.here, along.after},
        along_rates{along.before_rate, along.here_rate, along.after_rate},
        across_weights{across.before, across.here, across.after},
        across_rates{across.before_rate, across.here_rate, across.after_rate};
    MaskShare<T> at{};
    for (int j = 0; j < 3; ++j) {
        const int y = static_cast<int>(first_row) + j - 1;
        if (y < 0 || y >= cells.count.y) continue;
        T sum = T(0), rate = T(0);
        for (int i = 0; i < 3; ++i) {
            const int x = static_cast<int>(first_column) + i - 1;
            if (x < 0 || x >= cells.count.x) continue;
            const T share =
                whole *
                static_cast<T>(
                    cells.shares[static_cast<std::size_t>(y) * static_cast<std::size_t>(cells.count.x) +
                                 static_cast<std::size_t>(x)]);
            sum += along_weights[static_cast<std::size_t>(i)] * share;
            rate += along_rates[static_cast<std::size_t>(i)] * share;
        }
        at.share += across_weights[static_cast<std::size_t>(j)] * sum;
        at.x += across_weights[static_cast<std::size_t>(j)] * rate;
        at.y += across_rates[static_cast<std::size_t>(j)] * sum;
    }
    at.x *= per_m_u;
    at.y *= per_m_v;
    return at;
}

// None where no mask changes anything. With a spectrum, of the scene: also how its tiles feel a coast (core/plan/coast.h).
std::optional<MasksPlan> plan_masks(const Scene& scene);
std::optional<MasksPlan> plan_masks(const Scene& scene, const DirectionalSpectrum& spectrum);

// How much higher than it is shown a hero stands in the sea without masks, at most kMostHeroRaise; and how the gain of waves changes there
// over itself [1/m]: m η is level where η is not.
struct HeroMask {
    double raise = 1.0;
    glm::dvec2 change_per_m{0.0};
};
inline constexpr double kMostHeroRaise = 10.0;
HeroMask hero_mask(const std::optional<MasksPlan>& masks, const HeroWave& hero);

// The slopes that a slick's footprint hides, in expectation; of other moments there are none.
SpectralMoments slick_moments(const DirectionalSpectrum& spectrum, const FootprintFilter& filter);

}  // namespace pelagic
