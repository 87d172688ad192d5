// What is kept of a machine's speed, and what a budget of time does with it. How fast this one is matters to none of these.
#include "plugin/budget/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "plugin/budget/budget.h"
#include "tests/plugin/host/cli/program.h"

namespace pelagic::test {
namespace {

Calibration slower(double times) {
    Calibration machine = as_recorded();
    machine.times.fill(times);
    return machine;
}

TEST(Calibration, IsKeptForThisMachine) {
    const TempFolder folder;
    const std::filesystem::path file = keep(slower(3.0), folder.path() / "cache");
    ASSERT_TRUE(std::filesystem::exists(file)) << file;
    EXPECT_EQ(calibration(folder.path() / "cache").times, slower(3.0).times);
}

// Measured, and kept beside it: several machines share a folder.
TEST(Calibration, OfAnotherMachineIsMeasuredAnew) {
    const TempFolder folder;
    Calibration other = slower(3.0);
    other.cpu = "another";
    const std::filesystem::path file = keep(other, folder.path());
    const Calibration measured = calibration(folder.path());
    EXPECT_EQ(measured.cpu, as_recorded().cpu);
    for (const double times : measured.times) EXPECT_TRUE(times > 0.0 && std::isfinite(times)) << times;
    EXPECT_TRUE(has(read_file(file), "another"));
    EXPECT_EQ(kept_calibration(folder.path())->times, measured.times);
}

// A damaged file in a place that can't be written: what was measured is remembered.
TEST(Calibration, NeedsNoFile) {
    const TempFolder folder;
    const std::filesystem::path file = keep(slower(3.0), folder.path());
    std::filesystem::remove(file);
    std::filesystem::create_directory(file);
    std::ofstream(file / "inside") << "kept";
    const Calibration measured = calibration(folder.path());
    EXPECT_NE(measured.times, slower(3.0).times);
    EXPECT_EQ(calibration(folder.path()).times, measured.times);
    EXPECT_TRUE(std::filesystem::exists(file / "inside"));
    EXPECT_TRUE(keep(measured, {}).empty());
    for (const char* text : {"", "{", "[]", "{\"times\": 1}", "{\"times\": {\"transforms\": -1}}"}) {
        const TempFolder damaged;
        std::ofstream(damaged.path() / file.filename()) << text;
        EXPECT_FALSE(kept_calibration(damaged.path())) << text;
    }
}

// On a machine of half the speed, twice the time buys the same.
TEST(Calibration, DecidesWhatATimeBuys) {
    for (const Purpose purpose : {Purpose::Mesh, Purpose::Pictures}) {
        Scene scene;
        scene.camera.resolution = {160, 90};
        scene.quality.frame_ms = purpose == Purpose::Mesh ? 3.0 : 300.0;
        const Settled fast = settle(scene, purpose, with_rates(slower(1.0).rates()));
        EXPECT_NE(settle(scene, purpose, with_rates(slower(3.0).rates())).settings, fast.settings);
        *scene.quality.frame_ms *= 2.0;
        EXPECT_EQ(settle(scene, purpose, with_rates(slower(2.0).rates())).settings, fast.settings);
    }
}

}  // namespace
}  // namespace pelagic::test
