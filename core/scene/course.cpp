#include "core/scene/course.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>
#include <string>

namespace pelagic {

std::optional<std::vector<CourseKey>> course_of(std::string_view path, std::size_t* wrong) {
    std::vector<CourseKey> keys;
    for (std::size_t from = 0; from <= path.size();) {
        const std::size_t end = std::min(path.find(',', from), path.size());
        std::istringstream words{std::string(path.substr(from, end - from))};
        words.imbue(std::locale::classic());
        CourseKey key;
        std::string more;
        if (!(words >> key.frame >> key.east_m >> key.north_m) || words >> more) {
            if (wrong) *wrong = keys.size();
            return std::nullopt;
        }
        keys.push_back(key);
        from = end + 1;
    }
    return keys;
}

template <class Linear, class Cubic>
glm::dvec2 VesselPath::on(double time_s, Linear linear, Cubic cubic) const {
    const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                        [](double t, const Key& key) { return t < key.time_s; });
    if (after == keys.begin()) return linear(keys.front(), keys.front().velocity_mps);
    if (after == keys.end()) return linear(keys.back(), keys.back().velocity_mps);
    const Key &a = *(after - 1), &b = *after;
    const double step_s = b.time_s - a.time_s;
    if (!is_smooth) return linear(a, (b.place_m - a.place_m) / step_s);
    return cubic(a, b, step_s, (time_s - a.time_s) / step_s);
}

glm::dvec2 VesselPath::at(double time_s) const {
    return on(
        time_s,
        [&](const Key& from, glm::dvec2 velocity) {
            return from.place_m + (time_s - from.time_s) * velocity;
        },
        [](const Key& a, const Key& b, double step_s, double t) {  // Hermite's
            const double u = 1.0 - t;
            return u * u * ((1.0 + 2.0 * t) * a.place_m + t * step_s * a.velocity_mps) +
                   t * t * ((3.0 - 2.0 * t) * b.place_m - u * step_s * b.velocity_mps);
        });
}

glm::dvec2 VesselPath::velocity_mps(double time_s) const {
    return on(
        time_s, [](const Key&, glm::dvec2 velocity) { return velocity; },
        [](const Key& a, const Key& b, double step_s, double t) {
            const double u = 1.0 - t;
            return 6.0 * t * u / step_s * (b.place_m - a.place_m) + u * (1.0 - 3.0 * t) * a.velocity_mps +
                   t * (3.0 * t - 2.0) * b.velocity_mps;
        });
}

std::vector<double> VesselPath::speeds_mps() const {
    constexpr int kParts = 16;
    std::vector<double> speeds;
    for (std::size_t i = 0; i + 1 < keys.size(); ++i)
        for (int part = 0; part <= kParts; ++part)
            speeds.push_back(glm::length(
                velocity_mps(std::lerp(keys[i].time_s, keys[i + 1].time_s, part / double{kParts}))));
    return speeds;
}

double VesselPath::fastest_mps() const {
    return std::ranges::max(speeds_mps());
}
double VesselPath::slowest_mps() const {
    return std::ranges::min(speeds_mps());
}

VesselPath path_of(const Shot& shot, const Vessel& vessel) {
    VesselPath path;
    path.is_smooth = vessel.interpolation == CameraInterpolation::Smooth;
    for (const CourseKey& key : course_of(vessel.path).value_or(std::vector<CourseKey>{}))
        path.keys.push_back({shot.time_s(key.frame), {key.east_m, key.north_m}, {}});
    std::vector<VesselPath::Key>& keys = path.keys;
    const auto chord = [&](std::size_t i) {
        return (keys[i + 1].place_m - keys[i].place_m) / (keys[i + 1].time_s - keys[i].time_s);
    };
    for (std::size_t i = 0; keys.size() > 1 && i < keys.size(); ++i) {
        const glm::dvec2 before = chord(i > 0 ? i - 1 : 0), after = chord(std::min(i, keys.size() - 2));
        const double share = i > 0 && i + 1 < keys.size() ? (keys[i].time_s - keys[i - 1].time_s) /
                                                                (keys[i + 1].time_s - keys[i - 1].time_s)
                                                          : 0.5;
        keys[i].velocity_mps = (1.0 - share) * before + share * after;  // the parabola's through three keys
    }
    return path;
}

}  // namespace pelagic
