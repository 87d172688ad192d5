// Damage to a bake's files, over every kind of file and every kind of damage: verify() names it, and the next bake
// makes the very files again. And what is missing, stale and foreign, in folders of one shot and of two.
#include "plugin/run/verify.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "plugin/bake/bake.h"
#include "plugin/files/files.h"

namespace {

using namespace pelagic;
namespace fs = std::filesystem;
using Files = std::map<std::string, std::string>;

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary).write(bytes.data(), std::ssize(bytes));
}

Files files_in(const fs::path& folder) {
    Files files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[fs::relative(entry.path(), folder).string()] = bytes_of(entry.path());
    return files;
}

// Every output that a shot can ask for.
Scene every_output(MeshFormat format) {
    Scene scene;
    scene.shot.last_frame = 3;
    scene.surface.size_m = 100.0;
    scene.surface.resolution = 4;
    scene.waves.cascades = {{.size_m = 100.0, .resolution = 128}, {.size_m = 17.0, .resolution = 32}};
    scene.output.mesh = format;
    scene.output.maps = {MapKind::Displacement, MapKind::Normal, MapKind::SlopeVariance, MapKind::Whitecaps};
    scene.output.map_resolution = 8;
    scene.output.cascade_tiles = true;
    return scene;
}

std::string flipped(std::string bytes, std::size_t at, int bit) {
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
    return bytes;
}

// A record says the same with another line's end, or another last digit of a number that is nearest to it.
bool says_the_same(const std::string& a, const std::string& b) {
    return nlohmann::json::accept(a) && nlohmann::json::parse(a) == nlohmann::json::parse(b);
}

struct Damage {
    const char* name;
    std::function<std::string(std::string)> apply;
};
const std::vector<Damage>& damages() {
    static const std::vector<Damage> all{
        {"the first bit flipped", [](const std::string& b) { return flipped(b, 0, 0); }},
        {"a bit in the middle flipped", [](const std::string& b) { return flipped(b, b.size() / 2, 5); }},
        {"the last bit flipped", [](const std::string& b) { return flipped(b, b.size() - 1, 7); }},
        {"a block of zeros",
         [](std::string b) {
             return b.replace(b.size() / 3, std::min<std::size_t>(b.size() / 3, 512),
                              std::min<std::size_t>(b.size() / 3, 512), '\0');
         }},
        {"a destroyed header", [](std::string b) { return b.replace(0, 32, 32, 'x'); }},
        {"the end cut off", [](const std::string& b) { return b.substr(0, b.size() - 1); }},
        {"emptied", [](const std::string&) { return std::string(); }},
        {"something appended", [](const std::string& b) { return b + '\0'; }},
    };
    return all;
}

class Verify : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-verify-" + std::to_string(getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    RunReport bake_into(const fs::path& out, const Scene& scene, std::vector<int> frames = {},
                        bool trust_times = false) const {
        RunOptions options;
        options.out = out;
        options.frames = std::move(frames);
        options.trust_times = trust_times;
        return bake(scene, options);
    }
    // "damaged mesh/sea.0002.usdc", …
    std::vector<std::string> flaws() const {
        std::vector<std::string> lines;
        for (const Finding& finding : verify(folder_).findings)
            lines.push_back(std::string(word_of(finding.flaw)) + ' ' + finding.path);
        return lines;
    }
    void restore(const Files& files) const {
        for (const auto& [path, bytes] : files)
            if (bytes_of(folder_ / path) != bytes) write(folder_ / path, bytes);
    }

    fs::path folder_;
};

TEST_F(Verify, EveryDamageToEveryKindOfFileIsNamedAndMadeAgain) {
    for (const MeshFormat format : {MeshFormat::Usdc, MeshFormat::Usda}) {
        fs::remove_all(folder_);
        const Scene scene = every_output(format);
        bake_into(folder_, scene);
        const Files whole = files_in(folder_);
        const Verification found = verify(folder_);
        ASSERT_TRUE(found.is_whole()) << found.findings.front().path << ' ' << found.findings.front().what;
        EXPECT_EQ(found.files + found.shots, static_cast<int>(whole.size())) << "none is left out";
        std::vector<std::string> paths;  // of frame 2, and of no frame
        for (const auto& [path, bytes] : whole)
            if (path.find(".0001.") == std::string::npos && path.find(".0003.") == std::string::npos)
                paths.push_back(path);
        ASSERT_GE(paths.size(), 1u + 4 + 8 + 5);
        for (const Damage& damage : damages()) {
            SCOPED_TRACE(damage.name);
            for (const std::string& path : paths) {
                const std::string damaged = damage.apply(whole.at(path));
                ASSERT_NE(damaged, whole.at(path)) << path;
                if (path.ends_with(".json") && says_the_same(damaged, whole.at(path))) continue;
                write(folder_ / path, damaged);
                const std::vector<std::string> named = flaws();
                EXPECT_TRUE(std::count(named.begin(), named.end(), "damaged " + path) == 1)
                    << path << ": " << ::testing::PrintToString(named);
                if (!path.ends_with(".json")) {
                    EXPECT_EQ(named.size(), 1u) << path;
                }
                write(folder_ / path, whole.at(path));
            }
            // All at once but the record, which then knows what is wrong.
            for (const std::string& path : paths)
                if (!path.ends_with(".json")) write(folder_ / path, damage.apply(whole.at(path)));
            EXPECT_EQ(flaws().size(), paths.size() - 1);
            const RunReport report = bake_into(folder_, scene);
            EXPECT_EQ(report.kept, 2);
            EXPECT_EQ(report.damaged.size(), 1u + 4 + 8)
                << "the frame's files; the others are compared anyway";
            EXPECT_TRUE(files_in(folder_) == whole);
        }
        for (const std::string& path : paths) {
            fs::remove(folder_ / path);
            const std::vector<std::string> named = flaws();
            if (!path.ends_with(".json")) {
                EXPECT_EQ(named, std::vector<std::string>{"missing " + path});
            }
            if (path.ends_with(".json")) {
                EXPECT_EQ(named.size(), whole.size() - 1) << "nobody knows the others: all are foreign";
            }
            write(folder_ / path, whole.at(path));
        }
        // Two frames swapped: of one size, and each whole in itself.
        for (const std::string& path : paths) {
            const std::size_t number = path.find(".0002.");
            if (number == std::string::npos) continue;
            const std::string other = std::string(path).replace(number, 6, ".0003.");
            write(folder_ / path, whole.at(other));
            write(folder_ / other, whole.at(path));
            EXPECT_EQ(flaws(), (std::vector<std::string>{"damaged " + path, "damaged " + other}));
            EXPECT_EQ(bake_into(folder_, scene).kept, 1);
            EXPECT_TRUE(files_in(folder_) == whole);
        }
    }
}

// A number, a word, a bracket: whichever bit of the record is another one.
TEST_F(Verify, EveryFlippedBitOfARecordIsNoticed) {
    Scene scene = every_output(MeshFormat::None);
    scene.output.maps = {MapKind::Whitecaps};
    scene.output.cascade_tiles = false;
    scene.shot.last_frame = 2;
    bake_into(folder_, scene);
    const std::string record = bytes_of(folder_ / "sea.json");
    const Files whole = files_in(folder_);
    int unnoticed = 0;
    for (std::size_t at = 0; at < record.size(); at += 3) {
        const std::string damaged = flipped(record, at, static_cast<int>(at / 3 % 8));
        write(folder_ / "sea.json", damaged);
        if (verify(folder_).is_whole() && !says_the_same(damaged, record)) {
            ++unnoticed;
            ADD_FAILURE() << "byte " << at << ": " << record.substr(at > 20 ? at - 20 : 0, 40);
        }
    }
    EXPECT_EQ(unnoticed, 0);
    write(folder_ / "sea.json", record);
    EXPECT_TRUE(verify(folder_).is_whole());
}

// A statistic that somebody changed by hand, as valid JSON.
TEST_F(Verify, AnAlteredNumberInARecordIsNoticedAndTheFrameBakedAgain) {
    const Scene scene = every_output(MeshFormat::Usdc);
    bake_into(folder_, scene);
    const Files whole = files_in(folder_);
    nlohmann::ordered_json record = nlohmann::ordered_json::parse(whole.at("sea.json"));
    for (const char* key :
         {"hs_m", "tm_minus1_0_s", "mss_resolved", "mesh_hs_m", "whitecap_coverage", "time_s"}) {
        nlohmann::ordered_json altered = record;
        double& number = altered["frames"]["2"][key].get_ref<double&>();
        number += 1e-12 + 1e-9 * number;
        write(folder_ / "sea.json", altered.dump(2));
        EXPECT_EQ(flaws(), std::vector<std::string>{"damaged sea.json"}) << key;
        const RunReport report = bake_into(folder_, scene);
        EXPECT_EQ(report.done, 1) << key;
        EXPECT_EQ(report.damaged,
                  std::vector<std::string>{"sea.json was altered in what it says about frame 2"});
        EXPECT_TRUE(files_in(folder_) == whole) << key;
    }
    nlohmann::ordered_json altered = record;
    altered["frames"]["2"]["hs_m"] = 17.0;
    write(folder_ / "sea.json", altered.dump(2));
    const RunReport beside = bake_into(folder_, scene, {1, 3});
    EXPECT_TRUE(beside.damaged.empty()) << "it wasn't asked for, and so not made again";
    EXPECT_EQ(beside.stale, std::vector<int>{2});
    bake_into(folder_, scene);
    EXPECT_TRUE(files_in(folder_) == whole);
    record["spectrum"]["hs_m"] = 17.0;
    write(folder_ / "sea.json", record.dump(2));
    EXPECT_EQ(flaws(), std::vector<std::string>{"damaged sea.json"});
    EXPECT_EQ(bake_into(folder_, scene).kept, 3) << "what belongs to the shot is written anyway";
    EXPECT_TRUE(files_in(folder_) == whole);
}

TEST_F(Verify, FramesThatArentBakedAreMissingAndThoseOfAnotherVersionStale) {
    Scene scene = every_output(MeshFormat::Usdc);
    scene.shot.last_frame = 9;
    bake_into(folder_, scene, {1, 2, 5});
    std::vector<Finding> findings = verify(folder_).findings;
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].flaw, Flaw::Missing);
    EXPECT_EQ(findings[0].what, "lacks frames that aren't baked: 3-4, 6-9");
    scene.shot.last_frame = 5;
    bake_into(folder_, scene, {3, 4});
    EXPECT_TRUE(verify(folder_).is_whole());
    scene.shot.seed = 2;
    bake_into(folder_, scene, {4});
    findings = verify(folder_).findings;
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].flaw, Flaw::Stale);
    EXPECT_EQ(findings[0].what, "has frames of another version of the shot: 1-3, 5");
    scene.shot.seed = 1;
    bake_into(folder_, scene, {4});
    EXPECT_TRUE(verify(folder_).is_whole()) << "they are the record's version again";
    scene.shot.last_frame = 4;
    bake_into(folder_, scene);
    for (const std::string& flaw : flaws())
        EXPECT_TRUE(flaw.starts_with("foreign ") && flaw.find(".0005.") != std::string::npos) << flaw;
    EXPECT_EQ(flaws().size(), 1u + 4 + 8);
}

// A bake writes a frame's files, then its entry: whoever verifies in between, or after the bake was stopped there,
// is told of the frame, and of no file that would be foreign or damaged.
TEST_F(Verify, AFrameInTheMakingIsMissingOrStaleAndItsFilesAreNoFlaws) {
    Scene scene = every_output(MeshFormat::Usdc);
    bake_into(folder_, scene);
    Files frame;
    for (const auto& [path, bytes] : files_in(folder_))
        if (path.find(".0002.") != std::string::npos) frame[path] = bytes;
    EXPECT_EQ(frame.size(), 1u + 4 + 8);

    fs::remove_all(folder_);
    bake_into(folder_, scene, {1, 3});
    for (const auto& [path, bytes] : frame) {
        write(folder_ / path, bytes);
        EXPECT_EQ(flaws(), std::vector<std::string>{"missing sea.json"}) << path;
    }
    write(folder_ / "mesh/sea.0004.usdc", "");
    EXPECT_EQ(flaws(), (std::vector<std::string>{"foreign mesh/sea.0004.usdc", "missing sea.json"}));
    fs::remove(folder_ / "mesh/sea.0004.usdc");
    bake_into(folder_, scene);
    EXPECT_TRUE(verify(folder_).is_whole());

    scene.shot.seed = 2;
    bake_into(folder_, scene, {1, 3});
    for (const auto& [path, bytes] : frame) {
        write(folder_ / path, bytes + "a later version");
        EXPECT_EQ(flaws(), std::vector<std::string>{"stale sea.json"}) << path;
    }
    bake_into(folder_, scene);
    EXPECT_TRUE(verify(folder_).is_whole());
}

// A folder may hold several shots: no file of one is another's, whatever their names and outputs.
TEST_F(Verify, TwoShotsInAFolderShareNoFile) {
    const fs::path both = folder_ / "both";
    int pair = 0;
    for (const auto& [one, two] :
         {std::pair{"sea", "sea-2"}, {"sea", "sea_"}, {"normal", "0001"}, {"a", "a-normal"}})
        for (const MeshFormat format : {MeshFormat::Usdc, MeshFormat::Usda}) {
            if (pair++ > 0 && format == MeshFormat::Usda) continue;
            SCOPED_TRACE(std::string(one) + " and " + two);
            fs::remove_all(folder_);
            Scene first = every_output(format), second = every_output(format);
            first.shot.name = one;
            second.shot.name = two;
            second.shot.seed = 2;
            bake_into(folder_ / "one", first);
            bake_into(folder_ / "two", second);
            bake_into(both, first);
            EXPECT_EQ(bake_into(both, second).foreign, std::vector<std::string>());
            const RunReport again = bake_into(both, first);
            EXPECT_EQ(again.kept, 3);
            EXPECT_EQ(again.foreign, std::vector<std::string>()) << "the second one has its own record";
            Files alone = files_in(folder_ / "one");
            const std::size_t files = alone.size();
            alone.merge(files_in(folder_ / "two"));
            EXPECT_EQ(alone.size(), 2 * files) << "no name in common";
            EXPECT_TRUE(files_in(both) == alone);
            const Verification found = verify(both);
            EXPECT_TRUE(found.is_whole());
            EXPECT_EQ(found.shots, 2);
            fs::remove(both / (std::string(two) + ".json"));
            for (const Finding& finding : verify(both).findings) {
                EXPECT_EQ(finding.flaw, Flaw::Foreign);
                EXPECT_TRUE(fs::exists(folder_ / "two" / finding.path)) << finding.path;
            }
        }
}

TEST_F(Verify, OfAFolderWithoutABakeFindsNothingWhole) {
    EXPECT_FALSE(verify(folder_).is_whole());
    EXPECT_THROW(verify(folder_ / "nowhere"), files::FileError);
    write(folder_ / "file", "x");
    EXPECT_THROW(verify(folder_ / "file"), files::FileError);
    std::atomic<bool> cancel{true};
    bake_into(folder_, every_output(MeshFormat::Usdc));
    EXPECT_THROW(verify(folder_, {.progress = {}, .cancel = &cancel}), BuildCancelled);
}

// A bake that was stopped when it had written what the whole shot has, and not yet its record.
TEST_F(Verify, ABakeThatWasStoppedBeforeItsRecordIsInterruptedAndNotForeign) {
    bake_into(folder_, every_output(MeshFormat::Usdc));
    fs::remove(folder_ / "sea.json");
    const auto flaws = [&] {
        std::set<Flaw> all;
        for (const Finding& finding : verify(folder_).findings) all.insert(finding.flaw);
        return all;
    };
    EXPECT_EQ(flaws(), std::set{Flaw::Foreign}) << "files of frames come after the record";
    for (const fs::path folder : {"mesh", "maps", "tiles"})
        for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / folder))
            if (entry.path().stem().has_extension() && entry.path().stem().extension().string()[1] == '0')
                fs::remove(entry.path());
    fs::remove_all(folder_ / "tiles");
    EXPECT_EQ(flaws(), std::set{Flaw::Interrupted});
    EXPECT_FALSE(verify(folder_).is_whole());
    // What somebody else made isn't a bake of ours.
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write(folder_ / "sea.usda", "#usda 1.0\n");
    EXPECT_EQ(flaws(), std::set{Flaw::Foreign});
}

// Notes of one's own beside a bake aren't a damaged record, unless files lie there that need one.
TEST_F(Verify, AJsonFileOfSomebodyElseIsForeign) {
    bake_into(folder_, every_output(MeshFormat::Usdc));
    for (const char* text : {"{\"a\": 1}", "", "notes"}) {
        write(folder_ / "notes.json", text);
        const Verification found = verify(folder_);
        EXPECT_EQ(found.shots, 1);
        ASSERT_EQ(found.findings.size(), 1u) << text;
        EXPECT_EQ(found.findings[0].path, "notes.json");
        EXPECT_EQ(found.findings[0].flaw, Flaw::Foreign);
    }
    fs::remove(folder_ / "notes.json");
    write(folder_ / "sea.json", "{}");
    EXPECT_EQ(verify(folder_).findings.at(0).flaw, Flaw::Damaged);
}

// What is no regular file is never waited for.
TEST_F(Verify, PipesAndFoldersInTheWayAreSaid) {
    const Scene scene = every_output(MeshFormat::Usdc);
    bake_into(folder_, scene);
    for (const bool pipe : {true, false}) {
        for (const char* path : {"mesh/sea.0002.usdc", "maps/sea.normal.0001.exr", "sea.usda", "sea.json"}) {
            const fs::path kept = folder_ / "kept";
            fs::rename(folder_ / path, kept);
            if (pipe) {
                ASSERT_EQ(mkfifo((folder_ / path).c_str(), 0600), 0);
            }
            if (!pipe) fs::create_directory(folder_ / path);
            const std::vector<Finding> found = verify(folder_).findings;
            const bool named = std::any_of(found.begin(), found.end(), [&](const Finding& finding) {
                return finding.path == path && finding.flaw == Flaw::Damaged &&
                       finding.what == (pipe ? "is a pipe, not a file" : "is a folder, not a file");
            });
            EXPECT_TRUE(named) << path;
            if (std::string(path) == "sea.json") {
                try {
                    bake_into(folder_, scene);
                    ADD_FAILURE() << "a record that can't be read";
                } catch (const files::FileError& error) {
                    EXPECT_NE(std::string(error.what()).find(pipe ? "is a pipe, not a file" : "is a folder"),
                              std::string::npos)
                        << error.what();
                }
                EXPECT_TRUE(pipe ? fs::is_fifo(folder_ / path) : fs::is_directory(folder_ / path))
                    << "untouched";
            }
            fs::remove(folder_ / path);
            fs::rename(kept, folder_ / path);
        }
    }
    EXPECT_TRUE(verify(folder_).is_whole());
}

// Nothing in the record's place takes long, fills the memory or ends a bake: its frames are baked again, and it is
// said.
TEST_F(Verify, WhateverIsInTheRecordsPlaceIsSaidAndBakedOver) {
    Scene scene = every_output(MeshFormat::Usdc);
    scene.output.maps.clear();
    scene.output.cascade_tiles = false;
    bake_into(folder_, scene);
    const std::string record = bytes_of(folder_ / "sea.json");
    const auto replaced = [&](const std::string& what, const std::string& with) {
        std::string text = record;
        return text.replace(text.find(what), what.size(), with);
    };
    const std::string deep(1 << 20, '[');
    for (const auto& [name, content] : std::map<std::string, std::string>{
             {"empty", ""},
             {"words", "no record\n"},
             {"another JSON", "{\"a\": [1, 2]}"},
             {"a list", "[1, 2, 3]"},
             {"deep", deep},
             {"deep inside", replaced("\"fps\": 24.0", "\"fps\": " + deep)},
             {"not UTF-8", replaced("\"name\": \"sea\"", "\"name\": \"s\xff\xfe\"")},
             {"a long number", replaced("\"fps\": 24.0", "\"fps\": " + std::string(1 << 20, '9'))},
             {"an older version's", replaced("\"checksum\"", "\"check_sum\"")}}) {
        SCOPED_TRACE(name);
        write(folder_ / "sea.json", content);
        const std::vector<std::string> named = flaws();
        EXPECT_EQ(std::count(named.begin(), named.end(), "damaged sea.json"), 1)
            << ::testing::PrintToString(named);
        const RunReport report = bake_into(folder_, scene);
        EXPECT_FALSE(report.damaged.empty());
        EXPECT_EQ(bytes_of(folder_ / "sea.json"), record);
    }
    // A hole of a terabyte, which no program should read.
    fs::resize_file(folder_ / "sea.json", 0);
    if (truncate((folder_ / "sea.json").c_str(), off_t{1} << 40) == 0) {
        const auto start = std::chrono::steady_clock::now();
        EXPECT_FALSE(verify(folder_).is_whole());
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
        bake_into(folder_, scene);
        EXPECT_EQ(bytes_of(folder_ / "sea.json"), record);
    }
}

// --trust-times looks at size and time alone: cheaper, and only as good as these.
TEST_F(Verify, TimesAreTrustedWhenToldTo) {
    const Scene scene = every_output(MeshFormat::Usdc);
    bake_into(folder_, scene);
    const Files whole = files_in(folder_);
    const fs::path file = folder_ / "mesh/sea.0002.usdc";
    const fs::file_time_type before = fs::last_write_time(file);
    write(file, flipped(bytes_of(file), 1000, 1));
    fs::last_write_time(file, before);
    EXPECT_EQ(bake_into(folder_, scene, {}, true).kept, 3) << "as recorded, by size and time";
    fs::last_write_time(file, fs::last_write_time(folder_ / "sea.json") + std::chrono::seconds(1));
    const RunReport report = bake_into(folder_, scene, {}, true);
    EXPECT_EQ(report.kept, 2);
    EXPECT_EQ(report.damaged,
              std::vector<std::string>{"mesh/sea.0002.usdc was written later than the record"});
    EXPECT_TRUE(files_in(folder_) == whole);
    fs::resize_file(file, 2000);
    fs::remove(folder_ / "maps/sea.normal.0003.exr");
    EXPECT_EQ(bake_into(folder_, scene, {}, true).kept, 1);
    EXPECT_TRUE(files_in(folder_) == whole);
}

}  // namespace
