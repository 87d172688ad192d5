// pelagic accuracy [SHOT.toml] --out DIR
#include "plugin/accuracy/accuracy.h"
#include "core/scene/number_keys.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "core/scene/names.h"
#include "plugin/accuracy/report.h"
#include "plugin/budget/budget.h"
#include "plugin/files/files.h"
#include "plugin/files/read.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/threads.h"
#include "plugin/host/cli/verb.h"
#include "plugin/light/light.h"

namespace pelagic::cli {
namespace {

namespace fs = std::filesystem;

struct AccuracyArguments {
    std::string shot, out, threads;
    std::vector<std::string> rows;
    bool list = false, pictures = false;
    int repeats = 5;
};

void list_rows() {
    std::size_t widest = 0;
    for (const ApproximationRow& row : approximation_table())
        widest = std::max(widest, std::string(row.name).size());
    for (const ApproximationRow& row : approximation_table()) {
        const std::string name = row.name;
        std::cout << name << std::string(widest + 2 - name.size(), ' ') << row.title << "; knob: " << row.knob
                  << '\n';
    }
}

// Throws WrongUsage for a name that is none.
void refuse_rows(const std::vector<std::string>& names) {
    std::vector<std::string> known;
    for (const ApproximationRow& row : approximation_table()) known.emplace_back(row.name);
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) != known.end()) continue;
        const std::string near = nearest(name, known);
        throw WrongUsage("--rows: '" + name + "' is no approximation" +
                         (near.empty() ? "" : "; did you mean " + near + '?') +
                         " (pelagic accuracy --list has them all)");
    }
}

// In the order of the table; all where no name is given.
std::vector<const ApproximationRow*> asked_rows(const std::vector<std::string>& names) {
    std::vector<const ApproximationRow*> rows;
    for (const ApproximationRow& row : approximation_table())
        if (names.empty() || std::find(names.begin(), names.end(), row.name) != names.end())
            rows.push_back(&row);
    return rows;
}

// What an earlier run left; nothing where there is no table, or one of another program.
std::vector<MeasuredRow> recorded(const fs::path& table) {
    std::string text;
    const std::string problem = files::read_pieces(table, [&](std::string_view piece) { text += piece; });
    if (!problem.empty()) return {};
    try {
        return read_csv_report(text);
    } catch (const std::invalid_argument& error) {
        std::cerr << line_text(table.string()) << ": note: " << error.what() << "; it is measured anew\n";
        return {};
    }
}

void put(std::vector<MeasuredRow>& rows, MeasuredRow row) {
    std::erase_if(rows, [&](const MeasuredRow& old) { return old.name == row.name; });
    rows.push_back(std::move(row));
    const auto place = [](const MeasuredRow& of) {
        const auto table = approximation_table();
        return std::find_if(table.begin(), table.end(),
                            [&](const ApproximationRow& each) { return of.name == each.name; });
    };
    std::stable_sort(rows.begin(), rows.end(),
                     [&](const MeasuredRow& a, const MeasuredRow& b) { return place(a) < place(b); });
}

void write_reports(const fs::path& folder, const std::vector<MeasuredRow>& rows, const Scene& shot) {
    const std::string now = utc_now(), hash = shot_hash(shot);
    files::write_atomically(folder / "accuracy.txt", text_report(rows, now, hash));
    files::write_atomically(folder / "accuracy.csv", csv_report(rows));
    files::write_atomically(folder / "accuracy.html", html_report(rows, now, shot.shot.name, hash));
    for (const MeasuredRow& row : rows)
        if (const std::string plot = svg_report(row); !plot.empty())
            files::write_atomically(folder / (row.name + ".svg"), plot);
}

int run(const AccuracyArguments& arguments) {
    if (arguments.list) {
        list_rows();
        return kDone;
    }
    refuse_rows(arguments.rows);
    const std::vector<const ApproximationRow*> rows = asked_rows(arguments.rows);
    // Sweeps turn the knobs that a budget would choose.
    const Scene settled =
        held(settle(arguments.shot.empty() ? Scene{} : load_shot(arguments.shot, check_scene), Purpose::Mesh))
            .scene;
    const Scene shot = scene_at(settled, settled.shot.first_frame);
    if (!settled.keyed.empty())
        std::cerr << "pelagic: note: numbers that have keys are measured as they are at frame "
                  << settled.shot.first_frame << '\n';
    const fs::path folder =
        arguments.out.empty() ? fs::path(shot.shot.name + "-accuracy") : fs::path(arguments.out);
    files::ensure_folder(folder);
    std::vector<MeasuredRow> measured = recorded(folder / "accuracy.csv");
    std::size_t done = 0;
    const auto stopped = [&] {
        return line_text(folder.string()) + " has the " + std::to_string(done) +
               " rows that were measured, and earlier ones";
    };
    const Guard guard{.shot = {},
                      .threads = arguments.threads,
                      .stopping = "stopping: the row at hand is given up",
                      .stopped = stopped};
    return guarded_run(guard, [&](Session& session) {
        session.stop->files_begin();
        SweepWatch watch{.progress =
                             [&](const std::string& row, const std::string& setting) {
                                 session.progress.show(std::to_string(done + 1) + " of " +
                                                       std::to_string(rows.size()) + ": " + row + ", " +
                                                       setting);
                             },
                         .cancel = &session.stop->cancelled()};
        if (arguments.pictures) {
            files::ensure_folder(folder / "pictures");
            watch.picture = [&](const std::string& row, std::size_t setting, const PictureBytes& picture) {
                const fs::path stem = folder / "pictures" / (row + '.' + std::to_string(setting));
                files::write_atomically(stem.string() + ".exr", picture.exr);
                files::write_atomically(stem.string() + ".png", picture.png);
            };
        }
        for (const ApproximationRow* row : rows) {
            put(measured,
                session.threads.execute([&] { return sweep(*row, shot, arguments.repeats, watch); }));
            write_reports(folder, measured, shot);  // what is known so far
            ++done;
        }
        session.progress.clear();
        std::cout << text_report(measured, utc_now(), shot_hash(shot)) << '\n'
                  << line_text((folder / "accuracy.html").string()) << " has the plots\n";
        return int{kDone};
    });
}

}  // namespace

Verb add_accuracy(CLI::App& program) {
    CLI::App* command = program.add_subcommand("accuracy", help::kAccuracy)->footer(help::kAccuracyFooter);
    auto arguments = std::make_shared<AccuracyArguments>();
    command->add_option("SHOT.toml", arguments->shot, help::kAccuracyShot)->type_name("");
    command->add_option("--out", arguments->out, help::kAccuracyOut)->type_name("DIR");
    command->add_option("--rows", arguments->rows, help::kAccuracyRows)->delimiter(',')->type_name("NAMES");
    command->add_option("--repeats", arguments->repeats, help::kAccuracyRepeats)
        ->type_name("N")
        ->check(CLI::Range(1, 1000));
    command->add_flag("--pictures", arguments->pictures, help::kAccuracyPictures);
    command->add_flag("--list", arguments->list, help::kAccuracyList);
    add_threads(*command, arguments->threads, help::kAccuracyThreads);
    return {command, [arguments] { return run(*arguments); }};
}

}  // namespace pelagic::cli
