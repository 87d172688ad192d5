// pelagic verify DIR …
#include "plugin/run/verify.h"

#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "plugin/files/files.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/instruction_set.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/threads.h"
#include "plugin/host/cli/verb.h"

namespace pelagic::cli {
namespace {

struct VerifyArguments {
    std::vector<std::string> folders;
    std::string threads, instruction_set;
};

// "2 shots, 151 files, 1.2 GiB: 3 missing, 1 damaged"
std::string summary(const Verification& found) {
    std::string text = count_text(found.shots, "shot", "shots") + ", " +
                       count_text(found.files, "file", "files") + ", " + bytes_text(found.bytes) + ": ";
    if (found.is_whole()) return text + "all whole";
    std::string flaws;
    for (const Flaw flaw : {Flaw::Missing, Flaw::Damaged, Flaw::Stale, Flaw::Foreign, Flaw::Interrupted}) {
        long count = 0;
        for (const Finding& finding : found.findings) count += finding.flaw == flaw ? 1 : 0;
        if (count > 0) flaws += (flaws.empty() ? "" : ", ") + std::to_string(count) + ' ' + word_of(flaw);
    }
    return text + (flaws.empty() ? "no bake and no pictures are here" : flaws);
}

nlohmann::ordered_json json_of(const Verification& found, const std::string& folder) {
    nlohmann::ordered_json told{{"event", "result"},    {"verb", "verify"},
                                {"folder", folder},     {"whole", found.is_whole()},
                                {"shots", found.shots}, {"files", found.files},
                                {"bytes", found.bytes}, {"findings", nlohmann::ordered_json::array()}};
    told["merged"] = found.merged;
    told["notes"] = found.notes;
    for (const Finding& finding : found.findings)
        told["findings"].push_back(
            {{"path", finding.path}, {"flaw", word_of(finding.flaw)}, {"what", finding.what}});
    return told;
}

int run(const VerifyArguments& arguments) {
    std::string at;  // the folder that is read
    const auto check_all = [&](Session& session) {
        session.stop->files_begin();  // a check ends soon, and with a word
        int status = kDone;
        for (const std::string& folder : arguments.folders) {
            at = line_text(folder);
            const BuildWatch watch{.progress =
                                       [&](double done) {
                                           session.progress.show("reading " + at + ": " +
                                                                 std::to_string(std::lround(100.0 * done)) +
                                                                 " %");
                                       },
                                   .cancel = &session.stop->cancelled()};
            try {
                const Verification found =
                    session.threads.execute([&] { return verify(folder, watch, arguments.instruction_set); });
                session.progress.clear();
                for (const Finding& finding : found.findings)
                    std::cout << word_of(finding.flaw) << ": " << line_text(folder + '/' + finding.path)
                              << ' ' << finding.what << '\n';
                std::cout << at << ": " << summary(found) << std::endl;
                for (const std::string& record : found.merged)
                    std::cout << at << ": what its runs recorded is in " << line_text(record) << " now"
                              << std::endl;
                for (const std::string& note : found.notes)
                    std::cerr << "pelagic: note: " << note << std::endl;
                tell_json(json_of(found, folder));
                if (!found.is_whole()) status = kNotWhole;
            } catch (const files::FileError& error) {
                session.progress.clear();
                std::cerr << "pelagic: " << error.what() << std::endl;
                status = kNotWhole;
            }
        }
        return status;
    };
    return guarded_run({.shot = {},
                        .threads = arguments.threads,
                        .stopping = "stopping the check",
                        .stopped = [&] { return at + " was not read to its end"; }},
                       check_all);
}

}  // namespace

Verb add_verify(CLI::App& program) {
    CLI::App* command = program.add_subcommand("verify", help::kVerify)->footer(help::kVerifyFooter);
    auto arguments = std::make_shared<VerifyArguments>();
    command->add_option("DIR", arguments->folders, help::kFolders)->required()->type_name("");
    add_threads(*command, arguments->threads, help::kVerifyThreads);
    add_instruction_set(*command, arguments->instruction_set, help::kVerifySet);
    add_json(*command);
    return {command, [arguments] { return run(*arguments); }};
}

}  // namespace pelagic::cli
