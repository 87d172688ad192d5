#include "plugin/format/ocio/ocio.h"

#include "plugin/files/module.h"
#include "plugin/format/ocio/ocio_module.h"

namespace pelagic::ocio {

std::shared_ptr<const View> make_view(const ViewChoice& choice) {
    // For as long as the process lives: views have their code in there.
    static const auto maker = [] {
        return reinterpret_cast<decltype(&pelagic_ocio_view)>(files::load(
            {.file = PELAGIC_OCIO_MODULE,
             .symbol = "pelagic_ocio_view",
             .what = "OpenColorIO",
             .needs = "--ocio needs that file of Pelagic's, and the OpenColorIO that it was built with"}));
    }();
    return std::shared_ptr<const View>(maker(choice));
}

}  // namespace pelagic::ocio
