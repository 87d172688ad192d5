// A stand-in for RenderMan's ri.h, prmanapi.h and RixInterfaces.h, to compile and try examples/renderers/renderman.cpp without RenderMan: the
// declarations that it uses, written by us from public documentation, and a host that keeps what it is handed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#define PRMANEXPORT __attribute__((visibility("default")))

typedef void RtVoid;
typedef int RtInt;
typedef float RtFloat;
typedef RtFloat RtMatrix[4][4];
typedef char const* RtToken;
typedef char const* RtString;
typedef void* RtPointer;
typedef void* RtContextHandle;

enum RixInterfaceId { k_RixMessages };

// What the host has been handed, until it is cleared.
struct RenderManStandIn {
    struct Polygons {
        std::vector<int> corners{}, indices{};
        std::map<std::string, std::vector<float>> values{};  // by their whole token
    };
    std::vector<std::string> calls{}, log{};
    std::vector<Polygons> polygons{};
    std::vector<float> times{};
    std::array<float, 3> translation{};
};
inline RenderManStandIn& renderman_stand_in() {
    static RenderManStandIn host;
    return host;
}

class RixInterface {
  public:
    virtual ~RixInterface() = default;
};
class RixMessages : public RixInterface {
  public:
    virtual void Error(const char* format, ...) {
        va_list words;
        va_start(words, format);
        keep(format, words);
        va_end(words);
    }
    virtual void Warning(const char* format, ...) {
        va_list words;
        va_start(words, format);
        keep(format, words);
        va_end(words);
    }

  private:
    static void keep(const char* format, va_list words) {
        char text[4096];
        std::vsnprintf(text, sizeof text, format, words);
        renderman_stand_in().log.emplace_back(text);
    }
};
class RixContext {
  public:
    virtual ~RixContext() = default;
    virtual RixInterface* GetRixInterface(RixInterfaceId) { return &messages_; }

  private:
    RixMessages messages_;
};
inline RixContext* RixGetContext() {
    static RixContext context;
    return &context;
}

inline RtVoid RiAttributeBegin() {
    renderman_stand_in().calls.emplace_back("AttributeBegin");
}
inline RtVoid RiAttributeEnd() {
    renderman_stand_in().calls.emplace_back("AttributeEnd");
}
inline RtVoid RiConcatTransform(RtMatrix transform) {
    renderman_stand_in().calls.emplace_back("ConcatTransform");
    for (std::size_t axis = 0; axis < 3; ++axis) renderman_stand_in().translation[axis] = transform[3][axis];
}
inline RtVoid RiMotionBeginV(RtInt count, RtFloat times[]) {
    renderman_stand_in().calls.emplace_back("MotionBegin");
    renderman_stand_in().times.assign(times, times + count);
}
inline RtVoid RiMotionEnd() {
    renderman_stand_in().calls.emplace_back("MotionEnd");
}
inline RtVoid RiPointsPolygonsV(RtInt faces, RtInt corners[], RtInt indices[], RtInt count, RtToken tokens[],
                                RtPointer values[]) {
    RenderManStandIn& host = renderman_stand_in();
    host.calls.emplace_back("PointsPolygons");
    host.polygons.emplace_back();
    RenderManStandIn::Polygons& given = host.polygons.back();
    given.corners.assign(corners, corners + faces);
    std::size_t of_all = 0;
    for (const int each : given.corners) of_all += static_cast<std::size_t>(each);
    given.indices.assign(indices, indices + of_all);
    std::size_t points = 0;
    for (const int each : given.indices) points = std::max(points, static_cast<std::size_t>(each) + 1);
    const std::map<std::string, std::size_t> components = {
        {"P", 3}, {"N", 3}, {"vertex float[3] slopeVariance", 3}, {"vertex float whitecapCoverage", 1}};
    for (RtInt i = 0; i < count; ++i) {
        const auto* first = static_cast<const float*>(values[i]);
        given.values[tokens[i]].assign(first, first + points * components.at(tokens[i]));
    }
}
