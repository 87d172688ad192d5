#include "core/plan/effects.h"

#include <array>
#include <cmath>

#include "core/plan/choppiness.h"
#include "core/plan/plan.h"

namespace pelagic {
namespace {

constexpr auto kNothing = [](const Scene&) { return EffectNeeds{}; };

const std::array kEffectTable = std::to_array<EffectRow>({
    {"horizontal displacement", [](const Scene& scene) { return Choppiness::asked(scene).built().moves(); },
     "waves.choppiness is 0, or too little to be seen",
     [](Scene& scene) {
         scene.waves.choppiness = 0.0;
         for (CascadeSize& cascade : scene.waves.cascades) cascade.choppiness.reset();
     },
     horizontal_fields, [] { return ProductSet(); }, kNothing},
    {"whitecaps", [](const Scene& scene) { return scene.effects.whitecaps; }, "effects.whitecaps is false",
     [](Scene& scene) {
         scene.effects.whitecaps = false;
         std::erase(scene.output.maps, MapKind::Whitecaps);  // would be a contradiction
         std::erase(scene.output.volumes, VolumeKind::Spray);
     },
     [] { return FieldSet(); }, [] { return foam_products() | products(Product::JacobianMoments); },
     kNothing},
    {"living foam", has_persistent_foam, "effects.foam_decay_s is 0, or there are no whitecaps",
     [](Scene& scene) { scene.effects.foam_decay_s = 0.0; }, [] { return FieldSet(); },
     [] { return ProductSet(); }, kNothing},
    {"foam structure",
     [](const Scene& scene) { return scene.effects.whitecaps && scene.effects.foam_structure > 0.0; },
     "effects.foam_structure is 0, or there are no whitecaps",
     [](Scene& scene) { scene.effects.foam_structure = 0.0; }, [] { return FieldSet(); },
     [] { return ProductSet(); }, kNothing},
    {"spray", [](const Scene& scene) { return scene.effects.spray && scene.effects.whitecaps; },
     "effects.spray is false, or there are no whitecaps",
     [](Scene& scene) {
         scene.effects.spray = false;
         std::erase(scene.output.volumes, VolumeKind::Spray);
     },
     [] { return FieldSet(); }, [] { return ProductSet(); }, kNothing},
    {"gusts",
     [](const Scene& scene) { return scene.sea.gust_strength > 0.0 && scene.sea.wind_speed_mps > 0.0; },
     "sea.gust_strength is 0, or there is no wind", [](Scene& scene) { scene.sea.gust_strength = 0.0; },
     [] { return FieldSet(); }, [] { return ProductSet(); }, kNothing},
});

}  // namespace

std::span<const EffectRow> effect_table() {
    return kEffectTable;
}

ProductSet products_gone(const Scene& scene, std::span<const EffectRow> table) {
    ProductSet gone;
    for (const EffectRow& row : table)
        if (!row.is_on(scene)) gone |= row.products_gone();
    return gone;
}

std::vector<double> times_before(const TimeLattice& lattice, double t_s) {
    // The division may round up to the next whole number: a time after t isn't one before it.
    double last = std::floor(t_s / lattice.step_s);
    if (last * lattice.step_s > t_s) last -= 1.0;
    std::vector<double> times_s;
    for (int i = 0; i < lattice.count; ++i) times_s.push_back((last - i) * lattice.step_s);
    return times_s;
}

}  // namespace pelagic
