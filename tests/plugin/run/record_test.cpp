// What a bake's record says about the shot: every key, as a value.
#include "plugin/run/record.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "core/scene/keys.h"

namespace pelagic {
namespace {

// The type that JSON has for a value of a key; null where nothing is given, and for infinity.
struct IsJsonOf {
    const nlohmann::json& json;
    bool operator()(std::monostate) const { return json.is_null(); }
    bool operator()(bool) const { return json.is_boolean(); }
    bool operator()(std::int64_t) const { return json.is_number_integer(); }
    bool operator()(double number) const { return std::isfinite(number) ? json.is_number() : json.is_null(); }
    bool operator()(const std::string& text) const { return json == text; }
    bool operator()(const NumberKeys& number) const {
        return json.at("keys").size() == number.keys.size() && json.at("interpolation").is_string();
    }
    template <class Element>
    bool operator()(const std::vector<Element>& list) const {
        return json.is_array() && json.size() == list.size();
    }
};

// Settings that a shot is recorded with.
nlohmann::json recorded_settings(const Scene& scene) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("pelagic-record-" + std::to_string(getpid()) + ".json");
    Record record;
    record.describe(plan_bake(scene), SpectralMoments{}, 0.0, 0.0);
    record.begin(file);
    std::ifstream stream(file);
    nlohmann::json shot = nlohmann::json::parse(stream);
    std::filesystem::remove(file);
    return shot.at("settings");
}

TEST(Record, HasEveryKeyAsAValue) {
    Scene scene;
    scene.surface.size_m = 40.0;
    scene.surface.resolution = 16;
    scene.sea.swell = {{1.0, 9.0, 10.0}, {0.5, 7.0, 90.0}};
    set_value(scene, key_of("light.turbidity"), NumberKeys{{{1, 2.0}, {9, 5.0}}});
    const nlohmann::json settings = recorded_settings(scene);
    std::size_t found = 0;
    EXPECT_FALSE(settings.contains(std::string(kObjectsKey))) << "in fingerprints alone";
    EXPECT_FALSE(settings.contains(std::string(kCoastKey)))
        << "a record without a coast is one of before coasts";
    for (const Key& key : keys()) {
        if (key.path == kObjectsKey || key.path == kCoastKey) continue;
        ASSERT_TRUE(settings.contains(key.path)) << key.path;
        ++found;
        EXPECT_TRUE(std::visit(IsJsonOf{settings.at(key.path)}, value_of(scene, key)))
            << key.path << ": " << settings.at(key.path);
    }
    EXPECT_EQ(settings.size(), found);
    EXPECT_EQ(settings.at("sea.swell")[1],
              (nlohmann::json{{"height_m", 0.5}, {"period_s", 7.0}, {"direction_deg", 90.0}}));
    EXPECT_EQ(settings.at("light.turbidity"),
              (nlohmann::json{{"keys", {{1, 2.0}, {9, 5.0}}}, {"interpolation", "linear"}}));
    EXPECT_EQ(settings.at("sea.wind_speed_mps"), 10);
    EXPECT_TRUE(settings.at("sea.depth_m").is_null()) << "infinite";
    EXPECT_TRUE(settings.at("waves.longest_m").is_null()) << "not given";
    EXPECT_EQ(settings.at("camera.look_at_m"), (nlohmann::json{0.0, 0.0, 0.0}));
}

TEST(Record, SaysThatWavesFeelACoast) {
    Scene scene;
    scene.surface.resolution = 16;
    scene.sea.depth_m = 5.0;
    scene.sea.depth_file = "beach.exr";
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.cascades.clear();
    scene.waves.coast = true;
    scene.waves.coast_depths = std::make_shared<const DepthMap>(glm::ivec2(2), std::vector<float>(4, 5.0f),
                                                                glm::dvec2(-50.0), glm::dvec2(100.0));
    EXPECT_EQ(recorded_settings(scene).at("waves.coast"), true);
}

TEST(Record, SaysOfACascadesChoppinessWhatTheShotSays) {
    Scene scene;
    scene.surface.resolution = 16;
    scene.waves.cascades = {{200.0, 96, 0.4}, {60.0, 64}};
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("pelagic-cascades-" + std::to_string(getpid()) + ".json");
    Record record;
    record.describe(plan_bake(scene), SpectralMoments{}, 0.0, 0.0);
    record.begin(file);
    std::ifstream stream(file);
    const auto shot = nlohmann::json::parse(stream);
    std::filesystem::remove(file);
    for (const auto& cascades : {shot.at("settings").at("waves.cascades"), shot.at("plan").at("cascades")}) {
        ASSERT_EQ(cascades.size(), 2u);
        EXPECT_EQ(cascades[0].at("choppiness"), 0.4);
        EXPECT_FALSE(cascades[1].contains("choppiness"));
    }
}

// One number can't be every place's.
TEST(Record, SaysThatTheThresholdIsWithoutGusts) {
    for (const double strength : {0.0, 0.5}) {
        Scene scene;
        scene.surface.resolution = 16;
        scene.sea.gust_strength = strength;
        const std::filesystem::path file =
            std::filesystem::temp_directory_path() / ("pelagic-gusts-" + std::to_string(getpid()) + ".json");
        Record record;
        record.describe(plan_bake(scene), SpectralMoments{}, 0.5, 0.0);
        record.begin(file);
        std::ifstream stream(file);
        const auto shot = nlohmann::json::parse(stream);
        std::filesystem::remove(file);
        EXPECT_EQ(shot.at("whitecap_threshold"), 0.5);
        EXPECT_EQ(shot.contains("whitecap_threshold_is"), strength > 0.0);
        if (strength > 0.0) {
            EXPECT_NE(shot.at("whitecap_threshold_is").get<std::string>().find("without gusts"),
                      std::string::npos);
        }
    }
}

}  // namespace
}  // namespace pelagic
