// The table of effects: each row against what it says of itself, whatever the others are.
#include "core/plan/effects.h"

#include <gtest/gtest.h>

#include <string>

#include "core/plan/plan.h"
#include "core/scene/validate.h"

namespace pelagic {
namespace {

Scene with_all() {
    Scene scene;
    scene.surface.resolution = 32;
    scene.waves.tiling = Tiling::Periodic;
    scene.waves.cascades = {{400.0, 128}};
    scene.sea.gust_strength = 0.5;
    scene.effects.spray = true;
    return scene;
}

std::string page_of(const Scene& scene) {
    return explain(plan_bake(scene));
}

TEST(Effects, EachIsTurnedOffByItsOwnRow) {
    for (const EffectRow& row : effect_table()) {
        SCOPED_TRACE(row.name);
        EXPECT_EQ(&row_of(row.effect), &row);
        Scene scene = with_all();
        EXPECT_TRUE(row.is_on(scene));
        row.turn_off(scene);
        EXPECT_TRUE(validate(scene).empty());
        for (const EffectRow& other : effect_table()) {
            bool depends = other.effect == row.effect;
            for (const Effect on : other.depends_on) depends |= on == row.effect;
            EXPECT_EQ(other.is_on(scene), !depends) << other.name;
            EXPECT_EQ(other.why_off(scene).empty(), !depends) << other.name;
        }
    }
}

TEST(Effects, AQueryHasWhatThoseThatAreOnAddAndNothingOfTheOthers) {
    // Whatever others add.
    const auto of = [](const Scene& scene, const Query& query) {
        return with_effects(scene, query).products &
               (query.products | foam_products() | products(Product::Displacement));
    };
    Query picture;
    picture.is_picture = true;
    picture.products = products(Product::Coverage, Product::JacobianMoments, Product::Normal);
    EXPECT_EQ(of(with_all(), picture), picture.products | foam_products() | products(Product::Displacement));
    Query mesh = picture;
    mesh.is_picture = false;
    EXPECT_EQ(of(with_all(), mesh), picture.products | foam_products());
    Query tile = mesh;
    tile.only_cascade = 0;
    EXPECT_EQ(of(with_all(), tile), tile.products);
    Scene dry = with_all();
    dry.effects.whitecaps = false;
    EXPECT_EQ(of(dry, picture), products(Product::Normal));
}

TEST(Effects, ThePageListsEachWithItsCostOrWhyItIsOff) {
    const std::string all = page_of(with_all());
    for (const EffectRow& row : effect_table()) {
        SCOPED_TRACE(row.name);
        const std::string name = row.name;
        EXPECT_NE(all.find("\n  " + name + ": "), std::string::npos) << all;
        Scene scene = with_all();
        row.turn_off(scene);
        EXPECT_NE(page_of(scene).find("\n  no " + name + ": " + row.why_not), std::string::npos);
    }
    Scene dry = with_all();
    dry.effects.whitecaps = false;
    EXPECT_NE(page_of(dry).find("\n  no spray: there is none without whitecaps"), std::string::npos);
    // Velocities along x and y, and the displacement itself: what breaks keeps its displacement gradient.
    EXPECT_NE(all.find("\n  horizontal displacement: 4 transforms, "), std::string::npos) << all;
    EXPECT_NE(all.find("\n  gusts: no transform and no memory\n"), std::string::npos) << all;
}

TEST(Effects, TheGainOfSlopesStandsUnderTheirVariance) {
    const std::string page = page_of(with_all());
    const std::size_t line = page.find("\n", page.find("    slope variance ")) + 1;
    EXPECT_NE(page.substr(line, page.find('\n', line) - line).find(" times that at rest"), std::string::npos)
        << page;
}

}  // namespace
}  // namespace pelagic
