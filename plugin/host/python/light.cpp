// The lighting on arrays: pelagic.Sky, pelagic.WaterBody and pelagic.shade.
#include "plugin/light/light.h"
#include "plugin/host/python/light.h"
#include "plugin/light/exposure.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/background.h"
#include "core/lighting/lighting.h"
#include "core/lighting/spray.h"
#include "core/plan/spray.h"
#include "core/waves/whitecaps.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/watch.h"
#include "plugin/render/render.h"
#include "plugin/render/spray_map.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;
using Range = tbb::blocked_range<std::size_t>;

constexpr std::size_t kGrain = 256;  // points a task computes
constexpr float kDeepestEye_m = 10000.0f;
constexpr std::size_t kAlbedoGrain = 4096;  // those of water_albedo(), of which each task makes a table
constexpr std::size_t kShaded =
    kLayers.size() - 1;  // layers of a point: the air before it depends on the eye's place

// work(range) over as many points, by all threads, until it is interrupted.
template <class Work>
void over_points(py::ssize_t count, const Work& work, std::size_t grain = kGrain) {
    Watch watch{py::none(), py::none()};
    beside_others(watch, [&] {
        tbb::parallel_for(Range(0, static_cast<std::size_t>(count), grain), [&](const Range& range) {
            if (!*watch.flag()) work(range);
        });
    });
    if (*watch.flag()) throw Cancelled("the program ends");
}

py::tuple tuple_of(glm::vec3 v) {
    return py::make_tuple(v.x, v.y, v.z);
}

// ---- Sky

struct PythonSky {
    std::shared_ptr<const Sky> sky;
};

PythonSky sky_of(const Scene& scene) {
    require_valid(scene);
    return {beside_others([kept = scene] { return std::make_shared<const Sky>(make_sky(kept)); })};
}

py::array image_of(const PythonSky& self, int width) {
    LatLong picture = beside_others([sky = self.sky, width] { return lat_long(*sky, width); });
    return array_of<float>(std::move(picture.radiance), {picture.height, picture.width});
}

// By the direction in which an eye looks, as lat_long() has directions.
py::array spray_image_of(const PythonSky& self, const Scene& scene, int width) {
    require_valid(scene);
    if (width < kLeastLatLong || width > kLargestLatLong || width % 2 != 0)
        throw py::value_error("width: accepted: even numbers from " + std::to_string(kLeastLatLong) + " to " +
                              std::to_string(kLargestLatLong));
    std::vector<glm::vec3> radiance = beside_others([sky = self.sky, scene, width] {
        const auto prepared = prepare(scene);
        Spray spray = spray_by(spray_law(scene, prepared->extent.significant_height_m));
        light_spray(spray, {}, *sky, make_water(scene), law_coverage(scene));
        std::vector<glm::vec3> made;
        for (int row = 0; row < width / 2; ++row)
            for (int column = 0; column < width; ++column) {
                const double up = 0.5 * kPi - kTwoPi * (row + 0.5) / width;
                const double azimuth = kPi - kTwoPi * (column + 0.5) / width;
                const glm::dvec3 direction(std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth),
                                           std::sin(up));
                constexpr float kHeight_m = 2.0f;  // the haze above has next to none of the sun's light
                made.push_back(spray_light(spray, glm::vec3(direction), kHeight_m));
            }
        return made;
    });
    return array_of<float>(std::move(radiance), {width / 2, width});
}

py::object foam_picture_of(const Scene& scene) {
    require_valid(scene);
    const auto picture = beside_others([kept = scene] { return make_foam_picture(kept); });
    if (!picture) return py::none();
    std::vector<float> scores;
    const auto side = static_cast<std::size_t>(picture->side);
    for (std::size_t row = side; row-- > 0;)
        scores.insert(scores.end(), picture->texels.begin() + static_cast<std::ptrdiff_t>(row * side),
                      picture->texels.begin() + static_cast<std::ptrdiff_t>((row + 1) * side));
    return array_of<float>(std::move(scores), {picture->side, picture->side, 1});
}

py::object radiance_towards(const PythonSky& self, const py::object& directions, py::object out) {
    Copies copies;
    const auto [towards, count] = readable_vectors(directions, {"directions"}, copies);
    if (out.is_none()) out = py::array_t<float>({count, py::ssize_t{3}});
    const Strided<glm::vec3> radiance = writable_vectors(out, {"out", count}, copies);
    const Strided<const glm::vec3> to = towards;
    over_points(count, [&](const Range& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            radiance[i] = background(*self.sky, to[i], 1.0f).sky;
    });
    copies.give_back();
    return out;
}

void add_sky(py::module_& module) {
    py::class_<PythonSky>(
        module, "Sky", py::module_local(),
        "The light of a scene: daylight computed from the sun's place and the haze, or a picture that "
        "light.sky names.\n\n"
        "Radiances are linear Rec. 709 in kcd/m², irradiances in klx; of a picture in the picture's "
        "own units. ValueError, naming the file, for a picture that can't be read or isn't of a sky.")
        .def(py::init(&sky_of), py::arg("scene"))
        .def_property_readonly(
            "sun_direction", [](const PythonSky& self) { return tuple_of(self.sky->sun_direction); },
            "Unit, towards the sun, world axes.")
        .def_property_readonly(
            "sun_radiance", [](const PythonSky& self) { return tuple_of(self.sky->sun_radiance); },
            "Mean over the disc; 0 after sunset and where a picture has no sun.")
        .def_property_readonly(
            "sun_angular_radius", [](const PythonSky& self) { return self.sky->sun_angular_radius; },
            "Of the disc [rad].")
        .def_property_readonly(
            "sun_irradiance", [](const PythonSky& self) { return tuple_of(self.sky->sun_irradiance); },
            "Of the sun alone, on a horizontal plane. Across its rays: divided by sun_direction's z.")
        .def_property_readonly(
            "sky_irradiance", [](const PythonSky& self) { return tuple_of(self.sky->sky_irradiance); },
            "Of the sky without the sun, on a horizontal plane.")
        .def(
            "exposure",
            [](const PythonSky& self, const Scene& scene, double stops) {
                require_valid(scene);
                return shot_exposure(scene, *self.sky, stops);
            },
            py::arg("scene"), py::arg("stops") = 0.0,
            "For pictures of a scene in this light, which should be its own: radiance · exposure = 0.18 is middle "
            "grey. Metered from the light and a mean sea in the scene's camera, at its keys where it has any; stops "
            "brighter. A camera in the water counts as behind its glass, in air, where light from the water is 1/1.34² "
            "(is_metered_in_water()).")
        .def(
            "image", &image_of, py::arg("width"),
            "float32 (width/2, width, 3): the sky without the sun's disc as a lat-long picture, rows from the "
            "zenith down, the middle column +x, azimuth growing counter-clockwise, which is to the left: as "
            "light.sky reads one. Below the horizon: the sky's reflection in more sea. width: even, 8 … 16384.")
        .def(
            "spray_image", &spray_image_of, py::arg("scene"), py::arg("width"),
            "float32 (width/2, width, 3): the radiance that the large drops of the scene's spray send on to an eye that looks in "
            "each direction, where they hide all behind them; laid out as image(). The scene should be in this light.")
        .def("radiance", &radiance_towards, py::arg("directions"), py::kw_only(), py::arg("out") = py::none(),
             "float32 (n, 3): the sky without the sun's disc in these directions, float32 (n, 3), unit; into "
             "out, where that is given.");
}

// ---- The sea's light

template <class Choice>
Choice choice_of(const std::string& name, const std::string& word,
                 std::initializer_list<std::pair<const char*, Choice>> choices) {
    std::string accepted;
    for (const auto& [known, choice] : choices) {
        if (word == known) return choice;
        accepted += (accepted.empty() ? "" : ", ") + std::string(known);
    }
    throw py::value_error(name + " \"" + word + "\"; accepted: " + accepted);
}

struct ShadeArguments {
    py::object to_eye, normal, slope_variance, coverage;
    std::array<py::object, kShaded> layers;
};

py::dict shade(const PythonSky& sky, const WaterBody& water, const ShadeArguments& given,
               LightingChoice choice) {
    Copies copies;
    const auto [normal, count] = readable_vectors(given.normal, {"normal"}, copies);
    const auto read = [&, n = count](const py::object& object, const char* name) {
        return readable_vectors(object, {name, n}, copies).view;
    };
    const Strided<const glm::vec3> to_eye = read(given.to_eye, "to_eye"),
                                   slope_variance = read(given.slope_variance, "slope_variance"),
                                   normals = normal;
    choice.whitecaps = !given.coverage.is_none();
    const Strided<const float> coverage = choice.whitecaps
                                              ? readable_numbers(given.coverage, {"coverage", count}, copies)
                                              : Strided<const float>{};
    std::array<Strided<glm::vec3>, kShaded> out;
    py::dict written;
    for (std::size_t layer = 0; layer < kShaded; ++layer) {
        const char* name = kLayers[layer].first;
        py::object array = given.layers[layer];
        if (array.is_none()) array = py::array_t<float>({count, py::ssize_t{3}});
        out[layer] = writable_vectors(array, {name, count}, copies);
        written[name] = array;
    }
    over_points(count, [&](const Range& range) {
        std::vector<SeaPoint> points(range.size());
        std::vector<SeaRadiance> radiance(range.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::size_t at = range.begin() + i;
            points[i] = {.to_eye = to_eye[at],
                         .normal = normals[at],
                         .slope_variance = slope_variance[at],
                         .coverage = coverage ? coverage[at] : 0.0f};
        }
        shade_sea(choice, *sky.sky, water, points, radiance);
        for (std::size_t layer = 0; layer < kShaded; ++layer)
            for (std::size_t i = 0; i < radiance.size(); ++i)
                out[layer][range.begin() + i] = radiance[i].*kLayers[layer].second;
    });
    copies.give_back();
    return written;
}

py::object radiance_in_water(const PythonSky& sky, const WaterBody& water, const py::object& directions,
                             float depth_m, py::object out) {
    if (!water.has_body) throw py::value_error("water: it has no body, and nobody can be in it");
    if (!(depth_m >= 0.0f && depth_m <= kDeepestEye_m))
        throw py::value_error("depth_m: accepted: 0 to " + std::to_string(static_cast<int>(kDeepestEye_m)));
    Copies copies;
    const auto [towards, count] = readable_vectors(directions, {"directions"}, copies);
    if (out.is_none()) out = py::array_t<float>({count, py::ssize_t{3}});
    const Strided<glm::vec3> radiance = writable_vectors(out, {"out", count}, copies);
    over_points(count, [&, to = towards](const Range& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const glm::vec3 direction = to[i];
            SeaRadiance seen;
            shade_water({}, *sky.sky, water, -depth_m, {&direction, 1}, {&seen, 1});
            radiance[i] = seen.sea;
        }
    });
    copies.give_back();
    return out;
}

struct AlbedoArguments {
    py::object to_eye, coverage, foam_active, foam_age, normal, crest, out;
};

py::object albedo_of(const PythonSky& sky, const WaterBody& water, AlbedoArguments given) {
    Copies copies;
    const auto [to_eye, count] = readable_vectors(given.to_eye, {"to_eye"}, copies);
    const auto vectors = [&, n = count](const py::object& object, const char* name) {
        return object.is_none() ? Strided<const glm::vec3>{}
                                : readable_vectors(object, {name, n}, copies).view;
    };
    const auto numbers = [&, n = count](const py::object& object, const char* name) {
        return object.is_none() ? Strided<const float>{} : readable_numbers(object, {name, n}, copies);
    };
    const auto normal = vectors(given.normal, "normal"), crest = vectors(given.crest, "crest");
    const auto coverage = numbers(given.coverage, "coverage"),
               active = numbers(given.foam_active, "foam_active"),
               age_s = numbers(given.foam_age, "foam_age");
    if (given.out.is_none()) given.out = py::array_t<float>({count, py::ssize_t{3}});
    const Strided<glm::vec3> albedo = writable_vectors(given.out, {"out", count}, copies);
    over_points(
        count,
        [&, towards = to_eye](const Range& range) {
            std::vector<SeaPoint> points(range.size());
            std::vector<glm::vec3> made(range.size());
            for (std::size_t i = 0; i < points.size(); ++i) {
                const std::size_t at = range.begin() + i;
                points[i].to_eye = towards[at];
                if (normal) points[i].normal = normal[at];
                if (crest) points[i].crest = crest[at];
                if (coverage) points[i].coverage = coverage[at];
                if (active) points[i].active = active[at];
                if (age_s) points[i].age_s = age_s[at];
            }
            water_albedo(*sky.sky, water, points, made);
            for (std::size_t i = 0; i < points.size(); ++i) albedo[range.begin() + i] = made[i];
        },
        kAlbedoGrain);
    copies.give_back();
    return given.out;
}

}  // namespace

SkyQuality sky_quality_of(const std::string& word) {
    return choice_of<SkyQuality>(
        "sky_quality", word,
        {{"one", SkyQuality::One}, {"nine", SkyQuality::Nine}, {"integral", SkyQuality::Integral}});
}

void add_light(py::module_& module) {
    add_sky(module);
    py::class_<WaterBody>(module, "WaterBody", py::module_local(), "What is in a scene's water.")
        .def(py::init([](const Scene& scene) {
                 require_valid(scene);
                 return make_water(scene);
             }),
             py::arg("scene"))
        .def_property_readonly(
            "reflectance", [](const WaterBody& self) { return tuple_of(self.reflectance); },
            "Diffuse, just below the surface, linear Rec. 709; of a body of water under an even sky, with its floor, seen from 45 degrees.")
        .def_property_readonly(
            "absorption_per_m", [](const WaterBody& self) { return tuple_of(self.absorption_per_m); },
            "[1/m], at the dominant wavelengths of red, green and blue.")
        .def_property_readonly(
            "backscatter_per_m", [](const WaterBody& self) { return tuple_of(self.backscatter_per_m); },
            "[1/m], at the same. Isotropic scattering of twice as much sends as much back.")
        .def(
            "entering",
            [](const WaterBody& self, std::array<float, 3> direction) {
                return water_entering(self, {direction[0], direction[1], direction[2]});
            },
            py::arg("direction"),
            "The part of light from a direction (a unit vector) that the surface lets in: a rough surface of a body of "
            "water, a level one without.")
        .def(
            "lets_through",
            [](const WaterBody& self, float distance_m) {
                if (!self.has_body) throw py::value_error("lets_through: this water has no body");
                if (!(distance_m >= 0.0f)) throw py::value_error("distance_m: accepted: 0 or more");
                return tuple_of(water_lets_through(self, distance_m));
            },
            py::arg("distance_m"),
            "The part of the light of what is this far away [m] in a body of water that an eye in it sees, (r, g, b), linear "
            "Rec. 709. ValueError for water without a body.");
    module.def(
        "is_metered_in_water",
        [](const Scene& scene) {
            require_valid(scene);
            return is_metered_in_water(scene);
        },
        py::arg("scene"),
        "Whether the scene's camera, at its first key, is in the water as Sky.exposure() has it: not in the waves alone, nor "
        "where nothing is seen from below.");
    module.def(
        "water_radiance", &radiance_in_water, py::arg("sky"), py::arg("water"), py::arg("directions"),
        py::arg("depth_m"), py::kw_only(), py::arg("out") = py::none(),
        "float32 (n, 3) [kcd/m^2], linear Rec. 709: what an eye this deep in a body of water sees in these directions, "
        "float32 (n, 3), unit, z <= 0: the water, and the floor of scene.sea.depth_m. Into out, where that is given.\n\n"
        "ValueError for water without a body.");
    module.def(
        "water_albedo",
        [](const PythonSky& sky, const WaterBody& water, const py::object& to_eye, const py::object& coverage,
           const py::object& foam_active, const py::object& foam_age, const py::object& normal,
           const py::object& crest, const py::object& out) {
            return albedo_of(sky, water, {to_eye, coverage, foam_active, foam_age, normal, crest, out});
        },
        py::arg("sky"), py::arg("water"), py::arg("to_eye"), py::kw_only(), py::arg("coverage") = py::none(),
        py::arg("foam_active") = py::none(), py::arg("foam_age") = py::none(), py::arg("normal") = py::none(),
        py::arg("crest") = py::none(), py::arg("out") = py::none(),
        "float32 (n, 3), 0 to 1: the light from the water as a diffuse surface's, for renderers that light it themselves: "
        "of the irradiance of sun and sky on a level plane the share that leaves again towards the eye, before the factor "
        "(1 - Fresnel's term) of the way out; 0 in the dark. Into out, where that is given.\n\n"
        "to_eye: float32 (n, 3), unit, from the sea to the eye. coverage, foam_active, foam_age: float32 (n,), as "
        "evaluate() gives them, for the bubbles under foam, which itself isn't in it; without foam_active all foam breaks "
        "now. normal: float32 (n, 3), unit, default up. crest: float32 (n, 3), of waves longer than 2 m: slopes along x and "
        "y, and height [m]; default none.");
    module.def(
        "foam_picture", &foam_picture_of, py::arg("scene"),
        "float32 (side, side, 1), rows from the top: the picture of effects.foam_pattern by rank, as a variable of normal "
        "distribution, mean 0, variance 1, largest where foam is thickest; None where there is none. ValueError for a file "
        "that is no picture of foam.");
    module.def(
        "shade",
        [](const PythonSky& sky, const WaterBody& water, const py::object& to_eye, const py::object& normal,
           const py::object& slope_variance, const py::object& coverage, const std::string& sky_quality,
           const std::string& fresnel, const py::object& sun_layer, const py::object& sky_layer,
           const py::object& sea_layer, const py::object& foam_layer) {
            LightingChoice choice;
            choice.sky_quality = sky_quality_of(sky_quality);
            choice.fresnel = choice_of<FresnelFit>(
                "fresnel", fresnel, {{"exact", FresnelFit::Exact}, {"paper", FresnelFit::Paper}});
            return shade(
                sky, water,
                {to_eye, normal, slope_variance, coverage, {sun_layer, sky_layer, sea_layer, foam_layer}},
                choice);
        },
        py::arg("sky"), py::arg("water"), py::arg("to_eye"), py::arg("normal"), py::arg("slope_variance"),
        py::arg("coverage") = py::none(), py::kw_only(), py::arg("sky_quality") = "nine",
        py::arg("fresnel") = "exact", py::arg("sun_layer") = py::none(), py::arg("sky_layer") = py::none(),
        py::arg("sea_layer") = py::none(), py::arg("foam_layer") = py::none(),
        "The radiance of the sea towards the eye, by its source: a dict of float32 (n, 3), \"sun\" (its "
        "reflection), \"sky\" (its reflection), \"sea\" (light from the water) and \"foam\", in the sky's units. "
        "Each is weighted by its share of the pixel; their sum is what the eye sees.\n\n"
        "to_eye: float32 (n, 3), unit, from the sea to the eye. normal: float32 (n, 3), unit, of the resolved "
        "waves. slope_variance: float32 (n, 3), xx, yy, xy of the waves that the normals leave out. coverage: "
        "float32 (n,), of whitecaps; None: there are none. The last three are as evaluate() gives them.\n"
        "sky_quality: \"one\" lookup over the ellipse of the slopes, \"nine\", or the \"integral\". fresnel: "
        "\"exact\", or as the \"paper\" has it.\n"
        "sun_layer, sky_layer, sea_layer, foam_layer: arrays to write into instead of new ones.");
}

}  // namespace pelagic::python
