// Cameras' paths as .chan text.
#include "plugin/format/shot/chan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "core/surface/view.h"
#include "plugin/format/shot/shot.h"
#include "temporary_folder.h"
#include "tests/plugin/format/shot/no_check.h"

namespace pelagic {
namespace {

constexpr glm::ivec2 kSize{200, 100};

View view_of(const std::string& line) {
    Camera camera;
    camera.keys = parse_chan(line, kSize);
    return view_at(camera, camera.keys.front().frame);
}

void expect_near(glm::dvec3 a, glm::dvec3 b) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-9) << "component " << i;
}

// The file's x, y, z are our x, z, −y.
TEST(Chan, AnglesTurnTheCamera) {
    const View still = view_of("1 2 3 4 0 0 0");
    expect_near(still.position_m, {2.0, -4.0, 3.0});
    expect_near(still.forward, {0.0, 1.0, 0.0});
    expect_near(still.up, {0.0, 0.0, 1.0});
    const double s = std::sqrt(0.5);
    expect_near(view_of("1 0 9 0 -45 0 0").forward, {0.0, s, -s});     // looks down
    expect_near(view_of("1 0 9 0 0 90 0").forward, {-1.0, 0.0, 0.0});  // to the left
    const View rolled = view_of("1 0 9 0 0 0 30");  // counter-clockwise: its right side goes up
    expect_near(rolled.forward, {0.0, 1.0, 0.0});
    expect_near(rolled.right, {std::cos(0.52359877559829887), 0.0, 0.5});
    // First about z, then x, then y: R = Ry Rx Rz.
    const View all = view_of("1 0 9 0 -45 90 90");
    expect_near(all.forward, {-s, 0.0, -s});
    expect_near(all.right, {-s, 0.0, s});
    expect_near(view_of("1 0 9 0 -90 0 0").forward, {0.0, 0.0, -1.0});
}

TEST(Chan, LensesAndRollsGoOn) {
    const auto keys =
        parse_chan("# from elsewhere\r\n\r\n  1\t0 9 0 0 0 179 20\r\n+3 0 9 0 0 0 181 20", kSize);
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys[1].frame, 3);
    EXPECT_NEAR(std::tan(*keys[0].fov_deg * 0.008726646259971648), 2.0 * std::tan(0.17453292519943295),
                1e-12);
    EXPECT_NEAR(std::abs(keys[1].roll_deg - keys[0].roll_deg), 2.0, 1e-9);
    EXPECT_FALSE(parse_chan("1 0 9 0 0 0 0\n", kSize).front().fov_deg);
}

TEST(Chan, WhatIsWrongIsToldWithItsLine) {
    const auto refused = [](const std::string& text) -> std::string {
        try {
            parse_chan(text, kSize);
        } catch (const ChanError& error) {
            EXPECT_FALSE(error.accepted().empty());
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refused("1 0 9 0 0 0 0\n\n2 0 9 0 0 0\n"), "line 3: has 6 numbers");
    EXPECT_EQ(refused("1 0 9 0 0 0 0 50 1\n"), "line 1: has more than 8 numbers");
    EXPECT_EQ(refused("1 0 9 0 0 x 0\n"), "line 1: \"x\" is no number");
    EXPECT_EQ(refused("1 0 9 0 0 nan 0\n"), "line 1: \"nan\" is no number");
    EXPECT_EQ(refused("1 0 9 0 0 0 0\n1 0 9 0 0 0 0\n"), "line 2: the frame 1 doesn't come after 1");
    EXPECT_EQ(refused("1.5 0 9 0 0 0 0\n"), "line 1: the frame 1.5 is none");
    EXPECT_EQ(refused("1 0 1e30 0 0 0 0\n"), "line 1: the position is outside the range");
    EXPECT_EQ(refused("1 0 9 0 0 0 1e30\n"), "line 1: an angle is outside the range");
    EXPECT_EQ(refused("1 0 9 0 0 0 0 180\n"),
              "line 1: the angle of view of 180 degrees is outside the range");
    EXPECT_EQ(refused("# nothing\n"), "has no frames");
}

TEST(Chan, AShotTakesItForItsKeys) {
    const TemporaryFolder folder;
    folder.write("way.chan", "1 0 9 0 0 0 0\n48 0 9 -50 0 0 0\n");
    folder.write("bad.chan", "1 0 9\n");
    const std::filesystem::path file = folder.path() / "s.toml";
    const auto message = [&](const std::string& text) -> std::string {
        try {
            parse_shot("[camera]\n" + text, file, no_check);
        } catch (const ShotError& error) {
            return error.what();
        }
        return "";
    };
    const Scene scene = parse_shot("[camera]\nfile = \"way.chan\"\n", file, no_check);
    ASSERT_EQ(scene.camera.keys.size(), 2u);
    expect_near(scene.camera.keys[1].position_m, {0.0, 50.0, 9.0});
    const std::string at = file.string() + ":2:8: camera.file = ";
    EXPECT_EQ(message("file = \"bad.chan\"\n"),
              at + "\"bad.chan\": line 1: has 3 numbers; accepted: lines of frame x y z rx ry "
                   "rz, and the vertical angle of view if there is one");
    EXPECT_EQ(message("file = \"none.chan\"\n"),
              at + "\"none.chan\": the camera's path does not exist; accepted: a .chan of at most 16 MiB");
    EXPECT_EQ(
        message(
            "file = \"way.chan\"\nkeys = [{ frame = 1, position_m = [0, 0, 9], look_at_m = [0, 9, 9] }]\n"),
        at + "\"way.chan\": is given beside camera.keys; accepted: one of the two");
}

}  // namespace
}  // namespace pelagic
