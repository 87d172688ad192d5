#include "plugin/run/record.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <istream>
#include <limits>
#include <span>
#include <sstream>
#include <stdexcept>
#include <streambuf>
#include <system_error>
#include <thread>
#include <utility>

#include "core/base/build_watch.h"
#include "core/base/constants.h"
#include "core/base/text.h"
#include "core/plan/fingerprint.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/random_tiling.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/spectrum/cox_munk.h"
#include "core/spectrum/viscous_cutoff.h"
#include "core/waves/whitecaps.h"
#include "pelagic/version.h"
#include "plugin/files/checksum.h"
#include "plugin/files/read.h"
#include "plugin/light/light.h"

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
    Json operator()(const NumberKeys& number) const {
        Json keys = Json::array();
        for (const auto& [frame, value] : number.keys) keys.push_back({frame, value});
        return {{"keys", keys}, {"interpolation", word_of(number.interpolation)}};
    }
    template <class Plain>
    Json operator()(const Plain& value) const {
        return value;
    }
};

// Every key's value, by its path.
Json settings(const Scene& scene) {
    Json json = Json::object();
    for (const Key& key : keys()) json[key.path] = std::visit(ToJson{}, value_of(scene, key));
    // A cascade that says nothing of its choppiness has the record that it had before it could.
    for (Json& cascade : json["waves.cascades"])
        if (cascade["choppiness"].is_null()) cascade.erase("choppiness");
    return json;
}

Json to_json(const SprayRecord& spray) {
    return {{"breaking_over_mean", spray.breaking_over_mean},
            {"mass_flux_kg_per_s", spray.mass_flux_kg_per_s},
            {"optical_thickness", spray.optical_thickness}};
}

// The library's own conversion takes any number: of one beyond the type it makes something else.
template <class Integer>
Integer integer_from(const Json& json) {
    const bool is_in_range = json.is_number_unsigned()  ? std::in_range<Integer>(json.get<std::uint64_t>())
                             : json.is_number_integer() ? std::in_range<Integer>(json.get<std::int64_t>())
                                                        : false;
    if (!is_in_range) throw Json::type_error::create(302, "no integer of its type", &json);
    return json.get<Integer>();
}

std::optional<SprayRecord> spray_from_json(const Json& json) {
    const auto spray = json.find("spray");
    if (spray == json.end()) return {};
    return SprayRecord{.breaking_over_mean = spray->at("breaking_over_mean").get<double>(),
                       .mass_flux_kg_per_s = spray->at("mass_flux_kg_per_s").get<double>(),
                       .optical_thickness = spray->at("optical_thickness").get<double>()};
}

Json to_json(const FileRecord& file) {
    Json json{{"bytes", file.bytes}, {"checksum", file.checksum}};
    if (!file.fingerprint.empty()) json["fingerprint"] = file.fingerprint;
    if (file.coverage) json["whitecap_coverage"] = *file.coverage;
    if (file.significant_height_m) json["hs_m"] = *file.significant_height_m;
    if (file.spray) json["spray"] = to_json(*file.spray);
    return json;
}

FileRecord file_from_json(const Json& json) {
    FileRecord file{.bytes = integer_from<std::uintmax_t>(json.at("bytes")),
                    .checksum = json.at("checksum").get<std::string>(),
                    .fingerprint = json.value("fingerprint", std::string())};
    if (json.contains("whitecap_coverage")) file.coverage = json.at("whitecap_coverage").get<double>();
    if (json.contains("hs_m")) file.significant_height_m = json.at("hs_m").get<double>();
    file.spray = spray_from_json(json);
    return file;
}

Json to_json(const FrameRecord& frame) {
    Json json;
    json["fingerprint"] = frame.fingerprint;
    if (frame.is_stale) json["stale"] = true;
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
    if (frame.spray) json["spray"] = to_json(*frame.spray);
    json["files"] = Json::object();
    for (const auto& [path, file] : frame.files) json["files"][path] = to_json(file);
    return json;
}

FrameRecord from_json(const Json& json) {
    FrameRecord frame;
    frame.fingerprint = json.at("fingerprint").get<std::string>();
    frame.is_stale = json.value("stale", false);
    frame.instruction_set = json.at("instruction_set").get<std::string>();
    frame.time_s = json.at("time_s").get<double>();
    if (json.contains("hs_m"))
        frame.waves =
            WaveRecord{json.at("hs_m").get<double>(), json.at("tm_minus1_0_s").get<double>(),
                       json.at("mean_direction_deg").get<double>(), json.at("mss_resolved").get<double>()};
    frame.mss_residual = json.at("mss_residual").get<double>();
    if (json.contains("mesh_hs_m")) frame.mesh_significant_height_m = json.at("mesh_hs_m").get<double>();
    if (json.contains("whitecap_coverage")) frame.coverage = json.at("whitecap_coverage").get<double>();
    frame.spray = spray_from_json(json);
    for (const auto& [path, file] : json.at("files").items()) frame.files[path] = file_from_json(file);
    return frame;
}

// As text of which checksums are made. What isn't UTF-8 (in a path) is replaced: JSON has no other text.
std::string text_of(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// Of a part of the record: its content but for the checksum itself, and its key.
std::string checksum_of(const std::string& key, Json part) {
    part.erase("checksum");
    return files::checksum_of(key + text_of(part));
}

bool is_as_written(const std::string& key, const Json& part) {
    return part.is_object() && part.contains("checksum") && part.at("checksum") == checksum_of(key, part);
}

ShotRecord shot_from_json(const Json& json) {
    ShotRecord shot{.name = json.at("name").get<std::string>(),
                    .first_frame = integer_from<int>(json.at("frame_range").at(0)),
                    .last_frame = integer_from<int>(json.at("frame_range").at(1)),
                    .files = {},
                    .chosen = json.value("chosen", std::string())};
    for (const auto& [path, file] : json.at("files").items()) shot.files[path] = file_from_json(file);
    return shot;
}

// The bytes of a file for a parser. Ends where a single frame would be larger than any is, so that a file of
// anything in the record's place fills no memory and takes no time.
class Bytes final : public std::streambuf {
  public:
    Bytes(files::FileReader& file, const std::atomic<bool>* cancel) : file_(file), cancel_(cancel) {}

    void begin_part() { left_ = kLargestPart; }
    // A zero ends a text for the parser; in ours there is none.
    bool had_zero() const { return had_zero_; }
    void end() {  // nothing more is read
        left_ = 0;
        setg(eback(), egptr(), egptr());
    }

  private:
    static constexpr std::size_t kLargestPart = std::size_t{64} << 20;  // [bytes] camera keys for 1e5 frames

    int_type underflow() override {
        stop_if(cancel_);
        const std::size_t got = file_.read(std::span(piece_).first(std::min(piece_.size(), left_)));
        if (got == 0) return traits_type::eof();
        left_ -= got;
        had_zero_ = had_zero_ || std::memchr(piece_.data(), 0, got) != nullptr;
        setg(piece_.data(), piece_.data(), piece_.data() + got);
        return traits_type::to_int_type(piece_.front());
    }

    files::FileReader& file_;
    const std::atomic<bool>* cancel_;
    std::vector<char> piece_ = std::vector<char>(std::size_t{1} << 16);
    std::size_t left_ = kLargestPart;
    bool had_zero_ = false;
};

// The object's lines without its own brackets, each after a line's end and `indent`.
std::string lines_inside(const Json& object, const std::string& indent) {
    std::istringstream lines(text_of(object, 2));
    std::string text;
    for (std::string line; std::getline(lines, line);)
        if (line != "{" && line != "}") text += "\n" + indent + line;
    return text;
}

}  // namespace

RecordReading read_record(const std::filesystem::path& file,
                          const std::function<void(int, FrameRecord)>& take,
                          const std::atomic<bool>* cancel) {
    constexpr int kSection = 1, kFrame = 2, kDeepest = 16;  // depths
    RecordReading reading;
    files::FileReader reader(file);
    if (!reader.problem().empty()) {
        reading.problem = reader.problem();
        reading.is_missing = reader.is_missing();
        reading.is_blocked = !reading.is_missing;
        return reading;
    }
    Bytes bytes(reader, cancel);
    std::string section, number;
    const auto take_frame = [&](const Json& parsed) {
        bytes.begin_part();
        int frame = 0;
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), frame);
        if (error != std::errc() || end != number.data() + number.size()) return;
        if (!is_as_written(number, parsed)) return reading.altered.push_back(frame);
        FrameRecord record;
        try {
            record = from_json(parsed);
        } catch (const Json::exception&) {  // another version's
            return reading.altered.push_back(frame);
        }
        take(frame, std::move(record));
    };
    const auto at_event = [&](int depth, Json::parse_event_t event, const Json& parsed) {
        if (depth > kDeepest) bytes.end();
        if (event == Json::parse_event_t::key && depth == kSection) section = parsed;
        if (event == Json::parse_event_t::key && depth == kFrame) number = parsed;
        if (event != Json::parse_event_t::object_end || depth != kFrame || section != "frames") return true;
        take_frame(parsed);
        return false;
    };
    Json shot;
    bool is_read = false;
    try {
        std::istream stream(&bytes);
        shot = Json::parse(stream, at_event);
        is_read = !bytes.had_zero();
    } catch (const Json::exception&) {
    }
    if (!is_read) {
        reading.problem = reader.problem().empty() ? "is damaged, or no record of a bake" : reader.problem();
        return reading;
    }
    if (!shot.is_object() || !shot.contains("checksum")) {
        reading.problem = "is no record of a bake, or an older version's";
        return reading;
    }
    shot.erase("frames");
    try {
        if (is_as_written("", shot)) reading.shot = shot_from_json(shot);
    } catch (const Json::exception&) {
    }
    if (!reading.shot) reading.problem = "was altered in what it says about the shot";
    return reading;
}

void Record::describe(const Plan& plan, const SpectralMoments& total, double whitecap_threshold,
                      double residual_coverage) {
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
    shot["files"] = Json::object();

    if (scene.surface.cage) shot["cage"] = scene.surface.cage->content();
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

    const Scene first = scene_at(scene, scene.shot.first_frame);  // as `total` is, of a sea that changes
    const auto observed = CoxMunk::at_wind(first.sea.wind_speed_mps);
    shot["observed"] = {{"cox_munk_1954_mss", observed.total},
                        {"cox_munk_1954_mss_upwind", observed.up},
                        {"cox_munk_1954_mss_crosswind", observed.cross},
                        {"whitecap_law", word_of(scene.effects.whitecap_law)},
                        {"whitecap_law_coverage", law_coverage(first)}};
    shot["whitecap_threshold"] = number(whitecap_threshold);
    if (plan.gusts) shot["whitecap_threshold_is"] = "without gusts, which move it from place to place";
    // A bake refuses keys of how foam looks (plugin/bake/bake.cpp).
    const FoamLook foam = make_foam(first, nullptr, active_foam(scene, residual_coverage));
    shot["dense_foam"] = {{"active", foam.fresh_opacity}, {"left", foam.old_opacity}};

    Json& planned = shot["plan"];
    planned["transforms_per_frame"] = plan.transforms_per_frame();
    planned["sea_bytes"] = plan.sea_bytes();
    planned["frame_bytes"] = plan.frame_bytes();
    planned["output_bytes"] = plan.output_bytes();
    if (plan.trains && plan.trains->count > 0)
        planned["trains"] = {{"count", plan.trains->count},
                             {"longest_m", plan.trains->longest_m},
                             {"shortest_m", plan.trains->shortest_m}};
    planned["cascades"] = Json::array();
    for (const CascadePlan& cascade : plan.cascades) {
        const auto number_of = static_cast<int>(planned["cascades"].size());
        Json& row =
            planned["cascades"].emplace_back(Json{{"size_m", cascade.size_m},
                                                  {"resolution", cascade.resolution},
                                                  {"k_lower_rad_per_m", cascade.k_lower},
                                                  {"k_upper_rad_per_m", number(cascade.k_upper)},
                                                  {"modes", lattice_modes(cascade.amplitude_radius())}});
        if (cascade.vessel) {
            row["of"] = "a vessel";
            continue;
        }
        const auto& asked = plan.from->scene.waves.cascades;
        if (!asked.empty() && asked[static_cast<std::size_t>(number_of)].choppiness)
            row["choppiness"] = *asked[static_cast<std::size_t>(number_of)].choppiness;
        // By these and the rule of core/plan/random_tiling.h the tiles add up to the sea.
        if (cascade.has_random_tiling)
            row["copies"] = {{"key", tiling_key(plan.from->scene.shot.seed, number_of)},
                             {"ramp", kBlendRamp}};
    }
}

void Record::set(const std::string& path, const files::FileState& file) {
    shot_["files"][path] = to_json(FileRecord{.bytes = file.bytes, .checksum = file.checksum});
}

void Record::refuse_other_choice(const std::filesystem::path& former) const {
    if (choices_.empty() || written_) return;
    const auto shot = read_record(former, [](int, const FrameRecord&) {}).shot;
    if (!shot || shot->chosen.empty() ||
        std::find(choices_.begin(), choices_.end(), shot->chosen) != choices_.end())
        return;
    throw std::invalid_argument("another run into " + line_text(former.parent_path().string()) +
                                " has begun meanwhile, with other settings (" + line_text(shot->chosen) +
                                "; here it would be " + choices_.front() +
                                "): run the same command again, and it takes those");
}

void Record::save(const std::filesystem::path& file, const files::LockWatch& waiting,
                  const std::function<void()>& begin) {
    const files::FolderLock lock(file.parent_path(), waiting);
    unlocked_ = lock.problem();
    std::vector<int> found;
    // With a lock that holds, once.
    for (bool is_done = false; !is_done;) {
        const files::FileIdentity former = files::identity_of(file);
        refuse_other_choice(file);
        if (begin) begin();
        const bool is_ours = written_ && former == *written_;
        const auto made = files::replace_if_same(
            file, former, [&](const files::ByteSink& sink) { found = write(file, sink); });
        is_done = made.has_value();
        is_shared_ = is_shared_ || !is_done || (written_ && !is_ours);
        if (is_done && is_ours) saved_.clear();  // all of them are in it
        if (is_done) written_ = made;
    }
    for (const int frame : found) saved_.erase(frame);
    for (auto& [frame, record] : unsaved_) saved_[frame] = std::move(record);
    unsaved_.clear();
}

void Record::finish(const std::filesystem::path& file, const files::LockWatch& waiting) {
    // Longer than a run needs between its last look at the record and its renaming of the next one.
    constexpr std::chrono::milliseconds kMoment{200};
    constexpr int kMostTimes = 10;  // two runs that make the same frames of different shots would never agree
    save(file, waiting);
    for (int times = 0; is_shared_ && times < kMostTimes; ++times) {
        std::this_thread::sleep_for(kMoment);
        if (files::identity_of(file) == *written_ || is_all_in(file)) return;
        save(file, waiting);
    }
}

bool Record::is_all_in(const std::filesystem::path& file) const {
    std::size_t found = 0;
    read_record(file, [&](int number, const FrameRecord& frame) {
        const auto ours = saved_.find(number);
        found += ours != saved_.end() && to_json(ours->second) == to_json(frame);
    });
    return found == saved_.size();
}

// As one JSON object would be printed, frames by rising number, those of `former` merged with ours.
std::vector<int> Record::write(const std::filesystem::path& former,
                               const std::function<void(std::string_view)>& sink) const {
    constexpr std::size_t kPiece = 1 << 16;  // bytes: a piece is a call of the system
    Json shot = shot_;
    shot["checksum"] = checksum_of("", shot);
    std::string piece = "{" + lines_inside(shot, "") + ",\n  \"frames\": {";
    std::optional<int> last;
    const auto add = [&](int number, const FrameRecord& frame) {
        if (last && number <= *last) return;  // ours have taken its place, or somebody has mixed them up
        if (number < first_frame_ || number > last_frame_) return;
        if (last) piece += ',';
        last = number;
        const std::string key = std::to_string(number);
        Json entry = to_json(frame);
        entry["checksum"] = checksum_of(key, entry);
        piece += lines_inside({{key, std::move(entry)}}, "  ");
        if (piece.size() < kPiece) return;
        sink(piece);
        piece.clear();
    };
    // By rising number; of the same frame the one that was set later comes first.
    auto saved = saved_.begin(), unsaved = unsaved_.begin();
    const auto add_ours_up_to = [&](int number) {
        const auto is_next = [&](const auto& at, const auto& of) {
            return at != of.end() && at->first <= number;
        };
        while (is_next(unsaved, unsaved_) || is_next(saved, saved_)) {
            auto& next =
                !is_next(saved, saved_) || (is_next(unsaved, unsaved_) && unsaved->first <= saved->first)
                    ? unsaved
                    : saved;
            add(next->first, next->second);
            ++next;
        }
    };
    std::vector<int> found;
    // Where the former one can't be read any further, ours goes on without it.
    read_record(former, [&](int number, FrameRecord frame) {
        add_ours_up_to(number);
        if (const auto ours = saved_.find(number);
            ours != saved_.end() && to_json(ours->second) == to_json(frame))
            found.push_back(number);
        if (is_stale_) frame.is_stale = is_stale_(number, frame);
        add(number, frame);
    });
    add_ours_up_to(std::numeric_limits<int>::max());
    sink(piece + (last ? "\n  }\n}\n" : "}\n}\n"));
    return found;
}

}  // namespace pelagic
