// How dense foam is while it breaks and afterwards: all of it together as Koepke found it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "plugin/files/files.h"
#include "plugin/format/exr/exr.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

TEST(FoamOfAllAges, HasKoepkesMean) {
    for (const double active : {0.0, 0.01, 0.1, 0.3, 0.7, 0.99, 1.0}) {
        const FoamLook look = make_foam(Scene{}, nullptr, active);
        EXPECT_NEAR(active * static_cast<double>(look.fresh_opacity) +
                        (1.0 - active) * static_cast<double>(look.old_opacity),
                    0.4, 1e-6)
            << active;
        EXPECT_GE(look.fresh_opacity, look.old_opacity) << active;
        EXPECT_LE(look.fresh_opacity, 1.0f) << active;
        EXPECT_GE(look.old_opacity, 0.0f) << active;
    }
    // Fresh foam is white where most of the foam is old.
    EXPECT_GT(make_foam(Scene{}, nullptr, 0.1).fresh_opacity, 0.8f);
}

// A near gale draws foam out as the key says, a storm twice as far, and a light breeze not at all.
TEST(FoamStreaks, AreWhatTheWindBlows) {
    Scene scene;
    scene.effects.foam_streaks = 0.4;
    for (const auto& [wind_mps, streaks] :
         {std::pair{4.0, 0.0}, {10.0, 0.2}, {15.0, 0.4}, {25.0, 0.8}, {40.0, 0.8}}) {
        scene.sea.wind_speed_mps = wind_mps;
        EXPECT_NEAR(make_foam(scene, nullptr, 0.25).streaks, streaks, 1e-12) << wind_mps;
    }
    scene.effects.foam_streaks = 1.0;
    EXPECT_EQ(make_foam(scene, nullptr, 0.25).streaks, 1.0);
}

// What an artist says of one age leaves the mean, as far as the other age can make up for it; of both, it is what is seen.
TEST(FoamOfAllAges, IsWhatTheShotSays) {
    Scene scene;
    scene.effects.foam_new_albedo = 0.7;
    scene.effects.foam_old_albedo = 0.3;
    scene.effects.foam_new_opaque = 0.8;
    FoamLook look = make_foam(scene, nullptr, 0.25);
    EXPECT_EQ(look.fresh_albedo, 0.7f);
    EXPECT_EQ(look.old_albedo, 0.3f);
    EXPECT_EQ(look.fresh_opacity, 0.8f);
    EXPECT_NEAR(look.old_opacity, (0.4 - 0.25 * 0.8) / 0.75, 1e-6);
    scene.effects.foam_new_opaque = 0.0;
    scene.effects.foam_old_opaque = 0.3;
    look = make_foam(scene, nullptr, 0.25);
    EXPECT_NEAR(look.fresh_opacity, (0.4 - 0.75 * 0.3) / 0.25, 1e-6);
    EXPECT_EQ(look.old_opacity, 0.3f);
    scene.effects.foam_old_opaque = 0.9;
    for (const double active : {0.0, 1e-9, 0.25, 1.0}) {
        look = make_foam(scene, nullptr, active);
        EXPECT_GE(look.fresh_opacity, 0.0f) << active;
        EXPECT_LE(look.fresh_opacity, 1.0f) << active;
        EXPECT_EQ(look.old_opacity, 0.9f) << active;
    }
    scene.effects.foam_new_opaque = 1.0;
    EXPECT_EQ(make_foam(scene, nullptr, 0.25).fresh_opacity, 1.0f);
}

// Lines of brightness 0, 1 ... 15, to the right or upwards.
void write_lines(const std::filesystem::path& file, bool upwards) {
    constexpr int kSide = 16;
    std::vector<float> texels;
    for (int i = 0; i < kSide * kSide; ++i)
        texels.push_back(static_cast<float>(upwards ? i / kSide : i % kSide));
    files::write_atomically(
        file, exr::encode_scanline(
                  {}, {.width = kSide,
                       .height = kSide,
                       .channels = {{.name = "Y", .data = texels.data(), .type = exr::PixelType::Half}}}));
}

// While only the light changes it isn't read again; a file that has changed is.
TEST(KeptFoamPicture, IsMadeAgainWhereItsFileHasChanged) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::temp_directory_path() / ("pelagic_foam_" + std::to_string(getpid()));
    fs::create_directories(folder);
    Scene scene;
    EXPECT_EQ(kept_foam_picture(scene), nullptr);
    scene.effects.foam_pattern = folder / "lines.exr";
    write_lines(scene.effects.foam_pattern, false);
    const auto first = kept_foam_picture(scene);
    ASSERT_NE(first, nullptr);
    EXPECT_EQ(first->texels, make_foam_picture(scene)->texels);
    scene.light.sun_elevation_deg += 1.0;
    EXPECT_EQ(kept_foam_picture(scene), first);

    const auto changed = fs::last_write_time(scene.effects.foam_pattern);
    write_lines(scene.effects.foam_pattern, true);
    fs::last_write_time(scene.effects.foam_pattern, changed + std::chrono::seconds(1));
    const auto second = kept_foam_picture(scene);
    EXPECT_NE(second->texels, first->texels);
    EXPECT_EQ(second->texels, make_foam_picture(scene)->texels);

    // The same bytes elsewhere are another file.
    fs::copy_file(folder / "lines.exr", folder / "copy.exr");
    scene.effects.foam_pattern = folder / "copy.exr";
    EXPECT_NE(kept_foam_picture(scene), second);
    scene.effects.foam_pattern = folder / "none.exr";
    EXPECT_THROW(kept_foam_picture(scene), std::invalid_argument);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace pelagic
