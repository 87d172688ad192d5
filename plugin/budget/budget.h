// A budget turned into settings: quality.max_error or quality.frame_ms, once, by the host that has read the scene. Whatever is
// planned afterwards knows no budget (core/scene/budget.h).
//
// What a mesh misses is known from the spectrum (core/plan/mesh_error_model.h), what reading between the nodes adds is recorded,
// pictures' errors are measured on a small one of the shot (picture_errors.h), and costs follow from plans (cost.h).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/build_watch.h"
#include "pelagic/scene.h"
#include "plugin/budget/cost.h"
#include "plugin/render/render_files.h"
#include "plugin/run/run.h"

namespace pelagic {

// What the settings are for. A mesh gets another quality.level and, by its kind, another surface.resolution, surface.cell_px or
// surface.cage_level; a bake without one another level. Pictures get numbers of samples and lookups of the sky.
enum class Purpose { Mesh, Pictures };

// Of pictures: what isn't left to the budget. Nothing of which frames are made: a frame's time is that of a run through the shot,
// which goes on with the foam of the frame before.
struct FixedSettings {
    std::optional<int> samples{};
    std::optional<SkyQuality> sky_quality{};
    double shutter_frames = 0.0;  // as RenderOptions'
    PictureLayerSet layers = light_layers();
};

struct SettleOptions {
    FixedSettings fixed{};
    std::size_t max_memory_bytes = 0;  // 0: what the system gives
    BuildWatch watch{};
    // Without: for a time those of this machine (calibration.h), for an error the recorded ones, so that every machine chooses alike.
    std::optional<Rates> rates{};
};

// As if this were a machine of these rates: recorded_rates() for hosts whose answer must be the same on every machine at once, such
// as Blender on a farm.
SettleOptions with_rates(const Rates& rates, const FixedSettings& fixed = {});

struct Settled {
    Scene scene;              // without a budget
    RenderOptions options{};  // of pictures: render_options(scene), with what was chosen and what is fixed
    // Expected of a mesh: the RMS distance from the sea over Hs; where it is made for a camera, from what its pixels show. Of
    // pictures: the relative error of radiance that 95 % of the water's pixels don't exceed; typical ones, where the budget is of time.
    double error = 0.0;
    double ms = 0.0;    // of a frame, or a picture
    bool holds = true;  // false: nothing holds the budget, and these settings come nearest
    std::string
        budget{};  // "quality.max_error = 0.05"; empty: nothing was left to choose, and nothing was chosen
    std::string what{}, settings{};  // "mesh is", "quality.level = \"final\", surface.resolution = 384"
    std::string text{};              // for people: what was chosen, and why
    bool is_recorded = false;        // settle_for(): they are what the folder's files say
    std::string before{};  // settle_for(): what the folder's record said was chosen, for whatever budget
    std::string note{};    // settle_for(): where today's choice would be another; otherwise empty
    std::size_t measuring_bytes = 0;  // that measuring the shot held; 0 where nothing was measured

    // Of pictures: puts what was chosen into what is ordered.
    void apply(PictureOrder& order) const;
    // Puts it into the run that settle_for() was asked for.
    void apply(RunOptions& run) const {
        run.chosen = chosen();
        run.chosen_before = before;
    }
    // What files say of it (RunOptions::chosen): "quality.max_error = 0.05: quality.level = …"
    std::string chosen() const { return budget.empty() ? "" : budget + ": " + settings; }
};

// max_error: the cheapest settings that err by no more; frame_ms: the most accurate ones that cost no more. The scene must be
// valid. Without a budget at once; for a mesh it takes the longer the more of the surface's points must be looked at; for pictures
// with max_error, seconds. Throws as measured_errors(), and check_render()'s std::invalid_argument where even one sample a pixel is
// too many.
Settled settle(const Scene& scene, Purpose purpose, const SettleOptions& with = {});

// The settings that hold the budget. Throws std::invalid_argument, saying what comes nearest, where none does; `or_else`: what may
// be given instead of a budget.
Settled held(Settled settled, const std::string& or_else = {});

// The settings that hold the budget, for a run into a folder: those that its record, or one of its pictures, says were chosen for the
// same budget, so that all tasks that fill it agree, unless they err by more than max_error in today's shot; otherwise today's. Where
// run.settled says what was chosen, that, or it is refused.
// Throws as settle() and held(), and std::invalid_argument for a part of the shot's frames where the folder says nothing yet, or
// something that is none of what is chosen from today; a run of all frames then has a note.
Settled settle_for(const RunOptions& run, const Scene& scene, Purpose purpose, const SettleOptions& with = {},
                   const std::string& or_else = {});

// The surfaces that a mesh is chosen from, from coarse to fine; of those that aren't even grids only the ones of up to two
// million points.
std::vector<Surface> rising_fineness(const Scene& scene);

}  // namespace pelagic
