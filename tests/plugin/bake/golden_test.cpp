// The bits of every output of a small shot, against hashes that were written down with the output's revision.
// Bits that change without a new revision would leave files that are whole by their fingerprint and yet not
// what the program makes.
//
// Where the bits are meant to change: raise the revision (OutputRow::revision in core/plan/outputs.cpp, of
// pictures kPictureRevision in plugin/render/picture_files.h), and write the hashes down again with
//   PELAGIC_UPDATE_GOLDEN=1 build/release/tests/test_closure --gtest_filter='Golden.*'
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfTestFile.h>
#include <ImfTiledInputFile.h>
#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/plan/fingerprint.h"
#include "core/plan/outputs.h"
#include "core/scene/editions.h"
#include "core/scene/names.h"
#include "pelagic/version.h"
#include "plugin/bake/bake.h"
#include "plugin/files/files.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/render/picture_files.h"
#include "tests/plugin/bake/closure_shots.h"

namespace {

using namespace pelagic;
using namespace pelagic::test;
namespace fs = std::filesystem;

std::string bytes_of_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

template <class Value>
std::string_view raw_bytes(const std::vector<Value>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

int revision_of(OutputKind kind) {
    for (const OutputRow& row : output_table())
        if (row.kind == kind) return row.revision;
    return 0;
}

// A mesh's file: its bytes, but for what it says about itself.
std::string mesh_hash(const fs::path& file, const std::string& fingerprint) {
    std::string bytes = bytes_of_file(file);
    for (const std::string& text : {fingerprint, std::string(PELAGIC_VERSION)})
        for (std::size_t at = bytes.find(text); at != std::string::npos; at = bytes.find(text, at))
            bytes.erase(at, text.size());
    return Fingerprint().add(bytes).text();
}

// An image's file: the values of all its channels at all its levels, whatever packs them.
std::string exr_hash(const fs::path& file) {
    Fingerprint hash;
    const auto read = [&](const Imf::ChannelList& channels, int width, int height, const auto& take) {
        for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
            std::vector<float> values(static_cast<std::size_t>(width) * height);
            Imf::FrameBuffer buffer;
            buffer.insert(channel.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()),
                                                     sizeof(float), sizeof(float) * width));
            take(buffer);
            hash.add(channel.name()).add(raw_bytes(values));
        }
    };
    if (Imf::isTiledOpenExrFile(file.c_str())) {
        Imf::TiledInputFile in(file.c_str());
        for (int level = 0; level < in.numLevels(); ++level)
            read(in.header().channels(), in.levelWidth(level), in.levelHeight(level),
                 [&](const Imf::FrameBuffer& buffer) {
                     in.setFrameBuffer(buffer);
                     in.readTiles(0, in.numXTiles(level) - 1, 0, in.numYTiles(level) - 1, level);
                 });
    } else {
        Imf::InputFile in(file.c_str());
        const auto last = in.header().dataWindow().max;
        read(in.header().channels(), last.x + 1, last.y + 1, [&](const Imf::FrameBuffer& buffer) {
            in.setFrameBuffer(buffer);
            in.readPixels(0, last.y);
        });
    }
    return hash.text();
}

std::string png_hash(const fs::path& file) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_file(&image, file.c_str()), 0) << file;
    image.format = PNG_FORMAT_RGB;
    std::vector<unsigned char> pixels(PNG_IMAGE_SIZE(image));
    EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0) << file;
    return Fingerprint().add(raw_bytes(pixels)).text();
}

struct Golden {
    int revision = 0;
    std::string hash;
};
using Hashes = std::map<std::string, Golden>;  // by output

// What the shot leaves at its default becomes the edition's.
Scene in_edition(int edition, Scene scene) {
    for (const EditionChange& change : edition_changes()) {
        const Key& key = key_of(change.path);
        if (value_of(scene, key) == key.fallback) set_value(scene, key, fallback_in(edition, key));
    }
    scene.shot.edition = edition;
    return scene;
}

// Two frames of a shot with trains over cascades: every formula of the sea is in them. The first edition's sea has the bits that it
// had before there were editions.
Scene golden_shot(int edition) {
    Scene scene = in_edition(edition, trains_shot().scene);
    scene.shot.name = "golden";
    scene.shot.first_frame = scene.shot.last_frame = 7;
    scene.waves.cascades = {{.size_m = 30.0, .resolution = 64}, {.size_m = 9.0, .resolution = 32}};
    scene.output.maps = {MapKind::Displacement, MapKind::Normal, MapKind::SlopeVariance, MapKind::Whitecaps};
    scene.camera.resolution = {48, 27};
    return scene;
}

void add_bake(const Scene& scene, const fs::path& folder, Hashes& hashes) {
    const RunReport report = bake(scene, {.out = folder, .frames = {}, .progress = {}, .cancel = nullptr});
    const Plan plan = plan_bake(scene);
    const std::string name = scene.shot.name + '.';
    for (const PlannedOutput& output : plan.outputs) {
        const int revision = revision_of(output.row->kind);
        if (output.row->kind == OutputKind::Sky) {
            hashes["sky"] = {revision, exr_hash(folder / (name + "sky.0007.exr"))};
            continue;
        }
        if (!output.map) {
            const std::string format(word_of(scene.output.mesh));
            const std::string made_of =
                frame_fingerprint(plan, output, output_fingerprint(plan, output), scene.shot.first_frame);
            hashes["mesh." + format] = {revision,
                                        mesh_hash(folder / "mesh" / (name + "0007." + format), made_of)};
            continue;
        }
        const std::string map(word_of(*output.map));
        const std::string cascade = output.cascade ? std::to_string(*output.cascade) : "";
        const std::string file = output.cascade ? "tiles/" + name + map + '.' + cascade + ".0007.exr"
                                                : "maps/" + name + map + ".0007.exr";
        hashes[(output.cascade ? "tile" + cascade + '.' : "map.") + map] = {revision,
                                                                            exr_hash(folder / file)};
    }
}

void add_picture(const Scene& scene, const fs::path& folder, Hashes& hashes) {
    const RenderOptions options = render_options(scene);
    const std::vector<int> frames{scene.shot.first_frame};
    Renderer renderer(scene, options, make_sky(scene), frames);
    Picture picture;
    renderer.render(frames.front(), picture);
    const PictureContext context{.scene = scene,
                                 .options = options,
                                 .sky = renderer.sky(),
                                 .made_of = "golden",
                                 .exposure = shot_exposure(scene, renderer.sky())};
    files::write_atomically(folder / "golden.exr", encode_exr(context, picture, frames.front()));
    files::write_atomically(folder / "golden.png", encode_png(context, picture, frames.front()));
    hashes["picture.exr"] = {kPictureRevision, exr_hash(folder / "golden.exr")};
    hashes["picture.png"] = {kPictureRevision, png_hash(folder / "golden.png")};
}

// Lines of instruction set, output, revision and hash.
std::map<std::string, Hashes> hashes_in(const fs::path& file) {
    std::map<std::string, Hashes> all;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line);
        std::string set, output;
        Golden golden;
        if (words >> set >> output >> golden.revision >> golden.hash) all[set][output] = golden;
    }
    return all;
}

TEST(Golden, BitsChangeOnlyWithTheRevisionOfTheirOutput) {
    const fs::path file = fs::path(PELAGIC_SOURCE_DIR) / "tests/plugin/bake/golden/HASHES.txt";
    const std::string set = instruction_set();
    std::map<std::string, Hashes> known = hashes_in(file);
    const bool update = std::getenv("PELAGIC_UPDATE_GOLDEN") != nullptr;
    if (!update && !known.contains(set))
        GTEST_SKIP() << "no hashes for the instruction set " << set
                     << ": write them down with PELAGIC_UPDATE_GOLDEN=1";

    const fs::path folder = fs::temp_directory_path() / ("pelagic-golden-" + std::to_string(getpid()));
    fs::remove_all(folder);
    Hashes hashes;
    for (int edition = 1; edition <= kNewestEdition; ++edition) {
        Hashes made;
        Scene scene = golden_shot(edition);
        add_bake(scene, folder, made);
        scene.output.mesh = MeshFormat::Usdc;
        scene.output.maps.clear();
        scene.output.cascade_tiles = false;
        add_bake(scene, folder, made);
        if (Scene lit = scene; lit.water.body) {
            lit.sea.depth_m = 3.0;
            lit.output.mesh = MeshFormat::None;
            lit.output.maps = {MapKind::Floor};
            add_bake(lit, folder, made);
        }
        Scene sunset = scene;
        sunset.keyed.push_back({"light.sun_elevation_deg", {{{1, 20.0}, {9, 4.0}}}});
        add_bake(sunset, folder, made);
        scene.camera.position_m = {0.0, -30.0, 5.0};
        add_picture(scene, folder, made);
        fs::remove_all(folder);
        for (const auto& [output, golden] : made)
            hashes[output + (edition > 1 ? "@" + std::to_string(edition) : "")] = golden;
    }

    if (update) {
        known[set] = hashes;
        std::string text;
        for (const auto& [of_set, outputs] : known)
            for (const auto& [output, golden] : outputs)
                text +=
                    of_set + ' ' + output + ' ' + std::to_string(golden.revision) + ' ' + golden.hash + '\n';
        files::write_atomically(file, text);
        return;
    }
    for (const auto& [output, made] : hashes) {
        ASSERT_TRUE(known[set].contains(output)) << output << ": write its hash down";
        const Golden& golden = known[set][output];
        if (made.revision == golden.revision)
            EXPECT_EQ(made.hash, golden.hash)
                << output << " has other bits: if that is meant, raise "
                << (output.starts_with("picture") ? "kPictureRevision in plugin/render/picture_files.h"
                                                  : "its revision in core/plan/outputs.cpp")
                << " and run this test with PELAGIC_UPDATE_GOLDEN=1";
        else
            ADD_FAILURE() << output << " has revision " << made.revision << ", and the hashes are of "
                          << golden.revision << ": run this test with PELAGIC_UPDATE_GOLDEN=1";
    }
    EXPECT_EQ(known[set].size(), hashes.size())
        << "outputs that are no more: run with PELAGIC_UPDATE_GOLDEN=1";
}

}  // namespace
