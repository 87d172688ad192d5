// --instruction-set: what it accepts, and what becomes of files that another set made.
#include "core/base/instruction_set.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

class InstructionSet : public ::testing::Test {
  protected:
    void SetUp() override {
        const std::vector<std::string> sets = pelagic::instruction_sets();
        if (sets.size() < 2 || sets.front() != "sse4")
            GTEST_SKIP() << "this CPU has no SSE4, or nothing wider";
        write_file(folder_.path() / "small.toml", text_of({.frames = 2}));
    }
    Ended make(const std::string& verb, const std::string& out, const std::string& set,
               std::vector<std::string> more = {}) const {
        std::vector<std::string> arguments{verb, "small.toml", "--out", out};
        if (!set.empty()) arguments.push_back("--instruction-set=" + set);
        if (verb == "render") arguments.insert(arguments.end(), kPictures.begin(), kPictures.end());
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run({.arguments = arguments, .folder = folder_.path()});
    }
    std::string difference(const std::string& a, const std::string& b) const {
        return differences(folder_.path() / a, folder_.path() / b);
    }
    static inline const std::vector<std::string> kPictures{"--size", "32x18",         "--samples",
                                                           "1",      "--sky-quality", "one"};
    const std::string wide_ = pelagic::instruction_sets().back();

    TempFolder folder_;
};

TEST_F(InstructionSet, OthersAreRefused) {
    for (const char* set : {"", "avx", "AVX2", "avx3", "sse4,avx2", "native"}) {
        const Ended ended = run({.arguments = {"bake", "small.toml", std::string("--instruction-set=") + set},
                                 .folder = folder_.path()});
        EXPECT_EQ(ended.status, 2) << set;
        EXPECT_TRUE(has(ended.err, "--instruction-set")) << ended.err;
    }
    const Ended ended = make("bake", "a", "avx3");
    EXPECT_TRUE(has(ended.err, "accepted: sse4, avx2, avx512")) << ended.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "a"));
}

// The narrow set's files are others than the wide one's.
TEST_F(InstructionSet, IsUsedAndRecorded) {
    for (const std::string& set : {std::string(), wide_, std::string("sse4")})
        EXPECT_EQ(make("bake", "by-" + set, set).status, 0) << set;
    EXPECT_EQ(difference("by-", "by-" + wide_), "");
    EXPECT_NE(read_file(folder_.path() / "by-/mesh/small.0001.usda"),
              read_file(folder_.path() / "by-sse4/mesh/small.0001.usda"))
        << "fused products were used all the same";
    EXPECT_TRUE(has(read_file(folder_.path() / "by-sse4/small.json"), "\"instruction_set\": \"sse4\""));
}

// What a set made of a frame that lacks a file doesn't stay beside another one's.
TEST_F(InstructionSet, AFrameIsOfOneSet) {
    ASSERT_EQ(make("bake", "wide", wide_).status, 0);
    ASSERT_EQ(make("bake", "narrow", "sse4").status, 0);
    std::filesystem::remove(folder_.path() / "narrow/mesh/small.0001.usda");
    const Ended mended = make("bake", "narrow", "");
    EXPECT_TRUE(has(mended.out, "1 frame baked, 1 kept")) << mended.out;
    EXPECT_TRUE(has(mended.err, "sse4 had made the frames 2: kept")) << mended.err;
    EXPECT_EQ(make("bake", "narrow", wide_).status, 0);
    EXPECT_EQ(difference("wide", "narrow"), "");
}

#if defined(__x86_64__) && defined(__GLIBC__)
// The C library chooses its mathematics when a process starts: with fused products, unless the program is begun again without.
TEST_F(InstructionSet, BelowAvx2TheProgramIsStartedAnew) {
    if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "this CPU has no fused products";
    setenv("LD_SHOW_AUXV", "1", 1);  // the dynamic linker's: a line of AT_PHDR for each start
    const auto starts = [&](const std::string& set) {
        const Ended ended = make("bake", "started-" + set, set);
        EXPECT_EQ(ended.status, 0) << ended.err;
        int count = 0;
        for (std::size_t at = 0; (at = ended.out.find("AT_PHDR", at)) != std::string::npos; ++at) ++count;
        return count;
    };
    EXPECT_EQ(starts(wide_), 1);
    EXPECT_EQ(starts("sse4"), 2);
    unsetenv("LD_SHOW_AUXV");
}

// As the tarball's program is. The system then calls the loader the program.
TEST_F(InstructionSet, AProgramThatALoaderRunsIsStartedAnewByItsOwnName) {
    const std::filesystem::path loader = "/lib64/ld-linux-x86-64.so.2";
    if (!std::filesystem::exists(loader)) GTEST_SKIP() << "the loader has another name";
    const std::string name =
        std::filesystem::relative(PELAGIC_PROGRAM, std::filesystem::canonical(folder_.path())).string();
    const auto by_loader = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), name);
        const Ended ended = run({.arguments = arguments, .folder = folder_.path(), .program = loader});
        EXPECT_EQ(ended.status, 0) << ended.err;
    };
    ASSERT_EQ(make("bake", "itself", "sse4").status, 0);
    by_loader({"bake", "small.toml", "--out", "by-loader", "--instruction-set", "sse4"});
    EXPECT_EQ(difference("itself", "by-loader"), "");
    by_loader({"farm", "small.toml", "--out", "farmed"});
    const std::string script = read_file(folder_.path() / "farmed/farm/small.bake.sh");
    EXPECT_TRUE(has(script, "/" + name)) << "not by its whole path" << script;
    EXPECT_FALSE(has(script, "ld-linux")) << script;
}
#endif

TEST_F(InstructionSet, FilesOfAnotherAreKeptAndSaidOrMadeAgain) {
    for (const std::string& verb : {std::string("bake"), std::string("render")}) {
        SCOPED_TRACE(verb);
        ASSERT_EQ(make(verb, "whole", "sse4").status, 0);
        ASSERT_EQ(make(verb, "mixed", wide_, {"--frames", "1"}).status, 0);
        // Whole files stay, and a record knows of which set they are.
        const Ended kept = make(verb, "whole", "");
        EXPECT_EQ(kept.status, 0);
        EXPECT_TRUE(has(kept.out, "2 kept")) << kept.out;
        // A farm's status and the check at its end count what the set has made alone.
        std::vector<std::string> job{"--verb", verb, "--tasks", "2"};
        if (verb == "render")
            job.insert(job.end(), kPictures.begin(), kPictures.end());  // others aren't whole for it
        const Ended shared = make("farm", "mixed", "sse4", job);
        EXPECT_EQ(shared.status, 0) << shared.err;
        const auto in_folder = [&](std::vector<std::string> arguments) {
            return run({.arguments = std::move(arguments), .folder = folder_.path()});
        };
        EXPECT_TRUE(has(in_folder({"farm", "--status", "mixed"}).out, "0 of 2 frames whole"));
        const Ended checked = in_folder({"verify", "mixed", "--instruction-set", "sse4"});
        EXPECT_EQ(checked.status, 3);
        EXPECT_TRUE(has(checked.out, "again with --instruction-set sse4")) << checked.out;
        EXPECT_EQ(has(kept.err, "sse4 had made the frames 1-2: kept"), verb == "bake") << kept.err;
        // Whoever asks for a set gets it.
        const Ended again = make(verb, "mixed", "sse4");
        EXPECT_EQ(again.status, 0);
        EXPECT_TRUE(has(again.err, "had made the frames 1; made again by sse4")) << again.err;
        EXPECT_TRUE(has(again.out, "2 frames") || has(again.out, "2 pictures")) << again.out;
        EXPECT_TRUE(has(in_folder({"farm", "--status", "mixed"}).out, "2 of 2 frames whole"));
        EXPECT_EQ(in_folder({"verify", "mixed", "--instruction-set", "sse4"}).status, 0);
        EXPECT_TRUE(has(read_file(folder_.path() / "mixed/farm" / ("small." + verb + ".verify.sh")),
                        "farm --status"));
        std::filesystem::remove_all(folder_.path() / "mixed/farm");
        EXPECT_EQ(difference("whole", "mixed"), "");
        const Ended same = make(verb, "mixed", "sse4");
        EXPECT_TRUE(has(same.out, "2 kept")) << same.out;
        EXPECT_EQ(same.err.find("made again"), std::string::npos) << same.err;
        std::filesystem::remove_all(folder_.path() / "whole");
        std::filesystem::remove_all(folder_.path() / "mixed");
    }
}

}  // namespace
}  // namespace pelagic::test
