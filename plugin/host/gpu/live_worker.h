// A thread that makes something (a sea, a sky) in the background. Callers never wait. Of requests that come
// in the meantime only the latest is kept.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace pelagic {

// An exception's message, for users.
inline std::string message_of(const std::exception_ptr& error) {
    try {
        std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
        return "out of memory: lower the cascades' resolutions, or use --quality draft";
    } catch (const std::exception& known) {
        return known.what();
    } catch (...) {
        return "an error without a message; this is a mistake in the program, please report it";
    }
}

// Every member may be called from any thread.
template <class Asked, class Made>
class LiveWorker {
  public:
    using Make = std::function<std::shared_ptr<const Made>(const Asked&)>;

    // `make` runs on the worker's thread, one request at a time. Its exceptions become error().
    explicit LiveWorker(Make make) : make_(std::move(make)), thread_([this] { run(); }) {}
    // Waits for the request being made; drops one that is waiting.
    ~LiveWorker() {
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        wake_.notify_one();
        thread_.join();
    }
    LiveWorker(const LiveWorker&) = delete;
    LiveWorker& operator=(const LiveWorker&) = delete;

    void ask(Asked request) {
        {
            const std::lock_guard lock(mutex_);
            asked_ = std::move(request);
        }
        wake_.notify_one();
    }
    // The latest result, returned once; otherwise null.
    std::shared_ptr<const Made> take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(made_, nullptr);
    }
    bool is_busy() const {
        const std::lock_guard lock(mutex_);
        return making_ || asked_.has_value();
    }
    // Why the latest request failed; empty if it didn't.
    std::string error() const {
        const std::lock_guard lock(mutex_);
        return error_;
    }

  private:
    void run() {
        std::unique_lock lock(mutex_);
        for (;;) {
            wake_.wait(lock, [this] { return stopping_ || asked_.has_value(); });
            if (stopping_) return;
            const Asked request = std::move(*asked_);
            asked_.reset();
            making_ = true;
            lock.unlock();
            std::shared_ptr<const Made> made;
            std::string error;
            try {
                made = make_(request);
            } catch (...) {
                error = message_of(std::current_exception());
            }
            lock.lock();
            making_ = false;
            error_ = std::move(error);
            if (!made) continue;
            made_.swap(made);
            lock.unlock();
            made.reset();  // frees a result that nobody took, outside the lock
            lock.lock();
        }
    }

    const Make make_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::optional<Asked> asked_;
    std::shared_ptr<const Made> made_;
    std::string error_;
    bool making_ = false, stopping_ = false;
    std::thread thread_;  // declared last: it uses all members above
};

}  // namespace pelagic
