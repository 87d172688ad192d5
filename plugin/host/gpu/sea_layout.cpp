#include "plugin/host/gpu/sea_layout.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/plan/grid_layout.h"
#include "core/plan/products.h"

namespace pelagic {
namespace {

bool blends_tiles(const Plan& plan) {
    return std::any_of(plan.cascades.begin(), plan.cascades.end(),
                       [](const CascadePlan& cascade) { return cascade.has_random_tiling; });
}

}  // namespace

bool SeaLayout::has_random_tiling() const {
    return blends_tiles(sea_->plan());
}

SplitNumber split_number(double value) {
    constexpr int kBits = 12;
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);  // ½ ≤ |fraction| < 1
    const double high = std::ldexp(std::round(std::ldexp(fraction, kBits)), exponent - kBits);
    return {static_cast<float>(high), static_cast<float>(value - high)};
}

std::vector<SeaLayout::Plane> SeaLayout::lay_out(const Plan& plan, int query, Levels& cells, Levels& pixels,
                                                 Levels& breaking) {
    const PlannedQuery& planned = plan.queries.at(query);
    if (planned.query.lattice || planned.query.only_cascade)
        throw std::invalid_argument("query \"" + planned.query.name +
                                    "\" is of a lattice or of one cascade: "
                                    "a picture needs one of points anywhere in the whole sea");
    const ProductSet least = products(Product::Position, Product::Normal, Product::SlopeVariance);
    if ((planned.query.products & least) != least)
        throw std::invalid_argument(
            "query \"" + planned.query.name +
            "\" must ask for position, normal and slope variance: a picture needs them");
    cells = levels_of(plan, planned.query.cell_m, planned.cell_levels);
    pixels = levels_of(plan, planned.query.pixel_m, planned.pixel_levels);
    const bool breaks = !planned.breaking_levels.empty(), is_choppy = !plan.dropped[index(Field::Dx)];
    if (breaks && (!is_choppy || plan.trains || planned.breaking_levels != planned.pixel_levels))
        breaking = levels_of(plan, planned.query.pixel_m, planned.breaking_levels);
    const glm::ivec2 cell_size = place(plan, {&cells}), pixel_size = place(plan, {&pixels, &breaking});
    // Where tiles blend, or the sea's amplitude changes with the place, derivatives need the fields that they are derivatives of.
    if (blends_tiles(plan) || plan.masks)
        return {is_choppy ? Plane{true, 4, {Field::Height, Field::Dx, Field::Dy}, cell_size}
                          : Plane{true, 1, {Field::Height}, cell_size},
                {false, 4, {Field::SlopeX, Field::SlopeY, Field::Dxx, Field::Dyy}, pixel_size},
                {false, 4, {Field::Dxy, Field::Height, Field::Dx, Field::Dy}, pixel_size}};
    if (!is_choppy && !breaks)
        return {{true, 1, {Field::Height}, cell_size},
                {false, 2, {Field::SlopeX, Field::SlopeY}, pixel_size}};
    if (!is_choppy)
        return {{true, 1, {Field::Height}, cell_size},
                {false, 4, {Field::SlopeX, Field::SlopeY, Field::Dxx, Field::Dyy}, pixel_size},
                {false, 1, {Field::Dxy}, pixel_size}};
    return {{true, 4, {Field::Height, Field::Dx, Field::Dy}, cell_size},
            {false, 4, {Field::SlopeX, Field::SlopeY, Field::Dxx, Field::Dyy}, pixel_size},
            {false, 1, {Field::Dxy}, pixel_size}};
}

std::vector<SeaLayout::Plane> SeaLayout::planes_of(const Plan& plan, int query) {
    Levels cells, pixels, breaking;
    return lay_out(plan, query, cells, pixels, breaking);
}

SeaLayout::SeaLayout(std::shared_ptr<const Sea<float>> sea, int query) : sea_(std::move(sea)), query_(query) {
    const Plan& plan = sea_->plan();
    planes_ = lay_out(plan, query, cells_, pixels_, breaking_);
    coast_sizes_ = coast_sizes_of(plan);
    has_coverage_ = plan.queries[query].query.products[index(Product::Coverage)];
    is_choppy_ = !plan.dropped[index(Field::Dx)];

    // Differences are taken in double: in single precision those of the finest levels would cancel.
    const QueryStatistics& statistics = sea_->statistics(query);
    const auto whole = unresolved_moments<double>(has_trains() ? sea_->trains().outside : statistics.whole);
    const auto left = [&](const SpectralMoments& resolved) {
        const auto shown = unresolved_moments<double>(resolved);
        UnresolvedMoments<float> unresolved;
        for (std::size_t i = 0; i < unresolved.size(); ++i)
            unresolved[i] = static_cast<float>(whole[i] - shown[i]);
        return unresolved;
    };
    const double whole_m0 = has_trains() ? sea_->trains().outside.m0 : statistics.whole.m0;
    for (std::size_t i = 0; i < pixels_.footprints_m.size(); ++i) {
        unresolved_.push_back(
            {.alone = left(statistics.resolved[i]), .m0_alone = whole_m0 - statistics.resolved[i].m0});
        if (i + 1 == pixels_.footprints_m.size()) break;
        unresolved_.back().with_next = left(statistics.resolved_next[i]);
        unresolved_.back().m0_with_next = whole_m0 - statistics.resolved_next[i].m0;
    }
    const PlannedQuery& planned = plan.queries[query];
    const auto place_among = [](const std::vector<int>& calm, const std::vector<int>& all) {
        const auto found = calm.empty() ? all.end() : std::ranges::find(all, calm.front());
        return found == all.end() ? -1 : static_cast<int>(found - all.begin());
    };
    calm_cell_ = place_among(planned.calm_cells, planned.cell_levels);
    calm_pixel_ = place_among(planned.calm_pixels, planned.pixel_levels);
}

SeaLayout::Levels SeaLayout::levels_of(const Plan& plan, const std::vector<double>& footprints_m,
                                       const std::vector<int>& levels) {
    Levels all{footprints_m, {}};
    for (const int level : levels)
        for (int c = 0; c < static_cast<int>(plan.cascades.size()); ++c) {
            const CascadePlan& cascade = plan.cascades[c];
            const int grid = cascade.grid_of_level[level];
            all.tiles.push_back(
                {.n = grid < 0 ? 0 : cascade.grids[grid].resolution, .cascade = c, .grid = grid});
        }
    return all;
}

// Packs tiles, the largest first, into the texture of the fewest texels that most drivers have: as wide
// as one of the tiles, as two side by side, and so on.
glm::ivec2 SeaLayout::place(const Plan& plan, std::initializer_list<Levels*> all_levels) {
    const int skirt = plan.knobs.spline_taps - 1;
    std::map<std::pair<int, int>, std::vector<Tile*>> by_grid;  // several levels may share a grid
    for (Levels* levels : all_levels)
        for (Tile& tile : levels->tiles)
            if (tile.n > 0) by_grid[{tile.cascade, tile.grid}].push_back(&tile);
    if (by_grid.empty()) return glm::ivec2(1);
    std::vector<std::vector<Tile*>> grids;
    for (auto& [key, tiles] : by_grid) grids.push_back(tiles);
    std::stable_sort(grids.begin(), grids.end(),
                     [](const auto& a, const auto& b) { return a.front()->n > b.front()->n; });
    struct Room {
        glm::ivec2 at, size;
    };
    // The size that they take within this width, each put into the topmost room that holds it; `put` is told where.
    // The room left beside it and below it serves smaller ones.
    const auto packed = [&](int width, const auto& put) {
        std::vector<Room> rooms{{glm::ivec2(0), {width, std::numeric_limits<int>::max()}}};
        glm::ivec2 size(0);
        for (const auto& tiles : grids) {
            const int side = tiles.front()->n + skirt;
            const auto takes = [&](const Room& room) { return std::min(room.size.x, room.size.y) >= side; };
            auto best = rooms.end();
            for (auto room = rooms.begin(); room != rooms.end(); ++room)
                if (takes(*room) && (best == rooms.end() || room->at.y < best->at.y)) best = room;
            const Room room = *best;
            rooms.erase(best);
            put(tiles, room.at);
            size = glm::max(size, room.at + side);
            rooms.push_back({room.at + glm::ivec2(side, 0), {room.size.x - side, side}});
            rooms.push_back({room.at + glm::ivec2(0, side), {room.size.x, room.size.y - side}});
        }
        return size;
    };
    // How many of the limits that drivers have it exceeds, and then its texels.
    const auto judge = [&](glm::ivec2 size) {
        const int side = std::max(size.x, size.y);
        return std::pair((side > 4096) + (side > 8192) + (side > 16384),
                         static_cast<double>(size.x) * size.y);
    };
    std::optional<std::pair<int, double>> best;
    int best_width = 0, width = 0;
    for (const auto& tiles : grids) {
        width += tiles.front()->n + skirt;
        const auto judged = judge(packed(width, [](const auto&, glm::ivec2) {}));
        if (best && !(judged < *best)) continue;
        best = judged;
        best_width = width;
    }
    return packed(best_width, [](const auto& tiles, glm::ivec2 at) {
        for (Tile* tile : tiles) tile->first = at;
    });
}

std::vector<SeaLayout::Tile> SeaLayout::tiles_of(const Plane& plane) const {
    std::vector<Tile> tiles;
    const auto add = [&](const Levels& levels) {
        for (const Tile& tile : levels.tiles) {
            const auto is_same = [&](const Tile& other) {
                return other.cascade == tile.cascade && other.grid == tile.grid;
            };
            if (tile.n > 0 && std::none_of(tiles.begin(), tiles.end(), is_same)) tiles.push_back(tile);
        }
    };
    add(plane.of_cells ? cells_ : pixels_);
    if (!plane.of_cells) add(breaking_);
    return tiles;
}

void SeaLayout::fill_row(const Frame<float>& frame, const Plane& plane, const Tile& tile, int row,
                         float* to) const {
    const auto channels = static_cast<std::size_t>(plane.channels);
    const int skirt = side_of(tile) - tile.n;
    for (std::size_t f = 0; f < plane.fields.size(); ++f) {
        const float* from = frame.samples(tile.cascade, tile.grid, plane.fields[f]);
        if (!from) continue;
        from += static_cast<std::size_t>(row % tile.n) * line_stride<float>(tile.n);
        for (int i = 0; i < tile.n; ++i) to[static_cast<std::size_t>(i) * channels + f] = from[i];
        for (int i = 0; i < skirt; ++i)
            to[static_cast<std::size_t>(tile.n + i) * channels + f] = from[i % tile.n];
    }
}

void SeaLayout::fill(const Frame<float>& frame, std::vector<std::vector<float>>& planes) const {
    planes.resize(planes_.size());
    for (std::size_t p = 0; p < planes_.size(); ++p) {
        const Plane& plane = planes_[p];
        const auto channels = static_cast<std::size_t>(plane.channels);
        const auto width = static_cast<std::size_t>(plane.size.x);
        planes[p].resize(width * static_cast<std::size_t>(plane.size.y) * channels);
        for (const Tile& tile : tiles_of(plane))
            tbb::parallel_for(0, side_of(tile), [&](int row) {
                fill_row(frame, plane, tile, row,
                         planes[p].data() + (static_cast<std::size_t>(tile.first.y + row) * width +
                                             static_cast<std::size_t>(tile.first.x)) *
                                                channels);
            });
    }
}

int SeaLayout::ellipse_columns() const {
    return sea_->ellipses(query_).empty() ? 1 : 2 * EllipseTable::kRatios * EllipseTable::kDirections;
}

std::vector<glm::vec4> SeaLayout::ellipse_texels() const {
    const EllipseMoments& ellipses = sea_->ellipses(query_);
    if (ellipses.empty()) return {glm::vec4(0.0f)};
    std::vector<glm::vec4> texels;
    texels.reserve(2 * ellipses.values().size());
    for (const UnresolvedMoments<float>& m : ellipses.values()) {
        texels.emplace_back(m[0], m[1], m[2], m[3]);
        texels.emplace_back(m[4], m[5], m[6], m[7]);
    }
    return texels;
}

glm::ivec2 SeaLayout::wake_size() const {
    if (vessels() == 0) return glm::ivec2(0);
    return {std::max(2 * WakeStrip::kMostPoints,
                     Frame<float>::kSlopeBlocks * static_cast<int>(pixels_.footprints_m.size())),
            kWakeTableRows * vessels()};
}

std::vector<glm::vec4> SeaLayout::train_texels() const {
    const Trains<float>& trains = sea_->trains();
    const std::size_t count = trains.count();
    std::vector<glm::vec4> texels(kTrainTexels * (count + 1), glm::vec4(0.0f));
    const auto at = [&](std::size_t row, std::size_t train) -> glm::vec4& {
        return texels[row * (count + 1) + train];
    };
    const auto outside = unresolved_moments<double>(trains.outside);
    for (std::size_t i = 0; i <= count; ++i) {
        const auto from = unresolved_moments<double>(trains.from[i]);
        for (std::size_t m = 0; m < from.size(); ++m)
            at(6 + m / 4, i)[static_cast<int>(m % 4)] = static_cast<float>(from[m] - outside[m]);
        if (i == count) break;
        const SplitNumber kx = split_number(trains.kx_cycles_per_m[i]),
                          ky = split_number(trains.ky_cycles_per_m[i]);
        at(0, i) = {kx.high, kx.low, ky.high, ky.low};
        if (const auto& coast = sea_->coast()) {
            const float fade_per_m = i < coast->feeling ? coast->phase_fade_per_m[i] : 0.0f;
            at(1, i) = {coast->height_m[i], coast->sideways_m[i], coast->breaking_sideways_m[i], fade_per_m};
            at(2, i) = {coast->kx[i], coast->ky[i], 0.0f, 0.0f};
            at(3, i) = {coast->longest_m[i], coast->breaking[i], 0.0f, 0.0f};
            continue;
        }
        const auto amplitude = [&](Field field) { return trains.amplitude[index(field)][i]; };
        at(1, i) = {amplitude(Field::SlopeX), amplitude(Field::SlopeY), amplitude(Field::Dxx),
                    amplitude(Field::Dyy)};
        at(2, i) = {amplitude(Field::Dxy), amplitude(Field::Height), amplitude(Field::Dx),
                    amplitude(Field::Dy)};
        at(3, i) = {trains.wavelength[i], trains.breaking[i], 0.0f, 0.0f};
        for (std::size_t m = 0; m < from.size(); ++m)
            at(4 + m / 4, i)[static_cast<int>(m % 4)] = trains.unresolved_alone[i][m];
    }
    return texels;
}

int SeaLayout::CoastSizes::side() const {
    return std::max({cells.x, cells.y, trains.x, trains.y});
}

std::size_t SeaLayout::CoastSizes::bytes() const {
    const auto area = [](glm::ivec2 size) {
        return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    };
    return area(cells) * sizeof(glm::vec4) + area(trains) * sizeof(glm::vec2);
}

SeaLayout::CoastSizes SeaLayout::coast_sizes_of(const Plan& plan) {
    if (!plan.trains || plan.trains->coast_cells.x == 0)
        return {.cells = plan.masks && plan.masks->surf ? plan.masks->surf->count : glm::ivec2(0)};
    const glm::ivec2 cells = plan.trains->coast_cells;
    const int trains = plan.trains->coast_trains;
    if (trains == 0) return {.cells = cells};
    // As square as can be.
    const double square = std::sqrt(static_cast<double>(trains) * cells.y / cells.x);
    const int across = std::clamp(static_cast<int>(std::lround(square)), 1, trains);
    return {.cells = cells, .trains = cells * glm::ivec2(across, (trains + across - 1) / across)};
}

std::vector<glm::vec4> SeaLayout::coast_cell_texels() const {
    std::vector<glm::vec4> texels;
    const auto add = [&](const auto& surf, std::span<const float> others) {
        for (std::size_t cell = 0; cell < surf.broken.size(); ++cell)
            texels.emplace_back(surf.broken[cell], surf.deviation_m[cell],
                                others.empty() ? 0.0f : others[cell], 0.0f);
    };
    if (has_coast())
        add(*sea_->coast(), sea_->coast()->others);
    else
        add(*sea_->plan().masks->surf, {});
    return texels;
}

std::vector<glm::vec2> SeaLayout::coast_train_texels() const {
    if (coast_trains() == 0) return {};
    const Coast<float>& coast = *sea_->coast();
    const glm::ivec2 size = coast_sizes_.trains;
    const int across = coast_across();
    std::vector<glm::vec2> texels(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y),
                                  glm::vec2(0.0f));
    tbb::parallel_for(0, coast.count.y, [&](int y) {
        for (int x = 0; x < coast.count.x; ++x) {
            const std::size_t from = coast.cell(x, y) * coast.stride;
            for (int train = 0; train < coast_trains(); ++train) {
                const glm::ivec2 at =
                    coast.count * glm::ivec2(train % across, train / across) + glm::ivec2(x, y);
                texels[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(size.x) +
                       static_cast<std::size_t>(at.x)] = {coast.phase[from + static_cast<std::size_t>(train)],
                                                          coast.gain[from + static_cast<std::size_t>(train)]};
            }
        }
    });
    return texels;
}

}  // namespace pelagic
