// pelagic_rays.so.
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "plugin/render/ray_scene.h"

namespace pelagic {
namespace {

struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<RTCDeviceTy, Release>;
using SceneHandle = std::unique_ptr<RTCSceneTy, Release>;
using Geometry = std::unique_ptr<RTCGeometryTy, Release>;

// What Embree has taken, now and at most.
struct Taken {
    std::atomic<std::ptrdiff_t> bytes{0}, most{0};
    static bool count(void* taken, ssize_t bytes, bool /*after*/) {
        Taken& of = *static_cast<Taken*>(taken);
        const std::ptrdiff_t now = of.bytes += bytes;
        std::ptrdiff_t before = of.most;
        while (now > before && !of.most.compare_exchange_weak(before, now)) {
        }
        return true;
    }
};

[[noreturn]] void refuse(RTCError error) {
    switch (error) {
        case RTC_ERROR_OUT_OF_MEMORY:
            throw std::bad_alloc();
        case RTC_ERROR_UNSUPPORTED_CPU:
            throw std::runtime_error(
                "Embree doesn't run on this CPU: pictures of shots with objects need SSE2");
        case RTC_ERROR_INVALID_ARGUMENT:
        case RTC_ERROR_INVALID_OPERATION:
            throw std::runtime_error("Embree refuses the objects (error " + std::to_string(error) +
                                     "): please report it with their meshes");
        default:
            throw std::runtime_error("Embree fails with its error " + std::to_string(error) +
                                     ": another version of Embree 3 may do");
    }
}

class EmbreeScene final : public RayScene {
  public:
    explicit EmbreeScene(std::span<const ObjectMesh* const> meshes)
        : device_(rtcNewDevice("set_affinity=0,start_threads=0")) {
        if (!device_) refuse(rtcGetDeviceError(nullptr));
        rtcSetDeviceMemoryMonitorFunction(device_.get(), &Taken::count, &taken_);
        scene_ = new_scene();
        for (const ObjectMesh* mesh : meshes) {
            // Bodies of one mesh share it.
            std::size_t same = 0;
            while (same < of_.size() && of_[same] != mesh) ++same;
            of_.push_back(mesh);
            shapes_.push_back(same < shapes_.size() ? shapes_[same] : shape_of(mesh->data()));
            Geometry instance(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
            check();
            rtcSetGeometryInstancedScene(instance.get(), shapes_.back().get());
            rtcAttachGeometryByID(scene_.get(), instance.get(), static_cast<unsigned>(instances_.size()));
            instances_.push_back(std::move(instance));
        }
        check();
    }

    void place(std::span<const glm::mat4x3> bodies) override {
        for (std::size_t i = 0; i < instances_.size(); ++i) {
            rtcSetGeometryTransform(instances_[i].get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                                    &bodies[i][0].x);
            rtcCommitGeometry(instances_[i].get());
        }
        rtcCommitScene(scene_.get());
        check();
    }

    RayHit nearest(const Ray& ray) const override {
        RTCRayHit met{};
        fill(met.ray, ray);
        met.hit.geomID = met.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_.get(), &context, &met);
        if (met.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        return {.body = static_cast<int>(met.hit.instID[0]),
                .triangle = met.hit.primID,
                .weights = {met.hit.u, met.hit.v},
                .distance_m = met.ray.tfar};
    }

    bool is_blocked(const Ray& ray) const override {
        RTCRay met{};
        fill(met, ray);
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(scene_.get(), &context, &met);
        return met.tfar < 0.0f;
    }

    std::size_t bytes() const override {
        return static_cast<std::size_t>(std::max<std::ptrdiff_t>(taken_.most, 0));
    }

  private:
    static void fill(RTCRay& to, const Ray& ray) {
        to.org_x = ray.from.x;
        to.org_y = ray.from.y;
        to.org_z = ray.from.z;
        to.tnear = ray.nearest_m;
        to.dir_x = ray.towards.x;
        to.dir_y = ray.towards.y;
        to.dir_z = ray.towards.z;
        to.tfar = ray.farthest_m;
        to.mask = ~0u;
    }

    void check() const {
        if (const RTCError error = rtcGetDeviceError(device_.get()); error != RTC_ERROR_NONE) refuse(error);
    }

    SceneHandle new_scene() const {
        SceneHandle scene(rtcNewScene(device_.get()));
        check();
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
        return scene;
    }

    std::shared_ptr<RTCSceneTy> shape_of(const ObjectMeshData& mesh) const {
        const Geometry shape(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
        check();
        // Embree reads four bytes past a buffer's last point: it has its own copy.
        auto* const points = static_cast<glm::vec3*>(
            rtcSetNewGeometryBuffer(shape.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    sizeof(glm::vec3), mesh.points_m.size()));
        auto* const corners = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(shape.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), mesh.triangles.size() / 3));
        check();
        if (!points || !corners) throw std::bad_alloc();
        std::copy(mesh.points_m.begin(), mesh.points_m.end(), points);
        std::copy(mesh.triangles.begin(), mesh.triangles.end(), corners);
        rtcCommitGeometry(shape.get());
        SceneHandle scene = new_scene();
        rtcAttachGeometryByID(scene.get(), shape.get(), 0);
        rtcCommitScene(scene.get());
        check();
        return std::shared_ptr<RTCSceneTy>(scene.release(), Release());
    }

    Taken taken_;  // outlives the device
    Device device_;
    std::vector<const ObjectMesh*> of_;
    std::vector<std::shared_ptr<RTCSceneTy>> shapes_;
    std::vector<Geometry> instances_;
    SceneHandle scene_;
};

}  // namespace
}  // namespace pelagic

extern "C" __attribute__((visibility("default"))) pelagic::RayScene* pelagic_ray_scene(
    const pelagic::ObjectMesh* const* meshes, std::size_t count) {
    return new pelagic::EmbreeScene(std::span(meshes, count));
}
