// What a query gives, in arrays of our own: for hosts that keep answers, and in single precision, which is
// what files and arrays hold, whatever the precision of the sea.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/evaluate/evaluate.h"

namespace pelagic {

// An array a product, one value a point; empty where nobody asks.
template <class T>
class ProductArrays {
  public:
    // Room for this many points of each of `wanted`, and nothing of the others. Memory is kept for the next
    // time.
    void resize(ProductSet wanted, std::size_t points) {
        for (const ProductRow& row : kProductTable) {
            const std::size_t p = index(row.product), size = wanted[p] ? points : 0;
            (row.components == 1 ? numbers_[p].resize(size) : vectors_[p].resize(size));
        }
    }
    // How many points' values there are.
    std::size_t size(Product product) const {
        return numbers_[index(product)].size() + vectors_[index(product)].size();
    }

    const std::vector<glm::vec<3, T>>& vectors(VectorProduct product) const& {
        return vectors_[index(product)];
    }
    std::vector<glm::vec<3, T>>& vectors(VectorProduct product) & { return vectors_[index(product)]; }
    std::vector<glm::vec<3, T>> vectors(VectorProduct product) && {  // of a temporary: lives on
        return std::move(vectors_[index(product)]);
    }
    const std::vector<T>& numbers(NumberProduct product) const& { return numbers_[index(product)]; }
    std::vector<T>& numbers(NumberProduct product) & { return numbers_[index(product)]; }
    std::vector<T> numbers(NumberProduct product) && { return std::move(numbers_[index(product)]); }

    // Views of these arrays, for evaluate(): valid until they are resized.
    Results<T> results() {
        Results<T> results;
        for (const ProductRow& row : kProductTable) {
            const std::size_t p = index(row.product);
            if (size(row.product) == 0) continue;
            if (row.components == 1)
                results.set(NumberProduct::checked(row.product), {numbers_[p].data()});
            else
                results.set(VectorProduct::checked(row.product), {vectors_[p].data()});
        }
        return results;
    }

  private:
    template <class>
    friend class QueryRunner;

    // By product, whose number of components says in which of the two its values are.
    std::array<std::vector<glm::vec<3, T>>, kProductCount> vectors_;
    std::array<std::vector<T>, kProductCount> numbers_;
};
using Values = ProductArrays<float>;

// Evaluates queries of a frame or a SeaAtTime into single-precision arrays: in single precision straight into them, in
// double by way of arrays of its own, which are kept from call to call.
template <class T>
class QueryRunner {
  public:
    // All products that the query holds, or those of them that are `wanted`.
    template <class State, class... Watch>
    void run(const State& of, int query, const Points<T>& points, Values& out, const Watch&... watch) {
        run(of, query, points, of.sea().plan().queries.at(query).query.products, out, watch...);
    }
    template <class State, class... Watch>
    void run(const State& of, int query, const Points<T>& points, ProductSet wanted, Values& out,
             const Watch&... watch) {
        const auto ask = [&](const Results<T>& results) {
            if constexpr (std::is_same_v<State, Frame<T>>)
                evaluate(of, query, points, results);
            else
                of.evaluate(query, points, results, watch...);
        };
        out.resize(wanted, points.count);
        if constexpr (std::is_same_v<T, float>) {
            ask(out.results());
        } else {
            wide_.resize(wanted, points.count);
            ask(wide_.results());
            for (std::size_t p = 0; p < kProductCount; ++p) {
                narrow(wide_.vectors_[p], out.vectors_[p]);
                narrow(wide_.numbers_[p], out.numbers_[p]);
            }
        }
    }

  private:
    template <class Wide, class Narrow>
    static void narrow(const std::vector<Wide>& wide, std::vector<Narrow>& narrow) {
        std::transform(wide.begin(), wide.end(), narrow.begin(),
                       [](const Wide& value) { return Narrow(value); });
    }

    ProductArrays<T> wide_;  // unused in single precision
};

}  // namespace pelagic
