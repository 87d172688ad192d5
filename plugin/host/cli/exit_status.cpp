#include "plugin/host/cli/exit_status.h"

#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "core/plan/memory.h"
#include "plugin/files/files.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/run/record.h"

namespace pelagic::cli {
namespace {

// Of the system's refusals those that say something of the path: the others may pass.
int status_of_system(const std::error_code& code) {
    for (const std::errc path :
         {std::errc::not_a_directory, std::errc::file_exists, std::errc::is_a_directory,
          std::errc::permission_denied, std::errc::operation_not_permitted, std::errc::filename_too_long,
          std::errc::too_many_symbolic_link_levels, std::errc::invalid_argument,
          std::errc::function_not_supported, std::errc::not_supported})
        if (code == path) return kWrongUsage;
    return kTryAgain;
}

}  // namespace

bool is_about_threads(const std::exception& error) {
    const auto* system = dynamic_cast<const std::system_error*>(&error);
    return (system && system->code() == std::errc::resource_unavailable_try_again) ||
           std::string_view(error.what()).find("pthread_create") != std::string_view::npos;
}

int status_of(const std::exception& error) {
    if (const auto* file = dynamic_cast<const files::FileError*>(&error))
        return status_of_system(file->code());
    if (const auto* system = dynamic_cast<const std::system_error*>(&error))
        return status_of_system(system->code());
    if (const auto* memory = dynamic_cast<const NotEnoughMemory*>(&error))
        return memory->is_asked() ? kWrongUsage : kTryAgain;
    if (dynamic_cast<const std::bad_alloc*>(&error) || dynamic_cast<const ChosenMeanwhile*>(&error) ||
        dynamic_cast<const BegunAnew*>(&error) || dynamic_cast<const TryAgain*>(&error) ||
        is_about_threads(error))
        return kTryAgain;
    if (dynamic_cast<const ShotError*>(&error) || dynamic_cast<const WrongUsage*>(&error) ||
        dynamic_cast<const std::invalid_argument*>(&error))
        return kWrongUsage;
    return kUnknown;
}

}  // namespace pelagic::cli
