// The level set: the sea within the patch's square as a closed solid, by the distances of voxels from its boundary.
#include <oneapi/tbb/task_arena.h>

#include <mutex>
#include <optional>

#include "plugin/bake/volume_blocks.h"
#include "plugin/bake/volume_part.h"

namespace pelagic {
namespace {

struct LevelSetSlot final : OutputSlot {
    std::vector<float> heights_m;  // at corners of cells
    std::optional<Hulls> hulls;
    std::string file;
};

class LevelSetPart final : public VolumePart {
  public:
    LevelSetPart(const Plan& plan, const PlannedOutput& output)
        : VolumePart(plan, output), cells_(voxels_a_side(scene())) {}

    std::unique_ptr<OutputSlot> make_slot() const override { return std::make_unique<LevelSetSlot>(); }

    void compute(const SeaAtTime<float>& sea, int frame, OutputSlot& slot, const BuildWatch& watch) override {
        compute_as(sea.frame(), frame, static_cast<LevelSetSlot&>(slot), watch);
    }
    void compute(const SeaAtTime<double>& sea, int frame, OutputSlot& slot,
                 const BuildWatch& watch) override {
        compute_as(sea.frame(), frame, static_cast<LevelSetSlot&>(slot), watch);
    }

    OutputMemory memory() const override {
        constexpr double kFileBytes = 640.0;  // of a block; found 490 … 650
        const double blocks = expected_level_set_blocks(plan_);
        return memory_of(query().points * sizeof(float), 1, blocks * vdb::bytes_a_block<float>(),
                         blocks * kFileBytes);
    }

    void encode(int frame, OutputSlot& any_slot) const override {
        LevelSetSlot& slot = static_cast<LevelSetSlot&>(any_slot);
        slot.file = std::string();
        // One frame at a time, as in spray_part.cpp.
        const std::lock_guard lock(encoding_);
        tbb::this_task_arena::isolate([&] { slot.file = encoded(frame, slot); });
    }

    void write(int frame, const OutputSlot& any_slot, const FileSink& sink) const override {
        const LevelSetSlot& slot = static_cast<const LevelSetSlot&>(any_slot);
        sink({.path = file(frame), .content = [&](const auto& take) { take(slot.file); }});
    }

  private:
    template <class T>
    void compute_as(const Frame<T>& sea, int frame, LevelSetSlot& slot, const BuildWatch& watch) {
        if (meets_hulls()) slot.hulls.emplace(hulls_at(sea, frame));
        std::vector<double> corners_m;
        for (int i = 0; i <= cells_; ++i)
            corners_m.push_back(size_m() * (static_cast<double>(i) / cells_ - 0.5));
        slot.heights_m.resize(corners_m.size() * corners_m.size());
        for_each_row<T>(sea, corners_m, watch,
                        [&](std::size_t first, const Row<T>& row, const PreparedQuery<T>&) {
                            for (std::size_t i = 0; i < row.displacement_m.size(); ++i)
                                slot.heights_m[first + i] = static_cast<float>(row.displacement_m[i].z);
                        });
    }

    // Some voxels below the deepest trough to be expected, the same at every frame; deeper where a frame's is lower still.
    double floor_m(const LevelSetSlot& slot) const {
        const auto deepest_m =
            static_cast<double>(*std::min_element(slot.heights_m.begin(), slot.heights_m.end()));
        const double below_m = std::min(-plan_.from->extent.height_m, deepest_m);
        return (std::floor(below_m / voxel_m()) - kBelow_voxels) * voxel_m();
    }

    std::string encoded(int frame, const LevelSetSlot& slot) const {
        const VoxelLattice lattice = voxels();
        std::vector<vdb::Grid> grids;
        grids.emplace_back(vdb::GridOptions{
            .name = "surface",
            .kind = vdb::GridKind::LevelSet,
            .voxel_m = lattice.voxel_m,
            .first_m = lattice.first_m,
            .background = static_cast<float>(kHalfWidth_voxels * lattice.voxel_m),
            .attributes = attributes(frame, "distance from the water's boundary, negative inside", "m")});
        const SeaSolid solid{.size_m = size_m(),
                             .cells = cells_,
                             .heights_m = slot.heights_m,
                             .floor_m = floor_m(slot),
                             .hulls = slot.hulls ? &*slot.hulls : nullptr};
        for_each_block(solid, lattice, [&](const vdb::Block<float>& block) { grids.front().add(block); });
        return vdb::encode(grids, attributes(frame, "the sea as a closed solid"), fingerprint(frame));
    }

    int cells_;  // along a side
    mutable std::mutex encoding_;
};

}  // namespace

std::unique_ptr<OutputPart> make_level_set_part(const Plan& plan, const PlannedOutput& output) {
    return std::make_unique<LevelSetPart>(plan, output);
}

}  // namespace pelagic
