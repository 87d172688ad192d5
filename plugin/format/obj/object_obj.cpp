#include "plugin/format/obj/object_obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <set>

#include "core/base/constants.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "plugin/format/obj/lines.h"
#include "plugin/format/obj/polygons.h"

namespace pelagic {
namespace {

using obj::Refused, obj::Words, obj::quoted, obj::number_of, obj::index_of;

constexpr const char* kObjectLines =
    "v, vt, vn, f, s, usemtl, mtllib, and o, g, l, p and #, which are passed over: polygons";
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
    std::string passed_over;  // the first line that names a picture that isn't read
    // map_Kd: its picture, places in which are `scale` times a corner's and `shift`; and the line, as messages call it.
    std::string picture, picture_line;
    glm::vec2 scale{1.0f}, shift{0.0f};
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
                    take(*of, words, name + ':' + std::to_string(lines.line()));
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

    // "map_Kd -s 2 2 1 hull.png": options and a file's name, which may have spaces.
    static void take_picture(FileMaterial& of, const Words& words) {
        std::size_t at = 1;
        while (at + 1 < words.size() && words[at].size() > 1 && words[at][0] == '-') {
            const std::string_view option = words[at++];
            const bool is_scale = option == "-s", is_shift = option == "-o";
            // Those of "-s", "-o" and "-t" are one to three, and the name may be a number itself.
            const std::size_t most = is_scale || is_shift || option == "-t" ? 3 : option == "-mm" ? 2 : 1;
            for (std::size_t i = 0; i < most && at + 1 < words.size(); ++i, ++at) {
                if (most == 3 && words[at].find_first_not_of("+-.0123456789eE") != std::string_view::npos)
                    break;
                if (!(is_scale || is_shift)) continue;
                const double number = number_of(words[at]);
                if (!limits::kObjectImageAt.holds(number))
                    throw Refused{quoted(words[at]) + " is outside the range",
                                  text_of(limits::kObjectImageAt)};
                if (i < 2) (is_scale ? of.scale : of.shift)[static_cast<int>(i)] = static_cast<float>(number);
            }
        }
        Words name(words.begin() + static_cast<std::ptrdiff_t>(at) - 1, words.end());
        of.picture = joined(name);
        if (of.picture.empty())
            throw Refused{quoted(words[0]) + " names no picture", "the name of a PNG or an OpenEXR"};
    }

    static void take(FileMaterial& of, const Words& words, const std::string& line) {
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
        } else if (kind == "map_Kd") {
            of.picture_line = line;
            take_picture(of, words);
        } else if (kind.starts_with("map_") || kind == "bump" || kind == "norm" || kind == "disp" ||
                   kind == "decal" || kind == "refl") {
            if (of.passed_over.empty()) of.passed_over = std::string(kind) + ' ' + joined(words);
        }
    }
};

class ObjectParser {
  public:
    ObjectParser(std::string_view text, const std::string& name, const MaterialText& material_text,
                 const MaterialPicture& picture_of)
        : lines_(text), name_(name), material_text_(material_text), picture_of_(picture_of) {}

    ObjectMesh parse() {
        Words words;
        while (lines_.next(words)) try {
                if (!words.empty()) take(words);
            } catch (const Refused& refused) {
                throw ObjError(name_ + ':' + std::to_string(lines_.line()) + ": " + refused.problem,
                               refused.accepted);
            }
        if (polygons_.empty()) throw ObjError(name_ + " has no faces", kObjectLines);
        set_materials();
        ObjectMeshData mesh = polygons_.triangles(std::move(made_), std::move(images_));
        if (mesh.triangles.empty())
            throw ObjError(name_ + " has no face with an area", "at least one with an area");
        if (mesh.materials.size() > limits::kObjectMaterials)
            throw ObjError(name_ + " has too many materials",
                           "at most " + std::to_string(limits::kObjectMaterials));
        move_places(mesh);
        if (polygons_.has_lost_picture())
            notes_.push_back("faces without texture coordinates show the mean of their material's picture");
        return ObjectMesh(std::move(mesh), std::move(notes_));
    }

  private:
    static constexpr std::int64_t kUnsaid = -1;

    void take(const Words& words) {
        const std::string_view kind = words.front();
        if (kind == "v") {
            take_point(words);
        } else if (kind == "vt") {
            take_image_at(words);
        } else if (kind == "vn") {
            take_normal(words);
        } else if (kind == "f") {
            take_face(words);
        } else if (kind == "s") {
            group_ = words.size() < 2 || words[1] == "off"
                         ? obj::Polygons::kFlat
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
        if (polygons_.points_m.size() == limits::kObjectTriangles)
            throw Refused{"there are too many points", "at most " + std::to_string(limits::kObjectTriangles)};
        polygons_.points_m.emplace_back(point_m);
    }

    // One to three numbers; the third is of pictures with depth.
    void take_image_at(const Words& words) {
        if (words.size() < 2 || words.size() > 4)
            throw Refused{"a texture coordinate has " + std::to_string(words.size() - 1) + " numbers",
                          "one to three"};
        const glm::dvec2 at(number_of(words[1]), words.size() > 2 ? number_of(words[2]) : 0.0);
        if (!limits::kObjectImageAt.holds(at.x) || !limits::kObjectImageAt.holds(at.y))
            throw Refused{"the texture coordinate is outside the range", text_of(limits::kObjectImageAt)};
        if (polygons_.image_at.size() == 3 * limits::kObjectTriangles)
            throw Refused{"there are too many texture coordinates",
                          "at most " + std::to_string(3 * limits::kObjectTriangles)};
        polygons_.image_at.emplace_back(at);
    }

    void take_normal(const Words& words) {
        if (words.size() != 4)
            throw Refused{"a normal has " + std::to_string(words.size() - 1) + " numbers", "three"};
        if (polygons_.normals.size() == 3 * limits::kObjectTriangles)
            throw Refused{"there are too many normals",
                          "at most " + std::to_string(3 * limits::kObjectTriangles)};
        glm::dvec3 normal(number_of(words[1]), number_of(words[2]), number_of(words[3]));
        // By its largest part first: squares of very long ones would be infinite.
        const double largest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
        polygons_.normals.emplace_back(largest > 0.0 ? glm::normalize(normal / largest) : normal);
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
        corners_.clear();
        for (std::size_t i = 1; i <= count; ++i) {
            const auto parts = obj::corner_parts(words[i]);
            obj::Polygons::Corner corner{
                .point = static_cast<std::uint32_t>(index_of(parts[0], polygons_.points_m.size(), "point"))};
            if (!parts[1].empty())
                corner.image_at = index_of(parts[1], polygons_.image_at.size(), "texture coordinate");
            if (!parts[2].empty()) corner.normal = index_of(parts[2], polygons_.normals.size(), "normal");
            corners_.push_back(corner);
        }
        polygons_.add(corners_, group_, *material_);
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

    int image_of(const FileMaterial& read) {
        const auto [at, is_new] = image_of_file_.try_emplace(read.picture, static_cast<int>(images_.size()));
        if (is_new) try {
                images_.push_back(picture_of_(read.picture, limits::kObjectTexels - texels_));
                const ObjectImage::Level& whole = images_.back()->levels().front();
                texels_ += static_cast<std::size_t>(whole.width) * static_cast<std::size_t>(whole.height);
            } catch (const PictureRefused& refused) {
                throw ObjError(read.picture_line + ": the picture " + quoted_text(shortened(read.picture)) +
                                   ' ' + refused.problem,
                               refused.accepted);
            }
        return at->second;
    }

    // By the options -s and -o of their pictures. A triangle's stay near 0, where floats are fine: pictures repeat.
    void move_places(ObjectMeshData& mesh) const {
        for (std::size_t i = 0; i < mesh.image_at.size(); i += 3) {
            const auto found = moved_.find(mesh.material[i / 3]);
            if (found == moved_.end()) continue;
            const FileMaterial& by = *found->second;
            const auto moved = [&](std::size_t corner) {
                return glm::dvec2(by.scale) * glm::dvec2(mesh.image_at[corner]) + glm::dvec2(by.shift);
            };
            const glm::dvec2 whole = glm::floor(moved(i));
            for (std::size_t corner = i; corner < i + 3; ++corner) {
                const glm::dvec2 at = moved(corner) - whole;
                if (!limits::kObjectImageAt.holds(at.x) || !limits::kObjectImageAt.holds(at.y))
                    throw ObjError(by.picture_line + ": the picture repeats too often on a triangle",
                                   text_of(limits::kObjectImageAt) + " times");
                mesh.image_at[corner] = glm::vec2(at);
            }
        }
    }

    void set_materials() {
        std::vector<std::string> missing, pictures, transparent;
        std::vector<glm::dvec3> emissions(materials_.size());
        double brightest = 1.0;
        made_.resize(materials_.size());
        for (const auto& [name, index] : materials_) {
            ObjectMaterial& material = made_[index];
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
            if (!read.picture.empty()) {
                material.image = image_of(read);
                material.colour = images_[static_cast<std::size_t>(material.image)]->mean();
                if (read.scale != glm::vec2(1.0f) || read.shift != glm::vec2(0.0f)) moved_[index] = &read;
            }
            if (!read.passed_over.empty())
                pictures.push_back(quoted_text(shortened(name)) + " (" +
                                   line_text(shortened(read.passed_over)) + ')');
            if (read.is_transparent) transparent.push_back(quoted_text(shortened(name)));
        }
        for (std::size_t i = 0; i < emissions.size(); ++i)
            made_[i].glow = glm::vec3(emissions[i] / brightest);
        if (!missing.empty())
            notes_.push_back("materials that no MTL file of it has are grey: " + names_text(missing) +
                             (has_library_ ? "" : " (it has no mtllib)"));
        if (!pictures.empty())
            notes_.push_back("pictures of materials are passed over: " + names_text(pictures));
        if (!transparent.empty())
            notes_.push_back("transparency is passed over, these are opaque: " + names_text(transparent));
    }

    obj::Lines lines_;
    const std::string& name_;
    const MaterialText& material_text_;
    const MaterialPicture& picture_of_;
    obj::Polygons polygons_;
    std::vector<std::string> notes_;

    std::vector<obj::Polygons::Corner> corners_;  // of the face at hand
    std::size_t triangles_ = 0;
    std::int64_t group_ = kUnsaid;
    std::optional<std::uint16_t> material_;

    std::map<std::string, std::uint16_t> materials_;  // that faces have, "" without one
    MaterialReader libraries_;
    bool has_library_ = false;

    std::vector<ObjectMaterial> made_;
    std::vector<std::shared_ptr<const ObjectImage>> images_;
    std::map<std::string, int> image_of_file_;
    std::map<std::size_t, const FileMaterial*> moved_;  // materials whose picture has options, by their index
    std::size_t texels_ = 0;
};

}  // namespace

ObjectMesh parse_object_obj(std::string_view text, const std::string& name, const MaterialText& material_text,
                            const MaterialPicture& picture) {
    return ObjectParser(text, name, material_text, picture).parse();
}

}  // namespace pelagic
