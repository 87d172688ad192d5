#include "plugin/render/objects.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <utility>

#include "core/base/random.h"
#include "core/plan/hulls.h"
#include "core/surface/earth.h"

namespace pelagic {
namespace {

constexpr float kPi_f = std::numbers::pi_v<float>;

// Rays of a pixel, over all its samples, and of a sample at least.
constexpr std::uint32_t kSunRays = 16, kSkyRays = 32, kLeastSunRays = 2, kLeastSkyRays = 4;
constexpr std::uint32_t kGlossRays = 8, kLeastGlossRays = 2;
constexpr float kBlur = 0.15f;  // [rad] of the sky, by eye: some of what 32 rays of a hemisphere are apart
constexpr std::uint32_t kOpenFacets = 4;  // that look at sky and sea, for each that asks what is before them
constexpr std::uint32_t kLampPlaces = 32, kLeastLampPlaces = 4, kLitPlaces = 16, kLeastLitPlaces = 2;
constexpr std::uint32_t kMetPlaces = 4;  // of what one ray meets
constexpr float kMostOfPlace = 16.0f;
constexpr float kFaintLamp = 1e-3f, kFaintMirrored = 1e-4f;  // beside what else there is
enum Use : std::uint32_t {
    kOfSun,
    kOfSky,
    kOfGloss,
    kOfFacets,
    kOfBounces,
    kOfGlossBounces,
    kOtherHalf,
    kOfLamps = 20,
    kOfVarnishedLamps,
    kOfMirroredLamps
};

// A coordinate system round a unit direction (Duff et al. 2017).
glm::mat3 axes_round(const glm::vec3& z) {
    const float sign = std::copysign(1.0f, z.z), a = -1.0f / (sign + z.z), b = z.x * z.y * a;
    return {glm::vec3(1.0f + sign * z.x * z.x * a, sign * b, -sign * z.x),
            glm::vec3(b, sign + z.y * z.y * a, -z.y), z};
}

glm::vec2 on_disc(glm::vec2 square) {
    const float radius = std::sqrt(square.x), angle = 2.0f * kPi_f * square.y;
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

// The mean light of rays, each of which meets a body or is open, where it is known what all would have in the mean if they were open. Half
// of them take turns with the other half, whose numbers know nothing of theirs. What chance gives a half too much or too little is taken
// off where all of the other half are open: asked of the same rays that would depend on this chance, and few rays had another mean than
// many. So what nothing hides has no grain, and what is closed in is dark.
class MeanLight {
  public:
    // light: of `open`, where it is, or of the body. Two rays at least.
    void add(const glm::vec3& open, const glm::vec3& light, bool is_open) {
        Half& half = halves_[count_++ % 2];
        ++half.count;
        half.all += open;
        half.light += light;
        half.open += is_open;
    }
    glm::vec3 of(const glm::vec3& expected) const {
        glm::vec3 sum(0.0f);
        for (std::size_t h = 0; h < 2; ++h) {
            const Half &half = halves_[h], &other = halves_[1 - h];
            sum += half.light;
            if (other.open == other.count) sum += static_cast<float>(half.count) * expected - half.all;
        }
        return sum / static_cast<float>(count_);  // below 0 where the halves disagree: others make up for it
    }
    bool is_any_open() const { return halves_[0].open + halves_[1].open > 0; }

  private:
    struct Half {
        glm::vec3 all{0.0f}, light{0.0f};
        int count = 0, open = 0;
    };
    std::array<Half, 2> halves_;
    std::size_t count_ = 0;
};
// The numbers of such rays, of which there is an even count.
struct TwoHalves {
    std::array<SampleNumbers::Places, 2> half;
    TwoHalves(const SampleNumbers& numbers, std::uint32_t use)
        : half{numbers.places(use), numbers.places(use + kOtherHalf)} {}
    glm::vec2 of(std::uint32_t k, std::uint32_t rays) const { return half[k % 2].of(k / 2, rays / 2); }
};

// What light from a direction gives a diffuse surface, and rays by the cosine.
VarnishPart facing(const glm::vec3& normal, const glm::vec3& direction) {
    const float cosine = std::max(glm::dot(normal, direction), 0.0f);
    return {cosine, cosine / kPi_f};
}

// Off a surface, by what single precision knows of the place.
float off_surface_m(const glm::vec3& place) {
    return 5e-4f + 4e-6f * glm::length(place);
}

}  // namespace

SampleNumbers::Places SampleNumbers::places(std::uint32_t what) const {
    constexpr std::uint64_t kKey =
        0x6f626a65637473;  // "objects": no other use of philox() shares its numbers
    const auto shift = philox({x, y, frame, what}, kKey);
    return {shift[0], shift[1], index};
}

glm::vec2 SampleNumbers::Places::of(std::uint32_t n, std::uint32_t rays) const {
    const std::uint32_t at = index * rays + n;
    const auto unit = [](std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; };
    // R2's two numbers, times 2³².
    return {unit(shift_x + at * 3242174889u), unit(shift_y + at * 2447445413u)};
}

LitObjects::LitObjects(const Scene& scene) : scene_(scene), lamps_(scene) {
    std::vector<const ObjectMesh*> meshes;
    for (const SceneObject& object : scene.objects) {
        meshes.push_back(object.mesh.get());
        // Radiance 1 is a thousand cd/m² by daylight; a sky's picture counts as if it were so.
        bodies_.push_back({.mesh = object.mesh.get(),
                           .colour = glm::vec3(object.colour),
                           .glow = static_cast<float>(1e-3 * object.glow_cd_m2),
                           .holdout = object.holdout,
                           .placed = {},
                           .caustics = static_cast<float>(object.caustics),
                           .pattern = {}});
    }
    rays_ = make_ray_scene(meshes);
}

std::size_t LitObjects::bytes(const Scene& scene) {
    std::vector<const ObjectMesh*> meshes;
    for (const SceneObject& object : scene.objects) meshes.push_back(object.mesh.get());
    return meshes.empty() ? 0 : ray_scene_bytes(meshes) + Lamps::bytes(scene);
}

bool LitObjects::has_caustics() const {
    return std::any_of(bodies_.begin(), bodies_.end(), [](const Body& body) { return body.caustics > 0.0f; });
}

template <class T>
void LitObjects::place(const Frame<T>& state, double frame, const Sea& sea) {
    origin_m_ = sea.origin_m;
    const double step_s = scene_.shot.time_scale / scene_.shot.fps;
    const int query = hulls_query(state.sea().plan()).value_or(SeaLight<T>::kQuery);
    std::vector<glm::mat4x3> transforms;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        Body& body = bodies_[i];
        const SceneObject& object = scene_.objects[i];
        const glm::dvec3 least = body.mesh->least_m(), most = body.mesh->most_m();
        for (const int beside : {-1, 1, 0}) {
            if (beside != 0 && !sea.has_motion) continue;
            const auto [pose, water_m] = place_object(
                state, scene_, object,
                {.query = query, .frame = frame + beside, .rest_m = sea.rest_m, .late_s = beside * step_s});
            Placed& placed = body.placed[beside + 1];
            const glm::dvec3 flat_m = pose.place_m - glm::dvec3(sea.origin_m, 0.0);
            const glm::dvec3 vertical = earth_up(glm::dvec2(flat_m), sea.curvature_per_m);
            placed.place_m = on_earth(flat_m, sea.curvature_per_m);
            for (int axis = 0; axis < 3; ++axis)
                placed.axes[axis] = pose.scale * from_level(pose.turn[axis], vertical);
            if (beside != 0) continue;
            body.water_m =
                static_cast<float>(on_earth(glm::dvec3(glm::dvec2(flat_m), water_m), sea.curvature_per_m).z);
            const glm::dvec3 half = 0.5 * pose.scale * (most - least);
            body.half_edges_m = {half.x * pose.turn[0], half.y * pose.turn[1], half.z * pose.turn[2]};
            body.middle_m = pose.place_m + pose.turn * (0.5 * pose.scale * (least + most));
            body.flat_water_m = water_m;
            body.waves_m = water_m - (sea.rest_m ? sea.rest_m(glm::dvec2(pose.place_m)) : 0.0);
        }
        const Placed& now = body.placed[1];
        if (!sea.has_motion) body.placed[0] = body.placed[2] = now;
        body.axes = glm::mat3(now.axes);
        body.into = glm::mat3(glm::inverse(now.axes));
        body.place = glm::vec3(now.place_m);
        body.centre = glm::vec3(now.place_m + now.axes * (0.5 * (least + most)));
        // A little more, for what single precision makes of it.
        body.radius =
            1.001f * static_cast<float>(glm::length(now.axes[0]) * 0.5 * glm::length(most - least)) +
            1e-5f * glm::length(body.centre);
        transforms.push_back({body.axes[0], body.axes[1], body.axes[2], body.place});
    }
    rays_->place(transforms);
    lamps_.place(transforms);
}
template void LitObjects::place(const Frame<float>&, double, const Sea&);
template void LitObjects::place(const Frame<double>&, double, const Sea&);

template <class T>
void LitObjects::light(const SeaLight<T>& sea) {
    sky_ = &sea.sky();
    water_ = &sea.water();
    choice_ = sea.choice();
    const float radius = sky_->sun_angular_radius;
    beam_ = choice_.sun ? kPi_f * radius * radius * sky_->sun_radiance : glm::vec3(0.0f);
    to_sun_ = sky_->sun_direction;
    const glm::mat3 round = axes_round(to_sun_);
    sun_side_ = radius * round[0];
    sun_rise_ = radius * round[1];
    std::vector<glm::vec3> to_eye;
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            const float root = std::max(static_cast<float>(row) / (kRows - 1), 0.02f), z = root * root;
            const float azimuth = 2.0f * kPi_f * static_cast<float>(column) / kColumns;
            const float level = std::sqrt(1.0f - z * z);
            to_eye.emplace_back(level * std::cos(azimuth), level * std::sin(azimuth), z);
        }
    std::vector<SeaRadiance> light(to_eye.size());
    for (const bool lit : {false, true}) {
        sea.light_from_afar(to_eye, lit, light);
        sea_[lit].resize(light.size());
        std::transform(light.begin(), light.end(), sea_[lit].begin(), radiance_of);
    }
    sun_in_sea_.clear();
    if (has_caustics())
        for (const SeaRadiance& of : light) sun_in_sea_.push_back(of.sun);
    find_irradiance();
    constexpr float kStep_m = 0.5f, kFarthest_m = 64.0f, kLeast = 0.01f;
    sight_in_water_m_ = kStep_m;
    const auto most = [](const glm::vec3& of) { return std::max({of.x, of.y, of.z}); };
    while (sight_in_water_m_ < kFarthest_m && most(water_lets_through(*water_, sight_in_water_m_)) > kLeast)
        sight_in_water_m_ *= 1.25f;
}
template void LitObjects::light(const SeaLight<float>&);
template void LitObjects::light(const SeaLight<double>&);

template <class T>
void LitObjects::find_caustics(const SeaLight<T>& sea, const Seen& seen, const std::atomic<bool>* cancel) {
    const bool has_sun = beam_ != glm::vec3(0.0f);
    const glm::vec3 waves = has_sun && has_caustics() ? sea.wave_slopes() : glm::vec3(0.0f);
    for (Body& body : bodies_) {
        if (!(body.caustics > 0.0f)) continue;
        if (!has_sun) {
            body.pattern.clear();
            continue;
        }
        const glm::dmat3& half = body.half_edges_m;
        const double away_m =
            std::max(glm::length(body.middle_m - seen.eye_m) - glm::length(half[0] + half[1] + half[2]), 0.0);
        body.pattern.find(
            sea.frame(),
            {.sun = {.to_sun = to_sun_, .angular_radius = sky_->sun_angular_radius, .waves = waves},
             .middle_m = body.middle_m - glm::dvec3(0.0, 0.0, body.flat_water_m),
             .half_edges_m = half,
             .level_m = body.waves_m,
             .finest_m = std::max(seen.finest_m, seen.pixel_tangent * away_m),
             .finest_cell_m = seen.finest_cell_m},
            cancel);
    }
}
template void LitObjects::find_caustics(const SeaLight<float>&, const Seen&, const std::atomic<bool>*);
template void LitObjects::find_caustics(const SeaLight<double>&, const Seen&, const std::atomic<bool>*);

// By the normal, of the sky and sea that rays see. The nine numbers of ObjectSurroundings err by some per cent where the sun glitters on the
// sea: the rays' means would have other light than what they stand for.
void LitObjects::find_irradiance() {
    constexpr int kSide = 64;  // of a square round the horizon's circle in the sky's map
    constexpr float kStep = 2.0f / kSide;
    using Directions = std::vector<std::pair<glm::vec3, glm::vec3>>;  // with light across them
    Directions all, of_sun;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const glm::vec2 u(-1.0f + kStep * (static_cast<float>(i) + 0.5f),
                              -1.0f + kStep * (static_cast<float>(j) + 0.5f));
            if (glm::dot(u, u) > 1.0f) continue;
            const glm::vec3 d = sky_map_direction(u), down(d.x, d.y, -d.z);
            const float solid_angle = (1.0f + d.z) * (1.0f + d.z) * kStep * kStep;
            all.emplace_back(d, solid_angle * sky(d, kBlur));
            all.emplace_back(down, solid_angle * sea(-down, true));
            if (!sun_in_sea_.empty()) of_sun.emplace_back(down, solid_angle * mirrored_sun(-down));
        }
    irradiance_.clear();
    sun_irradiance_.clear();
    const auto falls_on = [](const glm::vec3& normal, const Directions& directions) {
        glm::vec3 sum(0.0f);
        for (const auto& [from, light] : directions) sum += std::max(glm::dot(from, normal), 0.0f) * light;
        return sum;
    };
    for (int row = 0; row < kNormalRows; ++row)
        for (int column = 0; column < kNormalColumns; ++column) {
            const float high = kPi_f * static_cast<float>(row) / (kNormalRows - 1),
                        round = 2.0f * kPi_f * static_cast<float>(column) / kNormalColumns;
            const glm::vec3 normal(std::sin(high) * std::cos(round), std::sin(high) * std::sin(round),
                                   std::cos(high));
            irradiance_.push_back(falls_on(normal, all));
            if (!of_sun.empty()) sun_irradiance_.push_back(falls_on(normal, of_sun));
        }
}

glm::vec3 LitObjects::by_normal(const std::vector<glm::vec3>& table, const glm::vec3& normal) {
    const float row = std::acos(std::clamp(normal.z, -1.0f, 1.0f)) / kPi_f * (kNormalRows - 1);
    float column = std::atan2(normal.y, normal.x) / (2.0f * kPi_f) * kNormalColumns;
    if (!(column >= 0.0f)) column += kNormalColumns;
    const int low = std::clamp(static_cast<int>(row), 0, kNormalRows - 2), left = static_cast<int>(column);
    const auto at = [&](int r, int c) { return table[r * kNormalColumns + c % kNormalColumns]; };
    const float down = row - static_cast<float>(low), right = column - static_cast<float>(left);
    return glm::mix(glm::mix(at(low, left), at(low, left + 1), right),
                    glm::mix(at(low + 1, left), at(low + 1, left + 1), right), down);
}

float LitObjects::gathered(const Surface& at) const {
    const Body& body = bodies_[at.body];
    if (!(body.caustics > 0.0f)) return 0.0f;
    const glm::dvec3 place(origin_m_ + glm::dvec2(at.place), at.place.z - body.water_m);
    return std::max(body.caustics * (body.pattern.at(place) - 1.0f), -1.0f);
}

bool LitObjects::may_meet(const Ray& ray) const {
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& body) {
        const glm::vec3 way = body.centre - ray.from;
        const float along = glm::dot(way, ray.towards), away2 = glm::dot(way, way),
                    radius2 = body.radius * body.radius;
        return away2 <= radius2 ||
               (along > 0.0f && away2 - along * along <= radius2 && along - body.radius <= ray.farthest_m);
    });
}

RayHit LitObjects::nearest(const Ray& ray) const {
    return may_meet(ray) ? rays_->nearest(ray) : RayHit{};
}

bool LitObjects::is_blocked(const Ray& ray) const {
    return may_meet(ray) && rays_->is_blocked(ray);
}

// A boat's hull, open above or closed: what is over its bottom and, on most sides, within its bulwark. Of eight level rays two may
// find a gap.
bool LitObjects::is_dry(const glm::vec3& place) const {
    constexpr int kSides = 8, kEnough = 6;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const Body& body = bodies_[i];
        const glm::vec3 within = body.into * (place - body.place);
        const glm::vec3 least(body.mesh->least_m()), most(body.mesh->most_m());
        if (glm::any(glm::lessThan(within, least)) || glm::any(glm::greaterThan(within, most))) continue;
        // What lies in the hull, as its load does, stands for it.
        const auto meets = [&](const glm::vec3& towards) {
            const RayHit hit = rays_->nearest({.from = place, .towards = towards});
            if (!hit.is_hit()) return false;
            const glm::vec3 at = body.into * (place + hit.distance_m * towards - body.place);
            constexpr float kSlack_m = 1e-3f;  // a hit on the box's own side
            return glm::all(glm::greaterThanEqual(at, least - kSlack_m)) &&
                   glm::all(glm::lessThanEqual(at, most + kSlack_m));
        };
        if (!meets(glm::normalize(-body.axes[2]))) continue;
        int met = 0;
        for (int side = 0; side < kSides; ++side) {
            const float angle = 2.0f * kPi_f * (static_cast<float>(side) + 0.5f) / kSides;
            met += meets(glm::normalize(std::cos(angle) * body.axes[0] + std::sin(angle) * body.axes[1]));
        }
        if (met >= kEnough) return true;
    }
    return false;
}

float LitObjects::sun_share(const glm::vec3& place, const glm::vec3& normal,
                            const SampleNumbers& numbers) const {
    if (beam_ == glm::vec3(0.0f)) return 1.0f;
    const glm::vec3 from = place + off_surface_m(place) * normal;
    const float spread = sky_->sun_angular_radius;
    const bool is_possible = std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& body) {
        const glm::vec3 way = body.centre - from;
        const float along = glm::dot(way, to_sun_);
        if (along < -body.radius) return false;
        const float most = body.radius + 1.01f * spread * std::max(along + body.radius, 0.0f);
        return glm::dot(way, way) - along * along <= most * most;
    });
    if (!is_possible) return 1.0f;
    const std::uint32_t count = numbers.rays(kSunRays, kLeastSunRays);
    const SampleNumbers::Places places = numbers.places(kOfSun);
    std::uint32_t seen = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        const glm::vec2 at = on_disc(places.of(k, count));
        seen += !rays_->is_blocked(
            {.from = from, .towards = glm::normalize(to_sun_ + at.x * sun_side_ + at.y * sun_rise_)});
    }
    return static_cast<float>(seen) / static_cast<float>(count);
}

float LitObjects::sun_share(const Ray& ray, const RayHit& hit, const SampleNumbers& numbers) const {
    const Surface at = surface(ray, hit);
    if (beam_ != glm::vec3(0.0f) && !is_sunny(at)) return 0.0f;
    return sun_share(at.smooth, at.geometric, numbers);
}

// Normals mean a smooth surface that lies over the triangles of a convex body, and reaches the sun where a triangle faces away from it already.
// There the sun's rays of such a place begin, or the shadow's edge would have the triangles' steps: by the planes that touch that surface
// in the corners, as a mean by the same weights as the normals (Hanika 2021). What faces the sun stays where it is: under eaves the sun
// must not come to a wall that bulges in its normals alone.
glm::vec3 LitObjects::smooth_lift(const ObjectMeshData& mesh, std::size_t first, const glm::vec3& weights,
                                  const Body& body, const glm::vec3& geometric) const {
    glm::vec3 lift(0.0f);
    if (glm::dot(geometric, to_sun_) >= 0.0f) return lift;
    std::array<glm::vec3, 3> corner{};
    for (std::size_t i = 0; i < 3; ++i) corner[i] = body.axes * mesh.points_m[mesh.triangles[first + i]];
    const glm::vec3 middle = weights.x * corner[0] + weights.y * corner[1] + weights.z * corner[2];
    for (std::size_t i = 0; i < 3; ++i) {
        glm::vec3 upright = body.axes * mesh.normals[first + i];
        const float size = glm::length(upright);
        if (!(size > 0.0f)) continue;
        upright *= std::copysign(1.0f / size, glm::dot(upright, geometric));
        lift +=
            weights[static_cast<int>(i)] * std::max(glm::dot(corner[i] - middle, upright), 0.0f) * upright;
    }
    return lift;
}

LitObjects::Surface LitObjects::surface(const Ray& ray, const RayHit& hit) const {
    const Body& body = bodies_[hit.body];
    const ObjectMeshData& mesh = body.mesh->data();
    const std::size_t first = 3 * std::size_t{hit.triangle};
    std::array<glm::dvec3, 3> corner{};
    for (std::size_t i = 0; i < 3; ++i) corner[i] = mesh.points_m[mesh.triangles[first + i]];
    Surface at;
    at.place = ray.from + hit.distance_m * ray.towards;
    at.body = hit.body;
    const glm::vec3 weights(1.0f - hit.weights.x - hit.weights.y, hit.weights.x, hit.weights.y);
    // In double: a sliver's area may be nothing in single precision.
    at.geometric = glm::vec3(
        glm::normalize(glm::dmat3(body.axes) * glm::cross(corner[1] - corner[0], corner[2] - corner[0])));
    at.normal = body.axes * (weights.x * mesh.normals[first] + weights.y * mesh.normals[first + 1] +
                             weights.z * mesh.normals[first + 2]);
    const float size = glm::length(at.normal);
    at.normal = size > 0.0f ? at.normal / size : at.geometric;
    // Both face the ray, whichever way the triangle was wound.
    if (glm::dot(at.geometric, ray.towards) > 0.0f) at.geometric = -at.geometric;
    if (glm::dot(at.normal, at.geometric) < 0.0f) at.normal = -at.normal;
    constexpr float kLeastFacing = 0.02f;
    if (const float facing = -glm::dot(at.normal, ray.towards); facing < kLeastFacing)
        at.normal = glm::normalize(at.normal - (kLeastFacing - facing) * ray.towards);
    const ObjectMaterial& material = mesh.materials[mesh.material[hit.triangle]];
    at.look = {
        .colour = body.colour * (material.image < 0 ? material.colour
                                                    : image_colour(ray, hit, *mesh.images[material.image])),
        .roughness = material.roughness,
        .glow = body.glow * material.glow};
    at.smooth = at.place + smooth_lift(mesh, first, weights, body, at.geometric);
    return at;
}

// The mean of a picture in the ellipse that the ray's cone cuts out of the triangle's plane: by samples along its longer axis, of the level
// whose texels are as wide as the shorter one (McCormack et al. 1999, "Feline").
glm::vec3 LitObjects::image_colour(const Ray& ray, const RayHit& hit, const ObjectImage& image) const {
    const Body& body = bodies_[hit.body];
    const ObjectMeshData& mesh = body.mesh->data();
    const std::size_t first = 3 * std::size_t{hit.triangle};
    const auto corner = [&](std::size_t i) {
        return glm::dmat3(body.axes) * glm::dvec3(mesh.points_m[mesh.triangles[first + i]]);
    };
    const glm::vec2 from = mesh.image_at[first], second = mesh.image_at[first + 1] - from,
                    third = mesh.image_at[first + 2] - from;
    const glm::vec2 at = from + hit.weights.x * second + hit.weights.y * third;
    const double width_m = ray.width_m + static_cast<double>(ray.spread) * hit.distance_m;
    if (!(width_m > 0.0)) return image.colour(at, 0.0f);
    const glm::dvec3 towards(ray.towards), u = corner(1) - corner(0), v = corner(2) - corner(0),
                                           twice_area = glm::cross(u, v);
    const double area2 = glm::dot(twice_area, twice_area);
    const glm::dvec3 upright = twice_area / std::sqrt(area2);
    constexpr double kLeastFacing = 0.01;
    const double facing = std::max(std::abs(glm::dot(upright, towards)), kLeastFacing);
    // Straight on any direction is the longer one.
    glm::dvec3 along = towards - glm::dot(towards, upright) * upright;
    along = glm::length(along) > 1e-6 ? glm::normalize(along) : u / glm::length(u);
    const auto in_picture = [&](const glm::dvec3& way) {
        return glm::dvec2(second) * (glm::dot(glm::cross(way, v), twice_area) / area2) +
               glm::dvec2(third) * (glm::dot(glm::cross(u, way), twice_area) / area2);
    };
    const glm::dvec2 texels(image.levels().front().width, image.levels().front().height);
    glm::dvec2 longer = in_picture(width_m / facing * along),
               shorter = in_picture(width_m * glm::cross(upright, along));
    double long_texels = glm::length(longer * texels), short_texels = glm::length(shorter * texels);
    if (short_texels > long_texels) {
        std::swap(longer, shorter);
        std::swap(long_texels, short_texels);
    }
    constexpr double kMostTaps = 8.0;
    const double samples = std::clamp(std::round(long_texels / std::max(short_texels, 1.0)), 1.0, kMostTaps);
    const auto level = static_cast<float>(std::log2(std::max({short_texels, long_texels / samples, 1.0})));
    glm::vec3 sum(0.0f);
    for (double i = 0.5; i < samples; i += 1.0)
        sum += image.colour(at + glm::vec2((i / samples - 0.5) * longer), level);
    return sum / static_cast<float>(samples);
}

glm::vec3 LitObjects::normal(const Ray& ray, const RayHit& hit) const {
    return surface(ray, hit).normal;
}

std::array<glm::dvec3, 3> LitObjects::places(const Ray& ray, const RayHit& hit) const {
    const Body& body = bodies_[hit.body];
    const glm::dvec3 now =
        glm::dvec3(ray.from) + static_cast<double>(hit.distance_m) * glm::dvec3(ray.towards);
    const glm::dvec3 local = glm::inverse(body.placed[1].axes) * (now - body.placed[1].place_m);
    std::array<glm::dvec3, 3> places{};
    for (std::size_t i = 0; i < places.size(); ++i)
        places[i] = i == 1 ? now : body.placed[i].place_m + body.placed[i].axes * local;
    return places;
}

glm::vec3 LitObjects::sky(const glm::vec3& direction, float blur_rad) const {
    if (!choice_.sky) return glm::vec3(0.0f);
    // A direction changes by up to as much in the map; a texel's side.
    const float texel = 2.0f * kSkyMapExtent / static_cast<float>(sky_->map.size());
    return sky_->map.radiance(sky_map_place(direction), std::max(std::log2(0.5f * blur_rad / texel), 0.0f));
}
glm::vec3 LitObjects::sky(const glm::vec3& direction) const {
    return sky(direction, 0.01f);
}

// The sea as a direction from it to an eye shows it.
glm::vec3 LitObjects::by_eye(const std::vector<glm::vec3>& table, const glm::vec3& to_eye) {
    const float row = std::sqrt(std::clamp(to_eye.z, 0.0f, 1.0f)) * (kRows - 1);
    float column = std::atan2(to_eye.y, to_eye.x) / (2.0f * kPi_f) * kColumns;
    if (!(column >= 0.0f)) column += kColumns;
    const int low = std::clamp(static_cast<int>(row), 0, kRows - 2), left = static_cast<int>(column);
    const auto at = [&](int r, int c) { return table[r * kColumns + c % kColumns]; };
    const float up = row - static_cast<float>(low), right = column - static_cast<float>(left);
    return glm::mix(glm::mix(at(low, left), at(low, left + 1), right),
                    glm::mix(at(low + 1, left), at(low + 1, left + 1), right), up);
}

bool LitObjects::is_sunny(const Surface& at) const {
    return beam_ != glm::vec3(0.0f) && glm::dot(at.normal, to_sun_) > 0.0f;
}

Ray LitObjects::ray_from(const Surface& at, const glm::vec3& towards) const {
    Ray ray{.from = at.place + off_surface_m(at.place) * at.geometric, .towards = towards};
    // What lies below the water doesn't count: the ray ends there.
    if (towards.z < 0.0f)
        ray.farthest_m = std::max(ray.from.z - bodies_[at.body].water_m, 0.0f) / std::max(-towards.z, 1e-6f);
    return ray;
}

// What comes from a direction, and what would without any body.
LitObjects::Incoming LitObjects::incoming(const Surface& at, const glm::vec3& from, float blur_rad,
                                          glm::vec2 number, const LampsOver& lamps, float density) const {
    Ray ray = ray_from(at, from);
    ray.spread = blur_rad;
    const glm::vec3 open = from.z < 0.0f ? sea(-from, true) : sky(from, blur_rad);
    if (const RayHit hit = nearest(ray); hit.is_hit() && hit.distance_m <= ray.farthest_m) {
        const glm::vec3 light = estimate(ray, hit, number) - light_of_places(lamps, ray, hit, density);
        return {.open = open, .light = light, .is_open = false};
    }
    if (from.z < 0.0f && beam_ != glm::vec3(0.0f)) {
        const glm::vec3 there = ray.from + ray.farthest_m * from;
        if (is_blocked({.from = there + glm::vec3(0.0f, 0.0f, off_surface_m(there)), .towards = to_sun_}))
            return {.open = open, .light = sea(-from, false), .is_open = false};
    }
    return {.open = open, .light = open, .is_open = true};
}

// To the outside of a surface, whichever way its smooth normal leans.
glm::vec3 LitObjects::outwards(const Surface& at, const glm::vec3& direction) {
    const float below = glm::dot(direction, at.geometric);
    return below < 0.0f ? direction - 2.0f * below * at.geometric : direction;
}

glm::vec3 LitObjects::estimate(const Ray& ray, const RayHit& hit, glm::vec2 number) const {
    const Surface at = surface(ray, hit);
    glm::vec3 light(0.0f);
    const glm::vec3 towards = outwards(
        at, axes_round(at.normal) * glm::vec3(on_disc(number), std::sqrt(std::max(1.0f - number.x, 0.0f))));
    if (!is_blocked(ray_from(at, towards))) {
        light = open_irradiance(at.normal);
        if (const float more = gathered(at); more != 0.0f) light += more * mirrored_sun_irradiance(at.normal);
    }
    if (is_sunny(at) &&
        !is_blocked({.from = at.smooth + off_surface_m(at.place) * at.geometric, .towards = to_sun_}))
        light += glm::dot(at.normal, to_sun_) * beam_;
    if (has_lamps())
        light += light_of(
            lamps_over(at.place + off_surface_m(at.place) * at.geometric, at.normal, kMetPlaces, 0),
            [&](const glm::vec3& from) { return facing(at.normal, from); },
            [&](std::uint32_t k) {
                // From one place in turn: one in each quarter of either side.
                constexpr std::array<float, kMetPlaces> kUp{0.0f, 0.5f, 0.25f, 0.75f};
                return glm::fract(number + glm::vec2(static_cast<float>(k) / kMetPlaces, kUp[k]));
            });
    return at.look.colour * light / kPi_f + at.look.glow;
}

LitObjects::LampsOver LitObjects::lamps_over(const glm::vec3& place, const glm::vec3& normal,
                                             std::uint32_t count, std::uint32_t rays) const {
    LampsOver lamps{.place = place, .normal = normal, .rays = rays};
    for (const Lamps::Lamp& lamp : lamps_.all()) {
        const glm::vec3 way = lamp.centre - place;
        const float away2 = glm::dot(way, way), away = std::sqrt(away2),
                    round = lamp.radius / std::max(away, 1e-6f);
        const float part = std::clamp(glm::dot(way, normal) / std::max(away, 1e-6f) + round, 0.0f, 1.0f);
        // A convex body shows a quarter of its surface (Cauchy).
        lamps.choice.add(0.25f * lamp.power * part / (away2 + lamp.radius * lamp.radius + 1e-12f));
    }
    glm::vec3 daylight(0.0f);
    if (choice_.sky) daylight += sky_->sky_irradiance;
    if (choice_.sun) daylight += sky_->sun_irradiance;
    if (!lamps.choice.empty() && lamps.choice.all() >= kFaintLamp * mean_of(daylight)) lamps.count = count;
    return lamps;
}

LitObjects::LampsOver LitObjects::lamps_over(const Surface& at, const SampleNumbers& numbers,
                                             std::uint32_t rays) const {
    if (!has_lamps()) return {};
    return lamps_over(at.place + off_surface_m(at.place) * at.geometric, at.normal,
                      numbers.rays(kLitPlaces, kLeastLitPlaces), rays);
}

bool LitObjects::shows(const glm::vec3& place, const Lamps::Light& light) const {
    const glm::vec3 there = place + light.distance_m * light.towards;
    if (there.z < bodies_[light.body].water_m) return false;  // for rays, too, the water ends the air
    const float short_of_m = off_surface_m(there) + 1e-5f * light.distance_m;
    return !is_blocked({.from = place,
                        .towards = light.towards,
                        .farthest_m = std::max(light.distance_m - short_of_m, 0.0f)});
}

glm::vec3 LitObjects::light_of(const LampsOver& lamps, const auto& part, const auto& number) const {
    glm::vec3 sum(0.0f);
    for (std::uint32_t k = 0; k < lamps.count; ++k) {
        glm::vec2 at = number(k);
        const std::size_t lamp = lamps.choice.pick(at.x);
        const Lamps::Light light = lamps_.light(lamp, lamps.place, at);
        if (!(light.density > 0.0f)) continue;
        const VarnishPart of = part(light.towards);
        if (!(of.weight > 0.0f) || !shows(lamps.place, light)) continue;
        const float density = static_cast<float>(lamps.count) * lamps.choice.chance(lamp) * light.density +
                              static_cast<float>(lamps.rays) * of.density;
        float share = of.weight / density;
        // Much nearer than a lamp is large one place alone may count far too much. The whole hemisphere has no more than π.
        if (lamps.rays == 0) share = std::min(share, kMostOfPlace * kPi_f / static_cast<float>(lamps.count));
        sum += share * light.radiance;
    }
    return sum;
}

glm::vec3 LitObjects::light_of_places(const LampsOver& lamps, const Ray& ray, const RayHit& hit,
                                      float density) const {
    if (lamps.count == 0) return glm::vec3(0.0f);
    const Lamps::Met met = lamps_.met(ray, hit);
    if (met.lamp < 0) return glm::vec3(0.0f);
    const float by_places = static_cast<float>(lamps.count) *
                            lamps.choice.chance(static_cast<std::size_t>(met.lamp)) * met.density,
                by_rays = static_cast<float>(lamps.rays) * density;
    return by_places / std::max(by_places + by_rays, 1e-30f) * met.radiance;
}

glm::vec3 LitObjects::lamplight(const glm::vec3& place, const glm::vec3& normal,
                                const SampleNumbers& numbers) const {
    const LampsOver lamps = lamps_over(place, normal, numbers.rays(kLitPlaces, kLeastLitPlaces), 0);
    const SampleNumbers::Places places = numbers.places(kOfLamps);
    return light_of(
        lamps, [&](const glm::vec3& from) { return facing(normal, from); },
        [&](std::uint32_t k) { return places.of(k, lamps.count); });
}

glm::vec3 LitObjects::irradiance(const Surface& at, const SampleNumbers& numbers) const {
    const glm::mat3 axes = axes_round(at.normal);
    const std::uint32_t count = 2 * ((numbers.rays(kSkyRays, kLeastSkyRays) + 1) / 2);
    const TwoHalves places(numbers, kOfSky);
    const SampleNumbers::Places bounces = numbers.places(kOfBounces);
    const SampleNumbers::Places of_lamps = numbers.places(kOfLamps);
    const LampsOver lamps = lamps_over(at, numbers, count);
    const float more = gathered(at);
    MeanLight mean, of_sun;
    for (std::uint32_t k = 0; k < count; ++k) {
        const glm::vec2 place = places.of(k, count);
        const glm::vec3 towards = outwards(at, axes * glm::vec3(on_disc(place), std::sqrt(1.0f - place.x)));
        const Incoming from =
            incoming(at, towards, kBlur, bounces.of(k, count), lamps, facing(at.normal, towards).density);
        mean.add(from.open, from.light, from.is_open);
        if (more == 0.0f) continue;
        const glm::vec3 sun = towards.z < 0.0f ? mirrored_sun(-towards) : glm::vec3(0.0f);
        of_sun.add(sun, from.is_open ? sun : glm::vec3(0.0f), from.is_open);
    }
    glm::vec3 pattern(0.0f);
    if (more != 0.0f) pattern = more * kPi_f * of_sun.of(mirrored_sun_irradiance(at.normal) / kPi_f);
    return kPi_f * mean.of(open_irradiance(at.normal) / kPi_f) + pattern +
           light_of(
               lamps, [&](const glm::vec3& from) { return facing(at.normal, from); },
               [&](std::uint32_t k) { return of_lamps.of(k, lamps.count); });
}

// The mean radiance in the varnish's lobe: many facets look at sky and sea, a few ask what is before them.
glm::vec3 LitObjects::mirrored(const Surface& at, const glm::vec3& to_eye,
                               const SampleNumbers& numbers) const {
    const glm::mat3 axes = axes_round(at.normal);
    const glm::vec3 eye = glm::transpose(axes) * to_eye;
    const float roughness = at.look.roughness, blur_rad = roughness * roughness;
    struct Facet {
        glm::vec3 from;
        float weight;
    };
    const auto facet = [&](glm::vec2 place) -> Facet {
        const glm::vec3 upright = axes * mirrored_facet(eye, roughness, on_disc(place));
        const float facing = glm::dot(to_eye, upright);
        const glm::vec3 from = outwards(at, glm::normalize(2.0f * facing * upright - to_eye));
        return {from, mirrored_by_facet(facing, glm::dot(from, at.normal), roughness)};
    };
    const std::uint32_t count = 2 * ((numbers.rays(kGlossRays, kLeastGlossRays) + 1) / 2),
                        facets = kOpenFacets * count;
    const TwoHalves of_rays(numbers, kOfGloss);
    const SampleNumbers::Places bounces = numbers.places(kOfGlossBounces),
                                of_facets = numbers.places(kOfFacets);
    const auto by_varnish = [&](const glm::vec3& from) {
        return mirrored_by_varnish(eye, glm::transpose(axes) * from, roughness);
    };
    const SampleNumbers::Places of_lamps = numbers.places(kOfVarnishedLamps);
    const LampsOver lamps = lamps_over(at, numbers, count);
    MeanLight mean;
    glm::vec3 seen(0.0f);
    for (std::uint32_t k = 0; k < count; ++k) {
        const auto [from, weight] = facet(of_rays.of(k, count));
        const Incoming light = incoming(at, from, blur_rad, bounces.of(k, count), lamps,
                                        lamps.count > 0 ? by_varnish(from).density : 0.0f);
        mean.add(weight * light.open, weight * light.light, light.is_open);
    }
    if (mean.is_any_open())
        for (std::uint32_t k = 0; k < facets; ++k) {
            const auto [from, weight] = facet(of_facets.of(k, facets));
            seen += weight * (from.z < 0.0f ? sea(-from, true) : sky(from, blur_rad));
        }
    return (mean.of(seen / static_cast<float>(facets)) +
            light_of(lamps, by_varnish, [&](std::uint32_t k) { return of_lamps.of(k, lamps.count); })) /
           object_reflectance(std::max(glm::dot(at.normal, to_eye), 1e-3f), roughness);
}

glm::vec3 LitObjects::radiance(const Ray& ray, const RayHit& hit, const SampleNumbers& numbers) const {
    const Surface at = surface(ray, hit);
    const glm::vec3 to_eye = -ray.towards;
    glm::vec3 light = at.look.glow;
    if (is_sunny(at))
        light +=
            sun_share(at.smooth, at.geometric, numbers) * object_of_sun(at.look, *sky_, to_eye, at.normal);
    return light + object_of_surroundings(at.look, std::max(glm::dot(at.normal, to_eye), 1e-3f),
                                          irradiance(at, numbers), mirrored(at, to_eye, numbers));
}

glm::vec3 LitObjects::left_at_depth(float way_m) const {
    return water_lets_through(*water_, std::max(way_m, 0.0f));
}

// The sun's ray is refracted by level water; the sky's light comes from a cone, the mean way through it is 1.17 of the depth (water.glsl).
glm::vec3 LitObjects::radiance_in_water(const Ray& ray, const RayHit& hit) const {
    constexpr float kSkySlant = 1.17f;
    const Surface at = surface(ray, hit);
    const float depth_m = bodies_[at.body].water_m - at.place.z;
    const glm::vec3 to_sun = -refracted_by_water(-to_sun_, glm::vec3(0.0f, 0.0f, 1.0f));
    glm::vec3 sky(0.0f), sun(0.0f);
    if (choice_.sky) sky = sky_->sky_irradiance * left_at_depth(kSkySlant * depth_m);
    if (glm::dot(at.normal, to_sun) > 0.0f && beam_ != glm::vec3(0.0f) && to_sun_.z > 0.0f) {
        const bool is_dark =
            is_blocked({.from = at.smooth + off_surface_m(at.place) * at.geometric, .towards = to_sun});
        if (!is_dark)
            sun = water_entering(*water_, to_sun_) * sky_->sun_irradiance * left_at_depth(depth_m / to_sun.z);
    }
    return object_in_water(at.look, at.normal, to_sun, sun, sky);
}

bool LitObjects::may_be_mirrored(const glm::vec3& place, const glm::vec3& to_eye, const glm::vec3& normal,
                                 float slope_variance) const {
    const float farthest = 4.0f * std::sqrt(std::max(slope_variance, 0.0f)) + 0.02f;
    const glm::vec2 mean = -glm::vec2(normal) / std::max(normal.z, 0.1f);
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& body) {
        const glm::vec3 way = body.centre - place;
        const float distance = glm::length(way);
        if (distance < 2.0f * body.radius) return true;
        const glm::vec3 half = to_eye + way / distance;
        if (half.z < 0.05f) return true;  // so low that no first order says anything
        // By how much the slope is another for the body's rim, half as much again for what isn't first order.
        const glm::vec2 slope = -glm::vec2(half) / half.z;
        const float size = 1.5f * body.radius / distance * (1.0f + glm::length(slope)) / half.z;
        return glm::length(slope - mean) <= farthest + size;
    });
}

LitObjects::LampsInSea LitObjects::lamps_in(const SeaFacets& facets, const glm::vec3& place,
                                            std::uint32_t rays, const SampleNumbers& numbers) const {
    LampsInSea lamps{.facets = facets, .place = place, .rays = rays};
    for (const Lamps::Lamp& lamp : lamps_.all()) {
        const glm::vec3 way = lamp.centre - place;
        const float away = std::max({glm::length(way), lamp.radius, 1e-6f});
        const float mirrored =
            facets.from(way / std::max(glm::length(way), 1e-6f), 0.5f * lamp.radius / away).weight;
        lamps.choice.add(0.25f * lamp.power / (away * away) * mirrored);
    }
    const float sky = choice_.sky ? mean_of(sky_->sky_irradiance) / kPi_f : 0.0f;
    if (!lamps.choice.empty() && lamps.choice.all() >= kFaintMirrored * sky)
        lamps.count = numbers.rays(kLampPlaces, kLeastLampPlaces);
    return lamps;
}

glm::vec3 LitObjects::mirrored_places(const LampsInSea& lamps, const SampleNumbers& numbers) const {
    const SampleNumbers::Places places = numbers.places(kOfMirroredLamps);
    glm::vec3 sum(0.0f);
    for (std::uint32_t k = 0; k < lamps.count; ++k) {
        glm::vec2 at = places.of(k, lamps.count);
        const std::size_t lamp = lamps.choice.pick(at.x);
        const Lamps::Light light = lamps_.light(lamp, lamps.place, at);
        if (!(light.density > 0.0f)) continue;
        const SeaFacets::Part part = lamps.facets->from(light.towards);
        if (!(part.weight > 0.0f) || !shows(lamps.place, light)) continue;
        const float density = static_cast<float>(lamps.count) * lamps.choice.chance(lamp) * light.density +
                              static_cast<float>(lamps.rays) * part.density;
        sum += part.weight / density * glm::max(light.radiance - sky(light.towards), glm::vec3(0.0f));
    }
    return sum;
}

LitObjects::LampMet LitObjects::lamp_met(const LampsInSea& lamps, const Ray& ray, const RayHit& hit) const {
    const Lamps::Met met = lamps_.met(ray, hit);
    if (met.lamp < 0) return {};
    const float by_places = static_cast<float>(lamps.count) *
                            lamps.choice.chance(static_cast<std::size_t>(met.lamp)) * met.density,
                by_rays = static_cast<float>(lamps.rays) * lamps.facets->from(ray.towards).density;
    LampMet found{.light = glm::max(met.radiance - sky(ray.towards), glm::vec3(0.0f))};
    if (by_places > 0.0f) found.part = by_rays / (by_rays + by_places);
    return found;
}

bool LitObjects::is_near(const glm::vec3& place, float distance_m) const {
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& body) {
        return glm::length(body.centre - place) <= body.radius + distance_m;
    });
}

}  // namespace pelagic
