// A shot shared out among tasks, without a queue: what `pelagic farm` writes, what its tasks leave, and what it says of them; and
// the words for programs. On a real Slurm: tests/farm.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Farm : public ::testing::Test {
  protected:
    void SetUp() override { write_file(folder() / "small.toml", text_of({.frames = 12})); }
    const fs::path& folder() const { return folder_.path(); }
    // Of bash, in which $P is the program.
    Ended shell(const std::string& line) const {
        return run({.arguments = {"-c", "P='" PELAGIC_PROGRAM "'; " + line},
                    .folder = folder(),
                    .program = "/bin/bash"});
    }
    // Its events.
    std::vector<Json> told(const std::string& line, int status = 0) const {
        const Ended ended = shell(line);
        EXPECT_EQ(ended.status, status) << ended.err;
        std::vector<Json> events;
        std::istringstream lines(ended.out);
        for (std::string text; std::getline(lines, text);) {
            events.push_back(Json::parse(text, nullptr, false));
            EXPECT_TRUE(events.back().is_object()) << text;
        }
        EXPECT_FALSE(events.empty());
        if (events.empty()) return {Json::object()};
        EXPECT_EQ(events.back().value("event", ""), "end");
        EXPECT_EQ(events.back().value("status", -1), status);
        return events;
    }
    // The event "result", of which there is one.
    Json result(const std::string& line, int status = 0) const {
        Json found;
        for (const Json& event : told(line, status))
            if (event.value("event", "") == "result") {
                EXPECT_TRUE(found.is_null()) << line;
                found = event;
            }
        EXPECT_FALSE(found.is_null()) << line;
        return found;
    }
    std::string without_farm(const std::string& a, const std::string& b) const {
        fs::remove_all(folder() / a / "farm");
        return differences(folder() / a, folder() / b);
    }

  private:
    TempFolder folder_;
};

TEST_F(Farm, ItsTasksLeaveWhatOneBakeLeaves) {
    const std::string out = "a shot's 100% \\\"folder\\\"";
    ASSERT_EQ(shell("$P farm --sbatch=--partition=night --sbatch=--nice small.toml --out \"" + out +
                    "\" --tasks 3 --frames 1-12")
                  .status,
              0);
    const Ended tasks = shell("for n in 2 0 1; do bash \"" + out + "\"/farm/small.bake.sh $n || exit; done");
    EXPECT_EQ(tasks.status, 0) << tasks.err;
    EXPECT_EQ(shell("$P bake small.toml --out whole").status, 0);
    const std::string name = "a shot's 100% \"folder\"";
    const std::string script = files_below(folder() / name).at("farm/small.bake.sh");
    for (const char* part : {"#SBATCH --array=0-2\n", "#SBATCH --requeue\n", "#SBATCH --partition=night\n",
                             "#SBATCH --nice\n", "\n    5-8\n", "#SBATCH --mem=", "#SBATCH --cpus-per-task=",
                             "/a shot's 100%% \\\"folder\\\"/farm/small.bake.%a.slurm\"\n"})
        EXPECT_TRUE(has(script, part)) << part << script;
    for (const char* log : {"farm/small.bake.0001-0004.log", "farm/small.bake.0009-0012.log"})
        EXPECT_TRUE(has(files_below(folder() / name).at(log), "with status 0")) << log;
    EXPECT_EQ(without_farm(name, "whole"), "");
}

TEST_F(Farm, TasksTakeMinutesAndWhatThePlanCounts) {
    write_file(folder() / "long.toml", text_of({.name = "long", .frames = 1000, .quads = 512}));
    for (const double minutes : {0.1, 0.5, 1000.0}) {
        const Json job = result("$P farm long.toml --out out --json --minutes " + std::to_string(minutes));
        // Half as much again for encoding and writing.
        const double seconds = 1000 * 1.5 * job.at("frame").at("seconds_a_frame").get<double>();
        EXPECT_EQ(static_cast<double>(job.at("tasks").size()), std::ceil(seconds / (60.0 * minutes)))
            << seconds;
        EXPECT_EQ(job.at("threads"), 1);
        EXPECT_GT(job.at("task_memory_bytes"), job.at("frame").at("memory_bytes"));
    }
    write_file(
        folder() / "large.toml",
        "[waves]\ncascades = [ { size_m = 150.0, resolution = 8192 }, { size_m = 5.0, resolution = 8192 } ]\n"
        "[surface]\nresolution = 8192\nsize_m = 5\n[output]\nmaps = [\"displacement\"]\nmap_resolution = 4000\n");
    const Json large = result("$P farm large.toml --out out --json");
    const double memory = large.at("task_memory_bytes").get<double>();
    EXPECT_GT(memory, 4.0 * (1 << 30)) << "the test needs a large shot";
    EXPECT_GE(large.at("threads").get<double>(), std::floor(memory / (4.0 * (1 << 30)))) << memory;
    EXPECT_EQ(result("$P farm large.toml --out out --json --threads 7").at("threads"), 7);
    EXPECT_EQ(shell("$P farm small.toml --out out --tasks 1001").status, 2);
    EXPECT_EQ(result("$P farm small.toml --out out --json --tasks 1000").at("tasks").size(), 12u)
        << "a frame each";
}

TEST_F(Farm, StatusSaysWhatIsWholeRunningFailedAndMissing) {
    const Json job = result("$P farm small.toml --out out --tasks 4 --json");
    EXPECT_EQ(job.at("tasks").size(), 4u);
    EXPECT_GT(job.at("frame").at("seconds_a_frame").get<double>(), 0.0);
    EXPECT_GT(job.at("frame").at("bytes_a_frame").get<double>(), 0.0);
    EXPECT_EQ(result("$P farm --status out --json", 3).at("missing"), "1-12");
    ASSERT_EQ(shell("bash out/farm/small.bake.sh 0").status, 0);
    // One that fails, one that is at work, and one that was killed with its shell.
    fs::create_directories(folder() / "out/mesh/small.0005.usda");
    EXPECT_EQ(shell("bash out/farm/small.bake.sh 1").status, 2);
    const std::string log = "log=out/farm/small.bake.0007-0009.log; host=$(hostname -s); ";
    const auto status = [&](const std::string& words, int end = 3) {
        return result(words + "$P farm --status out --json", end);
    };
    const Json found = status(log + "echo \"pelagic farm: begun $host-$$" + "_2 on $host, now\" > $log; ");
    EXPECT_EQ(found.at("whole"), "1-4");
    EXPECT_EQ(found.at("missing"), "10-12");
    ASSERT_EQ(found.at("running").size(), 1u) << found;
    EXPECT_EQ(found.at("running")[0].at("frames"), "7-9");
    ASSERT_EQ(found.at("failed").size(), 1u) << found;
    EXPECT_EQ(found.at("failed")[0].at("frames"), "5-6");
    EXPECT_EQ(found.at("failed")[0].at("status"), 2);
    EXPECT_TRUE(has(found.at("failed")[0].at("message"), "small.0005.usda")) << found;
    const Json lost = status(log + "echo \"pelagic farm: begun $host-2147483646_2 on $host, now\" > $log; ");
    EXPECT_EQ(lost.at("failed").size(), 2u) << lost;
    EXPECT_EQ(lost.at("running").size(), 0u) << lost;
    const Ended words = shell("$P farm --status out");
    for (const char* part : {"small, bake: 4 of 12 frames whole, in 4 tasks\n", "whole: 1-4\n",
                             "\n  5-6: ", "missing, not begun: 10-12\n"})
        EXPECT_TRUE(has(words.out, part)) << part << words.out;
    fs::remove(folder() / "out/mesh/small.0005.usda");
    ASSERT_EQ(shell("for n in 1 2 3; do bash out/farm/small.bake.sh $n || exit; done").status, 0);
    EXPECT_EQ(status("", 0).at("whole"), "1-12");
}

TEST_F(Farm, ABudgetIsSettledOnceForAllTasks) {
    write_file(folder() / "budget.toml", text_of({.frames = 4}) + "[quality]\nmax_error = 0.3\n");
    EXPECT_EQ(shell("$P bake budget.toml --out out --frames 2").status, 2) << "a part alone is refused";
    ASSERT_EQ(shell("$P farm budget.toml --out out --tasks 2").status, 0);
    EXPECT_TRUE(
        has(files_below(folder() / "out").at("farm/small.bake.sh"), "--chosen='quality.max_error = 0.3: "));
    const Ended tasks =
        shell("for n in 1 0; do bash out/farm/small.bake.sh $n || exit; done; cat out/farm/*.log >&2");
    ASSERT_EQ(tasks.status, 0) << tasks.err;
    ASSERT_EQ(shell("$P bake budget.toml --out whole").status, 0);
    EXPECT_EQ(without_farm("out", "whole"), "");
}

TEST_F(Farm, PicturesToo) {
    ASSERT_EQ(
        shell(
            "$P farm small.toml --out out --tasks 2 --verb render --size 32x18 --samples 1 --overscan 10% --region=-2,0,20,19 --layers none --frames 1-4")
            .status,
        0);
    EXPECT_EQ(result("$P farm --status out --json", 3).at("missing"), "1-4");
    ASSERT_EQ(shell("for n in 0 1; do bash out/farm/small.render.0001-0004.sh $n || exit; done").status, 0);
    EXPECT_EQ(result("$P farm --status out --json").at("whole"), "1-4");
    ASSERT_EQ(
        shell(
            "$P render small.toml --out whole --size 32x18 --samples 1 --overscan 10% --region=-2,0,20,19 --layers none --frames 1-4")
            .status,
        0);
    EXPECT_EQ(shell("bash out/farm/small.render.0001-0004.verify.sh").status, 0);
    ASSERT_EQ(shell("mkdir kept; mv out/small.0003.* kept").status, 0);
    EXPECT_EQ(shell("bash out/farm/small.render.0001-0004.verify.sh").status, 3)
        << "pictures nobody but the job misses";
    ASSERT_EQ(shell("mv kept/* out").status, 0);
    EXPECT_EQ(without_farm("out", "whole"), "");
}

TEST_F(Farm, APartOfAShotIsJudgedByItself) {
    ASSERT_EQ(shell("$P farm small.toml --out out --frames 3-4 --tasks 2").status, 0);
    const auto check = [&] { return shell("bash out/farm/small.bake.0003-0004.verify.sh").status; };
    EXPECT_EQ(shell("bash out/farm/small.bake.0003-0004.sh 0").status, 0);
    EXPECT_EQ(check(), 3) << "frame 4 isn't made";
    EXPECT_EQ(shell("bash out/farm/small.bake.0003-0004.sh 1").status, 0);
    EXPECT_EQ(check(), 0);
    ASSERT_EQ(shell("echo >> out/mesh/small.0003.usda").status, 0);
    EXPECT_EQ(check(), 3) << "damage";
}

// Each has scripts of its own, and is judged by them.
TEST_F(Farm, PartsAndShotsDontTouchEachOther) {
    write_file(folder() / "other.toml", text_of({.name = "other", .frames = 3}));
    ASSERT_EQ(
        shell("$P farm small.toml --out out --frames 1-2 && $P farm small.toml --out out --frames 5,9-11 && "
              "$P farm other.toml --out out")
            .status,
        0);
    EXPECT_EQ(shell("bash out/farm/small.bake.0005-0011.????????.sh 0").status, 0);
    const Ended check = shell("bash out/farm/small.bake.0005-0011.????????.verify.sh");
    EXPECT_EQ(check.status, 0) << check.out << check.err;
    EXPECT_TRUE(has(check.out, "whole: 5, 9-11\n")) << check.out;
    EXPECT_EQ(shell("bash out/farm/small.bake.0001-0002.verify.sh").status, 3);
    EXPECT_EQ(shell("bash out/farm/other.bake.verify.sh").status, 3);
    EXPECT_EQ(shell("bash out/farm/other.bake.sh 0; bash out/farm/other.bake.verify.sh").status, 0);
    EXPECT_EQ(shell("$P farm --status out").status, 3) << "all jobs of the folder";
    EXPECT_EQ(result("$P farm --status out/farm/other.bake.json --json").at("whole"), "1-3");
}

// What lies there under the frames' names may be another version's.
TEST_F(Farm, FramesOfAnotherVersionArentWhole) {
    const std::string windy = text_of({.frames = 12}) + "[sea]\nwind_speed_mps = 9.5\n";
    for (const std::string verb : {"bake", "render --size 32x18 --samples 1 --layers none"}) {
        const std::string name = verb.substr(0, verb.find(' '));
        const std::string farm = "$P farm small.toml --out " + name + " --tasks 3 --verb " + verb;
        const auto script = [&](int task) {
            return "bash " + name + "/farm/small." + name + ".sh " + std::to_string(task);
        };
        const auto status = [&](int end) { return result("$P farm --status " + name + " --json", end); };
        write_file(folder() / "small.toml", text_of({.frames = 12}));
        ASSERT_EQ(shell(farm + " && " + script(0) + " && " + script(1) + " && " + script(2)).status, 0);
        EXPECT_EQ(status(0).at("whole"), "1-12");
        write_file(folder() / "small.toml", text_of({.frames = 12}) + "nonsense = 3\n");
        EXPECT_EQ(shell(script(1)).status, 2);
        const Json refused = status(3);
        ASSERT_EQ(refused.at("failed").size(), 1u) << refused;
        EXPECT_EQ(refused.at("failed")[0].at("frames"), "5-8");
        EXPECT_TRUE(has(refused.at("failed")[0].at("message"), "nonsense")) << refused;
        EXPECT_TRUE(has(shell("$P farm --status " + name).out, "; the same again gives the same: mend that"))
            << name;
        write_file(folder() / "small.toml", windy);
        ASSERT_EQ(shell(farm).status, 0);
        EXPECT_EQ(status(3).at("whole"), "") << name;
        ASSERT_EQ(shell(script(2)).status, 0);
        EXPECT_EQ(status(3).at("whole"), "9-12") << name;
        EXPECT_EQ(shell("bash " + name + "/farm/small." + name + ".verify.sh").status, 3) << name;
        ASSERT_EQ(shell(script(0) + " && " + script(1)).status, 0);
        EXPECT_EQ(status(0).at("whole"), "1-12") << name;
        EXPECT_EQ(shell("bash " + name + "/farm/small." + name + ".verify.sh").status, 0) << name;
    }
}

// One that is still at the version before stops, whether it makes frames, gets ready for them or is told to stop, and leaves the record to the new
// one.
TEST_F(Farm, ATaskOfAnOlderVersionStops) {
    const std::string shot = text_of({.name = "long", .frames = 4000});
    for (const auto& [until, signals, status] : {std::tuple("ls out/mesh/long.0003.*", "-CONT", 75),
                                                 {"grep -q planning said", "-CONT", 75},
                                                 {"ls out/mesh/long.0003.*", "-TERM $!; kill -CONT", 143}}) {
        write_file(folder() / "long.toml", shot);
        const Ended ended = shell(
            "rm -rf out; $P bake long.toml --out out --json > said 2> heard & until " + std::string(until) +
            "; do sleep 0.02; done; kill -STOP $!; echo '[sea]' >> long.toml; "
            "echo 'wind_speed_mps = 9.5' >> long.toml; $P bake long.toml --out out --frames 1-20 || exit 9; "
            "cp out/long.json record; kill " +
            signals + " $!; wait $!");
        EXPECT_TRUE(ended.status == 75 || ended.status == status)
            << ended.status << ' ' << until << signals << ended.err;
        const auto files = files_below(folder());
        EXPECT_EQ(has(files.at("heard"), "another run has begun another version of long"), ended.status == 75)
            << files.at("heard");
        EXPECT_EQ(files.at("record"), files.at("out/long.json")) << until << signals;
        EXPECT_EQ(
            shell(
                "$P bake long.toml --out out --frames 1-20 && rm -rf whole && $P bake long.toml --out whole --frames 1-20")
                .status,
            0);
        for (const auto& [path, content] : files_below(folder() / "whole"))
            if (path != "long.json") {  // that of a part is alike where nothing lies beside it
                EXPECT_TRUE(files_below(folder() / "out").at(path) == content) << path;
            }
    }
}

// Of two jobs that make a frame of two versions the one that was shared out last counts, and what was said before of its tasks doesn't.
TEST_F(Farm, WhatWasSharedOutLastCounts) {
    ASSERT_EQ(
        shell(
            "$P farm small.toml --out out --frames 1-2 && $P farm small.toml --out out --frames 7-8 && "
            "$P farm small.toml --out out && bash out/farm/small.bake.sh 0 && cp out/farm/small.bake.sh old.sh")
            .status,
        0);
    EXPECT_EQ(shell("$P farm --status out").status, 0);
    write_file(folder() / "small.toml", text_of({.frames = 12}) + "[sea]\nwind_speed_mps = 9.5\n");
    ASSERT_EQ(shell("$P farm small.toml --out out --frames 1-6").status, 0);
    const Ended of_both = shell("$P farm --status out");
    EXPECT_EQ(of_both.status, 3);
    for (const char* part :
         {"bake: 6 of 6 frames whole", "bake: 2 of 2 frames whole", "bake: 0 of 6 frames whole"})
        EXPECT_TRUE(has(of_both.out, part)) << part << of_both.out;
    EXPECT_FALSE(has(of_both.out, "of 2 frames whole, in 1 task\nfailed")) << of_both.out;
    ASSERT_EQ(shell("$P farm small.toml --out out").status, 0);
    const auto whole = [&] { return result("$P farm --status out/farm/small.bake.json --json", 3); };
    EXPECT_EQ(whole().at("missing"), "1-12") << whole();
    const Ended part = shell("$P farm --status out/farm/small.bake.0007-0008.json");
    EXPECT_EQ(part.status, 3);
    EXPECT_TRUE(has(part.out, "superseded")) << part.out;
    ASSERT_EQ(shell("$P farm small.toml --out out --tasks 2 && $P farm small.toml --out out").status, 0);
    const Ended old = shell("bash old.sh 0");
    EXPECT_EQ(old.status, 2);
    EXPECT_TRUE(has(old.err, "shared out anew")) << old.err;
    fs::create_directories(folder() / "bin");
    // A task of the former array is at work, and told to stop after that.
    const fs::path log = folder() / "out/farm/small.bake.0001-0012.log";
    write_file(log, "pelagic farm: begun 12_0 on node1, now\npelagic farm: shared out anew\n");
    EXPECT_EQ(whole().at("running").size(), 1u) << whole();
    write_file(log, read_file(log) + "pelagic: stopping\npelagic farm: ended 12_0 with status 143, now\n");
    EXPECT_EQ(whole().at("missing"), "1-12") << whole();
    // One was lost, and the next one failed.
    write_file(
        log,
        "pelagic farm: begun 11_0 on node1, now\npelagic farm: begun 12_0 on node2, now\npelagic: a reason\n"
        "pelagic farm: ended 12_0 with status 2, now\n");
    write_file(folder() / "bin/squeue", "#!/bin/bash\n");
    EXPECT_EQ(
        result("chmod +x bin/squeue; PATH=$PWD/bin:$PATH $P farm --status out/farm/small.bake.json --json", 3)
            .at("failed")
            .at(0)
            .at("message"),
        "pelagic: a reason");
    fs::remove(folder() / "out/farm/small.bake.json");
    EXPECT_EQ(shell("bash out/farm/small.bake.sh 0").status, 75) << "nobody knows whether it is wanted";
}

TEST_F(Farm, DeepPicturesAreMissed) {
    const std::string options = " --verb render --size 32x18 --samples 1 --layers none --alpha";
    ASSERT_EQ(shell("sed -i 's/1, 12/1, 2/' small.toml; $P farm small.toml --out out" + options +
                    " && bash out/farm/small.render.sh 0 && $P farm --status out")
                  .status,
              0);
    ASSERT_EQ(shell("$P farm small.toml --out out --deep" + options).status, 0);
    EXPECT_EQ(result("$P farm --status out --json", 3).at("missing"), "1-2");
    EXPECT_EQ(shell("bash out/farm/small.render.sh 0 && $P farm --status out").status, 0);
}

TEST_F(Farm, StatusSaysWhyATaskFailedOrWaits) {
    ASSERT_EQ(shell("$P farm small.toml --out out --tasks 2").status, 0);
    write_file(folder() / "small.toml", text_of({.frames = 6}));
    EXPECT_EQ(shell("bash out/farm/small.bake.sh 1").status, 2);
    const std::string message = result("$P farm --status out --json", 3).at("failed").at(0).at("message");
    EXPECT_TRUE(has(message, "outside the shot")) << message;
    // Slurm's own requeue after a preemption, without a word of the task's; then progress and a note, and it was lost.
    fs::create_directories(folder() / "bin");
    const auto status = [&](const std::string& log, const std::string& listed) {
        write_file(folder() / "out/farm/small.bake.0001-0006.log",
                   "pelagic farm: begun 12_0 on node1, now\n" + log);
        write_file(folder() / "bin/squeue", "#!/bin/bash\necho '" + listed + "'\n");
        return result("chmod +x bin/squeue; PATH=$PWD/bin:$PATH $P farm --status out --json", 3);
    };
    const std::string stopped = "pelagic farm: ended 12_0 with status 143, now\n";
    const Json waits = status(stopped, "12_0 PENDING");
    ASSERT_EQ(waits.at("running").size(), 1u) << waits;
    EXPECT_EQ(waits.at("running")[0].at("message"), "stopped by signal 15");
    EXPECT_EQ(status(stopped, "").at("failed").size(), 2u);
    const Json again = status("the foam's past: 2 %\nsmall.toml: note: the spray takes 0.28 % of the light\n",
                              "12_0 PENDING");
    EXPECT_EQ(again.at("running").at(0).at("message"), "") << again;
}

TEST_F(Farm, RefusesWhatNoTaskCanDo) {
    const Ended memory = shell("$P farm small.toml --out out --max-memory 1M");
    EXPECT_EQ(memory.status, 2);
    EXPECT_TRUE(has(memory.err, "a task needs about ")) << memory.err;
    EXPECT_EQ(shell("$P farm small.toml --out out --max-memory 1M --verb render").status, 2);
    ASSERT_EQ(
        shell(
            "(cat small.toml; echo '[water]'; echo 'chlorophyll_mg_m3 = { keys = [[1, 0.1], [12, 1.0]] }') > keyed.toml")
            .status,
        0);
    EXPECT_EQ(shell("$P farm keyed.toml --out out").status, 2) << "as bake";
    EXPECT_FALSE(fs::exists(folder() / "out"));
    const Ended nowhere = shell("$P farm --status nowhere");
    EXPECT_EQ(nowhere.status, 2);
    EXPECT_TRUE(has(nowhere.err, "cannot read the folder 'nowhere': No such file or directory"))
        << nowhere.err;
    EXPECT_TRUE(has(shell("$P farm --status .").err, "has written no job into this folder"));
    ASSERT_EQ(
        shell(
            "$P farm small.toml --out out --tasks 3 --sbatch=--array=0-2%2 '--sbatch=--comment=night shift'")
            .status,
        0);
    const auto files = files_below(folder() / "out");
    for (const char* line : {"#SBATCH --array=0-2%2\n", "#SBATCH --comment=\"night shift\"\n"})
        EXPECT_TRUE(has(files.at("farm/small.bake.sh"), line)) << line;
    EXPECT_FALSE(has(files.at("farm/small.bake.verify.sh"), "--array"));
    fs::rename(folder() / "out", folder() / "moved");
    const Ended moved = shell("bash moved/farm/small.bake.sh 0");
    EXPECT_EQ(moved.status, 75);
    EXPECT_TRUE(has(moved.err, "share the shot out again")) << moved.err;
}

// What a task needs of the place where the command was given: nothing.
TEST_F(Farm, TasksRunWithoutTheSubmittersFolder) {
    ASSERT_EQ(shell("mkdir here && cd here && $P farm ../small.toml --out ../out --tasks 2").status, 0);
    fs::remove_all(folder() / "here");
    EXPECT_EQ(shell("bash out/farm/small.bake.sh 1").status, 0);
    for (const char* number : {"", "x", "-1", "2", "1x", "99999999999999999999"}) {
        const Ended ended = shell(std::string("bash out/farm/small.bake.sh ") + number);
        EXPECT_EQ(ended.status, 2) << number;
        EXPECT_TRUE(has(ended.err, "accepted: the number of a task, 0 to 1\n")) << ended.err;
    }
    EXPECT_EQ(shell("$P farm small.toml --out 'a\\b'").status, 2) << "Slurm would strip the \\";
    ASSERT_EQ(shell("$P farm small.toml --out out --sbatch=--time=7").status, 0);
    const std::string script = files_below(folder() / "out").at("farm/small.bake.sh");
    EXPECT_GT(script.find("#SBATCH --time=7\n"), script.find("#SBATCH --time=60\n"))
        << "the last one counts" << script;
}

TEST_F(Farm, ATaskHandsASignalOn) {
    write_file(folder() / "long.toml", text_of({.name = "long", .frames = 2000}));
    ASSERT_EQ(shell("$P farm long.toml --out out --tasks 1").status, 0);
    const Ended ended = shell(
        "bash out/farm/long.bake.sh 0 & for i in {1..600}; do ls out/mesh/long.0003.* && break; sleep 0.1; done; "
        "kill -TERM $!; wait $!");
    EXPECT_EQ(ended.status, 143) << ended.err;
    const std::string log = files_below(folder() / "out").at("farm/long.bake.0001-2000.log");
    for (const char* part : {"pelagic: stopping after the current file", "with status 143"})
        EXPECT_TRUE(has(log, part)) << part << log;
    EXPECT_FALSE(has(log, "stopped at once")) << log;
}

TEST_F(Farm, SubmitsWithWhateverSbatchSays) {
    fs::create_directories(folder() / "bin");
    const auto submit = [&](const std::string& sbatch, const char* more = "") {
        write_file(folder() / "bin/sbatch", "#!/bin/bash\n" + sbatch + '\n');
        return shell("chmod +x bin/sbatch; PATH=$PWD/bin:$PATH $P farm small.toml --out out --submit " +
                     std::string(more));
    };
    const Ended noted = submit(
        "echo \"sbatch: a note; $(touch '1;2')\" >&2; echo 'Welcome'; echo '17;night'; echo \"$*\" >> said");
    EXPECT_EQ(noted.status, 0) << noted.err;
    EXPECT_TRUE(has(noted.out, "submitted: array 17\nsubmitted: verify 17, after it\n")) << noted.out;
    EXPECT_TRUE(has(files_below(folder()).at("said"), "--dependency=afterany:17 ")) << "the number alone";
    const Ended refused = submit("echo 'no such partition' >&2; exit 1");
    EXPECT_EQ(refused.status, 75);
    EXPECT_TRUE(has(refused.err, "sbatch refuses ")) << refused.err;
    for (const char* wrong : {"thread", "unavailable"}) EXPECT_FALSE(has(refused.err, wrong)) << refused.err;
    const Ended half = submit("[[ $* != *afterany* ]] && echo 17");
    EXPECT_EQ(half.status, 75);
    EXPECT_TRUE(has(half.out, "submitted: array 17\n")) << "it runs";
    const Ended odd = submit("echo '17; rm -r out'; echo '$(touch odd)'");
    EXPECT_EQ(odd.status, 1);
    EXPECT_TRUE(has(odd.err, "sbatch gives no number of a job: ")) << odd.err;
    EXPECT_FALSE(fs::exists(folder() / "odd"));
}

TEST_F(Farm, WhatSqueueListsIsntLost) {
    ASSERT_EQ(shell("$P farm small.toml --out out --tasks 4").status, 0);
    fs::create_directories(folder() / "bin");
    write_file(folder() / "out/farm/small.bake.0001-0003.log", "pelagic farm: begun 12_0 on node1, now\n");
    const auto status = [&](const std::string& listed) {
        write_file(folder() / "bin/squeue", "#!/bin/bash\necho '" + listed + "'\n");
        return result("chmod +x bin/squeue; PATH=$PWD/bin:$PATH $P farm --status out --json", 3);
    };
    for (const char* state : {"RUNNING", "SUSPENDED", "CONFIGURING", "STOPPED"})
        EXPECT_EQ(status(std::string("12_0 ") + state).at("running").size(), 1u) << state;
    EXPECT_EQ(status("12_1 RUNNING").at("failed").size(), 1u);
}

// Whatever is measured today: it takes long, and another machine may find that the settings err by more.
TEST_F(Farm, WhatWasChosenIsntMeasuredAgain) {
    write_file(folder() / "budget.toml", text_of({.frames = 4}) + "[quality]\nmax_error = 0.001\n");
    const Ended render = shell(
        "$P render budget.toml --out out --size 32x18 --layers none --frames 2 --chosen='quality.max_error = 0.001: "
        "quality.level = \"final\", surface.cell_px = 2, 1 × 1 samples a pixel and nine lookups of the sky'");
    EXPECT_EQ(render.status, 0) << render.err;
    EXPECT_FALSE(has(render.err, "measuring")) << render.err;
    EXPECT_FALSE(has(render.err, "today")) << render.err;
    const Ended none = shell("$P bake small.toml --out x --chosen=nothing");
    EXPECT_EQ(none.status, 2);
    EXPECT_TRUE(has(none.err, "--chosen is of a budget, and the shot has none")) << none.err;
}

// As where the two tasks that end last miss each other's, on a file system that shows new files late.
TEST_F(Farm, VerifyTakesWhatLiesBesideTheRecordOfAWholeShotIntoIt) {
    ASSERT_EQ(
        shell("$P bake small.toml --out whole && $P bake small.toml --out out --frames 1-7 && "
              "$P bake small.toml --out other --frames 8-12 && cp -rn other/* out && mkdir out/record && "
              "cp other/small.json out/record/small.8-12.5.0123456789abcdef.json")
            .status,
        0);
    ASSERT_NE(differences(folder() / "out", folder() / "whole"), "");
    fs::rename(folder() / "out/mesh/small.0003.usda", folder() / "kept");
    EXPECT_EQ(shell("$P verify out").status, 3);
    EXPECT_TRUE(fs::exists(folder() / "out/record")) << "what isn't whole stays as it is";
    fs::rename(folder() / "kept", folder() / "out/mesh/small.0003.usda");
    EXPECT_EQ(shell("exec 9<out; flock 9; timeout --foreground --preserve-status -k 10 3 $P verify out 9<&-")
                  .status,
              143)
        << "who waits for the folder's lock can be stopped";
    EXPECT_EQ(result("$P verify out --json").at("merged"), Json({"small.json"}));
    EXPECT_EQ(differences(folder() / "out", folder() / "whole"), "");
    EXPECT_EQ(result("$P verify out --json").at("merged"), Json::array());
}

TEST_F(Farm, ProgramsReadWhatIsSaid) {
    const std::vector<Json> baked = told("$P bake small.toml --out out --json");
    int most = 0;
    for (const Json& event : baked)
        if (event.at("event") == "progress" && event.at("stage") == "frames") {
            EXPECT_GE(event.at("done").get<int>(), most);
            most = event.at("done");
        }
    EXPECT_EQ(most, 12);
    EXPECT_EQ(baked.at(baked.size() - 2).value("verb", ""), "bake");
    // Pictures tell the same keys, of which none goes back.
    double share = 0.0;
    most = 0;
    for (const Json& event :
         told("$P render small.toml --out pictures --size 128x72 --samples 2 --frames 1-3 --json"))
        if (event.at("event") == "progress" && event.at("stage") == "frames") {
            EXPECT_GE(event.at("done").get<int>(), most) << event;
            EXPECT_GE(event.at("share").get<double>(), share) << event;
            most = event.at("done");
            share = event.at("share");
        }
    EXPECT_EQ(most, 3);
    EXPECT_EQ(share, 1.0);
    const Json explained = result("$P explain small.toml --json");
    for (const char* of : {"bake", "pictures"})
        for (const char* key : {"seconds_a_frame", "bytes_a_frame", "memory_bytes"})
            EXPECT_GT(explained.at(of).at(key).get<double>(), 0.0) << of << key;
    fs::remove(folder() / "out/mesh/small.0002.usda");
    const Json verified = result("$P verify out --json", 3);
    ASSERT_EQ(verified.at("findings").size(), 1u);
    EXPECT_EQ(verified.at("findings")[0].at("path"), "mesh/small.0002.usda");
    EXPECT_EQ(verified.at("findings")[0].at("flaw"), "missing");
    EXPECT_FALSE(told("$P verify out --json", 3).back().contains("error"))
        << "nothing was wrong with the check";
    write_file(folder() / "wrong.toml", "[sea]\nwind_speed_mps = -1\n");
    for (const char* line : {"$P bake wrong.toml --json", "$P explain wrong.toml --json"})
        EXPECT_TRUE(has(told(line, 2).back().at("error"), "wrong.toml:2:18: ")) << line;
    EXPECT_TRUE(has(told("$P bake small.toml --json --frame 3", 2).back().at("error"), "--frame"));
    EXPECT_TRUE(
        has(told("$P bake small.toml --out full --max-memory 1K --json", 2).back().at("error"), "memory"));
    EXPECT_EQ(shell("$P bake small.toml --out out --json > /dev/full").status, 75);
}

}  // namespace
}  // namespace pelagic::test
