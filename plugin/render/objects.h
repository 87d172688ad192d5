// The bodies of a scene ([[objects]]) before a camera: where they are, what rays meet of them, and their light.
//
// Rays know the bodies alone. The sea is what pictures draw (render.h): where a ray goes down, it meets the plane of the water at the body.
// Its light is that of all its waves, seen from afar; of the sun's that they mirror, caustics have the pattern (mirrored_sun.h).
//
// Coordinates: relative to the origin that place() is given [m], in its axes, on the earth where the sea is.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/evaluate/object_place.h"
#include "core/lighting/lighting.h"
#include "core/lighting/object.h"
#include "core/lighting/sky.h"
#include "core/lighting/water.h"
#include "core/waves/frame.h"
#include "pelagic/scene.h"
#include "plugin/render/lamps.h"
#include "plugin/render/mirrored_sun.h"
#include "plugin/render/ray_scene.h"
#include "plugin/render/sea_light.h"

namespace pelagic {

// Numbers for the rays of a sample: the same whatever is computed before. Those of a pixel's samples together are spread evenly
// (Roberts 2018, R2), each pixel's and frame's in their own way (Cranley and Patterson 1976).
struct SampleNumbers {
    std::uint32_t x = 0, y = 0, frame = 0;  // of the pixel
    std::uint32_t index = 0, all = 1;       // of the sample in it
    // As many rays for the sample, at least, that a pixel's samples have so many together.
    std::uint32_t rays(std::uint32_t of_pixel, std::uint32_t least) const {
        return std::max((of_pixel + all - 1) / all, least);
    }
    struct Places {
        std::uint32_t shift_x = 0, shift_y = 0, index = 0;
        // The n-th of `rays` in the unit square.
        glm::vec2 of(std::uint32_t n, std::uint32_t rays) const;
    };
    Places places(std::uint32_t what) const;  // each use has its own
};

class LitObjects {
  public:
    // The scene, with objects whose meshes are there, must outlive it. Throws as make_ray_scene().
    explicit LitObjects(const Scene& scene);

    struct Sea {
        glm::dvec2 origin_m{0.0};
        double curvature_per_m = 0.0;
        RestHeight rest_m;
        bool has_motion = false;  // frames beside this one are asked for, the query has Product::Velocity
    };
    // At a frame, also between two, of a sea that is set to its time. Query 0 is asked for what floats. On all threads.
    template <class T>
    void place(const Frame<T>& state, double frame, const Sea& sea);
    // From now on their light is that of this sea and its sky, which must outlive the next calls.
    template <class T>
    void light(const SeaLight<T>& sea);
    // Whether some have objects[].caustics.
    bool has_caustics() const;
    // Before which eye, over the flat sea [m], whose pixels are so wide, over their distance; and the sea's finest footprints [m].
    struct Seen {
        glm::dvec3 eye_m{0.0};
        double pixel_tangent = 0.0, finest_m = 0.0, finest_cell_m = 0.0;
    };
    // Of the sea's time, where they stand: after place() and light(). All threads of the calling arena. Throws BuildCancelled.
    template <class T>
    void find_caustics(const SeaLight<T>& sea, const Seen& seen, const std::atomic<bool>* cancel);

    // The nearest body that a ray meets.
    RayHit nearest(const Ray& ray) const;
    // Whether a place of the sea is in a hull that keeps the water out.
    bool is_dry(const glm::vec3& place) const;
    // The share of the sun's disc that no body hides from a place, off whose surface `normal` points.
    float sun_share(const glm::vec3& place, const glm::vec3& normal, const SampleNumbers& numbers) const;
    // The same of a place of a body.
    float sun_share(const Ray& ray, const RayHit& hit, const SampleNumbers& numbers) const;
    // Light by rays of chance may be below 0, as their mean isn't: a picture cuts that off from a pixel's whole alone, or few rays would be too
    // bright.
    // What a body sends back along a ray, to an eye in the air, or in the water before a body in it.
    glm::vec3 radiance(const Ray& ray, const RayHit& hit, const SampleNumbers& numbers) const;
    glm::vec3 radiance_in_water(const Ray& ray, const RayHit& hit) const;
    // The same for rays that the sea has mirrored: without varnish, and one ray, by a place of the unit square, tells whether sky and sea are
    // hidden.
    glm::vec3 estimate(const Ray& ray, const RayHit& hit, glm::vec2 number) const;
    // Whether facets of a sea with these hidden slopes (their variances' sum) mirror some body to the eye, 4 deviations far.
    bool may_be_mirrored(const glm::vec3& place, const glm::vec3& to_eye, const glm::vec3& normal,
                         float slope_variance) const;
    // Whether something glows; only then what follows is asked for.
    bool has_lamps() const { return !lamps_.all().empty(); }
    // What facets of the sea at a place mirror of lamps, by places on these beside rays of the facets. Each counts by its part of how
    // densely both look there (the balance heuristic, Veach and Guibas 1995): small lamps are found by their places, and mirrors of lamps by
    // rays. A lamp counts by how much it is brighter than the sky behind it; rays alone have the rest.
    struct LampsInSea {
        std::optional<SeaFacets> facets{};
        glm::vec3 place{0.0f};              // where rays begin
        LampChoice choice{};                // by how much the facets mirror
        std::uint32_t count = 0, rays = 0;  // of places: 0 where that is next to nothing; of rays
    };
    LampsInSea lamps_in(const SeaFacets& facets, const glm::vec3& place, std::uint32_t rays,
                        const SampleNumbers& numbers) const;
    glm::vec3 mirrored_places(const LampsInSea& lamps, const SampleNumbers& numbers) const;
    // A ray that has met a body: the light that is for both, which estimate() has whole, and how much of it counts.
    struct LampMet {
        glm::vec3 light{0.0f};
        float part = 1.0f;
    };
    LampMet lamp_met(const LampsInSea& lamps, const Ray& ray, const RayHit& hit) const;
    // The irradiance of lamps on a surface of the sea; 0 where it is next to nothing beside that of sky and sun.
    glm::vec3 lamplight(const glm::vec3& place, const glm::vec3& normal, const SampleNumbers& numbers) const;
    // Whether a body may be nearer than this.
    bool is_near(const glm::vec3& place, float distance_m) const;
    // From how far a hundredth of a body's light comes through the water [m].
    float sight_in_water_m() const { return sight_in_water_m_; }
    // The sky's light that the sea mirrors where no body is.
    glm::vec3 sky(const glm::vec3& direction) const;

    bool is_holdout(const RayHit& hit) const { return bodies_[hit.body].holdout; }
    // Unit, to the side from which the ray comes.
    glm::vec3 normal(const Ray& ray, const RayHit& hit) const;
    // Where the place of a hit is in the frame before, this one, and the next [m]; without has_motion all are this one.
    std::array<glm::dvec3, 3> places(const Ray& ray, const RayHit& hit) const;

    // What rays and meshes hold [bytes].
    static std::size_t bytes(const Scene& scene);
    std::size_t ray_bytes() const { return rays_->bytes(); }

  private:
    struct Placed {
        glm::dmat3 axes{1.0};  // turn times scale
        glm::dvec3 place_m{0.0};
    };
    struct Body {
        const ObjectMesh* mesh = nullptr;
        glm::vec3 colour{1.0f};
        float glow = 0.0f;  // radiance of a material that glows wholly
        bool holdout = false;
        std::array<Placed, 3> placed;  // in the frame before, this one, and the next
        glm::mat3 axes{1.0f}, into{1.0f};
        glm::vec3 place{0.0f}, centre{0.0f};
        float radius = 0.0f, water_m = 0.0f;
        // The box over the flat sea, from its own origin, and how high the water lies at it, over the sea at rest.
        glm::dvec3 middle_m{0.0};
        glm::dmat3 half_edges_m{0.0};
        double flat_water_m = 0.0, waves_m = 0.0;
        float caustics = 0.0f;
        MirroredSun pattern;
    };
    struct Surface {
        glm::vec3 place{0.0f}, geometric{0.0f}, normal{0.0f};  // both to the ray's side
        glm::vec3 smooth{0.0f};  // where its sun's rays come, on the smooth surface that the normals mean
        ObjectLook look;
        int body = 0;
    };
    struct Incoming {
        glm::vec3 open{0.0f}, light{0.0f};
        bool is_open = true;  // both are one
    };

    glm::vec3 smooth_lift(const ObjectMeshData& mesh, std::size_t first, const glm::vec3& weights,
                          const Body& body, const glm::vec3& geometric) const;
    Surface surface(const Ray& ray, const RayHit& hit) const;
    glm::vec3 image_colour(const Ray& ray, const RayHit& hit, const ObjectImage& image) const;
    bool may_meet(const Ray& ray) const;
    bool is_blocked(const Ray& ray) const;
    bool is_sunny(const Surface& at) const;
    Ray ray_from(const Surface& at, const glm::vec3& towards) const;
    // Lamps over a surface, of whose places `count` are looked at beside so many rays; without count there are none.
    struct LampsOver {
        glm::vec3 place{0.0f}, normal{0.0f, 0.0f, 1.0f};
        LampChoice choice{};
        std::uint32_t count = 0, rays = 0;
    };
    LampsOver lamps_over(const glm::vec3& place, const glm::vec3& normal, std::uint32_t count,
                         std::uint32_t rays) const;
    LampsOver lamps_over(const Surface& at, const SampleNumbers& numbers, std::uint32_t rays) const;
    // part: of light from a direction, VarnishPart. number: of the k-th place, in the unit square.
    glm::vec3 light_of(const LampsOver& lamps, const auto& part, const auto& number) const;
    // Of the same where a ray has met something: the light that places have. density: of each ray [1/sr].
    glm::vec3 light_of_places(const LampsOver& lamps, const Ray& ray, const RayHit& hit, float density) const;
    bool shows(const glm::vec3& place, const Lamps::Light& light) const;
    Incoming incoming(const Surface& at, const glm::vec3& from, float blur_rad, glm::vec2 number,
                      const LampsOver& lamps, float density) const;
    static glm::vec3 outwards(const Surface& at, const glm::vec3& direction);
    void find_irradiance();
    static glm::vec3 by_normal(const std::vector<glm::vec3>& table, const glm::vec3& normal);
    glm::vec3 open_irradiance(const glm::vec3& normal) const { return by_normal(irradiance_, normal); }
    // Of the sun that the sea mirrors: its part of the same, and of the radiance towards an eye.
    glm::vec3 mirrored_sun_irradiance(const glm::vec3& normal) const {
        return by_normal(sun_irradiance_, normal);
    }
    glm::vec3 mirrored_sun(const glm::vec3& to_eye) const { return by_eye(sun_in_sea_, to_eye); }
    // By how much that light is more than its mean, over it.
    float gathered(const Surface& at) const;
    glm::vec3 irradiance(const Surface& at, const SampleNumbers& numbers) const;
    glm::vec3 mirrored(const Surface& at, const glm::vec3& to_eye, const SampleNumbers& numbers) const;
    static glm::vec3 by_eye(const std::vector<glm::vec3>& table, const glm::vec3& to_eye);
    glm::vec3 sea(const glm::vec3& to_eye, bool in_sun) const { return by_eye(sea_[in_sun], to_eye); }
    glm::vec3 sky(const glm::vec3& direction, float blur_rad) const;
    // Before a place so deep, of what falls on level water.
    glm::vec3 left_at_depth(float way_m) const;

    const Scene& scene_;
    std::vector<Body> bodies_;
    std::unique_ptr<RayScene> rays_;
    Lamps lamps_;

    const Sky* sky_ = nullptr;
    const WaterBody* water_ = nullptr;
    LightingChoice choice_;
    glm::vec3 beam_{0.0f};  // irradiance across the sun's beam
    glm::vec3 to_sun_{0.0f, 0.0f, 1.0f}, sun_side_{0.0f}, sun_rise_{0.0f};
    static constexpr int kRows = 12, kColumns = 24;
    std::array<std::vector<glm::vec3>, 2>
        sea_;  // by whether the sun shines on it: rows by the root of to_eye.z, columns by azimuth
    static constexpr int kNormalRows = 25, kNormalColumns = 48;
    std::vector<glm::vec3>
        irradiance_;  // of sky and sea that nothing hides: rows from up to down, columns by azimuth
    std::vector<glm::vec3> sun_in_sea_, sun_irradiance_;  // as those; empty without caustics
    glm::dvec2 origin_m_{0.0};
    float sight_in_water_m_ = 0.0f;
};

}  // namespace pelagic
