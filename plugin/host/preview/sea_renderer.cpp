#include "plugin/host/preview/sea_renderer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "core/lighting/tone.h"
#include "plugin/host/gpu/sea_layout.h"
#include "plugin/host/gpu/shader_variants.h"
#include "plugin/host/gpu/uniforms.h"
#include "plugin/host/preview/drawn_objects.h"
#include "plugin/host/preview/gl_objects.h"
#include "plugin/host/preview/gl_stage_timer.h"
#include "plugin/host/preview/gl_textures.h"
#include "plugin/host/preview/sea_textures.h"
#include "plugin/host/preview/shader_program.h"
#include "plugin/render/seen_drops.h"
#include "plugin/render/waterline.h"

namespace pelagic {
namespace {

// Texture units. SeaTextures has the first ones.
enum OtherUnit : int {
    kSkyMap = SeaTextures::kUnits,
    kAirTable,
    kSprayMapUnit,
    kDither,
    kFoamImage,
    kFloorMaps,
    kPictures
};

constexpr int kTerms = 5;  // sea, sun, sky, foam, air: sea_outputs.glsl
constexpr std::array<const char*, kTerms> kPictureNames{"sea_picture", "sun_picture", "sky_picture",
                                                        "foam_picture", "air_picture"};

constexpr int kObjectUnits = kPictures + kTerms;

constexpr std::array<const char*, 3> kPointNames{"first_points", "second_points", "third_points"};

void set_uniform(GLint at, const glm::vec3& v) {
    glUniform3f(at, v.x, v.y, v.z);
}

// Restores the caller's framebuffers and viewport.
class KeptFramebuffer {
  public:
    KeptFramebuffer() {
        glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_);
        glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_);
        glGetIntegerv(GL_VIEWPORT, viewport_.data());
    }
    ~KeptFramebuffer() {
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_));
        glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_));
        glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
    }
    KeptFramebuffer(const KeptFramebuffer&) = delete;
    KeptFramebuffer& operator=(const KeptFramebuffer&) = delete;

  private:
    GLint draw_ = 0, read_ = 0;
    std::array<GLint, 4> viewport_{};
};

}  // namespace

struct SeaRenderer::Implementation {
    Implementation();

    void upload_mesh(const SeaMesh& mesh);
    void upload_shape(const SeaMesh& mesh);
    void make_pictures(glm::ivec2 size, bool layers);
    static void require_framebuffer();
    void make_dither();
    void set_common(const ShaderProgram& program, const View& view) const;
    void set_air(double height_m);
    void draw_mesh(const ShaderProgram& program, const View& view, const SeaMesh& mesh);
    void draw_over_all(const ShaderProgram& program) const;
    void begin_picture(glm::ivec2 size, bool layers);
    void draw_points(const View& view, const SeaMesh& mesh, bool has_objects);
    void place_objects(const View& view, const SeaMesh& mesh, bool has_sun);
    void end_picture() const;
    void set_foam_image(const std::shared_ptr<const FoamImage>& image);
    void draw_sea(const View& view, const SeaMesh& mesh, const DrawOptions& options);
    void draw_sky(const View& view, const DrawOptions& options);
    void draw_drops(const View& view, const DrawOptions& options);
    void draw_object_maps(const View& view, const SeaMesh& mesh, const DrawOptions& options);
    const ShaderProgram& use_object_program(const View& view, const DrawOptions& options,
                                            ObjectPicture picture);
    const ShaderProgram& program_of(const ShaderVariant& variant);

    GLint largest_texture = 0;
    bool reversed_depth = false;

    SeaTextures sea;

    GlTexture sky_map, dither_tile;
    int sky_map_size = 0;
    std::vector<Uniform> light, water;
    bool water_has_body = false;
    glm::dvec3 to_sun{0.0, 0.0, 1.0};
    double sun_angular_radius = 0.0;  // 0: it doesn't shine
    std::optional<DrawnObjects> objects;
    std::shared_ptr<const AirModel> air_model;
    GlTexture air_table;
    std::optional<double> air_height_m;  // of the eye that the table is for
    std::vector<Uniform> air;
    Air seen_air;  // that the table has
    GlTexture foam_texture;
    std::shared_ptr<const FoamImage> foam_image;  // that the texture has
    bool has_foam_texture = false;
    std::shared_ptr<const Floor> floor;
    double curvature_per_m = 0.0;  // of the picture's sea
    GlTexture floor_maps;
    GlTexture spray_map;
    std::vector<Uniform> spray;  // empty: there is none
    struct Drops {
        Spray spray;
        std::shared_ptr<const std::vector<SprayDrop>> drops;
        double late_s = 0.0;
        GlVertexArray array;
        GlBuffer discs;
    };
    std::optional<Drops> drops;

    GlVertexArray grid_array, no_array;
    GlBuffer grid_vertices, shape_vertices, grid_indices;
    glm::ivec2 grid_size{0};
    GLsizei grid_index_count = 0;

    GlFramebuffer framebuffer, points_framebuffer;
    std::array<GlTexture, kTerms> pictures;
    std::array<GlTexture, kPointNames.size()> points;  // what each pixel of the sea shows, before its light
    GlTexture depth;
    glm::ivec2 picture_size{0};
    bool picture_layers = false, picture_plain = false, picture_objects = false;
    double near_m = kNear_m;  // of the picture that is drawn

    std::map<std::string, ShaderProgram> programs;  // by ShaderVariant::key()
    GlStageTimer timer;
    double submit_ms = 0.0;
};

SeaRenderer::Implementation::Implementation() {
    if (epoxy_gl_version() < 33 || !epoxy_is_desktop_gl())
        throw PreviewError("the preview needs OpenGL 3.3, and this driver (" +
                           std::string(reinterpret_cast<const char*>(glGetString(GL_RENDERER))) + ") has " +
                           std::string(reinterpret_cast<const char*>(glGetString(GL_VERSION))) +
                           ": update it, or use pelagic render");
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_texture);
    reversed_depth = epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_ARB_clip_control");
    make_pictures(glm::ivec2(4), true);
    make_dither();
}

void SeaRenderer::Implementation::make_dither() {
    constexpr int kSide = 64;
    std::vector<glm::vec4> texels;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) texels.emplace_back(dither({x, y}), 1.0f);
    edit_texture(dither_tile);
    texels_as_they_are();
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, kSide, kSide, 0, GL_RGBA, GL_FLOAT, texels.data());
}

// Shaders.

const ShaderProgram& SeaRenderer::Implementation::program_of(const ShaderVariant& variant) {
    const auto found = programs.find(variant.key());
    if (found != programs.end()) return found->second;
    ShaderProgram program(variant.vertex(), variant.fragment());
    program.use();
    glUniform1i(program.uniform("sky_map"), kSkyMap);
    glUniform1i(program.uniform("air_table"), kAirTable);
    glUniform1i(program.uniform("spray_map"), kSprayMapUnit);
    glUniform1i(program.uniform("dither"), kDither);
    glUniform1i(program.uniform("foam_image"), kFoamImage);
    glUniform1i(program.uniform("floor_maps"), kFloorMaps);
    for (int i = 0; i < kTerms; ++i) glUniform1i(program.uniform(kPictureNames[i]), kPictures + i);
    // No program reads two of these kinds.
    glUniform1i(program.uniform("sea_depth"), kPictures);
    for (std::size_t i = 0; i < kPointNames.size(); ++i)
        glUniform1i(program.uniform(kPointNames[i]), kPictures + static_cast<int>(i));
    return programs.emplace(variant.key(), std::move(program)).first->second;
}

void SeaRenderer::Implementation::upload_mesh(const SeaMesh& mesh) {
    const ProjectedGrid& grid = mesh.points;
    struct Vertex {
        glm::vec2 rest_m;
        float cell_m;
        glm::vec2 cell_axis_m;
        float pixel_m;
        glm::vec2 pixel_axis_m;
    };
    std::vector<Vertex> vertices(grid.rest_m.size());
    for (std::size_t i = 0; i < vertices.size(); ++i)
        vertices[i] = {grid.rest_m[i], grid.cell_m[i], grid.cell_axis_m[i], grid.pixel_m[i],
                       grid.pixel_axis_m[i]};
    glBindVertexArray(grid_array.name());
    glBindBuffer(GL_ARRAY_BUFFER, grid_vertices.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(),
                 GL_STREAM_DRAW);
    const auto attribute = [](GLuint location, GLint size, std::size_t offset) {
        glEnableVertexAttribArray(location);
        glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                              reinterpret_cast<const void*>(offset));
    };
    attribute(0, 2, offsetof(Vertex, rest_m));
    attribute(1, 3, offsetof(Vertex, cell_m));
    attribute(2, 3, offsetof(Vertex, pixel_m));
    upload_shape(mesh);
    // Whole grids of one size have the same triangles.
    const glm::ivec2 size = mesh.normal.empty() ? glm::ivec2(grid.columns, grid.rows) : glm::ivec2(0);
    if (size.x > 0 && grid_size == size) return;
    grid_size = size;
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, grid_indices.name());
    glBufferData(GL_ELEMENT_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(mesh.triangles.size() * sizeof(std::uint32_t)),
                 mesh.triangles.data(), GL_STATIC_DRAW);
    grid_index_count = static_cast<GLsizei>(mesh.triangles.size());
}

// Of a surface that isn't flat; no shader asks for it of others.
void SeaRenderer::Implementation::upload_shape(const SeaMesh& mesh) {
    constexpr GLuint kShape = 3;
    if (mesh.normal.empty()) return glDisableVertexAttribArray(kShape);
    std::vector<glm::vec4> shapes(mesh.normal.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i] = glm::vec4(mesh.normal[i], mesh.height_m[i]);
    glBindBuffer(GL_ARRAY_BUFFER, shape_vertices.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(shapes.size() * sizeof(glm::vec4)), shapes.data(),
                 GL_STREAM_DRAW);
    glEnableVertexAttribArray(kShape);
    glVertexAttribPointer(kShape, 4, GL_FLOAT, GL_FALSE, sizeof(glm::vec4), nullptr);
}

// Pictures.

void SeaRenderer::Implementation::require_framebuffer() {
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw PreviewError("the driver cannot draw into pictures of 32-bit floats (framebuffer status " +
                           std::to_string(status) + "): update it, or use pelagic render");
}

void SeaRenderer::Implementation::make_pictures(glm::ivec2 size, bool layers) {
    if (size.x < 1 || size.y < 1 || std::max(size.x, size.y) > largest_texture)
        throw PreviewError("a picture of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                           " does not fit the driver, whose largest is " + std::to_string(largest_texture) +
                           " a side: ask for a smaller one");
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    if (size == picture_size && layers == picture_layers) return;
    std::array<GLenum, kTerms> attachments{};
    for (int i = 0; i < kTerms; ++i) {
        const bool used = i == 0 || layers;
        attachments[i] = used ? GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i) : GL_NONE;
        edit_texture(pictures[i]);
        texels_as_they_are();
        const glm::ivec2 of = used ? size : glm::ivec2(1);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, of.x, of.y, 0, GL_RGBA, GL_FLOAT, nullptr);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i), GL_TEXTURE_2D,
                               used ? pictures[i].name() : 0, 0);
    }
    edit_texture(depth);
    texels_as_they_are();
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size.x, size.y, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                 nullptr);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth.name(), 0);
    glDrawBuffers(kTerms, attachments.data());
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    require_framebuffer();
    glBindFramebuffer(GL_FRAMEBUFFER, points_framebuffer.name());
    for (std::size_t i = 0; i < points.size(); ++i) {
        edit_texture(points[i]);
        texels_as_they_are();
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, size.x, size.y, 0, GL_RGBA, GL_FLOAT, nullptr);
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i), GL_TEXTURE_2D,
                               points[i].name(), 0);
    }
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth.name(), 0);
    glDrawBuffers(
        static_cast<GLsizei>(points.size()),
        std::array<GLenum, 3>{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2}.data());
    require_framebuffer();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    picture_size = size;
    picture_layers = layers;
}

void SeaRenderer::Implementation::set_common(const ShaderProgram& program, const View& view) const {
    const auto tangent = view.pixel_tangent();
    set_uniform(program.uniform("view_forward"), glm::vec3(view.forward));
    set_uniform(program.uniform("view_right"), glm::vec3(view.right * tangent));
    set_uniform(program.uniform("view_up"), glm::vec3(view.up * tangent));
    const glm::vec2 centre(0.5 * glm::dvec2(view.resolution) -
                           view.shift * static_cast<double>(view.resolution.x));
    glUniform2f(program.uniform("view_centre"), centre.x, centre.y);
    glUniform1f(program.uniform("view_pixel_tangent"), static_cast<float>(tangent));
    glUniform1f(program.uniform("view_height_m"), static_cast<float>(view.position_m.z));
    bind_texture(kSkyMap, sky_map);
    set_uniforms(program, light);
    set_uniforms(program, water);
    bind_texture(kFloorMaps, floor_maps);
    set_uniforms(program, floor_uniforms(floor ? floor->seen_from({.position_m = view.position_m,
                                                                   .curvature_per_m = curvature_per_m,
                                                                   .pixel_tangent = tangent})
                                               : FloorSeen{}));
    if (spray.empty()) return;
    bind_texture(kSprayMapUnit, spray_map);
    set_uniforms(program, spray);
}

void SeaRenderer::Implementation::set_foam_image(const std::shared_ptr<const FoamImage>& image) {
    bind_texture(kFoamImage, foam_texture);
    if (has_foam_texture && image == foam_image) return;
    const FoamImage none, &shown = image ? *image : none;
    if (std::max(shown.side, shown.rows()) > largest_texture)
        throw PreviewError("effects.foam_pattern is larger than this driver's textures, of " +
                           std::to_string(largest_texture) + " texels a side, have room for");
    texels_as_they_are();
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, shown.side, shown.rows(), 0, GL_RED, GL_FLOAT,
                 shown.texels.data());
    foam_image = image;
    has_foam_texture = true;
}

void SeaRenderer::Implementation::set_air(double height_m) {
    bind_texture(kAirTable, air_table);
    if (air_height_m == height_m) return;
    seen_air = air_model->seen_from(height_m);
    texels_as_they_are();
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, Air::kWidth, Air::kHeight, 0, GL_RGBA, GL_FLOAT,
                 seen_air.texels.data());
    air = air_uniforms(seen_air);
    air_height_m = height_m;
}

void SeaRenderer::Implementation::draw_mesh(const ShaderProgram& program, const View& view,
                                            const SeaMesh& mesh) {
    program.use();
    set_common(program, view);
    sea.bind(program, mesh.points.origin_m);
    set_uniforms(program, air);
    glUniform1f(program.uniform("eye_height_m"), static_cast<float>(view.position_m.z));
    glUniform1f(program.uniform("curvature_per_m"), static_cast<float>(mesh.points.curvature_per_m));
    upload_mesh(mesh);
    const glm::mat4 clip(view.clip_from(glm::dvec3(mesh.points.origin_m, 0.0), near_m));
    glUniformMatrix4fv(program.uniform("clip_from_grid"), 1, GL_FALSE, glm::value_ptr(clip));
    // Reversed depth, near/distance, keeps precision out to the horizon.
    if (reversed_depth)
        glUniform2f(program.uniform("depth_of_distance"), 0.0f, static_cast<float>(near_m));
    else
        glUniform2f(program.uniform("depth_of_distance"), 1.0f, static_cast<float>(-2.0 * near_m));
    glDrawElements(GL_TRIANGLES, grid_index_count, GL_UNSIGNED_INT, nullptr);
}

// One triangle at the far plane. The program must be in use.
void SeaRenderer::Implementation::draw_over_all(const ShaderProgram& program) const {
    glUniform1f(program.uniform("farthest"), reversed_depth ? 0.0f : 1.0f);
    glBindVertexArray(no_array.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void SeaRenderer::Implementation::begin_picture(glm::ivec2 size, bool layers) {
    make_pictures(size, layers);
    glViewport(0, 0, size.x, size.y);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glClearDepth(reversed_depth ? 0.0 : 1.0);
    glClear(GL_DEPTH_BUFFER_BIT);
    if (reversed_depth) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDepthFunc(reversed_depth ? GL_GREATER : GL_LESS);
}

void SeaRenderer::Implementation::end_picture() const {
    glDisable(GL_DEPTH_TEST);
    if (reversed_depth) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glBindVertexArray(0);
    glActiveTexture(GL_TEXTURE0);
}

void SeaRenderer::Implementation::draw_points(const View& view, const SeaMesh& mesh, bool has_objects) {
    glBindFramebuffer(GL_FRAMEBUFFER, points_framebuffer.name());
    const ShaderProgram& program =
        program_of(ShaderVariant::of_points(sea.layout(), !mesh.normal.empty(), has_objects));
    if (has_objects) {
        program.use();
        objects->bind_hulls(program, kObjectUnits);
    }
    draw_mesh(program, view, mesh);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
}

void SeaRenderer::Implementation::draw_sea(const View& view, const SeaMesh& mesh,
                                           const DrawOptions& options) {
    const SeaLayout& layout = sea.layout();
    const ShaderProgram& program = program_of(ShaderVariant::of_sea(layout, options, sky_map_size));
    if (!is_lit_afterwards(options)) {
        program.use();
        set_uniforms(program, foam_uniforms(foam_pattern(options.foam, mesh.points.origin_m)));
        if (options.has_objects) objects->bind(program, kObjectUnits);
        glPolygonMode(GL_FRONT_AND_BACK, options.wireframe ? GL_LINE : GL_FILL);
        draw_mesh(program, view, mesh);
        glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
        return;
    }
    draw_points(view, mesh, options.has_objects);
    program.use();
    set_common(program, view);
    sea.bind(program, mesh.points.origin_m);
    set_uniforms(program, air);
    set_foam_image(options.foam.image);
    set_uniforms(program, foam_uniforms(foam_pattern(options.foam, mesh.points.origin_m)));
    glUniform1f(program.uniform("curvature_per_m"), static_cast<float>(mesh.points.curvature_per_m));
    for (std::size_t i = 0; i < points.size(); ++i) bind_texture(kPictures + static_cast<int>(i), points[i]);
    if (options.has_objects) objects->bind(program, kObjectUnits);
    // Where something is nearer than the far plane.
    glDepthMask(GL_FALSE);
    glDepthFunc(reversed_depth ? GL_LESS : GL_GREATER);
    draw_over_all(program);
    glDepthMask(GL_TRUE);
}

const ShaderProgram& SeaRenderer::Implementation::use_object_program(const View& view,
                                                                     const DrawOptions& options,
                                                                     ObjectPicture picture) {
    const ShaderProgram& program = program_of(ShaderVariant::of_object(options, sky_map_size, picture));
    program.use();
    set_common(program, view);
    set_uniforms(program, air);
    return program;
}

void SeaRenderer::Implementation::place_objects(const View& view, const SeaMesh& mesh, bool has_sun) {
    objects->place({.view = view,
                    .origin_m = mesh.points.origin_m,
                    .curvature_per_m = mesh.points.curvature_per_m,
                    .near_m = near_m,
                    .to_sun = to_sun,
                    .sun_angular_radius = has_sun ? sun_angular_radius : 0.0,
                    .reversed_depth = reversed_depth,
                    .largest_texture = largest_texture});
}

void SeaRenderer::Implementation::draw_object_maps(const View& view, const SeaMesh& mesh,
                                                   const DrawOptions& options) {
    place_objects(view, mesh, options.lighting.sun);
    objects->draw_shadow(program_of(ShaderVariant::of_object_shadow()));
    objects->draw_mirrored(use_object_program(view, options, ObjectPicture::Mirrored), kObjectUnits);
    if (objects->any_in_water() && options.lighting.water && water_has_body)
        objects->draw_in_water(use_object_program(view, options, ObjectPicture::InWater), kObjectUnits);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glViewport(0, 0, picture_size.x, picture_size.y);
}

void SeaRenderer::Implementation::draw_sky(const View& view, const DrawOptions& options) {
    const ShaderProgram& program = program_of(ShaderVariant::of_sky(options, sky_map_size));
    program.use();
    set_common(program, view);
    set_uniforms(program, air);
    glDepthFunc(reversed_depth ? GL_GEQUAL : GL_LEQUAL);
    draw_over_all(program);
}

// Over the picture, from the farthest on.
void SeaRenderer::Implementation::draw_drops(const View& view, const DrawOptions& options) {
    const std::vector<SeenDrop> seen =
        seen_drops(*drops->drops, {.view = view,
                                   .curvature_per_m = curvature_per_m,
                                   .air = options.lighting.air ? &seen_air : nullptr,
                                   .spray = drops->spray,
                                   .late_s = drops->late_s});
    if (seen.empty()) return;
    struct Disc {
        glm::vec2 at_px;
        float radius_px, thickness;
        glm::vec3 radiance;
        float distance_m, depth_m;
    };
    std::vector<Disc> discs;
    discs.reserve(seen.size());
    for (const SeenDrop& drop : seen)
        discs.push_back({glm::vec2(drop.at_px), static_cast<float>(drop.radius_px), drop.thickness(),
                         drop.radiance, drop.distance_m, drop.depth_m});
    glBindVertexArray(drops->array.name());
    glBindBuffer(GL_ARRAY_BUFFER, drops->discs.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(discs.size() * sizeof(Disc)), discs.data(),
                 GL_STREAM_DRAW);
    const auto attribute = [](GLuint location, GLint size, std::size_t offset) {
        glEnableVertexAttribArray(location);
        glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, sizeof(Disc),
                              reinterpret_cast<const void*>(offset));
        glVertexAttribDivisor(location, 1);
    };
    attribute(0, 4, offsetof(Disc, at_px));
    attribute(1, 4, offsetof(Disc, radiance));
    attribute(2, 1, offsetof(Disc, depth_m));

    const ShaderProgram& program = program_of(ShaderVariant::of_drops(options.layers));
    program.use();
    set_common(program, view);
    glUniform2f(program.uniform("picture_size"), static_cast<float>(view.resolution.x),
                static_cast<float>(view.resolution.y));
    const auto near = static_cast<float>(near_m);
    if (reversed_depth)
        glUniform3f(program.uniform("nearness_of_depth"), 0.0f, 1.0f, near);
    else
        glUniform3f(program.uniform("nearness_of_depth"), 1.0f, -1.0f, near);
    // A texture that is drawn to can't be read.
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
    bind_texture(kPictures, depth);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);  // alpha says where there is sea
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(discs.size()));
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDisable(GL_BLEND);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth.name(), 0);
}

SeaRenderer::SeaRenderer() : implementation_(std::make_unique<Implementation>()) {}
SeaRenderer::~SeaRenderer() = default;

int SeaRenderer::largest_texture() const {
    return implementation_->largest_texture;
}

bool SeaRenderer::is_software() const {
    const std::string name = device();
    static constexpr std::array kNames{"llvmpipe", "softpipe", "swrast", "Software Rasterizer",
                                       "SwiftShader"};
    return std::any_of(kNames.begin(), kNames.end(),
                       [&](const char* known) { return name.find(known) != std::string::npos; });
}

std::string SeaRenderer::device() const {
    return std::string(reinterpret_cast<const char*>(glGetString(GL_RENDERER))) + ", OpenGL " +
           reinterpret_cast<const char*>(glGetString(GL_VERSION));
}

void SeaRenderer::set_sky(const Sky& sky, const WaterBody& water) {
    Implementation& of = *implementation_;
    of.light = light_uniforms(sky);
    of.to_sun = glm::dvec3(sky.sun_direction);
    of.sun_angular_radius =
        sky.sun_radiance == glm::vec3(0.0f) ? 0.0 : static_cast<double>(sky.sun_angular_radius);
    set_water(water);
    of.sky_map_size = sky.map.size();
    of.air_model = sky.air;
    of.air = air_uniforms({});  // none until a table is there
    of.air_height_m.reset();
    bind_texture(kSkyMap, of.sky_map);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, std::max(sky.map.level_count() - 1, 0));
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    for (int level = 0; level < sky.map.level_count(); ++level)
        glTexImage2D(GL_TEXTURE_2D, level, GL_RGB32F, sky.map.size() >> level, sky.map.size() >> level, 0,
                     GL_RGB, GL_FLOAT, sky.map.level(level).data());
}

void SeaRenderer::set_water(const WaterBody& water) {
    implementation_->water = water_uniforms(water);
    implementation_->water_has_body = water.has_body;
}

void SeaRenderer::set_floor(std::shared_ptr<const Floor> floor) {
    Implementation& of = *implementation_;
    if (of.floor == floor) return;
    of.floor = std::move(floor);
    if (!of.floor || of.floor->values().empty()) return;
    const std::vector<float>& values = of.floor->values();
    const auto columns = static_cast<std::size_t>(kFloorColumns);
    const std::size_t rows = values.size() / columns, rest = values.size() % columns;
    edit_texture(of.floor_maps);
    texels_as_they_are();
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, kFloorColumns, static_cast<GLsizei>(rows + (rest > 0 ? 1 : 0)), 0,
                 GL_RED, GL_FLOAT, nullptr);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kFloorColumns, static_cast<GLsizei>(rows), GL_RED, GL_FLOAT,
                    values.data());
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, static_cast<GLint>(rows), static_cast<GLsizei>(rest),
                    rest > 0 ? 1 : 0, GL_RED, GL_FLOAT, values.data() + rows * columns);
}

void SeaRenderer::set_spray(const Spray& spray, std::shared_ptr<const std::vector<SprayDrop>> drops,
                            double late_s) {
    Implementation& of = *implementation_;
    of.spray.clear();
    if (spray.empty() || !drops || drops->empty()) {
        of.drops.reset();
    } else {
        if (!of.drops) of.drops.emplace();
        of.drops->spray = spray;
        of.drops->drops = std::move(drops);
        of.drops->late_s = late_s;
    }
    if (spray.empty()) return;
    of.spray = spray_uniforms(spray);
    edit_texture(of.spray_map);
    texels_as_they_are();
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, spray.columns,
                 static_cast<int>(spray.texels.size()) / spray.columns, 0, GL_RGBA, GL_FLOAT,
                 spray.texels.data());
}

void SeaRenderer::set_objects(std::vector<DrawnObject> objects, const ObjectSurroundings& surroundings) {
    Implementation& of = *implementation_;
    if (objects.empty()) return of.objects.reset();
    if (!of.objects) of.objects.emplace();
    of.objects->set(std::move(objects), surroundings);
}

void SeaRenderer::upload(const PackedFrame& frame) {
    Implementation& of = *implementation_;
    const GlStageTimer::Measured measured(of.timer, GlStageTimer::Upload);
    of.sea.upload(frame);
}
void SeaRenderer::upload_once(Frame<float>&& frame, int query) {
    implementation_->sea.upload_once(std::move(frame), query);
}
bool SeaRenderer::has_frame() const {
    return !implementation_->sea.empty();
}

void SeaRenderer::upload_foam(std::shared_ptr<const PackedFoam> foam) {
    implementation_->sea.upload_foam(std::move(foam));
}

SeaRenderer::ShownPoints SeaRenderer::shown_points(const View& view, const SeaMesh& mesh) {
    Implementation& of = *implementation_;
    const KeptFramebuffer kept;
    of.near_m = kNear_m;
    of.begin_picture(view.resolution, of.picture_layers);
    // No pixel of the sea has a footprint of 0.
    glBindFramebuffer(GL_FRAMEBUFFER, of.points_framebuffer.name());
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    if (of.objects) of.place_objects(view, mesh, false);
    of.draw_points(view, mesh, of.objects.has_value());
    of.end_picture();
    glBindFramebuffer(GL_FRAMEBUFFER, of.points_framebuffer.name());
    const auto count =
        static_cast<std::size_t>(view.resolution.x) * static_cast<std::size_t>(view.resolution.y);
    std::array<std::vector<glm::vec4>, 2> texels;
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        texels[i].resize(count);
        glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i));
        glReadPixels(0, 0, view.resolution.x, view.resolution.y, GL_RGBA, GL_FLOAT, texels[i].data());
    }
    ShownPoints shown;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec4 &first = texels[0][i], &second = texels[1][i];
        if (!(first.z > 0.0f)) continue;
        shown.rest_m.emplace_back(first);
        shown.pixel_m.push_back(first.z);
        shown.pixel_axis_m.emplace_back(first.w, second.x);
    }
    return shown;
}

void SeaRenderer::draw(const View& view, const SeaMesh& mesh, const DrawOptions& options) {
    const auto started = std::chrono::steady_clock::now();
    Implementation& of = *implementation_;
    const KeptFramebuffer kept;
    DrawOptions drawn = options;
    drawn.lighting.air = options.lighting.air && of.air_model;
    drawn.lighting.spray = options.lighting.spray && !of.spray.empty() && !options.from_below;
    drawn.is_shaped = !mesh.normal.empty();
    drawn.has_objects = of.objects && !options.from_below;
    drawn.has_images = drawn.has_objects && of.objects->has_images();
    drawn.sky_from_air = of.air_model && of.air_model->has_sky();
    if (of.air_model) of.set_air(view.position_m.z);
    of.near_m = options.behind_glass ? kFrontGlass_m : kNear_m;
    of.curvature_per_m = mesh.points.curvature_per_m;
    of.begin_picture(view.resolution, options.layers);
    of.picture_objects = of.objects.has_value();
    of.picture_plain = options.wireframe || options.false_colour != FalseColour::None;
    {
        const GlStageTimer::Measured measured(of.timer, GlStageTimer::Sea);
        if (drawn.has_objects) of.draw_object_maps(view, mesh, drawn);
        if (!of.sea.empty()) of.draw_sea(view, mesh, drawn);
        if (drawn.has_objects) {
            glDepthFunc(of.reversed_depth ? GL_GREATER : GL_LESS);
            of.objects->draw(of.use_object_program(view, drawn, ObjectPicture::Seen), kObjectUnits);
        }
    }
    {
        const GlStageTimer::Measured measured(of.timer, GlStageTimer::Sky);
        of.draw_sky(view, drawn);
        if (of.drops && drawn.lighting.spray && !of.picture_plain) of.draw_drops(view, drawn);
    }

    of.end_picture();
    of.submit_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
}

void SeaRenderer::show(float exposure, const glm::mat3& white_balance) {
    Implementation& of = *implementation_;
    const ShaderProgram& program =
        of.program_of(ShaderVariant::of_screen(of.picture_layers, of.picture_plain));
    std::array<GLint, 4> viewport{};
    glGetIntegerv(GL_VIEWPORT, viewport.data());
    if (viewport[2] < 1 || viewport[3] < 1) return;  // an empty window
    const GlStageTimer::Measured measured(of.timer, GlStageTimer::Show);
    program.use();
    for (int i = 0; i < kTerms; ++i) bind_texture(kPictures + i, of.pictures[i]);
    bind_texture(kDither, of.dither_tile);
    glUniform2f(program.uniform("picture_from_window"),
                static_cast<float>(of.picture_size.x) / static_cast<float>(viewport[2]),
                static_cast<float>(of.picture_size.y) / static_cast<float>(viewport[3]));
    glUniform2f(program.uniform("window_first"), static_cast<float>(viewport[0]),
                static_cast<float>(viewport[1]));
    glUniform1f(program.uniform("exposure"), exposure);
    glUniformMatrix3fv(program.uniform("white_balance"), 1, GL_FALSE, &white_balance[0].x);
    glUniform1f(program.uniform("farthest"), 0.0f);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glBindVertexArray(of.no_array.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
    glActiveTexture(GL_TEXTURE0);
}

Picture SeaRenderer::read_layers() const {
    const Implementation& of = *implementation_;
    const KeptFramebuffer kept;
    glBindFramebuffer(GL_FRAMEBUFFER, of.framebuffer.name());
    const auto width = static_cast<std::size_t>(of.picture_size.x),
               height = static_cast<std::size_t>(of.picture_size.y);
    Picture picture{of.picture_size, std::vector<SeaRadiance>(width * height),
                    std::vector<std::uint8_t>(width * height)};
    constexpr std::array<glm::vec3 SeaRadiance::*, kTerms> kTerm{
        &SeaRadiance::sea, &SeaRadiance::sun, &SeaRadiance::sky, &SeaRadiance::foam, &SeaRadiance::air};
    std::vector<glm::vec4> texels(width * height);
    std::vector<bool> is_object(of.picture_objects ? width * height : 0);
    for (int i = 0; i < (of.picture_layers ? kTerms : 1); ++i) {
        glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i));
        glPixelStorei(GL_PACK_ALIGNMENT, 4);
        glReadPixels(0, 0, of.picture_size.x, of.picture_size.y, GL_RGBA, GL_FLOAT, texels.data());
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                const glm::vec4& texel = texels[(height - 1 - y) * width + x];
                const std::size_t at = y * width + x;
                if (i == 0) picture.sea[at] = texel.w > 0.5f;
                if (i == 0 && of.picture_objects) is_object[at] = texel.w < 0.0f;
                const auto term = of.picture_layers || picture.sea[at] ? kTerm[i] : &SeaRadiance::sky;
                picture.layers[at].*term = glm::vec3(texel);
            }
    }
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    if (!of.picture_objects) return picture;
    std::vector<float>& object = picture.data[index(PictureLayer::Object)];
    object.assign(3 * is_object.size(), 0.0f);
    picture.data[index(PictureLayer::Reflection)] = object;
    for (std::size_t at = 0; at < is_object.size(); ++at)
        if (is_object[at]) {
            const glm::vec3 light = std::exchange(picture.layers[at].sky, glm::vec3(0.0f));
            for (int c = 0; c < 3; ++c) object[3 * at + static_cast<std::size_t>(c)] = light[c];
        }
    return picture;
}

StageTimes SeaRenderer::times() const {
    const Implementation& of = *implementation_;
    return {.upload_ms = of.timer.milliseconds(GlStageTimer::Upload),
            .sea_ms = of.timer.milliseconds(GlStageTimer::Sea),
            .sky_ms = of.timer.milliseconds(GlStageTimer::Sky),
            .show_ms = of.timer.milliseconds(GlStageTimer::Show),
            .submit_ms = of.submit_ms};
}

}  // namespace pelagic
