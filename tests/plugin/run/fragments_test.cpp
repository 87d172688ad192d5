// Runs of parts of a shot in one folder: what each has recorded is there whatever the others do, and the record that they leave is
// the one that one run leaves.
#include "plugin/run/fragments.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "plugin/bake/bake.h"
#include "plugin/run/record.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

class Fragments : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-fragments-" + std::to_string(getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path record() const { return folder_ / "sea.json"; }

    // Of a shot of so many frames; wind: another version.
    static std::unique_ptr<Record> begun(int frames, double wind_mps = 10.0) {
        Scene scene;
        scene.shot.first_frame = 1;
        scene.shot.last_frame = frames;
        scene.surface.resolution = 16;
        scene.sea.wind_speed_mps = wind_mps;
        auto made = std::make_unique<Record>();
        made->describe(plan_bake(scene), SpectralMoments{}, 0.0, 0.0);
        return made;
    }
    static FrameRecord frame_record(int frame, const std::string& of = "a") {
        FrameRecord made;
        made.fingerprint = of + std::to_string(frame);
        made.instruction_set = "any";
        made.time_s = frame / 24.0;
        for (const char* part : {"mesh/sea.", "maps/sea.normal.", "maps/sea.displacement."})
            made.files[part + std::to_string(frame)] = {
                .bytes = 1000, .checksum = "0123456789abcdef", .fingerprint = made.fingerprint};
        return made;
    }
    // What is recorded: fingerprints by frame; of stale ones with a mark.
    std::map<int, std::string> recorded() const {
        std::map<int, std::string> found;
        const RecordsReading reading = read_records(record(), [&](int number, const FrameRecord& frame) {
            EXPECT_TRUE(found.empty() || found.rbegin()->first < number);
            found[number] = (frame.is_stale ? "stale " : "") + frame.fingerprint;
        });
        EXPECT_TRUE(reading.damaged.empty());
        return found;
    }
    std::string text() const {
        std::ifstream stream(record(), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    // As one run leaves it.
    std::string text_of_one(int frames) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        const auto one = begun(frames);
        one->begin(record(), {}, {}, true);
        for (int frame = 1; frame <= frames; ++frame) one->set(frame, frame_record(frame));
        one->finish(record());
        const std::string left = text();
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        return left;
    }

    fs::path folder_;
};

// Steps of four runs one between another's, in many orders: more than locks would let them, or their lack.
TEST_F(Fragments, OfRunsInAnyOrderNothingIsLostAndOneRecordIsLeft) {
    constexpr int kFrames = 12, kRuns = 4, kOfARun = kFrames / kRuns;
    const std::string expected = text_of_one(kFrames);
    for (unsigned seed = 0; seed < 15; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 draw(seed);
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        std::vector<std::unique_ptr<Record>> runs;
        for (int run = 0; run < kRuns; ++run) runs.push_back(begun(kFrames));
        std::vector<int> steps;  // by run: begin, a frame and a save each, finish
        for (int run = 0; run < kRuns; ++run) steps.insert(steps.end(), kOfARun + 2, run);
        if (seed > 0) std::shuffle(steps.begin(), steps.end(), draw);
        std::vector<int> at(kRuns, 0);
        std::set<int> set;
        for (const int run : steps) {
            const int step = at[static_cast<std::size_t>(run)]++;
            Record& record_of_run = *runs[static_cast<std::size_t>(run)];
            if (step == 0) {
                record_of_run.begin(record(), {}, {}, true);
            } else if (step <= kOfARun) {
                const int frame = run * kOfARun + step;
                record_of_run.set(frame, frame_record(frame));
                record_of_run.save(record());
                set.insert(frame);
            } else {
                record_of_run.finish(record());
            }
            const auto found = recorded();
            ASSERT_EQ(found.size(), set.size());
            for (const int frame : set) ASSERT_EQ(found.at(frame), "a" + std::to_string(frame));
        }
        EXPECT_EQ(text(), expected);
        EXPECT_FALSE(fs::exists(folder_ / "record"));
    }
}

// A killed run leaves its fragment; the run that makes the rest of the shot finds it, and takes it in.
TEST_F(Fragments, OfAKilledRunAreReadAndTakenIn) {
    const std::string expected = text_of_one(6);
    {
        const auto killed = begun(6);
        killed->begin(record(), {}, {}, true);
        for (const int frame : {2, 5}) killed->set(frame, frame_record(frame));
        killed->save(record());
    }
    EXPECT_EQ(recorded().size(), 2u);
    const auto rest = begun(6);
    rest->begin(record(), {}, {}, true);
    for (const int frame : {1, 3, 4, 6}) rest->set(frame, frame_record(frame));
    rest->finish(record());
    EXPECT_EQ(text(), expected);
    EXPECT_FALSE(fs::exists(folder_ / "record"));
}

// One that was killed before its first frame has said that it is at work, and no more.
// Of a frame that two runs have made the last one's entry counts, whatever their files are called, for few frames and for all.
TEST_F(Fragments, TheLastOneCounts) {
    for (int round = 0; round < 8; ++round) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        std::vector<std::unique_ptr<Record>> runs;  // killed, all of them
        for (const char* of : {"a", "b", "c"}) {
            runs.push_back(begun(3));
            runs.back()->begin(record(), {}, {}, true);
            runs.back()->set(1, frame_record(1, of));
            runs.back()->save(record());
            std::this_thread::sleep_for(
                std::chrono::milliseconds(10));  // file systems tell times apart by 4 ms
        }
        std::set<int> numbers;
        std::string few;
        read_some(
            record(), std::array{1},
            [&](int number, const FrameRecord& frame) {
                if (number == 1) few = frame.fingerprint;
            },
            numbers);
        EXPECT_EQ(few, "c1");
        EXPECT_EQ(recorded().at(1), "c1");
    }
}

TEST_F(Fragments, OfARunThatMadeNothingAreGoneOnceTheShotIsWhole) {
    const std::string expected = text_of_one(3);
    begun(3)->begin(record(), {}, {}, true);
    const auto whole = begun(3);
    whole->begin(record(), {}, {}, true);
    for (const int frame : {1, 2, 3}) whole->set(frame, frame_record(frame));
    whole->finish(record());
    begun(3)->begin(record(), {}, {}, true);
    EXPECT_EQ(fragments_of(record()).size(), 1u);
    const auto next = begun(3);
    next->begin(record());
    next->finish(record());
    EXPECT_EQ(text(), expected);
    EXPECT_FALSE(fs::exists(folder_ / "record"));
}

// What a run of another version of the shot has left isn't this one's, with a plan and without.
TEST_F(Fragments, OfAnotherVersionAreStale) {
    const std::string expected = text_of_one(4);
    const auto before = begun(4, 7.0);
    before->begin(record(), {}, {}, true);
    for (const int frame : {1, 2, 3}) before->set(frame, frame_record(frame, "b"));
    before->save(record());
    const auto now = begun(4);
    now->mark_stale([](int, const FrameRecord& frame) { return frame.fingerprint.starts_with("b"); });
    now->begin(record(), {}, {}, true);
    EXPECT_EQ(recorded(), (std::map<int, std::string>{{1, "stale b1"}, {2, "stale b2"}, {3, "stale b3"}}));
    now->set(2, frame_record(2));
    now->save(record());
    // The other one goes on, in vain.
    before->set(4, frame_record(4, "b"));
    before->save(record());
    EXPECT_EQ(recorded(),
              (std::map<int, std::string>{{1, "stale b1"}, {2, "a2"}, {3, "stale b3"}, {4, "stale b4"}}));
    for (const int frame : {1, 3, 4}) now->set(frame, frame_record(frame));
    now->finish(record());
    EXPECT_EQ(text(), expected);
}

TEST_F(Fragments, ThatWereAlteredAreNamedAndCountForNothing) {
    const auto run = begun(4);
    run->begin(record(), {}, {}, true);
    run->set(3, frame_record(3));
    run->save(record());
    const auto fragments = fragments_of(record());
    ASSERT_EQ(fragments.size(), 1u);
    EXPECT_EQ(std::tuple(fragments[0].first, fragments[0].last, fragments[0].frames), std::tuple(3, 3, 1));
    std::ifstream stream(fragments[0].file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    const std::size_t at = bytes.find("\"a3\"");
    ASSERT_NE(at, std::string::npos);
    bytes[at + 1] = 'c';
    std::ofstream(fragments[0].file, std::ios::binary) << bytes;
    int found = 0;
    const RecordsReading reading = read_records(record(), [&](int, const FrameRecord&) { ++found; });
    EXPECT_EQ(found, 0);
    ASSERT_EQ(reading.damaged.size(), 1u);
    EXPECT_TRUE(reading.damaged[0].starts_with("record/sea.3-3.1.")) << reading.damaged[0];
    EXPECT_TRUE(reading.damaged[0].ends_with("was altered in what it says about the frames 3"));
}

// A long record isn't written anew for a few frames, nor read through for them.
TEST_F(Fragments, OfALongRecordWaitUntilItIsWhole) {
    constexpr int kFrames = 600;
    const std::string expected = text_of_one(kFrames);
    const auto first = begun(kFrames);
    first->begin(record(), {}, {}, true);
    for (int frame = 1; frame <= kFrames - 2; ++frame) first->set(frame, frame_record(frame));
    first->finish(record());
    const std::string long_record = text();
    ASSERT_GT(long_record.size(), kSmallRecord);
    const auto one_frame = [&](int frame) {
        const auto run = begun(kFrames);
        run->begin(record(), {}, {}, true);
        run->set(frame, frame_record(frame));
        run->finish(record());
    };
    one_frame(7);  // made again: it is there
    EXPECT_EQ(text(), long_record);
    EXPECT_FALSE(fs::exists(folder_ / "record"));
    one_frame(kFrames);
    EXPECT_EQ(text(), long_record);
    EXPECT_EQ(recorded().size(), kFrames - 1u);

    std::map<int, std::string> some;
    std::set<int> numbers;
    const std::vector<int> asked{1, 300, kFrames - 1, kFrames};
    const RecordsReading reading = read_some(
        record(), asked, [&](int number, const FrameRecord& frame) { some[number] = frame.fingerprint; },
        numbers);
    EXPECT_TRUE(reading.problem.empty() && reading.shot) << reading.problem;
    EXPECT_EQ(some, (std::map<int, std::string>{{1, "a1"}, {300, "a300"}, {kFrames, "a600"}}));
    EXPECT_EQ(numbers.size(), kFrames - 1u);
    EXPECT_FALSE(numbers.contains(kFrames - 1));

    one_frame(kFrames - 1);  // the last one
    EXPECT_EQ(text(), expected);
    EXPECT_FALSE(fs::exists(folder_ / "record"));

    // Where nobody asks for frames, none is read; a record whose end is missing is damaged all the same.
    const RecordReading head = read_frames(
        record(), {}, [](int, const FrameRecord&) { ADD_FAILURE(); }, nullptr);
    EXPECT_EQ(head.version, read_record(record(), [](int, const FrameRecord&) {}).version);
    EXPECT_TRUE(head.problem.empty() && head.shot) << head.problem;
    fs::resize_file(record(), fs::file_size(record()) - 2);  // its last brace
    EXPECT_FALSE(read_frames(
                     record(), {}, [](int, const FrameRecord&) {}, nullptr)
                     .problem.empty());
}

// A task of few frames doesn't write a long record anew for what is broken in its middle; what it lost is made again, as by a run of the
// whole shot, and then it is whole.
TEST_F(Fragments, OfALongRecordThatIsBrokenWaitUntilItIsWhole) {
    constexpr int kFrames = 600, kBroken = 300;
    const std::string expected = text_of_one(kFrames);
    const auto make = [&](int from, int to) {
        const auto run = begun(kFrames);
        run->begin(record(), {}, {}, true);
        for (int frame = from; frame <= to; ++frame) run->set(frame, frame_record(frame));
        run->finish(record());
    };
    make(1, kFrames - 1);
    std::string broken = text();
    ASSERT_GT(broken.size(), kSmallRecord);
    const std::string key = "\"" + std::to_string(kBroken) + "\": {";
    ASSERT_NE(broken.find(key), std::string::npos);
    broken[broken.find(key) + key.size() - 1] = '[';
    std::ofstream(record(), std::ios::binary) << broken;
    make(kFrames, kFrames);
    EXPECT_EQ(text(), broken);

    const auto some = [&](int frame) {
        std::map<int, std::string> found;
        std::set<int> numbers;
        const std::vector<int> asked{frame};
        const RecordsReading reading = read_some(
            record(), asked, [&](int number, const FrameRecord& entry) { found[number] = entry.fingerprint; },
            numbers);
        EXPECT_FALSE(reading.problem.empty());
        return found;
    };
    EXPECT_TRUE(some(kBroken - 1).contains(kBroken - 1));
    EXPECT_FALSE(some(kBroken).contains(kBroken));
    EXPECT_TRUE(some(kFrames).contains(kFrames));

    make(kBroken, kFrames - 1);
    EXPECT_EQ(text(), expected);
    EXPECT_FALSE(fs::exists(folder_ / "record"));
}

}  // namespace
}  // namespace pelagic
