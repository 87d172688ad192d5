// See page.h.
#include "plugin/format/usd/page.h"

#include <cmath>
#include <stdexcept>

#include "plugin/format/usd/layers.h"

namespace pelagic::usd {

namespace {

std::string rate(double fps) {
    check_rate(fps);
    return number(fps);
}

}  // namespace

std::string real(std::string_view name, double value) {
    if (!std::isfinite(value)) {
        throw std::invalid_argument("USD: " + std::string(name) + " must be a finite number");
    }
    return number(value == 0.0 ? 0.0 : value);
}

std::string real32(std::string_view name, double value) {
    const auto single = static_cast<float>(value);
    real(name, single);
    return number(single == 0.0f ? 0.0f : single);
}

std::string color(std::string_view name, const glm::vec3& value) {
    std::string text = "(";
    for (int i = 0; i < 3; ++i) {
        real(name, value[i]);  // only to check it: as a float it prints with fewer digits
        text += number(value[i]);
        text += i < 2 ? ", " : ")";
    }
    return text;
}

void write_head(Page& page, const LayerHead& head) {
    const std::string fps = rate(head.fps);
    page.line({"defaultPrim = \"", head.default_prim, "\""});
    page.line({"endTimeCode = ", number(head.last_frame)});
    page.line({"framesPerSecond = ", fps});
    page.line({"metersPerUnit = 1"});
    page.line({"startTimeCode = ", number(head.first_frame)});
    page.line({"timeCodesPerSecond = ", fps});
    page.line({"upAxis = \"Z\""});
}

void write_timeless_head(Page& page, double fps) {
    const std::string text = rate(fps);
    page.open({"("});
    page.line({"defaultPrim = \"", kMeshName, "\""});
    page.line({"framesPerSecond = ", text});
    page.line({"metersPerUnit = 1"});
    page.line({"timeCodesPerSecond = ", text});
    page.line({"upAxis = \"Z\""});
    page.close(")");
}

}  // namespace pelagic::usd
