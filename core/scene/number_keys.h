// Numbers that change over the shot. A frame's scene has plain numbers: what comes after it knows nothing of keys, and a frame alone is
// that frame of a run.
#pragma once

#include <set>

#include "core/scene/keys.h"

namespace pelagic {

// The number at a frame: before the first key the first's, after the last the last's; between two on a straight line, or, with "smooth",
// on a C1 cubic that stays between their values and stands still at the first and the last key. Of an angle [degrees] by the shorter of
// the two ways from key to key.
double value_at(const NumberKeys& number, bool is_angle, double frame);
// How fast one that is no angle changes there, a frame; at a corner the mean of both sides.
double rate_at(const NumberKeys& number, double frame);
// What stands for all of its values where there is to be one: the largest, of angles, which have none, the first.
double standing_for(const NumberKeys& number, bool is_angle);

// The scene of a frame, without keys. Those of camera.keys stay: they are poses (core/surface/view.h).
Scene scene_at(const Scene& scene, double frame);

// For what shows one moment and isn't told which: throws std::invalid_argument, naming it, if a number of that table ("light"; "": of
// any) has keys.
void refuse_keys(const Scene& scene, std::string_view table = {});

// Why a number of this path can't have keys, as a sentence's end: ": waves keep …", or " yet" where nothing but the work is in the way.
std::string why_no_keys(std::string_view path);

// The path of the key in the table that holds it: a list's where it is an entry's.
std::string_view table_key(const KeyedNumber& number);

// Whether numbers of that table ("light") change over the shot: have keys, and not all of one value.
bool changes(const Scene& scene, std::string_view table);

// Of numbers that the sea is made of.
bool is_of_sea(const KeyedNumber& number);

// The frames at which one of them has a key.
std::set<int> frames_of_sea(const Scene& scene);

// For what has one sea for the whole shot: as refuse_keys(), of those.
void refuse_keyed_sea(const Scene& scene);

// Where all of a sea's keys give the same number: the number.
Scene without_still_keys(Scene scene);

// A shot's text without its numbers that have keys, and theirs at a frame as lines of their own: a frame's fingerprint depends on no
// other frame's values.
Scene without_keyed(Scene scene);
std::string keyed_text(const Scene& scene, KeyPartSet parts, int frame);

}  // namespace pelagic
