#include "plugin/render/passes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/constants.h"
#include "core/base/random.h"

namespace pelagic {
namespace {

// As many passes as samples would be all that a pixel needs; twice as many leave no two neighbours alike. A few samples are
// spread over more, for ghosts that stand closer.
constexpr int kFewestPasses = 16, kFewestParts = 2;

// Near a part of all and prime to it: multiples of it visit each once, far from the one before.
int jump_of(int all, double part) {
    int jump = std::max(1, static_cast<int>(part * all));
    while (std::gcd(jump, all) != 1) ++jump;
    return jump;
}

// From the unit square to the unit disc, areas staying in proportion and neighbours neighbours (Shirley and Chiu 1997).
glm::dvec2 on_disc(glm::dvec2 square) {
    const glm::dvec2 p = 2.0 * square - 1.0;
    if (p.x == 0.0 && p.y == 0.0) return p;
    const bool is_wide = std::abs(p.x) > std::abs(p.y);
    const double radius = is_wide ? p.x : p.y;
    const double angle = is_wide ? 0.25 * kPi * (p.y / p.x) : 0.5 * kPi - 0.25 * kPi * (p.x / p.y);
    return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

// Places in a cell, spread by the plane's analogue of the golden section (Roberts 2018, R2).
glm::dvec2 in_cell(int index) {
    const glm::dvec2 p =
        0.5 + static_cast<double>(index) * glm::dvec2(0.7548776662466927, 0.5698402909980532);
    return {p.x - std::floor(p.x), p.y - std::floor(p.y)};
}

}  // namespace

PicturePasses passes_of(const Camera& camera, int frame, const RenderOptions& options) {
    PicturePasses passes{.all = {{.frame = static_cast<double>(frame)}}};
    const int n = options.samples, all = n * n;
    const bool has_lens = camera.f_stop > 0.0;
    if (n == 1 || !(options.shutter_frames > 0.0 || has_lens)) return passes;
    passes.parts = std::max(kFewestParts, (kFewestPasses + all - 1) / all);
    const int jump = jump_of(all, 0.382);
    for (int stratum = 0; stratum < all; ++stratum)
        for (int part = 0; part < passes.parts; ++part) {
            const double moment = (stratum * passes.parts + part + 0.5) / (all * passes.parts) - 0.5;
            const int cell = stratum * jump % all;
            const glm::dvec2 square =
                (glm::dvec2(cell % n, cell / n) + in_cell(stratum * passes.parts + part)) /
                static_cast<double>(n);
            passes.all.push_back({.frame = frame + options.shutter_frames * moment,
                                  .lens = has_lens ? on_disc(square) : glm::dvec2(0.0),
                                  .stratum = stratum,
                                  .part = part});
        }
    return passes;
}

View view_of(const Camera& camera, const PicturePass& pass, glm::ivec2 overscan_px) {
    View view = view_at(camera, pass.frame);
    const double radius_m = aperture_radius_m(camera, view);
    if (radius_m > 0.0) view = through_lens(view, radius_m * pass.lens, camera.focus_distance_m);
    return with_overscan(view, overscan_px);
}

PixelPlace place_of(const PicturePass& pass, int parts, int samples, int frame, glm::ivec2 pixel) {
    constexpr std::uint64_t kKey = 0x70617373;  // "pass": no other use of philox() shares its numbers
    const auto x = static_cast<std::uint32_t>(pixel.x), y = static_cast<std::uint32_t>(pixel.y),
               f = static_cast<std::uint32_t>(frame);
    const auto stratum = static_cast<std::uint32_t>(pass.stratum);
    const std::uint32_t all = static_cast<std::uint32_t>(samples) * static_cast<std::uint32_t>(samples);
    const auto drawn = philox({x, y, f, stratum}, kKey);
    const auto below = [](std::uint32_t bits, std::uint32_t count) {
        return static_cast<std::uint32_t>((std::uint64_t{bits} * count) >> 32);
    };
    if (below(drawn[0], static_cast<std::uint32_t>(parts)) != static_cast<std::uint32_t>(pass.part))
        return {.x = PixelPlace::kNowhere};
    // One turn of the cells' order for all of the pixel's strata.
    const std::uint32_t turn = below(philox({x, y, f, ~0u}, kKey)[0], all);
    const std::uint32_t cell =
        (stratum * static_cast<std::uint32_t>(jump_of(static_cast<int>(all), 0.618)) + turn) % all;
    const glm::ivec2 at(cell % static_cast<std::uint32_t>(samples),
                        cell / static_cast<std::uint32_t>(samples));
    const glm::dvec2 place =
        256.0 * (glm::dvec2(at) + 0.5 + place_in_cell(samples, at)) / static_cast<double>(samples) - 128.0;
    const auto rounded = [](double at_256) {
        return static_cast<std::int16_t>(std::min(std::lround(at_256), 127l));
    };
    return {.x = rounded(place.x), .y = rounded(place.y)};
}

}  // namespace pelagic
