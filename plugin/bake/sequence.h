// One sea, frame after frame, turned into the bytes of files. The sea's buffers and the results are allocated
// once; the bytes of a file are made anew and let go.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "plugin/bake/record.h"

namespace pelagic {

// A finished file: its path below DIR and its bytes, in the order in which they are to be written.
using FileSink = std::function<void(const std::string& path, const std::string& bytes)>;

class Sequence {
  public:
    virtual ~Sequence() = default;
    // Computes the frame and hands each of its files to `sink`; what the sink throws passes through.
    virtual FrameRecord produce(int frame, const FileSink& sink) = 0;
    // The files that belong to no frame: root, topology, manifest. None without a mesh.
    virtual void produce_static(const FileSink& sink) = 0;
    virtual const SpectralMoments& total() const = 0;
    virtual double whitecap_threshold() const = 0;
    virtual long executed_transforms() const = 0;
};

// In the plan's precision. The plan must be make_plan(scene): its queries are the scene's mesh and maps.
std::unique_ptr<Sequence> make_sequence(const Scene& scene, const Plan& plan);

}  // namespace pelagic
