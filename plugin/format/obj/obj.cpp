#include "plugin/format/obj/obj.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "plugin/format/obj/lines.h"

namespace pelagic {
namespace {

using obj::Refused, obj::Words, obj::quoted, obj::number_of, obj::integer_of, obj::index_of;

constexpr const char* kLines =
    "v, vt, f, t crease, t corner, t hole, t interpolateboundary, and o, g, s, l, p, vn, usemtl, mtllib and #, which "
    "are passed over";

class Parser {
  public:
    Parser(std::string_view text, const std::string& name) : lines_(text), name_(name) {}

    Cage parse() {
        Words words;
        while (lines_.next(words)) try {
                take(words);
            } catch (const Refused& refused) {
                throw ObjError(place_text(lines_.line()) + refused.problem, refused.accepted);
            }
        if (faces_with_st_ == 0) mesh_.st.clear();  // of no face
        try {
            return Cage(std::move(mesh_));
        } catch (const CageError& error) {
            throw ObjError(where_text(error.where()) + error.problem(), error.accepted());
        }
    }

  private:
    std::string place_text(std::size_t line) const { return name_ + ':' + std::to_string(line) + ": "; }

    std::string where_text(CageError::Where where) const {
        const std::vector<std::uint32_t>& lines = places_[static_cast<std::size_t>(where.part)];
        const auto& [part, index] = where;
        if (part == CageError::Part::Mesh || index >= lines.size()) return name_ + ": ";
        std::string what = text_of(where);
        return place_text(lines[index]) + "the " + what.substr(0, what.rfind(' ')) + ' ';
    }

    void take(const Words& words) {
        if (words.empty()) return;
        const std::string_view kind = words.front();
        const Words::const_iterator first = words.begin() + 1;
        const auto count = static_cast<std::size_t>(words.end() - first);
        constexpr std::array<std::string_view, 7> kPassedOver{"o", "g", "s", "l", "p", "usemtl", "mtllib"};
        if (kind == "v") {
            take_point(words);
        } else if (kind == "vt") {
            take_texture(words);
        } else if (kind == "f") {
            take_face(words);
        } else if (kind == "t") {
            if (count < 2)
                throw Refused{"a tag has a name and three counts", "such as t crease 2/1/0 0 1 4.5"};
            take_tag(words[1], words);
        } else if (kind == "vn") {
            ++normals_;
        } else if (std::find(kPassedOver.begin(), kPassedOver.end(), kind) == kPassedOver.end()) {
            throw Refused{quoted(kind) + " begins no line that is known", kLines};
        }
    }

    void remember(CageError::Part part) {
        places_[static_cast<std::size_t>(part)].push_back(static_cast<std::uint32_t>(lines_.line()));
    }

    void take_point(const Words& words) {
        const glm::dvec3 point_m = obj::point_of(words);
        if (mesh_.points_m.size() == limits::kCagePoints)
            throw Refused{"there are too many points", "at most " + std::to_string(limits::kCagePoints)};
        mesh_.points_m.push_back(point_m);
        remember(CageError::Part::Point);
    }

    void take_texture(const Words& words) {
        if (words.size() != 3 && words.size() != 4)
            throw Refused{"a texture coordinate has " + std::to_string(words.size() - 1) + " numbers",
                          "two; a third is passed over"};
        std::array<double, 3> numbers{};
        for (std::size_t i = 1; i < words.size(); ++i) numbers[i - 1] = number_of(words[i]);
        if (mesh_.st.size() == limits::kCagePoints)
            throw Refused{"there are too many texture coordinates",
                          "at most " + std::to_string(limits::kCagePoints)};
        mesh_.st.emplace_back(numbers[0], numbers[1]);
        remember(CageError::Part::TextureCoordinate);
    }

    struct CornerIndices {
        std::int32_t point = 0;
        std::optional<std::int32_t> st{};
    };
    CornerIndices corner_of(std::string_view word) const {
        const auto parts = obj::corner_parts(word);
        CornerIndices corner{index_of(parts[0], mesh_.points_m.size(), "point")};
        if (!parts[1].empty()) corner.st = index_of(parts[1], mesh_.st.size(), "texture coordinate");
        if (!parts[2].empty()) index_of(parts[2], normals_, "normal");
        return corner;
    }

    void take_face(const Words& words) {
        const std::size_t count = words.size() - 1;
        if (mesh_.face_counts.size() == limits::kCageFaces)
            throw Refused{"there are too many faces", "at most " + std::to_string(limits::kCageFaces)};
        if (count < 3 || count > limits::kCageCorners)
            throw Refused{"the face has " + std::to_string(count) + (count == 1 ? " corner" : " corners"),
                          "3 … " + std::to_string(limits::kCageCorners) + " corners"};
        if (mesh_.indices.size() + count > limits::kCageAllCorners)
            throw Refused{"the faces have too many corners together",
                          "at most " + std::to_string(limits::kCageAllCorners)};
        bool has_st = false;
        for (std::size_t i = 1; i <= count; ++i) {
            const CornerIndices corner = corner_of(words[i]);
            const bool is_first = mesh_.face_counts.empty() && i == 1;
            if (!is_first && corner.st.has_value() != (i == 1 ? faces_with_st_ > 0 : has_st))
                throw Refused{quoted(words[i]) +
                                  (corner.st ? " has a texture coordinate and corners before it have none"
                                             : " has no texture coordinate and corners before it have one"),
                              "texture coordinates for all corners of all faces, or for none"};
            has_st = corner.st.has_value();
            mesh_.indices.push_back(corner.point);
            if (has_st) mesh_.st_indices.push_back(*corner.st);
        }
        if (has_st) ++faces_with_st_;
        mesh_.face_counts.push_back(static_cast<std::int32_t>(count));
        remember(CageError::Part::Face);
    }

    // ---- Tags: a name, "integers/numbers/strings" as counts, and those

    struct Tag {
        std::vector<std::int32_t> integers;
        std::vector<double> numbers;
    };

    static Tag values_of(const Words& words) {
        constexpr const char* kCounts =
            "counts of integers, numbers and strings, such as 2/1/0, and as many of each";
        std::array<std::size_t, 3> counts{};
        std::string_view rest = words[2];
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const std::size_t end = std::min(rest.find('/'), rest.size());
            const std::int64_t count = integer_of(rest.substr(0, end), kCounts);
            if (count < 0 || static_cast<std::size_t>(count) > words.size() ||
                (end == rest.size()) != (i == 2))
                throw Refused{quoted(words[2]) + " doesn't count what follows", kCounts};
            counts[i] = static_cast<std::size_t>(count);
            if (i < 2) rest.remove_prefix(end + 1);
        }
        if (counts[2] != 0 || words.size() != 3 + counts[0] + counts[1])
            throw Refused{quoted(words[2]) + " doesn't count what follows", kCounts};
        Tag tag;
        for (std::size_t i = 0; i < counts[0]; ++i) {
            const std::int64_t value = integer_of(words[3 + i], "whole numbers, counted from 0");
            if (!std::in_range<std::int32_t>(value))
                throw Refused{quoted(words[3 + i]) + " is outside the range",
                              "points and faces, counted from 0"};
            tag.integers.push_back(static_cast<std::int32_t>(value));
        }
        for (std::size_t i = 0; i < counts[1]; ++i)
            tag.numbers.push_back(number_of(words[3 + counts[0] + i]));
        return tag;
    }

    void take_tag(std::string_view name, const Words& words) {
        if (name != "crease" && name != "corner" && name != "hole" && name != "interpolateboundary")
            throw Refused{"the tag " + quoted(name) + " is not known",
                          "crease, corner, hole, interpolateboundary"};
        const Tag tag = values_of(words);
        const std::size_t integers = tag.integers.size(), numbers = tag.numbers.size();
        const auto sharpness = [&](std::size_t i) { return tag.numbers[numbers == 1 ? 0 : i]; };
        if (name == "crease") {
            const std::size_t edges = integers / 2;
            if (edges == 0 || integers % 2 != 0 || (numbers != 1 && numbers != edges))
                throw Refused{"a crease has pairs of points, and one sharpness or one for each",
                              "such as t crease 2/1/0 0 1 4.5"};
            if (mesh_.creases.size() + edges > limits::kCageAllCorners)
                throw Refused{"there are too many creases",
                              "at most " + std::to_string(limits::kCageAllCorners)};
            for (std::size_t i = 0; i < edges; ++i) {
                mesh_.creases.push_back({tag.integers[2 * i], tag.integers[2 * i + 1], sharpness(i)});
                remember(CageError::Part::Crease);
            }
        } else if (name == "corner") {
            if (integers == 0 || (numbers != 1 && numbers != integers))
                throw Refused{"a corner has points, and one sharpness or one for each",
                              "such as t corner 1/1/0 0 4.5"};
            if (mesh_.corners.size() + integers > limits::kCagePoints)
                throw Refused{"there are too many corners", "at most " + std::to_string(limits::kCagePoints)};
            for (std::size_t i = 0; i < integers; ++i) {
                mesh_.corners.push_back({tag.integers[i], sharpness(i)});
                remember(CageError::Part::Corner);
            }
        } else if (name == "hole") {
            if (integers == 0 || numbers != 0)
                throw Refused{"a hole has faces alone", "such as t hole 1/0/0 7"};
            if (mesh_.holes.size() + integers > limits::kCageFaces)
                throw Refused{"there are too many holes", "at most " + std::to_string(limits::kCageFaces)};
            for (const std::int32_t face : tag.integers) {
                mesh_.holes.push_back(face);
                remember(CageError::Part::Hole);
            }
        } else {
            constexpr std::array kRules{CageBoundary::None, CageBoundary::EdgeAndCorner,
                                        CageBoundary::EdgeOnly};
            if (integers != 1 || numbers != 0 || tag.integers[0] < 0 ||
                tag.integers[0] >= static_cast<std::int32_t>(kRules.size()))
                throw Refused{
                    "the boundary has one rule",
                    "t interpolateboundary 1/0/0 and 0 (none), 1 (edge and corner) or 2 (edge only)"};
            mesh_.boundary = kRules[static_cast<std::size_t>(tag.integers[0])];
        }
    }

    obj::Lines lines_;
    const std::string& name_;
    std::size_t normals_ = 0, faces_with_st_ = 0;
    CageMesh mesh_;
    // Where each part of the mesh stands, by CageError::Part.
    std::array<std::vector<std::uint32_t>, 7> places_;
};

}  // namespace

Cage parse_obj(std::string_view text, const std::string& name) {
    return Parser(text, name).parse();
}

}  // namespace pelagic
