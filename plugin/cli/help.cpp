// Every help text of the command line. See help.h.
#include "plugin/cli/help.h"

#include <oneapi/tbb/version.h>
#include <CLI/CLI.hpp>

namespace pelagic::cli::help {

const char* const kProgram =
    "Pelagic bakes the open sea: a shot file in, moving meshes and maps for renderers out.";
const char* const kProgramFooter =
    "Examples:\n"
    "  pelagic bake storm.toml --out storm     every frame, into the folder storm\n"
    "  pelagic render storm.toml --out storm   pictures of it, OpenEXR and PNG\n"
    "  pelagic preview storm.toml              a window that plays it\n"
    "  pelagic explain storm.toml              what a bake will compute, and why\n"
    "  pelagic validate shots/*.toml           check shot files without baking\n"
    "  pelagic keys                            all that a shot file can say\n"
    "\n"
    "\"pelagic VERB --help\" has more on each verb.\n"
    "\n"
    "Exit status: 0 when everything that was asked for is complete; 1 when a shot file is\n"
    "refused or a file can't be read or written; 2 for a mistake on the command line; 128 and\n"
    "the signal's number when stopped by one (130: Ctrl-C).";
const char* const kVersion = "Print the version and what the program was built with, and exit";
const char* const kVerbs = "Verbs";
const char* const kHelp = "Print this help and exit";

const char* const kShot = "The shot file; an empty one is a good-looking sea (see: pelagic keys)";
const char* const kShots = "The shot files";

const char* const kBake =
    "Bake a shot into a USD stage, OpenEXR maps and a record of the sea.\n"
    "Running it again keeps the frames that are whole and belong to this very shot, and\n"
    "bakes the others.";
const char* const kBakeFooter =
    "Examples:\n"
    "  pelagic bake storm.toml                      every frame, into a folder of the shot's name\n"
    "  pelagic bake storm.toml --out /data/storm    somewhere else\n"
    "  pelagic bake storm.toml --frames 1-48x8      every eighth frame, to look at first\n"
    "  pelagic bake storm.toml --frames 7           one frame: the same as in a run of all\n"
    "\n"
    "Every file appears under its name only when it is whole. Ctrl-C stops after the file at\n"
    "hand, a second Ctrl-C at once; either way the same command goes on from there.";
const char* const kOut =
    "The folder for the files, made where it is missing.\n"
    "Default: a folder in the working folder, named as the shot";
const char* const kFrames =
    "Which of the shot's frames: 1-48, 7, or 1-48x5 for every fifth.\n"
    "Default: all of them";
const char* const kThreads =
    "How many threads, 1 to 256; the files don't depend on it.\n"
    "Default: one for each core that the process may use";

const char* const kRender =
    "Render pictures of a shot through its camera: OpenEXR with layers, and PNG.\n"
    "The sea as the preview shows it, computed on the CPU. Each frame leaves DIR/NAME.####.exr\n"
    "(R, G, B and the layers sun, sky, sea and foam, which add up to them) and DIR/NAME.####.png.";
const char* const kRenderFooter =
    "Examples:\n"
    "  pelagic render storm.toml --out storm             every frame\n"
    "  pelagic render storm.toml --frames 12 --size 640x360 --samples 1\n"
    "                                                    one, small and fast, to look at first\n"
    "  pelagic render storm.toml --frames 12 --terms sun the glitter alone\n"
    "\n"
    "The PNG's exposure follows from the light, so that a camera that turns keeps its\n"
    "brightness. Frames don't depend on one another, nor on the number of threads.";
const char* const kSize =
    "The pictures' width and height in pixels.\n"
    "Default: the shot's camera.resolution";
const char* const kExposure =
    "Stops by which the PNG is brighter, or darker below 0: twice the light for each";
const char* const kSamples =
    "N × N samples a pixel, 1 to 16.\n"
    "Default: from the shot's quality.level: 1 for draft and preview, 2 for final, 4 for reference";
const char* const kSkyQuality =
    "How the sky's reflection is found: one (lookup), nine, integral.\n"
    "Default: from the shot's quality.level: one for draft, integral for reference, else nine";
const char* const kTerms =
    "Which of the light there is: sun, sky, sea, foam, with commas between.\n"
    "Default: all of them";

const char* const kPreview =
    "Play a shot in a window, in real time, and turn what it is made of.\n"
    "The pictures are those of pelagic render, drawn by OpenGL 3.3. A changed wind is built beside\n"
    "the sea that plays. F1 in the window says how to move.";
const char* const kPreviewFooter =
    "Examples:\n"
    "  pelagic preview storm.toml                            a window\n"
    "  pelagic preview storm.toml --scale 4 --quality draft  where there is no graphics card\n"
    "  pelagic preview storm.toml --offscreen storm.png --frame 12 --size 640x360\n"
    "                                                        one picture, without a display (EGL)\n"
    "\n"
    "The window's \"Copy as shot file\" puts the keys that you changed on the clipboard.";
const char* const kOffscreen =
    "Draw one frame into a file and open no window: an .exr with the layers sun, sky,\n"
    "sea and foam, or a .png. Needs no display";
const char* const kFrame =
    "With --offscreen which frame, otherwise where to begin, paused.\n"
    "Default: the shot's first; the window plays on from there";
const char* const kPreviewSize =
    "The window's, or the picture's, width and height in pixels.\n"
    "Default: the shot's camera.resolution, the window's no larger than the screen";
const char* const kPreviewQuality = "Instead of the shot's quality.level: draft, preview, final, reference";
const char* const kScale =
    "Draw fewer pixels than the window has: each covers 1, 2 × 2 or 4 × 4 of them.\n"
    "Also in the window's panel. Default: 1";
const char* const kScreenshot =
    "Save the window with its panel as a .png after some pictures, and close: to try\n"
    "the window without a hand, under Xvfb for one";
const char* const kAfter = "With --screenshot: after how many pictures that show the sea. Default: 8";
const char* const kPreviewThreads =
    "How many threads compute the sea, 1 to 256.\n"
    "Default: one for each core that the process may use";

const char* const kExplain =
    "Print what a bake will compute, and why.\n"
    "Each output, what it needs, the transforms with their sizes, and the memory. Bakes nothing.";
const char* const kExplainFooter =
    "Examples:\n"
    "  pelagic explain storm.toml\n"
    "  pelagic explain storm.toml | less\n"
    "  pelagic explain storm.toml --measure    what each output and effect costs\n"
    "\n"
    "--measure computes frames, with and without each item in turn, and writes no file. It\n"
    "takes some two seconds an item, longer where a frame takes seconds; Ctrl-C ends it, and\n"
    "the rows that are there stay right. Work that two items share is in neither's row.";
const char* const kMeasure =
    "Compute frames to measure what each effect and output adds: transforms,\n"
    "bytes and milliseconds of the frame with it less the frame without it";
const char* const kMeasureThreads =
    "With --measure: how many threads, 1 to 256.\n"
    "Default: one for each core that the process may use";

const char* const kValidate =
    "Check shot files without baking them.\n"
    "A summary of each file that is fine, and of the others every problem with line and column.\n"
    "Measured spectra that a file names are read as well.";
const char* const kValidateFooter =
    "Examples:\n"
    "  pelagic validate storm.toml\n"
    "  pelagic validate shots/*.toml";

const char* const kKeys =
    "Print every key of a shot file.\n"
    "With its default, its unit, what it accepts and what it does.";
const char* const kKeysFooter =
    "Examples:\n"
    "  pelagic keys\n"
    "  pelagic keys | grep wind";

std::string version_text() {
#ifdef __clang__
    const std::string compiler = "clang " __clang_version__;
#else
    const std::string compiler = "g++ " __VERSION__;
#endif
    return "pelagic " PELAGIC_VERSION "\nbuilt with " + compiler +
           " for " PELAGIC_PROCESSOR " (" PELAGIC_BUILD_TYPE "), oneTBB " TBB_VERSION_STRING
           ", CLI11 " CLI11_VERSION;
}

}  // namespace pelagic::cli::help
