#include "plugin/bake/measure.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "core/plan/tables.h"
#include "core/scene/names.h"
#include "plugin/bake/sequence.h"

namespace pelagic {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

struct FrameTimes {
    double compute_ms = 0.0, encode_ms = 0.0;
};

// Frames of a shot; none, and no time, where it asks for nothing.
class Runner {
  public:
    Runner(const Scene& scene, const Plan& plan) {
        const auto start = Clock::now();
        if (!plan.queries.empty()) sequence_ = make_sequence(scene, plan);
        build_s_ = seconds_since(start);
    }
    FrameTimes run(int frame) {
        if (!sequence_) return {};
        const auto start = Clock::now();
        sequence_->compute(frame, slot_);
        const double compute_s = seconds_since(start);
        sequence_->encode(slot_);
        return {1e3 * compute_s, 1e3 * (seconds_since(start) - compute_s)};
    }
    double build_s() const { return build_s_; }

  private:
    std::unique_ptr<Sequence> sequence_;
    FrameSlot slot_;
    double build_s_ = 0.0;
};

// values[fraction of the way] of the sorted values, which must not be empty.
double quantile(const std::vector<double>& sorted, double fraction) {
    return sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1) + 0.5)];
}

Milliseconds summary(std::vector<double> ms) {
    if (ms.empty()) return {};
    std::sort(ms.begin(), ms.end());
    return {quantile(ms, 0.5), 0.5 * (quantile(ms, 0.75) - quantile(ms, 0.25))};
}

struct Samples {
    std::vector<double> compute_ms, encode_ms;
    void add(const FrameTimes& times) {
        compute_ms.push_back(times.compute_ms);
        encode_ms.push_back(times.encode_ms);
    }
};

// Whether both plans compute the same numbers in the same way.
bool same_work(const Plan& a, const Plan& b) {
    return a.dropped == b.dropped && std::equal(a.queries.begin(), a.queries.end(), b.queries.begin(),
                                                b.queries.end(), [](const auto& x, const auto& y) {
                                                    return x.query.name == y.query.name &&
                                                           x.query.products == y.query.products;
                                                });
}

std::size_t held_bytes(const Scene& scene, const Plan& plan) {
    std::size_t bytes = plan.sea_bytes() + plan.frame_bytes() + plan.output_bytes();
    for (const PlannedQuery& planned : plan.queries) {
        // Encoded, at most: 18 bytes a number of text, 12 a texel, and a third more in levels, with as much
        // again while a file is made.
        constexpr std::size_t kText = 18, kTexel = 32;
        std::size_t scalars = 0;
        for (const ProductRow& row : kProductTable)
            if (planned.query.products[index(row.product)]) scalars += row.scalars;
        if (planned.query.map)
            bytes += planned.query.points * kTexel;
        else if (scene.output.mesh == MeshFormat::Usda)
            bytes += planned.query.points * scalars * kText;
    }
    return bytes;
}

}  // namespace

PlanCost cost_of(const Plan& plan) {
    return {plan.transforms_per_frame(), plan.lines_per_frame(), static_cast<std::int64_t>(plan.sea_bytes()),
            static_cast<std::int64_t>(plan.frame_bytes()), static_cast<std::int64_t>(plan.output_bytes())};
}

PlanCost operator-(const PlanCost& a, const PlanCost& b) {
    return {a.transforms - b.transforms, a.lines - b.lines, a.sea_bytes - b.sea_bytes,
            a.frame_bytes - b.frame_bytes, a.output_bytes - b.output_bytes};
}

std::vector<MeasureItem> measure_items(const Scene& scene) {
    std::vector<MeasureItem> items;
    const auto add = [&](std::string name, const auto& take_away) {
        MeasureItem item{std::move(name), scene};
        take_away(item.without);
        // No map, no tile of it.
        if (item.without.output.maps.empty()) item.without.output.cascade_tiles = false;
        items.push_back(std::move(item));
    };
    const Output& output = scene.output;
    if (output.mesh != MeshFormat::None) {
        add("mesh", [](Scene& without) { without.output.mesh = MeshFormat::None; });
        for (const AttributeRow& row : kAttributeTable)
            if (std::find(output.attributes.begin(), output.attributes.end(), row.attribute) !=
                output.attributes.end())
                add("mesh " + std::string(word_of(row.attribute)),
                    [&](Scene& without) { std::erase(without.output.attributes, row.attribute); });
    }
    for (const MapRow& row : kMapTable)
        if (std::find(output.maps.begin(), output.maps.end(), row.map) != output.maps.end())
            add("map " + std::string(row.name),
                [&](Scene& without) { std::erase(without.output.maps, row.map); });
    if (output.cascade_tiles) add("tiles", [](Scene& without) { without.output.cascade_tiles = false; });
    for (const EffectRow& row : kEffectTable)
        if (row.is_on(scene)) add(row.name, row.turn_off);
    return items;
}

std::size_t measure_bytes(const Scene& scene) {
    std::size_t beside = 0;
    for (const MeasureItem& item : measure_items(scene))
        beside = std::max(beside, held_bytes(item.without, make_plan(item.without)));
    return held_bytes(scene, make_plan(scene)) + beside;
}

Measured measure(const Scene& scene, const MeasureOptions& options) {
    const std::vector<MeasureItem> items = measure_items(scene);
    const Plan plan = make_plan(scene);
    MeasureProgress progress{.items = static_cast<int>(items.size())};
    const auto tell = [&](const std::string& name, double seconds_left) {
        progress.name = name;
        progress.seconds_left = seconds_left;
        if (options.progress) options.progress(progress);
    };
    tell("the whole", 0.0);
    Runner whole(scene, plan);
    const FrameTimes first = whole.run(scene.shot.first_frame);  // which also allocates
    const double pair_s = 2e-3 * (first.compute_ms + first.encode_ms);
    const auto bounded = [&](double pairs) {
        return std::clamp(pairs, 1.0 * options.least_pairs, 1.0 * options.most_pairs);
    };
    const double item_s = whole.build_s() + pair_s * (1.0 + bounded(options.seconds_an_item / pair_s));

    Samples of_whole;
    const auto frame_of = [&](int i) {
        const long count = long{scene.shot.last_frame} - scene.shot.first_frame + 1;
        return static_cast<int>(scene.shot.first_frame + i % count);
    };
    const auto measure_item = [&](const MeasureItem& item) {
        const Plan planned = make_plan(item.without);
        Measured result{.name = item.name, .cost = cost_of(plan) - cost_of(planned)};
        if (same_work(plan, planned)) return result;
        Runner without(item.without, planned);
        without.run(scene.shot.first_frame);
        Samples difference;
        const auto start = Clock::now();
        for (; result.pairs < options.most_pairs; ++result.pairs) {
            if (result.pairs >= options.least_pairs && seconds_since(start) > options.seconds_an_item) break;
            // Each of the two goes first every other time: whoever comes second finds the caches as the first
            // left them.
            const int frame = frame_of(result.pairs);
            FrameTimes with, less;
            if (result.pairs % 2 == 0) with = whole.run(frame);
            less = without.run(frame);
            if (result.pairs % 2 == 1) with = whole.run(frame);
            of_whole.add(with);
            difference.add({with.compute_ms - less.compute_ms, with.encode_ms - less.encode_ms});
            tell(item.name, std::max(item_s - seconds_since(start), 0.0) +
                                item_s * (progress.items - progress.item - 1));
        }
        result.compute = summary(std::move(difference.compute_ms));
        result.encode = summary(std::move(difference.encode_ms));
        return result;
    };
    for (; progress.item < progress.items; ++progress.item) {
        tell(items[progress.item].name, item_s * (progress.items - progress.item));
        const Measured result = measure_item(items[progress.item]);
        if (options.measured) options.measured(result);
    }
    return {.name = "the whole",
            .cost = cost_of(plan),
            .compute = summary(of_whole.compute_ms),
            .encode = summary(of_whole.encode_ms),
            .pairs = static_cast<int>(of_whole.compute_ms.size())};
}

}  // namespace pelagic
