#include "plugin/format/ocio/ocio.h"

#include <dlfcn.h>

#include <system_error>

#include "plugin/files/files.h"
#include "plugin/format/ocio/ocio_module.h"

namespace pelagic::ocio {

std::shared_ptr<const View> make_view(const ViewChoice& choice) {
    // For as long as the process lives: views have their code in there.
    static const auto maker = [] {
        void* const library = ::dlopen(PELAGIC_OCIO_MODULE, RTLD_NOW | RTLD_LOCAL);
        void* const symbol = library ? ::dlsym(library, "pelagic_ocio_view") : nullptr;
        if (!symbol)
            throw files::FileError(
                std::string("OpenColorIO can't be loaded: ") + ::dlerror() +
                    "; --ocio needs that file of Pelagic's, and the OpenColorIO that it was built with",
                PELAGIC_OCIO_MODULE, std::make_error_code(std::errc::not_supported));
        return reinterpret_cast<decltype(&pelagic_ocio_view)>(symbol);
    }();
    return std::shared_ptr<const View>(maker(choice));
}

}  // namespace pelagic::ocio
