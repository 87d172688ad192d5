// How rows of the table of keys are made from the members of a struct. Used by keys.cpp alone.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <iterator>
#include <limits>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/scene/keys.h"
#include "core/scene/member_count.h"
#include "core/scene/names.h"

namespace pelagic {

// ---- Members as values, and back. take() is false, and changes nothing, where the value is of another type.

template <class Member>
struct MemberValue {};

template <>
struct MemberValue<bool> {
    static constexpr KeyType kType = KeyType::Truth;
    static KeyValue value(bool member) { return member; }
    static bool take(const KeyValue& value, bool& member) {
        if (const auto* truth = std::get_if<bool>(&value)) return member = *truth, true;
        return false;
    }
};

template <std::integral Integer>
requires(!std::same_as<Integer, bool>) struct MemberValue<Integer> {
    static constexpr KeyType kType = KeyType::Integer;
    static constexpr std::int64_t kLeast = std::numeric_limits<Integer>::min();
    static constexpr std::int64_t kLargest =  // a shot file's integers have 63 bits and a sign
        std::cmp_less(std::numeric_limits<Integer>::max(), std::numeric_limits<std::int64_t>::max())
            ? static_cast<std::int64_t>(std::numeric_limits<Integer>::max())
            : std::numeric_limits<std::int64_t>::max();
    static KeyValue value(Integer member) {
        return static_cast<std::int64_t>(std::cmp_greater(member, kLargest) ? static_cast<Integer>(kLargest)
                                                                            : member);
    }
    static bool take(const KeyValue& value, Integer& member) {
        const auto* integer = std::get_if<std::int64_t>(&value);
        if (!integer || !std::in_range<Integer>(*integer)) return false;
        member = static_cast<Integer>(*integer);
        return true;
    }
};

template <>
struct MemberValue<double> {
    static constexpr KeyType kType = KeyType::Number;
    static KeyValue value(double member) { return member; }
    static bool take(const KeyValue& value, double& member) {
        if (const auto* number = std::get_if<double>(&value)) return member = *number, true;
        if (const auto* integer = std::get_if<std::int64_t>(&value))
            return member = static_cast<double>(*integer), true;
        return false;
    }
};

template <>
struct MemberValue<std::optional<double>> {
    static constexpr KeyType kType = KeyType::Number;
    static KeyValue value(const std::optional<double>& member) {
        return member ? KeyValue(*member) : KeyValue();
    }
    static bool take(const KeyValue& value, std::optional<double>& member) {
        if (std::holds_alternative<std::monostate>(value)) return member.reset(), true;
        double number = 0.0;
        if (!MemberValue<double>::take(value, number)) return false;
        return member = number, true;
    }
};

template <>
struct MemberValue<std::string> {
    static constexpr KeyType kType = KeyType::Text;
    static KeyValue value(const std::string& member) { return member; }
    static bool take(const KeyValue& value, std::string& member) {
        if (const auto* text = std::get_if<std::string>(&value)) return member = *text, true;
        return false;
    }
};

template <>
struct MemberValue<std::optional<std::string>> {
    static constexpr KeyType kType = KeyType::Text;
    static KeyValue value(const std::optional<std::string>& member) {
        return member ? KeyValue(*member) : KeyValue();
    }
    static bool take(const KeyValue& value, std::optional<std::string>& member) {
        if (std::holds_alternative<std::monostate>(value)) return member.reset(), true;
        std::string text;
        if (!MemberValue<std::string>::take(value, text)) return false;
        return member = std::move(text), true;
    }
};

template <class Choice>
requires std::is_enum_v<Choice>
struct MemberValue<Choice> {
    static constexpr KeyType kType = KeyType::Word;
    static KeyValue value(Choice member) { return std::string(word_of(member)); }
    static bool take(const KeyValue& value, Choice& member) {
        const auto* word = std::get_if<std::string>(&value);
        const std::optional<Choice> choice = word ? choice_of<Choice>(*word) : std::nullopt;
        if (choice) member = *choice;
        return choice.has_value();
    }
};

template <class Choice>
requires std::is_enum_v<Choice>
struct MemberValue<std::vector<Choice>> {
    static constexpr KeyType kType = KeyType::Words;
    static KeyValue value(const std::vector<Choice>& member) {
        std::vector<std::string> words;
        for (const Choice choice : member) words.emplace_back(word_of(choice));
        return words;
    }
    static bool take(const KeyValue& value, std::vector<Choice>& member) {
        const auto* words = std::get_if<std::vector<std::string>>(&value);
        if (!words) return false;
        std::vector<Choice> choices;
        for (const std::string& word : *words) {
            const std::optional<Choice> choice = choice_of<Choice>(word);
            if (!choice) return false;
            choices.push_back(*choice);
        }
        member = std::move(choices);
        return true;
    }
};

template <>
struct MemberValue<glm::dvec3> {
    static constexpr KeyType kType = KeyType::Point;
    static KeyValue value(const glm::dvec3& member) {
        return std::vector<double>{member.x, member.y, member.z};
    }
    static bool take(const KeyValue& value, glm::dvec3& member) {
        const auto* numbers = std::get_if<std::vector<double>>(&value);
        if (!numbers || numbers->size() != 3) return false;
        member = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
        return true;
    }
};

template <>
struct MemberValue<std::array<int, 2>> {
    static constexpr KeyType kType = KeyType::Pair;
    static constexpr std::int64_t kLeast = MemberValue<int>::kLeast, kLargest = MemberValue<int>::kLargest;
    static KeyValue value(const std::array<int, 2>& member) {
        return std::vector<std::int64_t>{member[0], member[1]};
    }
    static bool take(const KeyValue& value, std::array<int, 2>& member) {
        const auto* numbers = std::get_if<std::vector<std::int64_t>>(&value);
        if (!numbers || numbers->size() != 2 || !std::in_range<int>((*numbers)[0]) ||
            !std::in_range<int>((*numbers)[1]))
            return false;
        member = {static_cast<int>((*numbers)[0]), static_cast<int>((*numbers)[1])};
        return true;
    }
};

// A whole number, or the word in its place.
template <>
struct MemberValue<CageLevel> {
    static constexpr KeyType kType = KeyType::Integer;
    static constexpr std::int64_t kLeast = MemberValue<int>::kLeast, kLargest = MemberValue<int>::kLargest;
    static constexpr const char* kOtherWord = "adaptive";
    static KeyValue value(const CageLevel& member) {
        if (member.is_adaptive) return std::string(kOtherWord);
        return MemberValue<int>::value(member.splits);
    }
    static bool take(const KeyValue& value, CageLevel& member) {
        const auto* word = std::get_if<std::string>(&value);
        int splits = CageLevel{}.splits;
        if (word ? *word != kOtherWord : !MemberValue<int>::take(value, splits)) return false;
        member = {.splits = splits, .is_adaptive = word != nullptr};
        return true;
    }
};

template <>
struct MemberValue<glm::ivec2> {
    static constexpr KeyType kType = KeyType::Pair;
    static constexpr std::int64_t kLeast = MemberValue<int>::kLeast, kLargest = MemberValue<int>::kLargest;
    static KeyValue value(const glm::ivec2& member) {
        return MemberValue<std::array<int, 2>>::value({member.x, member.y});
    }
    static bool take(const KeyValue& value, glm::ivec2& member) {
        std::array<int, 2> numbers{};
        if (!MemberValue<std::array<int, 2>>::take(value, numbers)) return false;
        member = {numbers[0], numbers[1]};
        return true;
    }
};

// ---- Rows

// What a row says about a key beyond what follows from the key's member.
struct About {
    const char* name;
    const char* help;
    const char* unit = "";
    std::optional<Range> range = {};
    std::optional<SoftRange> soft = {};
    const char* form = "";      // of texts and pairs: "a string, of letters"
    const char* accepted = "";  // instead of what type and range say
    KeyPartSet key_parts = {};
    bool may_be_infinite = false;
    bool may_have_keys = false;
    bool is_angle = false;
    bool is_silent_off = false;
    bool is_picture = false;
    bool may_be_mesh = false;
    const char* of_picture = "";
    const char* other_word = "";
    std::size_t most_entries = ~std::size_t{0};
    bool are_entries_independent = true;
    const char* entry_name = "";
};

// A key of the struct Owner that describes so many of its members.
template <class Owner, std::size_t kCount>
struct Row {
    static constexpr std::size_t kMembers = kCount;
    Key key;
    std::function<KeyValue(const Owner&)> get;
    std::function<bool(Owner&, const KeyValue&)> set;
};

template <class Pointer>
struct Pointee;
template <class OfStruct, class OfType>
struct Pointee<OfType OfStruct::*> {
    using Owner = OfStruct;
    using Value = OfType;
};

// What a shot file may say for this key, from its type, range and choices.
std::string accepted_text(const Key& key, const About& about);

// "wind_speed_mps" → "Wind speed": without the unit, which a key has as a member of its own.
std::string label_of(std::string_view name, bool has_unit);

Key key_about(const About& about, KeyType type);

template <class Value>
Key key_of_member(const About& about) {
    Key key = key_about(about, MemberValue<Value>::kType);
    if constexpr (requires { MemberValue<Value>::kLeast; }) {
        key.least = MemberValue<Value>::kLeast;
        key.largest = MemberValue<Value>::kLargest;
    }
    key.is_optional =
        std::same_as<Value, std::optional<double>> || std::same_as<Value, std::optional<std::string>>;
    if constexpr (requires { MemberValue<Value>::kOtherWord; })
        key.other_word = MemberValue<Value>::kOtherWord;
    const auto add_choices = [&]<class Choice>(Choice) {
        for (const Word<Choice>& entry : words_of(Choice{})) key.choices.emplace_back(entry.word);
    };
    if constexpr (std::is_enum_v<Value>) add_choices(Value{});
    if constexpr (requires { typename Value::value_type; }) {
        if constexpr (std::is_enum_v<typename Value::value_type>) add_choices(typename Value::value_type{});
    }
    key.accepted = accepted_text(key, about);
    return key;
}

// A key that is a member of its struct.
template <auto kMember, class Owner = typename Pointee<decltype(kMember)>::Owner,
          class Value = typename Pointee<decltype(kMember)>::Value>
Row<Owner, 1> row(const About& about) {
    return {
        key_of_member<Value>(about),
        [](const Owner& owner) { return MemberValue<Value>::value(owner.*kMember); },
        [](Owner& owner, const KeyValue& value) { return MemberValue<Value>::take(value, owner.*kMember); }};
}

// The same in the entries of a list, where it has no default: every entry must give it.
template <auto kMember>
auto required(const About& about) {
    auto made = row<kMember>(about);
    made.key.is_required = true;
    return made;
}

// A list of tables, whose keys are rows of the entries' struct.
template <auto kMember, class... Rows>
auto entries(const About& about, Rows... rows) {
    using Owner = typename Pointee<decltype(kMember)>::Owner;
    using List = typename Pointee<decltype(kMember)>::Value;
    using Entry = typename List::value_type;
    static_assert((Rows::kMembers + ...) == member_count<Entry>(), "a member without a key");
    Key key = key_about(about, KeyType::Entries);
    (key.entry_keys.push_back(rows.key), ...);
    key.accepted = accepted_text(key, about);
    const Entry first{};
    std::size_t index = 0;
    ((key.entry_keys[index++].fallback = rows.get(first)), ...);
    // Entries point at the names of these rows, which last as long as the program.
    const auto shared = std::make_shared<const std::tuple<Rows...>>(std::move(rows)...);
    const auto get = [shared](const Owner& owner) {
        std::vector<KeyEntry> out;
        for (const Entry& entry : owner.*kMember) {
            KeyEntry& made = out.emplace_back();
            std::apply(
                [&](const Rows&... each) {
                    (made.values.emplace_back(std::string_view(each.key.name), each.get(entry)), ...);
                },
                *shared);
        }
        return KeyValue(std::move(out));
    };
    const auto set = [shared](Owner& owner, const KeyValue& value) {
        const auto* given = std::get_if<std::vector<KeyEntry>>(&value);
        if (!given) return false;
        List list;
        for (const KeyEntry& entry : *given) {
            Entry made{};
            const auto take = [&](const auto& each) {
                const auto found =
                    std::find_if(entry.values.begin(), entry.values.end(),
                                 [&](const auto& pair) { return pair.first == each.key.name; });
                return found != entry.values.end() && each.set(made, found->second);
            };
            if (entry.values.size() != sizeof...(Rows) ||
                !std::apply([&](const Rows&... each) { return (take(each) && ...); }, *shared))
                return false;
            list.push_back(made);
        }
        owner.*kMember = std::move(list);
        return true;
    };
    return Row<Owner, 1>{std::move(key), get, set};
}

// A key whose struct has one more member: what hosts read from the files that it names.
template <class Owner>
Row<Owner, 2> with_data(Row<Owner, 1> made) {
    return {std::move(made.key), std::move(made.get), std::move(made.set)};
}

// Lets the key of a number have NumberKeys as well.
void allow_keys(Key& key);
// The same for those of a list's entries that may have some. A number's path has its entry's index: "sea.swell[1].height_m".
void allow_keys_in_entries(Key& key);

// A table of the scene, its rows' access moved from the table's struct to the scene.
template <auto kTable, class... Rows>
void add_table(std::vector<KeyTable>& tables, std::vector<Key>& keys, KeyTable about, Rows... rows) {
    using Table = typename Pointee<decltype(kTable)>::Value;
    static_assert((Rows::kMembers + ...) == member_count<Table>(), "a member without a key");
    const auto add = [&]<class Any>(Any made) {
        Key key = std::move(made.key);
        key.path = about.name + '.' + key.name;
        for (Key& inner : key.entry_keys) inner.path = key.path + "[]." + inner.name;
        if (made.get) {
            key.get = [get = std::move(made.get)](const Scene& scene) { return get(scene.*kTable); };
            key.fallback = key.get(Scene{});
        }
        if (made.set)
            key.set = [set = std::move(made.set)](Scene& scene, const KeyValue& value) {
                return set(scene.*kTable, value);
            };
        if (key.may_have_keys) allow_keys(key);
        if (std::ranges::any_of(key.entry_keys, &Key::may_have_keys)) allow_keys_in_entries(key);
        keys.push_back(std::move(key));
    };
    (add(std::move(rows)), ...);
    about.copy = [prefix = about.name + '.'](const Scene& from, Scene& to) {
        const auto is_ours = [&](const KeyedNumber& number) { return number.path.starts_with(prefix); };
        to.*kTable = from.*kTable;
        const std::vector<KeyedNumber> given = from.keyed;  // the two scenes may be one
        std::erase_if(to.keyed, is_ours);
        std::copy_if(given.begin(), given.end(), std::back_inserter(to.keyed), is_ours);
    };
    tables.push_back(std::move(about));
}

// A list of the scene's own, [[name]] in the shot file: a table of one key, whose path is its name.
template <auto kList>
void add_list(std::vector<KeyTable>& tables, std::vector<Key>& keys, Row<Scene, 1> made) {
    Key key = std::move(made.key);
    key.path = key.name;
    for (Key& inner : key.entry_keys) inner.path = key.path + "[]." + inner.name;
    key.fallback = made.get(Scene{});
    key.get = std::move(made.get);
    key.set = std::move(made.set);
    tables.push_back({key.name, key.help, {}, [](const Scene& from, Scene& to) { to.*kList = from.*kList; }});
    keys.push_back(std::move(key));
}

}  // namespace pelagic
