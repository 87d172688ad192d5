// A shot's camera as a layer of its own, a crate beside the root: one prim, def Camera "Camera", with plain
// time samples, which every importer reads: 72 bytes for each, 80 where the lens zooms.
#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/format/usd/layers.h"

namespace pelagic::usd {

// Where a camera is, its axes in the world (unit vectors, orthogonal, right × up = backward), and its lens.
// The camera looks along −backward.
struct CameraPose {
    glm::dvec3 position_m{0.0};
    glm::dvec3 right{1.0, 0.0, 0.0};
    glm::dvec3 up{0.0, 0.0, 1.0};
    glm::dvec3 backward{0.0, -1.0, 0.0};
    double fov_deg = 50.0;  // horizontal, between 0 and 180
    bool operator==(const CameraPose&) const = default;
};

struct Camera {
    double fps = 24.0;               // > 0
    std::string_view fingerprint{};  // letters and digits; in customLayerData, empty: not written
    int first_frame = 1;             // of the shot, both included
    int last_frame = 1;
    // Rising; from each to the next the pose changes smoothly or not at all, and not before the first or after the last.
    std::vector<int> key_frames{};
    // The pose at a frame of the shot. It is called more than once for a frame, and must give the same.
    std::function<CameraPose(int frame)> pose_at{};
    glm::ivec2 resolution{1280, 720};  // pixels; their ratio is the film's
    double film_width_mm = 36.0;       // > 0
    glm::dvec2 shift{0.0};             // of the film, to the right and up in the picture, in widths of it
    double f_stop = 0.0;               // 0: a pinhole
    double focus_distance_m = 10.0;
    glm::dvec2 clipping_m{0.1, 1000e3};  // near and far; far is beyond the horizon of any aircraft
};

// Film and focal length in USD's unit for them, a tenth of the stage's, so 0.1 m. Only their ratios matter to
// the picture.
struct FilmBack {
    double horizontal_aperture;
    double vertical_aperture;
    double focal_length;
};
// Throws std::invalid_argument unless 0 < fov_deg < 180 and the resolution is positive.
FilmBack film_back(double fov_deg, glm::ivec2 resolution, double film_width_mm = 36.0);

// Throws std::invalid_argument, naming the frame, unless the pose is finite, its axes are orthonormal and
// right-handed, and 0 < fov_deg < 180.
void check(const CameraPose& pose, int frame);

// The pose's rotation as USD's rotateXYZ [deg], about x, then y, then z: x is the pitch (0 looks straight
// down, 90 at the horizon, 180 straight up), y the roll, z the heading (0 looks along +y). Angles repeat, and
// two sets of them give the same rotation; this returns the set nearest to `before_deg`, so that linear
// interpolation from one frame's angles to the next frame's takes the short way.
glm::dvec3 rotate_xyz_deg(const CameraPose& pose, const glm::dvec3& before_deg);

// What the file has of a frame.
struct CameraSample {
    glm::dvec3 translate;
    glm::dvec3 rotate_xyz_deg;
};
// The samples of a camera that moves; none of one that stands still.
struct Course {
    std::vector<double> frames;
    std::vector<CameraSample> samples;
    std::vector<float> focal_lengths;
    CameraSample first{};  // of the shot's first frame
    bool zooms = false;
};

// Asks for every pose that counts. Throws std::invalid_argument, naming what is wrong with one.
Course course_of(const Camera& camera);

// Above so many frames between the first key and the last there isn't a sample for each frame.
inline constexpr int kMostFramesEach = 8192;

// Translation and rotation have a sample for each frame, from the last frame before the first change of pose
// to the frame of the last change, and so has the focal length where it changes; what stands still has plain
// values. Where the keys are too far apart for that, samples stand at the keys and where a line from one to the next would be
// off by more than 0.2 mm, a fiftieth of a pixel's angle or 1e-5 of the focal length: what is written and how long that takes
// depends on the keys, not on the length of the shot.
// Throws std::invalid_argument, naming what is wrong, before it calls the sink.
void write_camera_crate(const Camera& camera, const Sink& sink);
std::string camera_crate(const Camera& camera);

}  // namespace pelagic::usd
