// Preloaded into the program: the system has PELAGIC_TEST_THREADS threads at a time for it, and refuses more.
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

namespace {

std::atomic<int>& left() {
    static std::atomic<int> threads{std::atoi(std::getenv("PELAGIC_TEST_THREADS"))};
    return threads;
}

struct Work {
    void* (*run)(void*);
    void* argument;
};

void* run_one(void* what) {
    const Work work = *static_cast<Work*>(what);
    delete static_cast<Work*>(what);
    void* const result = work.run(work.argument);
    left().fetch_add(1);
    return result;
}

}  // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                              void* argument) noexcept {
    using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
    static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
    if (left().fetch_sub(1) <= 0) {
        left().fetch_add(1);
        return EAGAIN;
    }
    return create(thread, attributes, run_one, new Work{run, argument});
}
