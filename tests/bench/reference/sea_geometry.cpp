// The reference's use of Embree. See sea_geometry.h.
#include "tests/bench/reference/sea_geometry.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "core/evaluate/evaluate.h"

namespace pelagic::bench {
namespace {

constexpr int kPatchCells = 64;      // per side of an Embree grid: u and v then have enough precision
constexpr double kMargin_m = 300.0;  // beside and behind the view, where reflected rays still meet waves

void* buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t bytes,
             std::size_t count) {
    void* memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, bytes, count);
    if (!memory) throw std::runtime_error("Embree has no memory for the sea: take fewer waves");
    return memory;
}

void attach(RTCScene scene, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

}  // namespace

EmbreeScene::EmbreeScene() : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

bool EmbreeScene::intersect(const SeaRay& ray, RTCRayHit& hit) const {
    hit.ray = {.org_x = ray.origin_m.x,
               .org_y = ray.origin_m.y,
               .org_z = ray.origin_m.z,
               .tnear = ray.from_m,
               .dir_x = ray.direction.x,
               .dir_y = ray.direction.y,
               .dir_z = ray.direction.z,
               .time = 0.0f,
               .tfar = 1e9f,
               .mask = ~0u,
               .id = 0u,
               .flags = 0u};
    hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &hit);
    return hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

FinestSea::FinestSea(const WaveTile& tile, const View& view, double reach_m, int cells)
    : tile_scene_(rtcNewScene(device_)),
      cell_m_(static_cast<float>(tile.size_m() / cells)),
      patches_(cells / kPatchCells) {
    const std::size_t side = static_cast<std::size_t>(cells) + 1;
    RTCGeometry waves = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_GRID);
    auto* vertices = static_cast<glm::vec3*>(
        buffer(waves, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), side * side));
    std::vector<glm::vec2> rest_m(side * side);
    for (std::size_t j = 0; j < side; ++j)
        for (std::size_t i = 0; i < side; ++i)
            rest_m[j * side + i] = cell_m_ * glm::vec2(static_cast<float>(i), static_cast<float>(j));
    Results<float> results;
    results.set(Product::Position, {vertices});
    evaluate(tile.frame(), kWhole, Points<float>{.count = rest_m.size(), .rest_m = {rest_m.data()}}, results);
    const auto patches = static_cast<std::size_t>(patches_);
    auto* grids = static_cast<RTCGrid*>(
        buffer(waves, RTC_BUFFER_TYPE_GRID, RTC_FORMAT_GRID, sizeof(RTCGrid), patches * patches));
    for (std::size_t j = 0; j < patches; ++j)
        for (std::size_t i = 0; i < patches; ++i)
            grids[j * patches + i] = {.startVertexID = static_cast<unsigned>((j * side + i) * kPatchCells),
                                      .stride = static_cast<unsigned>(side),
                                      .width = kPatchCells + 1,
                                      .height = kPatchCells + 1};
    attach(tile_scene_, waves);
    rtcSetSceneFlags(tile_scene_, RTC_SCENE_FLAG_ROBUST);  // no ray slips between two facets
    rtcCommitScene(tile_scene_);

    const glm::dvec2 ahead = glm::normalize(glm::dvec2(view.forward)), across(ahead.y, -ahead.x);
    const double size_m = tile.size_m();
    const int most = static_cast<int>(reach_m / size_m) + 2;
    for (int j = -most; j <= most; ++j)
        for (int i = -most; i <= most; ++i) {
            const glm::dvec2 middle = size_m * glm::dvec2(i + 0.5, j + 0.5) - glm::dvec2(view.position_m);
            const double forward_m = glm::dot(middle, ahead), aside_m = std::abs(glm::dot(middle, across));
            if (forward_m < -kMargin_m || forward_m > reach_m ||
                aside_m > kMargin_m + view.tan_half_width * std::max(forward_m, 0.0))
                continue;
            RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
            rtcSetGeometryInstancedScene(instance, tile_scene_);
            const auto x = static_cast<float>(size_m * i), y = static_cast<float>(size_m * j);
            const float rows[12] = {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, 0};
            rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
            attach(scene_, instance);
        }
    rtcCommitScene(scene_);
}

FinestSea::~FinestSea() {
    rtcReleaseScene(tile_scene_);
}

bool FinestSea::trace(const SeaRay& ray, SeaHit& hit) const {
    RTCRayHit found;
    if (!intersect(ray, found)) return false;
    const auto patch = static_cast<int>(found.hit.primID);
    const glm::vec2 first(static_cast<float>(patch % patches_), static_cast<float>(patch / patches_));
    hit.rest_m = (first + glm::vec2(found.hit.u, found.hit.v)) * (cell_m_ * kPatchCells);
    const glm::vec3 normal = glm::normalize(glm::vec3(found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z));
    hit.facet_normal = glm::dot(normal, ray.direction) > 0.0f ? -normal : normal;
    hit.distance_m = found.ray.tfar;
    return true;
}

ProjectedSea::ProjectedSea(const WaveTile& tile, const View& view, double cell_px)
    : grid_(projected_grid(view, {.cell_px = cell_px,
                                  .bounds = tile.bounds(),
                                  .significant_height_m = tile.whole().significant_height_m(),
                                  .unresolved = tile.unresolved_height()})),
      triangles_(projected_grid_triangles({grid_.columns, grid_.rows})) {
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<glm::vec3*>(
        buffer(mesh, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), grid_.rest_m.size()));
    Results<float> results;
    results.set(Product::Position, {vertices});
    evaluate(tile.frame(), kCells,
             Points<float>{.origin_m = grid_.origin_m,
                           .count = grid_.rest_m.size(),
                           .rest_m = {grid_.rest_m.data()},
                           .cell_m = {grid_.cell_m.data()},
                           .cell_axis_m = {grid_.cell_axis_m.data()}},
             results);
    auto* indices = static_cast<std::uint32_t*>(buffer(mesh, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                                       3 * sizeof(std::uint32_t), triangles_.size() / 3));
    std::copy(triangles_.begin(), triangles_.end(), indices);
    attach(scene_, mesh);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
}

bool ProjectedSea::trace(const SeaRay& ray, SeaHit& hit) const {
    RTCRayHit found;
    if (!intersect(ray, found)) return false;
    const std::uint32_t* corner = &triangles_[3 * static_cast<std::size_t>(found.hit.primID)];
    const float u = found.hit.u, v = found.hit.v;
    const auto at_hit = [&](const auto& values) {
        return (1.0f - u - v) * values[corner[0]] + u * values[corner[1]] + v * values[corner[2]];
    };
    hit.rest_m = at_hit(grid_.rest_m);
    hit.pixel_m = at_hit(grid_.pixel_m);
    hit.cell_m = at_hit(grid_.cell_m);
    hit.pixel_axis_m = at_hit(grid_.pixel_axis_m);
    hit.cell_axis_m = at_hit(grid_.cell_axis_m);
    hit.facet_normal = glm::normalize(glm::vec3(found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z));
    hit.distance_m = found.ray.tfar;
    return true;
}

}  // namespace pelagic::bench
