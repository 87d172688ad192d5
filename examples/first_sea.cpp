// The water at a buoy, in four lines of C++: a scene, its ocean, a time, a place.
#include <pelagic/ocean.h>

#include <cstdio>

int main() {
    pelagic::Scene scene;  // its members are the shot file's keys: scene.sea.wind_speed_mps = 14.0
    pelagic::Ocean ocean(scene);
    ocean.set(3.0);                                                 // seconds
    const pelagic::WaterState water = ocean.water_at({3.0, -8.0});  // metres: x east, y north

    std::printf("%+.2f m high, tilted by %.2f, rising at %+.2f m/s\n", double{water.height_m},
                double{1.0f - water.normal.z}, double{water.velocity_mps.z});
}
