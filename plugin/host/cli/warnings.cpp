#include "plugin/host/cli/warnings.h"

#include <iostream>

#include "core/base/text.h"
#include "core/plan/prepared_scene.h"
#include "core/scene/budget.h"
#include "core/waves/folding.h"

namespace pelagic::cli {

void print_warnings(const std::string& shot, const Scene& scene) {
    for (const std::string& warning : sea_warnings(*prepare(without_budget(scene))))
        std::cerr << line_text(shot) << ": note: " << warning << std::endl;
}

}  // namespace pelagic::cli
