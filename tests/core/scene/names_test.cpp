// The shot file's words, and the search for the nearest one.
#include "core/scene/names.h"

#include <gtest/gtest.h>

namespace pelagic {
namespace {

template <class Choice>
void expect_words(const std::vector<std::string>& words) {
    EXPECT_EQ(all_words<Choice>(), words);
    for (std::size_t i = 0; i < words.size(); ++i) {
        // In the enumeration's order, and back again.
        EXPECT_EQ(word_of(static_cast<Choice>(i)), words[i]);
        EXPECT_EQ(choice_of<Choice>(words[i]), static_cast<Choice>(i));
    }
    EXPECT_EQ(word_of(static_cast<Choice>(words.size())), "");
    EXPECT_EQ(choice_of<Choice>("Fft "), std::nullopt);
}

TEST(Names, AreTheShotFilesWords) {
    expect_words<SpectrumKind>(
        {"pierson-moskowitz", "jonswap", "jonswap-1973", "tma", "elfouhaily", "omega-2", "phillips", "file"});
    expect_words<SpreadingKind>({"hasselmann", "donelan-banner", "cosine", "elfouhaily"});
    expect_words<SpraySource>({"monahan-1986", "andreas-1998"});
    expect_words<WhitecapLaw>({"monahan-1980", "monahan-1986", "callaghan-2008"});
    expect_words<WaveModel>({"fft", "trochoid"});
    expect_words<SurfaceKind>({"patch", "projected-grid", "near-far", "cage", "planet"});
    expect_words<CameraInterpolation>({"linear", "smooth"});
    expect_words<WaterType>({"ocean", "coastal", "turbid", "jerlov-I", "jerlov-IA", "jerlov-IB", "jerlov-II",
                             "jerlov-III", "jerlov-1C", "jerlov-3C", "jerlov-5C", "jerlov-7C", "jerlov-9C"});
    expect_words<QualityLevel>({"draft", "preview", "final", "reference"});
    expect_words<MeshFormat>({"usda", "usdc", "none"});
    expect_words<MeshAttribute>({"normal", "velocity", "slope-variance", "whitecaps"});
    expect_words<MapKind>({"displacement", "normal", "slope-variance", "whitecaps", "floor"});
    expect_words<MeshScheme>({"none", "catmullClark"});
    expect_words<VolumeKind>({"spray", "level-set"});
}

TEST(Names, NearestFindsWhatWasMeant) {
    const std::vector<std::string> keys{"kind",    "wind_speed_mps", "wind_direction_deg",
                                        "fetch_m", "maps",           "map_resolution"};
    EXPECT_EQ(nearest("wind_sped_mps", keys), "wind_speed_mps");   // a letter left out
    EXPECT_EQ(nearest("fecth_m", keys), "fetch_m");                // two swapped
    EXPECT_EQ(nearest("Wind-Speed-Mps", keys), "wind_speed_mps");  // another spelling
    EXPECT_EQ(nearest("wind", keys), "wind_speed_mps");  // a beginning, though "kind" is one letter away
    EXPECT_EQ(nearest("map", keys), "maps");
    EXPECT_EQ(nearest("direction", keys), "wind_direction_deg");  // a part
    EXPECT_EQ(nearest("chlorophyll", keys), "");
    EXPECT_EQ(nearest("", keys), "");
    EXPECT_EQ(nearest("fetch_m", {}), "");
    EXPECT_EQ(nearest(std::string(100000, 'w'), keys), "");
}

}  // namespace
}  // namespace pelagic
