#include "plugin/bake/sequence.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "core/base/constants.h"
#include "core/base/precision.h"
#include "core/plan/unresolved_slopes.h"
#include "core/surface/footprint_levels.h"
#include "core/surface/rest_surface.h"
#include "plugin/bake/stage.h"

namespace pelagic {
namespace {

// To twelve digits: a plan that is as fine as other frames need it adds modes that don't show in this one, and
// they change where a sum rounds.
double rounded(double sum) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.12g", sum);
    return std::strtod(digits, nullptr);
}

template <class T>
class SequenceOf final : public Sequence {
  public:
    SequenceOf(const Plan& plan, const BuildWatch& watch)
        : sea_(std::make_shared<const SeaOverTime<T>>(plan, watch)),
          state_(sea_),
          parts_(make_parts(sea_->plan())),
          cancel_(watch.cancel) {}

    std::unique_ptr<RunSlot> make_slot() const override { return std::make_unique<FrameSlot>(); }

    void compute(int frame, RunSlot& any, const std::function<void(double)>& foam_past) override {
        FrameSlot& slot = static_cast<FrameSlot&>(any);
        slot.frame = frame;
        slot.record = {};
        slot.record.fingerprint = parts_.front()->fingerprint(frame);
        slot.record.time_s = sea_->plan().from->scene.shot.time_s(frame);
        state_.set(slot.record.time_s, cancel_);
        describe_waves(frame, slot.record);
        while (slot.outputs.size() < parts_.size())
            slot.outputs.push_back(parts_[slot.outputs.size()]->make_slot());
        BuildWatch watch{.progress = {}, .cancel = cancel_};
        std::size_t of_foam = 0, before = 0;
        for (std::size_t p = 0; p < parts_.size(); ++p)
            of_foam += slot.wants(p) && parts_[p]->has_foam_history();
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            if (!slot.wants(p)) continue;
            if (foam_past && parts_[p]->has_foam_history())
                watch.progress = [&, of_foam, done_before = before++](double done) {
                    foam_past((static_cast<double>(done_before) + done) / static_cast<double>(of_foam));
                };
            parts_[p]->compute(state_, frame, *slot.outputs[p], watch);
        }
    }

    void encode(RunSlot& any) const override {
        FrameSlot& slot = static_cast<FrameSlot&>(any);
        tbb::parallel_for(std::size_t(0), parts_.size(), [&](std::size_t p) {
            if (slot.wants(p)) parts_[p]->encode(slot.frame, *slot.outputs[p]);
        });
        for (std::size_t p = 0; p < parts_.size(); ++p)
            if (slot.wants(p))
                slot.record.files[parts_[p]->file(slot.frame)] = {
                    .fingerprint = parts_[p]->fingerprint(slot.frame),
                    .coverage = slot.outputs[p]->coverage,
                    .significant_height_m = slot.outputs[p]->significant_height_m,
                    .spray = slot.outputs[p]->spray};
    }

    void write(RunSlot& any, const FileSink& sink) const override {
        const FrameSlot& slot = static_cast<const FrameSlot&>(any);
        for (std::size_t p = 0; p < parts_.size(); ++p)
            if (slot.wants(p)) parts_[p]->write(slot.frame, *slot.outputs[p], sink);
    }

    void write_static(std::span<const int> frames, const FileSink& sink) const override {
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            parts_[p]->write_static(sink);
            if (sea_->plan().outputs[p].has_surface) write_stage(sea_->plan(), *parts_[p], frames, sink);
        }
    }

    void describe(Record& record) const override {
        // The shot's plan, whichever frames are baked: what a camera sees from each of them decides how fine it is.
        const Plan& plan = sea_->plan();
        const Scene& scene = plan.from->scene;
        constexpr int kFrames = 64;  // that are looked at
        std::optional<Plan> of_shot;
        if (!plan.surface->is_constant())
            of_shot = plan_bake(plan.from, representative_frames(scene, kFrames));
        const auto sea = sea_->at(scene.shot.time_s(scene.shot.first_frame));
        record.describe(of_shot ? *of_shot : plan, sea->total(), sea->whitecap_threshold(),
                        sea->residual_coverage());
    }
    long executed_transforms() const override { return state_.frame().executed_transforms(); }

  private:
    void describe_waves(int frame, FrameRecord& record) const {
        const Sea<T>& sea = state_.sea();
        const Plan& plan = sea.plan();
        const Query& first = plan.queries[plan.outputs.front().query].query;
        // A camera's levels are as fine as all frames of the bake need them; the frame's own cells are its own.
        Footprints at{first.cell_m.front(), first.pixel_m.front()};
        if (first.is_view) {
            const std::array alone{frame};
            const SurfaceNeeds needs = plan.surface->needs(alone);
            at = {first_level_m(needs.finest_cell_m), first_level_m(needs.finest_pixel_m)};
        }
        record.mss_residual = first.is_view
                                  ? unresolved_mean_square_slope(plan.from->spectrum, plan.filter, at.pixel_m)
                                  : std::max(sea.total().mss() - sea.resolved_moments(0).mss(), 0.0);
        const bool calm = !(sea.total().m0 > 0.0);
        if (plan.transforms_per_frame() == 0 && !plan.trains && !calm) return;  // no wave was computed
        const Realisation sum = state_.frame().realisation(0, at);
        WaveRecord waves;
        waves.significant_height_m = rounded(4.0 * std::sqrt(sum.m0));
        if (sum.m0 > 0.0) {
            waves.energy_period_s = rounded(kTwoPi * sum.m_minus1 / sum.m0);
            waves.mean_direction_deg = rounded(std::atan2(sum.north, sum.east) * 180.0 / kPi);
        }
        waves.mss = rounded(sum.mss);
        record.waves = waves;
    }

    std::shared_ptr<const SeaOverTime<T>> sea_;
    SeaAtTime<T> state_;
    std::vector<std::unique_ptr<OutputPart>> parts_;
    const std::atomic<bool>* cancel_;
};

}  // namespace

std::unique_ptr<Sequence> make_sequence(const Plan& plan, const BuildWatch& watch) {
    return with_precision(plan.knobs.double_precision, [&]<class T>(T) -> std::unique_ptr<Sequence> {
        return std::make_unique<SequenceOf<T>>(plan, watch);
    });
}

}  // namespace pelagic
