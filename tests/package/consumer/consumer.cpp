// Heights and normals of a sea through a camera and at a buoy, every bit of them: what a user of the package computes.
#include <cstddef>
#include <cstdio>
#include <memory>
#include <vector>

#include "core/evaluate/prepared_query.h"
#include "core/lighting/water.h"
#include "core/plan/plan.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"

int main() {
    using namespace pelagic;
    Scene scene;
    scene.sea.wind_speed_mps = 14.0;
    scene.waves.cascades = {{.size_m = 200.0, .resolution = 64}};

    Query query;
    query.name = "points";
    query.products = products(Product::Position, Product::Normal, Product::SlopeVariance);
    query.cell_m = query.pixel_m = {4.0};
    Frame<float> frame(
        std::make_shared<const Sea<float>>(make_plan(scene, {query}, {.double_precision = false})));
    frame.set(1.5);
    const PreparedQuery<float> sea(frame, 0, query.products);

    const View view = view_at(scene.camera, 1.0);
    std::vector<glm::vec2> rest{{3.0f, -8.0f}};
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 along = view.direction({160.0 * i, 700.0});
        if (along.z < 0.0)
            rest.emplace_back(glm::dvec2(view.position_m) +
                              glm::dvec2(along) * (-view.position_m.z / along.z));
    }
    std::vector<glm::vec3> position(rest.size()), normal(rest.size());
    Results<float> results;
    results.set(Product::Position, {position.data()});
    results.set(Product::Normal, {normal.data()});
    sea.evaluate({.count = rest.size(), .rest_m = {rest.data()}}, results);
    for (std::size_t i = 0; i < rest.size(); ++i)
        std::printf("%a %a %a\n", static_cast<double>(position[i].z), static_cast<double>(normal[i].x),
                    static_cast<double>(normal[i].y));
}
