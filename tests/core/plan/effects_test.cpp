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
    scene.waves.masks = {{.waves = 0.5}};
    scene.waves.vessels = {{}};
    scene.sea.depth_m = 20.0;
    scene.sea.depth_file = "bay.exr";
    scene.waves.coast = true;
    scene.waves.coast_depths = std::make_shared<const DepthMap>(glm::ivec2(2, 1), std::vector{3.0f, 4.0f},
                                                                glm::dvec2(), glm::dvec2(40.0, 20.0));
    return scene;
}

// Of all, that one and those on which it depends.
Scene with_only(Effect effect) {
    Scene scene = with_all();
    for (const EffectRow& row : effect_table()) {
        bool stays = row.effect == effect;
        for (const Effect on : row_of(effect).depends_on) stays |= on == row.effect;
        if (!stays) row.turn_off(scene);
    }
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
    const auto of = [](const Scene& scene, const Query& query) {
        return with_effects(scene, query).products;
    };
    Query picture;
    picture.is_picture = true;
    picture.products = products(Product::Coverage, Product::JacobianMoments, Product::Normal);
    Query mesh = picture;
    mesh.is_picture = false;
    Query tile = mesh;
    tile.only_cascade = 0;
    for (const EffectRow& row : effect_table()) {
        SCOPED_TRACE(row.name);
        const Scene with = with_only(row.effect);
        Scene without = with;
        row.turn_off(without);
        for (const Query& query : {picture, mesh, tile}) {
            const ProductSet added = row.adds_to ? row.adds_to(query) : ProductSet();
            EXPECT_EQ(of(with, query), of(without, query) | (query.products & row.products) | added);
            EXPECT_EQ(of(without, query) & row.products, ProductSet());
        }
    }
    const Scene living = with_only(Effect::LivingFoam), spray = with_only(Effect::Spray);
    EXPECT_EQ(of(living, picture), picture.products | foam_products());
    EXPECT_EQ(of(living, mesh), mesh.products | foam_products());
    EXPECT_EQ(of(living, tile), tile.products);
    EXPECT_EQ(of(spray, picture), picture.products | products(Product::Displacement));
    EXPECT_EQ(of(spray, mesh), mesh.products);
    EXPECT_EQ(of(with_only(Effect::Gusts), picture), products(Product::Normal));
}

TEST(Effects, SprayOfNoGainIsNone) {
    Scene scene = with_all();
    scene.effects.spray_gain = 0.0;
    EXPECT_FALSE(is_on(Effect::Spray, scene));
    EXPECT_NE(page_of(scene).find("\n  no spray: "), std::string::npos);
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
    Scene sea = with_all();
    sea.waves.vessels.clear();
    EXPECT_NE(page_of(sea).find("\n  horizontal displacement: 4 transforms, "), std::string::npos) << all;
    EXPECT_NE(all.find("\n  gusts: no transform and no memory\n"), std::string::npos) << all;
}

TEST(Effects, ThePageSaysWhereFrontsAre) {
    Scene scene = with_all();
    scene.sea.gust_fronts = {{.frame = 25.0, .east_m = 30.0, .speed_mps = 8.0, .wind = 1.5}};
    EXPECT_NE(page_of(scene).find(
                  "; a front of 1.5 times the wind that goes at 8 m/s, at 30, 0 m after 1 s; waves that are "
                  "shown don't feel fronts\n"),
              std::string::npos)
        << page_of(scene);
}

TEST(Effects, TheGainOfSlopesStandsUnderTheirVariance) {
    const std::string page = page_of(with_all());
    const std::size_t line = page.find("\n", page.find("    slope variance ")) + 1;
    EXPECT_NE(page.substr(line, page.find('\n', line) - line).find(" times that at rest"), std::string::npos)
        << page;
}

}  // namespace
}  // namespace pelagic
