// pelagic.Scene and its tables: the keys of core/scene/keys.h as attributes, documented in the words of the
// shot file's help.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/packing.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/plan/prepared_scene.h"
#include "core/scene/budget.h"
#include "core/scene/canonical.h"
#include "core/scene/editions.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "core/scene/number_keys.h"
#include "core/scene/shot_text.h"
#include "core/scene/text.h"
#include "core/spectrum/possible.h"
#include "core/waves/folding.h"
#include "plugin/budget/budget.h"
#include "plugin/files/files.h"
#include "plugin/format/obj/obj.h"
#include "plugin/format/shot/object_file.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/cage.h"
#include "plugin/host/python/values.h"
#include "plugin/host/python/watch.h"
#include "plugin/light/light.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

// "how far the wind has blown over water [m]; a number, 1 … 1e8; default 300000"
std::string doc_of(const Key& key) {
    std::string text = key.help;
    if (!key.unit.empty()) text += " [" + key.unit + "]";
    if (!key.accepted.empty()) text += "; " + key.accepted;
    const std::string fallback = key.is_required ? "" : value_text(key, key.fallback);
    if (!fallback.empty()) text += "; default " + fallback;
    return text;
}

// ---- Classes out of the table of keys

// A table of a scene, which it keeps alive; the base of a class for each table.
struct TableOfScene {
    std::shared_ptr<Scene> scene;
};

py::object property(const py::object& get, const py::object& set, const std::string& doc) {
    return py::module_::import("builtins").attr("property")(get, set, py::none(), doc);
}

// The attributes of a table's class that aren't keys.
void add_methods(const std::string& table, const py::object& base, py::dict& members) {
    if (table == "shot")
        members["time_s"] = py::cpp_function(
            [](const TableOfScene& self, double frame) { return self.scene->shot.time_s(frame); },
            py::name("time_s"), py::is_method(base), py::arg("frame"),
            "The sea's time that a frame shows [s], also between frames: "
            "t = time_offset_s + time_scale (frame - 1)/fps, whatever the range.");
    if (table == "surface")
        members["cage"] = property(
            py::cpp_function([](const TableOfScene& self) -> py::object {
                const Surface& surface = self.scene->surface;
                if (!surface.cage) return py::none();
                return py::cast(PythonCage{surface.cage, surface.cage_file});
            }),
            py::cpp_function([](const TableOfScene& self, const py::object& given) {
                if (!given.is_none() && !py::isinstance<PythonCage>(given))
                    throw py::type_error("surface.cage: accepted: a Cage, or None");
                const PythonCage cage = given.is_none() ? PythonCage() : given.cast<PythonCage>();
                self.scene->surface.cage = cage.cage;
                self.scene->surface.cage_file = cage.file;
            }),
            "With kind = \"cage\": the Cage whose limit surface the sea lies on, from cage_file or from arrays; otherwise None.");
    if (table != "sea") return;
    members["is_measured"] = property(
        py::cpp_function([](const TableOfScene& self) { return self.scene->sea.measured.has_value(); }),
        py::none(), "Whether a buoy's hour is in it, from Scene.from_file.");
    members["forget_measured"] = py::cpp_function(
        [](const TableOfScene& self) { self.scene->sea.measured.reset(); }, py::name("forget_measured"),
        py::is_method(base), "Lets the buoy's hour go, so that spectrum can be another than \"file\".");
}

std::string repr_of(const KeyTable& table, const Scene& scene) {
    std::string text;
    for (const Key& key : table.keys)
        text += (text.empty() ? "" : ", ") + key.name + "=" +
                std::string(py::repr(to_python(key, value_of(scene, key))));
    return table.name + "(" + text + ")";
}

// "ShotTable", "SeaTable", …
py::object add_table_class(py::module_& module, const py::object& base, const KeyTable& table) {
    py::dict members;
    members["__module__"] = "pelagic";
    members["__slots__"] = py::tuple();  // a misspelt key is refused, not added
    members["__doc__"] = "[" + table.name + "]: " + table.help;
    members["__repr__"] = py::cpp_function(
        [&table](const TableOfScene& self) { return repr_of(table, *self.scene); }, py::is_method(base));
    for (const Key& key : table.keys) {
        const py::cpp_function get(
            [&key](const TableOfScene& self) { return to_python(key, value_of(*self.scene, key)); });
        const py::cpp_function set([&key](const TableOfScene& self, const py::object& value) {
            set_from_python(*self.scene, key, value);
        });
        members[key.name.c_str()] = property(get, key.set ? py::object(set) : py::none(), doc_of(key));
    }
    add_methods(table.name, base, members);
    std::string name = table.name + "Table";
    name.front() += 'A' - 'a';
    const py::object made = py::type::of(base)(name, py::make_tuple(base), members);
    module.attr(name.c_str()) = made;
    return made;
}

// Named tuples: an attribute that is assigned would be lost with the copy that it belongs to.
void add_entry_class(py::module_& module, const Key& key) {
    py::list names;
    py::list defaults;  // of the last names: keys without one come first
    for (const Key& inner : key.entry_keys) {
        names.append(inner.name);
        if (!inner.is_required) defaults.append(to_python(inner, inner.fallback));
    }
    const py::object made =
        py::module_::import("collections")
            .attr("namedtuple")(key.entry_name, names, py::arg("module") = module.attr("__name__"),
                                py::arg("defaults") = defaults);
    made.attr("__doc__") = "An entry of " + key.path + ".";
    for (const Key& inner : key.entry_keys) made.attr(inner.name.c_str()).attr("__doc__") = doc_of(inner);
    module.attr(key.entry_name.c_str()) = entry_class(key) = made;
}

// ---- The table itself

py::object range_of(const Key& key) {
    if (key.range) return py::make_tuple(key.range->low, key.range->high);
    if (key.type == KeyType::Integer) return py::make_tuple(key.least, key.largest);
    return py::none();
}

py::dict described_key(const Key& key) {
    py::list feeds, inner;
    for (std::size_t part = 0; part < kKeyParts; ++part)
        if (key.key_parts[part]) feeds.append(text_of(KeyPartSet(1ull << part)));
    for (const Key& each : key.entry_keys) inner.append(described_key(each));
    py::dict out;
    out["path"] = key.path;
    out["name"] = key.name;
    out["label"] = key.label;
    out["type"] = std::string(word_of(key.type));
    out["unit"] = key.unit;
    out["help"] = key.help;
    out["accepted"] = key.accepted;
    out["default"] = key.is_required ? py::none() : to_python(key, key.fallback);
    py::list before;
    for (const EditionChange& change : edition_changes())
        if (change.path == key.path)
            before.append(py::make_tuple(change.edition, to_python(key, change.before)));
    out["defaults_before"] = before;
    out["required"] = key.is_required;
    out["may_have_keys"] = key.may_have_keys;
    out["is_angle"] = key.is_angle;
    out["range"] = range_of(key);
    out["soft_range"] = key.soft ? py::make_tuple(key.soft->low, key.soft->high) : py::object(py::none());
    out["logarithmic"] = key.soft && key.soft->is_logarithmic;
    out["choices"] = py::cast(key.choices);
    out["feeds"] = feeds;
    out["keys"] = inner;
    out["entry"] = key.entry_name;
    out["other_word"] = key.other_word;
    out["of_picture"] = key.of_picture;
    return out;
}

py::list described_keys() {
    py::list out;
    for (const Key& key : keys()) out.append(described_key(key));
    return out;
}

// A shot file may be read from any folder.
std::string text_of_shot(const Scene& scene) {
    Scene placed = scene;
    const auto absolute = [](std::string& path) { path = std::filesystem::absolute(path).string(); };
    replace_pictures(placed, [&](const Key&, std::string path) {
        absolute(path);
        return path;
    });
    for (WaveMask& mask : placed.waves.masks)
        if (mask.picture) absolute(*mask.picture);
    if (placed.sea.measured) absolute(placed.sea.measured->file);
    if (placed.surface.cage) {
        if (placed.surface.cage_file.empty())
            throw std::invalid_argument(
                text_of(Problem{std::string(kCageFile), quoted_text(placed.surface.cage->content()),
                                "is a cage that came from no file, which no shot file can name",
                                "a cage that was read from a file"}));
        absolute(placed.surface.cage_file);
    }
    for (std::size_t i = 0; i < placed.objects.size(); ++i) {
        if (placed.objects[i].file.empty())
            throw std::invalid_argument(text_of(
                Problem{"objects[" + std::to_string(i) + "].file", quoted_text(placed.objects[i].called()),
                        "is a body that came from no file, which no shot file can name",
                        "a body that was read from a file"}));
        absolute(placed.objects[i].file);
    }
    const auto require_utf8 = [](std::string_view key, const std::string& path) {
        if (utf8_text(path) != path)
            throw std::invalid_argument(text_of(
                Problem{std::string(key), quoted_text(path),
                        "has bytes that aren't UTF-8, which no shot file can have", "a path in UTF-8"}));
    };
    for (const Key* key : picture_keys(placed))
        require_utf8(key->path, std::get<std::string>(value_of(placed, *key)));
    for (const WaveMask& mask : placed.waves.masks)
        if (mask.picture) require_utf8("waves.masks", *mask.picture);
    if (placed.sea.measured) require_utf8(kSpectrumFile, placed.sea.measured->file);
    if (placed.surface.cage) require_utf8(kCageFile, placed.surface.cage_file);
    for (const SceneObject& object : placed.objects) require_utf8("objects[].file", object.file);
    return shot_text(placed);
}

// With the meshes of files that the scene doesn't have yet.
void set_list(Scene& scene, const Key& key, const py::object& given) {
    Scene made = scene;
    set_from_python(made, key, given);
    for (std::size_t i = 0; i < made.objects.size(); ++i) {
        SceneObject& object = made.objects[i];
        if (object.mesh || object.file.empty()) continue;
        const auto same = std::ranges::find_if(
            made.objects, [&](const SceneObject& other) { return other.mesh && other.file == object.file; });
        if (same != made.objects.end()) {
            object.mesh = same->mesh;
            continue;
        }
        try {
            object.mesh = load_object(object.file);
        } catch (const ObjError& error) {
            throw ShotError(text_of(Problem{"objects[" + std::to_string(i) + "].file",
                                            quoted_text(object.file), error.problem(), error.accepted()}));
        }
    }
    scene = std::move(made);
}

double significant_height_of(const Scene& scene) {
    require_valid(scene);
    const Scene kept = scene;
    const OthersMayRun others_may_run;
    const auto prepared = prepare(without_budget(kept));
    if (prepared->weather) refuse_keyed_sea(prepared->scene);
    return prepared->extent.significant_height_m;
}

std::vector<std::string> warnings_of(const Scene& scene) {
    require_valid(scene);
    const Scene kept = scene;
    const OthersMayRun others_may_run;
    return sea_warnings(*prepare(without_budget(kept)));
}

Scene settled_scene(const Scene& scene) {
    require_valid(scene);
    const Scene kept = scene;
    const OthersMayRun others_may_run;
    return held(settle(kept, Purpose::Mesh, with_rates(recorded_rates()))).scene;
}

// Rows of three.
template <class Number>
py::array_t<Number> rows_of_three(const Number* numbers, std::size_t rows) {
    return py::array_t<Number>({static_cast<py::ssize_t>(rows), py::ssize_t{3}}, numbers);
}

py::dict mesh_of(const Scene& scene, py::ssize_t index) {
    const SceneObject& object = object_at(scene, index);
    py::dict out;
    if (!object.mesh) return out;
    const ObjectMeshData& data = object.mesh->data();
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    out["points_m"] = rows_of_three(&data.points_m.data()->x, data.points_m.size());
    out["triangles"] = rows_of_three(data.triangles.data(), data.triangles.size() / 3);
    out["normals"] = rows_of_three(&data.normals.data()->x, data.normals.size());
    out["material"] =
        py::array_t<std::uint16_t>(static_cast<py::ssize_t>(data.material.size()), data.material.data());
    py::list materials;
    const auto colour = [](const glm::vec3& c) { return py::make_tuple(c.x, c.y, c.z); };
    for (const ObjectMaterial& material : data.materials) {
        py::dict each;
        each["name"] = material.name;
        each["colour"] = colour(material.colour);
        each["roughness"] = material.roughness;
        each["glow"] = colour(material.glow);
        each["image"] = material.image;
        materials.append(each);
    }
    out["materials"] = materials;
    py::list images;
    for (const auto& image : data.images) {
        const ObjectImage::Level& whole = image->levels().front();
        py::array_t<float> pixels({py::ssize_t{whole.height}, py::ssize_t{whole.width}, py::ssize_t{3}});
        std::transform(whole.rgb.begin(), whole.rgb.end(), pixels.mutable_data(),
                       [](std::uint16_t half) { return glm::unpackHalf1x16(half); });
        images.append(pixels);
    }
    out["images"] = images;
    out["image_at"] = py::array_t<float>({static_cast<py::ssize_t>(data.image_at.size()), py::ssize_t{2}},
                                         data.image_at.empty() ? nullptr : &data.image_at.data()->x);
    return out;
}

std::vector<std::string> problem_lines(const Scene& scene) {
    std::vector<std::string> lines;
    for (const Problem& problem : problems_of(scene)) lines.push_back(text_of(problem));
    return lines;
}

}  // namespace

void require_valid(const Scene& scene) {
    std::string report;
    for (const std::string& line : problem_lines(scene)) report += (report.empty() ? "" : "\n") + line;
    if (!report.empty()) throw ShotError(report);
}

void add_scene(py::module_& module) {
    for (const Key& key : keys())
        if (!key.entry_keys.empty()) add_entry_class(module, key);
    py::class_<Scene, std::shared_ptr<Scene>> scene(
        module, "Scene", py::module_local(),
        "What the artist asks for: the tables of a shot file, each with its keys as attributes.\n\n"
        "Scene() has the defaults. Words are strings, vectors and lists are tuples: assign a new one to "
        "change "
        "it. pelagic.keys() describes every key.");
    scene.def(py::init<>())
        .def_static(
            "from_file",
            [](const std::filesystem::path& path) {
                return std::make_shared<Scene>(load_shot(path, check_scene));
            },
            py::arg("path"),
            "The scene that a shot file describes. ShotError with every problem of the file.")
        .def_static(
            "from_text",
            [](const std::string& text, const std::filesystem::path& folder) {
                return std::make_shared<Scene>(parse_shot(text, folder / "text", check_scene));
            },
            py::arg("text"), py::arg("folder") = ".",
            "The scene that a shot file's text describes; paths in it are from this folder. ShotError with "
            "every problem, in whose lines the text is called \"text\" in the folder.")
        .def(
            "shot_text", &text_of_shot,
            "The shot file that describes the scene: the keys that aren't at their defaults. Paths in it are "
            "absolute.")
        .def(
            "save",
            [](const Scene& self, const std::filesystem::path& path) {
                files::write_atomically(path, text_of_shot(self));
            },
            py::arg("path"),
            "Writes shot_text() to a file, which is the old one until the new one is whole. FileError where "
            "it can't be written.")
        .def("validate", &problem_lines,
             "Every problem of the scene, a line each: KEY = VALUE: PROBLEM; accepted: WHAT IS. Empty: it "
             "can be "
             "planned.")
        .def(
            "warnings", &warnings_of,
            "What an artist should know of a sea that can be planned, a sentence each: that much of the surface folds over "
            "itself, that troughs reach the bed. Empty: nothing. ShotError for a scene that can't be.")
        .def(
            "significant_height_m", &significant_height_of,
            "4 times the root of the variance of the surface's height [m]: of its spectrum, without building a Sea.")
        .def(
            "settled", &settled_scene,
            "A copy with the keys of the mesh that the budget asks for (quality.max_error, quality.frame_ms), and without "
            "the budget; without one as it is. frame_ms counts here, as in a Sea, in Maps and in render(), the milliseconds of the "
            "recorded two cores, so that all machines of a farm choose alike; bake() and render_files() count this machine's. "
            "ValueError where nothing holds the budget, ShotError for a scene that can't "
            "be.")
        .def(
            "at", [](const Scene& self, double frame) { return scene_at(self, frame); }, py::arg("frame"),
            "The scene of a frame: numbers that change over the shot, such as {\"keys\": [(1, 30.0), (48, 2.0)], "
            "\"interpolation\": \"smooth\"}, as they are there. What has no frame, as Sky, WaterBody and GpuLight, wants "
            "a scene like that. Its sea is that of these numbers alone: of a shot whose sea changes bake() and render() show the waves of a "
            "frame, which have both keys' in them.")
        .def(
            "object_mesh", &mesh_of, py::arg("index"),
            "The mesh of a body of objects: points_m, float32 (n, 3); triangles, uint32 (m, 3), counter-clockwise seen from outside; "
            "normals of their corners, float32 (3 m, 3); material of each, uint16 (m,), into materials, a list of dictionaries of name, "
            "colour (linear Rec. 709), roughness, glow (times glow_cd_m2) and image, into images, -1 without one: float32 (height, width, 3) each, "
            "linear Rec. 709, rows from the bottom; image_at of the corners, float32 (3 m, 2), empty without images. Empty of a body without a mesh. IndexError for one that "
            "isn't there.")
        .def("__copy__", [](const Scene& self) { return std::make_shared<Scene>(self); })
        .def(
            "__deepcopy__", [](const Scene& self, const py::dict&) { return std::make_shared<Scene>(self); },
            py::arg("memo"))
        .def("__str__", [](const Scene& self) { return canonical(self); });
    add_objects(scene);
    py::class_<TableOfScene> base(module, "Table", py::module_local(),
                                  "A table of a scene: its keys are the attributes.");
    base.def(py::init([](const std::shared_ptr<Scene>& self) { return TableOfScene{self}; }),
             py::arg("scene"));
    for (const KeyTable& table : key_tables()) {
        if (table.is_list()) {
            const Key& key = table.keys.front();
            scene.def_property(
                table.name.c_str(), [&key](const Scene& self) { return to_python(key, value_of(self, key)); },
                [&key](Scene& self, const py::object& given) { set_list(self, key, given); },
                ("[[" + table.name + "]]: " + table.help +
                 ". Files are read when they are set, from the working folder.")
                    .c_str());
            continue;
        }
        const py::object made = add_table_class(module, base, table);
        scene.def_property(
            table.name.c_str(), [made](const std::shared_ptr<Scene>& self) { return made(self); },
            [&table, made](Scene& self, const py::object& other) {
                if (!py::isinstance(other, made))
                    throw py::type_error(table.name + ": accepted: a " +
                                         std::string(py::str(made.attr("__name__"))) +
                                         ", such as another scene's");
                const Scene from = *other.cast<const TableOfScene&>().scene;
                table.copy(from, self);
            },
            ("[" + table.name + "]: " + table.help).c_str());
    }
    add_presets(module, scene);
    module.def(
        "keys", &described_keys,
        "Every key of a shot file as a dictionary: path, name, label, type, unit, help, accepted, default, "
        "required, range, soft_range (of a slider), logarithmic, choices (words), feeds (what depends on it), "
        "the keys of a list's entries, the entries' class, other_word (that may stand in the place of a list or an "
        "integer), and of_picture (the key of the picture without which this one means nothing, or \"\").");
}

}  // namespace pelagic::python
