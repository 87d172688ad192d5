// The sea of a shot: one, or, where it changes (core/plan/weather.h), one for each time between those of its keys.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/plan/weather.h"
#include "core/waves/sea.h"

namespace pelagic {

// Immutable, shared by threads and frames.
template <class T>
class SeaOverTime {
  public:
    // Builds the seas of all keys. Throws BuildCancelled. `like`: of the same scene, whose tables of the spectra it takes.
    explicit SeaOverTime(Plan plan, const BuildWatch& watch = {}, const SeaOverTime* like = nullptr);
    explicit SeaOverTime(std::shared_ptr<const Sea<T>> sea);  // of all times

    // The shot's, of all times.
    const Plan& plan() const { return plan_; }
    const std::shared_ptr<const Sea<T>>& first() const { return seas_.front(); }
    // At a time: it depends on the time alone. Between two keys it is made, which takes a pass through the modes.
    std::shared_ptr<const Sea<T>> at(double t_s) const;
    // Without its modes, at(t_s)->total().significant_height_m() and at(t_s)->whitecaps().
    double significant_height_m(double t_s) const;
    Whitecaps whitecaps(double t_s) const;

  private:
    std::optional<OverDepth> over_depth(double t_s) const;

    Plan plan_;
    std::vector<std::shared_ptr<const Sea<T>>> seas_;  // by key; one without weather
    std::vector<Turns> turns_;                         // by key, where the depth changes
};

}  // namespace pelagic
