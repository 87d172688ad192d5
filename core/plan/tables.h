// The plan's tables: what each output, product and effect needs. They decide, and nothing else does.
#pragma once

#include <array>
#include <vector>

#include "core/plan/fields.h"
#include "core/scene/scene.h"

namespace pelagic {

struct ProductRow {
    Product product;
    const char* name;
    FieldSet (*needs)();
    const char* why;
    std::size_t scalars;  // a point
};

inline const std::array<ProductRow, kProductCount> kProductTable{{
    {Product::Position, "position", [] { return fields(Field::Height, Field::Dx, Field::Dy); },
     "the displaced point", 3},
    {Product::Displacement, "displacement", [] { return fields(Field::Height, Field::Dx, Field::Dy); },
     "the displaced point less the point at rest", 3},
    {Product::Normal, "normal",
     [] { return fields(Field::SlopeX, Field::SlopeY, Field::Dxx, Field::Dyy, Field::Dxy); },
     "the cross product of the displaced tangents", 3},
    {Product::Velocity, "velocity",
     [] { return fields(Field::VelocityX, Field::VelocityY, Field::VelocityZ); }, "the sums' time derivative",
     3},
    {Product::SlopeVariance, "slope variance", [] { return FieldSet(); },
     "a remainder of the spectrum: no transform", 3},
    {Product::JacobianMoments, "Jacobian moments", [] { return fields(Field::Dxx, Field::Dyy, Field::Dxy); },
     "J and the variance that the footprint hides", 3},
    {Product::Coverage, "whitecap coverage", [] { return fields(Field::Dxx, Field::Dyy, Field::Dxy); },
     "where J falls below the threshold of breaking", 1},
}};

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

// The fields that a point's cell filters (positions and velocities); its pixel filters the others.
FieldSet cell_fields();
FieldSet fields_of(ProductSet);
// The products that count what a footprint hides.
ProductSet hidden_products();

}  // namespace pelagic
