// Preloaded into the program: each lock succeeds and keeps nobody out, as on a file system that locks for one machine alone, or
// is refused with the errno PELAGIC_TEST_LOCK_ERROR.
#include <sys/file.h>

#include <cerrno>
#include <cstdlib>

extern "C" int flock(int, int) noexcept {
    const char* const error = std::getenv("PELAGIC_TEST_LOCK_ERROR");
    if (!error) return 0;
    errno = std::atoi(error);
    return -1;
}
