// The plan's tables: what each output and effect needs; what a product needs stands in products.h. They
// decide, and nothing else does.
#pragma once

#include <array>
#include <vector>

#include "core/plan/products.h"
#include "core/scene/scene.h"

namespace pelagic {

struct AttributeRow {
    MeshAttribute attribute;
    Product product;
};

inline constexpr std::array<AttributeRow, 4> kAttributeTable{{
    {MeshAttribute::Normal, Product::Normal},
    {MeshAttribute::Velocity, Product::Velocity},
    {MeshAttribute::SlopeVariance, Product::SlopeVariance},
    {MeshAttribute::Whitecaps, Product::Coverage},
}};

struct MapRow {
    MapKind map;
    const char* name;
    ProductSet (*needs)();
    bool asks_each_level;  // each level of its mip pyramid has a footprint of its own
};

inline const std::array<MapRow, 4> kMapTable{{
    {MapKind::Displacement, "displacement", [] { return products(Product::Displacement); }, false},
    {MapKind::Normal, "normal", [] { return products(Product::Normal); }, false},
    {MapKind::SlopeVariance, "slope-variance", [] { return products(Product::SlopeVariance); }, true},
    {MapKind::Whitecaps, "whitecaps", [] { return products(Product::JacobianMoments, Product::Coverage); },
     false},
}};

// What a scene can do without, and what then falls away.
struct EffectRow {
    const char* name;
    bool (*is_on)(const Scene&);
    const char* why_off;           // where it isn't
    void (*turn_off)(Scene&);      // leaves a valid scene
    FieldSet (*fields_gone)();     // zero without it, whoever asks: never computed
    ProductSet (*outputs_gone)();  // not written to meshes and maps
};

inline const std::array<EffectRow, 2> kEffectTable{{
    {"horizontal displacement", [](const Scene& scene) { return scene.waves.choppiness > 0.0; },
     "waves.choppiness is 0", [](Scene& scene) { scene.waves.choppiness = 0.0; }, horizontal_fields,
     [] { return ProductSet(); }},
    {"whitecaps", [](const Scene& scene) { return scene.effects.whitecaps; }, "effects.whitecaps is false",
     [](Scene& scene) {
         scene.effects.whitecaps = false;
         std::erase(scene.output.maps, MapKind::Whitecaps);  // would be a contradiction
     },
     [] { return FieldSet(); }, [] { return products(Product::JacobianMoments, Product::Coverage); }},
}};

}  // namespace pelagic
