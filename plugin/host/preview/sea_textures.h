// A sea and its latest frame on the GPU, for shaders that include query.glsl.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "plugin/host/gpu/packed_foam.h"
#include "plugin/host/gpu/sea_layout.h"
#include "plugin/host/preview/gl_objects.h"
#include "plugin/host/preview/sea_renderer.h"
#include "plugin/host/preview/shader_program.h"

namespace pelagic {

// What is wrong with a coast whose textures are larger than the driver's.
std::string too_large_coast(const SeaLayout::CoastSizes& sizes, int most);

class SeaTextures {
  public:
    static constexpr int kUnits = 13;  // bind() uses texture units 0 … kUnits − 1

    // As SeaRenderer::upload() and upload_once().
    void upload(const PackedFrame& frame);
    void upload_once(Frame<float>&& frame, int query);
    // What earlier breaking has left in that sea, for persistent foam; none before the first call.
    void upload_foam(std::shared_ptr<const PackedFoam> foam);
    bool empty() const { return layout_ == nullptr; }
    const SeaLayout& layout() const { return *layout_; }

    // Binds textures and sets uniforms for query.glsl, for points relative to origin_m. The program must be
    // in use.
    void bind(const ShaderProgram& program, glm::dvec2 origin_m);

  private:
    // Returns whether its planes and foam have their textures already.
    bool take_sea(const std::shared_ptr<const SeaLayout>& layout);
    void make_room(std::size_t plane);
    void upload_wakes(const std::vector<glm::vec4>& texels);
    void upload_tables(glm::dvec2 origin_m);

    std::shared_ptr<const SeaLayout> layout_;
    std::vector<GlTexture> planes_;
    std::optional<GlTexture> ellipse_table_, train_table_, train_cycles_, wake_table_, mask_cells_,
        coast_cells_, coast_trains_;
    struct FoamTextures {
        GlTexture nodes, pages, levels;
    };
    std::shared_ptr<const PackedFoam> foam_;
    std::optional<FoamTextures> foam_textures_;
    GlBuffer tables_;
    double time_within_loop_s_ = 0.0;

    struct Staging {
        std::array<std::optional<GlBuffer>, 3> planes;
    };
    std::array<Staging, 2> staging_;  // one is filled while the driver copies from the other
    std::size_t next_staging_ = 0;
};

}  // namespace pelagic
