// Named weathers and seas: values for some keys of a scene, which hosts offer in a menu.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene/keys.h"

namespace pelagic {

enum class PresetGroup { Beaufort, Sea };

// "beaufort", "sea".
std::string_view word_of(PresetGroup group);

struct Preset {
    std::string name;   // letters, digits and -, such as "beaufort-8"; no two are the same
    std::string label;  // for a menu: "8 Gale"
    std::string help;   // what it looks like
    PresetGroup group;
    // Paths of keys and their values, at most one value for each path.
    std::vector<std::pair<std::string, KeyValue>> values;
};

// Beaufort 0 … 12, which set the wind sea and leave swell, direction, depth, light and water as they are; then
// the named seas, which set the whole of [sea], [waves], [light] and [water].
//
// The winds are the middle of each force, the wave heights in the open sea those of the World Meteorological
// Organization's table (Manual on Codes, WMO-No. 306, 1100) from force 4 up. Lighter winds alone, without an
// older swell, don't raise as much in any fetch.
std::span<const Preset> presets();

// Null: there is none.
const Preset* find_preset(std::string_view name);

// What is wrong with a name that no preset has, for `key`; with the nearest that there is.
Problem unknown_preset(const std::string& key, const std::string& name);

// Into a scene of any edition: what the preset leaves at its default gets that edition's.
void apply(const Preset& preset, Scene& scene);

}  // namespace pelagic
