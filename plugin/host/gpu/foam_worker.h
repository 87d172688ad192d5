// The residual foam of pictures that don't wait for it: a thread goes through the earlier times, while pictures show
// what is ready.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/surface/projected_grid.h"
#include "plugin/host/gpu/live_worker.h"
#include "plugin/host/gpu/packed_foam.h"

namespace pelagic {

class FoamWorker {
  public:
    using Grids = std::vector<std::shared_ptr<const ProjectedGrid>>;

    // Of a sea with persistent foam.
    explicit FoamWorker(std::shared_ptr<const SeaOverTime<float>> sea);
    // Cancels a history that isn't done, and waits for the step of it that is being made.
    ~FoamWorker();

    // Asks for the foam at a time within these grids, above all the last of them. The latest request wins, but the
    // one being made is finished: it is most of the next one.
    void ask(double time_s, Grids grids);
    // The latest that is done, once; otherwise null.
    std::shared_ptr<const PackedFoam> take() { return worker_->take(); }
    bool is_busy() const { return worker_->is_busy(); }
    std::string error() const { return worker_->error(); }
    // The request being made, and whatever is asked for later, ends within a step.
    void cancel() { cancel_ = true; }

  private:
    struct Asked {
        double time_s = 0.0;
        Grids grids;
    };
    std::shared_ptr<const PackedFoam> make(const Asked& asked);

    FoamHistory<float> history_;  // the thread's
    std::atomic<bool> cancel_ = false;
    std::unique_ptr<LiveWorker<Asked, PackedFoam>> worker_;
};

}  // namespace pelagic
