// The one place where a precision that is known at run time becomes a type.
#pragma once

#include <utility>

namespace pelagic {

// use(double()) or use(float()); both must return the same type.
template <class Use>
auto with_precision(bool double_precision, Use&& use) {
    return double_precision ? std::forward<Use>(use)(double()) : std::forward<Use>(use)(float());
}

}  // namespace pelagic
