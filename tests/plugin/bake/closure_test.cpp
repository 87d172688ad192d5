// Resume, over every key of the table: a folder holds a shot's files, one key is changed, and the shot is made
// again into the same folder. All its files must then be those of a fresh folder, byte for byte, and those
// that the key can't change must be the old ones, untouched. Prints which were.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/plan/fingerprint.h"
#include "core/scene/canonical.h"
#include "plugin/bake/bake.h"
#include "plugin/files/files.h"
#include "plugin/format/exr/exr.h"
#include "plugin/format/vdb/vdb.h"
#include "plugin/light/light.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render_files.h"
#include "tests/plugin/bake/closure_shots.h"

namespace {

using namespace pelagic;
using namespace pelagic::test;
namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// A lat-long picture of a plain sky.
void write_sky(const fs::path& file, float radiance) {
    constexpr int kWidth = 16, kHeight = 8;
    const std::vector<float> texels(kWidth * kHeight, radiance);
    exr::Image image{.width = kWidth, .height = kHeight, .channels = {}};
    for (const char* name : {"R", "G", "B"})
        image.channels.push_back({.name = name, .data = texels.data(), .type = exr::PixelType::Float});
    files::write_atomically(file, exr::encode_scanline({}, image));
}

// A picture of foam that tiles.
void write_foam(const fs::path& file, int step) {
    constexpr int kSide = 16;
    std::vector<float> texels;
    for (int i = 0; i < kSide * kSide; ++i) texels.push_back(static_cast<float>(i * step % 251));
    const exr::Image image{.width = kSide,
                           .height = kSide,
                           .channels = {{.name = "Y", .data = texels.data(), .type = exr::PixelType::Half}}};
    files::write_atomically(file, exr::encode_scanline({}, image));
}

// What a run leaves besides its files.
struct Made {
    std::map<std::string, std::string> fingerprints;  // of the files that carry one, by path
    std::vector<std::string> foreign;
};

Made render_into(const Scene& scene, const fs::path& folder) {
    const PictureOrder order{.scene = scene, .options = render_options(scene)};
    const PictureFingerprint fingerprint(
        {.scene = scene, .options = order.options, .picture_content = picture_content(scene)});
    Made made;
    for (int frame = scene.shot.first_frame; frame <= scene.shot.last_frame; ++frame)
        for (const char* extension : {"png", "exr"})
            made.fingerprints[picture_file(scene.shot, frame, extension)] = fingerprint.of(frame);
    render_files(order, {.out = folder, .frames = {}, .progress = {}, .cancel = nullptr});
    return made;
}

Made bake_into(const Scene& scene, const fs::path& folder) {
    const RunReport report = bake(scene, {.out = folder, .frames = {}, .progress = {}, .cancel = nullptr});
    Made made{.fingerprints = {}, .foreign = report.foreign};
    const nlohmann::json record = nlohmann::json::parse(bytes_of(report.record));
    for (const auto& [frame, entry] : record.at("frames").items())
        for (const auto& [path, file] : entry.at("files").items())
            made.fingerprints[path] = file.at("fingerprint").get<std::string>();
    return made;
}

std::set<std::string> files_in(const fs::path& folder) {
    std::set<std::string> paths;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) paths.insert(fs::relative(entry.path(), folder).string());
    return paths;
}

// The bytes without what they were made of: its digits, and the checksums over them: in a PNG that of the chunk, in a
// picture's EXR that of the whole.
std::string without_fingerprint(std::string bytes, const std::string& fingerprint, bool is_png) {
    for (std::size_t at = bytes.find(fingerprint); at != std::string::npos; at = bytes.find(fingerprint, at))
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), fingerprint.size(), '.');
    if (is_png) {
        const std::size_t name = bytes.find(".png", bytes.find("Comment"));
        if (name != std::string::npos)
            std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(name + 4), 4, '.');
    }
    if (bytes.starts_with(" BDV"))  // a volume's identifier is made of the same digits
        std::fill_n(bytes.begin() + vdb::kIdentifierAt, vdb::kIdentifierLength, '.');
    const std::string before = exr::text_attribute_bytes("checksum", std::string(16, '0')).substr(0, 20);
    if (const std::size_t at = bytes.find(before); at != std::string::npos)
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at + before.size()), 16, '.');
    return bytes;
}

// The output that a file is of, for the table: "mesh", "normal", "tile normal", "png", "camera", …
std::string output_of(const std::string& path) {
    std::vector<std::string> parts;
    std::string part;
    for (const char c : path + '.')
        if (c == '.')
            parts.push_back(std::move(part)), part.clear();
        else
            part += c;
    const std::string& second = parts.at(1);
    if (path.starts_with("maps/")) return second;
    if (path.starts_with("tiles/")) return "tile " + second;
    if (path.starts_with("volumes/")) return "volume " + second;
    if (second == "usda") return "root";
    if (second == "json") return "record";
    const bool is_frame = second.find_first_not_of("-0123456789") == std::string::npos;
    if (path.starts_with("mesh/")) return is_frame ? "mesh" : second;
    return is_frame ? parts.back() : second;
}

// Keys whose change has the files of an output made again although the new ones are the same: what feeds an
// output counts, and only who has built both seas knows that this time it made no difference.
struct Excuse {
    std::string_view key, output, why;
    std::string_view shot = {};  // of this one alone
};
constexpr std::string_view kWholeCells =
    "an edge of a cage has a whole number of cells, the same from nearby";
constexpr auto kExcuses = std::to_array<Excuse>({
    {"sea.wind_direction_deg", "mesh", "a measured spectrum has directions of its own"},
    {"sea.fetch_m", "mesh", "a measured spectrum has grown already"},
    {"sea.gust_size_m", "mesh", "there are no gusts"},
    {"sea.gust_size_m", "slope-variance", "there are no gusts"},
    {"sea.gust_size_m", "whitecaps", "there are no gusts"},
    {"sea.spreading", "mesh", "a measured spectrum has directions of its own"},
    {"sea.depth_m", "mesh", "400 m are as deep as can be for these waves"},
    {"sea.spectrum", "mesh", "TMA is JONSWAP where the water is deep"},
    {"sea.swell", "mesh", "a swell without height"},
    {"waves.cascades", "mesh", "modes that are finer than the mesh"},
    {"waves.tiling", "mesh", "cascades that are finer than the mesh"},
    {"effects.foam_drift", "mesh", "foam that doesn't live doesn't drift"},
    {"effects.sea_minus_air_c", "mesh", "Monahan's law of 1980 doesn't know it"},
    {"quality.level", "mesh", "foam's history that sees trains alone"},
    {"quality.level", "whitecaps", "foam's history that sees trains alone"},
    {"quality.max_error", "mesh", "foam's history that sees trains alone"},
    {"quality.max_error", "whitecaps", "foam's history that sees trains alone"},
    {"quality.frame_ms", "mesh", "foam's history that sees trains alone"},
    {"quality.frame_ms", "whitecaps", "foam's history that sees trains alone"},
    {"quality.level", "slope-variance", "double precision, rounded to single"},
    {"surface.earth_curvature", "mesh", "a cage stays where it was put"},
    {"output.attributes", "mesh", "a list in another order is another value"},
    {"camera.fov_deg", "mesh", kWholeCells, kAdaptiveCageShot},
    {"camera.keys", "mesh", kWholeCells, kAdaptiveCageShot},
    {"surface.cell_px", "mesh", kWholeCells, kAdaptiveCageShot},
    {"camera.shift_x", "mesh", kWholeCells, kAdaptiveCageShot},
    {"camera.shift_y", "mesh", kWholeCells, kAdaptiveCageShot},
});

bool is_excused(const std::string& key, const std::string& output, std::string_view shot) {
    return std::any_of(kExcuses.begin(), kExcuses.end(), [&](const Excuse& excuse) {
        return excuse.key == key && output.ends_with(excuse.output) &&
               (excuse.shot.empty() || excuse.shot == shot);
    });
}

// How many files a bake's list of foreign ones names.
int named_files(const std::vector<std::string>& lines) {
    int count = 0;
    for (const std::string& line : lines) {
        const std::size_t colon = line.rfind(": ");
        int number = 1;
        if (std::sscanf(line.c_str() + colon, ": %d files", &number) != 1) number = 1;
        count += number;
    }
    return count;
}

class Closure : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-closure-" + std::to_string(getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    Made make(const Scene& scene, const fs::path& into) const {
        return is_picture_ ? render_into(scene, into) : bake_into(scene, into);
    }

    // Files of one fingerprint must be the same: of the hundreds of shots that this test makes, too.
    void compare_with_all_others(const std::string& path, const std::string& fingerprint,
                                 const std::string& bytes) {
        const auto [known, is_new] =
            bytes_by_fingerprint_.try_emplace({output_of(path), fingerprint}, bytes, path);
        EXPECT_TRUE(is_new || known->second.first == bytes)
            << path << ": other bytes than " << known->second.second << " of the same fingerprint";
    }

    // Equal fingerprints, equal plans and keys; and the other way round.
    void compare_sources(const Scene& scene) {
        std::vector<int> frames;
        for (int frame = scene.shot.first_frame; frame <= scene.shot.last_frame; ++frame)
            frames.push_back(frame);
        const Plan plan = plan_bake(prepare(scene), frames);
        for (const PlannedOutput& output : plan.outputs)
            for (const int frame : frames) {
                std::string source = plan.queries[output.query].query.name + '\n' +
                                     canonical(plan.from->scene, output.key_parts) +
                                     plan_text(plan, output.query) + std::to_string(frame);
                if (const auto view = plan.surface->shaped_by(frame); view && output.has_surface)
                    source += pose_text(*view);
                const std::string fingerprint =
                    frame_fingerprint(plan, output, output_fingerprint(plan, output), frame);
                EXPECT_EQ(source_of_.try_emplace(fingerprint, source).first->second, source);
                EXPECT_EQ(fingerprint_of_.try_emplace(source, fingerprint).first->second, fingerprint);
            }
    }

    // Two frames say of a camera that stands what three do, and one says it where no edit is of frames.
    void expect_closed(BaseShot base) {
        if (base.scene.camera.keys.size() < 2)
            base.scene.shot.last_frame =
                std::min(base.scene.shot.last_frame, base.scene.shot.first_frame + 1);
        is_picture_ = base.is_picture;
        shot_ = base.name;
        base_ = folder_ / "base";
        base_made_ = make(base.scene, base_);
        base_files_ = files_in(base_);
        ASSERT_FALSE(base_made_.fingerprints.empty());
        for (const auto& [path, fingerprint] : base_made_.fingerprints) {
            const std::string bytes = bytes_of(base_ / path);
            ASSERT_NE(bytes.find(fingerprint), std::string::npos) << path;
            compare_with_all_others(path, fingerprint,
                                    without_fingerprint(bytes, fingerprint, path.ends_with("png")));
        }
        if (!is_picture_) compare_sources(base.scene);
        std::set<std::string> tried;
        for (const Edit& edit : edits_of(base))
            if (tried.insert(edit.key).second || !has_one_edit_a_key_) try_edit(edit);
        print_table(base.name);
        EXPECT_TRUE(made_for_nothing_.empty())
            << "made again, and they are the same:\n"
            << std::accumulate(
                   made_for_nothing_.begin(), made_for_nothing_.end(), std::string(),
                   [](const std::string& text, const std::string& line) { return text + line + '\n'; });
    }

    void try_edit(const Edit& edit) {
        SCOPED_TRACE(edit.key + " = " + edit.what);
        const fs::path again = folder_ / "again", fresh = folder_ / "fresh";
        fs::remove_all(again);
        fs::remove_all(fresh);
        // Who replaces a file gives the name to a new one: the base keeps its own.
        fs::copy(base_, again, fs::copy_options::recursive | fs::copy_options::create_hard_links);
        if (!is_picture_) compare_sources(edit.scene);
        const Made report = make(edit.scene, again);
        const Made made = make(edit.scene, fresh);
        const std::set<std::string> files = files_in(fresh), there = files_in(again);

        std::map<std::string, std::set<char>> happened;  // by output
        for (const std::string& path : files) {
            const std::string output = output_of(path), bytes = bytes_of(fresh / path);
            EXPECT_TRUE(bytes_of(again / path) == bytes) << path << " isn't that of a fresh folder";
            const bool was_there = base_files_.contains(path);
            const bool kept = was_there && fs::equivalent(base_ / path, again / path);
            happened[output].insert(kept ? 'k' : was_there ? 'R' : 'n');
            if (output == "sky" && was_there) {
                EXPECT_EQ(kept, !edit.key.starts_with("light.")) << path;
            }
            const auto carries = made.fingerprints.find(path);
            if (carries == made.fingerprints.end()) continue;
            const std::string content = without_fingerprint(bytes, carries->second, path.ends_with("png"));
            compare_with_all_others(path, carries->second, content);
            if (!was_there || kept) continue;
            const std::string former = without_fingerprint(
                bytes_of(base_ / path), base_made_.fingerprints.at(path), path.ends_with("png"));
            if (former != content) continue;
            // A picture's two files have one fingerprint, and the EXR's header says what light and sea it is of.
            if (output == "png") continue;
            happened[output].insert('!');
            if (!is_excused(edit.key, output, shot_))
                made_for_nothing_.insert(output + ": " + edit.key + " = " + edit.what);
        }
        for (const std::string& path : base_files_)
            if (!files.contains(path)) happened[output_of(path)].insert('-');
        if (!is_picture_) {
            // Whatever else is there is named, unless it is of a shot with a record of its own.
            std::set<std::string> others;
            std::set_difference(there.begin(), there.end(), files.begin(), files.end(),
                                std::inserter(others, others.end()));
            std::erase_if(others, [all = others](const std::string& path) {
                const std::string name = fs::path(path).filename().string();
                return all.contains(name.substr(0, name.find('.')) + ".json");
            });
            EXPECT_EQ(named_files(report.foreign), static_cast<int>(others.size()))
                << ::testing::PrintToString(report.foreign) << "\n"
                << ::testing::PrintToString(others);
        }
        rows_.emplace_back(edit.key + " = " + edit.what, std::move(happened));
    }

    void print_table(const std::string& name) const {
        std::set<std::string> outputs;
        for (const auto& [label, happened] : rows_)
            for (const auto& [output, marks] : happened) outputs.insert(output);
        std::printf(
            "\n%s: after one key was changed, files were k kept, R made again (! though the same), "
            "n made, - left behind and named\n",
            name.c_str());
        std::string line;
        const auto end_row = [&](const std::string& label) {
            std::printf("%s  %s\n", line.c_str(), label.c_str());
            line.clear();
        };
        const auto add_cell = [&](std::string text, std::size_t width) {
            text.resize(std::max(text.size(), width + 2), ' ');
            line += text;
        };
        for (const std::string& output : outputs) add_cell(output, output.size());
        end_row("");
        for (const auto& [label, happened] : rows_) {
            for (const std::string& output : outputs) {
                const auto found = happened.find(output);
                add_cell(found == happened.end() ? std::string()
                                                 : std::string(found->second.begin(), found->second.end()),
                         output.size());
            }
            end_row(label);
        }
    }

    fs::path folder_, base_;
    bool is_picture_ = false, has_one_edit_a_key_ = false;
    std::string_view shot_;
    Made base_made_;
    std::set<std::string> base_files_;
    // By output and fingerprint: the bytes without it, and the path.
    std::map<std::pair<std::string, std::string>, std::pair<std::string, std::string>> bytes_by_fingerprint_;
    std::vector<std::pair<std::string, std::map<std::string, std::set<char>>>> rows_;
    std::set<std::string> made_for_nothing_;
    std::map<std::string, std::string> source_of_, fingerprint_of_;
};

// By day, of a shot that shares its other keys with another one, which is asked about them.
BaseShot only(BaseShot base, std::vector<std::string> tables) {
    base.tables = std::move(tables);
    return base;
}

TEST_F(Closure, OfAPatch) {
    expect_closed(patch_shot());
}
TEST_F(Closure, OfVolumes) {
    expect_closed(only(volumes_shot(), {"surface", "effects", "output"}));
}
TEST_F(Closure, OfVolumesByAllKeys) {
    expect_closed(volumes_shot());
}
TEST_F(Closure, OfFoamThatLives) {
    expect_closed(foam_shot());
}
TEST_F(Closure, OfTrainsOverCascades) {
    expect_closed(trains_shot());
}
TEST_F(Closure, OfAProjectedGridByAllKeys) {
    expect_closed(grid_shot());
}
TEST_F(Closure, OfAProjectedGridOverAutomaticCascades) {
    expect_closed(automatic_shot());
}
TEST_F(Closure, OfTrainsOnABeach) {
    expect_closed(coast_shot());
}
TEST_F(Closure, OfTilesOnABeach) {
    expect_closed(coast_tiles_shot());
}
TEST_F(Closure, OfAMeshFromNearToFar) {
    expect_closed(only(near_far_shot(), {"shot", "surface", "camera"}));
}
TEST_F(Closure, OfAMeshFromNearToFarByAllKeys) {
    expect_closed(near_far_shot());
}
TEST_F(Closure, OfACage) {
    expect_closed(only(cage_shot(), {"surface", "output"}));
}
TEST_F(Closure, OfACageByAllKeys) {
    expect_closed(cage_shot());
}
TEST_F(Closure, OfACageAsACameraSeesIt) {
    expect_closed(only(adaptive_cage_shot(), {"surface", "camera"}));
}
TEST_F(Closure, OfACageAsACameraSeesItByAllKeys) {
    expect_closed(adaptive_cage_shot());
}
TEST_F(Closure, OfABuoysSpectrum) {
    expect_closed(buoy_shot());
}
TEST_F(Closure, OfPicturesByDaylight) {
    // One frame, fewer pixels, and foam that forgets soon: each edit's light and sea are most of the work.
    BaseShot base = only(daylight_shot(), {"camera", "light", "water", "effects"});
    base.scene.shot.last_frame = base.scene.shot.first_frame;
    base.scene.camera.resolution = {16, 9};
    base.scene.effects.foam_decay_s = 0.5;
    has_one_edit_a_key_ = true;
    expect_closed(std::move(base));
}
TEST_F(Closure, OfPicturesByDaylightByAllKeys) {
    expect_closed(daylight_shot());
}
TEST_F(Closure, OfPicturesUnderAPictureOfASky) {
    const std::string sky = (folder_ / "sky.exr").string(), other = (folder_ / "other.exr").string();
    write_sky(sky, 1.0f);
    write_sky(other, 1.5f);
    const std::string foam = (folder_ / "foam.exr").string(), lace = (folder_ / "lace.exr").string();
    write_foam(foam, 167);
    write_foam(lace, 3);
    expect_closed(sky_shot({sky, other}, {foam, lace}));
}

// The same path, and another picture there.
TEST_F(Closure, PicturesCountByTheirContent) {
    is_picture_ = true;
    const std::string sky = (folder_ / "sky.exr").string(), foam = (folder_ / "foam.exr").string();
    write_sky(sky, 1.0f);
    write_foam(foam, 167);
    const Scene scene = sky_shot({sky}, {foam}).scene;
    const std::string first = picture_content(scene);
    write_foam(foam, 3);
    EXPECT_NE(picture_content(scene), first);
    const fs::path again = folder_ / "again", fresh = folder_ / "fresh";
    make(scene, again);
    const std::string file = picture_file(scene.shot, scene.shot.first_frame, "exr");
    const std::string before = bytes_of(again / file);
    write_sky(sky, 1.5f);
    make(scene, again);
    make(scene, fresh);
    EXPECT_NE(bytes_of(again / file), before);
    for (const std::string& path : files_in(fresh))
        EXPECT_TRUE(bytes_of(again / path) == bytes_of(fresh / path)) << path;
}

// A key of which no base shot has another value would be left out in silence.
TEST(ClosureEdits, ChangeEveryKeyThatHasAnotherValue) {
    std::set<std::string> changed;
    for (const BaseShot& base :
         {patch_shot(), volumes_shot(), foam_shot(), trains_shot(), coast_shot(), coast_tiles_shot(),
          grid_shot(), near_far_shot(), automatic_shot(), buoy_shot(), cage_shot(), adaptive_cage_shot(),
          daylight_shot(), sky_shot({"one.exr", "two.exr"}, {"three.exr", "four.exr"})})
        for (const Edit& edit : edits_of(base)) changed.insert(edit.key);
    for (const Key& key : keys()) {
        const bool has_one_value = key.type == KeyType::Word && key.choices.size() < 2;
        // A body's file stands beside the shot: PictureFiles.DependOnBodies changes each of its keys.
        const bool is_other_keys = key.path == "camera.file" || key.path == kObjectsKey;
        EXPECT_TRUE(changed.contains(key.path) || has_one_value || is_other_keys)
            << key.path << ": no base shot changes it";
    }
}

}  // namespace
