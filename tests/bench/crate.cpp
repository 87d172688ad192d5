// What a layer of a frame costs as a crate and as text: bytes, and the time to make it in memory and to write
// it into a file that stays in the system's cache.
//   crate [RESOLUTION…]      default 512 1024

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "plugin/format/usd/crate.h"
#include "plugin/format/usd/text.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

// A patch of 400 m with a few waves on it: every float has all its digits, as in a sea, which is what the
// length of a text hangs on.
struct Patch {
    std::vector<glm::vec3> points, normals, velocities, slope_variance;
    std::vector<float> whitecap_coverage;

    explicit Patch(int quads) {
        constexpr double kSize_m = 400.0;
        for (int j = 0; j <= quads; ++j)
            for (int i = 0; i <= quads; ++i) {
                const double x = kSize_m * i / quads, y = kSize_m * j / quads;
                const double phase = 0.11 * x + 0.05 * y + 0.3 * std::sin(0.7 * x - 0.4 * y);
                const auto c = static_cast<float>(std::cos(phase)), s = static_cast<float>(std::sin(phase));
                points.emplace_back(static_cast<float>(x) - s, static_cast<float>(y) - 0.5f * s, 1.3f * c);
                const float length = std::sqrt(1.0f + 0.03f * s * s);
                normals.emplace_back(0.14f * s / length, 0.06f * s / length, 1.0f / length);
                velocities.emplace_back(1.1f * c, 0.5f * c, 1.2f * s);
                slope_variance.emplace_back(0.011f + 0.001f * c, 0.009f + 0.001f * s, 0.0005f * c);
                whitecap_coverage.push_back(0.05f + 0.04f * c);
            }
    }
    usd::MeshSample sample() const {
        return {.fingerprint = "0123456789abcdef",
                .points = points,
                .normals = normals,
                .velocities = velocities,
                .slope_variance = slope_variance,
                .whitecap_coverage = whitecap_coverage};
    }
    std::size_t bytes() const { return points.size() * (4 * sizeof(glm::vec3) + sizeof(float)); }
};

// Writes over one temporary file, again and again.
class File {
  public:
    File() : file_(std::tmpfile(), &std::fclose) {
        if (!file_) throw std::runtime_error("cannot make a temporary file");
        std::setvbuf(file_.get(), nullptr, _IONBF, 0);  // the pieces are large already
    }
    void write(const std::function<void(const usd::Sink&)>& layer) {
        std::rewind(file_.get());
        layer([this](std::string_view part) {
            if (std::fwrite(part.data(), 1, part.size(), file_.get()) != part.size())
                throw std::runtime_error("cannot write the temporary file");
        });
    }

  private:
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

void table(int quads) {
    const Patch patch(quads);
    const usd::MeshSample sample = patch.sample();
    std::size_t text_bytes = 0, crate_bytes = 0;
    std::vector<char> copy(patch.bytes());
    File text_file, crate_file;
    std::vector<Timed> timed{
        {"text, in memory", [&] { text_bytes = usd::frame_text(sample).size(); }},
        {"crate, in memory", [&] { crate_bytes = usd::frame_crate(sample).size(); }},
        {"text, into a file",
         [&] { text_file.write([&](const usd::Sink& sink) { usd::write_frame_text(sample, sink); }); }},
        {"crate, into a file",
         [&] { crate_file.write([&](const usd::Sink& sink) { usd::write_frame_crate(sample, sink); }); }},
        {"crate, into nothing: its checks", [&] { usd::write_frame_crate(sample, [](std::string_view) {}); }},
        {"the arrays' bytes copied once",
         [&] {
             char* to = copy.data();
             const auto add = [&to](const auto& values) {
                 const std::size_t bytes = values.size() * sizeof(values[0]);
                 std::memcpy(to, values.data(), bytes);
                 to += bytes;
             };
             add(patch.points), add(patch.normals), add(patch.velocities), add(patch.slope_variance);
             add(patch.whitecap_coverage);
         }},
    };
    interleave(timed, 15);
    constexpr double kMb = 1e6;
    std::printf("\n%d^2 quads, every attribute, one thread\n", quads);
    std::printf("  text %.2f MB, crate %.2f MB, its arrays %.2f MB: crate / text %.3f\n",
                static_cast<double>(text_bytes) / kMb, static_cast<double>(crate_bytes) / kMb,
                static_cast<double>(patch.bytes()) / kMb,
                static_cast<double>(crate_bytes) / static_cast<double>(text_bytes));
    for (const Timed& t : timed) std::printf("  %-34s %9.2f ms\n", t.name.c_str(), t.median());
    std::printf("  crate / text: in memory %.4f, into a file %.4f\n", timed[1].median() / timed[0].median(),
                timed[3].median() / timed[2].median());
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    std::vector<int> resolutions;
    for (int i = 1; i < argc; ++i) resolutions.push_back(std::atoi(argv[i]));
    if (resolutions.empty()) resolutions = {512, 1024};
    std::printf("A frame's layer as a crate and as text, medians of 15 interleaved repeats\n");
    for (const int n : resolutions) pelagic::bench::table(n);
}
