// Curves as a PNG, by gnuplot if it is installed.
#pragma once

#include <string>
#include <vector>

namespace pelagic::bench {

struct Curve {
    std::string name, colour;  // colour: #rrggbb
    std::vector<double> values;
};

struct Panel {
    std::string title, key;  // key: the place of the legend, "left top"
    std::vector<Curve> curves;
};

struct Sheet {
    std::string path;     // of the PNG
    std::string x_label;  // of the last row
    int columns = 3;
    std::vector<Panel> panels;  // row after row
};

// Returns false, with a reason on stdout, if gnuplot isn't there or fails.
bool plot(const Sheet& sheet);

}  // namespace pelagic::bench
