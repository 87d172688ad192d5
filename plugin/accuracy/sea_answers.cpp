#include "plugin/accuracy/sea_answers.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace pelagic {

double middle_time_s(const Scene& shot) {
    return shot.shot.time_s(middle_frame(shot));
}

int middle_frame(const Scene& shot) {
    return static_cast<int>((long{shot.shot.first_frame} + shot.shot.last_frame) / 2);
}

SweepPoints sweep_points(const Scene& shot, int most_per_side) {
    SweepPoints points;
    points.per_side = std::clamp(shot.surface.resolution, 16, most_per_side);
    points.spacing_m = shot.surface.size_m / points.per_side;
    points.time_s = middle_time_s(shot);
    // No simple part of a cell, so that no point lies on a cascade's node.
    constexpr double kOff = 0.3819660112501051;
    for (int y = 0; y < points.per_side; ++y)
        for (int x = 0; x < points.per_side; ++x)
            points.rest_m.push_back((glm::dvec2(x, y) + kOff) * points.spacing_m - 0.5 * shot.surface.size_m);
    return points;
}

template <class T>
struct SeaAnswers::Of final : SeaAnswers::Precision {
    Of(const Plan& planned, const SweepPoints& at)
        : frame(std::make_shared<const Sea<T>>(planned)),
          rest(at.rest_m.begin(), at.rest_m.end()),
          time_s(at.time_s) {
        arrays.resize(planned.queries[0].query.products, rest.size());
    }
    void run() override {
        frame.set(time_s);
        evaluate(frame, 0, Points<T>{.count = rest.size(), .rest_m = {rest.data()}}, arrays.results());
    }
    std::vector<glm::dvec3> vectors(VectorProduct product) const override {
        const auto& own = arrays.vectors(product);
        return {own.begin(), own.end()};
    }
    std::vector<double> numbers(NumberProduct product) const override {
        const auto& own = arrays.numbers(product);
        return {own.begin(), own.end()};
    }
    const Plan& plan() const override { return frame.sea().plan(); }
    SpectralMoments resolved_moments() const override { return frame.sea().resolved_moments(0); }
    double significant_height_m() const override { return frame.sea().total().significant_height_m(); }

    Frame<T> frame;
    std::vector<glm::vec<2, T>> rest;
    double time_s;
    ProductArrays<T> arrays;
};

SeaAnswers::SeaAnswers(const Scene& scene, ProductSet wanted, double footprint_m, const SweepPoints& at,
                       const PlanOptions& options) {
    Query query;
    query.name = "sweep";
    query.products = wanted;
    query.cell_m = query.pixel_m = {footprint_m};
    query.points = at.rest_m.size();
    const Plan plan = make_plan(scene, {query}, options);
    with_precision(plan.knobs.double_precision,
                   [&]<class T>(T) { sea_ = std::make_shared<Of<T>>(plan, at); });
}

double percentile(std::vector<double>& values, double share) {
    if (values.empty()) return 0.0;
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double rms(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i] - b[i], a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(a.size(), 1)));
}

double rms(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(a.size(), 1)));
}

}  // namespace pelagic
