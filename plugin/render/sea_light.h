// The light of a frame of the sea, at places that somebody else has found: those that the rasteriser shows (render.h), or those
// that rays meet (examples/trace).
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/effects/sea_at_time.h"
#include "core/evaluate/hulls.h"
#include "core/evaluate/values.h"
#include "core/lighting/air.h"
#include "core/lighting/floor.h"
#include "core/lighting/foam_structure.h"
#include "core/lighting/lighting.h"
#include "core/lighting/meniscus.h"
#include "core/lighting/sky.h"
#include "core/lighting/spray.h"
#include "core/lighting/water.h"
#include "core/plan/plan.h"
#include "core/surface/projected_grid.h"
#include "core/waves/frame.h"
#include "pelagic/scene.h"
#include "plugin/render/floor_light.h"
#include "plugin/render/render.h"

namespace pelagic {

// Places of the sea and how they are seen, an entry each.
template <class T>
struct SeenSea {
    glm::dvec2 origin_m{0.0};  // of places at rest
    // From which to_eye and distance_m are, for the floor below; without: it is level and evenly lit.
    std::optional<FloorEye> eye;
    std::vector<glm::vec<2, T>> rest;  // [m]
    std::vector<T> pixel_m;  // the pixel's footprint at rest, as in Points (core/evaluate/evaluate.h)
    std::vector<glm::vec<2, T>> pixel_axis_m;
    std::vector<glm::vec3> to_eye, up;  // unit; the vertical there, in the eye's axes
    std::vector<float> distance_m;      // of the eye
    // Of the slopes that the surface on which places were found lacks, at rest, along the view; 0: it lacks none that the
    // pixel shows.
    std::vector<float> mesh_variance;
    // As SeaPoint::crest, by find_crests(); empty: the water is lit as level water.
    std::vector<glm::vec3> crest;
    // Whether the eye sees the place from below; empty: it sees none so.
    std::vector<std::uint8_t> from_below;
    // Normals of the surface at rest, of any length, as in Points; empty: it is flat everywhere.
    std::vector<glm::vec<3, T>> rest_normal;

    std::size_t size() const { return rest.size(); }
    void resize(std::size_t count) {
        rest.resize(count);
        pixel_m.resize(count);
        pixel_axis_m.resize(count);
        to_eye.resize(count);
        up.resize(count);
        distance_m.resize(count);
        mesh_variance.assign(count, 0.0f);
    }
    Points<T> points() const {
        Points<T> points{.origin_m = origin_m,
                         .count = size(),
                         .rest_m = {rest.data()},
                         .pixel_m = {pixel_m.data()},
                         .pixel_axis_m = {pixel_axis_m.data()}};
        if (!rest_normal.empty()) points.rest_normal = {rest_normal.data()};
        return points;
    }
};

// Holds the plan's sea and one frame of it. The plan is that of pictures (picture_plan()).
template <class T>
class SeaLight {
  public:
    static constexpr int kQuery = 0;  // the plan's only one

    // Throws BuildCancelled.
    SeaLight(const Plan& plan, const LightingChoice& choice, Sky sky, const BuildWatch& watch);

    const Plan& plan() const { return sea_->plan(); }
    const Sky& sky() const { return sky_; }
    const WaterBody& water() const { return water_; }
    const LightingChoice& choice() const { return choice_; }
    const Frame<T>& frame() const { return state_.frame(); }

    // From now on the light is that of a frame, where some of it has keys; whether the sky is another then.
    bool light_frame(int frame);
    // As Frame's.
    void set(double time_s, const std::atomic<bool>* cancel = nullptr) {
        floor_lit_.reset();
        state_.set(time_s, cancel);
    }
    // The air before an eye at this height above the sea at rest [m]; none where the light has none.
    Air air_before(double height_m) const;
    // The spray before a camera at the frame's time, with its light; none where the light or the scene has none. `drops`: its large
    // drops are shown one by one. The view's pixels are the samples, so many a side, of a picture's.
    Spray spray_before(const View& view, const ProjectedGridOptions& grid, int samples,
                       bool drops = false) const;
    // Before the first answer of a picture: all places that it will show, and what earlier times have left there, so
    // that its parts don't each go through them. Nothing without persistent foam. The last throws BuildCancelled.
    void say(const Points<T>& points) { state_.say(kQuery, points); }
    void prepare(const BuildWatch& watch) { state_.prepare(watch); }

    // What lies behind the sea, in this direction (unit), for a pixel whose side subtends `angle` [rad]. Without spray before it.
    SeaRadiance behind(const Air& air, const glm::vec3& direction, float angle) const;

    // What a camera in the water sees in these directions (unit) where there is no surface.
    void light_water(const FloorEye& eye, std::span<const glm::vec3> direction,
                     std::span<SeaRadiance> lit) const;

    // What a camera sees through the water that climbs its glass, whose normal is `forward` (core/lighting/meniscus.h).
    void light_meniscus(const FloorEye& eye, const glm::vec3& forward, std::span<const MeniscusSight> sights,
                        std::span<SeaRadiance> lit) const;

    // SeaPoint::crest at places of a flat sea at rest, by their footprints [m], width and long axis; empty where the water knows no crests.
    void find_crests(glm::dvec2 origin_m, const std::vector<glm::vec<2, T>>& rest, std::vector<T> width_m,
                     const std::vector<glm::vec<2, T>>& axis_m, std::vector<glm::vec3>& crest) const;

    // The sun's light on the floor before a camera at the frame's time (light_floor()), where it is seen: its view and footprints are asked
    // for. rest_m: the height at which the sea rests there. Throws BuildCancelled.
    void light_floor_before(FloorLightWanted wanted, double rest_m,
                            const std::atomic<bool>* cancel = nullptr);
    // The floor below a sea that rests at that height; made where it is of another one.
    const Floor& floor_below(double rest_m);
    // The last one.
    const Floor& floor() const { return floor_; }

    // What the places hold beside their position: kept until the next call. All threads of the calling arena, as light().
    void answer(const SeenSea<T>& seen);
    // And the foam of hulls at these places (core/evaluate/hulls.h), which are set for the frame. After answer().
    void add_foam_of(const Hulls& hulls, const SeenSea<T>& seen);
    // The light of the places that were answered last, under a sky, through the air and the spray before the eye. wanted: by place,
    // whether it is asked for; empty: all are.
    void light(const SeenSea<T>& seen, const Sky& sky, const Air& air, const Spray& spray,
               std::span<SeaRadiance> lit, std::span<const std::uint8_t> wanted = {});
    // Those of such a place that light() has lit; any thread.
    SeaFacets facets(const SeenSea<T>& seen, std::size_t place) const;
    // Variances xx, yy, xy of the slopes of all waves of its frame. Of water without a body some milliseconds.
    glm::vec3 wave_slopes() const;
    // What comes from the sea in directions to an eye (unit) over all its waves, hidden as they are from far away, without air; `lit`:
    // with the sun.
    void light_from_afar(std::span<const glm::vec3> to_eye, bool lit, std::span<SeaRadiance> light) const;

    const Values& answers() const { return answers_; }
    bool foam_lives() const { return state_.has_past(kQuery); }

  private:
    void light_by(const Scene& scene, double time_s);
    float residual_age_s(std::size_t i) const;

    LightingChoice choice_;
    Sky sky_;
    WaterBody water_;
    FoamLook foam_;
    double caustics_;
    std::optional<Scene> lit_;  // that of the frame whose light it is
    Floor floor_;
    std::optional<double> floor_rest_m_;         // that it is for
    std::optional<FloorLightWanted> floor_lit_;  // as its light is, at the frame's time
    std::shared_ptr<const SeaOverTime<T>> sea_;
    SeaAtTime<T> state_;
    QueryRunner<T> runner_;
    Values answers_;
    std::vector<float> contact_foam_;
    std::vector<float> bubbles_;  // by the same points, of a sea that has them
    std::vector<SeaPoint> points_;
};

}  // namespace pelagic
