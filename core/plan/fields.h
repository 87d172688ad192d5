// What can be asked of the sea, what that needs, and nothing else: the vocabulary of the plan's tables.
#pragma once

#include <bitset>
#include <cstddef>

namespace pelagic {

// A real field that a sum of waves gives directly, at rest positions x (core/waves). D is the horizontal
// displacement, already times the choppiness.
enum class Field { Height, Dx, Dy, SlopeX, SlopeY, Dxx, Dyy, Dxy, VelocityX, VelocityY, VelocityZ };
inline constexpr std::size_t kFieldCount = 11;
using FieldSet = std::bitset<kFieldCount>;

// What evaluate() writes per point: derived from the summed fields and from the spectrum's remainders.
enum class Product { Position, Displacement, Normal, Velocity, SlopeVariance, JacobianMoments, Coverage };
inline constexpr std::size_t kProductCount = 7;
using ProductSet = std::bitset<kProductCount>;

constexpr std::size_t index(Field field) {
    return static_cast<std::size_t>(field);
}
constexpr std::size_t index(Product product) {
    return static_cast<std::size_t>(product);
}

template <class... E>
FieldSet fields(E... wanted) {
    FieldSet set;
    (set.set(index(wanted)), ...);
    return set;
}
template <class... E>
ProductSet products(E... wanted) {
    ProductSet set;
    (set.set(index(wanted)), ...);
    return set;
}

inline FieldSet velocity_fields() {
    return fields(Field::VelocityX, Field::VelocityY, Field::VelocityZ);
}

// The fields of the horizontal displacement: identically zero where the choppiness is.
inline FieldSet horizontal_fields() {
    return fields(Field::Dx, Field::Dy, Field::Dxx, Field::Dyy, Field::Dxy, Field::VelocityX,
                  Field::VelocityY);
}

}  // namespace pelagic
