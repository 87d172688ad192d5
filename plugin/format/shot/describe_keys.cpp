// The help of all keys. See shot.h.
#include "core/scene/editions.h"
#include "core/scene/keys.h"
#include "core/scene/text.h"
#include "plugin/format/shot/shot.h"

namespace pelagic {

namespace {

void describe(std::string& out, const Key& key) {
    const std::string fallback = key.is_required ? "" : value_text(key, key.fallback);
    out += "  " + key.path + (fallback.empty() ? "" : " = " + fallback) + '\n';
    out += "      " + key.help + (key.unit.empty() ? "" : " [" + key.unit + "]") + '\n';
    out += "      " + key.accepted + '\n';
    for (const EditionChange& change : edition_changes())
        if (change.path == key.path)
            out += "      before edition " + std::to_string(change.edition) + ": " +
                   value_text(key, change.before) + '\n';
    if (key.key_parts.any()) out += "      feeds " + text_of(key.key_parts) + '\n';
    for (const Key& inner : key.entry_keys) describe(out, inner);
}

}  // namespace

std::string describe_keys() {
    std::string out =
        "preset\n      a named sea, first in the file; all below lies on top of it\n"
        "      a string, one of what pelagic presets lists\n"
        "preset_parts\n      what of the preset counts; all without it\n"
        "      a list of \"sea\", \"light\", \"camera\" and \"water\"\n";
    for (const KeyTable& table : key_tables()) {
        out +=
            (table.is_list() ? "\n[[" + table.name + "]]  " : "\n[" + table.name + "]  ") + table.help + '\n';
        for (const Key& key : table.keys) describe(out, key);
    }
    return out;
}

}  // namespace pelagic
