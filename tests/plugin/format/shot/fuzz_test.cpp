// Damaged shot files load or are refused; nothing else happens.
#include <gtest/gtest.h>

#include <random>

#include "core/scene/validate.h"
#include "plugin/format/shot/shot.h"
#include "tests/plugin/format/shot/no_check.h"

namespace pelagic {
namespace {

const std::filesystem::path kFolder =
    std::filesystem::path(PELAGIC_SOURCE_DIR) / "tests/plugin/format/shot/data";

constexpr std::string_view kShot =
    R"(# A sea of a made-up buoy with a swell from another storm, seen from a camera that moves a little. Everything that
# a shot can say is said at least once, and where a comment stands damage does no harm.
[shot]
name = "fuzz-1"
frames = [1, 48]
fps = 24
seed = 7
loop_s = 10.0
[sea]
wind_speed_mps = 14.0
fetch_m = 300e3
depth_m = inf
spectrum = "file"
spectrum_file = "made-99001w2021.txt"
spectrum_time = 2021-03-01T00:50:00Z
swell = [ { height_m = 1.5, period_s = 11.0, direction_deg = 80.0 } ]
[waves]
choppiness = 1
cascades = [ { size_m = 400.0, resolution = 512 }, { size_m = 31.0, resolution = 256 } ]
[surface]
size_m = 200.0
resolution = 256
[camera]
position_m = [0.0, -60.0, 4.0]
keys = [ { frame = 1, position_m = [0, 1, 2], look_at_m = [3, 4, 5] }, { frame = 9, position_m = [0, 1, 3], look_at_m = [3, 4, 5] } ]
resolution = [1280, 720]
[effects]
whitecaps = false
[output]
attributes = ["normal", "velocity"]
maps = ["displacement"]
)";

std::string damaged(std::string text, std::mt19937& random) {
    const auto below = [&](std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n == 0 ? 0 : n - 1)(random);
    };
    constexpr std::string_view kTelling = "[]{}=\"'.,-+#\n\r0123456789eE_infTZ:\\";
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
        const std::size_t at = below(text.size());
        const std::size_t length = std::min(1 + below(12), text.size() - at);
        switch (below(5)) {
            case 0:
                text[at] = static_cast<char>(below(256));
                break;
            case 1:
                text[at] = kTelling[below(kTelling.size())];
                break;
            case 2:
                text.erase(at, length);
                break;
            case 3:
                text.insert(below(text.size()), text.substr(at, length));
                break;
            default:
                text.insert(at, 1, kTelling[below(kTelling.size())]);
                break;
        }
        if (text.empty()) break;
    }
    return text;
}

TEST(ShotFuzz, DamagedFilesLoadOrAreRefused) {
    ASSERT_NO_THROW(parse_shot(kShot, kFolder / "fuzz.toml", no_check));
    int loaded = 0;
    int refused = 0;
    for (unsigned seed = 0; seed < 2000; ++seed) {
        std::mt19937 random(seed);
        const std::string text = damaged(std::string(kShot), random);
        try {
            const Scene scene = parse_shot(text, kFolder / "fuzz.toml", no_check);
            EXPECT_TRUE(validate(scene).empty()) << text;
            ++loaded;
        } catch (const ShotError& error) {
            EXPECT_TRUE(std::string_view(error.what()).find("fuzz.toml:") != std::string_view::npos)
                << error.what();
            EXPECT_TRUE(std::string_view(error.what()).find("; accepted: ") != std::string_view::npos)
                << error.what();
            ++refused;
        }
    }
    // Both happen, or the damage is none, or total.
    EXPECT_GT(loaded, 20);
    EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace pelagic
