// The shader variants: one for each choice of terms and kind of sea, so that a term that is off costs
// nothing.
#pragma once

#include <string>
#include <vector>

#include "plugin/host/gpu/draw_options.h"
#include "plugin/host/gpu/sea_layout.h"
#include "plugin/host/gpu/shader_source.h"

namespace pelagic {

// Whether the sea is drawn in two passes: first the point at rest of each pixel, then its light, once. A driver in
// software shades small triangles in blocks of pixels, and most of a block lies outside.
bool is_lit_afterwards(const DrawOptions& options);

// Objects whose boxes the sea's rays are tested against; a picture's alpha where it shows an object.
inline constexpr int kObjectBoxes = 16;
inline constexpr float kIsObject = -1.0f;

// Of an object: for the eye, for its mirror image, and what of it the eye sees in the water.
enum class ObjectPicture { Seen, Mirrored, InWater };

class ShaderVariant {
  public:
    static ShaderVariant of_sea(const SeaLayout& layout, const DrawOptions& options, int sky_map_size);
    // The first of two passes.
    static ShaderVariant of_points(const SeaLayout& layout, bool is_shaped, bool has_objects);
    static ShaderVariant of_sky(const DrawOptions& options, int sky_map_size);
    static ShaderVariant of_object(const DrawOptions& options, int sky_map_size, ObjectPicture picture);
    static ShaderVariant of_object_shadow();
    static ShaderVariant of_drops(bool layers);
    static ShaderVariant of_screen(bool layers, bool plain);

    // Equal for variants with equal source text.
    const std::string& key() const { return key_; }
    ShaderSource vertex() const { return source(vertex_); }
    ShaderSource fragment() const { return source(fragment_); }

  private:
    ShaderVariant(std::string constants, std::vector<std::string_view> vertex,
                  std::vector<std::string_view> fragment);
    ShaderSource source(const std::vector<std::string_view>& files) const;

    std::string constants_, key_;
    std::vector<std::string_view> vertex_, fragment_;
};

// The files of core/lighting in order, without air.glsl, place.glsl, background.glsl and tone.glsl.
const std::vector<std::string_view>& lighting_files();
// The files of the shared formulas and of the query; their constants.
const std::vector<std::string_view>& query_files();
std::string query_constants(const SeaLayout& layout, bool coverage, bool is_shaped = false);
std::string lighting_constants(const LightingChoice& choice, int sky_map_size, bool floor_maps = false);

}  // namespace pelagic
