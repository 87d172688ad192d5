// The sea as a procedural primitive of RenderMan, in RIB:
//
//   Procedural2 "DynamicLoad" "SimpleBound" "string dsoname" ["pelagic_sea"] "float[6] __bound" [-1e5 1e5 -1e5 1e5 -50 50]
//       "string shot" ["storm.toml"] "float frame" [12] "float[2] shutter" [-0.25 0.25]
//
// That is for present versions, 24 and later; older ones call `__bound` just `bound`.
//
// Its mesh are polygons with N, slopeVariance and whitecapCoverage, and with two keys of motion, at the times of `shutter`: frames, as
// the RIB's Shutter has to count them. Matrices are of single precision: a camera more than some 10 km away from the world's origin sees
// the mesh tremble.
//
//   c++ -std=c++17 -O2 -fPIC -shared renderman.cpp -I$RMANTREE/include $(pkg-config --cflags --libs pelagic) -o pelagic_sea.so
#include <RixInterfaces.h>
#include <prmanapi.h>
#include <ri.h>

#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "sea_mesh.h"

namespace {

SeaStop stop;

RixMessages* messages() {
    return static_cast<RixMessages*>(RixGetContext()->GetRixInterface(k_RixMessages));
}

// "float frame" and "frame" are the same parameter: its type may have been declared before.
std::string_view name_of(RtToken token) {
    const std::string_view words(token);
    return words.substr(words.find_last_of(' ') + 1);
}

template <class T>
const T* values_of(RtPointer values) {
    return static_cast<const T*>(values);
}

SeaParameters parameters_of(RtInt count, RtToken const tokens[], RtPointer const values[]) {
    SeaParameters asked;
    for (RtInt i = 0; i < count; ++i) {
        const std::string_view name = name_of(tokens[i]);
        if (name == "shot") {
            asked.shot = *values_of<RtString>(values[i]);
        } else if (name == "frame") {
            asked.frame = static_cast<double>(*values_of<RtFloat>(values[i]));
        } else if (name == "finestcell") {
            asked.finest_cell_m = static_cast<double>(*values_of<RtFloat>(values[i]));
        } else if (name == "threads") {
            asked.threads = *values_of<RtInt>(values[i]);
        } else if (name == "shutter") {
            asked.shutter_open = static_cast<double>(values_of<RtFloat>(values[i])[0]);
            asked.shutter_close = static_cast<double>(values_of<RtFloat>(values[i])[1]);
        }
    }
    return asked;
}

// slopeVariance is no vector: a transform must leave its components alone.
void polygons(SeaMesh& sea, std::vector<float> position_m) {
    std::vector<RtInt> corners(sea.faces(), 4), indices(sea.corner.begin(), sea.corner.end());
    RtToken tokens[] = {"P", "N", "vertex float[3] slopeVariance", "vertex float whitecapCoverage"};
    RtPointer values[] = {position_m.data(), sea.normal.data(), sea.slope_variance.data(),
                          sea.coverage.data()};
    RiPointsPolygonsV(static_cast<RtInt>(sea.faces()), corners.data(), indices.data(), 4, tokens, values);
}

void give(const SeaParameters& asked, SeaMesh sea) {
    RiAttributeBegin();
    RtMatrix to_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    for (std::size_t axis = 0; axis < 3; ++axis) to_world[3][axis] = static_cast<RtFloat>(sea.origin_m[axis]);
    RiConcatTransform(to_world);
    if (asked.shutter_close > asked.shutter_open) {
        RtFloat times[] = {static_cast<RtFloat>(asked.shutter_open),
                           static_cast<RtFloat>(asked.shutter_close)};
        RiMotionBeginV(2, times);
        polygons(sea, sea.position_at(asked.shutter_open));
        polygons(sea, sea.position_at(asked.shutter_close));
        RiMotionEnd();
    } else {
        polygons(sea, sea.position_at(asked.shutter_open));
    }
    RiAttributeEnd();
}

}  // namespace

// For the application that has started the render, from any thread: RenderMan tells no procedural that it is to stop.
extern "C" PRMANEXPORT void pelagic_renderman_stop(int stopped) {
    stop.set(stopped != 0);
}

extern "C" PRMANEXPORT RtVoid Subdivide2(RtContextHandle, RtFloat, RtInt count, RtToken const tokens[],
                                         RtPointer const values[]) {
    try {
        const SeaParameters asked = parameters_of(count, tokens, values);
        SeaSource source(stop);
        const auto note = [](const char* sentence) { messages()->Warning("pelagic: %s", sentence); };
        give(asked, source.mesh(asked, note));
    } catch (const SeaStopped&) {
    } catch (const std::exception& error) {
        messages()->Error("pelagic: %s", error.what());
    }
}
