// The canonical text: every value that a frame depends on, and not the range of frames.
#include "core/scene/canonical.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

namespace pelagic {
namespace {

Scene scene_with_lists() {
    Scene scene;
    scene.sea.swell = {{1.5, 11.0, 80.0}};
    scene.sea.spectrum = SpectrumKind::File;
    scene.sea.measured =
        MeasuredSpectrum{{{0.1, 1.0, 0.5, 0.1, 0.2, 0.3, true}}, "41010", "2019-02-06T00:40:00Z"};
    scene.waves.cascades = {{400.0, 512}};
    scene.camera.keys = {{1, {0.0, -60.0, 4.0}, {0.0, 0.0, 0.0}}};
    scene.output.maps = {MapKind::Normal};
    return scene;
}

// One change for each member of each struct of scene.h, the range of frames excepted. (A member without a
// key doesn't compile.)
const std::vector<std::function<void(Scene&)>>& changes() {
    static const std::vector<std::function<void(Scene&)>> list{
        [](Scene& s) { s.shot.name = "see"; },
        [](Scene& s) { s.shot.fps = 25.0; },
        [](Scene& s) { s.shot.seed = 2; },
        [](Scene& s) { s.shot.loop_s = 2.0; },
        [](Scene& s) { s.shot.time_scale = 0.5; },
        [](Scene& s) { s.shot.time_offset_s = 2.0; },
        [](Scene& s) { s.sea.wind_speed_mps = std::nextafter(10.0, 11.0); },
        [](Scene& s) { s.sea.wind_direction_deg = 1.0; },
        [](Scene& s) { s.sea.fetch_m = 1.0; },
        [](Scene& s) { s.sea.depth_m = 20.0; },
        [](Scene& s) { s.sea.spectrum = SpectrumKind::Tma; },
        [](Scene& s) { s.sea.spreading = SpreadingKind::Cosine; },
        [](Scene& s) { s.sea.swell.clear(); },
        [](Scene& s) { s.sea.swell.push_back(s.sea.swell.front()); },
        [](Scene& s) { s.sea.swell[0].height_m = 2.0; },
        [](Scene& s) { s.sea.swell[0].period_s = 12.0; },
        [](Scene& s) { s.sea.swell[0].direction_deg = 81.0; },
        [](Scene& s) { s.sea.measured.reset(); },
        [](Scene& s) { s.sea.measured->station = "41011"; },
        [](Scene& s) { s.sea.measured->time = "2019-02-06T01:40:00Z"; },
        // Two texts on one line: where one ends and the other begins matters.
        [](Scene& s) {
            s.sea.measured = MeasuredSpectrum{{}, "a b", "c"};
        },
        [](Scene& s) {
            s.sea.measured = MeasuredSpectrum{{}, "a", "b c"};
        },
        [](Scene& s) { s.sea.measured->bins.clear(); },
        [](Scene& s) { s.sea.measured->bins[0].frequency_hz = 0.2; },
        [](Scene& s) { s.sea.measured->bins[0].density_m2_per_hz = 2.0; },
        [](Scene& s) { s.sea.measured->bins[0].c1_re = 0.6; },
        [](Scene& s) { s.sea.measured->bins[0].c1_im = 0.6; },
        [](Scene& s) { s.sea.measured->bins[0].c2_re = 0.6; },
        [](Scene& s) { s.sea.measured->bins[0].c2_im = 0.6; },
        [](Scene& s) { s.sea.measured->bins[0].has_direction = false; },
        [](Scene& s) { s.waves.model = WaveModel::Trochoid; },
        [](Scene& s) { s.waves.choppiness = 0.5; },
        [](Scene& s) { s.waves.cascades.clear(); },
        [](Scene& s) { s.waves.cascades[0].size_m = 401.0; },
        [](Scene& s) { s.waves.cascades[0].resolution = 256; },
        [](Scene& s) { s.waves.cascades[0].choppiness = 1.0; },
        [](Scene& s) { s.waves.cascades[0].choppiness = 0.5; },
        [](Scene& s) { s.sea.gust_fronts = {{}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.frame = 2.0}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.east_m = 1.0}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.north_m = 1.0}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.direction_deg = 90.0}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.speed_mps = 9.0}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.length_m = 90.0}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.width_m = 90.0}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.edge_m = 90.0}}; },
        [](Scene& s) { s.sea.gust_fronts = {{.wind = 0.5}}; },
        [](Scene& s) { s.waves.heroes = {{.frame = 2.0}}; },
        [](Scene& s) { s.waves.heroes = {{.frame = 3.0}}; },
        [](Scene& s) { s.waves.heroes = {{.frame = 2.0, .east_m = 1.0}}; },
        [](Scene& s) { s.waves.heroes = {{.frame = 2.0, .north_m = 1.0}}; },
        [](Scene& s) { s.waves.heroes = {{.frame = 2.0, .height_m = 1.0}}; },
        [](Scene& s) { s.waves.masks = {{}}; },
        [](Scene& s) { s.waves.masks = {{.east_m = 1.0}}; },
        [](Scene& s) { s.waves.masks = {{.north_m = 1.0}}; },
        [](Scene& s) { s.waves.masks = {{.length_m = 90.0}}; },
        [](Scene& s) { s.waves.masks = {{.width_m = 90.0}}; },
        [](Scene& s) { s.waves.masks = {{.direction_deg = 90.0}}; },
        [](Scene& s) { s.waves.masks = {{.edge_m = 90.0}}; },
        [](Scene& s) { s.waves.masks = {{.waves = 0.5}}; },
        [](Scene& s) { s.waves.masks = {{.ripples = 0.5}}; },
        [](Scene& s) { s.waves.masks = {{.foam = 0.5}}; },
        [](Scene& s) { s.waves.masks = {{.picture = "lee.exr"}}; },
        [](Scene& s) { s.waves.vessels = {{}}; },
        [](Scene& s) { s.waves.vessels = {{.path = "1 0 0, 48 10 1"}}; },
        [](Scene& s) { s.waves.vessels = {{.interpolation = CameraInterpolation::Linear}}; },
        [](Scene& s) { s.waves.vessels = {{.length_m = 26.0}}; },
        [](Scene& s) { s.waves.vessels = {{.beam_m = 8.0}}; },
        [](Scene& s) { s.waves.vessels = {{.draught_m = 4.0}}; },
        [](Scene& s) { s.waves.vessels = {{.waves = 0.5}}; },
        [](Scene& s) { s.waves.vessels = {{.foam = 0.5}}; },
        [](Scene& s) { s.waves.trains = 61; },
        [](Scene& s) { s.waves.shortest_m = 0.02; },
        [](Scene& s) { s.waves.longest_m = 0.02; },
        [](Scene& s) { s.waves.coast = true; },
        [](Scene& s) {
            s.waves.coast = true;
            s.waves.coast_depths = std::make_shared<const DepthMap>(glm::ivec2(2, 1), std::vector{3.0f, 4.0f},
                                                                    glm::dvec2(0.0), glm::dvec2(2.0, 1.0));
        },
        [](Scene& s) {
            s.waves.coast = true;
            s.waves.coast_depths = std::make_shared<const DepthMap>(glm::ivec2(2, 1), std::vector{3.0f, 4.5f},
                                                                    glm::dvec2(0.0), glm::dvec2(2.0, 1.0));
        },
        [](Scene& s) { s.surface.kind = SurfaceKind::Planet; },
        [](Scene& s) { s.surface.size_m = 201.0; },
        [](Scene& s) { s.surface.resolution = 255; },
        [](Scene& s) { s.surface.cell_px = 4.0; },
        [](Scene& s) { s.camera.position_m.x = 1.0; },
        [](Scene& s) { s.camera.position_m.y = 1.0; },
        [](Scene& s) { s.camera.position_m.z = 1.0; },
        [](Scene& s) { s.camera.look_at_m.x = 1.0; },
        [](Scene& s) { s.camera.look_at_m.y = 1.0; },
        [](Scene& s) { s.camera.look_at_m.z = 1.0; },
        [](Scene& s) { s.camera.keys.clear(); },
        [](Scene& s) { s.camera.keys[0].frame = 2; },
        [](Scene& s) { s.camera.keys[0].position_m.z = 5.0; },
        [](Scene& s) { s.camera.keys[0].look_at_m.x = 5.0; },
        [](Scene& s) { s.camera.keys[0].fov_deg = 50.0; },
        [](Scene& s) { s.camera.keys[0].roll_deg = 1.0; },
        [](Scene& s) { s.camera.fov_deg = 51.0; },
        [](Scene& s) { s.camera.resolution.x = 1281; },
        [](Scene& s) { s.camera.resolution.y = 721; },
        [](Scene& s) { s.light.sun_elevation_deg = 21.0; },
        [](Scene& s) { s.light.sun_azimuth_deg = 91.0; },
        [](Scene& s) { s.light.sky = "sky.exr"; },
        [](Scene& s) { s.light.sky = "daylight\noutput.voxel_m = 1"; },
        [](Scene& s) { s.light.turbidity = 4.0; },
        [](Scene& s) { s.water.type = WaterType::Turbid; },
        [](Scene& s) { s.water.chlorophyll_mg_m3 = 0.2; },
        [](Scene& s) { s.water.body = false; },
        [](Scene& s) { s.water.floor_colour.z = 0.2; },
        [](Scene& s) { s.water.floor_pattern = "tiles.exr"; },
        [](Scene& s) { s.water.floor_pattern_m = 2.0; },
        [](Scene& s) { s.water.caustics = 0.5; },
        [](Scene& s) { s.sea.depth_file = "bay.exr"; },
        [](Scene& s) { s.sea.depth_size_m = 20.0; },
        [](Scene& s) { s.sea.depth_east_m = 20.0; },
        [](Scene& s) { s.sea.depth_north_m = 20.0; },
        [](Scene& s) { s.water.crest_light = 2.0; },
        [](Scene& s) { s.water.bubbles = 0.5; },
        [](Scene& s) { s.effects.whitecaps = false; },
        [](Scene& s) { s.effects.whitecap_law = WhitecapLaw::Monahan1980; },
        [](Scene& s) { s.effects.sea_minus_air_c = 2.0; },
        [](Scene& s) { s.effects.whitecap_amount = 2.0; },
        [](Scene& s) { s.effects.breaking_from_m = 2.0; },
        [](Scene& s) { s.effects.spray = true; },
        [](Scene& s) { s.effects.spray_law = SpraySource::Monahan1986; },
        [](Scene& s) { s.effects.spray_gain = 2.0; },
        [](Scene& s) { s.effects.spray_drops = true; },
        [](Scene& s) { s.quality.level = QualityLevel::Draft; },
        [](Scene& s) { s.output.mesh = MeshFormat::None; },
        [](Scene& s) { s.output.attributes.pop_back(); },
        [](Scene& s) { s.output.maps.clear(); },
        [](Scene& s) { s.output.map_resolution = 256; },
        [](Scene& s) { s.output.cascade_tiles = true; },
        [](Scene& s) { s.output.mesh_scheme = MeshScheme::CatmullClark; },
        [](Scene& s) { s.output.volumes = {VolumeKind::Spray}; },
        [](Scene& s) { s.output.voxel_m = 0.25; },
        [](Scene& s) { s.output.drops = true; },
    };
    return list;
}

TEST(Canonical, EveryValueMatters) {
    std::set<std::string> texts{canonical(scene_with_lists())};
    for (std::size_t i = 0; i < changes().size(); ++i) {
        Scene scene = scene_with_lists();
        changes()[i](scene);
        EXPECT_TRUE(texts.insert(canonical(scene)).second) << "change number " << i;
    }
}

// Shots from before it keep their fingerprints.
TEST(Canonical, ACoastThatIsOffSaysNothing) {
    EXPECT_EQ(canonical(Scene()).find("waves.coast"), std::string::npos);
}

TEST(Canonical, TheRangeOfFramesDoesNot) {
    Scene scene = scene_with_lists();
    scene.shot.first_frame = 100;
    scene.shot.last_frame = 2000;
    EXPECT_EQ(canonical(scene), canonical(scene_with_lists()));
}

}  // namespace
}  // namespace pelagic
