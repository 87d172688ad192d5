#include "core/scene/shot_text.h"

#include "core/scene/editions.h"
#include "core/scene/keys.h"

namespace pelagic {

std::string shot_text(const Scene& scene) {
    Scene nameless = scene_of_edition(scene.shot.edition);
    nameless.shot.edition = 0;
    return shot_text(scene, nameless);
}

namespace {

// The tables [[objects]] of a list, an entry's keys where they aren't what they are without.
std::string tables_text(const Key& list, const KeyValue& value) {
    std::string text;
    for (const KeyEntry& entry : std::get<std::vector<KeyEntry>>(value)) {
        text += (text.empty() ? "[[" : "\n[[") + list.path + "]]\n";
        for (std::size_t i = 0; i < entry.values.size(); ++i)
            if (const Key& key = list.entry_keys[i]; entry.values[i].second != key.fallback)
                text += key.name + " = " + value_text(key, entry.values[i].second) + '\n';
    }
    return text;
}

}  // namespace

std::string shot_text(const Scene& scene, const Scene& base) {
    std::string text;
    for (const KeyTable& table : key_tables()) {
        std::string lines;
        for (const Key& key : table.keys) {
            const KeyValue now = value_of(scene, key);
            const std::string value = value_text(key, now);
            if (value.empty() || value == value_text(key, value_of(base, key))) continue;
            if (!table.is_list())
                lines += key.name + " = " + value + '\n';
            else if (const std::string entries = tables_text(key, now); !entries.empty())
                text += (text.empty() ? "" : "\n") + entries;
            else  // none any more: before all tables
                text = key.name + " = []\n" + (text.empty() ? "" : "\n") + text;
        }
        if (!lines.empty()) text += (text.empty() ? "[" : "\n[") + table.name + "]\n" + lines;
    }
    return text;
}

}  // namespace pelagic
