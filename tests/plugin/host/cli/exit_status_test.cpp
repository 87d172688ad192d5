// Exit statuses, by cause: what scripts and farms rely on. Those of signals, full disks and lacking memory are also looked at where
// these are tested.
#include <gtest/gtest.h>

#include <string>

#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

TEST(ExitStatus, IsThatOfItsCause) {
    const TempFolder folder;
    write_file(folder.path() / "small.toml", text_of({.frames = 3}));
    write_file(folder.path() / "long.toml", text_of({.frames = 20000}));
    write_file(folder.path() / "large.toml", "[surface]\nresolution = 4096\n");
    write_file(folder.path() / "wrong.toml", "x = 1\n");
    write_file(folder.path() / "budget.toml", text_of({.frames = 3}) + "[quality]\nmax_error = 0.3\n");
    const auto shell = [&](const std::string& line) {
        return run({.arguments = {"-c", "P='" PELAGIC_PROGRAM "'; " + line},
                    .folder = folder.path(),
                    .program = "/bin/bash"});
    };
    struct Case {
        int status;
        const char* line;
    };
    const std::vector<Case> cases{
        {0, "$P --version"},
        {0, "$P validate small.toml"},
        {0, "$P bake small.toml --out out"},
        {0, "$P bake small.toml --out out --frames 1"},
        {0, "$P verify out"},
        {0, "$P farm small.toml --out farmed"},
        // The command line.
        {2, "$P"},
        {2, "$P paint"},
        {2, "$P bake"},
        {2, "$P bake small.toml --out x --frames 7"},
        {2, "$P bake small.toml --out x --threads 0"},
        {2, "$P farm --status out"},
        {2, "$P farm small.toml --out x --samples 2"},
        {2, "PATH=/nowhere $P farm small.toml --out x --submit"},
        // What it names.
        {2, "$P bake wrong.toml"},
        {2, "$P validate small.toml wrong.toml"},
        {2, "$P explain missing.toml"},
        {2, "$P bake small.toml --out small.toml"},
        {2, "$P bake budget.toml --out x --frames 2"},
        {2, "$P bake budget.toml --out x --frames 2 --chosen=nothing"},
        {2, "$P bake small.toml --out /proc/sea"},
        {2, "$P render small.toml --out /proc/sea --size 16x9 --samples 1"},
        // What it allows.
        {2, "$P bake small.toml --out x --max-memory 1K"},
        {2, "$P render small.toml --out x --max-memory 1K"},
        // What isn't whole.
        {3, "$P farm --status farmed"},
        {3, "$P verify nowhere"},
        {3, "rm out/mesh/small.0002.usda; $P verify out"},
        // What another machine, or a later day, has.
        {75, "$P keys > /dev/full"},
        {75, "ulimit -v 200000; $P bake large.toml --out y"},
        {75, "ulimit -f 1; $P bake small.toml --out y"},
        // Signals.
        {143, "$P bake long.toml --out z & sleep 0.5; kill -TERM $!; wait $!"},
        {137, "$P bake long.toml --out z & sleep 0.5; kill -KILL $!; wait $!"},
    };
    for (const Case& one : cases) {
        const Ended ended = shell(one.line);
        EXPECT_EQ(ended.status, one.status) << one.line << '\n' << ended.err;
    }
    const std::string help = shell("$P --help").out;
    for (const char* line : {"\n  0   ", "\n  1   ", "\n  2   ", "\n  3   ", "\n  75   ", "\n  128 + N  "})
        EXPECT_TRUE(has(help, line)) << line << help;
}

}  // namespace
}  // namespace pelagic::test
