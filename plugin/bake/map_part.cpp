// Maps and tiles: the sea over a square of texels, an OpenEXR file a frame.
#include "plugin/bake/maps.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/evaluate/gusts.h"
#include "core/plan/fingerprint.h"
#include "core/plan/random_tiling.h"
#include "core/scene/canonical.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "pelagic/version.h"
#include "plugin/bake/output_part.h"
#include "plugin/format/exr/exr.h"
#include "plugin/light/caustics.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

struct MapSlot final : OutputSlot {
    // Of slope variance: the mip levels below the map; of a tile, where a level is alike everywhere, one value each.
    std::vector<std::vector<glm::vec3>> unresolved;
    // Of whitecaps: what the moments of J are compared with, one value, or by mip level and texel where gusts make it differ.
    float whitecap_threshold = 0.0f;
    std::vector<std::vector<float>> whitecap_thresholds;
    // And where there are hulls: how much of a texel is water, and how much of it contact foam.
    std::vector<glm::vec3> hulls;
    std::string file;  // encoded
};

class MapPart final : public OutputPart {
  public:
    MapPart(const Plan& plan, const PlannedOutput& output, std::shared_ptr<SquareCache> squares)
        : OutputPart(plan, output),
          squares_(std::move(squares)),
          kind_(*output.map),
          n_(query().lattice ? static_cast<int>(std::lround(std::sqrt(static_cast<double>(query().points))))
                             : scene().output.map_resolution),
          size_m_(query().lattice ? query().lattice->spacing_m * n_ : scene().surface.size_m),
          periodic_(output.cascade ? true : patch_is_periodic()) {
        if (kind_ != MapKind::Floor) return;
        periodic_ = periodic_ && scene().sea.depth_file == SeaState{}.depth_file;
        base_ = Fingerprint()
                    .add(base_)
                    .add(canonical(portable(scene()), key_parts(KeyPart::Light, KeyPart::Water)))
                    .add(picture_content(scene()))
                    .text();
    }

    FilePattern pattern() const override {
        const std::string name = scene().shot.name + '.' + std::string(word_of(kind_)) + '.';
        return {output_.cascade ? "tiles/" + name + std::to_string(*output_.cascade) + '.' : "maps/" + name,
                ".exr"};
    }
    std::unique_ptr<OutputSlot> make_slot() const override { return std::make_unique<MapSlot>(); }

    void compute(const SeaAtTime<float>& sea, int frame, OutputSlot& slot, const BuildWatch& watch) override {
        compute_as(single_, sea, frame, static_cast<MapSlot&>(slot), watch);
    }
    void compute(const SeaAtTime<double>& sea, int frame, OutputSlot& slot,
                 const BuildWatch& watch) override {
        compute_as(wide_, sea, frame, static_cast<MapSlot&>(slot), watch);
    }

    OutputMemory memory() const override {
        const auto texels = static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_);
        const std::size_t scalar = plan_.knobs.double_precision ? sizeof(double) : sizeof(float);
        // With mip levels a third more. A tile's slope variances are the same all over, and packed to nothing.
        struct Encoded {
            std::size_t file, work, levels = 0;  // [bytes/texel] of the level that is as large as the map
        };
        const auto [file, work, levels] = [&]() -> Encoded {
            switch (kind_) {
                case MapKind::Displacement:
                    return {12, 0};
                case MapKind::Normal:
                    return {6 * 4 / 3, 12 / 3};
                case MapKind::SlopeVariance:
                    if (output_.cascade) return {0, 12 * 4 / 3};
                    return {12 * 4 / 3, 0, 12 / 3};
                case MapKind::Whitecaps:
                    // Moments, and by level what is written; of persistent foam, its past and what that becomes.
                    return has_foam_history() ? Encoded{22 * 4 / 3, 12 * 4 / 3 + 36 * 4 / 3}
                                              : Encoded{16 * 4 / 3, 12 * 4 / 3 + 12 * 4 / 3};
                case MapKind::Floor:
                    return {6 * 4 / 3, 12 * 4 / 3, 4};
            }
            throw std::logic_error("a map of no kind");
        }();
        const std::size_t points = texels * 2 * scalar;
        return {.once = kind_ == MapKind::Floor ? light_bytes() : points,
                .slot = texels * (file + levels + (has_gusts() ? sizeof(float) * 4 / 3 : 0)),
                .encoding = texels * (file + work),  // the file once more, in blocks
                .remedy = output_.cascade
                              ? "lower the resolutions in waves.cascades, or leave cascade_tiles out"
                              : "lower output.map_resolution, or ask for fewer output.maps"};
    }

    void encode(int frame, OutputSlot& any_slot) const override {
        MapSlot& slot = static_cast<MapSlot&>(any_slot);
        const auto& coverage = slot.values.numbers(Product::Coverage);
        slot.coverage.reset();
        if (!coverage.empty()) {
            AreaMean mean;  // pixels are patches at rest
            const auto& moments = slot.values.vectors(Product::JacobianMoments);
            for (std::size_t i = 0; i < coverage.size(); ++i) {
                const JacobianMoments<float> j{moments[i].x, moments[i].y, moments[i].z};
                mean.add(slot.hulls.empty() ? coverage[i] : beside_hulls(coverage[i], slot.hulls[i]),
                         sea_area(j, plan_.knobs.third_moment));
            }
            slot.coverage = mean.value();
        }
        slot.file = std::string();  // let go before the new one is made
        slot.file = encoded(slot, frame);
    }

    void write(int frame, const OutputSlot& any_slot, const FileSink& sink) const override {
        const MapSlot& slot = static_cast<const MapSlot&>(any_slot);
        sink({.path = file(frame), .content = [&](const auto& take) { take(slot.file); }});
    }

  private:
    template <class T>
    struct State {
        SharedPoints<T> rest;
        QueryRunner<T> runner;
        // Of slope variance: a mip level's texels, and their unresolved slopes.
        std::vector<glm::vec<2, T>> level_rest;
        Values level;
    };

    template <class T>
    void compute_as(State<T>& state, const SeaAtTime<T>& sea, int frame, MapSlot& slot,
                    const BuildWatch& watch) {
        if (kind_ == MapKind::Floor) return light_floor(sea.frame(), slot, watch);
        if (!state.rest)
            state.rest = squares_->points<T>({.per_side = n_,
                                              .spacing_m = query().lattice->spacing_m,
                                              .first_m = query().lattice->first_m});
        const Points<T> points{.count = state.rest->size(), .rest_m = {state.rest->data()}};
        state.runner.run(sea, output_.query, points, slot.values, watch);
        slot.whitecap_threshold = static_cast<float>(sea.sea().whitecap_threshold());
        if (kind_ == MapKind::SlopeVariance) find_unresolved(state, sea.frame(), slot);
        if (has_gusts()) find_thresholds(state, sea.frame(), slot);
        if (meets_hulls()) meet_hulls(sea.frame(), frame, points, slot);
    }

    // Where a texel's water is the hulls' query says: the map's own has no positions.
    template <class T>
    void meet_hulls(const Frame<T>& sea, int frame, const Points<T>& points, MapSlot& slot) {
        std::vector<float> wet(points.count), foam(points.count);
        hulls_at(sea, frame).meet(sea, hulls_query(), points, size_m_ / n_, {}, {wet, foam});
        slot.hulls.resize(points.count);
        for (std::size_t i = 0; i < points.count; ++i) slot.hulls[i] = {wet[i], wet[i] * foam[i], 0.0f};
    }
    // A coverage of the sea there.
    static float beside_hulls(float coverage, const glm::vec3& hulls) {
        return hulls.x * coverage + hulls.y * (1.0f - coverage);
    }

    struct FloorBelow {
        Floor floor;
        SunThroughWaves sun;
        CausticsOn on;
        double gain = 1.0;
    };
    // The floor of the shot. Of an uneven one the pattern is as sharp everywhere as where it is least deep, but for the shore. Where light comes
    // from much farther than the patch is wide, nothing of the pattern is left to see: it goes.
    FloorBelow floor_below() const {
        const Sky sky = make_sky(scene());
        FloorBelow below{.floor = make_floor(scene()),
                         .sun = {.to_sun = sky.sun_direction,
                                 .angular_radius = sky.sun_angular_radius,
                                 .waves = make_water(scene(), plan_.from->spectrum).waves},
                         .on = {}};
        below.gain = scene().water.caustics * caustics_share(below.sun);
        if (sky.sun_irradiance == glm::vec3(0.0f)) below.gain = 0.0;
        constexpr int kPlaces = 64;  // a side
        constexpr double kShore_m = 0.5;
        double least_m = std::numeric_limits<double>::infinity(), most_m = 0.0;
        for (int i = 0; i < kPlaces * kPlaces; ++i) {
            const glm::dvec2 place(i % kPlaces, i / kPlaces);
            const double depth_m = below.floor.depth_m(size_m_ * ((place + 0.5) / double(kPlaces) - 0.5));
            if (depth_m > kShore_m) least_m = std::min(least_m, depth_m);
            most_m = std::max(most_m, depth_m);
        }
        least_m = std::min(least_m, most_m);  // all of it is shore
        below.on = {.depth_m = least_m,
                    .uneven_m = most_m - std::min(least_m, kShore_m),
                    .most_margin_m = std::numeric_limits<double>::infinity()};
        constexpr double kMost = 2.0;  // of the patch's sides
        const double reach =
            caustics_margin_m(below.sun, Floor(), plan_.from->spectrum.m0(), below.on) / size_m_;
        below.gain *= 1.0 - glm::smoothstep(kMost, 2.0 * kMost, reach);
        below.on.most_margin_m = std::clamp(reach, 1.0, kMost) * size_m_;
        return below;
    }

    // Made once, by who asks first: the account of memory, or a frame.
    const FloorBelow& below() const {
        if (!below_) below_ = floor_below();
        return *below_;
    }

    std::size_t light_bytes() const {
        const double margin_m =
            caustics_margin_m(below().sun, below().floor, plan_.from->spectrum.m0(), below().on);
        return caustics_bytes(n_, margin_m / size_m_) + floor_bytes(scene());
    }

    template <class T>
    void light_floor(const Frame<T>& frame, MapSlot& slot, const BuildWatch& watch) {
        const double texel_m = size_m_ / n_;
        slot.floor_light.assign(static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_), 1.0f);
        if (!(below().gain > 0.0)) return;
        // A texel's middle is where the map says that it lies.
        find_caustics({glm::dvec2(-0.5 * (size_m_ + texel_m)), texel_m, n_, slot.floor_light, periodic_},
                      below().floor, frame, output_.query, below().sun, below().on, watch.cancel);
        const auto gain = static_cast<float>(below().gain);
        for (float& light : slot.floor_light) light = std::max(1.0f + gain * (light - 1.0f), 0.0f);
    }

    bool has_gusts() const { return plan_.gusts && !output_.cascade && kind_ == MapKind::Whitecaps; }

    // A tile's slopes are at rest: what carries them is the whole sea.
    VectorProduct unresolved_product() const {
        return VectorProduct::checked(output_.cascade ? Product::SlopeVarianceAtRest
                                                      : Product::SlopeVariance);
    }

    // Those of the map's texels that lie nearest to a mip level's.
    template <class T>
    void take_level(State<T>& state, int level) const {
        const int n = exr::mip_level_size(n_, n_, level).first;
        const auto nearest = [&](int i) { return static_cast<std::size_t>((2l * i * n_ + n) / (2l * n)); };
        state.level_rest.clear();
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                state.level_rest.push_back(
                    (*state.rest)[nearest(y) * static_cast<std::size_t>(n_) + nearest(x)]);
    }

    // Gusts at a level's texel, as its own size resolves them.
    template <class T>
    void find_thresholds(State<T>& state, const Frame<T>& sea, MapSlot& slot) const {
        slot.whitecap_thresholds.clear();
        for (int level = 0, n = n_ + 1; n > 1; ++level) {
            n = exr::mip_level_size(n_, n_, level).first;
            if (level > 0) take_level(state, level);
            const glm::vec<2, T>* const rest = level > 0 ? state.level_rest.data() : state.rest->data();
            const auto row = static_cast<std::size_t>(n);
            std::vector<float>& thresholds = slot.whitecap_thresholds.emplace_back(row * row);
            tbb::parallel_for(std::size_t(0), row, [&](std::size_t y) {
                whitecap_thresholds<T>(*sea.sea().gusts(), sea.time_within_loop_s(),
                                       {.count = row, .rest_m = {rest + y * row}},
                                       std::max(query().pixel_m.front(), size_m_ / n),
                                       std::span(thresholds).subspan(y * row, row));
            });
        }
    }

    // Each level leaves unresolved what its own texels are too coarse for, and resolves the waves that carry it: the
    // query's levels, asked at those of the map's texels that lie nearest to the level's.
    template <class T>
    void find_unresolved(State<T>& state, const Frame<T>& sea, MapSlot& slot) {
        const std::vector<double>& footprints_m = query().pixel_m;
        slot.unresolved.resize(footprints_m.size() - 1);
        for (std::size_t level = 1; level < footprints_m.size(); ++level) {
            take_level(state, static_cast<int>(level));
            if (output_.cascade) state.level_rest.resize(1);
            const T footprint = static_cast<T>(footprints_m[level]);
            Points<T> points{.count = state.level_rest.size(), .rest_m = {state.level_rest.data()}};
            points.pixel_m = {&footprint, 0};
            state.runner.run(sea, output_.query, points, products(unresolved_product()), state.level);
            slot.unresolved[level - 1] = state.level.vectors(unresolved_product());
        }
    }

    // Only if the patch is a common period of every cascade that shows in this map, whatever other outputs
    // show; trains have none, nor have copies at random offsets or places of the world.
    bool patch_is_periodic() const {
        if (plan_.trains || plan_.masks || meets_hulls() || plan_.sea_cascades() < plan_.cascades.size() ||
            scene().waves.tiling == Tiling::Random)
            return false;
        const std::vector<int> levels = summed_levels(plan_, plan_.queries[output_.query]);
        for (const CascadePlan& cascade : plan_.cascades) {
            const double periods = scene().surface.size_m / cascade.size_m;
            const bool whole = std::round(periods) >= 1.0 && std::abs(periods - std::round(periods)) < 1e-9;
            const bool shows = std::any_of(levels.begin(), levels.end(),
                                           [&](int level) { return cascade.grid_of_level[level] >= 0; });
            if (shows && !whole) return false;
        }
        return true;
    }

    // Three values a texel, as OpenEXR wants them.
    struct Level {
        int n;
        std::span<const glm::vec3> texels;
        std::span<const glm::vec3> more{};  // three further ones
    };

    // A channel of the file: one of the three values, or the same everywhere.
    struct ChannelOf {
        const char* name;
        std::optional<int> component;  // 0 … 5; none: 1 in every texel
        exr::PixelType type;
    };
    static std::vector<ChannelOf> red_green_blue(exr::PixelType type) {
        return {{"R", 0, type}, {"G", 1, type}, {"B", 2, type}};
    }

    std::string encoded(const MapSlot& slot, int frame) const {
        const std::string made_of = fingerprint(frame);
        switch (kind_) {
            case MapKind::Displacement: {
                const std::vector<glm::vec3>& texels = slot.values.vectors(Product::Displacement);
                const exr::Header header = header_of(made_of, frame, {"displacement", "m", texels});
                return exr::encode_scanline(header,
                                            image({n_, texels}, red_green_blue(exr::PixelType::Float)));
            }
            case MapKind::Normal: {
                const std::vector<glm::vec3>& texels = slot.values.vectors(Product::Normal);
                const exr::Header header = header_of(made_of, frame, {"unit normal", "1", texels});
                const auto below = normal_mips({.n = n_, .texels = texels, .periodic = periodic_});
                std::vector<Level> levels{{n_, texels}};
                for (const MipLevel<glm::vec3>& level : below) levels.push_back({level.n, level.texels});
                return encode_levels(header, levels, red_green_blue(exr::PixelType::Half));
            }
            case MapKind::SlopeVariance: {
                const std::vector<glm::vec3>& full = slot.values.vectors(unresolved_product());
                exr::Header header = header_of(
                    made_of, frame,
                    {output_.cascade ? "xx, yy and xy of the slope variance that a texel hides, at rest"
                                     : "xx, yy and xy of the slope variance that a texel hides",
                     "1", full});
                // A tile's is the same all over a level: packed, nearly nothing.
                if (output_.cascade) header.compression = exr::Compression::Zip;
                std::vector<std::vector<glm::vec3>> alike;
                std::vector<Level> levels{{n_, full}};
                for (const std::vector<glm::vec3>& unresolved : slot.unresolved) {
                    const int n = exr::mip_level_size(n_, n_, static_cast<int>(levels.size())).first;
                    if (output_.cascade)
                        alike.emplace_back(static_cast<std::size_t>(n) * n, unresolved.front());
                    levels.push_back({n, output_.cascade ? alike.back() : unresolved});
                }
                return encode_levels(header, levels, red_green_blue(exr::PixelType::Float));
            }
            case MapKind::Whitecaps:
                return encoded_whitecaps(slot, frame);
            case MapKind::Floor: {
                const std::vector<glm::vec3> texels(slot.floor_light.begin(), slot.floor_light.end());
                const exr::Header header =
                    header_of(made_of, frame,
                              {"the sun's light on the floor over that below a level sea", "1", texels});
                const auto below = mean_mips({.n = n_, .texels = texels, .periodic = periodic_});
                std::vector<Level> levels{{n_, texels}};
                for (const MipLevel<glm::vec3>& level : below) levels.push_back({level.n, level.texels});
                return encode_levels(header, levels, red_green_blue(exr::PixelType::Half));
            }
        }
        throw std::logic_error("a map of no kind");
    }

    std::string encoded_whitecaps(const MapSlot& slot, int frame) const {
        const std::string made_of = fingerprint(frame);
        using Moments = JacobianMoments<float>;
        const bool third = plan_.knobs.third_moment;
        const auto& thresholds = slot.whitecap_thresholds;
        std::vector<std::vector<glm::vec3>> texels;
        const auto add_level = [&](const std::vector<Moments>& moments) {
            const std::size_t l = texels.size();
            std::vector<glm::vec3>& level = texels.emplace_back(moments.size());
            const auto n = static_cast<std::size_t>(exr::mip_level_size(n_, n_, static_cast<int>(l)).first);
            const auto gain = [&](std::size_t i) {
                if (!plan_.masks || !plan_.masks->calms_foam) return 1.0f;
                const glm::dvec2 texel(static_cast<double>(i % n), static_cast<double>(i / n));
                return static_cast<float>(
                    plan_.masks
                        ->at(query().lattice->first_m +
                             query().lattice->spacing_m * n_ / static_cast<double>(n) * texel)
                        .foam);
            };
            tbb::parallel_for(std::size_t(0), moments.size(), [&](std::size_t i) {
                const Moments& j = moments[i];
                const float threshold = thresholds.empty() ? slot.whitecap_threshold : thresholds[l][i];
                level[i] = {gain(i) * coverage(j, threshold, third), j.mean, j.variance};
            });
        };
        std::vector<Moments> full;
        full.reserve(slot.values.vectors(Product::JacobianMoments).size());
        for (const glm::vec3& j : slot.values.vectors(Product::JacobianMoments))
            full.push_back({j.x, j.y, j.z});
        add_level(full);
        for (const MipLevel<Moments>& level : moment_mips({.n = n_, .texels = full, .periodic = periodic_}))
            add_level(level.texels);
        std::vector<std::vector<glm::vec3>> foam = foam_levels(slot, texels);
        if (!slot.hulls.empty()) add_hulls(slot, texels, foam);
        std::vector<Level> levels;
        for (std::size_t i = 0; i < texels.size(); ++i)
            levels.push_back({exr::mip_level_size(n_, n_, static_cast<int>(i)).first, texels[i],
                              foam.empty() ? std::span<const glm::vec3>() : foam[i]});
        const exr::Header header = header_of(
            made_of, frame, {"whitecap coverage; mean and variance of the Jacobian", "1", texels[0]});
        // Grey, so that every program shows coverage. No layers and an alpha of 1: tried in Blender 3.4, a channel
        // whose name has a dot makes the file a multi-layer image without pixels of its own, and Cycles takes
        // whatever comes fourth for alpha.
        using enum exr::PixelType;
        std::vector<ChannelOf> channels{{"R", 0, Half},
                                        {"G", 0, Half},
                                        {"B", 0, Half},
                                        {"A", {}, Half},
                                        {"jacobianMean", 1, Float},
                                        {"jacobianVariance", 2, Float}};
        if (!foam.empty())
            channels.insert(channels.end(),
                            {{"foamActive", 3, Half}, {"foamResidual", 4, Half}, {"foamAge", 5, Half}});
        return encode_levels(header, levels, channels);
    }

    // Of persistent foam: what breaks now, what earlier breaking has left, and its age, by level; the first of
    // `texels` becomes all of it. What is left is a mean already: its levels are means of it, and ages count by it.
    std::vector<std::vector<glm::vec3>> foam_levels(const MapSlot& slot,
                                                    std::vector<std::vector<glm::vec3>>& texels) const {
        const std::vector<float>&breaking = slot.values.numbers(Product::Breaking),
              &ages_s = slot.values.numbers(Product::FoamAge);
        if (ages_s.empty()) return {};
        const std::vector<float>& total = slot.values.numbers(Product::Coverage);
        // Of what is as little as rounding the quotient below would be any age.
        constexpr double kLives = 10.0;  // of a wake's foam: e⁻¹⁰ is left
        const auto oldest_s =
            static_cast<float>(std::max(plan_.foam ? plan_.foam->window_s : 0.0, kLives * kWakeBeaten_s));
        std::vector<glm::vec3> left(total.size());  // the residual's share of the rest, its times total age
        for (std::size_t i = 0; i < total.size(); ++i) {
            const float active = breaking[i], rest = 1.0f - active;
            const float residual = rest > 0.0f ? (total[i] - active) / rest : 0.0f;
            const float age_s =
                total[i] > active ? std::min(ages_s[i] * total[i] / (total[i] - active), oldest_s) : 0.0f;
            left[i] = {residual, residual * age_s, 0.0f};
        }
        std::vector<std::vector<glm::vec3>> levels;
        const auto add_level = [&](std::span<const glm::vec3> of) {
            std::vector<glm::vec3>& whole = texels[levels.size()];
            std::vector<glm::vec3>& level = levels.emplace_back(of.size());
            for (std::size_t i = 0; i < of.size(); ++i) {
                const float active = whole[i].x, residual = of[i].x * (1.0f - active);
                whole[i].x = active + residual;
                level[i] = {active, residual,
                            residual > 0.0f ? residual / whole[i].x * of[i].y / of[i].x : 0.0f};
            }
        };
        add_level(left);
        for (const MipLevel<glm::vec3>& level : mean_mips({.n = n_, .texels = left, .periodic = periodic_}))
            add_level(level.texels);
        return levels;
    }

    // A coarser texel has the means of its own: they are shares of its area.
    void add_hulls(const MapSlot& slot, std::vector<std::vector<glm::vec3>>& texels,
                   std::vector<std::vector<glm::vec3>>& foam) const {
        const auto add_level = [&](std::size_t level, std::span<const glm::vec3> hulls) {
            for (std::size_t i = 0; i < hulls.size(); ++i) {
                float& whole = texels[level][i].x;
                const float before = whole;
                whole = beside_hulls(whole, hulls[i]);
                if (foam.empty()) continue;
                glm::vec3& parts = foam[level][i];
                parts.x = beside_hulls(parts.x, hulls[i]);
                const float old_share = before > 0.0f ? parts.y / before : 0.0f;
                parts.y *= hulls[i].x - hulls[i].y;
                // Of all foam: what is new makes it younger.
                if (old_share > 0.0f && whole > 0.0f) parts.z *= parts.y / whole / old_share;
            }
        };
        add_level(0, slot.hulls);
        std::size_t next = 1;
        for (const MipLevel<glm::vec3>& level :
             mean_mips({.n = n_, .texels = slot.hulls, .periodic = periodic_}))
            add_level(next++, level.texels);
    }

    static exr::Image image(const Level& level, const std::vector<ChannelOf>& channels) {
        static constexpr float kOne = 1.0f;
        exr::Image image{.width = level.n, .height = level.n, .channels = {}};
        for (const ChannelOf& channel : channels)
            if (channel.component)
                image.channels.push_back({.name = channel.name,
                                          .data = *channel.component < 3
                                                      ? &level.texels.data()->x + *channel.component
                                                      : &level.more.data()->x + (*channel.component - 3),
                                          .pixel_stride_bytes = sizeof(glm::vec3),
                                          .type = channel.type});
            else
                image.channels.push_back(
                    {.name = channel.name,
                     .data = &kOne,
                     .pixel_stride_bytes = 0,  // and so of a row: the same sample everywhere
                     .type = channel.type});
        return image;
    }

    static std::string encode_levels(const exr::Header& header, const std::vector<Level>& levels,
                                     const std::vector<ChannelOf>& channels) {
        std::vector<exr::Image> images;
        for (const Level& level : levels) images.push_back(image(level, channels));
        return exr::encode_mipmapped(header, images);
    }

    struct Content {
        const char* what;
        const char* unit;
        const std::vector<glm::vec3>& texels;
    };

    exr::Header header_of(const std::string& made_of, int frame, const Content& content) const {
        const glm::vec3& first = content.texels.front();
        std::array<float, 3> low{first.x, first.y, first.z}, high = low;
        for (const glm::vec3& t : content.texels)
            for (int c = 0; c < 3; ++c) {
                low[c] = std::min(low[c], t[c]);
                high[c] = std::max(high[c], t[c]);
            }
        exr::Header header;
        header.periodic = periodic_;
        header.attributes = {
            {"content", std::string(content.what)},
            {"unit", std::string(content.unit)},
            {"space", std::string("object: metres, z up, right-handed")},
            {"axisOrder", std::string("xyz")},
            {"sampling", std::string("pixel corners: column i is x = -L/2 + i L/N, the bottom row is "
                                     "y = -L/2, rows upwards are +y")},
            {"size", size_m_},
            {"min", low},
            {"max", high},
            {"time", scene().shot.time_s(frame)},
            {"fps", scene().shot.fps},
            {"frame", frame},
            {"fingerprint", made_of},
            {"software", std::string("pelagic " PELAGIC_VERSION)}};
        if (periodic_) header.attributes.push_back({"period", size_m_});  // absent: it does not repeat
        // With these, tiles add up to the sea (core/plan/random_tiling.h).
        if (output_.cascade && scene().waves.tiling == Tiling::Random) {
            header.attributes.push_back({"copiesRamp", kBlendRamp});
            header.attributes.push_back(
                {"copiesKey", static_cast<int>(tiling_key(scene().shot.seed, *output_.cascade))});
        }
        if (scene().shot.loop_s > 0.0) header.attributes.push_back({"loop", scene().shot.exact_loop_s()});
        KeyPartSet described = output_.key_parts;
        if (kind_ == MapKind::Floor) described |= key_parts(KeyPart::Light, KeyPart::Water);
        describe(portable(scene()), described, header.attributes);
        return header;
    }

    std::shared_ptr<SquareCache> squares_;
    MapKind kind_;
    int n_;
    double size_m_;
    bool periodic_;  // whether its square is a common period of the waves
    mutable std::optional<FloorBelow> below_;
    State<float> single_;
    State<double> wide_;
};

}  // namespace

std::unique_ptr<OutputPart> make_map_part(const Plan& plan, const PlannedOutput& output,
                                          const std::shared_ptr<SquareCache>& squares) {
    return std::make_unique<MapPart>(plan, output, squares);
}

}  // namespace pelagic
