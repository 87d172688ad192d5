// How much a picture of the sea from the air repeats itself: its correlation at lags where the sea's own is below 0.05.
//
// The picture is the slope along the line of sight, which is what its brightness follows, as each pixel of a camera of
// 1280 pixels and 50° shows it: over a square of the sea, nadir at the middle of its near edge, resampled to even steps.
// Correlations are of the part where the picture and its copy overlap, which is half of it or more each way.
//   repeats [SAMPLES]      a side, default 1024

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/evaluate.h"
#include "core/evaluate/values.h"

namespace pelagic::bench {
namespace {

constexpr double kPixel_rad = 50.0 * kPi / 180.0 / 1280.0;
constexpr double kOwn = 0.05, kTarget = 0.15;

struct Look {
    std::string name;
    Scene scene;
    double height_m, side_m;
};

// n × n complex values and their transform in place.
class Square {
  public:
    explicit Square(int n)
        : n_(n),
          values_(static_cast<std::size_t>(n) * n),
          forward_(plan(FFTW_FORWARD)),
          backward_(plan(FFTW_BACKWARD)) {}
    ~Square() {
        fftwf_destroy_plan(forward_);
        fftwf_destroy_plan(backward_);
    }
    Square(const Square&) = delete;
    Square& operator=(const Square&) = delete;

    std::complex<float>& at(int x, int y) {
        const auto wrapped = [&](int i) { return static_cast<std::size_t>((i % n_ + n_) % n_); };
        return values_[wrapped(y) * static_cast<std::size_t>(n_) + wrapped(x)];
    }
    std::vector<std::complex<float>>& all() { return values_; }
    void forward() { fftwf_execute(forward_); }
    void backward() { fftwf_execute(backward_); }

  private:
    fftwf_plan plan(int sign) {
        auto* data = reinterpret_cast<fftwf_complex*>(values_.data());
        return fftwf_plan_dft_2d(n_, n_, data, data, sign, FFTW_ESTIMATE);
    }
    int n_;
    std::vector<std::complex<float>> values_;
    fftwf_plan forward_, backward_;
};

// Values of the picture, rows of n, and the filter's footprint of a pixel in its middle.
struct Picture {
    int n;
    std::vector<float> values;
};

Picture picture_of(const Look& look, int n) {
    const double step_m = look.side_m / n;
    std::vector<glm::vec2> rest, axis;
    std::vector<float> pixel_m;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const glm::dvec2 at((x + 0.5) * step_m, (y + 0.5 - 0.5 * n) * step_m);
            const double distance_m = std::hypot(at.x, at.y, look.height_m);
            const double across_m = std::max(kPixel_rad * distance_m, step_m);
            const double along_m = across_m * distance_m / look.height_m;
            rest.emplace_back(at);
            pixel_m.push_back(static_cast<float>(across_m));
            axis.emplace_back(along_m * at / std::hypot(at.x, at.y));
        }
    const auto prepared = prepare(look.scene);
    const Query query =
        view_query(*prepared, {.products = products(Product::Position, Product::Normal),
                               .finest_cell_m = pixel_m.front(),
                               .finest_pixel_m = *std::min_element(pixel_m.begin(), pixel_m.end()),
                               .points = rest.size()});
    Frame<float> frame(std::make_shared<const Sea<float>>(make_plan(prepared, {query})));
    frame.set(0.0);
    Values values;
    values.resize(products(Product::Normal), rest.size());
    evaluate(frame, 0,
             Points<float>{.count = rest.size(),
                           .rest_m = {rest.data()},
                           .pixel_m = {pixel_m.data()},
                           .pixel_axis_m = {axis.data()}},
             values.results());
    Picture picture{n, std::vector<float>(rest.size())};
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const glm::vec3 normal = values.vectors(VectorProduct::checked(Product::Normal))[i];
        picture.values[i] = glm::dot(glm::vec2(normal), glm::normalize(rest[i])) / normal.z;
    }
    return picture;
}

// The sea's own correlation of the same slopes, by the spectrum, at lags of whole steps up to half the square: with the
// footprint in the picture's middle, where the line of sight is x.
void own_correlation(const Look& look, Square& own, int n) {
    const DirectionalSpectrum spectrum(look.scene.sea);
    const double step_m = look.side_m / n, dk = kTwoPi / (2.0 * look.side_m);
    const double distance_m = std::hypot(0.5 * look.side_m, look.height_m);
    const double footprint_m = std::max(kPixel_rad * distance_m, step_m);
    const FootprintFilter filter;
    for (int my = -n; my < n; ++my)
        for (int mx = -n; mx < n; ++mx) {
            const double kx = mx * dk, ky = my * dk, k = std::hypot(kx, ky);
            double power = 0.0;
            if (k > 0.0 && k < filter.cutoff(footprint_m)) {
                const double theta = std::atan2(ky, kx), weight = filter.weight(k, footprint_m) * kx;
                power = weight * weight * (spectrum.polar(k, theta) + spectrum.polar(k, theta + kPi)) / k;
            }
            own.at(mx, my) = static_cast<float>(power);
        }
    own.forward();
    const float whole = own.at(0, 0).real();
    for (std::complex<float>& value : own.all()) value /= whole;
}

struct Worst {
    double correlation = 0.0, x_m = 0.0, y_m = 0.0;
};

Worst worst_of(const Look& look, int n) {
    const Picture picture = picture_of(look, n);
    const double step_m = look.side_m / n;
    // Padded to twice the size; squares are summed over what overlaps, by a mask of ones.
    Square values(2 * n), squares(2 * n), own(2 * n);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const float value = picture.values[static_cast<std::size_t>(y) * n + x];
            values.at(x, y) = value;
            squares.at(x, y) = {value * value, 1.0f};
        }
    values.forward();
    squares.forward();
    for (std::complex<float>& value : values.all()) value = std::norm(value);
    values.backward();
    // Two real fields in one transform: a = the squares', b = the mask's; conj(a) b.
    Square overlap(2 * n);
    for (int y = 0; y < 2 * n; ++y)
        for (int x = 0; x < 2 * n; ++x) {
            const std::complex<float> here = squares.at(x, y), mirrored = std::conj(squares.at(-x, -y));
            const std::complex<float> a = 0.5f * (here + mirrored),
                                      b = std::complex<float>(0.0f, -0.5f) * (here - mirrored);
            overlap.at(x, y) = std::conj(a) * b;
        }
    overlap.backward();
    own_correlation(look, own, n);
    Worst worst;
    for (int y = 0; y <= n / 2; ++y)
        for (int x = -n / 2; x <= n / 2; ++x) {
            if (std::abs(own.at(x, y).real()) >= kOwn || (x == 0 && y == 0)) continue;
            const double both = static_cast<double>(overlap.at(x, y).real()) * overlap.at(-x, -y).real();
            const double correlation = values.at(x, y).real() / std::sqrt(both);
            if (correlation > worst.correlation) worst = {correlation, x * step_m, y * step_m};
        }
    return worst;
}

void run(int n) {
    Scene harbour;
    harbour.sea.wind_speed_mps = 3.0;
    harbour.sea.fetch_m = 500.0;
    std::vector<Look> looks;
    for (const Tiling tiling : {Tiling::Random, Tiling::Periodic}) {
        const std::string of = tiling == Tiling::Random ? ", copies" : ", periodic";
        Scene sea;
        sea.waves.tiling = harbour.waves.tiling = tiling;
        looks.push_back({"the default sea from 3 km, 10 km of it" + of, sea, 3000.0, 10e3});
        looks.push_back({"the same from 8 km, 20 km of it" + of, sea, 8000.0, 20e3});
        looks.push_back(
            {"a harbour, 3 m/s, 500 m of fetch, from 100 m, 500 m of it" + of, harbour, 100.0, 500.0});
    }
    for (const int trains : {60, 250, 1000, 3000}) {
        Scene scene;
        scene.waves.model = WaveModel::Trochoid;
        scene.waves.trains = trains;
        looks.push_back(
            {std::to_string(trains) + " wave trains from 3 km, 10 km of it", scene, 3000.0, 10e3});
    }
    std::printf(
        "Largest correlation of a picture with itself where the sea's own is below %.2f; %d samples a side\n",
        kOwn, n);
    for (const Look& look : looks) {
        const Worst worst = worst_of(look, n);
        std::printf("  %-70s %5.2f at (%7.1f, %7.1f) m; target below %.2f: %s\n", look.name.c_str(),
                    worst.correlation, worst.x_m, worst.y_m, kTarget,
                    worst.correlation < kTarget ? "met" : "missed");
        std::fflush(stdout);
    }
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    pelagic::bench::run(argc > 1 ? std::atoi(argv[1]) : 1024);
}
