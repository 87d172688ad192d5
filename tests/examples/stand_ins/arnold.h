// A stand-in for Arnold's ai.h, to compile and try examples/renderers/arnold.cpp without Arnold: the declarations that it uses, written by
// us from the public reference of Arnold's API, and a host that keeps what it is handed. Names are Arnold's; layouts and numbers are not.
#pragma once

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#define AI_API inline
#define AI_EXPORT_LIB extern "C" __attribute__((visibility("default")))
#define AI_VERSION "stand-in"
#define AI_MAXSIZE_VERSION 32

enum { AI_TYPE_INT, AI_TYPE_UINT, AI_TYPE_FLOAT, AI_TYPE_VECTOR, AI_TYPE_NONE };
enum { AI_NODE_SHAPE_PROCEDURAL };

class AtString {
  public:
    explicit AtString(const char* text) : text_(text) {}
    const char* c_str() const { return text_.c_str(); }

  private:
    std::string text_;
};

struct AtVector {
    AtVector(float of_x, float of_y, float of_z) : x(of_x), y(of_y), z(of_z) {}
    float x, y, z;
};
struct AtMatrix {
    float data[4][4];
};
struct AtUniverse {};
struct AtParamEntry {};
// Both kinds of shapes that the host knows have a motion of their own.
struct AtNodeEntry {
    std::map<std::string, AtParamEntry> parameters{{"motion_start", {}}, {"motion_end", {}}};
};

class AtArray {
  public:
    std::uint32_t elements = 0;
    int keys = 0, type = AI_TYPE_NONE;
    std::vector<float> floats{};
    std::vector<std::uint32_t> uints{};
};

struct AtNode {
    AtUniverse* universe = nullptr;
    const AtNode* parent = nullptr;
    AtNodeEntry entry{};
    std::string type{}, name{};
    std::map<std::string, std::string> strings{}, declared{};
    std::map<std::string, double> numbers{};
    std::map<std::string, AtMatrix> matrices{};
    std::map<std::string, std::shared_ptr<AtArray>> arrays{};
};
// Parameters go to a node at once.
struct AtList {
    AtNode* node = nullptr;
};

// What the host has been handed, until it is cleared.
struct ArnoldStandIn {
    std::vector<std::unique_ptr<AtNode>> nodes;
    std::vector<std::string> log;
};
inline ArnoldStandIn& arnold_stand_in() {
    static ArnoldStandIn host;
    return host;
}

AI_API void ai_stand_in_log(const char* format, va_list words) {
    char text[4096];
    std::vsnprintf(text, sizeof text, format, words);
    arnold_stand_in().log.emplace_back(text);
}
AI_API void AiMsgError(const char* format, ...) {
    va_list words;
    va_start(words, format);
    ai_stand_in_log(format, words);
    va_end(words);
}
AI_API void AiMsgWarning(const char* format, ...) {
    va_list words;
    va_start(words, format);
    ai_stand_in_log(format, words);
    va_end(words);
}

AI_API AtUniverse* AiNodeGetUniverse(const AtNode* node) {
    return node->universe;
}
AI_API AtNode* AiNode(AtUniverse* universe, const AtString type, const AtString name, const AtNode* parent) {
    auto node = std::make_unique<AtNode>();
    node->universe = universe;
    node->parent = parent;
    node->type = type.c_str();
    node->name = name.c_str();
    arnold_stand_in().nodes.push_back(std::move(node));
    return arnold_stand_in().nodes.back().get();
}
AI_API AtString AiNodeGetStr(const AtNode* node, const AtString name) {
    return AtString(node->strings.at(name.c_str()).c_str());
}
AI_API float AiNodeGetFlt(const AtNode* node, const AtString name) {
    return static_cast<float>(node->numbers.at(name.c_str()));
}
AI_API int AiNodeGetInt(const AtNode* node, const AtString name) {
    return static_cast<int>(node->numbers.at(name.c_str()));
}
AI_API void AiNodeSetFlt(AtNode* node, const AtString name, float value) {
    node->numbers[name.c_str()] = static_cast<double>(value);
}
AI_API void AiNodeSetBool(AtNode* node, const AtString name, bool value) {
    node->numbers[name.c_str()] = value ? 1.0 : 0.0;
}
AI_API void AiNodeSetMatrix(AtNode* node, const AtString name, AtMatrix value) {
    node->matrices[name.c_str()] = value;
}
AI_API void AiNodeSetArray(AtNode* node, const AtString name, AtArray* value) {
    node->arrays[name.c_str()].reset(value);
}
AI_API bool AiNodeDeclare(AtNode* node, const AtString name, const char* declaration) {
    node->declared[name.c_str()] = declaration;
    return true;
}
AI_API const AtNodeEntry* AiNodeGetNodeEntry(const AtNode* node) {
    return &node->entry;
}
AI_API const AtParamEntry* AiNodeEntryLookUpParameter(const AtNodeEntry* entry, const AtString name) {
    const auto found = entry->parameters.find(name.c_str());
    return found == entry->parameters.end() ? nullptr : &found->second;
}
AI_API AtArray* AiArrayAllocate(std::uint32_t elements, std::uint8_t keys, std::uint8_t type) {
    return new AtArray{elements, keys, type, {}, {}};
}
// The keys come one after another.
AI_API bool AiArraySetKey(AtArray* array, std::uint8_t, const void* data) {
    const std::size_t count = std::size_t{array->elements} * (array->type == AI_TYPE_VECTOR ? 3 : 1);
    const auto append = [&](auto& to, const auto* values) { to.insert(to.end(), values, values + count); };
    if (array->type == AI_TYPE_UINT)
        append(array->uints, static_cast<const std::uint32_t*>(data));
    else
        append(array->floats, static_cast<const float*>(data));
    return true;
}
// Of one key alone.
AI_API AtArray* AiArrayConvert(std::uint32_t elements, std::uint8_t keys, std::uint8_t type,
                               const void* data) {
    AtArray* array = AiArrayAllocate(elements, keys, type);
    AiArraySetKey(array, 0, data);
    return array;
}
AI_API AtMatrix AiM4Translation(const AtVector& by) {
    return {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {by.x, by.y, by.z, 1}}};
}

struct AtNodeMethods {
    void (*Parameters)(AtList*, AtNodeEntry*);
    int (*Init)(AtNode*, void**);
    int (*Cleanup)(const AtNode*, void*);
    int (*NumNodes)(const AtNode*, void*);
    AtNode* (*GetNode)(const AtNode*, void*, int);
};
struct AtNodeLib {
    int node_type;
    std::uint8_t output_type;
    const char* name;
    const AtNodeMethods* methods;
    char version[AI_MAXSIZE_VERSION];
};

#define node_parameters static void Parameters(AtList* params, AtNodeEntry* nentry)
#define procedural_init static int ProceduralInit(AtNode* node, void** user_ptr)
#define procedural_cleanup static int ProceduralCleanup(const AtNode* node, void* user_ptr)
#define procedural_num_nodes static int ProceduralNumNodes(const AtNode* node, void* user_ptr)
#define procedural_get_node static AtNode* ProceduralGetNode(const AtNode* node, void* user_ptr, int i)
#define node_loader AI_EXPORT_LIB bool NodeLoader(int i, AtNodeLib* node)
#define AI_PROCEDURAL_NODE_EXPORT_METHODS(tag)                                                     \
    node_parameters;                                                                               \
    procedural_init;                                                                               \
    procedural_cleanup;                                                                            \
    procedural_num_nodes;                                                                          \
    procedural_get_node;                                                                           \
    static const AtNodeMethods tag##_of_stand_in = {Parameters, ProceduralInit, ProceduralCleanup, \
                                                    ProceduralNumNodes, ProceduralGetNode};        \
    static const AtNodeMethods* tag = &tag##_of_stand_in
#define AiParameterStr(name, value) params->node->strings[name] = value
#define AiParameterFlt(name, value) params->node->numbers[name] = static_cast<double>(value)
#define AiParameterInt(name, value) params->node->numbers[name] = value
