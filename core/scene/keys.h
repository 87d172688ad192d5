// The keys of a shot file, each described once: what it is called, what it may be, what it means and what
// depends on it. Everything that handles keys one after another reads this table: the reader of shot files,
// range checks, fingerprints, help, records, the headers of files, Python, the panels of windows.
//
// A key is added here (core/scene/keys.cpp) and as a member of its struct in scene.h; one without the other
// doesn't compile.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/scene/limits.h"
#include "core/scene/problem.h"
#include "pelagic/scene.h"

namespace pelagic {

// ---- What depends on a key

// The parts of the work that a key can change. An output's fingerprint is made of the keys that it depends on.
enum class KeyPart {
    Name,     // the names of files and of the stage's root prim
    Range,    // which frames are made; no frame's content depends on it
    Clock,    // the time that a frame shows
    Waves,    // the sea's motion
    Foam,     // whitecaps
    Gusts,    // how the wind varies over the surface: unresolved slopes and whitecaps
    Surface,  // the kind, size, resolution and curvature of the baked surface
    Cage,     // an artist's cage, and how finely it is refined
    Grid,     // the cells of projected grids, baked and in pictures
    View,     // the camera: pictures, and grids that are projected from it
    Light,    // sun and sky
    Water,    // the water body's colour, and how the foam on it looks
    Quality,  // the accuracy of waves and light
    Mesh,     // a mesh's kind of surface, its attributes, and the format of its files
    Maps,     // what is in a map, besides the sea
    Volumes,  // what a volume covers and how finely, besides the sea
    Spray,    // the droplets over breaking crests
    Objects,  // bodies in the light of the sea: pictures; of their hulls more (core/scene/hull.h)
    Choice,   // whether an output exists; what is in it does not depend on the key
};
inline constexpr std::size_t kKeyParts = 19;
using KeyPartSet = std::bitset<kKeyParts>;

template <class... Parts>
constexpr KeyPartSet key_parts(Parts... parts) {
    return KeyPartSet((0ull | ... | (1ull << static_cast<unsigned>(parts))));
}

inline KeyPartSet all_key_parts() {
    return KeyPartSet().set();
}

// "waves, clock"
std::string text_of(KeyPartSet set);

// ---- Values of any type

struct KeyEntry;

// A key's value: nothing (not given, and no default), a truth, an integer, a number, a text or word, three
// numbers, two integers, words, the entries of a list, or a number's keys over the shot.
using KeyValue =
    std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
                 std::vector<std::int64_t>, std::vector<std::string>, std::vector<KeyEntry>, NumberKeys>;

// An entry of a list such as sea.swell: its keys' names, in the order of the table, and values.
struct KeyEntry {
    std::vector<std::pair<std::string_view, KeyValue>> values;
    bool operator==(const KeyEntry&) const;
};

// ---- One key

enum class KeyType {
    Truth,
    Integer,
    Number,
    Text,
    Word,      // one of the choices
    Point,     // [x, y, z]
    Pair,      // two integers
    Words,     // a list of choices
    Entries,   // a list of tables, whose keys are entry_keys
    DataFile,  // the path of a file that is data of the scene; its content counts, not its path
    DataTime,  // which of the data's times: "2019-02-06T00:40:00Z"
};

// "integer", "point", …
std::string_view word_of(KeyType type);

// What a slider shows: the useful part of a range.
struct SoftRange {
    double low = 0.0, high = 1.0;
    bool is_logarithmic = false;
};

struct Key {
    std::string path;   // "sea.wind_speed_mps"; in the entries of a list "sea.swell[].height_m"
    std::string name;   // the path's last part
    std::string label;  // for panels: "Wind speed"
    KeyType type = KeyType::Number;
    std::string unit;  // "m/s"; empty: none
    std::string help;
    std::string accepted;  // what a shot file may say: "a number, 0 … 80"

    std::optional<Range> range;     // of the number, or of each one
    std::optional<SoftRange> soft;  // of a number
    bool may_be_infinite = false;   // besides what is in the range
    bool may_have_keys = false;     // a number: NumberKeys do as well
    bool is_angle = false;          // a number of degrees: between keys it turns the short way
    bool is_silent_off = false;  // at its fallback nobody says it: files of before it keep their fingerprints
    bool is_optional = false;    // may be left out, and has no default
    bool is_required = false;    // in an entry: it has no default
    bool is_picture = false;     // a text: its fallback, or the path of an .exr in its place
    bool may_be_mesh = false;    // or of an .obj
    std::string of_picture;      // of a number that means nothing without it: that text's key
    std::int64_t least = 0;      // of an integer, or each of two: what its member holds
    std::int64_t largest = 0;    // likewise
    std::vector<std::string> choices;  // of words
    std::vector<Key> entry_keys;       // of entries
    std::string entry_name;            // of entries: "Swell"
    std::size_t most_entries = ~std::size_t{0};
    bool are_entries_independent = true;  // whether an entry is valid doesn't depend on the others
    std::string other_word;               // of entries: the word that stands for none of them, "auto"; of an
                                          // integer: a word that may stand in its place, "adaptive"

    KeyValue fallback;  // the value that a Scene begins with
    KeyPartSet key_parts;

    std::function<KeyValue(const Scene&)> get;         // empty: a key of an entry
    std::function<bool(Scene&, const KeyValue&)> set;  // empty: likewise, and for data, which hosts load
};

// A table of the shot file and the keys in it. One that is a list, [[objects]], has one key, whose path is the table's name.
struct KeyTable {
    std::string name;  // "sea"
    std::string help;
    std::span<const Key> keys;
    std::function<void(const Scene& from, Scene& to)> copy;  // the whole table

    bool is_list() const { return keys.size() == 1 && keys.front().path == name; }
};

// All tables and all their keys, in the order of the shot file's documentation.
std::span<const KeyTable> key_tables();
std::span<const Key> keys();

// The key of a path, "sea.fetch_m", "sea.swell[].height_m", "sea.swell[1].height_m"; null: there is none.
const Key* find_key(std::string_view path);

// The parts of "sea.swell[1].height_m"; nothing for a path of no entry.
struct EntryPath {
    std::string_view list;  // "sea.swell"
    std::size_t index = 0;
    std::string_view name;  // "height_m"
};
std::optional<EntryPath> entry_of(std::string_view path);

// The keys of data files: what hosts read from them is a member of the scene.
inline constexpr std::string_view kSpectrumFile = "sea.spectrum_file", kCageFile = "surface.cage_file",
                                  kCameraFile = "camera.file";
// The list of bodies, whose meshes are as well.
inline constexpr std::string_view kObjectsKey = "objects", kMasksKey = "waves.masks",
                                  kCoastKey = "waves.coast", kFrontsKey = "sea.gust_fronts";

// The same for a path that is known to be one. Throws std::logic_error.
const Key& key_of(std::string_view path);

// ---- Values in a scene

// Throws std::logic_error for a key that has none.
KeyValue value_of(const Scene& scene, const Key& key);
// The same for fingerprints and headers: what is read from files and is data of the scene by its content, not by its path. Bodies' meshes,
// with the names that they are called by, and masks' pictures.
KeyValue content_value(const Scene& scene, const Key& key);

// The keys whose pictures a scene names by their paths.
std::vector<const Key*> picture_keys(const Scene& scene);
// The picture of a mask; null: it has none, or none was read.
const MaskPicture* picture_of(const Waves& waves, const WaveMask& mask);
// Changes each of those paths.
void replace_pictures(Scene& scene,
                      const std::function<std::string(const Key&, const std::string& path)>& by);

// A number without keys, also an entry's, by its path; to be set it may be nothing where the key has no default. Both throw
// std::logic_error for an entry that isn't there.
double number_of(const Scene& scene, std::string_view path);
void set_number(Scene& scene, std::string_view path, const KeyValue& number);

// Puts a value into the scene. An integer does for a number. The problem, if the value isn't of the key's
// type or is a word that isn't one of the choices; the scene is then as it was. Ranges are validate()'s.
std::optional<Problem> set_value(Scene& scene, const Key& key, const KeyValue& value);

// A word that isn't one of the key's choices, with the nearest that is. `path` may name an element of a list.
Problem unknown_word(const Key& key, const std::string& path, std::string_view word);

// As a shot file writes it: "10", "[0, -60, 4]", "\"auto\"", "[{ height_m = 1.5, … }]". Nothing: "".
std::string value_text(const Key& key, const KeyValue& value);

// ---- What a scene says about itself, for the headers of files

struct DescribedKey {
    std::string path;  // "sea.fetch_m"
    KeyValue value;
    std::string text;  // as a shot file writes it; a word that stands for no entries without quotes

    // "sea_fetch_m": for formats whose names are identifiers.
    std::string identifier() const;
    // For formats that know no more than numbers and texts.
    std::variant<double, std::string> number_or_text() const;
};

// Whether one of these parts depends on the key in this scene. What has none is neither in a fingerprint nor in a header: a
// file that is kept must be the one that would be made again.
bool has_say(const Scene& scene, const Key& key, KeyPartSet parts);
// The keys that have a say in these parts and a value. A measured spectrum is described by its station and
// time, a cage by its content (Cage::content), not by their files.
std::vector<DescribedKey> described(const Scene& scene, KeyPartSet parts);
// The same as attributes of a file's header: {"pelagic.sea.fetch_m", a number or a text}.
template <class Attribute>
void describe(const std::vector<DescribedKey>& keys, std::vector<Attribute>& attributes) {
    for (const DescribedKey& key : keys)
        std::visit(
            [&](const auto& value) {
                attributes.push_back({"pelagic." + key.path, value});
            },
            key.number_or_text());
}
template <class Attribute>
void describe(const Scene& scene, KeyPartSet parts, std::vector<Attribute>& attributes) {
    describe(described(scene, parts), attributes);
}

}  // namespace pelagic
