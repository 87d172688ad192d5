// Where the query writes: one strided view per product, in the caller's memory.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

#include "core/base/strided.h"
#include "core/plan/products.h"

namespace pelagic {

// An array of views over the table of products, which describes the values. A product without a view is
// skipped. A view's type follows from the product's number of components: the compiler checks it.
template <class T>
class Results {
  public:
    // The components of a value lie side by side, values any number of bytes apart.
    void set(VectorProduct product, Strided<glm::vec<3, T>> values) {
        views_[index(product)] = {values ? &values.data->x : nullptr, values.stride_bytes};
    }
    void set(NumberProduct product, Strided<T> values) { views_[index(product)] = values; }

    Strided<glm::vec<3, T>> vectors(VectorProduct product) const {
        const Strided<T>& view = views_[index(product)];
        return {reinterpret_cast<glm::vec<3, T>*>(view.data), view.stride_bytes};
    }
    Strided<T> numbers(NumberProduct product) const { return views_[index(product)]; }

    bool holds(Product product) const { return static_cast<bool>(views_[index(product)]); }
    ProductSet given() const {
        ProductSet given;
        for (const ProductRow& row : kProductTable) given[index(row.product)] = holds(row.product);
        return given;
    }
    // The same, beginning at a later point.
    Results from_point(std::size_t first) const {
        Results later = *this;
        for (Strided<T>& view : later.views_)
            if (view) view.data = &view[first];
        return later;
    }

  private:
    std::array<Strided<T>, kProductCount> views_;  // of the first components
};

}  // namespace pelagic
