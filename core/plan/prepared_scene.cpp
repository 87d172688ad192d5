#include "core/plan/prepared_scene.h"

#include <utility>

namespace pelagic {

std::shared_ptr<const PreparedScene> prepare(Scene scene) {
    DirectionalSpectrum spectrum(scene.sea, scene.waves.band_gains);
    const Extent extent = expected_extent(spectrum, scene.waves.choppiness);
    return std::make_shared<const PreparedScene>(
        PreparedScene{std::move(scene), std::move(spectrum), extent});
}

}  // namespace pelagic
