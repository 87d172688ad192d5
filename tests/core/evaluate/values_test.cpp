// Results and arrays by product: every product of the table has its own place, of its own type.
#include "core/evaluate/values.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

Scene small_sea() {
    Scene scene;
    scene.waves.cascades = {{40.0, 32}};
    return scene;
}
ProductSet all_products() {
    return ~lasting_products();
}

// The address of a product's view, as one of numbers.
const float* first_number(const Results<float>& results, const ProductRow& row) {
    if (row.components == 1) return results.numbers(NumberProduct::checked(row.product)).data;
    return &results.vectors(VectorProduct::checked(row.product)).data->x;
}

TEST(Values, HaveOneArrayAProductAndNoneForTheOthers) {
    for (const ProductRow& wanted : kProductTable) {
        Values values;
        values.resize(products(wanted.product), 5);
        const Results<float> results = values.results();
        EXPECT_EQ(results.given(), products(wanted.product)) << wanted.name;
        for (const ProductRow& row : kProductTable)
            EXPECT_EQ(values.size(row.product), row.product == wanted.product ? 5u : 0u) << row.name;
        const Results<float> later = results.from_point(3);
        EXPECT_EQ(later.given(), results.given());
        EXPECT_EQ(first_number(later, wanted) - first_number(results, wanted),
                  static_cast<std::ptrdiff_t>(3 * wanted.components))
            << wanted.name;
        values.resize(ProductSet(), 5);
        EXPECT_TRUE(values.results().given().none());
    }
}

TEST(Values, HaveTheTypeThatTheTableSays) {
    EXPECT_THROW(NumberProduct::checked(Product::Normal), std::logic_error);
    EXPECT_THROW(VectorProduct::checked(Product::Breaking), std::logic_error);
    EXPECT_EQ(Product(VectorProduct(Product::Normal)), Product::Normal);
}

// Each product that is asked for alone is what it is among all others, and a sea in double gives its own
// values, rounded once.
TEST(Values, HoldWhatEvaluateGivesRoundedOnce) {
    const std::vector<Query> queries{filtered(all_products(), 2.0)};
    const auto single = frame_of<float>(small_sea(), queries, 1.5);
    const auto reference = frame_of<double>(small_sea(), queries, 1.5);
    const auto rest = random_points<float>(100.0, 300);
    const std::vector<glm::dvec2> wide_rest(rest.begin(), rest.end());
    const Points<float> points{.count = rest.size(), .rest_m = {rest.data()}};
    const Points<double> wide_points{.count = rest.size(), .rest_m = {wide_rest.data()}};
    const auto expected = sample(single, 0, rest);
    const auto wide_expected = sample(reference, 0, wide_rest);
    QueryRunner<float> runner;
    QueryRunner<double> wide_runner;
    Values values, wide_values;
    const auto expect_same = [&](const ProductRow& row) {
        ASSERT_EQ(values.size(row.product), rest.size()) << row.name;
        ASSERT_EQ(wide_values.size(row.product), rest.size()) << row.name;
        for (std::size_t i = 0; i < rest.size(); ++i)
            if (row.components == 1) {
                const auto product = NumberProduct::checked(row.product);
                ASSERT_EQ(values.numbers(product)[i], expected.numbers(product)[i]) << row.name;
                ASSERT_EQ(wide_values.numbers(product)[i],
                          static_cast<float>(wide_expected.numbers(product)[i]))
                    << row.name;
            } else {
                const auto product = VectorProduct::checked(row.product);
                ASSERT_EQ(values.vectors(product)[i], expected.vectors(product)[i]) << row.name;
                ASSERT_EQ(wide_values.vectors(product)[i], glm::vec3(wide_expected.vectors(product)[i]))
                    << row.name;
            }
    };
    runner.run(single, 0, points, values);
    wide_runner.run(reference, 0, wide_points, wide_values);
    for (const ProductRow& row : kProductTable)
        if (all_products()[index(row.product)]) expect_same(row);
    for (const ProductRow& row : kProductTable) {
        if (!all_products()[index(row.product)]) continue;
        runner.run(single, 0, points, products(row.product), values);
        wide_runner.run(reference, 0, wide_points, products(row.product), wide_values);
        expect_same(row);
        for (const ProductRow& other : kProductTable) {
            if (other.product == row.product) continue;
            EXPECT_EQ(values.size(other.product) + wide_values.size(other.product), 0u);
        }
    }
}

}  // namespace
}  // namespace pelagic
