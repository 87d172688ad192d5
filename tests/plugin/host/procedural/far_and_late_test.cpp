// Precision over time and distance of rays through the C interface: four months after the start and a thousand kilometres from the
// origin, in wavelengths of the shortest wave. Points: tests/core/evaluate/phase_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/plugin/host/procedural/opened.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kMost = 1e-3;  // of a wavelength
constexpr double kFinest_m = 0.0625, kShortest_m = 2.0 * kFinest_m;
constexpr std::size_t kCount = 4000;

// Tiles whose sizes divide a megametre, in two to some power: there the sea is that of the origin.
const char* const kPeriodic = R"([waves]
choppiness = 0.0
tiling = "periodic"
cascades = [ { size_m = 32.0, resolution = 128 }, { size_m = 8.0, resolution = 128 } ]
)";
constexpr double kMegametre_m = 1048576.0;

SeaHandle opened(const std::string& shot) {
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.finest_cell_m = options.finest_pixel_m = kFinest_m;
    return open_text(shot, &options);
}

std::vector<glm::vec2> places() {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> within(-200.0f, 200.0f);
    std::vector<glm::vec2> places(kCount);
    for (glm::vec2& place : places) place = {within(random), within(random)};
    return places;
}

struct FarAnswers {
    std::vector<glm::vec3> position = std::vector<glm::vec3>(kCount), normal = std::vector<glm::vec3>(kCount);
};
FarAnswers answers_of(const FrameHandle& frame, glm::dvec2 origin_m, const std::vector<glm::vec2>& rest_m) {
    FarAnswers answers;
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.origin_m[0] = origin_m.x;
    points.origin_m[1] = origin_m.y;
    points.count = rest_m.size();
    points.rest_m = &rest_m[0].x;
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = &answers.position[0].x;
    values.normal = &answers.normal[0].x;
    pelagic_error error;
    EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, &error), PELAGIC_OK) << error.message;
    return answers;
}

// By how far a sea has moved whose heights differ by so much, RMS over RMS of slopes.
double shift_m(const std::vector<double>& off_m, const std::vector<glm::vec3>& normal) {
    double off = 0.0, slopes = 0.0;
    for (std::size_t i = 0; i < off_m.size(); ++i) {
        const glm::dvec3 n(normal[i]);
        off += off_m[i] * off_m[i];
        slopes += (n.x * n.x + n.y * n.y) / (n.z * n.z);
    }
    return std::sqrt(off / slopes);
}

// Straight down, and as a camera sees the sea. Measured: the same to the bit.
TEST(FarAndLate, RaysMeetTheSeaOfTheOrigin) {
    const SeaHandle sea = opened(kPeriodic);
    const std::vector<glm::vec2> rest_m = places();
    for (const double rise : {-1.0, -0.2})
        for (const double time_s : {0.0, 1e7 + 1.0 / 24.0}) {
            const FrameHandle frame = frame_of(sea, time_s, time_s);
            const auto distances = [&](glm::dvec2 origin_m) {
                pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
                rays.origin_m[0] = origin_m.x;
                rays.origin_m[1] = origin_m.y;
                rays.origin_m[2] = 10.0;
                std::vector<glm::vec3> offset_m, direction;
                for (const glm::vec2 place : rest_m) {
                    offset_m.emplace_back(place, 0.0f);
                    direction.emplace_back(0.0, std::sqrt(1.0 - rise * rise), rise);
                }
                rays.count = kCount;
                rays.offset_m = &offset_m[0].x;
                rays.direction = &direction[0].x;
                std::vector<float> distance(kCount);
                pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
                hits.distance = distance.data();
                pelagic_error error;
                EXPECT_EQ(pelagic_intersect(frame.get(), &rays, &hits, &error), PELAGIC_OK) << error.message;
                return distance;
            };
            const std::vector<float> here = distances({0.0, 0.0}),
                                     there = distances({kMegametre_m, -kMegametre_m});
            double mean_m = 0.0;
            std::vector<double> off_m;
            for (std::size_t i = 0; i < kCount; ++i) {
                off_m.push_back(rise * (static_cast<double>(there[i]) - static_cast<double>(here[i])));
                mean_m -= rise * static_cast<double>(here[i]) / kCount;
            }
            EXPECT_NEAR(mean_m, 10.0, 0.5);
            const double wavelengths =
                shift_m(off_m, answers_of(frame, {0.0, 0.0}, rest_m).normal) / kShortest_m;
            EXPECT_LE(wavelengths, kMost) << "rising by " << rise << ", at " << time_s << " s";
        }
}

}  // namespace
}  // namespace pelagic
