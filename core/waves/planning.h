// How FFTW finds its plans, for who compares them. All others have the recorded ones (core/waves/transform.h).
#pragma once

namespace pelagic {

enum class Planning {
    Recorded,  // recorded wisdom, FFTW's estimate where there is none
    Estimate,  // by the number of operations
    Measure,   // the fastest of some, timed
    Patient,   // the fastest of many, timed
};

// Transforms that the process plans while this lives are planned so. One at a time, and nobody else should plan meanwhile. It
// forgets what FFTW knows of plans when it begins and when it ends, so that those of others are again the recorded ones.
class PlannedBy {
  public:
    explicit PlannedBy(Planning wanted);
    ~PlannedBy();
    PlannedBy(const PlannedBy&) = delete;
    PlannedBy& operator=(const PlannedBy&) = delete;
};

}  // namespace pelagic
