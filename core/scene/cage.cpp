#include "pelagic/cage.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/hash.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

using Part = CageError::Part;

constexpr const char* kFromZero = " (counted from 0)";

// A side of a face: between two points, the lower index first.
struct Side {
    std::int32_t low, high;
    std::int32_t face;
    bool is_forward;  // the face runs from low to high

    bool operator<(const Side& other) const {
        return std::tie(low, high, face, is_forward) <
               std::tie(other.low, other.high, other.face, other.is_forward);
    }
    bool is_beside(const Side& other) const { return low == other.low && high == other.high; }
};

std::string count_text(std::size_t count, const char* one, const char* more) {
    return std::to_string(count) + ' ' + (count == 1 ? one : more);
}

std::string index_range(std::size_t count) {
    return "0 … " + std::to_string(count - 1);
}

class CageChecker {
  public:
    explicit CageChecker(const CageMesh& mesh) : mesh_(mesh) {}

    // Cheap checks first: a mesh that is too large is not traversed.
    void check() {
        check_counts();
        check_points();
        check_faces();
        check_sides();
        check_fans();
        check_insides();
        check_sharpness();
        check_holes();
        check_surface();
    }

  private:
    [[noreturn]] static void refuse(Part part, std::size_t index, std::string problem, std::string accepted) {
        throw CageError({part, index}, std::move(problem), std::move(accepted));
    }

    void check_counts() const {
        constexpr const char* kFaces = "1 … 1000000 faces";
        const std::size_t faces = mesh_.face_counts.size();
        if (faces == 0) refuse(Part::Mesh, 0, "has no faces", kFaces);
        if (faces > limits::kCageFaces)
            refuse(Part::Mesh, 0, "has " + std::to_string(faces) + " faces", kFaces);
        if (const std::size_t points = std::max(mesh_.points_m.size(), mesh_.st.size());
            points > limits::kCagePoints)
            refuse(Part::Mesh, 0, "has " + std::to_string(points) + " points or texture coordinates",
                   "at most " + std::to_string(limits::kCagePoints) + " of each");
        std::size_t corners = 0;
        for (std::size_t face = 0; face < faces; ++face) {
            const std::int32_t count = mesh_.face_counts[face];
            if (count < 3 || count > static_cast<std::int32_t>(limits::kCageCorners))
                refuse(Part::Face, face, "has " + std::to_string(count) + " corners",
                       "3 … " + std::to_string(limits::kCageCorners) + " corners");
            corners += static_cast<std::size_t>(count);
        }
        if (corners > limits::kCageAllCorners)
            refuse(Part::Mesh, 0, "has faces with " + std::to_string(corners) + " corners together",
                   "at most " + std::to_string(limits::kCageAllCorners));
        if (mesh_.indices.size() != corners)
            refuse(Part::Mesh, 0,
                   "has " + std::to_string(mesh_.indices.size()) + " indices for " + std::to_string(corners) +
                       " corners of faces",
                   "one index for each corner");
        if (mesh_.st_indices.size() != (mesh_.st.empty() ? 0 : corners))
            refuse(Part::Mesh, 0,
                   "has texture coordinates for " + std::to_string(mesh_.st_indices.size()) + " of " +
                       std::to_string(corners) + " corners of faces",
                   "a texture coordinate for each corner, or none");
    }

    void check_points() const {
        for (std::size_t i = 0; i < mesh_.points_m.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                if (const double value = mesh_.points_m[i][axis]; !limits::kCagePoint_m.holds(value))
                    refuse(Part::Point, i,
                           std::isfinite(value) ? "is too far away: " + number_text(value) + " m"
                                                : "is at " + number_text(value),
                           "three numbers in metres, each " + text_of(limits::kCagePoint_m));
        for (std::size_t i = 0; i < mesh_.st.size(); ++i)
            for (int axis = 0; axis < 2; ++axis)
                if (const double value = mesh_.st[i][axis]; !limits::kCageTexture.holds(value))
                    refuse(Part::TextureCoordinate, i, "is " + number_text(value),
                           "two numbers, each " + text_of(limits::kCageTexture));
    }

    void check_faces() {
        const auto points = mesh_.points_m.size();
        std::vector<std::int32_t> faces_at(points, 0), sorted;
        std::size_t first = 0;
        for (std::size_t face = 0; face < mesh_.face_counts.size(); ++face) {
            const auto count = static_cast<std::size_t>(mesh_.face_counts[face]);
            for (std::size_t k = first; k < first + count; ++k) {
                const std::int32_t index = mesh_.indices[k];
                if (index < 0 || static_cast<std::size_t>(index) >= points)
                    refuse(Part::Face, face, "has the point " + std::to_string(index),
                           points == 0 ? std::string("points, and faces of them")
                                       : "points " + index_range(points));
                if (++faces_at[static_cast<std::size_t>(index)] >
                    static_cast<std::int32_t>(limits::kCageCorners))
                    refuse(Part::Face, face,
                           "is the " + std::to_string(limits::kCageCorners + 1) + "th at the point " +
                               std::to_string(index),
                           "at most " + std::to_string(limits::kCageCorners) + " faces round a point");
                if (mesh_.st.empty()) continue;
                if (const std::int32_t st = mesh_.st_indices[k];
                    st < 0 || static_cast<std::size_t>(st) >= mesh_.st.size())
                    refuse(Part::Face, face, "has the texture coordinate " + std::to_string(st),
                           "texture coordinates " + index_range(mesh_.st.size()));
            }
            sorted.assign(mesh_.indices.begin() + static_cast<std::ptrdiff_t>(first),
                          mesh_.indices.begin() + static_cast<std::ptrdiff_t>(first + count));
            std::sort(sorted.begin(), sorted.end());
            if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
                refuse(Part::Face, face, "has the point " + std::to_string(*twice) + kFromZero + " twice",
                       "corners that are all different points");
            first += count;
        }
    }

    // Where an edge has three faces, or two that run the same way, the last one is named.
    void check_sides() {
        sides_.reserve(mesh_.indices.size());
        std::size_t first = 0;
        for (std::size_t face = 0; face < mesh_.face_counts.size(); ++face) {
            const auto count = static_cast<std::size_t>(mesh_.face_counts[face]);
            for (std::size_t k = 0; k < count; ++k) {
                const std::int32_t from = mesh_.indices[first + k],
                                   to = mesh_.indices[first + (k + 1) % count];
                sides_.push_back(
                    {std::min(from, to), std::max(from, to), static_cast<std::int32_t>(face), from < to});
            }
            first += count;
        }
        std::sort(sides_.begin(), sides_.end());
        const Side* worst = nullptr;
        bool are_three = false;
        for (std::size_t i = 1; i < sides_.size(); ++i) {
            const Side &here = sides_[i], &before = sides_[i - 1];
            if (!here.is_beside(before)) continue;
            const bool is_third = i > 1 && here.is_beside(sides_[i - 2]);
            if (!is_third && here.is_forward != before.is_forward) continue;
            if (worst && worst->face <= here.face) continue;
            worst = &here;
            are_three = is_third;
        }
        if (!worst) return;
        const std::string edge = "the edge between the points " + std::to_string(worst->low) + " and " +
                                 std::to_string(worst->high) + kFromZero;
        if (are_three)
            refuse(Part::Face, static_cast<std::size_t>(worst->face), "is the third at " + edge,
                   "edges with one face or two");
        refuse(Part::Face, static_cast<std::size_t>(worst->face),
               "runs along " + edge + " the same way as the face beside it",
               "faces that are all counter-clockwise seen from the same side");
    }

    // The faces round a point must be joined by edges: where they meet in the point alone, there is no surface round
    // it.
    void check_fans() const {
        std::vector<std::int32_t> leader(mesh_.indices.size());  // of the corners that edges join
        for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = static_cast<std::int32_t>(i);
        const auto find = [&](std::int32_t corner) {
            auto at = static_cast<std::size_t>(corner);
            while (leader[at] != static_cast<std::int32_t>(at)) {
                leader[at] = leader[static_cast<std::size_t>(leader[at])];
                at = static_cast<std::size_t>(leader[at]);
            }
            return static_cast<std::int32_t>(at);
        };
        std::vector<std::size_t> first_of;
        std::size_t first = 0;
        for (const std::int32_t count : mesh_.face_counts) {
            first_of.push_back(first);
            first += static_cast<std::size_t>(count);
        }
        const auto corner_of = [&](std::int32_t face, std::int32_t point) {
            std::size_t corner = first_of[static_cast<std::size_t>(face)];
            while (mesh_.indices[corner] != point) ++corner;
            return static_cast<std::int32_t>(corner);
        };
        for (std::size_t i = 1; i < sides_.size(); ++i) {
            const Side &here = sides_[i], &before = sides_[i - 1];
            if (!here.is_beside(before)) continue;
            for (const std::int32_t point : {here.low, here.high}) {
                const std::int32_t a = find(corner_of(here.face, point)),
                                   b = find(corner_of(before.face, point));
                leader[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
            }
        }
        std::vector<std::int32_t> fan(mesh_.points_m.size(), -1);
        for (std::size_t face = 0; face < first_of.size(); ++face)
            for (std::size_t k = 0; k < static_cast<std::size_t>(mesh_.face_counts[face]); ++k) {
                const std::size_t corner = first_of[face] + k;
                const std::int32_t of = find(static_cast<std::int32_t>(corner));
                std::int32_t& known = fan[static_cast<std::size_t>(mesh_.indices[corner])];
                if (known < 0) known = of;
                if (known != of)
                    refuse(Part::Face, face,
                           "meets others at the point " + std::to_string(mesh_.indices[corner]) + kFromZero +
                               " and shares no edge with them there",
                           "faces that share an edge where they share a point");
            }
    }

    // OpenSubdiv 3.5 crashes, or takes other faces' surfaces, at an inner point that has only two faces (mended in
    // its 3.6 and 3.7: its pull requests 1301, 1336 and 1353).
    void check_insides() const {
        std::vector<std::int32_t> faces_at(mesh_.points_m.size()), shared_at(mesh_.points_m.size());
        for (const std::int32_t index : mesh_.indices) ++faces_at[static_cast<std::size_t>(index)];
        for (std::size_t i = 1; i < sides_.size(); ++i) {
            if (!sides_[i].is_beside(sides_[i - 1])) continue;
            for (const std::int32_t point : {sides_[i].low, sides_[i].high}) {
                const auto at = static_cast<std::size_t>(point);
                if (++shared_at[at] == 2 && faces_at[at] == 2)
                    refuse(
                        Part::Face, static_cast<std::size_t>(std::max(sides_[i].face, sides_[i - 1].face)),
                        "meets one other face alone all round the point " + std::to_string(point) + kFromZero,
                        "three faces or more round a point inside: take the point out of both");
            }
        }
    }

    bool has_edge(std::int32_t a, std::int32_t b) const {
        const Side wanted{std::min(a, b), std::max(a, b), 0, false};
        const auto found = std::lower_bound(sides_.begin(), sides_.end(), wanted);
        return found != sides_.end() && found->is_beside(wanted);
    }

    static void check_sharp(Part part, std::size_t index, double sharpness) {
        if (!(sharpness >= 0.0) || std::isinf(sharpness))
            refuse(part, index, "has the sharpness " + number_text(sharpness),
                   "a finite number from 0 up; 10 and more are sharp for ever");
    }

    void check_sharpness() const {
        for (std::size_t i = 0; i < mesh_.creases.size(); ++i) {
            const auto [from, to, sharpness] = mesh_.creases[i];
            if (!has_edge(from, to))
                refuse(Part::Crease, i,
                       "lies between the points " + std::to_string(from) + " and " + std::to_string(to) +
                           kFromZero + ", which is no edge",
                       "two points beside each other in a face");
            check_sharp(Part::Crease, i, sharpness);
        }
        std::vector<bool> is_used(mesh_.points_m.size());
        for (const std::int32_t index : mesh_.indices) is_used[static_cast<std::size_t>(index)] = true;
        for (std::size_t i = 0; i < mesh_.corners.size(); ++i) {
            const auto [point, sharpness] = mesh_.corners[i];
            if (point < 0 || static_cast<std::size_t>(point) >= is_used.size() ||
                !is_used[static_cast<std::size_t>(point)])
                refuse(Part::Corner, i,
                       "is at the point " + std::to_string(point) + kFromZero + ", which no face has",
                       "a point of a face");
            check_sharp(Part::Corner, i, sharpness);
        }
    }

    void check_holes() const {
        const std::size_t faces = mesh_.face_counts.size();
        std::vector<bool> is_hole(faces);
        std::size_t holes = 0;
        for (std::size_t i = 0; i < mesh_.holes.size(); ++i) {
            const std::int32_t face = mesh_.holes[i];
            if (face < 0 || static_cast<std::size_t>(face) >= faces)
                refuse(Part::Hole, i, "is the face " + std::to_string(face) + kFromZero,
                       "faces " + index_range(faces));
            if (is_hole[static_cast<std::size_t>(face)]) continue;
            is_hole[static_cast<std::size_t>(face)] = true;
            ++holes;
        }
        if (holes == faces) refuse(Part::Mesh, 0, "has holes alone", "at least one face that is no hole");
    }

    // With CageBoundary::None a face whose corners touch the boundary has no surface; it only shapes its neighbours.
    void check_surface() const {
        if (mesh_.boundary != CageBoundary::None) return;
        std::vector<bool> is_on_boundary(mesh_.points_m.size());
        for (std::size_t i = 0; i < sides_.size(); ++i) {
            const bool is_shared = (i > 0 && sides_[i].is_beside(sides_[i - 1])) ||
                                   (i + 1 < sides_.size() && sides_[i].is_beside(sides_[i + 1]));
            if (is_shared) continue;
            is_on_boundary[static_cast<std::size_t>(sides_[i].low)] = true;
            is_on_boundary[static_cast<std::size_t>(sides_[i].high)] = true;
        }
        std::vector<bool> is_hole(mesh_.face_counts.size());
        for (const std::int32_t face : mesh_.holes) is_hole[static_cast<std::size_t>(face)] = true;
        std::size_t corner = 0;
        for (std::size_t face = 0; face < mesh_.face_counts.size(); ++face) {
            bool has_surface = !is_hole[face];
            for (std::int32_t k = 0; k < mesh_.face_counts[face]; ++k)
                if (is_on_boundary[static_cast<std::size_t>(mesh_.indices[corner++])]) has_surface = false;
            if (has_surface) return;
        }
        refuse(
            Part::Mesh, 0,
            "has no surface: with no interpolation of the boundary, faces that touch it only shape the others",
            "at least one face, no hole, whose points all lie inside; or a surface that ends at the boundary");
    }

    const CageMesh& mesh_;
    std::vector<Side> sides_;
};

// The structured binding names every member, so that a new member doesn't compile until it is added here.
std::string content_of(const CageMesh& mesh) {
    const auto& [points_m, counts, indices, st, st_indices, creases, corners, holes, boundary] = mesh;
    ByteHash hash;
    const auto add_bits = [&](auto bits) {
        for (std::size_t byte = 0; byte < sizeof bits; ++byte)
            hash.add(static_cast<unsigned char>(bits >> 8 * byte));
    };
    const auto add_integer = [&](std::int32_t value) { add_bits(static_cast<std::uint32_t>(value)); };
    const auto add_number = [&](double value) {
        add_bits(std::bit_cast<std::uint64_t>(value + 0.0));
    };  // −0 is 0
    const auto add_list = [&](const auto& list, const auto& add) {
        add_bits(static_cast<std::uint64_t>(list.size()));
        for (const auto& each : list) add(each);
    };
    add_list(points_m, [&](const glm::dvec3& p) { add_number(p.x), add_number(p.y), add_number(p.z); });
    add_list(counts, add_integer);
    add_list(indices, add_integer);
    add_list(st, [&](const glm::dvec2& t) { add_number(t.x), add_number(t.y); });
    add_list(st_indices, add_integer);
    add_list(creases, [&](const CageMesh::Crease& crease) {
        add_integer(crease.from), add_integer(crease.to), add_number(crease.sharpness);
    });
    add_list(corners, [&](const CageMesh::Corner& corner) {
        add_integer(corner.point), add_number(corner.sharpness);
    });
    add_list(holes, add_integer);
    hash.add(static_cast<unsigned char>(boundary));
    return count_text(counts.size(), "face", "faces") + ", " +
           count_text(points_m.size(), "point", "points") + ", " + hash.text();
}

}  // namespace

std::string PELAGIC_VERSION_NAMESPACE::text_of(CageError::Where where) {
    constexpr const char* kParts[] = {"the mesh", "point", "texture coordinate", "face", "crease",
                                      "corner",   "hole"};
    const std::string part = kParts[static_cast<std::size_t>(where.part)];
    return where.part == Part::Mesh ? part : part + ' ' + std::to_string(where.index);
}

CageError::CageError(Where where, std::string problem, std::string accepted)
    : std::runtime_error(text_of(where) + ' ' + problem + "; accepted: " + accepted),
      where_(where),
      problem_(std::move(problem)),
      accepted_(std::move(accepted)) {}

Cage::Cage(CageMesh mesh) : mesh_(std::move(mesh)) {
    CageChecker(mesh_).check();
    content_ = content_of(mesh_);
}

}  // namespace pelagic
