// A whole shot file into a Scene. See read_scene.h.
#include "plugin/format/shot/read_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/scene/editions.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "core/scene/number_keys.h"
#include "core/scene/presets.h"
#include "core/scene/text.h"

namespace pelagic {

namespace {

std::string joined_names(std::span<const Key> keys) {
    std::string out;
    for (const Key& key : keys) out += (out.empty() ? "" : ", ") + key.name;
    return out;
}

std::string indexed(const std::string& path, std::size_t index) {
    return path + '[' + std::to_string(index) + ']';
}

std::string inside_of(const std::string& path, const std::string& name) {
    return path.empty() ? name : path + '.' + name;
}

// One value to read: where it stands and what is accepted there, for messages.
struct Asked {
    const toml::node& node;
    std::string path;
    const Key& key;
};

std::nullopt_t refuse(Reader& reader, const Asked& asked, std::string problem) {
    reader.refuse(asked.node.source().begin,
                  {asked.path, text_of(asked.node), std::move(problem), asked.key.accepted});
    return std::nullopt;
}

std::nullopt_t refuse_type(Reader& reader, const Asked& asked) {
    return refuse(reader, asked, "is " + type_of(asked.node));
}

// A table's keys in the order of the file, so that the problems listed are the file's first.
std::vector<std::pair<toml::key, const toml::node*>> in_order(const toml::table& table) {
    std::vector<std::pair<toml::key, const toml::node*>> out;
    out.reserve(table.size());
    for (const auto& [key, node] : table) out.emplace_back(key, &node);
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
        const toml::source_position &x = a.first.source().begin, &y = b.first.source().begin;
        return std::pair(x.line, x.column) < std::pair(y.line, y.column);
    });
    return out;
}

// ---- Unknown keys

// What a person who wrote this unknown key may have meant: a key of the same table, else one of that name
// elsewhere.
std::string meant_key(const std::string& path, const std::string& name,
                      const std::vector<std::string>& known) {
    if (const std::string near = nearest(name, known); !near.empty()) return inside_of(path, near);
    std::vector<std::string> names;
    for (const Key& key : keys()) names.push_back(key.name);
    const std::string near = nearest(name, names);
    if (near.empty()) return {};
    return keys()[static_cast<std::size_t>(std::find(names.begin(), names.end(), near) - names.begin())].path;
}

// The keys that a table may have: their names, and how they are called in a message.
struct KnownKeys {
    std::vector<std::string> names;
    std::string accepted;  // "in sea the keys wind_speed_mps, …"
};

void refuse_unknown(Reader& reader, const std::string& path,
                    const std::pair<toml::key, const toml::node*>& at, const KnownKeys& known) {
    const std::string name(at.first.str());
    const bool is_listed = reader.is_listed(at.first.source().begin);
    const std::string meant = is_listed ? meant_key(path, name, known.names) : std::string();
    reader.refuse(at.first.source().begin,
                  {inside_of(path, name), text_of(*at.second),
                   std::string(at.second->is_table() ? "is an unknown table" : "is an unknown key") +
                       (meant.empty() ? "" : ", the nearest is " + meant),
                   known.accepted});
}

KnownKeys known_keys(const std::string& path, std::span<const Key> keys) {
    KnownKeys known{{}, "in " + path + " the keys " + joined_names(keys)};
    for (const Key& key : keys) known.names.push_back(key.name);
    return known;
}

// ---- Values of each type

std::optional<KeyValue> read_value(Reader& reader, const Asked& asked);

// An integer too large for its member is refused like one outside its range.
std::optional<std::int64_t> read_integer(Reader& reader, const Asked& asked) {
    const auto* integer = asked.node.as_integer();
    if (!integer) return refuse_type(reader, asked);
    const std::int64_t value = integer->get();
    if (value < asked.key.least || value > asked.key.largest)
        return refuse(reader, asked, "is outside the range");
    return value;
}

// A whole number does for a number with a point, not the other way round.
std::optional<double> read_number(Reader& reader, const Asked& asked) {
    if (const auto* number = asked.node.as_floating_point()) return number->get();
    if (const auto* integer = asked.node.as_integer()) return static_cast<double>(integer->get());
    return refuse_type(reader, asked);
}

std::optional<std::string> read_word(Reader& reader, const Asked& asked) {
    const auto* text = asked.node.as_string();
    if (!text) return refuse_type(reader, asked);
    for (const std::string& word : asked.key.choices)
        if (word == text->get()) return word;
    Problem problem = unknown_word(asked.key, asked.path, text->get());
    problem.value = text_of(asked.node);
    reader.refuse(asked.node.source().begin, problem);
    return std::nullopt;
}

// { keys = [[frame, number], …], interpolation = "smooth" }. What is wrong with a key names its place in the list.
std::optional<KeyValue> read_number_keys(Reader& reader, const Asked& asked) {
    const toml::table& table = *asked.node.as_table();
    static const KnownKeys known{{"keys", "interpolation"}, "the keys keys and interpolation"};
    static const Key& interpolation = pelagic::key_of("camera.interpolation");
    if (!asked.key.may_have_keys)
        return refuse(reader, asked,
                      "has keys, and this number can't change over the shot" + why_no_keys(asked.key.path));
    const std::size_t problems_before = reader.problem_count();
    NumberKeys number;
    for (const auto& at : in_order(table))
        if (at.first.str() != "keys" && at.first.str() != "interpolation")
            refuse_unknown(reader, asked.path, at, known);
    if (const toml::node* word = table.get("interpolation")) {
        const Asked here{*word, asked.path + ".interpolation", interpolation};
        if (const auto given = read_word(reader, here))
            number.interpolation = *choice_of<CameraInterpolation>(*given);
    }
    const toml::array* list = table["keys"].as_array();
    if (!list || list->empty()) return refuse(reader, asked, "has no list of keys in it");
    for (std::size_t i = 0; i < list->size(); ++i) {
        const toml::node& node = *list->get(i);
        const std::string path = indexed(asked.path + ".keys", i);
        reader.remember(path, node.source().begin);
        const toml::array* pair = node.as_array();
        const auto* frame = pair && pair->size() == 2 ? pair->get(0)->as_integer() : nullptr;
        const Asked value{frame ? *pair->get(1) : node, path, asked.key};
        if (!frame || !std::in_range<int>(frame->get())) {
            reader.refuse(node.source().begin,
                          {path, text_of(node), "is no frame and its number",
                           "[frame, number], the frame an integer, " + text_of(limits::kFrame)});
        } else if (const std::optional<double> read = read_number(reader, value)) {
            number.keys.push_back({static_cast<int>(frame->get()), *read});
        }
    }
    if (reader.problem_count() == problems_before) return number;
    reader.mark_failed(asked.path);
    return std::nullopt;
}

std::optional<std::string> read_text(Reader& reader, const Asked& asked) {
    if (const auto* text = asked.node.as_string()) return text->get();
    return refuse_type(reader, asked);
}

// A list of exactly this many numbers, each read by `read`.
template <class Number, class Read>
std::optional<KeyValue> read_numbers(Reader& reader, const Asked& asked, std::size_t count,
                                     const Read& read) {
    const auto* list = asked.node.as_array();
    if (!list) return refuse_type(reader, asked);
    if (list->size() != count) return refuse(reader, asked, "is a list of " + std::to_string(list->size()));
    std::vector<Number> numbers;
    for (std::size_t i = 0; i < count; ++i) {
        const toml::node& element = *list->get(i);
        reader.remember(indexed(asked.path, i), element.source().begin);
        if (const auto number = read(reader, {element, indexed(asked.path, i), asked.key}))
            numbers.push_back(*number);
    }
    if (numbers.size() == count) return numbers;
    reader.mark_failed(asked.path);
    return std::nullopt;
}

// A word that was refused stays, as the first one, so that the others keep their numbers in messages.
std::optional<KeyValue> read_words(Reader& reader, const Asked& asked) {
    const auto* list = asked.node.as_array();
    if (!list) return refuse_type(reader, asked);
    // No word counts twice: a list that is much longer isn't looked at word by word.
    if (const std::size_t most = 4 * asked.key.choices.size(); list->size() > most)
        return refuse(reader, asked, "is a list of " + std::to_string(list->size()));
    std::vector<std::string> words;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const toml::node& element = *list->get(i);
        const std::string path = indexed(asked.path, i);
        reader.remember(path, element.source().begin);
        const std::optional<std::string> word = read_word(reader, {element, path, asked.key});
        if (!word) reader.mark_failed(asked.path);
        words.push_back(word.value_or(asked.key.choices.front()));
    }
    return words;
}

KeyEntry read_entry(Reader& reader, const toml::table& table, const std::string& path,
                    std::span<const Key> keys) {
    KeyEntry entry;
    for (const auto& at : in_order(table))
        if (std::none_of(keys.begin(), keys.end(),
                         [&](const Key& key) { return key.name == at.first.str(); }))
            refuse_unknown(reader, path, at, known_keys(path, keys));
    for (const Key& key : keys) {
        entry.values.emplace_back(key.name, key.fallback);
        const toml::node* node = table.get(key.name);
        const std::string here = path + '.' + key.name;
        if (!node) {
            if (key.is_required)
                reader.refuse(table.source().begin,
                              {here, "(missing)", "has no default", key.accepted + "; " + key.help});
            continue;
        }
        reader.remember(here, node->source().begin);
        if (auto value = read_value(reader, {*node, here, key}))
            entry.values.back().second = std::move(*value);
    }
    return entry;
}

// An entry that was refused stays, as its default, so that the others keep their numbers in messages.
std::optional<KeyValue> read_entries(Reader& reader, const Asked& asked) {
    const Key& key = asked.key;
    if (!key.other_word.empty() && asked.node.is_string()) {
        if (asked.node.as_string()->get() == key.other_word) return std::vector<KeyEntry>();
        return refuse(reader, asked, "is not the word " + quoted_text(key.other_word));
    }
    const auto* list = asked.node.as_array();
    if (!list) return refuse_type(reader, asked);
    if (list->size() > key.most_entries) {
        reader.refuse(asked.node.source().begin,
                      {asked.path, std::to_string(list->size()) + " entries", "is too many",
                       "at most " + std::to_string(key.most_entries)});
        return std::nullopt;
    }
    std::vector<KeyEntry> entries;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const toml::node& node = *list->get(i);
        const std::string path = indexed(asked.path, i);
        reader.remember(path, node.source().begin);
        const std::size_t problems_before = reader.problem_count();
        const toml::table* table = node.as_table();
        if (!table)
            reader.refuse(node.source().begin, {path, text_of(node), "is " + type_of(node),
                                                "{ " + joined_names(key.entry_keys) + " }"});
        if (table) {
            entries.push_back(read_entry(reader, *table, path, key.entry_keys));
        } else {
            KeyEntry& entry = entries.emplace_back();
            for (const Key& inner : key.entry_keys) entry.values.emplace_back(inner.name, inner.fallback);
        }
        // Where validate() compares entries, one that couldn't be read would make the others look wrong.
        if (reader.problem_count() > problems_before)
            reader.mark_failed(key.are_entries_independent ? path : asked.path);
    }
    if (entries.empty() && !key.other_word.empty()) {
        reader.refuse(asked.node.source().begin,
                      {asked.path, "[]", "is a sea without waves", key.accepted + ", at least one"});
        return std::nullopt;
    }
    return entries;
}

std::optional<KeyValue> read_value(Reader& reader, const Asked& asked) {
    const auto value = [](auto&& read) { return read ? std::optional<KeyValue>(*read) : std::nullopt; };
    switch (asked.key.type) {
        case KeyType::Truth:
            if (const auto* truth = asked.node.as_boolean()) return truth->get();
            return refuse_type(reader, asked);
        case KeyType::Integer:
            if (const auto* word = asked.node.as_string(); word && !asked.key.other_word.empty()) {
                if (word->get() == asked.key.other_word) return word->get();
                return refuse(reader, asked, "is not the word " + quoted_text(asked.key.other_word));
            }
            return value(read_integer(reader, asked));
        case KeyType::Number:
            if (asked.node.is_table()) return read_number_keys(reader, asked);
            return value(read_number(reader, asked));
        case KeyType::Text:
        case KeyType::DataFile:
            return value(read_text(reader, asked));
        case KeyType::Word:
            return value(read_word(reader, asked));
        case KeyType::Point:
            return read_numbers<double>(reader, asked, 3, read_number);
        case KeyType::Pair:
            return read_numbers<std::int64_t>(reader, asked, 2, read_integer);
        case KeyType::Words:
            return read_words(reader, asked);
        case KeyType::Entries:
            return read_entries(reader, asked);
        case KeyType::DataTime:
            break;
    }
    return std::nullopt;
}

// ---- Values that need more than reading

// A zone has to be said: the buoys' times are UTC, and a time without one would be taken for local time by
// many.
void read_spectrum_time(Reader& reader, const Asked& asked) {
    const auto* both = asked.node.as_date_time();
    if (!both) {
        refuse_type(reader, asked);
        return;
    }
    const toml::date_time& moment = both->get();
    if (!moment.offset) {
        refuse(reader, asked, "does not say its time zone");
    } else if (moment.time.nanosecond != 0) {
        refuse(reader, asked, "has a part of a second");
    } else {
        const std::chrono::year_month_day date{std::chrono::year(moment.date.year),
                                               std::chrono::month(moment.date.month),
                                               std::chrono::day(moment.date.day)};
        reader.spectrum_time = std::chrono::sys_days{date} + std::chrono::hours{moment.time.hour} +
                               std::chrono::minutes{moment.time.minute - moment.offset->minutes} +
                               std::chrono::seconds{moment.time.second};
    }
}

// A file may list the cascades in any order; the scene wants the largest first.
void sort_cascades(Reader& reader, const std::string& path, std::vector<CascadeSize>& cascades) {
    const auto is_comparable = [](const CascadeSize& cascade) { return !std::isnan(cascade.size_m); };
    if (!std::all_of(cascades.begin(), cascades.end(), is_comparable)) return;
    std::vector<std::size_t> order(cascades.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return cascades[a].size_m > cascades[b].size_m; });
    const std::vector<CascadeSize> given = cascades;
    for (std::size_t i = 0; i < order.size(); ++i) {
        cascades[i] = given[order[i]];
        reader.rename(indexed(path, i), indexed(path, order[i]));
    }
}

void read_key(Reader& reader, const Asked& asked, Scene& scene) {
    if (asked.key.type == KeyType::DataTime) return read_spectrum_time(reader, asked);
    const std::optional<KeyValue> value = read_value(reader, asked);
    if (!value) return;
    if (asked.key.type == KeyType::DataFile) {
        (asked.key.path == kCageFile     ? reader.cage_file
         : asked.key.path == kCameraFile ? reader.camera_file
                                         : reader.spectrum_file) = std::get<std::string>(*value);
        return;
    }
    if (const std::optional<Problem> problem = set_value(scene, asked.key, *value))
        return reader.refuse(asked.node.source().begin, *problem);
    if (asked.key.path == "waves.cascades") sort_cascades(reader, asked.path, scene.waves.cascades);
}

void read_table(Reader& reader, const toml::table& table, const KeyTable& about, Scene& scene) {
    const KnownKeys known = known_keys(about.name, about.keys);
    for (const auto& at : in_order(table)) {
        const auto& [name_in_file, node] = at;
        const auto key =
            std::find_if(about.keys.begin(), about.keys.end(),
                         [&, name = name_in_file.str()](const Key& k) { return k.name == name; });
        if (key == about.keys.end()) {
            refuse_unknown(reader, about.name, at, known);
        } else {
            reader.remember(key->path, node->source().begin);
            read_key(reader, {*node, key->path, *key}, scene);
        }
    }
}

// The edition, which all else lies on; where it can't be read, read_key() says so.
int edition_of(const toml::table& root) {
    const auto edition = root["shot"]["edition"].value_exact<std::int64_t>();
    return edition && limits::kEdition.holds(static_cast<double>(*edition)) ? static_cast<int>(*edition)
                                                                            : kNewestEdition;
}

// Which parts of the preset count; all without preset_parts.
PresetParts read_preset_parts(Reader& reader, const toml::table& root) {
    const toml::node* node = root.get("preset_parts");
    if (!node) return ~PresetParts();
    constexpr const char* kAccepted = "a list of \"sea\", \"light\", \"camera\" and \"water\", beside preset";
    PresetParts parts;
    const auto refuse = [&](const toml::node& at, std::string problem) {
        reader.refuse(at.source().begin, {"preset_parts", text_of(at), std::move(problem), kAccepted});
    };
    const toml::array* list = node->as_array();
    if (!list || !root.get("preset"))
        return refuse(*node, list ? "is there without a preset" : "is " + type_of(*node)), parts;
    for (const toml::node& part : *list) {
        const auto* word = part.as_string();
        const auto at =
            std::find(kPresetParts.begin(), kPresetParts.end(), word ? word->get() : std::string());
        if (at == kPresetParts.end()) return refuse(part, "is no part of a preset"), parts;
        parts.set(static_cast<std::size_t>(at - kPresetParts.begin()));
    }
    return parts;
}

// The preset on which all other keys lie. Only a string can stand there: a table would be the file's own.
void read_preset(Reader& reader, const toml::node& node, PresetParts parts, Scene& scene) {
    const toml::source_position at = node.source().begin;
    const auto* name = node.as_string();
    if (!name)
        return reader.refuse(at, {"preset", text_of(node), "is " + type_of(node),
                                  "a string, the name of a preset: pelagic presets lists them"});
    if (const Preset* preset = find_preset(name->get())) return apply(*preset, scene, parts);
    reader.refuse(at, unknown_preset("preset", name->get()));
}

}  // namespace

Scene read_scene(Reader& reader, const toml::table& root) {
    Scene scene = scene_of_edition(edition_of(root));
    const PresetParts parts = read_preset_parts(reader, root);
    if (const toml::node* preset = root.get("preset")) read_preset(reader, *preset, parts, scene);
    KnownKeys tables;
    for (const KeyTable& table : key_tables()) {
        tables.accepted +=
            (tables.names.empty() ? "preset, preset_parts and the tables " : ", ") + table.name;
        tables.names.push_back(table.name);
    }
    for (const auto& at : in_order(root)) {
        const auto& [name_in_file, node] = at;
        if (name_in_file.str() == "preset" || name_in_file.str() == "preset_parts") continue;
        const auto table =
            std::find_if(key_tables().begin(), key_tables().end(),
                         [&, name = name_in_file.str()](const KeyTable& t) { return t.name == name; });
        if (table == key_tables().end()) {
            refuse_unknown(reader, "", at, tables);
            continue;
        }
        reader.remember(table->name, node->source().begin);
        if (table->is_list()) {
            read_key(reader, {*node, table->name, table->keys.front()}, scene);
            continue;
        }
        if (const auto* inner = node->as_table()) {
            read_table(reader, *inner, *table, scene);
        } else {
            reader.refuse(node->source().begin,
                          {table->name, text_of(*node), "is " + type_of(*node),
                           "a table, [" + table->name + "], of " + joined_names(table->keys)});
        }
    }
    return scene;
}

}  // namespace pelagic
