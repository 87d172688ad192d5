#include "plugin/host/python/values.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/scene/names.h"
#include "plugin/format/shot/coast_file.h"
#include "plugin/format/shot/mask_files.h"
#include "plugin/format/shot/shot.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

// Tuples, because a list would be a copy whose append() is lost.
struct ToPython {
    const Key& key;
    py::object operator()(std::monostate) const { return py::none(); }
    py::object operator()(const std::vector<KeyEntry>& entries) const {
        const py::object made = entry_class(key);
        py::tuple out(entries.size());
        for (std::size_t i = 0; i < entries.size(); ++i) {
            py::tuple values(entries[i].values.size());
            for (std::size_t k = 0; k < values.size(); ++k)
                values[k] = std::visit(ToPython{key.entry_keys[k]}, entries[i].values[k].second);
            out[i] = made(*values);
        }
        return out;
    }
    // As a shot file has them.
    py::object operator()(const NumberKeys& number) const {
        py::tuple keys(number.keys.size());
        for (std::size_t i = 0; i < keys.size(); ++i)
            keys[i] = py::make_tuple(number.keys[i].frame, number.keys[i].value);
        py::dict made;
        made["keys"] = keys;
        made["interpolation"] = std::string(word_of(number.interpolation));
        return made;
    }
    // A path may be any bytes: those that aren't UTF-8 come as in Python's own names of files.
    py::object operator()(const std::string& text) const {
        return py::reinterpret_steal<py::object>(
            PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape"));
    }
    template <class Element>
    py::object operator()(const std::vector<Element>& list) const {
        return py::tuple(py::cast(list));
    }
    template <class Plain>
    py::object operator()(const Plain& value) const {
        return py::cast(value);
    }
};

[[noreturn]] void refuse_type(const Key& key, const std::string& path, py::handle given) {
    throw py::type_error(text_of(Problem{
        path, py::repr(given),
        "is of type " + std::string(py::str(py::type::handle_of(given).attr("__name__"))), key.accepted}));
}

template <class Value>
KeyValue cast_to(const Key& key, const std::string& path, py::handle given, bool convert = true) {
    py::detail::make_caster<Value> caster;
    if (!caster.load(given, convert)) refuse_type(key, path, given);
    return py::detail::cast_op<Value>(caster);
}

KeyValue from_python(const Key& key, const std::string& path, py::handle given);

// An entry: anything that has the keys as items, as dictionaries do, or as attributes.
KeyEntry entry_from_python(const Key& list, const std::string& path, py::handle given) {
    KeyEntry entry;
    const bool is_dict = py::isinstance<py::dict>(given);
    if (is_dict)
        for (const auto& [name, value] : given.cast<py::dict>())
            if (std::none_of(list.entry_keys.begin(), list.entry_keys.end(),
                             [&](const Key& key) { return py::str(name).equal(py::str(key.name)); }))
                refuse_type(list, path, given);
    for (const Key& key : list.entry_keys) {
        const py::str name(key.name);
        const bool has_key = is_dict ? given.contains(name) : py::hasattr(given, name);
        if (!has_key) {
            if (key.is_required) refuse_type(list, path, given);
            entry.values.emplace_back(key.name, key.fallback);
            continue;
        }
        const py::object value = is_dict ? py::object(given[name]) : py::object(given.attr(name));
        entry.values.emplace_back(key.name, from_python(key, path + '.' + key.name, value));
    }
    return entry;
}

// As ToPython gives them; without an interpolation they are "linear".
KeyValue number_keys_from_python(const Key& key, const std::string& path, const py::dict& given) {
    NumberKeys number;
    for (const auto& [name, value] : given) {
        if (py::str(name).equal(py::str("interpolation"))) {
            const auto word = py::isinstance<py::str>(value)
                                  ? pelagic::choice_of<CameraInterpolation>(value.cast<std::string>())
                                  : std::nullopt;
            if (!word)
                throw ShotError(text_of(unknown_word(pelagic::key_of("camera.interpolation"),
                                                     path + ".interpolation", std::string(py::str(value)))));
            number.interpolation = *word;
            continue;
        }
        py::detail::make_caster<std::vector<std::pair<int, double>>> keys;
        if (!py::str(name).equal(py::str("keys")) || !keys.load(value, true)) refuse_type(key, path, given);
        for (const auto& [frame, at] : py::detail::cast_op<std::vector<std::pair<int, double>>&>(keys))
            number.keys.push_back({frame, at});
    }
    return number;
}

KeyValue from_python(const Key& key, const std::string& path, py::handle given) {
    if (key.is_optional && given.is_none()) return {};
    switch (key.type) {
        case KeyType::Truth:
            return cast_to<bool>(key, path, given, false);
        case KeyType::Integer:
            if (!key.other_word.empty() && py::isinstance<py::str>(given)) return given.cast<std::string>();
            return cast_to<std::int64_t>(key, path, given);
        case KeyType::Number:
            if (py::isinstance<py::dict>(given))
                return number_keys_from_python(key, path, py::reinterpret_borrow<py::dict>(given));
            return cast_to<double>(key, path, given);
        case KeyType::Point:
            return cast_to<std::vector<double>>(key, path, given);
        case KeyType::Pair:
            return cast_to<std::vector<std::int64_t>>(key, path, given);
        case KeyType::Words:
            return cast_to<std::vector<std::string>>(key, path, given);
        case KeyType::Entries:
            break;
        case KeyType::Text:
        case KeyType::Word:
        case KeyType::DataFile:
        case KeyType::DataTime:
            if (py::isinstance<py::str>(given))
                return std::string(given.attr("encode")("utf-8", "surrogateescape").cast<py::bytes>());
            return cast_to<std::string>(key, path, given);
    }
    if (!key.other_word.empty() && py::isinstance<py::str>(given) &&
        std::string(py::str(given)) == key.other_word)
        return std::vector<KeyEntry>();
    if (py::isinstance<py::str>(given) || !py::isinstance<py::sequence>(given)) refuse_type(key, path, given);
    std::vector<KeyEntry> entries;
    for (const py::handle element : given)
        entries.push_back(entry_from_python(key, path + '[' + std::to_string(entries.size()) + ']', element));
    return entries;
}

}  // namespace

py::object& entry_class(const Key& key) {
    // Never freed: Python may be gone when a program ends.
    static auto& classes = *new std::unordered_map<std::string, py::object>;
    return classes[key.entry_name];
}

py::object to_python(const Key& key, const KeyValue& value) {
    return std::visit(ToPython{key}, value);
}

void set_from_python(Scene& scene, const Key& key, py::handle given) {
    const KeyValue value = from_python(key, key.path, given);
    const Waves waves_before = scene.waves;
    const SeaState sea_before = scene.sea;
    if (const auto problem = set_value(scene, key, value)) throw ShotError(text_of(*problem));
    std::vector<Problem> problems;
    if (key.path == "waves.masks") problems = read_mask_pictures(scene.waves, "");
    if (key.path == kCoastKey || (scene.waves.coast && key.path.starts_with("sea.depth_")))
        problems = read_coast_depths(scene);
    if (problems.empty()) return;
    scene.waves = waves_before;
    scene.sea = sea_before;
    throw ShotError(text_of(problems.front()));
}

const Key& key_at(std::string_view path) {
    const std::span<const Key> all = keys();
    const auto key = std::find_if(all.begin(), all.end(), [&](const Key& each) { return each.path == path; });
    if (key == all.end()) throw std::logic_error("no key is called " + std::string(path));
    return *key;
}

}  // namespace pelagic::python
