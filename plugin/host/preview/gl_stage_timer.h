// GPU time of each stage of a frame, read without waiting.
#pragma once

#include <array>

#include "plugin/host/preview/gl_objects.h"

namespace pelagic {

class GlStageTimer {
    static constexpr std::size_t kFramesBehind = 4;
    struct Slot {
        GlQuery query;
        bool pending = false;
    };
    struct Row {
        std::array<Slot, kFramesBehind> slots;
        std::size_t next = 0;
        double latest_ms = 0.0;
    };

  public:
    enum Stage { Upload, Sea, Sky, Show };
    static constexpr int kStages = 4;

    // Measures a stage during its lifetime; stages don't overlap. If all of the stage's queries are in
    // flight, the measurement is skipped.
    class Measured {
      public:
        Measured(GlStageTimer& timer, Stage stage) {
            Row& row = timer.rows_[stage];
            collect(row);
            Slot& slot = row.slots[row.next];
            if (slot.pending) return;
            running_ = &slot;
            row.next = (row.next + 1) % kFramesBehind;
            glBeginQuery(GL_TIME_ELAPSED, slot.query.name());
        }
        ~Measured() {
            if (!running_) return;
            glEndQuery(GL_TIME_ELAPSED);
            running_->pending = true;
        }
        Measured(const Measured&) = delete;
        Measured& operator=(const Measured&) = delete;

      private:
        Slot* running_ = nullptr;
    };
    double milliseconds(Stage stage) const { return rows_[stage].latest_ms; }

  private:
    static void collect(Row& row) {
        for (std::size_t i = 0; i < kFramesBehind; ++i) {  // oldest first
            Slot& slot = row.slots[(row.next + i) % kFramesBehind];
            if (!slot.pending) continue;
            GLint there = GL_FALSE;
            glGetQueryObjectiv(slot.query.name(), GL_QUERY_RESULT_AVAILABLE, &there);
            if (there != GL_TRUE) return;
            GLuint64 nanoseconds = 0;
            glGetQueryObjectui64v(slot.query.name(), GL_QUERY_RESULT, &nanoseconds);
            row.latest_ms = static_cast<double>(nanoseconds) * 1e-6;
            slot.pending = false;
        }
    }

    std::array<Row, kStages> rows_;
};

}  // namespace pelagic
