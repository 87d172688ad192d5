#include "plugin/host/preview/sea_textures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "plugin/host/preview/gl_textures.h"

namespace pelagic {
namespace {

enum Unit : int {
    kCellFields,
    kPixelFields,
    kPixelFields2,
    kEllipseTable,
    kTrainTable,
    kTrainCycles,
    kFoamNodes,
    kFoamPages,
    kFoamLevels,
    kWakeTable,
    kMaskCells,
    kCoastCells,
    kCoastTrains
};
static_assert(kCoastTrains + 1 == SeaTextures::kUnits);

// A texture of floats from memory, rows without gaps.
void fill(const GlTexture& texture, glm::ivec2 size, int channels, const void* texels) {
    edit_texture(texture);
    texels_as_they_are();
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    const TexelFormat format = float_texels(channels);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format.internal), size.x, size.y, 0, format.format,
                 GL_FLOAT, texels);
}

}  // namespace

std::string too_large_coast(const SeaLayout::CoastSizes& sizes, int most) {
    return "the waves that feel the floor need a texture of " + std::to_string(sizes.side()) +
           " texels a side, and the driver's largest is " + std::to_string(most) + ": lower waves.trains";
}

bool SeaTextures::take_sea(const std::shared_ptr<const SeaLayout>& layout) {
    GLint largest_texture = 0, largest_block = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_texture);
    glGetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &largest_block);
    for (const SeaLayout::Plane& plane : layout->planes())
        if (std::max(plane.size.x, plane.size.y) > largest_texture)
            throw PreviewError("the sea's grids need a texture of " + std::to_string(plane.size.x) + " x " +
                               std::to_string(plane.size.y) + ", and the driver's largest is " +
                               std::to_string(largest_texture) +
                               ": lower the cascades' resolutions, or use --quality draft");
    const std::size_t block_bytes = layout->tables(glm::dvec2(0.0), 0.0).size();
    if (block_bytes > static_cast<std::size_t>(largest_block))
        throw PreviewError("the sea's tables need " + std::to_string(block_bytes) +
                           " bytes of uniforms, and the driver has " + std::to_string(largest_block) +
                           ": ask for fewer cascades or vessels");
    std::optional<GlTexture> train_table, train_cycles, mask_cells, coast_cells, coast_trains;
    GlTexture ellipse_table;
    edit_texture(ellipse_table);
    texels_as_they_are();
    const std::vector<glm::vec4> ellipses = layout->ellipse_texels();
    const int columns = layout->ellipse_columns();
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, columns, static_cast<GLsizei>(ellipses.size()) / columns, 0,
                 GL_RGBA, GL_FLOAT, ellipses.data());
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
    if (layout->has_mask_pictures()) {
        const glm::ivec2 size = layout->mask_cells_size();
        if (std::max(size.x, size.y) > largest_texture)
            throw PreviewError("the pictures of waves.masks and a coast's gains need a texture of " +
                               std::to_string(size.x) + " x " + std::to_string(size.y) +
                               ", and the driver's largest is " + std::to_string(largest_texture) +
                               ": take smaller ones, or wider edges");
        fill(mask_cells.emplace(), size, 1, layout->mask_cells().data());
    }
    if (layout->has_surf()) {
        const SeaLayout::CoastSizes& sizes = layout->coast_sizes();
        if (sizes.side() > largest_texture) throw PreviewError(too_large_coast(sizes, largest_texture));
        fill(coast_cells.emplace(), sizes.cells, 4, layout->coast_cell_texels().data());
        if (layout->coast_trains() > 0)
            fill(coast_trains.emplace(), sizes.trains, 2, layout->coast_train_texels().data());
    }
    // A sea that changes has a layout for each time, and the same textures for all of them.
    const bool has_room = layout_ &&
                          std::ranges::equal(layout_->planes(), layout->planes(),
                                             [](const auto& a, const auto& b) {
                                                 return a.size == b.size && a.channels == b.channels;
                                             }) &&
                          layout_->has_living_foam() == layout->has_living_foam();
    layout_ = layout;
    if (!has_room) {
        planes_.clear();
        planes_.resize(layout->planes().size());
    }
    ellipse_table_ = std::move(ellipse_table);
    if (layout->vessels() == 0) wake_table_.reset();
    mask_cells_ = std::move(mask_cells);
    coast_cells_ = std::move(coast_cells);
    coast_trains_ = std::move(coast_trains);
    train_table_ = std::move(train_table);
    train_cycles_ = std::move(train_cycles);
    if (has_room) return true;
    foam_textures_.reset();
    if (layout->has_living_foam()) upload_foam(std::make_shared<const PackedFoam>());
    return false;
}

// Of a plane's texture, which is bound from here on.
void SeaTextures::make_room(std::size_t p) {
    const SeaLayout::Plane& plane = layout_->planes()[p];
    edit_texture(planes_[p]);
    texels_as_they_are();
    const TexelFormat texels = float_texels(plane.channels);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(texels.internal), plane.size.x, plane.size.y, 0,
                 texels.format, GL_FLOAT, nullptr);
}

void SeaTextures::upload_wakes(const std::vector<glm::vec4>& texels) {
    if (texels.empty()) return;
    if (!wake_table_) wake_table_.emplace();
    edit_texture(*wake_table_);
    texels_as_they_are();
    const glm::ivec2 size = layout_->wake_size();
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, size.x, size.y, 0, GL_RGBA, GL_FLOAT, texels.data());
}

void SeaTextures::upload_foam(std::shared_ptr<const PackedFoam> foam) {
    if (!layout_ || !layout_->has_living_foam())
        throw std::invalid_argument("the sea that is shown has no living foam");
    GLint largest_texture = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_texture);
    if (const glm::ivec2 size = foam->nodes_size(); std::max(size.x, size.y) > largest_texture)
        throw PreviewError("the foam's past needs a texture of " + std::to_string(size.x) + " x " +
                           std::to_string(size.y) + ", and the driver's largest is " +
                           std::to_string(largest_texture) +
                           ": take a smaller picture, or set effects.foam_decay_s to 0");
    if (!foam_textures_) foam_textures_.emplace();
    foam_ = std::move(foam);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    fill(foam_textures_->nodes, foam_->nodes_size(), foam_->channels(), foam_->nodes().data());
    fill(foam_textures_->pages, foam_->pages_size(), 1, foam_->pages().data());
}

void SeaTextures::upload_once(Frame<float>&& frame, int query) {
    const std::shared_ptr<const Sea<float>> sea = frame.shared_sea();
    take_sea(std::make_shared<const SeaLayout>(sea, query));
    time_within_loop_s_ = frame.time_within_loop_s();
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    upload_wakes(layout_->wake_texels(frame));
    constexpr int kRows = 64;
    std::vector<float> rows;
    const auto upload = [&](const SeaLayout::Plane& plane, const SeaLayout::Tile& tile) {
        const int side = layout_->side_of(tile);
        const std::size_t row_values = static_cast<std::size_t>(side) * plane.channels;
        for (int first = 0; first < side; first += kRows) {
            const int count = std::min(kRows, side - first);
            rows.assign(row_values * count, 0.0f);
            for (int row = 0; row < count; ++row)
                layout_->fill_row(frame, plane, tile, first + row, rows.data() + row_values * row);
            glTexSubImage2D(GL_TEXTURE_2D, 0, tile.first.x, tile.first.y + first, side, count,
                            float_texels(plane.channels).format, GL_FLOAT, rows.data());
        }
    };
    const std::vector<SeaLayout::Plane>& planes = layout_->planes();
    for (std::size_t p = 0; p < planes.size(); ++p) {
        make_room(p);
        for (const SeaLayout::Tile& tile : layout_->tiles_of(planes[p])) {
            upload(planes[p], tile);
            for (const Field field : planes[p].fields) {
                const auto reads = [&](const SeaLayout::Plane& later) {
                    return std::count(later.fields.begin(), later.fields.end(), field) > 0;
                };
                if (std::none_of(planes.begin() + p + 1, planes.end(), reads))
                    frame.release(tile.cascade, tile.grid, field);
            }
        }
    }
}

void SeaTextures::upload(const PackedFrame& frame) {
    if (frame.planes().empty())
        throw std::invalid_argument("the packed frame holds nothing yet: call pack() first");
    if (layout_ != frame.layout() && !take_sea(frame.layout()))
        for (std::size_t p = 0; p < planes_.size(); ++p) make_room(p);
    time_within_loop_s_ = frame.time_within_loop_s();
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    upload_wakes(frame.wakes());
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
}

// Uploads what depends on the grid's origin.
void SeaTextures::upload_tables(glm::dvec2 origin_m) {
    const std::vector<std::byte> block = layout_->tables(origin_m, time_within_loop_s_);
    glBindBuffer(GL_UNIFORM_BUFFER, tables_.name());
    glBufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(block.size()), block.data(), GL_STREAM_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, tables_.name());
    if (foam_textures_) {
        const std::vector<glm::vec4> levels = foam_->level_texels(origin_m);
        edit_texture(foam_textures_->levels);
        texels_as_they_are();
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, PackedFoam::kLevelTexels,
                     static_cast<GLsizei>(levels.size()) / PackedFoam::kLevelTexels, 0, GL_RGBA, GL_FLOAT,
                     levels.data());
    }
    if (!layout_->has_trains()) return;
    const std::vector<float> cycles = layout_->train_cycles(origin_m, time_within_loop_s_);
    edit_texture(*train_cycles_);
    if (!cycles.empty())
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, static_cast<GLsizei>(cycles.size()), 1, GL_RED, GL_FLOAT,
                        cycles.data());
}

void SeaTextures::bind(const ShaderProgram& program, glm::dvec2 origin_m) {
    upload_tables(origin_m);
    const GLuint block = glGetUniformBlockIndex(program.name(), "SeaTables");
    if (block != GL_INVALID_INDEX) glUniformBlockBinding(program.name(), block, 0);
    for (const auto& [name, unit] :
         {std::pair{"cell_fields", kCellFields}, std::pair{"pixel_fields", kPixelFields},
          std::pair{"pixel_fields_2", kPixelFields2}, std::pair{"ellipse_table", kEllipseTable},
          std::pair{"train_table", kTrainTable}, std::pair{"train_cycles", kTrainCycles},
          std::pair{"foam_nodes", kFoamNodes}, std::pair{"foam_pages", kFoamPages},
          std::pair{"foam_levels", kFoamLevels}, std::pair{"wake_table", kWakeTable},
          std::pair{"mask_cells", kMaskCells}, std::pair{"coast_cells", kCoastCells},
          std::pair{"coast_trains", kCoastTrains}})
        glUniform1i(program.uniform(name), unit);
    set_uniforms(program, query_uniforms(*layout_));
    for (std::size_t p = 0; p < planes_.size(); ++p)
        bind_texture(static_cast<int>(kCellFields + p), planes_[p]);
    bind_texture(kEllipseTable, *ellipse_table_);
    if (layout_->has_trains()) {
        bind_texture(kTrainTable, *train_table_);
        bind_texture(kTrainCycles, *train_cycles_);
    }
    if (wake_table_) bind_texture(kWakeTable, *wake_table_);
    if (mask_cells_) bind_texture(kMaskCells, *mask_cells_);
    if (coast_cells_) bind_texture(kCoastCells, *coast_cells_);
    if (coast_trains_) bind_texture(kCoastTrains, *coast_trains_);
    if (foam_textures_) {
        bind_texture(kFoamNodes, foam_textures_->nodes);
        bind_texture(kFoamPages, foam_textures_->pages);
        bind_texture(kFoamLevels, foam_textures_->levels);
    }
}

}  // namespace pelagic
