// The sea at one time: its waves, and the foam that earlier breaking has left there.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "core/effects/foam_history.h"
#include "core/evaluate/evaluate.h"
#include "core/evaluate/prepared_query.h"
#include "core/waves/frame.h"

namespace pelagic {

// Between calls of set() any number of threads may ask. What it answers depends on the sea, the time and the point
// alone: not on what was asked before.
template <class T>
class SeaAtTime {
  public:
    explicit SeaAtTime(std::shared_ptr<const Sea<T>> sea);
    // sea() is then that of the time that was set last.
    explicit SeaAtTime(std::shared_ptr<const SeaOverTime<T>> sea);

    // As Frame's. Foam's past is gone through where somebody asks for it, not here.
    void set(double t_s, const std::atomic<bool>* cancel = nullptr) {
        places_.clear();
        frame_.set(t_s, cancel);
    }

    const Sea<T>& sea() const { return frame_.sea(); }
    const Frame<T>& frame() const { return frame_; }
    // Whether a query's foam has a past that takes time to go through.
    bool has_past(int query) const;
    // Held for it.
    std::size_t past_bytes() const { return history_ ? history_->held_bytes() : 0; }

    // Says what evaluate() will be asked for. Without, each place that is new takes a way through all of its past at
    // the call that needs it: prepare() goes it once for all, and in a run for places close by as well. Of points in
    // several batches: what say() collects, prepare() makes. Throws BuildCancelled where `watch` ends it.
    void prepare(int query, const Points<T>& points, const BuildWatch& watch = {}) const;
    void say(int query, const Points<T>& points);
    void prepare(const BuildWatch& watch = {});

    // As the frame's evaluate() or the query's, with the products that count what earlier breaking has left. On all
    // threads of the calling arena. Throws std::invalid_argument for a product that the query doesn't hold, and
    // BuildCancelled where `watch` ends it: the results are then worthless.
    void evaluate(int query, const Points<T>& points, const Results<T>& results,
                  const BuildWatch& watch = {}) const;
    // `alone`: by the calling thread.
    void evaluate(const PreparedQuery<T>& query, const Points<T>& points, const Results<T>& results,
                  const BuildWatch& watch = {}, bool alone = false) const;

    // The bubbles that earlier breaking has left, of 1 where all breaks (FoamHistory), of a plan that has them and a query with a past.
    bool has_bubbles(int query) const { return has_past(query) && sea().plan().foam->bubbles_m > 0.0; }
    void bubbles(int query, const Points<T>& points, std::span<float> left,
                 const BuildWatch& watch = {}) const;

  private:
    FoamHistory<T>& history() const;  // at the frame's time; of a caller that has the lock
    std::vector<FoamPlace> places_of(int query, const Points<T>& points) const;
    void make(std::vector<FoamPlace> places, const BuildWatch& watch) const;
    template <class Ask>
    void evaluate_by(const Ask& ask, int query, const Points<T>& points, const Results<T>& results,
                     const BuildWatch& watch) const;

    void add_wakes(const Points<T>& points, const FoamResults<T>& foam) const;

    Frame<T> frame_;
    std::vector<FoamPlace> places_;  // said since the last prepare()
    mutable std::mutex lock_;        // of the history
    mutable std::optional<FoamHistory<T>> history_;
    mutable long history_set_ = 0;  // Frame::times_set() of its time
};

}  // namespace pelagic
