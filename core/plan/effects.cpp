#include "core/plan/effects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "core/base/constants.h"
#include "core/plan/memory.h"
#include "core/plan/plan.h"
#include "core/scene/keys.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

bool asks_for(const Plan& plan, const ProductSet& any) {
    return std::any_of(plan.queries.begin(), plan.queries.end(),
                       [&](const PlannedQuery& planned) { return (planned.query.products & any).any(); });
}

std::string about_second_order(const Plan& plan) {
    for (const CascadePlan& cascade : plan.cascades)
        if (const std::optional<SecondOrderPlan>& own = cascade.second_order)
            return "skewness of heights " + rough_text(own->skewness) + "; " +
                   std::to_string(own->transforms()) + " complex transforms of " +
                   std::to_string(own->resolution) + " × " + std::to_string(own->resolution) +
                   ", from waves above " + rough_text(cascade.size_m / own->radius) + " m";
    return "no output shows heights, or no cascade holds enough of the waves";
}

std::string about_whitecaps(const Plan& plan) {
    if (!asks_for(plan, foam_products())) return "no output asks for them";
    return "coverage from " + std::string(plan.knobs.third_moment ? "3" : "2") +
           " moments of the Jacobian, of waves above " + number_text(plan.breaking.from_m) + " m" +
           (plan.choppiness.moves()
                ? ""
                : ", as a choppiness of " + number_text(plan.breaking.choppiness.largest()) +
                      " would press them");
}

std::string about_gusts(const Plan& plan) {
    const std::vector<GustsPlan::Front>& fronts = plan.gusts->fronts;
    if (fronts.empty()) return {};
    std::string about;
    for (const GustsPlan::Front& front : fronts)
        about += "a front of " + rough_text(front.wind) + " times the wind that goes at " +
                 rough_text(glm::length(front.velocity_mps)) + " m/s, at " + number_text(front.middle_m.x) +
                 ", " + number_text(front.middle_m.y) + " m after " + rough_text(front.time_s) + " s; ";
    return about + "waves that are shown don't feel fronts";
}

std::size_t mask_picture_bytes(const Plan& plan) {
    std::size_t texels = plan.masks ? plan.masks->picture_texels() : 0;
    for (const auto& [name, picture] : plan.from->scene.waves.mask_pictures)
        texels += picture->shares().size();
    return sizeof(float) * texels;
}

std::string about_masks(const Plan& plan) {
    const MasksPlan masks = plan_masks(plan.from->scene).value();
    const MasksPlan::Gains gains = masks.gains_in(glm::dvec2(-limits::kCameraCoordinate_m.high),
                                                  glm::dvec2(limits::kCameraCoordinate_m.high));
    std::string about = std::to_string(masks.masks.size()) + (masks.masks.size() == 1 ? " mask" : " masks");
    const std::size_t pictures =
        std::ranges::count_if(masks.masks, [](const auto& mask) { return mask.cells != nullptr; });
    if (pictures > 0)
        about += ", " + std::to_string(pictures) + " from pictures, " + bytes_text(mask_picture_bytes(plan));
    if (masks.changes_waves)
        about += "; waves " + rough_text(gains.least) + " … " + rough_text(gains.largest) + " times as high";
    if (masks.calms_ripples) about += "; slicks, of waves below 50 cm";
    if (masks.calms_foam) about += "; less foam";
    return about + "; pairs of waves (second order) change as the waves do, not as their square";
}

// With the file's own depths, which the scene keeps.
std::size_t coast_bytes(const Plan& plan) {
    if (!plan.masks || !plan.masks->surf) return 0;
    const glm::ivec2 texels = plan.from->scene.waves.coast_depths->columns_rows();
    return plan.masks->coast_bytes() +
           sizeof(float) * static_cast<std::size_t>(texels.x) * static_cast<std::size_t>(texels.y);
}

std::string about_coast(const Plan& plan) {
    if (!plan.masks || !plan.masks->surf) return "there are no waves";
    const MasksPlan::Mask& coast = plan.masks->masks.back();
    return "waves " + rough_text(coast.strongest) + " … " + rough_text(std::max(coast.other_way, 1.0)) +
           " times as high over " + std::to_string(plan.masks->surf->count.x) + " x " +
           std::to_string(plan.masks->surf->count.y) + " cells, " + bytes_text(coast_bytes(plan)) +
           "; nine reads a point, and heights and displacements in the derivatives' footprints as well";
}

std::string about_wakes(const Plan& plan) {
    std::string about = std::to_string(plan.cascades.size() - plan.sea_cascades()) + " of " +
                        std::to_string(plan.from->scene.waves.vessels.size()) + " vessels make waves";
    for (const CascadePlan& cascade : plan.cascades)
        if (const auto& vessel = cascade.vessel)
            about += "; at up to " + rough_text(vessel->speed_mps) + " m/s, in a tile of " +
                     rough_text(vessel->size_m) + " m, remembered for " +
                     rough_text(vessel->block_s * VesselPlan::kBlocks) + " s";
    return about + "; waves that break on theirs leave no foam";
}

std::string about_living_foam(const Plan& plan) {
    if (!plan.foam) return "no output asks for it";
    const FoamPlan& foam = *plan.foam;
    return "what broke in " + std::to_string(foam.intervals()) + " steps of " + rough_text(foam.step_s) +
           " s, over cells from " + rough_text(foam.cell_m) + " m; drifts by " +
           rough_text(std::hypot(foam.drift_mps.x, foam.drift_mps.y)) + " m/s";
}

const std::array kEffectTable = std::to_array<EffectRow>({
    {.effect = Effect::HorizontalDisplacement,
     .name = "horizontal displacement",
     .is_asked_for = [](const Scene& scene) { return Choppiness::asked(scene).built().moves(); },
     .why_not = "waves.choppiness is 0, or too little to be seen",
     .turn_off =
         [](Scene& scene) {
             scene.waves.choppiness = 0.0;
             for (CascadeSize& cascade : scene.waves.cascades) cascade.choppiness.reset();
         },
     .fields = horizontal_fields(),
     .plan =
         [](Plan& plan) {
             const Waves& waves = plan.from->scene.waves;
             plan.choppiness = Choppiness::asked(plan.from->scene).built();
             if (waves.model == WaveModel::Fft) plan.lean_rad = waves.lean_deg * kPi / 180.0;
         }},
    {.effect = Effect::SecondOrder,
     .name = "second order",
     .is_asked_for =
         [](const Scene& scene) {
             return scene.waves.second_order > 0.0 && scene.waves.model == WaveModel::Fft;
         },
     .why_not = "waves.second_order is 0, or waves.model has none",
     .depends_on = {Effect::HorizontalDisplacement},
     .turn_off = [](Scene& scene) { scene.waves.second_order = 0.0; },
     .plan = [](Plan& plan) { plan.second_order_gain = plan.from->scene.waves.second_order; },
     .state = {"what pairs of waves add", [](const Plan& plan) { return plan.second_order_bytes(); },
               "set waves.second_order to 0"},
     .about = about_second_order},
    {.effect = Effect::Whitecaps,
     .name = "whitecaps",
     .is_asked_for = [](const Scene& scene) { return scene.effects.whitecaps; },
     .why_not = "effects.whitecaps is false",
     .turn_off =
         [](Scene& scene) {
             scene.effects.whitecaps = false;
             std::erase(scene.output.maps, MapKind::Whitecaps);  // would be a contradiction
             std::erase(scene.output.volumes, VolumeKind::Spray);
             scene.output.drops = false;
         },
     .products = foam_products() | products(Product::JacobianMoments),
     .key_parts = key_parts(KeyPart::Foam),
     .shapes = [](const Query& query) { return (query.products & breaking_products()).any(); },
     .about = about_whitecaps},
    {.effect = Effect::LivingFoam,
     .name = "living foam",
     .is_asked_for = [](const Scene& scene) { return scene.effects.foam_decay_s > 0.0; },
     .why_not = "effects.foam_decay_s is 0",
     .depends_on = {Effect::Whitecaps},
     .turn_off = [](Scene& scene) { scene.effects.foam_decay_s = 0.0; },
     .adds_to = [](const Query& query) { return query.asks_for_past() ? foam_products() : ProductSet(); },
     .plan =
         [](Plan& plan) {
             if (asks_for(plan, foam_products())) {
                 // In pictures too what broke is that of a mesh: their wider edge is what breaks now.
                 plan.foam =
                     plan_foam(plan.from->scene, breaking_of(plan.from->scene, plan.filter).footprint_m,
                               plan.knobs.foam_steps_a_period);
                 plan.foam->breaking_m = plan.breaking.footprint_m;
             }
             // Nobody but pictures looks at them.
             const auto is_picture = [](const PlannedQuery& planned) { return planned.query.is_picture; };
             if (plan.foam && has_bubbles(plan.from->scene) && std::ranges::any_of(plan.queries, is_picture))
                 plan.foam->bubbles_m = bubbles_depth_m(plan.from->scene, plan.from->spectrum);
         },
     .state = {"the foam's history", [](const Plan& plan) { return plan.foam_history_bytes(); },
               "lower effects.foam_decay_s"},
     .about = about_living_foam},
    {.effect = Effect::FoamStructure,
     .name = "foam structure",
     .is_asked_for = [](const Scene& scene) { return scene.effects.foam_structure > 0.0; },
     .why_not = "effects.foam_structure is 0",
     .depends_on = {Effect::Whitecaps},
     .turn_off = [](Scene& scene) { scene.effects.foam_structure = 0.0; }},
    {.effect = Effect::Spray,
     .name = "spray",
     .is_asked_for = [](const Scene& scene) { return scene.effects.spray && scene.effects.spray_gain > 0.0; },
     .why_not = "effects.spray is false, or effects.spray_gain is 0",
     .depends_on = {Effect::Whitecaps},
     .turn_off =
         [](Scene& scene) {
             scene.effects.spray = false;
             std::erase(scene.output.volumes, VolumeKind::Spray);
             scene.output.drops = false;
         },
     // Its map lies over places of the world.
     .adds_to =
         [](const Query& query) {
             return query.is_picture ? products(Product::Displacement) : ProductSet();
         }},
    {.effect = Effect::Gusts,
     .name = "gusts",
     .is_asked_for =
         [](const Scene& scene) {
             return (scene.sea.gust_strength > 0.0 || has_fronts(scene.sea)) &&
                    scene.sea.wind_speed_mps > 0.0;
         },
     .why_not = "sea.gust_strength is 0 without sea.gust_fronts, or there is no wind",
     .turn_off =
         [](Scene& scene) {
             key_of("sea.gust_strength").set(scene, 0.0);
             scene.sea.gust_fronts.clear();
         },
     .plan = [](Plan& plan) { plan.gusts = plan_gusts(plan.from->scene); },
     .key_parts = key_parts(KeyPart::Gusts),
     .shapes =
         [](const Query& query) { return !query.only_cascade && (query.products & gusty_products()).any(); },
     .about = about_gusts},
    {.effect = Effect::Masks,
     .name = "calm and rough places",
     .is_asked_for =
         [](const Scene& scene) {
             const auto plan = plan_masks(scene);
             return plan && !plan->masks.empty();
         },
     .why_not = "waves.masks are none, or change nothing",
     .turn_off =
         [](Scene& scene) {
             scene.waves.masks.clear();
             scene.waves.mask_pictures.clear();
         },
     .state = {"pictures of calm and rough places", mask_picture_bytes,
               "take smaller pictures in waves.masks, or wider edges"},
     .about = about_masks},
    {.effect = Effect::Coast,
     .name = "tiles on a coast",
     .is_asked_for =
         [](const Scene& scene) { return scene.waves.model == WaveModel::Fft && scene.waves.coast; },
     .why_not = "waves.coast is false, or waves.model is trochoid",
     .turn_off =
         [](Scene& scene) {
             scene.waves.coast = false;
             scene.waves.coast_depths.reset();
         },
     .state = {"a coast's depths, gains and surf", coast_bytes, "take smaller depths in sea.depth_file"},
     .about = about_coast},
    {.effect = Effect::Wakes,
     .name = "wakes",
     .is_asked_for = [](const Scene& scene) { return !scene.waves.vessels.empty(); },
     .why_not = "waves.vessels are none",
     .turn_off = [](Scene& scene) { scene.waves.vessels.clear(); },
     .state = {"what vessels' waves were", [](const Plan& plan) { return plan.vessel_bytes(); },
               "have fewer waves.vessels"},
     .about = about_wakes},
});

}  // namespace

bool EffectRow::is_on(const Scene& scene) const {
    return is_asked_for(scene) && std::all_of(depends_on.begin(), depends_on.end(),
                                              [&](Effect other) { return pelagic::is_on(other, scene); });
}

std::string EffectRow::why_off(const Scene& scene) const {
    if (!is_asked_for(scene)) return why_not;
    for (const Effect other : depends_on)
        if (!pelagic::is_on(other, scene)) return std::string("there is none without ") + row_of(other).name;
    return {};
}

std::span<const EffectRow> effect_table() {
    return kEffectTable;
}

const EffectRow& row_of(Effect effect) {
    return kEffectTable[static_cast<std::size_t>(effect)];
}

bool is_on(Effect effect, const Scene& scene) {
    return row_of(effect).is_on(scene);
}

Query with_effects(const Scene& scene, Query query) {
    for (const EffectRow& row : kEffectTable)
        if (!row.is_on(scene))
            query.products &= ~row.products;
        else if (row.adds_to)
            query.products |= row.adds_to(query);
    return query;
}

}  // namespace pelagic
