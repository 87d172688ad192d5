#include "core/plan/outputs.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/plan/plan.h"
#include "core/plan/products.h"
#include "core/plan/spray_drops.h"
#include "core/scene/names.h"
#include "core/scene/number_keys.h"

namespace pelagic {
namespace {

constexpr std::array kAttributeTable = std::to_array<AttributeRow>({
    {MeshAttribute::Normal, Product::Normal},
    {MeshAttribute::Velocity, Product::Velocity},
    {MeshAttribute::SlopeVariance, Product::SlopeVariance},
    {MeshAttribute::Whitecaps, Product::Coverage},
});

const std::array kMapTable = std::to_array<MapRow>({
    {MapKind::Displacement, [] { return products(Product::Displacement); }, false},
    {MapKind::Normal, [] { return products(Product::Normal); }, false},
    {MapKind::SlopeVariance, [] { return products(Product::SlopeVariance); }, true},
    {MapKind::Whitecaps, [] { return products(Product::JacobianMoments, Product::Coverage); }, false},
    {MapKind::Floor, [] { return products(Product::Position, Product::Normal, Product::SlopeVariance); },
     false, true},
});

void add_mesh(const OutputRow& row, const OutputContext& context, std::vector<OutputRequest>& requests) {
    const Output& output = context.prepared.scene.output;
    if (output.mesh == MeshFormat::None) return;
    Query query;
    query.products = products(Product::Position);
    for (const MeshAttribute attribute : output.attributes)
        for (const AttributeRow& at : kAttributeTable)
            if (at.attribute == attribute) query.products.set(index(at.product));
    if (context.surface.fitted())
        query.products.reset(index(Product::Normal));  // a limit surface has its own
    const SurfaceNeeds needs = context.needs ? *context.needs : context.surface.needs(context.frames);
    if (needs.own_footprints) {
        query = view_query(context.prepared, {.products = query.products,
                                              .finest_cell_m = needs.finest_cell_m,
                                              .finest_pixel_m = needs.finest_pixel_m});
    } else {
        query.cell_m = {needs.finest_cell_m};
        query.pixel_m = {needs.finest_pixel_m};
    }
    query.name = "mesh";
    query.points = needs.points;
    query.lattice = needs.lattice;
    requests.push_back({.row = &row, .needs = needs, .query = std::move(query)});
}

// Each level of a map leaves more unresolved: the footprints of its mip pyramid, halved sizes rounded down as OpenEXR
// does.
std::vector<double> mip_footprints(double size_m, int n) {
    std::vector<double> footprints_m;
    for (; n >= 1; n /= 2) footprints_m.push_back(size_m / n);
    return footprints_m;
}

struct Square {
    double size_m = 1.0;
    int texels = 1;  // a side
    std::optional<int> cascade{};
};

// The maps asked for, over one square of texels.
void add_maps(const OutputRow& row, const OutputContext& context, const Square& square,
              std::vector<OutputRequest>& requests) {
    const auto [size_m, n, cascade] = square;
    for (const MapKind map : context.prepared.scene.output.maps)
        for (const MapRow& at : kMapTable) {
            if (at.map != map || (cascade && at.is_below)) continue;
            Query query;
            query.name = (cascade ? "tile " + std::to_string(*cascade) + " " : std::string("map ")) +
                         std::string(word_of(map));
            query.products = at.needs();
            // A tile's unresolved slopes are carried by the whole sea, not by the tile alone: so they are taken at
            // rest.
            if (cascade && query.products[index(Product::SlopeVariance)])
                query.products = products(Product::SlopeVarianceAtRest);
            query.points = static_cast<std::size_t>(n) * n;
            // What falls on a floor comes from elsewhere, and the sea is asked by rows.
            if (at.is_below)
                query.points = static_cast<std::size_t>(n);
            else
                query.lattice = Lattice{-0.5 * size_m, size_m / n, 0.5 * size_m};
            query.only_cascade = cascade;
            query.pixel_m = at.asks_each_level ? mip_footprints(size_m, n) : std::vector{size_m / n};
            // A tile's nodes carry each of its modes: there is nothing to filter out.
            if (cascade) query.pixel_m.front() = 0.0;
            query.cell_m = {query.pixel_m.front()};
            requests.push_back({.row = &row, .map = map, .cascade = cascade, .query = std::move(query)});
        }
}

void add_patch_maps(const OutputRow& row, const OutputContext& context,
                    std::vector<OutputRequest>& requests) {
    const Scene& scene = context.prepared.scene;
    add_maps(row, context, {.size_m = scene.surface.size_m, .texels = scene.output.map_resolution}, requests);
}

// Tiles are as fine as the other outputs need them, but for the camera's: a tile is the same wherever the
// camera is.
void add_tiles(const OutputRow& row, const OutputContext& context, std::vector<OutputRequest>& requests) {
    const Scene& scene = context.prepared.scene;
    if (!scene.output.cascade_tiles) return;
    double finest_m = std::numeric_limits<double>::infinity();
    for (const OutputRequest& request : requests)
        if (!request.query.is_view) finest_m = std::min(finest_m, request.query.pixel_m.front());
    const auto cascades = resolve_cascades(context.prepared, std::isfinite(finest_m) ? finest_m : 0.0);
    for (int i = 0; i < static_cast<int>(cascades.size()); ++i)
        add_maps(row, context, {.size_m = cascades[i].size_m, .texels = cascades[i].resolution, .cascade = i},
                 requests);
}

const std::array kVolumeTable = std::to_array<VolumeRow>({
    {VolumeKind::Spray, [] { return products(Product::Displacement, Product::Breaking); },
     key_parts(KeyPart::Spray), true},
    {VolumeKind::LevelSet, [] { return products(Product::Displacement); }, KeyPartSet(), false},
});

// Over the patch's square in the world, whatever the mesh is: waves shorter than two voxels are left out.
void add_volumes(const OutputRow& row, const OutputContext& context, std::vector<OutputRequest>& requests) {
    const Scene& scene = context.prepared.scene;
    const auto voxels = static_cast<std::size_t>(voxels_a_side(scene));
    for (const VolumeKind volume : scene.output.volumes)
        for (const VolumeRow& at : kVolumeTable) {
            if (at.volume != volume) continue;
            Query query;
            query.name = "volume " + std::string(word_of(volume));
            query.products = at.needs();
            query.cell_m = query.pixel_m = {scene.output.voxel_m};
            const std::size_t points = at.is_of_columns ? voxels : voxels + 1;
            query.points = points * points;
            requests.push_back({.row = &row, .volume = volume, .query = std::move(query)});
        }
}

// They look at the sea at other times than the frame's, as a sea of their own (core/plan/spray_drops.h).
void add_drops(const OutputRow& row, const OutputContext& context, std::vector<OutputRequest>& requests) {
    if (!context.prepared.scene.output.drops) return;
    Query query;
    query.name = "drops";
    query.cell_m =
        query.pixel_m = {plan_spray_drops(context.prepared, context.prepared.scene.surface.size_m).cell_m};
    requests.push_back({.row = &row, .query = std::move(query)});
}

// A stage shows it round the mesh. Its query has nothing to answer, and the mesh's footprints: others would be levels of their own.
void add_sky(const OutputRow& row, const OutputContext& context, std::vector<OutputRequest>& requests) {
    const Scene& scene = context.prepared.scene;
    if (scene.output.mesh == MeshFormat::None || !changes(scene, "light")) return;
    Query query = requests.front().query;  // of the mesh, which is the table's first row
    query.name = "sky";
    query.products.reset();
    query.points = 0;
    requests.push_back({.row = &row, .query = std::move(query)});
}

const std::array kOutputTable = std::to_array<OutputRow>({
    {OutputKind::Mesh, key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Mesh), 9, add_mesh},
    {OutputKind::Map, key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Maps), 7, add_patch_maps},
    {OutputKind::Tile, key_parts(KeyPart::Clock, KeyPart::Waves), 8, add_tiles},
    {OutputKind::Volume, key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Volumes), 3, add_volumes},
    {OutputKind::Drops,
     key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Foam, KeyPart::Gusts, KeyPart::Quality,
               KeyPart::Volumes, KeyPart::Spray),
     2, add_drops},
    {OutputKind::Sky, key_parts(KeyPart::Light), 2, add_sky},
});

}  // namespace

std::span<const OutputRow> output_table() {
    return kOutputTable;
}
std::span<const AttributeRow> attribute_table() {
    return kAttributeTable;
}
std::span<const MapRow> map_table() {
    return kMapTable;
}
std::span<const VolumeRow> volume_table() {
    return kVolumeTable;
}

int voxels_a_side(const Scene& scene) {
    const double voxels = scene.surface.size_m / scene.output.voxel_m;
    // A quotient that should be whole may come out a little above it.
    constexpr double kRounding = 1e-9;
    return std::max(static_cast<int>(std::ceil(voxels * (1.0 - kRounding))), 1);
}

}  // namespace pelagic
