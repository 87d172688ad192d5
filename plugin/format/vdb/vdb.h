// OpenVDB files in memory: sparse grids of floats and of vectors, filled block by block.
//
// Knows the format and no physics. The bytes depend on the arguments alone: no time stamp, no thread count, and instead of
// OpenVDB's random identifier of a file one that is made of the caller's fingerprint.
//
// Space. Voxel (i, j, k) is the cube whose middle is first_m + (i, j, k) · voxel_m, its sides along the axes. OpenVDB's
// own index space has the middle of a voxel at whole numbers, as most programs that read it.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pelagic::vdb {

using AttributeValue = std::variant<bool, std::int64_t, double, std::string>;

struct Attribute {
    std::string name;  // unique, and none of the format's own ("class", "name", "file_…")
    AttributeValue value;
};

enum class GridKind {
    FogVolume,  // of floats
    LevelSet,   // of floats: distances, negative inside
    Velocity,   // of vectors, each at the middle of its voxel: not staggered
};

struct GridOptions {
    std::string name;  // "density"
    // Under this name, too; empty: under none. The file holds the voxels once (OpenVDB's instances), and readers get two grids.
    std::string also_named{};
    GridKind kind = GridKind::FogVolume;
    double voxel_m = 1.0;
    glm::dvec3 first_m{0.0};  // the middle of voxel (0, 0, 0)
    // Of voxels that no block holds. Of level sets the value far outside; far inside it is the negative.
    float background = 0.0f;
    std::vector<Attribute> attributes{};
};

inline constexpr int kBlock = 8;  // voxels a side, as OpenVDB's leaves have them
inline constexpr int kBlockVoxels = kBlock * kBlock * kBlock;

// A cube of voxels. Voxel (i, j, k) of it stands at index_in_block(i, j, k).
template <class Value>
struct Block {
    glm::ivec3 first{0};  // its first voxel, in multiples of kBlock
    std::bitset<kBlockVoxels> active{};
    std::array<Value, kBlockVoxels> values{};  // of voxels that aren't active the background, with its sign
};
constexpr std::size_t index_in_block(int i, int j, int k) {
    return static_cast<std::size_t>((i * kBlock + j) * kBlock + k);
}

// Bytes that a grid holds for each block, with its share of the tree above, where blocks lie side by side.
template <class Value>
constexpr std::size_t bytes_a_block() {
    return kBlockVoxels * sizeof(Value) + 512;
}
// Bytes of the tree above, however few blocks there are.
inline constexpr std::size_t kTreeBytes = std::size_t{4} << 20;
// Bytes of the library itself, once it is loaded.
inline constexpr std::size_t kLibraryBytes = std::size_t{24} << 20;

// Loads OpenVDB, as the first grid would: memory is measured after it. Throws std::runtime_error where there is no
// such library, std::bad_alloc where there is no room for it, std::system_error where there are no threads.
void load();

// A grid that is being filled.
class Grid {
  public:
    explicit Grid(const GridOptions& options);
    ~Grid();
    Grid(Grid&&) noexcept;
    Grid& operator=(Grid&&) noexcept;

    // From any thread, in any order, each place once. Of floats where the kind is of floats, of vectors where it is
    // of vectors (std::invalid_argument otherwise). A value that isn't finite is refused: std::invalid_argument.
    void add(const Block<float>& block);
    void add(const Block<glm::vec3>& block);

  private:
    friend std::string encode(std::span<const Grid>, const std::vector<Attribute>&, const std::string&);
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// The grids, and the attributes of all of them, as the bytes of a file. Level sets get their signs far inside.
// Compressed by Blosc, or by zip where OpenVDB was built without. `fingerprint`: sixteen hexadecimal digits, of which
// the file's identifier is made. Throws std::invalid_argument for anything else.
std::string encode(std::span<const Grid> grids, const std::vector<Attribute>& attributes,
                   const std::string& fingerprint);

// Where that identifier stands among the bytes, for callers that compare files without it.
inline constexpr std::size_t kIdentifierAt = 21, kIdentifierLength = 36;

}  // namespace pelagic::vdb
