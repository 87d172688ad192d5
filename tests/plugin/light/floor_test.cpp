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
