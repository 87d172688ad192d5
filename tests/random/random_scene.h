// Shot files at random, over the whole valid range of every key: drawn from the table of keys (core/scene/keys.h), so
// that a new key is drawn without a word here.
//
// Each key is left out, or drawn: numbers evenly over their soft range or over all of their range, by their logarithm
// where that spans decades, with the range's ends now and then; words and lists with up to three entries. Keys drawn one by
// one seldom make a shot together, so what a few of them mean together is drawn together, and what is
// refused then is drawn again; but not always, so that refusals are tested as well.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/keys.h"
#include "pelagic/scene.h"

namespace pelagic::test {

// What a test can't pay for of a key's range, and why.
struct Cap {
    std::string_view what;  // the path of a key, whose numbers are capped, or what is counted
    Range range;
    std::string_view why;
};
std::span<const Cap> caps();

// What numbers of this key are drawn from: its range within its cap.
Range drawn_range(const Key& key);

struct GivenKey {
    const Key* key;
    KeyValue value;
};

struct RandomScene {
    std::uint64_t seed = 0;
    std::vector<GivenKey> keys;                // in the table's order; every other one has its default
    std::map<std::string, std::string> files;  // that they name: bytes by name

    const KeyValue* value(std::string_view path) const;  // null: not given
    std::string text() const;                            // of the shot file
    void forget_unnamed_files();
    // FOLDER/shot.toml and the files beside it.
    std::filesystem::path write(const std::filesystem::path& folder) const;
    // As core sees it: cages are read, and a buoy's spectrum is a stand-in. Nothing where a cage is refused.
    std::optional<Scene> scene() const;
};

// Whether a key's default costs more than what is drawn of it, and whether the scene costs more than its caps allow.
bool costs_too_much(const Key& key);
bool is_affordable(const RandomScene& scene);

// The same seed, the same scene.
RandomScene random_scene(std::uint64_t seed);

}  // namespace pelagic::test
