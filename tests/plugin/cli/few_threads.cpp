// Preloaded into the program: the system starts PELAGIC_TEST_THREADS threads, and refuses more.
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                              void* argument) noexcept {
    using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
    static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
    static std::atomic<int> left{std::atoi(std::getenv("PELAGIC_TEST_THREADS"))};
    if (left.fetch_sub(1) <= 0) return EAGAIN;
    return create(thread, attributes, run, argument);
}
