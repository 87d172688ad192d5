#include "core/plan/masks.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "core/base/constants.h"
#include "core/plan/effects.h"
#include "core/scene/keys.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

// Puts a picture in the ellipse's place.
void hold_picture(MasksPlan::Mask& made, const WaveMask& mask, const MaskPicture& picture) {
    const glm::dvec2 side_m(mask.length_m, mask.width_m);
    const double finest_m = 0.5 * mask.edge_m;
    made.cells = picture.cells(glm::ivec2(glm::min(side_m / finest_m, glm::dvec2(picture.size()))));
    const glm::dvec2 count(made.cells->count), cell_m = glm::max(side_m / count, finest_m);
    made.cells_per_m = 1.0 / cell_m;
    made.whole = side_m.x / (count.x * cell_m.x) * side_m.y / (count.y * cell_m.y);
    made.reach_m = glm::length((0.5 * count + 1.0) * cell_m);
    made.strongest = 1.0 + (mask.waves - 1.0) * made.whole * static_cast<double>(made.cells->most);
    const glm::dvec2 from = (glm::dvec2(made.cells->most_at) + 0.5 - 0.5 * count) * cell_m;
    made.strongest_m += from.x * made.along + from.y * glm::dvec2(-made.along.y, made.along.x);
}

}  // namespace

std::optional<MasksPlan> plan_masks(const Scene& scene) {
    MasksPlan plan;
    for (std::size_t i = 0; i < scene.waves.masks.size(); ++i) {
        const WaveMask& mask = scene.waves.masks[i];
        if (mask.waves == 1.0 && mask.ripples == 1.0 && mask.foam == 1.0) continue;
        const MaskPicture* picture = picture_of(scene.waves, mask);
        if (mask.picture && !picture)
            throw std::invalid_argument("a mask's picture, " + quoted_text(*mask.picture) + ", wasn't read");
        const double turn = mask.direction_deg * kPi / 180.0;
        const glm::dvec2 half_m(0.5 * mask.length_m, 0.5 * mask.width_m);
        plan.masks.push_back({.number = i,
                              .middle_m = {mask.east_m, mask.north_m},
                              .along = {std::cos(turn), std::sin(turn)},
                              .inner_per_m = 1.0 / half_m,
                              .outer_per_m = 1.0 / (half_m + mask.edge_m),
                              .reach_m = std::max(half_m.x, half_m.y) + mask.edge_m,
                              .waves = mask.waves,
                              .ripples = mask.ripples,
                              .foam = mask.foam,
                              .strongest = mask.waves,
                              .strongest_m = {mask.east_m, mask.north_m}});
        if (picture) hold_picture(plan.masks.back(), mask, *picture);
        plan.changes_waves = plan.changes_waves || mask.waves != 1.0;
        plan.calms_ripples = plan.calms_ripples || mask.ripples != 1.0;
        plan.calms_foam = plan.calms_foam || mask.foam != 1.0;
    }
    // Where ripples break they aren't calmed.
    plan.has_strips = !scene.waves.vessels.empty() &&
                      !(is_on(Effect::Whitecaps, scene) && scene.effects.breaking_from_m < 2.0 * kSlick_m);
    plan.calms_ripples = plan.calms_ripples || plan.has_strips;
    if (plan.masks.empty() && !plan.has_strips) return std::nullopt;
    return plan;
}

std::optional<MasksPlan> plan_masks(const Scene& scene, const DirectionalSpectrum& spectrum) {
    std::optional<MasksPlan> plan = plan_masks(scene);
    add_coast_mask(plan, scene, spectrum);
    return plan;
}

MasksPlan::Gains MasksPlan::gains_in(glm::dvec2 min_m, glm::dvec2 max_m) const {
    Gains gains;
    for (const Mask& mask : masks) {
        const glm::dvec2 low = min_m - mask.middle_m, high = max_m - mask.middle_m;
        const double away = std::max({low.x, low.y, -high.x, -high.y});
        if (away > mask.reach_m) continue;
        gains.least *= std::min({mask.strongest, mask.other_way, 1.0});
        gains.largest *= std::max({mask.strongest, mask.other_way, 1.0});
    }
    return gains;
}

double MasksPlan::largest() const {
    double largest = 1.0;
    for (const Mask& mask : masks) {  // with all that may overlap it
        double together = std::max({mask.strongest, mask.other_way, 1.0});
        for (const Mask& other : masks)
            if (&other != &mask &&
                glm::distance(other.middle_m, mask.middle_m) < other.reach_m + mask.reach_m)
                together *= std::max({other.strongest, other.other_way, 1.0});
        largest = std::max(largest, together);
    }
    return largest;
}

MaskGains<double> MasksPlan::at(glm::dvec2 place_m) const {
    MaskGains<double> gains{1.0, 0.0, 0.0, 1.0, 1.0};
    for (const Mask& mask : masks) {
        const glm::dvec2 from = place_m - mask.middle_m;
        if (mask.cells) {
            const glm::dvec2 beside(glm::dot(from, mask.along),
                                    from.y * mask.along.x - from.x * mask.along.y);
            gains = with_share(gains,
                               picture_share(*mask.cells, beside.x, beside.y, mask.cells_per_m.x,
                                             mask.cells_per_m.y, mask.whole),
                               mask.along.x, mask.along.y, mask.waves, mask.ripples, mask.foam);
            continue;
        }
        gains = with_mask(gains, from.x, from.y, mask.along.x, mask.along.y, mask.inner_per_m.x,
                          mask.inner_per_m.y, mask.outer_per_m.x, mask.outer_per_m.y, mask.waves,
                          mask.ripples, mask.foam);
    }
    return gains;
}

std::size_t MasksPlan::picture_texels() const {
    std::size_t texels = 0;
    for (const Mask& mask : masks)
        if (mask.cells && !is_coast(mask)) texels += mask.cells->shares.size();
    return texels;
}

std::size_t MasksPlan::coast_bytes() const {
    if (!surf) return 0;
    return sizeof(float) * masks.back().cells->shares.size() +
           sizeof(double) * (surf->broken.size() + surf->deviation_m.size());
}

HeroMask hero_mask(const std::optional<MasksPlan>& masks, const HeroWave& hero) {
    if (!masks) return {};
    const MaskGains<double> at = masks->at({hero.east_m, hero.north_m});
    if (!(at.waves * kMostHeroRaise > 1.0)) return {.raise = kMostHeroRaise};
    return {.raise = 1.0 / at.waves, .change_per_m = glm::dvec2(at.x, at.y) / at.waves};
}

SpectralMoments slick_moments(const DirectionalSpectrum& spectrum, const FootprintFilter& filter) {
    constexpr int kSteps = 32;  // of the octave in which waves fade
    const double end = filter.cutoff(kSlick_m), begin = end * filter.n_min / filter.n_max;
    SpectralMoments hidden = moments(spectrum, end, std::numeric_limits<double>::infinity());
    const auto edge = [&](int i) { return begin * std::pow(end / begin, i / double{kSteps}); };
    for (int i = 0; i < kSteps; ++i) {
        const double low = edge(i), high = edge(i + 1),
                     weight = filter.weight(std::sqrt(low * high), kSlick_m);
        SpectralMoments part = moments(spectrum, low, high);
        hidden += part *= 1.0 - weight * weight;
    }
    return hidden.scale_gradients(0.0);
}

}  // namespace pelagic
