// The effects of a scene: what it can do without, and what each asks for. A row of kEffectTable is all that
// the plan knows of an effect; whether one is on is asked here and nowhere else.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/plan/products.h"
#include "core/scene/scene.h"

namespace pelagic {

struct Query;

// The absolute times n·step_s with n·step_s ≤ t, the latest `count` of them: what an effect that remembers
// adds up over. They don't depend on the shot's range, so that a frame alone equals that frame of a run.
struct TimeLattice {
    double step_s = 1.0;
    int count = 0;
};
// Latest first.
std::vector<double> times_before(const TimeLattice& lattice, double t_s);

// What an effect wants beside what the outputs ask for.
struct EffectNeeds {
    std::vector<Query> queries;          // its own points: fields and products follow as for an output's
    std::size_t bytes = 0;               // of state, in each frame
    std::optional<TimeLattice> earlier;  // times other than the frame's at which its queries are asked
};

struct EffectRow {
    const char* name;
    bool (*is_on)(const Scene&);
    const char* why_off;            // where it isn't
    void (*turn_off)(Scene&);       // leaves a valid scene
    FieldSet (*fields_gone)();      // zero without it, whoever asks: never computed
    ProductSet (*products_gone)();  // without it no output holds them
    EffectNeeds (*asks)(const Scene&);
};

std::span<const EffectRow> effect_table();

// What the effects that are off take away from outputs.
ProductSet products_gone(const Scene& scene, std::span<const EffectRow> table = effect_table());

}  // namespace pelagic
