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
#include "plugin/run/fragments.h"

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

// Every key's value, by its path. Bodies aren't among them: what files depend on of their hulls is in the fingerprints.
Json settings(const Scene& scene) {
    Json json = Json::object();
    for (const Key& key : keys())
        if (key.path != kObjectsKey) json[key.path] = std::visit(ToJson{}, value_of(scene, key));
    // A cascade that says nothing of its choppiness has the record that it had before it could.
    for (Json& cascade : json["waves.cascades"])
        if (cascade["choppiness"].is_null()) cascade.erase("choppiness");
    for (Json& mask : json["waves.masks"])  // likewise
        if (mask["picture"].is_null()) mask.erase("picture");
    if (!scene.waves.coast) json.erase(std::string(kCoastKey));
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

// Of the shot's part, but for what files of no frame name: a task knows fewer frames than the shot has.
std::string version_of(Json shot) {
    shot.erase("files");
    shot.erase("checksum");
    return text_of(shot);
}

// What a record says of the shot.
void take_shot(Json shot, RecordReading& reading) {
    if (!shot.is_object() || !shot.contains("checksum")) {
        reading.problem = "is no record of a bake, or an older version's";
        return;
    }
    try {
        if (is_as_written("", shot)) reading.shot = shot_from_json(shot);
    } catch (const Json::exception&) {
    }
    if (reading.shot)
        reading.version = version_of(std::move(shot));
    else
        reading.problem = "was altered in what it says about the shot";
}

// Hands over what a record says of a frame; `number` is its key.
void take_entry(const std::string& number, const Json& entry, RecordReading& reading,
                const std::function<void(int, FrameRecord)>& take) {
    int frame = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), frame);
    if (error != std::errc() || end != number.data() + number.size()) return;
    if (!is_as_written(number, entry)) return reading.altered.push_back(frame);
    FrameRecord record;
    try {
        record = from_json(entry);
    } catch (const Json::exception&) {  // another version's
        return reading.altered.push_back(frame);
    }
    take(frame, std::move(record));
}

void remove_fragment(const std::filesystem::path& fragment) {
    std::error_code ignored;
    std::filesystem::remove(fragment, ignored);
    std::filesystem::remove(fragment.parent_path(), ignored);  // if it is empty
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
    const auto at_event = [&](int depth, Json::parse_event_t event, const Json& parsed) {
        if (depth > kDeepest) bytes.end();
        if (event == Json::parse_event_t::key && depth == kSection) section = parsed;
        if (event == Json::parse_event_t::key && depth == kFrame) number = parsed;
        if (event != Json::parse_event_t::object_end || depth != kFrame || section != "frames") return true;
        bytes.begin_part();
        take_entry(number, parsed, reading, take);
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
    if (shot.is_object()) shot.erase("frames");
    take_shot(std::move(shot), reading);
    return reading;
}

bool is_read_in_part(const std::filesystem::path& file, std::span<const int> frames) {
    return frames.size() <= kFewFrames && files::file_size(file).value_or(0) >= kSmallRecord;
}

RecordReading read_frames(const std::filesystem::path& file, std::span<const int> frames,
                          const std::function<void(int, FrameRecord)>& take, std::set<int>* numbers,
                          const std::atomic<bool>* cancel) {
    // As write() lays a record out: entries are what begins and ends with four spaces.
    constexpr std::string_view kFrames = ",\n  \"frames\": {", kBegin = "\n    \"", kEnd = "\n    }",
                               kLast = "\n  }\n}\n";
    const auto whole = [&] {
        return read_record(
            file,
            [&](int number, FrameRecord frame) {
                if (numbers && !frame.is_stale) numbers->insert(number);
                take(number, std::move(frame));
            },
            cancel);
    };
    constexpr std::uintmax_t kLargest = std::uintmax_t{1}
                                        << 30;  // [bytes] 1e5 frames: anything may be in its place
    const std::uintmax_t size = files::file_size(file).value_or(0);
    if (!is_read_in_part(file, frames) || size > kLargest || !files::carries(file, "{\n  \"pelagic\": "))
        return whole();
    files::FileReader reader(file);
    std::string text(kLast.size(), '\0');
    reader.seek(size - text.size());
    text.resize(reader.read(text));
    if (text != kLast) return whole();
    // Piece by piece: a task of one frame looks through the entries of ten thousand.
    constexpr std::size_t kPiece = std::size_t{1} << 18;
    reader.seek(0);
    text.clear();
    bool is_at_end = false;
    const auto read_on = [&] {
        stop_if(cancel);
        const std::size_t before = text.size();
        text.resize(before + kPiece);
        const std::size_t got = reader.read(std::span(text).subspan(before));
        text.resize(before + got);
        is_at_end = got < kPiece;
    };
    std::size_t begin = std::string::npos;
    while (begin == std::string::npos && !is_at_end) {
        const std::size_t from = text.size() - std::min(text.size(), kFrames.size());
        read_on();
        begin = text.find(kFrames, from);
    }
    RecordReading reading;
    const auto parsed = [](const std::string& part) { return Json::parse(part, nullptr, false); };
    if (begin != std::string::npos) take_shot(parsed(text.substr(0, begin) + '}'), reading);
    if (!reading.shot) return whole();
    if (!numbers && frames.empty()) return reading;
    text.erase(0, begin);
    for (std::size_t at = text.find(kBegin);;) {
        while (at == std::string::npos && !is_at_end) {
            text.erase(0, text.size() - std::min(text.size(), kBegin.size()));
            read_on();
            at = text.find(kBegin);
        }
        if (at == std::string::npos) break;
        std::size_t next = text.find(kBegin, at + 1);
        while (next == std::string::npos && !is_at_end) {
            text.erase(0, at);
            const std::size_t from = text.size() - std::min(text.size() - 1, kBegin.size());
            at = 0;
            read_on();
            next = text.find(kBegin, from);
        }
        const std::string_view entry =
            std::string_view(text).substr(at + kBegin.size(), next - at - kBegin.size());
        int number = 0;
        const auto [end, error] = std::from_chars(entry.data(), entry.data() + entry.size(), number);
        const auto after = static_cast<std::size_t>(end - entry.data());
        if (error != std::errc() || !entry.substr(after).starts_with("\": {")) return whole();
        // std::string_view looks at each quotation mark.
        constexpr std::string_view kStale = "\"stale\": true";
        if (numbers && !memmem(entry.data(), entry.size(), kStale.data(), kStale.size()))
            numbers->insert(numbers->end(), number);
        if (std::binary_search(frames.begin(), frames.end(), number)) {
            const std::size_t last = entry.find(kEnd, after);
            const Json json = parsed(std::string(entry.substr(
                after + 3, last == std::string_view::npos ? 0 : last + kEnd.size() - after - 3)));
            take_entry(std::to_string(number), json, reading, take);
        }
        at = next;
    }
    return reader.problem().empty() ? reading : whole();
}

RecordReading read_shot_part(const std::filesystem::path& file, const std::atomic<bool>* cancel) {
    return read_frames(
        file, {}, [](int, const FrameRecord&) {}, nullptr, cancel);
}

std::string made_of(const std::map<std::string, FileRecord>& files) {
    Fingerprint all;
    for (const auto& [path, file] : files) all.add(path).add(file.fingerprint);
    return all.text();
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
    for (const WaveMask& mask : scene.waves.masks)
        if (const MaskPicture* picture = picture_of(scene.waves, mask))
            shot["mask_pictures"].push_back(picture->content());
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

void Record::set(const std::string& path, const FileRecord& file) {
    shot_["files"][path] = to_json(file);
}

void Record::refuse_other_choice(const RecordReading& there, const std::filesystem::path& file) const {
    if (choices_.empty() || !there.shot || there.shot->chosen.empty() ||
        std::find(choices_.begin(), choices_.end(), there.shot->chosen) != choices_.end())
        return;
    throw ChosenMeanwhile("another run into " + line_text(file.parent_path().string()) +
                          " has begun meanwhile, with other settings (" + line_text(there.shot->chosen) +
                          "; here it would be " + choices_.front() +
                          "): run the same command again, and it takes those");
}

void Record::refuse_begun_anew(const RecordReading& there, const std::filesystem::path& file) const {
    if (!there.shot || there.version == version_of(shot_)) return;
    throw BegunAnew("another run has begun another version of " + line_text(there.shot->name) + " in " +
                    line_text(file.parent_path().string()) +
                    ": this one stops; the same command again makes what the shot file says by then");
}

void Record::refuse_other_version(const std::filesystem::path& file) {
    const files::FileIdentity now = files::identity_of(file);
    if (now == seen_) return;
    refuse_begun_anew(read_shot_part(file), file);
    seen_ = now;
}

void Record::begin(const std::filesystem::path& file, const files::LockWatch& waiting,
                   const WriteStatic& write_static, bool makes_frames) {
    const files::FolderLock lock(file.parent_path(), waiting);
    unlocked_ = lock.problem();
    // With a lock that holds, once.
    for (bool is_done = false; !is_done;) {
        const RecordReading there = read_shot_part(file);
        refuse_other_choice(there, file);
        if (before_ && there.version != *before_) refuse_begun_anew(there, file);
        if (write_static) write_static(there.shot ? there.shot->files : std::map<std::string, FileRecord>());
        std::map<std::string, Json> files_there, files;
        if (there.shot)
            for (const auto& [path, listed] : there.shot->files) files_there[path] = to_json(listed);
        for (const auto& [path, listed] : shot_["files"].items()) files[path] = listed;
        is_done = (there.version == version_of(shot_) && files_there == files) ||
                  merge(file, Taken::Nothing) == Merged::Yes;
    }
    if (makes_frames) save(file);
}

void Record::save(const std::filesystem::path& file) {
    if (id_.empty()) id_ = new_fragment_id();
    std::set<int> numbers;
    if (!fragment_.empty())
        read_record(fragment_, [&](int number, const FrameRecord&) { numbers.insert(number); });
    for (const auto& [number, frame] : unsaved_) numbers.insert(number);
    const auto named = numbers.empty() ? fragment_file(file, 0, 0, 0, id_)
                                       : fragment_file(file, *numbers.begin(), *numbers.rbegin(),
                                                       static_cast<int>(numbers.size()), id_);
    constexpr int kMostTimes = 10;
    for (int times = 1;; ++times) try {
            files::ensure_folder(named.parent_path());
            files::write_atomically(named, [&](const files::ByteSink& sink) {
                write(sink, [&](const Take& take) { read_record(fragment_, take); });
            });
            break;
        } catch (const files::FileError& error) {
            // Whoever took the last fragment away took the folder as well.
            if (error.code() != std::errc::no_such_file_or_directory || times == kMostTimes) throw;
        }
    if (named != fragment_) drop_fragment();
    fragment_ = named;
    saved_ = numbers.size();
    unsaved_.clear();
}

void Record::finish(const std::filesystem::path& file, const files::LockWatch& waiting,
                    const WriteStatic& write_static) {
    if (unsaved_.empty() && fragments_of(file).empty()) return;
    take_in(file, waiting, write_static);
    if (saved_ == 0) drop_fragment();
}

void Record::take_in(const std::filesystem::path& file, const files::LockWatch& waiting,
                     const WriteStatic& write_static) {
    constexpr int kMostTimes = 10;
    for (int times = 0; times < kMostTimes; ++times) {
        // Else one run after the other would write a long record.
        const bool is_small = is_alone(file) && files::file_size(file).value_or(0) < kSmallRecord;
        if (!is_small) {
            if (!unsaved_.empty()) save(file);
            // Fragments first: what is taken in meanwhile counts twice, and not never.
            auto frames = std::int64_t{0};
            for (const Fragment& fragment : fragments_of(file)) frames += fragment.frames;
            std::set<int> numbers;
            if (is_in_record(file, numbers)) return drop_fragment();
            frames += static_cast<std::int64_t>(numbers.size());
            if (frames <= std::int64_t{last_frame_} - first_frame_) return;
        }
        const files::FolderLock lock(file.parent_path(), waiting);
        try {
            refuse_other_version(file);
        } catch (const BegunAnew&) {
            if (!unsaved_.empty()) save(file);
            throw;
        }
        if (!is_small && write_static) {
            std::map<std::string, FileRecord> ours;
            for (const auto& [path, listed] : shot_["files"].items()) ours[path] = file_from_json(listed);
            write_static(ours);
        }
        const Merged merged = merge(file, is_small ? Taken::Ours : Taken::All);
        if (merged == Merged::Yes) return drop_fragment();
        if (merged == Merged::NotWhole) return;
    }
    if (!unsaved_.empty()) save(file);
}

bool Record::take_in_fragments(const std::filesystem::path& file, const files::LockWatch& waiting) {
    if (fragments_of(file).empty()) return false;
    const files::FolderLock lock(file.parent_path(), waiting);
    Record record;
    try {
        // Frames are of the fragments' readers: here they are only passed by.
        const auto skip_frames = [](int depth, Json::parse_event_t event, const Json& parsed) {
            return event != Json::parse_event_t::key || depth != 1 || parsed != "frames";
        };
        std::string text;
        if (!files::read_pieces(file, [&](std::string_view piece) { text += piece; }).empty()) return false;
        record.shot_ = Json::parse(text, skip_frames);
        if (!is_as_written("", record.shot_)) return false;
        record.shot_.erase("checksum");
        const ShotRecord shot = shot_from_json(record.shot_);
        record.first_frame_ = shot.first_frame;
        record.last_frame_ = shot.last_frame;
        // Of a longer shot they name the frames that are recorded (plugin/run/run.cpp): a bake writes them again.
        if (!names_all_frames(shot.first_frame, shot.last_frame)) return false;
    } catch (const Json::exception&) {
        return false;
    }
    return record.merge(file, Taken::All) == Merged::Yes;
}

bool Record::is_alone(const std::filesystem::path& file) const {
    const std::vector<Fragment> fragments = fragments_of(file);
    return std::all_of(fragments.begin(), fragments.end(),
                       [&](const Fragment& fragment) { return fragment.file == fragment_; });
}

// As where files were lost, and made again.
bool Record::is_in_record(const std::filesystem::path& file, std::set<int>& numbers_there) const {
    std::map<int, FrameRecord> ours;
    std::vector<int> numbers;
    if (!fragment_.empty())
        read_record(fragment_, [&](int number, FrameRecord frame) {
            numbers.push_back(number);
            ours[number] = std::move(frame);
        });
    const bool are_few = is_read_in_part(file, numbers);
    std::size_t found = 0;
    read_frames(
        file, are_few ? std::span<const int>(numbers) : std::span<const int>(),
        [&](int number, const FrameRecord& frame) {
            if (const auto own = ours.find(number); own != ours.end())
                found += to_json(own->second) == to_json(frame);
        },
        &numbers_there);
    return are_few && !ours.empty() && found == ours.size();
}

void Record::drop_fragment() {
    if (!fragment_.empty()) remove_fragment(fragment_);
    fragment_.clear();
}

Record::Merged Record::merge(const std::filesystem::path& file, Taken taken) {
    struct NotWhole {};
    const files::FileIdentity former = files::identity_of(file);
    RecordsReading reading;
    try {
        const auto made = files::replace_if_same(file, former, [&](const files::ByteSink& sink) {
            const std::int64_t fresh = write(sink, [&](const Take& take) {
                const auto take_marked = [&](int number, FrameRecord frame) {
                    if (is_stale_) frame.is_stale = is_stale_(number, frame);
                    take(number, std::move(frame));
                };
                if (taken == Taken::Nothing)
                    read_record(file, take_marked);
                else
                    reading = read_records(file, take_marked);
            });
            if (taken == Taken::All &&
                (reading.has_changed || fresh <= std::int64_t{last_frame_} - first_frame_))
                throw NotWhole();
        });
        if (!made) return Merged::Changed;
    } catch (const NotWhole&) {
        return reading.has_changed ? Merged::Changed : Merged::NotWhole;
    }
    unsaved_.clear();
    if (taken == Taken::Nothing) return Merged::Yes;
    for (const Fragment& fragment : reading.read)
        if ((taken == Taken::All || fragment.file == fragment_) &&
            files::identity_of(fragment.file) == fragment.identity)
            remove_fragment(fragment.file);
    return Merged::Yes;
}

// As one JSON object would be printed, frames by rising number, those that `former` hands over and ours, which take their place.
// Returns how many of the shot's frames aren't stale.
std::int64_t Record::write(const files::ByteSink& sink,
                           const std::function<void(const Take&)>& former) const {
    constexpr std::size_t kPiece = 1 << 16;  // bytes: a piece is a call of the system
    Json shot = shot_;
    shot["checksum"] = checksum_of("", shot);
    std::string piece = "{" + lines_inside(shot, "") + ",\n  \"frames\": {";
    std::optional<int> last;
    std::int64_t fresh = 0;
    const auto add = [&](int number, const FrameRecord& frame) {
        if (last && number <= *last) return;  // ours have taken its place, or somebody has mixed them up
        if (number < first_frame_ || number > last_frame_) return;
        if (last) piece += ',';
        last = number;
        fresh += !frame.is_stale;
        const std::string key = std::to_string(number);
        Json entry = to_json(frame);
        entry["checksum"] = checksum_of(key, entry);
        piece += lines_inside({{key, std::move(entry)}}, "  ");
        if (piece.size() < kPiece) return;
        sink(piece);
        piece.clear();
    };
    auto ours = unsaved_.begin();
    const auto add_ours_up_to = [&](int number) {
        for (; ours != unsaved_.end() && ours->first <= number; ++ours) add(ours->first, ours->second);
    };
    former([&](int number, FrameRecord frame) {
        add_ours_up_to(number);
        add(number, frame);
    });
    add_ours_up_to(std::numeric_limits<int>::max());
    sink(piece + (last ? "\n  }\n}\n" : "}\n}\n"));
    return fresh;
}

}  // namespace pelagic
