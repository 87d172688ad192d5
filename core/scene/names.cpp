// The shot file's words for every choice of a Scene, and the search for the nearest one. See names.h.
#include "core/scene/names.h"

#include <algorithm>
#include <cstddef>

namespace pelagic {

namespace {

constexpr std::array kSpectra = std::to_array<Word<SpectrumKind>>({
    {SpectrumKind::PiersonMoskowitz, "pierson-moskowitz"},
    {SpectrumKind::Jonswap, "jonswap"},
    {SpectrumKind::Jonswap1973, "jonswap-1973"},
    {SpectrumKind::Tma, "tma"},
    {SpectrumKind::Elfouhaily, "elfouhaily"},
    {SpectrumKind::Omega2, "omega-2"},
    {SpectrumKind::Phillips, "phillips"},
    {SpectrumKind::File, "file"},
});
constexpr std::array kShortWaves = std::to_array<Word<ShortWaves>>({
    {ShortWaves::Elfouhaily, "elfouhaily"},
    {ShortWaves::None, "none"},
});
constexpr std::array kGrowthLaws = std::to_array<Word<GrowthLaw>>({
    {GrowthLaw::HeightAndPeak, "height-and-peak"},
    {GrowthLaw::Height, "height"},
});
constexpr std::array kWhitecapLaws = std::to_array<Word<WhitecapLaw>>({
    {WhitecapLaw::Monahan1980, "monahan-1980"},
    {WhitecapLaw::Monahan1986, "monahan-1986"},
    {WhitecapLaw::Callaghan2008, "callaghan-2008"},
});
constexpr std::array kSpraySources = std::to_array<Word<SpraySource>>({
    {SpraySource::Monahan1986, "monahan-1986"},
    {SpraySource::Andreas1998, "andreas-1998"},
});
constexpr std::array kSpreadings = std::to_array<Word<SpreadingKind>>({
    {SpreadingKind::Hasselmann, "hasselmann"},
    {SpreadingKind::DonelanBanner, "donelan-banner"},
    {SpreadingKind::Cosine, "cosine"},
    {SpreadingKind::Elfouhaily, "elfouhaily"},
});
constexpr std::array kBuoyancies = std::to_array<Word<Buoyancy>>({
    {Buoyancy::Plane, "plane"},
    {Buoyancy::Response, "response"},
});
constexpr std::array kModels = std::to_array<Word<WaveModel>>({
    {WaveModel::Fft, "fft"},
    {WaveModel::Trochoid, "trochoid"},
});
constexpr std::array kTilings = std::to_array<Word<Tiling>>({
    {Tiling::Random, "random"},
    {Tiling::Periodic, "periodic"},
});
constexpr std::array kSurfaces = std::to_array<Word<SurfaceKind>>({
    {SurfaceKind::Patch, "patch"},
    {SurfaceKind::ProjectedGrid, "projected-grid"},
    {SurfaceKind::NearFar, "near-far"},
    {SurfaceKind::Cage, "cage"},
    {SurfaceKind::Planet, "planet"},
});
constexpr std::array kBeyond = std::to_array<Word<Beyond>>({
    {Beyond::ByKind, "by-kind"},
    {Beyond::Sea, "sea"},
    {Beyond::Nothing, "nothing"},
});
constexpr std::array kInterpolations = std::to_array<Word<CameraInterpolation>>({
    {CameraInterpolation::Linear, "linear"},
    {CameraInterpolation::Smooth, "smooth"},
});
constexpr std::array kWaters = std::to_array<Word<WaterType>>({
    {WaterType::Ocean, "ocean"},
    {WaterType::Coastal, "coastal"},
    {WaterType::Turbid, "turbid"},
    {WaterType::JerlovI, "jerlov-I"},
    {WaterType::JerlovIA, "jerlov-IA"},
    {WaterType::JerlovIB, "jerlov-IB"},
    {WaterType::JerlovII, "jerlov-II"},
    {WaterType::JerlovIII, "jerlov-III"},
    {WaterType::Jerlov1C, "jerlov-1C"},
    {WaterType::Jerlov3C, "jerlov-3C"},
    {WaterType::Jerlov5C, "jerlov-5C"},
    {WaterType::Jerlov7C, "jerlov-7C"},
    {WaterType::Jerlov9C, "jerlov-9C"},
});
constexpr std::array kLevels = std::to_array<Word<QualityLevel>>({
    {QualityLevel::Draft, "draft"},
    {QualityLevel::Preview, "preview"},
    {QualityLevel::Final, "final"},
    {QualityLevel::Reference, "reference"},
});
constexpr std::array kMeshes = std::to_array<Word<MeshFormat>>({
    {MeshFormat::Usda, "usda"},
    {MeshFormat::Usdc, "usdc"},
    {MeshFormat::None, "none"},
});
constexpr std::array kAttributes = std::to_array<Word<MeshAttribute>>({
    {MeshAttribute::Normal, "normal"},
    {MeshAttribute::Velocity, "velocity"},
    {MeshAttribute::SlopeVariance, "slope-variance"},
    {MeshAttribute::Whitecaps, "whitecaps"},
});
constexpr std::array kMaps = std::to_array<Word<MapKind>>({
    {MapKind::Displacement, "displacement"},
    {MapKind::Normal, "normal"},
    {MapKind::SlopeVariance, "slope-variance"},
    {MapKind::Whitecaps, "whitecaps"},
    {MapKind::Floor, "floor"},
});
constexpr std::array kSchemes = std::to_array<Word<MeshScheme>>({
    {MeshScheme::None, "none"},
    {MeshScheme::CatmullClark, "catmullClark"},
});
constexpr std::array kVolumes = std::to_array<Word<VolumeKind>>({
    {VolumeKind::Spray, "spray"},
    {VolumeKind::LevelSet, "level-set"},
});

char folded(char c) {
    if (c >= 'A' && c <= 'Z') return static_cast<char>(c - 'A' + 'a');
    return c == '-' ? '_' : c;
}

std::string folded(std::string_view text) {
    std::string out(text);
    std::transform(out.begin(), out.end(), out.begin(), [](char c) { return folded(c); });
    return out;
}

// Optimal string alignment: Damerau 1964 (CACM 7, 171), by Wagner and Fischer's table, three rows of it.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), previous(b.size() + 1), current(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) previous[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        current[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = previous[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            current[j] = std::min({previous[j] + 1, current[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                current[j] = std::min(current[j], before[j - 2] + 1);
            }
        }
        std::swap(before, previous);
        std::swap(previous, current);
    }
    return previous[b.size()];
}

}  // namespace

std::span<const Word<SpectrumKind>> words_of(SpectrumKind) {
    return kSpectra;
}
std::span<const Word<ShortWaves>> words_of(ShortWaves) {
    return kShortWaves;
}
std::span<const Word<GrowthLaw>> words_of(GrowthLaw) {
    return kGrowthLaws;
}
std::span<const Word<WhitecapLaw>> words_of(WhitecapLaw) {
    return kWhitecapLaws;
}
std::span<const Word<SpraySource>> words_of(SpraySource) {
    return kSpraySources;
}
std::span<const Word<SpreadingKind>> words_of(SpreadingKind) {
    return kSpreadings;
}
std::span<const Word<Buoyancy>> words_of(Buoyancy) {
    return kBuoyancies;
}
std::span<const Word<WaveModel>> words_of(WaveModel) {
    return kModels;
}
std::span<const Word<Tiling>> words_of(Tiling) {
    return kTilings;
}
std::span<const Word<SurfaceKind>> words_of(SurfaceKind) {
    return kSurfaces;
}
std::span<const Word<Beyond>> words_of(Beyond) {
    return kBeyond;
}
std::span<const Word<CameraInterpolation>> words_of(CameraInterpolation) {
    return kInterpolations;
}
std::span<const Word<WaterType>> words_of(WaterType) {
    return kWaters;
}
std::span<const Word<QualityLevel>> words_of(QualityLevel) {
    return kLevels;
}
std::span<const Word<MeshFormat>> words_of(MeshFormat) {
    return kMeshes;
}
std::span<const Word<MeshAttribute>> words_of(MeshAttribute) {
    return kAttributes;
}
std::span<const Word<MapKind>> words_of(MapKind) {
    return kMaps;
}
std::span<const Word<MeshScheme>> words_of(MeshScheme) {
    return kSchemes;
}
std::span<const Word<VolumeKind>> words_of(VolumeKind) {
    return kVolumes;
}

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
    constexpr std::size_t kLongest =
        64;  // nothing of ours is as long; keeps the table small for hostile input
    if (word.empty() || word.size() > kLongest) return {};
    const std::string wanted = folded(word);
    const bool is_telling = wanted.size() >= 3;  // shorter ones occur in too many words
    std::string best;
    std::size_t best_score = 0;
    for (const std::string& candidate : candidates) {
        const std::string offered = folded(candidate);
        const std::size_t distance = edit_distance(wanted, offered);
        const bool is_close =
            distance <= std::max<std::size_t>(1, std::max(wanted.size(), offered.size()) / 3);
        const bool is_beginning = is_telling && offered.starts_with(wanted);
        if (!is_close && !is_beginning) continue;
        // An edit costs two, a beginning one: "wind" is nearer to "wind_speed_mps" than to "kind".
        const std::size_t score = is_beginning ? std::min<std::size_t>(1, 2 * distance) : 2 * distance;
        if (best.empty() || score < best_score) {
            best = candidate;
            best_score = score;
        }
    }
    if (!best.empty() || !is_telling) return best;
    for (const std::string& candidate : candidates) {
        if (folded(candidate).find(wanted) != std::string::npos) return candidate;
    }
    return {};
}

}  // namespace pelagic
