// The optics' tables: Eq. 11, the white furnace, effective Fresnel terms, what each filter of the sky errs, and what a
// point of each variant costs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "core/lighting/lighting.h"
#include "core/lighting/sky.h"
#include "tests/bench/timing.h"
#include "tests/core/lighting/optics.h"

namespace pelagic {
namespace {

using glm::dvec2, glm::dvec3, glm::vec2, glm::vec3;
using optics::Furnace;
using optics::Inputs;
using optics::Optics;
namespace oracle = optics::oracle;

constexpr std::array<double, 9> kAngles{0.0, 30.0, 60.0, 70.0, 75.0, 80.0, 85.0, 88.0, 89.5};
constexpr std::array<double, 5> kSigmas{0.02, 0.1, 0.2, 0.3, 0.5};

dvec3 seen_from(double degrees) {
    const double theta = degrees * oracle::kPi / 180.0;
    return {std::sin(theta), 0.0, std::cos(theta)};
}

void heading(const char* title, const char* unit) {
    std::printf("\n%s\n%-18s", title, unit);
    for (double angle : kAngles) std::printf("%9.1f", angle);
    std::printf("\n");
}

// One row for each σ of isotropic waves, a column for each angle from the normal.
template <class Function>
void table(const char* title, Function&& f) {
    heading(title, "sigma \\ angle");
    for (double sigma : kSigmas) {
        std::printf("%-18.2f", sigma);
        for (double angle : kAngles) std::printf("%9.5f", f(seen_from(angle), sigma * sigma));
        std::printf("\n");
    }
}

double normalisation(dvec3 v, double variance) {
    Optics shared;
    const vec3 s(dvec3(variance, variance, 0.0));
    constexpr int kSteps = 400;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const dvec2 x = (dvec2(i, j) + 0.5) * (12.0 / kSteps) - 6.0;
            sum +=
                static_cast<double>(shared.visible_slope_density(vec2(x * std::sqrt(variance)), vec3(v), s));
        }
    return sum * variance * 144.0 / (kSteps * kSteps);
}

// What a white sea shows of a white sky, by one reflection and two.
double furnace(dvec3 v, double variance) {
    Furnace white;
    white.lookup = [](vec2 u, float) { return vec3(dot(u, u) < 1.0f ? 1.0f : 0.0f); };
    const auto frame = white.slope_frame(vec3(0.0f, 0.0f, 1.0f), vec3(dvec3(variance, variance, 0.0)));
    return static_cast<double>(white.sky_reflection(vec3(v), frame).x);
}

// The largest error against the average over 200 × 200 slopes, and where.
template <class Fit, class Term>
void fresnel_errors(const char* name, Fit&& fit, Term&& term) {
    double most = 0.0, most_angle = 0.0, most_along = 0.0, most_across = 0.0, squares = 0.0;
    int count = 0;
    for (double angle : {0.0, 20.0, 40.0, 55.0, 65.0, 72.0, 76.0, 80.0, 83.0, 86.0, 88.0, 89.0, 89.5, 89.9})
        for (double along : {0.01, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5})
            for (double across : {0.01, 0.1, 0.2, 0.35, 0.5}) {
                const dvec3 v = seen_from(angle), s(along * along, across * across, 0.0);
                const double average =
                    oracle::over_visible(v, s, 200, [&](dvec2, dvec3 f) { return term(dot(v, f)); });
                const double error = fit(v.z, along, across) - average;
                squares += error * error;
                ++count;
                if (std::abs(error) > std::abs(most)) {
                    most = error, most_angle = angle, most_along = along, most_across = across;
                }
            }
    std::printf("%-44s %+8.4f at %4.1f deg, sigma %.2f along, %.2f across; rms %.4f\n", name, most,
                most_angle, most_along, most_across, std::sqrt(squares / count));
}

// The mean sky of Eq. 22, filtered in other ways than sky_at_mean_normal(). The axes of an ellipse are each scaled by
// its standard deviation.
struct Filters : Optics {
    explicit Filters(const Sky& sky) {
        kSkyMapSize = static_cast<float>(sky.map.size());
        lookup = [&map = sky.map](vec2 u, float level) { return map.radiance(u, level); };
    }
    vec2 place(vec3 v, SlopeFrame frame) { return sky_place(2.0f * dot(v, frame.normal) * frame.normal - v); }
    // One trilinear lookup of the ellipse's area.
    vec3 isotropic(vec3 v, SlopeFrame frame) {
        const SkyEllipse ellipse = sky_ellipse(place_changes(v, frame), frame.variance);
        return sky_lookup(place(v, frame),
                          sky_level(std::sqrt(ellipse.along * std::max(ellipse.across, 0.0f))));
    }
    // The Gaussian itself by 32 × 32 sharp lookups over ±4 σ: of all of the ellipse, as Eq. 27 has it, or above the horizon.
    vec3 gaussian(vec3 v, SlopeFrame frame, bool is_cut) {
        const SkyEllipse ellipse = sky_ellipse(place_changes(v, frame), frame.variance);
        const vec2 along = std::sqrt(ellipse.along) * ellipse.axis,
                   across = std::sqrt(std::max(ellipse.across, 0.0f)) * vec2(-ellipse.axis.y, ellipse.axis.x);
        constexpr int kSteps = 32;
        vec3 sum(0.0f);
        float total = 0.0f;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const vec2 x = (vec2(i, j) + 0.5f) * (8.0f / kSteps) - 4.0f;
                const vec2 u = place(v, frame) + along * x.x + across * x.y;
                if (is_cut && dot(u, u) > 1.0f) continue;
                const float part = std::exp(-0.5f * dot(x, x));
                sum += part * sky_lookup(u, 0.0f);
                total += part;
            }
        return sum / total;
    }
    vec3 times_fresnel(vec3 v, SlopeFrame frame, vec3 mean) {
        return shown_of_uniform_sky(into_frame(frame, v), frame.variance) * mean;
    }
};

// Green of the reflected sky against the integral, rms of the relative error.
void sky_errors() {
    constexpr std::array kHeights_deg{1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 80.0};
    constexpr std::array kWinds_mps{2.0, 5.0, 10.0, 20.0};
    struct Row {
        const char* name;
        vec3 (*shown)(Filters& filters, vec3 v, Optics::SlopeFrame frame);
        std::array<double, kHeights_deg.size()> by_height{};
        std::array<double, kWinds_mps.size()> by_wind{};
        double all = 0.0, mean = 0.0, worst = 0.0;
    };
    using Frame = Optics::SlopeFrame;
    std::array rows{
        Row{"isotropic, of the ellipse's area",
            [](Filters& f, vec3 v, Frame frame) { return f.times_fresnel(v, frame, f.isotropic(v, frame)); }},
        Row{"ellipse, Eq. 27 (without a horizon)",
            [](Filters& f, vec3 v, Frame frame) {
                return f.times_fresnel(v, frame, f.gaussian(v, frame, false));
            }},
        Row{"ellipse above the horizon, Eq. 22",
            [](Filters& f, vec3 v, Frame frame) {
                return f.times_fresnel(v, frame, f.gaussian(v, frame, true));
            }},
        Row{"one lookup: the same by five probes",
            [](Filters& f, vec3 v, Frame frame) {
                f.kSkyLookups = 1;
                return f.sky_reflection(v, frame);
            }},
        Row{"nine lookups (the default)", [](Filters& f, vec3 v, Frame frame) {
                f.kSkyLookups = 9;
                return f.sky_reflection(v, frame);
            }}};
    int views = 0;
    for (double sun_deg : {5.0, 10.0, 20.0, 40.0, 60.0})
        for (double turbidity : {2.0, 4.0, 6.0}) {
            const Sky sky =
                daylight_sky({.sun_elevation_deg = sun_deg, .sun_azimuth_deg = 0.0, .turbidity = turbidity});
            Filters filters(sky);
            for (std::size_t w = 0; w < kWinds_mps.size(); ++w)
                for (double to_deg : {0.0, 40.0, 90.0}) {
                    // Cox & Munk 1954, clean surface: slope variances along the wind and across.
                    const double along = 0.00316 * kWinds_mps[w], across = 0.003 + 0.00192 * kWinds_mps[w];
                    const double a = to_deg * oracle::kPi / 180.0, c = std::cos(a), n = std::sin(a);
                    const auto frame = filters.slope_frame(
                        vec3(0.0f, 0.0f, 1.0f),
                        vec3(dvec3(along * c * c + across * n * n, along * n * n + across * c * c,
                                   (along - across) * c * n)));
                    for (std::size_t h = 0; h < kHeights_deg.size(); ++h)
                        for (double aside_deg : {0.0, 20.0, 60.0, 120.0, 180.0}) {  // 0: towards the sun
                            const double up = kHeights_deg[h] * oracle::kPi / 180.0,
                                         side = (180.0 + aside_deg) * oracle::kPi / 180.0;
                            const vec3 v(dvec3(std::cos(up) * std::cos(side), std::cos(up) * std::sin(side),
                                               std::sin(up)));
                            filters.kSkyLookups = 0;
                            const double expected = static_cast<double>(filters.sky_reflection(v, frame).y);
                            for (Row& row : rows) {
                                const double error =
                                    static_cast<double>(row.shown(filters, v, frame).y) / expected - 1.0;
                                row.all += error * error;
                                row.mean += error;
                                row.worst = std::max(row.worst, std::abs(error));
                                row.by_height[h] += error * error;
                                row.by_wind[w] += error * error;
                            }
                            ++views;
                        }
                }
        }
    std::printf(
        "\nreflected sky against the integral, per cent: rms, mean and worst of %d views of 15 skies\n%-36s",
        views, "");
    std::printf("%6s %6s %6s  rms from", "rms", "mean", "worst");
    for (double height : kHeights_deg) std::printf(" %4.0f\u00b0", height);
    std::printf("; wind");
    for (double wind : kWinds_mps) std::printf(" %3.0f m/s", wind);
    std::printf("\n");
    const auto rms = [](double sum, double count) { return 100.0 * std::sqrt(sum / count); };
    for (const Row& row : rows) {
        std::printf("%-36s%6.1f %+6.1f %6.1f          ", row.name, rms(row.all, views),
                    100.0 * row.mean / views, 100.0 * row.worst);
        for (double sum : row.by_height) std::printf(" %5.1f", rms(sum, views / double(kHeights_deg.size())));
        std::printf("      ");
        for (double sum : row.by_wind) std::printf(" %7.1f", rms(sum, views / double(kWinds_mps.size())));
        std::printf("\n");
    }
}

// Medians of interleaved runs over the same points, as multiples of the paper's variant.
void costs() {
    Inputs inputs(1);
    std::vector<SeaPoint> points(20000);
    for (SeaPoint& p : points) {
        p = {.to_eye = inputs.direction(1e-2),
             .normal = inputs.direction(0.8),
             .slope_variance = inputs.variance(0.05, 0.3, 0.5),
             .coverage = 0.02f};
    }
    std::vector<SeaRadiance> radiance(points.size());
    const Sky sky = daylight_sky({});
    const WaterBody water = water_body({});
    const LightingChoice off{.sun = false, .sky = false, .water = false, .whitecaps = false};
    const auto only = [&off](const auto& turn_on) {
        LightingChoice choice = off;
        turn_on(choice);
        return choice;
    };
    using Quality = SkyQuality;
    std::vector<bench::Timed> timed;
    for (const auto& [name, choice] : std::vector<std::pair<const char*, LightingChoice>>{
             {"all, one lookup, Eq. 26 (the paper's)",
              {.sky_quality = Quality::One, .fresnel = FresnelFit::Paper}},
             {"all, one lookup, exact Fresnel", {.sky_quality = Quality::One}},
             {"all, nine, Eq. 26", {.fresnel = FresnelFit::Paper}},
             {"all, nine, exact Fresnel (the default)", {}},
             {"nothing", off},
             {"sun alone", only([](LightingChoice& c) { c.sun = true; })},
             {"water alone", only([](LightingChoice& c) { c.water = true; })},
             {"whitecaps alone", only([](LightingChoice& c) { c.whitecaps = true; })},
             {"sky alone, one lookup",
              only([](LightingChoice& c) { c.sky = true, c.sky_quality = Quality::One; })},
             {"sky alone, nine", only([](LightingChoice& c) { c.sky = true; })}})
        timed.push_back({name, [&, choice = choice] { shade_sea(choice, sky, water, points, radiance); }});
    bench::interleave(timed, 9);
    // The reference takes long: a fiftieth of the points, beside the paper's variant of as many.
    const std::size_t few = points.size() / 50;
    const auto shade_few = [&](const LightingChoice& choice) {
        shade_sea(choice, sky, water, std::span(points).first(few), std::span(radiance).first(few));
    };
    std::vector<bench::Timed> slow{
        {"", [&] { shade_few({.sky_quality = Quality::One, .fresnel = FresnelFit::Paper}); }},
        {"all, the integral", [&] { shade_few({.sky_quality = Quality::Integral}); }}};
    bench::interleave(slow, 9);

    const double unit = timed.front().median();
    std::printf("\ntime per point, in times of the paper's variant (%.0f ns here)\n",
                unit / static_cast<double>(points.size()) * 1e6);
    for (const bench::Timed& row : timed) std::printf("%-52s %8.2f\n", row.name.c_str(), row.median() / unit);
    std::printf("%-52s %8.2f\n", slow[1].name.c_str(), slow[1].median() / slow[0].median());
}

void print() {
    table("Eq. 11: integral of what is seen over all slopes (1)", normalisation);
    table("white furnace: 0.99 ... 1 at 0 ... 85 degrees, sigma <= 0.3", furnace);
    table("of the real sea's reflected light, what meets the sea again", [](dvec3 v, double s) {
        return static_cast<double>(Optics().reflected_again(vec3(v), vec3(dvec3(s, s, 0.0))));
    });
    std::printf("\neffective Fresnel terms, largest errors for sigma <= 0.5\n");
    Optics shared;
    const auto paper = [&](double c, double along, double) {
        return static_cast<double>(
            shared.fresnel_effective_paper(static_cast<float>(c), static_cast<float>(along)));
    };
    const auto exact = [&](double c, double along, double across) {
        return static_cast<double>(shared.fresnel_effective_exact(
            static_cast<float>(c), static_cast<float>(along), static_cast<float>(across * across)));
    };
    const auto term = [](double c) { return oracle::fresnel(c); };
    fresnel_errors("Eq. 26 against the average of Schlick's term", paper, oracle::schlick);
    fresnel_errors("Eq. 26 against the average of the exact term", paper, term);
    fresnel_errors("our fit against the average of the exact term", exact, term);
    std::printf("\nwater, reflectance (Rec. 709)\n");
    for (double chlorophyll : {0.03, 0.1, 1.0, 10.0})
        for (const auto& [name, kind] : {std::pair{"ocean", WaterKind::Ocean},
                                         {"coastal", WaterKind::Coastal},
                                         {"turbid", WaterKind::Turbid}}) {
            const vec3 c = water_body({.kind = kind, .chlorophyll_mg_m3 = chlorophyll}).reflectance;
            std::printf("%-10s %6.2f mg/m3 %9.4f %9.4f %9.4f\n", name, chlorophyll, static_cast<double>(c.x),
                        static_cast<double>(c.y), static_cast<double>(c.z));
        }
    sky_errors();
    costs();
}

}  // namespace
}  // namespace pelagic

int main() {
    pelagic::print();
}
