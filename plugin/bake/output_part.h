// A part of a bake: one output of the plan, what it keeps of a frame, how it becomes bytes and which files
// they go to. Each kind is a class of its own behind this interface and a row of make_parts()
// (output_part.cpp).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/effects/sea_at_time.h"
#include "core/evaluate/hulls.h"
#include "core/evaluate/values.h"
#include "core/plan/fingerprint.h"
#include "core/plan/hulls.h"
#include "core/plan/plan.h"
#include "core/surface/patch.h"
#include "core/waves/frame.h"
#include "plugin/run/part.h"
#include "plugin/run/spray_record.h"

namespace pelagic {

// What an output keeps of one frame between its steps. Slots are used again for other frames.
struct OutputSlot {
    virtual ~OutputSlot() = default;
    Values values;
    std::vector<float> wet;          // where hulls keep water out: wet_share() (core/evaluate/hulls.h)
    std::vector<float> floor_light;  // of a floor's map: what values have no product for
    // Of the frame's record; absent where the output says nothing about it.
    std::optional<double> coverage, significant_height_m;
    std::optional<SprayRecord> spray;
};

// What an output will hold [bytes].
struct OutputMemory {
    std::size_t once = 0;      // from its first frame on, whatever is in flight: points at rest
    std::size_t slot = 0;      // in each frame in flight, beside the query's values: a file as it is encoded
    std::size_t encoding = 0;  // while one frame is encoded
    bool one_at_a_time = false;  // encodes one frame after another
    std::size_t fixed = 0;       // while files that belong to no frame are written, before the first frame
    std::string remedy;
};

class OutputPart {
  public:
    // The plan must outlive the part.
    OutputPart(const Plan& plan, const PlannedOutput& output);
    virtual ~OutputPart() = default;

    const Query& query() const { return plan_.queries[output_.query].query; }
    virtual FilePattern pattern() const = 0;
    std::string file(int frame) const { return pattern().file(frame); }
    // What the file of a frame is made of (core/plan/fingerprint.h), and the output for all frames alike.
    virtual std::string fingerprint(int frame) const {
        return frame_fingerprint(plan_, output_, base_, frame);
    }
    const std::string& fingerprint() const { return base_; }

    // Whether there are hulls that its water isn't in.
    bool meets_hulls() const { return output_.meets_hulls; }
    // Whether its coverage has a past.
    bool has_foam_history() const { return plan_.foam && query().asks_for_past(); }

    virtual std::unique_ptr<OutputSlot> make_slot() const { return std::make_unique<OutputSlot>(); }
    // The frame's values, of the sea at its time. One frame at a time. Throws BuildCancelled where `watch` ends it.
    virtual void compute(const SeaAtTime<float>& sea, int frame, OutputSlot& slot,
                         const BuildWatch& watch) = 0;
    virtual void compute(const SeaAtTime<double>& sea, int frame, OutputSlot& slot,
                         const BuildWatch& watch) = 0;
    // What it will hold, beside the values of its query.
    virtual OutputMemory memory() const = 0;
    // The bytes that aren't the values as they are. Different slots side by side, also while another frame is
    // computed.
    virtual void encode(int frame, OutputSlot& slot) const = 0;
    // Hands the frame's file to the sink; what that throws passes through. As encode().
    virtual void write(int frame, const OutputSlot& slot, const FileSink& sink) const = 0;
    // The files that belong to no frame.
    virtual void write_static(const FileSink&) const {}

  protected:
    const Scene& scene() const { return plan_.from->scene; }
    // Those of a frame: of the sea at its time; only where meets_hulls(). rest_m must last as long as they are asked.
    template <class T>
    const Hulls& hulls_at(const Frame<T>& sea, int frame, RestHeight rest_m = {}) {
        if (!hulls_) hulls_.emplace(scene());
        hulls_->place(sea, hulls_query(), frame, std::move(rest_m));
        return *hulls_;
    }
    std::optional<int> hulls_query() const { return pelagic::hulls_query(plan_); }

    const Plan& plan_;
    PlannedOutput output_;
    std::string base_;

  private:
    std::optional<Hulls> hulls_;
};

// Points at rest over squares, the same for every output that has the same square.
template <class T>
using SharedPoints = std::shared_ptr<const std::vector<glm::vec<2, T>>>;
class SquareCache {
  public:
    template <class T>
    SharedPoints<T> points(const PatchLattice& lattice) {
        auto& known = std::get<std::map<Square, SharedPoints<T>>>(known_);
        SharedPoints<T>& points = known[{lattice.per_side, lattice.spacing_m, lattice.first_m}];
        if (!points) points = std::make_shared<const std::vector<glm::vec<2, T>>>(rest_points<T>(lattice));
        return points;
    }

  private:
    using Square = std::tuple<int, double, double>;
    std::tuple<std::map<Square, SharedPoints<float>>, std::map<Square, SharedPoints<double>>> known_;
};

std::unique_ptr<OutputPart> make_mesh_part(const Plan& plan, const PlannedOutput& output,
                                           const std::shared_ptr<SquareCache>&);
std::unique_ptr<OutputPart> make_map_part(const Plan& plan, const PlannedOutput& output,
                                          const std::shared_ptr<SquareCache>& squares);
std::unique_ptr<OutputPart> make_volume_part(const Plan& plan, const PlannedOutput& output,
                                             const std::shared_ptr<SquareCache>&);
std::unique_ptr<OutputPart> make_drops_part(const Plan& plan, const PlannedOutput& output,
                                            const std::shared_ptr<SquareCache>&);
std::unique_ptr<OutputPart> make_sky_part(const Plan& plan, const PlannedOutput& output,
                                          const std::shared_ptr<SquareCache>&);

// A mean whose parts count by the area of sea that they stand for [any unit, ≥ 0]. 0 without any area.
class AreaMean {
  public:
    void add(double value, double area) {
        sum_ += value * area;
        area_ += area;
    }
    double value() const { return area_ > 0.0 ? sum_ / area_ : 0.0; }

  private:
    double sum_ = 0.0, area_ = 0.0;
};

// The parts of the plan's outputs, in their order.
std::vector<std::unique_ptr<OutputPart>> make_parts(const Plan& plan);

}  // namespace pelagic
