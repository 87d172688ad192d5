// What depends on the grid's origin: the uniform block of cascades.glsl, and the trains' phases. See
// sea_layout.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <span>

#include "core/plan/masks.h"
#include "core/plan/random_tiling.h"
#include "core/plan/taps.h"
#include "plugin/host/gpu/sea_layout.h"

namespace pelagic {
namespace {

// One entry of the uniform block of cascades.glsl.
struct TileRow {
    std::array<std::int32_t, 4> first{}, origin{};
    std::array<float, 4> scale{};
};

// A tile's entry for the grid's origin. The phase is computed in double, as in evaluate().
TileRow tile_row(const SeaLayout& layout, const SeaLayout::Tile& tile, glm::dvec2 origin_m) {
    TileRow row;
    if (tile.n == 0) return row;
    // Supports nodes within 2^28 of the origin. A multiple of N this large makes their numbers positive.
    constexpr int kFarthest = 1 << 28;
    row.first = {tile.first.x, tile.first.y, tile.n, kFarthest / tile.n * tile.n};
    const double size_m = layout.sea().plan().cascades[tile.cascade].size_m;
    for (int axis = 0; axis < 2; ++axis) {
        const double tiles = origin_m[axis] / size_m;
        const double nodes = (tiles - std::floor(tiles)) * tile.n, node = std::floor(nodes);
        row.origin[axis] = static_cast<std::int32_t>(node);
        // In 32 bits wherever the origin is: the tiles' offsets need no more.
        row.origin[2 + axis] = static_cast<std::int32_t>(static_cast<std::int64_t>(std::floor(tiles)));
        row.scale[axis] = static_cast<float>(nodes - node);
    }
    const SplitNumber nodes_per_m = split_number(tile.n / size_m);
    row.scale[2] = nodes_per_m.high;
    row.scale[3] = nodes_per_m.low;
    return row;
}

// Those of gusts.glsl.
std::vector<std::array<float, 4>> rows_of(const Gusts& gusts, glm::dvec2 origin_m,
                                          double time_within_loop_s) {
    const auto cycles = gusts.plan.cycles_at(origin_m, time_within_loop_s);
    const auto number = [](double value) { return static_cast<float>(value); };
    std::vector<std::array<float, 4>> rows;
    for (std::size_t i = 0; i < cycles.size(); ++i) {
        const GustsPlan::Wave& wave = gusts.plan.waves[i];
        rows.push_back({number(wave.cycles_per_m.x), number(wave.cycles_per_m.y), number(cycles[i]),
                        number(wave.amplitude)});
    }
    for (const GustsPlan::Wave& wave : gusts.plan.waves)
        rows.push_back({number(wave.shortest_m), number(wave.along.x), number(wave.along.y), 0.0f});
    std::vector<float> terms;
    for (const double term : gusts.of_level) terms.push_back(number(term));
    for (const double term : gusts.of_kept) terms.push_back(number(term));
    terms.push_back(number(gusts.plan.strength));
    for (std::size_t i = 0; i < terms.size(); ++i) {
        if (i % 4 == 0) rows.emplace_back();
        rows.back()[i % 4] = terms[i];
    }
    return rows;
}

std::array<float, 4> row(double a, double b, double c, double d) {
    return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), static_cast<float>(d)};
}

// Those of its fronts.
std::vector<std::array<float, 4>> front_rows_of(const Gusts& gusts, glm::dvec2 origin_m, double time_s) {
    const GustsPlan::FromFronts from = gusts.plan.from_fronts(origin_m, time_s);
    std::vector<std::array<float, 4>> rows;
    for (std::size_t i = 0; i < gusts.plan.fronts.size(); ++i) {
        const GustsPlan::Front& front = gusts.plan.fronts[i];
        rows.push_back(row(from[i].x, from[i].y, front.along.x, front.along.y));
        rows.push_back(row(front.half_m.x, front.half_m.y, front.edge_m, front.wind));
    }
    rows.push_back(row(gusts.plan.weakest, gusts.plan.strongest, gusts.most, 0.0));
    for (const auto* bends : {&gusts.stronger, &gusts.weaker})
        for (const Gusts::Bend& bend : *bends)
            rows.push_back(row(bend.wind, bend.even, bend.patchy, bend.foam));
    return rows;
}

// Those of masks.glsl.
std::vector<std::array<float, 4>> rows_of(const MasksPlan& plan, const SpectralMoments& slick,
                                          glm::dvec2 origin_m) {
    std::vector<std::array<float, 4>> rows;
    int first_row = 0;
    for (const MasksPlan::Mask& mask : plan.masks) {
        const glm::dvec2 from = origin_m - mask.middle_m,
                         in = mask.cells ? mask.cells_per_m : mask.inner_per_m,
                         out = mask.cells ? glm::dvec2(mask.cells->count) : mask.outer_per_m;
        rows.push_back(row(from.x, from.y, mask.along.x, mask.along.y));
        rows.push_back(row(in.x, in.y, out.x, out.y));
        rows.push_back(
            row(mask.waves, mask.ripples, mask.foam, mask.cells ? -1.0 - first_row : mask.reach_m));
        if (mask.cells) first_row += mask.cells->count.y;
    }
    rows.push_back(row(slick.xx, slick.xy, slick.yy, 0.0));
    return rows;
}

// Those of coast.glsl.
template <class T>
std::vector<std::array<float, 4>> rows_of(const SeaLayout& layout, const CoastSurf<T>& coast,
                                          glm::dvec2 origin_m) {
    const glm::dvec2 from = (origin_m - coast.from_m) / coast.cell_m, cell = glm::floor(from);
    const FootprintFilter& filter = layout.sea().plan().filter;
    return {
        row(from.x - cell.x, from.y - cell.y, 1.0 / coast.cell_m.x, 1.0 / coast.cell_m.y),
        row(coast.count.x, coast.count.y, coast.fade_m, coast.peak_per_m),
        row(filter.n_min, 1.0 / (filter.n_max - filter.n_min), layout.coast_trains(), layout.coast_across()),
        row(cell.x, cell.y, 0.0, 0.0)};
}

// Those of wakes.glsl. A sea with vessels has no loop.
std::vector<std::array<float, 4>> rows_of(const VesselPlan& vessel, glm::dvec2 origin_m, double time_s) {
    constexpr double kBlocks = Frame<float>::kSlopeBlocks;
    const glm::dvec2 middle_m = vessel.middle_m(time_s), from = origin_m - middle_m,
                     blocks = middle_m * (kBlocks / vessel.size_m) - 0.5,
                     within = blocks - glm::floor(blocks / kBlocks) * kBlocks;
    return {{static_cast<float>(from.x), static_cast<float>(from.y), static_cast<float>(0.5 * vessel.size_m),
             static_cast<float>(kBlocks / vessel.size_m)},
            {static_cast<float>(within.x), static_cast<float>(within.y), 0.0f, 0.0f}};
}

}  // namespace

std::vector<std::byte> SeaLayout::tables(glm::dvec2 origin_m, double time_within_loop_s) const {
    const std::size_t levels =
        cells_.footprints_m.size() + pixels_.footprints_m.size() + breaking_.footprints_m.size();
    const std::size_t tiles = levels * static_cast<std::size_t>(std::max(cascades(), 1));
    std::vector<std::array<std::int32_t, 4>> first, origin;
    std::vector<std::array<float, 4>> scale, level, unresolved;
    for (const Levels* all : {&cells_, &pixels_, &breaking_}) {
        for (const Tile& tile : all->tiles) {
            const TileRow row = tile_row(*this, tile, origin_m);
            first.push_back(row.first);
            origin.push_back(row.origin);
            scale.push_back(row.scale);
        }
        for (const double footprint_m : all->footprints_m)
            if (all != &breaking_) level.push_back({static_cast<float>(footprint_m), 0.0f, 0.0f, 0.0f});
        for (std::size_t i = 0; masks() > 0 && all == &pixels_ && i < unresolved_.size(); ++i) {
            std::array<float, 4>& row = level[level.size() - unresolved_.size() + i];
            row[1] = static_cast<float>(unresolved_[i].m0_alone);
            row[2] = static_cast<float>(unresolved_[i].m0_with_next);
        }
    }
    first.resize(tiles);
    origin.resize(tiles);
    scale.resize(tiles);
    for (const UnresolvedLevel& of : unresolved_)
        for (const UnresolvedMoments<float>& m : {of.alone, of.with_next}) {
            unresolved.push_back({m[0], m[1], m[2], m[3]});
            unresolved.push_back({m[4], m[5], m[6], m[7]});
        }
    std::vector<std::byte> block;
    const auto append = [&](const auto& rows) {
        const auto bytes = std::as_bytes(std::span(rows));
        block.insert(block.end(), bytes.begin(), bytes.end());
    };
    append(first);
    append(origin);
    append(scale);
    append(level);
    append(unresolved);
    std::vector<std::array<float, 4>> cascades;
    for (int c = 0; c < this->cascades(); ++c) {
        const CascadePlan& cascade = sea_->plan().cascades[c];
        cascades.push_back({static_cast<float>(whole_footprint_m(cascade, sea_->plan().filter)),
                            static_cast<float>(tiling_key(sea_->plan().from->scene.shot.seed, c)),
                            static_cast<float>(1.0 / cascade.size_m), 0.0f});
    }
    cascades.resize(std::max<std::size_t>(cascades.size(), 1));
    append(cascades);
    append(sea_->gusts() ? rows_of(*sea_->gusts(), origin_m, time_within_loop_s)
                         : std::vector<std::array<float, 4>>(SeaLayout::kGustRows));
    if (is_masked()) append(rows_of(*sea_->plan().masks, sea_->slick(), origin_m));
    for (int v = 0; v < vessels(); ++v) {
        const VesselPlan& vessel =
            *sea_->plan().cascades[static_cast<std::size_t>(sea_cascades() + v)].vessel;
        append(rows_of(vessel, origin_m, time_within_loop_s));
    }
    if (fronts() > 0) append(front_rows_of(*sea_->gusts(), origin_m, time_within_loop_s));
    if (has_coast())
        append(rows_of(*this, *sea_->coast(), origin_m));
    else if (has_surf())
        append(rows_of(*this, *sea_->plan().masks->surf, origin_m));
    return block;
}

std::vector<float> SeaLayout::train_cycles(glm::dvec2 origin_m, double time_within_loop_s) const {
    const std::vector<double> cycles = phases_at(sea_->trains(), origin_m, time_within_loop_s);
    return {cycles.begin(), cycles.end()};
}

glm::ivec2 SeaLayout::mask_cells_size() const {
    glm::ivec2 size(0);
    for (const MasksPlan::Mask& mask : sea_->plan().masks->masks)
        if (mask.cells) size = {std::max(size.x, mask.cells->count.x), size.y + mask.cells->count.y};
    return size;
}

std::vector<float> SeaLayout::mask_cells() const {
    const auto columns = static_cast<std::size_t>(mask_cells_size().x);
    std::vector<float> texels;
    for (const MasksPlan::Mask& mask : sea_->plan().masks->masks) {
        if (!mask.cells) continue;
        const auto width = static_cast<std::size_t>(mask.cells->count.x);
        for (std::size_t at = 0; at < mask.cells->shares.size(); at += width) {
            for (std::size_t i = 0; i < width; ++i)
                texels.push_back(static_cast<float>(mask.whole) * mask.cells->shares[at + i]);
            texels.resize(texels.size() + columns - width);
        }
    }
    return texels;
}

std::vector<glm::vec4> SeaLayout::wake_texels(const Frame<float>& frame) const {
    constexpr int kBlocks = Frame<float>::kSlopeBlocks;
    const glm::ivec2 size = wake_size();
    std::vector<glm::vec4> texels(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y),
                                  glm::vec4(0.0f));
    const auto levels = static_cast<int>(pixels_.footprints_m.size());
    for (int v = 0; v < vessels(); ++v) {
        const auto texel = [&](int column, int row) -> glm::vec4& {
            return texels[static_cast<std::size_t>(v * kWakeTableRows + row) *
                              static_cast<std::size_t>(size.x) +
                          static_cast<std::size_t>(column)];
        };
        const int cascade = sea_cascades() + v;
        const glm::dvec2 middle_m = frame.tile_middle_m(cascade);
        const WakeStrip& strip = frame.strips()[static_cast<std::size_t>(v)];
        const auto box = [&](const WakeStrip::Box& of) {
            return glm::vec4(glm::vec2(of.low_m - middle_m), glm::vec2(of.high_m - middle_m));
        };
        const WakeHull<double>& hull = strip.hull();
        texel(0, 0) = glm::vec4(hull.length_m, hull.beam_m, hull.foam, hull.oldest_s);
        texel(1, 0) = glm::vec4(static_cast<float>(strip.points().size()), strip.reach_m(), 0.0f, 0.0f);
        texel(2, 0) = box(strip.whole());
        for (std::size_t i = 0; i < strip.boxes().size(); ++i)
            texel(3 + static_cast<int>(i), 0) = box(strip.boxes()[i]);
        for (std::size_t i = 0; i < strip.points().size(); ++i) {
            const WakeStrip::Point& point = strip.points()[i];
            const int column = 2 * static_cast<int>(i);
            texel(column, 1) = glm::vec4(glm::vec2(point.place_m - middle_m), point.way_m, point.age_s);
            texel(column + 1, 1) = glm::vec4(point.strength, 0.0, 0.0, 0.0);
        }
        const CascadePlan& planned = sea_->plan().cascades[static_cast<std::size_t>(cascade)];
        const std::vector<int>& pixel_levels = sea_->plan().queries[query_].pixel_levels;
        for (int level = 0; level < levels; ++level)
            for (int y = 0; y < kBlocks; ++y)
                for (int x = 0; x < kBlocks; ++x)
                    texel(kBlocks * level + x, 2 + y) = glm::vec4(
                        glm::vec3(frame.hidden_slopes(cascade, planned.grid_of_level[pixel_levels[level]],
                                                      (glm::dvec2(x, y) + 0.5) * (planned.size_m / kBlocks))),
                        0.0f);
    }
    return texels;
}

}  // namespace pelagic
