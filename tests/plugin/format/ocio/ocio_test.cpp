// A studio's way to the display, through configurations whose numbers are known.
#include "plugin/format/ocio/ocio.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lighting/primaries.h"

namespace pelagic {
namespace {

// A gamma of 2 as "screen, square" and a scale of 0.5 as "paper, half".
std::string configuration(const std::string& roles, const std::string& linear) {
    return "ocio_profile_version: 2\n"
           "roles:\n  default: raw\n" +
           roles +
           "displays:\n"
           "  screen:\n"
           "    - !<View> {name: square, colorspace: squared}\n"
           "  paper:\n"
           "    - !<View> {name: half, colorspace: halved}\n"
           "    - !<View> {name: square, colorspace: squared}\n"
           "active_displays: [screen, paper]\n"
           "active_views: [square, half]\n"
           "colorspaces:\n"
           "  - !<ColorSpace> {name: raw, isdata: true}\n"
           "  - !<ColorSpace> {name: " +
           linear +
           "}\n"
           "  - !<ColorSpace>\n    name: squared\n"
           "    from_scene_reference: !<ExponentTransform> {value: [2, 2, 2, 1], style: pass_thru}\n"
           "  - !<ColorSpace>\n    name: halved\n"
           "    from_scene_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}\n";
}

class Ocio : public testing::Test {
  protected:
    Ocio() { std::filesystem::create_directories(folder_); }
    ~Ocio() override { std::filesystem::remove_all(folder_); }
    std::string written(const std::string& text) const {
        const std::filesystem::path file = folder_ / "config.ocio";
        std::ofstream(file) << text;
        return file.string();
    }
    static glm::vec3 shown(const ocio::View& view, glm::vec3 colour) {
        view.apply({&colour, 1});
        return colour;
    }
    std::string refusal(const ocio::ViewChoice& choice) const {
        try {
            ocio::make_view(choice);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "accepted";
    }

  private:
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("pelagic-ocio-" + std::to_string(getpid()));
};

void expect_near(glm::vec3 a, glm::vec3 b) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5f + 1e-4f * std::abs(b[c])) << c;
}

TEST_F(Ocio, ShowsByDisplayAndView) {
    const std::string config = written(configuration("", "lin_rec709"));
    const glm::vec3 light(0.5f, 0.2f, 3.0f);
    const auto usual = ocio::make_view({.config = config}),
               paper = ocio::make_view({.config = config, .display = "paper"}),
               other = ocio::make_view({.config = config, .display = "paper", .view = "square"});
    expect_near(shown(*usual, light), light * light);
    EXPECT_EQ(usual->name(), "screen, square");
    expect_near(shown(*other, light), light * light);
    expect_near(shown(*paper, light), paper->name() == "paper, half" ? 0.5f * light : light * light);
    const auto half = ocio::make_view({.config = config, .display = "paper", .view = "half"});
    expect_near(shown(*half, light), 0.5f * light);
    // A fingerprint's part: the same for the same way, another for another.
    EXPECT_EQ(half->content(),
              ocio::make_view({.config = config, .display = "paper", .view = "half"})->content());
    EXPECT_NE(half->content(), usual->content());
    // Many at once, and whatever light there is.
    std::vector<glm::vec3> many(1000, light);
    many[3] = glm::vec3(std::numeric_limits<float>::max());
    half->apply(many);
    expect_near(many.back(), 0.5f * light);
    usual->apply(many);
    for (const glm::vec3& colour : many)
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(colour[c]));
    half->apply({});
}

// Through ACES 2065-1, whose white is Rec. 709's.
TEST_F(Ocio, FindsItsWayByTheInterchangeRole) {
    const std::string config =
        written(configuration("  aces_interchange: ap0\n  scene_linear: ap0\n", "ap0"));
    const auto to_aces = glm::mat3(conversion(kRec709, kAces2065));
    const auto view =
        ocio::make_view({.config = config, .display = "paper", .view = "half", .aces_of_rec709 = to_aces});
    expect_near(shown(*view, glm::vec3(0.18f)), glm::vec3(0.09f));
    expect_near(shown(*view, {1.0f, 0.0f, 0.0f}), 0.5f * to_aces[0]);
    // As the artist says, whatever the role says.
    const auto as_is = ocio::make_view(
        {.config = config, .display = "paper", .view = "half", .space = "ap0", .aces_of_rec709 = to_aces});
    expect_near(shown(*as_is, {1.0f, 0.0f, 0.0f}), {0.5f, 0.0f, 0.0f});
}

TEST_F(Ocio, RefusesWithWhatThereIs) {
    const std::string config = written(configuration("", "lin_rec709"));
    EXPECT_EQ(refusal({.config = config, .display = "wall"}),
              "has no display \"wall\"; accepted: screen, paper");
    EXPECT_EQ(refusal({.config = config, .view = "film"}), "has no view \"film\"; accepted: square");
    EXPECT_NE(refusal({.config = config, .space = "xyz"})
                  .find("has no colour space \"xyz\"; accepted: --ocio-space with one of raw, lin_rec709"),
              std::string::npos);
    EXPECT_NE(refusal({.config = "/no/config.ocio"}).find("isn't a configuration that OpenColorIO reads"),
              std::string::npos);
    const std::string unknown = written(configuration("", "my_own"));
    EXPECT_NE(refusal({.config = unknown}).find("neither the role aces_interchange nor"), std::string::npos);
    EXPECT_EQ(refusal({.config = unknown, .space = "my_own"}), "accepted");
    EXPECT_NE(refusal({.config = written("not: [a config")}).find("isn't a configuration"),
              std::string::npos);
}

}  // namespace
}  // namespace pelagic
