// Shot files: what loads, and for what doesn't the words that say where, what and what instead.
#include "plugin/format/shot/shot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/scene/canonical.h"
#include "core/scene/keys.h"
#include "core/scene/presets.h"
#include "core/scene/shot_text.h"
#include "core/scene/text.h"
#include "plugin/format/exr/exr.h"
#include "plugin/format/png/png.h"
#include "temporary_folder.h"
#include "tests/plugin/format/shot/no_check.h"

namespace pelagic {
namespace {

const std::filesystem::path kMadeUp =
    std::filesystem::path(PELAGIC_SOURCE_DIR) / "tests/plugin/format/shot/data";

Scene parse(std::string_view text) {
    return parse_shot(text, kMadeUp / "s.toml", no_check);
}

// The message of a text that is refused, the file's folder taken off; empty if it loads.
std::string refusal(std::string_view text) {
    try {
        parse_shot(text, "s.toml", no_check);
    } catch (const ShotError& error) {
        return error.what();
    }
    return "";
}

std::size_t lines(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
}

// Refused in one line that begins so and has this among what is accepted.
void expect_refused(std::string_view text, const std::string& begins, const std::string& accepted) {
    const std::string message = refusal(text);
    EXPECT_TRUE(message.starts_with("s.toml:" + begins))
        << text << "\n-> " << message << "\nwanted " << begins;
    const std::size_t at = message.find("; accepted: ");
    ASSERT_NE(at, std::string::npos) << text << "\n-> " << message;
    EXPECT_NE(message.find(accepted, at), std::string::npos) << message << "\nwanted " << accepted;
    EXPECT_EQ(lines(message), 1u) << message;
}

TEST(Shot, ACoastsDepthsAreReadWhereWavesFeelThem) {
    const std::filesystem::path file = std::filesystem::path(PELAGIC_SOURCE_DIR) / "examples" / "beach.toml";
    const std::string begins =
        "[sea]\ndepth_file = \"data/beach.exr\"\ndepth_size_m = 400\ndepth_east_m = 30\n[waves]\nmodel = \"trochoid\"\n";
    EXPECT_EQ(parse_shot(begins, file, no_check).waves.coast_depths, nullptr);
    const Scene scene = parse_shot(begins + "coast = true\n", file, no_check);
    ASSERT_TRUE(scene.waves.coast_depths);
    const DepthMap& depths = *scene.waves.coast_depths;
    EXPECT_EQ(depths.from_m(), glm::dvec2(-170.0, -200.0));
    EXPECT_EQ(depths.size_m(), glm::dvec2(400.0));
    const auto depth_m = [&](glm::dvec2 at) { return depths.mean_m(at, at); };
    EXPECT_LT(depth_m({30.0, 190.0}), 0.0);   // land in the north
    EXPECT_GT(depth_m({30.0, -190.0}), 8.0);  // the sea in the south
    const auto refused = [&](const std::string& text) {
        try {
            parse_shot(text, file, no_check);
        } catch (const ShotError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string gone =
        refused("[sea]\ndepth_file = \"gone.exr\"\n[waves]\nmodel = \"trochoid\"\ncoast = true\n");
    EXPECT_NE(gone.find("sea.depth_file = \"gone.exr\": is no file"), std::string::npos) << gone;
    const std::string wrong =
        refused("[sea]\ndepth_file = \"beach.toml\"\n[waves]\nmodel = \"trochoid\"\ncoast = true\n");
    EXPECT_NE(wrong.find("is neither \"none\" nor a picture"), std::string::npos) << wrong;
}

// 8 m deep in the west, and land in the east.
TEST(Shot, ACoastMayBeAMesh) {
    const TemporaryFolder temporary;
    const std::filesystem::path folder = temporary.path();
    std::ofstream(folder / "floor.obj") << "v -50 -40 -8\nv 50 -40 2\nv 50 40 2\nv -50 40 -8\nf 1 2 3 4\n";
    const std::string text =
        "[sea]\ndepth_m = 8\ndepth_file = \"floor.obj\"\n[waves]\nmodel = \"trochoid\"\ncoast = true\n";
    const Scene scene = parse_shot(text, folder / "shot.toml", no_check);
    ASSERT_TRUE(scene.waves.coast_depths);
    const DepthMap& depths = *scene.waves.coast_depths;
    EXPECT_EQ(depths.from_m(), glm::dvec2(-50.0, -40.0));
    EXPECT_EQ(depths.size_m(), glm::dvec2(100.0, 80.0));
    EXPECT_NEAR(depths.mean_m({-30.0, 0.0}, {-30.0, 0.0}), 6.0, 0.01);
    EXPECT_NEAR(depths.mean_m({40.0, 0.0}, {40.0, 0.0}), -1.0, 0.01);
    std::ofstream(folder / "floor.obj") << "v 0 0 0\nf 1 1 1\n";
    try {
        parse_shot(text, folder / "shot.toml", no_check);
        FAIL();
    } catch (const ShotError& error) {
        EXPECT_NE(std::string(error.what()).find("floor.obj\": is no floor: "), std::string::npos)
            << error.what();
    }
}

TEST(Shot, AnEmptyFileIsTheDefaults) {
    for (const char* text : {"", "\n", "# nothing\n", "\xef\xbb\xbf", "[shot]\n[sea]\n[output]\n"}) {
        EXPECT_EQ(canonical(parse(text)), canonical(Scene{}));
        EXPECT_EQ(parse(text).shot.last_frame, 48);
    }
}

// The defaults of the documentation, written out.
TEST(Shot, TheDocumentedDefaultsAreTheDefaults) {
    const char* text = R"([shot]
name = "sea"
frames = [1, 48]
fps = 24
seed = 1
loop_s = 0.0
[sea]
wind_speed_mps = 10.0
wind_direction_deg = 0.0
fetch_m = 300e3
depth_m = inf
spectrum = "jonswap"
spreading = "hasselmann"
swell = []
[waves]
model = "fft"
choppiness = 1.0
cascades = "auto"
[surface]
kind = "patch"
size_m = 200.0
resolution = 256
[camera]
position_m = [0.0, -60.0, 4.0]
look_at_m = [0.0, 0.0, 0.0]
keys = []
fov_deg = 50.0
resolution = [1280, 720]
[light]
sun_elevation_deg = 20.0
sun_azimuth_deg = 90.0
sky = "daylight"
turbidity = 2.0
[water]
type = "ocean"
chlorophyll_mg_m3 = 0.1
[effects]
whitecaps = true
spray = false
[quality]
level = "final"
[output]
mesh = "usdc"
attributes = ["normal", "velocity", "slope-variance", "whitecaps"]
maps = []
map_resolution = 512
cascade_tiles = false
mesh_scheme = "none"
volumes = []
voxel_m = 0.5
)";
    EXPECT_EQ(canonical(parse(text)), canonical(Scene{}));
}

TEST(Shot, EveryKeyReachesItsMember) {
    const Scene s = parse(R"([shot]
name = "A-1"
frames = [-3, 7]
fps = 25
seed = 9223372036854775807
loop_s = 2
[sea]
wind_speed_mps = 14
wind_direction_deg = -30.5
fetch_m = 1e5
depth_m = 20
spectrum = "file"
spectrum_file = "made-99001w2021.txt"
spectrum_time = 2021-03-01T02:50:00+02:00
spreading = "donelan-banner"
swell = [ { height_m = 1.5, period_s = 11.0, direction_deg = 80 } ]
[waves]
model = "fft"
choppiness = 0.5
cascades = [ { size_m = 5.5, resolution = 128 }, { size_m = 40, resolution = 256 } ]
[surface]
size_m = 100
resolution = 64
[camera]
position_m = [1, 2.5, 3]
look_at_m = [4, 5, 6]
fov_deg = 35
resolution = [640, 360]
[[camera.keys]]
frame = 1
position_m = [7, 8, 9]
look_at_m = [10, 11, 12]
[[camera.keys]]
frame = 5
position_m = [7, 8, 10]
look_at_m = [10, 11, 13]
[light]
sun_elevation_deg = -5
sun_azimuth_deg = 180
[effects]
whitecaps = false
[quality]
level = "draft"
[output]
mesh = "none"
attributes = ["velocity"]
maps = ["slope-variance", "displacement"]
map_resolution = 32
cascade_tiles = true
)");
    EXPECT_EQ(s.shot.name, "A-1");
    EXPECT_EQ(s.shot.first_frame, -3);
    EXPECT_EQ(s.shot.last_frame, 7);
    EXPECT_EQ(s.shot.fps, 25.0);
    EXPECT_EQ(s.shot.seed, 9223372036854775807u);
    EXPECT_EQ(s.shot.loop_s, 2.0);
    EXPECT_EQ(s.sea.wind_speed_mps, 14.0);
    EXPECT_EQ(s.sea.wind_direction_deg, -30.5);
    EXPECT_EQ(s.sea.fetch_m, 1e5);
    EXPECT_EQ(s.sea.depth_m, 20.0);
    EXPECT_EQ(s.sea.spectrum, SpectrumKind::File);
    ASSERT_TRUE(s.sea.measured);
    EXPECT_EQ(s.sea.measured->time, "2021-03-01T00:50:00Z");  // the zone is taken off
    EXPECT_EQ(s.sea.measured->bins.size(), 4u);
    EXPECT_EQ(s.sea.spreading, SpreadingKind::DonelanBanner);
    ASSERT_EQ(s.sea.swell.size(), 1u);
    EXPECT_EQ(s.sea.swell[0].height_m, 1.5);
    EXPECT_EQ(s.sea.swell[0].period_s, 11.0);
    EXPECT_EQ(s.sea.swell[0].direction_deg, 80.0);
    EXPECT_EQ(s.waves.choppiness, 0.5);
    ASSERT_EQ(s.waves.cascades.size(), 2u);  // the largest first, whatever the file's order
    EXPECT_EQ(s.waves.cascades[0].size_m, 40.0);
    EXPECT_EQ(s.waves.cascades[0].resolution, 256);
    EXPECT_EQ(s.waves.cascades[1].size_m, 5.5);
    EXPECT_EQ(s.surface.size_m, 100.0);
    EXPECT_EQ(s.surface.resolution, 64);
    EXPECT_EQ(s.camera.position_m, glm::dvec3(1.0, 2.5, 3.0));
    EXPECT_EQ(s.camera.look_at_m, glm::dvec3(4.0, 5.0, 6.0));
    EXPECT_EQ(s.camera.fov_deg, 35.0);
    EXPECT_EQ(s.camera.resolution, glm::ivec2(640, 360));
    ASSERT_EQ(s.camera.keys.size(), 2u);
    EXPECT_EQ(s.camera.keys[1].frame, 5);
    EXPECT_EQ(s.camera.keys[1].position_m, glm::dvec3(7.0, 8.0, 10.0));
    EXPECT_EQ(s.camera.keys[1].look_at_m, glm::dvec3(10.0, 11.0, 13.0));
    EXPECT_EQ(s.light.sun_elevation_deg, -5.0);
    EXPECT_EQ(s.light.sun_azimuth_deg, 180.0);
    EXPECT_FALSE(s.effects.whitecaps);
    EXPECT_EQ(s.quality.level, QualityLevel::Draft);
    EXPECT_EQ(s.output.mesh, MeshFormat::None);
    EXPECT_EQ(s.output.attributes, std::vector{MeshAttribute::Velocity});
    EXPECT_EQ(s.output.maps, (std::vector{MapKind::SlopeVariance, MapKind::Displacement}));
    EXPECT_EQ(s.output.map_resolution, 32);
    EXPECT_TRUE(s.output.cascade_tiles);
}

TEST(Shot, APresetIsWhatAllElseLiesOn) {
    for (const Preset& preset : presets()) {
        Scene named;
        apply(preset, named);
        const std::string first = "preset = \"" + preset.name + "\"\n";
        EXPECT_EQ(canonical(parse(first)), canonical(named)) << preset.name;
        named.sea.wind_direction_deg = 77.0;
        named.waves.choppiness = 0.3;
        EXPECT_EQ(canonical(parse(first + "[sea]\nwind_direction_deg = 77\n[waves]\nchoppiness = 0.3\n")),
                  canonical(named))
            << preset.name;
    }
    expect_refused("preset = \"beaufort-13\"\n",
                   "1:10: preset = \"beaufort-13\": is no preset, the nearest is \"beaufort-1",
                   "pelagic presets");
    expect_refused("preset = 7\n", "1:10: preset = 7: is an integer", "the name of a preset");
    expect_refused("[preset]\n", "1:1: preset = { }: is a table", "the name of a preset");
}

TEST(Shot, UnknownKeysNameTheNearest) {
    expect_refused("[sea]\nwind_sped_mps = 3\n",
                   "2:1: sea.wind_sped_mps = 3: is an unknown key, the nearest is sea.wind_speed_mps",
                   "in sea the keys wind_speed_mps, wind_direction_deg");
    expect_refused("[see]\n", "1:2: see = { }: is an unknown table, the nearest is sea",
                   "preset, preset_parts and the tables shot, sea,");
    expect_refused("fps = 24\n", "1:1: fps = 24: is an unknown key, the nearest is shot.fps",
                   "preset, preset_parts and the tables shot");
    expect_refused("[waves]\n\n  fps = 24\n",
                   "3:3: waves.fps = 24: is an unknown key, the nearest is shot.fps",
                   "in waves the keys model");
    expect_refused("[sea]\nqqq = 24\n", "2:1: sea.qqq = 24: is an unknown key;", "in sea the keys");
    expect_refused(
        "[waves]\ncascades = [ { size_m = 10, resolution = 64, sise_m = 1 } ]\n",
        "2:46: waves.cascades[0].sise_m = 1: is an unknown key, the nearest is waves.cascades[0].size_m",
        "size_m, resolution");
}

TEST(Shot, WrongTypes) {
    expect_refused("[sea]\nwind_speed_mps = \"strong\"\n",
                   "2:18: sea.wind_speed_mps = \"strong\": is a string", "a number, 0 … 80");
    expect_refused("[surface]\nresolution = 256.0\n",
                   "2:14: surface.resolution = 256: is a number with a point", "an integer, 1 … 8192");
    expect_refused("[shot]\nname = 5\n", "2:8: shot.name = 5: is an integer", "a string, of letters");
    expect_refused("[shot]\nframes = 5\n", "2:10: shot.frames = 5: is an integer", "[first, last]");
    expect_refused("[shot]\nframes = [1]\n", "2:10: shot.frames = [1]: is a list of 1", "[first, last]");
    expect_refused("[shot]\nframes = [1, 4.0]\n", "2:14: shot.frames[1] = 4: is a number with a point",
                   "two integers");
    expect_refused("[shot]\nframes = [1, 9999999999]\n", "2:14: shot.frames[1] = 9999999999: is outside",
                   "-1e8 … 1e8");
    expect_refused("[shot]\nseed = -1\n", "2:8: shot.seed = -1: is outside the range",
                   "0 … 9223372036854775807");
    expect_refused("[effects]\nwhitecaps = 1\n", "2:13: effects.whitecaps = 1: is an integer",
                   "true or false");
    expect_refused("[camera]\nposition_m = [0, \"a\", 1]\n",
                   "2:18: camera.position_m[1] = \"a\": is a string", "three numbers");
    expect_refused("[sea]\nswell = 3\n", "2:9: sea.swell = 3: is an integer",
                   "a list of { height_m, period_s, direction_deg }");
    expect_refused("[sea]\nswell = [3]\n", "2:10: sea.swell[0] = 3: is an integer", "{ height_m,");
    expect_refused("[output]\nmaps = \"normal\"\n", "2:8: output.maps = \"normal\": is a string",
                   "a list of");
    expect_refused("[output]\nmaps = [1]\n", "2:9: output.maps[0] = 1: is an integer", "\"displacement\"");
    expect_refused("sea = 3\n", "1:7: sea = 3: is an integer", "a table, [sea], of wind_speed_mps");
    expect_refused("[[sea]]\n", "1:1: sea = [{ }]: is a list", "a table, [sea]");
    expect_refused("[waves]\ncascades = \"automatic\"\n", "2:12: waves.cascades = \"automatic\": is not",
                   "\"auto\"");
    expect_refused("[waves]\ncascades = []\n", "2:12: waves.cascades = []: is a sea without waves",
                   "at least one");
}

TEST(Shot, WrongWordsNameTheNearest) {
    expect_refused("[sea]\nspectrum = \"jonswop\"\n",
                   "2:12: sea.spectrum = \"jonswop\": is not one of the words, the nearest is \"jonswap\"",
                   "one of \"pierson-moskowitz\" \"jonswap\"");
    expect_refused(
        "[output]\nmaps = [\"normal\", \"white-caps\"]\n",
        "2:19: output.maps[1] = \"white-caps\": is not one of the words, the nearest is \"whitecaps\"",
        "one of \"displacement\"");
}

// Of impossible values: the place is the value's, however the table was written.
TEST(Shot, ImpossibleValues) {
    expect_refused("[sea]\nwind_speed_mps = -3.0\n", "2:18: sea.wind_speed_mps = -3: is outside the range",
                   "0 … 80");
    expect_refused("sea.wind_speed_mps = nan\n", "1:22: sea.wind_speed_mps = nan: is not a number", "0 … 80");
    expect_refused("sea = { fetch_m = inf }\n", "1:19: sea.fetch_m = inf: is outside the range", "1 … 1e8");
    expect_refused("[surface]\nresolution = 0\n", "2:14: surface.resolution = 0: is outside", "1 … 8192");
    expect_refused("[surface]\nresolution = 1000000000\n",
                   "2:14: surface.resolution = 1000000000: is outside", "1 … 8192");
    expect_refused("[surface]\nresolution = 1e9\n",
                   "2:14: surface.resolution = 1e9: is a number with a point", "an integer, 1 … 8192");
    expect_refused("[shot]\nframes = [48, 1]\n", "2:10: shot.frames = [48, 1]: runs backwards",
                   "first ≤ last");
    expect_refused("[shot]\nname = \"a/b\"\n", "2:8: shot.name = \"a/b\": is no file name",
                   "letters, digits, _ and -");
    expect_refused("[shot]\nloop_s = 0.99\n", "2:10: shot.loop_s = 0.99: is 23.76 frames",
                   "a whole number of frames");
    expect_refused("[camera]\nposition_m = [1, 2, 3]\nlook_at_m = [1, 2, 3]\n",
                   "3:13: camera.look_at_m = [1, 2, 3]: is where the camera itself is",
                   "away from the camera");
    // The value at fault is a default: the place is its table's.
    expect_refused("\n[camera]\nposition_m = [0, 0, 0]\n",
                   "2:1: camera.look_at_m = [0, 0, 0] (the default): is where the camera itself is",
                   "away from the camera");
    expect_refused("[[camera.keys]]\nframe = 1\nposition_m = [0, 0, 0]\nlook_at_m = [0, 0, 0]\n",
                   "4:13: camera.keys[0].look_at_m = [0, 0, 0]: is where the camera itself is", "away");
    expect_refused("[sea]\nswell = [ { height_m = 1, period_s = 0, direction_deg = 0 } ]\n",
                   "2:38: sea.swell[0].period_s = 0: is outside the range", "0.1 … 100");
    expect_refused("[sea]\nswell = [ { height_m = 1, period_s = 5 } ]\n",
                   "2:11: sea.swell[0].direction_deg = (missing): has no default", "a number");
}

// Cascades may come in any order; the message counts as the file does.
TEST(Shot, CascadesWithAGap) {
    expect_refused(
        "[waves]\ncascades = [ { size_m = 50, resolution = 64 }, { size_m = 400, resolution = 128 } ]\n",
        "2:77: waves.cascades[1].resolution = 128: leaves a gap", "at least 132");
}

TEST(Shot, Trains) {
    const Scene all =
        parse("[waves]\nmodel = \"trochoid\"\ntrains = 12\nshortest_m = 0.02\nlongest_m = 30\n");
    EXPECT_EQ(all.waves.model, WaveModel::Trochoid);
    EXPECT_EQ(all.waves.trains, 12);
    EXPECT_EQ(all.waves.shortest_m, 0.02);
    EXPECT_EQ(all.waves.longest_m, 30.0);
    EXPECT_TRUE(all.waves.cascades.empty());
    const Scene none = parse("[waves]\nmodel = \"trochoid\"\n");
    EXPECT_EQ(none.waves.trains, 250);
    EXPECT_FALSE(none.waves.shortest_m || none.waves.longest_m);
    expect_refused("[waves]\nmodel = \"trochoid\"\ntrains = 1.5\n", "3:10: waves.trains = 1.5: is a",
                   "an integer, 1 … 10000");
    expect_refused("[waves]\nmodel = \"trochoid\"\nlongest_m = \"30\"\n",
                   "3:13: waves.longest_m = \"30\": is a", "a number, 0.001 … 1000000");
    expect_refused("[waves]\nmodel = \"trochoid\"\nshortest_m = 0\n",
                   "3:14: waves.shortest_m = 0: is outside the range", "0.001 … 1000000");
    expect_refused("[waves]\nmodel = \"trochoid\"\nshortest_m = 3\nlongest_m = 2\n",
                   "3:14: waves.shortest_m = 3: is not shorter than longest_m, 2", "below the longest");
    expect_refused("[waves]\nlongest_m = 30\n", "2:13: waves.longest_m = 30: speaks of wave trains",
                   "model = \"trochoid\"");
    expect_refused("[waves]\nmodel = \"trochoid\"\n[output]\nmaps = [\"normal\"]\ncascade_tiles = true\n",
                   "5:17: output.cascade_tiles = true: asks for the tiles of cascades", "waves.cascades");
}

TEST(Shot, APictureOfASkyIsFoundBesideTheShot) {
    const TemporaryFolder temporary;
    const std::filesystem::path folder = temporary.path();
    temporary.write("noon.exr", "only its place matters here");
    const Scene scene = parse_shot("[light]\nsky = \"noon.exr\"\n", folder / "shot.toml", no_check);
    EXPECT_EQ(std::filesystem::path(scene.light.sky), folder / "noon.exr");
    EXPECT_EQ(parse_shot("[light]\nsky = \"daylight\"\n", folder / "shot.toml", no_check).light.sky,
              "daylight");
    try {
        parse_shot("[light]\nsky = \"dusk.exr\"\n", folder / "shot.toml", no_check);
        FAIL() << "a missing picture was accepted";
    } catch (const ShotError& error) {
        EXPECT_NE(std::string(error.what()).find(":2:7: light.sky = \"dusk.exr\": is no file in"),
                  std::string::npos)
            << error.what();
    }
}

TEST(Shot, WhatIsWrongInAPictureIsToldWithItsPlace) {
    const TemporaryFolder temporary;
    temporary.write("noon.exr", "only its place matters here");
    const std::filesystem::path file = temporary.path() / "shot.toml";
    const auto check = [](const Scene& scene) {
        return std::vector{Problem{"light.sky", quoted_text(scene.light.sky), "is no sky", "a sky"}};
    };
    const auto refused_with = [&](const std::string& text) -> std::string {
        try {
            parse_shot(text, file, check);
        } catch (const ShotError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refused_with("[light]\nturbidity = 3\nsky = \"noon.exr\"\n"),
              file.string() + ":3:7: light.sky = " + quoted_text((temporary.path() / "noon.exr").string()) +
                  ": is no sky; accepted: a sky");
    // A path ends at its first NUL for the system: what is looked at would be another file.
    EXPECT_NE(refused_with("[light]\nsky = \"noon.exr\\u0000.exr\"\n").find("is no file in"),
              std::string::npos);
    EXPECT_EQ(lines(refused_with("[light]\nsky = \"dusk.exr\"\n")), 1u);
}

TEST(Shot, ACageIsReadFromItsFile) {
    const TemporaryFolder folder;
    folder.write("pool.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
    const std::filesystem::path file = folder.path() / "s.toml";
    const auto refused_with = [&](const std::string& text) -> std::string {
        try {
            parse_shot(text, file, no_check);
        } catch (const ShotError& error) {
            return error.what();
        }
        return "";
    };
    const std::string cage = "[surface]\nkind = \"cage\"\n";
    const Scene scene =
        parse_shot(cage + "cage_file = \"pool.obj\"\ncage_level = \"adaptive\"\n", file, no_check);
    EXPECT_EQ(scene.surface.cage->mesh().face_counts.size(), 1u);
    EXPECT_TRUE(scene.surface.cage_level.is_adaptive);
    EXPECT_EQ(scene.surface.cage_file, (folder.path() / "pool.obj").string());
    EXPECT_EQ(canonical(parse_shot(shot_text(scene), "elsewhere.toml", no_check)), canonical(scene));
    const std::string at = file.string();
    EXPECT_EQ(
        refused_with(cage + "cage_file = \"bad.obj\"\n"),
        at +
            ":3:13: surface.cage_file = \"bad.obj\": bad.obj:3: the point 3 is outside the range; accepted: 1 … 2 or "
            "-1 … -2: so many stand above");
    EXPECT_EQ(
        refused_with(cage + "cage_file = \"none.obj\"\n"),
        at +
            ":3:13: surface.cage_file = \"none.obj\": the cage does not exist; accepted: a Wavefront OBJ of at most 256 "
            "MiB");
    EXPECT_EQ(
        refused_with(cage),
        at +
            ":2:8: surface.kind = \"cage\": comes without cage_file; accepted: \"cage\" together with cage_file");
    EXPECT_EQ(
        refused_with("[surface]\ncage_file = \"pool.obj\"\n"),
        at +
            ":2:13: surface.cage_file = \"pool.obj\": is given, but kind is \"patch\"; accepted: this key together "
            "with kind = \"cage\"");
    EXPECT_EQ(
        refused_with(cage + "cage_file = \"pool.obj\"\ncage_level = \"fine\"\n"),
        at +
            ":4:14: surface.cage_level = \"fine\": is not the word \"adaptive\"; accepted: an integer, 0 … 6, or "
            "\"adaptive\"");
    EXPECT_EQ(lines(refused_with(cage + "cage_file = 3\n")), 1u);
}

// Pictures lie beside the mesh, as materials do: PNG, whose numbers are sRGB, and linear OpenEXR.
TEST(Shot, BodiesHaveThePicturesBesideThem) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "s.toml";
    folder.write(
        "boat.obj",
        "mtllib paint.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n");
    const auto body_of = [&](const std::string& picture) {
        folder.write("paint.mtl", "newmtl red\nmap_Kd " + picture + "\n");
        return parse_shot("[[objects]]\nfile = \"boat.obj\"\n", file, no_check).objects[0].mesh;
    };
    const auto refused_with = [&](const std::string& picture) -> std::string {
        try {
            body_of(picture);
        } catch (const ShotError& error) {
            return error.what();
        }
        return "";
    };
    // The upper row red, the lower one grey: 188 of sRGB is 0.503 of linear light.
    const std::vector<std::uint8_t> bytes{255, 0, 0, 188, 188, 188};
    const std::string png = png::encode({.width = 1, .height = 2, .bytes = bytes});
    folder.write("paint.png", png);
    const auto body = body_of("paint.png");
    const ObjectImage& image = *body->data().images.at(0);
    EXPECT_EQ(image.colour({0.5f, 0.75f}, 0.0f), glm::vec3(1.0f, 0.0f, 0.0f));
    EXPECT_NEAR(image.colour({0.5f, 0.25f}, 0.0f).y, 0.50289, 2.5e-4);  // a half float's rounding
    std::vector<float> linear{0.25f, 0.75f};
    exr::Image of{.width = 1, .height = 2, .channels = {}};
    for (const char* name : {"R", "G", "B"}) of.channels.push_back({.name = name, .data = linear.data()});
    std::string exr = exr::encode_scanline({}, of);
    std::filesystem::create_directory(folder.path() / "in");
    folder.write("in/paint.exr", exr);
    const auto other = body_of("in/paint.exr");
    EXPECT_EQ(other->data().images.at(0)->colour({0.5f, 0.25f}, 0.0f), glm::vec3(0.25f));
    EXPECT_EQ(other->data().images.at(0)->colour({0.5f, 0.75f}, 0.0f), glm::vec3(0.75f));
    // By what is in the picture.
    EXPECT_NE(body->content(), other->content());
    linear = {0.25f, 7.0f};  // as bright as white
    exr = exr::encode_scanline({}, of);
    folder.write("in/paint.exr", exr);
    const auto bright = body_of("in/paint.exr");
    EXPECT_NE(bright->content(), other->content());
    EXPECT_EQ(bright->data().images.at(0)->colour({0.5f, 0.75f}, 0.0f), glm::vec3(1.0f));
    // What is wrong, with file and line.
    const std::string at = file.string() + ":2:8: objects[0].file = \"boat.obj\": paint.mtl:2: the picture ";
    folder.write("paint.jpg", "any");
    EXPECT_EQ(refused_with("paint.jpg"),
              at + "\"paint.jpg\" is a JPEG; accepted: a PNG or an OpenEXR: convert it");
    EXPECT_EQ(refused_with("paint.tga"),
              at + "\"paint.tga\" is neither PNG nor OpenEXR; accepted: a PNG or an OpenEXR: convert it");
    EXPECT_EQ(refused_with("none.png"), at + "\"none.png\" does not exist; accepted: a PNG or an OpenEXR");
    for (const std::string& away : {std::string("in/../paint.png"), (folder.path() / "paint.png").string()})
        EXPECT_NE(refused_with(away).find("lies outside the mesh's folder"), std::string::npos)
            << refused_with(away);
    folder.write("bad.png", png.substr(0, png.size() - 20));
    EXPECT_NE(refused_with("bad.png").find("\"bad.png\" is cut short or damaged"), std::string::npos);
    folder.write("bad.png", "any");
    EXPECT_NE(refused_with("bad.png").find("\"bad.png\" is no PNG"), std::string::npos);
    folder.write("bad.exr", "any");
    EXPECT_NE(refused_with("bad.exr").find("paint.mtl:2: the picture \"bad.exr\""), std::string::npos);
    const float seven = 7.0f, nan = std::nanf("");
    std::string number(sizeof seven, 0);
    std::memcpy(number.data(), &seven, sizeof seven);
    for (std::size_t place; (place = exr.find(number)) != std::string::npos;)
        std::memcpy(exr.data() + place, &nan, sizeof nan);
    folder.write("nan.exr", exr);
    EXPECT_EQ(refused_with("nan.exr"), at + "\"nan.exr\" has NaN in line 1; accepted: numbers");
    const std::vector<std::uint8_t> wide(std::size_t{3} * 20000);
    folder.write("wide.png", png::encode({.width = 20000, .height = 1, .bytes = wide}));
    EXPECT_NE(
        refused_with("wide.png")
            .find("\"wide.png\" has 20000 x 1 texels; accepted: pictures of at most 16384 texels a side"),
        std::string::npos);
    // A header that promises more than there is room for takes no memory.
    std::string huge = png;
    huge.replace(16, 8, std::string("\0\0\xff\xff\0\0\xff\xff", 8));
    folder.write("huge.png", huge);
    EXPECT_NE(refused_with("huge.png"), "");
}

TEST(Shot, BodiesAreReadFromTheirFiles) {
    const TemporaryFolder folder;
    const std::string triangle = "mtllib paint.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
    folder.write("boat.obj", triangle);
    folder.write("paint.mtl", "newmtl red\nKd 0.5 0 0\n");
    folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
    folder.write("plain.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    const std::filesystem::path file = folder.path() / "s.toml";
    const auto refused_with = [&](const std::string& text) -> std::string {
        try {
            parse_shot(text, file, no_check);
        } catch (const ShotError& error) {
            return error.what();
        }
        return "";
    };
    const Scene scene = parse_shot(
        "[[objects]]\nfile = \"boat.obj\"\npath = \"1 0 0, 48 20 5\"\n[[objects]]\nname = \"second\"\nfile = "
        "\"boat.obj\"\nfloats = true\ncolour = [1, 0.5, 0]\n[[objects]]\nfile = \"plain.obj\"\n",
        file, no_check);
    ASSERT_EQ(scene.objects.size(), 3u);
    EXPECT_EQ(scene.objects[0].mesh, scene.objects[1].mesh);
    EXPECT_EQ(scene.objects[0].mesh->data().materials[0].colour, glm::vec3(0.5f, 0.0f, 0.0f));
    EXPECT_EQ(scene.objects[0].file, (folder.path() / "boat.obj").string());
    // Materials lie beside it, or below: a mesh from elsewhere reads no other file.
    std::filesystem::create_directory(folder.path() / "in");
    folder.write("in/paint.mtl", "newmtl red\nKd 0.25 0 0\n");
    const auto red_of = [&](const std::string& library) {
        folder.write("other.obj", "mtllib " + library + "\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
        return parse_shot("[[objects]]\nfile = \"other.obj\"\n", file, no_check)
            .objects[0]
            .mesh->data()
            .materials[0]
            .colour.x;
    };
    EXPECT_EQ(red_of("in/paint.mtl"), 0.25f);
    EXPECT_EQ(red_of("./paint.mtl"), 0.5f);
    EXPECT_EQ(red_of("in/../paint.mtl"), 0.8f);  // grey
    EXPECT_EQ(red_of((folder.path() / "paint.mtl").string()), 0.8f);
    EXPECT_EQ(scene.objects[0].called(), "boat");
    EXPECT_TRUE(scene.objects[1].floats);
    EXPECT_EQ(scene.objects[1].colour, glm::dvec3(1.0, 0.5, 0.0));
    const Scene again = parse_shot(shot_text(scene), "elsewhere.toml", no_check);
    EXPECT_EQ(canonical(again), canonical(scene));
    EXPECT_EQ(shot_text(again), shot_text(scene));
    // As a list, too; and by what is in the file.
    folder.write("boat.obj", "# another comment\n" + triangle);
    EXPECT_EQ(canonical(parse_shot("objects = [{ file = \"boat.obj\" }]", file, no_check)),
              canonical(parse_shot("[[objects]]\nfile = \"./boat.obj\"", file, no_check)));
    const std::string at = file.string();
    EXPECT_EQ(
        refused_with("[[objects]]\nup_m = 1\n"),
        at +
            ":1:1: objects[0].file = (missing): has no default; accepted: a string, the path of an .obj or a .usdc; " +
            find_key("objects[].file")->help);
    EXPECT_EQ(
        refused_with("[[objects]]\nfile = \"bad.obj\"\n"),
        at +
            ":2:8: objects[0].file = \"bad.obj\": bad.obj:3: the point 3 is outside the range; accepted: 1 … 2 or "
            "-1 … -2: so many stand above");
    EXPECT_EQ(
        refused_with("[[objects]]\nfile = \"none.obj\"\n"),
        at +
            ":2:8: objects[0].file = \"none.obj\": the mesh does not exist; accepted: a Wavefront OBJ or a USD crate of at most 1 GiB");
    EXPECT_EQ(
        refused_with("[[objects]]\nfile = \"boat.stl\"\n"),
        at +
            ":2:8: objects[0].file = \"boat.stl\": is neither Wavefront OBJ nor USD; accepted: a mesh exported as .obj, z "
            "up and in metres, or as .usdc");
    EXPECT_EQ(
        refused_with("[[objects]]\nfile = \"boat.obj\"\n\n[[objects]]\nfile = \"boat.obj\"\n"),
        at +
            ":4:1: objects[1].name = \"boat\" (the default): is what objects[0] is called: without a name it is its "
            "file's; accepted: a name of its own for each of them");
    EXPECT_EQ(
        refused_with("[[objects]]\nfile = \"boat.obj\"\npath = \"1 0 0, 1 5 5\"\n"),
        at +
            ":3:8: objects[0].path = key 2, 1 5 5: does not come after the key before, of frame 1; accepted: rising "
            "frames, each once");
    EXPECT_NE(refused_with("[[objects]]\nfile = \"boat.obj\"\nheight = 3\n")
                  .find(":3:1: objects[0].height = 3: is an unknown key"),
              std::string::npos);
    EXPECT_EQ(lines(refused_with("[objects]\nfile = \"boat.obj\"\n")), 1u);
    EXPECT_EQ(lines(refused_with("[[objects]]\nfile = 3\n")), 1u);
}

// A grey picture, or one of colours, from its rows from the bottom.
std::string exr_of(int width, int height, const std::vector<float>& values, bool has_colours = false) {
    exr::Image image{.width = width, .height = height, .channels = {}};
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (!has_colours)
        image.channels = {{.name = "Y", .data = values.data()}};
    else
        for (const std::size_t channel : {0, 1, 2})
            image.channels.push_back(
                {.name = std::string(1, "RGB"[channel]), .data = values.data() + channel * pixels});
    return exr::encode_scanline({}, image);
}

TEST(Shot, AMasksPictureIsReadFromItsFile) {
    const TemporaryFolder folder;
    folder.write("lee.exr", exr_of(2, 3, {0.0f, 0.25f, 0.5f, 0.75f, 1.0f, 0.125f}));
    folder.write("colours.exr", exr_of(2, 2, {0, 1, 0, 1, 0, 1, 1, 1, 0, 1, 0.5f, 1}, true));
    const std::filesystem::path file = folder.path() / "s.toml";
    const auto text = [](const std::string& name) {
        return "[waves]\nmasks = [{ east_m = 1, north_m = 2, waves = 0.5, picture = \"" + name + "\" }]\n";
    };
    const Scene scene = parse_shot(text("lee.exr"), file, no_check);
    const std::string path = (folder.path() / "lee.exr").string();
    EXPECT_EQ(scene.waves.masks[0].picture, path);
    ASSERT_EQ(scene.waves.mask_pictures.size(), 1u);
    EXPECT_EQ(scene.waves.mask_pictures.at(path)->size(), glm::ivec2(2, 3));
    EXPECT_EQ(scene.waves.mask_pictures.at(path)->shares(),
              (std::vector<float>{1.0f, 0.125f, 0.5f, 0.75f, 0.0f, 0.25f}));
    const Scene again = parse_shot(shot_text(scene), "elsewhere.toml", no_check);
    EXPECT_EQ(canonical(again), canonical(scene));
    EXPECT_EQ(again.waves.mask_pictures.at(path),
              scene.waves.mask_pictures.at(path));  // it wasn't read again
    folder.write("lee.exr", exr_of(3, 2, {0.0f, 0.25f, 0.5f, 0.75f, 1.0f, 0.125f}));
    const Scene changed = parse_shot(text("lee.exr"), file, no_check);
    EXPECT_EQ(changed.waves.mask_pictures.at(path)->size(), glm::ivec2(3, 2));
    const Scene coloured = parse_shot(text("colours.exr"), file, no_check);
    EXPECT_EQ(coloured.waves.mask_pictures.begin()->second->shares(),
              (std::vector<float>{0.5f, 1.0f, 0.0f, 1.0f}));
}

TEST(Shot, AMasksPictureThatIsNoneIsRefused) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "s.toml";
    const auto refused_with = [&](const std::string& picture) -> std::string {
        try {
            parse_shot("[waves]\nmasks = [{ east_m = 1, north_m = 2, picture = " + picture + " }]\n", file,
                       no_check);
        } catch (const ShotError& error) {
            return error.what();
        }
        return "";
    };
    const std::string whole = exr_of(64, 64, std::vector<float>(4096, 0.5f));
    folder.write("small.exr", exr_of(1, 1, {1.0f}));
    folder.write("wide.exr", exr_of(4097, 2, std::vector<float>(8194, 1.0f)));
    folder.write("wider.exr", exr_of(65536, 2, std::vector<float>(131072, 1.0f)));
    // Our own writer writes none.
    std::string with_nan = exr_of(2, 2, {0.0f, 0.3f, 1.0f, 1.0f});
    const auto bytes_of = [](float value) {
        return std::string(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const std::size_t at = with_nan.find(bytes_of(0.3f));
    ASSERT_NE(at, std::string::npos);
    folder.write("nan.exr", with_nan.replace(at, sizeof(float), bytes_of(std::nanf(""))));
    folder.write("bright.exr", exr_of(2, 2, {0.0f, 1.5f, 1.0f, 1.0f}));
    folder.write("cut.exr", whole.substr(0, whole.size() / 2));
    folder.write("text.exr", "not a picture");
    const std::string place = file.string() + ":2:47: waves.masks[0].picture = ";
    const std::string accepted = "a picture of 2 … 4096 pixels a side, with values of 0 … 1";
    for (const auto& [name, problem] :
         {std::pair{"small.exr", "has 1 x 1 pixels; accepted: " + accepted},
          std::pair{"wide.exr", "has 4097 x 2 pixels; accepted: " + accepted},
          std::pair{"nan.exr", "has a value of nan in its row 2, column 2; accepted: " + accepted},
          std::pair{"bright.exr", "has a value of 1.5 in its row 2, column 2; accepted: " + accepted}})
        EXPECT_EQ(refused_with(quoted_text(name)), place + quoted_text(name) + ": " + problem);
    for (const char* name : {"wider.exr", "cut.exr", "text.exr", "gone.exr", "", ".", "a\\u0000b"}) {
        const std::string message = refused_with('"' + std::string(name) + '"');
        EXPECT_EQ(lines(message), 1u) << message;
        EXPECT_NE(message.find("waves.masks[0].picture = "), std::string::npos) << message;
        EXPECT_NE(message.find("; accepted: "), std::string::npos) << message;
    }
    EXPECT_EQ(lines(refused_with("3")), 1u);
}

TEST(Shot, BudgetsAreInsteadOfALevel) {
    EXPECT_FALSE(Scene{}.quality.max_error || Scene{}.quality.frame_ms);
    const Scene scene = parse("[quality]\nmax_error = 0.02\n");
    EXPECT_EQ(scene.quality.max_error, 0.02);
    EXPECT_EQ(parse("[quality]\nframe_ms = 40\n").quality.frame_ms, 40.0);
    expect_refused("quality.max_error = 3\n", "1:21: quality.max_error = 3: is outside the range",
                   "1e-6 … 1");
    expect_refused("quality.frame_ms = 0\n", "1:20: quality.frame_ms = 0: is outside the range",
                   "0.01 … 1e7");
    expect_refused("[quality]\nmax_error = 0.1\nframe_ms = 9\n",
                   "3:12: quality.frame_ms = 9: is a second budget beside quality.max_error",
                   "one of the two");
}

TEST(Shot, AllProblemsInTheOrderOfTheFile) {
    const std::string text = refusal(
        "[surface]\nresolution = 0\n[sea]\nwind_speed_mps = -1\nfetch = 3\nspectrum = 1\n[shot]\nfps = 0\n");
    EXPECT_EQ(
        text,
        "s.toml:2:14: surface.resolution = 0: is outside the range; accepted: 1 … 8192\n"
        "s.toml:4:18: sea.wind_speed_mps = -1: is outside the range; accepted: 0 … 80\n"
        "s.toml:5:1: sea.fetch = 3: is an unknown key, the nearest is sea.fetch_m; accepted: in sea the keys "
        "wind_speed_mps, wind_direction_deg, fetch_m, depth_m, depth_file, depth_size_m, depth_east_m, "
        "depth_north_m, spectrum, growth, short_waves, significant_height_m, "
        "spreading, directionality, gust_strength, gust_size_m, gust_fronts, rain_mm_h, swell, spectrum_file, spectrum_time\n"
        "s.toml:6:12: sea.spectrum = 1: is an integer; accepted: one of \"pierson-moskowitz\" \"jonswap\" "
        "\"jonswap-1973\" \"tma\" \"elfouhaily\" \"omega-2\" \"phillips\" \"file\"\n"
        "s.toml:8:7: shot.fps = 0: is outside the range; accepted: 0.001 … 10000");
    // A list of which one entry can't be read isn't judged against that entry's defaults.
    const std::string cascades = refusal(
        "[waves]\ncascades = [ { size_m = \"a\", resolution = 64 }, { size_m = 10, resolution = 16 } ]\n");
    EXPECT_EQ(lines(cascades), 1u) << cascades;
    // But swells are judged alone.
    EXPECT_EQ(lines(refusal("sea.swell = [ 3, { height_m = -1, period_s = 1, direction_deg = 0 } ]\n")), 2u);
}

TEST(Shot, BrokenToml) {
    expect_refused("[sea]\nfetch_m = 1\nfetch_m = 2\n", "3:", "TOML");
    EXPECT_NE(refusal("[sea]\nfetch_m = 1\nfetch_m = 2\n").find("'fetch_m'"), std::string::npos);
    expect_refused("[sea]\n[sea]\n", "2:", "TOML");
    expect_refused("[sea\n", "1:", "TOML");
    expect_refused("[sea]\nspectrum = \"\xff\"\n", "2:", "UTF-8");
    expect_refused(std::string_view("[sea]\n\0", 7), "2:", "TOML");
    expect_refused("[shot]\nseed = 9223372036854775808\n", "2:", "TOML");
}

// Repeated text: parsers, and what walks through their trees, go as deep as a file does.
std::string times(std::size_t count, std::string_view part) {
    std::string out;
    for (std::size_t i = 0; i < count; ++i) out += part;
    return out;
}

TEST(Shot, DepthAndLengthAreBoundedBeforeParsing) {
    const char* parts = "the key has too many parts";
    const char* nested = "lists and tables are nested too deep";
    for (const std::size_t count : {std::size_t{17}, std::size_t{16000}, std::size_t{1000000}}) {
        expect_refused("[sea]\n" + times(count, "a.") + "a = 1\n", std::string("2:32: ") + parts,
                       "at most 16");
        expect_refused('[' + times(count, "a.") + "a]\n", std::string("1:33: ") + parts, "at most 16");
        expect_refused("[[" + times(count, "a . ") + "a]]\n", std::string("1:65: ") + parts, "at most 16");
        expect_refused(times(count, "\"ü\".") + "a = 1\n", std::string("1:64: ") + parts, "at most 16");
        expect_refused("a = { " + times(count, "a.") + "a = 1 }\n", std::string("1:38: ") + parts,
                       "at most 16");
        expect_refused("# [[[\n'[' = " + times(count, "["), std::string("2:23: ") + nested, "at most 16");
        expect_refused("a = " + times(count, "[\n"), std::string("17:1: ") + nested, "at most 16");
        expect_refused("a = " + times(count, "{a="), std::string("1:53: ") + nested, "at most 16");
        // Brackets in strings don't count, those behind them do.
        expect_refused(
            "a = [\"[[[\\\"[\", '[\\', '''[''[''', \"\"\"[\\\"\"\"[\"\"\"\"\", " + times(count, "[{"),
            "1:65: " + std::string(nested), "at most 16");
    }
    expect_refused("[sea]\nfetch_m = 1" + times(300, "0"), "2:11: a key or value without quotes is too long",
                   "at most 256 bytes");
    expect_refused("[sea]\n" + times(257, "k") + " = 1", "2:1: a key or value", "at most 256 bytes");
    for (const std::string quote : {"\"", "'", "\"\"\"", "'''"})
        expect_refused("[shot]\nname = " + quote + times(8000000, "x") + quote, "2:8: a string is too long",
                       "at most 65536 bytes");
    // What isn't a key, a list or a string has no bound but the file's.
    EXPECT_EQ(parse("# " + times(100000, "[a.") + "\n[shot]\nname = \"a\" # " + times(100000, "'")).shot.name,
              "a");
    EXPECT_EQ(parse(times(100000, "\n") + times(100000, "\t") + "shot.name = \"b\"").shot.name, "b");
}

TEST(Shot, ManyProblemsAreCountedAndTheFirstListed) {
    constexpr std::size_t kMany = 50000;
    const auto many = [](const auto& part) {
        std::string out;
        for (std::size_t i = 0; i < kMany; ++i) out += part(std::to_string(i));
        return out;
    };
    const auto expect_some = [](const std::string& text, const std::string& first) {
        const std::string report = refusal(text);
        EXPECT_TRUE(report.starts_with("s.toml:" + first)) << report.substr(0, 200);
        EXPECT_EQ(lines(report), 21u);
        EXPECT_LT(report.size(), std::size_t{64} << 10);
        return report.substr(report.rfind('\n') + 1);
    };
    // Names whose nearest key is dear to find; in the order of the file, whatever the order of their names.
    const auto key = [](const std::string& i) { return "wind_speed_" + i + " = 1\n"; };
    EXPECT_EQ(expect_some("[sea]\n" + many(key), "2:1: sea.wind_speed_0 = 1: is an unknown key"),
              "s.toml: and 49980 more problems");
    EXPECT_EQ(expect_some("[sea]\nz = 1\n" + many(key), "2:1: sea.z = 1: is an unknown key"),
              "s.toml: and 49981 more problems");
    expect_some(many([](const std::string& i) { return "[sea" + i + "]\n"; }),
                "1:2: sea0 = { }: is an unknown table");
    const auto entry = [](const std::string& i) { return "{frame=" + i + ",fov_deg=1e9},"; };
    expect_some("[camera]\nkeys = [" + many(entry) + ']', "2:9: camera.keys[0]");
    // Lists that are too long are one problem.
    for (const char* list : {"sea.swell = [", "output.maps = [", "waves.cascades = ["})
        EXPECT_EQ(lines(refusal(list + many([](const std::string&) { return "'normale',"; }) + ']')), 1u)
            << list;
}

TEST(Shot, MessagesAreShortAndMoveNoCursor) {
    const std::string folder_text = "[sea]\nspectrum = \"file\"\nspectrum_time = 2021-03-01T00:50:00Z\n";
    for (const std::string& value :
         {times(16000, "x"), std::string("\\u001b[2J\\u009b\\u202e\\u0000"), times(5000, "水")})
        for (const std::string& text :
             {"[shot]\nname = \"" + value + "\"\n", "[light]\nsky = \"" + value + ".exr\"\n",
              "[sea]\nspectrum = \"" + value + "\"\n", "preset = \"" + value + "\"\n",
              folder_text + "spectrum_file = \"" + value + "w2021.txt\"\n", '"' + value + "\" = 1\n",
              "[shot]\n\"" + value + "\" = { \"" + value + "\" = 1 }\n",
              "[sea]\nswell = [ { \"" + value + "\" = \"" + value + "\" } ]\n",
              "[\"" + value + "\"]\n[\"" + value + "\"]\n"}) {
            const std::string report = refusal(text);
            EXPECT_TRUE(report.starts_with("s.toml:")) << text.substr(0, 100);
            EXPECT_LT(report.size(), 4096u) << report.substr(0, 200);
            std::istringstream each(report);
            for (std::string line; std::getline(each, line);)
                EXPECT_EQ(line_text(line), line) << "something in it is no text";
        }
    // A shot's own name may be anything that a system takes.
    try {
        parse_shot("[sea]\nfetch_m = -1\n", "a\x1b[2J\n\xe9.toml", no_check);
        FAIL();
    } catch (const ShotError& error) {
        EXPECT_TRUE(
            std::string_view(error.what()).starts_with("a\\u001b[2J\\u000a\\xe9.toml:2:11: sea.fetch_m"))
            << error.what();
    }
}

TEST(Shot, LineEndingsAndByteOrderMark) {
    EXPECT_EQ(parse("\xef\xbb\xbf[shot]\r\nname = \"b\"\r\n").shot.name, "b");
    expect_refused("\xef\xbb\xbf[sea]\r\n# h\xc3\xb6he\r\nfetch_m = -1\r\n", "3:11: sea.fetch_m = -1: is",
                   "1 … 1e8");
}

TEST(Shot, AMeasuredSpectrum) {
    const auto in_folder = [](const std::string& text) -> std::string {
        try {
            parse(text);
        } catch (const ShotError& error) {
            return error.what();
        }
        return "";
    };
    const std::string start = "[sea]\nspectrum = \"file\"\n";
    const std::string file = "spectrum_file = \"made-99001w2021.txt\"\n";
    EXPECT_EQ(in_folder(start + file + "spectrum_time = 2021-03-01T00:50:00Z\n"), "");

    const std::string no_hour = in_folder(start + file + "spectrum_time = 2021-03-01T00:00:00Z\n");
    EXPECT_NE(no_hour.find("s.toml:4:17: sea.spectrum_time = 2021-03-01T00:00:00Z: "), std::string::npos)
        << no_hour;
    EXPECT_NE(no_hour.find("; accepted: one of its 3 times"), std::string::npos) << no_hour;
    EXPECT_EQ(lines(no_hour), 1u) << no_hour;
    const std::string no_file =
        in_folder(start + "spectrum_file = \"none-1w2021.txt\"\nspectrum_time = 2021-03-01T00:50:00Z\n");
    EXPECT_NE(no_file.find("s.toml:3:17: sea.spectrum_file = \"none-1w2021.txt\": "), std::string::npos)
        << no_file;
    EXPECT_NE(no_file.find("none-1w2021.txt does not exist; accepted: "), std::string::npos) << no_file;
    EXPECT_EQ(lines(no_file), 1u) << no_file;

    expect_refused(start, "2:12: sea.spectrum = \"file\": comes without spectrum_file and spectrum_time",
                   "together with spectrum_file and spectrum_time");
    expect_refused(start + file, "2:12: sea.spectrum = \"file\": comes without spectrum_time",
                   "together with");
    expect_refused(start + file + "spectrum_time = 2021-03-01T00:50:00\n",
                   "4:17: sea.spectrum_time = 2021-03-01T00:50:00: does not say its time zone",
                   "2019-02-06T00:40:00Z");
    expect_refused(start + file + "spectrum_time = \"2021-03-01T00:50:00Z\"\n",
                   "4:17: sea.spectrum_time = \"2021-03-01T00:50:00Z\": is a string",
                   "a date and time with its zone");
    expect_refused(start + file + "spectrum_time = 2021-03-01\n",
                   "4:17: sea.spectrum_time = 2021-03-01: is a date", "a date and time with its zone");
    expect_refused(start + file + "spectrum_time = 2021-03-01T00:50:00.5Z\n",
                   "4:17: sea.spectrum_time = ", "a date and time with its zone");
    expect_refused("[sea]\n" + file,
                   "2:17: sea.spectrum_file = \"made-99001w2021.txt\": is given, but spectrum is \"jonswap\"",
                   "together with spectrum = \"file\"");
    expect_refused("[sea]\nspectrum_time = 2021-03-01T00:50:00Z\n",
                   "2:17: sea.spectrum_time = 2021-03-01T00:50:00Z: is given, but spectrum is \"jonswap\"",
                   "together with spectrum = \"file\"");
}

TEST(Shot, FilesThatAreNone) {
    const TemporaryFolder folder;
    const auto message = [](const std::filesystem::path& file) -> std::string {
        try {
            load_shot(file, no_check);
        } catch (const ShotError& error) {
            return error.what();
        }
        return "";
    };
    const std::string missing = (folder.path() / "no.toml").string();
    EXPECT_EQ(message(missing),
              missing + ": the shot file does not exist; accepted: a TOML file of at most 16 MiB");
    EXPECT_EQ(message(folder.path()),
              folder.path().string() +
                  ": the shot file is a folder, not a file; accepted: a TOML file of at most 16 MiB");
    // 16 MiB of comment are read, one byte more is not.
    std::string comment(std::size_t{16} << 20, '#');
    EXPECT_EQ(message(folder.write("full.toml", comment)), "");
    EXPECT_NE(message(folder.write("huge.toml", comment + '#')).find("is longer than 16 MiB"),
              std::string::npos);
    const std::filesystem::path locked = folder.write("locked.toml", "");
    std::filesystem::permissions(locked, std::filesystem::perms::none);
    if (!std::ifstream(locked)) {  // root opens it all the same
        EXPECT_NE(message(locked).find("can't be opened: "), std::string::npos);
    }
    // A place in the file begins with its path, as given.
    const std::filesystem::path bad = folder.write("bad.toml", "[sea]\nfetch_m = 0\n");
    EXPECT_TRUE(message(bad).starts_with(bad.string() + ":2:11: sea.fetch_m = 0: "));
}

TEST(Shot, HelpNamesEveryKey) {
    const std::string help = describe_keys();
    for (const char* part :
         {"[shot]", "  shot.fps = 24\n", "[1/s]", "sea.swell[].period_s", "camera.keys[].frame",
          "waves.cascades = \"auto\"", "waves.trains = 250", "  waves.longest_m\n", "  quality.max_error\n",
          "0 … 80", "output.attributes = [\"normal\", \"velocity\", \"slope-variance\", \"whitecaps\"]"}) {
        EXPECT_NE(help.find(part), std::string::npos) << part;
    }
}

}  // namespace
}  // namespace pelagic
