// How a picture is traced, part by part: tracer.cpp has what the eye's rays meet, second_rays.cpp what those add that begin there.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "core/surface/earth.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "plugin/render/batch.h"
#include "plugin/render/sea_light.h"
#include "tracer.h"

namespace pelagic::trace {

inline constexpr float kPi_f = std::numbers::pi_v<float>;

struct ReleaseFrame {
    void operator()(pelagic_frame* frame) const { pelagic_frame_release(frame); }
};
using FrameHandle = std::unique_ptr<pelagic_frame, ReleaseFrame>;

template <class Work>
void in_parallel(std::size_t count, const Work& work) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kShadeGrain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
    });
}

inline glm::vec3 world_normal(glm::vec3 level, glm::vec3 up) {
    return glm::vec3(from_level(glm::dvec3(level), glm::dvec3(up)));
}

// A ray that adds to the light of a sample.
struct SecondRay {
    RayQuery ray;
    std::size_t sample = 0;
    glm::vec3 weight{0.0f};
    bool replaces_sky = false;  // the sky in its direction is there already
};

// Those of some rays, side by side.
struct Gathered {
    std::vector<RayQuery> rays;
    std::vector<RayAnswer> met;
};
inline Gathered gathered(std::span<const RayQuery> rays, std::span<const RayAnswer> met,
                         std::span<const std::size_t> which) {
    Gathered some;
    for (const std::size_t i : which) {
        some.rays.push_back(rays[i]);
        some.met.push_back(met[i]);
    }
    return some;
}

class Tracer::Impl {
  public:
    Impl(const Scene& scene, const TraceOptions& options, Sky sky, int frame);
    TracedPicture render(const std::function<void(double)>& progress);

  private:
    static constexpr double kCell_px = 2.0;
    static constexpr std::uint32_t kDirections = 4;  // from which light on the object is looked for, a sample
    static constexpr float kWide = 0.3f;             // how much such rays widen in a metre,
    static constexpr float kMirrored = 0.02f;        // and those that the sea mirrors, at least
    static constexpr std::uint64_t kSeed = 0x7261797365610001u;

    void trace_rows(int first_row, int rows);
    void light_background();
    void find_places();
    void light_sea();
    void light_object();
    std::optional<glm::vec3> facet(std::size_t i, glm::vec3 to_eye) const;
    // dark: whether each sample of the sea lies in a shadow.
    void mirror_and_refract(const std::vector<std::uint8_t>& dark);
    std::vector<glm::vec3> transmittances() const;
    void trace_second_rays();
    void light_second_sea(std::span<const RayQuery> rays, std::span<const RayAnswer> met,
                          std::span<const std::size_t> sea, std::span<glm::vec3> light);
    void through_air();
    glm::dvec2 pixel_at(std::size_t sample) const;
    void average(int first_row, int rows, TracedPicture& to) const;
    PixelFootprint<double> pixel_of(std::size_t sample, const PixelFootprint<double>& at_rest,
                                    const glm::dvec3& normal) const;
    std::array<std::uint32_t, 4> random(std::size_t sample, std::uint32_t what) const;
    RayQuery from_place(const RayQuery& before, const RayAnswer& met, glm::vec3 towards) const;
    std::vector<std::uint8_t> in_shadow(std::span<const RayQuery> rays, std::span<const RayAnswer> met) const;
    glm::vec3 sun_on(const RayAnswer& object, bool in_shadow) const;
    glm::vec3 sky_on(const RayAnswer& object) const;
    glm::vec3 sky_towards(glm::vec3 direction) const;

    TraceOptions options_;
    Scene scene_;  // of samples
    int frame_;
    View view_;
    Plan plan_;
    ProjectedGridOptions grid_options_;
    SeaLight<float> light_;
    Air air_, air_below_;
    Spray spray_;
    Sky unlit_;  // without the sun
    FrameHandle ray_frame_;
    std::optional<TracedScene> traced_;

    // Of the rows at hand, by sample.
    int first_row_ = 0;
    std::vector<RayQuery> rays_;
    std::vector<RayAnswer> answers_;
    std::vector<SeaRadiance> radiance_;
    std::vector<glm::vec3> added_;  // before the air dims it
    std::vector<std::size_t> on_sea_, on_object_;
    SeenSea<float> seen_;  // by entry of on_sea_
    std::vector<SeaRadiance> lit_;
    std::vector<SecondRay> second_;
};

}  // namespace pelagic::trace
