#include "core/plan/budget.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/plan/cost_model.h"
#include "core/plan/mesh_error_model.h"
#include "core/plan/plan.h"
#include "core/plan/quality.h"
#include "core/scene/limits.h"
#include "core/scene/names.h"
#include "core/scene/text.h"
#include "core/scene/validate.h"

namespace pelagic {
namespace {

constexpr int kFrames = 3;  // that stand for a shot whose camera moves

std::shared_ptr<const PreparedScene> with(const PreparedScene& prepared, QualityLevel level,
                                          const Surface& surface) {
    PreparedScene changed = prepared;
    changed.scene = without_budget(std::move(changed.scene));
    changed.scene.quality.level = level;
    changed.scene.surface = surface;
    return std::make_shared<const PreparedScene>(std::move(changed));
}

class Chooser {
  public:
    explicit Chooser(const PreparedScene& prepared)
        : prepared_(prepared),
          model_(prepared),
          frames_(representative_frames(prepared.scene, kFrames)),
          has_mesh_(prepared.scene.output.mesh != MeshFormat::None),
          surfaces_(has_mesh_ ? rising_fineness(prepared.scene) : std::vector{prepared.scene.surface}) {
        // Beyond what can be laid out nothing is looked at.
        surfaces_.erase(std::partition_point(surfaces_.begin() + 1, surfaces_.end(),
                                             [&](const Surface& at) { return can_be_laid_out(at); }),
                        surfaces_.end());
        errors_.assign(surfaces_.size(), has_mesh_ ? -1.0 : 0.0);
    }

    struct Setting {
        const QualityRow* level;
        std::size_t surface;
        double error, ms;
    };

    Setting at(const QualityRow& level, std::size_t surface) {
        return {&level, surface, std::hypot(missed(surface), read_error(level)), cost(level, surface)};
    }
    // The cheapest that errs by no more; otherwise the most accurate.
    Setting cheapest(double most) {
        std::optional<Setting> best;
        for (const QualityRow& level : quality_table()) {
            const std::size_t surface =
                first([&](std::size_t i) { return std::hypot(missed(i), read_error(level)) <= most; });
            for (std::size_t i = surface; i < surfaces_.size(); ++i) {
                const Setting here = at(level, i);
                if (!best || here.ms < best->ms) best = here;
                if (!may_be_cheaper_finer()) break;
            }
        }
        return best ? *best : at(quality_table().back(), surfaces_.size() - 1);
    }
    // The most accurate that costs no more; otherwise the cheapest.
    Setting finest(double most_ms) {
        std::optional<Setting> best;
        for (const QualityRow& level : quality_table()) {
            std::size_t too_dear = first([&](std::size_t i) { return cost(level, i) > most_ms; });
            if (may_be_cheaper_finer())
                for (std::size_t i = surfaces_.size(); i > too_dear; --i)
                    if (cost(level, i - 1) <= most_ms) too_dear = i;
            if (too_dear == 0) continue;
            const Setting here = at(level, too_dear - 1);
            if (!best || here.error < best->error) best = here;
        }
        return best ? *best : at(quality_table().front(), 0);
    }
    const Surface& surface(std::size_t i) const { return surfaces_[i]; }
    bool has_mesh() const { return has_mesh_; }

  private:
    double read_error(const QualityRow& level) const {
        return prepared_.spectrum.m0() > 0.0 ? level.read_error : 0.0;  // a calm is flat however it is read
    }
    // Points on the nodes of periodic tiles are read as they are, and cost less than fewer points between them.
    bool may_be_cheaper_finer() const {
        return prepared_.scene.waves.tiling == Tiling::Periodic &&
               prepared_.scene.surface.kind == SurfaceKind::Patch;
    }
    // An even grid is never laid out here. Others hold some bytes for each point while they are.
    bool can_be_laid_out(const Surface& surface) const {
        constexpr std::size_t kMostPoints = std::size_t{1} << 21;
        try {
            const SurfaceNeeds needs = made(surface)->needs(frames_);
            return !needs.own_footprints || needs.points <= kMostPoints;
        } catch (const std::invalid_argument&) {
            return false;  // more points than a surface may have
        }
    }
    std::unique_ptr<const RestSurface> made(const Surface& surface) const {
        return make_surface(with(prepared_, QualityLevel::Final, surface)->scene, prepared_.extent);
    }
    template <class Holds>
    std::size_t first(const Holds& holds) const {
        // Coarse ones are looked at first: the finest take long to lay out.
        std::size_t low = 0, high = 1;
        while (high < surfaces_.size() && !holds(high - 1)) low = std::exchange(high, 2 * high);
        high = std::min(high, surfaces_.size());
        while (low < high) {
            const std::size_t middle = (low + high) / 2;
            if (holds(middle))
                high = middle;
            else
                low = middle + 1;
        }
        return low;
    }
    double missed(std::size_t surface) {
        if (errors_[surface] < 0.0)
            errors_[surface] = model_.error(*made(surfaces_[surface]), prepared_.scene.camera, frames_);
        return errors_[surface];
    }
    double cost(const QualityRow& level, std::size_t surface) const {
        return frame_ms(plan_bake(with(prepared_, level.level, surfaces_[surface]), frames_));
    }

    const PreparedScene& prepared_;
    MeshErrorModel model_;
    std::vector<int> frames_;
    bool has_mesh_;  // without one, all that a budget chooses is how waves are read
    std::vector<Surface> surfaces_;
    std::vector<double> errors_;
};

// "surface.resolution = 384": what differs among rising_fineness().
std::string fineness_text(const Surface& surface) {
    switch (surface.kind) {
        case SurfaceKind::Patch:
        case SurfaceKind::NearFar:
            return "surface.resolution = " + std::to_string(surface.resolution);
        case SurfaceKind::Cage:
            if (!surface.cage_level.is_adaptive)
                return "surface.cage_level = " + std::to_string(surface.cage_level.splits);
            break;
        case SurfaceKind::ProjectedGrid:
        case SurfaceKind::Planet:
            break;
    }
    return "surface.cell_px = " + number_text(surface.cell_px);
}

}  // namespace

bool has_budget(const Quality& quality) {
    return quality.max_error || quality.frame_ms;
}

Scene without_budget(Scene scene) {
    scene.quality.max_error.reset();
    scene.quality.frame_ms.reset();
    return scene;
}

std::string text_of_budget(const Quality& quality, bool holds) {
    return (quality.max_error ? "quality.max_error = " + number_text(*quality.max_error)
                              : "quality.frame_ms = " + number_text(*quality.frame_ms)) +
           (holds ? "" : ", which nothing holds") + ": the " +
           (quality.max_error.has_value() == holds ? "cheapest" : "most accurate");
}

Scene settled(Scene scene) {
    if (!has_budget(scene.quality)) return scene;
    const auto prepared = prepare(std::move(scene));
    if (!prepared->holds_budget) throw std::invalid_argument(prepared->budget + "; raise the budget");
    return prepared->scene;
}

std::vector<Surface> rising_fineness(const Scene& scene) {
    std::vector<Surface> surfaces;
    const auto add = [&](const Surface& surface) { surfaces.push_back(surface); };
    Surface surface = scene.surface;
    const bool has_level = surface.kind == SurfaceKind::Cage && !surface.cage_level.is_adaptive;
    if (surface.kind == SurfaceKind::Patch || surface.kind == SurfaceKind::NearFar) {
        const int most = surface.kind == SurfaceKind::NearFar
                             ? limits::kNearFarResolution
                             : static_cast<int>(limits::kSurfaceResolution.high);
        // From 64 on an eighth more at most from one to the next, and numbers with small factors.
        for (int quads = 8; quads <= most;
             quads += std::max(8, static_cast<int>(std::bit_floor(static_cast<unsigned>(quads))) / 8)) {
            surface.resolution = quads;
            add(surface);
        }
    } else if (has_level) {
        for (int splits = 0; splits <= static_cast<int>(limits::kCageLevel.high); ++splits) {
            surface.cage_level.splits = splits;
            Scene refined = without_budget(scene);
            refined.surface = surface;
            if (!validate(refined).empty()) break;  // more quads than an index counts
            add(surface);
        }
    } else {
        for (double cell_px = 64.0; cell_px > 0.99; cell_px *= std::exp2(-0.25)) {
            surface.cell_px = std::round(4.0 * cell_px) / 4.0;
            add(surface);
        }
    }
    return surfaces;
}

MeshBudget mesh_budget(const PreparedScene& prepared) {
    const Quality& quality = prepared.scene.quality;
    Chooser chooser(prepared);
    const Chooser::Setting chosen =
        quality.max_error ? chooser.cheapest(*quality.max_error) : chooser.finest(*quality.frame_ms);
    MeshBudget budget{.scene = without_budget(prepared.scene), .error = chosen.error, .ms = chosen.ms};
    budget.scene.quality.level = chosen.level->level;
    budget.scene.surface = chooser.surface(chosen.surface);
    budget.holds = quality.max_error ? chosen.error <= *quality.max_error : chosen.ms <= *quality.frame_ms;
    budget.text = text_of_budget(quality, budget.holds) + (chooser.has_mesh() ? " mesh is" : " frame has") +
                  " quality.level = \"" + std::string(word_of(chosen.level->level)) + "\"" +
                  (chooser.has_mesh() ? " with " + fineness_text(budget.scene.surface) : std::string()) +
                  ", an error of " + rough_text(chosen.error) + " and about " + rough_text(chosen.ms) +
                  " ms a frame";
    return budget;
}

}  // namespace pelagic
