// The sums of waves from which everything that can be asked of the sea is derived (core/plan/products.h).
#pragma once

#include <bitset>
#include <cstddef>

namespace pelagic {

// A real field that a sum of waves gives directly, at rest positions x (core/waves). D is the horizontal
// displacement, already times the choppiness.
enum class Field { Height, Dx, Dy, SlopeX, SlopeY, Dxx, Dyy, Dxy, VelocityX, VelocityY, VelocityZ };
inline constexpr std::size_t kFieldCount = 11;
using FieldSet = std::bitset<kFieldCount>;

constexpr std::size_t index(Field field) {
    return static_cast<std::size_t>(field);
}

template <class... E>
constexpr FieldSet fields(E... wanted) {
    return FieldSet((0ull | ... | (1ull << index(wanted))));
}

// The fields that a point's cell filters (positions and velocities); its pixel filters the others.
constexpr FieldSet cell_fields() {
    return fields(Field::Height, Field::Dx, Field::Dy, Field::VelocityX, Field::VelocityY, Field::VelocityZ);
}

constexpr FieldSet velocity_fields() {
    return fields(Field::VelocityX, Field::VelocityY, Field::VelocityZ);
}

// The surface's height, its gradient and its velocity.
constexpr FieldSet vertical_fields() {
    return fields(Field::Height, Field::SlopeX, Field::SlopeY, Field::VelocityZ);
}

// The gradient of the horizontal displacement. The waves that break have one of their own (Plan::breaking).
constexpr FieldSet displacement_gradient_fields() {
    return fields(Field::Dxx, Field::Dyy, Field::Dxy);
}

// The fields of the horizontal displacement: identically zero where the choppiness is.
constexpr FieldSet horizontal_fields() {
    return fields(Field::Dx, Field::Dy, Field::Dxx, Field::Dyy, Field::Dxy, Field::VelocityX,
                  Field::VelocityY);
}

// Where tiles blend, the weights' gradient times this field belongs to the derivative (core/plan/random_tiling.h). Height,
// Dx and Dy themselves have no such term.
struct Gradient {
    Field derivative, of;
    bool along_y;
};
inline constexpr Gradient kGradients[]{{Field::SlopeX, Field::Height, false},
                                       {Field::SlopeY, Field::Height, true},
                                       {Field::Dxx, Field::Dx, false},
                                       {Field::Dyy, Field::Dy, true},
                                       {Field::Dxy, Field::Dx, true}};

// The columns of a grid are transformed along y alone: those of a derivative along x are i kx times those of what it is of.
struct AlongX {
    Field derivative, of;
};
inline constexpr AlongX kAlongX[]{
    {Field::SlopeX, Field::Height}, {Field::Dxx, Field::Dx}, {Field::Dxy, Field::Dy}};

// The fields that derivatives among these need for that: Dyx, which has no transform of its own, needs Dy as well.
inline FieldSet gradient_fields(FieldSet derivatives) {
    FieldSet needed;
    for (const Gradient& gradient : kGradients)
        if (derivatives[index(gradient.derivative)]) needed[index(gradient.of)] = true;
    if (derivatives[index(Field::Dxy)]) needed[index(Field::Dy)] = true;
    return needed;
}

}  // namespace pelagic
