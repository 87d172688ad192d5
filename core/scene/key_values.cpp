// Keys by their paths, and values of any key as text and into a scene. See keys.h.
#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>

#include "core/scene/key_rows.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"

namespace pelagic {

namespace {

constexpr std::array<std::string_view, kKeyParts> kKeyPartWords{
    "name",  "range", "clock",   "waves", "foam", "gusts",   "surface", "cage",    "grid",  "view",
    "light", "water", "quality", "mesh",  "maps", "volumes", "spray",   "objects", "choice"};
static_assert(!kKeyPartWords.back().empty(), "each part has a word");

constexpr std::array<std::string_view, 11> kTypeWords{"truth",   "integer",   "number",   "text",
                                                      "word",    "point",     "pair",     "words",
                                                      "entries", "data file", "data time"};

std::string words_text(const std::vector<std::string>& choices) {
    std::string out;
    for (const std::string& word : choices) out += (out.empty() ? "" : " ") + quoted_text(word);
    return out;
}

std::string names_text(const std::vector<Key>& keys) {
    std::string out;
    for (const Key& key : keys) out += (out.empty() ? "" : ", ") + key.name;
    return out;
}

std::string type_text(const KeyValue& value) {
    struct Visitor {
        std::string operator()(std::monostate) const { return "nothing"; }
        std::string operator()(bool) const { return "true or false"; }
        std::string operator()(std::int64_t) const { return "an integer"; }
        std::string operator()(double) const { return "a number with a point"; }
        std::string operator()(const std::string&) const { return "a string"; }
        std::string operator()(const std::vector<double>&) const { return "a list of numbers"; }
        std::string operator()(const std::vector<std::int64_t>&) const { return "a list of integers"; }
        std::string operator()(const std::vector<std::string>&) const { return "a list of words"; }
        std::string operator()(const std::vector<KeyEntry>&) const { return "a list of tables"; }
        std::string operator()(const NumberKeys&) const { return "a number's keys"; }
    };
    return std::visit(Visitor{}, value);
}

template <class Element, class Text>
std::string list_text(const std::vector<Element>& list, const Text& text) {
    std::string out = "[";
    for (const Element& element : list) out += (out.size() == 1 ? "" : ", ") + text(element);
    return out + ']';
}

}  // namespace

// ---- Lookup

const Key* find_key(std::string_view path) {
    std::string of_list(path);  // without the entry's number
    if (const auto entry = entry_of(path))
        of_list = std::string(entry->list) + "[]." + std::string(entry->name);
    for (const Key& key : keys()) {
        if (key.path == path) return &key;
        if (key.entry_keys.empty() || !path.starts_with(key.path)) continue;
        for (const Key& inner : key.entry_keys)
            if (inner.path == of_list) return &inner;
    }
    return nullptr;
}

std::optional<EntryPath> entry_of(std::string_view path) {
    const std::size_t open = path.find('['), close = path.find("].");
    if (close == std::string_view::npos || open == std::string_view::npos || close <= open + 1)
        return std::nullopt;
    EntryPath entry{path.substr(0, open), 0, path.substr(close + 2)};
    const std::string_view digits = path.substr(open + 1, close - open - 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), entry.index);
    if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
    return entry;
}

const Key& key_of(std::string_view path) {
    if (const Key* key = find_key(path)) return *key;
    throw std::logic_error("the shot file has no key " + std::string(path));
}

std::string_view word_of(KeyType type) {
    return kTypeWords.at(static_cast<std::size_t>(type));
}

std::string text_of(KeyPartSet set) {
    std::string out;
    for (std::size_t part = 0; part < kKeyParts; ++part)
        if (set[part]) out += (out.empty() ? "" : ", ") + std::string(kKeyPartWords[part]);
    return out;
}

bool KeyEntry::operator==(const KeyEntry& other) const {
    return values == other.values;
}

// ---- What a row says

std::string accepted_text(const Key& key, const About& about) {
    if (*about.accepted != '\0') return about.accepted;
    const std::string range = key.range ? text_of(*key.range) + (key.may_be_infinite ? ", or inf" : "") : "";
    const std::string and_range = range.empty() ? "" : ", " + range;
    switch (key.type) {
        case KeyType::Truth:
            return "true or false";
        case KeyType::Integer:
            return "an integer" + and_range +
                   (key.other_word.empty() ? "" : ", or " + quoted_text(key.other_word));
        case KeyType::Number:
            return "a number" + and_range + (key.may_have_keys ? ", or { keys = [[frame, number], …] }" : "");
        case KeyType::Word:
            return "one of " + words_text(key.choices);
        case KeyType::Words:
            return "a list of " + words_text(key.choices);
        case KeyType::Point:
            return "[x, y, z], three numbers, each " + range;
        case KeyType::Pair:
            return about.form + range;
        case KeyType::Entries:
            return (key.other_word.empty() ? "" : quoted_text(key.other_word) + ", or ") + "a list of { " +
                   names_text(key.entry_keys) + " }";
        case KeyType::Text:
        case KeyType::DataFile:
        case KeyType::DataTime:
            break;
    }
    return "a string";
}

std::string label_of(std::string_view name, bool has_unit) {
    std::string label(name);
    if (has_unit) {
        for (const std::string_view suffix :
             {"_mg_m3", "_mm_h", "_mps", "_deg", "_px", "_ms", "_mm", "_m", "_s", "_k"})
            if (label.ends_with(suffix)) {
                label.erase(label.size() - suffix.size());
                break;
            }
    }
    std::replace(label.begin(), label.end(), '_', ' ');
    if (label.front() >= 'a' && label.front() <= 'z') label.front() += 'A' - 'a';
    return label;
}

Key key_about(const About& about, KeyType type) {
    Key key;
    key.name = about.name;
    key.unit = about.unit;
    key.label = label_of(key.name, !key.unit.empty());
    key.type = type;
    key.help = about.help;
    key.range = about.range;
    key.soft = about.soft;
    if (!key.soft && key.range && (type == KeyType::Number || type == KeyType::Integer))
        key.soft = SoftRange{key.range->low, key.range->high};
    key.may_be_infinite = about.may_be_infinite;
    key.may_have_keys = about.may_have_keys;
    key.is_angle = about.is_angle;
    key.is_silent_off = about.is_silent_off;
    key.is_picture = about.is_picture;
    key.may_be_mesh = about.may_be_mesh;
    key.of_picture = about.of_picture;
    key.most_entries = about.most_entries;
    key.are_entries_independent = about.are_entries_independent;
    key.other_word = about.other_word;
    key.entry_name = about.entry_name;
    key.key_parts = about.key_parts;
    key.accepted = about.accepted;
    return key;
}

namespace {

// The value of an entry's key; null: there is none.
KeyValue* value_in(std::vector<KeyEntry>& entries, const EntryPath& at) {
    if (at.index >= entries.size()) return nullptr;
    auto& values = entries[at.index].values;
    const auto found = std::ranges::find(values, at.name, [](const auto& pair) { return pair.first; });
    return found == values.end() ? nullptr : &found->second;
}

}  // namespace

void allow_keys(Key& key) {
    const auto is_it = [path = key.path](const KeyedNumber& number) { return number.path == path; };
    key.get = [is_it, get = std::move(key.get)](const Scene& scene) {
        const auto keyed = std::find_if(scene.keyed.begin(), scene.keyed.end(), is_it);
        return keyed != scene.keyed.end() ? KeyValue(keyed->keys) : get(scene);
    };
    key.set = [is_it, path = key.path, is_angle = key.is_angle, set = std::move(key.set)](
                  Scene& scene, const KeyValue& value) {
        const auto* number = std::get_if<NumberKeys>(&value);
        if (number && number->keys.empty()) return false;
        if (!set(scene, number ? KeyValue(standing_for(*number, is_angle)) : value)) return false;
        std::erase_if(scene.keyed, is_it);
        if (number) scene.keyed.push_back({path, *number});
        return true;
    };
}

void allow_keys_in_entries(Key& key) {
    const auto is_its = [prefix = key.path + '['](const KeyedNumber& number) {
        return number.path.starts_with(prefix);
    };
    key.get = [is_its, get = std::move(key.get)](const Scene& scene) {
        KeyValue value = get(scene);
        for (const KeyedNumber& number : scene.keyed)
            if (is_its(number))
                if (KeyValue* at =
                        value_in(std::get<std::vector<KeyEntry>>(value), entry_of(number.path).value()))
                    *at = number.keys;
        return value;
    };
    key.set = [is_its, path = key.path, inner = key.entry_keys, set = std::move(key.set)](
                  Scene& scene, const KeyValue& value) {
        const auto* given = std::get_if<std::vector<KeyEntry>>(&value);
        if (!given) return set(scene, value);
        std::vector<KeyEntry> entries = *given;
        std::vector<KeyedNumber> keyed;
        for (std::size_t i = 0; i < entries.size(); ++i)
            for (auto& [name, each] : entries[i].values) {
                const auto* number = std::get_if<NumberKeys>(&each);
                const auto of = std::ranges::find(inner, name, &Key::name);
                if (!number || of == inner.end() || !of->may_have_keys || number->keys.empty()) continue;
                keyed.push_back({path + '[' + std::to_string(i) + "]." + of->name, *number});
                each = standing_for(*number, of->is_angle);
            }
        if (!set(scene, entries)) return false;
        std::erase_if(scene.keyed, is_its);
        scene.keyed.insert(scene.keyed.end(), keyed.begin(), keyed.end());
        return true;
    };
}

// ---- Values

KeyValue value_of(const Scene& scene, const Key& key) {
    if (!key.get) throw std::logic_error("a scene has no value of " + key.path);
    return key.get(scene);
}

KeyValue content_value(const Scene& scene, const Key& key) {
    if (!scene.waves.mask_pictures.empty() && key.path == kMasksKey) {
        Scene named = scene;
        for (WaveMask& mask : named.waves.masks)
            if (const MaskPicture* picture = picture_of(scene.waves, mask)) mask.picture = picture->content();
        return value_of(named, key);
    }
    KeyValue value = value_of(scene, key);
    if (key.type != KeyType::Entries) return value;
    auto& entries = std::get<std::vector<KeyEntry>>(value);
    for (const Key& inner : key.entry_keys) {
        if (!inner.is_silent_off) continue;
        for (KeyEntry& entry : entries)
            std::erase(entry.values, std::pair(std::string_view(inner.name), inner.fallback));
    }
    for (std::size_t i = 0; key.path == kObjectsKey && i < entries.size(); ++i)
        for (auto& [name, inner] : entries[i].values) {
            const SceneObject& object = scene.objects[i];
            if (name == "name") inner = object.called();
            if (name == "file") inner = object.mesh ? object.mesh->content() : "";
        }
    return value;
}

Problem unknown_word(const Key& key, const std::string& path, std::string_view word) {
    const std::string near = nearest(word, key.choices);
    return {path, quoted_text(word),
            "is not one of the words" + (near.empty() ? "" : ", the nearest is " + quoted_text(near)),
            "one of " + words_text(key.choices)};
}

const MaskPicture* picture_of(const Waves& waves, const WaveMask& mask) {
    if (!mask.picture) return nullptr;
    const auto found = waves.mask_pictures.find(*mask.picture);
    return found == waves.mask_pictures.end() ? nullptr : found->second.get();
}

std::vector<const Key*> picture_keys(const Scene& scene) {
    std::vector<const Key*> named;
    for (const Key& key : keys())
        if (key.is_picture && key.get(scene) != key.fallback) named.push_back(&key);
    return named;
}

void replace_pictures(Scene& scene,
                      const std::function<std::string(const Key&, const std::string& path)>& by) {
    for (const Key* key : picture_keys(scene))
        key->set(scene, by(*key, std::get<std::string>(key->get(scene))));
}

double number_of(const Scene& scene, std::string_view path) {
    const auto entry = entry_of(path);
    KeyValue value = value_of(scene, key_of(entry ? entry->list : path));
    if (!entry) return std::get<double>(value);
    const KeyValue* inner = value_in(std::get<std::vector<KeyEntry>>(value), *entry);
    if (!inner) throw std::logic_error("a scene has no " + std::string(path));
    return std::get<double>(*inner);
}

void set_number(Scene& scene, std::string_view path, const KeyValue& number) {
    const auto entry = entry_of(path);
    const Key& key = key_of(entry ? entry->list : path);
    KeyValue value = number;
    if (entry) {
        value = value_of(scene, key);
        KeyValue* inner = value_in(std::get<std::vector<KeyEntry>>(value), *entry);
        if (!inner) throw std::logic_error("a scene has no " + std::string(path));
        *inner = number;
    }
    key.set(scene, value);
}

std::optional<Problem> set_value(Scene& scene, const Key& key, const KeyValue& value) {
    if (!key.set) return Problem{key.path, value_text(key, value), "can't be set", key.accepted};
    if (key.set(scene, value)) return std::nullopt;
    if (std::holds_alternative<NumberKeys>(value))
        return Problem{key.path, value_text(key, value),
                       key.may_have_keys
                           ? "has no keys in it"
                           : "is a number's keys, and this key can't have any" + why_no_keys(key.path),
                       key.accepted};
    if (const auto* entries = std::get_if<std::vector<KeyEntry>>(&value))
        for (std::size_t i = 0; i < entries->size(); ++i)
            for (std::size_t k = 0; k < std::min((*entries)[i].values.size(), key.entry_keys.size()); ++k) {
                const Key& inner = key.entry_keys[k];
                const KeyValue& each = (*entries)[i].values[k].second;
                if (const auto* number = std::get_if<NumberKeys>(&each);
                    number && (number->keys.empty() || !inner.may_have_keys))
                    return Problem{
                        key.path + '[' + std::to_string(i) + "]." + inner.name, value_text(inner, each),
                        inner.may_have_keys
                            ? "has no keys in it"
                            : "is a number's keys, and this key can't have any" + why_no_keys(inner.path),
                        inner.accepted};
            }
    const auto is_unknown = [&](const std::string& word) {
        return std::find(key.choices.begin(), key.choices.end(), word) == key.choices.end();
    };
    if (const auto* word = std::get_if<std::string>(&value); word && key.type == KeyType::Word)
        return unknown_word(key, key.path, *word);
    if (const auto* words = std::get_if<std::vector<std::string>>(&value);
        words && key.type == KeyType::Words) {
        const auto first = std::find_if(words->begin(), words->end(), is_unknown);
        if (first != words->end())
            return unknown_word(key, key.path + '[' + std::to_string(first - words->begin()) + ']', *first);
    }
    if (std::holds_alternative<std::string>(value) && key.type == KeyType::Integer && !key.other_word.empty())
        return Problem{key.path, value_text(key, value), "is not the word " + quoted_text(key.other_word),
                       key.accepted};
    if (std::holds_alternative<std::int64_t>(value) && key.type == KeyType::Integer)
        return Problem{key.path, value_text(key, value), "is outside the range", key.accepted};
    return Problem{key.path, value_text(key, value), "is " + type_text(value), key.accepted};
}

std::string value_text(const Key& key, const KeyValue& value) {
    struct Visitor {
        const Key& key;
        std::string operator()(std::monostate) const { return {}; }
        std::string operator()(bool truth) const { return truth ? "true" : "false"; }
        std::string operator()(std::int64_t integer) const { return std::to_string(integer); }
        std::string operator()(double number) const { return number_text(number); }
        std::string operator()(const std::string& text) const {
            return key.type == KeyType::DataTime ? text : quoted_text(text);
        }
        std::string operator()(const std::vector<double>& list) const { return list_text(list, number_text); }
        std::string operator()(const std::vector<std::int64_t>& list) const {
            return list_text(list, [](std::int64_t integer) { return std::to_string(integer); });
        }
        std::string operator()(const std::vector<std::string>& list) const {
            return list_text(list, [](const std::string& word) { return quoted_text(word); });
        }
        std::string operator()(const std::vector<KeyEntry>& list) const {
            if (list.empty() && !key.other_word.empty()) return quoted_text(key.other_word);
            return list_text(list, [&](const KeyEntry& entry) {
                std::string out = "{ ";
                for (const auto& [name, inner] : entry.values)
                    if (const std::string text = value_text(key, inner); !text.empty())  // empty: left out
                        out += (out.size() == 2 ? "" : ", ") + std::string(name) + " = " + text;
                return out + " }";
            });
        }
        std::string operator()(const NumberKeys& number) const {
            return "{ keys = " +
                   list_text(number.keys,
                             [](const NumberKeys::Key& at) {
                                 return '[' + std::to_string(at.frame) + ", " + number_text(at.value) + ']';
                             }) +
                   ", interpolation = " + quoted_text(word_of(number.interpolation)) + " }";
        }
    };
    return std::visit(Visitor{key}, value);
}

std::string DescribedKey::identifier() const {
    std::string out = path;
    std::replace(out.begin(), out.end(), '.', '_');
    return out;
}

std::variant<double, std::string> DescribedKey::number_or_text() const {
    if (const auto* number = std::get_if<double>(&value)) return *number;
    if (const auto* word = std::get_if<std::string>(&value)) return *word;
    return text;
}

bool has_say(const Scene& scene, const Key& key, KeyPartSet parts) {
    // Waves that are added up one by one have neither.
    if (scene.waves.model == WaveModel::Trochoid &&
        (key.path == "waves.lean_deg" || key.path == "waves.second_order"))
        return false;
    if (key.is_silent_off && key.get(scene) == key.fallback) return false;
    return (key.key_parts & parts).any();
}

std::vector<DescribedKey> described(const Scene& scene, KeyPartSet parts) {
    std::vector<DescribedKey> out;
    for (const Key& key : keys()) {
        if (!has_say(scene, key, parts)) continue;
        if (key.type == KeyType::DataFile) {
            if (const auto& cage = scene.surface.cage; cage && key.path == kCageFile)
                out.push_back({"surface.cage", cage->content(), quoted_text(cage->content())});
            if (const auto& measured = scene.sea.measured; measured && key.path == kSpectrumFile)
                out.push_back({"sea.spectrum_station", measured->station, quoted_text(measured->station)});
            continue;
        }
        KeyValue value = content_value(scene, key);
        if (std::holds_alternative<std::monostate>(value)) continue;
        const auto* entries = std::get_if<std::vector<KeyEntry>>(&value);
        const bool is_word = entries && entries->empty() && !key.other_word.empty();
        std::string text = is_word ? key.other_word : value_text(key, value);
        if (auto* path = std::get_if<std::string>(&value)) *path = utf8_text(*path);
        out.push_back({key.path, std::move(value), std::move(text)});
    }
    return out;
}

}  // namespace pelagic
