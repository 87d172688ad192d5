// All keys of a shot file, each described once: from this description the parser, its messages and the help
// are made.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plugin/shot/reader.h"

namespace pelagic {

// A key as the help shows it.
struct KeyHelp {
    std::string path;  // "sea.swell[].height_m"
    std::string
        fallback;  // the default as the shot file would write it; empty: a table, or a key without default
    std::string accepted;  // "a number, 0 … 80"
    std::string unit;      // "m/s"; empty: none
    std::string help;
    bool is_table = false;
};

// A key of the struct Owner.
template <class Owner>
struct Key {
    std::string name;
    std::string fallback;
    std::string accepted;
    std::string unit;
    std::string help;
    bool required = false;
    bool is_table = false;

    // Reads the value at `path` into its owner, or tells the reader why not. Empty: the key is known, and not
    // built.
    std::function<void(Reader&, const toml::node& value, const std::string& path, Owner&)> read = {};

    // The keys inside, for tables and lists of tables; empty for values.
    std::function<std::vector<KeyHelp>(const std::string& path)> inside = {};
};

// The keys of a struct, in the order of the shot file's description. Written for Scene, whose keys are the
// tables, for each table, and for the entries of lists.
template <class Owner>
const std::vector<Key<Owner>>& keys_of();
template <>
const std::vector<Key<Scene>>& keys_of();
template <>
const std::vector<Key<Shot>>& keys_of();
template <>
const std::vector<Key<SeaState>>& keys_of();
template <>
const std::vector<Key<Swell>>& keys_of();
template <>
const std::vector<Key<Waves>>& keys_of();
template <>
const std::vector<Key<CascadeSize>>& keys_of();
template <>
const std::vector<Key<Surface>>& keys_of();
template <>
const std::vector<Key<Camera>>& keys_of();
template <>
const std::vector<Key<CameraKey>>& keys_of();
template <>
const std::vector<Key<Light>>& keys_of();
template <>
const std::vector<Key<Water>>& keys_of();
template <>
const std::vector<Key<Effects>>& keys_of();
template <>
const std::vector<Key<Quality>>& keys_of();
template <>
const std::vector<Key<Output>>& keys_of();

// Reads a whole shot file into the scene. Values that can't be used are told to the reader, and stay at their
// defaults.
void read_scene(Reader& reader, const toml::table& root, Scene& scene);

// Every key of a shot file.
std::vector<KeyHelp> all_keys();

}  // namespace pelagic
