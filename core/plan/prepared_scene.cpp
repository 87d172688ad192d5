#include "core/plan/prepared_scene.h"

#include <utility>

#include "core/plan/budget.h"

namespace pelagic {

std::shared_ptr<const PreparedScene> prepare(Scene scene) {
    DirectionalSpectrum spectrum(scene.sea, scene.waves.band_gains);
    const Extent extent = expected_extent(spectrum, Choppiness::asked(scene));
    PreparedScene prepared{std::move(scene), std::move(spectrum), extent};
    if (has_budget(prepared.scene.quality)) {
        MeshBudget budget = mesh_budget(prepared);
        prepared.scene = std::move(budget.scene);
        prepared.budget = std::move(budget.text);
        prepared.holds_budget = budget.holds;
    }
    return std::make_shared<const PreparedScene>(std::move(prepared));
}

}  // namespace pelagic
