#include "plugin/bake/output_part.h"

#include <array>
#include <stdexcept>

namespace pelagic {

OutputPart::OutputPart(const Plan& plan, const PlannedOutput& output)
    : plan_(plan), output_(output), base_(output_fingerprint(plan, output)) {}

std::vector<std::unique_ptr<OutputPart>> make_parts(const Plan& plan) {
    struct PartRow {
        OutputKind kind;
        std::unique_ptr<OutputPart> (*make)(const Plan&, const PlannedOutput&,
                                            const std::shared_ptr<SquareCache>&);
    };
    static constexpr std::array kPartTable = std::to_array<PartRow>({
        {OutputKind::Mesh, make_mesh_part},
        {OutputKind::Map, make_map_part},
        {OutputKind::Tile, make_map_part},
        {OutputKind::Volume, make_volume_part},
        {OutputKind::Drops, make_drops_part},
        {OutputKind::Sky, make_sky_part},
    });
    const auto squares = std::make_shared<SquareCache>();
    std::vector<std::unique_ptr<OutputPart>> parts;
    for (const PlannedOutput& output : plan.outputs)
        for (const PartRow& row : kPartTable)
            if (row.kind == output.row->kind) parts.push_back(row.make(plan, output, squares));
    if (parts.size() != plan.outputs.size()) throw std::logic_error("an output of the plan has no part");
    return parts;
}

}  // namespace pelagic
