// Cages and bodies as OBJ: a cage with a limit surface that can be meshed, a body whose mesh is whole, or a refusal.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "core/scene/limits.h"
#include "core/surface/cage_limit.h"
#include "plugin/format/obj/object_obj.h"
#include "tests/fuzz/fuzz.h"

using namespace pelagic;
using fuzz::hold;

namespace {

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The limit surface stays within the box of the cage's points: its weights are a mean's.
void expect_in_box(const CageMesh& mesh, const std::vector<glm::dvec3>& places_m) {
    glm::dvec3 least(mesh.points_m.front()), most(least);
    for (const glm::dvec3& point : mesh.points_m)
        least = glm::min(least, point), most = glm::max(most, point);
    const double slack_m = 1e-9 * (1.0 + glm::length(most - least) + glm::length(most) + glm::length(least));
    for (const glm::dvec3& place : places_m)
        for (int axis = 0; axis < 3; ++axis)
            hold(place[axis] >= least[axis] - slack_m && place[axis] <= most[axis] + slack_m,
                 "the limit surface lies within the box of the points");
}

void expect_meshed(const Cage& cage, const CageLimit& limit, int segments) {
    const CageRates rates = limit.uniform_rates(segments);
    const CageMeshing meshing = limit.mesh(rates);
    hold(meshing.points == limit.count_points(rates), "as many points as are counted");
    const auto points = static_cast<std::int32_t>(meshing.points);
    std::size_t corners = 0;
    for (const std::int32_t count : meshing.faces.counts) {
        hold(count == 3 || count == 4, "faces have three or four corners");
        corners += static_cast<std::size_t>(count);
    }
    hold(corners == meshing.faces.indices.size(), "as many indices as corners");
    for (const std::int32_t index : meshing.faces.indices)
        hold(index >= 0 && index < points, "corners are points");
    std::vector<glm::dvec3> places, normals, again, normals_again;
    limit.place(meshing, cage.mesh().points_m, places, normals);
    hold(places.size() == meshing.points && normals.size() == meshing.points, "a place and a normal a point");
    for (const glm::dvec3& place : places) hold(is_finite(place), "places are finite");
    for (const glm::dvec3& normal : normals)
        hold(is_finite(normal) && std::abs(glm::length(normal) - 1.0) < 1e-6, "normals are of length 1");
    expect_in_box(cage.mesh(), places);
    CageLimit::place(meshing, limit.stencils(meshing), cage.mesh().points_m, again, normals_again);
    hold(again.size() == places.size() && normals_again.size() == normals.size(),
         "stencils give as many points");
    for (std::size_t i = 0; i < places.size(); ++i)
        hold(is_finite(again[i]) && is_finite(normals_again[i]), "stencils give finite points");
}

}  // namespace

// ObjectMesh itself refuses what isn't whole, in no words of a file's. The bytes are its materials, too.
void expect_body(std::string_view text) {
    try {
        const ObjectMesh body = parse_object_obj(
            text, "fuzz.obj", [&](const std::string&) { return std::string(text); },
            [](const std::string& file, std::size_t) {
                if (file.size() > 8) throw PictureRefused{"is too long", "a short name"};
                return std::make_shared<const ObjectImage>(1, 1,
                                                           std::vector<std::uint16_t>{0x3c00, 0, 0x3800});
            });
        hold(body.data().triangles.size() >= 3, "a body has a triangle");
    } catch (const ObjError& error) {
        hold(!error.problem().empty() && !error.accepted().empty(), "a refusal says why", error.what());
    }
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    expect_body({reinterpret_cast<const char*>(data), size});
    constexpr std::size_t kMostFaces = 100;  // for time
    try {
        const Cage cage = parse_obj({reinterpret_cast<const char*>(data), size}, "fuzz.obj");
        if (cage.mesh().face_counts.size() > kMostFaces) return 0;
        const CageLimit limit(cage.mesh());
        for (const int segments : {1, 2}) expect_meshed(cage, limit, segments);
    } catch (const ObjError& error) {
        hold(!error.problem().empty() && !error.accepted().empty(), "a refusal says why", error.what());
        hold(std::string_view(error.what()).starts_with("fuzz.obj:"), "a refusal names the file",
             error.what());
    }
    return 0;
}
