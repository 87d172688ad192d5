// The panel's values as keys of a shot file. See controls.h.
#include <functional>
#include <string_view>

#include "core/scene/names.h"
#include "core/scene/text.h"
#include "plugin/preview/controls.h"

namespace pelagic {
namespace {

std::string list_text(const glm::dvec3& v) {
    return "[" + number_text(v.x) + ", " + number_text(v.y) + ", " + number_text(v.z) + "]";
}

std::string list_text(const std::vector<Swell>& swells) {
    std::string text;
    for (const Swell& swell : swells)
        text += (text.empty() ? "{ height_m = " : ", { height_m = ") + number_text(swell.height_m) +
                ", period_s = " + number_text(swell.period_s) +
                ", direction_deg = " + number_text(swell.direction_deg) + " }";
    return "[" + text + "]";
}

std::string quoted_word(std::string_view word) {
    return quoted_text(word);
}

struct Entry {
    std::string_view table, key;
    std::function<std::string(const Scene&)> text;
};

// What the panel and the camera change, in the order of the shot file.
const std::vector<Entry>& entries() {
    static const std::vector<Entry> all{
        {"sea", "wind_speed_mps", [](const Scene& s) { return number_text(s.sea.wind_speed_mps); }},
        {"sea", "wind_direction_deg", [](const Scene& s) { return number_text(s.sea.wind_direction_deg); }},
        {"sea", "fetch_m", [](const Scene& s) { return number_text(s.sea.fetch_m); }},
        {"sea", "swell", [](const Scene& s) { return list_text(s.sea.swell); }},
        {"waves", "choppiness", [](const Scene& s) { return number_text(s.waves.choppiness); }},
        {"surface", "cell_px", [](const Scene& s) { return number_text(s.surface.cell_px); }},
        {"camera", "position_m", [](const Scene& s) { return list_text(s.camera.position_m); }},
        {"camera", "look_at_m", [](const Scene& s) { return list_text(s.camera.look_at_m); }},
        {"light", "sun_elevation_deg", [](const Scene& s) { return number_text(s.light.sun_elevation_deg); }},
        {"light", "sun_azimuth_deg", [](const Scene& s) { return number_text(s.light.sun_azimuth_deg); }},
        {"light", "turbidity", [](const Scene& s) { return number_text(s.light.turbidity); }},
        {"water", "type", [](const Scene& s) { return quoted_word(word_of(s.water.type)); }},
        {"water", "chlorophyll_mg_m3", [](const Scene& s) { return number_text(s.water.chlorophyll_mg_m3); }},
        {"effects", "whitecaps",
         [](const Scene& s) { return std::string(s.effects.whitecaps ? "true" : "false"); }},
    };
    return all;
}

}  // namespace

std::string changed_keys(const Scene& shot, const Scene& now) {
    std::string text;
    std::string_view table;
    for (const Entry& entry : entries()) {
        const std::string value = entry.text(now);
        if (value == entry.text(shot)) continue;
        if (entry.table != table) text += (text.empty() ? "[" : "\n[") + std::string(entry.table) + "]\n";
        table = entry.table;
        text += std::string(entry.key) + " = " + value + '\n';
    }
    return text;
}

}  // namespace pelagic
