#include "plugin/host/preview/drawn_objects.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/plan/hulls.h"
#include "core/plan/plan.h"
#include "core/scene/hull.h"
#include "core/surface/earth.h"
#include "plugin/host/gpu/shader_variants.h"
#include "plugin/host/preview/gl_textures.h"
#include "plugin/host/preview/sea_renderer.h"

namespace pelagic {
namespace {

// The objects' own programs ask for no hulls.
enum Unit : int {
    kMaterials,
    kShadow,
    kBlockers,
    kMirrored,
    kHullMaps,
    kHullPlaces,
    kInWater,
    kInWaterDepth,
    kImage = kHullMaps
};

struct Vertex {
    glm::vec3 place_m, normal;
    float material;
};
struct ImageVertex {
    Vertex vertex;
    glm::vec2 image_at;
};

constexpr int kShadowSide = 2048;  // texels, at most

void set_matrix(const ShaderProgram& program, const char* name, const glm::dmat4& value) {
    const glm::mat4 rounded(value);
    glUniformMatrix4fv(program.uniform(name), 1, GL_FALSE, glm::value_ptr(rounded));
}

// With the picture's own mip levels, from the largest one on that the driver takes.
void set_image(const GlTexture& texture, const ObjectImage& image) {
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    edit_texture(texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    // As many taps as plugin/render/objects.cpp has.
    if (epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic"))
        glTexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAX_ANISOTROPY_EXT, 8.0f);
    glPixelStorei(GL_UNPACK_ALIGNMENT, sizeof(std::uint16_t));
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    GLint number = 0;
    for (const ObjectImage::Level& level : image.levels())
        if (std::max(level.width, level.height) <= largest)
            glTexImage2D(GL_TEXTURE_2D, number++, GL_RGB16F, level.width, level.height, 0, GL_RGB,
                         GL_HALF_FLOAT, level.rgb.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, number - 1);
}

glm::dmat4 translation(glm::dvec3 by) {
    glm::dmat4 made(1.0);
    made[3] = glm::dvec4(by, 1.0);
    return made;
}

}  // namespace

std::vector<DrawnObject> drawn_objects(const Frame<float>& state, const Scene& scene,
                                       const ObjectMoment& at) {
    std::vector<DrawnObject> drawn;
    std::vector<Hulls::Beside> beside(scene.objects.size());
    ObjectMoment moment = at;
    if (const std::optional<int> query = hulls_query(state.sea().plan())) {
        moment.query = *query;
        Hulls hulls(scene);
        hulls.place(state, query, at.frame, at.rest_m);
        beside = hulls.beside(state, query);
    }
    for (const SceneObject& object : scene.objects) {
        const auto [pose, water_m] = place_object(state, scene, object, moment);
        drawn.push_back(
            {.mesh = object.mesh,
             .place_m = pose.place_m,
             .axes = pose.scale * pose.turn,
             .water_m = water_m,
             .colour = glm::vec3(object.colour),
             // Radiance 1 is a thousand cd/m² by daylight; a sky's picture counts as if it were so.
             .glow = static_cast<float>(1e-3 * object.glow_cd_m2),
             .holdout = object.holdout,
             .hull = hull_of(*object.mesh),
             .beside = std::move(beside[drawn.size()])});
    }
    return drawn;
}

void DrawnObjects::set(std::vector<DrawnObject> objects, const ObjectSurroundings& surroundings) {
    objects_ = std::move(objects);
    surroundings_ = surroundings_uniforms(surroundings);
    std::erase_if(meshes_, [&](const Mesh& mesh) {
        return std::ranges::none_of(objects_,
                                    [&](const DrawnObject& object) { return object.mesh == mesh.of; });
    });
    for (const DrawnObject& object : objects_) {
        if (std::ranges::any_of(meshes_, [&](const Mesh& mesh) { return mesh.of == object.mesh; })) continue;
        const ObjectMeshData& data = object.mesh->data();
        Mesh& mesh = meshes_.emplace_back();
        mesh.of = object.mesh;
        mesh.count = static_cast<GLsizei>(data.triangles.size());
        const auto vertex = [&](std::size_t i) {
            return Vertex{data.points_m[data.triangles[i]], data.normals[i],
                          static_cast<float>(data.material[i / 3])};
        };
        std::vector<Vertex> vertices;
        std::vector<ImageVertex> with_images;
        if (data.image_at.empty()) {
            vertices.resize(data.triangles.size());
            for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = vertex(i);
            mesh.parts.push_back({.count = mesh.count});
        } else {
            const auto image_of = [&](std::size_t triangle) {
                return data.materials[data.material[triangle]].image;
            };
            std::vector<std::size_t> order(data.material.size());
            std::iota(order.begin(), order.end(), std::size_t{0});
            std::ranges::stable_sort(order, {}, image_of);
            for (const std::size_t triangle : order) {
                if (mesh.parts.empty() || mesh.parts.back().image != image_of(triangle))
                    mesh.parts.push_back(
                        {.image = image_of(triangle), .first = static_cast<GLint>(with_images.size())});
                mesh.parts.back().count += 3;
                for (std::size_t i = 3 * triangle; i < 3 * triangle + 3; ++i)
                    with_images.push_back({vertex(i), data.image_at[i]});
            }
            for (const auto& image : data.images)
                set_image(*mesh.images.emplace_back(std::make_unique<GlTexture>()), *image);
        }
        const std::size_t stride = data.image_at.empty() ? sizeof(Vertex) : sizeof(ImageVertex);
        glBindVertexArray(mesh.array.name());
        glBindBuffer(GL_ARRAY_BUFFER, mesh.vertices.name());
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.triangles.size() * stride),
                     data.image_at.empty() ? static_cast<const void*>(vertices.data()) : with_images.data(),
                     GL_STATIC_DRAW);
        const auto attribute = [&](GLuint location, GLint size, std::size_t offset) {
            glEnableVertexAttribArray(location);
            glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                                  reinterpret_cast<const void*>(offset));
        };
        if (!data.image_at.empty()) attribute(3, 2, offsetof(ImageVertex, image_at));
        attribute(0, 3, offsetof(Vertex, place_m));
        attribute(1, 3, offsetof(Vertex, normal));
        attribute(2, 1, offsetof(Vertex, material));
        std::vector<glm::vec4> texels;
        for (const ObjectMaterial& material : data.materials) {
            texels.emplace_back(material.colour, material.roughness);
            texels.emplace_back(material.glow, 0.0f);
        }
        edit_texture(mesh.materials);
        texels_as_they_are();
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 2, static_cast<GLsizei>(data.materials.size()), 0, GL_RGBA,
                     GL_FLOAT, texels.data());
    }
    set_hulls();
}

// Of the objects' hulls, which stay while the meshes do.
void DrawnObjects::set_hulls() {
    std::vector<std::shared_ptr<const Hull>> hulls;
    for (const DrawnObject& object : objects_) hulls.push_back(object.hull);
    PackedHulls packed(std::move(hulls));
    if (packed == hulls_) return;
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (std::max(packed.rows(), kHullColumns) > largest)
        throw PreviewError(
            "the hulls of these objects take a texture of " + std::to_string(kHullColumns) + " x " +
            std::to_string(packed.rows()) + " texels, and this driver's largest is " +
            std::to_string(largest) +
            " a side: give fewer objects, or objects that share a file, or use pelagic render");
    hulls_ = std::move(packed);
    const std::vector<float> maps = hulls_.maps();
    edit_texture(hull_maps_);
    texels_as_they_are();
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, kHullColumns, std::max(hulls_.rows(), 1), 0, GL_RED, GL_FLOAT,
                 maps.empty() ? nullptr : maps.data());
}

void DrawnObjects::place_hulls() {
    std::vector<PlacedHull> hulls;
    for (std::size_t i = 0; i < objects_.size(); ++i)
        hulls.push_back({objects_[i].hull.get(), grid_from_[i], &objects_[i].beside});
    const std::vector<glm::vec4> texels = hulls_.places(hulls);
    edit_texture(hull_places_);
    texels_as_they_are();
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, kHullPlaceColumns,
                 static_cast<GLsizei>(texels.size() / kHullPlaceColumns), 0, GL_RGBA, GL_FLOAT,
                 texels.data());
}

void DrawnObjects::bind_hulls(const ShaderProgram& program, int first_unit) const {
    glUniform1i(program.uniform("hull_maps"), first_unit + kHullMaps);
    glUniform1i(program.uniform("hull_places"), first_unit + kHullPlaces);
    bind_texture(first_unit + kHullMaps, hull_maps_);
    bind_texture(first_unit + kHullPlaces, hull_places_);
    glUniform1f(program.uniform("behind_all"), eye_.reversed_depth ? 1e-30f : 0.99999994f);
}

bool DrawnObjects::has_images() const {
    return std::ranges::any_of(objects_,
                               [](const DrawnObject& object) { return !object.mesh->data().images.empty(); });
}

const DrawnObjects::Mesh& DrawnObjects::mesh_of(const DrawnObject& object) const {
    return *std::ranges::find_if(meshes_, [&](const Mesh& mesh) { return mesh.of == object.mesh; });
}

// Of an object's box, in the grid.
std::array<glm::dvec3, 8> DrawnObjects::corners(std::size_t object) const {
    const glm::dvec3 least = objects_[object].mesh->least_m(), most = objects_[object].mesh->most_m();
    std::array<glm::dvec3, 8> made{};
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 corner((i & 1) != 0 ? most.x : least.x, (i & 2) != 0 ? most.y : least.y,
                                (i & 4) != 0 ? most.z : least.z);
        made[i] = glm::dvec3(grid_from_[object] * glm::dvec4(corner, 1.0));
    }
    return made;
}

void DrawnObjects::place(const Eye& eye) {
    eye_ = eye;
    grid_from_.clear();
    bodies_.clear();
    for (const DrawnObject& object : objects_) {
        const glm::dvec3 flat_m = object.place_m - glm::dvec3(eye.origin_m, 0.0);
        const glm::dvec3 vertical = earth_up(glm::dvec2(flat_m), eye.curvature_per_m);
        glm::dmat4& grid_from = grid_from_.emplace_back();
        for (int axis = 0; axis < 3; ++axis)
            grid_from[axis] = glm::dvec4(from_level(object.axes[axis], vertical), 0.0);
        grid_from[3] = glm::dvec4(on_earth(flat_m, eye.curvature_per_m), 1.0);
        bodies_.push_back({grid_from_box(grid_from, object.mesh->least_m(), object.mesh->most_m()),
                           on_earth(glm::dvec3(glm::dvec2(flat_m), object.water_m), eye.curvature_per_m).z});
    }
    place_hulls();
    fit_shadow();
    const glm::dvec3 eye_m = eye.view.position_m - glm::dvec3(eye.origin_m, 0.0);
    mirrored_.from = mirrored_view(bodies_, eye_m, eye.view.pixel_tangent(), eye.largest_texture);
    in_water_.from = in_water_view(bodies_, eye_m, eye.view.pixel_tangent(), eye.largest_texture);
    size(mirrored_, true);
    if (any_in_water()) size(in_water_, false);
}

// The sun's rays, parallel, round all objects.
void DrawnObjects::fit_shadow() {
    has_shadow_ = eye_.sun_angular_radius > 0.0 && eye_.to_sun.z > 0.0;
    if (!has_shadow_) return;
    const glm::dvec3 ahead = -eye_.to_sun;
    const glm::dvec3 side = glm::normalize(
        glm::cross(ahead, std::abs(ahead.z) < 0.99 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0)));
    const glm::dvec3 up = glm::cross(side, ahead);
    glm::dvec3 least(std::numeric_limits<double>::infinity()), most(-least);
    for (std::size_t i = 0; i < objects_.size(); ++i)
        for (const glm::dvec3& corner : corners(i)) {
            const glm::dvec3 at(glm::dot(side, corner), glm::dot(up, corner), glm::dot(ahead, corner));
            least = glm::min(least, at);
            most = glm::max(most, at);
        }
    shadow_side_ = std::min(kShadowSide, eye_.largest_texture);
    // Texels round the edge see past the objects, as what lies beyond it does.
    const glm::dvec3 room = glm::max((most - least) * (4.0 / shadow_side_), glm::dvec3(1e-3));
    least -= room;
    most += room;
    shadow_reach_m_ = most - least;
    glm::dmat4 turn(1.0);
    for (int axis = 0; axis < 3; ++axis) turn[axis] = glm::dvec4(side[axis], up[axis], ahead[axis], 0.0);
    glm::dmat4 size(1.0);
    for (int axis = 0; axis < 3; ++axis) size[axis][axis] = 1.0 / shadow_reach_m_[axis];
    shadow_from_grid_ = size * translation(-least) * turn;
}

void DrawnObjects::size(Seen& seen, bool has_levels) const {
    const glm::ivec2 size = seen.from.size;
    glm::ivec2 there(0);
    edit_texture(seen.light);
    glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &there.x);
    glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &there.y);
    if (there == size) return;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, has_levels ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, size.x, size.y, 0, GL_RGBA, GL_FLOAT, nullptr);
    edit_texture(seen.depth);
    texels_as_they_are();
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size.x, size.y, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                 nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, seen.framebuffer.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, seen.light.name(), 0);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, seen.depth.name(), 0);
}

void DrawnObjects::draw_shadow(const ShaderProgram& program) {
    if (!has_shadow_) return;
    GLint side = 0;
    edit_texture(shadow_);
    glGetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &side);
    if (side != shadow_side_) {
        texels_as_they_are();
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
        constexpr std::array kNothing{1.0f, 1.0f, 1.0f, 1.0f};
        glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, kNothing.data());
        glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, shadow_side_, shadow_side_, 0,
                     GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
        glSamplerParameteri(compares_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glSamplerParameteri(compares_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glSamplerParameteri(compares_.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
        glSamplerParameteri(compares_.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
        glSamplerParameterfv(compares_.name(), GL_TEXTURE_BORDER_COLOR, kNothing.data());
        glSamplerParameteri(compares_.name(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        glSamplerParameteri(compares_.name(), GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, shadow_framebuffer_.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_.name(), 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    glViewport(0, 0, shadow_side_, shadow_side_);
    GLint depth_func = 0;
    glGetIntegerv(GL_DEPTH_FUNC, &depth_func);
    GLdouble clear_depth = 1.0;
    glGetDoublev(GL_DEPTH_CLEAR_VALUE, &clear_depth);
    glDepthFunc(GL_LESS);
    glClearDepth(1.0);
    glClear(GL_DEPTH_BUFFER_BIT);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5f, 2.0f);
    program.use();
    glm::dmat4 clip(1.0);  // from 0 … 1
    for (int axis = 0; axis < (eye_.reversed_depth ? 2 : 3); ++axis) {
        clip[axis][axis] = 2.0;
        clip[3][axis] = -1.0;
    }
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        set_matrix(program, "clip_from_object", clip * shadow_from_grid_ * grid_from_[i]);
        const Mesh& mesh = mesh_of(objects_[i]);
        glBindVertexArray(mesh.array.name());
        glDrawArrays(GL_TRIANGLES, 0, mesh.count);
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDepthFunc(static_cast<GLenum>(depth_func));
    glClearDepth(clear_depth);
}

void DrawnObjects::bind_shadow(const ShaderProgram& program, int first_unit) const {
    glUniform1i(program.uniform("sun_shadow"), first_unit + kShadow);
    glUniform1i(program.uniform("sun_blockers"), first_unit + kBlockers);
    bind_texture(first_unit + kShadow, shadow_);
    glBindSampler(static_cast<GLuint>(first_unit + kShadow), compares_.name());
    bind_texture(first_unit + kBlockers, shadow_);
    glm::dmat4 from_grid = shadow_from_grid_;
    // Without a sun everything lies before the map.
    if (!has_shadow_) from_grid = translation({0.0, 0.0, -2.0}) * glm::dmat4(0.0);
    set_matrix(program, "shadow_from_grid", from_grid);
    const glm::dvec3& reach = shadow_reach_m_;
    glUniform4f(program.uniform("shadow_reach"), static_cast<float>(reach.x), static_cast<float>(reach.y),
                static_cast<float>(reach.z), static_cast<float>(std::tan(eye_.sun_angular_radius)));
    const double texel_m = std::max(reach.x, reach.y) / std::max(shadow_side_, 1);
    glUniform1f(program.uniform("shadow_off"), static_cast<float>(0.5 * texel_m / reach.z));
    glUniform1f(program.uniform("shadow_texel_m"), static_cast<float>(1.5 * texel_m));
}

void DrawnObjects::draw_all(const ShaderProgram& program, const glm::dmat4& clip_from_grid, glm::dvec3 eye_m,
                            int first_unit) const {
    bind_shadow(program, first_unit);
    set_uniforms(program, surroundings_);
    glUniform1i(program.uniform("object_materials"), first_unit + kMaterials);
    glUniform1i(program.uniform("object_image"), first_unit + kImage);
    glUniform3f(program.uniform("object_eye"), static_cast<float>(eye_m.x), static_cast<float>(eye_m.y),
                static_cast<float>(eye_m.z));
    if (eye_.reversed_depth)
        glUniform2f(program.uniform("depth_of_distance"), 0.0f, static_cast<float>(eye_.near_m));
    else
        glUniform2f(program.uniform("depth_of_distance"), 1.0f, static_cast<float>(-2.0 * eye_.near_m));
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        const DrawnObject& object = objects_[i];
        const Mesh& mesh = mesh_of(object);
        set_matrix(program, "clip_from_object", clip_from_grid * grid_from_[i]);
        set_matrix(program, "grid_from_object", grid_from_[i]);
        glUniform3f(program.uniform("object_colour"), object.colour.x, object.colour.y, object.colour.z);
        glUniform1f(program.uniform("object_glow"), object.glow);
        glUniform1i(program.uniform("object_holdout"), object.holdout ? 1 : 0);
        glUniform1f(program.uniform("object_water_m"), static_cast<float>(bodies_[i].water_m));
        bind_texture(first_unit + kMaterials, mesh.materials);
        glBindVertexArray(mesh.array.name());
        for (const Mesh::Part& part : mesh.parts) {
            glUniform1i(program.uniform("object_has_image"), part.image >= 0 ? 1 : 0);
            if (part.image >= 0)
                bind_texture(first_unit + kImage, *mesh.images[static_cast<std::size_t>(part.image)]);
            glDrawArrays(GL_TRIANGLES, part.first, part.count);
        }
    }
}

void DrawnObjects::draw_into(const Seen& seen, const ShaderProgram& program, int first_unit) const {
    glBindFramebuffer(GL_FRAMEBUFFER, seen.framebuffer.name());
    glViewport(0, 0, seen.from.size.x, seen.from.size.y);
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    draw_all(program, seen.from.clip_from_grid, seen.from.eye_m, first_unit);
}

void DrawnObjects::draw_mirrored(const ShaderProgram& program, int first_unit) {
    draw_into(mirrored_, program, first_unit);
    edit_texture(mirrored_.light);
    glGenerateMipmap(GL_TEXTURE_2D);
}

void DrawnObjects::draw_in_water(const ShaderProgram& program, int first_unit) {
    draw_into(in_water_, program, first_unit);
}

void DrawnObjects::draw(const ShaderProgram& program, int first_unit) {
    draw_all(program, eye_.view.clip_from(glm::dvec3(eye_.origin_m, 0.0), eye_.near_m),
             eye_.view.position_m - glm::dvec3(eye_.origin_m, 0.0), first_unit);
}

void DrawnObjects::bind(const ShaderProgram& program, int first_unit) const {
    bind_shadow(program, first_unit);
    bind_hulls(program, first_unit);
    glUniform1i(program.uniform("mirrored_objects"), first_unit + kMirrored);
    bind_texture(first_unit + kMirrored, mirrored_.light);
    set_matrix(program, "mirrored_from_grid", mirrored_.from.clip_from_grid);
    glUniform1f(program.uniform("mirrored_texels"), static_cast<float>(mirrored_.from.texels));
    glUniform1i(program.uniform("objects_in_water"), first_unit + kInWater);
    glUniform1i(program.uniform("objects_in_water_depth"), first_unit + kInWaterDepth);
    bind_texture(first_unit + kInWater, in_water_.light);
    bind_texture(first_unit + kInWaterDepth, in_water_.depth);
    set_matrix(program, "in_water_from_grid", in_water_.from.clip_from_grid);
    glUniform3f(program.uniform("in_water_ahead"), eye_.reversed_depth ? 0.0f : 1.0f,
                eye_.reversed_depth ? 1.0f : -1.0f, any_in_water() ? static_cast<float>(eye_.near_m) : 0.0f);
    const std::vector<glm::mat4> boxes = object_boxes(bodies_, mirrored_.from.eye_m);
    glUniform1i(program.uniform("object_count"), static_cast<GLint>(boxes.size()));
    glUniformMatrix4fv(program.uniform("object_boxes"), static_cast<GLsizei>(boxes.size()), GL_FALSE,
                       glm::value_ptr(boxes.front()));
}

std::size_t DrawnObjects::bytes(const Scene& scene) {
    if (scene.objects.empty()) return 0;
    std::set<const ObjectMesh*> meshes;
    for (const SceneObject& object : scene.objects) meshes.insert(object.mesh.get());
    std::size_t all = std::size_t{kShadowSide} * kShadowSide * sizeof(float) +
                      std::size_t{kObjectsSide} * kObjectsSide * 2 * (2 * sizeof(glm::vec4));
    all += 2 * hulls_bytes(scene);  // with the texture
    for (const ObjectMesh* mesh : meshes) {
        const ObjectMeshData& data = mesh->data();
        all += 2 * data.triangles.size() * (data.image_at.empty() ? sizeof(Vertex) : sizeof(ImageVertex));
        for (const auto& image : data.images) all += image->bytes();  // the driver's
    }
    return all;
}

}  // namespace pelagic
