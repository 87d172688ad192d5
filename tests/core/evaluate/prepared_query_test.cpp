// What is kept between calls changes no bit of the answers, and is refused where it is out of date.
#include "core/evaluate/prepared_query.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <stdexcept>
#include <thread>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

ProductSet every_product() {
    return ~lasting_products();
}

struct PreparedCase {
    const char* name;
    WaveModel model;
    bool cascades, levels;
};
constexpr PreparedCase kCases[] = {
    {"cascades", WaveModel::Fft, true, false},
    {"cascades on several levels", WaveModel::Fft, true, true},
    {"trains", WaveModel::Trochoid, false, true},
    {"trains and a cascade on several levels", WaveModel::Trochoid, true, true}};

template <class T>
Frame<T> prepared_frame(const PreparedCase& c) {
    Scene scene;
    scene.waves.model = c.model;
    if (c.cascades) scene.waves.cascades = {{.size_m = 60.0, .resolution = 64}};
    if (c.model == WaveModel::Trochoid && c.cascades) scene.waves.shortest_m = 5.0;
    Query query = unfiltered(every_product());
    query.cell_m = query.pixel_m = {0.5};
    if (c.levels && c.cascades) query.cell_m = query.pixel_m = {0.5, 1.0, 2.0, 4.0};
    return test::frame_of<T>(scene, {query}, 3.25);
}

// Points, and each one's footprints where the case has any.
template <class T>
struct Asked {
    explicit Asked(bool footprints, std::size_t count)
        : rest(random_points<T>(500.0, static_cast<int>(count))) {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> size(0.0, 6.0);
        if (!footprints) return;
        for (std::size_t i = 0; i < count; ++i) {
            cell_m.push_back(static_cast<T>(size(random)));
            pixel_m.push_back(static_cast<T>(size(random)));
        }
    }
    Points<T> points(std::size_t first, std::size_t count) const {
        Points<T> points{.origin_m = origin_m, .count = count, .rest_m = {rest.data() + first}};
        if (!cell_m.empty()) {
            points.cell_m = {cell_m.data() + first};
            points.pixel_m = {pixel_m.data() + first};
        }
        return points;
    }
    glm::dvec2 origin_m{0.0};
    std::vector<glm::vec<2, T>> rest;
    std::vector<T> cell_m, pixel_m;
};

template <class T>
bool same_bits(const ProductArrays<T>& a, const ProductArrays<T>& b) {
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() &&
               (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
    };
    return std::all_of(kProductTable.begin(), kProductTable.end(), [&](const ProductRow& row) {
        if (row.components == 1) {
            const auto product = NumberProduct::checked(row.product);
            return same(a.numbers(product), b.numbers(product));
        }
        const auto product = VectorProduct::checked(row.product);
        return same(a.vectors(product), b.vectors(product));
    });
}

template <class T>
void expect_the_same_bits_in_any_batches(const PreparedCase& c) {
    constexpr std::size_t kCount = 700;
    const Frame<T> frame = prepared_frame<T>(c);
    const PreparedQuery<T> prepared(frame, 0, every_product());
    Asked<T> asked(c.levels, kCount);
    for (const glm::dvec2 origin_m : {glm::dvec2(0.0), glm::dvec2(1e6 + 0.375, -3e5)}) {
        asked.origin_m = origin_m;
        ProductArrays<T> whole;
        whole.resize(every_product(), kCount);
        evaluate(frame, 0, asked.points(0, kCount), whole.results());
        std::mt19937 random(3);
        for (const std::size_t most : {std::size_t(1), std::size_t(5), std::size_t(40), std::size_t(400)}) {
            ProductArrays<T> pieces;
            pieces.resize(every_product(), kCount);
            for (std::size_t first = 0; first < kCount;) {
                const std::size_t count = std::min<std::size_t>(1 + random() % most, kCount - first);
                prepared.evaluate(asked.points(first, count), pieces.results().from_point(first));
                first += count;
            }
            EXPECT_TRUE(same_bits(whole, pieces)) << c.name << ", at most " << most << " points at a time";
        }
    }
}

TEST(PreparedQuery, GivesTheSameBitsInBatchesOfAnySize) {
    for (const PreparedCase& c : kCases) {
        expect_the_same_bits_in_any_batches<float>(c);
        expect_the_same_bits_in_any_batches<double>(c);
    }
}

// Points of a row share the sums of the grid's rows, and lie in one vector of columns, in a few or in many; in any order.
template <class T>
void expect_the_same_bits_alone_and_in_a_row() {
    constexpr std::size_t kCount = 300;
    const Frame<T> frame = prepared_frame<T>(kCases[0]);
    const Grid& grid = frame.sea().plan().cascades[0].grids[0];
    ASSERT_EQ(grid.sampling, Sampling::Spline);
    const double node_m = 60.0 / grid.resolution;
    const PreparedQuery<T> prepared(frame, 0, every_product());
    for (const double columns : {0.03, 0.6, 1.3, 2.3, 3.2, 3.9, 5.0})
        for (const bool in_order : {true, false}) {
            Asked<T> asked(false, kCount);
            for (std::size_t i = 0; i < kCount; ++i)
                asked.rest[i] =
                    glm::vec<2, T>(static_cast<T>(columns * node_m * static_cast<double>(i)), T(7.3));
            if (!in_order) std::shuffle(asked.rest.begin(), asked.rest.end(), std::mt19937(9));
            ProductArrays<T> row, alone;
            row.resize(every_product(), kCount);
            alone.resize(every_product(), kCount);
            prepared.evaluate(asked.points(0, kCount), row.results());
            for (std::size_t i = 0; i < kCount; ++i)
                prepared.evaluate(asked.points(i, 1), alone.results().from_point(i));
            EXPECT_TRUE(same_bits(row, alone)) << columns << " columns a point, in order: " << in_order;
        }
}

TEST(PreparedQuery, GivesAPointOfARowTheSameBitsAlone) {
    expect_the_same_bits_alone_and_in_a_row<float>();
    expect_the_same_bits_alone_and_in_a_row<double>();
}

// Which products are asked for together changes none of them.
TEST(PreparedQuery, GivesEachProductAloneAsAmongAll) {
    for (const PreparedCase& c : kCases) {
        const Frame<float> frame = prepared_frame<float>(c);
        const PreparedQuery<float> prepared(frame, 0, every_product());
        const Asked<float> asked(c.levels, 50);
        Values together, single;
        together.resize(every_product(), 50);
        single.resize(every_product(), 50);
        prepared.evaluate(asked.points(0, 50), together.results());
        for (const ProductRow& row : kProductTable) {
            if (!every_product()[index(row.product)]) continue;
            Values alone;
            alone.resize(products(row.product), 50);
            prepared.evaluate(asked.points(0, 50), alone.results());
            if (row.components == 1)
                single.numbers(NumberProduct::checked(row.product)) =
                    alone.numbers(NumberProduct::checked(row.product));
            else
                single.vectors(VectorProduct::checked(row.product)) =
                    alone.vectors(VectorProduct::checked(row.product));
        }
        EXPECT_TRUE(same_bits(together, single)) << c.name;
    }
}

TEST(PreparedQuery, AnswersSeveralThreadsAtOnce) {
    constexpr std::size_t kCount = 2000, kThreads = 4;
    for (const PreparedCase& c : kCases) {
        const Frame<float> frame = prepared_frame<float>(c);
        const PreparedQuery<float> prepared(frame, 0, every_product());
        const Asked<float> asked(c.levels, kCount);
        Values whole, pieces;
        whole.resize(every_product(), kCount);
        pieces.resize(every_product(), kCount);
        evaluate(frame, 0, asked.points(0, kCount), whole.results());
        const Results<float> results = pieces.results();
        std::vector<std::thread> threads;
        for (std::size_t t = 0; t < kThreads; ++t)
            threads.emplace_back([&, t] {
                for (std::size_t i = t; i < kCount; i += kThreads)
                    prepared.evaluate(asked.points(i, 1), results.from_point(i));
            });
        for (std::thread& thread : threads) thread.join();
        EXPECT_TRUE(same_bits(whole, pieces)) << c.name;
    }
}

TEST(PreparedQuery, IsRefusedAfterSetUntilItIsRefreshed) {
    for (const PreparedCase& c : kCases) {
        Frame<float> frame = prepared_frame<float>(c);
        PreparedQuery<float> prepared(frame, 0, every_product());
        const Asked<float> asked(c.levels, 20);
        Values values, expected;
        values.resize(every_product(), 20);
        expected.resize(every_product(), 20);
        EXPECT_NO_THROW(prepared.evaluate(asked.points(0, 20), values.results()));
        frame.set(11.0);
        EXPECT_FALSE(prepared.is_current());
        EXPECT_THROW(prepared.evaluate(asked.points(0, 20), values.results()), std::logic_error);
        prepared.refresh();
        prepared.evaluate(asked.points(0, 20), values.results());
        evaluate(frame, 0, asked.points(0, 20), expected.results());
        EXPECT_TRUE(same_bits(values, expected)) << c.name;
    }
}

TEST(PreparedQuery, RefusesWhatItWasNotPreparedFor) {
    const Frame<float> frame = prepared_frame<float>(kCases[0]);
    const PreparedQuery<float> prepared(frame, 0, products(Product::Position));
    const Asked<float> asked(false, 3);
    for (const ProductRow& row : kProductTable) {
        if (row.product == Product::Position) continue;
        Values values;
        values.resize(products(row.product), 3);
        EXPECT_THROW(prepared.evaluate(asked.points(0, 3), values.results()), std::invalid_argument);
    }
    Scene scene;
    scene.waves.cascades = {{40.0, 32}};
    const Query positions = unfiltered(products(Product::Position));
    const Frame<float> holds_one = test::frame_of<float>(scene, {positions});
    EXPECT_THROW(PreparedQuery<float>(holds_one, 0, every_product()), std::invalid_argument);
    const Frame<float> unset(std::make_shared<const Sea<float>>(make_plan(scene, {positions})));
    EXPECT_THROW(PreparedQuery<float>(unset, 0, products(Product::Position)), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
