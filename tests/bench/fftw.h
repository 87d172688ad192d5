// FFTW by itself: the transforms that so many real N × N fields need, in whichever arrangement and with
// whichever planning is fastest on this machine. Single precision.
#pragma once

#include <fftw3.h>

#include <memory>
#include <string>
#include <vector>

#include "core/base/buffer.h"
#include "core/waves/planning.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {

// One way to lay out and plan them.
struct Arrangement {
    bool two_in_one = true;  // two real fields in a complex transform; else a complex-to-real one each
    bool in_place = true;
    int padding = 0;     // complex values behind each row
    bool split = false;  // each transform by all threads; else several side by side, one thread each
    std::string name() const;
    bool operator==(const Arrangement&) const = default;
};

// The bare transforms of `fields` (even) fields of n × n. They share memory: huge pages where there are any.
class BareFftw {
  public:
    BareFftw(int n, int fields);

    // The two fastest arrangements for that many threads, planned by FFTW_MEASURE, and the first of them by
    // FFTW_PATIENT, ready to be timed beside something else. Called within a tbb::global_control of as many
    // threads; leaves no wisdom behind. All arrangements compete up to 1024²; above, to save half an hour of
    // planning, padded rows only (without padding none was faster) and no FFTW_PATIENT; above 2048² in place
    // only.
    std::vector<Timed> fastest(int threads);

  private:
    struct Planned {
        Arrangement arrangement;
        std::string planning;
        fftwf_plan plan;
    };
    struct Destroy {
        void operator()(Planned* planned) const {
            fftwf_destroy_plan(planned->plan);
            delete planned;
        }
    };
    using Handle = std::shared_ptr<const Planned>;

    Handle planned(const Arrangement&, int threads, unsigned flag);
    Timed timed(const Handle&);
    void run(const Planned&);

    int n_, fields_;
    std::size_t slot_;  // floats of two fields, padding included
    Buffer<float> from_, to_;
    std::vector<Handle> measured_, patient_;  // kept from one number of threads to the next
};

// Lines of n values, as core/waves/transform lays them out, planned for long: what FFTW knows afterwards
// makes LineTransform take the fastest plans that there are, until only_recorded_plans().
void learn_lines(int n);
// What FFTW has learnt is forgotten, but for the recorded plans.
inline void only_recorded_plans() {
    const PlannedBy recorded(Planning::Recorded);
}

}  // namespace pelagic::bench
