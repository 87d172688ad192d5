// A Scene as text for fingerprints. See canonical.h.
#include "core/scene/canonical.h"

#include "core/scene/text.h"

namespace pelagic {

namespace {

// The structured bindings name every member, so that a new member doesn't compile until it is added here.
std::string content_text(const MeasuredSpectrum& measured) {
    const auto& [bins, station, time, file] = measured;
    static_cast<void>(file);  // only the content counts
    std::string text = quoted_text(station) + ' ' + quoted_text(time);
    for (const MeasuredSpectrum::Bin& bin : bins) {
        const auto& [frequency_hz, density, c1_re, c1_im, c2_re, c2_im, has_direction] = bin;
        text += " [";
        for (const double number : {frequency_hz, density, c1_re, c1_im, c2_re, c2_im})
            text += number_text(number) + ", ";
        text += has_direction ? "true]" : "false]";
    }
    return text;
}

}  // namespace

std::string canonical(const Scene& scene, KeyPartSet parts) {
    std::string text;
    for (const Key& key : keys()) {
        if (!has_say(scene, key, parts)) continue;
        std::string value;
        if (key.type == KeyType::DataFile) {
            if (scene.sea.measured && key.path == kSpectrumFile) value = content_text(*scene.sea.measured);
            if (scene.surface.cage && key.path == kCageFile) value = scene.surface.cage->content();
        } else if (key.type != KeyType::DataTime) {  // is part of its file's line
            value = value_text(key, content_value(scene, key));
            if (key.path == kCoastKey && scene.waves.coast_depths)
                value += ' ' + scene.waves.coast_depths->content();
        }
        if (!value.empty()) text += key.path + " = " + value + '\n';
    }
    return text;
}

std::string canonical(const Scene& scene) {
    return canonical(scene, ~key_parts(KeyPart::Range));
}

}  // namespace pelagic
