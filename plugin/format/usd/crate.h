// The mesh's layers as crates, USD's binary layers (usdc). They hold what the text layers of text.h hold. An
// array is in the file as it is in memory, so that writing it is copying, and readers can map it. Nothing
// here opens a file: the caller decides where the bytes go.
#pragma once

#include <string>

#include "plugin/format/usd/layers.h"

namespace pelagic::usd {

// The writers hand each array to the sink in one piece, straight from the caller's memory, and little else.
// The same arguments give the same bytes. The machine must be little-endian, as the format is.
//
// All throw std::invalid_argument, naming what is wrong, before they call the sink.

void write_topology_crate(const Topology& topology, const Sink& sink);
std::string topology_crate(const Topology& topology);

void write_frame_crate(const MeshSample& sample, const Sink& sink);
std::string frame_crate(const MeshSample& sample);

}  // namespace pelagic::usd
