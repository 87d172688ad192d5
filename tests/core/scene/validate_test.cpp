// Which scenes are refused, and in which words.
#include "core/scene/validate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/scene/limits.h"
#include "key_samples.h"

namespace pelagic {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Scene changed(const std::function<void(Scene&)>& change) {
    Scene scene;
    change(scene);
    return scene;
}

std::string all_text(const std::vector<Problem>& problems) {
    std::string out;
    for (const Problem& problem : problems) out += text_of(problem) + '\n';
    return out;
}

void expect_good(const std::function<void(Scene&)>& change) {
    const std::vector<Problem> problems = validate(changed(change));
    EXPECT_TRUE(problems.empty()) << all_text(problems);
}

// Refused for this key and value alone, with these words among what is accepted.
struct Refusal {
    std::string key, value, accepted;
};

void expect_refused(const std::function<void(Scene&)>& change, const Refusal& refusal) {
    const std::vector<Problem> problems = validate(changed(change));
    ASSERT_EQ(problems.size(), 1u) << refusal.key << '\n' << all_text(problems);
    EXPECT_EQ(problems[0].key, refusal.key);
    EXPECT_EQ(problems[0].value, refusal.value) << refusal.key;
    EXPECT_NE(problems[0].accepted.find(refusal.accepted), std::string::npos) << text_of(problems[0]);
    EXPECT_FALSE(problems[0].problem.empty());
}

TEST(Validate, TheDefaultsAreGood) {
    expect_good([](Scene&) {});
}

TEST(Validate, ANumberIsInItsRangeEndsIncluded) {
    struct Case {
        std::string key;
        Range range;
        std::function<void(Scene&, double)> set;
    };
    const std::vector<Case> cases{
        {"shot.fps", limits::kFps, [](Scene& s, double v) { s.shot.fps = v; }},
        {"sea.wind_speed_mps", limits::kWindSpeed_mps, [](Scene& s, double v) { s.sea.wind_speed_mps = v; }},
        {"sea.wind_direction_deg", limits::kAngle_deg,
         [](Scene& s, double v) { s.sea.wind_direction_deg = v; }},
        {"sea.fetch_m", limits::kFetch_m, [](Scene& s, double v) { s.sea.fetch_m = v; }},
        {"sea.swell[0].height_m", limits::kSwellHeight_m,
         [](Scene& s, double v) {
             s.sea.swell = {{v, 10.0, 0.0}};
         }},
        {"sea.swell[0].period_s", limits::kSwellPeriod_s,
         [](Scene& s, double v) {
             s.sea.swell = {{1.0, v, 0.0}};
         }},
        {"sea.swell[0].direction_deg", limits::kAngle_deg,
         [](Scene& s, double v) {
             s.sea.swell = {{1.0, 10.0, v}};
         }},
        {"waves.choppiness", limits::kChoppiness, [](Scene& s, double v) { s.waves.choppiness = v; }},
        {"waves.cascades[0].size_m", limits::kCascadeSize_m,
         [](Scene& s, double v) {
             s.waves.cascades = {{v, 64}};
         }},
        {"waves.cascades[0].choppiness", limits::kChoppiness,
         [](Scene& s, double v) {
             s.waves.cascades = {{400.0, 64, v}};
         }},
        {"sea.gust_fronts[0].frame", limits::kFrame,
         [](Scene& s, double v) { s.sea.gust_fronts = {{.frame = v}}; }},
        {"sea.gust_fronts[0].speed_mps", limits::kFrontSpeed_mps,
         [](Scene& s, double v) { s.sea.gust_fronts = {{.speed_mps = v}}; }},
        {"sea.gust_fronts[0].length_m", limits::kFrontSize_m,
         [](Scene& s, double v) { s.sea.gust_fronts = {{.length_m = v}}; }},
        {"sea.gust_fronts[0].width_m", limits::kFrontSize_m,
         [](Scene& s, double v) { s.sea.gust_fronts = {{.width_m = v}}; }},
        {"sea.gust_fronts[0].edge_m", limits::kFrontEdge_m,
         [](Scene& s, double v) { s.sea.gust_fronts = {{.edge_m = v}}; }},
        {"sea.gust_fronts[0].wind", limits::kFrontWind,
         [](Scene& s, double v) { s.sea.gust_fronts = {{.wind = v}}; }},
        {"waves.heroes[0].frame", limits::kFrame,
         [](Scene& s, double v) { s.waves.heroes = {{.frame = v}}; }},
        {"waves.heroes[0].height_m", limits::kHeroHeight_m,
         [](Scene& s, double v) { s.waves.heroes = {{.frame = 1.0, .height_m = v}}; }},
        {"waves.masks[0].length_m", limits::kMaskSize_m,
         [](Scene& s, double v) { s.waves.masks = {{.length_m = v}}; }},
        {"waves.masks[0].width_m", limits::kMaskSize_m,
         [](Scene& s, double v) { s.waves.masks = {{.width_m = v}}; }},
        {"waves.masks[0].edge_m", limits::kMaskEdge_m,
         [](Scene& s, double v) { s.waves.masks = {{.edge_m = v}}; }},
        {"waves.masks[0].waves", limits::kMaskWaves,
         [](Scene& s, double v) { s.waves.masks = {{.waves = v}}; }},
        {"waves.masks[0].ripples", limits::kMaskShare,
         [](Scene& s, double v) { s.waves.masks = {{.ripples = v}}; }},
        {"waves.masks[0].foam", limits::kMaskShare,
         [](Scene& s, double v) { s.waves.masks = {{.foam = v}}; }},
        {"waves.vessels[0].length_m", limits::kVesselSize_m,
         [](Scene& s, double v) { s.waves.vessels = {{.length_m = v}}; }},
        {"waves.vessels[0].beam_m", limits::kVesselSize_m,
         [](Scene& s, double v) { s.waves.vessels = {{.beam_m = v}}; }},
        {"waves.vessels[0].draught_m", limits::kVesselSize_m,
         [](Scene& s, double v) { s.waves.vessels = {{.draught_m = v}}; }},
        {"waves.vessels[0].foam", limits::kMaskShare,
         [](Scene& s, double v) { s.waves.vessels = {{.foam = v}}; }},
        {"waves.vessels[0].waves", limits::kVesselWaves,
         [](Scene& s, double v) { s.waves.vessels = {{.waves = v}}; }},
        {"waves.shortest_m", limits::kTrain_m,
         [](Scene& s, double v) {
             s.waves.model = WaveModel::Trochoid;
             s.waves.shortest_m = v;
         }},
        {"waves.longest_m", limits::kTrain_m,
         [](Scene& s, double v) {
             s.waves.model = WaveModel::Trochoid;
             s.waves.longest_m = v;
         }},
        {"surface.size_m", limits::kSurfaceSize_m, [](Scene& s, double v) { s.surface.size_m = v; }},
        {"camera.fov_deg", limits::kFov_deg, [](Scene& s, double v) { s.camera.fov_deg = v; }},
        {"light.sun_elevation_deg", limits::kSunElevation_deg,
         [](Scene& s, double v) { s.light.sun_elevation_deg = v; }},
        {"light.sun_azimuth_deg", limits::kAngle_deg,
         [](Scene& s, double v) { s.light.sun_azimuth_deg = v; }},
        {"light.turbidity", limits::kTurbidity, [](Scene& s, double v) { s.light.turbidity = v; }},
        {"water.chlorophyll_mg_m3", limits::kChlorophyll_mg_m3,
         [](Scene& s, double v) { s.water.chlorophyll_mg_m3 = v; }},
        {"water.crest_light", limits::kWaterGain, [](Scene& s, double v) { s.water.crest_light = v; }},
        {"water.bubbles", limits::kWaterGain, [](Scene& s, double v) { s.water.bubbles = v; }},
        {"water.caustics", limits::kWaterGain, [](Scene& s, double v) { s.water.caustics = v; }},
        {"water.floor_pattern_m", limits::kFoamPattern_m,
         [](Scene& s, double v) {
             s.water.floor_pattern = "tiles.exr";
             s.water.floor_pattern_m = v;
         }},
        {"sea.depth_size_m", limits::kSurfaceSize_m,
         [](Scene& s, double v) {
             s.sea.depth_file = "bay.exr";
             s.sea.depth_size_m = v;
         }},
        {"sea.depth_east_m", limits::kCameraCoordinate_m,
         [](Scene& s, double v) {
             s.sea.depth_file = "bay.exr";
             s.sea.depth_east_m = v;
         }},
        {"sea.depth_north_m", limits::kCameraCoordinate_m,
         [](Scene& s, double v) {
             s.sea.depth_file = "bay.exr";
             s.sea.depth_north_m = v;
         }},
        {"surface.cell_px", limits::kCell_px, [](Scene& s, double v) { s.surface.cell_px = v; }},
    };
    for (const Case& c : cases) {
        for (const double good : {c.range.low, c.range.high}) {
            expect_good([&](Scene& s) { c.set(s, good); });
        }
        for (const double bad : {std::nextafter(c.range.low, -kInfinity),
                                 std::nextafter(c.range.high, kInfinity), -kInfinity, kInfinity}) {
            const std::vector<Problem> problems = validate(changed([&](Scene& s) { c.set(s, bad); }));
            ASSERT_EQ(problems.size(), 1u) << c.key << ' ' << bad;
            EXPECT_EQ(problems[0].key, c.key);
            EXPECT_EQ(problems[0].accepted, text_of(c.range));
        }
        expect_refused([&](Scene& s) { c.set(s, kNan); }, {c.key, "nan", text_of(c.range)});
    }
}

TEST(Validate, AColoursPartsAreInItsRange) {
    expect_good([](Scene& s) { s.water.floor_colour = {0.0, 1.0, 0.5}; });
    for (const double bad : {-1e-9, 1.1, kNan})
        EXPECT_EQ(validate(changed([&](Scene& s) { s.water.floor_colour.y = bad; })).size(), 1u) << bad;
}

// The hard cases that have to work.
TEST(Validate, HardCasesAreGood) {
    expect_good([](Scene& s) { s.sea.wind_speed_mps = 0.0; });
    expect_good([](Scene& s) { s.sea.wind_speed_mps = 80.0; });
    expect_good([](Scene& s) { s.sea.fetch_m = 1.0; });
    expect_good([](Scene& s) { s.sea.fetch_m = 1e7; });
    expect_good([](Scene& s) { s.sea.depth_m = 0.01; });
    expect_good([](Scene& s) { s.sea.depth_m = kInfinity; });
    expect_good([](Scene& s) { s.surface.resolution = 1; });
    expect_good([](Scene& s) { s.surface.resolution = 8192; });
    expect_good([](Scene& s) { s.camera.position_m = {1e6, 0.0, 1e5}; });
    expect_good([](Scene& s) { s.camera.position_m = {0.0, 0.0, 1e5}; });  // straight down
    expect_good([](Scene& s) { s.shot.first_frame = s.shot.last_frame = -100; });
    expect_good([](Scene& s) { s.light.sun_elevation_deg = -90.0; });
    expect_good([](Scene& s) { s.surface.kind = SurfaceKind::ProjectedGrid; });
    expect_good([](Scene& s) { s.water.type = WaterType::Turbid; });
}

// A lens of 50 mm, 36 mm wide, can't be sharp within 50 mm; one that sees nearly nothing is no lens.
TEST(Validate, Lens) {
    const auto lens = [](double f_stop, double focus_m) {
        return [=](Scene& s) {
            s.camera.focal_length_mm = 50.0;
            s.camera.f_stop = f_stop;
            s.camera.focus_distance_m = focus_m;
        };
    };
    expect_good(lens(2.8, 5.0));
    expect_good(lens(0.0, 0.04));
    expect_refused(lens(0.2, 5.0), {"camera.f_stop", "0.2", "0.5 … 1000"});
    expect_refused(lens(2.8, 0.04), {"camera.focus_distance_m", "0.04", "more than that"});
    expect_refused(
        [](Scene& s) {
            s.camera.focal_length_mm = 2000.0;
            s.camera.sensor_width_mm = 0.2;
        },
        {"camera.focal_length_mm", "2000", "an angle of view of"});
}

TEST(Validate, Depth) {
    expect_refused([](Scene& s) { s.sea.depth_m = 0.0; }, {"sea.depth_m", "0", "or inf"});
    expect_refused([](Scene& s) { s.sea.depth_m = -kInfinity; }, {"sea.depth_m", "-inf", "or inf"});
    expect_refused([](Scene& s) { s.sea.depth_m = kNan; }, {"sea.depth_m", "nan", "or inf"});
}

TEST(Validate, Name) {
    for (const char* good : {"sea", "-", "_9", "Sturm-Nr_7"}) {
        expect_good([&](Scene& s) { s.shot.name = good; });
    }
    expect_good([](Scene& s) { s.shot.name = std::string(200, 'a'); });
    for (const char* bad : {"", "a/b", "..", "a b", "\xc3\xa9", "a\n", "#"}) {
        const std::vector<Problem> problems = validate(changed([&](Scene& s) { s.shot.name = bad; }));
        ASSERT_EQ(problems.size(), 1u) << bad;
        EXPECT_EQ(problems[0].key, "shot.name");
        EXPECT_NE(problems[0].accepted.find("letters, digits, _ and -"), std::string::npos);
    }
    const std::string too_long(201, 'a');
    expect_refused([&](Scene& s) { s.shot.name = too_long; }, {"shot.name", '"' + too_long + '"', "200"});
}

TEST(Validate, FramesSeedAndLoop) {
    expect_refused([](Scene& s) { s.shot.first_frame = 49; }, {"shot.frames", "[49, 48]", "first ≤ last"});
    expect_refused([](Scene& s) { s.shot.last_frame = std::numeric_limits<int>::max(); },
                   {"shot.frames", "[1, 2147483647]", "1e8"});
    expect_good([](Scene& s) { s.shot.seed = ~std::uint64_t{0} >> 1; });
    expect_refused([](Scene& s) { s.shot.seed = ~std::uint64_t{0}; },
                   {"shot.seed", "18446744073709551615", "9223372036854775807"});

    expect_good([](Scene& s) { s.shot.loop_s = 10.0; });
    expect_good([](Scene& s) { s.shot.loop_s = 1.0 / 24.0; });
    // 100 frames of film transferred to video, written with seven digits: 4.6e-6 of a frame short.
    expect_good([](Scene& s) {
        s.shot.fps = 24000.0 / 1001.0;
        s.shot.loop_s = 4.170833;
    });
    expect_refused([](Scene& s) { s.light.sky_rotation_deg = 20.0; },
                   {"light.sky_rotation_deg", "20", "0, or light.sky = \"PATH.exr\""});
    expect_refused([](Scene& s) { s.light.sky_gain = 2.0; },
                   {"light.sky_gain", "2", "1, or light.sky = \"PATH.exr\""});
    expect_good([](Scene& s) {
        s.light.sky = "noon.exr";
        s.light.sky_rotation_deg = -200.0;
        s.light.sky_gain = 0.5;
    });
    expect_refused([](Scene& s) { s.effects.foam_pattern = "bubbles"; },
                   {"effects.foam_pattern", "\"bubbles\"", "\"lace\", or the path"});
    expect_refused([](Scene& s) { s.sea.depth_file = "bay.png"; },
                   {"sea.depth_file", "\"bay.png\"", "\"none\", or the path"});
    expect_refused([](Scene& s) { s.water.floor_pattern = ""; },
                   {"water.floor_pattern", "\"\"", "\"plain\", or the path"});
    expect_refused([](Scene& s) { s.effects.foam_pattern_m = 4.0; },
                   {"effects.foam_pattern_m", "4", "10, or effects.foam_pattern = \"PATH.exr\""});
    expect_good([](Scene& s) { s.sea.depth_file = "reef.obj"; });
    // Waves that feel the floor: of a picture, of trains or tiles alone, in a sea that stays what it is.
    const auto coast = [](auto&& change) {
        return [=](Scene& s) {
            s.waves.model = WaveModel::Trochoid;
            s.waves.coast = true;
            s.sea.depth_file = "bay.exr";
            change(s);
        };
    };
    expect_good(coast([](Scene&) {}));
    expect_refused(coast([](Scene& s) { s.sea.depth_file = "none"; }),
                   {"waves.coast", "true", "false, or sea.depth_file = \"PATH.exr\" or \"PATH.obj\""});
    expect_good(coast([](Scene& s) { s.sea.depth_file = "reef.obj"; }));
    const auto tiles = [&](auto&& change) {
        return coast([=](Scene& s) {
            s.waves.model = WaveModel::Fft;
            s.waves.cascades = {{60.0, 128}};
            change(s);
        });
    };
    expect_good(tiles([](Scene&) {}));
    expect_good(tiles([](Scene& s) {
        s.objects = test::scene_with_body().objects;
        s.objects[0].floats = true;
        s.objects[0].buoyancy = Buoyancy::Response;
    }));
    expect_refused(tiles([](Scene& s) {
                       s.output.cascade_tiles = true;
                       s.output.maps = {MapKind::Normal};
                   }),
                   {"output.cascade_tiles", "true", "false, or waves.coast = false"});
    expect_good(tiles([](Scene& s) { s.waves.heroes = {{}}; }));
    expect_refused(tiles([](Scene& s) {
                       s.keyed = {{"sea.wind_speed_mps", {.keys = {{1, 5.0}, {40, 9.0}}}}};
                   }),
                   {"waves.coast", "true", "a sea without keys, or false"});
    expect_refused(coast([](Scene& s) {
                       s.waves.cascades = {{60.0, 128}};
                   }),
                   {"waves.coast", "true", "no waves.cascades, or waves.model = \"fft\""});
    expect_refused(coast([](Scene& s) { s.waves.heroes = {{}}; }),
                   {"waves.coast", "true", "no waves.heroes, or false"});
    expect_refused(coast([](Scene& s) {
                       s.keyed = {{"sea.wind_speed_mps", {.keys = {{1, 5.0}, {40, 9.0}}}}};
                   }),
                   {"waves.coast", "true", "a sea without keys, or false"});
    expect_refused(coast([](Scene& s) {
                       s.objects = test::scene_with_body().objects;
                       s.objects[0].floats = true;
                       s.objects[0].buoyancy = Buoyancy::Response;
                   }),
                   {"waves.coast", "true", "objects[].buoyancy = \"plane\", or false"});
    expect_refused([](Scene& s) { s.effects.foam_pattern = "foam.obj"; },
                   {"effects.foam_pattern", "\"foam.obj\"", "\"lace\", or the path"});
    // A mesh says itself where it lies.
    expect_refused(
        [](Scene& s) {
            s.sea.depth_file = "reef.obj";
            s.sea.depth_east_m = 4.0;
        },
        {"sea.depth_east_m", "4", "0, or sea.depth_file = \"PATH.exr\""});
    expect_refused([](Scene& s) { s.sea.depth_size_m = 4.0; },
                   {"sea.depth_size_m", "4", "or sea.depth_file = \"PATH.exr\""});
    expect_refused([](Scene& s) { s.sea.depth_north_m = -4.0; },
                   {"sea.depth_north_m", "-4", "or sea.depth_file = \"PATH.exr\""});
    expect_refused([](Scene& s) { s.water.floor_pattern_m = 5.0; },
                   {"water.floor_pattern_m", "5", "4, or water.floor_pattern = \"PATH.exr\""});
    expect_good([](Scene& s) {
        s.effects.foam_pattern = "lace.EXR";
        s.effects.foam_pattern_m = 4.0;
    });
    expect_refused([](Scene& s) { s.shot.loop_s = 1.01; }, {"shot.loop_s", "1.01", "nearest: 1"});
    // Less than a frame isn't no frames: the nearest loop is one frame long.
    expect_refused([](Scene& s) { s.shot.loop_s = 1e-6; }, {"shot.loop_s", "1e-6", "nearest: 0.0416"});
    expect_refused([](Scene& s) { s.shot.loop_s = -1.0; }, {"shot.loop_s", "-1", "0 … 1e7"});
    expect_refused([](Scene& s) { s.shot.loop_s = kNan; }, {"shot.loop_s", "nan", "0 … 1e7"});
}

TEST(Validate, TheSeasTimeIsOneThatItCanHave) {
    const auto far_frames = [](Scene& s) {
        s.shot.first_frame = 99999999;
        s.shot.last_frame = 100000000;
        s.shot.fps = 1e-3;
    };
    expect_good(far_frames);
    expect_refused(
        [&](Scene& s) {
            far_frames(s);
            s.shot.time_scale = 1e3;
        },
        {"shot.time_scale", "1000", "1e12"});

    // In a loop each wave goes round at least once, however short the loop is in the sea's time: infinitely fast,
    // here.
    const auto slow = [](Scene& s) { s.shot.time_scale = 1e-300; };
    expect_good(slow);
    expect_refused(
        [&](Scene& s) {
            slow(s);
            s.shot.loop_s = 1.0;
        },
        {"shot.time_scale", "1e-300", "1e-6"});
    expect_good([](Scene& s) {
        s.shot.loop_s = 1.0;
        s.shot.time_scale = 0.0;
    });
}

MeasuredSpectrum measured() {
    return {{{0.1, 1.0, 0.5, 0.5, 0.2, 0.2, true}, {0.2, 2.0, 0.0, 0.0, 0.0, 0.0, false}}, "41010", "a time"};
}

TEST(Validate, AMeasuredSpectrumIsThereExactlyWithFile) {
    const auto with = [](const std::function<void(MeasuredSpectrum&)>& change) {
        return [change](Scene& s) {
            s.sea.spectrum = SpectrumKind::File;
            s.sea.measured = measured();
            change(*s.sea.measured);
        };
    };
    expect_good(with([](MeasuredSpectrum&) {}));
    expect_refused([](Scene& s) { s.sea.spectrum = SpectrumKind::File; },
                   {"sea.spectrum", "\"file\"", "spectrum_file and spectrum_time"});
    expect_refused([](Scene& s) { s.sea.measured = measured(); },
                   {"sea.spectrum", "\"jonswap\"", "\"file\""});

    const std::string key = "sea.spectrum_file";
    const std::string value = "\"41010 at a time\"";
    expect_refused(with([](MeasuredSpectrum& m) { m.bins.pop_back(); }), {key, value, "at least two"});
    expect_refused(with([](MeasuredSpectrum& m) { m.bins[1].frequency_hz = 0.1; }), {key, value, "rising"});
    expect_refused(with([](MeasuredSpectrum& m) { m.bins[0].frequency_hz = 0.0; }),
                   {key, value, "0.0001 … 100 Hz"});
    expect_refused(with([](MeasuredSpectrum& m) { m.bins[0].density_m2_per_hz = -1.0; }),
                   {key, value, "≥ 0"});
    expect_refused(with([](MeasuredSpectrum& m) { m.bins[0].density_m2_per_hz = kInfinity; }),
                   {key, value, "≥ 0"});
    expect_refused(with([](MeasuredSpectrum& m) { m.bins[0].c1_re = 1.0; }), {key, value, "r1 and r2"});
    expect_refused(with([](MeasuredSpectrum& m) { m.bins[0].c2_im = kNan; }), {key, value, "r1 and r2"});
    expect_good(
        with([](MeasuredSpectrum& m) { m.bins[1].c2_im = kNan; }));  // without a direction, not looked at
}

TEST(Validate, SomethingMustBeBaked) {
    expect_refused([](Scene& s) { s.output.mesh = MeshFormat::None; },
                   {"output.mesh", "\"none\"", "at least one map"});
    expect_good([](Scene& s) {
        s.output.mesh = MeshFormat::None;
        s.output.maps = {MapKind::Normal};
    });
    for (const MeshFormat mesh : {MeshFormat::Usda, MeshFormat::Usdc})
        expect_good([&](Scene& s) { s.output.mesh = mesh; });
    expect_refused([](Scene& s) { s.output.cascade_tiles = true; },
                   {"output.cascade_tiles", "true", "at least one map"});
}

TEST(Validate, APlanetIsRoundAndSeenOnItsNearSide) {
    const auto planet = [](const std::function<void(Scene&)>& change) {
        return [change](Scene& s) {
            s.surface.kind = SurfaceKind::Planet;
            change(s);
        };
    };
    expect_good(planet([](Scene&) {}));
    expect_refused(planet([](Scene& s) { s.surface.earth_curvature = false; }),
                   {"surface.earth_curvature", "false", "projected-grid"});
    // Straight above the origin at any height; a quarter of the circle away, only at the sea.
    expect_good(planet([](Scene& s) { s.camera.position_m = {0.0, 0.0, 1e9}; }));
    expect_good(planet([](Scene& s) { s.camera.position_m = {6.3e6, 0.0, -5.4e6}; }));
    expect_refused(planet([](Scene& s) {
                       s.camera.position_m = {7e6, 0.0, -3e6};
                   }),
                   {"camera.position_m", "[7000000, 0, -3000000]", "nearer to the origin"});
    expect_refused(planet([](Scene& s) {
                       s.camera.keys = {
                           {.frame = 1, .position_m = {0.0, 0.0, 9.0}, .look_at_m = {0.0, 1.0, 9.0}},
                           {.frame = 9, .position_m = {1e7, 0.0, 9.0}, .look_at_m = {0.0, 1.0, 9.0}}};
                   }),
                   {"camera.keys[1].position_m", "[1e7, 0, 9]", "nearer to the origin"});
    expect_good([](Scene& s) { s.camera.position_m = {1e7, 0.0, 9.0}; });
}

TEST(Validate, CascadesReachEachOther) {
    expect_good([](Scene& s) { s.waves.cascades = {{400.0, 16}}; });
    expect_good([](Scene& s) { s.waves.cascades = {{400.0, 512}, {50.0, 512}, {5.0, 8192}}; });
    // 400/50 × 8 modes = 64, and corners of cells to 64.7; N/2 − 1 ≥ 65 first at 132.
    expect_good([](Scene& s) { s.waves.cascades = {{400.0, 132}, {50.0, 16}}; });
    expect_refused(
        [](Scene& s) {
            s.waves.cascades = {{400.0, 128}, {50.0, 16}};
        },
        {"waves.cascades[0].resolution", "128", "at least 132"});
    // 1e5 × 8 modes: out of reach.
    expect_refused(
        [](Scene& s) {
            s.waves.cascades = {{1e4, 8192}, {0.1, 16}};
        },
        {"waves.cascades[0].resolution", "8192", "put a cascade between, of about 31.62 m"});
    expect_refused([](Scene& s) { s.waves.cascades = std::vector<CascadeSize>(17); },
                   {"waves.cascades", "17 entries", "at most 16"});
    expect_refused(
        [](Scene& s) {
            s.waves.cascades = {{50.0, 512}, {50.0, 512}};
        },
        {"waves.cascades[1].size_m", "50", "differ"});
    expect_refused(
        [](Scene& s) {
            s.waves.cascades = {{50.0, 512}, {400.0, 512}};
        },
        {"waves.cascades[1].size_m", "400", "largest first"});
    // Trains have the shot's choppiness, and so have the cascades beside them.
    const auto with_trains = [](std::optional<double> choppiness) {
        return [choppiness](Scene& s) {
            s.waves.model = WaveModel::Trochoid;
            s.waves.cascades = {{400.0, 132}, {50.0, 16, choppiness}};
        };
    };
    expect_good(with_trains({}));
    expect_refused(with_trains(0.5), {"waves.cascades[1].choppiness", "0.5", "model = \"fft\""});
}

TEST(Validate, Resolutions) {
    for (const int bad : {0, -16, 14, 17, 8194, 1000000000}) {
        expect_refused(
            [&](Scene& s) {
                s.waves.cascades = {{400.0, bad}};
            },
            {"waves.cascades[0].resolution", std::to_string(bad), "16 … 8192"});
    }
    for (const int bad : {0, -1, 8193, 1000000000}) {
        expect_refused([&](Scene& s) { s.surface.resolution = bad; },
                       {"surface.resolution", std::to_string(bad), "1 … 8192"});
        expect_refused([&](Scene& s) { s.output.map_resolution = bad; },
                       {"output.map_resolution", std::to_string(bad), "1 … 8192"});
    }
    expect_refused(
        [](Scene& s) {
            s.camera.resolution = {0, 720};
        },
        {"camera.resolution", "[0, 720]", "1 … 65536"});
    expect_refused(
        [](Scene& s) {
            s.camera.resolution = {1280, 65537};
        },
        {"camera.resolution", "[1280, 65537]", "1 … 65536"});
}

TEST(Validate, ACameraLooksSomewhere) {
    expect_refused([](Scene& s) { s.camera.look_at_m = s.camera.position_m; },
                   {"camera.look_at_m", "[0, -60, 4]", "away from the camera"});
    expect_refused([](Scene& s) { s.camera.look_at_m = s.camera.position_m + glm::dvec3(0.0, 0.0, 1e-7); },
                   {"camera.look_at_m", "[0, -60, 4.0000001]", "away from the camera"});
    expect_refused([](Scene& s) { s.camera.position_m.y = kNan; },
                   {"camera.position_m", "[0, nan, 4]", "1e9"});
    expect_refused([](Scene& s) { s.camera.look_at_m.z = kInfinity; },
                   {"camera.look_at_m", "[0, 0, inf]", "1e9"});

    const glm::dvec3 here(0.0, -60.0, 4.0), there(0.0, 0.0, 0.0);
    // With keys, the camera's own points are not used.
    expect_good([&](Scene& s) {
        s.camera.look_at_m = s.camera.position_m;
        s.camera.keys = {{1, here, there}, {5, here + 1.0, there}};
    });
    expect_refused(
        [&](Scene& s) {
            s.camera.keys = {{1, here, there}, {2, here, here}};
        },
        {"camera.keys[1].look_at_m", "[0, -60, 4]", "away from the camera"});
    for (const int frame : {5, 3}) {
        expect_refused(
            [&](Scene& s) {
                s.camera.keys = {{5, here, there}, {frame, here, there}};
            },
            {"camera.keys[1].frame", std::to_string(frame), "rising"});
    }
    // They change places: half way they meet.
    expect_refused(
        [&](Scene& s) {
            s.camera.keys = {{1, here, there}, {9, there, here}};
        },
        {"camera.keys[1].look_at_m", "[0, -60, 4]", "add a key between"});
}

TEST(Validate, ListsHaveEachWordOnce) {
    expect_refused([](Scene& s) { s.output.attributes.push_back(MeshAttribute::Normal); },
                   {"output.attributes[4]", "\"normal\"", "once"});
    expect_refused(
        [](Scene& s) {
            s.output.maps = {MapKind::Normal, MapKind::Displacement, MapKind::Normal};
        },
        {"output.maps[2]", "\"normal\"", "once"});
}

TEST(Validate, WhitecapsThatAreOff) {
    expect_good(
        [](Scene& s) { s.effects.whitecaps = false; });  // although the attributes' default names them
    expect_good([](Scene& s) { s.output.maps = {MapKind::Whitecaps}; });
    expect_refused(
        [](Scene& s) {
            s.effects.whitecaps = false;
            s.output.maps = {MapKind::Normal, MapKind::Whitecaps};
        },
        {"output.maps[1]", "\"whitecaps\"", "effects.whitecaps = true"});
}

TEST(Validate, FloorsThatArentThere) {
    const auto with_floor = [](bool body, double depth_m) {
        return [=](Scene& s) {
            s.output.maps = {MapKind::Floor};
            s.water.body = body;
            s.sea.depth_m = depth_m;
        };
    };
    expect_good(with_floor(true, 20.0));
    expect_refused(with_floor(true, std::numeric_limits<double>::infinity()),
                   {"output.maps[0]", "\"floor\"", "a finite sea.depth_m"});
    expect_refused(with_floor(false, 20.0), {"output.maps[0]", "\"floor\"", "water.body = true"});
    expect_refused(
        [&](Scene& s) {
            with_floor(true, 20.0)(s);
            s.output.cascade_tiles = true;
        },
        {"output.cascade_tiles", "true", "other than floor"});
}

// A change to a scene of wave trains.
std::function<void(Scene&)> of_trains(const std::function<void(Scene&)>& change) {
    return [change](Scene& s) {
        s.waves.model = WaveModel::Trochoid;
        change(s);
    };
}

TEST(Validate, Trains) {
    expect_good(of_trains([](Scene&) {}));
    for (const int good : {1, 10000}) expect_good(of_trains([&](Scene& s) { s.waves.trains = good; }));
    for (const int bad : {-1, 0, 10001})
        expect_refused(of_trains([&](Scene& s) { s.waves.trains = bad; }),
                       {"waves.trains", std::to_string(bad), "1 … 10000"});
    const auto range = [](double shortest_m, double longest_m) {
        return of_trains([=](Scene& s) {
            s.waves.shortest_m = shortest_m;
            s.waves.longest_m = longest_m;
        });
    };
    expect_good(range(0.02, 30.0));
    expect_refused(range(30.0, 0.02), {"waves.shortest_m", "30", "below the longest"});
    expect_refused(range(30.0, 30.0), {"waves.shortest_m", "30", "below the longest"});
    // Cascades beside them begin at an eighth of the largest, 5 m here, and end at 1.25 m: no gap, and not
    // nothing.
    const auto above_cascades = [](double shortest_m) {
        return of_trains([=](Scene& s) {
            s.waves.cascades = {{.size_m = 40.0, .resolution = 64}};
            s.waves.shortest_m = shortest_m;
        });
    };
    for (const double good : {5.0, 1.26}) expect_good(above_cascades(good));
    expect_refused(above_cascades(5.01), {"waves.shortest_m", "5.01", "at most 5 m"});
    expect_refused(above_cascades(1.25), {"waves.shortest_m", "1.25", "more than 1.25 m"});
    // Without trains, nothing that speaks of them.
    expect_refused([](Scene& s) { s.waves.trains = 59; }, {"waves.trains", "59", "model = \"trochoid\""});
    expect_refused([](Scene& s) { s.waves.shortest_m = 0.02; },
                   {"waves.shortest_m", "0.02", "model = \"trochoid\""});
    expect_refused([](Scene& s) { s.waves.longest_m = 30.0; },
                   {"waves.longest_m", "30", "model = \"trochoid\""});
}

TEST(Validate, TilesOfTrainsAreThoseOfTheCascadesBesideThem) {
    const auto tiles = [](Scene& s) {
        s.output.maps = {MapKind::Normal};
        s.output.cascade_tiles = true;
    };
    expect_refused(of_trains(tiles), {"output.cascade_tiles", "true", "cascades listed in waves.cascades"});
    expect_good(of_trains([&](Scene& s) {
        tiles(s);
        s.waves.cascades = {{50.0, 256}};
    }));
    expect_good(tiles);
}

TEST(Validate, NearFarHasAsManyQuadsASideAsFilesCanCount) {
    const auto near_far = [](int resolution) {
        return [resolution](Scene& s) {
            s.surface.kind = SurfaceKind::NearFar;
            s.surface.resolution = resolution;
        };
    };
    expect_good(near_far(1));
    expect_good(near_far(4096));
    expect_refused(near_far(4097), {"surface.resolution", "4097", "1 … 4096"});
    expect_refused(near_far(8193), {"surface.resolution", "8193", "1 … 8192"});  // as everywhere, and once
}

TEST(Validate, DropsAreRefusedWhereThereAreNone) {
    const auto drops = [](Scene& s) {
        s.effects.spray = s.effects.spray_drops = true;
        s.output.drops = true;
    };
    expect_good(drops);
    expect_good([&](Scene& s) {
        drops(s);
        s.output.mesh = MeshFormat::None;
    });
    const auto refused = [&](void (*change)(Scene&), const char* accepted) {
        expect_refused(
            [&](Scene& s) {
                drops(s);
                change(s);
            },
            {"output.drops", "true", accepted});
    };
    refused([](Scene& s) { s.effects.spray_drops = false; }, "effects.spray_drops = true");
    refused([](Scene& s) { s.effects.spray = false; }, "effects.spray = true");
    refused([](Scene& s) { s.effects.whitecaps = false; }, "effects.whitecaps = true");
    refused([](Scene& s) { s.effects.spray_law = SpraySource::Monahan1986; },
            "effects.spray_law = \"andreas-1998\"");
    // Without output they are a matter of taste.
    expect_good([](Scene& s) { s.effects.spray_drops = true; });
}

TEST(Validate, Volumes) {
    const auto spray = [](Scene& s) {
        s.effects.spray = true;
        s.output.volumes = {VolumeKind::LevelSet, VolumeKind::Spray};
    };
    expect_good(spray);
    expect_good([](Scene& s) {
        s.output.mesh = MeshFormat::None;
        s.output.volumes = {VolumeKind::LevelSet};
    });
    expect_refused(
        [](Scene& s) {
            s.output.volumes = {VolumeKind::LevelSet, VolumeKind::Spray};
        },
        {"output.volumes[1]", "\"spray\"", "effects.spray = true"});
    expect_refused(
        [&](Scene& s) {
            spray(s);
            s.effects.whitecaps = false;
        },
        {"output.volumes[1]", "\"spray\"", "effects.whitecaps = true"});
    expect_good([](Scene& s) {  // nothing breaks, nothing flies
        s.effects.spray = true;
        s.effects.whitecaps = false;
    });
    expect_refused([](Scene& s) { s.effects.spray_gain = -1.0; },
                   {"effects.spray_gain", "-1", "0 … 1000000"});
    // One voxel at least, and no more than can be counted.
    const auto voxels = [](double size_m, double voxel_m) {
        return [=](Scene& s) {
            s.surface.size_m = size_m;
            s.output.volumes = {VolumeKind::LevelSet};
            s.output.voxel_m = voxel_m;
        };
    };
    expect_good(voxels(2.0, 2.0));
    expect_refused(voxels(2.0, 2.5), {"output.voxel_m", "2.5", "at most 2, the patch's side"});
    expect_good(voxels(1e5, 1.0));
    expect_refused(voxels(1e6, 1.0), {"output.voxel_m", "1", "at least 10, a 100000th of 1000000"});
    expect_good([](Scene& s) { s.output.voxel_m = 1e4; });  // nobody asks for volumes
    expect_refused([](Scene& s) { s.output.voxel_m = 0.0; }, {"output.voxel_m", "0", "0.001 … 100000"});
}

TEST(Validate, ACageIsFittedToAPatch) {
    const auto cage = [](SurfaceKind kind) {
        return [kind](Scene& s) {
            s.output.mesh_scheme = MeshScheme::CatmullClark;
            s.surface.kind = kind;
        };
    };
    expect_good(cage(SurfaceKind::Patch));
    for (const SurfaceKind kind : {SurfaceKind::ProjectedGrid, SurfaceKind::Planet})
        expect_refused(cage(kind), {"output.mesh_scheme", "\"catmullClark\"", "surface.kind = \"patch\""});
}

TEST(Validate, ACageComesWithItsKindAndIsNotRefinedWithoutEnd) {
    CageMesh square;
    square.points_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.face_counts = {4};
    square.indices = {0, 1, 2, 3};
    const auto with_cage = [&](Scene& s) {
        s.surface.kind = SurfaceKind::Cage;
        s.surface.cage = std::make_shared<const Cage>(square);
        s.surface.cage_level.splits = 6;
    };
    expect_good(with_cage);
    expect_refused([](Scene& s) { s.surface.kind = SurfaceKind::Cage; },
                   {"surface.kind", "\"cage\"", "together with cage_file"});
    expect_refused(
        [&](Scene& s) {
            with_cage(s);
            s.surface.kind = SurfaceKind::Patch;
        },
        {"surface.kind", "\"patch\"", "no cage"});
    // A floor's mesh is measured from the height 0.
    expect_refused(
        [&](Scene& s) {
            with_cage(s);
            s.waves.model = WaveModel::Trochoid;
            s.waves.coast = true;
            s.sea.depth_file = "reef.obj";
        },
        {"waves.coast", "true", "sea.depth_file = \"PATH.exr\", or false"});
    // 200 000 quads of 4⁶ each; as the camera sees them they are as many as fit.
    CageMesh many;
    for (std::int32_t i = 0; i < 200000; ++i) {
        for (const glm::dvec3& point : square.points_m)
            many.points_m.push_back(point + glm::dvec3(2.0 * i, 0.0, 0.0));
        for (const std::int32_t k : square.indices) many.indices.push_back(4 * i + k);
        many.face_counts.push_back(4);
    }
    const auto cage = std::make_shared<const Cage>(std::move(many));
    const auto with_many = [&](Scene& s) {
        with_cage(s);
        s.surface.cage = cage;
    };
    expect_refused(with_many, {"surface.cage_level", "6", "0 … 5"});
    expect_good([&](Scene& s) {
        with_many(s);
        s.surface.cage_level.splits = 5;
    });
    expect_good([&](Scene& s) {
        with_many(s);
        s.surface.cage_level.is_adaptive = true;
    });
}

TEST(Validate, BodiesHaveNamesAFileAndAPlace) {
    const Scene good = test::scene_with_body();
    EXPECT_TRUE(validate(good).empty());
    const auto refusal = [&](const std::function<void(Scene&)>& change) {
        Scene scene = good;
        change(scene);
        std::string text;
        for (const Problem& problem : validate(scene)) text += text_of(problem) + '\n';
        return text;
    };
    const auto twice = [](Scene& s) { s.objects.push_back(s.objects[0]); };
    EXPECT_EQ(
        refusal([](Scene& s) { s.objects[0].mesh.reset(), s.objects[0].file.clear(); }),
        "objects[0].file = \"\": names no file; accepted: the path of an .obj or a .usdc, which the host reads\n");
    EXPECT_EQ(
        refusal([](Scene& s) { s.objects[0].mesh.reset(); }),
        "objects[0].file = \"folder/boat.obj\": is named and not read; accepted: the path of an .obj or a .usdc, which the host "
        "reads\n");
    EXPECT_EQ(
        refusal(twice),
        "objects[1].name = \"boat\": is what objects[0] is called: without a name it is its file's; accepted: a name of "
        "its own for each of them\n");
    EXPECT_EQ(refusal([&](Scene& s) { twice(s), s.objects[1].name = "other"; }), "");
    EXPECT_EQ(
        refusal([&](Scene& s) { twice(s), s.objects[0].name = s.objects[1].name = "a"; }),
        "objects[1].name = \"a\": is what objects[0] is called; accepted: a name of its own for each of them\n");
    EXPECT_EQ(refusal([](Scene& s) { s.objects[0].name = "Küstenwache 7"; }), "");
    EXPECT_NE(refusal([](Scene& s) { s.objects[0].name = "sea"; }).find("is what mattes call the water"),
              std::string::npos);
    for (const std::string& bad :
         {std::string("a\"b"), std::string("a\nb"), std::string("\xff"), std::string(101, 'a')})
        EXPECT_NE(refusal([&](Scene& s) { s.objects[0].name = bad; }).find("is no name for mattes"),
                  std::string::npos)
            << bad;
    EXPECT_NE(
        refusal([&](Scene& s) { s.objects[0].file = "a\"b.obj"; }).find("is its file's name, and none for"),
        std::string::npos);
    EXPECT_NE(
        refusal([&](Scene& s) { s.objects[0].file = ""; }).find("objects[0].name = \"\": is its file's"),
        std::string::npos);
    EXPECT_NE(
        refusal([](Scene& s) {
            s.waves.vessels.resize(2), s.objects[0].vessel = 3;
        }).find("objects[0].vessel = 3: is not one of waves.vessels, which has 2; accepted: 1 … 2, or 0"),
        std::string::npos);
    EXPECT_NE(
        refusal([](Scene& s) { s.waves.vessels.clear(), s.objects[0].vessel = 1; }).find("which has none"),
        std::string::npos);
    EXPECT_NE(refusal([](Scene& s) {
                  s.objects[0].vessel = 1, s.objects[0].path = "1 0 0";
              }).find("objects[0].path = \"1 0 0\": is given beside vessel = 1"),
              std::string::npos);
    for (const auto& [path, problem] : std::vector<std::pair<std::string, std::string>>{
             {"1 0 0, 5 1", "key 2 isn't three numbers"},
             {"1 0 0,", "key 2 isn't three numbers"},
             {"1 0 0, 1 2 3", "key 2, 1 2 3: does not come after the key before, of frame 1"},
             {"1 2e9 0", "key 1, 1 2e9 0: is no place on the sea"},
             {"2e8 0 0", "key 1, 2e8 0 0: is at a frame outside the range"}})
        EXPECT_NE(refusal([&](Scene& s) { s.objects[0].path = path; }).find(problem), std::string::npos)
            << refusal([&](Scene& s) { s.objects[0].path = path; });
    const auto loop = [](Scene& s) { s.waves.vessels.clear(), s.shot.loop_s = 2.0; };
    EXPECT_EQ(refusal([&](Scene& s) { loop(s), s.objects[0].path = "1 3 4, 9 3 4"; }), "");
    EXPECT_NE(refusal([&](Scene& s) {
                  loop(s), s.objects[0].path = "1 3 4, 9 3 5";
              }).find("which a loop has no end for"),
              std::string::npos);
    // Where the sea's time stands still the camera's goes on.
    EXPECT_EQ(refusal([](Scene& s) {
                  s.waves.vessels.clear(), s.shot.time_scale = 0.0, s.objects[0].path = "1 3 4, 9 3 5";
              }),
              "");
    EXPECT_NE(refusal([&](Scene& s) {
                  s.objects.resize(limits::kObjects + 1, s.objects[0]);
              }).find("objects = 65 entries: is too many"),
              std::string::npos);
}

TEST(Validate, TheSkyIsDaylightOrAPicture) {
    for (const char* good : {"daylight", "sky.exr", "skies/Noon.EXR", "a b.exr"})
        expect_good([&](Scene& s) { s.light.sky = good; });
    for (const char* bad : {"", ".exr", "sky.hdr", "Daylight", "exr"})
        expect_refused([&](Scene& s) { s.light.sky = bad; },
                       {"light.sky", '"' + std::string(bad) + '"', "an .exr"});
}

TEST(Validate, AllProblemsAreFound) {
    const std::vector<Problem> problems = validate(changed([](Scene& s) {
        s.shot.name = "";
        s.sea.wind_speed_mps = -1.0;
        s.output.voxel_m = kNan;
    }));
    EXPECT_EQ(problems.size(), 3u) << all_text(problems);
    EXPECT_EQ(text_of(problems[1]), "sea.wind_speed_mps = -1: is outside the range; accepted: 0 … 80");
}

}  // namespace
}  // namespace pelagic
