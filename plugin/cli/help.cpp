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
