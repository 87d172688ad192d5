// The hulls of a scene's objects in its waves: where no water is, and the foam where hull and water meet.
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/evaluate/object_place.h"
#include "core/evaluate/values.h"
#include "core/scene/hull.h"
#include "core/waves/frame.h"
#include "pelagic/scene.h"

namespace pelagic {

// Places are over the flat sea, in the world. Wherever no hull is near, all of it costs next to nothing.
class Hulls {
  public:
    // Of the scene's objects that keep water out. The scene must outlive it.
    explicit Hulls(const Scene& scene);

    bool empty() const { return hulls_.empty(); }
    // At a frame, of a sea that is set to its time; `query` is the plan's hulls_query() (core/plan/hulls.h), which knows_hulls(). rest_m: heights at which the
    // sea rests. Hulls move with the sea's time: where that stands still (shot.time_scale = 0) they stand.
    template <class T>
    void place(const Frame<T>& state, std::optional<int> query, double frame, RestHeight rest_m = {});

    // A body whose way somebody else knows: where its axes and its origin are, and how these change each second of the sea.
    struct Moved {
        glm::dmat3 axes{1.0}, axes_per_s{0.0};  // turn times the object's scale
        glm::dvec3 place_m{0.0}, place_mps{0.0};
    };
    // The same of such bodies, one for each of the scene's objects, over a sea that rests level.
    void place(std::span<const Moved> bodies);

    // Along the hull's decks from its outline at the place's height, the nearest one's [m]; negative: dry. Infinite where none is near. Where a hull
    // leans by an angle it is the level one's over its cosine at most, a tenth more at the 24° to which what floats is kept.
    double distance_m(const glm::dvec3& place_m) const;
    // From the boundary of all hulls, negative inside: the nearer of the ways to its side and to its bottom, which is the distance or up to √2 times as
    // much. `bound_m` where it is farther.
    double depth_m(const glm::dvec3& place_m, double bound_m) const;
    // Whether hulls are within so much of a box over the sea.
    bool are_near(const glm::dvec2& least_m, const glm::dvec2& most_m, double distance_m) const;

    // How much of a cell so wide is water, where the outline goes through it straight: 0 in a hull … 1, ½ on the outline.
    static float wet_share(double distance_m, double cell_m);

    // What is known of points' water: where it is, relative to their origin, and how fast, each second of the sea. Without, as the hulls' query has it.
    struct Known {
        std::span<const glm::vec3> positions_m{}, velocities_mps{};
    };
    struct Met {
        std::span<float> wet{};   // wet_share() of each point's cell; empty: not wanted
        std::span<float> foam{};  // coverage of contact foam, 0 … 1; empty: not wanted
    };
    // Of points of the sea at rest, with their footprints in cell_m, or all of `cell_m` where they have none. On all threads of the calling arena.
    //
    // Contact foam is W (1 − smooth(s/w)) min(|v·n|/v₀, 1) outside a hull, s its distance_m(), n its side's normal, v the water's velocity less the hull's, with waves from about w on.
    // Form and constants are by eye. In cells wider than w it is as wide as a cell, and thinner in proportion.
    template <class T>
    void meet(const Frame<T>& state, std::optional<int> query, const Points<T>& points, double cell_m,
              const Known& known, const Met& met) const;

    // The water along an object's hull, as meet() has it for who knows nothing of it: at nodes over the hull's own x and y.
    struct Beside {
        glm::dvec2 first_m{0.0};
        double step_m = 1.0;
        glm::ivec2 count{0};  // 0: it has no foam
        std::vector<glm::vec3>
            way_mps{};  // the water's velocity less the hull's, row by row; 0 where no foam can be
        double foam = 0.0, foam_m = 0.0;  // W of the foam times its most, and its width w
    };
    // Of the scene's objects, in their order.
    template <class T>
    std::vector<Beside> beside(const Frame<T>& state, std::optional<int> query) const;
    static constexpr double kFull_mps = 1.5;  // v₀

  private:
    struct Placed : Moved {
        std::size_t object = 0;
        std::shared_ptr<const Hull> hull;
        glm::dmat3 into{1.0};  // of the axes
        glm::dvec3 centre_m{0.0};
        double scale = 1.0, radius_m = 0.0;  // round the box and the margin
        double foam = 0.0, foam_m = 0.0;

        bool is_near(const glm::dvec3& place, double distance_m) const {
            const glm::dvec3 way = place - centre_m;
            const double reach_m = radius_m + distance_m;
            return way.x * way.x + way.y * way.y + way.z * way.z <= reach_m * reach_m;
        }
        glm::dvec3 local(const glm::dvec3& place) const { return into * (place - place_m); }
        double distance(const glm::dvec3& place) const;
        double foam_at(const glm::dvec3& place, double distance_m, const glm::dvec3& water_mps,
                       double cell_m) const;
    };

    // What follows from where a hull is.
    void bound(Placed& placed) const;

    const Scene& scene_;
    std::vector<Placed> hulls_;
    RestHeight rest_m_;
};

// The foam of Hulls::meet() beside all that a query says is there, 1 − (1 − a)(1 − b): it is what breaks now, of age 0.
void add_contact_foam(std::span<const float> foam, Values& values);

}  // namespace pelagic
