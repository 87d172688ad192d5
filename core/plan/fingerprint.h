// What a file of a bake or a picture was made of, as one number: whoever finds the number in a file knows
// that making the file again would give the same bits on this kind of CPU.
//
// It is made of the keys on which the output depends, of the part of the resolved plan that the output reads, of the
// output's revision, and, for a frame, of its number and of the camera's pose where that shapes it. It is not made of
// anything else: not of the range of frames, of other outputs or of the program's version.
#pragma once

#include <string>
#include <string_view>

#include "core/base/hash.h"
#include "core/plan/plan.h"
#include "core/surface/view.h"

namespace pelagic {

// 16 hexadecimal digits, the hash of texts added one after another (core/base/hash.h).
class Fingerprint {
  public:
    Fingerprint& add(std::string_view text);
    std::string text() const { return hash_.text(); }

  private:
    ByteHash hash_;
};

// Of an output, for all frames alike.
std::string output_fingerprint(const Plan& plan, const PlannedOutput& output);
// Of its file of one frame; `whole` is the output's own. A sky's is its part's (plugin/bake/sky_part.cpp): of its frame's light, and no other's.
std::string frame_fingerprint(const Plan& plan, const PlannedOutput& output, const std::string& whole,
                              int frame);

// The part of a plan that decides a query's answers, exact: two plans with the same text give the same bits at the
// same points. The levels of a view's footprints are not in it: they are the same in every plan that has them.
std::string plan_text(const Plan& plan, int query);

// What a plan of a shot with weather has of all its keys: a key that changes none of it changes no other frames. Empty without.
// `by_extent`: whether the query's points depend on how far the sea goes.
std::string weather_plan_text(const Plan& plan, bool by_extent);
// And what a query's answers at a time have of the keys round it, the past of its foam included. Empty without.
std::string weather_time_text(const Plan& plan, int query, double t_s);

// A pose, exact.
std::string pose_text(const View& view);

}  // namespace pelagic
