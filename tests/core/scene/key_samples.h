// Values of any key, for tests that go over the whole table.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/scene/keys.h"

namespace pelagic::test {

// The ends of a key's range as values of its type: a number, a point of equal numbers, …
inline KeyValue value_at(const Key& key, double number) {
    const auto integer = static_cast<std::int64_t>(number);
    switch (key.type) {
        case KeyType::Integer:
            return integer;
        case KeyType::Pair:
            return std::vector<std::int64_t>{integer, integer};
        case KeyType::Point:
            return std::vector<double>(3, number);
        default:
            return number;
    }
}

// A triangle at folder/boat.obj, and as many vessels as a body could be.
inline Scene scene_with_body() {
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    Scene scene;
    scene.waves.vessels.resize(limits::kVessels);
    scene.objects = {{.file = "folder/boat.obj",
                      .mesh = std::make_shared<const ObjectMesh>(ObjectMeshData{
                          .points_m = {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}},
                          .triangles = {0, 1, 2},
                          .normals = {up, up, up},
                          .material = {0},
                          .materials = {{.name = "paint"}}})}};
    return scene;
}

// An entry whose keys are all good.
inline KeyEntry good_entry(const Key& list) {
    KeyEntry entry;
    for (const Key& key : list.entry_keys) entry.values.emplace_back(key.name, key.fallback);
    if (list.path == "sea.swell") {  // of any height and of any period it doesn't break
        entry.values[0].second = 1e-3;
        entry.values[1].second = 100.0;
    }
    if (list.path == "waves.band_gains") entry.values[2].second = 1.5;  // 1 changes nothing
    if (list.path == "waves.masks")
        for (auto& [name, value] : entry.values)
            if (name == "waves") value = 0.5;  // and so here
    if (list.path == kObjectsKey) entry.values[0].second = std::string("folder/boat.obj");
    if (list.path == "camera.keys") entry.values[1].second = std::vector<double>{0.0, -60.0, 4.0};
    return entry;
}

// The same type, another value: near the one that is there and within the range.
inline KeyValue another_value(const Key& key, const KeyValue& now) {
    struct Visitor {
        const Key& key;
        double moved(double value) const {
            const double up = value + 0.25;
            return key.range && !key.range->holds(up) ? value - 0.25 : up;
        }
        KeyValue operator()(std::monostate) const {
            return key.type == KeyType::Text ? KeyValue(std::string("x.exr")) : KeyValue(key.range->low);
        }
        KeyValue operator()(bool truth) const { return !truth; }
        KeyValue operator()(std::int64_t integer) const {
            const std::int64_t up = integer + (integer < 8 ? 1 : -2);
            return key.range && !key.range->holds(static_cast<double>(up)) ? integer - 1 : up;
        }
        KeyValue operator()(double value) const {
            // Depth may be infinite.
            return value > 1e300 ? KeyValue(key.range->high) : KeyValue(moved(value));
        }
        KeyValue operator()(const std::string& text) const {
            if (key.choices.empty()) return text + "x";
            const auto here = std::find(key.choices.begin(), key.choices.end(), text);
            return here + 1 == key.choices.end() ? key.choices.front() : *(here + 1);
        }
        KeyValue operator()(std::vector<double> point) const {
            point[2] = moved(point[2]);
            return point;
        }
        KeyValue operator()(std::vector<std::int64_t> pair) const {
            pair[1] += 1;
            return pair;
        }
        KeyValue operator()(std::vector<std::string> words) const {
            if (words.empty())
                words.push_back(key.choices.front());
            else
                words.pop_back();
            return words;
        }
        KeyValue operator()(NumberKeys number) const {
            number.keys.back().value = moved(number.keys.back().value);
            return number;
        }
        KeyValue operator()(std::vector<KeyEntry> entries) const {
            entries.push_back(good_entry(key));
            return entries;
        }
    };
    return std::visit(Visitor{key}, now);
}

}  // namespace pelagic::test
