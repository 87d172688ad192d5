// Random shots, from the first day on: whatever a valid-looking shot file asks, it is baked to finite,
// bounded numbers, the same bits on one thread and on two, or it is refused before anything is written.

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "core/plan/plan.h"
#include "core/scene/names.h"
#include "plugin/bake/bake.h"
#include "plugin/light/light.h"
#include "plugin/shot/shot.h"
#include "tests/plugin/bake/read_exr.h"

namespace {

using namespace pelagic;
namespace fs = std::filesystem;

class RandomShot {
  public:
    explicit RandomShot(unsigned seed) : engine_(seed) {}

    std::string text() {
        std::ostringstream shot;
        const int first = pick({1, 1, -3, 0, 100000});
        shot << "[shot]\nseed = " << pick({0, 1, 7, 123456789}) << "\nframes = [" << first << ", "
             << first + pick({0, 1}) << "]\n";
        shot << "fps = " << pick({24.0, 0.5, 60.0, 1e-3}) << "\n";
        if (chance(0.15)) shot << "loop_s = " << pick({1.0, 10.0, 0.1}) << "\n";
        shot << "[sea]\nwind_speed_mps = " << pick({0.0, 0.1, 2.0, 10.0, 20.0, 80.0, uniform(0.0, 30.0)})
             << "\n";
        shot << "wind_direction_deg = " << uniform(-360.0, 720.0) << "\n";
        shot << "fetch_m = " << pick({1.0, 100.0, 300e3, 1e7}) << "\n";
        const double depth = chance(0.5) ? pick({0.01, 0.5, 5.0, 100.0}) : 1e6;
        if (depth < 1e6) shot << "depth_m = " << depth << "\n";
        shot << "spectrum = \""
             << pick({"pierson-moskowitz", "jonswap", "jonswap-1973", "tma", "elfouhaily", "omega-2",
                      "phillips"})
             << "\"\n";
        if (chance(0.3)) shot << "short_waves = \"none\"\n";
        if (chance(0.1)) shot << "significant_height_m = 0.001\n";
        shot << "spreading = \"" << pick({"hasselmann", "donelan-banner", "cosine", "elfouhaily"}) << "\"\n";
        if (chance(0.4)) {
            // Steep swell in shallow water, but none that breaks: that is refused.
            const double period = pick({2.0, 11.0, 22.0});
            const auto height = [&](double wanted, double of_period) {
                return std::min({wanted, 0.5 * depth, 0.1 * of_period * of_period});
            };
            shot << "swell = [ { height_m = " << height(pick({0.0, 0.01, 2.0, 15.0}), period)
                 << ", period_s = " << period << ", direction_deg = " << uniform(0.0, 360.0) << " }";
            if (chance(0.3))
                shot << ", { height_m = " << height(1.0, 7.0) << ", period_s = 7.0, direction_deg = 45.0 }";
            shot << " ]\n";
        }
        shot << "[waves]\nchoppiness = " << pick({0.0, 0.5, 1.0, 1.0, 3.0, 10.0}) << "\n";
        if (chance(0.25)) {
            shot << "model = \"trochoid\"\ntrains = " << pick({1, 7, 60, 200}) << "\n";
            if (chance(0.4)) shot << "shortest_m = " << pick({0.02, 1.0, 30.0, 1000.0}) << "\n";
            if (chance(0.4)) shot << "longest_m = " << pick({0.5, 40.0, 1e4}) << "\n";
        }
        // "auto" goes as fine as somebody looks: a patch of half a metre would cost a grid of 2048² and more.
        const bool own_cascades = chance(0.6);
        if (own_cascades) {
            const double size = pick({1.0, 37.0, 400.0, 5000.0});
            shot << "cascades = [ { size_m = " << size << ", resolution = " << pick({16, 18, 30, 64, 96})
                 << " }";
            if (chance(0.5))
                shot << ", { size_m = " << size / pick({1.3, 2.618, 3.0})
                     << ", resolution = " << pick({16, 32}) << " }";
            shot << " ]\n";
        }
        const double size_m = own_cascades ? pick({0.5, 50.0, 400.0, 3e4}) : pick({200.0, 3e4});
        shot << "[surface]\nsize_m = " << size_m << "\nresolution = " << pick({1, 2, 3, 7, 8, 16}) << "\n";
        bool is_patch = false;
        if (chance(0.3)) {
            shot << "kind = \"near-far\"\nearth_curvature = " << (chance(0.5) ? "true" : "false") << "\n";
            const double x_m = pick({0.0, -3.3, 1e5, 1e9}), z_m = pick({0.0, 0.1, 4.0, -2.0, 1e3, 1e5});
            shot << "[camera]\nposition_m = [" << x_m << ", " << -x_m << ", " << z_m << "]\nlook_at_m = ["
                 << x_m << ", " << -x_m << ", " << z_m - 100.0 << "]\n";
        } else if (chance(0.2)) {
            shot << "kind = \"cage\"\ncage_file = \"cage.obj\"\ncage_level = "
                 << pick({"0", "1", "2", "\"adaptive\""}) << "\n";
            if (chance(0.5)) shot << "cell_px = 64\n";
        } else {
            is_patch = true;
        }
        const bool whitecaps = chance(0.8), spray = chance(0.6);
        shot << "[effects]\nwhitecaps = " << (whitecaps ? "true" : "false") << "\n";
        if (spray) shot << "spray = true\nspray_gain = " << pick({1.0, 0.0, 30.0, 1e6}) << "\n";
        shot << "[quality]\nlevel = \"" << pick({"draft", "preview", "final", "reference"}) << "\"\n";
        shot << "[output]\nmesh = \"" << pick({"usda", "usda", "usdc", "none"}) << "\"\nattributes = ["
             << subset({"normal", "velocity", "slope-variance", "whitecaps"}) << "]\nmaps = ["
             << (whitecaps || chance(0.1) ? subset({"displacement", "normal", "slope-variance", "whitecaps"})
                                          : subset({"displacement", "normal", "slope-variance"}))
             << "]\nmap_resolution = " << pick({1, 2, 5, 8, 16}) << "\n";
        if (own_cascades && chance(0.3)) shot << "cascade_tiles = true\n";
        // Of other surfaces it is refused.
        if (chance(is_patch ? 0.3 : 0.02)) shot << "mesh_scheme = \"catmullClark\"\n";
        if (chance(0.4))
            shot << "volumes = ["
                 << (whitecaps && spray ? subset({"spray", "level-set"}) : subset({"level-set"}))
                 << "]\nvoxel_m = " << size_m / pick({1.0, 1.7, 5.0, 20.0}) << "\n";
        return shot.str();
    }

    // A few faces of any size and slope, two of them triangles, with a crease, a corner, perhaps a hole, any rule for the
    // boundary and any texture. Rule 0 leaves the face in the middle of nine, and nothing of five.
    std::string cage() {
        std::ostringstream obj;
        const int side = pick({3, 4}), faces = (side - 1) * (side - 1);
        const double size = pick({0.0, 0.1, 10.0, 1e5}), at = pick({0.0, 0.0, 6e5});
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                obj << "v " << at + size * (x + 0.2 * uniform(-1.0, 1.0)) << ' ' << size * y << ' '
                    << pick({0.0, size * uniform(-2.0, 2.0)}) << '\n';
        const Texture texture = pick({Texture::None, Texture::OfPoints, Texture::OfFaces, Texture::OfHalves});
        const int halves = texture == Texture::OfHalves ? 2 : 1;
        const int coordinates = texture == Texture::OfFaces ? 4 * faces : halves * side * side;
        for (int i = 0; texture != Texture::None && i < coordinates; ++i)
            obj << "vt " << pick({0.0, uniform(-3.0, 3.0)}) << ' ' << uniform(0.0, 1.0) << '\n';
        for (int face = 0; face < faces; ++face) {
            const int x = face % (side - 1), first = x + face / (side - 1) * side + 1;
            const int points[] = {first, first + 1, first + 1 + side, first + side};
            const auto corner = [&](int k) {
                obj << ' ' << points[k];
                if (texture == Texture::OfFaces) obj << '/' << 4 * face + k + 1;
                if (texture == Texture::OfPoints || texture == Texture::OfHalves)
                    obj << '/' << points[k] + (halves == 2 && x > 0 ? side * side : 0);
            };
            const std::vector<std::vector<int>> polygons =
                face + 1 < faces ? std::vector<std::vector<int>>{{0, 1, 2, 3}}
                                 : std::vector<std::vector<int>>{{0, 1, 2}, {0, 2, 3}};
            for (const std::vector<int>& polygon : polygons) {
                obj << 'f';
                for (const int k : polygon) corner(k);
                obj << '\n';
            }
        }
        obj << "t crease 2/1/0 " << side << ' ' << side + 1 << ' ' << pick({0.0, 1.5, 10.0})
            << "\nt corner 1/1/0 4 " << pick({0.0, 3.0}) << "\n";
        if (chance(0.3)) obj << "t hole 1/0/0 " << pick({0, 4}) << "\n";
        if (chance(0.6)) obj << "t interpolateboundary 1/0/0 " << pick({0, 1, 2}) << "\n";
        return obj.str();
    }

  private:
    enum class Texture { None, OfPoints, OfFaces, OfHalves };

    template <class V>
    V pick(std::initializer_list<V> values) {
        return *(values.begin() + std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(engine_));
    }
    double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
    bool chance(double p) { return std::bernoulli_distribution(p)(engine_); }
    std::string subset(std::initializer_list<const char*> words) {
        std::string list;
        for (const char* word : words)
            if (chance(0.6)) list += (list.empty() ? "\"" : ", \"") + std::string(word) + "\"";
        return list;
    }
    std::mt19937 engine_;
};

using Files = std::map<std::string, std::string>;

Files read_all(const fs::path& folder) {
    Files files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        std::ifstream stream(entry.path(), std::ios::binary);
        files[fs::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>(stream), {}};
    }
    return files;
}

// The numbers of every array that follows `name` in a layer's text.
std::vector<double> numbers_after(const std::string& text, const std::string& name) {
    std::vector<double> numbers;
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
        const std::size_t begin = text.find("[", text.find("timeSamples", at)), end = text.find("]", begin);
        if (begin == std::string::npos || end == std::string::npos) break;
        for (const char* p = text.data() + begin; p < text.data() + end;) {
            double value = 0.0;
            const auto [after, error] = std::from_chars(p, text.data() + end, value);
            if (error == std::errc()) {
                numbers.push_back(value);
                p = after;
            } else {
                ++p;
            }
        }
    }
    return numbers;
}

void expect_bounded(const std::string& layer) {
    for (const char* name : {"point3f[] points", "normal3f[] normals", "vector3f[] velocities",
                             "slopeVariance", "whitecapCoverage"})
        for (const double value : numbers_after(layer, name)) ASSERT_TRUE(std::isfinite(value)) << name;
    const auto variances = numbers_after(layer, "slopeVariance");
    for (std::size_t i = 0; i < variances.size(); ++i)
        if (i % 3 != 2) {  // σxx, σyy; σxy has either sign
            ASSERT_GE(variances[i], 0.0);
        }
    for (const double w : numbers_after(layer, "whitecapCoverage")) {
        ASSERT_GE(w, 0.0);
        ASSERT_LE(w, 1.0);
    }
}

// Maps are finite by their encoder, which refuses anything else; their ranges are read back.
void expect_bounded_map(const fs::path& file) {
    const std::string name = file.filename().string();
    const auto is = [&](MapKind kind) {
        return name.find('.' + std::string(word_of(kind)) + '.') != std::string::npos;
    };
    if (is(MapKind::Whitecaps)) {
        for (const float w : test::read_level(file, "R", 0).values) {
            ASSERT_GE(w, 0.0f);
            ASSERT_LE(w, 1.0f);
        }
        for (const float v : test::read_level(file, "jacobianVariance", 0).values) ASSERT_GE(v, 0.0f);
    } else if (is(MapKind::SlopeVariance)) {
        for (const char* channel : {"R", "G"})
            for (const float v : test::read_level(file, channel, 0).values) ASSERT_GE(v, 0.0f);
    }
}

class RandomShots : public ::testing::TestWithParam<int> {};

TEST_P(RandomShots, AreBakedToFiniteNumbersOrRefused) {
    constexpr int kEach = 50;
    const fs::path folder = fs::temp_directory_path() / ("pelagic-random-" + std::to_string(getpid()));
    int baked = 0;
    for (int i = 0; i < kEach; ++i) {
        const unsigned seed = static_cast<unsigned>(GetParam() * kEach + i);
        RandomShot random(seed);
        const std::string text = random.text();
        SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + text);
        fs::remove_all(folder);
        fs::create_directories(folder);
        std::ofstream(folder / "shot.toml") << text;
        std::ofstream(folder / "cage.obj") << random.cage();

        std::vector<Files> results;
        bool refused = false;
        for (const int threads : {1, 2}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
            const fs::path out = folder / std::to_string(threads);
            try {
                const Scene scene = load_shot(folder / "shot.toml", check_scene);
                const RunReport report =
                    bake(scene, {.out = out, .frames = {}, .progress = {}, .cancel = nullptr});
                ASSERT_EQ(report.done, report.total);
                ASSERT_EQ(report.executed_transforms, report.done * plan_bake(scene).transforms_per_frame());
                results.push_back(read_all(out));
                for (const auto& [path, bytes] : results.back())
                    if (path.ends_with(".exr")) expect_bounded_map(out / path);
            } catch (const ShotError&) {
                refused = true;
            } catch (const std::exception& error) {
                FAIL() << "neither baked nor refused: "
                       << error.what();  // with the shot, unlike an exception
            }
            ASSERT_TRUE(!refused || !fs::exists(out)) << "refused, but something was written";
        }
        fs::remove_all(folder);
        if (refused) continue;
        ++baked;
        ASSERT_EQ(results[0].size(), results[1].size());
        for (const auto& [path, bytes] : results[0]) {
            ASSERT_TRUE(bytes == results[1].at(path)) << path << " differs between one thread and two";
            // Encoders refuse NaN and infinity by throwing, so that what is there is finite; the layers are
            // read anyway.
            if (path.ends_with(".usda") && path.find("mesh/") == 0) expect_bounded(bytes);
        }
    }
    EXPECT_GE(baked, kEach * 2 / 5) << "so many refusals test nothing";
}

// Ten batches of fifty, side by side under ctest.
INSTANTIATE_TEST_SUITE_P(Batch, RandomShots, ::testing::Range(0, 10));

}  // namespace
