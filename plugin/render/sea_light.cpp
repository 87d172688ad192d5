#include "plugin/render/sea_light.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "core/lighting/background.h"
#include "core/plan/hulls.h"
#include "core/plan/weather.h"
#include "core/scene/number_keys.h"
#include "core/waves/whitecaps.h"
#include "plugin/light/light.h"
#include "plugin/render/batch.h"
#include "plugin/render/floor_light.h"
#include "plugin/render/spray_map.h"

namespace pelagic {

template <class T>
SeaLight<T>::SeaLight(const Plan& plan, const LightingChoice& choice, Sky sky, const BuildWatch& watch)
    : choice_(choice),
      sky_(std::move(sky)),
      sea_(std::make_shared<const SeaOverTime<T>>(plan, watch)),
      state_(sea_) {
    foam_.image = make_foam_picture(plan.from->scene);
    const Shot& shot = plan.from->scene.shot;
    light_by(scene_at(plan.from->scene, shot.first_frame), shot.time_s(shot.first_frame));
}

template <class T>
void SeaLight<T>::light_by(const Scene& scene, double time_s) {
    water_ = make_water(scene, prepared_at(plan().from, time_s)->spectrum);
    foam_ = make_foam(scene, foam_.image,
                      plan().foam ? active_foam(scene, sea_->whitecaps(time_s).residual_coverage) : 1.0);
    caustics_ = scene.water.caustics;
}

template <class T>
bool SeaLight<T>::light_frame(int frame) {
    const Scene& shot = plan().from->scene;
    if (shot.keyed.empty()) return false;
    Scene scene = scene_at(shot, frame);
    light_by(scene, shot.shot.time_s(frame));
    floor_lit_.reset();
    if (!lit_ || lit_->sea.depth_m != scene.sea.depth_m) floor_rest_m_.reset();
    // The sky that the renderer was given stays where light has no keys.
    const bool is_other = !same_sky(shot, scene) && !(lit_ && same_sky(*lit_, scene));
    if (is_other) sky_ = make_sky(scene);
    lit_ = std::move(scene);
    return is_other;
}

template <class T>
Air SeaLight<T>::air_before(double height_m) const {
    return sky_.air ? sky_.air->seen_from(height_m) : Air{};
}

template <class T>
Spray SeaLight<T>::spray_before(const View& view, const ProjectedGridOptions& grid, int samples,
                                bool drops) const {
    if (!choice_.spray) return {};
    Spray spray = make_spray_map(frame(), view, grid, spray_map_size(view.resolution.x / samples), drops);
    light_spray(spray, choice_, sky_, water_, law_coverage(frame().sea().plan().from->scene));
    return spray;
}

template <class T>
SeaRadiance SeaLight<T>::behind(const Air& air, const glm::vec3& direction, float angle) const {
    SeaRadiance light;
    const Background seen = background(sky_, direction, angle);
    if (choice_.sky) light.sky += air.has_sky ? sky_through(air, direction) : seen.sky;
    if (choice_.sun) light.sky += seen.sun;
    return light;
}

template <class T>
void SeaLight<T>::find_crests(glm::dvec2 origin_m, const std::vector<glm::vec<2, T>>& rest,
                              std::vector<T> width_m, const std::vector<glm::vec<2, T>>& axis_m,
                              std::vector<glm::vec3>& crest) const {
    const bool has_crests = water_.crest_light > 0.0f && water_.crest_per_m > 0.0f;
    const std::size_t count = has_crests ? rest.size() : 0;
    crest.resize(count);
    if (count == 0) return;
    for (T& width : width_m) width = std::max(width, static_cast<T>(kCrestFootprint_m));
    std::vector<glm::vec<3, T>> normal(count), position(count);
    Results<T> results;
    results.set(Product::Normal, {normal.data()});
    results.set(Product::Position, {position.data()});
    evaluate(frame(), kQuery,
             Points<T>{.origin_m = origin_m,
                       .count = count,
                       .rest_m = {rest.data()},
                       .cell_m = {width_m.data()},
                       .pixel_m = {width_m.data()},
                       .cell_axis_m = {axis_m.data()},
                       .pixel_axis_m = {axis_m.data()}},
             results);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 n(normal[i]);
        crest[i] = glm::vec3(-glm::vec2(n) / std::max(n.z, 0.1f), static_cast<float>(position[i].z));
    }
}

template <class T>
const Floor& SeaLight<T>::floor_below(double rest_m) {
    if (floor_rest_m_ == rest_m) return floor_;
    floor_lit_.reset();
    floor_ = make_floor(lit_ ? *lit_ : plan().from->scene, rest_m);
    floor_rest_m_ = rest_m;
    return floor_;
}

template <class T>
void SeaLight<T>::light_floor_before(FloorLightWanted wanted, double rest_m,
                                     const std::atomic<bool>* cancel) {
    floor_below(rest_m);
    if (!choice_.water || !choice_.sun || sky_.sun_irradiance == glm::vec3(0.0f)) return;
    wanted.water = water_;
    wanted.sun_direction = sky_.sun_direction;
    wanted.sun_angular_radius = sky_.sun_angular_radius;
    wanted.gain = caustics_;
    if (floor_lit_ == wanted) return;
    floor_lit_.reset();
    light_floor(floor_, frame(), wanted, cancel);
    floor_lit_ = wanted;
}

template <class T>
void SeaLight<T>::answer(const SeenSea<T>& seen) {
    ProductSet wanted = plan().queries[kQuery].query.products;
    wanted &= ~products(Product::Position, Product::Displacement,
                        Product::Velocity);  // whoever found the places has them
    const Points<T> points = seen.points();
    runner_.run(state_, kQuery, points, wanted, answers_);
    bubbles_.resize(state_.has_bubbles(kQuery) && choice_.whitecaps ? seen.size() : 0);
    if (!bubbles_.empty()) state_.bubbles(kQuery, points, bubbles_);
}

template <class T>
void SeaLight<T>::add_foam_of(const Hulls& hulls, const SeenSea<T>& seen) {
    if (!choice_.whitecaps || answers_.numbers(Product::Coverage).empty()) return;
    Points<T> points = seen.points();
    points.cell_m = points.pixel_m;
    contact_foam_.resize(points.count);
    hulls.meet(frame(), hulls_query(plan()), points, 0.0, {}, {.foam = contact_foam_});
    add_contact_foam(contact_foam_, answers_);
}

template <class T>
void SeaLight<T>::light(const SeenSea<T>& seen, const Sky& sky, const Air& air, const Spray& spray,
                        std::span<SeaRadiance> lit, std::span<const std::uint8_t> wanted) {
    const std::vector<glm::vec3>& normal = answers_.vectors(Product::Normal);
    const std::vector<glm::vec3>& slope_variance = answers_.vectors(Product::SlopeVariance);
    const std::vector<glm::vec3>& at_rest = answers_.vectors(Product::SlopeVarianceAtRest);
    const std::vector<float>& coverage = answers_.numbers(Product::Coverage);
    points_.resize(seen.size());
    const FoamPattern foam = foam_pattern(foam_, seen.origin_m);
    const FloorSeen floor = seen.eye ? floor_.seen_from(*seen.eye) : FloorSeen{};
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, seen.size(), kShadeGrain),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                points_[i] = {.to_eye = seen.to_eye[i],
                              .normal = normal[i],
                              .slope_variance = slope_variance[i],
                              .slope_variance_at_rest = at_rest[i],
                              .coverage = coverage.empty() ? 0.0f : coverage[i],
                              .up = seen.up[i],
                              .mesh_variance = seen.mesh_variance[i],
                              .rest_m = glm::vec2(seen.rest[i]),
                              .pixel_m = glm::vec3(seen.pixel_m[i], seen.pixel_axis_m[i]),
                              .from_eye_m = -seen.distance_m[i] * seen.to_eye[i]};
            if (!seen.crest.empty())
                for (std::size_t i = range.begin(); i < range.end(); ++i) points_[i].crest = seen.crest[i];
            if (foam_lives())
                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                    points_[i].active = answers_.numbers(Product::Breaking)[i];
                    points_[i].age_s = residual_age_s(i);
                    if (!bubbles_.empty()) points_[i].bubbles = bubbles_[i];
                }
            const auto is_below = [&](std::size_t i) {
                return !seen.from_below.empty() && seen.from_below[i] != 0;
            };
            const auto is_wanted = [&](std::size_t i) { return wanted.empty() || wanted[i] != 0; };
            // Places after one another that are seen from the same side.
            for (std::size_t first = range.begin(), last = first; first < range.end(); first = last) {
                while (last < range.end() && is_below(last) == is_below(first) &&
                       is_wanted(last) == is_wanted(first))
                    ++last;
                if (!is_wanted(first)) continue;
                const auto part = [&](auto& of) { return std::span(of).subspan(first, last - first); };
                if (is_below(first)) {
                    shade_sea_from_below(choice_, sky, water_, static_cast<float>(seen.eye->position_m.z),
                                         part(points_), part(seen.distance_m), part(lit), foam, floor);
                    for (SeaRadiance& of : part(lit)) of = mixed({}, of, kBehindGlass);
                    continue;
                }
                shade_sea(choice_, sky, water_, part(points_), part(lit), &air, foam, floor);
                if (choice_.air) see_through(air, part(seen.to_eye), part(seen.distance_m), part(lit));
                see_through_spray(spray, part(seen.to_eye), part(seen.distance_m), part(lit));
            }
        });
}

template <class T>
SeaFacets SeaLight<T>::facets(const SeenSea<T>& seen, std::size_t place) const {
    return {choice_, sky_, points_[place], foam_pattern(foam_, seen.origin_m)};
}

template <class T>
glm::vec3 SeaLight<T>::wave_slopes() const {
    // Water without a body hasn't asked for them; those of any are the spectrum's.
    return water_.has_body ? water_.waves : make_water(Scene{}, frame().sea().plan().from->spectrum).waves;
}

template <class T>
void SeaLight<T>::light_from_afar(std::span<const glm::vec3> to_eye, bool lit,
                                  std::span<SeaRadiance> light) const {
    Sky sky = sky_;
    if (!lit) sky.sun_radiance = sky.sun_irradiance = glm::vec3(0.0f);
    const Scene& scene = plan().from->scene;
    // Of water without a body nobody has asked for the waves' slopes: Cox and Munk 1954.
    const auto slopes = static_cast<float>(0.003 + 0.00512 * scene.sea.wind_speed_mps);
    glm::vec3 variance = water_.has_body ? water_.waves : glm::vec3(0.5f * slopes, 0.5f * slopes, 0.0f);
    // A calm sea's glitter would be a point that tables of directions miss, or see as a wide one.
    constexpr float kLeast = 0.01f;
    variance.x = std::max(variance.x, kLeast);
    variance.y = std::max(variance.y, kLeast);
    const float coverage = choice_.whitecaps ? static_cast<float>(law_coverage(scene)) : 0.0f;
    std::vector<SeaPoint> points(to_eye.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = {.to_eye = to_eye[i],
                     .slope_variance = variance,
                     .slope_variance_at_rest = variance,
                     .coverage = coverage};
    shade_sea(choice_, sky, water_, points, light);
}

template <class T>
void SeaLight<T>::light_water(const FloorEye& eye, std::span<const glm::vec3> direction,
                              std::span<SeaRadiance> lit) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, direction.size(), kShadeGrain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          shade_water(choice_, sky_, water_, static_cast<float>(eye.position_m.z),
                                      direction.subspan(range.begin(), range.size()),
                                      lit.subspan(range.begin(), range.size()), floor_.seen_from(eye));
                          for (std::size_t i = range.begin(); i < range.end(); ++i)
                              lit[i] = mixed({}, lit[i], kBehindGlass);
                      });
}

template <class T>
void SeaLight<T>::light_meniscus(const FloorEye& eye, const glm::vec3& forward,
                                 std::span<const MeniscusSight> sights, std::span<SeaRadiance> lit) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sights.size(), kShadeGrain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          shade_meniscus(choice_, sky_, water_, static_cast<float>(eye.position_m.z), forward,
                                         sights.subspan(range.begin(), range.size()),
                                         lit.subspan(range.begin(), range.size()), floor_.seen_from(eye));
                      });
}

// Of the foam that earlier breaking has left, without what breaks now.
template <class T>
float SeaLight<T>::residual_age_s(std::size_t i) const {
    const float total = points_[i].coverage, left = total - answers_.numbers(Product::Breaking)[i];
    return left > 0.0f ? answers_.numbers(Product::FoamAge)[i] * total / left : 0.0f;
}

template class SeaLight<float>;
template class SeaLight<double>;

}  // namespace pelagic
