#include "plugin/bake/sequence.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

#include "core/base/constants.h"
#include "core/evaluate/values.h"
#include "core/plan/tables.h"
#include "core/scene/names.h"
#include "core/scene/text.h"
#include "core/surface/patch.h"
#include "core/surface/projected_grid.h"
#include "plugin/bake/maps.h"
#include "plugin/exr/exr.h"
#include "plugin/usd/camera.h"
#include "plugin/usd/crate.h"
#include "plugin/usd/layers.h"
#include "plugin/usd/text.h"

namespace pelagic {
namespace {

template <class T>
struct Square {  // points at rest over a square
    PatchLattice lattice;
    std::vector<glm::vec<2, T>> points;
};

// A map or a tile: the query that feeds it, where it lies and what it is called.
template <class T>
struct MapJob {
    int query = 0;
    MapKind kind = MapKind::Displacement;
    std::string stem;  // "maps/displacement" or "tiles/displacement.0"
    int n = 1;
    double size_m = 1.0;
    bool periodic = false;
    std::shared_ptr<const Square<T>> square;
};

bool asks(const Query& query, Product product) {
    return query.products[index(product)];
}

// UsdPreviewSurface's roughness: α² = 2σ² with σ² = mss/2 along each axis, roughness = √α.
double preview_roughness(double mss) {
    return std::min(std::sqrt(std::sqrt(std::max(mss, 0.0))), 1.0);
}

double mean_of(const std::vector<float>& values) {
    double sum = 0.0;
    for (const float value : values) sum += static_cast<double>(value);
    return sum / static_cast<double>(values.size());
}

double significant_height_of(const std::vector<glm::vec3>& points) {
    double mean = 0.0, squares = 0.0;
    for (const glm::vec3& p : points) mean += static_cast<double>(p.z);
    mean /= static_cast<double>(points.size());
    for (const glm::vec3& p : points)
        squares += (static_cast<double>(p.z) - mean) * (static_cast<double>(p.z) - mean);
    return 4.0 * std::sqrt(squares / static_cast<double>(points.size()));
}

template <class T>
Square<T> square_of(int per_side, double size_m, int intervals) {
    const PatchLattice lattice{
        .per_side = per_side, .spacing_m = size_m / intervals, .first_m = -0.5 * size_m};
    return {lattice, rest_points<T>(lattice)};
}

template <class T>
Points<T> points_of(const std::vector<glm::vec<2, T>>& rest) {
    return {.count = rest.size(), .rest_m = {rest.data()}};
}

// What a camera sees at one frame: the projected grid, in the precision of the sea. Its vertices are all that
// the file has: what lies between them is hidden from normals as it is from positions.
template <class T>
struct SeenPoints {
    glm::dvec2 origin_m{0.0};
    std::vector<glm::vec<2, T>> rest;
    std::vector<T> cell_m;

    void take(const ProjectedGrid& grid) {
        origin_m = grid.origin_m;
        rest.assign(grid.rest_m.begin(), grid.rest_m.end());
        cell_m.assign(grid.cell_m.begin(), grid.cell_m.end());
    }
    Points<T> points() const {
        return {.origin_m = origin_m,
                .count = rest.size(),
                .rest_m = {rest.data()},
                .cell_m = {cell_m.data()},
                .pixel_m = {cell_m.data()}};
    }
};

// Positions relative to an origin, put into the world.
void move_by(std::vector<glm::vec3>& positions, glm::dvec2 origin_m) {
    for (glm::vec3& p : positions) {
        p.x = static_cast<float>(origin_m.x + static_cast<double>(p.x));
        p.y = static_cast<float>(origin_m.y + static_cast<double>(p.y));
    }
}

template <class T>
class SequenceOf final : public Sequence {
  public:
    SequenceOf(const Scene& scene, const Plan& plan)
        : scene_(scene), sea_(std::make_shared<const Sea<T>>(plan)), frame_(sea_) {
        for (int q = 0; q < static_cast<int>(plan.queries.size()); ++q) {
            const Query& query = plan.queries[q].query;
            if (query.map) {
                maps_.push_back(map_job(q));
            } else {
                mesh_query_ = q;
                if (follows_camera()) {
                    grid_options_ = projected_grid_options(*plan.from);
                    grid_options_.size = projected_grid_needs(*plan.from).size;
                } else {
                    mesh_square_ = square_of<T>(scene.surface.resolution + 1, scene.surface.size_m,
                                                scene.surface.resolution);
                }
            }
        }
    }

    void compute(int frame, FrameSlot& slot) override {
        slot.frame = frame;
        slot.record = {};
        slot.record.fingerprint = sea_->plan().fingerprint_text();
        slot.record.time_s = scene_.shot.time_s(frame);
        frame_.set(slot.record.time_s);
        describe_waves(slot.record);
        if (mesh_query_ >= 0) compute_mesh(frame, slot.mesh);
        slot.maps.resize(maps_.size());
        for (std::size_t m = 0; m < maps_.size(); ++m) {
            runner_.run(frame_, maps_[m].query, points_of(maps_[m].square->points), slot.maps[m].values);
            if (maps_[m].kind == MapKind::SlopeVariance) slot.maps[m].hidden = hidden_by_level(maps_[m]);
        }
    }

    void encode(FrameSlot& slot) const override {
        tbb::parallel_for(std::size_t(0), maps_.size() + 1, [&](std::size_t file) {
            if (file < maps_.size()) {
                FrameSlot::Map& map = slot.maps[file];
                map.file = std::string();  // let go before the new one is made
                map.file = encoded(maps_[file], map, slot.frame);
            } else if (mesh_query_ >= 0) {
                encode_mesh(slot);
            }
        });
        const auto take_coverage = [&](const Values& values) {
            const std::vector<float>& coverage = values.numbers(Product::Coverage);
            if (!coverage.empty() && !slot.record.coverage) slot.record.coverage = mean_of(coverage);
        };
        take_coverage(slot.mesh);
        for (const FrameSlot::Map& map : slot.maps) take_coverage(map.values);
    }

    void write(FrameSlot& slot, const FileSink& sink) const override {
        const auto hand_over = [&](const std::string& path, const FileContent& content) {
            slot.record.files[path] = sink(path, content);
        };
        if (mesh_query_ >= 0)
            hand_over(usd::frame_file(scene_.shot.name, slot.frame, mesh_extension()),
                      [&](const usd::Sink& take) {
                          if (mesh_is_text())
                              take(slot.mesh_text);
                          else
                              usd::write_frame_crate(mesh_sample(slot), take);
                      });
        for (std::size_t m = 0; m < maps_.size(); ++m)
            hand_over(maps_[m].stem + "." + usd::frame_number(slot.frame) + ".exr",
                      [&](const usd::Sink& take) { take(slot.maps[m].file); });
    }

    void write_static(const FileSink& sink) const override {
        if (mesh_query_ < 0) return;
        const Shot& shot = scene_.shot;
        const Query& query = sea_->plan().queries[mesh_query_].query;
        const usd::AttributeSet attributes{.normals = asks(query, Product::Normal),
                                           .velocities = asks(query, Product::Velocity),
                                           .slope_variance = asks(query, Product::SlopeVariance),
                                           .whitecap_coverage = asks(query, Product::Coverage)};
        const usd::GridFaces faces =
            follows_camera() ? usd::grid_faces(grid_options_.size.columns, grid_options_.size.rows)
                             : usd::grid_faces(scene_.surface.resolution);
        const usd::Topology topology{.fps = shot.fps,
                                     .face_vertex_counts = faces.counts,
                                     .face_vertex_indices = faces.indices,
                                     .st = faces.st,
                                     .attributes = attributes};
        sink(usd::topology_file(shot.name, mesh_extension()), [&](const usd::Sink& take) {
            if (mesh_is_text())
                usd::write_topology_text(topology, take);
            else
                usd::write_topology_crate(topology, take);
        });
        const auto text = [&](const std::string& path, const std::string& bytes) {
            sink(path, [&](const usd::Sink& take) { take(bytes); });
        };
        text(usd::manifest_file(shot.name), usd::manifest_text({.fps = shot.fps, .attributes = attributes}));
        sink(usd::camera_file(shot.name),
             [&](const usd::Sink& take) { usd::write_camera_crate(camera(), take); });
        text(usd::root_file(shot.name), usd::root_text(stage(attributes)));
    }

    const SpectralMoments& total() const override { return sea_->total(); }
    double whitecap_threshold() const override { return sea_->whitecap_threshold(); }
    long executed_transforms() const override { return frame_.executed_transforms(); }

  private:
    bool follows_camera() const { return scene_.surface.kind == SurfaceKind::ProjectedGrid; }

    // The patch, or what the camera sees at this frame, in the world. The points at rest follow the camera;
    // velocities are the water's at each of them.
    void compute_mesh(int frame, Values& mesh) {
        if (!follows_camera()) {
            runner_.run(frame_, mesh_query_, points_of(mesh_square_.points), mesh);
            return;
        }
        seen_.take(projected_grid(view_at(scene_.camera, frame), grid_options_));
        runner_.run(frame_, mesh_query_, seen_.points(), mesh);
        move_by(mesh.vectors(Product::Position), seen_.origin_m);
    }

    bool mesh_is_text() const { return scene_.output.mesh == MeshFormat::Usda; }
    std::string mesh_extension() const { return std::string(word_of(scene_.output.mesh)); }

    usd::MeshSample mesh_sample(const FrameSlot& slot) const {
        return {.frame = slot.frame,
                .fps = scene_.shot.fps,
                .fingerprint = slot.record.fingerprint,
                .points = slot.mesh.vectors(Product::Position),
                .normals = slot.mesh.vectors(Product::Normal),
                .velocities = slot.mesh.vectors(Product::Velocity),
                .slope_variance = slot.mesh.vectors(Product::SlopeVariance),
                .whitecap_coverage = slot.mesh.numbers(Product::Coverage)};
    }

    void encode_mesh(FrameSlot& slot) const {
        // Of vertices that lie ever wider apart it says nothing about the sea.
        if (!follows_camera())
            slot.record.mesh_significant_height_m =
                significant_height_of(slot.mesh.vectors(Product::Position));
        if (!mesh_is_text()) return;
        slot.mesh_text.clear();
        usd::write_frame_text(mesh_sample(slot), [&](std::string_view part) { slot.mesh_text += part; });
    }

    double hidden_mss(int query) const {
        return std::max(sea_->total().mss() - sea_->shown(query).mss(), 0.0);
    }

    MapJob<T> map_job(int q) {
        const Plan& plan = sea_->plan();
        const Query& query = plan.queries[q].query;
        MapJob<T> job{.query = q, .kind = *query.map, .stem = {}, .square = {}};
        if (query.only_cascade) {
            job.n = plan.cascades[*query.only_cascade].resolution;
            job.size_m = plan.cascades[*query.only_cascade].size_m;
            job.periodic = true;
        } else {
            job.n = scene_.output.map_resolution;
            job.size_m = scene_.surface.size_m;
            job.periodic = patch_is_periodic();
        }
        const std::string name(word_of(job.kind));
        job.stem =
            query.only_cascade ? "tiles/" + name + "." + std::to_string(*query.only_cascade) : "maps/" + name;
        for (const MapJob<T>& other : maps_)
            if (other.n == job.n && other.size_m == job.size_m) job.square = other.square;
        if (!job.square)
            job.square = std::make_shared<const Square<T>>(square_of<T>(job.n, job.size_m, job.n));
        return job;
    }

    // Only if the patch is a common period of every cascade that shows in it; trains have none.
    bool patch_is_periodic() const {
        if (sea_->plan().trains) return false;
        for (const CascadePlan& cascade : sea_->plan().cascades) {
            const double periods = scene_.surface.size_m / cascade.size_m;
            const bool whole = std::round(periods) >= 1.0 && std::abs(periods - std::round(periods)) < 1e-9;
            if (!cascade.grids.empty() && !whole) return false;
        }
        return true;
    }

    void describe_waves(FrameRecord& record) const {
        record.mss_residual = hidden_mss(0);
        const bool calm = !(sea_->total().m0 > 0.0);
        const Plan& plan = sea_->plan();
        if (plan.transforms_per_frame() == 0 && !plan.trains && !calm) return;  // no wave was computed
        const Realisation sum = frame_.realisation(0);
        WaveRecord waves;
        waves.significant_height_m = 4.0 * std::sqrt(sum.m0);
        if (sum.m0 > 0.0) {
            waves.energy_period_s = kTwoPi * sum.m_minus1 / sum.m0;
            waves.mean_direction_deg = std::atan2(sum.north, sum.east) * 180.0 / kPi;
        }
        waves.mss = sum.mss;
        record.waves = waves;
    }

    // "1.6 m 11 s towards 110 deg, …"
    std::string swell_text() const {
        std::string text;
        for (const Swell& swell : scene_.sea.swell)
            text += (text.empty() ? "" : ", ") + number_text(swell.height_m) + " m " +
                    number_text(swell.period_s) + " s towards " + number_text(swell.direction_deg) + " deg";
        return text;
    }

    usd::Camera camera() const {
        return {.fps = scene_.shot.fps,
                .first_frame = scene_.shot.first_frame,
                .last_frame = scene_.shot.last_frame,
                .pose_at =
                    [this](int frame) {
                        const View view = view_at(scene_.camera, frame);
                        return usd::CameraPose{view.position_m, view.right, view.up, -view.forward};
                    },
                .fov_deg = scene_.camera.fov_deg,
                .resolution = scene_.camera.resolution};
    }

    usd::Stage stage(const usd::AttributeSet& attributes) const {
        const Shot& shot = scene_.shot;
        const SeaState& sea = scene_.sea;
        usd::Stage stage;
        stage.name = shot.name;
        stage.first_frame = shot.first_frame;
        stage.last_frame = shot.last_frame;
        stage.fps = shot.fps;
        stage.attributes = attributes;
        stage.frame_extension = stage.topology_extension = mesh_extension();
        stage.material.roughness = preview_roughness(hidden_mss(mesh_query_));
        stage.has_camera = true;
        // Its upper edge sets half a degree after its centre has.
        if (constexpr double kDiscRadius_deg = 0.27; scene_.light.sun_elevation_deg > -kDiscRadius_deg)
            stage.sun = usd::Sun{.elevation_deg = scene_.light.sun_elevation_deg,
                                 .azimuth_deg = scene_.light.sun_azimuth_deg};
        stage.sky = usd::Sky{};
        stage.custom_data = {
            {"version", std::string(PELAGIC_VERSION)},
            {"fingerprint", sea_->plan().fingerprint_text()},
            {"seed", static_cast<std::int64_t>(shot.seed)},
            {"spectrum", std::string(word_of(sea.spectrum))},
            {"spreading", std::string(word_of(sea.spreading))},
            {"wind_speed_mps", sea.wind_speed_mps},
            {"wind_direction_deg", sea.wind_direction_deg},
            {"fetch_m", sea.fetch_m},
            {"depth_m", sea.depth_m},
            {"choppiness", scene_.waves.choppiness},
            {"significant_height_m", sea_->total().significant_height_m()},
            {"loop_s", shot.loop_s},
        };
        if (!sea.swell.empty()) stage.custom_data.push_back({"swell", swell_text()});
        if (sea.measured) {
            stage.custom_data.push_back({"station", sea.measured->station});
            stage.custom_data.push_back({"measured_at", sea.measured->time});
        }
        return stage;
    }

    // Three values a texel, as OpenEXR wants them.
    struct Level {
        int n;
        std::span<const glm::vec3> texels;
    };

    std::string encoded(const MapJob<T>& job, const FrameSlot::Map& map, int frame) const {
        switch (job.kind) {
            case MapKind::Displacement: {
                const std::vector<glm::vec3>& texels = map.values.vectors(Product::Displacement);
                const exr::Header header = header_of(job, frame, {"displacement", "m", texels});
                return exr::encode_scanline(header,
                                            image({job.n, texels}, {"R", "G", "B"}, exr::PixelType::Float));
            }
            case MapKind::Normal: {
                const std::vector<glm::vec3>& texels = map.values.vectors(Product::Normal);
                const exr::Header header = header_of(job, frame, {"unit normal", "1", texels});
                const auto below = normal_mips({.n = job.n, .texels = texels, .periodic = job.periodic});
                std::vector<Level> levels{{job.n, texels}};
                for (const MipLevel<glm::vec3>& level : below) levels.push_back({level.n, level.texels});
                return encode_levels(header, levels, {"R", "G", "B"}, exr::PixelType::Half);
            }
            case MapKind::SlopeVariance: {
                exr::Header header = header_of(job, frame,
                                               {"slope variance of the waves that a texel hides", "1",
                                                map.values.vectors(Product::SlopeVariance)});
                // The same all over a level: packed, nearly nothing.
                header.compression = exr::Compression::Zip;
                std::vector<std::vector<glm::vec3>> texels;
                std::vector<Level> levels;
                for (const glm::vec3& hidden : map.hidden) {
                    const auto level = static_cast<int>(levels.size());
                    const int n = exr::mip_level_size(job.n, job.n, level).first;
                    texels.emplace_back(static_cast<std::size_t>(n) * n, hidden);
                    levels.push_back({n, texels.back()});
                }
                return encode_levels(header, levels, {"xx", "yy", "xy"}, exr::PixelType::Float);
            }
            case MapKind::Whitecaps:
                return encoded_whitecaps(job, map, frame);
        }
        throw std::logic_error("a map of no kind");
    }

    std::string encoded_whitecaps(const MapJob<T>& job, const FrameSlot::Map& map, int frame) const {
        using Moments = JacobianMoments<float>;
        const bool third = sea_->plan().knobs.third_moment;
        const auto threshold = static_cast<float>(sea_->whitecap_threshold());
        std::vector<std::vector<glm::vec3>> texels;
        const auto add_level = [&](const std::vector<Moments>& moments) {
            std::vector<glm::vec3>& level = texels.emplace_back(moments.size());
            tbb::parallel_for(std::size_t(0), moments.size(), [&](std::size_t i) {
                const Moments& j = moments[i];
                level[i] = {coverage(j, threshold, third), j.mean, j.variance};
            });
        };
        std::vector<Moments> full;
        full.reserve(map.values.vectors(Product::JacobianMoments).size());
        for (const glm::vec3& j : map.values.vectors(Product::JacobianMoments))
            full.push_back({j.x, j.y, j.z});
        add_level(full);
        for (const MipLevel<Moments>& level :
             moment_mips({.n = job.n, .texels = full, .periodic = job.periodic}))
            add_level(level.texels);
        std::vector<Level> levels;
        for (std::size_t i = 0; i < texels.size(); ++i)
            levels.push_back({exr::mip_level_size(job.n, job.n, static_cast<int>(i)).first, texels[i]});
        const exr::Header header =
            header_of(job, frame, {"whitecap coverage, mean and variance of the Jacobian", "1", texels[0]});
        return encode_levels(header, levels, {"coverage", "mean", "variance"}, exr::PixelType::Float);
    }

    // Each level hides what its own texels are too coarse for: the query's ladder, asked at one point of each
    // level.
    std::vector<glm::vec3> hidden_by_level(const MapJob<T>& job) const {
        std::vector<glm::vec3> levels;
        for (const double footprint_m : sea_->plan().queries[job.query].query.pixel_m) {
            const glm::vec<2, T> rest(0);
            const T footprint = static_cast<T>(footprint_m);
            glm::vec<3, T> hidden(0);
            Points<T> point{.count = 1, .rest_m = {&rest}};
            point.pixel_m = {&footprint};
            Results<T> result;
            result.set(Product::SlopeVariance, {&hidden});
            evaluate(frame_, job.query, point, result);
            levels.emplace_back(hidden);
        }
        return levels;
    }

    static exr::Image image(const Level& level, const std::array<const char*, 3>& names,
                            exr::PixelType type) {
        exr::Image image{.width = level.n, .height = level.n, .channels = {}};
        for (int c = 0; c < 3; ++c)
            image.channels.push_back({.name = names[c],
                                      .data = &level.texels.data()->x + c,
                                      .pixel_stride_bytes = sizeof(glm::vec3),
                                      .type = type});
        return image;
    }

    static std::string encode_levels(const exr::Header& header, const std::vector<Level>& levels,
                                     const std::array<const char*, 3>& names, exr::PixelType type) {
        std::vector<exr::Image> images;
        for (const Level& level : levels) images.push_back(image(level, names, type));
        return exr::encode_mipmapped(header, images);
    }

    struct Content {
        const char* what;
        const char* unit;
        const std::vector<glm::vec3>& texels;
    };

    exr::Header header_of(const MapJob<T>& job, int frame, const Content& content) const {
        const glm::vec3& first = content.texels.front();
        std::array<float, 3> low{first.x, first.y, first.z}, high = low;
        for (const glm::vec3& t : content.texels)
            for (int c = 0; c < 3; ++c) {
                low[c] = std::min(low[c], t[c]);
                high[c] = std::max(high[c], t[c]);
            }
        const SeaState& sea = scene_.sea;
        exr::Header header;
        header.periodic = job.periodic;
        header.attributes = {
            {"content", std::string(content.what)},
            {"unit", std::string(content.unit)},
            {"space", std::string("object: metres, z up, right-handed")},
            {"axisOrder", std::string("xyz")},
            {"sampling", std::string("pixel corners: column i is x = -L/2 + i L/N, the bottom row is "
                                     "y = -L/2, rows upwards are +y")},
            {"size", job.size_m},
            {"min", low},
            {"max", high},
            {"time", scene_.shot.time_s(frame)},
            {"fps", scene_.shot.fps},
            {"frame", frame},
            {"seed", std::to_string(scene_.shot.seed)},
            {"windSpeed_mps", sea.wind_speed_mps},
            {"windTowards_deg", sea.wind_direction_deg},
            {"spectrum", std::string(word_of(sea.spectrum))},
            {"fingerprint", sea_->plan().fingerprint_text()},
            {"software", std::string("pelagic " PELAGIC_VERSION)}};
        if (job.periodic) header.attributes.push_back({"period", job.size_m});  // absent: it does not repeat
        if (scene_.shot.loop_s > 0.0) header.attributes.push_back({"loop", scene_.shot.exact_loop_s()});
        if (!sea.swell.empty()) header.attributes.push_back({"swell", swell_text()});
        if (sea.measured) {
            header.attributes.push_back({"station", sea.measured->station});
            header.attributes.push_back({"measuredAt", sea.measured->time});
        }
        return header;
    }

    Scene scene_;
    std::shared_ptr<const Sea<T>> sea_;
    Frame<T> frame_;
    QueryRunner<T> runner_;
    int mesh_query_ = -1;
    Square<T> mesh_square_;              // of a patch
    ProjectedGridOptions grid_options_;  // of a projected grid: one topology for the whole shot
    SeenPoints<T> seen_;
    std::vector<MapJob<T>> maps_;
};

}  // namespace

std::unique_ptr<Sequence> make_sequence(const Scene& scene, const Plan& plan) {
    if (plan.knobs.double_precision) return std::make_unique<SequenceOf<double>>(scene, plan);
    return std::make_unique<SequenceOf<float>>(scene, plan);
}

}  // namespace pelagic
