// A frame of the sea at points of the shot's patch, in either precision, for sweeps.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/base/precision.h"
#include "core/evaluate/evaluate.h"
#include "core/evaluate/values.h"
#include "core/plan/plan.h"
#include "core/waves/frame.h"
#include "core/waves/sea.h"
#include "pelagic/scene.h"

namespace pelagic {

// Points at rest on the patch of the shot: a regular grid that no cascade's nodes meet.
struct SweepPoints {
    std::vector<glm::dvec2> rest_m;
    int per_side = 0;
    double spacing_m = 0.0;
    double time_s = 0.0;  // of the shot's middle frame
};
SweepPoints sweep_points(const Scene& shot, int most_per_side = 256);
double middle_time_s(const Scene& shot);
int middle_frame(const Scene& shot);

// The sea's values there, each run() a frame: transforms and points.
class SeaAnswers {
  public:
    // Filtered by one footprint [m]; 0: by none.
    SeaAnswers(const Scene& scene, ProductSet wanted, double footprint_m, const SweepPoints& at,
               const PlanOptions& options = {});

    void run() { sea_->run(); }
    std::vector<glm::dvec3> vectors(VectorProduct product) const { return sea_->vectors(product); }
    std::vector<double> numbers(NumberProduct product) const { return sea_->numbers(product); }
    const Plan& plan() const { return sea_->plan(); }
    SpectralMoments resolved_moments() const { return sea_->resolved_moments(); }
    double significant_height_m() const { return sea_->significant_height_m(); }
    std::size_t bytes() const { return plan().sea_bytes() + plan().frame_bytes(); }

  private:
    struct Precision {
        virtual ~Precision() = default;
        virtual void run() = 0;
        virtual std::vector<glm::dvec3> vectors(VectorProduct) const = 0;
        virtual std::vector<double> numbers(NumberProduct) const = 0;
        virtual const Plan& plan() const = 0;
        virtual SpectralMoments resolved_moments() const = 0;
        virtual double significant_height_m() const = 0;
    };
    template <class T>
    struct Of;
    std::shared_ptr<Precision> sea_;
};

// What `share` of the values don't exceed; their order is changed. 0 without values.
double percentile(std::vector<double>& values, double share);

// Root of the mean squared distance.
double rms(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b);
double rms(std::span<const double> a, std::span<const double> b);

}  // namespace pelagic
