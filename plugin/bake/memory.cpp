// What a bake holds in memory, from its plan.
#include <algorithm>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "core/plan/products.h"
#include "core/scene/hull.h"
#include "plugin/bake/bake.h"
#include "plugin/bake/output_part.h"
#include "plugin/format/vdb/vdb.h"
#include "plugin/machine/memory.h"

namespace pelagic {
namespace {

// The numbers of a query's products at a point.
std::size_t numbers_of(const Query& query) {
    std::size_t count = 0;
    for (const ProductRow& row : kProductTable)
        if (query.products[index(row.product)]) count += row.components;
    return count;
}

}  // namespace

MemoryNeed bake_memory(const Plan& plan, std::size_t frames, int threads) {
    const std::size_t in_flight = std::min<std::size_t>(frames, kFramesInFlight);
    // Files that belong to no frame are written one after another, before there are values.
    MemoryNeed before, during;
    // That of the stage. One whose light has keys has its own in each frame, which is an output like others.
    const bool has_sky = plan.from->scene.output.mesh != MeshFormat::None &&
                         std::ranges::none_of(plan.outputs, [](const PlannedOutput& output) {
                             return output.row->kind == OutputKind::Sky;
                         });
    for (MemoryNeed* of : {&before, &during}) {
        machine::add_program(*of);
        if (has_sky) machine::add_sky(*of);
    }
    add_sea(before, plan, threads);
    add_sea(during, plan, threads);
    std::size_t fixed = 0;
    std::string fixed_remedy;
    std::set<std::pair<std::size_t, double>> squares;  // whose points at rest are counted
    std::vector<MemoryPart> encodings;
    for (const auto& part : make_parts(plan)) {
        const Query& query = part->query();
        const OutputMemory memory = part->memory();
        if (memory.fixed > fixed) {
            fixed = memory.fixed;
            fixed_remedy = memory.remedy;
        }
        const std::size_t values = query.points * numbers_of(query);
        during.add("values of the " + query.name, in_flight * values * sizeof(float), memory.remedy);
        if (plan.knobs.double_precision)
            during.add("values of the " + query.name, values * sizeof(double), memory.remedy);
        if (!query.lattice || squares.insert({query.points, query.lattice->spacing_m}).second)
            during.add((query.points > 0 ? "points of the " : "tables of the ") + query.name, memory.once,
                       memory.remedy);
        during.add("files of the " + query.name, in_flight * memory.slot, memory.remedy);
        // A thread encodes one file at a time. Those of an output in several frames meet where a thread is left beside the computing.
        const std::size_t at_once =
            memory.one_at_a_time ? 1 : std::clamp<std::size_t>(threads - 1, 1, in_flight);
        encodings.insert(encodings.end(), at_once,
                         {"files of the " + query.name, memory.encoding, memory.remedy});
    }
    std::ranges::sort(encodings, std::ranges::greater(), &MemoryPart::bytes);
    encodings.resize(std::min(encodings.size(), static_cast<std::size_t>(threads)));
    for (const MemoryPart& of : encodings) during.add(of.what, of.bytes, of.remedy);
    if (std::ranges::any_of(plan.outputs,
                            [](const PlannedOutput& output) { return output.volume.has_value(); }))
        during.add("OpenVDB itself", vdb::kLibraryBytes, "set output.volumes to []");
    if (std::ranges::any_of(plan.outputs, &PlannedOutput::meets_hulls))
        during.add("the objects' hulls", hulls_bytes(plan.from->scene), "give fewer objects");
    before.add("the faces of the mesh", fixed, fixed_remedy);
    return before.bytes() > during.bytes() ? before : during;
}

}  // namespace pelagic
