// What a bake leaves, as the plan sees it: each output is a query, the keys on which it depends, and a revision. Its
// encoder and its files are a part of plugin/bake.
//
// There are the mesh, maps over the patch's square, the same maps over each cascade's own periodic tile, and volumes and drops of
// spray over the patch's square. Beside a mesh under a light that changes there is each frame's sky, which asks nothing of the sea.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/plan/prepared_scene.h"
#include "core/plan/products.h"
#include "core/plan/query.h"
#include "core/scene/keys.h"
#include "core/surface/rest_surface.h"

namespace pelagic {

struct OutputRow;

enum class OutputKind { Mesh, Map, Tile, Volume, Drops, Sky };

// One output of a scene, and what it asks of the sea.
struct OutputRequest {
    const OutputRow* row = nullptr;
    std::optional<MapKind> map{};         // of maps and tiles
    std::optional<int> cascade{};         // of a tile: which, counting from the largest
    std::optional<VolumeKind> volume{};   // of volumes
    std::optional<SurfaceNeeds> needs{};  // of the mesh's surface
    Query query;
};

struct OutputContext {
    const PreparedScene& prepared;
    const RestSurface& surface;
    std::span<const int> frames;          // that will be baked
    std::optional<SurfaceNeeds> needs{};  // of the surface, where they are known
};

// A row here and a part in plugin/bake are all that a kind of output is.
struct OutputRow {
    OutputKind kind;
    // Keys whose values are in the files or change them, besides what the resolved plan says: points,
    // footprints, products, cascades, trains and knobs follow from many keys together.
    KeyPartSet key_parts;
    // Raised by hand when the same plan and keys give other bits; then no file that is there counts as whole.
    // tests/plugin/bake/golden_test.cpp notices bits that change without it.
    int revision;
    // Appends those that the scene asks for; `requests` holds those of the rows before.
    void (*add)(const OutputRow&, const OutputContext&, std::vector<OutputRequest>& requests);
};
std::span<const OutputRow> output_table();

// What a mesh attribute carries, and what a map asks for.
struct AttributeRow {
    MeshAttribute attribute;
    Product product;
};
std::span<const AttributeRow> attribute_table();

struct MapRow {
    MapKind map;
    ProductSet (*needs)();
    bool asks_each_level;   // each level of its mip pyramid has a footprint of its own
    bool is_below = false;  // of what lies below the sea: there is none of a cascade alone
};
std::span<const MapRow> map_table();

// What a volume asks for.
struct VolumeRow {
    VolumeKind volume;
    ProductSet (*needs)();
    KeyPartSet key_parts;  // besides those of all volumes
    bool
        is_of_columns;  // points above the middles of columns of voxels, or above the corners of as many cells
};
std::span<const VolumeRow> volume_table();
// Of volumes: columns along a side of the patch's square, the last of which may reach beyond it. The scene must be valid.
int voxels_a_side(const Scene& scene);

struct PlannedOutput {
    const OutputRow* row = nullptr;
    std::optional<MapKind> map{};
    std::optional<int> cascade{};
    std::optional<VolumeKind> volume{};
    int query = 0;             // into Plan::queries, whose name is the output's: "mesh", "map normal", …
    bool has_surface = false;  // its points are Plan::surface's
    bool meets_hulls = false;  // there are some, and what it holds of the sea isn't in them
    KeyPartSet key_parts;      // the row's, the surface's, and the foam's where it holds coverage
};

}  // namespace pelagic
