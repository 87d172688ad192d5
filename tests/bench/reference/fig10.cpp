// Fig. 10 of Bruneton, Neyret, Holzschuch 2010: the energy of each line of a picture in sun, refracted light
// and sky, computed with mirrors of very fine geometry (path_tracer.h), with our method, and with a constant
// BRDF.
//   bench_fig10 [full] [KEY=NUMBER…] [plot=FILE.png]
//
// Without `full` the picture is smaller and has fewer samples. Keys:
//   width, height    the picture's size
//   strata, passes   strata² samples per pixel and pass
//   seeds, seed      number of seas averaged, and the first one's seed
//   waves            the tile's resolution
//   shading          our pixels have shading² samples
//   spread           tenths of the sun's radius (see below)
//   sun              its elevation in degrees
//   wind, fetch      one sea, of this wind [m/s] and fetch [km], in place of the two
//   bands            1 prints every band
// Keys to find the cost of an approximation:
//   cell             the projected grid's, in pixels; 0: the default's, and rows for smaller ones
//   pixels           tenths of a pixel by which normals are filtered; 0: by the cell
//   chop             choppiness in per cent
//   facets           1: mirrors are the facets of the mesh
//   lattice          cells of the mesh per sample of the waves

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "tests/bench/reference/path_tracer.h"
#include "tests/bench/reference/plot.h"
#include "tests/bench/reference/shaded_sea.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr int kBands = 24;
// Lines whose centre sees the sea at rest beyond this are left out: there are no waves.
constexpr double kHorizon_m = 3000.0, kReach_m = 6000.0;
// The sun is spread over a disc of 5 times its radius, on both sides of the comparison, so that 25 times as
// many samples hit it. Its 1.3 degrees correspond to a slope of 0.012, a tenth of the waves'. Far away that
// changes little. In the foreground, where a few waves mirror the sun, some of their light moves to other
// lines. The result of the true disc, with its noise, is printed as well.
constexpr int kSunSpread_tenths = 50;
constexpr double kFromBelow = 1.0;  // arbitrary: only ratios of energies are compared

struct Settings {
    std::map<std::string, int> number{
        {"width", 320},  {"height", 180}, {"strata", 4},  {"passes", 4},  {"seeds", 1},
        {"waves", 1024}, {"facets", 0},   {"bands", 0},   {"chop", 100},  {"spread", kSunSpread_tenths},
        {"cell", 0},     {"pixels", 10},  {"lattice", 2}, {"shading", 3}, {"seed", 1},
        {"sun", 25},     {"wind", 0},     {"fetch", 10}};
    std::string plot = "fig10.png";
    int operator[](const char* name) const { return number.at(name); }
};

struct Method {
    const char* name;
    LightingChoice choice;
    bool constant_variance = false;
};

const Method kMethods[] = {
    {"Eq. 26, one lookup", {.sky_quality = SkyQuality::One, .fresnel = FresnelFit::Paper}},
    {"exact fit, one lookup", {.sky_quality = SkyQuality::One, .fresnel = FresnelFit::Exact}},
    {"exact fit, nine lookups", {.sky_quality = SkyQuality::Nine, .fresnel = FresnelFit::Exact}},
    {"exact fit, integral", {.sky_quality = SkyQuality::Integral, .fresnel = FresnelFit::Exact}},
    {"constant BRDF", {.sky_quality = SkyQuality::Nine, .fresnel = FresnelFit::Exact}, true},
};
constexpr int kMethodCount = std::size(kMethods), kPaper = 0, kBest = 2, kIntegral = 3, kConstant = 4;

// Energies as [term][band], bands from the foreground to the horizon.
struct Bands {
    double energy[kTerms][kBands] = {};
    Bands& operator+=(const Bands& other) {
        for (int t = 0; t < kTerms; ++t)
            for (int b = 0; b < kBands; ++b) energy[t][b] += other.energy[t][b];
        return *this;
    }
};

Bands banded(const Lines& lines) {
    Bands bands;
    const int rows = static_cast<int>(lines.size());
    for (int b = 0; b < kBands; ++b) {
        // Band 0 is at the bottom of the picture.
        const int end = rows - rows * b / kBands, begin = rows - rows * (b + 1) / kBands;
        for (int row = begin; row < end; ++row)
            for (int t = 0; t < kTerms; ++t) bands.energy[t][b] += lines[row].term[t] / (end - begin);
    }
    return bands;
}

// Over the bands from `first` until `end`.
double rms_difference(const Bands& bands, const Bands& reference, int term, int first = 0, int end = kBands) {
    double sum = 0.0;
    for (int b = first; b < end; ++b) {
        const double relative = bands.energy[term][b] / reference.energy[term][b] - 1.0;
        sum += relative * relative / (end - first);
    }
    return std::sqrt(sum);
}

struct Comparison {
    Bands single, all, small_sun, ours[kMethodCount];
    std::map<double, Bands> by_cell;  // nine lookups, by the projected grid's cells
    double noise[kTerms] = {};        // of `all`: relative, root mean square over bands
    double small_sun_noise = 0.0;
    double rays = 0.0, missed = 0.0, blocked = 0.0, turned_away = 0.0;
};

// The standard error of the mean, from the scatter of the passes, as root mean square over bands.
double noise_of(const std::vector<Bands>& passes, int term) {
    const double n = static_cast<double>(passes.size());
    double sum = 0.0;
    for (int b = 0; b < kBands; ++b) {
        double mean = 0.0, square = 0.0;
        for (const Bands& pass : passes) mean += pass.energy[term][b] / n;
        for (const Bands& pass : passes) square += std::pow(pass.energy[term][b] / mean - 1.0, 2.0);
        sum += square / (n * (n - 1.0)) / kBands;
    }
    return std::sqrt(sum);
}

View camera(const Settings& settings) {
    Camera camera;
    camera.position_m = {0.0, 0.0, 5.0};
    // Neither along the tiles' sides nor along the wind; the horizon is near the upper edge.
    const double azimuth = 53.0 * kPi / 180.0, down = 10.5 * kPi / 180.0;
    camera.look_at_m =
        camera.position_m + 100.0 * glm::dvec3(std::cos(azimuth), std::sin(azimuth), -std::tan(down));
    camera.resolution = {settings["width"], settings["height"]};
    return view_at(camera, 1.0);
}

int first_row(const View& view) {
    for (int row = 0; row < view.resolution.y; ++row) {
        const glm::dvec3 way = view.direction({0.5 * view.resolution.x, row + 0.5});
        if (way.z < 0.0 && view.position_m.z * std::hypot(way.x, way.y) < -way.z * kHorizon_m) return row;
    }
    return view.resolution.y;
}

// The first band whose middle sees the sea at rest beyond this.
int band_beyond(const View& view, double distance_m) {
    const int rows = view.resolution.y - first_row(view);
    for (int b = 0; b < kBands; ++b) {
        const glm::dvec3 way =
            view.direction({0.5 * view.resolution.x, first_row(view) + rows - rows * (b + 0.5) / kBands});
        if (view.position_m.z * std::hypot(way.x, way.y) > -way.z * distance_m) return b;
    }
    return kBands;
}

struct SeaUnderTest {
    const char* name;
    double wind_speed_mps, fetch_m;
    bool agitated;
};

// Peaks of 20 m and 16 m, so that a tile contains several. The second sea has the steep waves of a short
// fetch.
const SeaUnderTest kSeas[] = {{"calm", 5.0, 300e3, false}, {"agitated", 13.0, 10e3, true}};

// The cells of the tables, and those of the rows beside them.
double main_cell(const Settings& settings) {
    return settings["cell"] > 0 ? settings["cell"] : Surface{}.cell_px;
}
std::vector<double> other_cells(const Settings& settings) {
    if (settings["cell"] > 0) return {};
    return {2.0, 4.0};
}

Comparison compare(const Settings& settings, const SeaUnderTest& under_test, const View& view,
                   const Sky& sky) {
    Comparison sums;
    const Sky wide = with_wider_sun(sky, 0.1f * static_cast<float>(settings["spread"]));
    std::vector<Bands> passes(static_cast<std::size_t>(settings["passes"]));
    std::vector<Bands> small_passes(passes.size());
    const int first_seed = settings["seed"];
    for (int seed = first_seed; seed < first_seed + settings["seeds"]; ++seed) {
        const WaveTile tile({.wind_speed_mps = under_test.wind_speed_mps,
                             .fetch_m = under_test.fetch_m,
                             .choppiness = settings["chop"] * 0.01,
                             .seed = static_cast<std::uint64_t>(seed),
                             .resolution = settings["waves"]});
        const SpectralMoments unresolved = tile.unresolved_from_all();
        std::printf(
            "  seed %d: waves of %.3f ... %.0f m, Hs %.2f m, slope variance %.5f "
            "(unresolved at footprint 0: %.1e of it)\n",
            seed, tile.shortest_m(), tile.size_m(), tile.whole().significant_height_m(), tile.whole().mss(),
            unresolved.mss() / tile.whole().mss());
        const auto start = std::chrono::steady_clock::now();
        const auto elapsed = [&] {
            return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        };
        const FinestSea sea(tile, view, kReach_m, settings["lattice"] * settings["waves"]);
        const double built = elapsed();
        const auto traced = trace_paths(tile, sea, view, sky, wide,
                                        {.strata = settings["strata"],
                                         .passes = settings["passes"],
                                         .facet_normals = settings["facets"] != 0,
                                         .first_row = first_row(view),
                                         .refracted = kFromBelow,
                                         .seed = static_cast<std::uint64_t>(seed)});
        std::printf("  built in %.1f s, traced in %.1f s\n", built, elapsed() - built);
        for (std::size_t p = 0; p < traced.size(); ++p) {
            sums.single += banded(traced[p].single);
            sums.all += banded(traced[p].all);
            sums.small_sun += banded(traced[p].small_sun);
            passes[p] += banded(traced[p].all);
            small_passes[p] += banded(traced[p].small_sun);
            sums.rays += traced[p].rays;
            sums.missed += traced[p].missed;
            sums.blocked += traced[p].blocked;
            sums.turned_away += traced[p].turned_away;
        }
        const auto seen_at = [&](double cell_px) {
            return sea_pixels(tile, view,
                              {.first_row = first_row(view),
                               .samples = settings["shading"],
                               .cell_px = cell_px,
                               .pixels = settings["pixels"] * 0.1});
        };
        const auto shaded = [&](const Method& method, const SeaPixels& pixels) {
            return banded(shaded_lines(pixels, method.choice, wide, kFromBelow));
        };
        for (const double cell_px : other_cells(settings))
            sums.by_cell[cell_px] += shaded(kMethods[kBest], seen_at(cell_px));
        const SeaPixels pixels = seen_at(main_cell(settings));
        const SeaPixels constant = with_constant_variance(pixels);
        for (int m = 0; m < kMethodCount; ++m)
            sums.ours[m] += shaded(kMethods[m], kMethods[m].constant_variance ? constant : pixels);
    }
    const double n = settings["seeds"] * settings["passes"];
    for (Bands* bands : {&sums.single, &sums.all, &sums.small_sun})
        for (auto& term : bands->energy)
            for (double& energy : term) energy /= n;
    const auto mean_of_seeds = [&](Bands& bands) {
        for (auto& term : bands.energy)
            for (double& energy : term) energy /= settings["seeds"];
    };
    for (Bands& bands : sums.ours) mean_of_seeds(bands);
    for (auto& [cell_px, bands] : sums.by_cell) mean_of_seeds(bands);
    sums.by_cell[main_cell(settings)] = sums.ours[kBest];
    for (int t = 0; t < kTerms; ++t) sums.noise[t] = noise_of(passes, t);
    sums.small_sun_noise = noise_of(small_passes, kSun);
    return sums;
}

void print_bands(const Comparison& result) {
    for (int t = 0; t < kTerms; ++t) {
        std::printf("\n  %-10s %10s %10s", kTermNames[t], "all", "single");
        for (const Method& method : kMethods) std::printf(" %24s", method.name);
        std::printf("\n");
        for (int b = 0; b < kBands; ++b) {
            const double all = result.all.energy[t][b];
            std::printf("  %-10d %10.4g %10.3f", b, all, result.single.energy[t][b] / all);
            for (const Bands& ours : result.ours) std::printf(" %24.3f", ours.energy[t][b] / all);
            std::printf("\n");
        }
    }
}

// Targets: sun, refracted, sky; 0: none.
struct Target {
    double most[kTerms] = {};
};

void print_table(const Comparison& result, bool agitated) {
    Target targets[kMethodCount];
    targets[kPaper] = {{0.10, 0.10, agitated ? 0.35 : 0.20}};
    targets[kBest] = {{0.08, 0.03, 0.05}};
    targets[kIntegral] = {{0.08, 0.03, 0.03}};
    std::printf("\n  %-24s %-26s %-26s %-26s\n", "rms difference", "sun", "refracted", "sky");
    for (int m = 0; m < kMethodCount; ++m) {
        std::printf("  %-24s", kMethods[m].name);
        for (int t = 0; t < kTerms; ++t) {
            const double rms = rms_difference(result.ours[m], result.all, t);
            char text[64];
            if (targets[m].most[t] > 0.0)
                std::snprintf(text, sizeof text, "%5.1f %%  <= %2.0f %% %s", 100.0 * rms,
                              100.0 * targets[m].most[t], verdict(rms <= targets[m].most[t]));
            else
                std::snprintf(text, sizeof text, "%5.1f %%", 100.0 * rms);
            std::printf(" %-26s", text);
        }
        std::printf("\n");
    }
}

void print_cells(const Comparison& result, const View& view) {
    const int near = band_beyond(view, 33.0), middle = band_beyond(view, 89.0);
    std::printf("\n  nine lookups, cells of %10s %10s %10s      sun to 33 m, to 89 m, beyond (<= 10 %%)\n",
                "sun", "refracted", "sky");
    for (const auto& [cell_px, bands] : result.by_cell) {
        const auto rms = [&, &bands = bands](int term, int first = 0, int end = kBands) {
            return 100.0 * rms_difference(bands, result.all, term, first, end);
        };
        std::printf("  %13g px %17.1f %% %8.1f %% %8.1f %% %17.1f %% %6.1f %% %6.1f %%\n", cell_px, rms(kSun),
                    rms(kRefracted), rms(kSky), rms(kSun, 0, near), rms(kSun, near, middle),
                    rms(kSun, middle));
    }
}

Settings settings_of(int argc, char** argv) {
    Settings settings;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const std::size_t equals = word.find('=');
        const std::string key = word.substr(0, equals);
        if (word == "full") {
            for (const auto& [name, value] : {std::pair{"width", 640},
                                              {"height", 360},
                                              {"strata", 4},
                                              {"passes", 16},
                                              {"seeds", 1},
                                              {"waves", 2048}})
                settings.number[name] = value;
        } else if (equals != std::string::npos && key == "plot") {
            settings.plot = word.substr(equals + 1);
        } else if (equals != std::string::npos && settings.number.count(key)) {
            settings.number[key] = std::atoi(word.c_str() + equals + 1);
        } else {
            std::fprintf(stderr, "bench_fig10: \"%s\" is neither \"full\" nor KEY=NUMBER, KEY one of plot",
                         word.c_str());
            for (const auto& [name, value] : settings.number) std::fprintf(stderr, ", %s", name.c_str());
            std::fprintf(stderr, "\n");
            std::exit(2);
        }
    }
    return settings;
}

void add_panels(Sheet& sheet, const char* sea, const Comparison& result) {
    for (int t = 0; t < kTerms; ++t) {
        const auto values = [&](const Bands& bands) {
            return std::vector<double>(bands.energy[t], bands.energy[t] + kBands);
        };
        sheet.panels.push_back({std::string(kTermNames[t]) + ", " + sea,
                                t == kRefracted ? "left bottom" : "left top",
                                {{"reference", "#000000", values(result.all)},
                                 {"ours", "#1f77b4", values(result.ours[kBest])},
                                 {"constant BRDF", "#d62728", values(result.ours[kConstant])}}});
    }
}

void run(const Settings& settings) {
    const View view = camera(settings);
    const Sky sky = daylight_sky({.sun_elevation_deg = settings["sun"] * 1.0, .sun_azimuth_deg = 53.0});
    std::printf("%d x %d pixels, %d samples each, %d seed(s); %d lines in %d bands, up to %.0f m\n",
                view.resolution.x, view.resolution.y,
                settings["strata"] * settings["strata"] * settings["passes"], settings["seeds"],
                view.resolution.y - first_row(view), kBands, kHorizon_m);
    Sheet sheet{.path = settings.plot, .x_label = "foreground ... horizon", .panels = {}};
    std::vector<SeaUnderTest> seas(std::begin(kSeas), std::end(kSeas));
    if (settings["wind"] > 0) seas = {{"another", 1.0 * settings["wind"], 1e3 * settings["fetch"], true}};
    for (const SeaUnderTest& under_test : seas) {
        std::printf("\nThe sea: %s, wind %.0f m/s over %.0f km\n", under_test.name, under_test.wind_speed_mps,
                    1e-3 * under_test.fetch_m);
        const Comparison result = compare(settings, under_test, view, sky);
        std::printf(
            "  noise: sun %.1f %%, refracted %.2f %%, sky %.2f %%; "
            "the disc as it is: %.1f %%, differs by %.1f %%\n",
            100.0 * result.noise[kSun], 100.0 * result.noise[kRefracted], 100.0 * result.noise[kSky],
            100.0 * result.small_sun_noise, 100.0 * rms_difference(result.small_sun, result.all, kSun));
        std::printf(
            "  of %.3g rays %.2g %% met no sea, %.1f %% were reflected onto it, "
            "%.2g %% met a facet whose normal faces away\n",
            result.rays, 100.0 * result.missed / result.rays, 100.0 * result.blocked / result.rays,
            100.0 * result.turned_away / result.rays);
        std::printf("  one reflection alone differs by: sun %.1f %%, refracted %.1f %%, sky %.1f %%\n",
                    100.0 * rms_difference(result.single, result.all, kSun),
                    100.0 * rms_difference(result.single, result.all, kRefracted),
                    100.0 * rms_difference(result.single, result.all, kSky));
        if (settings["bands"]) print_bands(result);
        print_table(result, under_test.agitated);
        print_cells(result, view);
        add_panels(sheet, under_test.name, result);
    }
    plot(sheet);
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // lines are minutes apart
    pelagic::bench::run(pelagic::bench::settings_of(argc, argv));
}
