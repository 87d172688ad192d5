#include "core/scene/editions.h"

#include <stdexcept>
#include <vector>

#include "core/scene/names.h"

namespace pelagic {

std::span<const EditionChange> edition_changes() {
    static const std::vector<EditionChange> all{
        {2, "sea.growth", std::string(word_of(GrowthLaw::Height))},
        {2, "waves.lean_deg", 0.0},
        {2, "waves.second_order", 0.0},
        {2, "waves.trains", std::int64_t{60}},
        {2, "light.turbidity", 3.0},
        {2, "effects.whitecap_law", std::string(word_of(WhitecapLaw::Monahan1980))},
        {2, "effects.spray_law", std::string(word_of(SpraySource::Monahan1986))},
        {3, "water.body", false},
        {3, "camera.white_balance_k", 6500.0},
    };
    return all;
}

const KeyValue& fallback_in(int edition, const Key& key) {
    for (const EditionChange& change : edition_changes())
        if (change.edition > edition && change.path == key.path) return change.before;
    return key.fallback;
}

Scene scene_of_edition(int edition) {
    Scene scene;
    scene.shot.edition = edition;
    for (const EditionChange& change : edition_changes())
        if (const Key& key = key_of(change.path); set_value(scene, key, fallback_in(edition, key)))
            throw std::logic_error("an edition's default that doesn't fit its key: " + key.path);
    return scene;
}

}  // namespace pelagic
