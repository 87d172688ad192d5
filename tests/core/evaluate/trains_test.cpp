// The trains' kernel against the formula of each field in scalar double precision, on every instruction set.
#include "core/evaluate/trains.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/base/constants.h"
#include "core/base/instruction_set.h"
#include "core/base/random.h"

namespace pelagic {
namespace {

constexpr Field kFields[] = {Field::Height,    Field::Dx,        Field::Dy,       Field::SlopeX,
                             Field::SlopeY,    Field::Dxx,       Field::Dyy,      Field::Dxy,
                             Field::VelocityX, Field::VelocityY, Field::VelocityZ};
constexpr std::size_t kPoints = Chunk<float>::kPoints;

FieldSet all_fields() {
    return FieldSet().set();
}
bool of_cell(Field field) {
    return field == Field::Height || field == Field::Dx || field == Field::Dy || field == Field::VelocityX ||
           field == Field::VelocityY || field == Field::VelocityZ;
}

Scene sea(double choppiness = 0.9) {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.choppiness = choppiness;
    scene.sea.wind_direction_deg = 35.0;
    scene.sea.depth_m = 30.0;
    return scene;
}

template <class T>
Trains<T> trains_of(const Scene& scene) {
    return make_trains<T>(*prepare(scene), *resolve_trains(*prepare(scene), 0.0));
}

// Rest points within ± 100 m, the same for both precisions.
template <class T>
std::unique_ptr<Chunk<T>> scattered(std::size_t count) {
    auto chunk = std::make_unique<Chunk<T>>();
    chunk->count = count;
    for (std::size_t i = 0; i < kPoints; ++i) {
        const auto z = normal_pair({static_cast<std::uint32_t>(i), 0, 0, 0}, 5);
        chunk->rest_x[i] = static_cast<T>(static_cast<float>(30.0 * z[0]));
        chunk->rest_y[i] = static_cast<T>(static_cast<float>(30.0 * z[1]));
    }
    for (auto& sum : chunk->sums) sum.fill(T(0));
    return chunk;
}

// From 5 mm to 500 m, in no order.
template <class T>
typename Chunk<T>::Values footprints(std::uint32_t stream) {
    typename Chunk<T>::Values values;
    for (std::size_t i = 0; i < kPoints; ++i) {
        const auto bits = philox({static_cast<std::uint32_t>(i), stream, 0, 0}, 11);
        values[i] = static_cast<T>(static_cast<float>(0.005 * std::pow(1e5, bits[0] * 0x1p-32)));
    }
    values[0] = T(0);
    return values;
}

struct Place {
    glm::dvec2 origin_m{0.0};
    double time_s = 0.0;
};

// Eq. 2 and its derivatives, one train after the other, phases in 64 bits of mantissa.
template <class T>
double formula(const Trains<T>& trains, Field field, const Place& place, glm::dvec2 rest_m,
               double weight_footprint_m) {
    double sum = 0.0;
    for (std::size_t i = 0; i < trains.count(); ++i) {
        const double k = kTwoPi / trains.wavelength_m[i], omega = kTwoPi * trains.cycles_per_s[i];
        const double x = trains.kx_cycles_per_m[i] * trains.wavelength_m[i];
        const double y = trains.ky_cycles_per_m[i] * trains.wavelength_m[i];
        const double h = trains.height_m[i], H = trains.horizontal_m[i];
        const auto wide = [](double a, double b) { return static_cast<long double>(a) * b; };
        const long double cycles = trains.start_cycles[i] + wide(trains.cycles_per_s[i], place.time_s) -
                                   wide(trains.kx_cycles_per_m[i], place.origin_m.x) -
                                   wide(trains.ky_cycles_per_m[i], place.origin_m.y) -
                                   wide(trains.kx_cycles_per_m[i], rest_m.x) -
                                   wide(trains.ky_cycles_per_m[i], rest_m.y);
        const double theta = kTwoPi * static_cast<double>(cycles - std::round(cycles));
        const double s = std::sin(theta), c = std::cos(theta);
        const double w = FootprintFilter{}.weight(k, weight_footprint_m);
        switch (field) {
            case Field::Height:
                sum += w * h * c;
                break;
            case Field::Dx:
                sum += w * x * H * s;
                break;
            case Field::Dy:
                sum += w * y * H * s;
                break;
            case Field::SlopeX:
                sum += w * k * x * h * s;
                break;
            case Field::SlopeY:
                sum += w * k * y * h * s;
                break;
            case Field::Dxx:
                sum -= w * k * x * x * H * c;
                break;
            case Field::Dyy:
                sum -= w * k * y * y * H * c;
                break;
            case Field::Dxy:
                sum -= w * k * x * y * H * c;
                break;
            case Field::VelocityX:
                sum += w * omega * x * H * c;
                break;
            case Field::VelocityY:
                sum += w * omega * y * H * c;
                break;
            case Field::VelocityZ:
                sum -= w * omega * h * s;
                break;
        }
    }
    return sum;
}

template <class T>
double sum_of_amplitudes(const Trains<T>& trains, Field field) {
    double sum = 0.0;
    for (const T a : trains.amplitude[index(field)]) sum += std::abs(static_cast<double>(a));
    return sum;
}

// The phase's rounding after reduction (half a unit of ½ cycle, times 2π), that of sine and cosine
// (sincos_test), of the amplitude, the weight and the sums.
template <class T>
double rounding() {
    return (sizeof(T) == 4 ? 0x1p-24 : 0x1p-53) * (0.5 * kTwoPi + 4.0 + 1.0 + 4.0 + 10.0);
}

template <class T>
void expect_formula(const Scene& scene, const Place& place, bool filtered) {
    const auto trains = trains_of<T>(scene);
    const auto chunk = scattered<T>(kPoints);
    const auto cells = footprints<T>(1), pixels = footprints<T>(2);
    const auto start = phases_at(trains, place.origin_m, place.time_s);
    add_trains<T>({.trains = &trains,
                   .start_cycles = start.data(),
                   .wanted = all_fields(),
                   .cell_of = filtered ? cells.data() : nullptr,
                   .pixel_of = filtered ? pixels.data() : nullptr},
                  *chunk);
    // Phases in double still carry their own rounding: 50 cycles a metre over 100 m, and phases_at()'s.
    const double phase = kTwoPi * 1e-11;
    for (const Field field : kFields) {
        const double bound = (rounding<T>() + phase) * sum_of_amplitudes(trains, field);
        ASSERT_GT(bound, 0.0);
        for (std::size_t i = 0; i < kPoints; ++i) {
            const double footprint_m =
                !filtered ? 0.0 : static_cast<double>(of_cell(field) ? cells[i] : pixels[i]);
            const double wanted =
                formula(trains, field, place, {chunk->rest_x[i], chunk->rest_y[i]}, footprint_m);
            ASSERT_NEAR(static_cast<double>(chunk->sums[index(field)][i]), wanted, bound)
                << "field " << index(field) << " point " << i;
        }
    }
}

TEST(TrainsKernel, OneTrainIsTheTrochoid) {
    Scene scene = sea(1.0);
    scene.waves.trains = 1;
    scene.waves.longest_m = 60.0;
    scene.waves.shortest_m = 20.0;
    expect_formula<double>(scene, {{0.0, 0.0}, 3.0}, false);
    expect_formula<float>(scene, {{0.0, 0.0}, 3.0}, false);
}

TEST(TrainsKernel, SixtyTrainsAreTheirSum) {
    expect_formula<double>(sea(), {{0.0, 0.0}, 3.0}, false);
    expect_formula<float>(sea(), {{0.0, 0.0}, 3.0}, false);
}

TEST(TrainsKernel, EachPointHasItsOwnFilter) {
    expect_formula<double>(sea(), {{0.0, 0.0}, 3.0}, true);
    expect_formula<float>(sea(), {{0.0, 0.0}, 3.0}, true);
}

TEST(TrainsKernel, IsExactFarAwayAndLate) {
    expect_formula<float>(sea(), {{1e6 + 0.3, -1e6}, 1e7 + 1.0 / 24.0}, true);
    expect_formula<double>(sea(), {{1e6 + 0.3, -1e6}, 1e7 + 1.0 / 24.0}, true);
}

TEST(TrainsKernel, SteepTrainsStayFinite) {
    Scene scene = sea(10.0);
    scene.sea.wind_speed_mps = 0.0;
    scene.sea.swell = {{20.0, 2.0, 30.0}};  // no sea has it, and the core bears it
    scene.waves.trains = 1;
    const auto trains = trains_of<float>(scene);
    ASSERT_GT(kTwoPi / trains.wavelength_m[0] * trains.height_m[0], 2.0);
    expect_formula<float>(scene, {{0.0, 0.0}, 3.0}, true);
}

// Central differences of eighth order pass a phase step φ with the relative error φ⁸/630
// (derivatives_test.cpp). The step of a hundredth of the shortest wavelength, 20 cm here, gives φ = 0.063 and
// 4e-13; rounding of the differences adds 1e-15 of the field over the step: 1e-12 of the amplitudes over
// their derivatives' step.
TEST(TrainsKernel, DerivativesAreThoseOfTheDisplacement) {
    Scene scene = sea();
    scene.waves.shortest_m = 0.2;
    const auto trains = trains_of<double>(scene);
    constexpr double kWeights[] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
    constexpr double kStep_m = 2e-3, kStep_s = 2e-3;
    const auto chunk_at = [&](glm::dvec2 shift_m, double time_s) {
        auto chunk = scattered<double>(64);
        const auto start = phases_at(trains, shift_m, time_s);
        add_trains<double>({.trains = &trains, .start_cycles = start.data(), .wanted = all_fields()}, *chunk);
        return chunk;
    };
    const auto here = chunk_at({0.0, 0.0}, 2.0);
    struct Pair {
        Field of, derivative;
        int axis;  // x, y, t
    };
    for (const Pair& pair :
         {Pair{Field::Height, Field::SlopeX, 0}, Pair{Field::Height, Field::SlopeY, 1},
          Pair{Field::Dx, Field::Dxx, 0}, Pair{Field::Dy, Field::Dyy, 1}, Pair{Field::Dx, Field::Dxy, 1},
          Pair{Field::Dy, Field::Dxy, 0}, Pair{Field::Dx, Field::VelocityX, 2},
          Pair{Field::Dy, Field::VelocityY, 2}, Pair{Field::Height, Field::VelocityZ, 2}}) {
        const double step = pair.axis == 2 ? kStep_s : kStep_m;
        std::array<double, 64> difference{};
        for (int i = 1; i <= 4; ++i)
            for (const int side : {-1, 1}) {
                const double s = side * i * step;
                const auto there = chunk_at({pair.axis == 0 ? s : 0.0, pair.axis == 1 ? s : 0.0},
                                            pair.axis == 2 ? 2.0 + s : 2.0);
                for (std::size_t p = 0; p < 64; ++p)
                    difference[p] += side * kWeights[i - 1] * there->sums[index(pair.of)][p] / step;
            }
        const double bound = 1e-12 * sum_of_amplitudes(trains, pair.derivative) +
                             1e-15 * sum_of_amplitudes(trains, pair.of) / step;
        for (std::size_t p = 0; p < 64; ++p)
            EXPECT_NEAR(here->sums[index(pair.derivative)][p], difference[p], bound)
                << index(pair.of) << " → " << index(pair.derivative);
    }
}

// Its neighbours decide which trains the vector looks at, and nothing else.
TEST(TrainsKernel, APointDependsOnNothingButThePoint) {
    const auto trains = trains_of<float>(sea());
    const auto start = phases_at(trains, {5.0, 6.0}, 7.0);
    const auto cells = footprints<float>(1), pixels = footprints<float>(2);
    const auto together = scattered<float>(kPoints);
    UnresolvedChunk<float> unresolved_together, unresolved_alone;
    TrainArgs<float> args{.trains = &trains,
                          .start_cycles = start.data(),
                          .wanted = all_fields(),
                          .cell_of = cells.data(),
                          .pixel_of = pixels.data(),
                          .unresolved = &unresolved_together};
    add_trains(args, *together);
    for (std::size_t i = 0; i < kPoints; ++i) {
        const auto alone = scattered<float>(1);
        std::fill(alone->rest_x.begin(), alone->rest_x.end(), together->rest_x[i]);
        std::fill(alone->rest_y.begin(), alone->rest_y.end(), together->rest_y[i]);
        typename Chunk<float>::Values cell, pixel;
        cell.fill(std::nanf(""));  // beyond the count, nothing counts
        pixel.fill(std::nanf(""));
        cell[0] = cells[i];
        pixel[0] = pixels[i];
        args.cell_of = cell.data();
        args.pixel_of = pixel.data();
        args.unresolved = &unresolved_alone;
        add_trains(args, *alone);
        for (const Field field : kFields)
            ASSERT_EQ(alone->sums[index(field)][0], together->sums[index(field)][i])
                << index(field) << " " << i;
        for (std::size_t m = 0; m < kUnresolvedMoments.size(); ++m)
            ASSERT_EQ(unresolved_alone.moments[m][0], unresolved_together.moments[m][i]) << m << " " << i;
        // A footprint of all points is the same as an array of it.
        const auto uniform = scattered<float>(1);
        uniform->rest_x = alone->rest_x;
        uniform->rest_y = alone->rest_y;
        args.cell_of = args.pixel_of = nullptr;
        args.cell_m = cells[i];
        args.pixel_m = pixels[i];
        add_trains(args, *uniform);
        for (const Field field : kFields)
            ASSERT_EQ(uniform->sums[index(field)][0], together->sums[index(field)][i])
                << index(field) << " " << i;
    }
}

// Per point, what is unresolved is what unresolved() says of its footprint; with resolved() it is the whole.
template <class T>
void expect_unresolved(const Scene& scene, double relative) {
    const auto trains = trains_of<T>(scene);
    const auto start = phases_at(trains, {0.0, 0.0}, 0.0);
    const auto pixels = footprints<T>(3);
    const auto chunk = scattered<T>(kPoints);
    UnresolvedChunk<T> out;
    add_trains<T>(
        {.trains = &trains, .start_cycles = start.data(), .pixel_of = pixels.data(), .unresolved = &out},
        *chunk);
    const SpectralMoments all = total(trains);
    for (std::size_t i = 0; i < kPoints; ++i) {
        const double footprint_m = static_cast<double>(pixels[i]);
        const SpectralMoments wanted = unresolved(trains, {}, footprint_m),
                              shown = resolved(trains, {}, footprint_m);
        for (std::size_t m = 0; m < kUnresolvedMoments.size(); ++m) {
            const auto moment = kUnresolvedMoments[m];
            const double scale = m < kUnresolvedSlopes ? all.mss() : all.xxxx + 2.0 * all.xxyy + all.yyyy;
            EXPECT_NEAR(static_cast<double>(out.moments[m][i]), wanted.*moment, relative * scale);
            EXPECT_NEAR(static_cast<double>(out.moments[m][i]) + shown.*moment, all.*moment,
                        relative * scale);
        }
        EXPECT_GE(out.moments[0][i], T(0));
        EXPECT_GE(out.moments[2][i], T(0));
    }
}

TEST(TrainsKernel, UnresolvedAndResolvedAreTheWhole) {
    expect_unresolved<double>(sea(), 1e-13);
    expect_unresolved<float>(sea(), 20 * 0x1p-24);  // the weights', and a few sums'
    Scene steep = sea(3.0);
    steep.waves.trains = 4;
    expect_unresolved<double>(steep, 1e-13);
}

TEST(TrainsKernel, CostsWhatIsResolved) {
    const auto trains = trains_of<float>(sea());
    const auto start = phases_at(trains, {0.0, 0.0}, 0.0);
    const auto chunk = scattered<float>(200);
    std::size_t before = trains.count() * 200 + 1;
    for (const double footprint_m : {0.0, 0.1, 1.0, 10.0, 1e4}) {
        const std::size_t passing = static_cast<std::size_t>(
            std::count_if(trains.wavelength_m.begin(), trains.wavelength_m.end(),
                          [&](double m) { return FootprintFilter{}.weight(kTwoPi / m, footprint_m) > 0.0; }));
        const TrainArgs<float> args{.trains = &trains,
                                    .start_cycles = start.data(),
                                    .wanted = fields(Field::Height),
                                    .cell_m = static_cast<float>(footprint_m)};
        EXPECT_EQ(add_trains(args, *chunk), passing * 200);
        EXPECT_LT(passing * 200, before);
        before = passing * 200;
        // Derivatives see their own footprint, and the union of both is evaluated, once.
        TrainArgs<float> both = args;
        both.wanted = fields(Field::Height, Field::SlopeX);
        both.pixel_m = 1.0f;
        TrainArgs<float> slopes = both;
        slopes.wanted = fields(Field::SlopeX);
        EXPECT_EQ(add_trains(both, *chunk), std::max(passing * 200, add_trains(slopes, *chunk)));
    }
    EXPECT_EQ(before, 0u);
}

TEST(TrainsKernel, AddsWhatIsWantedAndLeavesTheRest) {
    const auto trains = trains_of<float>(sea());
    const auto start = phases_at(trains, {0.0, 0.0}, 0.0);
    const auto all = scattered<float>(kPoints);
    TrainArgs<float> args{.trains = &trains, .start_cycles = start.data(), .wanted = all_fields()};
    add_trains(args, *all);
    for (const Field wanted : kFields) {
        const auto chunk = scattered<float>(kPoints);
        for (auto& sum : chunk->sums) sum.fill(0.5f);
        args.wanted = fields(wanted);
        add_trains(args, *chunk);
        for (const Field field : kFields)
            for (std::size_t i = 0; i < kPoints; ++i) {
                const float expected = field == wanted ? 0.5f + all->sums[index(field)][i] : 0.5f;
                ASSERT_EQ(chunk->sums[index(field)][i], expected) << index(wanted) << " " << index(field);
            }
    }
}

TEST(TrainsKernel, EveryInstructionSetAgrees) {
    const Scene scene = sea();
    const double hs = 4.0 * std::sqrt(DirectionalSpectrum(scene.sea).m0());
    const auto trains = trains_of<float>(scene);
    const auto start = phases_at(trains, {0.0, 0.0}, 3.0);
    const auto cells = footprints<float>(1), pixels = footprints<float>(2);
    const auto best = scattered<float>(kPoints);
    const TrainArgs<float> args{.trains = &trains,
                                .start_cycles = start.data(),
                                .wanted = all_fields(),
                                .cell_of = cells.data(),
                                .pixel_of = pixels.data()};
    add_trains(args, *best);
    const std::string widest = instruction_set();
    for (const std::string& set : instruction_sets()) {
        use_instruction_set(set);
        SCOPED_TRACE(set);
        const auto chunk = scattered<float>(kPoints);
        add_trains(args, *chunk);
        use_instruction_set(widest);
        for (const Field field : kFields)
            for (std::size_t i = 0; i < kPoints; ++i)
                ASSERT_NEAR(chunk->sums[index(field)][i], best->sums[index(field)][i], 1e-5 * hs)
                    << index(field);
    }
    EXPECT_GE(instruction_sets().size(), 2U);
}

}  // namespace
}  // namespace pelagic
