// All keys of a shot file: their words, and how each is read. See keys.h.
#include "plugin/shot/keys.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <type_traits>

#include "core/scene/limits.h"
#include "core/scene/names.h"
#include "core/scene/text.h"
#include "plugin/shot/shot.h"

namespace pelagic {

namespace {

std::string joined(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
    return out;
}

std::string indexed(const std::string& path, std::size_t index) {
    return path + '[' + std::to_string(index) + ']';
}

std::string inside_of(const std::string& path, const std::string& name) {
    return path.empty() ? name : path + '.' + name;
}

void refuse_type(Reader& reader, const toml::node& value, const std::string& path,
                 const std::string& accepted) {
    reader.refuse(value.source().begin, {path, text_of(value), "is " + type_of(value), accepted});
}

// ---- Tables, and lists of them
// -------------------------------------------------------------------------------------

template <class Owner>
std::vector<KeyHelp> help_of(const std::string& path) {
    std::vector<KeyHelp> out;
    for (const Key<Owner>& key : keys_of<Owner>()) {
        const std::string here = inside_of(path, key.name);
        out.push_back({here, key.fallback, key.accepted, key.unit, key.help, key.is_table});
        if (!key.inside) continue;
        for (KeyHelp& help : key.inside(here)) out.push_back(std::move(help));
    }
    return out;
}

template <class Owner>
std::vector<std::string> names_of() {
    std::vector<std::string> names;
    for (const Key<Owner>& key : keys_of<Owner>()) names.push_back(key.name);
    return names;
}

// What a person who wrote this unknown key may have meant: a key of the same table, else one of that name
// elsewhere.
std::string meant_key(const std::string& path, const std::string& name,
                      const std::vector<std::string>& known) {
    if (const std::string near = nearest(name, known); !near.empty()) return inside_of(path, near);
    std::vector<std::string> names;
    std::vector<std::string> paths;
    for (const KeyHelp& key : all_keys()) {
        if (key.is_table || key.path.find('[') != std::string::npos) continue;
        paths.push_back(key.path);
        names.push_back(key.path.substr(key.path.rfind('.') + 1));
    }
    const std::string near = nearest(name, names);
    if (near.empty()) return {};
    return paths[static_cast<std::size_t>(std::find(names.begin(), names.end(), near) - names.begin())];
}

template <class Owner>
void read_table(Reader& reader, const toml::table& table, const std::string& path, Owner& owner) {
    const std::vector<Key<Owner>>& keys = keys_of<Owner>();
    for (const auto& [name_in_file, value] : table) {
        const std::string name(name_in_file.str());
        const std::string here = inside_of(path, name);
        const auto key =
            std::find_if(keys.begin(), keys.end(), [&](const Key<Owner>& k) { return k.name == name; });
        if (key == keys.end()) {
            const std::vector<std::string> known = names_of<Owner>();
            const std::string meant = meant_key(path, name, known);
            reader.refuse(name_in_file.source().begin,
                          {here, text_of(value),
                           std::string(value.is_table() ? "is an unknown table" : "is an unknown key") +
                               (meant.empty() ? "" : ", the nearest is " + meant),
                           (path.empty() ? "the tables " : "in " + path + " the keys ") + joined(known)});
        } else if (!key->read) {
            reader.refuse(name_in_file.source().begin, {here, text_of(value), "is not built yet",
                                                        "a file without this key: " + key->accepted});
        } else {
            reader.remember(here, value.source().begin);
            key->read(reader, value, here, owner);
        }
    }
    for (const Key<Owner>& key : keys) {
        if (key.required && !table.contains(key.name)) {
            reader.refuse(table.source().begin, {inside_of(path, key.name), "(missing)", "has no default",
                                                 key.accepted + "; " + key.help});
        }
    }
}

// ---- Values: what is accepted of each type, the default's text, and the reading
// ------------------------------------

std::string words_text(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& word : words) {
        if (!out.empty()) out += ' ';
        out += quoted_text(word);
    }
    return out;
}

template <class Value>
struct Type;

template <>
struct Type<double> {
    static std::string accepted() { return "a number"; }
    static std::string fallback(double value) { return number_text(value); }
    static bool read(const toml::node& node, double& out) {
        // A whole number does for a number with a point, not the other way round.
        if (const auto* number = node.as_floating_point()) return out = number->get(), true;
        if (const auto* integer = node.as_integer()) return out = static_cast<double>(integer->get()), true;
        return false;
    }
};

// A key without a default of its own.
template <>
struct Type<std::optional<double>> : Type<double> {
    static std::string fallback(const std::optional<double>&) { return {}; }
    static bool read(const toml::node& node, std::optional<double>& out) {
        double value = 0.0;
        if (!Type<double>::read(node, value)) return false;
        out = value;
        return true;
    }
};

template <std::integral Integer>
struct Type<Integer> {
    static std::string accepted() { return "an integer"; }
    static std::string fallback(Integer value) { return std::to_string(value); }
    static bool read(const toml::node& node, Integer& out) {
        const auto* integer = node.as_integer();
        if (!integer || !std::in_range<Integer>(integer->get())) return false;
        out = static_cast<Integer>(integer->get());
        return true;
    }
};

template <>
struct Type<bool> {
    static std::string accepted() { return "true or false"; }
    static std::string fallback(bool value) { return value ? "true" : "false"; }
    static bool read(const toml::node& node, bool& out) {
        const auto* truth = node.as_boolean();
        if (truth) out = truth->get();
        return truth != nullptr;
    }
};

template <>
struct Type<std::string> {
    static std::string accepted() { return "a string"; }
    static std::string fallback(const std::string& value) { return quoted_text(value); }
    static bool read(const toml::node& node, std::string& out) {
        const auto* text = node.as_string();
        if (text) out = text->get();
        return text != nullptr;
    }
};

template <class Choice>
requires std::is_enum_v<Choice>
struct Type<Choice> {
    static std::string accepted() { return "one of " + words_text(all_words<Choice>()); }
    static std::string fallback(Choice value) { return quoted_text(word_of(value)); }
};

template <>
struct Type<glm::dvec3> {
    static std::string accepted() { return "[x, y, z], three numbers"; }
    static std::string fallback(const glm::dvec3& v) {
        return '[' + joined({number_text(v.x), number_text(v.y), number_text(v.z)}) + ']';
    }
};

template <>
struct Type<glm::ivec2> {
    static std::string accepted() { return "[width, height], two integers"; }
    static std::string fallback(const glm::ivec2& v) {
        return '[' + std::to_string(v.x) + ", " + std::to_string(v.y) + ']';
    }
};

template <class Element>
struct Type<std::vector<Element>> {
    static std::string accepted() {
        if constexpr (std::is_enum_v<Element>) {
            return "a list of " + words_text(all_words<Element>());
        } else {
            return "a list of { " + joined(names_of<Element>()) + " }";
        }
    }
    static std::string fallback(const std::vector<Element>& list) {
        std::vector<std::string> texts;
        if constexpr (std::is_enum_v<Element>) {
            for (const Element element : list) texts.push_back(Type<Element>::fallback(element));
        }
        return '[' + joined(texts) + ']';
    }
};

// One value to read: where it stands and what is accepted there, for messages.
struct Asked {
    const toml::node& node;
    std::string path;
    std::string accepted;
};

// Numbers, truths and strings. An integer too large for its type is refused like one outside its range.
template <class Value>
bool read_value(Reader& reader, const Asked& asked, Value& out) {
    if (Type<Value>::read(asked.node, out)) return true;
    if (std::is_integral_v<Value> && !std::is_same_v<Value, bool> && asked.node.is_integer()) {
        reader.refuse(asked.node.source().begin,
                      {asked.path, text_of(asked.node), "is outside the range", asked.accepted});
    } else {
        refuse_type(reader, asked.node, asked.path, asked.accepted);
    }
    return false;
}

template <class Choice>
requires std::is_enum_v<Choice>
bool read_value(Reader& reader, const Asked& asked, Choice& out) {
    const auto* text = asked.node.as_string();
    if (!text) return refuse_type(reader, asked.node, asked.path, asked.accepted), false;
    if (const auto choice = choice_of<Choice>(text->get())) return out = *choice, true;
    const std::string near = nearest(text->get(), all_words<Choice>());
    reader.refuse(asked.node.source().begin,
                  {asked.path, text_of(asked.node),
                   "is not one of the words" + (near.empty() ? "" : ", the nearest is " + quoted_text(near)),
                   "one of " + words_text(all_words<Choice>())});
    return false;
}

// A list of exactly this many numbers.
template <class Number>
bool read_numbers(Reader& reader, const Asked& asked, std::span<Number> out) {
    const auto* list = asked.node.as_array();
    if (!list) return refuse_type(reader, asked.node, asked.path, asked.accepted), false;
    if (list->size() != out.size()) {
        reader.refuse(asked.node.source().begin,
                      {asked.path, text_of(asked.node), "is a list of " + std::to_string(list->size()),
                       asked.accepted});
        return false;
    }
    bool good = true;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const toml::node& element = *list->get(i);
        reader.remember(indexed(asked.path, i), element.source().begin);
        good = read_value(reader, {element, indexed(asked.path, i), asked.accepted}, out[i]) && good;
    }
    if (!good) reader.mark_failed(asked.path);
    return good;
}

bool read_value(Reader& reader, const Asked& asked, glm::dvec3& out) {
    std::array<double, 3> numbers{};
    if (!read_numbers(reader, asked, std::span<double>(numbers))) return false;
    out = {numbers[0], numbers[1], numbers[2]};
    return true;
}

bool read_value(Reader& reader, const Asked& asked, glm::ivec2& out) {
    std::array<int, 2> numbers{};
    if (!read_numbers(reader, asked, std::span<int>(numbers))) return false;
    out = {numbers[0], numbers[1]};
    return true;
}

// Whether validate() judges an element of a list by itself. Where it compares elements, one that couldn't be
// read would make the others look wrong.
template <class Element>
constexpr bool kIsJudgedAlone = std::is_same_v<Element, Swell>;

template <class Element>
bool read_value(Reader& reader, const Asked& asked, std::vector<Element>& out) {
    const auto* list = asked.node.as_array();
    if (!list) return refuse_type(reader, asked.node, asked.path, asked.accepted), false;
    std::vector<Element> elements;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const toml::node& node = *list->get(i);
        const std::string path = indexed(asked.path, i);
        reader.remember(path, node.source().begin);
        Element element{};
        const std::size_t problems_before = reader.problem_count();
        if constexpr (std::is_enum_v<Element>) {
            read_value(reader, {node, path, asked.accepted}, element);
        } else if (const auto* table = node.as_table()) {
            read_table(reader, *table, path, element);
        } else {
            refuse_type(reader, node, path, "{ " + joined(names_of<Element>()) + " }");
        }
        if (reader.problem_count() > problems_before) {
            reader.mark_failed(kIsJudgedAlone<Element> ? path : asked.path);
        }
        // An element that was refused stays, as its default, so that the others keep their numbers in
        // messages.
        elements.push_back(element);
    }
    out = std::move(elements);
    return true;
}

// ---- The words of one key, and the making of it
// ---------------------------------------------------------------------

struct Words {
    std::string name;
    std::string help;
    std::string unit = {};
    std::string range = {};     // added to what the type accepts: "0 … 80"
    std::string accepted = {};  // instead of both
};

std::string accepted_text(const Words& words, const std::string& type) {
    if (!words.accepted.empty()) return words.accepted;
    return words.range.empty() ? type : type + ", " + words.range;
}

template <class Element>
struct IsListOfTables : std::false_type {};
template <class Element>
struct IsListOfTables<std::vector<Element>> : std::bool_constant<!std::is_enum_v<Element>> {};

// A value that is a member of its owner; its default is the one that scene.h gives it.
template <class Owner, class Value>
Key<Owner> value(Value Owner::*member, const Words& words) {
    Key<Owner> key{.name = words.name,
                   .fallback = Type<Value>::fallback(Owner{}.*member),
                   .accepted = accepted_text(words, Type<Value>::accepted()),
                   .unit = words.unit,
                   .help = words.help};
    key.read = [member, accepted = key.accepted](Reader& reader, const toml::node& node,
                                                 const std::string& path, Owner& owner) {
        read_value(reader, Asked{node, path, accepted}, owner.*member);
    };
    if constexpr (IsListOfTables<Value>::value) {
        key.inside = [](const std::string& path) { return help_of<typename Value::value_type>(path + "[]"); };
    }
    return key;
}

// A value without which its table means nothing.
template <class Owner, class Value>
Key<Owner> required(Value Owner::*member, const Words& words) {
    Key<Owner> key = value(member, words);
    key.required = true;
    key.fallback.clear();
    return key;
}

// A table of the scene.
template <class Table>
Key<Scene> table(Table Scene::*member, const Words& words) {
    Key<Scene> key{.name = words.name, .fallback = {}, .accepted = {}, .unit = {}, .help = words.help};
    key.is_table = true;
    key.read = [member, name = words.name](Reader& reader, const toml::node& node, const std::string& path,
                                           Scene& scene) {
        if (const auto* inner = node.as_table()) return read_table(reader, *inner, path, scene.*member);
        refuse_type(reader, node, path, "a table, [" + name + "], of " + joined(names_of<Table>()));
    };
    key.inside = [](const std::string& path) { return help_of<Table>(path); };
    return key;
}

// A key whose feature comes later: known, so that its name is taken, and refused, saying what to do
// meanwhile.
template <class Owner>
Key<Owner> not_built(const Words& words) {
    return {.name = words.name,
            .fallback = {},
            .accepted = words.accepted,
            .unit = words.unit,
            .help = words.help};
}

// ---- Keys that are more than a value of their own
// -------------------------------------------------------------------

void read_frames(Reader& reader, const toml::node& node, const std::string& path, Shot& shot) {
    std::array<int, 2> frames{};
    const Asked asked{node, path, "[first, last], two integers of " + text_of(limits::kFrame)};
    if (!read_numbers(reader, asked, std::span<int>(frames))) return;
    shot.first_frame = frames[0];
    shot.last_frame = frames[1];
}

Key<Shot> frames_key() {
    const Shot shot;
    Key<Shot> key{
        .name = "frames",
        .fallback = '[' + std::to_string(shot.first_frame) + ", " + std::to_string(shot.last_frame) + ']',
        .accepted = "[first, last], two integers of " + text_of(limits::kFrame),
        .unit = {},
        .help = "both included; frame f shows t = (f - 1)/fps, whatever the range"};
    key.read = read_frames;
    return key;
}

Key<SeaState> spectrum_file_key() {
    Key<SeaState> key{
        .name = "spectrum_file",
        .fallback = {},
        .accepted = "a string, the path of NDBC's w file, from the shot file's folder",
        .unit = {},
        .help = "with spectrum = \"file\": the densities; the files d, i, j and k lie beside it"};
    key.read = [accepted = key.accepted](Reader& reader, const toml::node& node, const std::string& path,
                                         SeaState&) {
        std::string file;
        if (read_value(reader, Asked{node, path, accepted}, file)) reader.spectrum_file = file;
    };
    return key;
}

// A zone has to be said: the buoys' times are UTC, and a time without one would be taken for local time by
// many.
Key<SeaState> spectrum_time_key() {
    Key<SeaState> key{.name = "spectrum_time",
                      .fallback = {},
                      .accepted = "a date and time with its zone, such as 2019-02-06T00:40:00Z",
                      .unit = {},
                      .help = "with spectrum = \"file\": one of the file's times, which are UTC"};
    key.read = [accepted = key.accepted](Reader& reader, const toml::node& node, const std::string& path,
                                         SeaState&) {
        const auto* both = node.as_date_time();
        if (!both) return refuse_type(reader, node, path, accepted);
        const toml::date_time& moment = both->get();
        if (!moment.offset) {
            return reader.refuse(node.source().begin,
                                 {path, text_of(node), "does not say its time zone", accepted});
        }
        if (moment.time.nanosecond != 0) {
            return reader.refuse(node.source().begin,
                                 {path, text_of(node), "has a part of a second", accepted});
        }
        const std::chrono::year_month_day date{std::chrono::year(moment.date.year),
                                               std::chrono::month(moment.date.month),
                                               std::chrono::day(moment.date.day)};
        reader.spectrum_time = std::chrono::sys_days{date} + std::chrono::hours{moment.time.hour} +
                               std::chrono::minutes{moment.time.minute - moment.offset->minutes} +
                               std::chrono::seconds{moment.time.second};
    };
    return key;
}

// "auto", or a list in any order: the scene wants the largest first.
void read_cascades(Reader& reader, const Asked& asked, Waves& waves) {
    if (const auto* word = asked.node.as_string(); word && word->get() == "auto")
        return waves.cascades.clear();
    if (asked.node.is_string()) {
        return reader.refuse(asked.node.source().begin,
                             {asked.path, text_of(asked.node), "is not the word \"auto\"", asked.accepted});
    }
    std::vector<CascadeSize> given;
    if (!read_value(reader, asked, given)) return;
    if (given.empty()) {
        return reader.refuse(asked.node.source().begin,
                             {asked.path, "[]", "is a sea without waves", asked.accepted + ", at least one"});
    }
    std::vector<std::size_t> order(given.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto is_comparable = [](const CascadeSize& cascade) { return !std::isnan(cascade.size_m); };
    if (std::all_of(given.begin(), given.end(), is_comparable)) {
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return given[a].size_m > given[b].size_m; });
    }
    waves.cascades.clear();
    for (std::size_t i = 0; i < order.size(); ++i) {
        waves.cascades.push_back(given[order[i]]);
        reader.rename(indexed(asked.path, i), indexed(asked.path, order[i]));
    }
}

Key<Waves> cascades_key() {
    Key<Waves> key{.name = "cascades",
                   .fallback = quoted_text("auto"),
                   .accepted = "\"auto\", or a list of { size_m, resolution }",
                   .unit = {},
                   .help =
                       "the periodic tiles; auto: four, from the spectrum's peak down, and none with "
                       "trochoid. Their bands "
                       "depend on the sizes alone; a resolution that leaves a gap is refused"};
    key.read = [accepted = key.accepted](Reader& reader, const toml::node& node, const std::string& path,
                                         Waves& waves) {
        read_cascades(reader, Asked{node, path, accepted}, waves);
    };
    key.inside = [](const std::string& path) { return help_of<CascadeSize>(path + "[]"); };
    return key;
}

}  // namespace

// ---- The description of a shot file
// ---------------------------------------------------------------------------------

template <>
const std::vector<Key<Shot>>& keys_of() {
    static const std::vector<Key<Shot>> keys{
        value(&Shot::name, {.name = "name",
                            .help = "names the files and the stage's root prim",
                            .range = "of letters, digits, _ and -, at most 200"}),
        frames_key(),
        value(&Shot::fps,
              {.name = "fps", .help = "frames a second", .unit = "1/s", .range = text_of(limits::kFps)}),
        value(&Shot::seed, {.name = "seed",
                            .help = "another seed, another sea of the same weather",
                            .range = "0 … 9223372036854775807"}),
        value(&Shot::loop_s,
              {.name = "loop_s",
               .help = "above 0: the sea repeats exactly after this long, a whole number of frames",
               .unit = "s",
               .range = text_of(limits::kLoop_s)}),
    };
    return keys;
}

template <>
const std::vector<Key<Swell>>& keys_of() {
    static const std::vector<Key<Swell>> keys{
        required(&Swell::height_m, {.name = "height_m",
                                    .help = "significant height, 4 times the root of the variance",
                                    .unit = "m",
                                    .range = text_of(limits::kSwellHeight_m)}),
        required(&Swell::period_s, {.name = "period_s",
                                    .help = "period of the peak",
                                    .unit = "s",
                                    .range = text_of(limits::kSwellPeriod_s)}),
        required(&Swell::direction_deg, {.name = "direction_deg",
                                         .help = "travelling towards, counter-clockwise from +x",
                                         .unit = "degrees",
                                         .range = text_of(limits::kAngle_deg)}),
    };
    return keys;
}

template <>
const std::vector<Key<SeaState>>& keys_of() {
    static const std::vector<Key<SeaState>> keys{
        value(&SeaState::wind_speed_mps, {.name = "wind_speed_mps",
                                          .help = "10 m above the sea",
                                          .unit = "m/s",
                                          .range = text_of(limits::kWindSpeed_mps)}),
        value(&SeaState::wind_direction_deg, {.name = "wind_direction_deg",
                                              .help = "blowing towards, counter-clockwise from +x (east)",
                                              .unit = "degrees",
                                              .range = text_of(limits::kAngle_deg)}),
        value(&SeaState::fetch_m, {.name = "fetch_m",
                                   .help = "how far the wind has blown over water",
                                   .unit = "m",
                                   .range = text_of(limits::kFetch_m)}),
        value(&SeaState::depth_m, {.name = "depth_m",
                                   .help = "of the water",
                                   .unit = "m",
                                   .range = text_of(limits::kDepth_m) + ", or inf"}),
        value(&SeaState::spectrum,
              {.name = "spectrum", .help = "how the energy is shared among the wavelengths"}),
        value(&SeaState::spreading, {.name = "spreading", .help = "how it is shared among the directions"}),
        value(&SeaState::swell,
              {.name = "swell", .help = "waves of far storms, each a narrow spectrum of its own"}),
        spectrum_file_key(),
        spectrum_time_key(),
    };
    return keys;
}

template <>
const std::vector<Key<CascadeSize>>& keys_of() {
    static const std::vector<Key<CascadeSize>> keys{
        required(&CascadeSize::size_m, {.name = "size_m",
                                        .help = "the tile's period; all sizes differ",
                                        .unit = "m",
                                        .range = text_of(limits::kCascadeSize_m)}),
        required(&CascadeSize::resolution, {.name = "resolution",
                                            .help = "samples a side, even",
                                            .range = text_of(limits::kCascadeResolution)}),
    };
    return keys;
}

template <>
const std::vector<Key<Waves>>& keys_of() {
    static const std::vector<Key<Waves>> keys{
        value(&Waves::model,
              {.name = "model", .help = "fft: periodic tiles; trochoid: a sum of wave trains"}),
        value(&Waves::choppiness, {.name = "choppiness",
                                   .help = "sharpness of the crests; 1 is the trochoid's own",
                                   .range = text_of(limits::kChoppiness)}),
        cascades_key(),
        value(&Waves::trains, {.name = "trains",
                               .help = "with trochoid: how many, their wavelengths in geometric progression",
                               .range = text_of(limits::kTrains)}),
        value(&Waves::shortest_m,
              {.name = "shortest_m",
               .help =
                   "with trochoid: the shortest train; what is shorter counts as variance, or is left to the "
                   "cascades if there are any. Without it: 2 cm, or shorter so that ten trains are below a "
                   "pixel; with cascades an eighth of the largest tile; at most a tenth of longest_m",
               .unit = "m",
               .range = text_of(limits::kTrain_m)}),
        value(&Waves::longest_m,
              {.name = "longest_m",
               .help = "with trochoid: the longest train; what is longer is not on the surface and counts as "
                       "variance. "
                       "Without it: all but 0.1 % of the energy is shorter; at least ten times shortest_m",
               .unit = "m",
               .range = text_of(limits::kTrain_m)}),
    };
    return keys;
}

template <>
const std::vector<Key<Surface>>& keys_of() {
    static const std::vector<Key<Surface>> keys{
        value(&Surface::kind, {.name = "kind",
                               .help = "what is baked: a square patch, or the projected grid of the camera. "
                                       "Pictures show the sea to the horizon, whatever stands here. "
                                       "The other kinds are not built yet"}),
        value(&Surface::size_m, {.name = "size_m",
                                 .help = "side of the patch, centred on the origin",
                                 .unit = "m",
                                 .range = text_of(limits::kSurfaceSize_m)}),
        value(&Surface::resolution,
              {.name = "resolution", .help = "quads a side", .range = text_of(limits::kSurfaceResolution)}),
        value(&Surface::cell_px, {.name = "cell_px",
                                  .help = "side of the projected grid's cells, in pictures and bakes",
                                  .unit = "pixels",
                                  .range = text_of(limits::kCell_px)}),
        not_built<Surface>({.name = "earth_curvature",
                            .help = "whether the far sea bends away",
                            .accepted = "use kind = \"patch\""}),
        not_built<Surface>(
            {.name = "cage_file", .help = "a coarse surface to refine", .accepted = "use kind = \"patch\""}),
        not_built<Surface>(
            {.name = "cage_level", .help = "how often it is refined", .accepted = "use kind = \"patch\""}),
    };
    return keys;
}

template <>
const std::vector<Key<CameraKey>>& keys_of() {
    const std::string range = "each " + text_of(limits::kCameraCoordinate_m);
    static const std::vector<Key<CameraKey>> keys{
        required(&CameraKey::frame,
                 {.name = "frame", .help = "rising from key to key", .range = text_of(limits::kFrame)}),
        required(&CameraKey::position_m,
                 {.name = "position_m", .help = "as above", .unit = "m", .range = range}),
        required(&CameraKey::look_at_m,
                 {.name = "look_at_m", .help = "as above", .unit = "m", .range = range}),
    };
    return keys;
}

template <>
const std::vector<Key<Camera>>& keys_of() {
    const std::string range = "each " + text_of(limits::kCameraCoordinate_m);
    static const std::vector<Key<Camera>> keys{
        value(&Camera::position_m, {.name = "position_m", .help = "z is up", .unit = "m", .range = range}),
        value(&Camera::look_at_m,
              {.name = "look_at_m", .help = "up is z; looking along z, +y", .unit = "m", .range = range}),
        value(&Camera::keys,
              {.name = "keys", .help = "for a moving camera: linear between keys, still outside"}),
        value(&Camera::fov_deg, {.name = "fov_deg",
                                 .help = "horizontal angle of view",
                                 .unit = "degrees",
                                 .range = text_of(limits::kFov_deg)}),
        value(&Camera::resolution, {.name = "resolution",
                                    .help = "of the picture",
                                    .unit = "pixels",
                                    .range = "each " + text_of(limits::kImageResolution)}),
    };
    return keys;
}

template <>
const std::vector<Key<Light>>& keys_of() {
    static const std::vector<Key<Light>> keys{
        value(&Light::sun_elevation_deg, {.name = "sun_elevation_deg",
                                          .help = "above the horizon",
                                          .unit = "degrees",
                                          .range = text_of(limits::kSunElevation_deg)}),
        value(&Light::sun_azimuth_deg, {.name = "sun_azimuth_deg",
                                        .help = "towards the sun, counter-clockwise from +x",
                                        .unit = "degrees",
                                        .range = text_of(limits::kAngle_deg)}),
        value(&Light::sky,
              {.name = "sky",
               .help = "clear daylight, or a picture of a sky: lat-long, middle column +x, azimuth "
                       "growing to the left, top row the zenith; its sun is found in it",
               .accepted = "\"daylight\", or the path of an .exr, from the shot file's folder"}),
        value(&Light::turbidity, {.name = "turbidity",
                                  .help = "haze of the daylight's air; 2 is very clear, 6 is hazy",
                                  .range = text_of(limits::kTurbidity)}),
    };
    return keys;
}

template <>
const std::vector<Key<Water>>& keys_of() {
    static const std::vector<Key<Water>> keys{
        value(&Water::type,
              {.name = "type",
               .help = "what the water holds besides plankton: nothing, some silt, much of it"}),
        value(&Water::chlorophyll_mg_m3, {.name = "chlorophyll_mg_m3",
                                          .help = "plankton: greens the water",
                                          .unit = "mg/m³",
                                          .range = text_of(limits::kChlorophyll_mg_m3)}),
    };
    return keys;
}

template <>
const std::vector<Key<Effects>>& keys_of() {
    static const std::vector<Key<Effects>> keys{
        value(&Effects::whitecaps,
              {.name = "whitecaps",
               .help = "foam where waves break; off, no output has coverage and none is computed"}),
        value(&Effects::spray, {.name = "spray", .help = "droplets over breaking crests; not built yet"}),
        value(&Effects::spray_gain,
              {.name = "spray_gain", .help = "with spray; only the default is built yet"}),
    };
    return keys;
}

template <>
const std::vector<Key<Quality>>& keys_of() {
    static const std::vector<Key<Quality>> keys{
        value(&Quality::level, {.name = "level", .help = "how much time accuracy may take"}),
        not_built<Quality>({.name = "max_error", .help = "a budget of error", .accepted = "use level"}),
        not_built<Quality>(
            {.name = "frame_ms", .help = "a budget of time", .unit = "ms", .accepted = "use level"}),
    };
    return keys;
}

template <>
const std::vector<Key<Output>>& keys_of() {
    static const std::vector<Key<Output>> keys{
        value(&Output::mesh,
              {.name = "mesh", .help = "how the mesh is written: as binary crates, as text, or not"}),
        value(&Output::attributes, {.name = "attributes", .help = "what the mesh carries per vertex"}),
        value(&Output::maps, {.name = "maps", .help = "images over the patch, a file a frame"}),
        value(&Output::map_resolution, {.name = "map_resolution",
                                        .help = "of the maps, a side",
                                        .unit = "pixels",
                                        .range = text_of(limits::kMapResolution)}),
        value(&Output::cascade_tiles,
              {.name = "cascade_tiles", .help = "each cascade's own periodic tile as well"}),
        value(&Output::mesh_scheme, {.name = "mesh_scheme",
                                     .help = "none: every vertex on the sea; catmullClark is not built yet"}),
        value(&Output::volumes, {.name = "volumes", .help = "not built yet"}),
        value(&Output::voxel_m,
              {.name = "voxel_m", .help = "of the volumes; only the default is built yet", .unit = "m"}),
    };
    return keys;
}

template <>
const std::vector<Key<Scene>>& keys_of() {
    static const std::vector<Key<Scene>> keys{
        table(&Scene::shot, {.name = "shot", .help = "what is made"}),
        table(&Scene::sea, {.name = "sea", .help = "the weather"}),
        table(&Scene::waves, {.name = "waves", .help = "how waves are made from it"}),
        table(&Scene::surface, {.name = "surface", .help = "where the sea is looked at"}),
        table(&Scene::camera, {.name = "camera", .help = "from where"}),
        table(&Scene::light, {.name = "light", .help = "sun and sky"}),
        table(&Scene::water, {.name = "water", .help = "the water body"}),
        table(&Scene::effects,
              {.name = "effects", .help = "what comes on top of the waves; off costs nothing"}),
        table(&Scene::quality, {.name = "quality", .help = "accuracy against time"}),
        table(&Scene::output, {.name = "output", .help = "what a bake writes"}),
    };
    return keys;
}

void read_scene(Reader& reader, const toml::table& root, Scene& scene) {
    read_table(reader, root, "", scene);
}

std::vector<KeyHelp> all_keys() {
    return help_of<Scene>("");
}

std::string describe_keys() {
    std::string out;
    for (const KeyHelp& key : all_keys()) {
        if (key.is_table) {
            out += (out.empty() ? "[" : "\n[") + key.path + "]  " + key.help + '\n';
            continue;
        }
        const bool is_built = !key.accepted.starts_with("use ");
        out += "  " + key.path + (key.fallback.empty() ? "" : " = " + key.fallback) + '\n';
        out += "      " + key.help + (key.unit.empty() ? "" : " [" + key.unit + "]") + '\n';
        out += "      " + (is_built ? key.accepted : "not built yet: " + key.accepted) + '\n';
    }
    return out;
}

}  // namespace pelagic
