#include "plugin/host/gpu/foam_worker.h"

#include <tbb/task_arena.h>

#include <utility>

namespace pelagic {

FoamWorker::FoamWorker(std::shared_ptr<const SeaOverTime<float>> sea)
    : history_(std::move(sea)),
      worker_(std::make_unique<LiveWorker<Asked, PackedFoam>>([this](const Asked& asked) {
          // The sea's own frames go first.
          tbb::task_arena arena(tbb::task_arena::automatic, 1, tbb::task_arena::priority::low);
          return arena.execute([&] { return make(asked); });
      })) {}

FoamWorker::~FoamWorker() {
    cancel();
    worker_.reset();
}

void FoamWorker::ask(double time_s, Grids grids) {
    worker_->ask({.time_s = time_s, .grids = std::move(grids)});
}

std::shared_ptr<const PackedFoam> FoamWorker::make(const Asked& asked) {
    history_.set(asked.time_s);
    std::vector<FoamPlace> places;
    for (const auto& grid : asked.grids) {
        const std::vector<FoamPlace> own = foam_places(history_.plan(), history_.time_s(), *grid, &cancel_);
        places.insert(places.end(), own.begin(), own.end());
    }
    history_.prepare(std::move(places), {.cancel = &cancel_});
    return std::make_shared<const PackedFoam>(
        history_, asked.grids.empty() ? glm::dvec2(0.0) : asked.grids.back()->origin_m);
}

}  // namespace pelagic
