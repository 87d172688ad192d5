// The help of all keys. See shot.h.
#include "core/scene/keys.h"
#include "core/scene/text.h"
#include "plugin/shot/shot.h"

namespace pelagic {

namespace {

// "one of "a" "b"; not built yet: "b""
std::string accepted_text(const Key& key) {
    if (!key.is_built) {
        const bool has_value = !key.meanwhile.empty();
        return "not built yet: " + (has_value ? key.meanwhile : "only " + value_text(key, key.fallback));
    }
    std::string unbuilt;
    for (const KeyChoice& choice : key.choices)
        if (!choice.is_built) unbuilt += ' ' + quoted_text(choice.word);
    return key.accepted + (unbuilt.empty() ? "" : "; not built yet:" + unbuilt);
}

void describe(std::string& out, const Key& key) {
    const std::string fallback = key.is_required ? "" : value_text(key, key.fallback);
    out += "  " + key.path + (fallback.empty() ? "" : " = " + fallback) + '\n';
    out += "      " + key.help + (key.unit.empty() ? "" : " [" + key.unit + "]") + '\n';
    out += "      " + accepted_text(key) + '\n';
    if (key.feeds.any()) out += "      feeds " + text_of(key.feeds) + '\n';
    for (const Key& inner : key.entry_keys) describe(out, inner);
}

}  // namespace

std::string describe_keys() {
    std::string out =
        "preset\n      a named sea, first in the file; all below lies on top of it\n"
        "      a string, one of what pelagic presets lists\n";
    for (const KeyTable& table : key_tables()) {
        out += "\n[" + table.name + "]  " + table.help + '\n';
        for (const Key& key : table.keys) describe(out, key);
    }
    return out;
}

}  // namespace pelagic
