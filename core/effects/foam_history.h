// Persistent foam: beside what breaks now, what earlier breaking has left, drifting with the wind and decaying.
//
// At a place x at rest and a time t the residual foam is
//   R = (r/d) ∫ P(x − u a, t − a) e^{−a/τ} da  over ages a from 0 to the window,
// with P the share of the surroundings of x that breaks (J < ε: Dupuy and Bruneton 2012, Eq. 3), τ the decay, u the drift,
// and r/d what breaking leaves in a second (FoamLife in core/waves/whitecaps.h). It is linear in P, so that the mean over a
// footprint is that of a finer one, until R is limited to 1. Total coverage is what breaks now and the residual on the rest.
//
// P is kept on levels of cells, each twice as large as those before, at nodes that drift with the foam: at each of them the
// integral is then a sum over its own past. Cells lie in tiles, which are made where somebody asks. What a tile holds
// depends on the sea, the tile and the time alone: a frame alone has the bits that it has in a run, whoever asked for
// what before, on any number of threads.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/base/strided.h"
#include "core/effects/foam_kernels.h"
#include "core/evaluate/evaluate.h"
#include "core/evaluate/prepared_query.h"
#include "core/waves/frame.h"
#include "core/waves/sea.h"

namespace pelagic {

// What add() reads and writes, a value a point. A view may be another one's: what breaks is read first.
template <class T>
struct FoamResults {
    Strided<T> breaking{};           // what breaks now
    Strided<T> coverage{}, age_s{};  // Product::Coverage and FoamAge, or no view
};

// A tile of a level's cells: its first node is kTileCells · (x, y) cells from the drifting water's origin.
struct FoamPlace {
    int level = 0;
    std::int64_t x = 0, y = 0;
    bool operator==(const FoamPlace&) const = default;
};

// In the order that tiles are made in, each once.
void keep_each_once(std::vector<FoamPlace>& places);

// What a tile has at its nodes, in rows of kTileCells + 1, as add() reads it.
struct FoamNodes {
    FoamPlace place;
    const float *foam, *aged;  // residual foam, not limited to 1, and that times its age [s]
    const float* bubbles;      // that are left, of 1 where all breaks; null where the plan has none
};

template <class T>
class FoamHistory {
  public:
    // Of a sea whose plan has persistent foam (std::invalid_argument otherwise).
    explicit FoamHistory(std::shared_ptr<const Sea<T>> sea);
    // Of one that may change: each past time has its own waves, threshold, and foam that a breaking leaves.
    explicit FoamHistory(std::shared_ptr<const SeaOverTime<T>> sea);
    ~FoamHistory();

    // The foam at this time, |t| ≤ Frame<T>::kLatest_s. Keeps what earlier calls have computed for it, which is most
    // when times rise.
    void set(double t_s);

    // The tiles that add() will read at these points at this time, in order, each once. `query`: of the sea's plan, whose
    // footprint points without their own have.
    std::vector<FoamPlace> places(const Points<T>& points, int query) const;
    // Makes these tiles, which are all that is asked for at this time. Where add() is called for a few points at a
    // time, it then needn't go through the earlier times for each call. Other tiles are kept for the next time as
    // long as there is room in the plan's foam_history_bytes(), those read last above all: a tile that a wave covers
    // for a moment needn't begin anew. In a run some close ones are made as well. Where it has to go through many
    // earlier times it tells `watch` how far it is; cancelled by it, it throws BuildCancelled, and may be asked
    // again.
    void prepare(std::vector<FoamPlace> places, const BuildWatch& watch = {});
    void prepare(const Points<T>& points, int query, const BuildWatch& watch = {}) {
        prepare(places(points, query), watch);
    }
    // The tiles that were asked for since set(), in order. They last until the next call of anything else.
    std::vector<FoamNodes> nodes() const;
    const FoamPlan& plan() const { return foam_; }
    // How far a level's nodes have drifted from where they were at time 0 [m].
    glm::dvec2 drifted_m(int level) const { return foam_.drift_of(level) * time_s_; }
    double time_s() const { return time_s_; }
    // Beyond the last level: residual foam, and that times its age [s].
    float mean() const { return mean_; }
    float mean_times_age_s() const { return mean_ * mean_age_s_; }
    float mean_bubbles() const { return mean_bubbles_; }
    // Of the share of the sea that breaks, for masks (masked_breaking()); of a sea that changes that of its first key.
    double breaking_deviate() const { return breaking_deviate_; }

    // Adds to what breaks now what earlier breaking has left. Tiles that were read at the time before and haven't been
    // made for this one are made first, all at once. On all threads of the calling arena, one call at a time.
    // `watch`: as prepare()'s; of a call that was cancelled the results are worthless.
    void add(const Points<T>& points, int query, const FoamResults<T>& results, const BuildWatch& watch = {});

    // The bubbles that earlier breaking has left, of 1 where all breaks: the same sum with their own decay, not limited. Of a plan that has them.
    void add_bubbles(const Points<T>& points, int query, std::span<float> bubbles,
                     const BuildWatch& watch = {});

    // Bytes of all tiles, and of the seas that they are sampled from. The plan's foam_history_bytes() expects as many: for squares
    // and views all round a camera no more are needed, in a picture's frame waves may show more tiles than a plan can know.
    std::size_t held_bytes() const;

  private:
    struct Level;
    struct Tile;
    using Place = FoamPlace;
    struct HashOf {
        std::size_t operator()(const Place& place) const;
    };
    class Locator;  // of points among the nodes

    bool leaves_nothing() const;  // where no wave breaks
    // Of the whole sea at a time of the lattice.
    const Whitecaps& whitecaps(std::int64_t n);
    void find_means();
    // Two of a tile's sums, with what they are beyond all tiles.
    struct Sums {
        std::size_t first, second;
        float mean_of_first, mean_of_second;
    };
    template <class Use>
    void for_parts(const Points<T>& points, int query, const Sums& sums, const BuildWatch& watch,
                   const Use& use);
    bool read(const Locator& locate, std::size_t first, const Sums& sums, std::span<float> of_first,
              std::span<float> of_second, std::vector<Place>& missing) const;
    void make(std::vector<Place>& places, const BuildWatch& watch);
    void renew(const BuildWatch& watch);
    std::vector<Place> surroundings_of(const std::vector<Place>& places) const;
    void make_room(std::size_t count, long round);
    void advance(const std::vector<Tile*>& tiles, const BuildWatch& watch);
    void sample_from(std::int64_t from, const std::vector<Tile*>& tiles, const BuildWatch& watch);
    // Of a row of tiles, whose nodes beside each other are sampled as one.
    void sample(std::span<Tile* const> row, std::int64_t n, const PreparedQuery<T>& query,
                const Whitecaps& whitecaps) const;
    // What a tile's part of such a row has, from its first node on; rows of `columns`.
    struct RowValues {
        const glm::vec<3, T>*moments, *moved;  // `moved`: null without surf
        std::size_t columns;
    };
    void take_sample(Tile& tile, std::int64_t n, const Whitecaps& whitecaps, const RowValues& values) const;
    glm::dvec2 first_node_m(const Place& place, double time_s) const;
    // Of what broke in an interval, what masks leave of it (WaveMask::foam).
    void calm(std::uint16_t* shares, const Place& place, std::int64_t interval) const;
    Level& level(int index, const std::atomic<bool>* cancel);

    std::shared_ptr<const Sea<T>> sea_;            // of a sea that changes the first key's
    std::shared_ptr<const SeaOverTime<T>> shot_;   // null: the sea is one
    std::map<std::int64_t, Whitecaps> whitecaps_;  // of a sea that changes, by times of the lattice
    FoamPlan foam_;
    FoamKernels kernels_;
    std::size_t most_tiles_ = 0;                                    // that the plan has room for
    std::array<std::unique_ptr<Level>, FoamPlan::kLevels> levels_;  // made where tiles are
    std::unordered_map<Place, std::unique_ptr<Tile>, HashOf> tiles_;
    float mean_ = 0.0f, mean_age_s_ = 0.0f;  // of the residual over the whole sea
    std::optional<Gusts> gusts_;             // of the moment, where the sea changes and has fronts
    float mean_bubbles_ = 0.0f;
    double breaking_deviate_ = 0.0;
    double time_s_ = 0.0;
    std::int64_t first_ = 0, last_ = -1;  // the intervals that count now
    struct IntervalWeight {
        float foam, age, bubbles;
    };
    std::vector<IntervalWeight> weights_;
    long round_ = 0;  // calls of set()
    bool is_renewed_ = true;
};

}  // namespace pelagic
