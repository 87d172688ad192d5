#include "core/effects/foam_history.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "core/base/buffer.h"
#include "core/evaluate/gusts.h"
#include "core/plan/foam_tiles.h"
#include "core/waves/loop.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

constexpr std::size_t kNodes = FoamPlan::kTileNodes, kStride = FoamPlan::kTileStride;
constexpr int kSide = FoamPlan::kTileCells + 1;
constexpr std::size_t kPart = FoamAxis::kPoints;
constexpr std::int64_t kLong = 6;  // samples: a run's frame takes fewer, and is soon done
// The deviate of 10⁻¹² of the sea, where the law has no foam: the polynomial through six samples would go far beyond them where foam
// sets in, from lower ones.
constexpr float kNoBreaking = -7.0f;
constexpr int kSamples = 6;  // that an interval is known by: from two before it to two after it

// Of a division whose divisor is positive.
std::size_t modulo(std::int64_t n, std::size_t by) {
    const auto rest = n % static_cast<std::int64_t>(by);
    return static_cast<std::size_t>(rest < 0 ? rest + static_cast<std::int64_t>(by) : rest);
}

auto order_of(const FoamPlace& place) {
    return std::tuple(place.level, place.y, place.x);
}

bool is_before(const FoamPlace& a, const FoamPlace& b) {
    return order_of(a) < order_of(b);
}

// Tiles of a row of so many may be sampled together: as many points beside each other as PreparedQuery keeps places for.
constexpr int kStripBits = 3;
constexpr std::int64_t kStripTiles = 1 << kStripBits;

std::int64_t strip_of(const FoamPlace& place) {
    return place.x >> kStripBits;
}

// Whether the second one lies beside the first one in its strip.
bool goes_on_in_row(const FoamPlace& one, const FoamPlace& next) {
    return next.level == one.level && next.y == one.y && next.x == one.x + 1 &&
           strip_of(next) == strip_of(one);
}

}  // namespace

void keep_each_once(std::vector<FoamPlace>& places) {
    std::sort(places.begin(), places.end(), is_before);
    places.erase(std::unique(places.begin(), places.end()), places.end());
}

template <class T>
struct FoamHistory<T>::Level {
    Level(Frame<T> of, double cell, const Plan& plan)
        : cell_m(cell), bytes(plan.sea_bytes() + plan.frame_bytes()), frame(std::move(of)) {
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x)
                rest_m.emplace_back(static_cast<T>(x * cell), static_cast<T>(y * cell));
    }

    double cell_m;
    std::size_t bytes;
    Frame<T> frame;
    std::vector<glm::vec<2, T>> rest_m;  // a tile's nodes, from its first
};

template <class T>
struct FoamHistory<T>::Tile {
    Tile(const Place& at, std::size_t kept, std::size_t sums)
        : place(at),
          shares(Buffer<std::uint16_t>::uncleared(kept * kStride)),
          deviates(Buffer<float>::uncleared(kSamples * kStride)),
          foam(Buffer<float>::uncleared(sums * kStride)) {}

    std::span<float> residual() { return {foam.data(), kNodes}; }
    std::span<float> age() { return {foam.data() + kStride, kNodes}; }
    std::span<float> bubbles() { return {foam.data() + 2 * kStride, kNodes}; }
    std::size_t bytes() const {
        return shares.size() * sizeof(std::uint16_t) + (deviates.size() + foam.size()) * sizeof(float);
    }

    Place place;
    Buffer<std::uint16_t> shares;  // of interval n at n modulo their number
    Buffer<float> deviates;        // of sample n at n modulo kSamples
    Buffer<float> foam;            // what add() reads, at made_at
    // Shares of intervals begin … end − 1 are there; samples up to end + 2 were taken.
    std::int64_t begin = 0, end = 0, next = 0;
    double made_at = 0.0;
    bool is_begun = false, is_made = false;
    // When it was read last: the round, and its time.
    mutable std::atomic<long> used = 0;
    mutable std::atomic<double> used_at_s = 0.0;

    // Whether it has what a time reads whose first interval this is, or goes on to it.
    bool continues_at(std::int64_t first) const {
        const auto kept = static_cast<std::int64_t>(shares.size() / kStride);
        return begin <= first && first >= end - kept && first <= end;
    }
    bool is_of(double time_s) const { return is_made && made_at == time_s; }
    void was_read(long round, double time_s) const {
        used.store(round, std::memory_order_relaxed);
        used_at_s.store(time_s, std::memory_order_relaxed);
    }
};

// Finds the nodes round points: in two levels where a footprint lies between them.
template <class T>
class FoamHistory<T>::Locator {
  public:
    // Of at most kPart points.
    struct Part {
        std::array<int, kPart> level;
        alignas(64) std::array<float, kPart> t;  // of the level after it
        alignas(64) std::array<double, FoamAxis::kRoom> x_m, y_m;
        FoamAxis x, y;
    };

    glm::dvec2 rest_m(std::size_t point) const {
        return points_.origin_m + glm::dvec2(points_.rest_m[point]);
    }

    Locator(const FoamHistory& history, const Points<T>& points, int query)
        : points_(points), foam_(history.foam_), kernels_(history.kernels_) {
        const auto& asked = history.sea_->plan().queries.at(static_cast<std::size_t>(query)).query;
        whole_m_ = static_cast<float>(asked.pixel_m.front());
        whole_ = foam_level_blend(foam_, whole_m_);
        for (int level = 0; level < FoamPlan::kLevels; ++level)
            cells_[static_cast<std::size_t>(level)] = {
                .per_m = 1.0 / foam_.cell_of(level),
                .origin_m = points.origin_m - foam_.drift_of(level) * history.time_s_};
    }

    // Whether none of the part's points reads a level beside its own.
    static bool is_on_level(const Part& part, std::size_t count) {
        return std::all_of(part.t.begin(), part.t.begin() + count, [](float t) { return !(t > 0.0f); });
    }

    // Calls use(which, place, begin, end) for points of the part, one after another, that lie in one tile: in their level,
    // `which` = 0, and in the one after it, 1, where they read that as well. Where there are no cells, foam is the sea's mean.
    template <class Use>
    void operator()(std::size_t first, std::size_t count, Part& part, const Use& use) const {
        const auto take = [&](const auto& rest_m) {
            for (std::size_t i = 0; i < count; ++i) {
                const glm::vec<2, T>& at = rest_m[first + i];
                part.x_m[i] = static_cast<double>(at.x);
                part.y_m[i] = static_cast<double>(at.y);
            }
        };
        if (points_.rest_m.stride_bytes == sizeof(glm::vec<2, T>))
            take(&points_.rest_m[0]);  // side by side: in vectors
        else
            take(points_.rest_m);
        for (std::size_t i = 0; points_.pixel_m && i < count; ++i) {
            const FoamLevelBlend blend = foam_level_blend(foam_, footprint_m(first + i));
            part.level[i] = blend.level;
            part.t[i] = blend.t;
        }
        if (!points_.pixel_m) {
            std::fill_n(part.level.begin(), count, whole_.level);
            std::fill_n(part.t.begin(), count, whole_.t);
        }
        for (const int which : {0, 1}) {
            if (which == 1 && is_on_level(part, count)) continue;
            const auto level_of = [&](std::size_t i) {
                return which == 0 || part.t[i] > 0.0f ? part.level[i] + which : FoamPlan::kLevels;
            };
            for (std::size_t begin = 0, end; begin < count; begin = end) {
                const int level = level_of(begin);
                for (end = begin + 1; end < count && level_of(end) == level;) ++end;
                if (level < FoamPlan::kLevels)
                    for_tiles(level, begin, end, part, [&](const auto&... at) { use(which, at...); });
            }
        }
    }

    float footprint_m(std::size_t i) const {
        if (!points_.pixel_m) return whole_m_;
        return foam_footprint_m(static_cast<float>(points_.pixel_m[i]), length_m(i));
    }
    // What breaks is unresolved already where the longer axis hides it.
    float longer_m(std::size_t i) const {
        if (!points_.pixel_m) return whole_m_;
        return std::max(static_cast<float>(points_.pixel_m[i]), length_m(i));
    }

  private:
    float length_m(std::size_t i) const {
        if (!points_.pixel_axis_m) return 0.0f;
        const glm::vec<2, T> axis = points_.pixel_axis_m[i];
        return static_cast<float>(std::sqrt(axis.x * axis.x + axis.y * axis.y));
    }
    template <class Use>
    void for_tiles(int level, std::size_t first, std::size_t last, Part& part, const Use& use) const {
        const Cells& cells = cells_[static_cast<std::size_t>(level)];
        kernels_.place({cells.origin_m.x, cells.per_m, part.x_m.data()}, first, last, part.x);
        kernels_.place({cells.origin_m.y, cells.per_m, part.y_m.data()}, first, last, part.y);
        for (std::size_t begin = first, end; begin < last; begin = end) {
            const double x = part.x.tile[begin], y = part.y.tile[begin];
            for (end = begin + 1; end < last && part.x.tile[end] == x && part.y.tile[end] == y;) ++end;
            use(Place{level, static_cast<std::int64_t>(x), static_cast<std::int64_t>(y)}, begin, end);
        }
    }

    const Points<T>& points_;
    const FoamPlan& foam_;
    const FoamKernels& kernels_;
    float whole_m_ = 0.0f;
    FoamLevelBlend whole_;
    struct Cells {
        double per_m = 0.0;
        glm::dvec2 origin_m{0.0};  // the points', where the nodes are that drift
    };
    std::array<Cells, FoamPlan::kLevels> cells_{};
};

template <class T>
std::size_t FoamHistory<T>::HashOf::operator()(const Place& place) const {
    std::uint64_t hash = static_cast<std::uint64_t>(place.level);
    for (const std::int64_t v : {place.x, place.y})
        hash = (hash ^ static_cast<std::uint64_t>(v)) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
}

// The deviate, below 0, beyond which so small a share of a normal distribution lies.
static double deviate_of_share(double share) {
    double y = 0.0;
    for (double step = 8.0; step > 1e-6; step *= 0.5)
        if (0.5 * std::erfc(-(y - step) / std::sqrt(2.0)) >= share) y -= step;
    return y;
}

template <class T>
FoamHistory<T>::FoamHistory(std::shared_ptr<const Sea<T>> sea)
    : sea_(std::move(sea)), kernels_(foam_kernels()) {
    if (!sea_->plan().foam) throw std::invalid_argument("foam that doesn't live has no history");
    foam_ = *sea_->plan().foam;
    for (const double count : foam_tiles(sea_->plan()))
        most_tiles_ += static_cast<std::size_t>(std::ceil(count));
    const FoamPlan::Weight all = foam_.weight(0.0, foam_.window_s);
    mean_ = static_cast<float>(std::min(sea_->left_coverage(), 1.0));
    mean_age_s_ = static_cast<float>(all.age_s2 / all.foam_s);
    mean_bubbles_ =
        static_cast<float>(sea_->left_coverage() / all.foam_s * foam_.bubbles_weight_s(0.0, foam_.window_s));
    if (sea_->left_coverage() > 0.0)
        breaking_deviate_ = deviate_of_share(sea_->left_coverage() / (sea_->foam_left_per_s() * all.foam_s));
}

template <class T>
FoamHistory<T>::FoamHistory(std::shared_ptr<const SeaOverTime<T>> shot) : FoamHistory(shot->first()) {
    if (!shot->plan().from->weather) return;
    shot_ = std::move(shot);
    most_tiles_ = 0;  // as many as the shot's largest wind shows
    for (const double count : foam_tiles(shot_->plan()))
        most_tiles_ += static_cast<std::size_t>(std::ceil(count));
}

template <class T>
FoamHistory<T>::~FoamHistory() = default;

template <class T>
bool FoamHistory<T>::leaves_nothing() const {
    if (!shot_) return !(sea_->foam_left_per_s() > 0.0);
    return std::ranges::none_of(weights_, [](const IntervalWeight& weight) { return weight.foam > 0.0f; });
}

template <class T>
const Whitecaps& FoamHistory<T>::whitecaps(std::int64_t n) {
    if (!shot_) return sea_->whitecaps();
    if (const auto found = whitecaps_.find(n); found != whitecaps_.end()) return found->second;
    return whitecaps_.emplace(n, shot_->whitecaps(static_cast<double>(n) * foam_.step_s)).first->second;
}

// What all breaking of the past has left, over the whole of a sea that changes.
template <class T>
void FoamHistory<T>::find_means() {
    whitecaps_.erase(whitecaps_.begin(), whitecaps_.lower_bound(first_ - kSamples));
    whitecaps_.erase(whitecaps_.upper_bound(last_ + kSamples), whitecaps_.end());
    const double lasting_s = foam_.weight(0.0, foam_.window_s).foam_s;
    double foam = 0.0, aged = 0.0, bubbles = 0.0;
    for (std::int64_t n = first_; n <= last_; ++n) {
        const double since_s = time_s_ - static_cast<double>(n) * foam_.step_s;
        const double left = 0.5 * (whitecaps(n).left_coverage + whitecaps(n + 1).left_coverage) / lasting_s;
        const FoamPlan::Weight weight = foam_.weight(since_s - foam_.step_s, since_s);
        foam += left * weight.foam_s;
        aged += left * weight.age_s2;
        bubbles += left * foam_.bubbles_weight_s(since_s - foam_.step_s, since_s);
    }
    mean_ = static_cast<float>(std::min(foam, 1.0));
    mean_age_s_ = foam > 0.0 ? static_cast<float>(aged / foam) : 0.0f;
    mean_bubbles_ = static_cast<float>(bubbles);
    if (const auto& gusts = sea_->plan().gusts; gusts && !gusts->fronts.empty())
        gusts_ = shot_->whitecaps(time_s_).gusts;
}

template <class T>
void FoamHistory<T>::set(double t_s) {
    if (!(std::abs(t_s) <= Frame<T>::kLatest_s))
        throw std::invalid_argument("the foam's time must be a number of at most 1e12 s to either side of 0");
    ++round_;
    is_renewed_ = false;
    time_s_ = time_within_loop_s(t_s, sea_->loop_s());
    last_ = static_cast<std::int64_t>(std::floor(time_s_ / foam_.step_s));
    first_ = last_ + 1 - foam_.intervals();
    std::erase_if(tiles_, [&](const auto& entry) { return !entry.second->continues_at(first_); });
    weights_.clear();
    for (std::int64_t n = first_; n <= last_; ++n) {
        const double since_s = time_s_ - static_cast<double>(n) * foam_.step_s;
        const FoamPlan::Weight weight = foam_.weight(since_s - foam_.step_s, since_s);
        const double left_per_s =
            shot_ ? 0.5 * (whitecaps(n).left_per_s + whitecaps(n + 1).left_per_s) : sea_->foam_left_per_s();
        weights_.push_back(
            {static_cast<float>(left_per_s * weight.foam_s), static_cast<float>(left_per_s * weight.age_s2),
             static_cast<float>(left_per_s * foam_.bubbles_weight_s(since_s - foam_.step_s, since_s))});
    }
    if (shot_) find_means();
}

template <class T>
typename FoamHistory<T>::Level& FoamHistory<T>::level(int index, const std::atomic<bool>* cancel) {
    std::unique_ptr<Level>& level = levels_[static_cast<std::size_t>(index)];
    if (level) return *level;
    const double cell_m = foam_.cell_of(index);
    const BuildWatch watch{.progress = {}, .cancel = cancel};
    Plan plan = plan_of_foam_level(shot_ ? shot_->plan() : sea_->plan(), cell_m);
    Frame<T> frame =
        shot_ ? Frame<T>(std::make_shared<const SeaOverTime<T>>(plan, watch, shot_.get()))
              : Frame<T>(std::make_shared<const Sea<T>>(plan, watch, sea_->spectrum_table(), sea_->coast()));
    level = std::make_unique<Level>(std::move(frame), cell_m, plan);
    return *level;
}

// Two sums at points from `first` on; false where a tile is missing, which is noted.
template <class T>
bool FoamHistory<T>::read(const Locator& locate, std::size_t first, const Sums& sums, std::span<float> foam,
                          std::span<float> aged, std::vector<Place>& missing) const {
    const std::size_t missed = missing.size();
    typename Locator::Part part;
    alignas(64) std::array<float, kPart> next, next_age;
    for (const std::span<float> of : {foam, std::span<float>(next)})
        std::fill(of.begin(), of.end(), sums.mean_of_first);
    for (const std::span<float> of : {aged, std::span<float>(next_age)})
        std::fill(of.begin(), of.end(), sums.mean_of_second);
    locate(first, foam.size(), part, [&](int which, const Place& place, std::size_t begin, std::size_t end) {
        const auto found = tiles_.find(place);
        if (found != tiles_.end()) found->second->was_read(round_, time_s_);
        if (found == tiles_.end() || !found->second->is_of(time_s_)) return missing.push_back(place);
        const float* values = found->second->foam.data();
        kernels_.between({values + sums.first * kStride, values + sums.second * kStride}, part.x, part.y,
                         begin, end, which == 0 ? foam.data() : next.data(),
                         which == 0 ? aged.data() : next_age.data());
    });
    const auto& masks = sea_->plan().masks;
    const std::optional<Gusts>& now = shot_ ? gusts_ : sea_->gusts();
    const Gusts* const gusts = now && !now->plan.fronts.empty() ? &*now : nullptr;
    for (std::size_t i = 0; (masks || gusts) && i < foam.size(); ++i) {
        if (part.level[i] + 1 < FoamPlan::kLevels) continue;
        // Beyond all tiles masks leave as much of the mean, and fronts make as much of it, where they are now.
        const glm::dvec2 place_m = locate.rest_m(first + i);
        double gained = 1.0;
        if (masks) {
            const MaskGains<double> gains = masks->at(place_m);
            gained = gains.foam * masked_breaking(gains.waves, breaking_deviate_);
        }
        if (gusts)
            gained *= gusts->foam_of(gusts->plan.fronts_wind(
                place_m, static_cast<double>(locate.footprint_m(first + i)), time_s_));
        const auto gain = static_cast<float>(gained);
        next[i] *= gain;
        next_age[i] *= gain;
        if (part.level[i] < FoamPlan::kLevels) continue;
        foam[i] *= gain;
        aged[i] *= gain;
    }
    const bool blends = !Locator::is_on_level(part, foam.size());
    for (std::size_t i = 0; blends && i < foam.size(); ++i) {
        foam[i] += part.t[i] * (next[i] - foam[i]);
        aged[i] += part.t[i] * (next_age[i] - aged[i]);
    }
    return missing.size() == missed;
}

// Calls use(first, of the first sum, of the second) for parts of the points. Most tiles are there from the time before; parts that lack
// some are read again when those are made.
template <class T>
template <class Use>
void FoamHistory<T>::for_parts(const Points<T>& points, int query, const Sums& sums, const BuildWatch& watch,
                               const Use& use) {
    if (round_ == 0) throw std::invalid_argument("the foam has no time yet: call set() first");
    renew(watch);
    const Locator locate(*this, points, query);
    std::vector<std::size_t> parts;
    for (std::size_t first = 0; first < points.count; first += kPart) parts.push_back(first);
    tbb::enumerable_thread_specific<std::vector<Place>> missing;
    tbb::enumerable_thread_specific<std::vector<std::size_t>> undone;
    while (!parts.empty()) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, parts.size(), 8), [&](const auto& range) {
            alignas(64) std::array<float, kPart> foam, aged;
            for (std::size_t p = range.begin(); p < range.end(); ++p) {
                const std::size_t first = parts[p], count = std::min(kPart, points.count - first);
                if (read(locate, first, sums, {foam.data(), count}, {aged.data(), count}, missing.local()))
                    use(first, std::span<const float>(foam.data(), count),
                        std::span<const float>(aged.data(), count));
                else
                    undone.local().push_back(first);
            }
        });
        std::vector<Place> places;
        parts.clear();
        for (std::vector<Place>& own : missing)
            places.insert(places.end(), own.begin(), own.end()), own.clear();
        for (std::vector<std::size_t>& own : undone)
            parts.insert(parts.end(), own.begin(), own.end()), own.clear();
        keep_each_once(places);
        make_room(places.size(),
                  round_ - 1);  // who doesn't prepare asks for those of the time before bit by bit
        make(places, watch);
    }
}

template <class T>
std::vector<FoamPlace> FoamHistory<T>::places(const Points<T>& points, int query) const {
    if (round_ == 0) throw std::invalid_argument("the foam has no time yet: call set() first");
    if (leaves_nothing()) return {};
    const Locator locate(*this, points, query);
    tbb::enumerable_thread_specific<std::vector<Place>> found;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.count, kPart), [&](const auto& range) {
        std::vector<Place>& own = found.local();
        std::array<Place, FoamPlan::kLevels> before;
        before.fill({-1, 0, 0});
        typename Locator::Part part;
        for (std::size_t first = range.begin(); first < range.end(); first += kPart)
            locate(first, std::min(kPart, range.end() - first), part,
                   [&](int, const Place& place, std::size_t, std::size_t) {
                       Place& last = before[static_cast<std::size_t>(place.level)];
                       if (!(place == last)) own.push_back(last = place);
                   });
        keep_each_once(own);
    });
    std::vector<Place> all;
    for (const std::vector<Place>& own : found) all.insert(all.end(), own.begin(), own.end());
    keep_each_once(all);
    return all;
}

template <class T>
void FoamHistory<T>::prepare(std::vector<FoamPlace> places, const BuildWatch& watch) {
    if (leaves_nothing()) return;
    if (round_ == 0) throw std::invalid_argument("the foam has no time yet: call set() first");
    keep_each_once(places);
    is_renewed_ = true;
    const std::vector<FoamPlace> beside = surroundings_of(places);
    std::vector<FoamPlace> made = places;
    made.insert(made.end(), beside.begin(), beside.end());
    std::size_t missing = 0;
    for (const FoamPlace& place : made) {
        const auto found = tiles_.find(place);
        if (found != tiles_.end())
            found->second->was_read(round_, time_s_);
        else
            ++missing;
    }
    make_room(missing, round_);
    const auto mark = [&](const std::vector<FoamPlace>& of, long round) {
        for (const FoamPlace& place : of)
            if (const auto found = tiles_.find(place); found != tiles_.end())
                found->second->was_read(round, time_s_);
    };
    // They count as read at the time before: nobody has asked for them, so they are not among nodes(), and need no
    // renewing.
    const auto mark_those_beside = [&] { mark(beside, round_ - 1); };
    try {
        make(made, watch);
    } catch (...) {
        mark_those_beside();
        throw;
    }
    mark(places, round_);
    mark_those_beside();
}

// A level that lacks one tile goes through its past for that one. In a run the missing tiles round all that are asked
// for are made along with it, so that moving waves and cameras don't ask for that at each frame: level by level,
// where there is room beside the tiles read not long ago. At the first time none are made beside: a single picture
// would have no use for them.
template <class T>
std::vector<FoamPlace> FoamHistory<T>::surroundings_of(const std::vector<FoamPlace>& places) const {
    constexpr double kNotLong_s = 1.0;
    std::array<bool, FoamPlan::kLevels> goes_on{};
    std::size_t held = places.size();
    for (const auto& [place, tile] : tiles_) {
        goes_on[static_cast<std::size_t>(place.level)] = true;
        held += std::abs(tile->used_at_s.load() - time_s_) <= kNotLong_s &&
                !std::binary_search(places.begin(), places.end(), place, is_before);
    }
    std::size_t room = most_tiles_ - std::min(most_tiles_, held);
    std::vector<FoamPlace> beside;
    for (auto first = places.begin(), last = first; first != places.end(); first = last) {
        last = std::find_if(first, places.end(),
                            [&](const Place& place) { return place.level != first->level; });
        std::vector<FoamPlace> lacking;
        std::copy_if(first, last, std::back_inserter(lacking),
                     [&](const Place& place) { return !tiles_.contains(place); });
        if (lacking.empty() || !goes_on[static_cast<std::size_t>(first->level)]) continue;
        // Round all of a level's tiles, or where there is no room for that, round those that it lacks.
        for (const std::span<const FoamPlace> middle :
             {std::span<const FoamPlace>(first, last), std::span<const FoamPlace>(lacking)}) {
            std::vector<FoamPlace> round;
            for (const FoamPlace& place : middle)
                for (const int x : {-1, 0, 1})
                    for (const int y : {-1, 0, 1}) {
                        const FoamPlace at{place.level, place.x + x, place.y + y};
                        if (!tiles_.contains(at) && !std::binary_search(first, last, at, is_before))
                            round.push_back(at);
                    }
            keep_each_once(round);
            if (round.size() > room) continue;
            room -= round.size();
            beside.insert(beside.end(), round.begin(), round.end());
            break;
        }
    }
    return beside;
}

template <class T>
std::vector<FoamNodes> FoamHistory<T>::nodes() const {
    std::vector<FoamNodes> nodes;
    for (const auto& [place, tile] : tiles_)
        if (tile->used.load() == round_ && tile->is_of(time_s_))
            nodes.push_back({place, tile->foam.data(), tile->foam.data() + kStride,
                             foam_.sums() > 2 ? tile->foam.data() + 2 * kStride : nullptr});
    std::sort(nodes.begin(), nodes.end(),
              [](const FoamNodes& a, const FoamNodes& b) { return order_of(a.place) < order_of(b.place); });
    return nodes;
}

// For so many more tiles: lets those go that nobody has read for longest, of those that were read before this round.
template <class T>
void FoamHistory<T>::make_room(std::size_t count, long round) {
    if (tiles_.size() + count <= most_tiles_) return;
    std::vector<std::pair<long, Place>> unused;
    for (const auto& [place, tile] : tiles_)
        if (const long used = tile->used.load(); used < round) unused.emplace_back(used, place);
    std::sort(unused.begin(), unused.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const std::size_t too_many = tiles_.size() + count - most_tiles_;
    for (std::size_t i = 0; i < std::min(too_many, unused.size()); ++i) tiles_.erase(unused[i].second);
}

// Brings the tiles of the time before to this one.
template <class T>
void FoamHistory<T>::renew(const BuildWatch& watch) {
    if (is_renewed_) return;
    is_renewed_ = true;
    std::vector<Place> places;
    for (const auto& [place, tile] : tiles_)
        if (tile->used.load() + 1 >= round_) places.push_back(place);
    make(places, watch);
}

template <class T>
void FoamHistory<T>::make(std::vector<Place>& places, const BuildWatch& watch) {
    keep_each_once(places);
    std::vector<Tile*> old;
    const auto kept = static_cast<std::size_t>(foam_.intervals() + FoamPlan::kSpareIntervals);
    for (const Place& place : places) {
        auto tile = tiles_.find(place);  // made before it is entered: memory may be refused
        if (tile == tiles_.end())
            tile = tiles_.emplace(place, std::make_unique<Tile>(place, kept, foam_.sums())).first;
        if (!tile->second->is_of(time_s_)) old.push_back(tile->second.get());
    }
    if (old.empty()) return;
    advance(old, watch);
    tbb::parallel_for(std::size_t(0), old.size(), [&](std::size_t i) {
        Tile& tile = *old[i];
        std::vector<FoamShares> shares;
        for (std::int64_t n = first_; n <= last_; ++n) {
            const IntervalWeight& weight = weights_[static_cast<std::size_t>(n - first_)];
            if (weight.foam > 0.0f)
                shares.push_back({tile.shares.data() + modulo(n, kept) * kStride, weight.foam, weight.age});
        }
        kernels_.sum(shares, tile.residual(), tile.age());
        if (foam_.sums() > 2) {
            shares.clear();
            for (std::int64_t n = first_; n <= last_; ++n)
                if (const float bubbles = weights_[static_cast<std::size_t>(n - first_)].bubbles;
                    bubbles > 0.0f)
                    shares.push_back({tile.shares.data() + modulo(n, kept) * kStride, bubbles, 0.0f});
            std::array<float, kStride> nothing;
            kernels_.sum(shares, tile.bubbles(), {nothing.data(), kNodes});
        }
        tile.made_at = time_s_;
        tile.is_made = true;
    });
}

// Takes the samples that the tiles lack. The interval after sample n is known by samples n − 2 … n + 3.
template <class T>
void FoamHistory<T>::advance(const std::vector<Tile*>& tiles, const BuildWatch& watch) {
    std::int64_t from = last_ + 4;
    for (Tile* tile : tiles) {
        if (!tile->is_begun || !tile->continues_at(first_)) {
            tile->is_begun = true;
            tile->begin = tile->end = first_;
            tile->next = first_ - 2;
        }
        from = std::min(from, tile->next);
    }
    try {
        sample_from(from, tiles, watch);
    } catch (const BuildCancelled&) {
        for (Tile* tile : tiles) tile->was_read(round_, time_s_);  // what they have is kept for the next time
        throw;
    }
}

// Samples `from` on, of the tiles whose next one it is.
template <class T>
void FoamHistory<T>::sample_from(std::int64_t from, const std::vector<Tile*>& tiles,
                                 const BuildWatch& watch) {
    const auto is_cancelled = [&] { return watch.cancel && watch.cancel->load(std::memory_order_relaxed); };
    std::vector<Tile*> due;  // in the order of places
    std::vector<std::span<Tile* const>> rows;
    const std::int64_t end = last_ + 4;
    const bool is_long = end - from > kLong;
    for (std::int64_t n = from; n < end; ++n) {
        for (int l = 0; l < FoamPlan::kLevels; ++l) {
            due.clear();
            for (Tile* tile : tiles)
                if (tile->place.level == l && tile->next == n) due.push_back(tile);
            if (due.empty()) continue;
            if (is_cancelled()) throw BuildCancelled();
            Frame<T>& frame = level(l, watch.cancel).frame;
            frame.set(static_cast<double>(n) * foam_.step_s);
            ProductSet wanted = products(Product::JacobianMoments);
            if (frame.sea().has_surf()) wanted |= products(Product::Displacement);
            const PreparedQuery<T> query(frame, 0, wanted);
            const Whitecaps& now = whitecaps(n);
            rows.clear();
            const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
            const std::size_t most = (due.size() + threads - 1) / threads;  // few tiles keep all threads busy
            for (std::size_t first = 0, next = 0; first < due.size(); first = next) {
                next = first + 1;
                while (next < due.size() && next - first < most &&
                       goes_on_in_row(due[next - 1]->place, due[next]->place))
                    ++next;
                rows.push_back(std::span(due).subspan(first, next - first));
            }
            tbb::parallel_for(std::size_t(0), rows.size(), [&](std::size_t i) {
                if (!is_cancelled()) sample(rows[i], n, query, now);
            });
            if (is_cancelled()) throw BuildCancelled();
        }
        if (is_long && watch.progress)
            watch.progress(static_cast<double>(n + 1 - from) / static_cast<double>(end - from));
    }
}

template <class T>
glm::dvec2 FoamHistory<T>::first_node_m(const Place& place, double time_s) const {
    return foam_.cell_of(place.level) * FoamPlan::kTileCells * glm::dvec2(place.x, place.y) +
           foam_.drift_of(place.level) * time_s;
}

template <class T>
void FoamHistory<T>::calm(std::uint16_t* shares, const Place& place, std::int64_t interval) const {
    const glm::dvec2 first_m = first_node_m(place, (static_cast<double>(interval) + 0.5) * foam_.step_s);
    const std::vector<glm::vec<2, T>>& rest_m = levels_[static_cast<std::size_t>(place.level)]->rest_m;
    for (std::size_t i = 0; i < kNodes; ++i) {
        const auto gain = static_cast<float>(sea_->plan().masks->at(first_m + glm::dvec2(rest_m[i])).foam);
        if (gain == 1.0f) continue;
        const float share = gain * std::bit_cast<float>(static_cast<std::uint32_t>(shares[i]) << 16);
        shares[i] = static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(share) >> 16);
    }
}

// Of tiles that goes_on_in_row(): points in long rows cost less than those of one tile after another.
template <class T>
void FoamHistory<T>::sample(std::span<Tile* const> row, std::int64_t n, const PreparedQuery<T>& query,
                            const Whitecaps& now) const {
    const FoamPlace& first = row.front()->place;
    const Level& level = *levels_[static_cast<std::size_t>(first.level)];
    constexpr std::size_t kCells = FoamPlan::kTileCells;
    // Relative to the strip's first node, whichever of its tiles are sampled: a node's value depends on nothing else.
    const std::int64_t strip_x = strip_of(first) * kStripTiles;
    const std::size_t begin = static_cast<std::size_t>(first.x - strip_x) * kCells,
                      columns = row.size() * kCells + 1;
    static thread_local std::vector<glm::vec<2, T>> rest_m;
    rest_m.clear();
    for (int y = 0; y < kSide; ++y)
        for (std::size_t x = 0; x < columns; ++x)
            rest_m.emplace_back(static_cast<T>(static_cast<double>(begin + x) * level.cell_m),
                                static_cast<T>(y * level.cell_m));
    static thread_local std::vector<glm::vec<3, T>> moments, moved;
    moments.resize(rest_m.size());
    Results<T> results;
    results.set(Product::JacobianMoments, {moments.data()});
    const bool has_surf = level.frame.sea().has_surf();
    moved.resize(has_surf ? rest_m.size() : 0);
    if (has_surf) results.set(Product::Displacement, {moved.data()});
    const Points<T> points{
        .origin_m = first_node_m({first.level, strip_x, first.y}, static_cast<double>(n) * foam_.step_s),
        .count = rest_m.size(),
        .rest_m = {rest_m.data()}};
    query.evaluate_alone(points, results);
    for (std::size_t i = 0; i < row.size(); ++i)
        take_sample(*row[i], n, now,
                    {moments.data() + i * kCells, has_surf ? moved.data() + i * kCells : nullptr, columns});
}

template <class T>
void FoamHistory<T>::take_sample(Tile& tile, std::int64_t n, const Whitecaps& now,
                                 const RowValues& values) const {
    const Level& level = *levels_[static_cast<std::size_t>(tile.place.level)];
    const glm::dvec2 origin_m = first_node_m(tile.place, static_cast<double>(n) * foam_.step_s);
    const auto in_row = [&](std::size_t node) { return node / kSide * values.columns + node % kSide; };
    alignas(64) std::array<float, kStride> mean, variance, third, threshold;
    for (std::array<float, kStride>* of : {&mean, &variance, &third})
        std::fill(of->begin() + kNodes, of->end(),
                  1.0f);  // behind the last node: of no interest, but numbers
    for (std::size_t i = 0; i < kNodes; ++i) {
        const glm::vec<3, T>& moments = values.moments[in_row(i)];
        mean[i] = static_cast<float>(moments.x);
        variance[i] = static_cast<float>(moments.y);
        third[i] = static_cast<float>(moments.z);
    }
    threshold.fill(static_cast<float>(now.threshold));
    if (now.gusts)
        whitecap_thresholds<T>(*now.gusts, level.frame.time_within_loop_s(),
                               {.origin_m = origin_m, .count = kNodes, .rest_m = {level.rest_m.data()}},
                               level.cell_m, threshold);
    const auto deviates = [&](std::int64_t sample) {
        return tile.deviates.data() + modulo(sample, kSamples) * kStride;
    };
    if (std::isfinite(now.threshold))
        kernels_.deviates(mean.data(), variance.data(), third.data(), threshold.data(),
                          sea_->plan().knobs.third_moment, {deviates(n), kNodes});
    else
        std::fill_n(deviates(n), kStride, kNoBreaking);
    // A whitecap leaves its foam once, at foam_left_per_s() while it lasts. A roller breaks all the way in over water that foams already: of it
    // such a share of that rate that what it leaves is on the mean no more than what breaks, however long foam lives. (Deviates between
    // a crest and the trough lose up to half of it.)
    const double lasting = sea_->foam_left_per_s() * foam_.weight(0.0, foam_.window_s).foam_s,
                 source = 1.0 / std::max(lasting, 1.0);
    for (std::size_t i = 0; i < kNodes && values.moved; ++i) {
        const double foam = source * level.frame.sea().surf_foam(
                                         origin_m + glm::dvec2(level.rest_m[i]),
                                         static_cast<double>(values.moved[in_row(i)].z), level.cell_m);
        deviates(n)[i] = std::max(deviates(n)[i], static_cast<float>(quick_deviate(foam)));
    }
    // In a calm J is 1 throughout, as far from breaking as can be.
    if (const auto& masks = sea_->plan().masks) {
        const double side_m = level.cell_m * FoamPlan::kTileCells;
        if (masks->gains_in(origin_m, origin_m + side_m).least < 1.0)
            for (std::size_t i = 0; i < kNodes; ++i)
                if (masks->at(origin_m + glm::dvec2(level.rest_m[i])).waves < 1.0)
                    deviates(n)[i] = std::max(deviates(n)[i], kNoBreaking);
    }
    tile.next = n + 1;
    const std::int64_t interval = n - 3;
    if (interval < tile.end) return;
    const float* const six[kSamples] = {deviates(n - 5), deviates(n - 4), deviates(n - 3),
                                        deviates(n - 2), deviates(n - 1), deviates(n)};
    const auto kept = static_cast<std::size_t>(foam_.intervals() + FoamPlan::kSpareIntervals);
    std::uint16_t* shares = tile.shares.data() + modulo(interval, kept) * kStride;
    kernels_.share(six, {shares, kNodes});
    if (sea_->plan().masks && sea_->plan().masks->calms_foam) calm(shares, tile.place, interval);
    tile.end = interval + 1;
}

template <class T>
void FoamHistory<T>::add(const Points<T>& points, int query, const FoamResults<T>& results,
                         const BuildWatch& watch) {
    if (leaves_nothing()) {
        for (std::size_t i = 0; i < points.count; ++i) {
            if (results.coverage) results.coverage[i] = results.breaking[i];
            if (results.age_s) results.age_s[i] = T(0);
        }
        return;
    }
    const Locator locate(*this, points, query);
    const auto past_m = static_cast<float>(foam_.past_m), breaking_m = static_cast<float>(foam_.breaking_m);
    for_parts(points, query, {0, 1, mean_, mean_ * mean_age_s_}, watch,
              [&](std::size_t first, std::span<const float> foam, std::span<const float> aged) {
                  const std::size_t count = foam.size();
                  alignas(64) std::array<float, kPart> breaking, under, all, age_s;
                  for (std::size_t i = 0; i < count; ++i) {
                      breaking[i] = static_cast<float>(results.breaking[first + i]);
                      under[i] = share_under_breaking(locate.longer_m(first + i), past_m, breaking_m);
                  }
                  std::fill(breaking.begin() + count, breaking.end(), 0.0f);
                  std::fill(under.begin() + count, under.end(), 0.0f);
                  kernels_.add({foam.data(), aged.data()}, breaking.data(), under.data(), count, all.data(),
                               age_s.data());
                  for (std::size_t i = 0; results.coverage && i < count; ++i)
                      results.coverage[first + i] = static_cast<T>(all[i]);
                  for (std::size_t i = 0; results.age_s && i < count; ++i)
                      results.age_s[first + i] = static_cast<T>(age_s[i]);
              });
}

template <class T>
void FoamHistory<T>::add_bubbles(const Points<T>& points, int query, std::span<float> bubbles,
                                 const BuildWatch& watch) {
    if (leaves_nothing() || foam_.sums() < 3) return std::fill(bubbles.begin(), bubbles.end(), 0.0f);
    for_parts(points, query, {2, 2, mean_bubbles_, mean_bubbles_}, watch,
              [&](std::size_t first, std::span<const float> left, std::span<const float>) {
                  std::copy(left.begin(), left.end(), bubbles.begin() + static_cast<std::ptrdiff_t>(first));
              });
}

template <class T>
std::size_t FoamHistory<T>::held_bytes() const {
    std::size_t bytes = 0;
    for (const auto& [place, tile] : tiles_) bytes += tile->bytes();
    for (const auto& level : levels_)
        if (level) bytes += level->bytes;
    return bytes;
}

template class FoamHistory<float>;
template class FoamHistory<double>;

}  // namespace pelagic
