// The window's panel. See controls.h.
#include "plugin/host/preview/controls.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "core/plan/effects.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"

namespace pelagic {
namespace {

constexpr float kPanelWidth = 330.0f, kBarHeight = 46.0f, kMargin = 10.0f;  // at scale 1, pixels
const ImVec4 kAccent(0.33f, 0.66f, 0.80f, 1.0f);
const ImVec4 kWarning(1.0f, 0.72f, 0.35f, 1.0f);

// Everything scales with the font, whose size is the screen's.
float scaled(float pixels) {
    return pixels * ImGui::GetFontSize() / 15.0f;
}

void tooltip(const char* text) {
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(scaled(300.0f));
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

struct SliderLook {
    double low = 0.0, high = 1.0;
    std::string format = "%.2f";
    std::string help = {};
    bool logarithmic = false;
};

bool slider(const char* label, double& value, const SliderLook& look) {
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_AlwaysClamp | (look.logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    const bool changed = ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &look.low, &look.high,
                                             look.format.c_str(), flags);
    tooltip(look.help.c_str());
    return changed;
}

void warning(const std::string& message) {
    ImGui::PushStyleColor(ImGuiCol_Text, kWarning);
    ImGui::TextWrapped("%s", message.c_str());
    ImGui::PopStyleColor();
}

bool section(const char* title, bool open = true) {
    ImGui::Spacing();
    return ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

template <class Choice, std::size_t N>
void choose(const char* label, Choice& value, const std::array<std::pair<Choice, const char*>, N>& choices,
            const char* help) {
    const auto now = std::find_if(choices.begin(), choices.end(),
                                  [&](const auto& choice) { return choice.first == value; });
    if (ImGui::BeginCombo(label, now == choices.end() ? "" : now->second)) {
        for (const auto& [choice, name] : choices)
            if (ImGui::Selectable(name, choice == value)) value = choice;
        ImGui::EndCombo();
    }
    tooltip(help);
}

// ---- Controls made of the table of keys

// "%.1f m/s": with as many digits as the slider's range asks for.
std::string format_of(const Key& key) {
    constexpr double kSpan = 100.0, kShortSpan = 10.0;  // from tens on no decimals, below ones two
    const SoftRange& soft = *key.soft;
    const double span = soft.is_logarithmic ? soft.low * kSpan : soft.high - soft.low;
    const char* digits = span > kSpan || key.type == KeyType::Integer ? "%.0f"
                         : span >= kShortSpan                         ? "%.1f"
                                                                      : "%.2f";
    const std::string unit = key.unit == "degrees" ? "°" : key.unit == "pixels" ? " px" : ' ' + key.unit;
    return digits + (key.unit.empty() ? "" : unit);
}

// Whether a number is infinite, as the depth of deep water is.
bool key_unbounded(const Key& key, double& number) {
    bool is_infinite = std::isinf(number);
    ImGui::PushID(key.path.c_str());
    const bool changed = ImGui::Checkbox("##infinite", &is_infinite);
    ImGui::PopID();
    tooltip("Without bound");
    if (changed)
        number =
            is_infinite ? std::numeric_limits<double>::infinity() : std::sqrt(key.soft->low * key.soft->high);
    ImGui::SameLine();
    return changed;
}

// A whole number to type or step, where no part of what the key accepts is more useful than another.
bool key_integer(const Key& key, std::int64_t& number) {
    constexpr std::int64_t kStep = 1;
    const bool changed = ImGui::InputScalar(key.label.c_str(), ImGuiDataType_S64, &number, &kStep);
    number = std::clamp(number, key.least, key.largest);
    tooltip(key.help.c_str());
    return changed;
}

// A slider over the useful part of what the key accepts.
bool key_slider(const Key& key, KeyValue& value) {
    if (!key.soft) return key_integer(key, std::get<std::int64_t>(value));
    const bool is_integer = std::holds_alternative<std::int64_t>(value);
    double number = is_integer ? static_cast<double>(std::get<std::int64_t>(value)) : std::get<double>(value);
    const SliderLook look{.low = key.soft->low,
                          .high = key.soft->high,
                          .format = format_of(key),
                          .help = key.help,
                          .logarithmic = key.soft->is_logarithmic};
    bool changed = key.may_be_infinite && key_unbounded(key, number);
    if (std::isinf(number))
        ImGui::TextDisabled("%s: unbounded", key.label.c_str());
    else
        changed = slider(key.label.c_str(), number, look) || changed;
    if (!changed) return false;
    if (is_integer)
        value = static_cast<std::int64_t>(std::llround(number));
    else
        value = number;
    return true;
}

// A choice that takes a file can't be made here.
constexpr const char* kOfFile = "file";

bool key_words(const Key& key, std::string& word) {
    const auto shown = [](std::string text) {
        if (text.front() >= 'a' && text.front() <= 'z') text.front() += 'A' - 'a';
        return text;
    };
    bool changed = false;
    ImGui::BeginDisabled(word == kOfFile);
    if (ImGui::BeginCombo(key.label.c_str(), shown(word).c_str())) {
        for (const std::string& choice : key.choices)
            if (choice != kOfFile && ImGui::Selectable(shown(choice).c_str(), choice == word)) {
                word = choice;
                changed = true;
            }
        ImGui::EndCombo();
    }
    ImGui::EndDisabled();
    tooltip(key.help.c_str());
    return changed;
}

// A new entry: every number in the middle of what is useful.
KeyEntry usual_entry(const Key& key) {
    KeyEntry entry;
    for (const Key& inner : key.entry_keys)
        entry.values.emplace_back(inner.name, 0.5 * (inner.soft->low + inner.soft->high));
    return entry;
}

void key_that_changes(const Key& key, const KeyValue& value) {
    ImGui::TextDisabled("%s: changes over the shot", key.label.c_str());
    tooltip(value_text(key, value).c_str());
}

bool key_entries(const Key& key, std::vector<KeyEntry>& entries) {
    bool changed = false;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        ImGui::TextDisabled(entries.size() > 1 ? "%s %zu" : "%s", key.label.c_str(), i + 1);
        for (std::size_t k = 0; k < key.entry_keys.size(); ++k) {
            KeyValue& value = entries[i].values[k].second;
            if (std::holds_alternative<NumberKeys>(value))
                key_that_changes(key.entry_keys[k], value);
            else
                changed = key_slider(key.entry_keys[k], value) || changed;
        }
        ImGui::PopID();
    }
    ImGui::PushID(key.path.c_str());
    ImGui::BeginDisabled(entries.size() >= key.most_entries);
    if (ImGui::SmallButton(("Add " + key.label).c_str())) {
        entries.push_back(usual_entry(key));
        changed = true;
    }
    ImGui::EndDisabled();
    tooltip(key.help.c_str());
    if (!entries.empty()) {
        ImGui::SameLine();
        if (ImGui::SmallButton("Remove")) {
            entries.pop_back();
            changed = true;
        }
        tooltip("The last one");
    }
    ImGui::PopID();
    return changed;
}

// Whether it was changed.
bool key_control(Scene& scene, const Key& key) {
    KeyValue value = value_of(scene, key);
    bool changed = false;
    if (auto* truth = std::get_if<bool>(&value)) {
        changed = ImGui::Checkbox(key.label.c_str(), truth);
        tooltip(key.help.c_str());
    } else if (auto* word = std::get_if<std::string>(&value)) {
        changed = key_words(key, *word);
    } else if (auto* entries = std::get_if<std::vector<KeyEntry>>(&value)) {
        changed = key_entries(key, *entries);
    } else if (std::holds_alternative<NumberKeys>(value)) {
        key_that_changes(key, value);
    } else {
        changed = key_slider(key, value);
    }
    if (changed) set_value(scene, key, value);
    return changed;
}

void key_controls(Scene& scene, const PanelSection& section) {
    for (const std::string_view path : section.paths) key_control(scene, key_of(path));
}

const PanelSection& keys_of(std::string_view title) {
    const std::vector<PanelSection>& all = panel_sections();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const PanelSection& s) { return s.title == title; });
    if (found == all.end()) throw std::logic_error("the panel has no section " + std::string(title));
    return *found;
}

void waves_section(Controls& controls, const Readout& readout) {
    if (!section(keys_of("Wind and waves").title)) return;
    key_controls(controls.scene, keys_of("Wind and waves"));
    ImGui::PushStyleColor(ImGuiCol_Text,
                          readout.building_sea ? kAccent : ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
    ImGui::TextWrapped("%s", sea_words(readout).c_str());
    ImGui::PopStyleColor();
}

void foam_section(Controls& controls) {
    if (!section(keys_of("Foam").title)) return;
    const bool had_whitecaps = is_on(Effect::Whitecaps, controls.scene);
    key_controls(controls.scene, keys_of("Foam"));
    // Foam that is turned on is drawn, also in a shot that begins without.
    if (is_on(Effect::Whitecaps, controls.scene) && !had_whitecaps) controls.draw.lighting.whitecaps = true;
}

void sky_section(Scene& scene, const Readout& readout) {
    if (!section(keys_of("Sun and sky").title)) return;
    const bool daylight = scene.light.sky == Light{}.sky;
    if (!daylight) {
        ImGui::TextDisabled("Sky: %s", std::filesystem::path(scene.light.sky).filename().string().c_str());
        tooltip("The sun stands where the picture has it");
    }
    ImGui::BeginDisabled(!daylight);
    key_controls(scene, keys_of("Sun and sky"));
    ImGui::EndDisabled();
    if (readout.building_sky) ImGui::TextColored(kAccent, "Building this sky …");
}

void water_section(Scene& scene) {
    if (!section(keys_of("Water").title)) return;
    key_controls(scene, keys_of("Water"));
    // Jerlov's types have plankton of their own.
    if (const Key& plankton = key_of("water.chlorophyll_mg_m3"); scene.water.type > WaterType::Turbid)
        set_value(scene, plankton, plankton.fallback);
}

void light_section(LightingChoice& choice) {
    if (!section("Light")) return;
    struct Term {
        const char* name;
        bool LightingChoice::*on;
        const char* help;
    };
    static constexpr std::array kTerms{
        Term{"Sun", &LightingChoice::sun, "The sun's reflection: the glitter"},
        Term{"Sky", &LightingChoice::sky, "The sky's reflection"},
        Term{"Water", &LightingChoice::water, "Light that comes back from under the surface"},
        Term{"Foam", &LightingChoice::whitecaps, "Light from the whitecaps"},
        Term{"Air", &LightingChoice::air, "The air before the sea: what it adds, and what it takes away"}};
    const float step = scaled(62.0f);
    for (std::size_t i = 0; i < kTerms.size(); ++i) {
        if (i > 0) ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + step * static_cast<float>(i));
        ImGui::BeginGroup();
        ImGui::PushID(kTerms[i].name);
        ImGui::Checkbox(kTerms[i].name, &(choice.*kTerms[i].on));
        tooltip(kTerms[i].help);
        if (ImGui::SmallButton("only")) {
            const bool alone =
                choice.*kTerms[i].on && std::count_if(kTerms.begin(), kTerms.end(),
                                                      [&](const Term& term) { return choice.*term.on; }) == 1;
            for (const Term& term : kTerms) choice.*term.on = alone || &term == &kTerms[i];
        }
        tooltip("This term alone; again for all of them");
        ImGui::PopID();
        ImGui::EndGroup();
    }
    static constexpr std::array kSkies{std::pair{SkyQuality::One, "1 lookup"},
                                       std::pair{SkyQuality::Nine, "9 lookups"},
                                       std::pair{SkyQuality::Integral, "Integral"}};
    choose("Sky", choice.sky_quality, kSkies,
           "How the sky's reflection is found: fast, more accurate, or the reference, of 512 lookups");
    static constexpr std::array kFits{std::pair{FresnelFit::Exact, "Exact fit"},
                                      std::pair{FresnelFit::Paper, "Bruneton 2010"}};
    choose("Fresnel", choice.fresnel, kFits,
           "How much rough water reflects: fitted to the exact term, or the paper's own fit to Schlick's");
}

void picture_section(Controls& controls, const Readout& readout) {
    if (!section(keys_of("Picture").title)) return;
    slider("Exposure", controls.exposure_stops,
           {.low = -6.0,
            .high = 6.0,
            .format = "%+.1f stops",
            .help = "Brighter or darker than what suits the light; a stop is a factor of two"});
    static constexpr std::array kSizes{std::pair{1, "Full"}, std::pair{2, "½"}, std::pair{4, "¼"}};
    choose("Resolution", controls.pixel_size, kSizes,
           "Of the drawn picture, against the window's: lower it where the graphics are slow");
    ImGui::TextDisabled("%d × %d pixels drawn", readout.drawn_px.x, readout.drawn_px.y);
    key_controls(controls.scene, keys_of("Picture"));
    static constexpr std::array kColours{std::pair{FalseColour::None, "Light"},
                                         std::pair{FalseColour::FilterLevel, "Filter levels"},
                                         std::pair{FalseColour::UnresolvedVariance, "Hidden slopes"},
                                         std::pair{FalseColour::Coverage, "Whitecap coverage"}};
    choose("Show", controls.draw.false_colour, kColours,
           "The light, or in its place: which filter level a pixel's waves come from, the variance of the "
           "slopes that it hides, or how much of it is foam");
    ImGui::Checkbox("Wireframe", &controls.draw.wireframe);
    tooltip("The projected grid");
}

void camera_section(const Readout& readout, Clicks& clicks) {
    if (!section("Camera")) return;
    ImGui::Text("%.1f, %.1f, %.1f m", readout.camera_m.x, readout.camera_m.y, readout.camera_m.z);
    ImGui::BeginDisabled(readout.follows_shot);
    clicks.shot_camera =
        ImGui::Button(readout.follows_shot ? "The shot's camera" : "Back to the shot's camera");
    tooltip("Follows the shot's keys until you take the camera (Home)");
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::TextDisabled("F1: how to move");
}

void time_row(const char* name, double ms, double whole_ms) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::Text("%7.2f", ms);
    ImGui::TableNextColumn();
    const auto share = static_cast<float>(whole_ms > 0.0 ? std::clamp(ms / whole_ms, 0.0, 1.0) : 0.0);
    ImGui::ProgressBar(share, ImVec2(-1.0f, ImGui::GetTextLineHeight() * 0.7f), "");
}

bool begin_times(const char* name) {
    if (!ImGui::BeginTable(name, 3, ImGuiTableFlags_SizingStretchProp)) return false;
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, scaled(130.0f));
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, scaled(58.0f));
    ImGui::TableSetupColumn("");
    return true;
}

void times_section(const Readout& readout) {
    if (!section("Time")) return;
    const PictureTimes& times = readout.times;
    // A slow first picture must not flatten the others.
    const auto highest = static_cast<float>(2.0 * times.total_ms);
    if (!readout.history_ms.empty())
        ImGui::PlotLines("##history", readout.history_ms.data(), static_cast<int>(readout.history_ms.size()),
                         0, nullptr, 0.0f, highest, ImVec2(-1.0f, scaled(44.0f)));
    tooltip("Milliseconds from picture to picture, the latest on the right");
    ImGui::TextDisabled("A picture, milliseconds");
    if (begin_times("picture")) {
        time_row("Grid, CPU", times.grid_ms, times.total_ms);
        time_row("Panel, CPU", times.panel_ms, times.total_ms);
        time_row("Submitting, CPU", times.gpu.submit_ms, times.total_ms);
        time_row("Upload, GPU", times.gpu.upload_ms, times.total_ms);
        time_row("Sea, GPU", times.gpu.sea_ms, times.total_ms);
        time_row("Sky, GPU", times.gpu.sky_ms, times.total_ms);
        time_row("Showing, GPU", times.gpu.show_ms, times.total_ms);
        time_row("Present and wait", times.present_ms, times.total_ms);
        ImGui::EndTable();
    }
    ImGui::TextDisabled("A time of the sea, beside the drawing");
    if (begin_times("sea")) {
        const double whole_ms = times.transforms_ms + times.packing_ms;
        time_row("Transforms", times.transforms_ms, whole_ms);
        time_row("Packing", times.packing_ms, whole_ms);
        ImGui::EndTable();
    }
    ImGui::TextDisabled("%s", readout.device.c_str());
    tooltip(readout.device.c_str());
}

void panel(Controls& controls, const Readout& readout, const Scene& shot, Clicks& clicks) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float margin = scaled(kMargin);
    ImGui::SetNextWindowPos(ImVec2(margin, margin));
    ImGui::SetNextWindowSize(
        ImVec2(scaled(kPanelWidth), std::max(screen.y - 3.0f * margin - scaled(kBarHeight), scaled(120.0f))));
    ImGui::Begin("##panel", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    ImGui::PushItemWidth(scaled(180.0f));
    ImGui::TextColored(kAccent, "%s", shot.shot.name.c_str());
    ImGui::SameLine();
    ImGui::TextDisabled("%s quality", std::string(word_of(shot.quality.level)).c_str());
    if (readout.times.total_ms > 0.0) {
        std::array<char, 32> rate{};
        std::snprintf(rate.data(), rate.size(), "%.1f fps", 1000.0 / readout.times.total_ms);
        ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(rate.data()).x);
        ImGui::TextColored(kAccent, "%s", rate.data());
    }
    if (!readout.message.empty()) warning(readout.message);
    waves_section(controls, readout);
    foam_section(controls);
    sky_section(controls.scene, readout);
    water_section(controls.scene);
    light_section(controls.draw.lighting);
    picture_section(controls, readout);
    camera_section(readout, clicks);
    times_section(readout);
    ImGui::Spacing();
    ImGui::Separator();
    clicks.save = ImGui::Button("Save shot");
    tooltip(
        "Writes the keys that differ, the camera's place included, into the shot's file; all else in it stays");
    ImGui::SameLine();
    clicks.copy = ImGui::Button("Copy");
    tooltip("Puts the same keys on the clipboard, as a shot file");
    ImGui::SameLine();
    clicks.reset = ImGui::Button("Reset");
    tooltip("Everything as the shot file has it");
    ImGui::PopItemWidth();
    ImGui::End();
}

void bar(Controls& controls, const Shot& shot) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float margin = scaled(kMargin);
    ImGui::SetNextWindowPos(ImVec2(margin, screen.y - margin - scaled(kBarHeight)));
    ImGui::SetNextWindowSize(ImVec2(screen.x - 2.0f * margin, scaled(kBarHeight)));
    ImGui::Begin("##bar", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::Button(controls.playing ? "Pause" : "Play", ImVec2(scaled(64.0f), 0.0f)))
        play_or_pause(controls, shot);
    tooltip("Space");
    ImGui::SameLine();
    auto frame = static_cast<float>(controls.frame);
    const float right = scaled(330.0f);
    ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - right, scaled(60.0f)));
    if (ImGui::SliderFloat("##frame", &frame, static_cast<float>(shot.first_frame),
                           static_cast<float>(std::max(shot.last_frame, shot.first_frame + 1)), "frame %.1f",
                           ImGuiSliderFlags_AlwaysClamp))
        controls.frame = static_cast<double>(frame);
    tooltip("Frame of the shot; fractions are shown too. The arrow keys step");
    ImGui::SameLine();
    ImGui::TextDisabled("%.2f s", shot.time_s(controls.frame));
    ImGui::SameLine(ImGui::GetWindowWidth() - scaled(245.0f));
    ImGui::SetNextItemWidth(scaled(120.0f));
    slider("##speed", controls.speed,
           {.low = 0.05,
            .high = 8.0,
            .format = "speed × %.2f",
            .help = "How fast time runs; Ctrl-click to type",
            .logarithmic = true});
    ImGui::SameLine();
    ImGui::Checkbox("Repeat", &controls.repeat);
    tooltip("Play the shot's frames over and over; otherwise once");
    ImGui::End();
}

void help() {
    static constexpr std::array<std::array<const char*, 2>, 14> kLines{{
        {"Left drag", "turn round what is in the middle"},
        {"Middle drag, Shift + left drag", "slide along"},
        {"Wheel", "nearer and farther"},
        {"Right drag", "look round on the spot"},
        {"W A S D, E Q", "fly: ahead, left, back, right, up, down"},
        {"Shift with these", "five times as fast (a height a second otherwise)"},
        {"Home", "back to the shot's camera"},
        {"Space", "play and pause"},
        {"Left, Right", "a frame back, a frame on"},
        {"Tab", "hide and show the panel"},
        {"F12", "save the picture, without the panel, beside the shot"},
        {"Ctrl + click on a slider", "type a number"},
        {"F1", "this help"},
        {"Esc, Ctrl + Q", "close"},
    }};
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(screen.x * 0.5f, screen.y * 0.5f), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::Begin("##help", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    if (ImGui::BeginTable("keys", 2)) {
        for (const auto& [keys, what] : kLines) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextColored(kAccent, "%s", keys);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(what);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace

const std::vector<PanelSection>& panel_sections() {
    static const std::vector<PanelSection> sections{
        {"Wind and waves",
         {"sea.wind_speed_mps", "sea.wind_direction_deg", "sea.fetch_m", "sea.depth_m", "sea.spectrum",
          "sea.spreading", "sea.directionality", "sea.gust_strength", "sea.gust_size_m", "sea.gust_fronts",
          "sea.rain_mm_h", "waves.choppiness", "waves.tiling", "shot.seed", "sea.swell"}},
        {"Foam",
         {"effects.whitecaps", "effects.whitecap_law", "effects.sea_minus_air_c", "effects.whitecap_amount",
          "effects.breaking_from_m", "effects.foam_decay_s", "effects.foam_drift", "effects.foam_structure",
          "effects.foam_streaks", "effects.foam_pattern_m", "effects.foam_new_albedo",
          "effects.foam_old_albedo", "effects.foam_new_opaque", "effects.foam_old_opaque"}},
        {"Sun and sky", {"light.sun_elevation_deg", "light.sun_azimuth_deg", "light.turbidity"}},
        {"Water",
         {"water.type", "water.chlorophyll_mg_m3", "water.body", "water.caustics", "water.crest_light",
          "water.bubbles"}},
        {"Picture", {"surface.cell_px"}}};
    return sections;
}

Controls controls_for(const Scene& scene) {
    Controls controls;
    controls.scene = scene;
    controls.draw.lighting = render_options(scene).lighting;
    controls.frame = scene.shot.first_frame;
    return controls;
}

void play_on(Controls& controls, double seconds, const Shot& shot) {
    if (!controls.playing) return;
    const double first = shot.first_frame, last = shot.last_frame;
    const double frame = controls.frame + seconds * controls.speed * shot.fps;
    if (first == last) return go_to(controls, first, shot);
    if (!controls.repeat) {
        controls.playing = frame < last;
        return go_to(controls, frame, shot);
    }
    // The last frame is shown as long as the others.
    controls.frame = first + std::fmod(frame - first, last + 1.0 - first);
}

void play_or_pause(Controls& controls, const Shot& shot) {
    controls.playing = !controls.playing;
    if (controls.playing && !controls.repeat && controls.frame >= shot.last_frame)
        controls.frame = shot.first_frame;
}

void go_to(Controls& controls, double frame, const Shot& shot) {
    controls.frame =
        std::clamp(frame, static_cast<double>(shot.first_frame), static_cast<double>(shot.last_frame));
}

std::string sea_words(const Readout& readout) {
    std::array<char, 160> words{};
    if (readout.building_sea)
        std::snprintf(words.data(), words.size(), "Building %s: %.0f %%, %.0f s",
                      readout.has_sea ? "this sea, while the last one plays on" : "the sea",
                      100.0 * readout.built, readout.waited_s);
    else if (readout.has_sea)
        std::snprintf(words.data(), words.size(), "Significant height %.2f m, built in %.2f s",
                      readout.significant_height_m, readout.times.build_s);
    else if (readout.message.empty())
        return "The sea's first picture is being made";
    return words.data();
}

namespace {

// In the middle of a window that has no sea yet.
void waiting_note(const Readout& readout) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(screen.x * 0.5f, screen.y * 0.5f), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::Begin("##waiting", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    ImGui::TextUnformatted(sea_words(readout).c_str());
    ImGui::ProgressBar(static_cast<float>(readout.built), ImVec2(scaled(240.0f), 0.0f), "");
    ImGui::End();
}

}  // namespace

Clicks draw_controls(Controls& controls, const Readout& readout, const Scene& shot) {
    Clicks clicks;
    if (controls.show_panel) {
        panel(controls, readout, shot, clicks);
        bar(controls, shot.shot);
    }
    if (!controls.show_panel && !readout.message.empty()) {
        ImGui::SetNextWindowPos(ImVec2(scaled(kMargin), scaled(kMargin)));
        ImGui::SetNextWindowSize(ImVec2(scaled(kPanelWidth), 0.0f));
        ImGui::Begin(
            "##message", nullptr,
            ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
        warning(readout.message);
        ImGui::End();
    }
    if (!readout.has_sea && readout.message.empty()) waiting_note(readout);
    if (controls.show_help) help();
    return clicks;
}

void set_controls_style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 6.0f;
    style.FrameRounding = 4.0f;
    style.GrabRounding = 4.0f;
    style.PopupRounding = 4.0f;
    style.ScrollbarRounding = 4.0f;
    style.WindowBorderSize = 0.0f;
    style.WindowPadding = ImVec2(12.0f, 10.0f);
    style.FramePadding = ImVec2(8.0f, 3.0f);
    style.ItemSpacing = ImVec2(8.0f, 5.0f);
    style.ScrollbarSize = 10.0f;
    const auto set = [&](ImGuiCol_ colour, float strength, float alpha) {
        style.Colors[colour] =
            ImVec4(kAccent.x * strength, kAccent.y * strength, kAccent.z * strength, alpha);
    };
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.07f, 0.09f, 0.11f, 0.88f);
    style.Colors[ImGuiCol_PopupBg] = ImVec4(0.07f, 0.09f, 0.11f, 0.96f);
    style.Colors[ImGuiCol_FrameBg] = ImVec4(0.16f, 0.19f, 0.22f, 1.0f);
    style.Colors[ImGuiCol_FrameBgHovered] = ImVec4(0.21f, 0.25f, 0.29f, 1.0f);
    style.Colors[ImGuiCol_FrameBgActive] = ImVec4(0.24f, 0.29f, 0.34f, 1.0f);
    set(ImGuiCol_SliderGrab, 0.75f, 1.0f);
    set(ImGuiCol_SliderGrabActive, 1.0f, 1.0f);
    set(ImGuiCol_CheckMark, 1.1f, 1.0f);
    set(ImGuiCol_Header, 0.35f, 0.6f);
    set(ImGuiCol_HeaderHovered, 0.45f, 0.8f);
    set(ImGuiCol_HeaderActive, 0.55f, 1.0f);
    set(ImGuiCol_Button, 0.45f, 0.8f);
    set(ImGuiCol_ButtonHovered, 0.6f, 1.0f);
    set(ImGuiCol_ButtonActive, 0.75f, 1.0f);
    set(ImGuiCol_PlotHistogram, 0.75f, 1.0f);
    set(ImGuiCol_PlotLines, 1.0f, 1.0f);
    style.ScaleAllSizes(scale);
    // Debian's own; where it isn't, the library's built-in font, which is of pixels.
    const char* const font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    static constexpr std::array<ImWchar, 5> kLetters{0x20, 0xff, 0x2026, 0x2026, 0};  // Latin-1 and …
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(font, ignored)) {
        fonts.AddFontFromFileTTF(font, std::round(15.0f * scale), nullptr, kLetters.data());
    } else {
        ImFontConfig config;
        config.SizePixels = std::round(13.0f * scale);
        fonts.AddFontDefault(&config);
    }
}

}  // namespace pelagic
