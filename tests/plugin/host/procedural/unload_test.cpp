// The library loaded while a program runs, and let go again: hosts do so between scenes.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>

#include "pelagic/procedural.h"

namespace {

constexpr const char* kShot =
    "[waves]\ncascades = [ { size_m = 60.0, resolution = 64 } ]\n[camera]\nresolution = [64, 36]\n";

std::size_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::size_t size = 0, resident = 0;
    statm >> size >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::ptrdiff_t running_threads() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
}

// Executable pieces of files in this process.
std::size_t libraries() {
    std::ifstream maps("/proc/self/maps");
    std::size_t count = 0;
    for (std::string line; std::getline(maps, line);)
        count += line.find(" r-xp ") != std::string::npos && line.find(".so") != std::string::npos;
    return count;
}

class Library {
  public:
    Library() : handle_(dlopen(PELAGIC_LIBRARY, RTLD_NOW | RTLD_LOCAL)) {
        if (!handle_) throw std::runtime_error(dlerror());
    }
    ~Library() { dlclose(handle_); }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

    template <class Function>
    Function* function(const char* name) const {
        return reinterpret_cast<Function*>(dlsym(handle_, name));
    }

  private:
    void* handle_;
};

// What a host does with a scene. Returns the bytes of its frame.
std::size_t round_of(int threads, pelagic_frame** left_open = nullptr) {
    const Library library;
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = kShot;
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.threads = threads;
    pelagic_sea* sea = nullptr;
    pelagic_frame* frame = nullptr;
    pelagic_error error;
    EXPECT_EQ(library.function<decltype(pelagic_open)>("pelagic_open")(&source, &options, &sea, &error),
              PELAGIC_OK)
        << error.message;
    EXPECT_EQ(library.function<decltype(pelagic_frame_create)>("pelagic_frame_create")(sea, 1.0, 1.02, &frame,
                                                                                       &error),
              PELAGIC_OK)
        << error.message;
    pelagic_info info = PELAGIC_INIT(pelagic_info);
    EXPECT_EQ(library.function<decltype(pelagic_get_info)>("pelagic_get_info")(sea, &info, &error),
              PELAGIC_OK);
    if (left_open)
        *left_open = frame;
    else
        library.function<decltype(pelagic_frame_release)>("pelagic_frame_release")(frame);
    library.function<decltype(pelagic_close)>("pelagic_close")(sea);
    return info.frame_bytes;
}

// 100 rounds, of which the first few fill what is kept: FFTW's plans, and the memory that each thread keeps for its next request.
// A round that left its frame behind would add 90 of them.
class UnloadRounds : public testing::TestWithParam<int> {};
TEST_P(UnloadRounds, LeavesNothingBehind) {
    std::size_t frame_bytes = 0;
    for (int round = 0; round < 10; ++round) frame_bytes = round_of(GetParam());
    const std::size_t bytes = resident_bytes(), held = libraries();
    const std::ptrdiff_t running = running_threads();
    for (int round = 0; round < 90; ++round) round_of(GetParam());
    RecordProperty("frame_kib", static_cast<int>(frame_bytes / 1024));
    RecordProperty("grown_kib", static_cast<int>(resident_bytes() / 1024) - static_cast<int>(bytes / 1024));
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they keep what is freed
    EXPECT_LT(resident_bytes(), bytes + 10 * frame_bytes);
#endif
    // TBB has a thread for each processor at most, and starts it when there is work.
    EXPECT_LE(running_threads(), std::max<std::ptrdiff_t>(running, std::thread::hardware_concurrency() + 1));
    EXPECT_EQ(libraries(), held);
}
INSTANTIATE_TEST_SUITE_P(Threads, UnloadRounds, testing::Values(1, 2, 8));

// A host may forget a frame, and its own threads may still be in TBB.
TEST(Unload, AFrameThatIsOpenGoesOn) {
    pelagic_frame* frame = nullptr;
    round_of(2, &frame);
    const Library again;
    pelagic_error error;
    EXPECT_EQ(again.function<decltype(pelagic_frame_set)>("pelagic_frame_set")(frame, 2.0, 2.02, &error),
              PELAGIC_OK)
        << error.message;
    again.function<decltype(pelagic_frame_release)>("pelagic_frame_release")(frame);
}

// A host's own TBB is the same library: let go by one, it is still the other's.
TEST(Unload, TheHostsTbbStays) {
    void* const host = dlopen("libtbb.so.12", RTLD_NOW | RTLD_GLOBAL);
    ASSERT_NE(host, nullptr) << dlerror();
    for (int round = 0; round < 3; ++round) round_of(2);
    EXPECT_EQ(dlclose(host), 0);
    for (int round = 0; round < 3; ++round) round_of(2);
}

}  // namespace
