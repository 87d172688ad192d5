#include "plugin/run/verify.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "core/scene/text.h"
#include "plugin/run/foreign.h"
#include "plugin/run/fragments.h"
#include "plugin/run/record.h"
#include "plugin/run/run.h"
#include "plugin/run/seals.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

// What a folder holds by its records.
struct Known {
    std::vector<FileCheck> files;
    std::set<std::string> paths;      // of these and of the records
    std::set<std::string> uncertain;  // shots whose record is damaged: what else is named so may be theirs
    struct Baked {
        int first_frame = 0, last_frame = 0;  // of the shot
        std::set<int> frames;                 // that the record has, as they were written or altered
    };
    std::map<std::string, Baked> baked;  // by shot
    // What is called .json and says nothing of a bake: somebody's own, if no file here is of a shot of its name.
    std::set<std::string> unread;
};

// "1-6, 9": the shot's frames that aren't there. A shot may have very many.
std::string gaps_text(const Known::Baked& baked) {
    std::string text;
    std::int64_t next = baked.first_frame;
    const auto add_until = [&](std::int64_t end) {
        if (next >= end) return;
        text += (text.empty() ? "" : ", ") + std::to_string(next);
        if (end - 1 > next) text += '-' + std::to_string(end - 1);
    };
    for (const int frame : baked.frames) {
        if (frame < baked.first_frame || frame > baked.last_frame) continue;
        add_until(frame);
        next = std::int64_t{frame} + 1;
    }
    add_until(std::int64_t{baked.last_frame} + 1);
    return text;
}

void read_shot(const fs::path& folder, const std::string& record, const std::string& instruction_set,
               const std::atomic<bool>* cancel, Known& known, Verification& found) {
    const std::string name = record.substr(0, record.size() - std::string_view(".json").size());
    const auto tell = [&](Flaw flaw, std::string what) {
        found.findings.push_back({record, flaw, std::move(what)});
    };
    const auto add = [&](const std::string& path, FileRecord file) {
        if (known.paths.insert(path).second)
            known.files.push_back({.path = path, .recorded = std::move(file)});
    };
    std::vector<int> baked, stale;
    std::map<std::string, std::vector<int>> by_set;
    const RecordsReading reading = read_records(
        folder / record,
        [&](int frame, FrameRecord entry) {
            baked.push_back(frame);
            if (entry.is_stale)
                stale.push_back(frame);
            else
                by_set[entry.instruction_set].push_back(frame);
            for (auto& [path, file] : entry.files) {
                // A bake makes a stale frame's files anew one after another, and then writes its entry: until
                // then they hold other bytes, and aren't damaged.
                if (entry.is_stale)
                    known.paths.insert(path);
                else
                    add(path, std::move(file));
            }
        },
        cancel);
    known.paths.insert(record);
    ++found.shots;
    if (!reading.problem.empty()) tell(Flaw::Damaged, reading.problem);
    for (const std::string& fragment : reading.damaged) {
        const std::size_t end = fragment.find(' ');
        found.findings.push_back({fragment.substr(0, end), Flaw::Damaged, fragment.substr(end + 1)});
    }
    if (!reading.altered.empty())
        tell(Flaw::Damaged, "was altered in what it says about the frames " + frames_text(reading.altered));
    if (!reading.problem.empty() || !reading.altered.empty() || !reading.damaged.empty())
        known.uncertain.insert(name);
    if (!stale.empty()) tell(Flaw::Stale, "has frames of another version of the shot: " + frames_text(stale));
    for (const auto& [set, frames] : by_set) {
        if (instruction_set.empty() && by_set.size() > 1)
            found.notes.push_back(record + ": " + line_text(set) + " has made the frames " +
                                  frames_text(frames));
        if (!instruction_set.empty() && set != instruction_set)
            tell(Flaw::Stale, "has frames that " + line_text(set) + " has made: " + frames_text(frames) +
                                  "; bake them again with --instruction-set " + instruction_set);
    }
    if (!reading.shot && baked.empty() && !reading.is_blocked) known.unread.insert(record);
    if (!reading.shot) return;
    const ShotRecord& shot = *reading.shot;
    if (shot.name != name)
        tell(Flaw::Damaged, "is the record of the shot " + line_text(shot.name) + ", renamed");
    for (const auto& [path, file] : shot.files) add(path, file);
    Known::Baked there{shot.first_frame, shot.last_frame, {baked.begin(), baked.end()}};
    there.frames.insert(reading.altered.begin(), reading.altered.end());
    if (const std::string missing = gaps_text(there); !missing.empty())
        tell(Flaw::Missing, "lacks frames that aren't baked: " + missing);
    known.baked[name] = std::move(there);
}

// Whether the file is of a frame that its shot's record lacks: a bake makes the files, and then the entry.
bool is_of_missing_frame(const std::string& path, const Known& known) {
    const auto shot = known.baked.find(shot_of(path));
    if (shot == known.baked.end()) return false;
    const auto frame = frame_of(fs::path(path).stem().extension().string(), {".", ""});
    const Known::Baked& baked = shot->second;
    return frame && *frame >= baked.first_frame && *frame <= baked.last_frame &&
           !baked.frames.contains(*frame);
}

// Whole shots' records take in what lies beside them.
void merge_records(const fs::path& folder, const std::set<std::string>& records,
                   const std::atomic<bool>* cancel, Verification& found) {
    const files::LockWatch waiting = [&](double) {
        if (cancel && *cancel) throw BuildCancelled();
    };
    std::set<std::string> flawed;
    for (const Finding& finding : found.findings)
        flawed.insert(shot_of(fs::path(finding.path).filename().string()));
    for (const std::string& record : records)
        if (!flawed.contains(shot_of(record))) try {
                if (Record::take_in_fragments(folder / record, waiting)) found.merged.push_back(record);
            } catch (const files::FileError& error) {
                found.notes.emplace_back(error.what());
            }
}

bool is_of_frame(const std::string& path) {
    return frame_of(fs::path(path).stem().extension().string(), {".", ""}).has_value();
}

// Whether a bake made them, and was stopped before its first record: that is written before any frame's file, and after
// those that the whole shot has. Several of them say of themselves what made them.
bool are_before_a_record(const fs::path& folder, const std::vector<std::string>& paths) {
    return std::none_of(paths.begin(), paths.end(), is_of_frame) &&
           std::any_of(paths.begin(), paths.end(),
                       [&](const std::string& path) { return files::carries(folder / path, "pelagic"); });
}

bool is_picture(const std::string& name) {
    const std::string shot = shot_of(name) + '.';
    return frame_of(name, {shot, ".exr"}) || frame_of(name, {shot, ".png"}) ||
           frame_of(name, {shot + "deep.", ".exr"});
}

// What lies beside a picture: of a deep one the flat one.
std::string beside_picture(const std::string& name) {
    const std::string shot = shot_of(name) + '.';
    if (const auto frame = frame_of(name, {shot + "deep.", ".exr"}))
        return FilePattern{shot, ".exr"}.file(*frame);
    return fs::path(name).replace_extension(name.ends_with(".png") ? ".exr" : ".png").string();
}

}  // namespace

const char* word_of(Flaw flaw) {
    constexpr std::array kWords{"missing", "damaged", "stale", "foreign", "interrupted"};
    return kWords[static_cast<std::size_t>(flaw)];
}

Verification verify(const fs::path& folder, const BuildWatch& watch, const std::string& instruction_set) {
    std::set<std::string> names;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        names.insert(entry->path().filename().string());
    if (error)
        throw files::FileError("cannot read the folder '" + line_text(folder.string()) + "': " +
                                   error.message() + ": name a folder that a bake or a render wrote into",
                               folder, error);

    Verification found;
    Known known;
    // A shot whose own record was lost is known by its runs'.
    std::set<std::string> records;
    for (fs::directory_iterator entry(folder / "record", error), end; !error && entry != end;
         entry.increment(error))
        records.insert(shot_of(entry->path().filename().string()) + ".json");
    std::erase_if(records, [&](const std::string& record) { return fragments_of(folder / record).empty(); });
    for (const std::string& name : names) {
        if (name.starts_with('.')) continue;
        if (name.ends_with(".json")) records.insert(name);
        if (is_picture(name))
            known.files.push_back(
                {.path = name, .recorded = {.bytes = files::file_size(folder / name).value_or(0)}});
    }
    for (const std::string& record : records)
        read_shot(folder, record, instruction_set, watch.cancel, known, found);
    for (const FileCheck& file : known.files) found.bytes += file.recorded.bytes;
    check_files(folder, known.files, watch);
    found.files = static_cast<int>(known.files.size());
    for (const FileCheck& file : known.files) {
        if (!file.problem.empty())
            found.findings.push_back(
                {file.path, file.is_missing ? Flaw::Missing : Flaw::Damaged, file.problem});
        if (!file.is_sealed()) continue;
        if (file.problem.empty() && !instruction_set.empty() &&
            !says_instruction_set(folder / file.path, instruction_set))
            found.findings.push_back({file.path, Flaw::Stale,
                                      "was made by another instruction set: render it again with "
                                      "--instruction-set " +
                                          instruction_set});
        const std::string other = beside_picture(file.path);
        if (!names.contains(other))
            found.findings.push_back({other, Flaw::Missing, "is missing beside " + file.path});
    }
    std::map<std::string, std::vector<std::string>> unrecorded;  // paths, by shot
    for_each_bake_file(folder, [&](const std::string& path) {
        if (known.paths.contains(path)) return;
        const std::string shot = shot_of(path);
        known.unread.erase(shot + ".json");
        if (!known.uncertain.contains(shot) && !is_of_missing_frame(path, known))
            unrecorded[shot].push_back(path);
    });
    for (const auto& [shot, paths] : unrecorded) {
        const bool is_begun = !names.contains(shot + ".json") && are_before_a_record(folder, paths);
        for (const std::string& path : paths)
            found.findings.push_back(
                is_begun
                    ? Finding{path, Flaw::Interrupted,
                              "is of a bake that was stopped before its first record: bake the shot again"}
                    : Finding{path, Flaw::Foreign, "is in no record here"});
    }
    found.shots -= static_cast<int>(known.unread.size());
    for (Finding& finding : found.findings)
        if (known.unread.contains(finding.path)) {
            finding.flaw = Flaw::Foreign;
            finding.what = "is no record of a bake, and no file here is of such a shot";
        }
    merge_records(folder, records, watch.cancel, found);
    std::stable_sort(found.findings.begin(), found.findings.end(),
                     [](const Finding& a, const Finding& b) { return a.path < b.path; });
    return found;
}

}  // namespace pelagic
