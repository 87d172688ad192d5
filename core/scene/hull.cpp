#include "core/scene/hull.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <span>

#include "core/base/constants.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kSides = 8, kEnough = 6;  // ways along x and y, and how many meet hull within it

struct Segment {
    glm::dvec2 from, to;
};

double distance_to(const glm::dvec2& place, const Segment& segment) {
    const glm::dvec2 along = segment.to - segment.from, from = place - segment.from;
    const double square = glm::dot(along, along);
    const double t = square > 0.0 ? glm::clamp(glm::dot(from, along) / square, 0.0, 1.0) : 0.0;
    return glm::length(from - t * along);
}

glm::dvec3 corner_of(const ObjectMeshData& mesh, std::size_t corner) {
    return glm::dvec3(mesh.points_m[mesh.triangles[corner]]);
}

// The lowest surface over each column of a fine grid over the box.
class Bottom {
  public:
    explicit Bottom(const ObjectMesh& mesh)
        : least_(mesh.least_m()), size_(glm::dvec2(mesh.most_m()) - least_) {
        constexpr double kColumns = 512.0;
        cell_m_ = std::max(size_.x, size_.y) / kColumns;
        count_ = glm::ivec2(glm::ceil(size_ / cell_m_)) + 1;
        lowest_.assign(static_cast<std::size_t>(count_.x) * count_.y, static_cast<float>(kInfinity));
        const ObjectMeshData& data = mesh.data();
        for (std::size_t i = 0; i < data.triangles.size(); i += 3)
            add(corner_of(data, i), corner_of(data, i + 1), corner_of(data, i + 2));
    }

    // Of the four columns round a place: near an upright side some of them are beside it.
    double near(const glm::dvec2& place) const {
        const glm::ivec2 low = glm::clamp(glm::ivec2(glm::floor((place - least_) / cell_m_)), glm::ivec2(0),
                                          count_ - 1),
                         high = glm::min(low + 1, count_ - 1);
        return std::min({at(low.x, low.y), at(high.x, low.y), at(low.x, high.y), at(high.x, high.y)});
    }

  private:
    double at(int x, int y) const {
        return static_cast<double>(lowest_[static_cast<std::size_t>(y) * count_.x + x]);
    }

    void add(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        const glm::dvec2 ab(b - a), ac(c - a);
        const double area = ab.x * ac.y - ab.y * ac.x;
        if (area == 0.0) return;  // upright: its edges are its neighbours' too
        const glm::dvec2 low = (glm::min(glm::dvec2(a), glm::min(glm::dvec2(b), glm::dvec2(c))) - least_) /
                               cell_m_,
                         high = (glm::max(glm::dvec2(a), glm::max(glm::dvec2(b), glm::dvec2(c))) - least_) /
                                cell_m_;
        const glm::ivec2 from = glm::max(glm::ivec2(glm::ceil(low - 1e-9)), glm::ivec2(0)),
                         to = glm::min(glm::ivec2(glm::floor(high + 1e-9)), count_ - 1);
        constexpr double kEdge = -1e-9;  // nodes on an edge belong to both sides
        for (int y = from.y; y <= to.y; ++y)
            for (int x = from.x; x <= to.x; ++x) {
                const glm::dvec2 p = least_ + cell_m_ * glm::dvec2(x, y) - glm::dvec2(a);
                const double u = (p.x * ac.y - p.y * ac.x) / area, v = (ab.x * p.y - ab.y * p.x) / area;
                if (u < kEdge || v < kEdge || u + v > 1.0 - kEdge) continue;
                float& lowest = lowest_[static_cast<std::size_t>(y) * count_.x + x];
                lowest = std::min(lowest, static_cast<float>(a.z + u * (b.z - a.z) + v * (c.z - a.z)));
            }
    }

    glm::dvec2 least_, size_;
    double cell_m_ = 1.0;
    glm::ivec2 count_{0};
    std::vector<float> lowest_;
};

// A body's cut at one height: whether a place in it is in the hull.
//
// A level way meets something if the farthest of all that lies in its line is ahead. So each of the eight directions has, by lines side by side,
// how far the cut goes along it: no place needs a ray.
class Cut {
  public:
    Cut(const ObjectMesh& mesh, double height_m)
        : height_m_(height_m), least_(mesh.least_m()), most_(mesh.most_m()), middle_(0.5 * (least_ + most_)) {
        const glm::dvec2 half = 0.5 * (most_ - least_);
        for (int side = 0; side < kSides; ++side) {
            Direction& way = ways_[static_cast<std::size_t>(side)];
            const double angle = kTwoPi * (side + 0.5) / kSides;
            way.along = {std::cos(angle), std::sin(angle)};
            way.reach_m = std::abs(way.along.y) * half.x + std::abs(way.along.x) * half.y;
            way.farthest.assign(kLines, static_cast<float>(-kInfinity));
        }
    }

    // A triangle of the mesh.
    void add(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        const auto cut = cut_of(a, b, c);
        if (!cut) return;
        is_empty_ = false;
        for (Direction& way : ways_) way.add({cut->from - middle_, cut->to - middle_});
    }

    bool is_empty() const { return is_empty_; }
    bool holds(const glm::dvec2& place, const Bottom& bottom) const {
        if (glm::any(glm::lessThan(place, least_)) || glm::any(glm::greaterThan(place, most_))) return false;
        if (!(bottom.near(place) < height_m_)) return false;
        int met = 0;
        for (const Direction& way : ways_) met += way.meets(place - middle_);
        return met >= kEnough;
    }

  private:
    static constexpr int kLines = 2048;
    struct Direction {
        glm::dvec2 along{1.0, 0.0};
        double reach_m = 1.0;
        std::vector<float> farthest;

        double line_of(const glm::dvec2& p) const {
            const double across = along.x * p.y - along.y * p.x;
            return (across / reach_m + 1.0) * (0.5 * kLines) - 0.5;
        }
        void add(const Segment& segment) {
            double a = line_of(segment.from), b = line_of(segment.to);
            double far_a = glm::dot(along, segment.from), far_b = glm::dot(along, segment.to);
            if (a > b) std::swap(a, b), std::swap(far_a, far_b);
            const int from = std::max(static_cast<int>(std::ceil(a)), 0),
                      to = std::min(static_cast<int>(std::floor(b)), kLines - 1);
            for (int line = from; line <= to; ++line) {
                const double t = b > a ? (line - a) / (b - a) : 0.0;
                float& most = farthest[static_cast<std::size_t>(line)];
                most = std::max(most, static_cast<float>(far_a + t * (far_b - far_a)));
            }
        }
        bool meets(const glm::dvec2& p) const {
            const int line = std::clamp(static_cast<int>(std::lround(line_of(p))), 0, kLines - 1);
            return static_cast<double>(farthest[static_cast<std::size_t>(line)]) > glm::dot(along, p);
        }
    };

    std::optional<Segment> cut_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const {
        std::array<glm::dvec2, 2> at{};
        int found = 0;
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
            if ((from.z < height_m_) == (to.z < height_m_)) continue;
            // From the lower end, so that both triangles of an edge have the same point.
            const auto& [low, high] = from.z < to.z ? std::pair(from, to) : std::pair(to, from);
            const double t = (height_m_ - low.z) / (high.z - low.z);
            at[static_cast<std::size_t>(found++)] =
                glm::dvec2(low) + t * (glm::dvec2(high) - glm::dvec2(low));
        }
        if (found != 2) return std::nullopt;
        return Segment{at[0], at[1]};
    }

    double height_m_;
    glm::dvec2 least_, most_, middle_;
    std::array<Direction, kSides> ways_;
    bool is_empty_ = true;
};

// Signed distances over the nodes of one level.
class LevelDistances {
  public:
    LevelDistances(const Cut& cut, const Bottom& bottom, glm::dvec2 first_m, double cell_m, glm::ivec2 count)
        : first_m_(first_m), cell_m_(cell_m), count_(count) {
        if (cut.is_empty()) return;
        inside_.resize(static_cast<std::size_t>(count.x) * count.y);
        for (int y = 0; y < count.y; ++y)
            for (int x = 0; x < count.x; ++x) {
                inside_[index(x, y)] = cut.holds(place(x, y), bottom);
                is_any_ = is_any_ || inside_[index(x, y)];
            }
        if (is_any_) find_outline(cut, bottom), spread();
    }

    bool is_any() const { return is_any_; }
    void write(std::span<float> to, double farthest_m) const {
        for (int y = 0; y < count_.y; ++y)
            for (int x = 0; x < count_.x; ++x) {
                double distance_m = farthest_m;
                if (is_any_) {
                    const int near = nearest_[index(x, y)];
                    if (near >= 0)
                        distance_m = std::min(
                            distance_to(place(x, y), outline_[static_cast<std::size_t>(near)]), farthest_m);
                    if (inside_[index(x, y)]) distance_m = -distance_m;
                }
                to[index(x, y)] = static_cast<float>(distance_m);
            }
    }

  private:
    std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * count_.x + x; }
    glm::dvec2 place(int x, int y) const { return first_m_ + cell_m_ * glm::dvec2(x, y); }

    // Where the outline crosses the way from one node to the next.
    std::optional<glm::dvec2> crossing(glm::ivec2 a, glm::ivec2 b, const Cut& cut,
                                       const Bottom& bottom) const {
        if (inside_[index(a.x, a.y)] == inside_[index(b.x, b.y)]) return std::nullopt;
        if (!inside_[index(a.x, a.y)]) std::swap(a, b);
        glm::dvec2 in = place(a.x, a.y), out = place(b.x, b.y);
        constexpr int kHalvings = 7;
        for (int i = 0; i < kHalvings; ++i) {
            const glm::dvec2 middle = 0.5 * (in + out);
            (cut.holds(middle, bottom) ? in : out) = middle;
        }
        return 0.5 * (in + out);
    }

    // A piece or two in each square that the outline goes through (marching squares).
    void find_outline(const Cut& cut, const Bottom& bottom) {
        nearest_.assign(inside_.size(), -1);
        for (int y = 0; y + 1 < count_.y; ++y)
            for (int x = 0; x + 1 < count_.x; ++x) {
                const std::array<glm::ivec2, 5> round{
                    {{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}, {x, y}}};
                std::array<glm::dvec2, 4> at{};
                std::size_t found = 0;
                for (std::size_t side = 0; side < 4; ++side)
                    if (const auto crossed = crossing(round[side], round[side + 1], cut, bottom))
                        at[found++] = *crossed;
                for (std::size_t i = 0; i + 1 < found; i += 2) {
                    outline_.push_back({at[i], at[i + 1]});
                    for (std::size_t corner = 0; corner < 4; ++corner)
                        offer(round[corner].x, round[corner].y, static_cast<int>(outline_.size()) - 1);
                }
            }
    }

    void offer(int x, int y, int piece) {
        int& nearest = nearest_[index(x, y)];
        if (piece < 0 || piece == nearest) return;
        if (nearest < 0 || distance_to(place(x, y), outline_[static_cast<std::size_t>(piece)]) <
                               distance_to(place(x, y), outline_[static_cast<std::size_t>(nearest)]))
            nearest = piece;
    }

    // Each node takes over what its neighbours know (Danielsson 1980), there and back.
    void spread() {
        const auto take = [&](int x, int y, int dx, int dy) {
            if (x + dx < 0 || x + dx >= count_.x || y + dy < 0 || y + dy >= count_.y) return;
            offer(x, y, nearest_[index(x + dx, y + dy)]);
        };
        for (int pass = 0; pass < 2; ++pass) {
            const int way = pass % 2 == 0 ? 1 : -1;
            for (int j = 0; j < count_.y; ++j) {
                const int y = way > 0 ? j : count_.y - 1 - j;
                for (int i = 0; i < count_.x; ++i) {
                    const int x = way > 0 ? i : count_.x - 1 - i;
                    take(x, y, -way, 0), take(x, y, 0, -way), take(x, y, -way, -way), take(x, y, way, -way);
                }
                for (int i = count_.x - 1; i >= 0; --i) take(way > 0 ? i : count_.x - 1 - i, y, way, 0);
            }
        }
    }

    glm::dvec2 first_m_;
    double cell_m_;
    glm::ivec2 count_;
    std::vector<char> inside_;
    std::vector<int> nearest_;
    std::vector<Segment> outline_;
    bool is_any_ = false;
};

}  // namespace

Hull::Hull(const ObjectMesh& mesh) : lowest_m_(mesh.least_m().z), highest_m_(mesh.most_m().z) {
    const glm::dvec2 least(mesh.least_m()), size = glm::dvec2(mesh.most_m()) - least;
    beam_m_ = std::min(size.x, size.y);
    const double length_m = std::max(size.x, size.y), height_m = highest_m_ - lowest_m_;
    if (!(beam_m_ > 0.0 && height_m > 0.0)) return;  // a sheet
    constexpr double kAlong = 160.0, kAcross = 48.0, kMostAlong = 512.0;
    cell_m_ = std::max(std::min(length_m / kAlong, beam_m_ / kAcross), length_m / kMostAlong);
    level_m_ = height_m / kLevels;
    margin_m_ = 0.25 * beam_m_;
    const glm::ivec2 around(static_cast<int>(std::ceil(margin_m_ / cell_m_)));
    first_m_ = least - cell_m_ * glm::dvec2(around);
    columns_ = glm::ivec2(glm::ceil(size / cell_m_)) + 1 + 2 * around;
    const std::size_t a_level = static_cast<std::size_t>(columns_.x) * columns_.y;
    const Bottom bottom(mesh);
    std::vector<float> distance_m(a_level * kLevels);
    std::array<char, kLevels> is_any{};
    // Some levels at a time: each goes through the triangles once.
    constexpr int kTogether = 12;
    static_assert(kLevels % kTogether == 0);
    tbb::parallel_for(0, kLevels / kTogether, [&](int group) {
        const int first = group * kTogether;
        std::vector<Cut> cuts;
        for (int i = 0; i < kTogether; ++i) cuts.emplace_back(mesh, lowest_m_ + (first + i + 0.5) * level_m_);
        const ObjectMeshData& data = mesh.data();
        for (std::size_t i = 0; i < data.triangles.size(); i += 3) {
            const glm::dvec3 a = corner_of(data, i), b = corner_of(data, i + 1), c = corner_of(data, i + 2);
            const double low = (std::min({a.z, b.z, c.z}) - lowest_m_) / level_m_ - 0.5 - first,
                         high = (std::max({a.z, b.z, c.z}) - lowest_m_) / level_m_ - 0.5 - first;
            // A level more on each side, for what is rounded.
            const int from = static_cast<int>(std::max(std::floor(low), 0.0)),
                      to = static_cast<int>(std::min(std::ceil(high), kTogether - 1.0));
            for (int level = from; level <= to; ++level) cuts[static_cast<std::size_t>(level)].add(a, b, c);
        }
        for (int i = 0; i < kTogether; ++i) {
            const auto level = static_cast<std::size_t>(first + i);
            const LevelDistances distances(cuts[static_cast<std::size_t>(i)], bottom, first_m_, cell_m_,
                                           columns_);
            is_any[level] = distances.is_any();
            distances.write(std::span(distance_m).subspan(a_level * level, a_level), margin_m_ + beam_m_);
        }
    });
    if (std::ranges::none_of(is_any, [](char any) { return any != 0; })) return;
    distance_m_ = std::move(distance_m);
    bottom_m_.resize(a_level);
    for (int y = 0; y < columns_.y; ++y)
        for (int x = 0; x < columns_.x; ++x) {
            const glm::dvec2 place = first_m_ + cell_m_ * glm::dvec2(x, y);
            const bool is_in_box = glm::all(glm::greaterThanEqual(place, least)) &&
                                   glm::all(glm::lessThanEqual(place, least + size));
            bottom_m_[static_cast<std::size_t>(y) * columns_.x + x] =
                static_cast<float>(is_in_box ? bottom.near(place) : kInfinity);
        }
}

double Hull::distance_m(const glm::dvec3& place) const {
    if (!keeps_water_out() || !(place.z >= lowest_m_ && place.z <= highest_m_)) return kInfinity;
    const glm::dvec2 at = (glm::dvec2(place) - first_m_) / cell_m_;
    if (!(at.x >= 0.0 && at.y >= 0.0 && at.x <= columns_.x - 1 && at.y <= columns_.y - 1)) return kInfinity;
    const int x = std::min(static_cast<int>(at.x), columns_.x - 2),
              y = std::min(static_cast<int>(at.y), columns_.y - 2);
    const double level = glm::clamp((place.z - lowest_m_) / level_m_ - 0.5, 0.0, kLevels - 1.0);
    const int low = std::min(static_cast<int>(level), kLevels - 2);
    const glm::dvec2 t = at - glm::dvec2(x, y);
    const auto over = [&](int of) {
        return glm::mix(glm::mix(node(of, x, y), node(of, x + 1, y), t.x),
                        glm::mix(node(of, x, y + 1), node(of, x + 1, y + 1), t.x), t.y);
    };
    return glm::mix(over(low), over(low + 1), level - low);
}

glm::dvec2 Hull::outward(const glm::dvec3& place) const {
    const glm::dvec3 x(0.5 * cell_m_, 0.0, 0.0), y(0.0, 0.5 * cell_m_, 0.0);
    const glm::dvec2 way(distance_m(place + x) - distance_m(place - x),
                         distance_m(place + y) - distance_m(place - y));
    const double size = glm::length(way);
    return size > 0.0 && std::isfinite(size) ? way / size : glm::dvec2(0.0);
}

double Hull::above_bottom_m(const glm::dvec3& place) const {
    if (!keeps_water_out()) return kInfinity;
    const glm::dvec2 at = glm::round((glm::dvec2(place) - first_m_) / cell_m_);
    if (!(at.x >= 0.0 && at.y >= 0.0 && at.x < columns_.x && at.y < columns_.y)) return kInfinity;
    const auto bottom_m = static_cast<double>(
        bottom_m_[static_cast<std::size_t>(at.y) * columns_.x + static_cast<std::size_t>(at.x)]);
    return bottom_m < kInfinity ? place.z - bottom_m : kInfinity;
}

std::shared_ptr<const Hull> hull_of(const ObjectMesh& mesh) {
    static std::mutex mutex;
    static auto& known = *new std::map<std::string, std::weak_ptr<const Hull>>;  // by the meshes' content
    {
        const std::lock_guard lock(mutex);
        if (mesh.hull_) return mesh.hull_;
        if (const auto found = known.find(mesh.content()); found != known.end())
            if (auto hull = found->second.lock()) return mesh.hull_ = std::move(hull);
    }
    // Without the lock: a thread that waits inside for the others may be given work that asks for the same.
    auto made = std::make_shared<const Hull>(mesh);
    const std::lock_guard lock(mutex);
    std::erase_if(known, [](const auto& of) { return of.second.expired(); });
    known[mesh.content()] = made;
    return mesh.hull_ = std::move(made);
}

std::vector<std::size_t> hulls_of(const Scene& scene) {
    std::vector<std::size_t> hulls;
    for (std::size_t i = 0; i < scene.objects.size(); ++i)
        if (const auto& mesh = scene.objects[i].mesh; mesh && hull_of(*mesh)->keeps_water_out())
            hulls.push_back(i);
    return hulls;
}

std::string hulls_text(const Scene& scene, bool has_foam) {
    std::string text;
    for (const std::size_t i : hulls_of(scene)) {
        const SceneObject& object = scene.objects[i];
        text += "hull 1 " + object.mesh->content();
        for (const double value :
             {object.east_m, object.north_m, object.up_m, object.heading_deg, object.pitch_deg,
              object.roll_deg, object.scale, object.floats ? 1.0 : 0.0, has_foam ? object.foam : 0.0})
            text += ' ' + number_text(value);
        std::string path = object.path;
        CameraInterpolation interpolation = object.interpolation;
        if (object.vessel > 0) {
            const Vessel& vessel = scene.waves.vessels.at(static_cast<std::size_t>(object.vessel) - 1);
            path = vessel.path;
            interpolation = vessel.interpolation;
            text += " vessel";  // in the sea's time
        }
        if (object.floats && object.buoyancy == Buoyancy::Response)
            text += " response " + number_text(object.roll_damping);
        if (!path.empty())
            text += ' ' + quoted_text(path) +
                    (interpolation == CameraInterpolation::Smooth ? " smooth" : " linear");
        text += " fps " + number_text(scene.shot.fps) + '\n';
    }
    return text;
}

std::size_t hulls_bytes(const Scene& scene) {
    std::map<const Hull*, std::size_t> bytes;  // bodies of one mesh share it
    for (const std::size_t i : hulls_of(scene)) {
        const auto hull = hull_of(*scene.objects[i].mesh);
        bytes[hull.get()] = hull->bytes();
    }
    std::size_t all = 0;
    for (const auto& of : bytes) all += of.second;
    return all;
}

double contact_foam_m(const SceneObject& object, const Hull& hull) {
    // By eye: of a launch two decimetres, of a trawler a metre.
    constexpr double kOfBeam = 0.12, kWidest_m = 3.0;
    return std::min({kOfBeam * hull.beam_m() * object.scale, kWidest_m, hull.margin_m() * object.scale});
}

}  // namespace pelagic
