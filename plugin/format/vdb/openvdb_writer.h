// What vdb.cpp asks of OpenVDB.
//
// The other side is a module of its own, pelagic_openvdb.so, that the program loads when it makes the first
// grid. Debian's OpenVDB brings log4cplus, which starts four threads as soon as it is loaded: neither a bake without volumes nor a
// process that is about to fork shall have them.
#pragma once

#include "plugin/format/vdb/vdb.h"

namespace pelagic::vdb {

class GridWriter {
  public:
    virtual ~GridWriter() = default;
    virtual void add(const Block<float>& block) = 0;
    virtual void add(const Block<glm::vec3>& block) = 0;
};

class OpenVdbWriter {
  public:
    virtual ~OpenVdbWriter() = default;
    virtual std::unique_ptr<GridWriter> make_grid(const GridOptions& options) const = 0;
    // Of grids that this made.
    virtual std::string encode(std::span<const GridWriter* const> grids,
                               const std::vector<Attribute>& attributes,
                               const std::string& identifier) const = 0;
};

}  // namespace pelagic::vdb

// The library's only symbol.
extern "C" const pelagic::vdb::OpenVdbWriter* pelagic_openvdb_writer();
