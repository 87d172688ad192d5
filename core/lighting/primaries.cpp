#include "core/lighting/primaries.h"

#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace pelagic {
namespace {

glm::dvec3 xyz_of(glm::dvec2 xy) {
    return {xy.x / xy.y, 1.0, (1.0 - xy.x - xy.y) / xy.y};
}

// Each primary by as much as makes them white together. Written without the division by y, which may be 0.
glm::dmat3 xyz_of_rgb(const Primaries& of) {
    const auto column = [](glm::dvec2 xy) { return glm::dvec3(xy, 1.0 - xy.x - xy.y); };
    const glm::dmat3 each(column(of.red), column(of.green), column(of.blue));
    const glm::dvec3 parts = glm::inverse(each) * xyz_of(of.white);
    return {each[0] * parts.x, each[1] * parts.y, each[2] * parts.z};
}

}  // namespace

glm::dmat3 bradford() {
    // Written by rows.
    return glm::transpose(
        glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
}

glm::dmat3 conversion(const Primaries& from, const Primaries& to) {
    const glm::dvec3 gain = bradford() * xyz_of(to.white) / (bradford() * xyz_of(from.white));
    glm::dmat3 adapted(0.0);
    for (int i = 0; i < 3; ++i) adapted[i][i] = gain[i];
    return glm::inverse(xyz_of_rgb(to)) * glm::inverse(bradford()) * adapted * bradford() * xyz_of_rgb(from);
}

}  // namespace pelagic
