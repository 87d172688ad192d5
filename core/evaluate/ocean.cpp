#include "pelagic/ocean.h"

#include <algorithm>
#include <glm/common.hpp>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "core/evaluate/water.h"
#include "core/plan/plan.h"
#include "core/scene/budget.h"
#include "core/scene/limits.h"
#include "core/scene/validate.h"

namespace pelagic {

void water_at(const BoundsByLevel<float>& bounds, const PreparedQuery<float>& query,
              std::span<const glm::dvec2> places_m, float footprint_m, std::span<WaterState> water,
              bool alone) {
    const std::size_t count = places_m.size();
    if (water.size() != count)
        throw std::invalid_argument("there are " + std::to_string(count) +
                                    " places, and room for the water at " + std::to_string(water.size()));
    for (std::size_t i = 0; i < count; ++i)
        for (const double metres : {places_m[i].x, places_m[i].y})
            if (!limits::kCameraCoordinate_m.holds(metres))
                throw std::invalid_argument(
                    "place " + std::to_string(i) +
                    " is no place on the sea; accepted: " + text_of(limits::kCameraCoordinate_m) + " m");
    // Places of a square have its middle as their origin, whichever others there are: in single precision none is far
    // from its own.
    constexpr double kSquare_m = 1024.0;
    const auto origin_of = [&](std::size_t i) { return kSquare_m * glm::round(places_m[i] / kSquare_m); };
    const auto rank = [&](std::size_t i) {
        const glm::dvec2 origin_m = origin_of(i);
        return std::tuple(origin_m.x, origin_m.y, i);
    };
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto before = [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); };
    if (!std::is_sorted(order.begin(), order.end(), before)) std::sort(order.begin(), order.end(), before);

    std::vector<glm::vec2> place_m, rest_m(count);
    std::vector<glm::vec3> displacement_m(count);
    std::vector<WaterState> there(count);
    for (std::size_t first = 0; first < count; first += place_m.size()) {
        const glm::dvec2 origin_m = origin_of(order[first]);
        place_m.clear();
        for (std::size_t k = first; k < count && origin_of(order[k]) == origin_m; ++k)
            place_m.emplace_back(places_m[order[k]] - origin_m);
        Points<float> points{.origin_m = origin_m, .count = place_m.size(), .rest_m = {place_m.data()}};
        if (footprint_m > 0.0f) points.cell_m = points.pixel_m = {&footprint_m, 0};
        find_highest_rest(bounds, query, points, {}, {rest_m.data()}, Strided<float>{}, alone);
        points.rest_m = {rest_m.data()};
        constexpr std::size_t kStride = sizeof(WaterState);
        Results<float> results;
        results.set(Product::Displacement, {displacement_m.data()});
        results.set(Product::Normal, {&there[0].normal, kStride});
        results.set(Product::Velocity, {&there[0].velocity_mps, kStride});
        alone ? query.evaluate_alone(points, results) : query.evaluate(points, results);
        for (std::size_t k = 0; k < points.count; ++k) {
            there[k].height_m = displacement_m[k].z;
            water[order[first + k]] = there[k];
        }
    }
}

struct Ocean::State {
    explicit State(const Plan& plan)
        : frame(std::make_shared<const SeaOverTime<float>>(plan)), bounds(frame, 0) {}

    Frame<float> frame;
    BoundsByLevel<float> bounds;
    std::optional<PreparedQuery<float>> query;
};

Ocean::Ocean(const Scene& scene, double footprint_m) {
    for (const Problem& problem : validate(scene)) throw std::invalid_argument(text_of(problem));
    if (!(footprint_m >= 0.0 && footprint_m <= 1e6))
        throw std::invalid_argument("footprint_m is outside the range; accepted: 0 to 1e6 m");
    const Scene plain = without_budget(scene);  // who asks says how fine the water is
    Query query;
    query.name = "water";
    query.products = kWaterProducts;
    if (footprint_m == 0.0) footprint_m = scene.surface.size_m / scene.surface.resolution;
    query.cell_m = query.pixel_m = {footprint_m};
    state_ = std::make_unique<State>(make_plan(plain, {query}, {.double_precision = false}));
    set(0.0);
}
Ocean::~Ocean() = default;
Ocean::Ocean(Ocean&&) noexcept = default;
Ocean& Ocean::operator=(Ocean&&) noexcept = default;

void Ocean::set(double t_s) {
    state_->frame.set(t_s);
    if (state_->query)
        state_->query->refresh();
    else
        state_->query.emplace(state_->frame, 0, kWaterProducts);
}

WaterState Ocean::water_at(glm::dvec2 place_m) const {
    WaterState water;
    water_at({&place_m, 1}, {&water, 1});
    return water;
}

void Ocean::water_at(std::span<const glm::dvec2> places_m, std::span<WaterState> water) const {
    pelagic::water_at(state_->bounds, *state_->query, places_m, 0.0f, water);
}

}  // namespace pelagic
