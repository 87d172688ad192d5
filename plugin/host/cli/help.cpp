// All help texts of the command line. See help.h.
#include "plugin/host/cli/help.h"

#include "core/base/instruction_set.h"
#include "pelagic/version.h"

namespace pelagic::cli::help {

const char* const kProgram =
    "Pelagic bakes the open sea: a shot file in, moving meshes and maps for renderers out.";
const char* const kProgramFooter =
    "Examples:\n"
    "  pelagic bake storm.toml --out storm     every frame, into the folder storm\n"
    "  pelagic render storm.toml --out storm   pictures of it, OpenEXR and PNG\n"
    "  pelagic preview storm.toml              a window that plays it\n"
    "  pelagic explain storm.toml              what a bake will compute, and why\n"
    "  pelagic accuracy storm.toml             what accuracy costs, measured\n"
    "  pelagic verify storm                    check the files that were written\n"
    "  pelagic farm storm.toml --out storm     share a shot out among a farm's machines\n"
    "  pelagic validate shots/*.toml           check shot files without baking\n"
    "  pelagic keys                            every key of a shot file\n"
    "  pelagic presets                         seas that a shot file can begin with\n"
    "  pelagic calibrate                       what quality.frame_ms costs on this machine\n"
    "\n"
    "\"pelagic VERB --help\" has more on each verb.\n"
    "\n"
    "Exit status:\n"
    "  0        everything that was asked for is whole\n"
    "  1        an error that nobody knows; please report it\n"
    "  2        what was asked for can't be, and the same again gives the same: the command line, a shot\n"
    "           file, a folder that may not be written into (permissions, /proc), more memory than\n"
    "           --max-memory allows, a part that this machine lacks\n"
    "  3        not whole: verify or farm --status found something missing or wrong\n"
    "  75       try again, later or on another machine: the disk (full, failing, read-only, gone), memory, threads,\n"
    "           or another run that was first\n"
    "  128 + N  stopped by signal N (130: Ctrl-C)";
const char* const kVersion = "Print the version and what the program was built with, and exit";
const char* const kVerbs = "Verbs";
const char* const kHelp = "Print this help and exit";

const char* const kShot = "The shot file; an empty one gives a good-looking sea (see: pelagic keys)";
const char* const kShots = "The shot files";

const char* const kBake =
    "Bake a shot into a USD stage, OpenEXR maps and a record of the sea.\n"
    "Run again, it reads what is there, keeps the files that are whole and belong to exactly\n"
    "this shot, and bakes the others.";
const char* const kBakeFooter =
    "Examples:\n"
    "  pelagic bake storm.toml                      every frame, into a folder of the shot's name\n"
    "  pelagic bake storm.toml --out /data/storm    into another folder\n"
    "  pelagic bake storm.toml --frames 1-48x8      every eighth frame, for a first look\n"
    "  pelagic bake storm.toml --frames 7           one frame, the same as in a full run\n"
    "\n"
    "A file appears under its name only when it is complete. Ctrl-C stops after the current\n"
    "file, a second Ctrl-C at once. The same command then continues.";
const char* const kOut =
    "The folder for the files; created if it is missing.\n"
    "Default: a folder in the working folder, named after the shot";
const char* const kFrames =
    "Which of the shot's frames: 1-48, 7, 1-48x5 for every fifth, or 1,5,10-20x5.\n"
    "Default: all of them";
const char* const kThreads =
    "How many threads, 1 to 256; the files don't depend on it.\n"
    "Default: one for each core that the process may use";

const char* const kInstructionSet =
    "No wider vectors than these: sse4, avx2 or avx512. CPUs that have them make the same bytes\n"
    "then; files that another set made are made again.\n"
    "Default: the widest that this CPU has, and whole files stay, whatever made them";

const char* const kVerifySet =
    "Frames and pictures that another set has made aren't whole: sse4, avx2 or avx512.\n"
    "Default: any set will do, and a note says of a shot that several have";

const char* const kMaxMemory =
    "Refuse a shot that would take more memory than this, before any work (exit status 2): 8G, 512M.\n"
    "Default: what the machine has, or less where a container or ulimit allows less";
const char* const kPreviewMaxMemory =
    "Refuse a picture that would take more memory than this, before any work (exit status 2): 8G,\n"
    "512M. A window draws less instead, and says so.\n"
    "Default: what the machine has, or less where a container or ulimit allows less";

const char* const kTrustTimes =
    "Don't read the files that are there: those of the recorded size that are no newer than the\n"
    "record count as whole. Faster for many gigabytes, and damage goes unnoticed";

const char* const kChosen =
    "What the shot's budget was settled to, in the words of its record (\"chosen\"): for tasks that each make\n"
    "a part of the shot. pelagic farm gives it";
const char* const kJson =
    "Say it for programs: an object a line on stdout, with \"event\": progress, message, result or end";

const char* const kFarm =
    "Share a shot out among a farm's machines: a job array for Slurm.\n"
    "Writes DIR/farm/NAME.VERB.sh, each of whose tasks makes a part of the frames, and NAME.VERB.verify.sh,\n"
    "which checks them when all have ended; of a part of the shot (--frames) NAME.VERB.FIRST-LAST.sh and so on.\n"
    "A budget is settled here, once for all of them; how many frames a task has, its memory and its cores\n"
    "follow from what a frame costs by the shot's plan.\n"
    "Bakes nothing itself. Further options are those of bake and render, and the tasks get them.";
const char* const kFarmFooter =
    "Examples:\n"
    "  pelagic farm storm.toml --out /data/storm                   writes the scripts, and says how to submit them\n"
    "  pelagic farm storm.toml --out /data/storm --submit          and submits them with sbatch\n"
    "  pelagic farm storm.toml --out /data/storm --verb render --samples 4 --sbatch=--partition=night\n"
    "  pelagic farm --status /data/storm                           whole, running, failed and missing frames\n"
    "  bash /data/storm/farm/storm.bake.sh 3                       task 3 without Slurm, for any other queue\n"
    "\n"
    "A task may be killed, begun again, run twice at once or lost with its machine: nothing is torn, and the\n"
    "same array again makes what is missing. It asks Slurm to begin it again where it ends with status 75 or is\n"
    "killed, three times at most. Its log is DIR/farm/NAME.VERB.FIRST-LAST.log.\n"
    "\n"
    "Exit status of --status: 0 if all frames are there, as the shot was when it was shared out, 3 if not.";
const char* const kFarmOut =
    "The folder for the files and, in its folder farm, the scripts and logs.\n"
    "Default: a folder in the working folder, named after the shot";
const char* const kFarmThreads =
    "How many cores and threads a task has, 1 to 256.\n"
    "Default: one for each 4 GiB of its memory";
const char* const kFarmVerb = "What each task runs: bake or render. Default: bake";
const char* const kFarmSubmit = "Submit both jobs with sbatch";
const char* const kFarmStatus =
    "Say what is whole, missing, running and failed, of the jobs that were written into this folder, or of one\n"
    "by its DIR/farm/NAME.VERB.json: from the record or what the pictures say of themselves, the tasks' logs,\n"
    "and squeue where there is one";
const char* const kFarmTasks =
    "How many tasks, 1 to 1000.\n"
    "Default: so many that each takes about --minutes";
const char* const kFarmMinutes = "How long a task should take, in minutes, 0.1 to 1440. Default: 10";
const char* const kFarmSbatch =
    "An option for sbatch, as --sbatch=--partition=night; may be given several times. Of both jobs (--array of\n"
    "the array alone), and in place of what Pelagic itself asks for";

const char* const kRender =
    "Render pictures of a shot through its camera: OpenEXR with layers, and PNG.\n"
    "The same sea as in the preview, computed on the CPU. Each frame gives DIR/NAME.####.png\n"
    "and DIR/NAME.####.exr with R, G, B and the layers sun, sky, sea, foam and air, which add up to\n"
    "them.";
const char* const kRenderFooter =
    "Examples:\n"
    "  pelagic render storm.toml --out storm             every frame\n"
    "  pelagic render storm.toml --frames 12 --size 640x360 --samples 1\n"
    "                                                    one frame, small and fast\n"
    "  pelagic render storm.toml --frames 12 --terms sun only the glitter\n"
    "  pelagic render storm.toml --shutter 0.5 --samples 4 --alpha --layers all\n"
    "                                                    for compositing\n"
    "  pelagic render storm.toml --frames 12 --overscan 10%\n"
    "                                                    with pixels round the picture\n"
    "  pelagic render storm.toml --ocio env --primaries acescg\n"
    "                                                    in a studio's colours\n"
    "\n"
    "The PNG's exposure is metered from the light and the sea in view, once for the whole shot\n"
    "(at the camera's keys), so that a turning camera keeps its brightness; where light or water have\n"
    "keys, for each frame's light. Such a frame has its own sky, also while the shutter is open.\n"
    "A frame doesn't depend on other frames or on the number of threads.\n"
    "surface.beyond decides whether a patch or a cage lies in the open sea or before nothing but sky.\n"
    "camera.f_stop blurs what isn't in focus by the samples, too. camera.white_balance_k and\n"
    "camera.glare are for the PNG; the EXR holds the light itself.\n"
    "\n"
    "Layers of the EXR, as Nuke and Blender read them:\n"
    "  sun, sky, sea, foam, air  .R .G .B  the light by its source; their sum is R, G, B\n"
    "  depth           Z              along the camera's axis, in metres; 1e10 in the sky\n"
    "  position        P.X .Y .Z      in the world, z up, in metres\n"
    "  normal          N.X .Y .Z      of the waves that the pixel resolves, in the world\n"
    "  motion          forward.u .v, backward.u .v   in pixels, u right, v up: to where the\n"
    "                                 next frame, and the one before, shows the same water (Nuke)\n"
    "  vector          Vector.X … .W  the same for Blender's Vector Blur, as Speed\n"
    "  coverage        coverage.X     the share of the sea that whitecaps cover\n"
    "  slope_variance  slope_variance.X .Y .Z        xx, yy, xy of the slopes that the pixel hides\n"
    "  foam_active     foam_active.X  the share that breaks now\n"
    "  foam_age        foam_age.X     how old the foam is, in seconds; what breaks counts as 0\n"
    "Of shots with objects:\n"
    "  object, reflection  .R .G .B   their light, and what the sea mirrors and shows of them, less\n"
    "                                 what it would show without: parts of the sum, also below 0\n"
    "  shadow          shadow.X       the share of the sun that no object hides\n"
    "  cryptomatte     CryptoObject00 … 02.r .g .b .a   mattes of the objects, and of \"sea\"\n"
    "Light is a mean over the pixel and the shutter's time. The others are those of the sample in\n"
    "the pixel's middle at the frame's own time: a mean of depths is a depth that isn't there.";
const char* const kSize =
    "The pictures' width and height in pixels.\n"
    "Default: the shot's camera.resolution";
const char* const kOverscan =
    "Pixels round the picture, through the same lens, for distortion and shake in the composite: 10% of\n"
    "its width at the left and the right and of its height above and below, or 64 pixels on all sides;\n"
    "up to half of it. The EXR's data window has them, its display window is the picture, and so is\n"
    "the PNG. Default: none";
const char* const kRegion =
    "Compute these pixels alone: X0,Y0,X1,Y1 from the picture's upper left corner, x to the right and\n"
    "y down, X1 and Y1 not among them, as the EXR's data window counts (that one names the last\n"
    "pixel). They are the whole picture's own, to the bit. The PNG is cut to them, and its camera.glare\n"
    "is that of their light alone. Below 0 with --overscan: --region=-20,0,100,50.\n"
    "The files have the whole picture's names, so each region needs an --out. Default: all";
const char* const kExposure =
    "Stops by which the PNG is brighter (or darker, if negative): each doubles the light";
const char* const kSamples =
    "N × N samples per pixel, 1 to 16.\n"
    "Default: what the shot's budget asks for (quality.max_error, quality.frame_ms), or from its\n"
    "quality.level: 1 for draft and preview, 2 for final, 4 for reference";
const char* const kSkyQuality =
    "How the sky's reflection is computed: one (lookup, over the ellipse of the slopes), nine, integral.\n"
    "Against the integral one errs by some 10 % of the reflected sky, nine by 3 %.\n"
    "Default: what the shot's budget asks for, or from its quality.level: one for draft, integral for\n"
    "reference, otherwise nine";
const char* const kTerms =
    "The terms of the light: sun, sky, sea, foam, and the air and the spray before them, separated by commas.\n"
    "Default: all of them";

const char* const kShutter =
    "How long the shutter is open, in frames: 0.5 is half a frame (180°), around the frame's own\n"
    "time. Sea and camera move; each of a pixel's N × N samples has a moment of its own, chosen by\n"
    "chance: few leave grain, so take more --samples for fast cameras; one a pixel is sharp. 0 to 4.\n"
    "Default: 0, no motion blur";
const char* const kAlpha =
    "Transparent where there is neither sea nor object: no sky behind it, and A, by which the light is multiplied\n"
    "(in the PNG it isn't, as that format wants)";
const char* const kDeep =
    "NAME.deep.####.exr as well, for compositing in depth: of each pixel the sea, the objects and the spray\n"
    "by their distance, with identifiers as the layer cryptomatte has them. Needs --alpha; not with --shutter.\n"
    "About half of the EXR's bytes, and hardly any time; of spray up to 4 times the bytes, and twice as long";
const char* const kLayers =
    "The layers of the EXR beside R, G, B, separated by commas; or all, or none. See below.\n"
    "Default: sun,sky,sea,foam,air,object,reflection";

const char* const kOcio =
    "The OpenColorIO configuration by which the PNG shows the light, in place of our own curve: the\n"
    "path of a config.ocio, or env for the one that the variable OCIO names";
const char* const kOcioDisplay = "Its display. Default: its own";
const char* const kOcioView = "Its view. Default: the display's own";
const char* const kOcioSpace =
    "What it calls linear Rec. 709. Default: by its role aces_interchange, or a usual name";
const char* const kPrimaries =
    "The colours of the EXR's light: rec709 or acescg.\n"
    "Default: rec709";

const char* const kTrustPictures =
    "Don't read the pictures that are there in full: those with the right beginning and end\n"
    "count as whole. Faster for many gigabytes, and damage goes unnoticed";

const char* const kPreview =
    "Play a shot in a window, in real time, and change it while it plays.\n"
    "The pictures are those of pelagic render, drawn with OpenGL 3.3. When the wind changes, the\n"
    "new sea is built while the old one plays. F1 in the window shows the controls.";
const char* const kPreviewFooter =
    "Examples:\n"
    "  pelagic preview storm.toml                            a window\n"
    "  pelagic preview storm.toml --scale 4 --quality draft  without a graphics card\n"
    "  pelagic preview storm.toml --offscreen storm.png --frame 12 --size 640x360\n"
    "                                                        one picture, without a display (EGL)\n"
    "\n"
    "The window's \"Save shot\" writes the keys that you changed into the shot's file, and keeps the\n"
    "rest of it; \"Copy\" puts them on the clipboard.";
const char* const kOffscreen =
    "Draw one frame into a file, without a window or display: an .exr with the layers sun, sky,\n"
    "sea and foam, or a .png";
const char* const kFrame =
    "The frame to draw (with --offscreen), or the frame to start at, paused.\n"
    "Default: the shot's first; the window then plays";
const char* const kPreviewSize =
    "Width and height of the window or picture in pixels.\n"
    "Default: the shot's camera.resolution; a window is no larger than the screen";
const char* const kPreviewQuality =
    "Instead of the shot's quality.level: draft, preview, final, reference.\n"
    "Budgets (quality.max_error, quality.frame_ms) are of bakes and renders, not of previews";
const char* const kScale =
    "Draw fewer pixels than the window has: each covers N × N of them, N = 1, 2 or 4.\n"
    "Also in the window's panel. Default: 1, or 2 where the processor draws";
const char* const kScreenshot =
    "Save the window with its panel as a .png after some pictures, and close it: for tests\n"
    "without a user, for example under Xvfb";
const char* const kAfter = "With --screenshot: the number of pictures of the sea to draw before. Default: 8";
const char* const kPreviewThreads =
    "How many threads compute the sea, 1 to 256.\n"
    "Default: one for each core that the process may use";

const char* const kNoPreview =
    "This program has no preview. The tarball's has none: what draws is the system's, which a program\n"
    "with a C library of its own can't load. Debian's package pelagic has one, and a build that was\n"
    "configured with -DPELAGIC_PREVIEW=ON.\n"
    "Without a window: pelagic render SHOT.toml --frames 1 --size 640x360 --samples 1";

const char* const kExplain =
    "Print what a bake will compute, and why.\n"
    "Each output and what it needs, the transforms and their sizes, and the memory. Bakes nothing.";
const char* const kExplainFooter =
    "Examples:\n"
    "  pelagic explain storm.toml\n"
    "  pelagic explain storm.toml | less\n"
    "  pelagic explain storm.toml --measure    the cost of each output and effect\n"
    "\n"
    "--measure computes frames with and without each item in turn, and writes no file. It takes\n"
    "some two seconds per item, longer if a frame takes seconds. After Ctrl-C the printed rows\n"
    "remain valid. Work that two items share is in neither's row.";
const char* const kMeasure =
    "Compute frames, and measure what each effect and output adds in transforms,\n"
    "bytes and milliseconds: a frame with it minus a frame without it";
const char* const kMeasureThreads =
    "With --measure: how many threads, 1 to 256.\n"
    "Default: one for each core that the process may use";

const char* const kAccuracy =
    "Measure what accuracy costs on a shot: error against time for each approximation.\n"
    "Also what each effect that is on costs a picture and a bake.\n"
    "Sweeps the knob of each, with errors against a named reference and times of the same run, and\n"
    "writes DIR/accuracy.html with plots, accuracy.csv, accuracy.txt and ROW.svg. Rows that were measured before\n"
    "stay, with their age.";
const char* const kAccuracyFooter =
    "Examples:\n"
    "  pelagic accuracy                             the default sea, every row: some minutes\n"
    "  pelagic accuracy storm.toml --out storm-accuracy\n"
    "  pelagic accuracy storm.toml --out storm-accuracy --rows sky,samples\n"
    "                                               two rows again; the others stay\n"
    "  pelagic accuracy storm.toml --rows picture-effects,bake-effects\n"
    "                                               the price of each effect and output\n"
    "\n"
    "Times are medians of settings that are measured in turn, so that they compare within a row, also on\n"
    "a machine with other work. Of a shot with a budget, rows start from what it chose for the mesh.";
const char* const kAccuracyShot = "The shot file. Default: the default sea";
const char* const kAccuracyOut =
    "The folder for the report; created if it is missing.\n"
    "Default: NAME-accuracy in the working folder";
const char* const kAccuracyRows =
    "Measure only these rows, separated by commas (see --list).\n"
    "Default: all of them";
const char* const kAccuracyRepeats = "How often each setting is timed. Default: 5";
const char* const kAccuracyPictures =
    "Also write the pictures that the rows compare: DIR/pictures/ROW.N.exr and .png, N being the\n"
    "setting's place in the row";
const char* const kAccuracyList = "Print the rows with their knobs, and exit";
const char* const kAccuracyThreads =
    "How many threads compute, 1 to 256.\n"
    "Default: one for each core that the process may use";

const char* const kVerify =
    "Check that everything in a folder is as it was written.\n"
    "Reads the files of all shots that were baked there, and the pictures, and names each that is\n"
    "  missing      recorded and not there, or a frame of the shot that isn't baked\n"
    "  damaged      not the bytes that were written, or a record with a changed number\n"
    "  stale        a frame of another version of the shot than the record's, or of another --instruction-set\n"
    "  foreign      named as a bake's files are, and in no record\n"
    "  interrupted  of a bake that was stopped before it wrote its record\n"
    "A frame that a bake is at, or was stopped at, is missing or stale: its files aren't named one by one.\n"
    "Deletes and repairs nothing: the next bake or render makes again what is missing, damaged or stale.\n"
    "Where a shot is whole, what its tasks have recorded becomes DIR/NAME.json, as a single bake leaves it;\n"
    "not of one of more than 32768 frames, where it stays beside that.";
const char* const kVerifyFooter =
    "Examples:\n"
    "  pelagic verify storm\n"
    "  pelagic verify shots/* && rsync …\n"
    "\n"
    "A picture whose .exr and .png are both gone isn't missed: pictures have no record.\n"
    "\n"
    "Exit status: 0 if every folder is whole; 3 if something isn't as it was written,\n"
    "if a folder holds nothing to check, or can't be read; 2 for an error on the command line; 128\n"
    "plus the signal's number if it was stopped (130: Ctrl-C).";
const char* const kFolders = "The folders that were baked or rendered into";
const char* const kVerifyThreads =
    "How many threads read, 1 to 256.\n"
    "Default: one for each core that the process may use";

const char* const kValidate =
    "Check shot files without baking them.\n"
    "Prints a summary of each valid file, and for others every problem with line and column.\n"
    "Measured spectra and sky pictures that a shot file names are looked at as well.";
const char* const kValidateFooter =
    "Examples:\n"
    "  pelagic validate storm.toml\n"
    "  pelagic validate shots/*.toml";

const char* const kKeys =
    "Print every key of a shot file.\n"
    "With its default, unit, accepted values and meaning.";
const char* const kKeysFooter =
    "Examples:\n"
    "  pelagic keys\n"
    "  pelagic keys | grep wind\n"
    "\n"
    "Where \"or { keys = [[frame, number], …] }\" stands, the number can change over the shot:\n"
    "  sun_elevation_deg = { keys = [[1, 9.0], [96, -1.0]], interpolation = \"smooth\" }\n"
    "\"linear\", the default, goes straight from key to key; \"smooth\" never beyond them. Before the first\n"
    "key and after the last their numbers hold; angles turn the short way. Not in a loop (shot.loop_s).";

const char* const kPresets =
    "List the named seas, or print one.\n"
    "A shot file that begins with preset = \"NAME\" lies on top of it: sea, light, camera and water, or those that\n"
    "preset_parts = [\"sea\", …] beside it names; water.bubbles is of the sea, as foam is.";
const char* const kPresetName = "Print this one's keys, as a shot file has them";
const char* const kPresetSheet = "Draw a small picture of each into this file";
const char* const kPresetsFooter =
    "Examples:\n"
    "  pelagic presets\n"
    "  pelagic presets beaufort-7\n"
    "  pelagic presets --sheet presets.png    a small picture of each; a minute or two";

const char* const kCalibrate =
    "Measure this machine anew, for shots with quality.frame_ms.\n"
    "A few seconds of small seas and pictures say how long it takes for what a frame consists of. That is kept\n"
    "in the user's cache folder ($XDG_CACHE_HOME/pelagic or ~/.cache/pelagic) for the version, the CPU, the\n"
    "number of threads and its vectors. A shot with quality.frame_ms measures by itself where nothing is kept.";
const char* const kCalibrateFooter =
    "Examples:\n"
    "  pelagic calibrate                after other work slowed the machine, or its cooling changed\n"
    "  pelagic calibrate --threads 4    for runs with --threads 4";

std::string version_text() {
#ifdef __clang__
    const std::string compiler = "clang " __clang_version__;
#else
    const std::string compiler = "g++ " __VERSION__;
#endif
    return "pelagic " PELAGIC_VERSION "\nbuilt with " + compiler +
           " for " PELAGIC_PROCESSOR " (" PELAGIC_BUILD_TYPE ")\nparts: " PELAGIC_PARTS
           "\nlibraries: " PELAGIC_LIBRARIES "\ninstruction set on this machine: " +
           instruction_set();
}

}  // namespace pelagic::cli::help
