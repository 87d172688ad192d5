// pelagic render SHOT.toml
#include "plugin/render/render.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/plan/budget.h"
#include "core/plan/spray.h"
#include "core/scene/text.h"
#include "plugin/bake/bake.h"
#include "plugin/bake/foreign.h"
#include "plugin/bake/pipeline.h"
#include "plugin/cli/exit_status.h"
#include "plugin/cli/help.h"
#include "plugin/cli/memory.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/size.h"
#include "plugin/cli/stop.h"
#include "plugin/cli/text.h"
#include "plugin/cli/threads.h"
#include "plugin/cli/verb.h"
#include "plugin/files/files.h"
#include "plugin/machine/memory.h"
#include "plugin/render/picture_budget.h"
#include "plugin/render/picture_files.h"
#include "plugin/shot/shot.h"

namespace pelagic::cli {
namespace {

constexpr double kMostStops = 30.0;

struct RenderArguments {
    std::string shot;
    std::optional<std::string> out, frames, terms, sky_quality, layers;
    std::optional<int> samples;
    double exposure_stops = 0.0, shutter_frames = 0.0;
    bool alpha = false;
    std::string size, threads, max_memory;
    bool trust_times = false;
};

struct WrongUsage : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// "sun,sea": those alone.
void parse_terms(const std::string& text, LightingChoice& choice) {
    choice.sun = choice.sky = choice.water = choice.air = false;
    bool foam = false, spray = false;
    const std::array<std::pair<std::string_view, bool*>, 6> terms{{{"sun", &choice.sun},
                                                                   {"sky", &choice.sky},
                                                                   {"sea", &choice.water},
                                                                   {"foam", &foam},
                                                                   {"air", &choice.air},
                                                                   {"spray", &spray}}};
    std::istringstream words(text + ',');  // an empty text is a word that is none
    for (std::string word; std::getline(words, word, ',');) {
        const auto term =
            std::find_if(terms.begin(), terms.end(), [&](const auto& t) { return t.first == word; });
        if (term == terms.end())
            throw WrongUsage(
                "terms \"" + text + "\": \"" + word +
                "\" is none; accepted: any of sun, sky, sea, foam, air, spray with commas between");
        *term->second = true;
    }
    choice.whitecaps = choice.whitecaps && foam;
    choice.spray = choice.spray && spray;
}

SkyQuality parse_sky_quality(const std::string& text) {
    if (text == "one") return SkyQuality::One;
    if (text == "nine") return SkyQuality::Nine;
    if (text == "integral") return SkyQuality::Integral;
    throw WrongUsage("sky quality \"" + text + "\"; accepted: one, nine, integral");
}

struct Job {
    Scene scene;
    RenderOptions options;
    std::vector<int> frames;
    std::filesystem::path out;
    double exposure_stops = 0.0;
    std::size_t max_memory_bytes = 0;
    bool trust_times = false;
    bool has_samples = false, has_sky_quality = false;  // asked for by name: no budget decides them
};

Job job_of(const RenderArguments& arguments) {
    Job job{.scene = load_shot(arguments.shot, check_scene), .options = {}, .frames = {}, .out = {}};
    const Shot& shot = job.scene.shot;
    if (const glm::ivec2 size = size_of(arguments.size); size.x > 0) job.scene.camera.resolution = size;
    job.options = render_options(job.scene);
    job.has_samples = arguments.samples.has_value();
    job.has_sky_quality = arguments.sky_quality.has_value();
    if (arguments.samples) job.options.samples = *arguments.samples;
    if (job.options.samples < 1 || job.options.samples > kMostSamples)
        throw WrongUsage("samples " + std::to_string(job.options.samples) + "; accepted: 1 to " +
                         std::to_string(kMostSamples));
    if (arguments.terms) parse_terms(*arguments.terms, job.options.lighting);
    if (!(arguments.shutter_frames >= 0.0 && arguments.shutter_frames <= kLongestShutter_frames))
        throw WrongUsage("shutter " + number_text(arguments.shutter_frames) + "; accepted: frames, 0 to " +
                         number_text(kLongestShutter_frames));
    job.options.shutter_frames = arguments.shutter_frames;
    job.options.alpha = arguments.alpha;
    if (arguments.layers) {
        try {
            job.options.layers = parse_picture_layers(*arguments.layers);
        } catch (const std::invalid_argument& error) {
            throw WrongUsage(error.what());
        }
    }
    if (arguments.sky_quality) job.options.lighting.sky_quality = parse_sky_quality(*arguments.sky_quality);
    if (!(std::abs(arguments.exposure_stops) <= kMostStops))
        throw WrongUsage("exposure " + number_text(arguments.exposure_stops) + "; accepted: stops, " +
                         number_text(-kMostStops) + " to " + number_text(kMostStops));
    job.exposure_stops = arguments.exposure_stops;
    job.max_memory_bytes = memory_of(arguments.max_memory);
    job.trust_times = arguments.trust_times;
    try {
        const std::string whole_shot =
            std::to_string(shot.first_frame) + "-" + std::to_string(shot.last_frame);
        job.frames = parse_frames(arguments.frames.value_or(whole_shot), shot);
    } catch (const std::invalid_argument& error) {
        throw WrongUsage(error.what());
    }
    if (arguments.out && arguments.out->empty())
        throw WrongUsage("--out \"\": that is no folder; accepted: a path, or no --out for ./" + shot.name);
    job.out = arguments.out.value_or(shot.name);
    return job;
}

struct Cancelled {};

// Turns the shot's budget into settings, in the light of which the rest of the job is done. Throws BuildCancelled.
void spend_budget(Job& job, StopSignals& stop, Progress& progress) {
    if (!has_budget(job.scene.quality)) return;
    FixedSettings fixed{.shutter_frames = job.options.shutter_frames, .layers = job.options.layers};
    if (job.has_samples) fixed.samples = job.options.samples;
    if (job.has_sky_quality) fixed.sky_quality = job.options.lighting.sky_quality;
    const PictureBudget budget = picture_budget(
        job.scene, fixed, job.max_memory_bytes,
        {.progress = [&](double done) { progress.show_measuring(done); }, .cancel = &stop.cancelled()});
    progress.clear();
    if (!budget.holds)
        throw std::invalid_argument(budget.text +
                                    "; raise the budget, or give --samples and --sky-quality instead of it");
    if (!budget.text.empty()) std::cout << budget.text << std::endl;
    job.scene = budget.scene;
    job.options.samples = budget.options.samples;
    job.options.lighting.sky_quality = budget.options.lighting.sky_quality;
    job.options.lighting.fresnel = budget.options.lighting.fresnel;
}

struct Done {
    std::vector<int> stale;  // of the shot, not asked for, and made of something else
    int frames = 0, kept = 0;
    double seconds = 0.0;
    bool cancelled = false;
};

// What a picture in flight holds.
struct Place {
    Picture picture;
    std::string exr, png;
};

Done render_all(const Job& job, StopSignals& stop, Progress& progress) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    const auto seconds_since = [](Clock::time_point from) {
        return std::chrono::duration<double>(Clock::now() - from).count();
    };
    const Shot& shot = job.scene.shot;
    BakeProgress now{.stage = BakeStage::Planning, .total = static_cast<int>(job.frames.size())};
    progress.show(now);
    check_render(job.scene, job.options);
    const PictureFingerprint fingerprint({.scene = job.scene,
                                          .options = job.options,
                                          .sky_content = sky_content(job.scene),
                                          .exposure_stops = job.exposure_stops});
    const std::vector<int> frames = unfinished_pictures(job.out, shot, fingerprint, job.frames,
                                                        {.trust = job.trust_times,
                                                         .watch = {.progress =
                                                                       [&](double checked) {
                                                                           now.stage = BakeStage::Checking;
                                                                           now.checked = checked;
                                                                           progress.show(now);
                                                                       },
                                                                   .cancel = &stop.cancelled()}});
    Done done;
    done.kept = static_cast<int>(job.frames.size() - frames.size());
    for (const int frame : frames_in(job.out, {shot.name + '.', ".png"}))
        if (frame >= shot.first_frame && frame <= shot.last_frame &&
            !std::binary_search(job.frames.begin(), job.frames.end(), frame) &&
            !is_whole_picture(job.out / picture_file(shot, frame, "png"), fingerprint.of(frame),
                              {.trust = true}))
            done.stale.push_back(frame);
    now.kept = done.kept;
    if (frames.empty()) {
        done.seconds = seconds_since(start);
        return done;
    }
    require_memory(render_memory(job.scene, job.options, frames,
                                 std::min(static_cast<int>(frames.size()), kPicturesInFlight),
                                 tbb::this_task_arena::max_concurrency()),
                   machine::memory_limit_or(job.max_memory_bytes), "this picture");
    now.stage = BakeStage::Building;
    progress.show(now);
    files::check_folder(job.out);
    Sky sky = make_sky(job.scene);
    const BuildWatch building{.progress =
                                  [&](double built) {
                                      now.built = built;
                                      progress.show(now);
                                  },
                              .cancel = &stop.cancelled()};
    std::optional<Renderer> made;
    try {
        made.emplace(job.scene, job.options, std::move(sky), frames, building);
    } catch (const BuildCancelled&) {
        done.cancelled = true;
        return done;
    }
    Renderer& renderer = *made;
    const float exposure = shot_exposure(job.scene, renderer.sky(), job.exposure_stops);
    const auto context_of = [&](int frame) {
        return PictureContext{.scene = job.scene,
                              .options = job.options,
                              .sky = renderer.sky(),
                              .made_of = fingerprint.of(frame),
                              .exposure = exposure};
    };
    if (!renderer.check_cameras(frames, {.progress =
                                             [&](double part) {
                                                 progress.show("looking where the camera is above water: " +
                                                               std::to_string(std::lround(100.0 * part)) +
                                                               " %");
                                             },
                                         .cancel = &stop.cancelled()})) {
        done.cancelled = true;
        return done;
    }
    // Whatever is refused has left no folder behind.
    files::ensure_folder(job.out);
    files::remove_stale_temporaries(job.out);
    stop.files_begin();
    now.stage = BakeStage::Frames;
    const Clock::time_point first_frame = Clock::now();
    const auto stop_if_cancelled = [&] {
        if (stop.cancelled().load(std::memory_order_relaxed)) throw Cancelled();
    };

    std::array<Place, kPicturesInFlight> places;
    PipelineStages stages;
    stages.compute = [&](int item, int place) {
        stop_if_cancelled();
        const RenderWatch watch{.progress =
                                    [&](double part) {
                                        progress.show("frame " + std::to_string(frames[item]) + ": " +
                                                      std::to_string(std::lround(100.0 * part)) + " %, " +
                                                      std::to_string(done.frames) + " of " +
                                                      std::to_string(frames.size()) + " whole");
                                    },
                                .cancel = &stop.cancelled()};
        if (!renderer.render(frames[item], places[place].picture, watch)) throw Cancelled();
    };
    stages.encode = [&](int item, int place) {
        Place& at = places[place];
        const PictureContext context = context_of(frames[item]);
        at.png = encode_png(context, at.picture, frames[item]);
        at.exr = encode_exr(context, at.picture, frames[item]);
    };
    stages.write = [&](int item, int place) {
        files::write_atomically(job.out / picture_file(shot, frames[item], "png"), places[place].png);
        files::write_atomically(job.out / picture_file(shot, frames[item], "exr"), places[place].exr);
    };
    stages.written = [&](int item) {
        now.frame = frames[item];
        now.done = ++done.frames;
        now.seconds = seconds_since(first_frame);
        progress.show(now);
    };
    try {
        run_pipeline(static_cast<int>(frames.size()), kPicturesInFlight, stages);
    } catch (const Cancelled&) {
        done.cancelled = true;
    }
    done.seconds = seconds_since(start);
    return done;
}

int run(const RenderArguments& arguments) {
    Job job;
    try {
        job = job_of(arguments);
    } catch (const WrongUsage& error) {
        std::cerr << "pelagic: " << error.what() << "\nSee: pelagic render --help\n";
        return kWrongUsage;
    }
    const std::string out = line_text(job.out.string());
    if (const std::string thin = spray_warning(job.scene); !thin.empty())
        std::cerr << line_text(arguments.shot) << ": note: " << thin << std::endl;
    StopSignals stop;
    Progress progress;
    Threads threads(arguments.threads);
    Done done;
    try {
        done = threads.execute([&] {
            try {
                spend_budget(job, stop, progress);
            } catch (const BuildCancelled&) {
                Done none;
                none.cancelled = true;
                return none;
            }
            return render_all(job, stop, progress);
        });
    } catch (const std::bad_alloc&) {
        progress.clear();
        std::cerr << "pelagic: out of memory; ask for a smaller picture with --size (now "
                  << job.scene.camera.resolution.x << "x" << job.scene.camera.resolution.y
                  << ") or lower the cascades' resolutions; files already written are whole\n";
        return kRefused;
    } catch (const NotEnoughMemory& error) {
        progress.clear();
        return refuse_memory(arguments.shot, error);
    } catch (const std::invalid_argument& error) {
        progress.clear();
        std::cerr << placed(arguments.shot, error.what()) << '\n';
        return kRefused;
    }
    progress.clear();
    const std::string asked = count_text(static_cast<long>(job.frames.size()), "frame", "frames");
    if (done.cancelled) {
        std::cerr << "pelagic: stopped; " << done.frames + done.kept << " of the " << asked
                  << " asked for are whole in " << out << "; run the same command again to continue\n";
        return kSignal + stop.number();
    }
    std::cout << "pictures: "
              << line_text((job.out / picture_file(job.scene.shot, job.frames.front(), "exr")).string())
              << (job.frames.size() > 1 ? " …" : "") << " and .png\n"
              << count_text(done.frames, "frame", "frames") << " rendered in " << duration_text(done.seconds);
    if (done.kept > 0) std::cout << ", " << done.kept << " kept as they were";
    std::cout << std::endl;
    if (!done.stale.empty())
        std::cerr << "pelagic: in " << out << " the frames " << frames_text(done.stale)
                  << " are of another version of this shot, and were not asked for; render them again with "
                     "--frames, or without it for the whole shot\n";
    for (const std::string& line : foreign_pictures(job.out, job.scene.shot))
        std::cerr << "pelagic: in " << out << " lies " << line << "; nothing was deleted\n";
    return kDone;
}

}  // namespace

Verb add_render(CLI::App& program) {
    CLI::App* command = program.add_subcommand("render", help::kRender);
    command->group(help::kVerbs);
    command->footer(help::kRenderFooter);
    auto arguments = std::make_shared<RenderArguments>();
    command->add_option("SHOT.toml", arguments->shot, help::kShot)->required()->type_name("");
    command->add_option("--out", arguments->out, help::kOut)->type_name("DIR");
    command->add_option("--frames", arguments->frames, help::kFrames)->type_name("FRAMES");
    add_size(*command, arguments->size, help::kSize);
    command->add_option("--exposure", arguments->exposure_stops, help::kExposure)->type_name("EV");
    command->add_option("--samples", arguments->samples, help::kSamples)->type_name("N");
    command->add_option("--sky-quality", arguments->sky_quality, help::kSkyQuality)->type_name("QUALITY");
    command->add_option("--terms", arguments->terms, help::kTerms)->type_name("TERMS");
    command->add_option("--shutter", arguments->shutter_frames, help::kShutter)->type_name("FRAMES");
    command->add_flag("--alpha", arguments->alpha, help::kAlpha);
    command->add_option("--layers", arguments->layers, help::kLayers)->type_name("LAYERS");
    command->add_flag("--trust-times", arguments->trust_times, help::kTrustPictures);
    add_threads(*command, arguments->threads, help::kThreads);
    add_max_memory(*command, arguments->max_memory, help::kMaxMemory);
    return {command, [arguments] { return run(*arguments); }};
}

}  // namespace pelagic::cli
