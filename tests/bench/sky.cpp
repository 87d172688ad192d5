// A sky's picture: how long make_sky() takes, against OpenEXR's own reading of all of the file by as many threads,
// and how much memory. In turn, least of the repeats.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfThreading.h>
#include <half.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <thread>
#include <vector>

#include "plugin/light/light.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr int kRows = 256;  // at a time

using Rows = std::vector<std::array<half, 3>>;

// A frame buffer for kRows rows from this one on.
Imf::FrameBuffer buffer_of(Rows& rows, int first_row, int width) {
    Imf::FrameBuffer buffer;
    const std::array names{"R", "G", "B"};
    for (std::size_t c = 0; c < names.size(); ++c)
        buffer.insert(names[c], Imf::Slice::Make(Imf::HALF, rows.data()->data() + c, Imath::V2i(0, first_row),
                                                 width, kRows, sizeof(rows[0]), sizeof(rows[0]) * width));
    return buffer;
}

// A sky with a sun and some noise, as pictures have: noise is what makes files hard to pack.
void write_picture(const std::filesystem::path& path, int width) {
    Imf::Header header(width, width / 2);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
    Imf::OutputFile file(path.c_str(), header);
    Rows rows(static_cast<std::size_t>(width) * kRows);
    for (int first = 0; first < width / 2; first += kRows) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::size_t pixel = static_cast<std::size_t>(first) * width + i;
            const int row = static_cast<int>(pixel / width), column = static_cast<int>(pixel % width);
            const float noise = static_cast<float>(pixel * 2654435761u % 1024u) / 16384.0f;
            const float height = 1.0f - 2.0f * static_cast<float>(row) / static_cast<float>(width);
            const bool is_sun =
                std::abs(row - width / 8) < width / 1024 && std::abs(column - width / 4) < width / 1024;
            for (std::size_t c = 0; c < 3; ++c)
                rows[i][c] = is_sun ? 50000.0f : height * (0.5f + 0.25f * static_cast<float>(c)) + noise;
        }
        file.setFrameBuffer(buffer_of(rows, first, width));
        file.writePixels(kRows);
    }
}

void read_all(const std::filesystem::path& path, int width) {
    Imf::InputFile file(path.c_str());
    Rows rows(static_cast<std::size_t>(width) * kRows);
    for (int first = 0; first < width / 2; first += kRows) {
        file.setFrameBuffer(buffer_of(rows, first, width));
        file.readPixels(first, first + kRows - 1);
    }
}

void row(const std::filesystem::path& path, int width) {
    write_picture(path, width);
    Scene scene;
    scene.light.sky = path.string();
    std::vector<Timed> timed{{"sky", [&] { make_sky(scene); }},
                             {"content", [&] { sky_content(scene); }},
                             {"read", [&] { read_all(path, width); }}};
    interleave(timed, 3);
    std::printf("  %5d x %-5d %8.0f %10.1f %10.1f %10.1f %8.2f %8.0f\n", width, width / 2,
                static_cast<double>(std::filesystem::file_size(path)) / (1 << 20), timed[0].least(),
                timed[1].least(), timed[2].least(), timed[0].least() / timed[2].least(), peak_mib());
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
    const std::filesystem::path path = std::filesystem::temp_directory_path() / "pelagic-bench-sky.exr";
    std::printf(
        "The sky of a picture (half, ZIP), ms, least of the repeats; MiB: the most so far\n"
        "  %-13s %8s %10s %10s %10s %8s %8s\n",
        "", "file MiB", "make_sky", "its hash", "plain read", "ratio", "peak MiB");
    for (const int width : {2048, 4096, 8192, 16384}) pelagic::bench::row(path, width);
    std::filesystem::remove(path);
    return 0;
}
