// What each effect that is on in a shot costs: the shot without it. The tables of effects and outputs list them, and
// the table below those of a picture's light.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/plan/effects.h"
#include "plugin/accuracy/picture_trials.h"
#include "plugin/accuracy/rows.h"
#include "plugin/bake/measure.h"
#include "plugin/bake/sequence.h"
#include "plugin/light/light.h"

namespace pelagic::rows {
namespace {

// The terms of a picture's light that can be left out.
struct LightRow {
    const char* name;
    bool (*is_on)(const LightingChoice&);
    void (*turn_off)(LightingChoice&);
};
constexpr auto kLightTable = std::to_array<LightRow>({
    {"air", [](const LightingChoice& light) { return light.air; },
     [](LightingChoice& light) { light.air = false; }},
    {"multiple reflections", [](const LightingChoice& light) { return light.second_reflection; },
     [](LightingChoice& light) { light.second_reflection = false; }},
    {"sky by nine lookups", [](const LightingChoice& light) { return light.sky_quality != SkyQuality::One; },
     [](LightingChoice& light) { light.sky_quality = SkyQuality::One; }},
    {"sky by the integral",
     [](const LightingChoice& light) { return light.sky_quality == SkyQuality::Integral; },
     [](LightingChoice& light) { light.sky_quality = SkyQuality::Nine; }},
});

struct ShotPicture {
    Scene scene;
    RenderOptions options;
};

struct PicturePart {
    std::string name;
    ShotPicture without;
};

// Those that are on, in the order in which a picture is made up.
std::vector<PicturePart> parts_of(const ShotPicture& whole) {
    std::vector<PicturePart> parts;
    for (const EffectRow& row : effect_table()) {
        if (!row.is_on(whole.scene)) continue;
        PicturePart part{row.name, whole};
        row.turn_off(part.without.scene);
        const LightingChoice own = render_options(part.without.scene).lighting;
        part.without.options.lighting.whitecaps = own.whitecaps;
        part.without.options.lighting.spray = own.spray;
        parts.push_back(std::move(part));
    }
    for (const LightRow& row : kLightTable) {
        if (!row.is_on(whole.options.lighting)) continue;
        PicturePart part{row.name, whole};
        row.turn_off(part.without.options.lighting);
        parts.push_back(std::move(part));
    }
    return parts;
}

ShotPicture picture_of(const Scene& shot, int widest) {
    const Scene scene = with_small_pictures(shot, widest);
    RenderOptions options = render_options(scene);
    options.samples = 1;
    options.lighting.air = make_sky(scene).air != nullptr;
    return {scene, options};
}

// The parts of a bake. The mesh's positions aren't one: they are what is left when all parts are taken away.
std::vector<MeasureItem> bake_items(const Scene& scene) {
    std::vector<MeasureItem> items = measure_items(scene);
    std::erase_if(items, [](const MeasureItem& item) { return item.name == "mesh"; });
    return items;
}

// Frames of a bake, one after another; nothing where the shot asks for nothing.
class BakedFrames {
  public:
    explicit BakedFrames(const Scene& scene) : plan_(plan_bake(scene)) {
        if (!plan_.outputs.empty()) sequence_ = make_sequence(plan_);
    }
    void run() {
        if (!sequence_) return;
        const Shot& shot = plan_.from->scene.shot;
        const long frames = long{shot.last_frame} - shot.first_frame + 1;
        sequence_->compute(static_cast<int>(shot.first_frame + runs_++ % frames), slot_);
    }
    const Plan& plan() const { return plan_; }

  private:
    Plan plan_;
    std::unique_ptr<Sequence> sequence_;
    FrameSlot slot_;
    long runs_ = 0;
};

}  // namespace

Trials picture_effects(const Scene& shot) {
    const ShotPicture whole = picture_of(shot, kSweepWidth);
    std::vector<PictureSetting> settings{{kWholeShot, true, whole.scene, whole.options},
                                         {kShotAgain, false, whole.scene, whole.options}};
    for (PicturePart& part : parts_of(whole))
        settings.push_back(
            {kWithout + part.name, false, std::move(part.without.scene), part.without.options});
    ShotPicture bare = whole;
    for (auto left = parts_of(bare); !left.empty(); left = parts_of(bare)) bare = left.front().without;
    settings.push_back({kBareShot, false, bare.scene, bare.options});
    return against(whole.scene, whole.options, std::move(settings));
}

Trials picture_steps(const Scene& shot) {
    constexpr int kWidest = 480;
    ShotPicture whole = picture_of(shot, kWidest);
    const LightingChoice own = whole.options.lighting;
    whole.options.lighting.sky_quality = SkyQuality::Integral;
    // From the whole picture down; the settings are reversed then, so that each adds a part.
    std::vector<PictureSetting> settings;
    for (ShotPicture at = whole;;) {
        std::vector<PicturePart> left = parts_of(at);
        settings.push_back({left.empty() ? "waves alone" : "+ " + left.back().name,
                            at.options.lighting == own, at.scene, at.options});
        if (left.empty()) break;
        at = std::move(left.back().without);
    }
    std::reverse(settings.begin(), settings.end());
    return against(whole.scene, whole.options, std::move(settings), PictureErrors::AlsoOfStep);
}

Trials bake_effects(const Scene& shot) {
    const auto trial_of = [](std::string name, const Scene& scene) {
        const auto frames = std::make_shared<BakedFrames>(scene);
        const PlanCost cost = cost_of(frames->plan());
        return Trial{.setting = std::move(name),
                     .is_shots = false,
                     .run = [frames] { frames->run(); },
                     .errors = [] { return std::vector<double>(); },
                     .bytes = static_cast<std::size_t>(cost.sea_bytes + cost.frame_bytes + cost.output_bytes),
                     .transforms = static_cast<int>(cost.transforms)};
    };
    const Plan whole = plan_bake(shot);
    if (whole.outputs.empty()) return {{}, "has nothing to take away: the shot has no outputs"};
    Trials trials;
    trials.trials.push_back(trial_of(kWholeShot, shot));
    trials.trials.front().is_shots = true;
    trials.trials.push_back(trial_of(kShotAgain, shot));
    for (const MeasureItem& item : bake_items(shot))
        if (!same_work(whole, plan_bake(item.without)))
            trials.trials.push_back(trial_of(kWithout + item.name, item.without));
    Scene bare = shot;
    for (auto left = bake_items(bare); !left.empty(); left = bake_items(bare)) bare = left.front().without;
    trials.trials.push_back(trial_of(kBareShot, bare));
    return trials;
}

}  // namespace pelagic::rows
