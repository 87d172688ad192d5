// A sea and its frames through the C interface, closed by themselves.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "pelagic/procedural.h"

namespace pelagic::test {

struct Close {
    void operator()(pelagic_sea* sea) const { pelagic_close(sea); }
    void operator()(pelagic_frame* frame) const { pelagic_frame_release(frame); }
};
using SeaHandle = std::unique_ptr<pelagic_sea, Close>;
using FrameHandle = std::unique_ptr<pelagic_frame, Close>;

inline SeaHandle open_text(const std::string& text, const pelagic_open_options* options = nullptr) {
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = text.data();
    source.text_length = text.size();
    pelagic_sea* sea = nullptr;
    pelagic_error error;
    EXPECT_EQ(pelagic_open(&source, options, &sea, &error), PELAGIC_OK) << error.message;
    return SeaHandle(sea);
}

inline SeaHandle open_file(const std::string& path, const pelagic_open_options* options = nullptr) {
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.path = path.c_str();
    pelagic_sea* sea = nullptr;
    pelagic_error error;
    EXPECT_EQ(pelagic_open(&source, options, &sea, &error), PELAGIC_OK) << error.message;
    return SeaHandle(sea);
}

inline FrameHandle frame_of(const SeaHandle& sea, double open_s, double close_s) {
    pelagic_frame* frame = nullptr;
    pelagic_error error;
    EXPECT_EQ(pelagic_frame_create(sea.get(), open_s, close_s, &frame, &error), PELAGIC_OK) << error.message;
    return FrameHandle(frame);
}

}  // namespace pelagic::test
