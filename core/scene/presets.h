// Named weathers and seas: values for some keys of a scene, which hosts offer in a menu.
#pragma once

#include <array>
#include <bitset>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/keys.h"

namespace pelagic {

enum class PresetGroup { Beaufort, Sea };

// "beaufort", "sea".
std::string_view word_of(PresetGroup group);

// What of a look a preset gives: the sea with its waves, effects and bubbles, the light, the camera, the water.
enum class PresetPart { Sea, Light, Camera, Water };
inline constexpr std::array<std::string_view, 4> kPresetParts{"sea", "light", "camera",
                                                              "water"};  // their names
using PresetParts = std::bitset<kPresetParts.size()>;
// The part that a key belongs to, by its table. Bubbles are as many as there is foam: they go with the sea's.
PresetPart preset_part(std::string_view path);

struct PresetValue {
    std::string path;  // of a key
    KeyValue value;
    int since = 1;  // the first edition in which the preset gives it
};

struct Preset {
    std::string name;   // letters, digits and -, such as "beaufort-8"; no two are the same
    std::string label;  // for a menu: "8 Gale"
    std::string help;   // what it looks like
    PresetGroup group;
    std::vector<PresetValue> values;  // of one key the last one that the edition has
};

// Beaufort 0 … 12, then the named seas. Each is a look: it can be told from the others at a glance. Of the sea Beaufort's set the wind
// sea and how much foam there is, and leave swell, direction and depth as they are; the named seas set the whole of [sea], [waves],
// [light] and [water]. Before edition 2 there were no cameras, and Beaufort's were the wind sea alone;
// before edition 3 storms were seen from as high as their seas.
//
// The winds are the middle of each force, the wave heights in the open sea those of the World Meteorological
// Organization's table (Manual on Codes, WMO-No. 306, 1100) from force 4 up. Lighter winds alone, without an
// older swell, don't raise as much in any fetch.
std::span<const Preset> presets();

// Null: there is none.
const Preset* find_preset(std::string_view name);

// What is wrong with a name that no preset has, for `key`; with the nearest that there is.
Problem unknown_preset(const std::string& key, const std::string& name);

// Into a scene of any edition: what the preset leaves at its default gets that edition's. parts: of the look; all by default.
void apply(const Preset& preset, Scene& scene, PresetParts parts = ~PresetParts());

}  // namespace pelagic
