#include "plugin/format/shot/edit_shot.h"

#include <toml++/toml.h>

#include <sstream>

#include "core/scene/editions.h"
#include "core/scene/shot_text.h"
#include "plugin/format/shot/shot.h"

namespace pelagic {
namespace {

// The byte at a place. Columns count characters: continuation bytes don't count.
std::size_t offset_of(const std::string& text, const toml::source_position& place) {
    std::size_t at = 0;
    for (toml::source_index line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
    for (toml::source_index column = 1; column < place.column && at < text.size(); ++column) do
            ++at;
        while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0u) == 0x80u);
    return at;
}

std::string with_key(const std::string& text, const std::string& table, const std::string& name,
                     const std::string& value) {
    const toml::table root = toml::parse(text);
    const std::string line = name + " = " + value;
    const toml::node* found = root.get(table);
    const toml::table* keys = found == nullptr ? nullptr : found->as_table();
    const std::string end = text.empty() || text.back() == '\n' ? "" : "\n";
    if (keys == nullptr) return text + end + (text.empty() ? "[" : "\n[") + table + "]\n" + line + '\n';
    const auto put = [&](std::size_t from, std::size_t to, const std::string& words) {
        return text.substr(0, from) + words + text.substr(to);
    };
    if (const toml::node* old = keys->get(name))
        return put(offset_of(text, old->source().begin), offset_of(text, old->source().end), value);
    const std::size_t begin = offset_of(text, keys->source().begin);
    if (keys->is_inline()) return put(begin + 1, begin + 1, ' ' + line + (keys->empty() ? "" : ","));
    const std::size_t next = text.find('\n', begin);
    if (next == std::string::npos) return text + '\n' + line + '\n';
    return put(next + 1, next + 1, line + '\n');
}

}  // namespace

std::string edited_shot(std::string_view text, const Scene& scene, const Scene& base) {
    std::string edited(text);
    Scene read = base;
    const toml::table root = toml::parse(text);
    if (root["shot"]["edition"].node() == nullptr) read.shot.edition = 0;  // to be written
    // What the text will mean in another edition.
    if (scene.shot.edition != base.shot.edition)
        for (const EditionChange& change : edition_changes())
            if (const Key& key = key_of(change.path); root.at_path(change.path).node() == nullptr)
                set_value(read, key, fallback_in(scene.shot.edition, key));
    // The preview, which edits shots, has no lists of the scene's own to change.
    for (const KeyTable& each : key_tables())
        if (const Key& key = each.keys.front(); each.is_list() && value_of(scene, key) != value_of(base, key))
            throw ShotError("[[" + each.name +
                            "]] can't be changed in a text; accepted: those that are there");
    std::istringstream changes(shot_text(scene, read));
    std::string table;
    try {
        for (std::string line; std::getline(changes, line);) {
            if (line.starts_with('[')) {
                table = line.substr(1, line.size() - 2);
            } else if (const std::size_t equals = line.find(" = "); equals != std::string::npos) {
                edited = with_key(edited, table, line.substr(0, equals), line.substr(equals + 3));
            }
        }
    } catch (const toml::parse_error& error) {
        throw ShotError(std::string(error.description()));
    }
    return edited;
}

}  // namespace pelagic
