// The floor that a shot's pictures say.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "plugin/files/files.h"
#include "plugin/format/exr/exr.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

class FloorPictures : public testing::Test {
  protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    // A grey picture of value(column, row), rows from the top.
    std::string picture(const std::string& name, int width, int height,
                        const std::function<float(int, int)>& value) const {
        std::vector<float> texels;
        for (int row = height; row-- > 0;)  // as files are written, from the bottom
            for (int x = 0; x < width; ++x) texels.push_back(value(x, row));
        const fs::path path = folder_ / name;
        files::write_atomically(
            path,
            exr::encode_scanline(
                {}, {.width = width, .height = height, .channels = {{.name = "Y", .data = texels.data()}}}));
        return path.string();
    }

    const fs::path folder_ = fs::temp_directory_path() / ("pelagic_floor_" + std::to_string(getpid()));
};

TEST_F(FloorPictures, LieWhereTheShotSaysWithNorthAtTheTop) {
    Scene scene;
    scene.sea.depth_m = 30.0;
    scene.sea.depth_file = picture("bay.exr", 8, 4, [](int x, int row) {
        return 1.0f + static_cast<float>(x) + 10.0f * static_cast<float>(row);
    });
    scene.sea.depth_size_m = 16.0;
    scene.sea.depth_east_m = 100.0;
    scene.sea.depth_north_m = -50.0;
    const Floor floor = make_floor(scene);
    EXPECT_NEAR(floor.depth_m({93.0, -47.0}), 1.0, 1e-5);   // north-west
    EXPECT_NEAR(floor.depth_m({107.0, -47.0}), 8.0, 1e-5);  // north-east
    EXPECT_NEAR(floor.depth_m({93.0, -53.0}), 31.0, 1e-4);  // south-west
    EXPECT_NEAR(floor.depth_m({0.0, 0.0}), 30.0, 1e-4);
    scene.sea.depth_m = std::numeric_limits<double>::infinity();
    EXPECT_GT(make_floor(scene).depth_m({0.0, 0.0}), 100.0);
    EXPECT_GT(floor_bytes(scene), 8u * 4u * sizeof(float));
    EXPECT_EQ(floor_bytes(Scene{}), 0u);
    EXPECT_LT(make_water(scene).floor_m, 1e6f);  // so that the floor is looked for
    // Land is water of a centimetre.
    scene.sea.depth_file = picture("land.exr", 2, 2, [](int, int) { return -3.0f; });
    EXPECT_NEAR(make_floor(scene).depth_m({100.0, -50.0}), 0.01, 1e-6);
}

// A slope with a rock on it, and a rectangle that isn't square; what hangs over the rock's foot hides it.
TEST_F(FloorPictures, MayBeMeshesAsTheyLieInTheWorld) {
    const fs::path path = folder_ / "shelf.OBJ";
    files::write_atomically(path,
                            "v -20 -5 -8\nv 20 -5 -2\nv 20 5 -2\nv -20 5 -8\n"
                            "v 4 -1 -1\nv 6 -1 -1\nv 6 1 -1\nv 4 1 -1\n"
                            "f 5 6 7 8\nf 1 2 3 4\n");
    Scene scene;
    scene.sea.depth_m = 30.0;
    scene.sea.depth_file = path.string();
    EXPECT_TRUE(check_scene(scene).empty());
    const Floor floor = make_floor(scene);
    for (const double x : {-19.0, -7.3, 0.0, 3.5, 7.0, 19.0})
        for (const double y : {-4.5, 0.0, 4.5})
            EXPECT_NEAR(floor.depth_m({x, y}), 5.0 - 0.15 * x, 1e-3) << x << ' ' << y;
    for (const double y : {-0.9, 0.0, 0.9}) EXPECT_NEAR(floor.depth_m({5.0, y}), 1.0, 1e-4);
    EXPECT_NEAR(floor.depth_m({0.0, 40.0}), 30.0, 1e-4);
    EXPECT_GE(floor_bytes(scene), floor.values().size() * sizeof(float));
    EXPECT_NEAR(make_floor(scene, 10.0).depth_m({0.0, 0.0}), 15.0, 1e-3);  // of a sea that rests higher
    // Of a mesh that has none everywhere, what is left is the level floor.
    files::write_atomically(path, "v 0 0 -3\nv 8 0 -3\nv 0 8 -3\nf 1 2 3\n");
    const Floor part = make_floor(scene);
    EXPECT_NEAR(part.depth_m({1.0, 1.0}), 3.0, 1e-4);
    EXPECT_NEAR(part.depth_m({7.0, 7.0}), 30.0, 1e-4);
    // Up to its edges, of whatever shape.
    for (const std::string north : {"10.003", "9.98", "0.2"}) {
        files::write_atomically(
            path, "v 0 0 -3\nv 40 0 -3\nv 40 " + north + " -3\nv 0 " + north + " -3\nf 1 2 3 4\n");
        const Floor whole = make_floor(scene);
        for (const float depth : whole.values()) ASSERT_NEAR(depth, 3.0f, 1e-4f) << north;
    }
}

TEST_F(FloorPictures, ThatAreNoneAreRefusedByName) {
    const auto refusal = [](const Scene& scene) -> std::string {
        try {
            make_floor(scene);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    Scene scene;
    scene.sea.depth_file = (folder_ / "gone.exr").string();
    EXPECT_NE(refusal(scene).find("sea.depth_file"), std::string::npos) << refusal(scene);
    EXPECT_EQ(check_scene(scene).size(), 1u);
    EXPECT_THROW(picture_content(scene), std::invalid_argument);
    scene = {};
    scene.water.floor_pattern = picture("wide.exr", 4, 2, [](int, int) { return 0.5f; });
    EXPECT_NE(refusal(scene).find("square"), std::string::npos) << refusal(scene);
    scene.water.floor_pattern = picture("below.exr", 2, 2, [](int, int) { return -0.5f; });
    EXPECT_NE(refusal(scene).find("negative"), std::string::npos) << refusal(scene);
    scene.water.floor_pattern =
        picture("good.exr", 2, 2, [](int x, int) { return 0.5f * static_cast<float>(x); });
    EXPECT_EQ(refusal(scene), "");
    const fs::path wall = folder_ / "wall.obj";
    scene = {};
    scene.sea.depth_file = wall.string();
    EXPECT_NE(refusal(scene).find("does not exist"), std::string::npos) << refusal(scene);
    files::write_atomically(wall, "v 0 0 0\nv 1 0 0\nv 1 0 -9\nv 0 0 -9\nf 1 2 3 4\n");
    EXPECT_NE(refusal(scene).find("no area from above"), std::string::npos) << refusal(scene);
    files::write_atomically(wall, "v 0 0 0\nf 1 2 3\n");
    EXPECT_NE(refusal(scene).find("wall.obj:2"), std::string::npos) << refusal(scene);
    std::string layers;
    for (int i = 0; i < 1000; ++i) {
        const std::string z = std::to_string(-i);
        layers += "v 0 0 " + z + "\nv 9 0 " + z + "\nv 9 9 " + z + "\nv 0 9 " + z + "\nf -4 -3 -2 -1\n";
    }
    files::write_atomically(wall, layers);
    EXPECT_NE(refusal(scene).find("too often"), std::string::npos) << refusal(scene);
}

// Over bright sand that only a map says the picture isn't burnt out.
TEST_F(FloorPictures, AreMetered) {
    Scene scene;
    scene.water.floor_colour = {0.6f, 0.55f, 0.45f};
    scene.effects.whitecaps = false;
    scene.camera.position_m = {0.0, 0.0, 60.0};
    scene.camera.look_at_m = {0.0, 40.0, 0.0};
    const Sky sky = make_sky(scene);
    const float deep = shot_exposure(scene, sky);
    scene.sea.depth_m = 2.0;
    const float shallow = shot_exposure(scene, sky);
    EXPECT_LT(shallow, 0.8f * deep);
    scene.sea.depth_m = 1000.0;
    scene.sea.depth_file = picture("sand.exr", 2, 2, [](int, int) { return 2.0f; });
    scene.sea.depth_size_m = 1e5;
    EXPECT_NEAR(shot_exposure(scene, sky) / shallow, 1.0f, 0.02f);
}

TEST_F(FloorPictures, CountByTheirContentNotTheirFolder) {
    Scene scene;
    scene.water.floor_pattern = picture("a.exr", 2, 2, [](int, int) { return 0.5f; });
    const std::string before = picture_content(scene);
    EXPECT_FALSE(before.empty());
    EXPECT_EQ(portable(scene).water.floor_pattern, "a.exr");
    picture("a.exr", 2, 2, [](int, int) { return 0.25f; });
    EXPECT_NE(picture_content(scene), before);
}

}  // namespace
}  // namespace pelagic
