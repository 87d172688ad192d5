#include "core/scene/number_keys.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/scene/text.h"

namespace pelagic {

double value_at(const NumberKeys& number, bool is_angle, double frame) {
    const auto& keys = number.keys;
    const auto after = std::upper_bound(keys.begin(), keys.end(), frame,
                                        [](double f, const NumberKeys::Key& key) { return f < key.frame; });
    if (after == keys.begin()) return after->value;
    const auto from = static_cast<std::size_t>(after - keys.begin()) - 1;
    if (after == keys.end() || frame == keys[from].frame) return keys[from].value;
    // In double: the difference of two ints may overflow an int.
    const auto frames = [&](std::size_t i) { return static_cast<double>(keys[i + 1].frame) - keys[i].frame; };
    const auto change = [&](std::size_t i) {
        const double plain = keys[i + 1].value - keys[i].value;
        return is_angle ? std::remainder(plain, 360.0) : plain;
    };
    const double t = (frame - keys[from].frame) / frames(from), whole = change(from);
    double share = t * whole;
    if (number.interpolation == CameraInterpolation::Smooth) {
        // The slope at a key that keeps the cubics monotone: the weighted harmonic mean of the lines' beside it, 0 at a turn (Fritsch and
        // Butland, SIAM J. Sci. Stat. Comput. 5, 1984), and at the ends.
        const auto slope = [&](std::size_t i) {
            if (i == 0 || i + 1 == keys.size()) return 0.0;
            const double h = frames(i - 1), k = frames(i), a = change(i - 1) / h, b = change(i) / k;
            if (!(a * b > 0.0)) return 0.0;
            return 3.0 * (h + k) / ((2.0 * k + h) / a + (k + 2.0 * h) / b);
        };
        const double u = 1.0 - t, span = frames(from);
        share = t * t * (3.0 - 2.0 * t) * whole + t * u * span * (u * slope(from) - t * slope(from + 1));
    }
    const double value = keys[from].value + share;
    if (is_angle) return value;
    // Rounding must not leave the keys' values, which may be a limit.
    const auto [low, high] = std::minmax(keys[from].value, keys[from + 1].value);
    return std::clamp(value, low, high);
}

Scene scene_at(const Scene& scene, double frame) {
    Scene made = scene;
    for (const KeyedNumber& number : scene.keyed) {
        const Key& key = key_of(number.path);
        double value = value_at(number.keys, key.is_angle, frame);
        if (key.is_angle && !key.range->holds(value)) value -= std::copysign(360.0, value);
        set_number(made, number.path, value);
    }
    return made;
}

namespace {

[[noreturn]] void refuse(const KeyedNumber& number) {
    throw std::invalid_argument(
        number.path +
        " has keys, and this shows one moment; accepted: a number, or the scene of a frame (in Python "
        "scene.at(frame), in C++ scene_at())");
}

}  // namespace

void refuse_keys(const Scene& scene, std::string_view table) {
    for (const KeyedNumber& number : scene.keyed)
        if (number.path.starts_with(table)) refuse(number);
}

std::string why_no_keys(std::string_view path) {
    if (path == "sea.depth_m") return ": waves keep their frequencies, and another depth has others";
    if (path == "sea.gust_size_m") return ": patches far away would race over the sea as they grow";
    if (path == "waves.choppiness" || path == "waves.lean_deg" || path == "waves.second_order")
        return ": where waves break, what that leaves and all bounds are those of one displacement";
    if (path.find("[]") != std::string_view::npos || path.starts_with("shot.") ||
        path.starts_with("quality.") || path.starts_with("output."))
        return ": it is one for the whole shot";
    return " yet";
}

std::string_view table_key(const KeyedNumber& number) {
    const auto entry = entry_of(number.path);
    return entry ? entry->list : number.path;
}

bool is_of_sea(const KeyedNumber& number) {
    return number.path.starts_with("sea.") || number.path.starts_with("waves.");
}

std::set<int> frames_of_sea(const Scene& scene) {
    std::set<int> frames;
    for (const KeyedNumber& number : scene.keyed)
        if (is_of_sea(number))
            for (const NumberKeys::Key& key : number.keys.keys) frames.insert(key.frame);
    return frames;
}

void refuse_keyed_sea(const Scene& scene) {
    for (const KeyedNumber& number : scene.keyed)
        if (is_of_sea(number)) refuse(number);
}

Scene without_still_keys(Scene scene) {
    for (const std::vector<KeyedNumber> keyed = scene.keyed; const KeyedNumber& number : keyed) {
        const auto& keys = number.keys.keys;
        const auto is_first = [&](const NumberKeys::Key& key) { return key.value == keys.front().value; };
        if (is_of_sea(number) && !keys.empty() && std::ranges::all_of(keys, is_first))
            set_number(scene, number.path, keys.front().value);
    }
    return scene;
}

Scene without_keyed(Scene scene) {
    for (const std::vector<KeyedNumber> keyed = scene.keyed; const KeyedNumber& number : keyed) {
        set_number(scene, number.path, key_of(number.path).fallback);
    }
    return scene;
}

std::string keyed_text(const Scene& scene, KeyPartSet parts, int frame) {
    std::string text;
    for (const Key& key : keys())
        for (const KeyedNumber& number : scene.keyed)
            if (table_key(number) == key.path && (key.key_parts & parts).any())
                text += number.path + " = " +
                        number_text(value_at(number.keys, key_of(number.path).is_angle, frame)) + '\n';
    return text;
}

}  // namespace pelagic
