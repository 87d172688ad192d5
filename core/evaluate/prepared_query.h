// The query for hosts that ask for few points often (rays, floats): what doesn't depend on the points, kept.
#pragma once

#include <cstddef>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/evaluate/footprints.h"
#include "core/evaluate/gusts.h"
#include "core/evaluate/kernels.h"
#include "core/evaluate/masks.h"
#include "core/evaluate/random_tiling.h"

namespace pelagic {

// One query of a frame, ready to be asked. Made by whoever owns the frame, which it must not outlive and
// which must stay where it is; valid until the frame's next set(), after which refresh() makes it so again.
template <class T>
class PreparedQuery {
  public:
    // `query`: index into the plan's queries. `wanted`: the products that results may hold. `origin_m`: that
    // of the points that will be asked for; others are answered as well, but their phases are reduced anew at
    // each call. `whitecaps`: null for the sea's own; otherwise it must outlive this. Throws std::invalid_argument when
    // the query doesn't hold a product, or the frame has no time, or what earlier breaking has left is wanted, which
    // a frame alone doesn't know (core/effects/sea_at_time.h); std::out_of_range when there is no such query.
    PreparedQuery(const Frame<T>& frame, int query, ProductSet wanted, glm::dvec2 origin_m = glm::dvec2(0.0),
                  const Whitecaps* whitecaps = nullptr);

    // After the frame's set(). Throws std::invalid_argument when the frame has no time.
    void refresh();
    int query() const { return query_; }
    bool is_current() const { return frame_->times_set() == times_set_; }

    // As evaluate(), to the bit, from any number of threads at once. A chunk of points or less is done by the
    // calling thread alone and takes no memory. Throws std::invalid_argument for a product that isn't among
    // the wanted, std::logic_error when the frame was set since.
    void evaluate(const Points<T>& points, const Results<T>& results) const;
    // The same, however many points there are, by the calling thread alone.
    void evaluate_alone(const Points<T>& points, const Results<T>& results) const;

  private:
    // A level of the plan and its grids, cascade after cascade; those through which nothing passes are left
    // out.
    struct LevelGrids {
        int level;
        std::vector<GridArgs<T>> grids;  // where the origin lies stands in Place
        std::vector<int> cascades;       // of each grid
        std::vector<int> of_cascade;     // index into grids; −1: nothing passes
        std::vector<bool>
            breaks_alike;  // by grid: whether normals and breaking at the first footprint share theirs
    };
    // Where the points' origin lies.
    struct Place {
        glm::dvec2 origin_m;
        std::vector<std::vector<glm::dvec2>> nodes;  // in each of a level's grids, 0 … n
        std::vector<TilingOrigin> tiling;            // in each cascade; empty: periodic tiling
        std::vector<double> start_cycles;            // of each train
        GustPhases gusts{};
    };
    // What one call has in common for all its points.
    struct Call;
    struct Work;
    struct MaskWork;
    struct Cut;
    // The footprints of points, among these levels.
    struct Seen {
        const std::vector<int>& levels;
        const ChunkFootprints<T>& footprints;
    };
    // Which of a level's grids, by breaks_alike.
    enum class Part { All, Alike, Other };
    // How a level's grids count at a chunk's points.
    struct Share {
        FieldSet fields;
        const T *cell_weight = nullptr, *pixel_weight = nullptr;
        Part part = Part::All;
    };

    void evaluate_by(const Points<T>& points, const Results<T>& results, bool alone) const;
    Place place_of(glm::dvec2 origin_m) const;
    Call call(const Points<T>& points, const Results<T>& results, const Place& place) const;
    Cut cut(const Call& call) const;
    void keep_places(Work& work) const;
    void run(const Call& call, PointRange of, Work& work) const;
    void add_grids(const Call& call, std::size_t level, const Share& share, Work& work,
                   Chunk<T>& chunk) const;
    // Whether the displacement gradient of the waves that break isn't that of the chunk's normals.
    bool breaks_apart(const Call& call, const Work& work) const;
    // Adds what pixels hide of vessels' slopes; false: nothing of them is there.
    bool hide_vessels(const Call& call, Work& work) const;
    // Which of a chunk's points lie in a vessel's tile, in `within` 1 and else 0; false: none.
    bool is_within(int cascade, glm::dvec2 origin_m, const Chunk<T>& chunk, T* within) const;
    void add_only_footprint(const Call& call, Work& work) const;
    void add_levels(const Call& call, Work& work) const;
    // Points whose footprints are round: those of `fields` that cells filter, and the others.
    void add_round(const Call& call, FieldSet fields, const Seen& cells, const Seen& pixels, Work& work,
                   Chunk<T>& chunk) const;
    void add_ellipses(const Call& call, FieldSet fields, const Seen& seen, const Work& work,
                      Chunk<T>& chunk) const;
    void add_own_footprints(const Call& call, std::size_t first, Work& work) const;
    // Calm and rough places (core/plan/masks.h). What a slick leaves of waves, in place of a part of them; heights and displacements as
    // the derivatives' footprints show them; and the gains, of the sums and of what is unresolved.
    void calm_ripples(const Call& call, Work& work) const;
    void add_values(const Call& call, Work& work) const;
    void mask_chunks(const Call& call, Work& work) const;
    void mask_unresolved(const Call& call, Work& work) const;
    // What gusts do to the chunk's points.
    void take_gusts(const Call& call, std::size_t first, Work& work) const;
    // What an ellipse leaves unresolved of the cascades' waves beyond a round footprint of its width.
    UnresolvedMoments<double> beside_round(const Footprint<T>& pixel) const;

    void take_sea();  // the frame's, which may be another at each time

    const Frame<T>* frame_;
    int query_;
    const PlannedQuery* planned_;
    const QueryStatistics* statistics_;
    const EllipseMoments* ellipses_;
    std::size_t sea_cascades_ = 0;  // those behind are vessels'
    bool has_vessels_ = false;
    std::vector<int> hiding_vessels_;  // whose slopes pixels hide: their cascades
    std::vector<T> whole_m_;           // by cascade: whole_footprint_m()
    ProductSet wanted_;
    EvaluateKernels<T> kernels_;
    bool has_trains_ = false, has_coast_ = false, has_surf_ = false, has_random_tiling_ = false,
         breaks_ = false, has_masks_ = false;
    const Whitecaps* given_whitecaps_;  // null: the sea's
    const Whitecaps* whitecaps_;
    const Gusts* gusts_ = nullptr;       // none, or nothing that they change is wanted
    UnresolvedMoments<T> unresolved_{};  // of pixels that are all the query's first
    std::vector<LevelGrids> levels_;
    Place place_;
    long times_set_ = -1;
};

}  // namespace pelagic
