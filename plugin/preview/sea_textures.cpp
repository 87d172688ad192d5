#include "plugin/preview/sea_textures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "plugin/preview/gl_textures.h"

namespace pelagic {
namespace {

enum Unit : int { kCellFields, kPixelFields, kPixelFields2, kTrainTable, kTrainCycles };

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
        row.scale[axis] = static_cast<float>(nodes - node);
    }
    const SplitNumber nodes_per_m = split_number(tile.n / size_m);
    row.scale[2] = nodes_per_m.high;
    row.scale[3] = nodes_per_m.low;
    return row;
}

}  // namespace

void SeaTextures::take_sea(const std::shared_ptr<const SeaLayout>& layout) {
    GLint largest_texture = 0, largest_block = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_texture);
    glGetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &largest_block);
    for (const SeaLayout::Plane& plane : layout->planes())
        if (std::max(plane.size.x, plane.size.y) > largest_texture)
            throw PreviewError("the sea's grids need a texture of " + std::to_string(plane.size.x) + " x " +
                               std::to_string(plane.size.y) + ", and the driver's largest is " +
                               std::to_string(largest_texture) +
                               ": lower the cascades' resolutions, or use --quality draft");
    const std::size_t rungs = layout->cells().footprints_m.size() + layout->pixels().footprints_m.size();
    const std::size_t tiles = layout->cells().tiles.size() + layout->pixels().tiles.size();
    const std::size_t block_bytes =
        (3 * std::max<std::size_t>(tiles, rungs) + rungs + 4 * layout->hidden().size()) * sizeof(glm::vec4);
    if (block_bytes > static_cast<std::size_t>(largest_block))
        throw PreviewError("the sea's tables need " + std::to_string(block_bytes) +
                           " bytes of uniforms, and the driver has " + std::to_string(largest_block) +
                           ": ask for fewer cascades");
    std::vector<GlTexture> planes;
    std::optional<GlTexture> train_table, train_cycles;
    for (const SeaLayout::Plane& plane : layout->planes()) {
        edit_texture(planes.emplace_back());
        texels_as_they_are();
        const TexelFormat texels = float_texels(plane.channels);
        glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(texels.internal), plane.size.x, plane.size.y, 0,
                     texels.format, GL_FLOAT, nullptr);
    }
    if (layout->has_trains()) {
        const auto count = static_cast<GLsizei>(layout->sea().trains().count());
        if (count + 1 > largest_texture)
            throw PreviewError(std::to_string(count) +
                               " trains are more than the driver's largest texture, " +
                               std::to_string(largest_texture) + ", holds: lower waves.trains");
        edit_texture(train_table.emplace());
        texels_as_they_are();
        const std::vector<glm::vec4> texels = layout->train_texels();
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, count + 1, SeaLayout::kTrainTexels, 0, GL_RGBA, GL_FLOAT,
                     texels.data());
        edit_texture(train_cycles.emplace());
        texels_as_they_are();
        glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, std::max(count, 1), 1, 0, GL_RED, GL_FLOAT, nullptr);
    }
    layout_ = layout;
    planes_ = std::move(planes);
    train_table_ = std::move(train_table);
    train_cycles_ = std::move(train_cycles);
}

void SeaTextures::upload(const PackedFrame& frame) {
    if (frame.planes().empty())
        throw std::invalid_argument("the packed frame holds nothing yet: call pack() first");
    if (layout_ != frame.layout()) take_sea(frame.layout());
    Staging& buffers = staging_[next_staging_];
    next_staging_ = (next_staging_ + 1) % staging_.size();
    for (std::size_t p = 0; p < frame.planes().size(); ++p) {
        const SeaLayout::Plane& plane = layout_->planes()[p];
        const std::vector<float>& texels = frame.planes()[p];
        const auto bytes = static_cast<GLsizeiptr>(texels.size() * sizeof(float));
        if (!buffers.planes[p]) buffers.planes[p].emplace();
        glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffers.planes[p]->name());
        glBufferData(GL_PIXEL_UNPACK_BUFFER, bytes, texels.data(), GL_STREAM_DRAW);
        edit_texture(planes_[p]);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, plane.size.x, plane.size.y,
                        float_texels(plane.channels).format, GL_FLOAT, nullptr);
    }
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    time_within_loop_s_ = frame.time_within_loop_s();
}

// Uploads what depends on the grid's origin.
void SeaTextures::upload_tables(glm::dvec2 origin_m) {
    const SeaLayout& layout = *layout_;
    const SeaLayout::Ladder &cells = layout.cells(), &pixels = layout.pixels();
    const std::size_t rungs = cells.footprints_m.size() + pixels.footprints_m.size();
    const std::size_t tiles = rungs * static_cast<std::size_t>(std::max(layout.cascades(), 1));
    std::vector<std::array<std::int32_t, 4>> first, origin;
    std::vector<std::array<float, 4>> scale, rung, hidden;
    for (const SeaLayout::Ladder* ladder : {&cells, &pixels}) {
        for (const SeaLayout::Tile& tile : ladder->tiles) {
            const TileRow row = tile_row(layout, tile, origin_m);
            first.push_back(row.first);
            origin.push_back(row.origin);
            scale.push_back(row.scale);
        }
        for (const double footprint_m : ladder->footprints_m)
            rung.push_back({static_cast<float>(footprint_m), 0.0f, 0.0f, 0.0f});
    }
    first.resize(tiles);
    origin.resize(tiles);
    scale.resize(tiles);
    for (const SeaLayout::HiddenRung& of : layout.hidden())
        for (const HiddenMoments<float>& m : {of.alone, of.with_next}) {
            hidden.push_back({m[0], m[1], m[2], m[3]});
            hidden.push_back({m[4], m[5], m[6], m[7]});
        }
    std::vector<std::byte> block;
    const auto append = [&](const auto& rows) {
        const auto bytes = std::as_bytes(std::span(rows));
        block.insert(block.end(), bytes.begin(), bytes.end());
    };
    append(first);
    append(origin);
    append(scale);
    append(rung);
    append(hidden);
    glBindBuffer(GL_UNIFORM_BUFFER, tables_.name());
    glBufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(block.size()), block.data(), GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, tables_.name());
    if (!layout.has_trains()) return;
    const std::vector<double> cycles = phases_at(layout.sea().trains(), origin_m, time_within_loop_s_);
    const std::vector<float> narrow(cycles.begin(), cycles.end());
    edit_texture(*train_cycles_);
    if (!narrow.empty())
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, static_cast<GLsizei>(narrow.size()), 1, GL_RED, GL_FLOAT,
                        narrow.data());
}

void SeaTextures::bind(const ShaderProgram& program, glm::dvec2 origin_m) {
    upload_tables(origin_m);
    const GLuint block = glGetUniformBlockIndex(program.name(), "SeaTables");
    if (block != GL_INVALID_INDEX) glUniformBlockBinding(program.name(), block, 0);
    for (const auto& [name, unit] :
         {std::pair{"cell_fields", kCellFields}, std::pair{"pixel_fields", kPixelFields},
          std::pair{"pixel_fields_2", kPixelFields2}, std::pair{"train_table", kTrainTable},
          std::pair{"train_cycles", kTrainCycles}})
        glUniform1i(program.uniform(name), unit);
    glUniform1f(program.uniform("whitecap_threshold"),
                static_cast<float>(layout_->sea().whitecap_threshold()));
    glUniform2f(program.uniform("finest_m"), static_cast<float>(layout_->cells().footprints_m.front()),
                static_cast<float>(layout_->pixels().footprints_m.front()));
    for (std::size_t p = 0; p < planes_.size(); ++p)
        bind_texture(static_cast<int>(kCellFields + p), planes_[p]);
    if (layout_->has_trains()) {
        const FootprintFilter& filter = layout_->sea().plan().filter;
        bind_texture(kTrainTable, *train_table_);
        bind_texture(kTrainCycles, *train_cycles_);
        glUniform1i(program.uniform("train_count"), static_cast<GLint>(layout_->sea().trains().count()));
        glUniform4f(program.uniform("train_filter"), static_cast<float>(filter.n_min),
                    static_cast<float>(1.0 / (filter.n_max - filter.n_min)),
                    static_cast<float>(1.0 / filter.n_max), static_cast<float>(1.0 / filter.n_min));
    }
}

}  // namespace pelagic
