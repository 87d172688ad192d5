#include "plugin/light/light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "core/base/constants.h"
#include "core/lighting/air.h"
#include "core/lighting/lighting.h"
#include "core/lighting/primaries.h"
#include "core/plan/fingerprint.h"
#include "core/plan/foam.h"
#include "core/scene/canonical.h"
#include "core/scene/keys.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/scene/validate.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/possible.h"
#include "core/spectrum/spectral_moments.h"
#include "core/spectrum/viscous_cutoff.h"
#include "core/waves/whitecaps.h"
#include "plugin/format/exr/read.h"
#include "plugin/format/shot/floor_mesh.h"

namespace pelagic {
namespace {

constexpr float kLeastDepth_m = 0.01f;  // of a floor that is lit: on land there is a film of water

// What each type of water holds. Jerlov's: fitted through Lee's K_d (2005) to the K_d of his tables (1976), rms of its logarithm 0.05 … 0.18;
// that hardly fixes how much they scatter.
WaterChoice choice_of(const Water& water) {
    const double c = water.chlorophyll_mg_m3;
    switch (water.type) {
        case WaterType::Ocean:
            return {c};
        case WaterType::Coastal:
            return {c, 0.1, 0.7};
        case WaterType::Turbid:
            return {c, 0.5, 6.0};
        case WaterType::JerlovI:
            return {0.01};
        case WaterType::JerlovIA:
            return {0.01, 0.007};
        case WaterType::JerlovIB:
            return {0.01, 0.015};
        case WaterType::JerlovII:
            return {0.2, 0.025};
        case WaterType::JerlovIII:
            return {1.0, 0.042};
        case WaterType::Jerlov1C:
            return {0.01, 0.205, 0.17};
        case WaterType::Jerlov3C:
            return {0.01, 0.27, 1.2};
        case WaterType::Jerlov5C:
            return {0.3, 0.35, 2.3};
        case WaterType::Jerlov7C:
            return {1.0, 0.45, 4.3};
        case WaterType::Jerlov9C:
            return {10.0, 0.76, 4.3};
    }
    throw std::invalid_argument("water of no type");
}

exr::Chromaticities chromaticities(const Primaries& of) {
    const auto xy = [](glm::dvec2 c) { return std::array{static_cast<float>(c.x), static_cast<float>(c.y)}; };
    return {.red = xy(of.red), .green = xy(of.green), .blue = xy(of.blue), .white = xy(of.white)};
}

bool is_in_kcd_m2(const Scene& scene) {
    return !has_sky_picture(scene);
}

// `problem` may have names from the file in it.
Problem sky_problem(const Scene& scene, const std::string& problem, const std::string& accepted) {
    return {"light.sky", quoted_text(scene.light.sky), line_text(problem), accepted};
}
Problem foam_problem(const Scene& scene, const std::string& problem) {
    return {"effects.foam_pattern", quoted_text(scene.effects.foam_pattern), line_text(problem),
            "a picture in OpenEXR, square, with a side of 16, 32 ... 4096 pixels, not all of one brightness"};
}

constexpr int kMostDepths = 2048, kMostColours = 1024;  // a side

// What is wrong with a picture of the floor, as far as can be said without its pixels.
std::vector<Problem> check_floor_picture(const Scene& scene, const Key& key) {
    const std::string path = std::get<std::string>(value_of(scene, key));
    const bool is_depths = key.path == "sea.depth_file";
    const auto problem = [&](const std::string& text, const std::string& accepted) {
        return std::vector{Problem{key.path, quoted_text(path), line_text(text), accepted}};
    };
    try {
        if (is_depths && is_floor_mesh(path)) {
            depths_of(read_floor_mesh(path).mesh(), 0.0, 0.0);
            return {};
        }
        const exr::RgbFile file(path);
        const int width = file.width(), height = file.height();
        const bool is_good = is_depths
                                 ? std::max(width, height) <= kMostDepths
                                 : width == height && width <= kMostColours && (width & (width - 1)) == 0;
        if (is_good) return {};
        return problem("has " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                       is_depths ? "a picture of up to 2048 pixels a side"
                                 : "a square picture with a side of 1, 2 ... 1024 pixels");
    } catch (const exr::ReadError& error) {
        return problem(error.problem(), error.accepted());
    } catch (const FloorMeshError& error) {
        return problem(error.what(), error.accepted());
    }
}

// The keys of pictures of the floor that the scene names.
std::vector<const Key*> floor_keys(const Scene& scene) {
    std::vector<const Key*> named = picture_keys(scene);
    std::erase_if(named, [](const Key* key) {
        return key->path != "sea.depth_file" && key->path != "water.floor_pattern";
    });
    return named;
}

bool has_foam_picture(const Scene& scene) {
    return scene.effects.foam_pattern != Effects{}.foam_pattern;
}

std::vector<Problem> check_foam_picture(const Scene& scene) {
    if (!has_foam_picture(scene)) return {};
    try {
        const exr::RgbFile file(scene.effects.foam_pattern);
        if (file.width() != file.height())
            return {foam_problem(scene, "has " + std::to_string(file.width()) + " x " +
                                            std::to_string(file.height()) + " pixels")};
        check_foam_image_side(file.width());
        return {};
    } catch (const exr::ReadError& error) {
        return {foam_problem(scene, error.problem())};
    } catch (const std::invalid_argument& error) {
        return {foam_problem(scene, error.what())};
    }
}

// A hash of the file's bytes.
std::string content_of(const std::string& path, const Problem& unreadable) {
    Fingerprint hash;
    std::ifstream stream(path, std::ios::binary);
    std::string piece(std::size_t{1} << 20, '\0');
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0)
        hash.add(std::string_view(piece).substr(0, static_cast<std::size_t>(stream.gcount())));
    if (!stream.eof()) throw std::invalid_argument(text_of(unreadable));
    return hash.text();
}

}  // namespace

bool has_sky_picture(const Scene& scene) {
    return scene.light.sky != Light{}.sky;
}

Daylight daylight_of(const Light& light) {
    return {.sun_elevation_deg = light.sun_elevation_deg,
            .sun_azimuth_deg = light.sun_azimuth_deg,
            .turbidity = light.turbidity};
}

Sky make_sky(const Scene& scene) {
    refuse_keys(scene, "light");
    const Light& light = scene.light;
    if (!has_sky_picture(scene)) return daylight_sky(daylight_of(light));
    try {
        const exr::RgbFile file(light.sky);
        LatLongRows rows{.width = file.width(),
                         .height = file.height(),
                         .rows_in_piece = file.rows_in_piece(),
                         .rotation_rad = std::remainder(light.sky_rotation_deg, 360.0) * kPi / 180.0,
                         .read = [&](int first_row, std::span<glm::vec3> radiance) {
                             file.read(first_row, {&radiance.data()->x, 3 * radiance.size()});
                             for (glm::vec3& value : radiance) value *= static_cast<float>(light.sky_gain);
                         }};
        Sky sky = picture_sky(rows);
        if (light.visibility_km) sky.air = picture_air(sky.map, 1e3 * *light.visibility_km);
        return sky;
    } catch (const exr::ReadError& error) {
        throw std::invalid_argument(text_of(sky_problem(scene, error.problem(), error.accepted())));
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument("light.sky = " + quoted_text(light.sky) + ": " + error.what());
    }
}

std::vector<Problem> check_sky(const Scene& scene) {
    if (!has_sky_picture(scene)) return {};
    try {
        const exr::RgbFile looked_at(scene.light.sky);
        return {};
    } catch (const exr::ReadError& error) {
        return {sky_problem(scene, error.problem(), error.accepted())};
    }
}

std::vector<Problem> check_scene(const Scene& scene) {
    std::vector<Problem> problems = check_sky(scene);
    for (Problem& problem : check_foam_picture(scene)) problems.push_back(std::move(problem));
    for (const Key* key : floor_keys(scene))
        for (Problem& problem : check_floor_picture(scene, *key)) problems.push_back(std::move(problem));
    if (!validate(scene).empty()) return problems;
    for (Problem& problem : impossible_waves(scene)) problems.push_back(std::move(problem));
    return problems;
}

std::string sky_content(const Scene& scene) {
    for (const Problem& problem : check_sky(scene)) throw std::invalid_argument(text_of(problem));
    if (!has_sky_picture(scene)) return {};
    return content_of(scene.light.sky, sky_problem(scene, "can't be read", "a lat-long picture in OpenEXR"));
}

std::string picture_content(const Scene& scene) {
    std::string content = sky_content(scene);
    for (const Problem& problem : check_foam_picture(scene)) throw std::invalid_argument(text_of(problem));
    if (has_foam_picture(scene))
        content += content_of(scene.effects.foam_pattern, foam_problem(scene, "can't be read"));
    for (const Key* key : floor_keys(scene)) {
        for (const Problem& problem : check_floor_picture(scene, *key))
            throw std::invalid_argument(text_of(problem));
        const std::string path = std::get<std::string>(value_of(scene, *key));
        content += content_of(path, {key->path, quoted_text(path), "can't be read", key->accepted});
    }
    return content;
}

Scene portable(Scene scene) {
    replace_pictures(scene, [](const Key&, const std::string& path) {
        return std::filesystem::path(path).filename().string();
    });
    return scene;
}

std::string radiance_unit(const Scene& scene, bool acescg) {
    const std::string primaries = acescg ? "ACEScg" : "linear Rec. 709";
    return is_in_kcd_m2(scene) ? "kcd/m2, " + primaries
           : acescg            ? "the sky picture's own, " + primaries
                               : "the sky picture's own, linear";
}

std::vector<exr::Attribute> radiance_attributes(const Scene& scene, bool acescg) {
    std::vector<exr::Attribute> attributes{{"unit", radiance_unit(scene, acescg)},
                                           {"chromaticities", chromaticities(acescg ? kAcesCg : kRec709)}};
    if (is_in_kcd_m2(scene)) attributes.push_back({"whiteLuminance", 1000.0f});  // [cd/m²]
    return attributes;
}

WaterBody make_water(const Scene& scene) {
    refuse_keys(scene, "water");
    refuse_keyed_sea(scene);
    if (!scene.water.body) return water_body(choice_of(scene.water));
    return make_water(scene, DirectionalSpectrum(scene.sea, scene.waves.band_gains));
}

WaterBody make_water(const Scene& scene, const DirectionalSpectrum& spectrum) {
    refuse_keys(scene, "water");
    WaterChoice choice = choice_of(scene.water);
    choice.has_body = scene.water.body;
    choice.floor_colour = scene.water.floor_colour;
    // Of a map of depths each place has its own; as one depth it is sea.depth_m, beyond sight.
    constexpr double kUnseen_m = 1e5;
    choice.floor_m = scene.sea.depth_file == SeaState{}.depth_file ? scene.sea.depth_m
                                                                   : std::min(scene.sea.depth_m, kUnseen_m);
    WaterBody water = water_body(choice);
    if (!water.has_body) return water;
    water.reflectance = body_reflectance(water);
    constexpr double kShortestCrest_m = 2.0 * kCrestFootprint_m;
    constexpr double kLeast = 1e-10;  // of variances: their density needs a determinant
    const SpectralMoments all = moments(spectrum, 0.0, kViscousWavenumber),
                          crests = moments(spectrum, 0.0, kTwoPi / kShortestCrest_m);
    const double xx = std::max(all.xx, kLeast), yy = std::max(all.yy, kLeast),
                 most = 0.9999 * std::sqrt(xx * yy);
    water.waves = glm::vec3(glm::dvec3(xx, yy, std::clamp(all.xy, -most, most)));
    water.crest_light = static_cast<float>(scene.water.crest_light);
    // Of a sine of the crests' height and slope.
    if (crests.m0 > 0.0) water.crest_per_m = static_cast<float>(std::sqrt(crests.mss() / crests.m0));
    water.bubbles = static_cast<float>(scene.water.bubbles);
    water.bubbles_m = static_cast<float>(bubbles_depth_m(scene, spectrum));
    return water;
}

std::size_t floor_bytes(const Scene& scene) {
    // A pixel as it is read and as a colour; then its depth, or its colour in all levels.
    constexpr std::size_t kPixel = 2 * sizeof(glm::vec3) + 2 * sizeof(glm::vec3);
    std::size_t bytes = 0;
    for (const Key* key : floor_keys(scene)) {
        if (!check_floor_picture(scene, *key).empty()) continue;
        const std::string path = std::get<std::string>(value_of(scene, *key));
        if (key->path == "sea.depth_file" && is_floor_mesh(path)) {
            // Its text, and points and corners as they are read, which take some three times as much; then a grid of depths, twice.
            constexpr std::size_t kOfText = 4, kTexels = std::size_t{kFloorMeshTexels} * kFloorMeshTexels;
            std::error_code gone;
            const std::uintmax_t size = std::filesystem::file_size(path, gone);
            if (!gone) bytes += kOfText * static_cast<std::size_t>(size) + 2 * kTexels * sizeof(float);
            continue;
        }
        const exr::RgbFile file(path);
        bytes += kPixel * static_cast<std::size_t>(file.width()) * static_cast<std::size_t>(file.height());
    }
    return bytes;
}

Floor make_floor(const Scene& scene, double rest_m) {
    const bool has_map = scene.sea.depth_file != SeaState{}.depth_file;
    const double beyond_m = std::min(scene.sea.depth_m, has_map ? kDeepestFloor_m : 1e9);
    Floor floor(beyond_m, rest_m);
    for (const Key* key : floor_keys(scene)) {
        const std::string path = std::get<std::string>(value_of(scene, *key));
        const auto refuse = [&](const std::string& problem, const std::string& accepted) {
            throw std::invalid_argument(
                text_of(Problem{key->path, quoted_text(path), line_text(problem), accepted}));
        };
        const bool is_mesh = key->path == "sea.depth_file" && is_floor_mesh(path);
        if (!is_mesh)
            for (const Problem& problem : check_floor_picture(scene, *key))
                throw std::invalid_argument(text_of(problem));
        try {
            if (is_mesh) {
                FloorDepths of = depths_of(read_floor_mesh(path).mesh(), rest_m, beyond_m);
                for (float& depth : of.depths_m) depth = std::max(depth, kLeastDepth_m);
                floor.set_depths(of.columns_rows, std::move(of.depths_m), of.from_m, of.size_m);
                continue;
            }
            exr::RgbPixels picture = exr::read_rgb(path);
            const auto width = static_cast<std::size_t>(picture.width),
                       height = static_cast<std::size_t>(picture.height);
            std::vector<glm::vec3> pixels;  // rows from the south
            pixels.reserve(width * height);
            for (std::size_t row = height; row-- > 0;)
                for (std::size_t x = 0; x < width; ++x) {
                    const auto& [red, green, blue] = picture.pixels[row * width + x];
                    pixels.emplace_back(red, green, blue);
                }
            if (key->path == "sea.depth_file") {
                std::vector<float> depths;
                depths.reserve(pixels.size());
                for (const glm::vec3& pixel : pixels) {
                    if (!std::isfinite(pixel.x)) refuse("has depths that are no numbers", "depths in metres");
                    depths.push_back(std::clamp(pixel.x, kLeastDepth_m, 1e5f));
                }
                const double size_m = scene.sea.depth_size_m;
                const glm::dvec2 size(size_m, size_m * picture.height / picture.width);
                floor.set_depths({picture.width, picture.height}, std::move(depths),
                                 glm::dvec2(scene.sea.depth_east_m, scene.sea.depth_north_m) - 0.5 * size,
                                 size);
            } else {
                for (const glm::vec3& pixel : pixels)
                    if (!std::isfinite(pixel.x + pixel.y + pixel.z) ||
                        std::min({pixel.x, pixel.y, pixel.z}) < 0.0f)
                        refuse("has colours that are negative or no numbers", "linear colours, 0 and more");
                floor.set_colours(picture.width, pixels, scene.water.floor_pattern_m);
            }
        } catch (const exr::ReadError& error) {
            refuse(error.problem(), error.accepted());
        } catch (const FloorMeshError& error) {
            refuse(error.what(), error.accepted());
        }
    }
    return floor;
}

WaterText water_text(const WaterBody& water) {
    if (!water.has_body) return {};
    const auto six = [](const auto& value_of) {
        std::string text;
        for (int i = 0; i < 6; ++i) {
            std::array<char, 32> number{};
            std::snprintf(number.data(), number.size(), "%.3g", value_of(i));
            text += (i > 0 ? ", " : "") + std::string(number.data());
        }
        return text;
    };
    const auto of = [](const WaterBands& bands, int i) {
        return static_cast<double>(i < 3 ? bands.shorter[i] : bands.longer[i - 3]);
    };
    const auto a = [&](int i) { return of(water.absorption, i); };
    const auto b = [&](int i) { return of(water.backscatter, i); };
    return {.wavelengths_nm = six([](int i) { return kWaterBands_nm[static_cast<std::size_t>(i)]; }),
            .absorption_per_m = six(a),
            .backscatter_per_m = six(b),
            .fading_per_m =
                six([&](int i) { return a(i) + 4.18 * (1.0 - 0.52 * std::exp(-10.8 * a(i))) * b(i); })};
}

std::string light_content(const Scene& scene) {
    return canonical(scene, key_parts(KeyPart::Light)) + scene.effects.foam_pattern;
}

bool same_sky(const Scene& a, const Scene& b) {
    const auto light = std::ranges::find(key_tables(), "light", &KeyTable::name);
    return std::ranges::all_of(light->keys,
                               [&](const Key& key) { return value_of(a, key) == value_of(b, key); });
}

double active_foam(const Scene& scene, double residual_coverage) {
    const double law = law_coverage(scene);
    return law > 0.0 ? std::clamp(1.0 - residual_coverage / law, 0.0, 1.0) : 1.0;
}

std::shared_ptr<const FoamImage> make_foam_picture(const Scene& scene) {
    if (!has_foam_picture(scene)) return nullptr;
    for (const Problem& problem : check_foam_picture(scene)) throw std::invalid_argument(text_of(problem));
    try {
        const exr::RgbPixels picture = exr::read_rgb(scene.effects.foam_pattern);
        std::vector<float> brightness;
        brightness.reserve(picture.pixels.size());
        for (int row = picture.height; row-- > 0;) {  // from the bottom
            const auto* const first =
                picture.pixels.data() + static_cast<std::ptrdiff_t>(row) * picture.width;
            for (int i = 0; i < picture.width; ++i)
                brightness.push_back(first[i][0] + first[i][1] + first[i][2]);
        }
        return std::make_shared<const FoamImage>(make_foam_image(picture.width, brightness));
    } catch (const exr::ReadError& error) {
        throw std::invalid_argument(text_of(foam_problem(scene, error.problem())));
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(text_of(foam_problem(scene, error.what())));
    }
}

std::shared_ptr<const FoamImage> kept_foam_picture(const Scene& scene) {
    if (!has_foam_picture(scene)) return nullptr;
    struct File {
        std::filesystem::path path;
        std::uintmax_t bytes = 0;
        std::filesystem::file_time_type::rep changed = 0;
        bool operator==(const File&) const = default;
    };
    static std::mutex mutex;
    static std::optional<File> last;
    static std::weak_ptr<const FoamImage> made;
    // Looked at before it is read: what changes in between is seen the next time.
    std::optional<File> file{{.path = scene.effects.foam_pattern}};
    std::error_code unknown;
    file->bytes = std::filesystem::file_size(file->path, unknown);
    if (!unknown)
        file->changed = std::filesystem::last_write_time(file->path, unknown).time_since_epoch().count();
    if (unknown) file.reset();
    {
        const std::lock_guard lock(mutex);
        if (auto picture = made.lock(); picture && file && file == last) return picture;
    }
    const auto picture = make_foam_picture(scene);
    const std::lock_guard lock(mutex);
    last = file;
    made = picture;
    return picture;
}

namespace {

// The wind draws foam into rows: from force 4 on a little, from a near gale's (15 m/s, "foam begins to be blown in streaks") as the key
// says, and in a storm up to twice as much.
double foam_streaks(const Scene& scene) {
    const double wind = std::clamp((scene.sea.wind_speed_mps - 5.0) / 10.0, 0.0, 2.0);
    return std::min(scene.effects.foam_streaks * wind, 1.0);
}

}  // namespace

FoamLook make_foam(const Scene& scene, std::shared_ptr<const FoamImage> picture, double active) {
    refuse_keys(scene, "effects");
    refuse_keyed_sea(scene);
    const Effects& effects = scene.effects;
    FoamLook look{.image = std::move(picture),
                  .image_m = effects.foam_pattern_m,
                  .structure = effects.foam_structure,
                  .streaks = foam_streaks(scene),
                  .wind_direction_deg = scene.sea.wind_direction_deg,
                  .seed = scene.shot.seed,
                  .fresh_albedo = static_cast<float>(effects.foam_new_albedo),
                  .old_albedo = static_cast<float>(effects.foam_old_albedo)};
    constexpr double kMean = 0.4;  // of all ages: Koepke 1984
    // Koepke's patches lose reflectance while they grow; how foam that still breaks compares with what is left isn't told apart
    // there. This makes what breaks as white as dense foam wherever a tenth of the foam does.
    constexpr double kOldOverFresh = 0.4;
    const double left = 1.0 - active;
    double fresh = effects.foam_new_opaque, old = effects.foam_old_opaque;
    if (fresh == 0.0)
        fresh = old == 0.0   ? kMean / (active + left * kOldOverFresh)
                : active > 0 ? (kMean - left * old) / active
                             : kMean;
    fresh = std::clamp(fresh, 0.0, 1.0);
    if (old == 0.0) old = left > 0.0 ? std::clamp((kMean - active * fresh) / left, 0.0, 1.0) : fresh;
    look.fresh_opacity = static_cast<float>(fresh);
    look.old_opacity = static_cast<float>(old);
    return look;
}

}  // namespace pelagic
