#include "core/scene/shot_text.h"

#include "core/scene/editions.h"
#include "core/scene/keys.h"

namespace pelagic {

std::string shot_text(const Scene& scene) {
    Scene nameless = scene_of_edition(scene.shot.edition);
    nameless.shot.edition = 0;
    return shot_text(scene, nameless);
}

std::string shot_text(const Scene& scene, const Scene& base) {
    std::string text;
    for (const KeyTable& table : key_tables()) {
        std::string lines;
        for (const Key& key : table.keys) {
            const std::string value = value_text(key, value_of(scene, key));
            if (!value.empty() && value != value_text(key, value_of(base, key)))
                lines += key.name + " = " + value + '\n';
        }
        if (!lines.empty()) text += (text.empty() ? "[" : "\n[") + table.name + "]\n" + lines;
    }
    return text;
}

}  // namespace pelagic
