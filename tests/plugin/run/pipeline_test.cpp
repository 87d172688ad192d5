// Stages side by side: every item passes them in order, in a place that is its own meanwhile, whatever the
// stages' speeds, and an error in any of them ends all without hanging and without losing what came before.
#include "plugin/run/pipeline.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace pelagic;
using std::chrono::microseconds;

constexpr int kPlaces = 3;

enum class Stage { Compute, Encode, Write };
constexpr const char* kStageNames[] = {"compute", "encode", "write"};

struct Failure : std::runtime_error {
    explicit Failure(int failed) : std::runtime_error(std::to_string(failed)), item(failed) {}
    int item;
};

// Items that know what has been done to them, and stages that take random times and may throw.
class Factory {
  public:
    Factory(int items, unsigned seed) : items_(items), random_(seed) {
        for (int i = 0; i < 3 * items; ++i)
            delays_.push_back(microseconds(std::uniform_int_distribution<int>(0, 3000)(random_)));
    }
    void fail(Stage stage, int item) { failures_.emplace_back(stage, item); }
    void run() {
        PipelineStages stages;
        stages.compute = [&](int item, int place) {
            EXPECT_EQ(std::this_thread::get_id(), caller_);
            EXPECT_EQ(computed++, item);
            EXPECT_EQ(holds_[place].exchange(item), -1) << "place " << place << " was not free";
            // Work for all threads, in which no other item's may be begun on this one.
            tbb::parallel_for(0, 8, [&](int) { work(Stage::Compute, item, 8); });
            throw_if_told(Stage::Compute, item);
            state_[place] = 1;
        };
        stages.encode = [&](int item, int place) {
            EXPECT_EQ(holds_[place], item);
            EXPECT_EQ(state_[place], 1) << "not computed yet";
            work(Stage::Encode, item, 1);
            throw_if_told(Stage::Encode, item);
            state_[place] = 2;
        };
        stages.write = [&](int item, int place) {
            EXPECT_NE(std::this_thread::get_id(), caller_);
            EXPECT_EQ(holds_[place], item);
            EXPECT_EQ(state_[place], 2) << "not encoded yet";
            work(Stage::Write, item, 1);
            throw_if_told(Stage::Write, item);
            EXPECT_EQ(written++, item) << "out of order";
            state_[place] = 0;
            holds_[place] = -1;
        };
        stages.written = [&](int item) {
            EXPECT_EQ(std::this_thread::get_id(), caller_);
            EXPECT_EQ(told++, item);
            EXPECT_LT(item, written) << "told of before it was written";
            if (item == tell_fails_at) throw Failure(item);
        };
        times = run_pipeline(items_, kPlaces, stages);
    }

    int computed = 0, told = 0, tell_fails_at = -1;
    std::atomic<int> written{0};
    PipelineTimes times;

  private:
    void work(Stage stage, int item, int parts) const {
        std::this_thread::sleep_for(delays_[static_cast<std::size_t>(3 * item + static_cast<int>(stage))] /
                                    parts);
    }
    void throw_if_told(Stage stage, int item) const {
        for (const auto& [failing, at] : failures_)
            if (failing == stage && at == item) throw Failure(item);
    }

    int items_;
    std::mt19937 random_;
    std::vector<microseconds> delays_;
    std::vector<std::pair<Stage, int>> failures_;
    std::thread::id caller_ = std::this_thread::get_id();
    std::atomic<int> holds_[kPlaces] = {-1, -1, -1};
    std::atomic<int> state_[kPlaces] = {0, 0, 0};
};

TEST(Pipeline, EveryItemPassesEveryStageInOrderInAPlaceOfItsOwn) {
    for (const int threads : {1, 2, 4})
        for (unsigned seed = 0; seed < 4; ++seed) {
            SCOPED_TRACE(std::to_string(threads) + " threads, seed " + std::to_string(seed));
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            tbb::task_arena(threads).execute([&] {
                Factory factory(40, seed);
                factory.run();
                EXPECT_EQ(factory.computed, 40);
                EXPECT_EQ(factory.written, 40);
                EXPECT_EQ(factory.told, 40);
            });
        }
}

TEST(Pipeline, NothingToDoAndLessThanThePlacesAreFine) {
    for (const int items : {0, 1, 2}) {
        Factory factory(items, 1);
        factory.run();
        EXPECT_EQ(factory.told, items);
    }
}

TEST(Pipeline, AnErrorInAnyStageComesOutWhenAllBeforeItIsWrittenAndNothingBehind) {
    for (const Stage stage : {Stage::Compute, Stage::Encode, Stage::Write})
        for (const int item : {0, 1, 7, 18, 19})
            for (unsigned seed = 0; seed < 3; ++seed) {
                SCOPED_TRACE(std::string(kStageNames[static_cast<int>(stage)]) + " of " +
                             std::to_string(item) + ", seed " + std::to_string(seed));
                Factory factory(20, seed);
                factory.fail(stage, item);
                try {
                    factory.run();
                    ADD_FAILURE() << "no error";
                } catch (const Failure& failure) {
                    EXPECT_EQ(failure.item, item);
                }
                EXPECT_EQ(factory.written, item);
                EXPECT_EQ(factory.told, item) << "what is written is told of";
                EXPECT_LE(factory.computed, std::min(item + kPlaces, 20));
            }
}

TEST(Pipeline, OfSeveralErrorsTheLowestItemsComesOut) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        Factory factory(20, seed);
        factory.fail(Stage::Compute, 8);
        factory.fail(Stage::Encode, 7);
        factory.fail(Stage::Write, 6);
        try {
            factory.run();
            ADD_FAILURE() << "no error";
        } catch (const Failure& failure) {
            EXPECT_EQ(failure.item, 6);
        }
        EXPECT_EQ(factory.written, 6);
    }
}

TEST(Pipeline, AnErrorOfWhoIsToldEndsIt) {
    Factory factory(20, 5);
    factory.tell_fails_at = 4;
    EXPECT_THROW(factory.run(), Failure);
    EXPECT_GE(factory.written, 5);
    EXPECT_LE(factory.written, 5 + kPlaces) << "nothing more is begun";
}

// Where no other thread takes an encoding, the caller must get to each: also to the last ones, and to those
// before one that throws.
TEST(Pipeline, OneThreadFinishesEveryItem) {
    for (int items = 0; items <= 2 * kPlaces + 1; ++items)
        for (int failing = -1; failing < items; ++failing) {
            std::vector<int> written;
            const PipelineStages stages{.compute =
                                            [&](int item, int) {
                                                if (item == failing) throw std::runtime_error("no");
                                            },
                                        .encode = [](int, int) {},
                                        .write = [&](int item, int) { written.push_back(item); }};
            tbb::task_arena(1).execute([&] {
                // One thread in the whole process: the arena alone would still be given a second one to wait
                // on.
                const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
                if (failing < 0)
                    run_pipeline(items, kPlaces, stages);
                else
                    EXPECT_THROW(run_pipeline(items, kPlaces, stages), std::runtime_error);
            });
            EXPECT_EQ(written.size(), static_cast<std::size_t>(failing < 0 ? items : failing));
        }
}

// Three stages of sleep, which need no core: together they take as long as the slowest, not as the sum.
TEST(Pipeline, StagesOverlapAndTheTimesSaySo) {
    using std::chrono::milliseconds;
    const auto sleep = [](int ms) {
        return [ms](int, int) { std::this_thread::sleep_for(milliseconds(ms)); };
    };
    PipelineTimes times;
    tbb::task_arena(2).execute([&] {
        times = run_pipeline(20, kPlaces, {.compute = sleep(4), .encode = sleep(4), .write = sleep(12)});
    });
    // The sum of all is 400 ms, the slowest stage alone 240; the first item's other stages come before it.
    // Sleeps are never shorter than asked.
    EXPECT_GE(times.wall_s, 0.248);
    EXPECT_LT(times.wall_s, times.compute_busy_s + times.encode_busy_s + times.write_busy_s);
    EXPECT_GE(times.write_busy_s, 0.240);
    EXPECT_GE(times.compute_busy_s, 0.080);
    EXPECT_GE(times.encode_busy_s, 0.040);  // on two threads; two at once count once
    EXPECT_LE(times.write_busy_s, times.wall_s);
    EXPECT_GT(times.waiting_for_write_s, times.waiting_for_encode_s) << "the slowest is waited for";

    tbb::task_arena(2).execute([&] {
        times = run_pipeline(20, kPlaces, {.compute = sleep(12), .encode = sleep(4), .write = sleep(4)});
    });
    EXPECT_GT(times.waiting_for_encode_s, times.waiting_for_write_s);
}

}  // namespace
