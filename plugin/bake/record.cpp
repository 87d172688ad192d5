#include "plugin/bake/record.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "core/base/constants.h"
#include "core/plan/fingerprint.h"
#include "core/plan/mode_lattice.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "core/scene/text.h"
#include "core/spectrum/cox_munk.h"
#include "core/spectrum/viscous_cutoff.h"
#include "core/waves/whitecaps.h"
#include "plugin/files/files.h"

namespace pelagic {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity (deep water, no threshold): null says "none".
Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

// What is not given is null.
struct ToJson {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(double value) const { return number(value); }
    Json operator()(const std::string& text) const { return utf8_text(text); }  // a path may be anything
    Json operator()(const std::vector<KeyEntry>& entries) const {
        Json list = Json::array();
        for (const KeyEntry& entry : entries) {
            Json& made = list.emplace_back(Json::object());
            for (const auto& [name, inner] : entry.values) made[std::string(name)] = std::visit(*this, inner);
        }
        return list;
    }
    template <class Plain>
    Json operator()(const Plain& value) const {
        return value;
    }
};

// Every key that a scene has a value of, by its path.
Json settings(const Scene& scene) {
    Json json = Json::object();
    for (const Key& key : keys())
        if (key.has_value()) json[key.path] = std::visit(ToJson{}, value_of(scene, key));
    return json;
}

Json to_json(const FileRecord& file) {
    Json json{{"bytes", file.bytes}, {"fingerprint", file.fingerprint}};
    if (file.coverage) json["whitecap_coverage"] = *file.coverage;
    if (file.significant_height_m) json["hs_m"] = *file.significant_height_m;
    return json;
}

FileRecord file_from_json(const Json& json) {
    FileRecord file{.bytes = json.at("bytes").get<std::uintmax_t>(),
                    .fingerprint = json.at("fingerprint").get<std::string>()};
    if (json.contains("whitecap_coverage")) file.coverage = json.at("whitecap_coverage").get<double>();
    if (json.contains("hs_m")) file.significant_height_m = json.at("hs_m").get<double>();
    return file;
}

Json to_json(const FrameRecord& frame) {
    Json json;
    json["fingerprint"] = frame.fingerprint;
    json["instruction_set"] = frame.instruction_set;
    json["time_s"] = frame.time_s;
    if (frame.waves) {
        json["hs_m"] = frame.waves->significant_height_m;
        json["tm_minus1_0_s"] = frame.waves->energy_period_s;
        json["mean_direction_deg"] = frame.waves->mean_direction_deg;
        json["mss_resolved"] = frame.waves->mss;
    }
    json["mss_residual"] = frame.mss_residual;
    if (frame.mesh_significant_height_m) json["mesh_hs_m"] = *frame.mesh_significant_height_m;
    if (frame.coverage) json["whitecap_coverage"] = *frame.coverage;
    json["files"] = Json::object();
    for (const auto& [path, file] : frame.files) json["files"][path] = to_json(file);
    return json;
}

FrameRecord from_json(const Json& json) {
    FrameRecord frame;
    frame.fingerprint = json.at("fingerprint").get<std::string>();
    frame.instruction_set = json.at("instruction_set").get<std::string>();
    frame.time_s = json.at("time_s").get<double>();
    if (json.contains("hs_m"))
        frame.waves =
            WaveRecord{json.at("hs_m").get<double>(), json.at("tm_minus1_0_s").get<double>(),
                       json.at("mean_direction_deg").get<double>(), json.at("mss_resolved").get<double>()};
    frame.mss_residual = json.at("mss_residual").get<double>();
    if (json.contains("mesh_hs_m")) frame.mesh_significant_height_m = json.at("mesh_hs_m").get<double>();
    if (json.contains("whitecap_coverage")) frame.coverage = json.at("whitecap_coverage").get<double>();
    for (const auto& [path, file] : json.at("files").items()) frame.files[path] = file_from_json(file);
    return frame;
}

// Each frame of a record in turn, so that never more than one of them is in memory; whether it could be read
// to its end.
bool read_frames(const std::filesystem::path& file, const std::function<void(int, FrameRecord)>& take) {
    constexpr int kSection = 1, kFrame = 2;  // depths
    std::string section, frame;
    const auto at_event = [&](int depth, Json::parse_event_t event, const Json& parsed) {
        if (event == Json::parse_event_t::key && depth == kSection) section = parsed;
        if (event == Json::parse_event_t::key && depth == kFrame) frame = parsed;
        if (event != Json::parse_event_t::object_end || depth != kFrame || section != "frames") return true;
        take(std::stoi(frame), from_json(parsed));
        return false;
    };
    std::ifstream stream(file, std::ios::binary);
    try {
        [[maybe_unused]] const Json rest = Json::parse(stream, at_event);
    } catch (const files::FileError&) {
        throw;  // of who takes the frames
    } catch (const std::exception&) {
        return false;
    }
    return true;
}

// The object's lines without its own brackets, each after a line's end and `indent`.
std::string lines_inside(const Json& object, const std::string& indent) {
    std::istringstream lines(object.dump(2));
    std::string text;
    for (std::string line; std::getline(lines, line);)
        if (line != "{" && line != "}") text += "\n" + indent + line;
    return text;
}

}  // namespace

std::map<int, FrameRecord> recorded_frames(const std::filesystem::path& file) {
    std::map<int, FrameRecord> frames;
    if (!read_frames(file, [&](int number, FrameRecord frame) { frames[number] = std::move(frame); }))
        frames.clear();
    return frames;
}

void Record::describe(const Plan& plan, const SpectralMoments& total, double whitecap_threshold) {
    const Scene& scene = plan.from->scene;
    first_frame_ = scene.shot.first_frame;
    last_frame_ = scene.shot.last_frame;
    Json& shot = shot_;
    shot = Json::object();
    shot["pelagic"] = PELAGIC_VERSION;
    shot["name"] = scene.shot.name;
    for (const PlannedOutput& output : plan.outputs)
        shot["fingerprints"][plan.queries[output.query].query.name] = output_fingerprint(plan, output);
    shot["precision"] = plan.knobs.double_precision ? "double" : "single";
    shot["frame_range"] = {scene.shot.first_frame, scene.shot.last_frame};
    shot["fps"] = scene.shot.fps;
    shot["settings"] = settings(scene);

    Json& spectrum = shot["spectrum"];
    spectrum["kind"] = word_of(scene.sea.spectrum);
    spectrum["hs_m"] = total.significant_height_m();
    spectrum["tm_minus1_0_s"] = total.energy_period_s();
    spectrum["mean_direction_deg"] = total.mean_direction() * 180.0 / kPi;
    spectrum["mss"] = total.mss();
    spectrum["slope_variance_xx_yy_xy"] = {total.xx, total.yy, total.xy};
    spectrum["dispersion"] = "gravity and capillarity, finite depth";
    spectrum["viscous_cutoff_rad_per_m"] = kViscousWavenumber;
    spectrum["depth_m"] = number(scene.sea.depth_m);
    if (scene.sea.measured) {
        spectrum["station"] = scene.sea.measured->station;
        spectrum["measured_at"] = scene.sea.measured->time;
    }

    const auto observed = CoxMunk::at_wind(scene.sea.wind_speed_mps);
    shot["observed"] = {
        {"cox_munk_1954_mss", observed.total},
        {"cox_munk_1954_mss_upwind", observed.up},
        {"cox_munk_1954_mss_crosswind", observed.cross},
        {"monahan_omuircheartaigh_1980_coverage", observed_coverage(scene.sea.wind_speed_mps)}};
    shot["whitecap_threshold"] = number(whitecap_threshold);

    Json& planned = shot["plan"];
    planned["transforms_per_frame"] = plan.transforms_per_frame();
    planned["sea_bytes"] = plan.sea_bytes();
    planned["frame_bytes"] = plan.frame_bytes();
    planned["output_bytes"] = plan.output_bytes();
    if (plan.trains)
        planned["trains"] = {{"count", plan.trains->count},
                             {"longest_m", plan.trains->longest_m},
                             {"shortest_m", plan.trains->shortest_m}};
    planned["cascades"] = Json::array();
    for (const CascadePlan& cascade : plan.cascades)
        planned["cascades"].push_back({{"size_m", cascade.size_m},
                                       {"resolution", cascade.resolution},
                                       {"k_lower_rad_per_m", cascade.k_lower},
                                       {"k_upper_rad_per_m", number(cascade.k_upper)},
                                       {"modes", lattice_modes(cascade.grid_radius())}});
}

bool is_whole(const FrameRecord& frame, const std::string& path, const std::string& fingerprint,
              const std::filesystem::path& folder) {
    const auto found = frame.files.find(path);
    return found != frame.files.end() && found->second.fingerprint == fingerprint &&
           files::file_size(folder / path) == found->second.bytes &&
           files::carries(folder / path, fingerprint);
}

void Record::save(const std::filesystem::path& file) {
    const files::FolderLock lock(file.parent_path());
    files::write_atomically(file, [&](const files::ByteSink& sink) { write(file, sink); });
    unsaved_.clear();
}

// As one JSON object would be printed, frames by rising number, those of `former` merged with ours.
void Record::write(const std::filesystem::path& former,
                   const std::function<void(std::string_view)>& sink) const {
    constexpr std::size_t kPiece = 1 << 16;  // bytes: a piece is a call of the system
    std::string piece = "{" + lines_inside(shot_, "") + ",\n  \"frames\": {";
    std::optional<int> last;
    const auto add = [&](int number, const FrameRecord& frame) {
        if (last && number <= *last) return;  // ours have taken its place, or somebody has mixed them up
        if (number < first_frame_ || number > last_frame_) return;
        if (last) piece += ',';
        last = number;
        piece += lines_inside({{std::to_string(number), to_json(frame)}}, "  ");
        if (piece.size() < kPiece) return;
        sink(piece);
        piece.clear();
    };
    auto ours = unsaved_.begin();
    const auto add_ours_up_to = [&](int number) {
        for (; ours != unsaved_.end() && ours->first <= number; ++ours) add(ours->first, ours->second);
    };
    // Where the former one can't be read any further, ours goes on without it.
    read_frames(former, [&](int number, const FrameRecord& frame) {
        add_ours_up_to(number);
        add(number, frame);
    });
    add_ours_up_to(std::numeric_limits<int>::max());
    sink(piece + (last ? "\n  }\n}\n" : "}\n}\n"));
}

}  // namespace pelagic
