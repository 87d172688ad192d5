// Every row of the table on a small shot: what holds for all of them, and which way each knob turns.
#include "plugin/accuracy/accuracy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pelagic/cage.h"
#include "plugin/accuracy/report.h"

namespace pelagic {
namespace {

Scene small_shot() {
    Scene scene;
    scene.shot.name = "small";
    scene.shot.last_frame = 3;
    scene.sea.wind_speed_mps = 13.0;
    scene.surface.resolution = 32;
    scene.surface.size_m = 80.0;
    scene.waves.cascades = {{400.0, 128}, {60.0, 64}};
    scene.camera.resolution = {24, 14};
    scene.effects.foam_decay_s = 1.0;  // a shorter past
    return scene;
}

// The same with a cage as its surface.
Scene caged_shot() {
    Scene scene = small_shot();
    scene.surface.kind = SurfaceKind::Cage;
    CageMesh mesh;
    constexpr int kSide = 3;
    for (int y = 0; y <= kSide; ++y)
        for (int x = 0; x <= kSide; ++x)
            mesh.points_m.emplace_back(27.0 * x - 40.0, 27.0 * y - 40.0, (x + y) % 2 == 0 ? 0.0 : 2.0);
    for (std::int32_t y = 0; y < kSide; ++y)
        for (std::int32_t x = 0; x < kSide; ++x) {
            const std::int32_t a = y * (kSide + 1) + x;
            mesh.face_counts.push_back(4);
            mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + kSide + 2, a + kSide + 1});
        }
    scene.surface.cage = std::make_shared<const Cage>(mesh);
    return scene;
}

const ApproximationRow& row_called(const std::string& name) {
    for (const ApproximationRow& row : approximation_table())
        if (name == row.name) return row;
    throw std::logic_error(name);
}

Scene shot_of(const std::string& row) {
    if (row == "cage-level") return caged_shot();
    Scene shot = small_shot();
    if (row == "cascade-resolution")
        shot.effects.foam_decay_s = 0.0;  // or it takes tiles of 4096² for each moment of the past
    return shot;
}

// Each is swept once.
const MeasuredRow& measured(const std::string& name) {
    static std::map<std::string, MeasuredRow> known;
    const auto found = known.find(name);
    if (found != known.end()) return found->second;
    return known.emplace(name, sweep(row_called(name), shot_of(name), 1, {})).first->second;
}

double error_of(const std::string& row, const std::string& setting, std::size_t which = 0) {
    for (const MeasuredSetting& each : measured(row).settings)
        if (each.setting == setting) return each.errors.at(which);
    ADD_FAILURE() << row << " has no setting " << setting;
    return NAN;
}

TEST(Accuracy, EveryRowHoldsWhatTheTableSays) {
    std::set<std::string> names;
    for (const ApproximationRow& row : approximation_table()) {
        SCOPED_TRACE(row.name);
        EXPECT_TRUE(names.insert(row.name).second) << "twice";
        EXPECT_EQ(std::string(row.name).find_first_not_of("abcdefghijklmnopqrstuvwxyz-"), std::string::npos);
        for (const char* text : {row.title, row.knob, row.reference, row.time, row.lesson})
            EXPECT_STRNE(text, "");
        const bool is_of_parts = row.kind == RowKind::Parts;
        if (!is_of_parts) {
            EXPECT_GE(row.errors.size(), 1u) << "which is drawn";
        }
        EXPECT_LE(row.errors.size(), 3u) << "as many as a line of the CSV has";
        const MeasuredRow& result = measured(row.name);
        EXPECT_EQ(result.why_none, "");
        EXPECT_GE(result.settings.size(), 2u);
        EXPECT_EQ(result.shot, shot_hash(shot_of(row.name)));
        std::set<std::string> settings;
        int own = 0;
        for (const MeasuredSetting& setting : result.settings) {
            EXPECT_TRUE(settings.insert(setting.setting).second) << setting.setting << " twice";
            own += setting.is_shots ? 1 : 0;
            EXPECT_EQ(setting.errors.size(), row.errors.size());
            if (!is_of_parts) {  // of a part it is a difference, which may be any
                EXPECT_GT(setting.ms, 0.0);
            }
            if (row.bytes) {
                EXPECT_GT(setting.bytes, 0u) << setting.setting;
            }
        }
        EXPECT_LE(own, 1);
        if (is_of_parts) {
            ASSERT_GE(result.settings.size(), 4u);
            EXPECT_EQ(result.settings[0].setting, kWholeShot);
            EXPECT_EQ(result.settings[1].setting, kShotAgain);
            EXPECT_EQ(result.settings.back().setting, kBareShot);
            EXPECT_EQ(result.settings[1].transforms, result.settings[0].transforms);
            EXPECT_EQ(result.settings[1].bytes, result.settings[0].bytes);
            for (const MeasuredSetting& setting : result.settings) {
                EXPECT_LE(setting.transforms, result.settings[0].transforms) << setting.setting;
                EXPECT_LE(result.settings.back().transforms, setting.transforms) << setting.setting;
                EXPECT_LE(result.settings.back().bytes, setting.bytes) << setting.setting;
            }
        }
    }
}

std::vector<std::string> settings_of(const std::string& row) {
    std::vector<std::string> names;
    for (const MeasuredSetting& setting : measured(row).settings) names.push_back(setting.setting);
    return names;
}

// What is on in the shot, and nothing else, is taken away or added; the tables say what that is.
TEST(Accuracy, EffectsAreThoseThatAreOn) {
    const std::vector<std::string> effects{"horizontal displacement", "second order", "whitecaps",
                                           "living foam", "foam structure"},
        light{"air", "multiple reflections", "sky by nine lookups"};
    std::vector<std::string> taken{kWholeShot, kShotAgain}, added{"waves alone"},
        of_bake{kWholeShot, kShotAgain};
    for (const auto& names : {effects, light})
        for (const std::string& name : names) {
            taken.push_back(kWithout + name);
            added.push_back("+ " + name);
        }
    taken.emplace_back(kBareShot);
    added.emplace_back("+ sky by the integral");
    EXPECT_EQ(settings_of("picture-effects"), taken);
    EXPECT_EQ(settings_of("picture-steps"), added);
    // The structure of foam is no matter of a bake.
    for (const char* name : {"mesh normal", "mesh velocity", "mesh slope-variance", "mesh whitecaps",
                             "horizontal displacement", "second order", "whitecaps", "living foam"})
        of_bake.push_back(kWithout + std::string(name));
    of_bake.emplace_back(kBareShot);
    EXPECT_EQ(settings_of("bake-effects"), of_bake);
}

TEST(Accuracy, StepsLeadFromWavesAloneToTheWholePicture) {
    const std::vector<MeasuredSetting>& steps = measured("picture-steps").settings;
    EXPECT_EQ(steps.front().errors[2], 0.0);
    EXPECT_GT(steps.front().errors[0], 0.1);
    EXPECT_EQ(steps.back().errors[0], 0.0);
    EXPECT_EQ(steps.back().errors[1], 0.0);
    // The last step's change is the error of the one before, but for what it is relative to.
    EXPECT_NEAR(steps.back().errors[2], steps[steps.size() - 2].errors[0], 0.3 * steps.back().errors[2]);
    for (std::size_t i = 1; i < steps.size(); ++i) EXPECT_GT(steps[i].errors[2], 0.0) << steps[i].setting;
    // Taken away or not added yet, it is the same light that is missing.
    EXPECT_EQ(error_of("picture-effects", "the shot"), 0.0);
    EXPECT_GT(error_of("picture-effects", "without air"), 0.001);
    EXPECT_NEAR(error_of("picture-effects", "without all of these"), steps.front().errors[0],
                0.2 * steps.front().errors[0]);
}

// From the coarsest setting to the finest the error falls by most of what the approximation's theory gives,
// where that is known (beside the line), and otherwise by half of what is measured on this shot.
TEST(Accuracy, FinerSettingsErrLess) {
    struct Case {
        const char *row, *coarse, *fine;
        double factor;
    };
    for (const Case& each : {
             Case{"cascade-resolution", "32²", "2048²", 10.0},
             Case{"interpolation", "cubic, 1 nodes a sample", "cubic, 3 nodes a sample", 50.0},  // 3⁴ = 81
             Case{"interpolation", "quintic, 1 nodes a sample", "quintic, 2 nodes a sample",
                  50.0},                                        // 2⁶ = 64
             Case{"trains", "10 trains", "480 trains", 500.0},  // a bin's width squared: 48² = 2304
             Case{"mesh-spacing", "16 quads a side", "512 quads a side", 50.0},
             Case{"fitted-cage", "16 quads a side", "512 quads a side", 1e4},
             Case{"cage-level", "2 halvings", "6 halvings", 20.0},
             Case{"rays", "4 footprints", "0.05 footprints", 20.0},
             Case{"mesh-variance", "16 cells without", "16 cells with variance", 2.0},
             Case{"files", "half", "float", 1e9},
             Case{"sky", "one", "nine",
                  1.05},  // 1.1 under a clear sky, 1.7 in haze: one lookup is over an ellipse
             Case{"sky", "nine", "integral", 1e9},
             Case{"samples", "1 × 1", "6 × 6", 2.0},
             Case{"grid-cells", "32 px", "1 px", 1.5},
             Case{"picture-interpolation", "cubic, 1 nodes a sample", "quintic, 2 nodes a sample", 30.0},
         })
        EXPECT_GE(error_of(each.row, each.coarse), each.factor * error_of(each.row, each.fine) + 1e-300)
            << each.row << ": " << each.coarse << ", " << each.fine;
}

// Numbers that are known apart from the sweep.
TEST(Accuracy, KnownErrorsAreFound) {
    // A half has 11 bits: an error of 2^−12/√3 of a number at its binade's top, of three components.
    EXPECT_LT(error_of("files", "half"), std::ldexp(1.0, -11));
    EXPECT_GT(error_of("files", "half"), std::ldexp(1.0, -16));
    EXPECT_LT(error_of("precision", "single"), 1e-5);
    EXPECT_GT(error_of("precision", "single"), 1e-8);
    EXPECT_LT(error_of("precision", "double"), 1e-12);
    // All instruction sets agree to rounding.
    for (const MeasuredSetting& setting : measured("instruction-sets").settings)
        EXPECT_LT(setting.errors[0], 1e-5) << setting.setting;
    for (const MeasuredSetting& setting : measured("planning").settings) {
        EXPECT_LT(setting.errors[0], 1e-5) << setting.setting;
        EXPECT_GT(setting.errors[0], 1e-8) << setting.setting;
    }
    // Hits lie within the tolerance, of which five standard deviations are in it.
    for (const auto& [setting, tolerance] :
         {std::pair{"0.05 footprints", 0.05}, std::pair{"0.5 footprints", 0.5},
          std::pair{"4 footprints", 4.0}})
        EXPECT_LT(error_of("rays", setting), tolerance) << setting;
    // The energy of trains is their bins'.
    for (const MeasuredSetting& setting : measured("trains").settings) EXPECT_LT(setting.errors[1], 1e-9);
    EXPECT_EQ(error_of("air", "with"), 0.0);
    EXPECT_GT(error_of("air", "without"), 0.001);
}

TEST(Accuracy, TheShotsOwnSettingsAreMarked) {
    const auto own = [](const std::string& row) {
        for (const MeasuredSetting& setting : measured(row).settings)
            if (setting.is_shots) return setting.setting;
        return std::string("none");
    };
    EXPECT_EQ(own("interpolation"), "quintic, 2 nodes a sample");
    EXPECT_EQ(own("sky"), "nine");
    EXPECT_EQ(own("samples"), "2 × 2");
    EXPECT_EQ(own("picture-steps"), "+ sky by nine lookups");
    EXPECT_EQ(own("picture-effects"), kWholeShot);
    EXPECT_EQ(own("grid-cells"), "8 px");
    EXPECT_EQ(own("mesh-spacing"), "32 quads a side");
    EXPECT_EQ(own("cascade-resolution"), "64²");
    EXPECT_EQ(own("cage-level"), "2 halvings");
    EXPECT_EQ(own("rays"), "0.5 footprints");
    EXPECT_EQ(own("planning"), "recorded");
    EXPECT_EQ(own("trains"), "none") << "the shot has cascades";
}

// What a shot hasn't isn't swept, and says why; and nothing is NaN where nothing moves.
TEST(Accuracy, SeasWithoutWavesAndWithoutCascadesAreNoSpecialCase) {
    // What is finite and what isn't swept is so at any size.
    Scene calm = small_shot();
    calm.surface.resolution = 16;
    calm.waves.cascades = {{400.0, 32}, {60.0, 32}};
    calm.camera.resolution = {12, 7};
    calm.effects.foam_decay_s = 0.2;
    Scene trains = calm, bare = calm;
    calm.sea.wind_speed_mps = 0.0;
    trains.waves.cascades.clear();
    trains.waves.model = WaveModel::Trochoid;
    bare.effects.whitecaps = false;
    const auto sweep_all = [](const Scene& scene, std::initializer_list<const char*> rows) {
        for (const char* name : rows) {
            const MeasuredRow result = sweep(row_called(name), scene, 1, {});  // throws for what isn't finite
            EXPECT_NE(result.settings.empty(), result.why_none.empty()) << name;
        }
    };
    for (const Scene& scene : {calm, trains})
        sweep_all(scene,
                  {"interpolation", "cascade-number", "trains", "mesh-spacing", "mesh-variance",
                   "fitted-cage", "files", "whitecap-moments", "instruction-sets", "foam-structure", "rays",
                   "planning", "cage-level", "picture-effects", "picture-steps", "bake-effects"});
    sweep_all(bare, {"files", "foam-structure", "picture-effects", "bake-effects"});  // which foam is in
    EXPECT_FALSE(sweep(row_called("interpolation"), trains, 1, {}).why_none.empty());
    EXPECT_FALSE(sweep(row_called("whitecap-moments"), bare, 1, {}).why_none.empty());
    EXPECT_FALSE(sweep(row_called("planning"), trains, 1, {}).why_none.empty());
    EXPECT_FALSE(sweep(row_called("cage-level"), bare, 1, {}).why_none.empty());
    bare.camera.look_at_m = bare.camera.position_m + glm::dvec3(0.0, 1.0, 2.0);
    EXPECT_FALSE(sweep(row_called("rays"), bare, 1, {}).why_none.empty()) << "the camera sees no sea";
}

TEST(Accuracy, NothingToBakeHasNoPrice) {
    Scene nothing = small_shot();
    nothing.output.mesh = MeshFormat::None;
    EXPECT_FALSE(sweep(row_called("bake-effects"), nothing, 1, {}).why_none.empty());
}

// Each setting's picture, once, as files that begin as theirs do.
TEST(Accuracy, PicturesAreHandedOut) {
    std::vector<std::size_t> numbers;
    const auto take = [&](const std::string& row, std::size_t number, const PictureBytes& picture) {
        EXPECT_EQ(row, "sky");
        EXPECT_TRUE(picture.exr.starts_with("\x76\x2f\x31\x01"));
        EXPECT_TRUE(picture.png.starts_with("\x89PNG"));
        numbers.push_back(number);
    };
    sweep(row_called("sky"), small_shot(), 1, {.progress = {}, .picture = take});
    EXPECT_EQ(numbers, (std::vector<std::size_t>{1, 2, 3}));
    sweep(row_called("files"), small_shot(), 1, {.progress = {}, .picture = take});
}

TEST(Accuracy, ACancelledSweepEnds) {
    const std::atomic<bool> cancel = true;
    EXPECT_THROW(
        sweep(row_called("files"), small_shot(), 1, {.progress = {}, .picture = {}, .cancel = &cancel}),
        BuildCancelled);
}

}  // namespace
}  // namespace pelagic
