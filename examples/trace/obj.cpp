#include "obj.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

namespace pelagic::trace {
namespace {

glm::vec3 point_of(std::istringstream& words, glm::vec3& colour) {
    glm::vec3 point;
    if (!(words >> point.x >> point.y >> point.z)) throw std::runtime_error("a point needs three numbers");
    const auto is_small = [](float x) { return std::abs(x) <= 1e6f; };  // no NaN either
    if (!is_small(point.x) || !is_small(point.y) || !is_small(point.z))
        throw std::runtime_error("a point is more than 1e6 m away");
    if (glm::vec3 given; words >> given.x >> given.y >> given.z)
        colour = glm::clamp(given, glm::vec3(0.0f), glm::vec3(1.0f));
    return point;
}

// "7", "7/1", "7//3": the point's index, from 1 on; negative ones count from the last.
std::uint32_t corner_of(const std::string& word, std::size_t points) {
    const std::string digits = word.substr(0, word.find('/'));
    long index = 0;
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    if (problem != std::errc() || end != digits.data() + digits.size())
        throw std::runtime_error("\"" + word + "\" is no corner");
    const auto count = static_cast<long>(points);
    if (index < 0) index += count + 1;
    if (index < 1 || index > count)
        throw std::runtime_error("corner " + word + ": there are " + std::to_string(count) +
                                 " points before it");
    return static_cast<std::uint32_t>(index - 1);
}

}  // namespace

FloatingObject read_obj(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error(file.string() + ": can't be read; give an OBJ file that is there");
    FloatingObject object;
    Mesh& shown = object.shown;
    bool is_dry = false;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) try {
            std::istringstream words(line);
            std::string kind, word;
            words >> kind;
            if (kind == "o" || kind == "g") {
                is_dry = words >> word && word == "dry";
            } else if (kind == "v") {
                glm::vec3 colour(0.5f);
                shown.points.push_back(point_of(words, colour));
                shown.colours.push_back(colour);
            } else if (kind == "f") {
                std::vector<std::uint32_t> corners;
                while (words >> word) corners.push_back(corner_of(word, shown.points.size()));
                if (corners.size() < 3) throw std::runtime_error("a face needs three corners or more");
                for (std::size_t i = 2; i < corners.size(); ++i)
                    (is_dry ? object.dry : shown)
                        .triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
            }
        } catch (const std::runtime_error& problem) {
            throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": " + problem.what());
        }
    if (in.bad()) throw std::runtime_error(file.string() + ": can't be read to its end");
    if (shown.triangles.empty()) throw std::runtime_error(file.string() + ": has no faces");
    if (!object.dry.triangles.empty()) {
        object.dry.points = shown.points;
        object.dry.colours = shown.colours;
    }
    return object;
}

}  // namespace pelagic::trace
