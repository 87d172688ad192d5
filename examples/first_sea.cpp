// The sea as C++ has it: a scene, a query, the sea at a time, and the height of the water at a buoy for three seconds.
#include <cstdio>
#include <memory>

#include "core/effects/sea_at_time.h"
#include "core/plan/plan.h"

int main() {
    using namespace pelagic;
    Scene scene;  // each member is the shot file's key of the same name, with its default
    scene.sea.wind_speed_mps = 14.0;

    Query query;
    query.name = "buoy";
    query.products = products(Product::Position, Product::Normal);
    query.cell_m = query.pixel_m = {0.5};  // half a metre: waves below two cells are left out
    const Plan plan = make_plan(scene, {query}, {.double_precision = false});

    SeaAtTime<float> sea(std::make_shared<const Sea<float>>(plan));

    const glm::vec2 rest(3.0f, -8.0f);  // where the buoy is at rest [m]: x east, y north
    glm::vec3 position, normal;
    Results<float> results;
    results.set(Product::Position, {&position});
    results.set(Product::Normal, {&normal});
    for (double t_s = 0.0; t_s <= 3.0; t_s += 0.5) {
        sea.set(t_s);
        sea.evaluate(0, {.count = 1, .rest_m = {&rest}}, results);
        std::printf("%.1f s: at (%.2f, %.2f) m, %+.2f m high, tilted by %.2f\n", t_s,
                    static_cast<double>(position.x), static_cast<double>(position.y),
                    static_cast<double>(position.z), static_cast<double>(1.0f - normal.z));
    }
}
