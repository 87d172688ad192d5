// The layers of layers.h as USD text (OpenUSD's usda 1.0). Floats are printed with the fewest digits that
// read back as the same float. Nothing here opens a file: the caller decides where the text goes.
#pragma once

#include <string>
#include <string_view>

#include "plugin/format/usd/layers.h"

namespace pelagic::usd {

// The writers hand the sink about a megabyte of text at a time.
//
// All throw std::invalid_argument, naming what is wrong, before they call the sink.

// Its length does not depend on the number of frames.
std::string root_text(const Stage& stage);
std::string manifest_text(const Manifest& manifest);

void write_topology_text(const Topology& topology, const Sink& sink);
std::string topology_text(const Topology& topology);

void write_frame_text(const MeshSample& sample, const Sink& sink);
std::string frame_text(const MeshSample& sample);

}  // namespace pelagic::usd
