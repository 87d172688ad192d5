// The program "pelagic".
#include "plugin/cli/program.h"

int main(int argc, char** argv) {
    return pelagic::cli::run_program(argc, argv);
}
