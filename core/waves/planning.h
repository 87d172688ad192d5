// How FFTW finds its plans, for comparisons. All other code uses the recorded ones (core/waves/transform.h).
#pragma once

namespace pelagic {

enum class Planning {
    Recorded,  // recorded wisdom, FFTW's estimate where there is none
    Estimate,  // by the number of operations
    Measure,   // the fastest of some, timed
    Patient,   // the fastest of many, timed
};

// While this object lives, the process plans its transforms in this way. Only one may live at a time, and nobody else
// should plan meanwhile. It clears what FFTW knows of plans when it begins and when it ends, so that later plans are
// the recorded ones again.
class PlannedBy {
  public:
    explicit PlannedBy(Planning wanted);
    ~PlannedBy();
    PlannedBy(const PlannedBy&) = delete;
    PlannedBy& operator=(const PlannedBy&) = delete;
};

}  // namespace pelagic
