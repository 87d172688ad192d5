#include "core/scene/presets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/base/constants.h"
#include "core/scene/editions.h"
#include "core/scene/names.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

// A camera, by default over (0, −60), that looks along +y.
struct Framing {
    double height_m, aim_m;  // of the camera, and of what it looks at 60 m ahead
    double fov_deg;
    double east_m = 0.0, north_m = -60.0, towards_deg = 90.0;
    double stops = 0.0;
};

struct Day {
    double sun_elevation_deg, sun_azimuth_deg, turbidity;
};

struct Force {
    const char* name;
    double wind_speed_mps;
    double fetch_km;  // with which a JONSWAP sea has the table's height
    double foam;      // times the law's, which counts whitecaps and not the streaks that whiten a storm
    Day day;
    Framing framing;
    const char* help;
};

// What the sea looks like: after the same table's descriptions, shortened. Each is whiter than the one before, and none of them by the sun's
// glitter alone: foam is lit from the side or from behind the eye. Force 2 is silk at dawn. From 4 to 8 the camera stands before waves that
// break, on a boat's deck; from 9 on it is low, as in a trough, where the next sea stands over the horizon: from the seas' own height they are
// low hills. Storms have no fair sky: at force 9 it is grey with haze, and from 10 on with spray. The places are those of the default seed,
// found by a search: the water stays below the camera for ten seconds, and breaking water or a crest is ahead, on the default patch, which a
// bake of the preset shows.
// clang-format off
constexpr std::array<Force, 13> kForces{{
    {"Calm", 0.0, 100.0, 1.0, {5.0, 75.0, 2.4}, {2.2, 2.6, 45.0}, "like a mirror"},
    {"Light air", 0.9, 100.0, 1.0, {9.0, 112.0, 2.2}, {1.8, 1.2, 45.0}, "ripples without crests"},
    {"Light breeze", 2.4, 200.0, 1.0, {7.0, 25.0, 2.0}, {1.1, 0.9, 38.0}, "small wavelets, glassy crests that don't break"},
    {"Gentle breeze", 4.4, 300.0, 1.0, {16.0, 90.0, 2.0}, {3.0, 1.0, 50.0}, "large wavelets, the first scattered whitecaps"},
    {"Moderate breeze", 6.7, 70.0, 1.0, {52.0, 330.0, 2.0}, {2.0, 0.9, 44.0, 63.0, -90.0, 280.0}, "small waves that grow longer, fairly frequent whitecaps; 1 m"},
    {"Fresh breeze", 9.3, 150.0, 1.0, {24.0, 205.0, 2.0}, {2.4, 1.6, 42.0, -60.0, 60.0, 280.0}, "moderate, long waves, many whitecaps; 2 m"},
    {"Strong breeze", 12.3, 180.0, 1.2, {30.0, 150.0, 2.0}, {1.5, 1.8, 28.0, -90.0, 90.0, 286.0}, "large waves, white crests everywhere; 3 m"},
    {"Near gale", 15.5, 190.0, 1.4, {30.0, 350.0, 2.2}, {1.8, 2.2, 30.0, 30.0, 36.0, 116.0}, "the sea heaps up, foam begins to be blown in streaks; 4 m"},
    {"Gale", 18.9, 240.0, 1.7, {28.0, 30.0, 2.4}, {2.3, 3.0, 34.0, 60.0, 66.0, 164.0}, "moderately high, longer waves, foam in marked streaks; 5.5 m"},
    {"Strong gale", 22.6, 270.0, 2.0, {50.0, 200.0, 8.0}, {0.5, 3.0, 32.0, -2.0, -63.0, 340.0, -0.1}, "high waves, dense streaks, crests begin to topple; 7 m"},
    {"Storm", 26.4, 320.0, 3.2, {24.0, 300.0, 3.0}, {3.3, 4.4, 34.0, 50.0, 58.0, 220.0, -0.3}, "very high waves with overhanging crests, the sea looks white; 9 m"},
    {"Violent storm", 30.5, 385.0, 4.5, {26.0, 300.0, 3.0}, {3.9, 5.0, 34.0, 77.0, 69.0, 200.0, -0.2}, "exceptionally high waves, long white patches everywhere; 11.5 m"},
    {"Hurricane", 35.0, 425.0, 7.5, {45.0, 100.0, 3.5}, {3.9, 5.0, 34.0, -2.0, -5.0, 40.0, -0.5}, "the air is full of foam, the sea white; 14 m"},
}};
// clang-format on

// What presets give since they are looks.
void add(Preset& preset, const char* path, KeyValue value) {
    constexpr int kLooks = 2;  // the edition
    preset.values.push_back({path, std::move(value), kLooks});
}

// Their light and cameras until edition 3: cameras as high as the seas.
struct Before {
    std::string_view name;
    Day day;
    Framing framing;
};
// clang-format off
constexpr std::array kBefore = std::to_array<Before>({
    {"beaufort-2", {32.0, 205.0, 2.0}, {2.0, 0.6, 45.0}},
    {"beaufort-4", {52.0, 150.0, 2.0}, {4.0, 0.0, 50.0}},
    {"beaufort-5", {38.0, 20.0, 2.0}, {4.5, 1.0, 46.0}},
    {"beaufort-6", {24.0, 118.0, 2.2}, {5.0, 2.4, 42.0}},
    {"beaufort-7", {46.0, 250.0, 2.2}, {7.0, 3.0, 40.0}},
    {"beaufort-8", {14.0, 62.0, 2.6}, {6.0, 4.5, 38.0}},
    {"beaufort-9", {30.0, 140.0, 3.0}, {9.0, 5.5, 36.0}},
    {"beaufort-10", {9.0, 195.0, 3.0}, {9.0, 7.5, 34.0}},
    {"beaufort-11", {26.0, 215.0, 3.0}, {11.0, 8.0, 34.0}},
    {"beaufort-12", {40.0, 60.0, 3.5}, {13.0, 8.0, 36.0}},
    {"lagoon", {55.0, 60.0, 2.0}, {3.0, 0.6, 50.0}},
    {"north-sea-storm", {24.0, 35.0, 2.0}, {10.0, 7.0, 36.0}},
    {"southern-ocean", {16.0, 60.0, 2.0}, {7.0, 6.0, 34.0}},
});
// clang-format on

using Values = std::vector<std::pair<const char*, KeyValue>>;
Values values_of(const Day& day) {
    return {{"light.sun_elevation_deg", day.sun_elevation_deg},
            {"light.sun_azimuth_deg", day.sun_azimuth_deg},
            {"light.turbidity", day.turbidity}};
}
Values values_of(const Framing& framing) {
    constexpr double kAhead_m = 60.0;
    const double towards = framing.towards_deg * kPi / 180.0;
    const auto whole_cm = [](double m) { return std::round(100.0 * m) / 100.0; };
    return {{"camera.position_m", std::vector<double>{framing.east_m, framing.north_m, framing.height_m}},
            {"camera.look_at_m",
             std::vector<double>{whole_cm(framing.east_m + kAhead_m * std::cos(towards)),
                                 whole_cm(framing.north_m + kAhead_m * std::sin(towards)), framing.aim_m}},
            {"camera.fov_deg", framing.fov_deg}};
}

void add_framing(Preset& preset, const Framing& framing) {
    for (const auto& [path, value] : values_of(framing)) add(preset, path, value);
    add(preset, "camera.glare", 0.03);  // a clean lens: a sun in the picture glows
    preset.values.push_back({"camera.exposure_ev", framing.stops, 3});
}

// What the preset gives now it gives from edition 3 on, before it that.
void add_before(Preset& preset, const Before& before) {
    Values values = values_of(before.day);
    for (auto& value : values_of(before.framing)) values.push_back(std::move(value));
    for (const auto& [path, value] : values) {
        const auto now = std::ranges::find(preset.values, path, &PresetValue::path);
        if (now->value == value) continue;
        PresetValue from_then_on{path, std::exchange(now->value, value), 3};
        preset.values.push_back(std::move(from_then_on));
    }
}

// What a storm adds to its waves: spray, and foam that is thick. Of the streaks that whiten a sea from force 10 on there is no law: by eye, so
// that each force is whiter than the one before it.
struct Storm {
    bool spray = false;
    double new_opaque = 0.0, old_opaque = 0.0;  // 0: the law's
};
Storm storm_of(int force) {
    constexpr std::array<Storm, 5> kFrom8{
        {{true}, {true}, {true, 0.8, 0.5}, {true, 0.9, 0.65}, {true, 0.95, 0.85}}};
    return force < 8 ? Storm{} : kFrom8[static_cast<std::size_t>(force - 8)];
}
void add_storm(Preset& preset, const Storm& storm) {
    preset.values.push_back({"effects.spray", storm.spray, 3});
    preset.values.push_back({"effects.foam_new_opaque", storm.new_opaque, 3});
    preset.values.push_back({"effects.foam_old_opaque", storm.old_opaque, 3});
}

Preset beaufort(int number) {
    const Force& force = kForces[static_cast<std::size_t>(number)];
    Preset preset{.name = "beaufort-" + std::to_string(number),
                  .label = std::to_string(number) + ' ' + force.name,
                  .help = force.help,
                  .group = PresetGroup::Beaufort,
                  .values = {{"sea.wind_speed_mps", force.wind_speed_mps},
                             {"sea.fetch_m", force.fetch_km * 1e3},
                             {"sea.significant_height_m", KeyValue()},
                             {"sea.spectrum", std::string(word_of(SpectrumKind::Jonswap))}}};
    add(preset, "effects.whitecap_amount", force.foam);
    add_storm(preset, storm_of(number));
    // What amounts of foam add to the law's is drifting streaks, which have no bubbles below.
    preset.values.push_back({"water.bubbles", std::round(100.0 / force.foam) / 100.0, 3});
    for (const auto& [path, value] : values_of(force.day)) add(preset, path, value);
    add_framing(preset, force.framing);
    return preset;
}

// All keys of the tables that a named sea sets, as they are in this scene.
Preset named(const char* name, const char* label, const char* help, const Scene& scene,
             const Framing& framing, const Storm& storm = {}) {
    Preset preset{.name = name, .label = label, .help = help, .group = PresetGroup::Sea, .values = {}};
    for (const KeyTable& table : key_tables()) {
        if (table.name != "sea" && table.name != "waves" && table.name != "light" && table.name != "water")
            continue;
        for (const Key& key : table.keys)
            if (key.set) preset.values.push_back({key.path, value_of(scene, key)});
    }
    add_storm(preset, storm);
    add_framing(preset, framing);
    return preset;
}

std::vector<Preset> named_seas() {
    std::vector<Preset> out;
    Scene glassy;
    glassy.sea.wind_speed_mps = 0.0;
    glassy.sea.swell = {{2.4, 10.5, 100.0}, {0.6, 6.0, 55.0}, {0.08, 2.6, 150.0}};
    glassy.light = {.sun_elevation_deg = 14.0, .sun_azimuth_deg = 48.0};
    out.push_back(named("glassy-swell", "Glassy swell", "long swell without wind, the sun low", glassy,
                        {4.0, 2.0, 45.0}));

    Scene trade;
    trade.sea.wind_speed_mps = 8.0;
    trade.sea.fetch_m = 1e6;
    trade.sea.spectrum = SpectrumKind::Elfouhaily;
    trade.sea.spreading = SpreadingKind::Elfouhaily;
    trade.sea.swell = {{1.2, 9.5, 340.0}};
    trade.light = {.sun_elevation_deg = 48.0, .sun_azimuth_deg = 130.0};
    out.push_back(named("trade-wind", "Trade wind", "a steady breeze over deep blue water, the sun high",
                        trade, {9.0, 2.0, 50.0}));

    Scene coast;
    coast.sea.wind_speed_mps = 7.0;
    coast.sea.fetch_m = 15e3;
    coast.sea.depth_m = 6.0;
    coast.sea.spectrum = SpectrumKind::Tma;
    coast.light = {.sun_elevation_deg = 32.0, .sun_azimuth_deg = 60.0};
    coast.water = {.type = WaterType::Coastal, .chlorophyll_mg_m3 = 2.0};
    out.push_back(named("coastal-bay", "Coastal bay", "short, steep waves over shallow green water", coast,
                        {2.5, 0.5, 50.0}));

    Scene lagoon;
    lagoon.sea.wind_speed_mps = 2.5;
    lagoon.sea.fetch_m = 1e3;
    lagoon.sea.depth_m = 2.5;
    lagoon.light = {.sun_elevation_deg = 36.0, .sun_azimuth_deg = 76.0};
    lagoon.water = {.type = WaterType::JerlovIB, .floor_colour = {0.55, 0.50, 0.40}};
    out.push_back(named("lagoon", "Lagoon", "clear, shallow water over coral sand, a light wind", lagoon,
                        {.height_m = 3.0, .aim_m = -11.0, .fov_deg = 50.0, .stops = 0.4}));

    Scene evening;
    evening.sea.wind_speed_mps = 5.0;
    evening.sea.fetch_m = 100e3;
    evening.sea.swell = {{0.8, 8.0, 200.0}};
    evening.light = {.sun_elevation_deg = 4.0, .sun_azimuth_deg = 90.0};
    out.push_back(named("evening-breeze", "Evening breeze", "light wind, the sun's path on the water",
                        evening, {3.0, 2.0, 40.0}));

    Scene gale;
    gale.sea.wind_speed_mps = 24.0;
    gale.sea.fetch_m = 400e3;
    gale.sea.depth_m = 90.0;
    gale.sea.spectrum = SpectrumKind::Tma;
    gale.sea.spreading = SpreadingKind::DonelanBanner;
    gale.waves.choppiness = 1.15;
    gale.light = {.sun_elevation_deg = 45.0, .sun_azimuth_deg = 150.0, .turbidity = 8.0};
    gale.water = {.type = WaterType::Coastal, .chlorophyll_mg_m3 = 1.0};
    out.push_back(named("north-sea-storm", "North Sea storm", "a storm over a shelf sea, streaked with foam",
                        gale, {1.3, 2.9, 40.0, -5.0, -68.0, 20.0, -0.4}, {.spray = true}));

    Scene southern;
    southern.sea.wind_speed_mps = 17.0;
    southern.sea.fetch_m = 900e3;
    southern.sea.swell = {{5.0, 15.0, 20.0}, {2.0, 12.0, 320.0}};
    southern.light = {.sun_elevation_deg = 14.0, .sun_azimuth_deg = 300.0};
    out.push_back(named("southern-ocean", "Southern Ocean", "a gale over a swell as high as a house",
                        southern, {2.2, 3.4, 44.0, 41.0, -48.0, 316.0}, {.spray = true}));
    return out;
}

}  // namespace

std::string_view word_of(PresetGroup group) {
    return group == PresetGroup::Beaufort ? "beaufort" : "sea";
}

std::span<const Preset> presets() {
    static const std::vector<Preset> all = [] {
        std::vector<Preset> out;
        for (int force = 0; force < static_cast<int>(kForces.size()); ++force) out.push_back(beaufort(force));
        std::vector<Preset> seas = named_seas();
        std::move(seas.begin(), seas.end(), std::back_inserter(out));
        for (const Before& before : kBefore)
            add_before(*std::ranges::find(out, before.name, &Preset::name), before);
        return out;
    }();
    return all;
}

const Preset* find_preset(std::string_view name) {
    for (const Preset& preset : presets())
        if (preset.name == name) return &preset;
    return nullptr;
}

Problem unknown_preset(const std::string& key, const std::string& name) {
    std::vector<std::string> names;
    for (const Preset& preset : presets()) names.push_back(preset.name);
    const std::string near = nearest(name, names);
    return {key, quoted_text(name),
            "is no preset" + (near.empty() ? std::string() : ", the nearest is " + quoted_text(near)),
            "beaufort-0 … beaufort-12, glassy-swell, trade-wind, …: pelagic presets lists them"};
}

PresetPart preset_part(std::string_view path) {
    if (path == "water.bubbles") return PresetPart::Sea;
    const std::string_view table = path.substr(0, path.find('.'));
    if (table == "light") return PresetPart::Light;
    if (table == "camera") return PresetPart::Camera;
    return table == "water" ? PresetPart::Water : PresetPart::Sea;
}

void apply(const Preset& preset, Scene& scene, PresetParts parts) {
    for (const auto& [path, value, since] : preset.values) {
        if (since > scene.shot.edition || !parts[static_cast<std::size_t>(preset_part(path))]) continue;
        // A measured spectrum would otherwise replace any other one.
        if (path == "sea.spectrum") scene.sea.measured.reset();
        // What a preset leaves at its default stays at the edition's.
        const Key& key = key_of(path);
        if (const auto problem =
                set_value(scene, key, value == key.fallback ? fallback_in(scene.shot.edition, key) : value))
            throw std::logic_error("a preset that doesn't fit its key: " + text_of(*problem));
    }
}

}  // namespace pelagic
