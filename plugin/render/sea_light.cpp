#include "plugin/render/sea_light.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <utility>

#include "core/lighting/background.h"
#include "core/waves/whitecaps.h"
#include "plugin/light/light.h"
#include "plugin/render/batch.h"
#include "plugin/render/spray_map.h"

namespace pelagic {

template <class T>
SeaLight<T>::SeaLight(const Plan& plan, const LightingChoice& choice, Sky sky, const BuildWatch& watch)
    : choice_(choice),
      sky_(std::move(sky)),
      water_(make_water(plan.from->scene)),
      foam_(make_foam(plan.from->scene)),
      sea_(std::make_shared<const Sea<T>>(plan, watch)),
      frame_(sea_) {
    if (!plan.foam) return;
    history_.emplace(sea_);
    foam_ = make_foam(plan.from->scene, active_foam(plan.from->scene, sea_->residual_coverage()));
}

template <class T>
Air SeaLight<T>::air_before(double height_m) const {
    return sky_.air ? sky_.air->seen_from(height_m) : Air{};
}

template <class T>
Spray SeaLight<T>::spray_before(const View& view, const ProjectedGridOptions& grid) const {
    if (!choice_.spray) return {};
    Spray spray = make_spray_map(frame_, view, grid, spray_map_size(view.resolution.x));
    light_spray(spray, choice_, sky_, water_, law_coverage(plan().from->scene));
    return spray;
}

template <class T>
void SeaLight<T>::begin_foam(double time_s) {
    foam_places_.clear();
    if (history_) history_->set(time_s);
}

template <class T>
void SeaLight<T>::ask_foam(const Points<T>& points) {
    if (!history_) return;
    const std::vector<FoamPlace> places = history_->places(points, kQuery);
    foam_places_.insert(foam_places_.end(), places.begin(), places.end());
    keep_each_once(foam_places_);  // batches ask for much the same
}

template <class T>
void SeaLight<T>::prepare_foam(const BuildWatch& watch) {
    if (history_) history_->prepare(foam_places_, watch);
    foam_places_.clear();
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
void SeaLight<T>::answer(const SeenSea<T>& seen) {
    ProductSet wanted = plan().queries[kQuery].query.products;
    wanted &= ~products(Product::Position, Product::Displacement,
                        Product::Velocity);  // whoever found the places has them
    const Points<T> points = seen.points();
    runner_.run(frame_, kQuery, points, wanted, answers_);
    if (!history_) return;
    foam_active_.resize(seen.size());
    foam_age_s_.resize(seen.size());
    history_->add(points, kQuery,
                  {.coverage = {answers_.numbers(Product::Coverage).data()},
                   .active = {foam_active_.data()},
                   .age_s = {foam_age_s_.data()}});
}

template <class T>
void SeaLight<T>::light(const SeenSea<T>& seen, const Sky& sky, const Air& air, const Spray& spray,
                        std::span<SeaRadiance> lit) {
    const std::vector<glm::vec3>& normal = answers_.vectors(Product::Normal);
    const std::vector<glm::vec3>& slope_variance = answers_.vectors(Product::SlopeVariance);
    const std::vector<glm::vec3>& at_rest = answers_.vectors(Product::SlopeVarianceAtRest);
    const std::vector<float>& coverage = answers_.numbers(Product::Coverage);
    points_.resize(seen.size());
    const FoamPattern foam = foam_pattern(foam_, seen.origin_m);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, seen.size(), kShadeGrain),
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
                                            .pixel_m = glm::vec3(seen.pixel_m[i], seen.pixel_axis_m[i])};
                          if (history_)
                              for (std::size_t i = range.begin(); i < range.end(); ++i) {
                                  points_[i].active = foam_active_[i];
                                  points_[i].age_s = residual_age_s(i);
                              }
                          const auto part = [&](auto& of) {
                              return std::span(of).subspan(range.begin(), range.size());
                          };
                          shade_sea(choice_, sky, water_, part(points_), part(lit), &air, foam);
                          if (choice_.air)
                              see_through(air, part(seen.to_eye), part(seen.distance_m), part(lit));
                          see_through_spray(spray, part(seen.to_eye), part(seen.distance_m), part(lit));
                      });
}

// Of the foam that earlier breaking has left, without what breaks now.
template <class T>
float SeaLight<T>::residual_age_s(std::size_t i) const {
    const float total = points_[i].coverage, left = total - foam_active_[i];
    return left > 0.0f ? foam_age_s_[i] * total / left : 0.0f;
}

template class SeaLight<float>;
template class SeaLight<double>;

}  // namespace pelagic
