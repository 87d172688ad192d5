#include "scene.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <stdexcept>
#include <string>

namespace pelagic::trace {
namespace {

constexpr unsigned kSea = 0, kObject = 1, kPacket = 16;

std::size_t packets_of(std::size_t rays) {
    return (rays + kPacket - 1) / kPacket;
}

// Calls `packet` with each sixteen rays.
template <class Packet>
void in_packets(std::size_t rays, const Packet& packet) {
    constexpr std::size_t kGrain = 8;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, packets_of(rays), kGrain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            packet(i * kPacket, static_cast<unsigned>(std::min<std::size_t>(kPacket, rays - i * kPacket)));
    });
}

// Of a packet: which are rays, and how wide they are.
struct PacketState {
    alignas(64) std::array<int, kPacket> valid{};
    std::array<RayWidth, kPacket> widths;
    SeaRayContext context;

    PacketState() { context.widths = widths.data(); }
};

void fill(RTCRay16& to, unsigned i, const RayQuery& ray) {
    to.org_x[i] = ray.from.x;
    to.org_y[i] = ray.from.y;
    to.org_z[i] = ray.from.z;
    to.dir_x[i] = ray.towards.x;
    to.dir_y[i] = ray.towards.y;
    to.dir_z[i] = ray.towards.z;
    to.tnear[i] = ray.nearest_m;
    to.tfar[i] = ray.farthest_m;
    to.time[i] = 0.5f;
    to.mask[i] = ~0u;
    to.id[i] = i;
    to.flags[i] = 0u;
}

// Whether a closed surface is round a point: a ray from there meets it an odd number of times.
bool is_inside(RTCScene closed, const glm::vec3& point) {
    constexpr int kMost = 64;  // of surfaces that no ray gets through
    constexpr float kBehind_m = 1e-4f;
    float from_m = 0.0f;
    int met = 0;
    for (; met < kMost; ++met) {
        RTCRayHit up{};
        up.ray = {.org_x = point.x,
                  .org_y = point.y,
                  .org_z = point.z,
                  .tnear = from_m,
                  .dir_x = 0.0f,
                  .dir_y = 0.0f,
                  .dir_z = 1.0f,
                  .time = 0.0f,
                  .tfar = 1e9f,
                  .mask = ~0u,
                  .id = 0u,
                  .flags = 0u};
        up.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(closed, &context, &up);
        if (up.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
        from_m = std::max(up.ray.tfar + kBehind_m, std::nextafter(up.ray.tfar, 1e9f));
    }
    return met % 2 == 1;
}

// Rejects hits of the water inside the closed surface that the context's `user` is a scene of.
void reject_dry(const RTCFilterFunctionNArguments* arguments) {
    const auto& context = *reinterpret_cast<const SeaRayContext*>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] == 0) continue;
        const RTCRay hit = rtcGetRayFromRayN(arguments->ray, arguments->N, i);
        const glm::vec3 place = glm::vec3(hit.org_x, hit.org_y, hit.org_z) +
                                hit.tfar * glm::vec3(hit.dir_x, hit.dir_y, hit.dir_z);
        if (is_inside(static_cast<RTCScene>(context.user), place)) arguments->valid[i] = 0;
    }
}

// Embree says what went wrong when it is asked.
void check_device(RTCDevice device) {
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE)
        throw std::runtime_error("Embree has no memory for the scene");
}

}  // namespace

TracedScene::TracedScene(const pelagic_frame* frame, EmbreeSea::Options options, const FloatingObject* object,
                         const Placement& placement)
    : device_(rtcNewDevice(nullptr)) {
    if (!device_) throw std::runtime_error("Embree can't be started on this machine");
    sea_.emplace(device_.get(), frame, options);
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometryByID(scene_.get(), sea_->geometry(), kSea);
    if (object) {
        float_on(frame, options, *object, placement);
        object_scene_ = scene_of_mesh(shown_);
        rtcAttachGeometryByID(scene_.get(), rtcGetGeometry(object_scene_.get(), kObject), kObject);
        if (!dry_.triangles.empty()) {
            dry_scene_ = scene_of_mesh(dry_);
            sea_->set_filters(reject_dry, reject_dry);
        }
    }
    rtcCommitScene(scene_.get());
    check_device(device_.get());
}

TracedScene::Scene TracedScene::scene_of_mesh(const Mesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    void* points = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(glm::vec3), mesh.points.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              sizeof(glm::uvec3), mesh.triangles.size());
    if (!points || !triangles) {
        rtcReleaseGeometry(geometry);
        throw std::runtime_error("Embree has no memory for the object");
    }
    std::copy(mesh.points.begin(), mesh.points.end(), static_cast<glm::vec3*>(points));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<glm::uvec3*>(triangles));
    rtcCommitGeometry(geometry);
    Scene scene(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometryByID(scene.get(), geometry, kObject);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene.get());
    check_device(device_.get());
    return scene;
}

// On the plane that is nearest to the sea under the object: that of its heights at a grid of places, seen from above.
void TracedScene::float_on(const pelagic_frame* frame, const EmbreeSea::Options& options,
                           const FloatingObject& object, const Placement& placement) {
    constexpr int kSide = 5;
    glm::vec3 low(object.shown.points.front()), high = low;
    for (const glm::vec3& point : object.shown.points) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    const auto cosine = static_cast<float>(std::cos(placement.heading_rad)),
               sine = static_cast<float>(std::sin(placement.heading_rad));
    const glm::vec2 at(placement.at_m - glm::dvec2(options.origin_m[0], options.origin_m[1]));
    const auto turned = [&](glm::vec2 p) {
        return glm::vec2(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y);
    };
    constexpr float kAbove_m = 1000.0f;
    std::array<glm::vec2, kSide * kSide> places;
    std::array<glm::vec3, kSide * kSide> from, towards;
    std::array<float, kSide * kSide> width_m, distance_m;
    const float step_m = std::max(high.x - low.x, high.y - low.y) / kSide;
    for (int i = 0; i < kSide * kSide; ++i) {
        places[i] = glm::vec2(low) + glm::vec2(high - low) * (glm::vec2(i % kSide, i / kSide) + 0.5f) /
                                         static_cast<float>(kSide);
        from[i] = glm::vec3(at + turned(places[i]), kAbove_m);
        towards[i] = glm::vec3(0.0f, 0.0f, -1.0f);
        width_m[i] = step_m;
    }
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    std::copy_n(options.origin_m, 3, rays.origin_m);
    rays.count = places.size();
    rays.offset_m = &from[0].x;
    rays.direction = &towards[0].x;
    rays.footprint_m = width_m.data();
    rays.tolerance = 0.05;
    rays.on_earth = options.on_earth ? 1 : 0;
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    hits.distance = distance_m.data();
    pelagic_error error;
    if (pelagic_intersect(frame, &rays, &hits, &error) != PELAGIC_OK) throw std::runtime_error(error.message);
    // The places are symmetric about their middle: the plane's three numbers are means.
    const glm::vec2 middle = glm::vec2(low + high) * 0.5f;
    float height_m = 0.0f;
    glm::vec2 slope(0.0f), square(0.0f);
    for (int i = 0; i < kSide * kSide; ++i) {
        const float z = kAbove_m - distance_m[i];
        height_m += z / static_cast<float>(places.size());
        slope += z * (places[i] - middle);
        square += (places[i] - middle) * (places[i] - middle);
    }
    if (!std::isfinite(height_m))
        throw std::runtime_error("the object has no sea to float on where it stands");
    // A flat object has no slope across itself.
    for (int axis = 0; axis < 2; ++axis)
        slope[axis] = square[axis] > 0.0f ? slope[axis] / square[axis] : 0.0f;
    const glm::vec3 up = glm::normalize(glm::vec3(turned(-slope), 1.0f));
    const glm::vec3 ahead =
        glm::normalize(glm::vec3(cosine, sine, 0.0f) - up * glm::dot(up, glm::vec3(cosine, sine, 0.0f)));
    const glm::mat3 axes(ahead, glm::cross(up, ahead), up);
    const glm::vec3 place(at + turned(middle), height_m);
    const auto floating = [&](Mesh mesh) {
        for (glm::vec3& point : mesh.points) point = place + axes * (point - glm::vec3(middle, 0.0f));
        return mesh;
    };
    shown_ = floating(object.shown);
    dry_ = floating(object.dry);
}

void TracedScene::check() const {
    if (sea_->status() != PELAGIC_OK) throw std::runtime_error(std::string("rays: ") + sea_->message());
}

void TracedScene::trace_in(RTCScene scene, std::span<const RayQuery> rays,
                           std::span<RayAnswer> answers) const {
    in_packets(rays.size(), [&](std::size_t first, unsigned count) {
        PacketState state;
        state.context.user = dry_scene_.get();
        RTCRayHit16 packet{};
        for (unsigned i = 0; i < count; ++i) {
            state.valid[i] = -1;
            state.widths[i] = rays[first + i].width;
            fill(packet.ray, i, rays[first + i]);
            packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(state.valid.data(), scene, &state.context.embree, &packet);
        for (unsigned i = 0; i < count; ++i) {
            RayAnswer& answer = answers[first + i];
            answer = {};
            if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
            answer.met = packet.hit.geomID[i] == kSea ? Met::Sea : Met::Object;
            answer.distance_m = packet.ray.tfar[i];
            answer.normal =
                glm::normalize(glm::vec3(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]));
            const glm::vec2 uv(packet.hit.u[i], packet.hit.v[i]);
            if (answer.met == Met::Sea) {
                answer.rest_m = uv;
                continue;
            }
            if (glm::dot(answer.normal, rays[first + i].towards) > 0.0f) answer.normal = -answer.normal;
            const glm::uvec3 corner = shown_.triangles[packet.hit.primID[i]];
            answer.albedo = (1.0f - uv.x - uv.y) * shown_.colours[corner.x] +
                            uv.x * shown_.colours[corner.y] + uv.y * shown_.colours[corner.z];
        }
    });
    check();
}

void TracedScene::trace(std::span<const RayQuery> rays, std::span<RayAnswer> answers) const {
    trace_in(scene_.get(), rays, answers);
}

void TracedScene::trace_object(std::span<const RayQuery> rays, std::span<RayAnswer> answers) const {
    if (object_scene_)
        trace_in(object_scene_.get(), rays, answers);
    else
        std::fill(answers.begin(), answers.end(), RayAnswer{});
}

void TracedScene::occluded(std::span<const RayQuery> rays, std::span<std::uint8_t> blocked) const {
    in_packets(rays.size(), [&](std::size_t first, unsigned count) {
        PacketState state;
        state.context.user = dry_scene_.get();
        RTCRay16 packet{};
        for (unsigned i = 0; i < count; ++i) {
            state.valid[i] = -1;
            state.widths[i] = rays[first + i].width;
            fill(packet, i, rays[first + i]);
        }
        rtcOccluded16(state.valid.data(), scene_.get(), &state.context.embree, &packet);
        for (unsigned i = 0; i < count; ++i) blocked[first + i] = packet.tfar[i] < 0.0f;
    });
    check();
}

}  // namespace pelagic::trace
