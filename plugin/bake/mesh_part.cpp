// The mesh: a layer for each frame, as a crate or as text, and beside them the layers that say what varies.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/scene/names.h"
#include "core/surface/earth.h"
#include "plugin/bake/output_part.h"
#include "plugin/format/usd/crate.h"
#include "plugin/format/usd/layers.h"
#include "plugin/format/usd/text.h"

namespace pelagic {
namespace {

// 4 × the standard deviation of the heights.
double significant_height_of(const std::vector<glm::vec3>& points) {
    double mean = 0.0, squares = 0.0;
    for (const glm::vec3& p : points) mean += static_cast<double>(p.z);
    mean /= static_cast<double>(points.size());
    for (const glm::vec3& p : points)
        squares += (static_cast<double>(p.z) - mean) * (static_cast<double>(p.z) - mean);
    return 4.0 * std::sqrt(squares / static_cast<double>(points.size()));
}

// The surface's own heights; empty: it is flat.
template <class T>
void raise_by(std::vector<glm::vec3>& positions, const std::vector<T>& height_m) {
    for (std::size_t i = 0; i < height_m.size(); ++i)
        positions[i].z =
            static_cast<float>(static_cast<double>(positions[i].z) + static_cast<double>(height_m[i]));
}

void move_by(std::vector<glm::vec3>& positions, const glm::dvec3& offset_m) {
    if (offset_m == glm::dvec3(0.0)) return;
    for (glm::vec3& p : positions) p = offset_m + glm::dvec3(p);
}

template <class T>
double finest_of(const std::vector<T>& cell_m) {
    return static_cast<double>(*std::min_element(cell_m.begin(), cell_m.end()));
}

// A file's velocities are per second of the screen.
void scale_by(std::vector<glm::vec3>& velocities, double time_scale) {
    if (time_scale == 1.0) return;
    for (glm::vec3& v : velocities) v *= static_cast<float>(time_scale);
}

// What the vertices of a cage have.
struct CageArrays {
    std::vector<glm::vec3> points, velocities, slope_variance;
    std::vector<float> coverage, breaking, age_s, wet;
};

struct MeshSlot final : OutputSlot {
    Faces faces;      // where they vary
    CageArrays cage;  // where the mesh is one; the values are then those of the points that it is fitted to
    glm::dvec3 origin_m{0.0};
    std::string text;  // of a mesh in text; a crate needs none, its arrays are the values
};

class MeshPart final : public OutputPart {
  public:
    MeshPart(const Plan& plan, const PlannedOutput& output)
        : OutputPart(plan, output),
          cage_(plan.surface->fitted()),
          attributes_{.normals = asks(Product::Normal),
                      .velocities = asks(Product::Velocity),
                      .slope_variance = asks(Product::SlopeVariance),
                      .whitecap_coverage = asks(Product::Coverage),
                      .foam_history = has_foam_history(),
                      .wet = meets_hulls(),
                      .faces = !plan.surface->has_constant_faces(),
                      .origin = plan.surface->has_origin(),
                      .st_of_corners = plan.surface->has_st_of_corners()} {}

    FilePattern pattern() const override {
        return {"mesh/" + scene().shot.name + '.', '.' + std::string(word_of(scene().output.mesh))};
    }
    std::unique_ptr<OutputSlot> make_slot() const override { return std::make_unique<MeshSlot>(); }

    void compute(const SeaAtTime<float>& sea, int frame, OutputSlot& slot, const BuildWatch& watch) override {
        compute_as(single_, sea, frame, static_cast<MeshSlot&>(slot), watch);
    }
    void compute(const SeaAtTime<double>& sea, int frame, OutputSlot& slot,
                 const BuildWatch& watch) override {
        compute_as(wide_, sea, frame, static_cast<MeshSlot&>(slot), watch);
    }

    OutputMemory memory() const override {
        const std::size_t points = query().points;
        const std::size_t scalar = plan_.knobs.double_precision ? sizeof(double) : sizeof(float);
        const std::size_t face_bytes = kQuadFaceBytes + (attributes_.st_of_corners ? kQuadSeamBytes : 0);
        const SurfaceBytes surface = plan_.surface->bytes(points, scalar);
        OutputMemory memory{
            .once = points * 2 * scalar + surface.held + (plan_.surface->is_constant() ? 0 : surface.making),
            .remedy = plan_.surface->remedy() + ", or ask for fewer output.attributes"};
        if (attributes_.faces)
            memory.slot = points * face_bytes;
        else
            memory.fixed = points * face_bytes * (keeps_faces() ? 2 : 1) + surface.held + surface.making;
        if (keeps_faces()) memory.once += points * face_bytes;
        // Footprints of each point, and the grid that they are taken from.
        if (!plan_.surface->is_constant())
            memory.once += points * (2 * scalar + sizeof(glm::vec2) + 2 * sizeof(float) + sizeof(double));
        if (meets_hulls()) memory.slot += points * sizeof(float);
        if (cage_) memory.slot += points * numbers() * sizeof(float);  // beside the points' values
        if (is_text()) {
            memory.slot += points * kText * numbers();
            memory.encoding =
                points * kText * numbers() / 2;  // the string moves to a larger place as it grows
            if (memory.fixed > 0) memory.fixed += points * face_bytes;
            memory.remedy += "; output.mesh = \"usdc\" needs a third";
        }
        return memory;
    }

    void encode(int frame, OutputSlot& any_slot) const override {
        MeshSlot& slot = static_cast<MeshSlot&>(any_slot);
        slot.coverage.reset();
        slot.significant_height_m.reset();
        if (cage_) {
            take_statistics_of_patch(slot);
            fit_cage(slot);
        } else {
            take_statistics(slot, slot.values.vectors(Product::Position),
                            slot.values.numbers(Product::Coverage));
        }
        slot.text.clear();
        if (!is_text()) return;
        usd::write_frame_text(sample(frame, fingerprint(frame), slot),
                              [&](std::string_view piece) { slot.text += piece; });
    }

    void write(int frame, const OutputSlot& any_slot, const FileSink& sink) const override {
        const MeshSlot& slot = static_cast<const MeshSlot&>(any_slot);
        const std::string made_of = fingerprint(frame);
        sink({.path = file(frame), .content = [&](const usd::Sink& take) {
                  if (is_text())
                      take(slot.text);
                  else
                      usd::write_frame_crate(sample(frame, made_of, slot), take);
              }});
    }

    void write_static(const FileSink& sink) const override {
        const Shot& shot = scene().shot;
        usd::Topology topology{
            .fps = shot.fps,
            .scheme = cage_ ? usd::SubdivisionScheme::CatmullClark : usd::SubdivisionScheme::None,
            .attributes = attributes_};
        Faces faces;
        if (!attributes_.faces) {
            plan_.surface->faces_at(shot.first_frame, faces);
            topology.face_vertex_counts = faces.counts;
            topology.face_vertex_indices = faces.indices;
            topology.st = faces.st;
        }
        sink({.path = usd::topology_file(shot.name, word_of(scene().output.mesh)),
              .content = [&](const usd::Sink& take) {
                  if (is_text())
                      usd::write_topology_text(topology, take);
                  else
                      usd::write_topology_crate(topology, take);
              }});
        sink({.path = usd::manifest_file(shot.name), .content = [&](const usd::Sink& take) {
                  take(usd::manifest_text({.fps = shot.fps, .attributes = attributes_}));
              }});
    }

  private:
    template <class T>
    struct State {
        RestPoints<T> points;
        bool is_laid_out = false;
        QueryRunner<T> runner;
    };

    // Characters of a number in text, with what separates them, as a mesh has them.
    static constexpr std::size_t kText = 13;
    std::size_t numbers() const {
        std::size_t count = 0;
        for (const ProductRow& row : kProductTable)
            if (asks(row.product)) count += row.components;
        return count + meets_hulls();
    }

    bool asks(Product product) const { return query().products[index(product)]; }
    // The mean coverage of a frame goes over faces. Those of a surface that never changes are known without a list.
    bool keeps_faces() const {
        const RestSurface& surface = *plan_.surface;
        return surface.has_constant_faces() && !query().lattice && asks(Product::Coverage);
    }
    bool is_text() const { return scene().output.mesh == MeshFormat::Usda; }

    template <class T>
    void compute_as(State<T>& state, const SeaAtTime<T>& sea, int frame, MeshSlot& slot,
                    const BuildWatch& watch) {
        const RestSurface& surface = *plan_.surface;
        if (!state.is_laid_out || !surface.is_constant()) surface.points_at(frame, state.points);
        state.is_laid_out = true;
        if (attributes_.faces) surface.faces_at(frame, slot.faces);
        if (keeps_faces() && faces_.counts.empty()) surface.faces_at(frame, faces_);
        const RestPoints<T>& at = state.points;
        Points<T> points{.origin_m = at.origin_m, .count = at.rest_m.size(), .rest_m = {at.rest_m.data()}};
        if (!at.cell_m.empty()) points.cell_m = {at.cell_m.data()};
        if (!at.pixel_m.empty()) points.pixel_m = {at.pixel_m.data()};
        if (!at.cell_axis_m.empty()) points.cell_axis_m = {at.cell_axis_m.data()};
        if (!at.pixel_axis_m.empty()) points.pixel_axis_m = {at.pixel_axis_m.data()};
        if (!at.normal.empty()) points.rest_normal = {at.normal.data()};
        state.runner.run(sea, output_.query, points, slot.values, watch);
        raise_by(slot.values.vectors(Product::Position), at.height_m);
        if (meets_hulls()) meet_hulls(sea.frame(), frame, points, at, slot);
        if (attributes_.origin) slot.origin_m = local_origin(place_of_origin(at), finest_of(at.cell_m));
        if (at.curvature_per_m != 0.0)
            lay_on_earth(at, slot.origin_m, slot.values);
        else
            move_by(slot.values.vectors(Product::Position), glm::dvec3(at.origin_m, 0.0) - slot.origin_m);
        scale_by(slot.values.vectors(Product::Velocity), scene().shot.time_scale);
    }

    // Positions are still those of the flat sea, relative to the points' origin.
    template <class T>
    void meet_hulls(const Frame<T>& sea, int frame, const Points<T>& points, const RestPoints<T>& at,
                    MeshSlot& slot) {
        RestHeight rest_m;
        if (!at.height_m.empty())
            rest_m = [&](glm::dvec2 place_m) {  // the nearest point's
                std::size_t nearest = 0;
                double least = std::numeric_limits<double>::infinity();
                for (std::size_t i = 0; i < at.rest_m.size(); ++i) {
                    const glm::dvec2 way = at.origin_m + glm::dvec2(at.rest_m[i]) - place_m;
                    if (const double square = glm::dot(way, way); square < least) {
                        least = square;
                        nearest = i;
                    }
                }
                return static_cast<double>(at.height_m[nearest]);
            };
        slot.wet.resize(points.count);
        std::vector<float> foam(asks(Product::Coverage) ? points.count : 0);
        hulls_at(sea, frame, std::move(rest_m))
            .meet(sea, hulls_query(), points, query().cell_m.front(),
                  {slot.values.vectors(Product::Position), slot.values.vectors(Product::Velocity)},
                  {slot.wet, foam});
        add_contact_foam(foam, slot.values);
    }

    // Of the frame's record.
    void take_statistics(MeshSlot& slot, const std::vector<glm::vec3>& positions,
                         const std::vector<float>& coverage) const {
        if (!coverage.empty()) slot.coverage = mean_coverage(slot, positions, coverage);
        if (plan_.surface->is_even()) slot.significant_height_m = significant_height_of(positions);
    }
    // The same without what lies round the patch for the fit.
    void take_statistics_of_patch(MeshSlot& slot) const {
        std::vector<glm::vec3> positions;
        std::vector<float> coverage;
        cage_->crop<glm::vec3>(slot.values.vectors(Product::Position), FittedCage::kMargin, positions);
        if (asks(Product::Coverage))
            cage_->crop<float>(slot.values.numbers(Product::Coverage), FittedCage::kMargin, coverage);
        take_statistics(slot, positions, coverage);
    }

    void fit_cage(MeshSlot& slot) const {
        CageArrays& cage = slot.cage;
        cage_->fit(slot.values.vectors(Product::Position), cage.points);
        if (asks(Product::Velocity)) cage_->fit(slot.values.vectors(Product::Velocity), cage.velocities);
        const auto keep = [&](const auto& values, auto& kept) {
            if (!values.empty())
                cage_->crop<typename std::decay_t<decltype(kept)>::value_type>(values, FittedCage::kReach,
                                                                               kept);
        };
        keep(slot.values.vectors(Product::SlopeVariance), cage.slope_variance);
        keep(slot.values.numbers(Product::Coverage), cage.coverage);
        keep(slot.values.numbers(Product::Breaking), cage.breaking);
        keep(slot.values.numbers(Product::FoamAge), cage.age_s);
        keep(slot.wet, cage.wet);
    }

    static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

    // Of a square of quads: each edge serves the two faces beside it, which go along it in opposite ways.
    static double mean_coverage_of_square(const std::vector<glm::vec3>& positions,
                                          const std::vector<float>& coverage) {
        const auto side =
            static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(positions.size()))));
        AreaMean mean;
        std::vector<glm::dvec2> below(positions.begin(), positions.begin() + side);
        std::vector<double> along(side);  // the edges of the row below
        for (std::size_t x = 0; x + 1 < side; ++x) along[x] = cross(below[x], below[x + 1]);
        for (std::size_t y = 0; y + 1 < side; ++y) {
            const float *low = coverage.data() + y * side, *high = low + side;
            glm::dvec2 left(positions[(y + 1) * side]);
            double up = cross(below[0], left);
            for (std::size_t x = 0; x + 1 < side; ++x) {
                const glm::dvec2 right(positions[(y + 1) * side + x + 1]);
                const double next_up = cross(below[x + 1], right), above = cross(left, right);
                const double twice_area = -up + along[x] + next_up - above;
                const double sum = static_cast<double>(low[x]) + static_cast<double>(low[x + 1]) +
                                   static_cast<double>(high[x + 1]) + static_cast<double>(high[x]);
                mean.add(sum / 4.0, std::max(twice_area, 0.0));
                along[x] = above;
                below[x] = left;
                left = right;
                up = next_up;
            }
            below[side - 1] = left;
        }
        return mean.value();
    }

    // Over the faces, as seen from above; a face that is folded over lies under others.
    double mean_coverage(const MeshSlot& slot, const std::vector<glm::vec3>& positions,
                         const std::vector<float>& coverage) const {
        if (query().lattice) return mean_coverage_of_square(positions, coverage);
        AreaMean mean;
        const auto add = [&](std::span<const std::int32_t> corners) {
            double twice_area = 0.0, sum = 0.0;
            const std::int32_t* before = corners.data() + corners.size() - 1;
            for (const std::int32_t* at = corners.data(); at != corners.data() + corners.size();
                 before = at++) {
                twice_area += cross(glm::dvec2(positions[*before]), glm::dvec2(positions[*at]));
                sum += static_cast<double>(coverage[*at]);
            }
            mean.add(sum / static_cast<double>(corners.size()), std::max(twice_area, 0.0));
        };
        const Faces& faces = attributes_.faces ? slot.faces : faces_;
        const std::int32_t* corner = faces.indices.data();
        for (const std::int32_t count : faces.counts) {
            add({corner, static_cast<std::size_t>(count)});
            corner += count;
        }
        return mean.value();
    }

    // Of the points' origin, in the world.
    template <class T>
    static glm::dvec3 place_of_origin(const RestPoints<T>& at) {
        const glm::dvec2 from_m = at.origin_m - at.touches_at_m;
        return glm::dvec3(at.touches_at_m, 0.0) + on_earth(glm::dvec3(from_m, 0.0), at.curvature_per_m);
    }

    // What a flat sea's answers are on the earth; positions relative to the mesh's origin.
    template <class T>
    static void lay_on_earth(const RestPoints<T>& at, const glm::dvec3& mesh_origin_m, Values& values) {
        const glm::dvec2 from_m = at.origin_m - at.touches_at_m;
        const glm::dvec3 relative_m = glm::dvec3(at.touches_at_m, 0.0) - mesh_origin_m;
        const auto turn = [&](std::vector<glm::vec3>& directions) {
            for (std::size_t i = 0; i < directions.size(); ++i)
                directions[i] = from_level(glm::dvec3(directions[i]),
                                           earth_up(from_m + glm::dvec2(at.rest_m[i]), at.curvature_per_m));
        };
        for (glm::vec3& position : values.vectors(Product::Position))
            position =
                relative_m + on_earth(glm::dvec3(from_m, 0.0) + glm::dvec3(position), at.curvature_per_m);
        turn(values.vectors(Product::Normal));
        turn(values.vectors(Product::Velocity));
    }

    usd::MeshSample sample(int frame, const std::string& made_of, const MeshSlot& slot) const {
        usd::MeshSample sample{.frame = frame,
                               .fps = scene().shot.fps,
                               .fingerprint = made_of,
                               .points = slot.values.vectors(Product::Position),
                               .normals = slot.values.vectors(Product::Normal),
                               .velocities = slot.values.vectors(Product::Velocity),
                               .slope_variance = slot.values.vectors(Product::SlopeVariance),
                               .whitecap_coverage = slot.values.numbers(Product::Coverage),
                               .breaking = slot.values.numbers(Product::Breaking),
                               .age_s = slot.values.numbers(Product::FoamAge),
                               .wet = slot.wet};
        if (cage_) {
            sample.points = slot.cage.points;
            sample.velocities = slot.cage.velocities;
            sample.slope_variance = slot.cage.slope_variance;
            sample.whitecap_coverage = slot.cage.coverage;
            sample.breaking = slot.cage.breaking;
            sample.age_s = slot.cage.age_s;
            sample.wet = slot.cage.wet;
        }
        if (attributes_.origin) sample.origin_m = slot.origin_m;
        if (attributes_.faces)
            sample.faces = usd::Faces{.counts = slot.faces.counts,
                                      .indices = slot.faces.indices,
                                      .st = slot.faces.st,
                                      .is_st_of_corners = slot.faces.is_st_of_corners};
        return sample;
    }

    std::optional<FittedCage> cage_;
    usd::AttributeSet attributes_;
    Faces faces_{};  // where all frames share them and they are no square of quads
    State<float> single_;
    State<double> wide_;
};

}  // namespace

std::unique_ptr<OutputPart> make_mesh_part(const Plan& plan, const PlannedOutput& output,
                                           const std::shared_ptr<SquareCache>&) {
    return std::make_unique<MeshPart>(plan, output);
}

}  // namespace pelagic
