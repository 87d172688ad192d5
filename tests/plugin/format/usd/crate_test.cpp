// The mesh's layers as crates. That other programs read them, and find in them what the text holds, is tested
// by usd.openusd_reads_usdc and usd.three_reads_crates. Here is what those would not notice.
#include "plugin/format/usd/crate.h"
#include "core/surface/rest_surface.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include "plugin/format/usd/text.h"

namespace pelagic::usd {
namespace {

struct CrateFrame {
    std::vector<glm::vec3> points, normals, velocities, slope_variance;
    std::vector<float> whitecap_coverage;

    explicit CrateFrame(std::size_t n)
        : points(n), normals(n), velocities(n), slope_variance(n), whitecap_coverage(n) {
        for (std::size_t i = 0; i < n; ++i) {
            const auto x = static_cast<float>(i);
            points[i] = {x, -x, 0.5f};
            normals[i] = {0.0f, 0.0f, 1.0f / (x + 1.0f)};
            velocities[i] = {x, 1.0f, -x};
            slope_variance[i] = {0.1f, 0.2f, x};
            whitecap_coverage[i] = 0.25f * x;
        }
    }
    MeshSample sample() const {
        return {.frame = 7,
                .fps = 29.97,
                .fingerprint = "0123456789abcdef",
                .points = points,
                .normals = normals,
                .velocities = velocities,
                .slope_variance = slope_variance,
                .whitecap_coverage = whitecap_coverage};
    }
};

struct Piece {
    const char* data;
    std::size_t size;
};

struct Written {
    std::vector<Piece> pieces;
    std::string bytes;

    Sink sink() {
        return [this](std::string_view part) {
            pieces.push_back({part.data(), part.size()});
            bytes += part;
        };
    }
    // Where in the file the piece begins that was handed over from this memory; 0 if there is none.
    std::size_t offset_of(const void* memory, std::size_t size) const {
        std::size_t offset = 0;
        for (const Piece& piece : pieces) {
            if (piece.data == memory && piece.size == size) return offset;
            offset += piece.size;
        }
        return 0;
    }
};

template <class T>
T number_at(const std::string& bytes, std::size_t offset) {
    T number;
    std::memcpy(&number, bytes.data() + offset, sizeof number);
    return number;
}

// What a file holds besides its arrays, the specs of its attributes, fits on a page.
constexpr std::size_t kMostBesidesArrays = 4096;

TEST(UsdCrate, ArraysGoFromTheCallersMemoryToTheFileAlignedAndInOnePiece) {
    const CrateFrame frame(1001);  // odd, so that nothing is aligned by itself
    Written written;
    write_frame_crate(frame.sample(), written.sink());
    const auto expect_array = [&](const void* memory, std::size_t count, std::size_t element_bytes) {
        const std::size_t offset = written.offset_of(memory, count * element_bytes);
        ASSERT_GT(offset, 88u);
        EXPECT_EQ(offset % 8, 0u);
        EXPECT_EQ(number_at<std::uint64_t>(written.bytes, offset - 8), count);
    };
    expect_array(frame.points.data(), 1001, 12);
    expect_array(frame.normals.data(), 1001, 12);
    expect_array(frame.velocities.data(), 1001, 12);
    expect_array(frame.slope_variance.data(), 1001, 12);
    expect_array(frame.whitecap_coverage.data(), 1001, 4);

    const pelagic::Faces faces = pelagic::grid_faces(3, 3);
    Written topology;
    write_topology_crate(
        {.face_vertex_counts = faces.counts, .face_vertex_indices = faces.indices, .st = faces.st},
        topology.sink());
    EXPECT_GT(topology.offset_of(faces.counts.data(), 9 * 4), 0u);
    EXPECT_GT(topology.offset_of(faces.indices.data(), 36 * 4), 0u);
    EXPECT_GT(topology.offset_of(faces.st.data(), 16 * 8), 0u);

    // Faces that vary are arrays of the frame.
    const CrateFrame vertices(16);
    MeshSample sample = vertices.sample();
    sample.faces = Faces{.counts = faces.counts, .indices = faces.indices, .st = faces.st};
    written = {};
    write_frame_crate(sample, written.sink());
    expect_array(faces.counts.data(), 9, 4);
    expect_array(faces.indices.data(), 36, 4);
    expect_array(faces.st.data(), 16, 8);
}

TEST(UsdCrate, IsAsLongAsItsArraysAndAPage) {
    for (const std::size_t vertices :
         {std::size_t{0}, std::size_t{4}, std::size_t{1001}, std::size_t{513 * 513}}) {
        const CrateFrame frame(vertices);
        const std::string bytes = frame_crate(frame.sample());
        const std::size_t arrays = vertices * (4 * sizeof(glm::vec3) + sizeof(float));
        EXPECT_GT(bytes.size(), arrays);
        EXPECT_LT(bytes.size(), arrays + kMostBesidesArrays) << vertices;
        EXPECT_EQ(bytes.capacity(), bytes.size()) << "reserved once, to the byte";
    }
    const pelagic::Faces faces = pelagic::grid_faces(100, 100);
    const std::string bytes = topology_crate({.scheme = SubdivisionScheme::CatmullClark,
                                              .face_vertex_counts = faces.counts,
                                              .face_vertex_indices = faces.indices,
                                              .st = faces.st,
                                              .attributes = {true, true, true, true}});
    const std::size_t arrays = 10000 * 4 + 40000 * 4 + 101 * 101 * 8;
    EXPECT_GT(bytes.size(), arrays);
    EXPECT_LT(bytes.size(), arrays + kMostBesidesArrays);
}

TEST(UsdCrate, BeginsAsACrateAndEndsWithItsContents) {
    const CrateFrame frame(4);
    const std::string bytes = frame_crate(frame.sample());
    EXPECT_TRUE(bytes.starts_with("PXR-USDC"));
    EXPECT_EQ(bytes.substr(8, 8), std::string("\0\10\0\0\0\0\0\0", 8));
    // Sections follow each other without a gap, and the contents follow them, to the file's last byte.
    const std::size_t contents = number_at<std::uint64_t>(bytes, 16);
    const std::vector<std::string> names{"TOKENS", "STRINGS", "FIELDS", "FIELDSETS", "PATHS", "SPECS"};
    ASSERT_EQ(contents + 8 + names.size() * 32, bytes.size());
    EXPECT_EQ(number_at<std::uint64_t>(bytes, contents), names.size());
    std::size_t end = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::size_t at = contents + 8 + 32 * i;
        EXPECT_EQ(bytes.substr(at, 16), names[i] + std::string(16 - names[i].size(), '\0'));
        const std::size_t start = number_at<std::uint64_t>(bytes, at + 16);
        EXPECT_EQ(start, i > 0 ? end : start) << names[i];
        end = start + number_at<std::uint64_t>(bytes, at + 24);
    }
    EXPECT_EQ(end, contents);
}

// The text of an LZ4 block of literals, after the byte that says there is one block. By LZ4's block format
// its length is in four bits; if they say 15, bytes follow that are added to it, up to the first below 255.
std::string literals(std::string_view block) {
    std::size_t at = 1, length = static_cast<unsigned char>(block.at(0)) >> 4;
    if (length == 15) {
        unsigned char more = 0;
        do {
            more = static_cast<unsigned char>(block.at(at++));
            length += more;
        } while (more == 255);
    }
    EXPECT_EQ(static_cast<unsigned char>(block.at(0)) & 15, 0);
    EXPECT_EQ(at + length, block.size());
    return std::string(block.substr(at));
}

TEST(UsdCrate, TokensOfAnyLengthReadBack) {
    // Long enough for every remainder of 255, which is where the length of a block changes its form.
    for (std::size_t length = 1; length < 600; ++length) {
        const std::string fingerprint(length, 'f');
        const std::string bytes = frame_crate({.fingerprint = fingerprint});
        const std::size_t section =
            number_at<std::uint64_t>(bytes, number_at<std::uint64_t>(bytes, 16) + 8 + 16);
        const std::size_t text_bytes = number_at<std::uint64_t>(bytes, section + 8);
        const std::size_t block_bytes = number_at<std::uint64_t>(bytes, section + 16);
        ASSERT_EQ(bytes[section + 24], '\0') << "a single block";
        const std::string text = literals(std::string_view(bytes).substr(section + 25, block_bytes - 1));
        ASSERT_EQ(text.size(), text_bytes) << length;
        ASSERT_NE(text.find('\0' + fingerprint + '\0'), std::string::npos) << length;
    }
}

TEST(UsdCrate, FingerprintStandsInTheLastPageAsItIs) {
    const CrateFrame frame(100000);
    const std::string bytes = frame_crate(frame.sample());
    const std::size_t at = bytes.rfind("0123456789abcdef");
    ASSERT_NE(at, std::string::npos);
    EXPECT_GT(at, bytes.size() - kMostBesidesArrays);
    MeshSample without = frame.sample();
    without.fingerprint = "";
    EXPECT_EQ(frame_crate(without).find("customLayerData"), std::string::npos);
}

TEST(UsdCrate, BothWaysOfWritingGiveTheSameBytesEveryTime) {
    const CrateFrame frame(1001), same(1001);
    Written written;
    write_frame_crate(frame.sample(), written.sink());
    EXPECT_EQ(frame_crate(same.sample()), written.bytes);
    const pelagic::Faces faces = pelagic::grid_faces(3, 3), again = pelagic::grid_faces(3, 3);
    Written topology;
    write_topology_crate(
        {.face_vertex_counts = faces.counts, .face_vertex_indices = faces.indices, .st = faces.st},
        topology.sink());
    EXPECT_EQ(topology_crate(
                  {.face_vertex_counts = again.counts, .face_vertex_indices = again.indices, .st = again.st}),
              topology.bytes);
}

// What a call throws, in words.
std::string crate_refusal(const auto& call) {
    try {
        call();
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "nothing was refused";
}

TEST(UsdCrate, RefusesWhatTheTextRefusesBeforeAnythingIsWritten) {
    bool called = false;
    const Sink sink = [&](std::string_view) { called = true; };
    const auto expect_same = [&](const auto& crate, const auto& text) {
        const std::string said = crate_refusal(crate);
        EXPECT_NE(said, "nothing was refused");
        EXPECT_EQ(said, crate_refusal(text));
        EXPECT_FALSE(called);
    };
    const auto frames_alike = [&](const MeshSample& sample) {
        expect_same([&] { write_frame_crate(sample, sink); }, [&] { frame_text(sample); });
    };
    CrateFrame frame(1001);
    frame.points.back().y = std::numeric_limits<float>::quiet_NaN();
    frames_alike(frame.sample());
    frame = CrateFrame(1001);
    frame.whitecap_coverage.front() = std::numeric_limits<float>::infinity();
    frames_alike(frame.sample());
    frame = CrateFrame(1001);
    frame.velocities.pop_back();
    frames_alike(frame.sample());
    frames_alike({.fps = 0.0});
    frames_alike({.fps = std::numeric_limits<double>::infinity()});
    frames_alike({.fps = std::numeric_limits<double>::quiet_NaN()});

    const auto topologies_alike = [&](const Topology& topology) {
        expect_same([&] { write_topology_crate(topology, sink); }, [&] { topology_text(topology); });
    };
    const std::vector<std::int32_t> counts{3}, indices{0, 1, 3};
    const std::vector<glm::vec2> st(3, glm::vec2(0));
    topologies_alike({.face_vertex_counts = counts, .face_vertex_indices = indices, .st = st});
    topologies_alike({.face_vertex_counts = counts});
    topologies_alike(
        {.face_vertex_counts = counts, .face_vertex_indices = indices, .attributes = {.faces = true}});
    const std::vector<glm::vec3> points(3, glm::vec3(0));
    frames_alike({.faces = Faces{counts, indices, st}, .points = points});  // an index without a point
    topologies_alike({.fps = -1.0, .face_vertex_counts = counts, .face_vertex_indices = indices});
}

}  // namespace
}  // namespace pelagic::usd
