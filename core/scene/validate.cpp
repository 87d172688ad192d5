// Whether the values of a Scene make sense. See validate.h.
#include "core/scene/validate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <utility>

#include "core/scene/cascade_bands.h"
#include "core/scene/limits.h"
#include "core/scene/names.h"
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

class Checker {
  public:
    void refuse(Problem problem) { problems_.push_back(std::move(problem)); }

    // Whether the value is in range; refused if not.
    bool in_range(const std::string& key, double value, Range range) {
        if (range.holds(value)) return true;
        refuse({key, number_text(value), std::isnan(value) ? "is not a number" : "is outside the range",
                text_of(range)});
        return false;
    }

    bool in_range(const std::string& key, int value, Range range) {
        if (range.holds(value)) return true;
        refuse({key, std::to_string(value), "is outside the range", text_of(range)});
        return false;
    }

    template <class Choice>
    void no_duplicates(const std::string& key, const std::vector<Choice>& list) {
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (std::find(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(i), list[i]) !=
                list.begin() + static_cast<std::ptrdiff_t>(i)) {
                refuse({indexed(key, i), choice_text(list[i]), "is in the list twice", "each word once"});
            }
        }
    }

    void not_built(const std::string& key, std::string value, std::string meanwhile) {
        refuse({key, std::move(value), "is not built yet", std::move(meanwhile)});
    }

    std::vector<Problem> take() { return std::move(problems_); }

  private:
    std::vector<Problem> problems_;
};

void check_shot(Checker& check, const Shot& shot) {
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-';
    };
    constexpr const char* kNameRule = "letters, digits, _ and -, at least one and at most 200 of them";
    if (shot.name.empty()) {
        check.refuse({"shot.name", quoted_text(shot.name), "is empty", kNameRule});
    } else if (const auto bad = std::find_if_not(shot.name.begin(), shot.name.end(), allowed);
               bad != shot.name.end()) {
        check.refuse(
            {"shot.name", quoted_text(shot.name),
             "is no file name for every system: it has " + quoted_text(std::string_view(&*bad, 1)) + " in it",
             kNameRule});
    } else if (shot.name.size() > static_cast<std::size_t>(limits::kNameLength)) {
        check.refuse({"shot.name", quoted_text(shot.name), "is too long for a file name", kNameRule});
    }

    const std::string frames =
        '[' + std::to_string(shot.first_frame) + ", " + std::to_string(shot.last_frame) + ']';
    if (!limits::kFrame.holds(shot.first_frame) || !limits::kFrame.holds(shot.last_frame)) {
        check.refuse({"shot.frames", frames, "is outside the range", "frames of " + text_of(limits::kFrame)});
    } else if (shot.last_frame < shot.first_frame) {
        check.refuse(
            {"shot.frames", frames, "runs backwards", "[first, last] with first ≤ last, both included"});
    }

    const bool fps_is_good = check.in_range("shot.fps", shot.fps, limits::kFps);
    constexpr auto kLargestSeed = ~std::uint64_t{0} >> 1;  // what a shot file can hold
    if (shot.seed > kLargestSeed) {
        check.refuse({"shot.seed", std::to_string(shot.seed), "is outside the range",
                      "0 … " + std::to_string(kLargestSeed)});
    }
    if (check.in_range("shot.loop_s", shot.loop_s, limits::kLoop_s) && fps_is_good && shot.loop_s > 0.0) {
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
}

void check_measured(Checker& check, const MeasuredSpectrum& measured) {
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

void check_sea(Checker& check, const SeaState& sea) {
    check.in_range("sea.wind_speed_mps", sea.wind_speed_mps, limits::kWindSpeed_mps);
    check.in_range("sea.wind_direction_deg", sea.wind_direction_deg, limits::kAngle_deg);
    check.in_range("sea.fetch_m", sea.fetch_m, limits::kFetch_m);
    const bool infinitely_deep = std::isinf(sea.depth_m) && sea.depth_m > 0.0;
    if (!infinitely_deep && !limits::kDepth_m.holds(sea.depth_m)) {
        check.refuse({"sea.depth_m", number_text(sea.depth_m),
                      std::isnan(sea.depth_m) ? "is not a number" : "is outside the range",
                      text_of(limits::kDepth_m) + ", or inf"});
    }
    if (sea.swell.size() > static_cast<std::size_t>(limits::kSwells)) {
        check.refuse({"sea.swell", std::to_string(sea.swell.size()) + " swells", "is too many",
                      "at most " + std::to_string(limits::kSwells)});
    }
    for (std::size_t i = 0; i < sea.swell.size(); ++i) {
        const std::string key = indexed("sea.swell", i);
        check.in_range(key + ".height_m", sea.swell[i].height_m, limits::kSwellHeight_m);
        check.in_range(key + ".period_s", sea.swell[i].period_s, limits::kSwellPeriod_s);
        check.in_range(key + ".direction_deg", sea.swell[i].direction_deg, limits::kAngle_deg);
    }
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
void check_bands(Checker& check, const std::vector<CascadeSize>& cascades) {
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

void check_trains(Checker& check, const Waves& waves) {
    check.in_range("waves.trains", waves.trains, limits::kTrains);
    bool all_good = true;
    for (const auto& [key, end_m] :
         {std::pair{"waves.shortest_m", waves.shortest_m}, std::pair{"waves.longest_m", waves.longest_m}})
        if (end_m) all_good = check.in_range(key, *end_m, limits::kTrain_m) && all_good;
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

void check_no_trains(Checker& check, const Waves& waves) {
    const auto refuse = [&](const char* key, std::string value) {
        check.refuse({key, std::move(value), "speaks of wave trains, and the model has none",
                      "model = \"trochoid\", or a file without this key"});
    };
    if (waves.trains != Waves{}.trains) refuse("waves.trains", std::to_string(waves.trains));
    if (waves.shortest_m) refuse("waves.shortest_m", number_text(*waves.shortest_m));
    if (waves.longest_m) refuse("waves.longest_m", number_text(*waves.longest_m));
}

void check_waves(Checker& check, const Waves& waves) {
    if (waves.model == WaveModel::Trochoid) {
        check_trains(check, waves);
    } else {
        check_no_trains(check, waves);
    }
    check.in_range("waves.choppiness", waves.choppiness, limits::kChoppiness);
    if (waves.cascades.size() > static_cast<std::size_t>(limits::kCascades)) {
        check.refuse({"waves.cascades", std::to_string(waves.cascades.size()) + " cascades", "is too many",
                      "at most " + std::to_string(limits::kCascades)});
        return;
    }
    bool all_good = true;
    for (std::size_t i = 0; i < waves.cascades.size(); ++i) {
        const CascadeSize& cascade = waves.cascades[i];
        const std::string key = indexed("waves.cascades", i);
        all_good = check.in_range(key + ".size_m", cascade.size_m, limits::kCascadeSize_m) && all_good;
        if (!limits::kCascadeResolution.holds(cascade.resolution) || cascade.resolution % 2 != 0) {
            check.refuse({key + ".resolution", std::to_string(cascade.resolution),
                          "is no grid for a transform",
                          "an even number, " + text_of(limits::kCascadeResolution)});
            all_good = false;
        }
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

void check_surface(Checker& check, const Surface& surface) {
    if (surface.kind != SurfaceKind::Patch && surface.kind != SurfaceKind::ProjectedGrid) {
        check.not_built("surface.kind", choice_text(surface.kind), "\"patch\" or \"projected-grid\"");
    }
    check.in_range("surface.size_m", surface.size_m, limits::kSurfaceSize_m);
    check.in_range("surface.resolution", surface.resolution, limits::kSurfaceResolution);
    check.in_range("surface.cell_px", surface.cell_px, limits::kCell_px);
}

bool check_point(Checker& check, const std::string& key, const glm::dvec3& point_m) {
    const Range range = limits::kCameraCoordinate_m;
    if (range.holds(point_m.x) && range.holds(point_m.y) && range.holds(point_m.z)) return true;
    check.refuse(
        {key, vector_text(point_m), "is outside the range", "three numbers, each " + text_of(range)});
    return false;
}

// The least distance from the origin to the segment from a to b.
double distance_to_origin(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 along = b - a;
    const double length2 = glm::dot(along, along);
    const double s = length2 > 0.0 ? std::clamp(-glm::dot(a, along) / length2, 0.0, 1.0) : 0.0;
    return glm::length(a + s * along);
}

constexpr const char* kOffTarget = "a target at least 1e-6 m away from the camera's position";

void check_camera(Checker& check, const Camera& camera) {
    const bool position_is_good = check_point(check, "camera.position_m", camera.position_m);
    const bool target_is_good = check_point(check, "camera.look_at_m", camera.look_at_m);
    // With keys, the two points above are not used.
    if (position_is_good && target_is_good && camera.keys.empty() &&
        glm::distance(camera.position_m, camera.look_at_m) < limits::kOnTarget_m) {
        check.refuse({"camera.look_at_m", vector_text(camera.look_at_m),
                      "is where the camera itself is, so that it looks nowhere", kOffTarget});
    }
    bool previous_is_good = false;
    for (std::size_t i = 0; i < camera.keys.size(); ++i) {
        const CameraKey& here = camera.keys[i];
        const std::string key = indexed("camera.keys", i);
        check.in_range(key + ".frame", here.frame, limits::kFrame);
        bool good = check_point(check, key + ".position_m", here.position_m);
        good = check_point(check, key + ".look_at_m", here.look_at_m) && good;
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
    check.in_range("camera.fov_deg", camera.fov_deg, limits::kFov_deg);
    if (!limits::kImageResolution.holds(camera.resolution.x) ||
        !limits::kImageResolution.holds(camera.resolution.y)) {
        check.refuse(
            {"camera.resolution",
             '[' + std::to_string(camera.resolution.x) + ", " + std::to_string(camera.resolution.y) + ']',
             "is outside the range", "[width, height], each " + text_of(limits::kImageResolution)});
    }
}

// A number that nothing uses yet: refused, rather than ignored, where it isn't the default.
void check_unused_number(Checker& check, const std::string& key,
                         std::pair<double, double> value_and_default) {
    const auto [value, fallback] = value_and_default;
    if (value == fallback) return;
    if (!std::isfinite(value)) {
        check.refuse({key, number_text(value), "is not a finite number",
                      number_text(fallback) + ", the only value built so far"});
    } else {
        check.not_built(key, number_text(value), number_text(fallback));
    }
}

void check_light_and_water(Checker& check, const Light& light, const Water& water) {
    check.in_range("light.sun_elevation_deg", light.sun_elevation_deg, limits::kSunElevation_deg);
    check.in_range("light.sun_azimuth_deg", light.sun_azimuth_deg, limits::kAngle_deg);
    const auto is_exr = [](std::string_view path) {
        constexpr std::string_view kExr = ".exr";
        return path.size() > kExr.size() &&
               std::equal(kExr.begin(), kExr.end(), path.end() - static_cast<std::ptrdiff_t>(kExr.size()),
                          [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b); });
    };
    if (light.sky != Light{}.sky && !is_exr(light.sky)) {
        check.refuse({"light.sky", quoted_text(light.sky), "is neither a sky's name nor a picture",
                      "\"daylight\", or the path of a lat-long picture, an .exr"});
    }
    check.in_range("light.turbidity", light.turbidity, limits::kTurbidity);
    check.in_range("water.chlorophyll_mg_m3", water.chlorophyll_mg_m3, limits::kChlorophyll_mg_m3);
}

void check_tiles(Checker& check, const Output& output, const Waves& waves) {
    if (output.cascade_tiles && waves.model == WaveModel::Trochoid && waves.cascades.empty()) {
        check.refuse({"output.cascade_tiles", "true",
                      "asks for the tiles of cascades, and wave trains alone have none",
                      "false, waves.model = \"fft\", or cascades listed in waves.cascades"});
    }
}

void check_effects_and_output(Checker& check, const Effects& effects, const Output& output) {
    if (effects.spray) check.not_built("effects.spray", "true", "false");
    check_unused_number(check, "effects.spray_gain", {effects.spray_gain, Effects{}.spray_gain});

    if (output.mesh == MeshFormat::None && output.maps.empty()) {
        check.refuse({"output.mesh", choice_text(output.mesh),
                      "leaves nothing to bake: there are no maps either",
                      "a mesh, or at least one map in output.maps"});
    }
    if (output.cascade_tiles && output.maps.empty()) {
        check.refuse({"output.cascade_tiles", "true", "asks for tiles of no map",
                      "true together with at least one map in output.maps, or false"});
    }
    check.no_duplicates("output.attributes", output.attributes);
    check.no_duplicates("output.maps", output.maps);
    for (std::size_t i = 0; i < output.maps.size(); ++i) {
        if (output.maps[i] == MapKind::Whitecaps && !effects.whitecaps) {
            check.refuse({indexed("output.maps", i), choice_text(output.maps[i]),
                          "asks for coverage while effects.whitecaps is false",
                          "effects.whitecaps = true, or no such map"});
        }
    }
    check.in_range("output.map_resolution", output.map_resolution, limits::kMapResolution);
    if (output.mesh_scheme != MeshScheme::None) {
        check.not_built("output.mesh_scheme", choice_text(output.mesh_scheme), "\"none\"");
    }
    for (std::size_t i = 0; i < output.volumes.size(); ++i) {
        check.not_built(indexed("output.volumes", i), choice_text(output.volumes[i]), "an empty list, []");
    }
    check_unused_number(check, "output.voxel_m", {output.voxel_m, Output{}.voxel_m});
}

}  // namespace

std::string text_of(Range range) {
    return number_text(range.low) + " … " + number_text(range.high);
}

std::string text_of(const Problem& problem) {
    return problem.key + " = " + problem.value + ": " + problem.problem + "; accepted: " + problem.accepted;
}

std::vector<Problem> validate(const Scene& scene) {
    Checker check;
    check_shot(check, scene.shot);
    check_sea(check, scene.sea);
    check_waves(check, scene.waves);
    check_surface(check, scene.surface);
    check_camera(check, scene.camera);
    check_light_and_water(check, scene.light, scene.water);
    check_effects_and_output(check, scene.effects, scene.output);
    check_tiles(check, scene.output, scene.waves);
    return check.take();
}

}  // namespace pelagic
