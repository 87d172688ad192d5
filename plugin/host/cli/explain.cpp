// pelagic explain SHOT.toml
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/base/text.h"
#include "core/plan/memory.h"
#include "core/plan/plan.h"
#include "core/scene/budget.h"
#include "core/scene/names.h"
#include "core/scene/number_keys.h"
#include "plugin/bake/bake.h"
#include "plugin/bake/measure.h"
#include "plugin/bake/stage.h"
#include "plugin/budget/budget.h"
#include "plugin/budget/calibration.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/account.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/threads.h"
#include "plugin/host/cli/verb.h"
#include "plugin/host/cli/warnings.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/render/render.h"

namespace pelagic::cli {
namespace {

struct ExplainArguments {
    std::string shot;
    bool measure = false;
    std::string threads;
};

std::string signed_bytes(std::int64_t bytes) {
    if (bytes == 0) return "0";
    return (bytes < 0 ? "-" : "") + bytes_text(static_cast<std::size_t>(std::abs(bytes)));
}

std::string milliseconds_text(const Milliseconds& ms) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.2f (%.2f)", ms.median, ms.spread);
    return text.data();
}

// Columns of fixed width, so that each row can be printed as soon as it is measured.
void print_row(const std::array<std::string, 8>& cells) {
    constexpr std::array<int, 8> kWidths{-23, 10, 8, 10, 10, 10, 17, 17};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto width = static_cast<std::size_t>(std::abs(kWidths[i]));
        const std::string space(width - std::min(width, cells[i].size()), ' ');
        std::cout << (i > 0 ? " " : "") << (kWidths[i] < 0 ? cells[i] + space : space + cells[i]);
    }
    std::cout << std::endl;  // flushed, because a row may take seconds
}

void print_measured(const Measured& measured) {
    const PlanCost& cost = measured.cost;
    print_row({measured.name, std::to_string(cost.transforms), std::to_string(cost.lines),
               signed_bytes(cost.sea_bytes), signed_bytes(cost.frame_bytes), signed_bytes(cost.output_bytes),
               milliseconds_text(measured.compute), milliseconds_text(measured.encode)});
}

std::string too_large(std::size_t needed, const std::string& there) {
    return "measuring holds the sea twice, with and without an item: about " + bytes_text(needed) + there +
           "; lower surface.resolution, output.map_resolution or the cascades' resolutions, or run explain "
           "without --measure";
}

int print_prices(const Scene& scene, const ExplainArguments& arguments) {
    std::size_t needed = 0;
    const auto out_of_memory = [&](int) { return too_large(needed, ", which this process doesn't get"); };
    const auto print = [&](Session& session) {
        const int threads = session.threads.count();
        needed = measure_bytes(scene, threads);
        if (const MemoryLimit limit = machine::memory_limit(); needed > limit.bytes)
            throw NotEnoughMemory(too_large(needed, ", and " + limit.whose + " " + bytes_text(limit.bytes)));
        std::cout
            << "\nPrices: a frame with the item minus a frame without it, on "
            << count_text(threads, "thread", "threads") << ", " << instruction_set()
            << ".\nBytes: held by the sea, by a frame, and by points and results. Milliseconds: median\n"
               "(half the interquartile range) of computing as in a bake, and of encoding its files.\n\n";
        print_row({"", "transforms", "lines", "sea", "frame", "output", "compute, ms", "encode, ms"});
        MeasureOptions options;
        options.progress = [&](const MeasureProgress& now) {
            std::string line = "measuring " + now.name;
            if (now.seconds_left > 0.0)
                line += ", " + std::to_string(now.item + 1) + " of " + std::to_string(now.items) +
                        ", about " + duration_text(now.seconds_left) + " left";
            session.progress.show(line);
        };
        options.measured = [&](const Measured& measured) {
            session.progress.clear();
            print_measured(measured);
        };
        const Measured whole = session.threads.execute([&] { return measure(scene, options); });
        options.measured(whole);
        return int{kDone};
    };
    return guarded_run({.shot = {}, .threads = arguments.threads, .out_of_memory = out_of_memory}, print);
}

// What the shot's budget, if it has one, asks for.
Settled print_settled(const Scene& scene, Purpose purpose, const std::string& title) {
    Progress progress;
    Settled settled;
    try {
        settled = settle(
            scene, purpose,
            {.watch = {.progress = [&](double done) { progress.show_measuring(done); }, .cancel = nullptr}});
    } catch (const std::exception& error) {  // who only bakes needs no picture
        settled = settle(without_budget(scene), purpose);
        settled.text = std::string("none: ") + error.what();
    }
    progress.clear();
    if (!settled.text.empty()) std::cout << title << "\n  " << settled.text << "\n\n";
    return settled;
}

// What changes over the shot.
void print_keyed(const Scene& scene) {
    const Scene first = scene_at(scene, scene.shot.first_frame),
                last = scene_at(scene, scene.shot.last_frame);
    for (const KeyedNumber& number : scene.keyed) {
        const Key& key = key_of(number.path);
        std::cout << number.path << " has "
                  << count_text(static_cast<long>(number.keys.keys.size()), "key", "keys") << ", "
                  << word_of(number.keys.interpolation) << ": "
                  << value_text(key, number_of(first, number.path)) << " at frame " << scene.shot.first_frame
                  << ", " << value_text(key, number_of(last, number.path)) << " at frame "
                  << scene.shot.last_frame << ".\n";
    }
    if (!scene.keyed.empty())
        std::cout << "Pictures meter each frame's light; where the sky changes each bakes its own"
                  << (scene.output.mesh == MeshFormat::None || !changes(scene, "light")
                          ? ""
                          : ", and a baked frame has its sky as a file of its own")
                  << ".\n";
    for (const Problem& problem : unbaked_keys(scene))
        std::cout << "A bake refuses " << problem.key << ": it " << problem.problem << ".\n";
}

void print_objects(const Scene& scene) {
    for (const SceneObject& object : scene.objects)
        std::cout << "The object " << quoted_text(object.called()) << " has "
                  << count_text(static_cast<long>(object.mesh->data().triangles.size() / 3), "triangle",
                                "triangles")
                  << ", " << bytes_text(object.mesh->bytes()) << ".\n";
}

// What a frame takes here, by what was measured of this machine where that is known.
struct Accounts {
    int threads;
    bool is_measured;
    std::optional<FrameAccount> bake;  // none: nothing is baked
    FrameAccount picture;
};
Accounts accounts_of(const Settled& pictures, const Plan& plan) {
    const int threads = tbb::this_task_arena::max_concurrency();
    const auto kept = kept_calibration(cache_folder());
    const Rates rates = kept ? kept->rates() : rates_on(threads);
    const Shot& shot = plan.from->scene.shot;
    Accounts accounts{.threads = threads,
                      .is_measured = kept.has_value(),
                      .bake = std::nullopt,
                      .picture = picture_account(pictures.scene, pictures.options, threads, rates)};
    if (!plan.outputs.empty())
        accounts.bake = bake_account(plan, shot.last_frame - shot.first_frame + 1, threads, rates);
    return accounts;
}

void print_accounts(const Accounts& accounts) {
    std::cout << "On " << count_text(accounts.threads, "thread", "threads") << ", by "
              << (accounts.is_measured
                      ? "what was measured of this machine"
                      : "the recorded speed of another machine (pelagic calibrate measures this one)")
              << ":\n";
    if (accounts.bake) std::cout << "  A baked frame " << text_of(*accounts.bake) << ".\n";
    std::cout << "  A picture " << text_of(accounts.picture) << ".\n" << std::flush;
}

// --json.
void tell_accounts(const Accounts& accounts, const Settled& pictures, const Plan& plan) {
    const Shot& shot = plan.from->scene.shot;
    nlohmann::ordered_json told{
        {"event", "result"},           {"verb", "explain"},
        {"name", shot.name},           {"frames", {shot.first_frame, shot.last_frame}},
        {"threads", accounts.threads}, {"rates", accounts.is_measured ? "measured" : "recorded"}};
    if (accounts.bake) {
        told["bake"] = json_of(*accounts.bake);
        told["bake"]["transforms_a_frame"] = plan.transforms_per_frame();
    }
    told["pictures"] = json_of(accounts.picture);
    told["pictures"]["resolution"] = {pictures.scene.camera.resolution.x, pictures.scene.camera.resolution.y};
    told["pictures"]["samples"] = pictures.options.samples;
    told["text"] = explain(plan);
    tell_json(told);
}

// What a bake of the shot and its pictures would hold, as bake and render compare it with what there is.
void print_memory(const Scene& scene, const RenderOptions& options, const Plan& plan) {
    const int threads = tbb::this_task_arena::max_concurrency();
    const std::vector<int> frames = representative_frames(scene, 64);
    const bool alone = scene.shot.first_frame == scene.shot.last_frame;
    if (!plan.outputs.empty())
        std::cout << "A bake holds " << memory_text(bake_memory(plan, alone ? 1 : kFramesInFlight, threads))
                  << ".\n";
    if (scene.output.mesh != MeshFormat::None)
        std::cout << "The camera of the bake's stage takes " << bytes_text(camera_layer_bytes(scene))
                  << ", for all frames of the shot together.\n";
    print_keyed(scene);
    print_objects(scene);
    const WaterBody water = make_water(scene_at(scene, scene.shot.first_frame), plan.from->spectrum);
    if (const WaterText text = water_text(water); !text.wavelengths_nm.empty())
        std::cout << "The water at " << text.wavelengths_nm << " nm absorbs " << text.absorption_per_m
                  << " and scatters back " << text.backscatter_per_m
                  << " a metre; a high sun's light fades by " << text.fading_per_m << " a metre of depth.\n";
    std::cout << "Pictures of " << scene.camera.resolution.x << " × " << scene.camera.resolution.y << " hold "
              << memory_text(render_memory(scene, options, frames, alone ? 1 : kPicturesInFlight, threads))
              << ".\n"
              << std::flush;
}

}  // namespace

Verb add_explain(CLI::App& program) {
    CLI::App* command = program.add_subcommand("explain", help::kExplain)->footer(help::kExplainFooter);
    auto arguments = std::make_shared<ExplainArguments>();
    command->add_option("SHOT.toml", arguments->shot, help::kShot)->required()->type_name("");
    CLI::Option* measure = command->add_flag("--measure", arguments->measure, help::kMeasure);
    add_threads(*command, arguments->threads, help::kMeasureThreads)->needs(measure);
    add_json(*command);
    return {command, [arguments] {
                const Scene scene = load_shot(arguments->shot, check_scene);
                const Plan plan = plan_bake(print_settled(scene, Purpose::Mesh, "Budget").scene);
                std::cout << explain(plan);
                const Settled pictures = print_settled(scene, Purpose::Pictures, "\nBudget of pictures");
                print_memory(pictures.scene, pictures.options, plan);
                const Accounts accounts = accounts_of(pictures, plan);
                print_accounts(accounts);
                print_warnings(arguments->shot, scene);
                tell_accounts(accounts, pictures, plan);
                return arguments->measure ? print_prices(plan.from->scene, *arguments) : int{kDone};
            }};
}

}  // namespace pelagic::cli
