// Spray: how much droplets dim light, and how they fly, in voxels over the patch's square.
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <mutex>

#include "core/base/constants.h"
#include "core/effects/spray.h"
#include "core/plan/spray.h"
#include "core/plan/wind_profile.h"
#include "plugin/bake/volume_blocks.h"
#include "plugin/bake/volume_part.h"

namespace pelagic {
namespace {

struct SpraySlot final : OutputSlot {
    // By column: the sea's height, how much breaks beside the sea's mean, and how much spray, at three heights; and how far up it stays.
    std::vector<float> heights_m, breaking;
    std::vector<glm::vec3> shares;
    std::vector<float> lifts_m;
    SprayLaw law;                        // of the moment
    double wind_mps = 0.0, top_m = 0.0;  // top_m: of the spray, over the sea
    std::string file;
};

// The profile's mean over [from_m, to_m] above the sea, none below it.
double mean_profile(double scale_m, double from_m, double to_m) {
    if (!(to_m > 0.0)) return 0.0;
    return scale_m * (std::exp(-std::max(from_m, 0.0) / scale_m) - std::exp(-to_m / scale_m)) /
           (to_m - from_m);
}

class SprayPart final : public VolumePart {
  public:
    SprayPart(const Plan& plan, const PlannedOutput& output) : VolumePart(plan, output) {
        const int columns = voxels_a_side(scene());
        const double half_m = 0.5 * size_m();
        for (int i = 0; i < columns; ++i) {
            const double low_m = -half_m + i * voxel_m(), high_m = std::min(low_m + voxel_m(), half_m);
            middles_m_.push_back(0.5 * (low_m + high_m));
            widths_.push_back((high_m - low_m) / voxel_m());
        }
    }

    std::unique_ptr<OutputSlot> make_slot() const override { return std::make_unique<SpraySlot>(); }

    void compute(const SeaAtTime<float>& sea, int frame, OutputSlot& slot, const BuildWatch& watch) override {
        compute_as(sea.frame(), frame, static_cast<SpraySlot&>(slot), watch);
    }
    void compute(const SeaAtTime<double>& sea, int frame, OutputSlot& slot,
                 const BuildWatch& watch) override {
        compute_as(sea.frame(), frame, static_cast<SpraySlot&>(slot), watch);
    }

    OutputMemory memory() const override {
        constexpr double kBlockBytes = 500.0, kVoxelBytes = 6.0;  // of a file; fitted to 4 … 30 m/s
        const ExpectedSpray spray = expected_spray(plan_);
        return memory_of(columns() * columns() * 6 * sizeof(float), 2,
                         spray.blocks * (vdb::bytes_a_block<float>() + vdb::bytes_a_block<glm::vec3>()),
                         spray.blocks * kBlockBytes + spray.voxels * kVoxelBytes);
    }

    void encode(int frame, OutputSlot& any_slot) const override {
        SpraySlot& slot = static_cast<SpraySlot&>(any_slot);
        slot.file = std::string();
        // One frame's grids at a time: they are much larger than their file. The threads that help must not take up another
        // frame, which would wait for this one.
        const std::lock_guard lock(encoding_);
        tbb::this_task_arena::isolate([&] { slot.file = encoded(frame, slot); });
        slot.spray = spray_of(slot);
    }

    void write(int frame, const OutputSlot& any_slot, const FileSink& sink) const override {
        const SpraySlot& slot = static_cast<const SpraySlot&>(any_slot);
        sink({.path = file(frame), .content = [&](const auto& take) { take(slot.file); }});
    }

  private:
    std::size_t columns() const { return middles_m_.size(); }

    template <class T>
    void compute_as(const Frame<T>& sea, int frame, SpraySlot& slot, const BuildWatch& watch) {
        const Hulls* hulls = meets_hulls() ? &hulls_at(sea, frame) : nullptr;
        slot.heights_m.resize(columns() * columns());
        slot.breaking.resize(slot.heights_m.size());
        slot.shares.resize(slot.heights_m.size());
        slot.lifts_m.resize(slot.heights_m.size());
        const double mean = mean_breaking(sea.sea());
        const SprayVeil veil(sea);
        slot.law = veil.law();
        slot.top_m = spray_top_m(slot.law);
        slot.wind_mps = veil.wind_speed_mps();  // 0 where there is none: nothing flies then
        std::vector<glm::dvec3> shares;
        std::vector<double> cells_m, lifts_m;
        for_each_row<T>(
            sea, middles_m_, watch, [&](std::size_t first, const Row<T>& row, const PreparedQuery<T>& ask) {
                const std::size_t count = row.breaking.size();
                shares.resize(count);
                lifts_m.resize(count);
                cells_m.assign(count, voxel_m());
                veil.shares<T>(ask, {.count = count, .rest_m = {row.places_m.data()}}, row.breaking,
                               row.displacement_m, cells_m, shares, lifts_m);
                for (std::size_t i = 0; i < count; ++i) {
                    slot.heights_m[first + i] = static_cast<float>(row.displacement_m[i].z);
                    slot.breaking[first + i] =
                        mean > 0.0 ? static_cast<float>(static_cast<double>(row.breaking[i]) / mean) : 0.0f;
                    slot.shares[first + i] = glm::vec3(shares[i]);
                    slot.lifts_m[first + i] = static_cast<float>(lifts_m[i]);
                    if (!hulls) continue;
                    // Above water that is in a hull there is none.
                    const glm::dvec3 place(glm::dvec2(row.places_m[i]),
                                           static_cast<double>(row.displacement_m[i].z));
                    const float wet = Hulls::wet_share(hulls->distance_m(place), voxel_m());
                    slot.breaking[first + i] *= wet;
                    slot.shares[first + i] *= wet;
                }
            });
    }

    // The extinctions of a column's voxels at the heights of the ribbons, or at the surface alone, as means over them where the
    // square ends within.
    glm::dvec3 extinction_per_m(const SpraySlot& slot, std::size_t x, std::size_t y) const {
        glm::dvec3 share(slot.shares[y * columns() + x]);
        for (int i = 0; i < 3; ++i)
            if (share[i] < kNegligibleSpray) share[i] = 0.0;
        if (slot.law.over_foam.extinction_per_m > 0.0)
            return {slot.law.over_foam.extinction_per_m * share.x * widths_[x] * widths_[y], 0.0, 0.0};
        return slot.law.ribbons.extinction_per_m * share * widths_[x] * widths_[y];
    }
    // Their mean over a height above the sea.
    static double mean_over(const SprayLaw& law, const glm::dvec3& extinction_per_m, double from_m,
                            double to_m, double lift_m) {
        return law.over_foam.extinction_per_m > 0.0
                   ? extinction_per_m.x * mean_profile(law.over_foam.scale_m, from_m, to_m)
                   : law.ribbons.mean(extinction_per_m, from_m, to_m, lift_m);
    }

    std::string encoded(int frame, const SpraySlot& slot) const {
        const VoxelLattice lattice = voxels();
        const auto grid_of = [&](const char* name, const char* also_named, vdb::GridKind kind,
                                 const char* content, const char* unit) {
            std::vector<vdb::Attribute> about = attributes(frame, content, unit);
            if (slot.law.haze.extinction_per_m > 0.0) {
                about.push_back({"haze_extinction_per_m", slot.law.haze.extinction_per_m});
                about.push_back({"haze_scale_m", slot.law.haze.scale_m});
            }
            return vdb::Grid({.name = name,
                              .also_named = also_named,
                              .kind = kind,
                              .voxel_m = lattice.voxel_m,
                              .first_m = lattice.first_m,
                              .attributes = std::move(about)});
        };
        std::vector<vdb::Grid> grids;
        grids.push_back(grid_of("density", "", vdb::GridKind::FogVolume,
                                "extinction of spray, means over voxels", "1/m"));
        // As Blender calls it, and Houdini with Karma.
        grids.push_back(grid_of("velocity", "v", vdb::GridKind::Velocity,
                                "velocity of the air that carries it", "m/s, of the shot's seconds"));
        const int a_side = static_cast<int>((columns() + vdb::kBlock - 1) / vdb::kBlock);
        tbb::parallel_for(0, a_side * a_side, [&](int i) {
            add_blocks(slot, {i % a_side, i / a_side}, grids[0], grids[1]);
        });
        return vdb::encode(grids, attributes(frame, "spray"), fingerprint(frame));
    }

    void add_blocks(const SpraySlot& slot, glm::ivec2 column, vdb::Grid& density, vdb::Grid& velocity) const {
        const glm::ivec2 first = column * vdb::kBlock;
        const glm::ivec2 end = glm::min(first + vdb::kBlock, static_cast<int>(columns()));
        // Of voxels, over the columns that have any.
        int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();
        for (int y = first.y; y < end.y; ++y)
            for (int x = first.x; x < end.x; ++x) {
                if (extinction_per_m(slot, x, y) == glm::dvec3(0.0)) continue;
                const auto height_m = static_cast<double>(slot.heights_m[y * columns() + x]);
                low = std::min(low, static_cast<int>(std::floor(height_m / voxel_m())));
                high = std::max(high, static_cast<int>(std::floor((height_m + slot.top_m) / voxel_m())));
            }
        if (low > high) return;
        const auto block_of = [](int voxel) {
            return static_cast<int>(std::floor(voxel / double{vdb::kBlock}));
        };
        for (int k = block_of(low); k <= block_of(high); ++k)
            add_block(slot, {first, k * vdb::kBlock}, density, velocity);
    }

    void add_block(const SpraySlot& slot, glm::ivec3 first, vdb::Grid& density, vdb::Grid& velocity) const {
        vdb::Block<float> thick{.first = first};
        vdb::Block<glm::vec3> moved{.first = first};
        const double towards = scene().sea.wind_direction_deg * kPi / 180.0;
        const glm::dvec2 downwind(std::cos(towards), std::sin(towards));
        const WindProfile wind(slot.wind_mps);
        const int count = static_cast<int>(columns());
        for (int i = 0; i < vdb::kBlock && first.x + i < count; ++i)
            for (int j = 0; j < vdb::kBlock && first.y + j < count; ++j) {
                const auto x = static_cast<std::size_t>(first.x + i),
                           y = static_cast<std::size_t>(first.y + j);
                const glm::dvec3 extinction = extinction_per_m(slot, x, y);
                if (extinction == glm::dvec3(0.0)) continue;
                const auto height_m = static_cast<double>(slot.heights_m[y * columns() + x]);
                const auto lift_m = static_cast<double>(slot.lifts_m[y * columns() + x]);
                for (int k = 0; k < vdb::kBlock; ++k) {
                    const double from_m = (first.z + k) * voxel_m() - height_m, to_m = from_m + voxel_m();
                    const auto value =
                        static_cast<float>(mean_over(slot.law, extinction, from_m, to_m, lift_m));
                    if (!(value > 0.0f) || from_m > slot.top_m) continue;
                    const std::size_t at = vdb::index_in_block(i, j, k);
                    thick.active[at] = moved.active[at] = true;
                    thick.values[at] = value;
                    // The wind at the middle of the voxel's part that is in the air.
                    const double speed_mps =
                        wind.at(0.5 * (std::max(from_m, 0.0) + to_m)) * scene().shot.time_scale;
                    moved.values[at] = glm::vec3(glm::dvec3(downwind * speed_mps, 0.0));
                }
            }
        if (thick.active.none()) return;
        density.add(thick);
        velocity.add(moved);
    }

    // Totals of what the file holds; the share of breaking is of all columns.
    SprayRecord spray_of(const SpraySlot& slot) const {
        SprayRecord spray;
        double area = 0.0;  // in columns
        for (std::size_t y = 0; y < columns(); ++y)
            for (std::size_t x = 0; x < columns(); ++x) {
                const double width = widths_[x] * widths_[y];
                const auto breaking = static_cast<double>(slot.breaking[y * columns() + x]);
                area += width;
                spray.breaking_over_mean += width * breaking;
                if (breaking >= kNegligibleSpray)
                    spray.mass_flux_kg_per_s +=
                        width * breaking * slot.law.mass_flux_kg_per_m2_s * voxel_m() * voxel_m();
                const glm::dvec3 extinction = extinction_per_m(slot, x, y);
                if (extinction == glm::dvec3(0.0)) continue;
                const auto height_m = static_cast<double>(slot.heights_m[y * columns() + x]);
                const double top_m =
                    (std::floor((height_m + slot.top_m) / voxel_m()) + 1.0) * voxel_m() - height_m;
                spray.optical_thickness += mean_over(slot.law, extinction, 0.0, top_m,
                                                     static_cast<double>(slot.lifts_m[y * columns() + x])) *
                                           top_m;
            }
        spray.breaking_over_mean /= area;
        spray.optical_thickness /= area;
        return spray;
    }

    std::vector<double> middles_m_, widths_;  // of columns along a side, within the square; widths in voxels
    mutable std::mutex encoding_;
};

}  // namespace

std::unique_ptr<OutputPart> make_spray_part(const Plan& plan, const PlannedOutput& output) {
    return std::make_unique<SprayPart>(plan, output);
}

}  // namespace pelagic
