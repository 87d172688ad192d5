#include "plugin/format/vdb/vdb.h"

#include <malloc.h>
#include <sys/mman.h>

#include <latch>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "plugin/files/module.h"
#include "plugin/format/vdb/openvdb_writer.h"

namespace pelagic::vdb {
namespace {

// That loading OpenVDB has room, and threads. Where it has too little, under a limit of addresses, data or processes (ulimit -v, -d,
// -u), the loader doesn't fail but ends the process, or never returns: OpenVDB's log starts threads then, whose failure nobody handles.
void require_room() {
    constexpr std::size_t kAddresses = std::size_t{112}
                                       << 20;             // found 69 MiB, and 92 with four stacks of 8 MiB
    constexpr std::size_t kData = std::size_t{40} << 20;  // of them; found 9 and 33
    void* const data =
        ::mmap(nullptr, kData, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    void* const rest =
        ::mmap(nullptr, kAddresses - kData, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    const bool has_room = data != MAP_FAILED && rest != MAP_FAILED;
    if (data != MAP_FAILED) ::munmap(data, kData);
    if (rest != MAP_FAILED) ::munmap(rest, kAddresses - kData);
    if (!has_room) throw std::bad_alloc();
    constexpr std::size_t kThreads = 4;
    std::latch are_there(1);
    std::vector<std::jthread> threads;
    try {
        for (std::size_t i = 0; i < kThreads; ++i) threads.emplace_back([&] { are_there.wait(); });
    } catch (...) {
        are_there.count_down();
        throw;
    }
    are_there.count_down();
}

// For as long as the process lives: OpenVDB's threads can't be taken away.
const OpenVdbWriter& writer() {
    static const OpenVdbWriter& loaded = []() -> const OpenVdbWriter& {
        require_room();
        return *reinterpret_cast<decltype(&pelagic_openvdb_writer)>(files::load(
            {.file = PELAGIC_OPENVDB_WRITER,
             .symbol = "pelagic_openvdb_writer",
             .what = "OpenVDB",
             .needs = "volumes need that file of Pelagic's, and the OpenVDB that it was built with"}))();
    }();
    return loaded;
}

// "8-4-4-4-12", as a file's identifier is written.
std::string identifier_of(const std::string& fingerprint) {
    constexpr std::size_t kDigits = 16;
    if (fingerprint.size() != kDigits ||
        fingerprint.find_first_not_of("0123456789abcdef") != std::string::npos)
        throw std::invalid_argument("a fingerprint has sixteen hexadecimal digits");
    return "00000000-0000-0000-" + fingerprint.substr(0, 4) + '-' + fingerprint.substr(4);
}

}  // namespace

struct Grid::Impl {
    std::unique_ptr<GridWriter> writer;
};

void load() {
    writer();
}

Grid::Grid(const GridOptions& options) : impl_(std::make_unique<Impl>(writer().make_grid(options))) {}
// A grid is made of many small pieces, on all threads: their heaps would keep them, each as many as its busiest frame had.
Grid::~Grid() {
    if (!impl_) return;
    impl_.reset();
    ::malloc_trim(0);
}
Grid::Grid(Grid&&) noexcept = default;
Grid& Grid::operator=(Grid&&) noexcept = default;

void Grid::add(const Block<float>& block) {
    impl_->writer->add(block);
}
void Grid::add(const Block<glm::vec3>& block) {
    impl_->writer->add(block);
}
std::string encode(std::span<const Grid> grids, const std::vector<Attribute>& attributes,
                   const std::string& fingerprint) {
    const std::string identifier = identifier_of(fingerprint);
    std::vector<const GridWriter*> writers;
    for (const Grid& grid : grids) writers.push_back(grid.impl_->writer.get());
    return writer().encode(writers, attributes, identifier);
}

}  // namespace pelagic::vdb
