// The water at a buoy and at floats near and far, every bit of it: what a user of the package asks.
#include <pelagic/ocean.h>
#include <pelagic/version.h>

#include <array>
#include <cstdio>
#include <type_traits>

// Names stand in the version's namespace, and without it.
static_assert(std::is_same_v<pelagic::Ocean, pelagic::PELAGIC_VERSION_NAMESPACE::Ocean>);

int main() {
    pelagic::Scene scene;
    scene.sea.wind_speed_mps = 14.0;
    scene.waves.cascades.resize(1);
    scene.waves.cascades[0].size_m = 200.0;
    scene.waves.cascades[0].resolution = 64;
    pelagic::Ocean ocean(scene, 4.0);
    ocean.set(scene.shot.time_s(37.0));
    std::array<glm::dvec2, 8> places;
    for (std::size_t i = 0; i < places.size(); ++i)
        places[i] = {3.0 + 1e5 * static_cast<double>(i), -8.0 - 70.0 * static_cast<double>(i)};
    std::array<pelagic::WaterState, 8> water;
    ocean.water_at(places, water);
    for (const pelagic::WaterState& here : water)
        std::printf("%a %a %a %a\n", static_cast<double>(here.height_m), static_cast<double>(here.normal.x),
                    static_cast<double>(here.normal.y), static_cast<double>(here.velocity_mps.z));
    std::printf("%s %d %d %d\n", PELAGIC_VERSION, PELAGIC_VERSION_MAJOR, PELAGIC_VERSION_MINOR,
                PELAGIC_VERSION_PATCH);
}
