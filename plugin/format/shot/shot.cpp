// Shot files: TOML in, a validated Scene out. See shot.h.
#include "plugin/format/shot/shot.h"

#include <toml++/toml.h>

#include <map>
#include <memory>

#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "core/scene/text.h"
#include "core/scene/validate.h"
#include "plugin/format/obj/obj.h"
#include "plugin/format/shot/bounds.h"
#include "plugin/format/shot/chan.h"
#include "plugin/format/shot/coast_file.h"
#include "plugin/format/shot/mask_files.h"
#include "plugin/format/shot/ndbc.h"
#include "plugin/format/shot/object_file.h"
#include "plugin/format/shot/read_scene.h"
#include "plugin/format/shot/reader.h"
#include "plugin/format/shot/text_file.h"

namespace pelagic {

namespace {

constexpr std::size_t kMostOfPath = 4096;  // in messages [bytes]: no longer one can be opened

// A measured spectrum is data of the scene: its file is read here, and the scene forgets where it came from.
void load_measured(Reader& reader, const std::filesystem::path& folder, SeaState& sea) {
    const bool spectrum_is_known = !reader.has_failed("sea.spectrum");
    if (sea.spectrum != SpectrumKind::File) {
        for (const char* key : {"sea.spectrum_file", "sea.spectrum_time"}) {
            if (!spectrum_is_known || !reader.knows(key) || reader.has_failed(key)) continue;
            const bool is_file = key == std::string_view("sea.spectrum_file");
            reader.refuse({key,
                           is_file ? quoted_text(*reader.spectrum_file) : time_text(*reader.spectrum_time),
                           "is given, but spectrum is " + quoted_text(word_of(sea.spectrum)),
                           "this key together with spectrum = \"file\""});
        }
        return;
    }
    // From here on, whatever keeps the spectrum from being there is reported here.
    std::string missing;
    for (const auto& [key, is_given] : {std::pair{"spectrum_file", reader.spectrum_file.has_value()},
                                        std::pair{"spectrum_time", reader.spectrum_time.has_value()}}) {
        if (is_given || reader.has_failed(std::string("sea.") + key)) continue;
        missing += std::string(missing.empty() ? "" : " and ") + key;
    }
    if (!missing.empty()) {
        reader.refuse({"sea.spectrum", "\"file\"", "comes without " + missing,
                       "\"file\" together with spectrum_file and spectrum_time"});
    }
    if (!reader.spectrum_file || !reader.spectrum_time) return reader.mark_failed("sea.spectrum");
    try {
        sea.measured = load_ndbc(folder / *reader.spectrum_file, *reader.spectrum_time);
    } catch (const NdbcError& error) {
        const NdbcError::Parts& parts = error.parts();
        reader.refuse(
            {parts.about_time ? "sea.spectrum_time" : "sea.spectrum_file",
             parts.about_time ? time_text(*reader.spectrum_time) : quoted_text(*reader.spectrum_file),
             parts.problem, parts.accepted});
        reader.mark_failed("sea.spectrum");
    }
}

// A cage is data of the scene like a measured spectrum.
void load_cage(Reader& reader, const std::filesystem::path& folder, Surface& surface) {
    const std::string key(kCageFile);
    if (reader.has_failed("surface.kind")) return;
    if (surface.kind != SurfaceKind::Cage) {
        if (reader.cage_file && !reader.has_failed(key))
            reader.refuse({key, quoted_text(*reader.cage_file),
                           "is given, but kind is " + quoted_text(word_of(surface.kind)),
                           "this key together with kind = \"cage\""});
        return;
    }
    if (!reader.cage_file) {
        if (!reader.has_failed(key))
            reader.refuse(
                {"surface.kind", "\"cage\"", "comes without cage_file", "\"cage\" together with cage_file"});
        return reader.mark_failed("surface.kind");
    }
    const std::filesystem::path file = folder / *reader.cage_file;
    const auto refuse = [&](std::string problem, std::string accepted) {
        reader.refuse({key, quoted_text(*reader.cage_file), std::move(problem), std::move(accepted)});
        reader.mark_failed("surface.kind");
    };
    try {
        surface.cage = std::make_shared<const Cage>(
            parse_obj(read_text_file(file, kMostObjBytes), line_text(file.filename().string())));
        surface.cage_file = file.string();
    } catch (const TextFileError& error) {
        refuse("the cage " + std::string(error.what()), "a Wavefront OBJ of at most 256 MiB");
    } catch (const ObjError& error) {
        refuse(error.problem(), error.accepted());
    }
}

// Bodies' meshes are data of the scene as well; those of one file are one.
void load_objects(Reader& reader, const std::filesystem::path& folder, std::vector<SceneObject>& objects) {
    std::map<std::string, std::shared_ptr<const ObjectMesh>> read;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const std::string key = std::string(kObjectsKey) + '[' + std::to_string(i) + "].file";
        SceneObject& object = objects[i];
        if (object.file.empty() || reader.has_failed(key)) continue;
        const std::string given = object.file;
        const std::filesystem::path file = folder / given;
        object.file = file.string();
        std::shared_ptr<const ObjectMesh>& mesh = read[object.file];
        if (!mesh) try {
                mesh = load_object(file);
            } catch (const ObjError& error) {
                reader.refuse({key, quoted_text(given), error.problem(), error.accepted()});
            }
        object.mesh = mesh;
    }
}

// A camera's path becomes keys, and is data of the scene as they are.
void load_camera(Reader& reader, const std::filesystem::path& folder, Camera& camera) {
    const std::string key(kCameraFile);
    if (!reader.camera_file || reader.has_failed(key)) return;
    const auto refuse = [&](std::string problem, std::string accepted) {
        reader.refuse({key, quoted_text(*reader.camera_file), std::move(problem), std::move(accepted)});
    };
    if (reader.knows("camera.keys")) return refuse("is given beside camera.keys", "one of the two");
    if (reader.has_failed("camera.resolution")) return;
    try {
        camera.keys =
            parse_chan(read_text_file(folder / *reader.camera_file, kMostChanBytes), camera.resolution);
    } catch (const TextFileError& error) {
        refuse("the camera's path " + std::string(error.what()), "a .chan of at most 16 MiB");
    } catch (const ChanError& error) {
        refuse(error.what(), error.accepted());
    }
}

// Whether there is a file of that name. The system takes a path up to its first NUL.
bool is_file(const std::filesystem::path& file) {
    std::error_code ignored;
    return file.native().find('\0') == std::string::npos && std::filesystem::is_regular_file(file, ignored);
}

// A picture is data of the hosts that make pictures: here only its place is found.
void find_pictures(Reader& reader, const std::filesystem::path& folder, Scene& scene) {
    replace_pictures(scene, [&](const Key& key, const std::string& path) {
        if (reader.has_failed(key.path)) return path;
        const std::filesystem::path file = folder / path;
        if (!is_file(file))
            reader.refuse({key.path, quoted_text(path),
                           "is no file in " + quoted_text(folder.empty() ? "." : folder.string()),
                           key.accepted});
        return file.string();
    });
}

}  // namespace

Scene parse_shot(std::string_view text, const std::filesystem::path& file, const SceneCheck& check_scene) {
    const std::string name = line_text(file.string());
    const auto place_text = [&](std::size_t line, std::size_t column) {
        return name + ':' + std::to_string(line) + ':' + std::to_string(column) + ": ";
    };
    if (const std::optional<BeyondBound> beyond = beyond_bounds(text))
        throw ShotError(place_text(beyond->line, beyond->column) + beyond->problem +
                        "; accepted: " + beyond->accepted);
    toml::table root;
    try {
        root = toml::parse(text);
    } catch (const toml::parse_error& error) {
        const toml::source_position place = error.source().begin;
        throw ShotError(place_text(place.line, place.column) + line_text(error.description()) +
                        "; accepted: TOML 1.0 in UTF-8");
    }
    Reader reader(name);
    Scene scene = read_scene(reader, root);
    load_measured(reader, file.parent_path(), scene.sea);
    load_cage(reader, file.parent_path(), scene.surface);
    load_objects(reader, file.parent_path(), scene.objects);
    load_camera(reader, file.parent_path(), scene.camera);
    find_pictures(reader, file.parent_path(), scene);
    for (const Problem& problem : read_mask_pictures(scene.waves, file.parent_path())) reader.refuse(problem);
    if (!reader.has_failed("sea.depth_file"))
        for (const Problem& problem : read_coast_depths(scene)) reader.refuse(problem);
    for (Problem& problem : validate(scene)) reader.refuse_value(std::move(problem));
    const std::vector<const Key*> pictures = picture_keys(scene);
    if (std::none_of(pictures.begin(), pictures.end(),
                     [&](const Key* key) { return reader.has_failed(key->path); }))
        for (Problem& problem : check_scene(scene)) reader.refuse_value(std::move(problem));
    if (reader.problem_count() > 0) throw ShotError(reader.report());
    return scene;
}

std::string placed(const std::filesystem::path& file, const std::string& problem) {
    std::string place = line_text(file.string());
    try {
        const toml::table root = toml::parse(read_text_file(file, kMostShotBytes));
        const std::string key = problem.substr(0, problem.find(' '));
        if (const toml::node* const value = root.at_path(key).node())
            place += ':' + std::to_string(value->source().begin.line) + ':' +
                     std::to_string(value->source().begin.column);
    } catch (const TextFileError&) {  // gone since
    } catch (const toml::parse_error&) {
    }
    return place + ": " + problem;
}

Scene load_shot(const std::filesystem::path& file, const SceneCheck& check_scene) {
    std::string text;
    try {
        text = read_text_file(file, kMostShotBytes);
    } catch (const TextFileError& error) {
        throw ShotError(line_text(shortened(file.string(), kMostOfPath)) + ": the shot file " + error.what() +
                        "; accepted: a TOML file of at most 16 MiB");
    }
    return parse_shot(text, file, check_scene);
}

}  // namespace pelagic
