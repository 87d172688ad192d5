// Which files of a folder a bake names as not its own, and which are none of its business.
#include "plugin/run/foreign.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "plugin/bake/bake.h"

namespace {

using namespace pelagic;
namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

class ForeignFiles : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-foreign-" + std::to_string(getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        scene_.shot.last_frame = 3;
        scene_.surface.size_m = 100.0;
        scene_.surface.resolution = 4;
        scene_.waves.cascades = {{.size_m = 100.0, .resolution = 32}};
        scene_.output.map_resolution = 4;
    }
    void TearDown() override { fs::remove_all(folder_); }

    Lines foreign(const Scene& scene) const {
        return bake(scene, {.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr}).foreign;
    }
    void write(const std::string& path) const {
        fs::create_directories((folder_ / path).parent_path());
        std::ofstream(folder_ / path) << "somebody's\n";
    }

    fs::path folder_;
    Scene scene_;
};

TEST_F(ForeignFiles, AFolderOfOneShotHasNone) {
    scene_.output.maps = {MapKind::Normal};
    scene_.output.cascade_tiles = true;
    EXPECT_EQ(foreign(scene_), Lines());
    EXPECT_EQ(foreign(scene_), Lines());
}

TEST_F(ForeignFiles, AreThoseOutsideTheRange) {
    foreign(scene_);
    scene_.shot.last_frame = 2;
    EXPECT_EQ(foreign(scene_), Lines{"mesh/sea.0003.usdc: outside the shot's frames"});
    scene_.shot.first_frame = 2;
    EXPECT_EQ(foreign(scene_), Lines{"mesh/sea.####.usdc: 2 files outside the shot's frames"});
    EXPECT_TRUE(fs::exists(folder_ / "mesh/sea.0001.usdc")) << "nothing is deleted";
}

TEST_F(ForeignFiles, AreThoseOfAnotherFormatAndOfOutputsThatAreGone) {
    scene_.output.maps = {MapKind::Normal, MapKind::Displacement};
    scene_.output.cascade_tiles = true;
    foreign(scene_);
    scene_.output.mesh = MeshFormat::Usda;
    scene_.output.maps = {MapKind::Normal};
    const std::string gone = " of an output that the shot doesn't have";
    EXPECT_EQ(foreign(scene_),
              (Lines{"maps/sea.displacement.####.exr: 3 files" + gone, "mesh/sea.####.usdc: 3 files" + gone,
                     "mesh/sea.topology.usdc:" + gone, "tiles/sea.displacement.0.####.exr: 3 files" + gone}));
    scene_.output.mesh = MeshFormat::None;
    scene_.output.cascade_tiles = false;
    EXPECT_EQ(foreign(scene_).size(), 11u) << "the stage and its sky, too";
}

TEST_F(ForeignFiles, AreThoseOfAnotherNameThatNoRecordKnows) {
    scene_.output.mesh = MeshFormat::Usda;
    foreign(scene_);
    // A name that begins like the other one. That shot has its own record, and its files are its own business.
    scene_.shot.name = "sea-2";
    EXPECT_EQ(foreign(scene_), Lines());
    fs::remove(folder_ / "sea.json");
    const std::string other = " of another shot";
    EXPECT_EQ(foreign(scene_),
              (Lines{"mesh/sea.####.usda: 3 files" + other, "mesh/sea.manifest.usda:" + other,
                     "mesh/sea.topology.usda:" + other, "sea.camera.usdc:" + other, "sea.sky.exr:" + other,
                     "sea.usda:" + other}));
    write("sea.json");
    EXPECT_EQ(foreign(scene_).size(), 7u) << "that is no record";
}

TEST_F(ForeignFiles, AreNotWhatPeopleAndRendersKeepBesideThem) {
    for (const char* path :
         {"sea.0001.exr", "sea.0001.png", "sea.0007.exr", "notes.txt", "shot.toml", "mesh/notes.txt",
          "mesh/.hidden.usdc", "maps/thumbs/sea.normal.0009.exr", "other/sea.0009.usdc"})
        write(path);
    EXPECT_EQ(foreign(scene_), Lines());
}

// Numbers as a bake writes them: four digits at least, no more zeros than that.
TEST_F(ForeignFiles, NumbersAreThoseThatABakeWrites) {
    for (const char* path : {"mesh/sea.00002.usdc", "mesh/sea.2.usdc"}) write(path);
    EXPECT_EQ(foreign(scene_), (Lines{"mesh/sea.00002.usdc: of an output that the shot doesn't have",
                                      "mesh/sea.2.usdc: of an output that the shot doesn't have"}));
}

TEST_F(ForeignFiles, OfPicturesAreThoseOutsideTheRange) {
    for (const char* path : {"sea.0001.exr", "sea.0001.png", "sea.0004.png", "sea.0004.exr", "sea.0005.exr",
                             "other.0009.exr", "sea.normal.0009.exr"})
        write(path);
    const std::vector<RunPart> parts{{{"sea.", ".png"}, {}}, {{"sea.", ".exr"}, {}}};
    EXPECT_EQ(foreign_pictures(folder_, scene_.shot, parts),
              (Lines{"sea.####.exr: 2 files outside the shot's frames",
                     "sea.0004.png: outside the shot's frames"}));
}

}  // namespace
