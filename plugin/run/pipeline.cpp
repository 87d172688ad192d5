#include "plugin/run/pipeline.h"

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace pelagic {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration time) {
    return std::chrono::duration<double>(time).count();
}

// Adds the time of its life to a sum.
class Stopwatch {
  public:
    explicit Stopwatch(double& sum_s) : sum_s_(sum_s) {}
    ~Stopwatch() { sum_s_ += seconds(Clock::now() - start_); }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

  private:
    double& sum_s_;
    Clock::time_point start_ = Clock::now();
};

class Pipeline {
  public:
    Pipeline(int items, int places, const PipelineStages& stages)
        : items_(items),
          places_(places),
          stages_(stages),
          encoders_(static_cast<std::size_t>(places)),
          encoded_(static_cast<std::size_t>(places)) {}

    PipelineTimes run() {
        const Clock::time_point start = Clock::now();
        std::thread writer([this] { write_all(); });
        try {
            compute_all();
        } catch (...) {
            end(std::current_exception());
        }
        for (tbb::task_group& encoder : encoders_) encoder.wait();
        writer.join();
        if (error_) std::rethrow_exception(error_);
        times_.wall_s = seconds(Clock::now() - start);
        return times_;
    }

  private:
    // What a place's item has come to.
    struct Encoded {
        bool done = false;
        std::exception_ptr error{};
    };

    Encoded& encoded(int item) { return encoded_[static_cast<std::size_t>(item % places_)]; }

    // The first one counts. Nothing is begun any more.
    void end(std::exception_ptr error) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::move(error);
        changed_.notify_all();
    }

    bool has_ended() {
        const std::lock_guard lock(mutex_);
        return error_ != nullptr;
    }

    void compute_all() {
        int begun = 0;
        while (begun < items_) {
            const int item = begun++;
            if (!wait_until_written(item - places_ + 1)) return;
            try {
                const Stopwatch watch(times_.compute_busy_s);
                // While it waits for the other threads' part of this item, no other item is begun on this
                // one.
                tbb::this_task_arena::isolate([&] { stages_.compute(item, item % places_); });
            } catch (...) {
                set_encoded(item, std::current_exception());
                break;
            }
            encoders_[static_cast<std::size_t>(item % places_)].run([this, item] { encode(item); });
        }
        // One after another: where there is no other thread, this one encodes them.
        for (int count = std::max(1, begun - places_ + 1); count <= begun; ++count)
            if (!wait_until_written(count)) return;
    }

    // Tells of what is written meanwhile. False when the pipeline has ended before.
    bool wait_until_written(int count) {
        std::unique_lock lock(mutex_);
        // The last of them must be encoded first: this thread helps with that, and with nothing later.
        if (written_ < count && !error_) {
            lock.unlock();
            encoders_[static_cast<std::size_t>((count - 1) % places_)].wait();
            lock.lock();
        }
        for (;;) {
            while (told_ < written_) {
                const int item = told_++;
                lock.unlock();
                if (stages_.written) stages_.written(item);
                lock.lock();
            }
            if (error_) return false;
            if (written_ >= count) return true;
            const Stopwatch watch(times_.waiting_for_write_s);
            changed_.wait(lock, [this] { return written_ > told_ || error_; });
        }
    }

    void encode(int item) {
        if (has_ended()) return;
        count_encoder(+1);
        std::exception_ptr error;
        try {
            stages_.encode(item, item % places_);
        } catch (...) {
            error = std::current_exception();
        }
        count_encoder(-1);
        set_encoded(item, std::move(error));
    }

    void count_encoder(int change) {
        const std::lock_guard lock(mutex_);
        const Clock::time_point now = Clock::now();
        if (encoding_ > 0) times_.encode_busy_s += seconds(now - encoders_changed_);
        encoders_changed_ = now;
        encoding_ += change;
    }

    void set_encoded(int item, std::exception_ptr error) {
        const std::lock_guard lock(mutex_);
        encoded(item) = {.done = true, .error = std::move(error)};
        changed_.notify_all();
    }

    void write_all() {
        for (int item = 0; item < items_; ++item) {
            std::exception_ptr error = wait_until_encoded(item);
            if (has_ended()) return;
            if (!error) {
                try {
                    const Stopwatch watch(times_.write_busy_s);
                    stages_.write(item, item % places_);
                } catch (...) {
                    error = std::current_exception();
                }
            }
            if (error) return end(std::move(error));
            const std::lock_guard lock(mutex_);
            ++written_;
            changed_.notify_all();
        }
    }

    // The item's error, or none.
    std::exception_ptr wait_until_encoded(int item) {
        std::unique_lock lock(mutex_);
        const Stopwatch watch(times_.waiting_for_encode_s);
        changed_.wait(lock, [&] { return encoded(item).done || error_; });
        encoded(item).done = false;
        return std::exchange(encoded(item).error, nullptr);
    }

    const int items_, places_;
    const PipelineStages& stages_;
    std::vector<tbb::task_group> encoders_;  // by place

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Encoded> encoded_;  // by place
    int written_ = 0;               // items
    int told_ = 0;                  // items whose end the calling thread has been told of
    int encoding_ = 0;              // items being encoded just now
    Clock::time_point encoders_changed_{};
    std::exception_ptr error_;
    PipelineTimes times_;
};

}  // namespace

PipelineTimes run_pipeline(int items, int places, const PipelineStages& stages) {
    return Pipeline(items, places, stages).run();
}

}  // namespace pelagic
