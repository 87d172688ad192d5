// Pipes everything to gnuplot. See plot.h.
#include "tests/bench/reference/plot.h"

#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>

namespace pelagic::bench {

bool plot(const Sheet& sheet) {
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) {
        std::printf("no plot: install gnuplot-nox for %s\n", sheet.path.c_str());
        return false;
    }
    std::FILE* pipe = popen("gnuplot", "w");
    if (!pipe) {
        std::printf("no plot: gnuplot does not start\n");
        return false;
    }
    const int rows = (static_cast<int>(sheet.panels.size()) + sheet.columns - 1) / sheet.columns;
    std::fprintf(pipe,
                 "set terminal png size %d,%d font ',11' enhanced\nset output '%s'\n"
                 "set multiplot layout %d,%d\nset grid lc rgb '#dddddd'\nset yrange [0:*]\n",
                 420 * sheet.columns, 330 * rows, sheet.path.c_str(), rows, sheet.columns);
    for (std::size_t p = 0; p < sheet.panels.size(); ++p) {
        const Panel& panel = sheet.panels[p];
        std::fprintf(pipe, "set title \"%s\"\nset xlabel \"%s\"\nset key %s\nplot ", panel.title.c_str(),
                     sheet.x_label.c_str(), panel.key.c_str());
        for (std::size_t c = 0; c < panel.curves.size(); ++c)
            std::fprintf(pipe, "%s'-' using 1:2 with lines lw 2 lc rgb '%s' title \"%s\"", c ? ", " : "",
                         panel.curves[c].colour.c_str(), panel.curves[c].name.c_str());
        std::fprintf(pipe, "\n");
        for (const Curve& curve : panel.curves) {
            for (std::size_t i = 0; i < curve.values.size(); ++i)
                std::fprintf(pipe, "%zu %.6g\n", i, curve.values[i]);
            std::fprintf(pipe, "e\n");
        }
    }
    std::fprintf(pipe, "unset multiplot\n");
    const int status = pclose(pipe);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        std::printf("no plot: gnuplot failed\n");
        return false;
    }
    std::printf("plot: %s\n", sheet.path.c_str());
    return true;
}

}  // namespace pelagic::bench
