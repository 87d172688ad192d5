#include "plugin/format/usd/read_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "plugin/format/usd/crate_layer.h"

namespace pelagic::usd {
namespace {

using Node = CrateLayer::Node;

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::dmat4 moved(const glm::dvec3& by) {
    glm::dmat4 made(1.0);
    made[3] = glm::dvec4(by, 1.0);
    return made;
}
glm::dmat4 scaled(const glm::dvec3& by) {
    glm::dmat4 made(1.0);
    for (int i = 0; i < 3; ++i) made[i][i] = by[i];
    return made;
}
glm::dmat4 turned(char axis, double angle_deg) {
    const double angle = angle_deg * std::numbers::pi / 180.0, c = std::cos(angle), s = std::sin(angle);
    glm::dmat4 made(1.0);
    const int a = axis == 'X' ? 1 : axis == 'Y' ? 2 : 0, b = (a + 1) % 3;
    made[a][a] = made[b][b] = c;
    made[a][b] = s;
    made[b][a] = -s;
    return made;
}

class BodyReader {
  public:
    BodyReader(std::string_view bytes, std::size_t most_corners) : layer_(bytes), most_(most_corners) {}

    Body read() {
        const auto units = layer_.number(0, "metersPerUnit").value_or(0.01);
        if (!(units > 0.0) || !std::isfinite(units)) throw ReadError("has a metersPerUnit that is no length");
        glm::dmat4 from = scaled(glm::dvec3(units));
        const auto up = layer_.token(0, "upAxis").value_or("Y");
        if (up != "Y" && up != "Z") throw ReadError("has the upAxis '" + std::string(up) + '\'');
        if (up == "Y") from = turned('X', 90.0) * from;
        if (layer_.has(0, "subLayers")) remark("layers below it are passed over");
        for (const Node prim : layer_.prims_of(0)) walk(prim, {.from = from}, 0);
        for (const auto& [what, prims] : remarks_)
            body_.notes.push_back(prims.empty() ? what : what + ": " + prims);
        if (body_.meshes.empty())
            throw ReadError("has no mesh that is read" +
                            (body_.notes.empty() ? std::string() : " (" + body_.notes.front() + ')'));
        return std::move(body_);
    }

  private:
    struct Place {
        glm::dmat4 from{1.0};
        bool is_seen = true;  // of a purpose that is rendered
    };

    void remark(const std::string& what, std::string_view prim = {}) {
        constexpr std::size_t kMost = 60;  // a few names
        std::string& names = remarks_[what];
        if (prim.empty() || names.ends_with(" …")) return;
        if (names.size() > kMost)
            names += " …";
        else
            names += (names.empty() ? "" : ", ") + std::string(prim.substr(0, kMost));
    }

    void walk(Node prim, Place place, int depth) {
        constexpr int kDeepest = 500;
        if (depth > kDeepest) throw ReadError("has prims too deep in each other");
        constexpr double kDef = 0.0;
        if (layer_.number(prim, "specifier").value_or(1.0) != kDef)
            return;  // classes, and what changes another layer's
        if (layer_.number(prim, "active").value_or(1.0) == 0.0) return;
        if (const auto shown = layer_.property(prim, "visibility");
            shown && layer_.token(*shown, "default").value_or("inherited") == "invisible")
            return;
        if (const auto purpose = layer_.property(prim, "purpose")) {
            const std::string_view is = layer_.token(*purpose, "default").value_or("default");
            if (is == "proxy" || is == "guide") place.is_seen = false;
            if (is == "render") place.is_seen = true;
        }
        for (const char* arc : {"references", "payload", "inheritPaths", "specializes", "variantSetNames"})
            if (layer_.has(prim, arc))
                remark("references, payloads, classes and variants are passed over", layer_.name(prim));
        transform(prim, place.from);
        const std::string_view type = layer_.token(prim, "typeName").value_or("");
        if (type == "Mesh" && place.is_seen) add_mesh(prim, place.from);
        constexpr std::array<std::string_view, 12> kShapes{
            "PointInstancer", "Cube",        "Sphere",      "Cylinder",   "Cone",   "Capsule",
            "Plane",          "BasisCurves", "NurbsCurves", "NurbsPatch", "Points", "Volume"};
        if (place.is_seen && std::ranges::find(kShapes, type) != kShapes.end()) {
            remark("of shapes, meshes alone are read; passed over", layer_.name(prim));
            return;  // what an instancer has below it is drawn by it alone
        }
        if (type == "Material") return;
        for (const Node child : layer_.prims_of(prim)) walk(child, place, depth + 1);
    }

    // xformOpOrder: the last is applied first.
    void transform(Node prim, glm::dmat4& from) {
        const auto order = layer_.property(prim, "xformOpOrder");
        if (!order) return;
        const auto ops = layer_.tokens(*order, "default").value_or(std::vector<std::string_view>());
        for (std::string_view op : ops) {
            if (op == "!resetXformStack!") {
                remark("'!resetXformStack!' is passed over", layer_.name(prim));
                continue;
            }
            constexpr std::string_view kInvert = "!invert!", kOp = "xformOp:";
            const bool is_inverse = op.starts_with(kInvert);
            if (is_inverse) op.remove_prefix(kInvert.size());
            const auto at = layer_.property(prim, op);
            if (!op.starts_with(kOp) || !at)
                throw ReadError("has the transform '" + std::string(op) + "', which isn't there");
            std::string_view kind = op.substr(kOp.size());
            kind = kind.substr(0, kind.find(':'));
            const std::optional<glm::dmat4> one = transform_of(*at, kind);
            if (!one) {
                if (!layer_.has(*at, "timeSamples"))
                    throw ReadError("has the transform '" + std::string(op) + "', which isn't read");
                remark("what moves stands where it has a default value, or at its parent", layer_.name(prim));
                continue;
            }
            from = from * (is_inverse ? glm::inverse(*one) : *one);
        }
        for (int i = 0; i < 4; ++i)
            if (!is_finite(glm::dvec3(from[i]))) throw ReadError("has a transform that isn't finite");
    }

    std::optional<glm::dmat4> transform_of(Node at, std::string_view kind) const {
        if (kind == "transform") return layer_.matrix(at, "default");
        if (kind == "orient") {
            const auto q = layer_.quaternion(at, "default");
            if (!q) return std::nullopt;
            const glm::dquat turn((*q)[3], (*q)[0], (*q)[1], (*q)[2]);
            const double size = glm::length(turn);
            return size > 0.0 ? glm::mat4_cast(turn / size) : glm::dmat4(1.0);
        }
        if (kind == "translate" || kind == "scale") {
            const auto by = layer_.vector(at, "default");
            if (!by) return std::nullopt;
            return kind == "scale" ? scaled(*by) : moved(*by);
        }
        if (!kind.starts_with("rotate")) return std::nullopt;
        kind.remove_prefix(6);
        if (kind.size() == 1 && kind[0] >= 'X' && kind[0] <= 'Z') {
            const auto angle = layer_.number(at, "default");
            if (!angle) return std::nullopt;
            return turned(kind[0], *angle);
        }
        const auto angles = layer_.vector(at, "default");
        if (!angles || kind.size() != 3) return std::nullopt;
        glm::dmat4 made(1.0);  // XYZ: x first
        for (const char axis : kind) {
            if (axis < 'X' || axis > 'Z') return std::nullopt;
            made = turned(axis, (*angles)[axis - 'X']) * made;
        }
        return made;
    }

    void add_mesh(Node prim, const glm::dmat4& from) {
        const std::string name(layer_.name(prim));
        const auto array = [&](const char* property, const auto& get) -> decltype(get(Node{})) {
            const auto at = layer_.property(prim, property);
            return at ? get(*at) : std::nullopt;
        };
        const auto integers = [&](Node at) { return layer_.integers(at, "default", most_ - corners_); };
        const auto vectors = [&](Node at) { return layer_.vectors(at, "default", most_); };
        const auto points = array("points", vectors);
        auto counts = array("faceVertexCounts", integers), indices = array("faceVertexIndices", integers);
        if (!points || !counts || !indices) {
            const bool moves = std::ranges::any_of(
                std::array{"points", "faceVertexCounts", "faceVertexIndices"}, [&](const char* each) {
                    const auto at = layer_.property(prim, each);
                    return at && layer_.has(*at, "timeSamples");
                });
            remark(moves ? "meshes that have time samples and no default value are passed over"
                         : "meshes without points or faces are passed over",
                   name);
            return;
        }
        if (points->size() > most_ - points_) throw ReadError("has more points than a body may have");
        points_ += points->size();
        corners_ += indices->size();
        const auto refuse = [&](const char* what) { throw ReadError("has a mesh '" + name + "' " + what); };
        std::int64_t corners = 0;
        for (const std::int32_t count : *counts) {
            if (count < 0) refuse("with a face of fewer than no corners");
            corners += count;
        }
        if (corners != static_cast<std::int64_t>(indices->size()))
            refuse("whose faces have another number of corners than it has indices");
        for (const std::int32_t index : *indices)
            if (index < 0 || static_cast<std::size_t>(index) >= points->size())
                refuse("with a corner whose point isn't there");
        const glm::dmat3 linear(from);
        const double size = glm::determinant(linear);
        if (size == 0.0) return remark("meshes that are scaled to nothing are passed over", name);

        BodyMesh& mesh = body_.meshes.emplace_back();
        for (const glm::vec3& point : *points) {
            mesh.points_m.emplace_back(from * glm::dvec4(glm::dvec3(point), 1.0));
            if (!is_finite(mesh.points_m.back())) refuse("with a point that isn't finite");
        }
        const auto scheme = layer_.property(prim, "subdivisionScheme");
        const bool is_plain = scheme && layer_.token(*scheme, "default").value_or("catmullClark") == "none";
        if (!is_plain)
            remark("subdivision is passed over, these are their cages", name);
        else
            set_normals(prim, mesh, *points, *counts, *indices, glm::transpose(glm::inverse(linear)));
        for (glm::dvec3& normal : mesh.normals)
            if (!is_finite(normal)) refuse("with a normal that isn't finite");
        if (const auto holes = array("holeIndices", integers); holes && !holes->empty())
            remark("holes are passed over, these are closed", name);

        // Seen from outside.
        const auto orientation = layer_.property(prim, "orientation");
        const bool is_left =
            orientation && layer_.token(*orientation, "default").value_or("") == "leftHanded";
        if (is_left != (size < 0.0)) {
            std::size_t first = 0;
            for (const std::int32_t count : *counts) {
                const auto range = [&](auto& list) {
                    std::reverse(list.begin() + static_cast<std::ptrdiff_t>(first),
                                 list.begin() + static_cast<std::ptrdiff_t>(first) + count);
                };
                range(*indices);
                if (!mesh.normals.empty()) range(mesh.normals);
                first += static_cast<std::size_t>(count);
            }
        }
        mesh.counts = std::move(*counts);
        mesh.indices = std::move(*indices);
        set_colour(prim, mesh, name);
    }

    // By their interpolation; those that don't fit are passed over.
    void set_normals(Node prim, BodyMesh& mesh, const std::vector<glm::vec3>& points,
                     const std::vector<std::int32_t>& counts, const std::vector<std::int32_t>& indices,
                     const glm::dmat3& turn) {
        auto at = layer_.property(prim, "primvars:normals");
        const bool is_primvar = at && layer_.has(*at, "default");
        if (!is_primvar) at = layer_.property(prim, "normals");
        if (!at) return;
        auto normals = layer_.vectors(*at, "default", most_);
        if (!normals || normals->empty()) return;
        if (const auto to = layer_.property(prim, "primvars:normals:indices"); is_primvar && to) {
            const auto which = layer_.integers(*to, "default", most_);
            if (!which) return;
            std::vector<glm::vec3> chosen;
            for (const std::int32_t index : *which) {
                if (index < 0 || static_cast<std::size_t>(index) >= normals->size())
                    throw ReadError("has a normal that isn't there");
                chosen.push_back((*normals)[static_cast<std::size_t>(index)]);
            }
            normals = std::move(chosen);
        }
        const std::string_view how = layer_.token(*at, "interpolation").value_or("vertex");
        const std::size_t wanted = how == "faceVarying" ? indices.size()
                                   : how == "uniform"   ? counts.size()
                                   : how == "constant"  ? 1
                                                        : points.size();
        if (normals->size() != wanted)
            return remark("normals that don't fit their mesh are passed over", layer_.name(prim));
        std::size_t corner = 0;
        for (std::size_t face = 0; face < counts.size(); ++face)
            for (std::int32_t i = 0; i < counts[face]; ++i, ++corner) {
                const std::size_t which = how == "faceVarying" ? corner
                                          : how == "uniform"   ? face
                                          : how == "constant"  ? 0
                                                               : static_cast<std::size_t>(indices[corner]);
                mesh.normals.push_back(turn * glm::dvec3((*normals)[which]));
            }
    }

    void set_colour(Node prim, BodyMesh& mesh, const std::string& name) {
        const auto at = layer_.property(prim, "primvars:displayColor");
        const auto colours = at ? layer_.vectors(*at, "default", most_) : std::nullopt;
        if (!colours || colours->empty()) {
            if (layer_.property(prim, "material:binding"))
                remark("materials are passed over: without displayColor these are grey", name);
            return;
        }
        glm::dvec3 sum(0.0);
        for (const glm::vec3& colour : *colours) sum += glm::dvec3(colour);
        const glm::dvec3 mean = sum / static_cast<double>(colours->size());
        if (!is_finite(mean)) throw ReadError("has a mesh '" + name + "' with a colour that isn't finite");
        mesh.colour = glm::clamp(mean, glm::dvec3(0.0), glm::dvec3(1.0));
        if (colours->size() > 1) remark("of several display colours the mean counts", name);
    }

    CrateLayer layer_;
    std::size_t most_, corners_ = 0, points_ = 0;
    Body body_;
    std::map<std::string, std::string> remarks_;
};

}  // namespace

Body read_body(std::string_view bytes, std::size_t most_corners) {
    if (!bytes.starts_with(kCrateMagic)) {
        if (bytes.starts_with("#usda")) throw ReadError("is USD as text, which isn't read");
        throw ReadError("is no crate of USD");
    }
    return BodyReader(bytes, most_corners).read();
}

}  // namespace pelagic::usd
