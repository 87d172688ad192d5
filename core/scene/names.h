// The shot file's words for every choice of a Scene: one table each, for the parser, explain and the record
// alike.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pelagic/scene.h"

namespace pelagic {

template <class Choice>
struct Word {
    Choice value;
    std::string_view word;
};

// The words of a choice, in the order of the enumeration.
std::span<const Word<SpectrumKind>> words_of(SpectrumKind);
std::span<const Word<ShortWaves>> words_of(ShortWaves);
std::span<const Word<GrowthLaw>> words_of(GrowthLaw);
std::span<const Word<WhitecapLaw>> words_of(WhitecapLaw);
std::span<const Word<SpraySource>> words_of(SpraySource);
std::span<const Word<SpreadingKind>> words_of(SpreadingKind);
std::span<const Word<WaveModel>> words_of(WaveModel);
std::span<const Word<Tiling>> words_of(Tiling);
std::span<const Word<Buoyancy>> words_of(Buoyancy);
std::span<const Word<SurfaceKind>> words_of(SurfaceKind);
std::span<const Word<Beyond>> words_of(Beyond);
std::span<const Word<CameraInterpolation>> words_of(CameraInterpolation);
std::span<const Word<WaterType>> words_of(WaterType);
std::span<const Word<QualityLevel>> words_of(QualityLevel);
std::span<const Word<MeshFormat>> words_of(MeshFormat);
std::span<const Word<MeshAttribute>> words_of(MeshAttribute);
std::span<const Word<MapKind>> words_of(MapKind);
std::span<const Word<MeshScheme>> words_of(MeshScheme);
std::span<const Word<VolumeKind>> words_of(VolumeKind);

// The word of a value; empty for a number that is none of the enumeration's.
template <class Choice>
requires std::is_enum_v<Choice> std::string_view word_of(Choice value) {
    for (const Word<Choice>& entry : words_of(value)) {
        if (entry.value == value) return entry.word;
    }
    return {};
}

// The value of a word, spelled exactly.
template <class Choice>
requires std::is_enum_v<Choice> std::optional<Choice> choice_of(std::string_view word) {
    for (const Word<Choice>& entry : words_of(Choice{})) {
        if (entry.word == word) return entry.value;
    }
    return std::nullopt;
}

// All words of a choice, for messages and suggestions.
template <class Choice>
requires std::is_enum_v<Choice> std::vector<std::string> all_words() {
    std::vector<std::string> words;
    for (const Word<Choice>& entry : words_of(Choice{})) words.emplace_back(entry.word);
    return words;
}

// The candidate that a person who typed `word` most likely meant: one that begins with it ("wind" of
// wind_speed_mps), else the one with the fewest insertions, deletions, replacements and swaps of neighbours,
// at most a third of the longer word's letters, else one that contains it. Upper and lower case, and _ and -,
// count as equal. Empty: none.
std::string nearest(std::string_view word, std::span<const std::string> candidates);

}  // namespace pelagic
