// Curves as a PNG, by gnuplot where it is installed.
#pragma once

#include <string>
#include <vector>

namespace pelagic::bench {

struct Curve {
    std::string name, colour;  // colour: #rrggbb
    std::vector<double> values;
};

struct Panel {
    std::string title, key;  // key: where the curves' names stand, "left top"
    std::vector<Curve> curves;
};

struct Sheet {
    std::string path;     // of the PNG
    std::string x_label;  // of the last row
    int columns = 3;
    std::vector<Panel> panels;  // row after row
};

// false, with a line on stdout that says why, where there is no gnuplot or it fails.
bool plot(const Sheet& sheet);

}  // namespace pelagic::bench
