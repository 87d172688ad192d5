// What an artist can turn in the preview's window: a panel of sliders, a bar that plays the shot, and what
// the picture costs. Draws with Dear ImGui into the frame that has begun; knows no OpenGL and no window.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "pelagic/scene.h"
#include "plugin/host/preview/sea_renderer.h"

namespace pelagic {

// What the panel changes.
struct Controls {
    Scene scene;  // as asked for now: the sea on show may still be an older one's
    DrawOptions draw;
    double exposure_stops = 0.0;  // above what suits the light
    int pixel_size = 1;           // 1, 2, 4: a drawn pixel covers this many of the window's, squared
    bool playing = true;
    bool repeat = true;  // the shot's frames over and over; otherwise playing ends with the last one
    double speed = 1.0;  // of playing
    double frame = 1.0;  // of the shot, with fractions
    bool show_panel = true, show_help = false;
};

// How the panel begins for a shot.
Controls controls_for(const Scene& scene);

// The playhead, which never leaves the shot's frames. play_on(): so many seconds on while it plays. play_or_pause():
// from the first frame again where it had come to the end. go_to(): by hand to a frame.
void play_on(Controls& controls, double seconds, const Shot& shot);
void play_or_pause(Controls& controls, const Shot& shot);
void go_to(Controls& controls, double frame, const Shot& shot);

// The milliseconds of one picture, in the order in which they are spent; frames and seas beside it.
struct PictureTimes {
    double total_ms = 0.0;    // from picture to picture
    double panel_ms = 0.0;    // this panel
    double grid_ms = 0.0;     // the projected grid
    double present_ms = 0.0;  // handing the window's picture over, waiting for the screen included
    StageTimes gpu;
    double transforms_ms = 0.0, packing_ms = 0.0;  // of the frame on show, beside the drawing
    double build_s = 0.0;                          // of the sea on show
};

// What the panel tells.
struct Readout {
    std::string device;
    std::string message;   // what went wrong; empty: all is well
    bool has_sea = false;  // one is on show
    bool building_sea = false, building_sky = false;
    double built = 0.0,
           waited_s = 0.0;     // how much of that sea there is, 0 … 1, and for how long it has been built
    bool follows_shot = true;  // the camera is the shot's own
    glm::dvec3 camera_m{0.0};
    double significant_height_m = 0.0;  // of the sea on show
    glm::ivec2 drawn_px{0};             // the picture's size before it is scaled to the window
    PictureTimes times;
    std::vector<float> history_ms;  // total_ms of the last pictures, the oldest first
};

// What was clicked.
struct Clicks {
    bool shot_camera = false;  // back to it
    bool copy = false;         // the changed keys, as a shot file
    bool save = false;         // the same into the shot's own file
    bool reset = false;        // everything as the shot has it
};

// What the window is doing or shows of the sea, in a line.
std::string sea_words(const Readout& readout);

// Draws everything and changes `controls` as the artist wills. `shot` is the scene as its file has it.
Clicks draw_controls(Controls& controls, const Readout& readout, const Scene& shot);

// Dear ImGui's look: colours, spacing and a font for a screen of this scale (1: 96 dots an inch). Once,
// before the first frame.
void set_controls_style(float scale);

// The keys that the panel shows, section by section, by their paths: sliders, words and boxes, made of what
// core/scene/keys.h says about each.
struct PanelSection {
    const char* title;
    std::vector<std::string_view> paths;
};
const std::vector<PanelSection>& panel_sections();

}  // namespace pelagic
