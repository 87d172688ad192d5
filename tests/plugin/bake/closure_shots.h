// Small shots of every kind, and every key of theirs changed: for tests that go over the whole table.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/budget.h"
#include "core/scene/keys.h"
#include "core/scene/validate.h"
#include "pelagic/scene.h"
#include "plugin/budget/budget.h"
#include "plugin/format/shot/ndbc.h"
#include "tests/core/scene/key_samples.h"

namespace pelagic::test {

struct BaseShot {
    std::string name;
    Scene scene;
    bool is_picture = false;
    std::vector<std::string> skies{};   // paths of pictures, of which light.sky is one
    std::vector<std::string> foams{};   // likewise effects.foam_pattern
    std::vector<std::string> tables{};  // of the shot file, whose keys are changed; empty: all
};

inline MeasuredSpectrum made_up_buoy(int hour) {
    using namespace std::chrono;
    return load_ndbc(
        std::filesystem::path(PELAGIC_SOURCE_DIR) / "examples" / "data" / "made-up-99002w2024.txt",
        sys_days{year{2024} / October / 3} + hours{hour});
}

inline Scene small_shot() {
    Scene scene;
    scene.shot.last_frame = 3;
    scene.sea.swell = {{.height_m = 1.0, .period_s = 9.0, .direction_deg = 40.0}};
    scene.waves.cascades = {{.size_m = 80.0, .resolution = 64}, {.size_m = 24.0, .resolution = 32}};
    scene.surface.size_m = 80.0;
    scene.surface.resolution = 8;
    scene.camera.resolution = {64, 36};
    scene.quality.level = QualityLevel::Preview;
    scene.output.map_resolution = 8;
    return scene;
}

inline BaseShot patch_shot() {
    BaseShot base{.name = "patch", .scene = small_shot()};
    base.scene.output.maps = {MapKind::Displacement, MapKind::Normal, MapKind::SlopeVariance,
                              MapKind::Whitecaps};
    base.scene.output.cascade_tiles = true;
    return base;
}

// Volumes, and foam that lives where nobody asks for what it leaves.
inline BaseShot volumes_shot() {
    BaseShot base{.name = "volumes", .scene = small_shot()};
    base.scene.shot.last_frame = 2;
    base.scene.effects.spray = base.scene.effects.spray_drops = true;
    base.scene.output.mesh = MeshFormat::None;
    base.scene.output.volumes = {VolumeKind::Spray, VolumeKind::LevelSet};
    base.scene.output.voxel_m = 5.0;
    return base;
}

// Foam that lives, by the law that knows the air's temperature, and gusts.
inline BaseShot foam_shot() {
    BaseShot base{.name = "living foam", .scene = small_shot()};
    base.scene.effects.foam_decay_s = 0.5;
    base.scene.sea.gust_strength = 0.5;
    base.scene.sea.gust_size_m = 40.0;
    base.scene.effects.whitecap_law = WhitecapLaw::Monahan1986;
    base.scene.output.maps = {MapKind::Whitecaps};
    base.tables = {"shot", "sea", "effects"};
    return base;
}

inline BaseShot trains_shot() {
    BaseShot base{.name = "trains over cascades, as text", .scene = small_shot()};
    base.scene.waves.model = WaveModel::Trochoid;
    base.scene.waves.trains = 12;
    base.scene.waves.cascades = {{.size_m = 20.0, .resolution = 32}};
    base.scene.output.mesh = MeshFormat::Usda;
    base.scene.output.maps = {MapKind::Displacement, MapKind::Whitecaps};
    base.scene.output.cascade_tiles = true;
    return base;
}

// Trains on a beach; a small map, of which each edit's sea is marched anew.
inline BaseShot coast_shot() {
    BaseShot base{.name = "trains on a beach", .scene = small_shot()};
    base.scene.waves.model = WaveModel::Trochoid;
    base.scene.waves.trains = 12;
    base.scene.waves.cascades.clear();
    base.scene.waves.coast = true;
    base.scene.sea.depth_m = 8.0;
    base.scene.sea.depth_file = "beach.exr";
    std::vector<float> depths_m;
    for (int i = 0; i < 16; ++i)
        depths_m.push_back(8.0f - 0.7f * static_cast<float>(i % 4) - 0.1f * static_cast<float>(i));
    base.scene.waves.coast_depths = std::make_shared<const DepthMap>(glm::ivec2(4), std::move(depths_m),
                                                                     glm::dvec2(-10.0), glm::dvec2(20.0));
    base.scene.output.maps = {MapKind::Displacement, MapKind::Whitecaps};
    base.tables = {"waves"};
    return base;
}

// The same beach under tiles.
inline BaseShot coast_tiles_shot() {
    BaseShot base = coast_shot();
    base.name = "tiles on a beach";
    base.scene.waves.model = WaveModel::Fft;
    base.scene.waves.trains = Waves{}.trains;
    base.scene.waves.cascades = small_shot().waves.cascades;
    return base;
}

// The nearer the sea, the finer the grid's cells.
inline void descend(Scene& scene) {
    scene.shot.first_frame = 2;
    scene.shot.last_frame = 5;
    scene.camera.resolution = {160, 90};
    scene.camera.keys = {{.frame = 1, .position_m = {0.0, -60.0, 40.0}, .look_at_m = {0.0, 20.0, 0.0}},
                         {.frame = 10, .position_m = {0.0, -40.0, 2.0}, .look_at_m = {0.0, 20.0, 0.0}}};
}

inline BaseShot grid_shot() {
    BaseShot base{.name = "projected grid of a camera that descends", .scene = small_shot()};
    descend(base.scene);
    base.scene.surface.kind = SurfaceKind::ProjectedGrid;
    base.scene.output.maps = {MapKind::Displacement, MapKind::SlopeVariance, MapKind::Floor};
    base.scene.sea.depth_m = 6.0;
    base.scene.output.cascade_tiles = true;
    return base;
}

inline BaseShot near_far_shot() {
    BaseShot base{.name = "near to far, of a camera that descends", .scene = small_shot()};
    descend(base.scene);
    base.scene.surface.kind = SurfaceKind::NearFar;
    base.scene.surface.size_m = 20.0;
    base.tables = {"shot", "surface", "camera", "output"};
    return base;
}

// The cascades are as fine as the shot needs them: the next one may need finer ones.
inline BaseShot automatic_shot() {
    BaseShot base{.name = "projected grid over automatic cascades", .scene = small_shot()};
    descend(base.scene);
    base.scene.surface.kind = SurfaceKind::ProjectedGrid;
    base.scene.waves.cascades.clear();
    // A near camera makes the last cascade finer than its tile.
    base.scene.output.maps = {MapKind::SlopeVariance, MapKind::Whitecaps};
    base.scene.output.cascade_tiles = true;
    base.tables = {"shot", "surface", "camera"};
    return base;
}

inline BaseShot buoy_shot() {
    BaseShot base{.name = "a buoy's spectrum", .scene = small_shot()};
    base.scene.shot.last_frame = 2;
    base.scene.sea.spectrum = SpectrumKind::File;
    base.scene.sea.measured = made_up_buoy(6);
    base.scene.output.maps = {MapKind::Normal};
    return base;
}

inline BaseShot daylight_shot() {
    BaseShot base{.name = "pictures by daylight", .scene = small_shot(), .is_picture = true};
    base.scene.shot.last_frame = 2;
    base.scene.quality.level = QualityLevel::Draft;
    base.scene.camera.resolution = {32, 18};
    base.tables = {"shot", "surface", "camera", "light", "water", "effects"};
    return base;
}

// `skies`, `foams`: two paths of pictures each, of a sky and of all else.
inline BaseShot sky_shot(std::vector<std::string> skies, std::vector<std::string> foams) {
    BaseShot base = daylight_shot();
    base.name = "pictures with a picture in each key that has one";
    descend(base.scene);
    base.scene.shot.last_frame = 3;
    base.scene.camera.resolution = {32, 18};
    base.scene.light.sky = skies.front();
    for (const Key& key : keys())
        if (key.is_picture && key.path != "light.sky") key.set(base.scene, foams.front());
    base.skies = std::move(skies);
    base.foams = std::move(foams);
    base.tables.clear();
    return base;
}

// A basin of quads and a triangle with a fairly sharp edge, whose limit surface the sea lies on.
inline CageMesh small_cage() {
    CageMesh mesh;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x)
            mesh.points_m.emplace_back(12.0 * x - 18.0, 12.0 * y - 12.0, y == 2 ? 3.0 : 0.5 * x);
    mesh.points_m.emplace_back(24.0, 6.0, 1.0);
    mesh.face_counts = {4, 4, 4, 4, 4, 4, 3};
    mesh.indices = {0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 4, 5, 9, 8, 5, 6, 10, 9, 6, 7, 11, 10, 7, 12, 11};
    mesh.creases = {{5, 6, 2.5}};
    mesh.holes = {1};
    return mesh;
}

inline BaseShot cage_shot() {
    BaseShot base{.name = "a cage", .scene = small_shot()};
    base.scene.surface.kind = SurfaceKind::Cage;
    base.scene.surface.cage_file = "basin.obj";
    base.scene.surface.cage = std::make_shared<const Cage>(small_cage());
    base.tables = {"sea", "surface", "camera"};
    return base;
}

inline constexpr std::string_view kAdaptiveCageShot = "a cage as a camera that descends sees it";
inline BaseShot adaptive_cage_shot() {
    BaseShot base = cage_shot();
    base.name = kAdaptiveCageShot;
    descend(base.scene);
    base.scene.surface.cage_level.is_adaptive = true;
    base.tables = {"shot", "surface", "camera"};
    return base;
}

// ---- Edits

struct Edit {
    std::string key;   // its path
    std::string what;  // the value as a shot file writes it
    Scene scene;
};

// Other values of a list: an entry more, one less, and each key of the first entry and of the last changed.
inline std::vector<KeyValue> other_entries(const Key& key, const std::vector<KeyEntry>& now) {
    std::vector<KeyValue> others;
    std::vector<KeyEntry> more = now;
    more.push_back(good_entry(key));
    others.emplace_back(more);
    if (now.empty()) return others;
    others.emplace_back(std::vector<KeyEntry>(now.begin(), now.end() - 1));
    for (const std::size_t i : std::set{std::size_t{0}, now.size() - 1})
        for (std::size_t k = 0; k < key.entry_keys.size(); ++k) {
            std::vector<KeyEntry> changed = now;
            KeyValue& value = changed[i].values[k].second;
            value = another_value(key.entry_keys[k], value);
            others.emplace_back(std::move(changed));
        }
    return others;
}

inline std::vector<KeyValue> other_words(const Key& key, const std::vector<std::string>& now) {
    std::vector<KeyValue> others;
    for (const std::string& word : key.choices) {
        std::vector<std::string> words = now;
        const auto here = std::find(words.begin(), words.end(), word);
        if (here == words.end())
            words.push_back(word);
        else
            words.erase(here);
        others.emplace_back(std::move(words));
    }
    if (now.size() > 1) others.emplace_back(std::vector<std::string>(now.rbegin(), now.rend()));
    return others;
}

// Values that mean something where a step from the one that is there doesn't.
inline std::vector<KeyValue> chosen_values(const std::string& path, const BaseShot& base) {
    const Scene& scene = base.scene;
    const auto frames = [](std::int64_t first, std::int64_t last) {
        return KeyValue(std::vector<std::int64_t>{first, last});
    };
    const std::int64_t first = scene.shot.first_frame, last = scene.shot.last_frame;
    if (path == "shot.frames")
        return {frames(first, last - 1), frames(first, last + 2), frames(first + 1, last),
                frames(first - 1, last), frames(first + 1, last + 1)};
    if (path == "camera.f_stop") return {2.8};
    if (path == "shot.fps") return {25.0};
    if (path == "shot.loop_s") return {2.0, 4.0};
    if (path == "sea.wind_speed_mps") return {7.0, 0.0};
    if (path == "sea.fetch_m") return {50e3};
    if (path == "sea.depth_m") return {15.0, 400.0};
    if (path == "waves.shortest_m") return {2.0};
    if (path == "waves.longest_m") return {90.0};
    if (path == "waves.cascades") {
        const auto entry = [&](double size_m, std::int64_t resolution) {
            KeyEntry made = good_entry(key_of(path));
            made.values[0].second = size_m;
            made.values[1].second = resolution;
            return made;
        };
        return {std::vector{entry(60.0, 32)}, std::vector{entry(80.0, 64), entry(24.0, 48)},
                std::vector{entry(80.0, 80), entry(24.0, 32)}, std::vector{entry(20.0, 64)}};
    }
    if (path == "camera.resolution") return {std::vector<std::int64_t>{96, 54}};
    if (path == "camera.keys" && !scene.camera.keys.empty()) {
        // Slower, and one key in the middle of the shot.
        Scene slower = scene, between = scene;
        slower.camera.keys.back().frame = 20;
        CameraKey key = scene.camera.keys.front();
        key.frame = static_cast<int>(last);
        between.camera.keys.insert(between.camera.keys.begin() + 1, key);
        return {value_of(slower, key_of(path)), value_of(between, key_of(path))};
    }
    if (path == "light.sky") return {base.skies.begin(), base.skies.end()};
    if (path != "light.sky" && key_of(path).is_picture) return {base.foams.begin(), base.foams.end()};
    if (path == "quality.max_error") return {0.3, 0.1};
    if (path == "quality.frame_ms") return {1.0, 3.0};
    if (path == "surface.cage_level") return {std::int64_t{1}, std::int64_t{3}, std::string("adaptive")};
    return {};
}

// Each key of the table changed, alone: all edits that validate() accepts.
inline std::vector<Edit> edits_of(const BaseShot& base) {
    std::vector<Edit> edits;
    for (const Key& key : keys()) {
        const std::string table = key.path.substr(0, key.path.find('.'));
        if (!base.tables.empty() &&
            std::find(base.tables.begin(), base.tables.end(), table) == base.tables.end())
            continue;
        const auto add = [&](Scene changed, const std::string& what) {
            if (validate(changed).empty()) edits.push_back({key.path, what, std::move(changed)});
        };
        if (key.path == "camera.file") continue;  // a host makes camera.keys of it
        if (key.path == kCageFile) {
            if (!base.scene.surface.cage) continue;
            Scene changed = base.scene;
            changed.surface.cage_file += ".moved";
            add(changed, "moved");
            CageMesh mesh = changed.surface.cage->mesh();
            mesh.points_m.front().z += 0.5;
            changed.surface.cage = std::make_shared<const Cage>(mesh);
            add(changed, "other points");
            mesh.creases.front().sharpness = 1.0;
            changed.surface.cage = std::make_shared<const Cage>(std::move(mesh));
            add(changed, "other sharpness");
            continue;
        }
        if (!key.set) {
            if (!base.scene.sea.measured) continue;
            Scene changed = base.scene;
            if (key.type == KeyType::DataTime) {
                changed.sea.measured = made_up_buoy(7);
                add(changed, "another hour");
                continue;
            }
            changed.sea.measured->file += ".moved";
            add(changed, "moved");
            changed.sea.measured->bins[changed.sea.measured->bins.size() / 3].density_m2_per_hz += 1.0;
            add(changed, "other numbers");
            continue;
        }
        const KeyValue now = value_of(base.scene, key);
        std::vector<KeyValue> values = chosen_values(key.path, base);
        if (const auto* entries = std::get_if<std::vector<KeyEntry>>(&now)) {
            const auto others = other_entries(key, *entries);
            values.insert(values.end(), others.begin(), others.end());
        } else if (const auto* words = std::get_if<std::vector<std::string>>(&now)) {
            const auto others = other_words(key, *words);
            values.insert(values.end(), others.begin(), others.end());
        } else if (key.type == KeyType::Word) {
            for (const std::string& word : key.choices) values.emplace_back(word);
        } else if (values.empty() && !(base.is_picture && key.path == "light.sky")) {
            values.push_back(another_value(key, now));
        }
        for (const KeyValue& value : values) {
            Scene changed = base.scene;
            if (value == now || set_value(changed, key, value)) continue;
            if (has_budget(changed.quality)) {
                // Of meshes that a bake writes in a moment; a picture's budget becomes options before it is rendered.
                if (base.is_picture) continue;
                const Settled settled = settle(changed, Purpose::Mesh, with_rates(recorded_rates()));
                constexpr int kMostQuads = 64;
                if (!settled.holds || settled.scene.surface.resolution > kMostQuads) continue;
                changed = settled.scene;
            }
            const std::string text = value_text(key, value);
            add(std::move(changed), text.empty() ? "none" : text);
        }
    }
    return edits;
}

}  // namespace pelagic::test
