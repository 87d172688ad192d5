#include "tests/random/judged_scene.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfTiledInputFile.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/base/precision.h"
#include "core/plan/plan.h"
#include "core/scene/cascade_bands.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "core/waves/sea.h"
#include "plugin/bake/bake.h"
#include "plugin/budget/budget.h"
#include "plugin/format/shot/shot.h"
#include "plugin/format/usd/read_mesh.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/plugin/bake/read_vdb.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

class Failed : public std::runtime_error {
  public:
    Failed(const std::string& of, const std::string& detail)
        : std::runtime_error(of + ": " + detail), kind(of) {}
    std::string kind;
};

// ---- Numbers

// What a number may be, besides finite.
enum class Is { Any, NotNegative, Share, Distance };

void judge_number(double value, Is is, const std::string& what) {
    // Sums of shares that were rounded each.
    constexpr double kOne = 1.0 + 1e-5;
    if (!std::isfinite(value)) throw Failed("not finite: " + what, std::to_string(value));
    if (is != Is::Any && value < 0.0) throw Failed("negative: " + what, std::to_string(value));
    if (is == Is::Share && value > kOne) throw Failed("more than 1: " + what, std::to_string(value));
}
template <class Numbers>
void judge_numbers(const Numbers& numbers, Is is, const std::string& what) {
    for (const auto value : numbers) judge_number(static_cast<double>(value), is, what);
}

// Triples (xx, yy, xy): a covariance.
void judge_variances(const std::vector<float>& numbers, const std::string& what) {
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
        const double xx = static_cast<double>(numbers[i]), yy = static_cast<double>(numbers[i + 1]),
                     xy = static_cast<double>(numbers[i + 2]);
        judge_number(xx, Is::NotNegative, what);
        judge_number(yy, Is::NotNegative, what);
        judge_number(xy, Is::Any, what);
        constexpr double kRounding = 1.0 + 1e-5;
        if (std::abs(xy) > kRounding * std::sqrt(xx) * std::sqrt(yy) + 1e-30)
            throw Failed("no covariance: " + what,
                         std::to_string(xx) + ", " + std::to_string(yy) + ", " + std::to_string(xy));
    }
}

void judge_normals(const std::vector<float>& numbers, double tolerance, const std::string& what) {
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
        double length2 = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            judge_number(static_cast<double>(numbers[i + c]), Is::Any, what);
            length2 += static_cast<double>(numbers[i + c]) * static_cast<double>(numbers[i + c]);
        }
        if (std::abs(std::sqrt(length2) - 1.0) > tolerance)
            throw Failed("no unit vector: " + what, std::to_string(std::sqrt(length2)));
    }
}

// ---- Files

using Channels = std::map<std::string, std::vector<float>>;

template <class File>
Channels read_channels(const Imf::Header& header, int width, int height, const File& read) {
    Channels channels;
    Imf::FrameBuffer buffer;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        std::vector<float>& values = channels[c.name()];
        values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        buffer.insert(c.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                           sizeof(float) * static_cast<std::size_t>(width)));
    }
    read(buffer);
    return channels;
}

void judge_level(const std::string& name, const Channels& channels) {
    const auto is_of = [&](MapKind kind) {
        return name.find('.' + std::string(word_of(kind)) + '.') != std::string::npos;
    };
    for (const auto& [channel, values] : channels) {
        Is is = Is::Any;
        if (is_of(MapKind::Whitecaps))
            is = channel == "jacobianMean"                               ? Is::Any
                 : channel == "jacobianVariance" || channel == "foamAge" ? Is::NotNegative
                                                                         : Is::Share;
        else if (is_of(MapKind::SlopeVariance) && channel != "B")
            is = Is::NotNegative;
        else if (is_of(MapKind::Floor) || name.find(".sky.") != std::string::npos)
            is = Is::NotNegative;
        const std::string what = name.substr(0, name.find('/')) + " " + channel;
        judge_numbers(values, is,
                      is_of(MapKind::Whitecaps)       ? "whitecaps map " + channel
                      : is_of(MapKind::SlopeVariance) ? "slope variance map " + channel
                                                      : what);
    }
}

void judge_exr(const std::string& name, const fs::path& path) {
    const Imf::InputFile whole(path.c_str());
    if (!whole.header().hasTileDescription()) {
        Imf::InputFile file(path.c_str());
        const auto window = file.header().dataWindow();
        const int width = window.max.x + 1, height = window.max.y + 1;
        judge_level(name, read_channels(file.header(), width, height, [&](Imf::FrameBuffer& buffer) {
                        file.setFrameBuffer(buffer);
                        file.readPixels(0, height - 1);
                    }));
        return;
    }
    Imf::TiledInputFile file(path.c_str());
    for (int level = 0; level < file.numLevels(); ++level)
        judge_level(name, read_channels(file.header(), file.levelWidth(level), file.levelHeight(level),
                                        [&](Imf::FrameBuffer& buffer) {
                                            file.setFrameBuffer(buffer);
                                            file.readTiles(0, file.numXTiles(level) - 1, 0,
                                                           file.numYTiles(level) - 1, level);
                                        }));
}

void judge_mesh(const std::string& bytes) {
    usd::MeshLayer layer;
    try {
        layer = usd::read_mesh_layer(bytes);
    } catch (const usd::ReadError& error) {
        throw Failed("a mesh that can't be read", error.what());
    }
    for (const usd::MeshArray& array : layer.arrays) {
        const auto* numbers = std::get_if<std::vector<float>>(&array.values);
        if (!numbers) continue;
        const auto is = [&](const char* name) { return array.name.find(name) != std::string::npos; };
        if (is("slopeVariance"))
            judge_variances(*numbers, "mesh " + array.name);
        else if (is("normals"))
            judge_normals(*numbers, 1e-4, "mesh " + array.name);
        else
            judge_numbers(*numbers, is("whitecapCoverage") || is("wet") ? Is::Share : Is::Any,
                          "mesh " + array.name);
    }
}

void judge_volume(const fs::path& path) {
    for (const VdbGrid& grid : read_vdb(path)) {
        const bool is_density = grid.name == "density";
        grid.for_each([&](glm::ivec3, glm::vec3 value) {
            for (int c = 0; c < 3; ++c)
                judge_number(static_cast<double>(value[c]), is_density ? Is::NotNegative : Is::Any,
                             "volume " + grid.name);
        });
    }
}

// A realisation of few waves may be higher than they are expected to be, but not by much.
void judge_record(const std::string& bytes) {
    const nlohmann::json record = nlohmann::json::parse(bytes);
    const double expected_m = record.at("spectrum").at("hs_m");
    // A hero's trains are a fifth of its height high, as waves are counted; of heroes that contradict each other, up to ten times that.
    double raised_m = 0.0;
    for (const auto& hero : record.at("settings").at("waves.heroes"))
        raised_m += 2.0 * std::abs(hero.at("height_m").get<double>());
    const auto& vessels = record.at("settings").at("waves.vessels");
    const bool has_vessels = vessels.is_array() && !vessels.empty();
    constexpr double kTimes = 6.0;  // exp(−36) for a single wave
    for (const auto& [frame, what] : record.at("frames").items()) {
        if (!what.contains("hs_m")) continue;
        const double hs_m = what.at("hs_m").get<double>();
        if (hs_m > kTimes * expected_m + raised_m + 1e-9)
            throw Failed("higher than the spectrum",
                         what.at("hs_m").dump() + " m instead of " + std::to_string(expected_m) + " m");
        // A patch may lie in the highest group of the tile, and pairs of waves that are too short for it raise it, too.
        const double most_m = 4.0 * std::max(hs_m, 0.1 * expected_m) + raised_m + 1e-6;
        if (!has_vessels && what.contains("mesh_hs_m") && what.at("mesh_hs_m").get<double>() > most_m)
            throw Failed("a mesh higher than its sea",
                         what.at("mesh_hs_m").dump() + " m, the sea " + what.at("hs_m").dump() + " m");
    }
}

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

using Times = std::map<std::string, fs::file_time_type>;

Times times_of(const fs::path& folder) {
    Times times;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) times[entry.path().string()] = entry.last_write_time();
    return times;
}

void judge_files(const fs::path& folder, const Files& files) {
    for (const auto& [name, bytes] : files) {
        const std::string extension = fs::path(name).extension().string();
        if (extension == ".exr") judge_exr(name, folder / name);
        if (extension == ".vdb") judge_volume(folder / name);
        if (extension == ".json") judge_record(bytes);
        const bool is_layer = extension == ".usda" || extension == ".usdc";
        if (is_layer && name.starts_with("mesh/") && name.find(".manifest.") == std::string::npos)
            judge_mesh(bytes);
    }
}

// ---- Runs

struct Threads {
    explicit Threads(int count)
        : limit(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)) {}
    oneapi::tbb::global_control limit;
};
constexpr int kThreads[] = {1, 2};

void judge_bake(const Scene& scene, const fs::path& folder) {
    std::optional<Files> first;
    for (const int threads : kThreads) {
        const Threads limit(threads);
        const fs::path out = folder / ("baked-" + std::to_string(threads));
        const auto run = [&](std::vector<int> frames) {
            const RunReport report =
                bake(scene, {.out = out, .frames = std::move(frames), .progress = {}, .cancel = nullptr});
            if (report.done + report.kept != report.total)
                throw Failed("an unfinished bake",
                             std::to_string(report.done) + " of " + std::to_string(report.total) + " frames");
            return report.done;
        };
        if (!first) {
            run({});
            first = read_all(out);
            judge_files(out, *first);
            continue;
        }
        // One by one; and a run over what is whole leaves it.
        for (int frame = scene.shot.first_frame; frame <= scene.shot.last_frame; ++frame) run({frame});
        Files files = read_all(out);
        const Times times = times_of(out);
        if (run({}) != 0 || times_of(out) != times) throw Failed("made again what was whole", "");
        if (files.size() != first->size())
            throw Failed("other files on two threads",
                         std::to_string(files.size()) + " instead of " + std::to_string(first->size()));
        for (const auto& [name, bytes] : *first)
            if (files[name] != bytes) throw Failed("a bake with other bytes on two threads", name);
    }
}

bool are_modes_dense(const Plan& plan) {
    const DirectionalSpectrum& spectrum = plan.from->spectrum;
    return !plan.trains && !plan.cascades.empty() && !spectrum.empty() &&
           plan.cascades.front().size_m * spectrum.longest_peak_wavenumber() > kBandModes * kTwoPi;
}

// What each query shows of the sea's energy and slopes, beside all that the spectrum has.
template <class T>
void judge_energy(const Plan& plan) {
    const Sea<T> sea(plan);
    const SpectralMoments& total = sea.total();
    for (std::size_t query = 0; query < plan.queries.size(); ++query) {
        const SpectralMoments shown = sea.resolved_moments(static_cast<int>(query));
        const auto compare = [&](const char* what, double part, double whole, double tolerance) {
            judge_number(whole, Is::NotNegative, std::string("the spectrum's ") + what);
            judge_number(part, Is::NotNegative, std::string("shown ") + what);
            if (part > (1.0 + tolerance) * whole)
                throw Failed(std::string("more than the spectrum's ") + what,
                             std::to_string(part) + " of " + std::to_string(whole) + ", " +
                                 plan.queries[query].query.name);
        };
        compare("energy", shown.m0, total.m0, 1e-6);
        // A mode has the slopes of its own wavenumber, not those of its whole cell: as good where the tile is larger than
        // the longest waves.
        if (are_modes_dense(plan)) compare("slope variance", shown.mss(), total.mss(), 0.05);
    }
}
void judge_energy_of(const Plan& plan) {
    with_precision(plan.knobs.double_precision, [&]<class T>(T) { judge_energy<T>(plan); });
}

RenderOptions picture_options(const Scene& scene, std::uint64_t variant) {
    RenderOptions options = render_options(scene);
    // Sixteen samples a pixel would be most of the test's time.
    options.samples = std::min(options.samples, variant % 5 == 0 ? 2 : 1);
    options.shutter_frames = variant % 7 == 0 ? 0.5 : 0.0;
    options.alpha = variant % 3 == 0;
    if (variant % 2 == 0) options.layers.set();
    return options;
}

void judge_picture(const Picture& picture) {
    for (const SeaRadiance& pixel : picture.layers)
        for (const PictureLayerRow& row : kPictureLayers)
            if (row.light)
                for (int c = 0; c < 3; ++c)
                    judge_number(static_cast<double>((pixel.*row.light)[c]), Is::NotNegative,
                                 "picture " + std::string(row.name));
    judge_numbers(picture.alpha, Is::Share, "picture alpha");
    for (const PictureLayerRow& row : kPictureLayers) {
        const std::vector<float>& values = picture.data[index(row.layer)];
        const std::string what = "picture " + std::string(row.name);
        if (row.layer == PictureLayer::SlopeVariance)
            judge_variances(values, what);
        else if (row.layer == PictureLayer::Coverage || row.layer == PictureLayer::Breaking ||
                 row.layer == PictureLayer::Shadow)
            judge_numbers(values, Is::Share, what);
        else
            judge_numbers(values, row.layer == PictureLayer::FoamAge ? Is::NotNegative : Is::Any, what);
    }
}

template <class V>
bool same_bits(const std::vector<V>& a, const std::vector<V>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(V)) == 0);
}

// The last one is kept: it takes longer than a picture.
const Sky& sky_of(const Scene& scene) {
    static std::string of;
    static Sky sky;
    const std::string light = light_content(scene) + picture_content(scene);
    if (of != light) sky = make_sky(scene);
    of = light;
    return sky;
}

// Whether the camera sees the sea: it isn't in its floor, nor under water that has no body.
bool judge_pictures(const Scene& scene, std::uint64_t variant) {
    const RenderOptions options = picture_options(scene, variant);
    const Sky& sky = sky_of(scene);
    const int frame = scene.shot.first_frame;
    std::optional<Picture> first;
    std::optional<std::string> refusal;
    for (const int threads : kThreads) {
        const Threads limit(threads);
        Renderer renderer(scene, options, sky, std::span(&frame, 1));
        if (threads == kThreads[0] && variant % 2 == 1) judge_energy_of(renderer.plan());
        Picture picture;
        std::string refused;
        try {
            renderer.render(frame, picture);
        } catch (const std::invalid_argument& error) {
            refused = error.what();
            if (refused.find("under water") == std::string::npos &&
                refused.find("in the sea's floor") == std::string::npos)
                throw;
        }
        if (!refusal) {
            refusal = refused;
            if (!refused.empty()) continue;
            judge_picture(picture);
            first = std::move(picture);
            continue;
        }
        if (refused != *refusal) throw Failed("another refusal on two threads", refused);
        if (!refused.empty()) continue;
        bool is_same = same_bits(picture.layers, first->layers) && same_bits(picture.alpha, first->alpha) &&
                       same_bits(picture.sea, first->sea);
        for (std::size_t i = 0; i < kPictureLayerCount; ++i)
            is_same = is_same && same_bits(picture.data[i], first->data[i]);
        if (!is_same) throw Failed("a picture with other bits on two threads", "");
    }
    return refusal->empty();
}

// A line of a refusal names the file and the key.
void judge_refusal(const fs::path& shot, const std::string& message) {
    const bool has_key = std::any_of(key_tables().begin(), key_tables().end(), [&](const KeyTable& table) {
        return message.find(table.name + (table.is_list() ? '[' : '.')) != std::string::npos;
    });
    if (!has_key || !message.starts_with(shot.string()) || message.find("; accepted: ") == std::string::npos)
        throw Failed("a refusal that doesn't say what is wrong", message);
}

// Without its numbers, so that a simpler shot's message is of the same kind.
std::string kind_of(const std::string& message) {
    std::string kind;
    for (const char letter : message.substr(0, 60))
        if ((letter < '0' || letter > '9') && letter != '.' && letter != '-') kind += letter;
    return kind;
}

}  // namespace

Judgement judge(const fs::path& shot, std::uint64_t variant) {
    Judgement judgement;
    const fs::path folder = shot.parent_path();
    for (const int threads : kThreads) fs::remove_all(folder / ("baked-" + std::to_string(threads)));
    try {
        std::optional<Scene> scene;
        try {
            scene = load_shot(shot, check_scene);
        } catch (const ShotError& error) {
            judgement.refusal = error.what();
            judge_refusal(shot, judgement.refusal);
            return judgement;
        }
        const Settled settled = settle(*scene, Purpose::Mesh, with_rates(recorded_rates()));
        if (!settled.holds) {
            judgement.refusal = settled.text;
            return judgement;
        }
        scene = settled.scene;
        if (variant % 2 == 0) judge_energy_of(plan_bake(*scene));
        judge_bake(*scene, folder);
        judgement.is_pictured = judge_pictures(*scene, variant);
    } catch (const Failed& failed) {
        judgement.failure = failed.kind;
        judgement.detail = failed.what();
    } catch (const std::exception& error) {
        judgement.failure = "thrown: " + kind_of(error.what());
        judgement.detail = std::string("thrown: ") + error.what();
    }
    return judgement;
}

}  // namespace pelagic::test
