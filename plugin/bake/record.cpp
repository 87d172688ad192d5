#include "plugin/bake/record.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/scene/canonical.h"
#include "core/scene/names.h"
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

// The canonical lines: numbers as numbers, words as text, a key of several lines (swells, cascades, …) as a
// list.
Json settings(const Scene& scene) {
    Json lines = Json::object();
    std::istringstream text(canonical(scene));
    for (std::string line; std::getline(text, line);) {
        const std::size_t equals = line.find(" = ");
        if (equals == std::string::npos) continue;
        const std::string key = line.substr(0, equals), words = line.substr(equals + 3);
        Json value = Json::parse(words, nullptr, false);
        if (value.is_discarded()) value = words;
        if (!lines.contains(key)) {
            lines[key] = value;
        } else {
            if (!lines[key].is_array()) lines[key] = Json::array({lines[key]});
            lines[key].push_back(value);
        }
    }
    return lines;
}

// Whether the fingerprint stands near one end of the file: maps and layers in text carry it among their first
// lines, crates among the tokens after the arrays.
bool carries(const std::filesystem::path& file, const std::string& fingerprint) {
    constexpr std::streamoff kEnd = 8192;  // bytes; what lies before or behind it takes one or two thousand
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    const std::streamoff size = stream.tellg();
    const auto stands_from = [&](std::streamoff begin) {
        std::string bytes(kEnd, '\0');
        stream.clear();
        stream.seekg(begin);
        stream.read(bytes.data(), kEnd);
        bytes.resize(static_cast<std::size_t>(stream.gcount()));
        return bytes.find(fingerprint) != std::string::npos;
    };
    return stream && (stands_from(0) || stands_from(std::max<std::streamoff>(size - kEnd, 0)));
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
    for (const auto& [path, size] : frame.files) json["files"][path] = size;
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
    for (const auto& [path, size] : json.at("files").items()) frame.files[path] = size.get<std::uintmax_t>();
    return frame;
}

}  // namespace

Record Record::load(const std::filesystem::path& file) {
    Record record;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return record;
    // Frame after frame, so that never more than one of them is in memory as JSON.
    constexpr int kSection = 1, kFrame = 2;  // depths
    std::string section, frame;
    const auto take = [&](int depth, Json::parse_event_t event, const Json& parsed) {
        if (event == Json::parse_event_t::key && depth == kSection) section = parsed;
        if (event == Json::parse_event_t::key && depth == kFrame) frame = parsed;
        if (event != Json::parse_event_t::object_end || depth != kFrame || section != "frames") return true;
        record.frames_[std::stoi(frame)] = from_json(parsed);
        return false;
    };
    try {
        [[maybe_unused]] const Json rest = Json::parse(stream, take);
    } catch (const std::exception&) {
        record.frames_.clear();
    }
    return record;
}

void Record::describe(const Scene& scene, const Plan& plan, const SpectralMoments& total,
                      double whitecap_threshold) {
    Json& shot = shot_;
    shot = Json::object();
    shot["pelagic"] = PELAGIC_VERSION;
    shot["name"] = scene.shot.name;
    shot["fingerprint"] = plan.fingerprint_text();
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
    planned["cascades"] = Json::array();
    for (const CascadePlan& cascade : plan.cascades)
        planned["cascades"].push_back({{"size_m", cascade.size_m},
                                       {"resolution", cascade.resolution},
                                       {"k_lower_rad_per_m", cascade.k_lower},
                                       {"k_upper_rad_per_m", number(cascade.k_upper)},
                                       {"modes", lattice_modes(cascade.grid_radius())}});
}

bool Record::is_whole(int frame, const std::string& fingerprint, const std::filesystem::path& folder) const {
    const auto found = frames_.find(frame);
    if (found == frames_.end() || found->second.fingerprint != fingerprint) return false;
    for (const auto& [path, size] : found->second.files)
        if (files::file_size(folder / path) != size || !carries(folder / path, fingerprint)) return false;
    return true;
}

void Record::save(const std::filesystem::path& file) {
    const files::FolderLock lock(file.parent_path());
    for (const auto& [frame, entry] : load(file).frames_)
        if (!own_.contains(frame)) frames_[frame] = entry;
    files::write_atomically(file, [this](const files::ByteSink& sink) { write(sink); });
}

// As one JSON object would be printed, but frame after frame, for the same reason as in load().
void Record::write(const std::function<void(std::string_view)>& sink) const {
    constexpr std::size_t kPiece = 1 << 16;  // bytes: a piece is a call of the system
    const auto inside = [](const Json& object, const std::string& indent) {
        std::istringstream lines(object.dump(2));
        std::string text;
        for (std::string line; std::getline(lines, line);)
            if (line != "{" && line != "}") text += "\n" + indent + line;
        return text;
    };
    std::string piece = "{" + inside(shot_, "") + ",\n  \"frames\": {";
    for (const auto& [number_of_frame, frame] : frames_) {
        if (number_of_frame != frames_.begin()->first) piece += ',';
        piece += inside({{std::to_string(number_of_frame), to_json(frame)}}, "  ");
        if (piece.size() < kPiece) continue;
        sink(piece);
        piece.clear();
    }
    sink(piece + (frames_.empty() ? "}\n}\n" : "\n  }\n}\n"));
}

}  // namespace pelagic
