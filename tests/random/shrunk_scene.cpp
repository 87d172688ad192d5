#include "tests/random/shrunk_scene.h"

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pelagic::test {
namespace {

double one_digit(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.0e", value);
    return std::strtod(text, nullptr);
}

class Shrinking {
  public:
    Shrinking(RandomScene scene, const std::function<bool(const RandomScene&)>& still_fails, int runs)
        : scene_(std::move(scene)), still_fails_(still_fails), runs_(runs) {}

    RandomScene simplest() {
        bool has_changed = true;
        while (has_changed) {
            has_changed = leave_out(1);
            has_changed = (!has_changed && leave_out(2)) || has_changed;
            has_changed = shorten() || has_changed;
            has_changed = round() || has_changed;
        }
        scene_.forget_unnamed_files();
        return std::move(scene_);
    }

  private:
    bool try_out(RandomScene simpler) {
        if (runs_ <= 0 || !is_affordable(simpler)) return false;
        --runs_;
        if (!still_fails_(simpler)) return false;
        scene_ = std::move(simpler);
        return true;
    }

    // So many keys at once: some mean something only together.
    bool leave_out(int together) {
        bool has_changed = false;
        for (std::size_t i = 0; i < scene_.keys.size();) {
            bool is_gone = false;
            for (std::size_t k = together == 1 ? i : i + 1; k < scene_.keys.size() && !is_gone; ++k) {
                if (costs_too_much(*scene_.keys[i].key) || costs_too_much(*scene_.keys[k].key)) {
                    if (together == 1) break;
                    continue;
                }
                RandomScene simpler = scene_;
                simpler.keys.erase(simpler.keys.begin() + static_cast<std::ptrdiff_t>(k));
                if (together == 2) simpler.keys.erase(simpler.keys.begin() + static_cast<std::ptrdiff_t>(i));
                is_gone = try_out(std::move(simpler));
                if (together == 1) break;
            }
            has_changed = has_changed || is_gone;
            if (!is_gone) ++i;
        }
        return has_changed;
    }

    template <class List>
    bool shorten(std::size_t key) {
        bool has_changed = false;
        const auto size = [&] {
            const auto* list = std::get_if<List>(&scene_.keys[key].value);
            return list ? list->size() : 0;
        };
        for (std::size_t half = (size() + 1) / 2; half > 0; half /= 2)
            for (std::size_t first = 0; first + half <= size();) {
                RandomScene simpler = scene_;
                auto& list = std::get<List>(simpler.keys[key].value);
                const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
                list.erase(begin, begin + static_cast<std::ptrdiff_t>(half));
                if (try_out(std::move(simpler)))
                    has_changed = true;
                else
                    ++first;
            }
        return has_changed;
    }
    bool shorten() {
        bool has_changed = false;
        for (std::size_t key = 0; key < scene_.keys.size(); ++key) {
            has_changed = shorten<std::vector<KeyEntry>>(key) || has_changed;
            has_changed = shorten<std::vector<std::string>>(key) || has_changed;
        }
        return has_changed;
    }

    // All numbers of a value.
    static void each_number(KeyValue& value, const std::function<void(double&)>& take) {
        if (auto* number = std::get_if<double>(&value)) take(*number);
        if (auto* numbers = std::get_if<std::vector<double>>(&value))
            for (double& number : *numbers) take(number);
        if (auto* number = std::get_if<NumberKeys>(&value))
            for (NumberKeys::Key& key : number->keys) take(key.value);
        if (auto* entries = std::get_if<std::vector<KeyEntry>>(&value))
            for (KeyEntry& entry : *entries)
                for (auto& [name, inner] : entry.values) each_number(inner, take);
    }
    bool round() {
        bool has_changed = false;
        for (std::size_t key = 0; key < scene_.keys.size(); ++key) {
            int count = 0;
            each_number(scene_.keys[key].value, [&](double&) { ++count; });
            for (int i = 0; i < count; ++i) {
                RandomScene simpler = scene_;
                int at = 0;
                bool is_other = false;
                each_number(simpler.keys[key].value, [&](double& number) {
                    if (at++ != i || !std::isfinite(number)) return;
                    const double rounded = one_digit(number);
                    is_other = rounded != number;
                    number = rounded;
                });
                if (is_other) has_changed = try_out(std::move(simpler)) || has_changed;
            }
        }
        return has_changed;
    }

    RandomScene scene_;
    const std::function<bool(const RandomScene&)>& still_fails_;
    int runs_;
};

}  // namespace

RandomScene shrunk(RandomScene scene, const std::function<bool(const RandomScene&)>& still_fails,
                   int most_runs) {
    return Shrinking(std::move(scene), still_fails, most_runs).simplest();
}

}  // namespace pelagic::test
