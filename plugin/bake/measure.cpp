#include "plugin/bake/measure.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "core/plan/effects.h"
#include "core/plan/fingerprint.h"
#include "core/scene/names.h"
#include "plugin/bake/bake.h"
#include "plugin/bake/sequence.h"
#include "plugin/machine/memory.h"

namespace pelagic {
namespace {

using Clock = std::chrono::steady_clock;

double elapsed_s(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Frames of a shot; none, and no time, where it asks for nothing.
class Runner {
  public:
    explicit Runner(const Plan& plan) {
        const auto start = Clock::now();
        if (!plan.outputs.empty()) sequence_ = make_sequence(plan);
        build_s_ = elapsed_s(start);
    }
    double compute_ms(int frame) {
        return timed_ms([&] { sequence_->compute(frame, slot_); });
    }
    // Of the frame that was computed last.
    double encode_ms() {
        return timed_ms([&] { sequence_->encode(slot_); });
    }
    double build_s() const { return build_s_; }

  private:
    template <class Work>
    double timed_ms(const Work& work) {
        if (!sequence_) return 0.0;
        const auto start = Clock::now();
        work();
        return 1e3 * elapsed_s(start);
    }

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

}  // namespace

bool same_work(const Plan& a, const Plan& b) {
    return std::equal(a.outputs.begin(), a.outputs.end(), b.outputs.begin(), b.outputs.end(),
                      [&](const PlannedOutput& x, const PlannedOutput& y) {
                          return output_fingerprint(a, x) == output_fingerprint(b, y);
                      });
}

PlanCost cost_of(const Plan& plan) {
    return {plan.transforms_per_frame(), plan.lines_per_frame(), static_cast<std::int64_t>(plan.sea_bytes()),
            static_cast<std::int64_t>(plan.frame_bytes() + plan.effect_bytes()),
            static_cast<std::int64_t>(plan.output_bytes())};
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
        for (const AttributeRow& row : attribute_table())
            if (std::find(output.attributes.begin(), output.attributes.end(), row.attribute) !=
                output.attributes.end())
                add("mesh " + std::string(word_of(row.attribute)),
                    [&](Scene& without) { std::erase(without.output.attributes, row.attribute); });
    }
    for (const MapRow& row : map_table())
        if (std::find(output.maps.begin(), output.maps.end(), row.map) != output.maps.end())
            add("map " + std::string(word_of(row.map)),
                [&](Scene& without) { std::erase(without.output.maps, row.map); });
    for (const VolumeRow& row : volume_table())
        if (std::find(output.volumes.begin(), output.volumes.end(), row.volume) != output.volumes.end())
            add("volume " + std::string(word_of(row.volume)),
                [&](Scene& without) { std::erase(without.output.volumes, row.volume); });
    if (output.drops) add("drops", [](Scene& without) { without.output.drops = false; });
    if (output.cascade_tiles) add("tiles", [](Scene& without) { without.output.cascade_tiles = false; });
    for (const EffectRow& row : effect_table())
        if (row.is_on(scene)) add(row.name, row.turn_off);
    return items;
}

std::size_t measure_bytes(const Scene& scene, int threads) {
    std::size_t beside = 0;
    for (const MeasureItem& item : measure_items(scene))
        beside = std::max(beside, bake_memory(plan_bake(item.without), 1, threads).bytes());
    MemoryNeed program;  // which is there once
    machine::add_program(program);
    return bake_memory(plan_bake(scene), 1, threads).bytes() + beside - (beside > 0 ? program.bytes() : 0);
}

Measured measure(const Scene& scene, const MeasureOptions& options) {
    const std::vector<MeasureItem> items = measure_items(scene);
    const Plan plan = plan_bake(scene);
    MeasureProgress progress{.items = static_cast<int>(items.size())};
    const auto tell = [&](const std::string& name, double seconds_left) {
        progress.name = name;
        progress.seconds_left = seconds_left;
        if (options.progress) options.progress(progress);
    };
    tell("the whole", 0.0);
    Runner whole(plan);
    // This run also allocates, and isn't one of the pairs.
    const double compute_s = 1e-3 * whole.compute_ms(scene.shot.first_frame);
    const double encode_s = 1e-3 * whole.encode_ms();
    // Half of an item's time for either.
    const double half_s = 0.5 * options.seconds_an_item;
    const auto expected_s = [&](double once_s) {
        return 2.0 * once_s *
               std::clamp(half_s / (2.0 * once_s), 1.0 * options.least_pairs, 1.0 * options.most_pairs);
    };
    const double item_s =
        whole.build_s() + compute_s + encode_s + expected_s(compute_s) + expected_s(encode_s);

    std::vector<double> whole_compute_ms, whole_encode_ms;
    const auto measure_item = [&](const MeasureItem& item) {
        const Plan planned = plan_bake(item.without);
        Measured result{.name = item.name, .cost = cost_of(plan) - cost_of(planned)};
        if (same_work(plan, planned)) return result;
        const auto begin = Clock::now();
        Runner without(planned);
        without.compute_ms(scene.shot.first_frame);
        without.encode_ms();
        // Differences of pairs. Each of the two goes first every other time: whoever comes second finds the
        // caches as the first left them.
        const auto differences = [&](const auto& once_ms, std::vector<double>& of_whole) {
            std::vector<double> ms;
            const auto start = Clock::now();
            for (int i = 0; i < options.most_pairs; ++i) {
                if (i % 2 == 0 && i >= options.least_pairs && elapsed_s(start) > half_s) break;
                double with = 0.0;
                if (i % 2 == 0) with = once_ms(whole, i);
                const double less = once_ms(without, i);
                if (i % 2 == 1) with = once_ms(whole, i);
                of_whole.push_back(with);
                ms.push_back(with - less);
                tell(item.name, std::max(item_s - elapsed_s(begin), 0.0) +
                                    item_s * (progress.items - progress.item - 1));
            }
            return ms;
        };
        const long frames = long{scene.shot.last_frame} - scene.shot.first_frame + 1;
        const auto compute = [&](Runner& runner, int i) {
            return runner.compute_ms(static_cast<int>(scene.shot.first_frame + i % frames));
        };
        const auto compute_ms = differences(compute, whole_compute_ms);
        result.pairs = static_cast<int>(compute_ms.size());
        result.compute = summary(compute_ms);
        result.encode =
            summary(differences([](Runner& runner, int) { return runner.encode_ms(); }, whole_encode_ms));
        return result;
    };
    for (; progress.item < progress.items; ++progress.item) {
        tell(items[progress.item].name, item_s * (progress.items - progress.item));
        const Measured result = measure_item(items[progress.item]);
        if (options.measured) options.measured(result);
    }
    return {.name = "the whole",
            .cost = cost_of(plan),
            .compute = summary(whole_compute_ms),
            .encode = summary(whole_encode_ms),
            .pairs = static_cast<int>(whole_compute_ms.size())};
}

}  // namespace pelagic
