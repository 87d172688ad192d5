// The effects of a scene: what it can do without. A row of the table is all that the plan, its page and its prices know of
// an effect, and whether one is on is asked here alone (tests/style/effects.sh).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/plan/products.h"
#include "core/plan/query.h"
#include "core/scene/keys.h"
#include "pelagic/scene.h"

namespace pelagic {

struct Plan;

enum class Effect {
    HorizontalDisplacement,
    SecondOrder,
    Whitecaps,
    LivingFoam,
    FoamStructure,
    Spray,
    Gusts,
    Masks,
    Coast,
    Wakes
};

// Members that aren't given: the effect has nothing of the kind.
struct EffectRow {
    Effect effect;
    const char* name;
    bool (*is_asked_for)(const Scene&);  // by its own keys
    const char* why_not;                 // where it isn't
    std::vector<Effect> depends_on{};    // off where one of these is
    void (*turn_off)(Scene&);            // leaves a valid scene

    FieldSet fields{};                              // zero without it, whoever asks: never computed
    ProductSet products{};                          // without it no output holds them
    ProductSet (*adds_to)(const Query&) = nullptr;  // what outputs and pictures hold besides where it is on
    void (*plan)(Plan&) = nullptr;                  // where it is on: its part of a plan that has its queries
    struct State {                                  // what it keeps from frame to frame
        const char* name;
        std::size_t (*bytes)(const Plan&) = nullptr;
        const char* remedy;  // what to change so that they become fewer
    } state{};

    KeyPartSet key_parts{};                       // the parts of the keys on which those outputs depend
    bool (*shapes)(const Query&) = nullptr;       // that it changes
    std::string (*about)(const Plan&) = nullptr;  // where it is on, for explain()

    bool is_on(const Scene&) const;
    std::string why_off(const Scene&) const;  // where it is off
};

// In the order of the enumerators, each after those on which it depends.
std::span<const EffectRow> effect_table();
const EffectRow& row_of(Effect effect);
bool is_on(Effect effect, const Scene& scene);

// An output's or a picture's query, without the products of effects that are off, and with what those that are on add.
Query with_effects(const Scene& scene, Query query);

}  // namespace pelagic
