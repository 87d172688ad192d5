// The sea as a user geometry of Embree, beside a box that floats in it: what Embree finds is what the C interface and the box alone say.
#include "examples/trace/embree_sea.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tests/plugin/host/procedural/opened.h"

namespace pelagic {
namespace {

constexpr double kOpen_s = 3.0, kShutter_s = 0.5;
constexpr float kEnd = std::numeric_limits<float>::infinity();
constexpr std::array kOrigin_m{1200.0, -340.0, 0.0};

struct Ray {
    std::array<float, 3> from{}, towards{};
    float nearest = 0.0f, farthest = kEnd, time = 0.5f;
};
struct Found {
    float distance = kEnd;
    unsigned geometry = RTC_INVALID_GEOMETRY_ID;
    std::array<float, 2> place{};
    std::array<float, 3> normal{};
};

// From a point in all directions, as steep as from `least` to `most`; of all times.
std::vector<Ray> fan(float height_m, int columns, int rows, float least = -1.0f, float most = 0.1f) {
    std::vector<Ray> rays;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const float azimuth =
                6.2832f * (static_cast<float>(column) + 0.37f) / static_cast<float>(columns);
            const float rise = most - (most - least) * static_cast<float>(row) / static_cast<float>(rows);
            // Of any length: distances are counted in it.
            const float length = 0.5f + static_cast<float>((row + column) % 3);
            rays.push_back(
                {.from = {0.3f, -0.2f, height_m},
                 .towards = {length * std::cos(azimuth), length * std::sin(azimuth), length * rise},
                 .time = static_cast<float>(column % 5) / 4.0f});
        }
    return rays;
}

struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, ReleaseDevice>;
using Scene = std::unique_ptr<RTCSceneTy, ReleaseScene>;

// Of eight corners and twelve triangles, half under water.
RTCGeometry box(RTCDevice device) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corner = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float), 8));
    for (int i = 0; i < 8; ++i) {
        corner[3 * i] = 7.0f + ((i & 1) != 0 ? 4.0f : -4.0f);
        corner[3 * i + 1] = (i & 2) != 0 ? 3.0f : -3.0f;
        corner[3 * i + 2] = (i & 4) != 0 ? 1.5f : -1.5f;
    }
    constexpr std::array<unsigned, 36> kCorners{0, 1, 3, 0, 3, 2, 4, 7, 5, 4, 6, 7, 0, 5, 1, 0, 4, 5,
                                                2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};
    std::copy(kCorners.begin(), kCorners.end(),
              static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                             RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 12)));
    rtcCommitGeometry(geometry);
    return geometry;
}

class EmbreeSeaTest : public testing::Test {
  protected:
    static constexpr unsigned kSea = 7, kBox = 3;

    static void SetUpTestSuite() {
        pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
        options.finest_cell_m = options.finest_pixel_m = 0.25;
        shot = test::open_text("[sea]\nwind_speed_mps = 12.0\n", &options).release();
        frame = test::frame_of(test::SeaHandle(shot), kOpen_s, kOpen_s + kShutter_s).release();
    }
    static void TearDownTestSuite() { pelagic_frame_release(frame); }

    static EmbreeSea::Options options() {
        EmbreeSea::Options options;
        std::copy(kOrigin_m.begin(), kOrigin_m.end(), options.origin_m);
        options.finest_cell_m = 0.25;
        options.shutter_s = kShutter_s;
        return options;
    }

    Scene scene_of(EmbreeSea* sea, bool has_box) {
        Scene scene(rtcNewScene(device_.get()));
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
        if (sea) rtcAttachGeometryByID(scene.get(), sea->geometry(), kSea);
        if (has_box) {
            RTCGeometry geometry = box(device_.get());
            rtcAttachGeometryByID(scene.get(), geometry, kBox);
            rtcReleaseGeometry(geometry);
        }
        rtcCommitScene(scene.get());
        return scene;
    }

    // What the C interface says of each ray alone.
    static std::vector<Found> sea_alone(const std::vector<Ray>& rays, RayWidth width, bool on_earth = false) {
        std::vector<Found> all;
        for (const Ray& ray : rays) {
            const float time_s = ray.time * static_cast<float>(kShutter_s);
            pelagic_rays asked = PELAGIC_INIT(pelagic_rays);
            std::copy(kOrigin_m.begin(), kOrigin_m.end(), asked.origin_m);
            asked.count = 1;
            asked.offset_m = ray.from.data();
            asked.direction = ray.towards.data();
            asked.near = &ray.nearest;
            asked.far = &ray.farthest;
            asked.time_s = &time_s;
            asked.footprint_m = &width.footprint_m;
            asked.spread = &width.spread;
            asked.on_earth = on_earth ? 1 : 0;
            Found found;
            pelagic_values values = PELAGIC_INIT(pelagic_values);
            values.normal = found.normal.data();
            pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
            hits.distance = &found.distance;
            hits.rest_m = found.place.data();
            hits.values = &values;
            pelagic_error error;
            EXPECT_EQ(pelagic_intersect(frame, &asked, &hits, &error), PELAGIC_OK) << error.message;
            if (found.distance < kEnd) found.geometry = kSea;
            all.push_back(found);
        }
        return all;
    }

    static pelagic_sea* shot;
    static pelagic_frame* frame;
    Device device_{rtcNewDevice(nullptr)};
};
pelagic_sea* EmbreeSeaTest::shot = nullptr;
pelagic_frame* EmbreeSeaTest::frame = nullptr;

RTCRay embree_ray(const Ray& ray, unsigned id) {
    return {.org_x = ray.from[0],
            .org_y = ray.from[1],
            .org_z = ray.from[2],
            .tnear = ray.nearest,
            .dir_x = ray.towards[0],
            .dir_y = ray.towards[1],
            .dir_z = ray.towards[2],
            .time = ray.time,
            .tfar = ray.farthest,
            .mask = ~0u,
            .id = id,
            .flags = 0u};
}
RTCRayHit embree_query(const Ray& ray, unsigned id) {
    RTCRayHit query{};
    query.ray = embree_ray(ray, id);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}
Found found_in(const RTCRayHit& query) {
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {.distance = query.ray.tfar,
            .geometry = query.hit.geomID,
            .place = {query.hit.u, query.hit.v},
            .normal = {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}};
}

std::vector<Found> one_by_one(RTCScene scene, const std::vector<Ray>& rays, SeaRayContext& context) {
    std::vector<Found> all;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        RTCRayHit query = embree_query(rays[i], static_cast<unsigned>(i));
        rtcIntersect1(scene, &context.embree, &query);
        all.push_back(found_in(query));
    }
    return all;
}

// In packets of N, each third ray of which is left out; those that are keep what was there.
template <unsigned kWidth, class Packet, class Intersect>
std::vector<Found> in_packets(const std::vector<Ray>& rays, const Intersect& intersect) {
    std::vector<Found> all;
    for (std::size_t first = 0; first < rays.size(); first += kWidth) {
        alignas(64) std::array<int, kWidth> valid{};
        Packet packet;
        auto* rayhits = reinterpret_cast<RTCRayHitN*>(&packet);
        RTCRayN* to_rays = RTCRayHitN_RayN(rayhits, kWidth);
        RTCHitN* hits = RTCRayHitN_HitN(rayhits, kWidth);
        for (unsigned i = 0; i < kWidth; ++i) {
            const bool is_there = first + i < rays.size();
            valid[i] = is_there && (first + i) % 3 != 0 ? -1 : 0;
            const RTCRayHit query =
                embree_query(rays[is_there ? first + i : 0], static_cast<unsigned>(first + i));
            rtcCopyHitToHitN(hits, &query.hit, kWidth, i);
            RTCRayN_org_x(to_rays, kWidth, i) = query.ray.org_x;
            RTCRayN_org_y(to_rays, kWidth, i) = query.ray.org_y;
            RTCRayN_org_z(to_rays, kWidth, i) = query.ray.org_z;
            RTCRayN_dir_x(to_rays, kWidth, i) = query.ray.dir_x;
            RTCRayN_dir_y(to_rays, kWidth, i) = query.ray.dir_y;
            RTCRayN_dir_z(to_rays, kWidth, i) = query.ray.dir_z;
            RTCRayN_tnear(to_rays, kWidth, i) = query.ray.tnear;
            // Where a processor's vectors are shorter than the packet, Embree 3 looks at this alone, and not at `valid`.
            RTCRayN_tfar(to_rays, kWidth, i) = valid[i] ? query.ray.tfar : -kEnd;
            RTCRayN_time(to_rays, kWidth, i) = query.ray.time;
            RTCRayN_mask(to_rays, kWidth, i) = query.ray.mask;
            RTCRayN_id(to_rays, kWidth, i) = query.ray.id;
            RTCRayN_flags(to_rays, kWidth, i) = query.ray.flags;
        }
        intersect(valid.data(), &packet);
        for (unsigned i = 0; i < kWidth && first + i < rays.size(); ++i)
            all.push_back(found_in(rtcGetRayHitFromRayHitN(rayhits, kWidth, i)));
    }
    return all;
}

TEST_F(EmbreeSeaTest, RaysMeetWhicheverIsNearer) {
    EmbreeSea sea(device_.get(), frame, options());
    const Scene both = scene_of(&sea, true), only_box = scene_of(nullptr, true);
    const std::vector<Ray> rays = fan(4.0f, 40, 12);
    SeaRayContext context({.footprint_m = 0.02f, .spread = 0.003f});
    const std::vector<Found> found = one_by_one(both.get(), rays, context),
                             of_box = one_by_one(only_box.get(), rays, context),
                             of_sea = sea_alone(rays, context.width);
    int seas = 0, boxes = 0, none = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Found& expected = of_sea[i].distance < of_box[i].distance ? of_sea[i] : of_box[i];
        EXPECT_EQ(found[i].geometry, expected.geometry) << "ray " << i;
        EXPECT_EQ(found[i].distance, expected.distance) << "ray " << i;
        EXPECT_EQ(found[i].place, expected.place) << "ray " << i;
        EXPECT_EQ(found[i].normal, expected.normal) << "ray " << i;
        seas += found[i].geometry == kSea;
        boxes += found[i].geometry == kBox;
        none += found[i].geometry == RTC_INVALID_GEOMETRY_ID;
    }
    EXPECT_GT(seas, 100);
    EXPECT_GT(boxes, 20);
    EXPECT_GT(none, 20);
    EXPECT_EQ(sea.status(), PELAGIC_OK) << sea.message();
}

TEST_F(EmbreeSeaTest, PacketsOfAnySizeAgree) {
    EmbreeSea sea(device_.get(), frame, options());
    const Scene scene = scene_of(&sea, true);
    const std::vector<Ray> rays = fan(3.0f, 23, 9);
    std::vector<RayWidth> widths;
    for (std::size_t i = 0; i < rays.size(); ++i)
        widths.push_back({.footprint_m = 0.4f * static_cast<float>(i % 7), .spread = 0.004f});
    SeaRayContext context;
    context.widths = widths.data();
    const std::vector<Found> one = one_by_one(scene.get(), rays, context);
    const auto check = [&](const std::vector<Found>& found, bool with_gaps, const char* name) {
        ASSERT_EQ(found.size(), one.size());
        for (std::size_t i = 0; i < one.size(); ++i) {
            const Found& expected = with_gaps && i % 3 == 0 ? Found{} : one[i];
            EXPECT_EQ(found[i].geometry, expected.geometry) << name << ", ray " << i;
            if (expected.geometry == kSea) {
                EXPECT_EQ(found[i].distance, expected.distance) << name << ", ray " << i;
                EXPECT_EQ(found[i].place, expected.place) << name << ", ray " << i;
            }
        }
    };
    check(in_packets<4, RTCRayHit4>(rays,
                                    [&](const int* valid, RTCRayHit4* p) {
                                        rtcIntersect4(valid, scene.get(), &context.embree, p);
                                    }),
          true, "4");
    check(in_packets<8, RTCRayHit8>(rays,
                                    [&](const int* valid, RTCRayHit8* p) {
                                        rtcIntersect8(valid, scene.get(), &context.embree, p);
                                    }),
          true, "8");
    check(in_packets<16, RTCRayHit16>(rays,
                                      [&](const int* valid, RTCRayHit16* p) {
                                          rtcIntersect16(valid, scene.get(), &context.embree, p);
                                      }),
          true, "16");
    std::vector<RTCRayHit> stream;
    for (std::size_t i = 0; i < rays.size(); ++i)
        stream.push_back(embree_query(rays[i], static_cast<unsigned>(i)));
    rtcIntersect1M(scene.get(), &context.embree, stream.data(), static_cast<unsigned>(stream.size()),
                   sizeof(RTCRayHit));
    std::vector<Found> streamed;
    for (const RTCRayHit& query : stream) streamed.push_back(found_in(query));
    check(streamed, false, "1M");
    EXPECT_EQ(sea.status(), PELAGIC_OK) << sea.message();
}

TEST_F(EmbreeSeaTest, OccludedAreTheRaysThatMeetSomething) {
    EmbreeSea sea(device_.get(), frame, options());
    const Scene scene = scene_of(&sea, true);
    std::vector<Ray> rays = fan(2.5f, 31, 8);
    for (std::size_t i = 0; i < rays.size(); ++i)
        if (i % 2 == 0) rays[i].farthest = 12.0f;
    SeaRayContext context({.footprint_m = 0.02f, .spread = 0.003f});
    const std::vector<Found> found = one_by_one(scene.get(), rays, context);
    int blocked = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        RTCRay ray = embree_ray(rays[i], static_cast<unsigned>(i));
        rtcOccluded1(scene.get(), &context.embree, &ray);
        EXPECT_EQ(ray.tfar < 0.0f, found[i].geometry != RTC_INVALID_GEOMETRY_ID) << "ray " << i;
        blocked += ray.tfar < 0.0f;
    }
    EXPECT_GT(blocked, 50);
    EXPECT_LT(blocked, 200);
}

// Rejects what is nearer than the number that `user` points to; hits of the box, too, where it is the context's.
void reject_near(const RTCFilterFunctionNArguments* arguments) {
    const float nearest =
        *static_cast<const float*>(reinterpret_cast<const SeaRayContext*>(arguments->context)->user);
    for (unsigned i = 0; i < arguments->N; ++i)
        if (arguments->valid[i] != 0 && RTCRayN_tfar(arguments->ray, arguments->N, i) < nearest)
            arguments->valid[i] = 0;
}

TEST_F(EmbreeSeaTest, RaysGoOnBehindHitsThatAFilterRejects) {
    EmbreeSea sea(device_.get(), frame, options());
    const Scene scene = scene_of(&sea, false);
    // From between the waves, nearly level: many meet several.
    std::vector<Ray> rays = fan(1.0f, 60, 6, -0.05f, 0.03f);
    float nearest = 25.0f;
    SeaRayContext context({.footprint_m = 0.02f, .spread = 0.003f});
    context.user = &nearest;
    std::vector<Ray> behind = rays;
    for (Ray& ray : behind) ray.nearest = nearest;
    const std::vector<Found> first = sea_alone(rays, context.width),
                             expected = sea_alone(behind, context.width);
    for (const bool of_context : {false, true}) {
        context.embree.filter = of_context ? reject_near : nullptr;
        sea.set_filters(of_context ? nullptr : reject_near, of_context ? nullptr : reject_near);
        rtcCommitScene(scene.get());
        const std::vector<Found> found = one_by_one(scene.get(), rays, context);
        int second_hits = 0, other = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            // A surface that is touched within the tolerance of the border may count as either.
            other +=
                found[i].geometry != expected[i].geometry ||
                (expected[i].geometry == kSea && std::abs(found[i].distance - expected[i].distance) > 0.5f);
            second_hits += first[i].distance < nearest && found[i].geometry == kSea;
            EXPECT_FALSE(found[i].distance < nearest) << "ray " << i;
            RTCRay ray = embree_ray(rays[i], static_cast<unsigned>(i));
            rtcOccluded1(scene.get(), &context.embree, &ray);
            EXPECT_EQ(ray.tfar < 0.0f, found[i].geometry == kSea) << "ray " << i;
        }
        EXPECT_LE(other, 3);
        EXPECT_GT(second_hits, 10);
    }
    EXPECT_EQ(sea.status(), PELAGIC_OK) << sea.message();
}

TEST_F(EmbreeSeaTest, MovesOverTheShutter) {
    EmbreeSea sea(device_.get(), frame, options());
    const Scene scene = scene_of(&sea, false);
    SeaRayContext context({.footprint_m = 0.02f, .spread = 0.003f});
    std::vector<Ray> rays;
    for (const float time : {0.0f, 0.5f, 1.0f})
        for (int i = 0; i < 20; ++i)
            rays.push_back({.from = {static_cast<float>(3 * i), 0.0f, 20.0f},
                            .towards = {0.0f, 0.0f, -1.0f},
                            .time = time});
    const std::vector<Found> found = one_by_one(scene.get(), rays, context);
    const std::vector<Found> expected = sea_alone(rays, context.width);
    double moved_m = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(found[i].distance, expected[i].distance);
    for (std::size_t i = 0; i < 20; ++i)
        moved_m += std::abs(found[i].distance - found[40 + i].distance) / 20.0;
    EXPECT_GT(moved_m, 0.05);
}

TEST_F(EmbreeSeaTest, BendsWithTheEarth) {
    EmbreeSea::Options on_earth = options();
    on_earth.on_earth = true;
    EmbreeSea sea(device_.get(), frame, on_earth);
    const Scene scene = scene_of(&sea, false);
    // The horizon of 100 m is 0.0056 below the level, 36 km away.
    std::vector<Ray> rays;
    for (int i = 0; i < 40; ++i)
        rays.push_back(
            {.from = {0.0f, 0.0f, 100.0f}, .towards = {0.6f, 0.8f, -0.001f * static_cast<float>(i)}});
    SeaRayContext context({.footprint_m = 0.0f, .spread = 0.0005f});
    const std::vector<Found> found = one_by_one(scene.get(), rays, context),
                             expected = sea_alone(rays, context.width, true);
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(found[i].distance, expected[i].distance) << i;
    EXPECT_EQ(found[4].geometry, RTC_INVALID_GEOMETRY_ID);
    EXPECT_EQ(found[8].geometry, kSea);
    // At the ends of the default reach, 1000 km away along x or y, the sea is 78.5 km lower.
    RTCBounds bounds;
    rtcGetSceneBounds(scene.get(), &bounds);
    EXPECT_LT(bounds.lower_z, -78.4e3f);
    EXPECT_LT(bounds.upper_z, 30.0f);
    EXPECT_LE(bounds.lower_x, -1e6f);
    EXPECT_GE(bounds.upper_y, 1e6f);
}

TEST_F(EmbreeSeaTest, KeepsTheFirstErrorOfACallback) {
    EmbreeSea::Options wrong = options();
    wrong.tolerance = 100.0;
    EmbreeSea sea(device_.get(), frame, wrong);
    const Scene scene = scene_of(&sea, false);
    SeaRayContext context;
    const std::vector<Found> found = one_by_one(scene.get(), fan(4.0f, 5, 3), context);
    for (const Found& of : found) EXPECT_EQ(of.geometry, RTC_INVALID_GEOMETRY_ID);
    EXPECT_EQ(sea.status(), PELAGIC_INVALID_ARGUMENT);
    EXPECT_NE(std::string(sea.message()).find("tolerance"), std::string::npos) << sea.message();
}

}  // namespace
}  // namespace pelagic
