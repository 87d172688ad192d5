#include "plugin/host/cli/warnings.h"

#include <iostream>
#include <set>

#include "core/base/text.h"
#include "core/plan/prepared_scene.h"
#include "core/scene/budget.h"
#include "core/waves/folding.h"

namespace pelagic::cli {

void print_warnings(const std::string& shot, const Scene& scene) {
    for (const std::string& warning : sea_warnings(*prepare(without_budget(scene))))
        std::cerr << line_text(shot) << ": note: " << warning << std::endl;
    std::set<const ObjectMesh*> said;  // bodies of one file share its mesh
    for (const SceneObject& object : scene.objects)
        if (said.insert(object.mesh.get()).second)
            for (const std::string& note : object.mesh->notes())
                std::cerr << line_text(shot) << ": note: the mesh " << line_text(object.file) << ": " << note
                          << std::endl;
}

}  // namespace pelagic::cli
