// A mesh holds nothing that it cannot show: its surface, sampled four times as densely, has no energy beyond
// the mesh's Nyquist wavenumber π/spacing in x or y.
#include <gtest/gtest.h>

#include <complex>
#include <functional>
#include <vector>

#include "core/waves/transform.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

// The part of Σ|F|² at |mx| or |my| ≥ limit; mirrored for every second value of x and y alike.
template <class Value>
double share_beyond(const std::vector<Value>& samples, int n, int limit,
                    const std::function<double(const Value&)>& of) {
    // Rows, then columns of what they gave: one line after another. The sign of the exponent doesn't matter
    // for energies.
    const LineTransform<double> transform(n);
    const std::size_t stride = line_stride<double>(n);
    Buffer<double> from(2 * stride), to(2 * stride);
    std::vector<std::complex<double>> square(static_cast<std::size_t>(n) * n);
    for (std::size_t i = 0; i < samples.size(); ++i) square[i] = of(samples[i]);
    const auto along = [&](std::size_t first, std::size_t step) {
        for (int i = 0; i < n; ++i) {
            from[i] = square[first + i * step].real();
            from[stride + i] = square[first + i * step].imag();
        }
        transform.execute(from.data(), to.data());
        for (int i = 0; i < n; ++i) square[first + i * step] = {to[i], to[stride + i]};
    };
    for (int y = 0; y < n; ++y) along(static_cast<std::size_t>(y) * n, 1);
    for (int x = 0; x < n; ++x) along(x, n);
    double beyond = 0.0, whole = 0.0;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const double energy = std::norm(square[static_cast<std::size_t>(y) * n + x]);
            whole += energy;
            if (std::min(x, n - x) >= limit || std::min(y, n - y) >= limit) beyond += energy;
        }
    return beyond / whole;
}

// A patch on whose size every tile fits a whole number of times, so that its transform needs no window.
constexpr double kPatch_m = 200.0;
constexpr int kQuads = 256, kDense = 4 * kQuads;

TEST(Mesh, HoldsNothingBeyondItsNyquist) {
    Scene scene;
    scene.sea.wind_speed_mps = 12.0;
    scene.waves.cascades = {{200.0, 96}, {50.0, 96}, {12.5, 128}};
    scene.waves.tiling = Tiling::Periodic;  // the patch is a period
    const double spacing_m = kPatch_m / kQuads;
    const ProductSet wanted = products(Product::Displacement);
    // The mesh's own lattice (its nodes are read where that is cheaper), and the same footprint four times as
    // dense: the spline's images are in there. Both in double, so that rounding doesn't hide what is sought.
    Query mesh = filtered(wanted, spacing_m), dense = mesh;
    mesh.lattice = Lattice{0.0, spacing_m};
    const auto frame = frame_of<double>(scene, {mesh, dense}, 1.0);
    const auto dense_points = tile_points<double>(kPatch_m, kDense);
    const auto fine = sample(frame, 1, dense_points).vectors(Displacement);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_LT(share_beyond<glm::dvec3>(fine, kDense, kQuads / 2, [&](const auto& d) { return d[axis]; }),
                  1e-6)
            << axis;

    // And the mesh is that surface, at its own points.
    const auto coarse = sample(frame, 0, tile_points<double>(kPatch_m, kQuads)).vectors(Displacement);
    double error = 0.0, energy = 0.0;
    for (int y = 0; y < kQuads; ++y)
        for (int x = 0; x < kQuads; ++x) {
            const auto d = coarse[static_cast<std::size_t>(y) * kQuads + x];
            const auto e = fine[static_cast<std::size_t>(4 * y) * kDense + 4 * x];
            error += (d.z - e.z) * (d.z - e.z);
            energy += d.z * d.z;
        }
    EXPECT_LT(error / energy, 1e-6);  // the images again
}

// Slopes, where short waves count as much as long ones: with a filter that began at 1.5 samples a wavelength,
// 1e-4 of them would be beyond. Choppiness 0: the normal's slopes are then linear in the waves, and
// band-limited as they are.
TEST(Mesh, HasNoSlopesBeyondItsNyquist) {
    Scene scene;
    scene.sea.wind_speed_mps = 12.0;
    scene.waves.choppiness = 0.0;
    scene.waves.cascades = {{200.0, 96}, {50.0, 96}, {12.5, 128}};
    scene.waves.tiling = Tiling::Periodic;  // the patch is a period
    const auto frame = frame_of<double>(scene, {filtered(products(Product::Normal), kPatch_m / kQuads)}, 1.0);
    const auto normals = sample(frame, 0, tile_points<double>(kPatch_m, kDense)).vectors(Normal);
    for (int axis = 0; axis < 2; ++axis)
        EXPECT_LT(share_beyond<glm::dvec3>(normals, kDense, kQuads / 2,
                                           [&](const auto& n) { return n[axis] / n.z; }),
                  1e-6)
            << axis;
}

// Read at its nodes there are no images: zero to double rounding. And without the filter there is plenty, so
// the measure sees what it is for.
TEST(Mesh, ReadAtNodesHoldsNothingBeyondItsNyquistToRounding) {
    Scene scene;
    scene.sea.wind_speed_mps = 12.0;
    scene.waves.cascades = {{50.0, 256}};
    constexpr int kTileQuads = 64;
    Query shown = tile(products(Product::Displacement), 0, 50.0, 4 * kTileQuads), all = shown;
    shown.cell_m = shown.pixel_m = {50.0 / kTileQuads};
    const auto frame = frame_of<double>(scene, {shown, all}, 1.0);
    const auto points = tile_points<double>(50.0, 4 * kTileQuads);
    const auto height = [](const glm::dvec3& d) { return d.z; };
    EXPECT_LT(share_beyond<glm::dvec3>(sample(frame, 0, points).vectors(Displacement), 4 * kTileQuads,
                                       kTileQuads / 2, height),
              1e-20);
    EXPECT_GT(share_beyond<glm::dvec3>(sample(frame, 1, points).vectors(Displacement), 4 * kTileQuads,
                                       kTileQuads / 2, height),
              1e-4);
}

}  // namespace
}  // namespace pelagic
