// The layers about the mesh as USD's binary crate (usdc), with the very contents of text.h's: the arrays lie
// flat in the file, as they are in memory, so that writing is copying and a reader may map them. Nothing here
// touches a file: the caller puts the bytes where they belong.
#pragma once

#include <string>

#include "plugin/usd/layers.h"

namespace pelagic::usd {

// The writers give the sink the arrays as they lie in the caller's memory, each in one piece, and little
// else. The same arguments give the same bytes. The machine must be little-endian, as the format is.
//
// All throw std::invalid_argument, naming what is wrong, before the sink is called for the first time.

void write_topology_crate(const Topology& topology, const Sink& sink);
std::string topology_crate(const Topology& topology);

void write_frame_crate(const MeshSample& sample, const Sink& sink);
std::string frame_crate(const MeshSample& sample);

}  // namespace pelagic::usd
