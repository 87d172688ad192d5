// What volumes have in common: where their points lie in the world, their files, and what those say of themselves.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/evaluate/places.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "pelagic/version.h"
#include "plugin/bake/level_set.h"
#include "plugin/bake/output_part.h"
#include "plugin/bake/volumes.h"
#include "plugin/format/vdb/vdb.h"

namespace pelagic {

class VolumePart : public OutputPart {
  public:
    FilePattern pattern() const override { return volume_pattern(scene(), *output_.volume); }

  protected:
    using OutputPart::OutputPart;

    double voxel_m() const { return scene().output.voxel_m; }
    double size_m() const { return scene().surface.size_m; }
    VoxelLattice voxels() const { return voxels_over(size_m(), voxel_m()); }

    // Of `grids` grids that take so much, in a file of so many bytes [bytes]. While a frame is encoded they are there with what
    // the heap loses between them, and the file grows by doubling.
    OutputMemory memory_of(std::size_t values, int grids, double in_grids, double in_file) const {
        constexpr double kHeap = 1.25;  // found, over winds and voxels, beside what the grids' blocks take
        const auto file = static_cast<std::size_t>(in_file);
        return {.slot = values + file,
                .encoding = static_cast<std::size_t>(kHeap * in_grids) + 2 * file + grids * vdb::kTreeBytes,
                .one_at_a_time = true,
                .remedy = "raise output.voxel_m, or lower surface.size_m"};
    }

    // The sea at places of the world, row after row of rising y, some rows at a time: take(first place, its row's
    // neighbours, …, the query) sees the values of the query's products there.
    template <class T>
    struct Row {
        std::vector<glm::vec<2, T>> places_m;
        std::vector<glm::vec<3, T>> displacement_m;
        std::vector<T> breaking;
    };
    // places_m: along a side, of x and y alike.
    template <class T, class Take>
    void for_each_row(const Frame<T>& sea, const std::vector<double>& places_m, const BuildWatch& watch,
                      const Take& take) const {
        const PreparedQuery<T> ask(sea, output_.query, query().products);
        const PlaceSearch search{.tolerance_m = std::min(1e-3, 1e-2 * voxel_m())};
        const std::size_t a_row = places_m.size();
        // Enough points for all threads.
        const std::size_t rows_at_once = std::max<std::size_t>(kPointsAtOnce / a_row, 1);
        Row<T> at;
        for (std::size_t first = 0; first < a_row; first += rows_at_once) {
            stop_if(watch.cancel);
            const std::size_t rows = std::min(rows_at_once, a_row - first);
            at.places_m.clear();
            for (std::size_t row = first; row < first + rows; ++row)
                for (const double x_m : places_m)
                    at.places_m.emplace_back(static_cast<T>(x_m), static_cast<T>(places_m[row]));
            const std::size_t count = at.places_m.size();
            at.displacement_m.resize(count);
            Results<T> results;
            results.set(Product::Displacement, {at.displacement_m.data()});
            if (query().products[index(Product::Breaking)]) {
                at.breaking.resize(count);
                results.set(Product::Breaking, {at.breaking.data()});
            }
            evaluate_at<T>(ask, {.count = count, .rest_m = {at.places_m.data()}}, search, results);
            take(first * a_row, at, ask);
        }
    }

    // Of a file.
    std::vector<vdb::Attribute> attributes(int frame, const std::string& content) const {
        std::vector<vdb::Attribute> all{
            {"content", content},
            {"space",
             std::string("metres, z up, right-handed; a voxel's value is that of its middle's place")},
            {"size", size_m()},
            {"time", scene().shot.time_s(frame)},
            {"fps", scene().shot.fps},
            {"frame", std::int64_t{frame}},
            {"fingerprint", fingerprint(frame)},
            {"software", std::string("pelagic " PELAGIC_VERSION)}};
        describe(scene(), output_.key_parts, all);
        return all;
    }
    // Of a grid, which programs copy without what its file says.
    std::vector<vdb::Attribute> attributes(int frame, const std::string& content,
                                           const std::string& unit) const {
        return {{"content", content},
                {"unit", unit},
                {"time", scene().shot.time_s(frame)},
                {"frame", std::int64_t{frame}},
                {"seed", std::to_string(scene().shot.seed)},
                {"wind_speed_mps", scene().sea.wind_speed_mps},
                {"wind_direction_deg", scene().sea.wind_direction_deg}};
    }

  private:
    static constexpr std::size_t kPointsAtOnce = std::size_t{1} << 16;
};

// As make_mesh_part().
std::unique_ptr<OutputPart> make_spray_part(const Plan& plan, const PlannedOutput& output);
std::unique_ptr<OutputPart> make_level_set_part(const Plan& plan, const PlannedOutput& output);

}  // namespace pelagic
