#include "plugin/format/ocio/ocio.h"

#include <dlfcn.h>

#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "plugin/format/ocio/ocio_module.h"

namespace pelagic::ocio {
namespace {

// What this machine lacks, in these words alone: std::system_error adds the system's.
struct NotLoaded : std::system_error {
    explicit NotLoaded(std::string text)
        : system_error(std::make_error_code(std::errc::not_supported)), text_(std::move(text)) {}
    const char* what() const noexcept override { return text_.c_str(); }
    std::string text_;
};

}  // namespace

std::shared_ptr<const View> make_view(const ViewChoice& choice) {
    // For as long as the process lives: views have their code in there.
    static const auto maker = [] {
        void* const library = ::dlopen(PELAGIC_OCIO_MODULE, RTLD_NOW | RTLD_LOCAL);
        void* const symbol = library ? ::dlsym(library, "pelagic_ocio_view") : nullptr;
        if (!symbol)
            throw NotLoaded(
                std::string("OpenColorIO can't be loaded: ") + ::dlerror() +
                "; --ocio needs that file of Pelagic's, and the OpenColorIO that it was built with");
        return reinterpret_cast<decltype(&pelagic_ocio_view)>(symbol);
    }();
    return std::shared_ptr<const View>(maker(choice));
}

}  // namespace pelagic::ocio
