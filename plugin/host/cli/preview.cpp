// pelagic preview SHOT.toml
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "core/plan/plan.h"
#include "core/scene/budget.h"
#include "core/scene/names.h"
#include "core/scene/number_keys.h"
#include "core/scene/shot_text.h"
#include "plugin/files/files.h"
#include "plugin/format/shot/edit_shot.h"
#include "plugin/format/shot/shot.h"
#include "plugin/format/shot/text_file.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/memory.h"
#include "plugin/host/cli/size.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/threads.h"
#include "plugin/host/cli/verb.h"
#include "plugin/host/preview/offscreen.h"
#include "plugin/host/preview/window.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/render/picture_files.h"

namespace pelagic::cli {
namespace {

namespace fs = std::filesystem;

struct PreviewArguments {
    std::string shot;
    std::optional<std::string> offscreen, screenshot, quality;
    std::optional<int> frame;
    std::string size, threads, max_memory;
    int scale = 0, after = 8;  // 0: what suits the driver
};

// Throws WrongUsage for what is no picture's name.
void refuse_file(const std::string& option, const fs::path& file,
                 const std::vector<std::string>& extensions) {
    if (std::find(extensions.begin(), extensions.end(), file.extension()) == extensions.end() ||
        !file.has_stem())
        throw WrongUsage(option + " \"" + file.string() +
                         "\" is not the name of a picture; accepted: a file that ends in " +
                         listed(extensions));
}

int draw_offscreen(const Scene& shot, const fs::path& file, const PreviewArguments& arguments,
                   Progress& progress) {
    Scene scene = without_budget(shot);  // of bakes and renders
    const int frame = arguments.frame.value_or(scene.shot.first_frame);
    if (const glm::ivec2 size = size_of(arguments.size); size.x > 0) scene.camera.resolution = size;
    const OffscreenContext context;
    files::check_folder(file.parent_path());
    const OffscreenPlan planned = plan_offscreen(scene, frame, {}, memory_of(arguments.max_memory));
    scene = planned.scene;
    const Sky sky = make_sky(scene);
    const auto tell = [&](const std::string& what) {
        return BuildWatch{
            .progress =
                [&progress, what](double done) {
                    progress.show(what + ": " + std::to_string(std::lround(100.0 * done)) + " %");
                },
            .cancel = nullptr};
    };
    const OffscreenPicture drawn = render_offscreen(
        planned, sky, {.sea = tell("building the sea"), .foam_past = tell("the foam's past")});
    progress.clear();
    files::ensure_folder(file.parent_path());  // an error before has left none behind
    files::remove_stale_temporaries(file.has_parent_path() ? file.parent_path() : ".");
    RenderOptions options = render_options(scene);
    options.samples = 1;
    const PictureContext about{.scene = scene,
                               .options = options,
                               .sky = sky,
                               .made_of = PictureFingerprint({.scene = scene,
                                                              .options = options,
                                                              .picture_content = picture_content(scene),
                                                              .drawn_by_gpu = true})
                                              .of(frame),
                               .exposure = shot_exposure(scene, sky)};
    files::write_atomically(file, file.extension() == ".exr" ? encode_exr(about, drawn.picture, frame)
                                                             : encode_png(about, drawn.picture, frame));
    if (!drawn.note.empty()) std::cerr << "pelagic: note: " << drawn.note << '\n';
    std::cout << "picture: " << line_text(file.string()) << "\ndrawn by " << drawn.device << std::endl;
    return kDone;
}

// Into the shot's file, which keeps all that hasn't changed.
void save_shot(const fs::path& file, const Scene& scene, const Scene& shot) {
    const std::string text = edited_shot(read_text_file(file, kMostShotBytes), scene, shot);
    Scene written = parse_shot(text, file, check_scene);
    written.quality.level = scene.quality.level;  // --quality may have chosen it
    if (!shot_text(scene, written).empty())
        throw ShotError(
            line_text(file.string()) +
            ": isn't written in a way that keys can be put into; use Copy, and put them in by hand");
    files::write_atomically(file, text);
}

int run(const PreviewArguments& arguments) {
    Scene scene = without_still_keys(load_shot(arguments.shot, check_scene));
    if (arguments.quality) {
        const auto level = choice_of<QualityLevel>(*arguments.quality);
        if (!level)
            throw WrongUsage("quality \"" + *arguments.quality +
                             "\"; accepted: " + listed(all_words<QualityLevel>()));
        scene.quality.level = *level;
    }
    if (arguments.frame) asked([&] { return parse_frames(std::to_string(*arguments.frame), scene.shot); });
    if (arguments.offscreen) {
        refuse_file("--offscreen", *arguments.offscreen, {".png", ".exr"});
        // Signals end it at once: no file is begun.
        return guarded_run({.shot = arguments.shot, .threads = arguments.threads}, [&](Session& session) {
            return session.threads.execute(
                [&] { return draw_offscreen(scene, *arguments.offscreen, arguments, session.progress); });
        });
    }
    const Threads threads(arguments.threads);
    const auto save = [&](const Scene& now, const Scene& shot) { save_shot(arguments.shot, now, shot); };
    WindowOptions options{.folder = fs::path(arguments.shot).parent_path(),
                          .save = save,
                          .size = size_of(arguments.size),
                          .pixel_size = arguments.scale,
                          .frame = arguments.frame,
                          .max_memory_bytes = memory_of(arguments.max_memory),
                          .screenshot_after = arguments.after};
    if (arguments.screenshot) {
        refuse_file("--screenshot", *arguments.screenshot, {".png"});
        options.screenshot = *arguments.screenshot;
    }
    run_window(scene, options);
    return kDone;
}

}  // namespace

Verb add_preview(CLI::App& program) {
    CLI::App* command = program.add_subcommand("preview", help::kPreview)->footer(help::kPreviewFooter);
    auto arguments = std::make_shared<PreviewArguments>();
    command->add_option("SHOT.toml", arguments->shot, help::kShot)->required()->type_name("");
    CLI::Option* offscreen =
        command->add_option("--offscreen", arguments->offscreen, help::kOffscreen)->type_name("FILE");
    command->add_option("--frame", arguments->frame, help::kFrame)->type_name("N");
    add_size(*command, arguments->size, help::kPreviewSize);
    command->add_option("--quality", arguments->quality, help::kPreviewQuality)->type_name("LEVEL");
    command->add_option("--scale", arguments->scale, help::kScale)
        ->type_name("1|2|4")
        ->check(CLI::IsMember({"1", "2", "4"})
                    .description(""));  // words: of what is no number it would say nothing
    CLI::Option* screenshot =
        command->add_option("--screenshot", arguments->screenshot, help::kScreenshot)->type_name("FILE");
    command->add_option("--after", arguments->after, help::kAfter)
        ->type_name("N")
        ->check(CLI::Range(1, 1000000).description(""))
        ->needs(screenshot);
    screenshot->excludes(offscreen);
    add_threads(*command, arguments->threads, help::kPreviewThreads);
    add_max_memory(*command, arguments->max_memory, help::kPreviewMaxMemory);
    return {command, [arguments] {
                try {
                    return run(*arguments);
                } catch (const PreviewError& error) {
                    std::cerr << "pelagic: " << error.what() << '\n';
                    return int{kWrongUsage};
                }
            }};
}

}  // namespace pelagic::cli
