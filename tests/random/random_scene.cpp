#include "tests/random/random_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <random>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/base/constants.h"
#include "core/plan/plan.h"
#include "core/scene/cascade_bands.h"
#include "core/spectrum/possible.h"
#include "plugin/budget/budget.h"
#include "plugin/format/exr/exr.h"
#include "plugin/format/obj/object_obj.h"
#include "plugin/render/render.h"

namespace pelagic::test {
namespace {

constexpr std::string_view kEntries = "entries of a list", kFramesAfterTheFirst = "frames after the first",
                           kVoxelsASide = "voxels along a side",
                           kAutomaticBytes = "bytes of automatic cascades",
                           kDropsSide_m = "metres along a side of drops of spray";

// For time alone: with all of these a scene takes some tens of milliseconds.
constexpr Cap kCaps[] = {
    {kEntries, {0, 3}, "each swell is a spectrum of its own, each cascade a grid"},
    {kFramesAfterTheFirst, {0, 1}, "each frame is baked twice"},
    {kVoxelsASide, {1, 12}, "voxels grow with the cube"},
    {kDropsSide_m, {1, 20}, "parcels start in cells of a metre, up to 256 a side, in ten intervals"},
    {kAutomaticBytes, {0, 2e6}, "automatic cascades are as fine as somebody looks: 2048² beside a lens"},
    {"waves.cascades[].resolution", {16, 64}, "transforms grow with the square"},
    {"waves.trains", {1, 100}, "each point sums all trains"},
    {"surface.resolution", {1, 10}, "vertices grow with the square, and near to far has many parts of it"},
    {"objects[].vessel", {0, 1}, "without so many vessels it is refused"},
    {"surface.cell_px", {6, 256}, "points of projected grids grow with the inverse square"},
    {"surface.cage_level", {0, 2}, "each level has four times the faces"},
    {"camera.resolution", {1, 24}, "each pixel is lit"},
    {"output.map_resolution", {1, 12}, "texels grow with the square"},
    {"quality.max_error", {0.45, 1.0}, "a budget of error makes a mesh finer than all caps"},
    {"quality.frame_ms", {0.01, 0.4}, "and so does one of time"},
    {"effects.foam_decay_s",
     {0, 0.5},
     "foam's past is computed before the first frame: some ten times this long"},
};

const Range& cap(std::string_view what) {
    for (const Cap& each : kCaps)
        if (each.what == what) return each.range;
    throw std::logic_error("no cap of " + std::string(what));
}

// A sky takes a tenth of a second: so many scenes, one after another, have one light. Daylight and its air take several:
// most skies are pictures.
constexpr std::uint64_t kScenesALight = 10;
constexpr double kPictureOfSky = 0.8;

constexpr const char* kCageName = "cage.obj";
constexpr const char* kBodyName = "body.obj";
constexpr const char* kSkyName = "sky.exr";
constexpr const char* kFoamName = "foam.exr";
constexpr const char* kMaskName = "mask.exr";
constexpr const char* kBuoyName = "99001w2024.txt";
constexpr const char* kBody =
    "v -3 -1 -1\nv 3 0 0\nv -3 1 -1\nv -2 0 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n";
constexpr const char* kBuoyTime = "2024-10-03T06:00:00Z";

class Draw {
  public:
    explicit Draw(std::uint64_t seed) : engine_(seed) {}

    double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
    bool chance(double p) { return unit() < p; }
    std::size_t index(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
    int integer(int low, int high) {
        return low + static_cast<int>(index(static_cast<std::size_t>(high - low) + 1));
    }
    double uniform(double low, double high) { return low + (high - low) * unit(); }
    double log_uniform(double low, double high) {
        return std::clamp(low * std::exp(unit() * std::log(high / low)), low, high);
    }
    template <class V>
    V pick(std::initializer_list<V> values) {
        return *(values.begin() + static_cast<std::ptrdiff_t>(index(values.size())));
    }

    // Anywhere in the range: by its logarithm where that spans decades, of either sign and from 0 as well.
    double anywhere(const Range& range) {
        constexpr double kDecades = 100.0, kSmallest = 1e-9;  // of the range, where it begins at 0
        const auto [low, high] = range;
        if (low > 0.0) return high / low >= kDecades ? log_uniform(low, high) : uniform(low, high);
        const bool is_wide = high - low > 2.0 * kDecades;
        if (!is_wide && chance(0.7)) return uniform(low, high);
        const double side = low < 0.0 && (high <= 0.0 || chance(0.5)) ? low : high;
        return side == 0.0 ? 0.0
                           : std::copysign(log_uniform(kSmallest * std::abs(side), std::abs(side)), side);
    }

    double number(const Key& key) {
        if (!key.range)
            throw std::logic_error(key.path + " has no range: say in random_scene.cpp what to draw of it");
        const Range range = drawn_range(key);
        if (key.may_be_infinite && chance(0.1)) return std::numeric_limits<double>::infinity();
        if (chance(0.12)) return pick({range.low, range.high});
        // What costs much is off more often than other keys.
        if (range.holds(0.0) && chance(costs_too_much(key) ? 0.5 : 0.05)) return 0.0;
        if (!key.soft || chance(0.4)) return anywhere(range);
        const double low = std::clamp(key.soft->low, range.low, range.high),
                     high = std::clamp(key.soft->high, range.low, range.high);
        return key.soft->is_logarithmic && low > 0.0 ? log_uniform(low, high) : uniform(low, high);
    }
    std::int64_t whole_number(const Key& key) {
        if (key.range) return std::llround(number(key));
        // A seed: any of them.
        const double largest = static_cast<double>(key.largest);
        return chance(0.2) ? pick({key.least, key.largest})
                           : static_cast<std::int64_t>(log_uniform(1.0, 0.99 * largest));
    }

    std::vector<std::string> words(const Key& key) {
        std::vector<std::string> all;
        for (const std::string& word : key.choices)
            if (chance(0.6)) all.push_back(word);
        for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[index(i)]);
        return all;
    }

    // Up to three entries; their required keys, and most others.
    std::vector<KeyEntry> entries(const Key& key) {
        std::vector<KeyEntry> all(static_cast<std::size_t>(
            std::llround(uniform(cap(kEntries).low - 0.49, cap(kEntries).high + 0.49))));
        for (KeyEntry& entry : all)
            for (const Key& inner : key.entry_keys)
                entry.values.emplace_back(inner.name,
                                          inner.is_required || inner.path == "objects[].name" || chance(0.6)
                                              ? value(inner)
                                              : inner.fallback);
        return all;
    }

    KeyValue value(const Key& key) {
        switch (key.type) {
            case KeyType::Truth:
                return chance(0.5);
            case KeyType::Integer:
                if (!key.other_word.empty() && chance(0.25)) return key.other_word;
                return whole_number(key);
            case KeyType::Number:
                return number(key);
            case KeyType::Text:
                return text(key);
            case KeyType::Word:
                return key.choices[index(key.choices.size())];
            case KeyType::Point:
                return point(key);
            case KeyType::Pair:
                if (key.path == "shot.frames") return frames(key);
                return std::vector<std::int64_t>{whole_number(key), whole_number(key)};
            case KeyType::Words:
                return words(key);
            case KeyType::Entries:
                return entries(key);
            case KeyType::DataFile:
                return std::string(key.path == kCageFile ? kCageName : kBuoyName);
            case KeyType::DataTime:
                return std::string(kBuoyTime);
        }
        throw std::logic_error(key.path + " is of no type");
    }

  private:
    std::string text(const Key& key) {
        if (key.path == "light.sky")
            return chance(kPictureOfSky) ? kSkyName : std::get<std::string>(key.fallback);
        if (key.path == "waves.masks[].picture") return kMaskName;
        if (key.is_picture) return chance(0.5) ? kFoamName : std::get<std::string>(key.fallback);
        if (key.path == "shot.name") {
            constexpr std::string_view kLetters =
                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
            std::string name(static_cast<std::size_t>(log_uniform(1.0, limits::kNameLength)), 'a');
            for (char& letter : name) letter = kLetters[index(kLetters.size())];
            return name;
        }
        if (key.path == "objects[].file") return kBodyName;
        if (key.path == "objects[].name") {
            std::string name(16, 'a');
            for (char& letter : name) letter = static_cast<char>('a' + index(26));
            return name;
        }
        if (key.path == "objects[].path" && chance(0.5)) return {};
        if (key.name == "path") {  // up to 50 m between keys
            std::string path;
            double frame = integer(-60, 20), east_m = uniform(-60.0, 60.0), north_m = uniform(-60.0, 60.0);
            for (int keys = integer(2, 5); keys > 0; --keys) {
                path += (path.empty() ? "" : ", ") + std::to_string(frame) + ' ' + std::to_string(east_m) +
                        ' ' + std::to_string(north_m);
                frame += uniform(1.0, 100.0);
                east_m += chance(0.2) ? 0.0 : uniform(-35.0, 35.0);
                north_m += chance(0.2) ? 0.0 : uniform(-35.0, 35.0);
            }
            return path;
        }
        throw std::logic_error(key.path + " is a text: say in random_scene.cpp what to draw of it");
    }

    std::vector<double> point(const Key& key) {
        if (key.unit.empty()) return {number(key), number(key), number(key)};  // a colour
        // Near the origin, where most cameras are, or anywhere; above the sea more often than below.
        const bool is_near = chance(0.6);
        std::vector<double> place;
        for (int axis = 0; axis < 3; ++axis)
            place.push_back(is_near       ? uniform(-60.0, 60.0)
                            : chance(0.1) ? number(key)
                                          : anywhere(*key.range));
        if (is_near) place[2] = log_uniform(0.01, 1e3);
        if (chance(0.8)) place[2] = std::abs(place[2]);
        return place;
    }

    std::vector<std::int64_t> frames(const Key& key) {
        const double most = cap(kFramesAfterTheFirst).high;
        const std::int64_t first = chance(0.5) ? integer(-2, 30) : std::llround(anywhere(*key.range));
        const std::int64_t last = first + std::llround(uniform(0.0, most));
        return {first, std::min(last, static_cast<std::int64_t>(key.range->high))};
    }

    std::mt19937_64 engine_;
};

// ---- Files

// A few faces of any size and slope, triangles among them, in one piece or two, with any sharpness, holes, rule for the
// boundary and texture.
std::string random_cage(Draw& draw) {
    std::ostringstream obj;
    obj.precision(9);
    const int wide = draw.integer(2, 5), high = draw.integer(2, 5);
    const double size = draw.chance(0.05) ? 0.0 : draw.log_uniform(1e-3, 2e5);
    const double at = draw.chance(0.7) ? 0.0 : draw.log_uniform(1.0, 1e5);
    const bool is_flat = draw.chance(0.3);
    for (int y = 0; y < high; ++y)
        for (int x = 0; x < wide; ++x)
            obj << "v " << at + size * (x + 0.3 * draw.uniform(-1.0, 1.0)) << ' ' << size * y << ' '
                << (is_flat ? 0.0 : size * draw.uniform(-2.0, 2.0)) << '\n';
    const int points = wide * high;
    const bool has_texture = draw.chance(0.4), has_seams = draw.chance(0.5);
    if (has_texture)
        for (int i = 0; i < (has_seams ? 2 : 1) * points; ++i)
            obj << "vt " << draw.uniform(-3.0, 3.0) << ' ' << draw.uniform(0.0, 1.0) << '\n';
    int faces = 0;
    for (int y = 0; y + 1 < high; ++y)
        for (int x = 0; x + 1 < wide; ++x) {
            if (faces > 0 && draw.chance(0.1)) continue;
            const int first = x + y * wide + 1;
            const int corners[] = {first, first + 1, first + 1 + wide, first + wide};
            const int seam = has_seams && x > 0 ? points : 0;
            const auto face = [&](std::initializer_list<int> of) {
                obj << 'f';
                for (const int k : of) {
                    obj << ' ' << corners[k];
                    if (has_texture) obj << '/' << corners[k] + seam;
                }
                obj << '\n';
                ++faces;
            };
            if (draw.chance(0.8)) {
                face({0, 1, 2, 3});
            } else {
                face({0, 1, 2});
                face({0, 2, 3});
            }
        }
    if (draw.chance(0.5))
        obj << "t crease 2/1/0 0 1 " << (draw.chance(0.3) ? 10.0 : draw.uniform(0.0, 12.0)) << '\n';
    if (draw.chance(0.3)) obj << "t corner 1/1/0 1 " << draw.uniform(0.0, 12.0) << '\n';
    if (faces > 1 && draw.chance(0.2)) obj << "t hole 1/0/0 " << draw.integer(0, faces - 1) << '\n';
    if (draw.chance(0.5)) obj << "t interpolateboundary 1/0/0 " << draw.pick({0, 1, 1, 2, 2}) << '\n';
    return obj.str();
}

// A picture of a sky of any brightness and few pixels, some of them black, with or without a sun.
std::string random_sky(Draw& draw) {
    const int height = draw.integer(1, 8), width = draw.chance(0.8) ? 2 * height : draw.integer(1, 16);
    const double brightness = draw.log_uniform(1e-6, 1e6);
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::array<std::vector<float>, 3> colours;
    for (std::size_t i = 0; i < pixels; ++i) {
        const double grey = draw.chance(0.1) ? 0.0 : brightness * draw.uniform(0.5, 1.5);
        for (std::vector<float>& colour : colours)
            colour.push_back(static_cast<float>(grey * draw.uniform(0.5, 1.0)));
    }
    if (draw.chance(0.5)) {
        const std::size_t sun = draw.index(pixels);
        const double light = brightness * draw.log_uniform(1.0, 1e5);
        for (std::vector<float>& colour : colours) colour[sun] = static_cast<float>(light);
    }
    exr::Image image{.width = width, .height = height, .channels = {}};
    for (std::size_t c = 0; c < 3; ++c)
        image.channels.push_back({.name = std::string(1, "RGB"[c]), .data = colours[c].data()});
    return exr::encode_scanline({}, image);
}

// A picture of foam, much of it of one brightness.
std::string random_foam(Draw& draw) {
    const int side = 1 << draw.integer(4, 6);
    const double black = draw.uniform(0.0, 0.95), brightness = draw.log_uniform(1e-6, 1e4);
    std::vector<float> texels;
    for (int i = 0; i < side * side; ++i)
        texels.push_back(draw.chance(black) ? 0.0f : static_cast<float>(brightness * draw.uniform(0.0, 1.0)));
    return exr::encode_scanline(
        {}, {.width = side, .height = side, .channels = {{.name = "Y", .data = texels.data()}}});
}

// A picture of where a mask holds.
std::string random_mask(Draw& draw) {
    const int width = draw.integer(2, 32), height = draw.integer(2, 32);
    std::vector<float> texels;
    for (int i = 0; i < width * height; ++i)
        texels.push_back(static_cast<float>(draw.chance(0.3) ? draw.integer(0, 1) : draw.uniform(0.0, 1.0)));
    return exr::encode_scanline(
        {}, {.width = width, .height = height, .channels = {{.name = "Y", .data = texels.data()}}});
}

// An hour of a buoy that measures a few frequencies, some of them without directions or missing.
std::map<std::string, std::string> random_buoy(Draw& draw) {
    const int count = draw.integer(2, 12);
    std::vector<double> frequencies_hz;
    const bool is_usual = draw.chance(0.7);
    for (int i = 0; i < count; ++i)
        frequencies_hz.push_back(is_usual ? draw.uniform(0.02, 0.5) : draw.log_uniform(1e-4, 100.0));
    std::sort(frequencies_hz.begin(), frequencies_hz.end());
    std::map<std::string, std::string> files;
    for (const char letter : std::string("wdijk")) {
        std::ostringstream file;
        file << "#YY  MM DD hh mm";
        for (const double frequency : frequencies_hz) file << ' ' << frequency;
        file << "\n2024 10 03 06 00";
        for (int i = 0; i < count; ++i) {
            file << ' ';
            if (draw.chance(0.1))
                file << "999";
            else if (letter == 'w')
                file << (draw.chance(0.2) ? 0.0 : draw.log_uniform(1e-6, 50.0));
            else
                file << draw.integer(0, letter == 'd' || letter == 'i' ? 360 : 100);
        }
        std::string name = kBuoyName;
        name[name.find('w')] = letter;
        files[name] = file.str() + '\n';
    }
    return files;
}

// ---- What keys mean together

class Drawing {
  public:
    explicit Drawing(std::uint64_t seed) : draw_(seed), light_(~(seed / kScenesALight)) { made_.seed = seed; }

    RandomScene made() {
        constexpr double kUnfit = 0.06;
        // Few keys, or most of them.
        const double each = draw_.uniform(0.1, 0.7), of_light = 0.5;
        for (const Key& key : keys()) {
            if (key.path == kCameraFile) continue;  // says what keys say
            const bool is_data = key.type == KeyType::DataFile || key.type == KeyType::DataTime;
            Draw& draw = key.path.starts_with("light.") ? light_ : draw_;
            if (draw.chance(is_data                                          ? 0.1
                            : costs_too_much(key) || key.path == "light.sky" ? 1.0
                            : is_budget(key)                                 ? 0.1
                            : &draw == &light_                               ? of_light
                                                                             : each))
                give(key, draw.value(key));
        }
        const bool is_fit = !draw_.chance(kUnfit);
        if (is_fit)
            fit();
        else if (made_.value(kCageFile))
            add_cage();
        if (!afford() && is_fit) mend();
        if (made_.value(kSpectrumFile))
            for (auto& [name, bytes] : random_buoy(draw_)) made_.files[name] = std::move(bytes);
        if (made_.value(kObjectsKey)) made_.files[kBodyName] = kBody;
        if (is("light.sky", std::string(kSkyName))) made_.files[kSkyName] = random_sky(light_);
        for (const char* key : {"effects.foam_pattern", "sea.depth_file", "water.floor_pattern"})
            if (is(key, std::string(kFoamName))) made_.files[kFoamName] = random_foam(light_);
        if (made_.text().find(kMaskName) != std::string::npos) made_.files[kMaskName] = random_mask(light_);
        return std::move(made_);
    }

  private:
    static bool is_budget(const Key& key) {
        return key.path == "quality.max_error" || key.path == "quality.frame_ms";
    }
    void give(const Key& key, KeyValue value) {
        const auto at = std::find_if(made_.keys.begin(), made_.keys.end(),
                                     [&](const GivenKey& given) { return given.key >= &key; });
        if (at != made_.keys.end() && at->key == &key)
            at->value = std::move(value);
        else
            made_.keys.insert(at, {&key, std::move(value)});
    }
    void give(std::string_view path, KeyValue value) { give(key_of(path), std::move(value)); }
    void leave_out(std::string_view path) {
        std::erase_if(made_.keys, [&](const GivenKey& given) { return given.key->path == path; });
    }
    bool is(std::string_view path, const KeyValue& value) const {
        const KeyValue* given = made_.value(path);
        return given ? *given == value : key_of(path).fallback == value;
    }
    double number(std::string_view path) const {
        const KeyValue* given = made_.value(path);
        const KeyValue& value = given ? *given : key_of(path).fallback;
        if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
        return std::get<double>(value);
    }
    template <class V>
    V* list(std::string_view path) {
        for (GivenKey& given : made_.keys)
            if (given.key->path == path) return std::get_if<V>(&given.value);
        return nullptr;
    }
    void add_cage() {
        if (!made_.files.contains(kCageName)) made_.files[kCageName] = random_cage(draw_);
    }

    // Bodies go with a vessel that is there, or by a path of their own.
    void fit_objects() {
        const auto* vessels = list<std::vector<KeyEntry>>("waves.vessels");
        auto* objects = list<std::vector<KeyEntry>>("objects");
        if (!objects) return;
        for (KeyEntry& entry : *objects) {
            const auto of = [&](std::string_view name) -> KeyValue& {
                return std::ranges::find(entry.values, name, &std::pair<std::string_view, KeyValue>::first)
                    ->second;
            };
            if (!vessels || vessels->empty())
                of("vessel") = std::int64_t{0};
            else if (std::get<std::int64_t>(of("vessel")) != 0)
                of("path") = std::string();
        }
    }

    void fit() {
        fit_data();
        fit_loop();
        fit_cascades();
        fit_trains();
        if (number("shot.loop_s") > 0.0 || number("shot.time_scale") == 0.0 ||
            is("waves.model", std::string("trochoid")))
            leave_out("waves.vessels");
        fit_objects();
        fit_camera();
        fit_output();
        // Where all of a sea breaks that gains have raised tenfold, its drops take a minute a frame.
        if (made_.value("waves.band_gains"))
            for (const char* key : {"effects.spray_drops", "output.drops"}) leave_out(key);
        for (const Key& key : keys())
            if (!key.of_picture.empty()) {
                const KeyValue* picture = made_.value(key.of_picture);
                if (!picture || *picture == key_of(key.of_picture).fallback) leave_out(key.path);
            }
        if (const KeyValue* type = made_.value("water.type");
            type && std::get<std::string>(*type).starts_with("jerlov"))
            leave_out("water.chlorophyll_mg_m3");
        mend();
    }

    void fit_data() {
        const auto fit_file = [&](std::string_view file, std::string_view kind, const char* word) {
            if (made_.value(file))
                give(kind, std::string(word));
            else if (is(kind, std::string(word)))
                give(file, draw_.value(key_of(file)));
        };
        fit_file(kCageFile, "surface.kind", "cage");
        fit_file(kSpectrumFile, "sea.spectrum", "file");
        if (made_.value(kSpectrumFile))
            give("sea.spectrum_time", std::string(kBuoyTime));
        else
            leave_out("sea.spectrum_time");
        if (made_.value(kCageFile)) add_cage();
    }

    // A whole number of frames, where that is within the range.
    void fit_loop() {
        const double loop_s = number("shot.loop_s"), fps = number("shot.fps");
        if (loop_s > 0.0)
            give("shot.loop_s",
                 std::min(std::max(1.0, std::round(loop_s * fps)) / fps, limits::kLoop_s.high));
    }

    // Each as much smaller than the one before as its grid allows.
    void fit_cascades() {
        const bool has_trains = is("waves.model", std::string("trochoid"));
        constexpr std::string_view kPath = "waves.cascades";
        if (!made_.value(kPath) && !has_trains && draw_.chance(0.85)) give(kPath, draw_.value(key_of(kPath)));
        auto* cascades = list<std::vector<KeyEntry>>(kPath);
        if (!cascades) return;
        double largest_m = 0.0;
        for (std::size_t i = 0; i < cascades->size(); ++i) {
            double& size_m = std::get<double>((*cascades)[i].values[0].second);
            auto& resolution = std::get<std::int64_t>((*cascades)[i].values[1].second);
            if (has_trains) (*cascades)[i].values[2].second = KeyValue();  // a choppiness of its own
            const bool is_last = i + 1 == cascades->size();
            resolution = std::max<std::int64_t>(resolution, is_last ? 16 : 32) / 2 * 2;
            if (i > 0) {
                const auto above =
                    static_cast<double>(std::get<std::int64_t>((*cascades)[i - 1].values[1].second));
                // kBandModes periods of this tile, of the modes that the one above has.
                size_m = largest_m / draw_.uniform(1.05, (0.5 * above - 3.0) / kBandModes);
            }
            largest_m = size_m;
        }
        std::erase_if(*cascades, [](const KeyEntry& cascade) {
            return std::get<double>(cascade.values[0].second) < limits::kCascadeSize_m.low;
        });
    }

    // Without what it refuses.
    void fit_coast(std::initializer_list<const char*> refused) {
        if (!is("waves.coast", true)) return;
        if (!is("sea.depth_file", std::string(kFoamName))) return leave_out("waves.coast");
        for (const char* path : refused) leave_out(path);
    }

    void fit_trains() {
        if (!is("waves.model", std::string("trochoid"))) {
            fit_coast({"waves.heroes", "output.cascade_tiles"});
            for (const char* path : {"waves.trains", "waves.shortest_m", "waves.longest_m"}) leave_out(path);
            return;
        }
        fit_coast({"waves.cascades", "waves.heroes"});
        const auto* cascades = list<std::vector<KeyEntry>>("waves.cascades");
        if (cascades && !cascades->empty() && made_.value("waves.shortest_m")) {
            const auto& first = cascades->front().values;
            const auto& last = cascades->back().values;
            const double finest_m = 2.0 * std::get<double>(last[0].second) /
                                    static_cast<double>(std::get<std::int64_t>(last[1].second));
            const double coarsest_m = std::get<double>(first[0].second) / kBandModes;
            if (1.01 * finest_m < coarsest_m)
                give("waves.shortest_m", draw_.log_uniform(1.01 * finest_m, coarsest_m));
            else
                leave_out("waves.shortest_m");
        }
    }

    // Keys about the frames that are shown; most cameras look at what is before them.
    void fit_camera() {
        const auto look = [&](const std::vector<double>& from, std::vector<double>& at) {
            if (!draw_.chance(0.6)) return;
            const double far = draw_.log_uniform(1e-2, 1e4);
            at = {from[0] + far * draw_.uniform(-1.0, 1.0), from[1] + far * draw_.uniform(-1.0, 1.0),
                  from[2] + far * draw_.uniform(-1.0, 0.3)};
            for (double& place : at)
                place = std::clamp(place, limits::kCameraCoordinate_m.low, limits::kCameraCoordinate_m.high);
        };
        if (const auto* from = list<std::vector<double>>("camera.position_m")) {
            std::vector<double> at{0.0, 0.0, 0.0};
            if (const auto* given = list<std::vector<double>>("camera.look_at_m")) at = *given;
            const std::vector<double> before = at;
            look(*from, at);
            if (at != before) give("camera.look_at_m", at);
        }
        auto* poses = list<std::vector<KeyEntry>>("camera.keys");
        if (!poses) return;
        const KeyValue* frames = made_.value("shot.frames");
        const std::int64_t first = frames ? std::get<std::vector<std::int64_t>>(*frames)[0] : 1;
        std::vector<std::int64_t> at;
        for (KeyEntry& pose : *poses) {
            if (draw_.chance(0.7)) pose.values[0].second = first + draw_.integer(-2, 3);
            at.push_back(std::get<std::int64_t>(pose.values[0].second));
            look(std::get<std::vector<double>>(pose.values[1].second),
                 std::get<std::vector<double>>(pose.values[2].second));
        }
        std::sort(at.begin(), at.end());
        for (std::size_t i = 0; i < at.size(); ++i) (*poses)[i].values[0].second = at[i];
    }

    void fit_output() {
        if (const KeyValue* drops = made_.value("output.drops"); drops && std::get<bool>(*drops)) {
            for (const char* needed : {"effects.spray_drops", "effects.spray", "effects.whitecaps"})
                give(needed, true);
            give("effects.spray_law", std::string("andreas-1998"));
            if (draw_.chance(0.95))
                give("surface.size_m", std::min(number("surface.size_m"), cap(kDropsSide_m).high));
        }
        const auto* volumes = list<std::vector<std::string>>("output.volumes");
        if (!volumes || volumes->empty()) return;
        if (std::find(volumes->begin(), volumes->end(), "spray") != volumes->end()) {
            give("effects.spray", true);
            give("effects.whitecaps", true);
        }
        fit_voxels();
    }
    void fit_voxels() {
        const double size_m = number("surface.size_m");
        give("output.voxel_m",
             std::clamp(size_m / draw_.log_uniform(cap(kVoxelsASide).low, cap(kVoxelsASide).high),
                        limits::kVoxel_m.low, limits::kVoxel_m.high));
    }

    // Draws again what is refused, and leaves it out where that doesn't help.
    void mend() {
        std::map<std::string, int> tries;
        for (int round = 0; round < 200; ++round) {
            const std::optional<Scene> scene = made_.scene();
            if (!scene) return;  // its cage is refused
            const std::vector<Problem> problems = problems_of(*scene);
            if (problems.empty()) return;
            mend(problems.front().key, ++tries[problems.front().key]);
        }
        throw std::logic_error("a random scene that can't be mended:\n" + made_.text());
    }
    // path: "sea.swell[1].height_m", "waves.cascades[0].size_m".
    void mend(const std::string& path, int tries) {
        constexpr int kTries = 3;
        const std::size_t bracket = path.find('['), dot = path.find('.', std::min(bracket, path.size()));
        const auto given = std::find_if(made_.keys.begin(), made_.keys.end(), [&](const GivenKey& each) {
            return each.key->path == path.substr(0, bracket);
        });
        if (given == made_.keys.end()) {
            // A default that doesn't go with others: one of those has to go.
            made_.keys.erase(made_.keys.begin() +
                             static_cast<std::ptrdiff_t>(draw_.index(made_.keys.size())));
            return;
        }
        const Key& key = *given->key;
        auto* entries = std::get_if<std::vector<KeyEntry>>(&given->value);
        if (entries && bracket != std::string::npos) {
            const std::size_t entry = std::stoul(path.substr(bracket + 1));
            const auto inner =
                std::find_if(key.entry_keys.begin(), key.entry_keys.end(), [&](const Key& each) {
                    return dot != std::string::npos && each.name == path.substr(dot + 1);
                });
            if (tries < kTries && inner != key.entry_keys.end())
                (*entries)[entry].values[static_cast<std::size_t>(inner - key.entry_keys.begin())].second =
                    draw_.value(*inner);
            else
                entries->erase(entries->begin() + static_cast<std::ptrdiff_t>(entry));
            return;
        }
        const bool is_data = key.type == KeyType::DataFile || key.type == KeyType::DataTime;
        if (tries < kTries && !is_data)
            give(key, draw_.value(key));
        else
            leave_out(std::string(key.path));
        if (key.path == "surface.kind" || key.path == "sea.spectrum") fit_data();
    }

    // Where automatic cascades would cost too much, others; and fewer voxels. Whether nothing was changed.
    bool afford() {
        bool was_cheap = true;
        if (const auto* volumes = list<std::vector<std::string>>("output.volumes");
            volumes && !volumes->empty() &&
            number("surface.size_m") / number("output.voxel_m") > cap(kVoxelsASide).high) {
            fit_voxels();
            was_cheap = false;
        }
        if (is_affordable(made_)) return was_cheap;
        give("waves.cascades", std::vector<KeyEntry>(1));
        auto& entry = list<std::vector<KeyEntry>>("waves.cascades")->front();
        for (const Key& inner : key_of("waves.cascades").entry_keys)
            entry.values.emplace_back(inner.name, draw_.value(inner));
        fit_cascades();
        return false;
    }

    Draw draw_, light_;
    RandomScene made_;
};

}  // namespace

std::span<const Cap> caps() {
    return kCaps;
}

Range drawn_range(const Key& key) {
    Range range = *key.range;
    for (const Cap& each : kCaps)
        if (each.what == key.path)
            range = {std::max(range.low, each.range.low), std::min(range.high, each.range.high)};
    return range;
}

bool costs_too_much(const Key& key) {
    if (key.path == "shot.frames") return true;
    if (!key.range) return false;
    const Range range = drawn_range(key);
    const auto is_outside = [&](double value) { return !range.holds(value) && key.range->holds(value); };
    if (const auto* integer = std::get_if<std::int64_t>(&key.fallback))
        return is_outside(static_cast<double>(*integer));
    if (const auto* number = std::get_if<double>(&key.fallback)) return is_outside(*number);
    const auto* pair = std::get_if<std::vector<std::int64_t>>(&key.fallback);
    return pair && is_outside(static_cast<double>(pair->front()));
}

bool is_affordable(const RandomScene& random) {
    std::optional<Scene> scene = random.scene();
    if (!scene || !problems_of(*scene).empty()) return true;  // refused
    if (!scene->output.volumes.empty() &&
        scene->surface.size_m / scene->output.voxel_m > 1.001 * cap(kVoxelsASide).high)
        return false;
    if (!scene->waves.cascades.empty() || scene->waves.model == WaveModel::Trochoid) return true;
    scene->waves.coast = false;  // its depths aren't read, and cost next to nothing
    scene = settle(*scene, Purpose::Mesh, with_rates(recorded_rates())).scene;
    const int frame = scene->shot.first_frame;
    const std::size_t bytes =
        std::max(plan_bake(*scene).frame_bytes(), picture_plan(*scene, std::span(&frame, 1)).frame_bytes());
    return static_cast<double>(bytes) <= cap(kAutomaticBytes).high;
}

const KeyValue* RandomScene::value(std::string_view path) const {
    for (const GivenKey& given : keys)
        if (given.key->path == path) return &given.value;
    return nullptr;
}

std::string RandomScene::text() const {
    std::string out;
    for (const KeyTable& table : key_tables()) {
        std::string inside;
        for (const GivenKey& given : keys)
            if (given.key >= table.keys.data() && given.key < table.keys.data() + table.keys.size())
                if (const std::string value = value_text(*given.key, given.value); !value.empty())
                    inside += given.key->name + " = " + value + '\n';
        if (table.is_list())
            out = inside + out;  // before all tables
        else if (!inside.empty())
            out += '[' + table.name + "]\n" + inside;
    }
    return out;
}

void RandomScene::forget_unnamed_files() {
    const std::string shot = text();
    const bool has_buoy = shot.find(kBuoyName) != std::string::npos;
    std::erase_if(files, [&](const auto& file) {
        const bool is_of_buoy = file.first.ends_with(".txt");
        return is_of_buoy ? !has_buoy : shot.find(file.first) == std::string::npos;
    });
}

std::filesystem::path RandomScene::write(const std::filesystem::path& folder) const {
    std::filesystem::create_directories(folder);
    const auto put = [&](const std::string& name, const std::string& bytes) {
        std::ofstream(folder / name, std::ios::binary) << bytes;
        return folder / name;
    };
    for (const auto& [name, bytes] : files) put(name, bytes);
    return put("shot.toml", text());
}

std::optional<Scene> RandomScene::scene() const {
    Scene scene;
    for (const auto& [key, value] : keys) {
        if (key->type == KeyType::DataFile) {
            if (key->path == kCageFile) {
                try {
                    scene.surface.cage =
                        std::make_shared<const Cage>(parse_obj(files.at(kCageName), kCageName));
                } catch (const ObjError&) {
                    return std::nullopt;
                }
            } else {
                const MeasuredSpectrum::Bin bin{0.1, 1.0, 0.5, 0.0, 0.2, 0.0, true};
                scene.sea.measured = MeasuredSpectrum{{bin, bin}, "99001", kBuoyTime};
                scene.sea.measured->bins[1].frequency_hz = 0.2;
            }
        } else if (key->type != KeyType::DataTime) {
            if (const std::optional<Problem> problem = set_value(scene, *key, value))
                throw std::logic_error("a random scene's " + text_of(*problem));
            if (key->path == "waves.masks")
                scene.waves.mask_pictures[kMaskName] =
                    std::make_shared<const MaskPicture>(2, 2, std::vector<float>{0.0f, 1.0f, 1.0f, 0.5f});
        }
    }
    // One for all scenes: a mesh keeps its hull, which takes a tenth of a second.
    static const auto body = std::make_shared<const ObjectMesh>(
        parse_object_obj(kBody, kBodyName, [](const std::string&) { return std::nullopt; }, {}));
    for (SceneObject& object : scene.objects) object.mesh = body;
    return scene;
}

RandomScene random_scene(std::uint64_t seed) {
    return Drawing(seed).made();
}

}  // namespace pelagic::test
