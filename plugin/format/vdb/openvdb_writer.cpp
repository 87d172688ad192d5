// The only file that includes OpenVDB: its headers take twenty seconds to compile. A library of its own (openvdb_writer.h).
#include "plugin/format/vdb/openvdb_writer.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <mutex>
#include <ostream>
#include <stdexcept>
#include <streambuf>

namespace pelagic::vdb {
namespace {

void insert(openvdb::MetaMap& map, const Attribute& attribute) {
    std::visit(
        [&]<class Value>(const Value& value) {
            if constexpr (std::is_same_v<Value, std::int64_t>)
                map.insertMeta(attribute.name, openvdb::Int64Metadata(value));
            else
                map.insertMeta(attribute.name, openvdb::TypedMetadata<Value>(value));
        },
        attribute.value);
}

openvdb::math::Transform::Ptr transform_of(const GridOptions& options) {
    openvdb::math::Transform::Ptr transform =
        openvdb::math::Transform::createLinearTransform(options.voxel_m);
    transform->postTranslate({options.first_m.x, options.first_m.y, options.first_m.z});
    return transform;
}

template <class Typed>
typename Typed::Ptr make_grid(const GridOptions& options) {
    const typename Typed::Ptr grid = Typed::create(typename Typed::ValueType(options.background));
    grid->setName(options.name);
    grid->setTransform(transform_of(options));
    for (const Attribute& attribute : options.attributes) insert(*grid, attribute);
    return grid;
}

bool is_finite(float value) {
    return std::isfinite(value);
}
bool is_finite(const glm::vec3& value) {
    return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z);
}
float openvdb_value(float value) {
    return value;
}
openvdb::Vec3s openvdb_value(const glm::vec3& value) {
    return {value.x, value.y, value.z};
}

template <class Typed, class Value>
std::unique_ptr<typename Typed::TreeType::LeafNodeType> leaf_of(const Block<Value>& block) {
    using Leaf = typename Typed::TreeType::LeafNodeType;
    static_assert(Leaf::SIZE == kBlockVoxels);
    auto leaf = std::make_unique<Leaf>(openvdb::Coord(block.first.x, block.first.y, block.first.z),
                                       typename Typed::ValueType(0.0f), false);
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
        if (!is_finite(block.values[i])) throw std::invalid_argument("a voxel's value is no finite number");
        leaf->setValueOnly(i, openvdb_value(block.values[i]));
        leaf->setActiveState(i, block.active[i]);
    }
    return leaf;
}

// A string that is written to, also anew where something is already: grids' places in the file are filled in when they
// are known.
class StringBuffer final : public std::streambuf {
  public:
    explicit StringBuffer(std::string& bytes) : bytes_(bytes) {}

  private:
    std::streamsize xsputn(const char* from, std::streamsize count) override {
        const auto size = static_cast<std::size_t>(count);
        if (at_ + size > bytes_.size()) bytes_.resize(at_ + size);
        std::memcpy(bytes_.data() + at_, from, size);
        at_ += size;
        return count;
    }
    int_type overflow(int_type byte) override {
        const char c = traits_type::to_char_type(byte);
        xsputn(&c, 1);
        return byte;
    }
    pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
        off_type base = 0;
        if (from == std::ios_base::cur) base = static_cast<off_type>(at_);
        if (from == std::ios_base::end) base = static_cast<off_type>(bytes_.size());
        return seekpos(base + offset, std::ios_base::out);
    }
    pos_type seekpos(pos_type position, std::ios_base::openmode) override {
        const auto at = static_cast<off_type>(position);
        if (at < 0 || static_cast<std::size_t>(at) > bytes_.size()) return pos_type(off_type(-1));
        at_ = static_cast<std::size_t>(at);
        return position;
    }

    std::string& bytes_;
    std::size_t at_ = 0;
};

// As openvdb::io::File writes: with each grid's place, so that readers take the grids that they want.
class Writer final : public openvdb::io::Archive {
  public:
    void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& about) {
        setCompression((hasBloscCompression() ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP) |
                       openvdb::io::COMPRESS_ACTIVE_MASK);
        write(stream, grids, /*seekable=*/true, about);
    }
};

class OpenVdbGrid final : public GridWriter {
  public:
    explicit OpenVdbGrid(const GridOptions& options) : kind_(options.kind), also_named_(options.also_named) {
        switch (options.kind) {
            case GridKind::FogVolume:
                floats_ = make_grid<openvdb::FloatGrid>(options);
                floats_->setGridClass(openvdb::GRID_FOG_VOLUME);
                break;
            case GridKind::LevelSet:
                floats_ = make_grid<openvdb::FloatGrid>(options);
                floats_->setGridClass(openvdb::GRID_LEVEL_SET);
                break;
            case GridKind::Velocity:
                vectors_ = make_grid<openvdb::Vec3SGrid>(options);
                vectors_->setGridClass(openvdb::GRID_UNKNOWN);
                vectors_->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
                break;
        }
    }

    void add(const Block<float>& block) override {
        if (!floats_) throw std::invalid_argument("a grid of vectors takes no floats");
        auto leaf = leaf_of<openvdb::FloatGrid>(block);
        const std::lock_guard lock(mutex_);
        floats_->tree().addLeaf(leaf.release());
    }
    void add(const Block<glm::vec3>& block) override {
        if (!vectors_) throw std::invalid_argument("a grid of floats takes no vectors");
        auto leaf = leaf_of<openvdb::Vec3SGrid>(block);
        const std::lock_guard lock(mutex_);
        vectors_->tree().addLeaf(leaf.release());
    }

    const std::string& also_named() const { return also_named_; }

    openvdb::GridBase::Ptr finished() const {
        if (kind_ == GridKind::LevelSet) openvdb::tools::signedFloodFill(floats_->tree());
        return grid();
    }

  private:
    openvdb::GridBase::Ptr grid() const {
        if (floats_) return floats_;
        return vectors_;
    }

    GridKind kind_;
    std::string also_named_;
    openvdb::FloatGrid::Ptr floats_;  // one of the two
    openvdb::Vec3SGrid::Ptr vectors_;
    std::mutex mutex_;
};

class Library final : public OpenVdbWriter {
  public:
    Library() { openvdb::initialize(); }

    std::unique_ptr<GridWriter> make_grid(const GridOptions& options) const override {
        return std::make_unique<OpenVdbGrid>(options);
    }

    std::string encode(std::span<const GridWriter* const> grids, const std::vector<Attribute>& attributes,
                       const std::string& identifier) const override {
        openvdb::GridCPtrVec all;
        for (const GridWriter* grid : grids) {
            const auto* const of = static_cast<const OpenVdbGrid*>(grid);
            const openvdb::GridBase::Ptr finished = of->finished();
            all.push_back(finished);
            if (of->also_named().empty()) continue;
            const openvdb::GridBase::Ptr same = finished->copyGrid();  // of the same tree
            same->setName(of->also_named());
            all.push_back(same);
        }
        openvdb::MetaMap about;
        for (const Attribute& attribute : attributes) insert(about, attribute);
        std::string bytes;
        StringBuffer buffer(bytes);
        std::ostream stream(&buffer);
        stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
        Writer().write_to(stream, all, about);
        // OpenVDB has drawn one by the clock.
        bytes.replace(kIdentifierAt, kIdentifierLength, identifier);
        bytes.shrink_to_fit();  // grown by doubling, and kept while other frames are encoded
        return bytes;
    }
};

}  // namespace
}  // namespace pelagic::vdb

extern "C" const pelagic::vdb::OpenVdbWriter* pelagic_openvdb_writer() {
    static const pelagic::vdb::Library library;
    return &library;
}
