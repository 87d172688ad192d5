// Rays against the choppy sea, beside Embree over a mesh far finer than their tolerance: no hit is missed, none is invented.
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/plugin/host/procedural/opened.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kCell_m = 0.25;
constexpr float kForever = std::numeric_limits<float>::infinity();

// The exact surface over a square round a place of the world, as triangles a quarter of the finest cell wide.
class FineMesh {
  public:
    static constexpr int kSide = 1024;
    static constexpr float kStep_m = static_cast<float>(kCell_m / 4.0);

    FineMesh(const FrameHandle& frame, float shutter_s, glm::dvec2 origin_m)
        : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        const std::size_t count = std::size_t{kSide + 1} * (kSide + 1);
        std::vector<glm::vec2> rest_m;
        for (int y = 0; y <= kSide; ++y)
            for (int x = 0; x <= kSide; ++x)
                rest_m.emplace_back(static_cast<float>(x - kSide / 2) * kStep_m,
                                    static_cast<float>(y - kSide / 2) * kStep_m);
        const unsigned steps = shutter_s > 0.0f ? 2 : 1;
        rtcSetGeometryTimeStepCount(geometry, steps);
        for (unsigned step = 0; step < steps; ++step) {
            const std::vector<float> times_s(count, static_cast<float>(step) * shutter_s);
            auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
                geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), count));
            pelagic_points points = PELAGIC_INIT(pelagic_points);
            points.origin_m[0] = origin_m.x;
            points.origin_m[1] = origin_m.y;
            points.count = count;
            points.rest_m = &rest_m[0].x;
            points.time_s = times_s.data();
            pelagic_values values = PELAGIC_INIT(pelagic_values);
            values.position_m = &vertices[0].x;
            EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, nullptr), PELAGIC_OK);
            if (step == 0) open_.assign(vertices, vertices + count);
            if (step == 1) close_.assign(vertices, vertices + count);
        }
        auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                                       RTC_FORMAT_UINT3, 3 * sizeof(unsigned),
                                                                       std::size_t{2} * kSide * kSide));
        for (unsigned y = 0; y < kSide; ++y)
            for (unsigned x = 0; x < kSide; ++x) {
                const unsigned a = y * (kSide + 1) + x, b = a + 1, d = a + kSide + 1, c = d + 1;
                for (const unsigned corner : {a, b, c, a, c, d}) *corners++ = corner;
            }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene_);
        for (const glm::vec3& at : open_) reach_m_ = std::max(reach_m_, static_cast<double>(std::abs(at.z)));
    }
    ~FineMesh() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    FineMesh(const FineMesh&) = delete;
    FineMesh& operator=(const FineMesh&) = delete;

    double highest_m() const { return reach_m_; }
    // Where rays may be, so that no point from outside comes there.
    double half_m() const { return kSide / 2 * static_cast<double>(kStep_m) - 8.0; }
    glm::dvec3 point(std::size_t i) const { return glm::dvec3(open_[i % open_.size()]); }

    // Where a ray crosses it, and whether from above.
    struct Crossing {
        double at_m;
        bool is_from_above;
    };
    // The first from `near` on; at infinity if there is none.
    Crossing first(glm::dvec3 from, glm::dvec3 direction, double near, double far, float time) const {
        const glm::vec3 at(from + near * direction);
        RTCRayHit ray{};
        ray.ray = {at.x,
                   at.y,
                   at.z,
                   0.0f,
                   static_cast<float>(direction.x),
                   static_cast<float>(direction.y),
                   static_cast<float>(direction.z),
                   time,
                   static_cast<float>(far - near),
                   ~0u,
                   0,
                   0};
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_, &context, &ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID)
            return {std::numeric_limits<double>::infinity(), false};
        return {near + static_cast<double>(ray.ray.tfar),
                glm::dot(glm::dvec3(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z), direction) < 0.0};
    }

    // To the nearest point of the mesh [m], as far as `most_m`.
    double distance_m(glm::dvec3 from, double most_m, float time) const {
        const glm::vec3 at(from);
        RTCPointQuery query{at.x, at.y, at.z, time, static_cast<float>(most_m)};
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        Nearest nearest{this, at, time, static_cast<float>(most_m)};
        rtcPointQuery(scene_, &query, &context, &FineMesh::near_triangle, &nearest);
        return static_cast<double>(nearest.distance_m);
    }

  private:
    struct Nearest {
        const FineMesh* mesh;
        glm::vec3 at;
        float time, distance_m;
    };
    glm::vec3 vertex(std::size_t i, float time) const {
        return close_.empty() ? open_[i] : glm::mix(open_[i], close_[i], time);
    }
    static bool near_triangle(RTCPointQueryFunctionArguments* args) {
        Nearest& nearest = *static_cast<Nearest*>(args->userPtr);
        const unsigned cell = args->primID / 2, y = cell / kSide, x = cell % kSide;
        const std::size_t a = std::size_t{y} * (kSide + 1) + x, c = a + kSide + 2;
        const std::size_t b = args->primID % 2 == 0 ? a + 1 : a + kSide + 1;
        // So small a triangle is its corners and its middle, to an eighth of a cell.
        const glm::vec3 pa = nearest.mesh->vertex(a, nearest.time),
                        pb = nearest.mesh->vertex(b, nearest.time),
                        pc = nearest.mesh->vertex(c, nearest.time);
        // The distance to its plane, where the foot is inside; else to its edges.
        const glm::vec3 normal = glm::cross(pb - pa, pc - pa);
        const float area2 = glm::dot(normal, normal);
        const glm::vec3 to = nearest.at - pa;
        float distance_m = std::numeric_limits<float>::infinity();
        if (area2 > 0.0f) {
            const float u = glm::dot(glm::cross(to, pc - pa), normal) / area2,
                        v = glm::dot(glm::cross(pb - pa, to), normal) / area2;
            if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f)
                distance_m = std::abs(glm::dot(to, normal)) / std::sqrt(area2);
        }
        const glm::vec3 corners[] = {pa, pb, pc, pa};
        for (int i = 0; i < 3; ++i) {
            const glm::vec3 edge = corners[i + 1] - corners[i], way = nearest.at - corners[i];
            const float share =
                glm::clamp(glm::dot(way, edge) / std::max(glm::dot(edge, edge), 1e-20f), 0.0f, 1.0f);
            distance_m = std::min(distance_m, glm::length(way - share * edge));
        }
        if (distance_m >= nearest.distance_m) return false;
        nearest.distance_m = distance_m;
        args->query->radius = distance_m;
        return true;
    }

    RTCDevice device_;
    RTCScene scene_;
    std::vector<glm::vec3> open_, close_;
    double reach_m_ = 0.0;
};

struct Rays {
    std::vector<glm::vec3> offset_m, direction;
    std::vector<float> near, far, time_s, footprint_m, spread;
    void add(glm::dvec3 from, glm::dvec3 towards, double near_m, double far_m) {
        offset_m.emplace_back(from);
        direction.emplace_back(glm::normalize(towards));
        near.push_back(static_cast<float>(near_m));
        far.push_back(static_cast<float>(far_m));
    }
    std::size_t size() const { return near.size(); }
};

// Between the walls of the square that the mesh fills.
double way_inside_m(glm::dvec3 from, glm::dvec3 direction, double half_m) {
    double far_m = 1e4;
    for (int axis = 0; axis < 2; ++axis)
        if (direction[axis] != 0.0)
            far_m = std::min(far_m, std::max((half_m - from[axis]) / direction[axis],
                                             (-half_m - from[axis]) / direction[axis]));
    return std::max(far_m, 0.0);
}

enum class Kind { Down, Grazing, FromBelow, JustAbove, JustBelow, Upward, FromFarAway, AlongCrests };
constexpr Kind kKinds[] = {Kind::Down,      Kind::Grazing, Kind::FromBelow,   Kind::JustAbove,
                           Kind::JustBelow, Kind::Upward,  Kind::FromFarAway, Kind::AlongCrests};

Rays rays_of(Kind kind, const FineMesh& mesh, std::size_t count, std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const double half_m = mesh.half_m(), high_m = mesh.highest_m();
    Rays rays;
    while (rays.size() < count) {
        const glm::dvec3 place(half_m * unit(random), half_m * unit(random), 0.0);
        const double turn = 3.14159265358979 * unit(random);
        const glm::dvec3 level(std::cos(turn), std::sin(turn), 0.0), up(0.0, 0.0, 1.0);
        glm::dvec3 from = place, towards = level;
        double back_m = 0.0;
        // A point of the sea, and those of its neighbourhood that lie highest.
        glm::dvec3 on_sea = mesh.point(random());
        switch (kind) {
            case Kind::Down:
                from += up * (high_m + 20.0 + 15.0 * unit(random));
                towards = level * (1.0 + unit(random)) - up;
                break;
            case Kind::Grazing:
                from += up * high_m * unit(random);
                towards = level + 0.03 * unit(random) * up;
                break;
            case Kind::FromBelow:
                from -= up * (high_m + 10.0 + 9.0 * unit(random));
                towards = level * (2.0 + 2.0 * unit(random)) + up;
                break;
            case Kind::JustAbove:
            case Kind::JustBelow:
                from = on_sea +
                       up * ((kind == Kind::JustAbove ? 1.0 : -1.0) * kCell_m * (1.0 + 0.9 * unit(random)));
                towards = level + unit(random) * up;
                break;
            case Kind::Upward:
                from += up * (high_m + 1.0 + unit(random));
                towards = level * (1.0 + unit(random)) + up * (1e-6 + 1.0 + unit(random));
                break;
            case Kind::FromFarAway:
                from += up * high_m * unit(random);
                towards = level - up * (0.02 + 0.5 * (1.0 + unit(random)));
                back_m = 1e6;
                break;
            case Kind::AlongCrests: {
                for (int i = 0; i < 64; ++i) {
                    const glm::dvec3 other = mesh.point(random());
                    if (other.z > on_sea.z) on_sea = other;
                }
                from = on_sea + up * (kCell_m * unit(random));
                towards = level + 0.002 * unit(random) * up;
                break;
            }
        }
        if (std::max(std::abs(from.x), std::abs(from.y)) >= half_m) continue;
        towards = glm::dvec3(glm::vec3(glm::normalize(towards)));
        if (back_m > 0.0) {
            // The float that begins it decides where it goes.
            const glm::dvec3 begin(glm::vec3(from - back_m * towards));
            const double near_m = glm::dot(from - begin, towards),
                         inside_m = way_inside_m(begin + near_m * towards, towards, half_m);
            rays.add(begin, towards, near_m, near_m + inside_m);
        } else {
            rays.add(from, towards, 0.0, way_inside_m(from, towards, half_m));
        }
    }
    return rays;
}

struct Sea {
    const char* name;
    const char* text;
    double shutter_s;
    glm::dvec2 origin_m;
};
void PrintTo(const Sea& sea, std::ostream* os) {
    *os << sea.name;
}

class RaysAgainstMesh : public ::testing::TestWithParam<Sea> {};

TEST_P(RaysAgainstMesh, MeetTheSeaWhereItIs) {
    // As many as PELAGIC_RAYS says, in all; others by PELAGIC_SEED.
    const char *asked = std::getenv("PELAGIC_RAYS"), *seed = std::getenv("PELAGIC_SEED");
    const std::size_t count =
        (asked ? std::strtoul(asked, nullptr, 10) : 96000) / (2 * std::size(kKinds)) / 3;
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.finest_cell_m = options.finest_pixel_m = kCell_m;
    const SeaHandle sea = open_text(GetParam().text, &options);
    const auto shutter_s = static_cast<float>(GetParam().shutter_s);
    const FrameHandle frame = frame_of(sea, 7.0, 7.0 + GetParam().shutter_s);
    const FineMesh mesh(frame, shutter_s, GetParam().origin_m);
    std::mt19937 random(seed ? static_cast<unsigned>(std::strtoul(seed, nullptr, 10)) : 5);
    std::uniform_real_distribution<float> share(0.0f, 1.0f);
    constexpr double kTolerance = 0.5, kOfMesh_m = 0.02 * kCell_m;
    std::size_t hits = 0, touches = 0;
    double worst = 0.0;
    for (const Kind kind : kKinds)
        for (const float spread : {0.0f, 0.02f}) {
            if (kind == Kind::FromFarAway && spread > 0.0f) continue;  // a footprint of 20 km
            Rays rays = rays_of(kind, mesh, count, random);
            rays.spread.assign(rays.size(), spread);
            for (std::size_t i = 0; i < rays.size(); ++i) rays.time_s.push_back(shutter_s * share(random));
            pelagic_rays asks = PELAGIC_INIT(pelagic_rays);
            asks.origin_m[0] = GetParam().origin_m.x;
            asks.origin_m[1] = GetParam().origin_m.y;
            asks.count = rays.size();
            asks.offset_m = &rays.offset_m[0].x;
            asks.direction = &rays.direction[0].x;
            asks.near = rays.near.data();
            asks.far = rays.far.data();
            asks.time_s = rays.time_s.data();
            asks.spread = rays.spread.data();
            asks.tolerance = kTolerance;
            std::vector<float> distance(rays.size());
            std::vector<glm::vec2> rest_m(rays.size());
            pelagic_hits found = PELAGIC_INIT(pelagic_hits);
            found.distance = distance.data();
            found.rest_m = &rest_m[0].x;
            pelagic_error error;
            ASSERT_EQ(pelagic_intersect(frame.get(), &asks, &found, &error), PELAGIC_OK) << error.message;
            std::vector<unsigned char> occluded(rays.size());
            ASSERT_EQ(pelagic_occluded(frame.get(), &asks, occluded.data(), &error), PELAGIC_OK)
                << error.message;
            // Where the places of the hits are.
            pelagic_points points = PELAGIC_INIT(pelagic_points);
            points.origin_m[0] = GetParam().origin_m.x;
            points.origin_m[1] = GetParam().origin_m.y;
            points.count = rays.size();
            points.rest_m = &rest_m[0].x;
            points.time_s = rays.time_s.data();
            std::vector<glm::vec3> exact_m(rays.size());
            pelagic_values values = PELAGIC_INIT(pelagic_values);
            values.position_m = &exact_m[0].x;
            ASSERT_EQ(pelagic_evaluate(frame.get(), &points, &values, &error), PELAGIC_OK) << error.message;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const glm::dvec3 from(rays.offset_m[i]), direction(rays.direction[i]);
                const double near_m = rays.near[i], far_m = rays.far[i];
                const auto tolerance_m = [&](double s_m) {
                    return kTolerance * std::max(kCell_m, static_cast<double>(spread) * s_m) + kOfMesh_m;
                };
                const bool is_hit = distance[i] < kForever;
                ASSERT_EQ(occluded[i] != 0, is_hit);
                double at_m = far_m;
                if (is_hit) {
                    ++hits;
                    at_m = glm::dot(glm::dvec3(exact_m[i]) - from, direction);
                    const double off_m = glm::length(glm::dvec3(exact_m[i]) - from - at_m * direction);
                    worst = std::max(worst, off_m / (tolerance_m(at_m) - kOfMesh_m));
                    ASSERT_LE(off_m, tolerance_m(at_m)) << "kind " << static_cast<int>(kind) << " ray " << i;
                    // The exact place may lie behind the hit.
                    at_m = std::min(at_m, static_cast<double>(distance[i]) * (1.0 + 1e-7));
                }
                // One that begins within the tolerance may begin on the other side.
                const float time = shutter_s > 0.0f ? rays.time_s[i] / shutter_s : 0.0f;
                if (mesh.distance_m(from + near_m * direction, 2.0 * tolerance_m(near_m), time) <
                    tolerance_m(near_m))
                    continue;
                // What it crossed before: in as the first time, out the other way, never deeper than the tolerance.
                const FineMesh::Crossing in = mesh.first(from, direction, near_m, at_m, time);
                if (!(in.at_m < at_m - tolerance_m(at_m))) continue;
                ++touches;
                for (FineMesh::Crossing last = in; last.at_m < at_m;) {
                    const FineMesh::Crossing next = mesh.first(from, direction, last.at_m + 1e-4, at_m, time);
                    const double until_m = std::min(next.at_m, at_m);
                    for (int step = 0; step < 64 && last.is_from_above == in.is_from_above; ++step) {
                        const double s_m = last.at_m + (until_m - last.at_m) * (step + 0.5) / 64.0;
                        ASSERT_LT(mesh.distance_m(from + s_m * direction, 2.0 * tolerance_m(s_m), time),
                                  tolerance_m(s_m))
                            << "kind " << static_cast<int>(kind) << " ray " << i << " goes through at " << s_m
                            << " m of " << at_m;
                    }
                    last = next;
                }
            }
        }
    EXPECT_GT(hits, count * 4);
    std::printf(
        "%s: %zu hits, the worst %.2f of the tolerance away; %zu rays first touched a crest within it\n",
        GetParam().name, hits, worst, touches);
}

constexpr char kStorm[] = "[sea]\nwind_speed_mps = 22.0\n[waves]\nchoppiness = 1.2\n";
constexpr char kTrains[] = "[sea]\nwind_speed_mps = 9.0\n[waves]\nmodel = \"trochoid\"\n";
// A rough place, a lee and a rough picture within reach of each other.
constexpr char kPlaces[] =
    "[[waves.masks]]\neast_m = 8.0\nnorth_m = 0.0\nlength_m = 10.0\nwidth_m = 6.0\nedge_m = 8.0\nwaves = 2.0\n"
    "[[waves.masks]]\neast_m = -10.0\nnorth_m = 4.0\nlength_m = 12.0\nwidth_m = 12.0\nedge_m = 9.0\nwaves = 0.1\n"
    "[[waves.masks]]\neast_m = 2.0\nnorth_m = -6.0\nlength_m = 20.0\nwidth_m = 15.0\nedge_m = 4.0\nwaves = 1.8\n"
    "picture = \"" PELAGIC_SOURCE_DIR "/examples/data/tiles.exr\"\n";
// A calm that begins a kilometre east and is wider than what the tolerance is measured over.
constexpr char kCalmAfar[] =
    "[[waves.masks]]\neast_m = 51000.0\nnorth_m = 33000.0\nlength_m = 99000.0\nwidth_m = 99000.0\nedge_m = 500.0\n"
    "waves = 0.0\n";
INSTANTIATE_TEST_SUITE_P(Seas, RaysAgainstMesh,
                         ::testing::Values(Sea{"storm", kStorm, 0.0, {2e6, -7e5}},
                                           Sea{"places", kPlaces, 0.01, {}}, Sea{"shutter", "", 0.02, {}},
                                           Sea{"trains", kTrains, 0.0, {}},
                                           Sea{"calm_afar", kCalmAfar, 0.0, {}}),
                         [](const auto& sea) { return std::string(sea.param.name); });

}  // namespace
}  // namespace pelagic
