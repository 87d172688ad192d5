// The objects of a picture on the GPU: their meshes, a map of their depth towards the sun, and pictures of them as the sea mirrors them and as one
// sees them in it.
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/evaluate/hulls.h"
#include "core/evaluate/object_place.h"
#include "core/lighting/object.h"
#include "core/surface/view.h"
#include "pelagic/object_mesh.h"
#include "pelagic/scene.h"
#include "plugin/host/gpu/objects_view.h"
#include "plugin/host/gpu/packed_hulls.h"
#include "plugin/host/gpu/uniforms.h"
#include "plugin/host/preview/gl_objects.h"
#include "plugin/host/preview/shader_program.h"

namespace pelagic {

// An object where it is at one time.
struct DrawnObject {
    std::shared_ptr<const ObjectMesh> mesh;
    glm::dvec3 place_m{0.0};  // of its origin, over the flat sea
    glm::dmat3 axes{1.0};     // its own in the world, level there, times its scale
    double water_m = 0.0;     // height of the water at it
    glm::vec3 colour{1.0f};
    float glow = 0.0f;  // radiance of a material that glows wholly [kcd/m²]
    bool holdout = false;
    std::shared_ptr<const Hull> hull{};  // with what it keeps out, if anything
    Hulls::Beside beside{};              // the water along it, where its foam is known
};

// A scene's, which have meshes, in its sea; their foam where its plan has a hulls_query(). Any thread; needs no context.
std::vector<DrawnObject> drawn_objects(const Frame<float>& state, const Scene& scene, const ObjectMoment& at);

class DrawnObjects {
  public:
    // Meshes that are there already stay as they are; those of no object any more go.
    void set(std::vector<DrawnObject> objects, const ObjectSurroundings& surroundings);
    bool empty() const { return objects_.empty(); }
    bool has_images() const;

    // What a picture of them needs: the eye's place in the grid whose origin is given, and the sun.
    struct Eye {
        View view;
        glm::dvec2 origin_m{0.0};
        double curvature_per_m = 0.0, near_m = 0.05;
        glm::dvec3 to_sun{0.0, 0.0, 1.0};
        double sun_angular_radius = 0.0;  // 0: nothing throws a shadow
        bool reversed_depth = false;
        int largest_texture = 1 << 12;
    };
    void place(const Eye& eye);
    // The maps of what place() was told; the programs are of ShaderVariant::of_object_shadow() and of_object(). Leave other framebuffers
    // and viewports bound.
    void draw_shadow(const ShaderProgram& program);
    // The program must be in use, with all that isn't of objects set.
    void draw_mirrored(const ShaderProgram& program, int first_unit);
    bool any_in_water() const { return in_water_.from.size.x > 0; }
    void draw_in_water(const ShaderProgram& program, int first_unit);
    void draw(const ShaderProgram& program, int first_unit);
    // For the sea's program, which is in use.
    static constexpr int kUnits = 8;  // from first_unit on
    void bind(const ShaderProgram& program, int first_unit) const;
    // For the program of its points alone.
    void bind_hulls(const ShaderProgram& program, int first_unit) const;

    // [bytes] of a scene's meshes, here and at the driver's, and of the maps; 0 without objects.
    static std::size_t bytes(const Scene& scene);

  private:
    struct Mesh {
        std::shared_ptr<const ObjectMesh> of;
        GlVertexArray array;
        GlBuffer vertices;
        GlTexture materials;
        GLsizei count = 0;
        // Vertices side by side with one picture, or with none (−1).
        struct Part {
            int image = -1;
            GLint first = 0;
            GLsizei count = 0;
        };
        std::vector<Part> parts;
        std::vector<std::unique_ptr<GlTexture>> images;
    };
    // What the sea shows of all objects: its image of them, and them in the water.
    struct Seen {
        GlTexture light, depth;
        GlFramebuffer framebuffer;
        ObjectsView from;
    };
    const Mesh& mesh_of(const DrawnObject& object) const;
    std::array<glm::dvec3, 8> corners(std::size_t object) const;
    void set_hulls();
    void place_hulls();
    void fit_shadow();
    void size(Seen& seen, bool has_levels) const;
    void draw_into(const Seen& seen, const ShaderProgram& program, int first_unit) const;
    void draw_all(const ShaderProgram& program, const glm::dmat4& clip_from_grid, glm::dvec3 eye_m,
                  int first_unit) const;
    void bind_shadow(const ShaderProgram& program, int first_unit) const;

    std::vector<DrawnObject> objects_;
    std::vector<Uniform> surroundings_;
    std::vector<Mesh> meshes_;
    PackedHulls hulls_{{}};
    GlTexture hull_maps_, hull_places_;
    Eye eye_;
    std::vector<glm::dmat4> grid_from_;  // of each object
    std::vector<ViewedBody> bodies_;

    GlTexture shadow_;
    GlFramebuffer shadow_framebuffer_;
    Seen mirrored_, in_water_;
    GlSampler compares_;
    bool has_shadow_ = false;
    int shadow_side_ = 0;
    glm::dmat4 shadow_from_grid_{1.0};
    glm::dvec3 shadow_reach_m_{1.0};
};

}  // namespace pelagic
