#include "plugin/budget/budget.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/plan/memory.h"
#include "core/plan/mesh_error_model.h"
#include "core/plan/plan.h"
#include "core/plan/quality.h"
#include "core/plan/weather.h"
#include "core/scene/budget.h"
#include "core/scene/limits.h"
#include "core/scene/names.h"
#include "core/scene/text.h"
#include "core/scene/validate.h"
#include "plugin/budget/calibration.h"
#include "plugin/budget/picture_errors.h"
#include "plugin/files/files.h"
#include "plugin/render/batch.h"
#include "plugin/render/picture_files.h"
#include "plugin/run/foreign.h"
#include "plugin/run/record.h"

namespace pelagic {
namespace {

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

// What a budget chooses from: rows of settings, each from coarse and cheap to fine and dear.
class Choices {
  public:
    virtual ~Choices() = default;
    virtual double error(std::size_t row, std::size_t step) = 0;
    virtual double ms(std::size_t row, std::size_t step) const = 0;
    virtual void apply(std::size_t row, std::size_t step, Settled& to) const = 0;
    // What takes less than any of them but isn't chosen from, in words; empty: nothing does.
    virtual std::string cheaper() const { return {}; }

    std::size_t rows = 1, steps = 1;
    bool may_be_cheaper_finer = false;
};

struct Choice {
    std::size_t row, step;
    double error, ms;
};

// The first step from which on all hold.
template <class Holds>
std::size_t first(std::size_t steps, const Holds& holds) {
    // Coarse ones are looked at first: the finest take long to lay out.
    std::size_t low = 0, high = 1;
    while (high < steps && !holds(high - 1)) low = std::exchange(high, 2 * high);
    high = std::min(high, steps);
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (holds(middle))
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

// The cheapest that errs by no more than max_error, or the most accurate that costs no more than frame_ms; where none holds, the
// most accurate, or the cheapest.
Choice chosen(Choices& from, const Quality& budget) {
    const auto at = [&](std::size_t row, std::size_t step) {
        return Choice{row, step, from.error(row, step), from.ms(row, step)};
    };
    std::optional<Choice> best;
    for (std::size_t row = 0; row < from.rows; ++row) {
        if (budget.max_error) {
            std::size_t step =
                first(from.steps, [&](std::size_t i) { return from.error(row, i) <= *budget.max_error; });
            for (; step < from.steps; ++step) {
                const Choice here = at(row, step);
                if (!best || here.ms < best->ms) best = here;
                if (!from.may_be_cheaper_finer) break;
            }
        } else {
            const auto is_too_dear = [&](std::size_t i) { return from.ms(row, i) > *budget.frame_ms; };
            std::size_t end = first(from.steps, is_too_dear);
            if (from.may_be_cheaper_finer)
                for (std::size_t i = from.steps; i > end; --i)
                    if (!is_too_dear(i - 1)) end = i;
            if (end == 0) continue;
            const Choice here = at(row, end - 1);
            if (!best || here.error < best->error) best = here;
        }
    }
    if (best) return *best;
    return budget.max_error ? at(from.rows - 1, from.steps - 1) : at(0, 0);
}

// A sea that changes errs most where it is highest.
PreparedScene of_highest_key(PreparedScene prepared) {
    if (!prepared.weather) return prepared;
    const auto m0 = [](const Weather::Key& key) { return key.sea->spectrum.m0(); };
    prepared.spectrum = std::ranges::max_element(prepared.weather->keys, {}, m0)->sea->spectrum;
    return prepared;
}

// Levels of quality, of surfaces that get finer.
class Meshes final : public Choices {
  public:
    Meshes(const Scene& scene, const Rates& rates)
        : prepared_(of_highest_key(*prepare(scene))),
          rates_(rates),
          model_(prepared_),
          frames_(representative_frames(scene, kFrames)),
          has_mesh_(scene.output.mesh != MeshFormat::None),
          surfaces_(has_mesh_ ? rising_fineness(scene) : std::vector{scene.surface}) {
        // Beyond what can be laid out nothing is looked at.
        surfaces_.erase(std::partition_point(surfaces_.begin() + 1, surfaces_.end(),
                                             [&](const Surface& at) { return can_be_laid_out(at); }),
                        surfaces_.end());
        errors_.assign(surfaces_.size(), has_mesh_ ? -1.0 : 0.0);
        rows = quality_table().size();
        steps = surfaces_.size();
        // Points on the nodes of periodic tiles are read as they are, and cost less than fewer points between them.
        may_be_cheaper_finer =
            scene.waves.tiling == Tiling::Periodic && scene.surface.kind == SurfaceKind::Patch;
    }

    double error(std::size_t row, std::size_t step) override {
        double& missed = errors_[step];
        if (missed < 0.0) missed = model_.error(*made(surfaces_[step]), prepared_.scene.camera, frames_);
        // A calm is flat however it is read.
        return std::hypot(missed, prepared_.spectrum.m0() > 0.0 ? quality_table()[row].read_error : 0.0);
    }
    double ms(std::size_t row, std::size_t step) const override {
        return cost_ms(work_of(plan_bake(with(quality_table()[row].level, surfaces_[step]), frames_)),
                       rates_);
    }
    void apply(std::size_t row, std::size_t step, Settled& to) const override {
        to.scene.quality.level = quality_table()[row].level;
        to.scene.surface = surfaces_[step];
        to.settings = "quality.level = \"" + std::string(word_of(to.scene.quality.level)) + '"' +
                      (has_mesh_ ? ", " + fineness_text(to.scene.surface) : std::string());
        to.what = has_mesh_ ? "mesh is" : "frame has";
    }

  private:
    static constexpr int kFrames = 3;  // that stand for a shot whose camera moves

    std::shared_ptr<const PreparedScene> with(QualityLevel level, const Surface& surface) const {
        auto changed = std::make_shared<PreparedScene>(prepared_);
        changed->scene.quality.level = level;
        changed->scene.surface = surface;
        return changed;
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
        return make_surface(with(QualityLevel::Final, surface)->scene, prepared_.extent);
    }

    PreparedScene prepared_;
    Rates rates_;
    MeshErrorModel model_;
    std::vector<int> frames_;
    bool has_mesh_;  // without one, all that a budget chooses is how waves are read
    std::vector<Surface> surfaces_;
    std::vector<double> errors_;  // that cells add; negative: not known yet
};

struct SkyWords {
    SkyQuality quality;
    const char* words;
};
constexpr std::array kSkies = std::to_array<SkyWords>({
    {SkyQuality::Nine, "nine lookups"},
    {SkyQuality::Integral, "the integral"},
});

// Of first-shot, 160 pixels wide: by which settings are put in order where nothing is measured.
constexpr MeasuredErrors kTypical{{0.33, 0.22, 0.13, 0.09}, 0.07, 0};

// The shot's own, with what isn't left to the budget.
RenderOptions fixed_options(const Scene& scene, const FixedSettings& fixed) {
    RenderOptions options = render_options(scene);
    options.samples = fixed.samples.value_or(options.samples);
    options.lighting.sky_quality = fixed.sky_quality.value_or(options.lighting.sky_quality);
    options.shutter_frames = fixed.shutter_frames;
    options.layers = fixed.layers;
    return options;
}

// Lookups of the sky, with more and more samples.
class Pictures final : public Choices {
  public:
    Pictures(const Scene& scene, const FixedSettings& fixed, const MeasuredErrors& errors, const Rates& rates)
        : scene_(scene), fixed_(fixed), errors_(errors), rates_(rates), frames_(frames_to_measure(scene)) {
        for (const SkyWords& sky : kSkies)
            if (fixed.sky_quality.value_or(sky.quality) == sky.quality) skies_.push_back(sky);
        RenderOptions options = fixed_options(scene, fixed);
        const int fewest = fixed.samples.value_or(kMeasuredSamples.front());
        options.samples = fewest;
        check_render(scene, options);
        for (; options.samples <= fixed.samples.value_or(kMeasuredSamples.back()); ++options.samples) {
            try {
                check_render(scene, options);
            } catch (const std::invalid_argument&) {
                break;  // more samples a side than a picture has
            }
            plans_.push_back(picture_plan(of_samples(scene, options.samples), frames_, options));
            options_.push_back(options);
        }
        rows = skies_.size();
        steps = options_.size();
    }

    double error(std::size_t row, std::size_t step) override {
        return std::hypot(errors_.at(options_[step].samples),
                          skies_[row].quality == SkyQuality::Integral ? 0.0 : errors_.of_nine);
    }
    double ms(std::size_t row, std::size_t step) const override {
        return cost_ms(picture_work(plans_[step], frames_, with(row, step)), rates_);
    }
    void apply(std::size_t row, std::size_t step, Settled& to) const override {
        to.options = with(row, step);
        const std::string samples = std::to_string(to.options.samples);
        to.settings = "quality.level = \"" + std::string(word_of(to.scene.quality.level)) +
                      "\", surface.cell_px = " + number_text(to.scene.surface.cell_px) + ", " + samples +
                      " × " + samples + " samples a pixel and " + skies_[row].words + " of the sky";
        to.what = "final pictures have";
    }
    std::string cheaper() const override {
        Scene draft = scene_;
        draft.quality.level = QualityLevel::Draft;
        const RenderOptions options = fixed_options(draft, fixed_);
        check_render(draft, options);
        const double draft_ms =
            cost_ms(picture_work(picture_plan(of_samples(draft, options.samples), frames_, options), frames_,
                                 options),
                    rates_);
        return "a draft (quality.level = \"draft\" and no budget) takes about " + rough_text(draft_ms) +
               " ms";
    }

  private:
    RenderOptions with(std::size_t row, std::size_t step) const {
        RenderOptions options = options_[step];
        options.lighting.sky_quality = skies_[row].quality;
        return options;
    }

    Scene scene_;
    FixedSettings fixed_;
    MeasuredErrors errors_;
    Rates rates_;
    std::vector<int> frames_;
    std::vector<SkyWords> skies_;
    std::vector<RenderOptions> options_;  // by step, with their plans
    std::vector<Plan> plans_;
};

// What is chosen from, with what a host settles first; null: nothing is left to choose. is_told: it is chosen already, and nothing is
// measured.
std::unique_ptr<Choices> choices(const Scene& scene, Purpose purpose, const SettleOptions& with,
                                 Settled& settled, bool is_told) {
    const FixedSettings& fixed = with.fixed;
    if (!has_budget(scene.quality) || (purpose == Purpose::Pictures && fixed.sky_quality &&
                                       (fixed.samples || *fixed.sky_quality == SkyQuality::One)))
        return nullptr;
    Rates rates = recorded_rates();
    if (with.rates)
        rates = *with.rates;
    else if (scene.quality.frame_ms && !is_told)
        rates = calibration(cache_folder(), with.watch).rates();
    if (purpose == Purpose::Mesh) return std::make_unique<Meshes>(settled.scene, rates);
    settled.scene.quality.level = QualityLevel::Final;
    settled.scene.surface.cell_px = kPictureCell_px;
    MeasuredErrors errors = kTypical;
    if (scene.quality.max_error && !is_told)
        errors = measured_errors(settled.scene, with.max_memory_bytes, with.watch);
    settled.measuring_bytes = errors.bytes;
    return std::make_unique<Pictures>(settled.scene, fixed, errors, rates);
}

// What the folder says of how its files were chosen.
struct Said {
    std::string record{};  // for whatever budget
    std::string words{};   // for this one, for people; empty: nothing
    std::function<bool(const std::string& chosen)> is{};
};

Said said_in(const std::filesystem::path& folder, const Shot& shot, Purpose purpose,
             const std::string& budget) {
    if (purpose == Purpose::Mesh) {
        const auto record = read_record(folder / (shot.name + ".json"), [](int, const FrameRecord&) {}).shot;
        Said said{.record = record ? record->chosen : std::string()};
        if (said.record.starts_with(budget + ": ")) said.words = line_text(said.record);
        said.is = [words = said.record](const std::string& chosen) { return words == chosen; };
        return said;
    }
    for (const int frame : frames_in(folder, {shot.name + '.', ".exr"})) {
        const auto file = folder / picture_file(shot, frame, "exr");
        if (files::carries(file, budget + ": "))
            return {.words = budget + ": … (\"chosen\" in the header of " +
                             line_text(file.filename().string()) + ')',
                    .is = [file](const std::string& chosen) { return files::carries(file, chosen); }};
    }
    return {};
}

// Where files in `folder` (null: none) say what was chosen for this budget, that. told: what whoever shared the shot out chose, by which
// no error and no time is looked at.
Settled settled_by(const Scene& scene, Purpose purpose, const SettleOptions& with,
                   const std::filesystem::path* folder, const std::string& told = {}) {
    Settled settled{.scene = without_budget(scene)};
    const std::unique_ptr<Choices> from = choices(scene, purpose, with, settled, !told.empty());
    if (purpose == Purpose::Pictures) settled.options = fixed_options(settled.scene, with.fixed);
    if (!from) return settled;
    const Quality& budget = scene.quality;
    settled.budget = budget.max_error ? "quality.max_error = " + number_text(*budget.max_error)
                                      : "quality.frame_ms = " + number_text(*budget.frame_ms);
    if (!told.empty()) {
        settled.before = said_in(*folder, scene.shot, purpose, settled.budget).record;
        for (std::size_t row = 0; row < from->rows; ++row)
            for (std::size_t step = 0; step < from->steps; ++step) {
                from->apply(row, step, settled);
                if (settled.chosen() != told) continue;
                settled.is_recorded = true;
                settled.text = told + ", as was chosen for the whole shot";
                return settled;
            }
        return settled;
    }
    const Choice best = chosen(*from, budget);
    const auto take = [&](const Choice& choice, Settled& to) {
        from->apply(choice.row, choice.step, to);
        to.error = choice.error;
        to.ms = choice.ms;
    };
    take(best, settled);
    settled.holds = budget.max_error ? best.error <= *budget.max_error : best.ms <= *budget.frame_ms;
    // Pictures' errors are measured for a budget of error alone.
    const bool has_error = purpose == Purpose::Mesh || budget.max_error;
    settled.text =
        settled.budget + (settled.holds ? "" : ", which nothing holds") + ": the " +
        (budget.max_error.has_value() == settled.holds ? "cheapest " : "most accurate ") + settled.what +
        ' ' + settled.settings + (has_error ? ", an error of " + rough_text(best.error) : std::string()) +
        " and about " + rough_text(best.ms) + " ms a " + (purpose == Purpose::Mesh ? "frame" : "picture") +
        (settled.measuring_bytes > 0
             ? "; measured on a small picture, which held about " + bytes_text(settled.measuring_bytes)
             : std::string());
    if (!settled.holds && budget.frame_ms)
        if (const std::string cheaper = from->cheaper(); !cheaper.empty()) settled.text += "; " + cheaper;
    if (!folder) return settled;
    const Said said = said_in(*folder, scene.shot, purpose, settled.budget);
    settled.before = said.record;
    if (said.words.empty()) return settled;
    Settled recorded = settled;
    bool is_known = false;
    for (std::size_t row = 0; row < from->rows; ++row)
        for (std::size_t step = 0; step < from->steps; ++step) {
            from->apply(row, step, recorded);
            if (!said.is(recorded.chosen())) continue;
            is_known = true;
            // Of another shot than today's, perhaps, for which it was enough.
            if (budget.max_error && from->error(row, step) > *budget.max_error) continue;
            take({row, step, from->error(row, step), from->ms(row, step)}, recorded);
            recorded.is_recorded = true;
            if (row != best.row || step != best.step || !settled.holds) {
                recorded.text = recorded.chosen() + ", as was chosen before";
                recorded.note = "files have " + recorded.settings + ", which stays; today " + settled.text;
            }
            return recorded;
        }
    if (!is_known)
        settled.note = "files were made with " + said.words +
                       ", which isn't among what this budget is given today: they are made anew";
    return settled;
}

}  // namespace

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

SettleOptions with_rates(const Rates& rates, const FixedSettings& fixed) {
    SettleOptions options;
    options.fixed = fixed;
    options.rates = rates;
    return options;
}

void Settled::apply(PictureOrder& order) const {
    order.scene = scene;
    order.options.samples = options.samples;
    order.options.lighting.sky_quality = options.lighting.sky_quality;
    order.options.lighting.fresnel = options.lighting.fresnel;
}

Settled settle(const Scene& scene, Purpose purpose, const SettleOptions& with) {
    return settled_by(scene, purpose, with, nullptr);
}

Settled settle_for(const RunOptions& run, const Scene& scene, Purpose purpose, const SettleOptions& with,
                   const std::string& or_else) {
    if (!run.settled.empty() && !has_budget(scene.quality))
        throw std::invalid_argument("--chosen is of a budget, and the shot has none");
    const Settled found = settled_by(scene, purpose, with, &run.out, run.settled);
    if (found.budget.empty() || found.is_recorded) return found;
    if (!run.settled.empty())
        throw std::invalid_argument(found.budget + ": " + line_text(run.settled) +
                                    " isn't among what this budget is given: share the shot out anew");
    const auto asked = static_cast<std::int64_t>(run.frames.size());
    if (held(found, or_else);
        asked > 0 && asked <= std::int64_t{scene.shot.last_frame} - scene.shot.first_frame)
        throw std::invalid_argument(
            found.budget + ": isn't settled yet in " + line_text(run.out.string()) +
            (found.note.empty() ? "" : " (" + found.note + " by a run of all frames)") +
            ", and other runs that make the rest of the shot's frames may choose otherwise; begin with a run of all frames, or in "
            "its place put " +
            found.settings + (or_else.empty() ? "" : " (" + or_else + ')'));
    return found;
}

Settled held(Settled settled, const std::string& or_else) {
    if (!settled.holds)
        throw std::invalid_argument(settled.text + "; raise the budget" +
                                    (or_else.empty() ? "" : ", or give " + or_else + " instead of it"));
    return settled;
}

}  // namespace pelagic
