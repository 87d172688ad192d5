#include "core/effects/sea_at_time.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace pelagic {
namespace {

// Points between which evaluating may be cancelled.
constexpr std::size_t kPiece = std::size_t{1} << 18;

template <class T>
Points<T> piece_of(const Points<T>& points, std::size_t first, std::size_t count) {
    const auto from = [&](auto view) {
        if (view) view.data = &view[first];
        return view;
    };
    return {.origin_m = points.origin_m,
            .count = std::min(count, points.count - first),
            .rest_m = from(points.rest_m),
            .cell_m = from(points.cell_m),
            .pixel_m = from(points.pixel_m),
            .cell_axis_m = from(points.cell_axis_m),
            .pixel_axis_m = from(points.pixel_axis_m),
            .rest_normal = from(points.rest_normal)};
}

// Where what breaks now is written: where it is asked for, or in place of what it becomes a part of.
template <class T>
Strided<T> breaking_in(const Results<T>& results) {
    for (const NumberProduct product : {NumberProduct(Product::Breaking), NumberProduct(Product::Coverage)})
        if (const Strided<T> view = results.numbers(product)) return view;
    return results.numbers(Product::FoamAge);
}

// What a frame alone answers of it.
template <class T>
Results<T> of_frame(Results<T> results) {
    results.set(Product::Breaking, breaking_in(results));
    for (const NumberProduct product : {NumberProduct(Product::Coverage), NumberProduct(Product::FoamAge)})
        results.set(product, Strided<T>{});
    return results;
}

}  // namespace

template <class T>
SeaAtTime<T>::SeaAtTime(std::shared_ptr<const Sea<T>> sea) : frame_(std::move(sea)) {
    if (frame_.sea().plan().foam) history_.emplace(frame_.shared_sea());
}

template <class T>
SeaAtTime<T>::SeaAtTime(std::shared_ptr<const SeaOverTime<T>> shot) : frame_(shot) {
    if (shot->plan().foam) history_.emplace(shot);
}

template <class T>
bool SeaAtTime<T>::has_past(int query) const {
    return history_ && sea().plan().queries.at(static_cast<std::size_t>(query)).query.asks_for_past();
}

template <class T>
FoamHistory<T>& SeaAtTime<T>::history() const {
    if (!frame_.is_set()) throw std::invalid_argument("the frame has no time yet: call set() first");
    if (history_set_ != frame_.times_set()) history_->set(frame_.time_s());
    history_set_ = frame_.times_set();
    return *history_;
}

template <class T>
void SeaAtTime<T>::say(int query, const Points<T>& points) {
    if (!has_past(query)) return;
    const std::vector<FoamPlace> places = places_of(query, points);
    places_.insert(places_.end(), places.begin(), places.end());
    keep_each_once(places_);  // batches ask for much the same
}

template <class T>
void SeaAtTime<T>::prepare(const BuildWatch& watch) {
    if (history_) make(std::exchange(places_, {}), watch);
}

template <class T>
void SeaAtTime<T>::prepare(int query, const Points<T>& points, const BuildWatch& watch) const {
    if (has_past(query)) make(places_of(query, points), watch);
}

template <class T>
std::vector<FoamPlace> SeaAtTime<T>::places_of(int query, const Points<T>& points) const {
    const std::lock_guard lock(lock_);
    // Elsewhere than in its own parts this thread might wait for the lock that it holds.
    return tbb::this_task_arena::isolate([&] { return history().places(points, query); });
}

template <class T>
void SeaAtTime<T>::make(std::vector<FoamPlace> places, const BuildWatch& watch) const {
    const std::lock_guard lock(lock_);
    tbb::this_task_arena::isolate([&] { history().prepare(std::move(places), watch); });
}

template <class T>
template <class Ask>
void SeaAtTime<T>::evaluate_by(const Ask& ask, int index, const Points<T>& points, const Results<T>& results,
                               const BuildWatch& watch) const {
    const Query& query = sea().plan().queries.at(static_cast<std::size_t>(index)).query;
    const ProductSet lasting = results.given() & lasting_products();
    if ((lasting & ~query.products).any())
        throw std::invalid_argument(
            "query \"" + query.name +
            "\" does not hold the foam that is asked for: ask for it when the plan is made");
    const Results<T> now = of_frame(results);
    // A lattice's rows stay together: they are cheap that way.
    const std::size_t piece = watch.cancel && !query.lattice ? kPiece : points.count;
    for (std::size_t first = 0; first < points.count; first += piece) {
        stop_if(watch.cancel);
        ask(piece_of(points, first, piece), now.from_point(first));
    }
    if (lasting.none()) return;
    const FoamResults<T> foam{.breaking = breaking_in(results),
                              .coverage = results.numbers(Product::Coverage),
                              .age_s = results.numbers(Product::FoamAge)};
    if (has_past(index)) {
        const std::lock_guard lock(lock_);
        tbb::this_task_arena::isolate([&] { history().add(points, index, foam, watch); });
    } else {
        for (std::size_t i = 0; i < points.count; ++i) {
            if (foam.coverage) foam.coverage[i] = foam.breaking[i];
            if (foam.age_s) foam.age_s[i] = T(0);
        }
    }
    if (!query.only_cascade) add_wakes(points, foam);
}

// The foam of vessels' wakes beside what waves leave.
template <class T>
void SeaAtTime<T>::add_wakes(const Points<T>& points, const FoamResults<T>& foam) const {
    const std::span<const WakeStrip> strips = frame_.strips();
    if (strips.empty()) return;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.count, 4096), [&](const auto& range) {
        const std::size_t first = range.begin();
        for (const WakeStrip& strip : strips)
            strip.for_each(
                WakeStrip::Wanted::Foam, range.size(),
                [&](std::size_t i) { return points.origin_m + glm::dvec2(points.rest_m[first + i]); },
                [&](std::size_t i) {
                    return points.pixel_m ? static_cast<double>(points.pixel_m[first + i]) : 0.0;
                },
                [&](std::size_t i, const WakeWater<double>& water) {
                    if (!(water.foam > 0.0)) return;
                    const WakeWater<T> at{static_cast<T>(water.foam), static_cast<T>(water.age_s), T(0)};
                    if (foam.coverage)
                        foam.coverage[first + i] = with_wake_foam(foam.coverage[first + i], at.foam);
                    // The same whether coverage is asked for or not.
                    if (foam.age_s) foam.age_s[first + i] = with_wake_age(foam.age_s[first + i], at);
                });
    });
}

template <class T>
void SeaAtTime<T>::evaluate(int query, const Points<T>& points, const Results<T>& results,
                            const BuildWatch& watch) const {
    evaluate_by([&](const Points<T>& of, const Results<T>& to) { pelagic::evaluate(frame_, query, of, to); },
                query, points, results, watch);
}

template <class T>
void SeaAtTime<T>::evaluate(const PreparedQuery<T>& query, const Points<T>& points, const Results<T>& results,
                            const BuildWatch& watch, bool alone) const {
    evaluate_by([&](const Points<T>& of,
                    const Results<T>& to) { alone ? query.evaluate_alone(of, to) : query.evaluate(of, to); },
                query.query(), points, results, watch);
}

template <class T>
void SeaAtTime<T>::bubbles(int query, const Points<T>& points, std::span<float> left,
                           const BuildWatch& watch) const {
    if (left.size() != points.count) throw std::invalid_argument("bubbles: give a number for each point");
    const std::lock_guard lock(lock_);
    tbb::this_task_arena::isolate([&] { history().add_bubbles(points, query, left, watch); });
}

template class SeaAtTime<float>;
template class SeaAtTime<double>;

}  // namespace pelagic
