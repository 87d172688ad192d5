// Shot files of cases that have broken somebody's ocean (the folder shots). The first lines of each say what must come of it:
//   # What it is
//   # load: fine, or a part of the message that refuses it
//   # picture: fine, any (a picture, or a message), or a part of the message that refuses its picture
//   # limit: none, calm (no point higher than 10 cm) or flat (z is 0 and normals point up)
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace pelagic::test {

struct HardCase {
    std::filesystem::path file;
    std::string load, picture, limit;
    bool loads() const { return load == "fine"; }
    friend std::ostream& operator<<(std::ostream& out, const HardCase& hard) {
        return out << hard.file.filename().string();
    }
};

inline std::vector<HardCase> hard_cases() {
    std::vector<HardCase> cases;
    for (const auto& entry : std::filesystem::directory_iterator(PELAGIC_HARD_CASES)) {
        if (entry.path().extension() != ".toml") continue;
        HardCase hard{.file = entry.path(), .load = {}, .picture = {}, .limit = {}};
        std::ifstream stream(entry.path());
        for (std::string line; std::getline(stream, line) && line.starts_with('#');)
            for (const auto& [name, member] :
                 {std::pair{"# load: ", &HardCase::load}, std::pair{"# picture: ", &HardCase::picture},
                  std::pair{"# limit: ", &HardCase::limit}})
                if (line.starts_with(name)) hard.*member = line.substr(std::string(name).size());
        if (hard.load.empty() || hard.picture.empty() || hard.limit.empty())
            throw std::runtime_error(entry.path().string() + " doesn't say what must come of it");
        cases.push_back(std::move(hard));
    }
    std::sort(cases.begin(), cases.end(),
              [](const HardCase& a, const HardCase& b) { return a.file < b.file; });
    return cases;
}

// For names of tests: "wind_0_1".
inline std::string name_of(const HardCase& hard) {
    std::string name = hard.file.stem().string();
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '-' || c == '.'; }, '_');
    return name;
}

}  // namespace pelagic::test
