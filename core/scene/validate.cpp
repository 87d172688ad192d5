// Whether the values of a Scene make sense: each alone, by the table of keys, then what they mean together.
// See validate.h.
#include "core/scene/validate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <map>
#include <set>
#include <utility>

#include "core/base/constants.h"
#include "core/scene/cascade_bands.h"
#include "core/scene/course.h"
#include "core/scene/editions.h"
#include "core/scene/keys.h"
#include "core/scene/lens.h"
#include "core/scene/limits.h"
#include "core/scene/names.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"

namespace pelagic {

namespace {

std::string indexed(const std::string& key, std::size_t index) {
    return key + '[' + std::to_string(index) + ']';
}

std::string vector_text(const glm::dvec3& v) {
    return '[' + number_text(v.x) + ", " + number_text(v.y) + ", " + number_text(v.z) + ']';
}

template <class Choice>
std::string choice_text(Choice choice) {
    return quoted_text(word_of(choice));
}

class SceneChecker {
  public:
    void refuse(Problem problem) {
        refused_.insert(problem.key);
        problems_.push_back(std::move(problem));
    }

    // Whether no problem with this key's value has been found yet.
    bool is_good(const std::string& key) const { return !refused_.contains(key); }

    // In the order of the shot file's tables.
    std::vector<Problem> take() {
        const auto table_of = [](const Problem& problem) {
            const std::span<const KeyTable> tables = key_tables();
            const std::string name = problem.key.substr(0, problem.key.find_first_of(".["));
            return std::find_if(tables.begin(), tables.end(),
                                [&](const KeyTable& table) { return table.name == name; }) -
                   tables.begin();
        };
        std::stable_sort(problems_.begin(), problems_.end(),
                         [&](const Problem& a, const Problem& b) { return table_of(a) < table_of(b); });
        return std::move(problems_);
    }

  private:
    std::set<std::string> refused_;
    std::vector<Problem> problems_;
};

// ---- Each value alone

bool is_in_range(const Key& key, double value) {
    return !key.range || key.range->holds(value) || (key.may_be_infinite && std::isinf(value) && value > 0.0);
}

// The accepted range of a number; for lists of numbers, all that the key accepts.
std::string range_text(const Key& key) {
    if (key.type != KeyType::Number && key.type != KeyType::Integer) return key.accepted;
    return text_of(*key.range) + (key.may_be_infinite ? ", or inf" : "");
}

struct Place {
    const Key& key;
    std::string path;
};

void check_value(SceneChecker& check, const Place& at, const KeyValue& value);

struct ValueCheck {
    SceneChecker& check;
    const Place& at;

    void refuse(const KeyValue& value, const char* problem) const {
        check.refuse({at.path, value_text(at.key, value), problem, range_text(at.key)});
    }

    void operator()(std::monostate) const {}
    void operator()(bool) const {}
    void operator()(std::int64_t value) const {
        if (!is_in_range(at.key, static_cast<double>(value))) refuse(value, "is outside the range");
    }
    void operator()(double value) const {
        if (!is_in_range(at.key, value))
            refuse(value, std::isnan(value) ? "is not a number" : "is outside the range");
    }
    void operator()(const std::string&) const {}
    void operator()(const NumberKeys& number) const {
        for (std::size_t i = 0; i < number.keys.size(); ++i) {
            const auto& [frame, value] = number.keys[i];
            const std::string path = indexed(at.path + ".keys", i);
            const auto refuse_key = [&](const std::string& problem, const std::string& accepted) {
                check.refuse(
                    {path, '[' + std::to_string(frame) + ", " + number_text(value) + ']', problem, accepted});
            };
            if (!is_in_range(at.key, value))
                refuse_key(std::isnan(value) ? "is not a number" : "is outside the range",
                           range_text(at.key));
            else if (!limits::kFrame.holds(frame))
                refuse_key("is at a frame outside the range", text_of(limits::kFrame));
            else if (i > 0 && frame <= number.keys[i - 1].frame)
                refuse_key("does not come after the key before, of frame " +
                               std::to_string(number.keys[i - 1].frame),
                           "rising frames, each once");
        }
    }
    template <class Number>
    void operator()(const std::vector<Number>& list) const {
        const auto is_good = [&](Number value) { return is_in_range(at.key, static_cast<double>(value)); };
        if (!std::all_of(list.begin(), list.end(), is_good)) refuse(list, "is outside the range");
    }
    void operator()(const std::vector<std::string>& list) const {
        for (std::size_t i = 0; i < list.size(); ++i) {
            const auto here = list.begin() + static_cast<std::ptrdiff_t>(i);
            if (std::find(list.begin(), here, *here) != here)
                check.refuse(
                    {indexed(at.path, i), quoted_text(*here), "is in the list twice", "each word once"});
        }
    }
    void operator()(const std::vector<KeyEntry>& list) const {
        if (list.size() > at.key.most_entries) {
            check.refuse({at.path, std::to_string(list.size()) + " entries", "is too many",
                          "at most " + std::to_string(at.key.most_entries)});
            return;
        }
        for (std::size_t i = 0; i < list.size(); ++i)
            for (std::size_t k = 0; k < list[i].values.size(); ++k) {
                const Key& inner = at.key.entry_keys[k];
                check_value(check, {inner, indexed(at.path, i) + '.' + inner.name}, list[i].values[k].second);
            }
    }
};

void check_value(SceneChecker& check, const Place& at, const KeyValue& value) {
    std::visit(ValueCheck{check, at}, value);
}

void check_each_value(SceneChecker& check, const Scene& scene) {
    for (const Key& key : keys()) check_value(check, {key, key.path}, value_of(scene, key));
}

// ---- What ranges can't express, and what the values mean together

void check_shot(SceneChecker& check, const Shot& shot) {
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-';
    };
    constexpr const char* kNameRule = "letters, digits, _ and -, at least one and at most 200 of them";
    if (shot.name.empty()) {
        check.refuse({"shot.name", quoted_text(shot.name), "is empty", kNameRule});
    } else if (const auto bad = std::find_if_not(shot.name.begin(), shot.name.end(), allowed);
               bad != shot.name.end()) {
        check.refuse({"shot.name", quoted_text(shot.name),
                      "is no file name for every system: it has " +
                          quoted_text(first_character(std::string_view(bad, shot.name.end()))) + " in it",
                      kNameRule});
    } else if (shot.name.size() > static_cast<std::size_t>(limits::kNameLength)) {
        check.refuse({"shot.name", quoted_text(shot.name), "is too long for a file name", kNameRule});
    }

    if (check.is_good("shot.frames") && shot.last_frame < shot.first_frame) {
        const std::string frames =
            '[' + std::to_string(shot.first_frame) + ", " + std::to_string(shot.last_frame) + ']';
        check.refuse(
            {"shot.frames", frames, "runs backwards", "[first, last] with first ≤ last, both included"});
    }

    const auto largest_seed = static_cast<std::uint64_t>(key_of("shot.seed").largest);
    if (shot.seed > largest_seed) {
        check.refuse({"shot.seed", std::to_string(shot.seed), "is outside the range",
                      "0 … " + std::to_string(largest_seed)});
    }
    if (check.is_good("shot.loop_s") && check.is_good("shot.fps") && shot.loop_s > 0.0) {
        const double frames_a_loop = shot.loop_s * shot.fps;
        const double whole = std::max(1.0, std::round(frames_a_loop));
        if (!(std::abs(frames_a_loop - whole) <= limits::kLoopTolerance_frames)) {
            check.refuse({"shot.loop_s", number_text(shot.loop_s),
                          "is " + number_text(std::round(frames_a_loop * 1e6) / 1e6) + " frames at " +
                              number_text(shot.fps) + " a second, so that no frame closes the loop",
                          "a whole number of frames (to " + number_text(limits::kLoopTolerance_frames) +
                              " of one); nearest: " + number_text(whole / shot.fps)});
        }
    }
    if (!check.is_good("shot.time_scale")) return;
    if (check.is_good("shot.loop_s") && shot.loop_s > 0.0 && shot.time_scale > 0.0 &&
        shot.time_scale < limits::kSlowestLoopScale) {
        check.refuse({"shot.time_scale", number_text(shot.time_scale), "is too slow for a loop",
                      "0, numbers from " + number_text(limits::kSlowestLoopScale) +
                          " up, or any together with shot.loop_s = 0"});
    }
    if (check.is_good("shot.frames") && check.is_good("shot.fps") && check.is_good("shot.time_offset_s")) {
        for (const int frame : {shot.first_frame, shot.last_frame}) {
            if (limits::kTime_s.holds(shot.time_s(frame))) continue;
            check.refuse(
                {"shot.time_scale", number_text(shot.time_scale),
                 "makes it " + number_text(shot.time_s(frame)) + " s at frame " + std::to_string(frame),
                 "a sea's time of " + text_of(limits::kTime_s) + " s"});
            break;
        }
    }
}

void check_measured(SceneChecker& check, const MeasuredSpectrum& measured) {
    const std::string key = "sea.spectrum_file";
    const std::string value = quoted_text(measured.station + " at " + measured.time);
    if (measured.bins.size() < 2) {
        check.refuse({key, value, "has fewer than two frequencies", "at least two with a density"});
    }
    for (std::size_t i = 0; i < measured.bins.size(); ++i) {
        const MeasuredSpectrum::Bin& bin = measured.bins[i];
        const std::string here = "bin " + std::to_string(i) + " at " + number_text(bin.frequency_hz) + " Hz ";
        if (!limits::kMeasuredFrequency_hz.holds(bin.frequency_hz)) {
            check.refuse(
                {key, value, here + "is outside the range", text_of(limits::kMeasuredFrequency_hz) + " Hz"});
        } else if (i > 0 && !(bin.frequency_hz > measured.bins[i - 1].frequency_hz)) {
            check.refuse({key, value, here + "is not above the one before", "rising frequencies"});
        }
        if (!std::isfinite(bin.density_m2_per_hz) || bin.density_m2_per_hz < 0.0) {
            check.refuse({key, value, here + "has the density " + number_text(bin.density_m2_per_hz),
                          "a finite density ≥ 0"});
        }
        // Fourier coefficients of a density with integral 1 lie in the unit circle; 1e-9 is for their
        // rounding.
        constexpr double kUnitCircle = 1.0 + 1e-9;
        if (bin.has_direction && (!(std::hypot(bin.c1_re, bin.c1_im) <= kUnitCircle) ||
                                  !(std::hypot(bin.c2_re, bin.c2_im) <= kUnitCircle))) {
            check.refuse({key, value, here + "has a directional coefficient beyond 1", "r1 and r2 of 0 … 1"});
        }
    }
}

void check_sea(SceneChecker& check, const SeaState& sea) {
    const bool wants_file = sea.spectrum == SpectrumKind::File;
    if (wants_file && !sea.measured) {
        check.refuse({"sea.spectrum", choice_text(sea.spectrum), "comes without a measured spectrum",
                      "\"file\" together with spectrum_file and spectrum_time, or one of the other spectra"});
    } else if (!wants_file && sea.measured) {
        check.refuse({"sea.spectrum", choice_text(sea.spectrum), "leaves a measured spectrum unused",
                      "\"file\" with a measured spectrum, or no measured spectrum"});
    }
    if (sea.measured) check_measured(check, *sea.measured);
}

// Bands must reach each other: the edge between two cascades depends on sizes alone, and the larger one's
// grid has to hold everything below it.
void check_bands(SceneChecker& check, const std::vector<CascadeSize>& cascades) {
    std::vector<double> sizes_m;
    for (const CascadeSize& cascade : cascades) sizes_m.push_back(cascade.size_m);
    const std::vector<double> edges = lower_edges(sizes_m);
    for (std::size_t i = 0; i + 1 < cascades.size(); ++i) {
        const int sufficient = sufficient_resolution(sizes_m[i], edges[i + 1]);
        if (cascades[i].resolution >= sufficient) continue;
        const std::string problem = "leaves a gap up to the waves that the tile of " +
                                    number_text(sizes_m[i + 1]) + " m begins with (" +
                                    number_text(sizes_m[i + 1] / kBandModes) + " m long)";
        const std::string value = std::to_string(cascades[i].resolution);
        const std::string key = indexed("waves.cascades", i) + ".resolution";
        if (sufficient <= kMaxCascadeResolution) {
            check.refuse({key, value, problem, "even, at least " + std::to_string(sufficient)});
        } else {
            check.refuse(
                {key, value, problem,
                 "no grid reaches that far (" + std::to_string(sufficient) +
                     " would be needed): put a cascade between, of about " +
                     number_text(std::round(std::sqrt(sizes_m[i] * sizes_m[i + 1]) * 100.0) / 100.0) + " m"});
        }
    }
}

void check_trains(SceneChecker& check, const Waves& waves) {
    const bool all_good = check.is_good("waves.shortest_m") && check.is_good("waves.longest_m");
    if (all_good && waves.shortest_m && waves.longest_m && !(*waves.shortest_m < *waves.longest_m)) {
        check.refuse({"waves.shortest_m", number_text(*waves.shortest_m),
                      "is not shorter than longest_m, " + number_text(*waves.longest_m),
                      "a shortest train below the longest"});
    }
    if (!all_good || !waves.shortest_m || waves.cascades.empty()) return;
    // The cascades take over where the trains end: without a gap, and with something left to carry.
    const CascadeSize &largest = waves.cascades.front(), &finest = waves.cascades.back();
    const double longest_wave_m = largest.size_m / kBandModes;
    const double finest_wave_m = 2.0 * finest.size_m / std::max(finest.resolution, 1);
    if (*waves.shortest_m > longest_wave_m)
        check.refuse(
            {"waves.shortest_m", number_text(*waves.shortest_m),
             "leaves out waves: the largest cascade begins at " + number_text(longest_wave_m) + " m",
             "at most " + number_text(longest_wave_m) + " m, an eighth of the tile, or a larger tile"});
    else if (!(*waves.shortest_m > finest_wave_m))
        check.refuse({"waves.shortest_m", number_text(*waves.shortest_m),
                      "leaves the cascades no waves: theirs end at " + number_text(finest_wave_m) + " m",
                      "more than " + number_text(finest_wave_m) + " m, or finer cascades"});
}

void check_no_trains(SceneChecker& check, const Waves& waves, int edition) {
    const auto refuse = [&](const char* key, std::string value) {
        if (!check.is_good(key)) return;
        check.refuse({key, std::move(value), "speaks of wave trains, and the model has none",
                      "model = \"trochoid\", or a file without this key"});
    };
    if (waves.trains != Waves{}.trains && waves.trains != scene_of_edition(edition).waves.trains)
        refuse("waves.trains", std::to_string(waves.trains));
    if (waves.shortest_m) refuse("waves.shortest_m", number_text(*waves.shortest_m));
    if (waves.longest_m) refuse("waves.longest_m", number_text(*waves.longest_m));
}

void check_waves(SceneChecker& check, const Waves& waves, int edition) {
    if (waves.model == WaveModel::Trochoid) {
        check_trains(check, waves);
    } else {
        check_no_trains(check, waves, edition);
    }
    for (std::size_t i = 0; i < waves.band_gains.size(); ++i) {
        const BandGain& band = waves.band_gains[i];
        const std::string key = indexed("waves.band_gains", i);
        if (check.is_good(key + ".from_m") && check.is_good(key + ".to_m") && band.from_m == band.to_m)
            check.refuse({key + ".to_m", number_text(band.to_m), "is from_m as well: the band has no width",
                          "another wavelength"});
    }
    if (!check.is_good("waves.cascades")) return;
    bool all_good = true;
    for (std::size_t i = 0; i < waves.cascades.size(); ++i) {
        const CascadeSize& cascade = waves.cascades[i];
        const std::string key = indexed("waves.cascades", i);
        if (check.is_good(key + ".resolution") && cascade.resolution % 2 != 0)
            check.refuse({key + ".resolution", std::to_string(cascade.resolution),
                          "is no grid for a transform",
                          "an even number, " + text_of(limits::kCascadeResolution)});
        if (cascade.choppiness && waves.model != WaveModel::Fft && check.is_good(key + ".choppiness"))
            check.refuse({key + ".choppiness", number_text(*cascade.choppiness),
                          "is of one cascade's waves, and with wave trains all waves have waves.choppiness",
                          "model = \"fft\", or an entry without this key"});
        all_good = check.is_good(key + ".size_m") && check.is_good(key + ".resolution") && all_good;
        if (i > 0 && !(cascade.size_m < waves.cascades[i - 1].size_m)) {
            const bool same = cascade.size_m == waves.cascades[i - 1].size_m;
            check.refuse({key + ".size_m", number_text(cascade.size_m),
                          same ? "is the size of another cascade, and two tiles cannot share a band"
                               : "is not smaller than the one before",
                          "sizes that all differ, the largest first"});
            all_good = false;
        }
    }
    if (all_good) check_bands(check, waves.cascades);
}

// The least distance from the origin to the segment from a to b.
double distance_to_origin(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 along = b - a;
    const double length2 = glm::dot(along, along);
    const double s = length2 > 0.0 ? std::clamp(-glm::dot(a, along) / length2, 0.0, 1.0) : 0.0;
    return glm::length(a + s * along);
}

constexpr const char* kOffTarget = "a target at least 1e-6 m away from the camera's position";

void check_lens(SceneChecker& check, const Camera& camera) {
    bool is_good = true;
    for (const char* key : {"camera.focal_length_mm", "camera.sensor_width_mm", "camera.fov_deg"})
        is_good = is_good && check.is_good(key);
    if (is_good && camera.focal_length_mm && !limits::kFov_deg.holds(lens_fov_deg(camera))) {
        check.refuse({"camera.focal_length_mm", number_text(*camera.focal_length_mm),
                      "sees " + number_text(lens_fov_deg(camera)) + " degrees of a sensor_width_mm of " +
                          number_text(camera.sensor_width_mm),
                      "an angle of view of " + text_of(limits::kFov_deg) + " degrees"});
        is_good = false;
    }
    if (!check.is_good("camera.f_stop") || camera.f_stop == 0.0) return;
    if (camera.f_stop < limits::kLeastFStop) {
        check.refuse({"camera.f_stop", number_text(camera.f_stop), "is wider than any lens in air",
                      key_of("camera.f_stop").accepted});
        return;
    }
    if (!is_good || !check.is_good("camera.focus_distance_m")) return;
    double narrowest_deg = lens_fov_deg(camera);
    for (const CameraKey& key : camera.keys)
        if (key.fov_deg && limits::kFov_deg.holds(*key.fov_deg))
            narrowest_deg = std::min(narrowest_deg, *key.fov_deg);
    const double longest_m = focal_length_m(camera, std::tan(narrowest_deg * (kPi / 360.0)));
    if (camera.focus_distance_m > longest_m) return;
    check.refuse({"camera.focus_distance_m", number_text(camera.focus_distance_m),
                  "is nearer than a lens of a focal length of " + number_text(longest_m) + " m can be sharp",
                  "more than that"});
}

void check_camera(SceneChecker& check, const Camera& camera) {
    check_lens(check, camera);
    // With keys, the camera's own two points are not used.
    if (check.is_good("camera.position_m") && check.is_good("camera.look_at_m") && camera.keys.empty() &&
        glm::distance(camera.position_m, camera.look_at_m) < limits::kOnTarget_m) {
        check.refuse({"camera.look_at_m", vector_text(camera.look_at_m),
                      "is where the camera itself is, so that it looks nowhere", kOffTarget});
    }
    bool previous_is_good = false;
    for (std::size_t i = 0; i < camera.keys.size(); ++i) {
        const CameraKey& here = camera.keys[i];
        const std::string key = indexed("camera.keys", i);
        bool good = check.is_good(key + ".position_m") && check.is_good(key + ".look_at_m");
        if (good && glm::distance(here.position_m, here.look_at_m) < limits::kOnTarget_m) {
            check.refuse({key + ".look_at_m", vector_text(here.look_at_m),
                          "is where the camera itself is, so that it looks nowhere", kOffTarget});
            good = false;
        }
        if (i > 0) {
            const CameraKey& before = camera.keys[i - 1];
            if (here.frame <= before.frame) {
                check.refuse({key + ".frame", std::to_string(here.frame),
                              "does not come after the key before, of frame " + std::to_string(before.frame),
                              "rising frames, each once"});
            }
            if (good && previous_is_good &&
                distance_to_origin(before.look_at_m - before.position_m, here.look_at_m - here.position_m) <
                    limits::kOnTarget_m) {
                check.refuse({key + ".look_at_m", vector_text(here.look_at_m),
                              "makes the camera pass through its own target on the way from the key before",
                              "a way that keeps them apart: add a key between"});
            }
        }
        previous_is_good = good;
    }
}

void check_near_far(SceneChecker& check, const Scene& scene) {
    if (scene.surface.kind != SurfaceKind::NearFar || !check.is_good("surface.resolution")) return;
    if (scene.surface.resolution <= limits::kNearFarResolution) return;
    check.refuse({"surface.resolution", std::to_string(scene.surface.resolution),
                  "makes more corners of faces than files can count, with surface.kind = \"near-far\"",
                  "1 … " + std::to_string(limits::kNearFarResolution)});
}

// A planet's points rest about the origin (azimuthal equidistant projection). The camera may see no farther from
// there than a quarter of the circle, where the projection stretches waves by half.
void check_planet(SceneChecker& check, const Scene& scene) {
    if (scene.surface.kind != SurfaceKind::Planet) return;
    if (!scene.surface.earth_curvature)
        check.refuse({"surface.earth_curvature", "false", "leaves no sphere, and surface.kind is a planet",
                      "true, or kind = \"projected-grid\""});
    const auto check_place = [&](const std::string& key, const glm::dvec3& place_m) {
        if (!check.is_good(key)) return;
        const glm::dvec3 from_centre_m = place_m + glm::dvec3(0.0, 0.0, kEarthRadius_m);
        const double to_horizon = std::acos(std::min(kEarthRadius_m / glm::length(from_centre_m), 1.0));
        const double to_nadir = std::atan2(std::hypot(place_m.x, place_m.y), from_centre_m.z);
        if (to_nadir + to_horizon <= 0.5 * kPi) return;
        check.refuse({key, vector_text(place_m),
                      "sees a planet farther from the origin than a quarter of its circle",
                      "a place nearer to the origin, or lower; the planet's centre is " +
                          number_text(kEarthRadius_m) + " m below it"});
    };
    if (scene.camera.keys.empty()) check_place("camera.position_m", scene.camera.position_m);
    for (std::size_t i = 0; i < scene.camera.keys.size(); ++i)
        check_place(indexed("camera.keys", i) + ".position_m", scene.camera.keys[i].position_m);
}

void check_budget(SceneChecker& check, const Quality& quality) {
    if (quality.max_error && quality.frame_ms)
        check.refuse({"quality.frame_ms", number_text(*quality.frame_ms),
                      "is a second budget beside quality.max_error", "one of the two"});
}

// Each corner of a face becomes a square of quads. Their corners are counted with an int.
void check_refined(SceneChecker& check, const Surface& surface) {
    if (surface.cage_level.is_adaptive || !check.is_good("surface.cage_level")) return;
    constexpr double kMostQuads = 1 << 28;
    const double corners = static_cast<double>(surface.cage->mesh().indices.size());
    const double quads = corners * std::exp2(2.0 * (surface.cage_level.splits - 1));
    if (quads <= kMostQuads) return;
    const double most = std::floor(0.5 * std::log2(kMostQuads / corners)) + 1.0;
    check.refuse({"surface.cage_level", std::to_string(surface.cage_level.splits),
                  "makes " + number_text(quads) + " quads of a cage of " +
                      std::to_string(surface.cage->mesh().face_counts.size()) + " faces",
                  "0 … " + number_text(most) + ", or \"adaptive\""});
}

void check_cage(SceneChecker& check, const Surface& surface) {
    if (!check.is_good("surface.kind")) return;
    const bool wants_cage = surface.kind == SurfaceKind::Cage;
    if (wants_cage && !surface.cage) {
        check.refuse({"surface.kind", choice_text(surface.kind), "comes without a cage",
                      "\"cage\" together with cage_file, or one of the other kinds"});
    } else if (wants_cage) {
        check_refined(check, surface);
    } else if (surface.cage) {
        check.refuse({"surface.kind", choice_text(surface.kind), "leaves a cage unused",
                      "\"cage\" with a cage, or no cage"});
    }
}

void check_pictures(SceneChecker& check, const Scene& scene) {
    for (const Key* key : picture_keys(scene)) {
        const std::string path = std::get<std::string>(value_of(scene, *key));
        if (!has_ending(path, ".exr") && !(key->may_be_mesh && has_ending(path, ".obj")))
            check.refuse({key->path, quoted_text(path),
                          "is neither " + value_text(*key, key->fallback) + " nor a picture", key->accepted});
    }
    for (const Key& key : keys()) {
        if (key.of_picture.empty() || value_of(scene, key) == key.fallback || !check.is_good(key.path))
            continue;
        const Key& picture = key_of(key.of_picture);
        const KeyValue& given = value_of(scene, picture);
        const bool is_mesh = has_ending(std::get<std::string>(given), ".obj");
        if (given != picture.fallback && (key.may_be_mesh || !is_mesh)) continue;
        check.refuse({key.path, value_text(key, value_of(scene, key)),
                      "is of a picture, and " + picture.path + " is " + value_text(picture, given),
                      value_text(key, key.fallback) + ", or " + picture.path +
                          (key.may_be_mesh ? " = \"PATH.exr\" or \"PATH.obj\"" : " = \"PATH.exr\"")});
    }
}

void check_water(SceneChecker& check, const Scene& scene) {
    const Water& water = scene.water;
    const Key& key = key_of("water.chlorophyll_mg_m3");
    if (water.type <= WaterType::Turbid || !check.is_good(key.path)) return;
    if (value_of(scene, key) == key.fallback) return;
    check.refuse(
        {key.path, value_text(key, value_of(scene, key)),
         "is plankton beside that of water.type = " + choice_text(water.type),
         number_text(Water{}.chlorophyll_mg_m3) + ", or water.type = \"ocean\", \"coastal\", \"turbid\""});
}

// What goes by the sea of all times.
void check_keyed_sea(SceneChecker& check, const Scene& scene) {
    const Effects& effects = scene.effects;
    for (const KeyedNumber& number : without_still_keys(scene).keyed) {
        if (!is_of_sea(number)) continue;
        const auto refuse = [&](const std::string& problem, const std::string& accepted) {
            check.refuse({number.path, value_text(key_of(number.path), number.keys), problem, accepted});
        };
        constexpr double kSlowest = 1e-6;  // slower, and amplitudes' rates leave single precision
        if (scene.shot.time_scale < kSlowest)
            refuse("changes with the sea's time, which stands still",
                   "a number, or a shot.time_scale of at least " + number_text(kSlowest));
        if (effects.whitecaps && effects.spray && effects.spray_drops)
            refuse("changes, and drops of spray fly in one sea", "a number, or effects.spray_drops = false");
        if (!scene.waves.heroes.empty())
            refuse("changes, and hero waves stand in one sea", "a number, or no waves.heroes");
        return;
    }
}

// What takes one depth for all times.
template <class Refuse>
void check_keyed_depth(const Scene& scene, const KeyedNumber& depth, const Refuse& refuse) {
    constexpr double kMost =
        16.0;  // times between two keys: more parts of one way, each a pass through the modes
    const auto& keys = depth.keys.keys;
    if (std::ranges::any_of(keys, [](const NumberKeys::Key& key) { return std::isinf(key.value); }))
        return refuse("goes to water without a floor, and no depth is between",
                      "keys of finite depths: 1000 is deep for all waves");
    for (std::size_t i = 0; i + 1 < keys.size(); ++i)
        if (const auto [low, high] = std::minmax(keys[i].value, keys[i + 1].value); high > kMost * low)
            refuse("changes more than " + number_text(kMost) + " times from frame " +
                       std::to_string(keys[i].frame) + " to " + std::to_string(keys[i + 1].frame) +
                       ", too much for the phases of waves",
                   "a key between");
    const Waves& waves = scene.waves;
    if (waves.second_order > 0.0 && waves.model == WaveModel::Fft)
        refuse("changes, and what pairs of waves add is worked out for one depth",
               "a number, or waves.second_order = 0");
    if (!waves.vessels.empty())
        refuse("changes, and wakes are worked out for one depth", "a number, or no waves.vessels");
    if (scene.sea.depth_file != SeaState{}.depth_file)
        refuse("changes, and the floor of sea.depth_file stays", "a number, or no sea.depth_file");
    if (std::ranges::any_of(scene.objects, [](const SceneObject& object) {
            return object.floats && object.buoyancy == Buoyancy::Response;
        }))
        refuse("changes, and objects[].buoyancy = \"response\" answers waves of one depth",
               "a number, or objects[].buoyancy = \"plane\"");
}

void check_keyed(SceneChecker& check, const Scene& scene) {
    for (const KeyedNumber& number : scene.keyed)
        if (const auto entry = entry_of(number.path))
            if (const auto list = value_of(scene, key_of(entry->list));
                entry->index >= std::get<std::vector<KeyEntry>>(list).size()) {
                check.refuse({number.path, value_text(key_of(number.path), number.keys),
                              "has keys, and there is no such entry", "keys of entries that are there"});
                return;
            }
    check_keyed_sea(check, scene);
    for (const KeyedNumber& number : without_still_keys(scene).keyed) {
        const auto refuse = [&](const std::string& problem, const std::string& accepted) {
            check.refuse({number.path, value_text(key_of(number.path), number.keys), problem, accepted});
        };
        const bool is_wind = number.path == "sea.wind_direction_deg",
                   is_swell = table_key(number) == "sea.swell" && number.path.ends_with(".direction_deg");
        if ((is_wind || is_swell) && scene.waves.model == WaveModel::Trochoid)
            refuse("changes, and a train keeps its direction", "a number, or waves.model = \"fft\"");
        if (number.path == "sea.depth_m") check_keyed_depth(scene, number, refuse);
        const auto has_own = [](const CascadeSize& cascade) { return cascade.choppiness.has_value(); };
        if (number.path == "waves.choppiness" && scene.waves.model == WaveModel::Fft &&
            std::ranges::any_of(scene.waves.cascades, has_own))
            refuse("changes, and waves.cascades[].choppiness is one for the whole shot",
                   "a number, or cascades without a choppiness of their own");
        if (is_wind && scene.effects.whitecaps && scene.effects.spray)
            refuse("changes, and spray is torn along one wind", "a number, or effects.spray = false");
    }
    if (scene.shot.loop_s == 0.0) return;
    for (const KeyedNumber& number : scene.keyed)
        check.refuse({number.path, value_text(key_of(number.path), number.keys),
                      "changes over the shot, and a loop has no beginning to change from",
                      "a number, or shot.loop_s = 0"});
}

// The fit needs a regular grid, whose limit surface is a spline.
void check_scheme(SceneChecker& check, const Output& output, const Surface& surface) {
    if (output.mesh_scheme != MeshScheme::CatmullClark || surface.kind == SurfaceKind::Patch) return;
    check.refuse({"output.mesh_scheme", choice_text(output.mesh_scheme),
                  "fits a cage to the even grid of a patch, and surface.kind is " + choice_text(surface.kind),
                  "\"none\", or surface.kind = \"patch\""});
}

void check_tiles(SceneChecker& check, const Output& output, const Waves& waves) {
    if (output.cascade_tiles && waves.model == WaveModel::Trochoid && waves.cascades.empty()) {
        check.refuse({"output.cascade_tiles", "true",
                      "asks for the tiles of cascades, and wave trains alone have none",
                      "false, waves.model = \"fft\", or cascades listed in waves.cascades"});
    }
}

// A path that a hull could take, in a sea that has a tile for it.
void check_vessels(SceneChecker& check, const Scene& scene) {
    constexpr double kMostOfDepth = 0.8;
    const std::vector<Vessel>& vessels = scene.waves.vessels;
    const double fastest_mps = limits::kVesselDepthFroude * std::sqrt(kGravity * scene.sea.depth_m);
    for (std::size_t i = 0; i < vessels.size(); ++i) {
        const auto refuse = [&](const std::string& value, const std::string& problem,
                                const std::string& accepted) {
            check.refuse({indexed("waves.vessels", i) + ".path", value, problem, accepted});
        };
        std::size_t wrong = 0;
        const auto keys = course_of(vessels[i].path, &wrong);
        if (!keys || keys->size() < 2 || keys->size() > limits::kVesselKeys) {
            refuse(quoted_text(vessels[i].path),
                   !keys ? "is no list of keys: key " + std::to_string(wrong + 1) + " isn't three numbers"
                         : "has too few keys, or too many",
                   "\"frame east north, frame east north, …\", of 2 … " +
                       std::to_string(limits::kVesselKeys) + " keys");
            continue;
        }
        bool is_good = scene.shot.time_scale > 0.0;
        for (std::size_t k = 0; k < keys->size(); ++k) {
            const CourseKey &key = (*keys)[k], &before = (*keys)[k > 0 ? k - 1 : 0];
            const std::string text = "key " + std::to_string(k + 1) + ", " + number_text(key.frame) + ' ' +
                                     number_text(key.east_m) + ' ' + number_text(key.north_m);
            const double step_s = scene.shot.time_scale * (key.frame - before.frame) / scene.shot.fps;
            const double way_m = std::hypot(key.east_m - before.east_m, key.north_m - before.north_m);
            if (!limits::kFrame.holds(key.frame))
                refuse(text, "is at a frame outside the range", text_of(limits::kFrame));
            else if (!limits::kCameraCoordinate_m.holds(key.east_m) ||
                     !limits::kCameraCoordinate_m.holds(key.north_m))
                refuse(text, "is no place on the sea", text_of(limits::kCameraCoordinate_m) + " m");
            else if (k > 0 && !(key.frame > before.frame))
                refuse(text, "does not come after the key before, of frame " + number_text(before.frame),
                       "rising frames, each once");
            else if (k > 0 && !(way_m <= limits::kVesselSpeed_mps * step_s))
                refuse(text,
                       "is " + number_text(way_m) + " m from the key before, which the sea's " +
                           number_text(step_s) + " s are too short for",
                       "at most " + number_text(limits::kVesselSpeed_mps) + " m/s");
            else if (way_m > step_s * fastest_mps)
                refuse(text,
                       "is " + number_text(way_m) + " m from the key before, " + number_text(way_m / step_s) +
                           " m/s over " + number_text(scene.sea.depth_m) +
                           " m of water: near √(g d) waves pile up, which linear theory has without an end",
                       "at most " + number_text(fastest_mps) + " m/s there, or deeper water");
            else
                continue;
            is_good = false;
            break;
        }
        // Between keys a smooth path is faster than on the straight way.
        if (const double most_mps = is_good ? path_of(scene.shot, vessels[i]).fastest_mps() : 0.0;
            most_mps > fastest_mps)
            check.refuse(
                {indexed("waves.vessels", i) + ".interpolation", "\"smooth\"",
                 "goes up to " + number_text(most_mps) + " m/s between its keys, over " +
                     number_text(scene.sea.depth_m) +
                     " m of water: near √(g d) waves pile up, which linear theory has without an end",
                 "keys of a steadier speed, at most " + number_text(fastest_mps) + " m/s, or deeper water"});
        const double most_m = kMostOfDepth * scene.sea.depth_m;
        if (vessels[i].draught_m > most_m)
            check.refuse({indexed("waves.vessels", i) + ".draught_m", number_text(vessels[i].draught_m),
                          "reaches the floor, or nearly",
                          "at most " + number_text(most_m) + " m, or deeper water"});
    }
    if (vessels.empty()) return;
    const auto refuse = [&](const char* key, const std::string& value, const std::string& problem,
                            const std::string& accepted) {
        check.refuse({key, value, problem, accepted + ", or no waves.vessels"});
    };
    if (scene.shot.time_scale == 0.0)
        refuse("shot.time_scale", "0", "lets the sea stand still, in which waves.vessels move",
               "a number above 0");
    if (scene.shot.loop_s > 0.0)
        refuse("shot.loop_s", number_text(scene.shot.loop_s), "is a loop, which waves.vessels leave", "0");
    if (scene.waves.model == WaveModel::Trochoid)
        refuse("waves.model", choice_text(scene.waves.model),
               "is a sum of trains, and waves.vessels make theirs on grids", "\"fft\"");
    if (scene.output.cascade_tiles)
        refuse("output.cascade_tiles", "true",
               "asks for tiles, which are alike everywhere, and waves.vessels make places differ", "false");
}

// A path that a body can take: of one place it stands there.
void check_object_path(SceneChecker& check, const Shot& shot, const std::string& key,
                       const SceneObject& object) {
    const auto refuse = [&](const std::string& value, const std::string& problem,
                            const std::string& accepted) {
        check.refuse({key, value, problem, accepted});
    };
    std::size_t wrong = 0;
    const auto keys = course_of(object.path, &wrong);
    if (!keys || keys->size() > limits::kVesselKeys)
        return refuse(quoted_text(shortened(object.path)),
                      !keys ? "is no list of keys: key " + std::to_string(wrong + 1) + " isn't three numbers"
                            : "has too many keys",
                      "\"frame east north, frame east north, …\", of 1 … " +
                          std::to_string(limits::kVesselKeys) + " keys");
    bool moves = false;
    for (std::size_t k = 0; k < keys->size(); ++k) {
        const CourseKey &at = (*keys)[k], &before = (*keys)[k > 0 ? k - 1 : 0];
        const std::string text = "key " + std::to_string(k + 1) + ", " + number_text(at.frame) + ' ' +
                                 number_text(at.east_m) + ' ' + number_text(at.north_m);
        if (!limits::kFrame.holds(at.frame))
            return refuse(text, "is at a frame outside the range", text_of(limits::kFrame));
        if (!limits::kCameraCoordinate_m.holds(at.east_m) || !limits::kCameraCoordinate_m.holds(at.north_m))
            return refuse(text, "is no place on the sea", text_of(limits::kCameraCoordinate_m) + " m");
        if (k > 0 && !(at.frame > before.frame))
            return refuse(text, "does not come after the key before, of frame " + number_text(before.frame),
                          "rising frames, each once");
        moves = moves || at.east_m != before.east_m || at.north_m != before.north_m;
    }
    if (moves && shot.loop_s > 0.0)
        refuse(quoted_text(shortened(object.path)), "goes from place to place, which a loop has no end for",
               "keys of one place, or shot.loop_s = 0");
}

void check_objects(SceneChecker& check, const Scene& scene) {
    const std::string list(kObjectsKey);
    constexpr std::size_t kMostOfName = 100;
    std::map<std::string, std::size_t> names;
    std::map<const ObjectMesh*, std::size_t> triangles;  // bodies of one file share its mesh
    std::size_t all_triangles = 0;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const SceneObject& object = scene.objects[i];
        const std::string here = indexed(list, i);
        if (!object.mesh) {
            check.refuse({here + ".file", quoted_text(object.file),
                          object.file.empty() ? "names no file" : "is named and not read",
                          "the path of an .obj or a .usdc, which the host reads"});
        } else if (triangles.try_emplace(object.mesh.get()).second) {
            all_triangles += object.mesh->data().triangles.size() / 3;
        }
        const std::string name = object.called();
        // Nothing in it needs an escape where mattes list it.
        if (name.empty() || name.size() > kMostOfName || quoted_text(name) != '"' + name + '"' ||
            line_text(name) != name) {
            if (object.mesh || !object.name.empty())
                check.refuse({here + ".name", quoted_text(shortened(name)),
                              object.name.empty() ? "is its file's name, and none for mattes"
                                                  : "is no name for mattes",
                              "1 … " + std::to_string(kMostOfName) +
                                  " bytes of UTF-8 without \", \\ and control characters"});
        } else if (name == "sea") {
            check.refuse(
                {here + ".name", quoted_text(name), "is what mattes call the water", "another name"});
        } else if (const auto [first, is_new] = names.try_emplace(name, i); !is_new) {
            check.refuse({here + ".name", quoted_text(name),
                          "is what " + indexed(list, first->second) + " is called" +
                              (object.name.empty() ? ": without a name it is its file's" : ""),
                          "a name of its own for each of them"});
        }
        const std::size_t vessels = scene.waves.vessels.size();
        if (check.is_good(here + ".vessel") && object.vessel > static_cast<int>(vessels))
            check.refuse({here + ".vessel", std::to_string(object.vessel),
                          "is not one of waves.vessels, which has " +
                              (vessels == 0 ? "none" : std::to_string(vessels)),
                          vessels == 0 ? "0, or a list waves.vessels"
                                       : "1 … " + std::to_string(vessels) + ", or 0: of none"});
        if (object.path.empty()) continue;
        if (object.vessel > 0)
            check.refuse({here + ".path", quoted_text(shortened(object.path)),
                          "is given beside vessel = " + std::to_string(object.vessel) + ", which has one",
                          "one of the two"});
        else
            check_object_path(check, scene.shot, here + ".path", object);
    }
    if (all_triangles > limits::kObjectTriangles)
        check.refuse({list, std::to_string(all_triangles) + " triangles", "is too many",
                      "at most " + std::to_string(limits::kObjectTriangles) + " of all files together"});
}

// What waves that feel the floor need, and can't do yet. Tiles do as masks do (core/plan/coast.h).
void check_coast(SceneChecker& check, const Scene& scene) {
    const Waves& waves = scene.waves;
    if (!waves.coast) return;
    const auto refuse = [&](const std::string& problem, const std::string& accepted) {
        check.refuse({std::string(kCoastKey), "true", problem, accepted + ", or false"});
    };
    const bool has_trains = waves.model == WaveModel::Trochoid;
    if (has_trains && !waves.cascades.empty())
        refuse("turns wave trains, and waves.cascades beside them are tiles, which are alike everywhere",
               "no waves.cascades, or waves.model = \"fft\", whose tiles are lowered by the floor");
    if (!has_trains && scene.output.cascade_tiles)
        check.refuse({"output.cascade_tiles", "true",
                      "asks for tiles, which are alike everywhere, and waves.coast makes places differ",
                      "false, or waves.coast = false"});
    if (scene.surface.kind == SurfaceKind::Cage && has_ending(scene.sea.depth_file, ".obj"))
        refuse("measures a floor's mesh from the height 0, and a cage lies at any",
               "sea.depth_file = \"PATH.exr\"");
    if (has_trains && !waves.heroes.empty())
        refuse("turns the waves that waves.heroes are made of", "no waves.heroes");
    if (has_trains && std::ranges::any_of(scene.objects, [](const SceneObject& object) {
            return object.floats && object.buoyancy == Buoyancy::Response;
        }))
        refuse("turns waves, and objects[].buoyancy = \"response\" answers each as it comes from sea.depth_m",
               "objects[].buoyancy = \"plane\"");
    if (std::ranges::any_of(scene.keyed, is_of_sea))
        refuse("is worked out for one sea, and this one has keys", "a sea without keys");
}

// What calm and rough places can't do yet.
void check_masks(SceneChecker& check, const Scene& scene) {
    const Waves& waves = scene.waves;
    constexpr double kShortestBreaker_m = 0.25;  // a slick's waves are shorter
    int rows = 0;
    for (std::size_t i = 0; i < waves.masks.size(); ++i) {
        const WaveMask& mask = waves.masks[i];
        const std::string key = indexed("waves.masks", i) + ".picture";
        const auto refuse_picture = [&](const std::string& problem, const std::string& accepted) {
            check.refuse({key, quoted_text(*mask.picture), problem, accepted});
        };
        if (const MaskPicture* picture = picture_of(waves, mask)) {
            rows += picture->size().y;
            if (rows > limits::kMaskRows)
                refuse_picture("and those of the masks before it have " + std::to_string(rows) + " rows",
                               "at most " + std::to_string(limits::kMaskRows) + " together");
        } else if (mask.picture) {
            refuse_picture("was not read", key_of("waves.masks[].picture").accepted);
        }
        if (mask.ripples == 1.0) continue;
        const auto refuse = [&](const std::string& problem, const std::string& accepted) {
            check.refuse({indexed("waves.masks", i) + ".ripples", number_text(mask.ripples), problem,
                          "1, or " + accepted});
        };
        if (waves.model == WaveModel::Trochoid)
            refuse("calms ripples, and wave trains are calmed all alike", "waves.model = \"fft\"");
        else if (scene.effects.whitecaps && scene.effects.breaking_from_m < kShortestBreaker_m)
            refuse("calms ripples, and effects.breaking_from_m = " +
                       number_text(scene.effects.breaking_from_m) + " lets them break",
                   "effects.breaking_from_m of " + number_text(kShortestBreaker_m) + " or more");
    }
    if (scene.output.cascade_tiles && !waves.masks.empty())
        check.refuse({"output.cascade_tiles", "true",
                      "asks for tiles, which are alike everywhere, and waves.masks make places differ",
                      "false, or no waves.masks"});
}

// Fronts that move leave a loop. A sea that stands still has none to leave.
void check_fronts(SceneChecker& check, const Scene& scene) {
    if (!(scene.shot.sea_loop_s() > 0.0)) return;
    for (std::size_t i = 0; i < scene.sea.gust_fronts.size(); ++i)
        if (const double speed_mps = scene.sea.gust_fronts[i].speed_mps; speed_mps > 0.0)
            check.refuse({indexed(std::string(kFrontsKey), i) + ".speed_mps", number_text(speed_mps),
                          "takes it away, and in a loop it would have to be back", "0, or shot.loop_s = 0"});
}

void check_output(SceneChecker& check, const Scene& scene) {
    const Effects& effects = scene.effects;
    const Output& output = scene.output;
    if (output.mesh == MeshFormat::None && output.maps.empty() && output.volumes.empty() && !output.drops) {
        check.refuse({"output.mesh", choice_text(output.mesh),
                      "leaves nothing to bake: there are no maps and no volumes either",
                      "a mesh, or at least one map in output.maps or volume in output.volumes"});
    }
    if (output.drops) {
        const auto refuse = [&](const std::string& problem, const std::string& accepted) {
            check.refuse({"output.drops", "true", problem, accepted + ", or false"});
        };
        if (!effects.spray_drops)
            refuse("asks for drops while effects.spray_drops is false", "effects.spray_drops = true");
        else if (!effects.spray)
            refuse("asks for drops while effects.spray is false", "effects.spray = true");
        else if (!effects.whitecaps)
            refuse("asks for drops, which come from whitecaps, while effects.whitecaps is false",
                   "effects.whitecaps = true");
        else if (effects.spray_law != SpraySource::Andreas1998)
            refuse("asks for large drops, and effects.spray_law = " + choice_text(effects.spray_law) +
                       " has none",
                   "effects.spray_law = \"andreas-1998\"");
    }
    if (output.cascade_tiles &&
        std::ranges::all_of(output.maps, [](MapKind map) { return map == MapKind::Floor; })) {
        check.refuse({"output.cascade_tiles", "true", "asks for tiles of no map",
                      "true together with at least one map in output.maps other than floor, or false"});
    }
    for (std::size_t i = 0; i < output.maps.size(); ++i) {
        if (output.maps[i] == MapKind::Whitecaps && !effects.whitecaps) {
            check.refuse({indexed("output.maps", i), choice_text(output.maps[i]),
                          "asks for coverage while effects.whitecaps is false",
                          "effects.whitecaps = true, or no such map"});
        }
        if (output.maps[i] != MapKind::Floor) continue;
        if (!scene.water.body)
            check.refuse({indexed("output.maps", i), choice_text(output.maps[i]),
                          "asks for the light on the floor while water.body is false",
                          "water.body = true, or no such map"});
        else if (!std::isfinite(scene.sea.depth_m) && scene.sea.depth_file == SeaState{}.depth_file)
            check.refuse({indexed("output.maps", i), choice_text(output.maps[i]),
                          "asks for the light on the floor of a sea without one",
                          "a finite sea.depth_m, or no such map"});
    }
}

void check_volumes(SceneChecker& check, const Scene& scene) {
    const Output& output = scene.output;
    for (std::size_t i = 0; i < output.volumes.size(); ++i) {
        if (output.volumes[i] != VolumeKind::Spray) continue;
        const std::string key = indexed("output.volumes", i);
        if (!scene.effects.spray)
            check.refuse({key, choice_text(output.volumes[i]), "asks for spray while effects.spray is false",
                          "effects.spray = true, or no such volume"});
        else if (!scene.effects.whitecaps)
            check.refuse({key, choice_text(output.volumes[i]),
                          "asks for spray, which comes from whitecaps, while effects.whitecaps is false",
                          "effects.whitecaps = true, or no such volume"});
    }
    if (output.volumes.empty() || !check.is_good("output.voxel_m") || !check.is_good("surface.size_m"))
        return;
    const double size_m = scene.surface.size_m;
    const auto refuse_size = [&](const std::string& problem, const std::string& accepted) {
        check.refuse({"output.voxel_m", number_text(output.voxel_m), problem,
                      accepted + number_text(size_m) + ", the patch's side (surface.size_m)"});
    };
    if (output.voxel_m > size_m) refuse_size("is wider than the patch that the volumes cover", "at most ");
    if (size_m / output.voxel_m > limits::kVoxelsASide)
        refuse_size("makes " + number_text(std::ceil(size_m / output.voxel_m)) + " voxels along a side",
                    "at least " + number_text(size_m / limits::kVoxelsASide) + ", a " +
                        number_text(limits::kVoxelsASide) + "th of ");
}

}  // namespace

std::string text_of(Range range) {
    return number_text(range.low) + " … " + number_text(range.high);
}

std::string text_of(const Problem& problem) {
    constexpr std::size_t kMostOfValue = 300, kMostOfProblem = 1000;  // bytes: room for most files' paths
    return line_text(shortened(problem.key, kMostOfValue)) + " = " + shortened(problem.value, kMostOfValue) +
           ": " + shortened(problem.problem, kMostOfProblem) + "; accepted: " + problem.accepted;
}

std::vector<Problem> validate(const Scene& scene) {
    SceneChecker check;
    check_each_value(check, scene);
    check_shot(check, scene.shot);
    check_sea(check, scene.sea);
    check_waves(check, scene.waves, scene.shot.edition);
    check_camera(check, scene.camera);
    check_near_far(check, scene);
    check_planet(check, scene);
    check_cage(check, scene.surface);
    check_pictures(check, scene);
    check_water(check, scene);
    check_keyed(check, scene);
    check_output(check, scene);
    check_scheme(check, scene.output, scene.surface);
    check_budget(check, scene.quality);
    check_tiles(check, scene.output, scene.waves);
    check_masks(check, scene);
    check_fronts(check, scene);
    check_coast(check, scene);
    check_vessels(check, scene);
    check_objects(check, scene);
    check_volumes(check, scene);
    return check.take();
}

}  // namespace pelagic
