#include "core/plan/prepared_scene.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "core/scene/budget.h"

namespace pelagic {

std::shared_ptr<const PreparedScene> prepare(Scene scene) {
    if (has_budget(scene.quality))
        throw std::invalid_argument(
            std::string(scene.quality.max_error ? "quality.max_error" : "quality.frame_ms") +
            " isn't resolved yet: a plan takes settings, which a host chooses for a budget before it (pelagic explain "
            "says which)");
    DirectionalSpectrum spectrum(scene.sea, scene.waves.band_gains);
    const Extent extent = expected_extent(spectrum, Choppiness::asked(scene));
    return std::make_shared<const PreparedScene>(
        PreparedScene{std::move(scene), std::move(spectrum), extent});
}

}  // namespace pelagic
