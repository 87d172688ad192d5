// Random scenes: whatever a shot file asks is baked and pictured to finite, bounded numbers, the same bits on one thread and
// on two, or it is refused by name. A scene that fails is shrunk to the simplest that still does, and printed.
//
//   PELAGIC_SCENES=10000 test_random_scenes    so many, instead of 20
//   PELAGIC_SEED=500 test_random_scenes        from the scene of this seed on, instead of 0
//   PELAGIC_SCENE=123 test_random_scenes       the scene of this seed alone

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/random/judged_scene.h"
#include "tests/random/random_scene.h"
#include "tests/random/shrunk_scene.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

constexpr int kBatches = 2, kScenes = 20;  // each day; at night more, and others

std::optional<long> number_of_environment(const char* name) {
    const char* value = std::getenv(name);
    return value ? std::optional<long>(std::atol(value)) : std::nullopt;
}

// In memory where there is such a folder: each file of a bake waits for the disk.
fs::path scratch_folder() {
    const fs::path memory = "/dev/shm";
    const bool has_memory = ::access(memory.c_str(), W_OK) == 0;
    return (has_memory ? memory : fs::temp_directory_path()) / ("pelagic-scenes-" + std::to_string(getpid()));
}

std::string report_of(const RandomScene& scene) {
    std::string report = "PELAGIC_SCENE=" + std::to_string(scene.seed) + '\n' + scene.text();
    for (const auto& [name, bytes] : scene.files)
        if (!name.ends_with(".exr")) report += "---- " + name + '\n' + bytes;
    return report;
}

// A crash, or a scene that doesn't end, can't be shrunk, but says which scene it was.
std::string running;
void say_and_die(int signal) {
    if (::write(STDERR_FILENO, running.data(), running.size()) < 0) std::_Exit(1);
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

class RandomScenes : public ::testing::TestWithParam<int> {
  protected:
    void SetUp() override {
        for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM})
            std::signal(signal, say_and_die);
    }
    void TearDown() override {
        ::alarm(0);
        for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM})
            std::signal(signal, SIG_DFL);
    }

    Judgement judged(const RandomScene& scene, const fs::path& folder) const {
        constexpr unsigned kEndless_s = 300;
        running = "\nThis scene doesn't end well:\n" + report_of(scene);
        fs::remove_all(folder);
        ::alarm(kEndless_s);
        return judge(scene.write(folder), scene.seed);
    }

    void report(const RandomScene& scene, const Judgement& judgement, const fs::path& folder) const {
        const fs::path other = folder.string() + "-simpler";
        const RandomScene simplest = shrunk(scene, [&](const RandomScene& simpler) {
            return judged(simpler, other).failure == judgement.failure;
        });
        fs::remove_all(other);
        const Judgement again = judged(simplest, folder);
        ADD_FAILURE() << again.detail << "\n"
                      << report_of(simplest) << "The files are in " << folder << ", those of all of it:\n"
                      << scene.text();
    }
};

TEST_P(RandomScenes, AreMadeWholeOrRefused) {
    const std::optional<long> one = number_of_environment("PELAGIC_SCENE");
    const long count = number_of_environment("PELAGIC_SCENES").value_or(kScenes);
    const long first = number_of_environment("PELAGIC_SEED").value_or(0);
    std::vector<std::uint64_t> seeds;
    for (long i = count * GetParam() / kBatches; !one && i < count * (GetParam() + 1) / kBatches; ++i)
        seeds.push_back(static_cast<std::uint64_t>(first + i));
    if (one && GetParam() == 0) seeds.push_back(static_cast<std::uint64_t>(*one));
    if (seeds.empty()) GTEST_SKIP() << "none of its scenes is asked for";

    int whole = 0, pictured = 0, failed = 0;
    for (const std::uint64_t seed : seeds) {
        const RandomScene scene = random_scene(seed);
        const fs::path folder = scratch_folder() / "scene";  // the same for all, so that a sky is as well
        const Judgement judgement = judged(scene, folder);
        whole += judgement.refusal.empty();
        pictured += judgement.is_pictured;
        if (judgement.failure.empty()) {
            fs::remove_all(folder);
            continue;
        }
        fs::remove_all(folder);
        report(scene, judgement, scratch_folder() / std::to_string(seed));
        constexpr int kEnough = 3;
        if (++failed == kEnough) return;
    }
    if (failed == 0 && fs::is_empty(scratch_folder())) fs::remove(scratch_folder());
    if (one) return;
    const auto all = static_cast<int>(seeds.size());
    EXPECT_GE(whole, all / 2) << "so many refusals test nothing";
    EXPECT_GE(pictured, all / 3) << "so many cameras under water test nothing";
}

// Side by side under ctest.
INSTANTIATE_TEST_SUITE_P(Batch, RandomScenes, ::testing::Range(0, kBatches));

}  // namespace
}  // namespace pelagic::test
