// pelagic.Scene and its tables: the shot file's keys as attributes, documented in the words of the shot
// file's help.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "core/scene/canonical.h"
#include "core/scene/names.h"
#include "core/scene/text.h"
#include "core/scene/validate.h"
#include "plugin/python/bindings.h"
#include "plugin/shot/keys.h"
#include "plugin/shot/shot.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

// "how far the wind has blown over water [m]; a number, 1 … 1e8; default 300000"
std::string doc_of(const std::string& path) {
    for (const KeyHelp& key : all_keys()) {
        if (key.path != path) continue;
        std::string text = key.help;
        if (!key.unit.empty()) text += " [" + key.unit + "]";
        if (!key.accepted.empty()) text += "; " + key.accepted;
        if (!key.fallback.empty()) text += "; default " + key.fallback;
        return text;
    }
    throw std::logic_error("the shot file has no key " + path);
}

// "[sea]: the weather", "An entry of sea.swell."
std::string class_doc(const std::string& path) {
    if (path.ends_with("[]")) return "An entry of " + path.substr(0, path.size() - 2) + ".";
    return "[" + path + "]: " + doc_of(path);
}

// ---- How values look in Python: choices are the shot file's words, vectors and lists are tuples

template <class Value>
struct Face {
    static const Value& to_python(const Value& value) { return value; }
    using Given = Value;
    static Value from_python(const Given& given, const std::string&) { return given; }
};

template <class Choice>
requires std::is_enum_v<Choice>
struct Face<Choice> {
    static std::string to_python(Choice choice) { return std::string(word_of(choice)); }
    using Given = std::string;
    static Choice from_python(const Given& word, const std::string& path) {
        if (const auto choice = choice_of<Choice>(word)) return *choice;
        const auto words = all_words<Choice>();
        std::string accepted;
        for (const std::string& one : words) accepted += (accepted.empty() ? "" : " ") + quoted_text(one);
        const std::string near = nearest(word, words);
        throw ShotError(text_of(
            Problem{path, quoted_text(word),
                    "is not one of the words" + (near.empty() ? "" : ", the nearest is " + quoted_text(near)),
                    "one of " + accepted}));
    }
};

template <>
struct Face<glm::dvec3> {
    static std::array<double, 3> numbers(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
    static py::tuple to_python(const glm::dvec3& v) { return py::make_tuple(v.x, v.y, v.z); }
    using Given = std::array<double, 3>;
    static glm::dvec3 from_python(const Given& v, const std::string&) { return {v[0], v[1], v[2]}; }
};

template <>
struct Face<glm::ivec2> {
    static py::tuple to_python(const glm::ivec2& v) { return py::make_tuple(v.x, v.y); }
    using Given = std::array<int, 2>;
    static glm::ivec2 from_python(const Given& v, const std::string&) { return {v[0], v[1]}; }
};

// A tuple, because a list would be a copy whose append() is lost.
template <class Element>
struct Face<std::vector<Element>> {
    static py::tuple to_python(const std::vector<Element>& list) {
        py::tuple tuple(list.size());
        for (std::size_t i = 0; i < list.size(); ++i) tuple[i] = py::cast(Face<Element>::to_python(list[i]));
        return tuple;
    }
    using Given = std::vector<typename Face<Element>::Given>;
    static std::vector<Element> from_python(const Given& given, const std::string& path) {
        std::vector<Element> list;
        for (std::size_t i = 0; i < given.size(); ++i)
            list.push_back(Face<Element>::from_python(given[i], path + '[' + std::to_string(i) + ']'));
        return list;
    }
};

// ---- Classes out of structs

// A table, or an entry of a list ("sea.swell[]"): its keys become attributes.
template <class Table>
class Binder {
  public:
    Binder(py::module_& module, const char* name, std::string path)
        : path_(std::move(path)), class_(module, name, class_doc(path_).c_str()) {
        class_.def("__repr__", [class_name = std::string(name), this_names = names_](const py::object& self) {
            std::string text;
            for (const std::string& key : *this_names)
                text +=
                    (text.empty() ? "" : ", ") + key + "=" + std::string(py::repr(self.attr(key.c_str())));
            return class_name + "(" + text + ")";
        });
    }

    template <class Value>
    Binder& key(const char* name, Value Table::*member) {
        using Shown = Face<Value>;
        const std::string path = path_ + '.' + name;
        names_->push_back(name);
        class_.def_property(
            name, [member](const Table& table) { return Shown::to_python(table.*member); },
            [member, path](Table& table, const typename Shown::Given& given) {
                table.*member = Shown::from_python(given, path);
            },
            doc_of(path).c_str());
        return *this;
    }

    py::class_<Table>& python() { return class_; }
    void add_name(const char* name) { names_->push_back(name); }

  private:
    std::string path_;
    std::shared_ptr<std::vector<std::string>> names_ = std::make_shared<std::vector<std::string>>();
    py::class_<Table> class_;
};

void add_lists(py::module_& module) {
    Binder<Swell>(module, "Swell", "sea.swell[]")
        .key("height_m", &Swell::height_m)
        .key("period_s", &Swell::period_s)
        .key("direction_deg", &Swell::direction_deg)
        .python()
        .def(py::init([](double height_m, double period_s, double direction_deg) {
                 return Swell{height_m, period_s, direction_deg};
             }),
             py::kw_only(), py::arg("height_m"), py::arg("period_s"), py::arg("direction_deg"));
    Binder<CascadeSize>(module, "CascadeSize", "waves.cascades[]")
        .key("size_m", &CascadeSize::size_m)
        .key("resolution", &CascadeSize::resolution)
        .python()
        .def(py::init([](double size_m, int resolution) {
                 return CascadeSize{size_m, resolution};
             }),
             py::kw_only(), py::arg("size_m"), py::arg("resolution"));
    Binder<CameraKey>(module, "CameraKey", "camera.keys[]")
        .key("frame", &CameraKey::frame)
        .key("position_m", &CameraKey::position_m)
        .key("look_at_m", &CameraKey::look_at_m)
        .python()
        .def(py::init([](int frame, std::array<double, 3> at, std::array<double, 3> target) {
                 return CameraKey{frame, {at[0], at[1], at[2]}, {target[0], target[1], target[2]}};
             }),
             py::kw_only(), py::arg("frame"), py::arg("position_m"), py::arg("look_at_m"));
}

void add_shot(py::module_& module) {
    Binder<Shot> shot(module, "Shot", "shot");
    shot.key("name", &Shot::name);
    shot.add_name("frames");
    shot.python().def_property(
        "frames", [](const Shot& self) { return py::make_tuple(self.first_frame, self.last_frame); },
        [](Shot& self, std::array<int, 2> frames) {
            self.first_frame = frames[0];
            self.last_frame = frames[1];
        },
        doc_of("shot.frames").c_str());
    shot.key("fps", &Shot::fps).key("seed", &Shot::seed).key("loop_s", &Shot::loop_s);
    shot.python().def(
        "time_s", [](const Shot& self, double frame) { return (frame - 1.0) / self.fps; }, py::arg("frame"),
        "The time that a frame shows [s], also between frames: t = (frame - 1)/fps, whatever the range.");
}

void add_tables(py::module_& module) {
    add_shot(module);
    Binder<SeaState>(module, "SeaState", "sea")
        .key("wind_speed_mps", &SeaState::wind_speed_mps)
        .key("wind_direction_deg", &SeaState::wind_direction_deg)
        .key("fetch_m", &SeaState::fetch_m)
        .key("depth_m", &SeaState::depth_m)
        .key("spectrum", &SeaState::spectrum)
        .key("spreading", &SeaState::spreading)
        .key("swell", &SeaState::swell)
        .python()
        .def_property_readonly(
            "is_measured", [](const SeaState& self) { return self.measured.has_value(); },
            "Whether a buoy's hour is in it, from Scene.from_file.")
        .def(
            "forget_measured", [](SeaState& self) { self.measured.reset(); },
            "Lets the buoy's hour go, so that spectrum can be another than \"file\".");
    Binder<Waves>(module, "Waves", "waves")
        .key("model", &Waves::model)
        .key("choppiness", &Waves::choppiness)
        .key("cascades", &Waves::cascades)
        .key("trains", &Waves::trains)
        .key("shortest_m", &Waves::shortest_m)
        .key("longest_m", &Waves::longest_m);
    Binder<Surface>(module, "Surface", "surface")
        .key("kind", &Surface::kind)
        .key("size_m", &Surface::size_m)
        .key("resolution", &Surface::resolution)
        .key("cell_px", &Surface::cell_px);
    Binder<Camera>(module, "Camera", "camera")
        .key("position_m", &Camera::position_m)
        .key("look_at_m", &Camera::look_at_m)
        .key("keys", &Camera::keys)
        .key("fov_deg", &Camera::fov_deg)
        .key("resolution", &Camera::resolution);
    Binder<Light>(module, "Light", "light")
        .key("sun_elevation_deg", &Light::sun_elevation_deg)
        .key("sun_azimuth_deg", &Light::sun_azimuth_deg)
        .key("sky", &Light::sky)
        .key("turbidity", &Light::turbidity);
    Binder<Water>(module, "Water", "water")
        .key("type", &Water::type)
        .key("chlorophyll_mg_m3", &Water::chlorophyll_mg_m3);
    Binder<Effects>(module, "Effects", "effects")
        .key("whitecaps", &Effects::whitecaps)
        .key("spray", &Effects::spray)
        .key("spray_gain", &Effects::spray_gain);
    Binder<Quality>(module, "Quality", "quality").key("level", &Quality::level);
    Binder<Output>(module, "Output", "output")
        .key("mesh", &Output::mesh)
        .key("attributes", &Output::attributes)
        .key("maps", &Output::maps)
        .key("map_resolution", &Output::map_resolution)
        .key("cascade_tiles", &Output::cascade_tiles)
        .key("mesh_scheme", &Output::mesh_scheme)
        .key("volumes", &Output::volumes)
        .key("voxel_m", &Output::voxel_m);
}

std::vector<std::string> problem_lines(const Scene& scene) {
    std::vector<std::string> lines;
    for (const Problem& problem : validate(scene)) lines.push_back(text_of(problem));
    return lines;
}

}  // namespace

void require_valid(const Scene& scene) {
    std::string report;
    for (const std::string& line : problem_lines(scene)) report += (report.empty() ? "" : "\n") + line;
    if (!report.empty()) throw ShotError(report);
}

void add_scene(py::module_& module) {
    add_lists(module);
    add_tables(module);
    py::class_<Scene> scene(
        module, "Scene",
        "What the artist asks for: the tables of a shot file, each with its keys as "
        "attributes.\n\n"
        "Scene() has the defaults. Words are strings, vectors and lists are tuples: assign a new "
        "one to change it.");
    scene.def(py::init<>())
        .def_static("from_file", &load_shot, py::arg("path"),
                    "The scene that a shot file describes. ShotError with every problem of the file.")
        .def("validate", &problem_lines,
             "Every problem of the scene, a line each: KEY = VALUE: PROBLEM; accepted: WHAT IS. Empty: it "
             "can be "
             "planned.")
        .def("__copy__", [](const Scene& self) { return self; })
        .def(
            "__deepcopy__", [](const Scene& self, const py::dict&) { return self; }, py::arg("memo"))
        .def("__str__", &canonical);
    const auto table = [&scene](const char* name, auto member) {
        scene.def_readwrite(name, member, doc_of(name).c_str());
    };
    table("shot", &Scene::shot);
    table("sea", &Scene::sea);
    table("waves", &Scene::waves);
    table("surface", &Scene::surface);
    table("camera", &Scene::camera);
    table("light", &Scene::light);
    table("water", &Scene::water);
    table("effects", &Scene::effects);
    table("quality", &Scene::quality);
    table("output", &Scene::output);
}

}  // namespace pelagic::python
