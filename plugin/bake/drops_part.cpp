// The spray's large drops over the patch's square, as points of USD.
#include <cmath>

#include "core/effects/spray_drops.h"
#include "core/plan/spray_drops.h"
#include "plugin/bake/output_part.h"
#include "plugin/format/usd/drops.h"

namespace pelagic {
namespace {

struct DropsSlot final : OutputSlot {
    std::vector<SprayDrop> drops;
    std::vector<glm::vec3> points, velocities;
    std::vector<float> widths, opacities, sections;
    std::vector<std::int64_t> ids;
};

class DropsPart final : public OutputPart {
  public:
    using OutputPart::OutputPart;

    FilePattern pattern() const override { return {usd::drops_frame_prefix(scene().shot.name), ".usdc"}; }
    std::unique_ptr<OutputSlot> make_slot() const override { return std::make_unique<DropsSlot>(); }

    void compute(const SeaAtTime<float>& sea, int frame, OutputSlot& slot, const BuildWatch& watch) override {
        compute_by(singles_, sea, frame, static_cast<DropsSlot&>(slot), watch);
    }
    void compute(const SeaAtTime<double>& sea, int frame, OutputSlot& slot,
                 const BuildWatch& watch) override {
        compute_by(doubles_, sea, frame, static_cast<DropsSlot&>(slot), watch);
    }

    OutputMemory memory() const override {
        const SprayDropsPlan drops = plan_spray_drops(*plan_.from, size_m());
        const double cells = std::pow(size_m() / drops.cell_m, 2.0);
        constexpr double kBytes =
            sizeof(SprayDrop) + 2 * sizeof(glm::vec3) + 3 * sizeof(float) + sizeof(std::int64_t);
        return {.once = spray_drops_bytes(plan_, drops, size_m()),
                .slot = static_cast<std::size_t>(cells * drops.parcels_per_s *
                                                 SprayDropsPlan::kLongestLife_s * kBytes),
                .remedy = "lower surface.size_m, or set output.drops to false"};
    }

    void encode(int, OutputSlot& any_slot) const override {
        DropsSlot& slot = static_cast<DropsSlot&>(any_slot);
        const auto resize = [&](auto&... all) { (all.resize(slot.drops.size()), ...); };
        resize(slot.points, slot.velocities, slot.widths, slot.opacities, slot.sections, slot.ids);
        for (std::size_t i = 0; i < slot.drops.size(); ++i) {
            const SprayDrop& drop = slot.drops[i];
            slot.points[i] = glm::vec3(drop.position_m);
            slot.velocities[i] = glm::vec3(drop.velocity_mps * scene().shot.time_scale);
            slot.widths[i] = static_cast<float>(drop.width_m);
            slot.sections[i] = static_cast<float>(drop.section_m2);
            slot.opacities[i] = static_cast<float>(drop.opacity());
            slot.ids[i] = drop.id;
        }
    }

    void write(int frame, const OutputSlot& any_slot, const FileSink& sink) const override {
        const DropsSlot& slot = static_cast<const DropsSlot&>(any_slot);
        const std::string whole = fingerprint(frame);
        sink({.path = file(frame), .content = [&](const auto& take) {
                  usd::write_drops_crate({.frame = frame,
                                          .fps = scene().shot.fps,
                                          .fingerprint = whole,
                                          .points = slot.points,
                                          .velocities = slot.velocities,
                                          .widths = slot.widths,
                                          .opacities = slot.opacities,
                                          .sections = slot.sections,
                                          .ids = slot.ids},
                                         take);
              }});
    }

    void write_static(const FileSink& sink) const override {
        const Shot& shot = scene().shot;
        const usd::DropsShot about{.name = shot.name,
                                   .fps = shot.fps,
                                   .first_frame = shot.first_frame,
                                   .last_frame = shot.last_frame};
        sink({.path = usd::drops_manifest_file(shot.name),
              .content = [&](const auto& take) { take(usd::drops_manifest_text(about)); }});
        sink({.path = usd::drops_file(shot.name),
              .content = [&](const auto& take) { take(usd::drops_text(about)); }});
    }

  private:
    double size_m() const { return scene().surface.size_m; }

    template <class T>
    void compute_by(std::unique_ptr<SprayDrops<T>>& drops, const SeaAtTime<T>& sea, int frame,
                    DropsSlot& slot, const BuildWatch& watch) const {
        if (!drops) drops = std::make_unique<SprayDrops<T>>(sea.sea(), size_m(), watch);
        drops->at(scene().shot.time_s(frame), glm::dvec2(0.0), slot.drops, watch.cancel);
    }

    std::unique_ptr<SprayDrops<float>> singles_;
    std::unique_ptr<SprayDrops<double>> doubles_;
};

}  // namespace

std::unique_ptr<OutputPart> make_drops_part(const Plan& plan, const PlannedOutput& output,
                                            const std::shared_ptr<SquareCache>&) {
    return std::make_unique<DropsPart>(plan, output);
}

}  // namespace pelagic
