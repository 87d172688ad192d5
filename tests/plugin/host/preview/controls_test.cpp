// What the panel shows, and how it begins.
#include "plugin/host/preview/controls.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/scene/keys.h"

namespace pelagic {
namespace {

// What the panel shows is in the table of keys, and each slider moves within what its key accepts.
TEST(Panel, ShowsKeysOfTheTable) {
    for (const PanelSection& section : panel_sections()) {
        EXPECT_FALSE(section.paths.empty()) << section.title;
        for (const std::string_view path : section.paths) {
            const Key* key = find_key(path);
            ASSERT_NE(key, nullptr) << path;
            EXPECT_TRUE(key->set != nullptr) << path;
            EXPECT_FALSE(key->help.empty() || key->label.empty()) << path;
            const auto expect_slider = [](const Key& k) {
                ASSERT_TRUE(k.soft && k.range) << k.path;
                EXPECT_TRUE(k.range->holds(k.soft->low) && k.range->holds(k.soft->high)) << k.path;
                EXPECT_LT(k.soft->low, k.soft->high) << k.path;
                EXPECT_TRUE(!k.soft->is_logarithmic || k.soft->low > 0.0) << k.path;
            };
            if (key->type == KeyType::Integer && !key->soft)
                EXPECT_LT(key->least, key->largest) << path;
            else if (key->type == KeyType::Number || key->type == KeyType::Integer)
                expect_slider(*key);
            for (const Key& inner : key->entry_keys) expect_slider(inner);
        }
    }
}

TEST(Controls, BeginAsTheShotHasIt) {
    Scene scene;
    scene.shot.first_frame = 25;
    scene.effects.whitecaps = false;
    const Controls still = controls_for(scene);
    EXPECT_EQ(still.frame, 25.0);
    EXPECT_FALSE(still.draw.lighting.whitecaps);
}

TEST(Controls, ThePlayheadStaysInTheShot) {
    Shot shot;
    for (const auto& [first, last] : {std::pair{1, 24}, std::pair{-5, 3}, std::pair{7, 7}}) {
        shot.first_frame = first;
        shot.last_frame = last;
        for (const bool repeat : {true, false}) {
            Scene scene;
            scene.shot = shot;
            Controls controls = controls_for(scene);
            EXPECT_TRUE(controls.repeat && controls.playing);
            controls.repeat = repeat;
            double furthest = controls.frame;
            for (int picture = 0; picture < 900; ++picture) {
                play_on(controls, 0.11, shot);
                furthest = std::max(furthest, controls.frame);
                ASSERT_GE(controls.frame, first);
                ASSERT_LT(controls.frame, last + 1.0) << (repeat ? "repeated" : "once");
            }
            EXPECT_GE(furthest, last) << "it plays all of it";
            EXPECT_EQ(controls.playing, repeat || first == last);
            if (!repeat && first != last) {
                EXPECT_EQ(controls.frame, last);
                play_or_pause(controls, shot);
                EXPECT_TRUE(controls.playing && controls.frame == first) << "from the start again";
            }
        }
        Controls controls;
        for (const double frame : {-100.0, 271.0, first + 0.5}) {
            go_to(controls, frame, shot);
            EXPECT_GE(controls.frame, first);
            EXPECT_LE(controls.frame, last);
        }
    }
}

TEST(Controls, WhatHappensBeforeTheFirstSeaIsSaid) {
    Readout readout;
    EXPECT_EQ(sea_words(readout).find("0.00"), std::string::npos);
    EXPECT_FALSE(sea_words(readout).empty());
    readout.building_sea = true;
    readout.built = 0.42;
    readout.waited_s = 12.0;
    EXPECT_EQ(sea_words(readout), "Building the sea: 42 %, 12 s");
    readout.has_sea = true;
    EXPECT_NE(sea_words(readout).find("last one plays on"), std::string::npos);
    readout.building_sea = false;
    readout.significant_height_m = 2.91;
    EXPECT_EQ(sea_words(readout).find("Significant height 2.91 m"), 0u);
}

// The panel without a window: pictures of it, with a mouse that clicks.
class Hand {
  public:
    Hand() : context_(ImGui::CreateContext()) {
        ImGuiIO& io = ImGui::GetIO();
        io.DisplaySize = {900.0f, 2400.0f};
        io.DeltaTime = 1.0f / 60.0f;
        io.IniFilename = nullptr;
        set_controls_style(1.0f);
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
        picture();
        picture();
    }
    ~Hand() { ImGui::DestroyContext(context_); }
    Hand(const Hand&) = delete;
    Hand& operator=(const Hand&) = delete;

    Clicks clicked_at(float x, float y) {
        ImGuiIO& io = ImGui::GetIO();
        io.MousePos = {x, y};
        picture();
        io.MouseDown[ImGuiMouseButton_Left] = true;
        picture();
        io.MouseDown[ImGuiMouseButton_Left] = false;
        return picture();
    }

  private:
    Clicks picture() {
        ImGui::NewFrame();
        const Clicks clicks = draw_controls(controls_, readout_, scene_);
        ImGui::Render();
        return clicks;
    }

    ImGuiContext* context_;
    Scene scene_;
    Controls controls_ = controls_for(scene_);
    Readout readout_;
};

// Save, copy and reset are buttons that a mouse finds, below everything else, and each tells its own click alone.
TEST(Panel, SaveShotIsAButton) {
    Hand hand;
    int saved = 0, copied = 0, reset = 0;
    for (float y = 2396.0f; y > 0.0f && saved == 0; y -= 8.0f)
        for (float x = 24.0f; x < 400.0f; x += 16.0f) {
            const Clicks clicks = hand.clicked_at(x, y);
            saved += clicks.save;
            copied += clicks.copy;
            reset += clicks.reset;
            EXPECT_LE(clicks.save + clicks.copy + clicks.reset + clicks.shot_camera, 1) << x << ' ' << y;
        }
    EXPECT_GT(saved, 0);
    EXPECT_GT(copied, 0);
    EXPECT_GT(reset, 0);
}

// Each thing that an artist asked for can be turned.
TEST(Panel, HasTheWholeWeather) {
    std::string all;
    for (const PanelSection& section : panel_sections())
        for (const std::string_view path : section.paths) all += std::string(path) + ' ';
    for (const char* path : {"shot.seed", "sea.depth_m", "sea.spectrum", "sea.spreading", "sea.swell",
                             "sea.gust_strength", "sea.gust_size_m", "sea.gust_fronts", "waves.tiling",
                             "effects.whitecaps", "effects.foam_decay_s", "effects.foam_drift"})
        EXPECT_NE(all.find(path), std::string::npos) << path;
}

}  // namespace
}  // namespace pelagic
