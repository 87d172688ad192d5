// One sea, frame after frame, turned into the bytes of files, in three steps that different frames may take
// at the same time. A frame's memory is its slot, which is used again for others; the sea's buffers are
// allocated once.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/evaluate/values.h"
#include "core/scene/scene.h"
#include "plugin/bake/record.h"

namespace pelagic {

// Hands the bytes of a file over, piece after piece.
using FileContent = std::function<void(const std::function<void(std::string_view)>&)>;
// Takes a finished file: its path below DIR and its bytes; returns how many they are. Files come in the order
// in which they are to be written.
using FileSink = std::function<std::uintmax_t(const std::string& path, const FileContent& content)>;

// What one frame needs between its steps.
struct FrameSlot {
    struct Map {
        Values values;
        std::vector<glm::vec3> hidden;  // slope variance by mip level
        std::string file;               // encoded
    };
    int frame = 0;
    FrameRecord record;
    Values mesh;
    std::string mesh_text;  // of a mesh in text; a crate needs none, its arrays are the mesh's
    std::vector<Map> maps;
};

class Sequence {
  public:
    virtual ~Sequence() = default;
    // The frame's values. One frame at a time.
    virtual void compute(int frame, FrameSlot& slot) = 0;
    // The bytes that aren't the values as they are. Different slots side by side, also while another frame is
    // computed.
    virtual void encode(FrameSlot& slot) const = 0;
    // Hands each of the frame's files to `sink` and enters it in the slot's record; what the sink throws
    // passes through. As encode().
    virtual void write(FrameSlot& slot, const FileSink& sink) const = 0;
    // The files that belong to no frame: root, camera, topology, manifest. None without a mesh.
    virtual void write_static(const FileSink& sink) const = 0;
    virtual const SpectralMoments& total() const = 0;
    virtual double whitecap_threshold() const = 0;
    virtual long executed_transforms() const = 0;
};

// In the plan's precision. The plan must be make_plan(scene): its queries are the scene's mesh and maps.
std::unique_ptr<Sequence> make_sequence(const Scene& scene, const Plan& plan);

}  // namespace pelagic
