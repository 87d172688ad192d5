#include "plugin/format/obj/object_obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <set>

#include "core/base/constants.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "plugin/format/obj/lines.h"

namespace pelagic {
namespace {

using obj::Refused, obj::Words, obj::quoted, obj::number_of, obj::index_of;

constexpr const char* kObjectLines =
    "v, vn, f, s, usemtl, mtllib, and vt, o, g, l, p and #, which are passed over: polygons";
constexpr std::array<std::string_view, 15> kPassedOver{
    "o",        "g",   "l",          "p",         "t",      "mg",     "bevel", "c_interp",
    "d_interp", "lod", "shadow_obj", "trace_obj", "usemap", "maplib", "vp"};

std::string joined(const Words& words) {  // a name may have spaces
    std::string out;
    for (std::size_t i = 1; i < words.size(); ++i) out += (i > 1 ? " " : "") + std::string(words[i]);
    return out;
}

// "a", "b", "c" and 4 more.
std::string names_text(const std::vector<std::string>& names) {
    constexpr std::size_t kSaid = 3;
    std::string out;
    for (std::size_t i = 0; i < std::min(kSaid, names.size()); ++i) out += (i > 0 ? ", " : "") + names[i];
    return names.size() > kSaid ? out + " and " + std::to_string(names.size() - kSaid) + " more" : out;
}

// ---- Materials

struct FileMaterial {
    ObjectMaterial material;
    glm::dvec3 emission{0.0};
    std::string picture;  // the first line that names one
    bool is_transparent = false, has_roughness = false;
};

class MaterialReader {
  public:
    std::map<std::string, FileMaterial> materials;

    void read(std::string_view text, const std::string& name) {
        obj::Lines lines(text);
        FileMaterial* of = nullptr;
        for (Words words; lines.next(words);) try {
                if (words.empty()) continue;
                if (words[0] == "newmtl") {
                    // The first of a name counts: it may stand in two files.
                    const auto [at, is_new] = materials.try_emplace(joined(words));
                    of = is_new ? &at->second : nullptr;
                    at->second.material.name = at->first;
                } else if (of) {
                    take(*of, words);
                }
            } catch (const Refused& refused) {
                throw ObjError(name + ':' + std::to_string(lines.line()) + ": " + refused.problem,
                               refused.accepted);
            }
    }

  private:
    static double number(const Words& words) {
        if (words.size() != 2)
            throw Refused{quoted(words[0]) + " has " + std::to_string(words.size() - 1) + " numbers", "one"};
        return number_of(words[1]);
    }
    // One number stands for three. Spectra and CIE XYZ are left out.
    static std::optional<glm::dvec3> colour(const Words& words) {
        if (words.size() > 1 && (words[1] == "spectral" || words[1] == "xyz")) return std::nullopt;
        if (words.size() != 2 && words.size() != 4)
            throw Refused{quoted(words[0]) + " has " + std::to_string(words.size() - 1) + " numbers",
                          "three, linear Rec. 709"};
        const auto at = [&](std::size_t i) { return number_of(words[words.size() == 2 ? 1 : i]); };
        return glm::dvec3(at(1), at(2), at(3));
    }

    static void take(FileMaterial& of, const Words& words) {
        const std::string_view kind = words[0];
        if (kind == "Kd") {
            if (const auto read = colour(words))
                of.material.colour = glm::vec3(glm::clamp(*read, glm::dvec3(0.0), glm::dvec3(1.0)));
        } else if (kind == "Ke") {
            if (const auto read = colour(words)) of.emission = glm::max(*read, glm::dvec3(0.0));
        } else if (kind == "Pr") {
            of.has_roughness = true;
            of.material.roughness = static_cast<float>(std::clamp(number(words), 0.0, 1.0));
        } else if (kind == "Ns") {
            if (!of.has_roughness)
                of.material.roughness =
                    static_cast<float>(1.0 - std::sqrt(std::clamp(number(words) / 1000.0, 0.0, 1.0)));
        } else if (kind == "d" || kind == "Tr") {
            const double value = words.size() == 2 ? number(words) : kind == "d" ? 1.0 : 0.0;
            if (value != (kind == "d" ? 1.0 : 0.0)) of.is_transparent = true;
        } else if (kind.starts_with("map_") || kind == "bump" || kind == "norm" || kind == "disp" ||
                   kind == "decal" || kind == "refl") {
            if (of.picture.empty()) of.picture = std::string(kind) + ' ' + joined(words);
        }
    }
};

// ---- Faces into triangles

// Cuts a polygon's corners, in the plane that it is best seen in, counter-clockwise, into triangles. Where none can be cut off (it
// meets itself) one is all the same.
class Ears {
  public:
    template <class Take>
    void cut(const std::vector<glm::dvec2>& at, const Take& take) {
        at_ = &at;
        left_.resize(at.size());
        std::iota(left_.begin(), left_.end(), std::size_t{0});
        reflex_.clear();
        for (std::size_t i = 0; i < at.size(); ++i)
            if (turn(before(i), i, after(i)) < 0.0) reflex_.push_back(i);
        std::size_t i = 0, tried = 0;
        while (left_.size() > 3) {
            const std::size_t a = before(i), b = i, c = after(i);
            if (tried < left_.size() && !is_ear(left_[a], left_[b], left_[c])) {
                i = c, ++tried;
                continue;
            }
            take(left_[a], left_[b], left_[c]);
            left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(b));
            tried = 0;
            i = b % left_.size();
        }
        take(left_[0], left_[1], left_[2]);
    }

  private:
    std::size_t before(std::size_t i) const { return (i + left_.size() - 1) % left_.size(); }
    std::size_t after(std::size_t i) const { return (i + 1) % left_.size(); }
    double turn(std::size_t a, std::size_t b, std::size_t c) const {
        const glm::dvec2 u = (*at_)[b] - (*at_)[a], v = (*at_)[c] - (*at_)[a];
        return u.x * v.y - u.y * v.x;
    }
    bool is_ear(std::size_t a, std::size_t b, std::size_t c) const {
        if (!(turn(a, b, c) > 0.0)) return false;
        // A corner that lies on one of these is a bridge's to a hole.
        const auto is_one = [&](std::size_t i) {
            const glm::dvec2 p = (*at_)[i];
            return p == (*at_)[a] || p == (*at_)[b] || p == (*at_)[c];
        };
        return std::ranges::none_of(reflex_, [&](std::size_t i) {
            return !is_one(i) && turn(a, b, i) >= 0.0 && turn(b, c, i) >= 0.0 && turn(c, a, i) >= 0.0;
        });
    }

    const std::vector<glm::dvec2>* at_ = nullptr;
    std::vector<std::size_t> left_, reflex_;
};

class ObjectParser {
  public:
    ObjectParser(std::string_view text, const std::string& name, const MaterialText& material_text)
        : lines_(text), name_(name), material_text_(material_text) {}

    ObjectMesh parse() {
        Words words;
        while (lines_.next(words)) try {
                if (!words.empty()) take(words);
            } catch (const Refused& refused) {
                throw ObjError(name_ + ':' + std::to_string(lines_.line()) + ": " + refused.problem,
                               refused.accepted);
            }
        if (faces_.empty()) throw ObjError(name_ + " has no faces", kObjectLines);
        set_materials();
        set_normals_of_faces();
        find_faces_of_points();
        for (const Face& face : faces_) add_triangles(face);
        if (mesh_.triangles.empty())
            throw ObjError(name_ + " has no face with an area", "at least one with an area");
        return ObjectMesh(std::move(mesh_), std::move(notes_));
    }

  private:
    static constexpr std::int32_t kNoNormal = -1;
    static constexpr std::int64_t kFlat = 0, kUnsaid = -1;

    struct Corner {
        std::uint32_t point;
        std::int32_t normal;  // into normals_
    };
    struct Face {
        std::size_t first;  // its corners, up to the next face's
        std::size_t count;
        std::int64_t group;
        std::uint16_t material;
        glm::dvec3 normal{0.0};  // of no length: it has no area
    };

    void take(const Words& words) {
        const std::string_view kind = words.front();
        if (kind == "v") {
            take_point(words);
        } else if (kind == "vt") {
            ++textures_;
        } else if (kind == "vn") {
            take_normal(words);
        } else if (kind == "f") {
            take_face(words);
        } else if (kind == "s") {
            group_ = words.size() < 2 || words[1] == "off"
                         ? kFlat
                         : obj::integer_of(words[1], "s and a number, or s off");
        } else if (kind == "usemtl") {
            material_ = material_of(joined(words));
        } else if (kind == "mtllib") {
            take_library(words);
        } else if (std::ranges::find(kPassedOver, kind) == kPassedOver.end()) {
            throw Refused{quoted(kind) + " begins no line that is known", kObjectLines};
        }
    }

    void take_point(const Words& words) {
        const glm::dvec3 point_m = obj::point_of(words);
        for (int axis = 0; axis < 3; ++axis)
            if (!limits::kObjectPoint_m.holds(point_m[axis]))
                throw Refused{"the point is outside the range", text_of(limits::kObjectPoint_m) + " m"};
        if (mesh_.points_m.size() == limits::kObjectTriangles)
            throw Refused{"there are too many points", "at most " + std::to_string(limits::kObjectTriangles)};
        mesh_.points_m.emplace_back(point_m);
    }

    void take_normal(const Words& words) {
        if (words.size() != 4)
            throw Refused{"a normal has " + std::to_string(words.size() - 1) + " numbers", "three"};
        if (normals_.size() == 3 * limits::kObjectTriangles)
            throw Refused{"there are too many normals",
                          "at most " + std::to_string(3 * limits::kObjectTriangles)};
        glm::dvec3 normal(number_of(words[1]), number_of(words[2]), number_of(words[3]));
        // By its largest part first: squares of very long ones would be infinite.
        const double largest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
        normals_.emplace_back(largest > 0.0 ? glm::normalize(normal / largest) : normal);
    }

    void take_face(const Words& words) {
        const std::size_t count = words.size() - 1;
        if (count < 3 || count > limits::kObjectCorners)
            throw Refused{"the face has " + std::to_string(count) + (count == 1 ? " corner" : " corners"),
                          "3 … " + std::to_string(limits::kObjectCorners) + " corners"};
        triangles_ += count - 2;
        if (triangles_ > limits::kObjectTriangles)
            throw Refused{"there are too many triangles",
                          "at most " + std::to_string(limits::kObjectTriangles)};
        if (!material_) material_ = material_of("");
        faces_.push_back({corners_.size(), count, group_, *material_});
        for (std::size_t i = 1; i <= count; ++i) {
            const auto parts = obj::corner_parts(words[i]);
            Corner corner{static_cast<std::uint32_t>(index_of(parts[0], mesh_.points_m.size(), "point")),
                          kNoNormal};
            if (!parts[1].empty()) index_of(parts[1], textures_, "texture coordinate");
            if (!parts[2].empty()) corner.normal = index_of(parts[2], normals_.size(), "normal");
            corners_.push_back(corner);
        }
    }

    // ---- Materials

    std::uint16_t material_of(const std::string& name) {
        const auto [at, is_new] = materials_.try_emplace(name, static_cast<std::uint16_t>(materials_.size()));
        if (is_new && materials_.size() > limits::kObjectMaterials)
            throw Refused{"there are too many materials",
                          "at most " + std::to_string(limits::kObjectMaterials)};
        return at->second;
    }

    // A name may have spaces in it, or there are several.
    void take_library(const Words& words) {
        std::vector<std::string> files{joined(words)};
        std::optional<std::string> text = files[0].empty() ? std::nullopt : material_text_(files[0]);
        if (!text && words.size() > 2) files.assign(words.begin() + 1, words.end());
        for (const std::string& file : files) {
            if (!text) text = material_text_(file);
            if (text)
                libraries_.read(*text, line_text(file));
            else
                notes_.push_back(quoted_text(shortened(file)) + ", which has its materials, can't be read");
            text.reset();
            has_library_ = true;
        }
    }

    void set_materials() {
        std::vector<std::string> missing, pictures, transparent;
        std::vector<glm::dvec3> emissions(materials_.size());
        double brightest = 1.0;
        mesh_.materials.resize(materials_.size());
        for (const auto& [name, index] : materials_) {
            ObjectMaterial& material = mesh_.materials[index];
            material.name = name.empty() ? "grey" : name;
            const auto found = libraries_.materials.find(name);
            if (found == libraries_.materials.end()) {
                if (!name.empty()) missing.push_back(quoted_text(shortened(name)));
                continue;
            }
            const FileMaterial& read = found->second;
            material = read.material;
            emissions[index] = read.emission;
            brightest = std::max({brightest, read.emission.x, read.emission.y, read.emission.z});
            if (!read.picture.empty())
                pictures.push_back(quoted_text(shortened(name)) + " (" + line_text(shortened(read.picture)) +
                                   ')');
            if (read.is_transparent) transparent.push_back(quoted_text(shortened(name)));
        }
        for (std::size_t i = 0; i < emissions.size(); ++i)
            mesh_.materials[i].glow = glm::vec3(emissions[i] / brightest);
        if (!missing.empty())
            notes_.push_back("materials that no MTL file of it has are grey: " + names_text(missing) +
                             (has_library_ ? "" : " (it has no mtllib)"));
        if (!pictures.empty())
            notes_.push_back("pictures of materials are passed over: " + names_text(pictures));
        if (!transparent.empty())
            notes_.push_back("transparency is passed over, these are opaque: " + names_text(transparent));
    }

    // ---- Normals

    glm::dvec3 place(std::size_t corner) const { return glm::dvec3(mesh_.points_m[corners_[corner].point]); }

    // Newell's: the mean over a face that isn't flat.
    void set_normals_of_faces() {
        for (Face& face : faces_) {
            const glm::dvec3 from = place(face.first);
            glm::dvec3 twice_area(0.0);
            for (std::size_t i = 1; i + 1 < face.count; ++i)
                twice_area += glm::cross(place(face.first + i) - from, place(face.first + i + 1) - from);
            const double length = glm::length(twice_area);
            if (length > 0.0) face.normal = twice_area / length;
        }
    }

    // Only where a corner has no normal of its own.
    void find_faces_of_points() {
        const auto has_none = [&](const Corner& corner) { return !has_normal(corner); };
        if (std::ranges::none_of(corners_, has_none)) return;
        first_of_point_.assign(mesh_.points_m.size() + 1, 0);
        for (const Corner& corner : corners_) ++first_of_point_[corner.point + 1];
        std::partial_sum(first_of_point_.begin(), first_of_point_.end(), first_of_point_.begin());
        corners_of_points_.resize(corners_.size());
        std::vector<std::size_t> next(first_of_point_.begin(), first_of_point_.end() - 1);
        for (std::size_t f = 0; f < faces_.size(); ++f)
            for (std::size_t i = 0; i < faces_[f].count; ++i)
                corners_of_points_[next[corners_[faces_[f].first + i].point]++] = {
                    static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(i)};
    }

    bool has_normal(const Corner& corner) const {
        return corner.normal != kNoNormal &&
               normals_[static_cast<std::size_t>(corner.normal)] != glm::vec3(0.0f);
    }

    // The angle of a face at its corner.
    double angle_at(const Face& face, std::size_t i) const {
        const glm::dvec3 at = place(face.first + i);
        const glm::dvec3 to = place(face.first + (i + 1) % face.count) - at,
                         from = place(face.first + (i + face.count - 1) % face.count) - at;
        return std::atan2(glm::length(glm::cross(to, from)), glm::dot(to, from));
    }

    glm::vec3 normal_at(const Face& face, std::size_t i) const {
        constexpr double kSmooth = 0.642787609686539;  // the cosine of 50°: an octagon's corners are smooth
        constexpr std::size_t kMostFaces = 256;        // of a point: work goes with the square
        const Corner& corner = corners_[face.first + i];
        if (has_normal(corner)) return normals_[static_cast<std::size_t>(corner.normal)];
        const std::size_t first = first_of_point_[corner.point], last = first_of_point_[corner.point + 1];
        if (face.group == kFlat || last - first > kMostFaces) return glm::vec3(face.normal);
        glm::dvec3 sum(0.0);
        for (std::size_t at = first; at < last; ++at) {
            const Face& other = faces_[corners_of_points_[at].face];
            if (other.group == face.group && glm::dot(other.normal, face.normal) > kSmooth)
                sum += angle_at(other, corners_of_points_[at].corner) * other.normal;
        }
        return glm::vec3(glm::dot(sum, face.normal) > 0.0 ? glm::normalize(sum) : face.normal);
    }

    void add_triangles(const Face& face) {
        if (face.normal == glm::dvec3(0.0)) return;
        // Seen along the axis that it faces most.
        const glm::dvec3 facing = glm::abs(face.normal);
        const int away = facing.x > facing.y ? (facing.x > facing.z ? 0 : 2) : (facing.y > facing.z ? 1 : 2);
        const int right = (away + 1) % 3, up = (away + 2) % 3;
        flat_.clear();
        normals_of_face_.clear();
        for (std::size_t i = 0; i < face.count; ++i) {
            const glm::dvec3 at = place(face.first + i);
            flat_.emplace_back(face.normal[away] > 0.0 ? at[right] : -at[right], at[up]);
            normals_of_face_.push_back(normal_at(face, i));
        }
        ears_.cut(flat_, [&](std::size_t a, std::size_t b, std::size_t c) {
            const std::array corners{a, b, c};
            const glm::dvec3 from = place(face.first + a);
            if (glm::cross(place(face.first + b) - from, place(face.first + c) - from) == glm::dvec3(0.0))
                return;
            for (const std::size_t i : corners) {
                mesh_.triangles.push_back(corners_[face.first + i].point);
                mesh_.normals.push_back(normals_of_face_[i]);
            }
            mesh_.material.push_back(face.material);
        });
    }

    obj::Lines lines_;
    const std::string& name_;
    const MaterialText& material_text_;
    ObjectMeshData mesh_;
    std::vector<std::string> notes_;

    std::vector<glm::vec3> normals_;  // unit, or 0
    std::vector<Corner> corners_;
    std::vector<Face> faces_;
    std::size_t textures_ = 0, triangles_ = 0;
    std::int64_t group_ = kUnsaid;
    std::optional<std::uint16_t> material_;

    std::map<std::string, std::uint16_t> materials_;  // that faces have, "" without one
    MaterialReader libraries_;
    bool has_library_ = false;

    // Of each point, from first_of_point_[p] to the next.
    struct FaceCorner {
        std::uint32_t face, corner;
    };
    std::vector<std::size_t> first_of_point_;
    std::vector<FaceCorner> corners_of_points_;

    Ears ears_;
    std::vector<glm::dvec2> flat_;
    std::vector<glm::vec3> normals_of_face_;
};

}  // namespace

ObjectMesh parse_object_obj(std::string_view text, const std::string& name,
                            const MaterialText& material_text) {
    return ObjectParser(text, name, material_text).parse();
}

}  // namespace pelagic
