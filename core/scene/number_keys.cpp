#include "core/scene/number_keys.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/scene/text.h"

namespace pelagic {

namespace {

// Between a key and the next.
class Span {
  public:
    Span(const NumberKeys& number, bool is_angle, std::size_t from)
        : keys_(number.keys),
          is_angle_(is_angle),
          is_smooth_(number.interpolation == CameraInterpolation::Smooth),
          from_(from),
          frames_(frames(from)),
          whole_(change(from)) {
        if (!is_smooth_) return;
        begins_ = slope(from);
        ends_ = slope(from + 1);
    }
    // At the share t of the frames: what has been added to the first key's value, and how fast that grows, a frame.
    double added(double t) const {
        const double u = 1.0 - t;
        if (!is_smooth_) return t * whole_;
        return t * t * (3.0 - 2.0 * t) * whole_ + t * u * frames_ * (u * begins_ - t * ends_);
    }
    double rate(double t) const {
        const double u = 1.0 - t;
        if (!is_smooth_) return whole_ / frames_;
        return 6.0 * t * u * whole_ / frames_ + u * (u - 2.0 * t) * begins_ - t * (2.0 * u - t) * ends_;
    }
    double share(double frame) const { return (frame - keys_[from_].frame) / frames_; }

  private:
    // In double: the difference of two ints may overflow an int.
    double frames(std::size_t i) const { return static_cast<double>(keys_[i + 1].frame) - keys_[i].frame; }
    double change(std::size_t i) const {
        const double plain = keys_[i + 1].value - keys_[i].value;
        return is_angle_ ? std::remainder(plain, 360.0) : plain;
    }
    // The slope at a key that keeps the cubics monotone: the weighted harmonic mean of the lines' beside it, 0 at a turn (Fritsch and
    // Butland, SIAM J. Sci. Stat. Comput. 5, 1984), and at the ends.
    double slope(std::size_t i) const {
        if (i == 0 || i + 1 == keys_.size()) return 0.0;
        const double h = frames(i - 1), k = frames(i), a = change(i - 1) / h, b = change(i) / k;
        if (!(a * b > 0.0)) return 0.0;
        return 3.0 * (h + k) / ((2.0 * k + h) / a + (k + 2.0 * h) / b);
    }

    const std::vector<NumberKeys::Key>& keys_;
    bool is_angle_, is_smooth_;
    std::size_t from_;
    double frames_, whole_, begins_ = 0.0, ends_ = 0.0;
};

// The keys that are not after a frame.
std::size_t keys_until(const NumberKeys& number, double frame) {
    const auto after = std::upper_bound(number.keys.begin(), number.keys.end(), frame,
                                        [](double f, const NumberKeys::Key& key) { return f < key.frame; });
    return static_cast<std::size_t>(after - number.keys.begin());
}

bool stands_still(const NumberKeys& number) {
    return std::ranges::all_of(
        number.keys, [&](const NumberKeys::Key& key) { return key.value == number.keys.front().value; });
}

}  // namespace

double value_at(const NumberKeys& number, bool is_angle, double frame) {
    const auto& keys = number.keys;
    const std::size_t until = keys_until(number, frame);
    if (until == 0) return keys.front().value;
    const std::size_t from = until - 1;
    if (until == keys.size() || frame == keys[from].frame) return keys[from].value;
    const Span span(number, is_angle, from);
    const double value = keys[from].value + span.added(span.share(frame));
    if (is_angle) return value;
    // Rounding must not leave the keys' values, which may be a limit.
    const auto [low, high] = std::minmax(keys[from].value, keys[until].value);
    return std::clamp(value, low, high);
}

double standing_for(const NumberKeys& number, bool is_angle) {
    return is_angle ? number.keys.front().value
                    : std::ranges::max_element(number.keys, {}, &NumberKeys::Key::value)->value;
}

double rate_at(const NumberKeys& number, double frame) {
    const std::size_t until = keys_until(number, frame);
    if (until == 0) return 0.0;
    const bool is_last = until == number.keys.size();
    const double after = is_last ? 0.0 : Span(number, false, until - 1).rate(0.0);
    if (frame == number.keys[until - 1].frame)
        return 0.5 * (after + (until < 2 ? 0.0 : Span(number, false, until - 2).rate(1.0)));
    if (is_last) return 0.0;
    const Span span(number, false, until - 1);
    return span.rate(span.share(frame));
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

bool changes(const Scene& scene, std::string_view table) {
    return std::ranges::any_of(scene.keyed, [&](const KeyedNumber& number) {
        return number.path.starts_with(std::string(table) + '.') && !stands_still(number.keys);
    });
}

std::string why_no_keys(std::string_view path) {
    if (path == "sea.gust_size_m") return ": patches far away would race over the sea as they grow";
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
        if (is_of_sea(number) && !keys.empty() && stands_still(number.keys))
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
