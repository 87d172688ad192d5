// What evaluate() gives at a point, described once: everything that lists products iterates this table. How to add
// one: core/README.md.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <stdexcept>

#include "core/plan/fields.h"

namespace pelagic {

enum class Product {
    Position,
    Displacement,
    Normal,
    Velocity,
    SlopeVariance,
    SlopeVarianceAtRest,
    JacobianMoments,
    Coverage,
    Breaking,
    FoamAge
};

struct ProductRow {
    Product product;
    const char* identifier;  // in Python and in messages to programs: "slope_variance"
    const char* name;        // for people: "slope variance"
    const char* in_meshes;   // the attribute of meshes' files; null: they have none
    std::size_t components;  // of a point's value: 3, or 1
    FieldSet needs;          // the sums that it is derived from
    bool counts_what_hides;  // whether it depends on what a footprint leaves unresolved
    bool
        is_of_breaking;  // whether its displacement gradient is that of the waves that break, unlike a normal's
    const char* why;     // what the sums are needed for, or why there are none
    const char* description;  // of the values, with their unit
};

inline constexpr auto kProductTable = std::to_array<ProductRow>({
    {Product::Position, "position", "position", "points", 3, fields(Field::Height, Field::Dx, Field::Dy),
     false, false, "the displaced point", "relative to the points' origin, z up [m]"},
    {Product::Displacement, "displacement", "displacement", nullptr, 3,
     fields(Field::Height, Field::Dx, Field::Dy), false, false, "the displaced point less the point at rest",
     "position less rest [m]"},
    {Product::Normal, "normal", "normal", "normals", 3,
     fields(Field::SlopeX, Field::SlopeY, Field::Dxx, Field::Dyy, Field::Dxy), false, false,
     "the cross product of the displaced tangents",
     "unit; its z is negative where the surface has folded over"},
    {Product::Velocity, "velocity", "velocity", "velocities", 3,
     fields(Field::VelocityX, Field::VelocityY, Field::VelocityZ), false, false, "the sums' time derivative",
     "of the water that rests at the point [m/s]"},
    {Product::SlopeVariance, "slope_variance", "slope variance", "primvars:slopeVariance", 3,
     displacement_gradient_fields(), true, false,
     "a remainder of the spectrum, carried by the waves that are shown",
     "xx, yy, xy of the slopes that the pixel footprint hides: larger on crests, smaller in troughs"},
    {Product::SlopeVarianceAtRest, "slope_variance_at_rest", "slope variance at rest", nullptr, 3, FieldSet(),
     true, false, "a remainder of the spectrum: no transform",
     "the same before the waves that are shown compress and stretch it: shown and unresolved add up to the spectrum's"},
    {Product::JacobianMoments, "jacobian", "Jacobian moments", nullptr, 3, displacement_gradient_fields(),
     true, true, "J of the waves that break, and the variance that the footprint hides",
     "mean, variance (not negative) and third cumulant of J in the pixel footprint, of the waves that break"},
    {Product::Coverage, "coverage", "whitecap coverage", "primvars:whitecapCoverage", 1,
     displacement_gradient_fields(), true, true, "where J falls below the threshold of breaking",
     "whitecaps, 0 … 1"},
    {Product::Breaking, "foam_active", "breaking", "primvars:foamActive", 1, displacement_gradient_fields(),
     true, true, "where J falls below the threshold of breaking", "what of the coverage breaks now, 0 … 1"},
    {Product::FoamAge, "foam_age", "foam age", "primvars:foamAge", 1, displacement_gradient_fields(), true,
     true, "what breaks now is new",
     "the mean age of the foam that is there, what breaks now counting as 0 [s]"},
});

inline constexpr std::size_t kProductCount = kProductTable.size();
using ProductSet = std::bitset<kProductCount>;

constexpr std::size_t index(Product product) {
    return static_cast<std::size_t>(product);
}
constexpr const ProductRow& row_of(Product product) {
    return kProductTable[index(product)];
}
static_assert(
    [] {
        for (std::size_t i = 0; i < kProductCount; ++i) {
            const ProductRow& row = kProductTable[i];
            if (index(row.product) != i || (row.components != 1 && row.components != 3)) return false;
        }
        return true;
    }(),
    "rows stand in the order of the enumerators; a value has 1 or 3 components");

template <class... E>
constexpr ProductSet products(E... wanted) {
    return ProductSet((0ull | ... | (1ull << index(wanted))));
}

inline FieldSet fields_of(ProductSet wanted) {
    FieldSet needed;
    for (const ProductRow& row : kProductTable)
        if (wanted[index(row.product)]) needed |= row.needs;
    return needed;
}

// The products that are of the waves that break.
inline ProductSet breaking_products() {
    ProductSet breaking;
    for (const ProductRow& row : kProductTable) breaking[index(row.product)] = row.is_of_breaking;
    return breaking;
}

// The products that count what a footprint leaves unresolved.
inline ProductSet unresolved_products() {
    ProductSet unresolved;
    for (const ProductRow& row : kProductTable) unresolved[index(row.product)] = row.counts_what_hides;
    return unresolved;
}

// The products of foam: what breaks now, and what counts as well what earlier breaking has left. A frame alone has
// none of the latter (core/effects/sea_at_time.h).
inline constexpr ProductSet lasting_products() {
    return products(Product::Coverage, Product::FoamAge);
}
inline constexpr ProductSet foam_products() {
    return products(Product::Breaking, Product::Coverage, Product::FoamAge);
}

// The products that gusts change.
inline constexpr ProductSet gusty_products() {
    return products(Product::SlopeVariance, Product::Breaking, Product::Coverage, Product::FoamAge);
}

// A product whose values have this many components. Of a constant, the compiler checks it.
template <std::size_t kComponents>
class ProductWith {
  public:
    consteval ProductWith(Product product) : product_(checked(product).product_) {}
    // Of a variable: throws std::logic_error where the number is another.
    static constexpr ProductWith checked(Product product) {
        if (row_of(product).components != kComponents)
            throw std::logic_error("the product's values have another number of components");
        return ProductWith(product, Checked());
    }
    constexpr operator Product() const { return product_; }

  private:
    struct Checked {};
    constexpr ProductWith(Product product, Checked) : product_(product) {}

    Product product_;
};
using VectorProduct = ProductWith<3>;
using NumberProduct = ProductWith<1>;

}  // namespace pelagic
