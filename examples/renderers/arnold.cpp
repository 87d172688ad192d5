// The sea as a procedural node of Arnold 7, pelagic_sea:
//
//   pelagic_sea { name sea shot "storm.toml" frame 12 motion_start -0.25 motion_end 0.25 }
//
// Its mesh is a polymesh with normals, the user data slopeVariance and whitecapCoverage, and a key at either end of the node's motion,
// which is counted in frames. A node that doesn't set its motion has Arnold's own, 0 to 1: from the frame to the next one. Arnold's matrices
// are of single precision: a camera more than some 10 km away from the world's origin sees the mesh tremble.
//
//   c++ -std=c++17 -O2 -fPIC -shared arnold.cpp -I$ARNOLD/include -L$ARNOLD/bin -lai $(pkg-config --cflags --libs pelagic) -o pelagic_sea.so
#include <ai.h>

#include <cstring>
#include <exception>
#include <vector>

#include "sea_mesh.h"

AI_PROCEDURAL_NODE_EXPORT_METHODS(PelagicSeaMethods);

namespace {

SeaStop stop;

AtArray* array_of(std::size_t count, std::uint8_t type, const void* values) {
    return AiArrayConvert(static_cast<std::uint32_t>(count), 1, type, values);
}

bool has(const AtNode* node, const AtString& parameter) {
    return AiNodeEntryLookUpParameter(AiNodeGetNodeEntry(node), parameter) != nullptr;
}

AtNode* polymesh(const AtNode* procedural, const SeaParameters& asked, const SeaMesh& sea) {
    AtNode* mesh = AiNode(AiNodeGetUniverse(procedural), AtString("polymesh"), AtString("sea"), procedural);
    const std::vector<std::uint32_t> four(sea.faces(), 4);
    AiNodeSetArray(mesh, AtString("nsides"), array_of(sea.faces(), AI_TYPE_UINT, four.data()));
    for (const char* indices : {"vidxs", "nidxs"})
        AiNodeSetArray(mesh, AtString(indices), array_of(sea.corner.size(), AI_TYPE_UINT, sea.corner.data()));
    // Normals have as many keys as points.
    const std::uint8_t keys = asked.shutter_close > asked.shutter_open ? 2 : 1;
    const auto points = static_cast<std::uint32_t>(sea.points());
    AtArray *positions = AiArrayAllocate(points, keys, AI_TYPE_VECTOR),
            *normals = AiArrayAllocate(points, keys, AI_TYPE_VECTOR);
    for (std::uint8_t key = 0; key < keys; ++key) {
        AiArraySetKey(positions, key,
                      sea.position_at(key == 0 ? asked.shutter_open : asked.shutter_close).data());
        AiArraySetKey(normals, key, sea.normal.data());
    }
    AiNodeSetArray(mesh, AtString("vlist"), positions);
    AiNodeSetArray(mesh, AtString("nlist"), normals);
    const AtString start("motion_start"), end("motion_end");
    if (has(mesh, start)) AiNodeSetFlt(mesh, start, static_cast<float>(asked.shutter_open));
    if (has(mesh, end)) AiNodeSetFlt(mesh, end, static_cast<float>(asked.shutter_close));
    AiNodeSetBool(mesh, AtString("smoothing"), true);
    AiNodeSetMatrix(
        mesh, AtString("matrix"),
        AiM4Translation(AtVector(static_cast<float>(sea.origin_m[0]), static_cast<float>(sea.origin_m[1]),
                                 static_cast<float>(sea.origin_m[2]))));
    AiNodeDeclare(mesh, AtString("slopeVariance"), "varying VECTOR");
    AiNodeSetArray(mesh, AtString("slopeVariance"),
                   array_of(sea.points(), AI_TYPE_VECTOR, sea.slope_variance.data()));
    AiNodeDeclare(mesh, AtString("whitecapCoverage"), "varying FLOAT");
    AiNodeSetArray(mesh, AtString("whitecapCoverage"),
                   array_of(sea.points(), AI_TYPE_FLOAT, sea.coverage.data()));
    return mesh;
}

}  // namespace

// For the application that has started the render, from any thread: Arnold tells no procedural that it is to stop.
AI_EXPORT_LIB void pelagic_arnold_stop(int stopped) {
    stop.set(stopped != 0);
}

node_parameters {
    AiParameterStr("shot", "");
    AiParameterFlt("frame", 1.0f);
    AiParameterFlt("finest_cell", 0.0f);
    AiParameterInt("threads", 0);
}

procedural_init {
    SeaParameters asked;
    asked.shot = AiNodeGetStr(node, AtString("shot")).c_str();
    asked.frame = static_cast<double>(AiNodeGetFlt(node, AtString("frame")));
    asked.finest_cell_m = static_cast<double>(AiNodeGetFlt(node, AtString("finest_cell")));
    asked.threads = AiNodeGetInt(node, AtString("threads"));
    const AtString start("motion_start"), end("motion_end");
    if (has(node, start)) asked.shutter_open = static_cast<double>(AiNodeGetFlt(node, start));
    if (has(node, end)) asked.shutter_close = static_cast<double>(AiNodeGetFlt(node, end));
    *user_ptr = nullptr;
    try {
        SeaSource source(stop);
        const auto note = [](const char* sentence) { AiMsgWarning("[pelagic] %s", sentence); };
        *user_ptr = polymesh(node, asked, source.mesh(asked, note));
    } catch (const SeaStopped&) {
    } catch (const std::exception& error) {
        AiMsgError("[pelagic] %s", error.what());
    }
    return *user_ptr != nullptr;
}

// The node is Arnold's.
procedural_cleanup {
    return true;
}

procedural_num_nodes {
    return user_ptr ? 1 : 0;
}

procedural_get_node {
    return i == 0 ? static_cast<AtNode*>(user_ptr) : nullptr;
}

node_loader {
    if (i > 0) return false;
    node->methods = PelagicSeaMethods;
    node->output_type = AI_TYPE_NONE;
    node->name = "pelagic_sea";
    node->node_type = AI_NODE_SHAPE_PROCEDURAL;
    std::strcpy(node->version, AI_VERSION);
    return true;
}
