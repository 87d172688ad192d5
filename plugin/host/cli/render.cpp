// pelagic render SHOT.toml
#include "plugin/render/render.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "core/lighting/primaries.h"
#include "core/plan/effects.h"
#include "core/plan/prepared_scene.h"
#include "core/plan/spray.h"
#include "core/scene/text.h"
#include "plugin/format/ocio/ocio.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/memory.h"
#include "plugin/host/cli/render_order.h"
#include "plugin/host/cli/size.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/verb.h"
#include "plugin/light/light.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render_files.h"

namespace pelagic::cli {
namespace {

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

// What is left of a text behind a number; nullptr without one.
template <class Number>
const char* read_number(const char* from, const char* end, Number& number) {
    const auto [rest, error] = std::from_chars(from, end, number);
    return error == std::errc() ? rest : nullptr;
}

// "10%": of the width at the left and the right, of the height above and below; "64": pixels on all sides.
glm::ivec2 parse_overscan(const std::string& text, glm::ivec2 size) {
    const char* const end = text.data() + text.size();
    double number = 0.0;
    const char* const rest = read_number(text.data(), end, number);
    const bool is_share = rest && std::string_view(rest, end) == "%";
    if (!rest || !(number >= 0.0) ||
        (is_share ? number > 50.0 : rest != end || number != std::floor(number) || number > size.x))
        throw WrongUsage(
            "overscan \"" + text +
            "\"; accepted: a share of the picture, 0% to 50%, or whole pixels, up to half of its width and of its height");
    if (!is_share) return glm::ivec2(static_cast<int>(number));
    return {std::lround(0.01 * number * size.x), std::lround(0.01 * number * size.y)};
}

PixelWindow parse_region(const std::string& text) {
    std::array<int, 4> corners{};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (std::size_t i = 0; i < corners.size() && at; ++i) {
        at = read_number(at, end, corners[i]);
        const bool is_last = i + 1 == corners.size();
        if (at && !is_last) at = at != end && *at == ',' ? at + 1 : nullptr;
        if (at && is_last && at != end) at = nullptr;
    }
    const PixelWindow region{{corners[0], corners[1]}, {corners[2], corners[3]}};
    if (!at || region.is_empty())
        throw WrongUsage(
            "region \"" + text +
            "\"; accepted: X0,Y0,X1,Y1, pixels from the upper left corner, those from X0,Y0 on, before X1,Y1");
    return region;
}

PictureColours colours_of(const RenderArguments& arguments) {
    PictureColours colours;
    if (arguments.primaries != "rec709" && arguments.primaries != "acescg")
        throw WrongUsage("primaries \"" + arguments.primaries + "\"; accepted: rec709, acescg");
    colours.acescg = arguments.primaries == "acescg";
    if (arguments.ocio.empty()) {
        for (const auto& [option, value] : {std::pair("--ocio-display", arguments.display),
                                            {"--ocio-view", arguments.view},
                                            {"--ocio-space", arguments.space}})
            if (!value.empty()) throw WrongUsage(std::string(option) + " without --ocio; accepted: both");
        return colours;
    }
    std::string config = arguments.ocio;
    if (config == "env") {
        const char* const named = std::getenv("OCIO");
        if (!named || !*named)
            throw WrongUsage(
                "--ocio env: the variable OCIO names no configuration; accepted: the path of a config.ocio");
        config = named;
    }
    try {
        const auto view = ocio::make_view({.config = config,
                                           .display = arguments.display,
                                           .view = arguments.view,
                                           .space = arguments.space,
                                           .aces_of_rec709 = glm::mat3(conversion(kRec709, kAces2065))});
        colours.show = [view](std::span<glm::vec3> lights) { view->apply(lights); };
        colours.shown_by = view->name() + ' ' + view->content();
    } catch (const std::invalid_argument& error) {
        throw WrongUsage("--ocio \"" + config + "\" " + error.what());
    }
    return colours;
}

}  // namespace

PictureOrder order_of(const RenderArguments& arguments, FixedSettings& fixed) {
    PictureOrder order{.scene = load_shot(arguments.shot, check_scene), .options = {}};
    if (const glm::ivec2 size = size_of(arguments.size); size.x > 0) order.scene.camera.resolution = size;
    RenderOptions& options = order.options = render_options(order.scene);
    options.samples = arguments.samples.value_or(options.samples);
    if (options.samples < 1 || options.samples > kMostSamples)
        throw WrongUsage("samples " + std::to_string(options.samples) + "; accepted: 1 to " +
                         std::to_string(kMostSamples));
    if (arguments.terms) parse_terms(*arguments.terms, options.lighting);
    if (!(arguments.shutter_frames >= 0.0 && arguments.shutter_frames <= kLongestShutter_frames))
        throw WrongUsage("shutter " + number_text(arguments.shutter_frames) + "; accepted: frames, 0 to " +
                         number_text(kLongestShutter_frames));
    options.shutter_frames = arguments.shutter_frames;
    options.alpha = arguments.alpha;
    options.deep = arguments.deep;
    if (options.deep && !options.alpha)
        throw WrongUsage("--deep without --alpha: a sky behind all has no place in it; accepted: both");
    if (options.deep && (options.shutter_frames > 0.0 || order.scene.camera.f_stop > 0.0))
        throw WrongUsage(
            "--deep of a blurred picture; accepted: no --shutter, and a shot without camera.f_stop");
    if (arguments.layers) options.layers = asked([&] { return parse_picture_layers(*arguments.layers); });
    if (arguments.sky_quality) options.lighting.sky_quality = parse_sky_quality(*arguments.sky_quality);
    const glm::ivec2 size = order.scene.camera.resolution;
    if (arguments.overscan) options.overscan_px = parse_overscan(*arguments.overscan, size);
    if (arguments.region) options.region = parse_region(*arguments.region);
    asked([&] {
        check_window(size, options);
        return true;
    });
    fixed = {
        .samples = arguments.samples, .shutter_frames = options.shutter_frames, .layers = options.layers};
    if (arguments.sky_quality) fixed.sky_quality = options.lighting.sky_quality;
    if (!(std::abs(arguments.exposure_stops) <= kMostStops))
        throw WrongUsage("exposure " + number_text(arguments.exposure_stops) + "; accepted: stops, " +
                         number_text(-kMostStops) + " to " + number_text(kMostStops));
    order.exposure_stops = arguments.exposure_stops;
    order.colours = colours_of(arguments);
    return order;
}

namespace {

void print_rendered(const RunReport& report, const PictureOrder& order, const RunOptions& options,
                    const std::string& out) {
    const Shot& shot = order.scene.shot;
    const int first = options.frames.empty() ? shot.first_frame : options.frames.front();
    std::cout << "pictures: " << line_text((options.out / picture_file(shot, first, "exr")).string())
              << (report.total > 1 ? " …" : "") << " and .png\n"
              << count_text(report.done, "frame", "frames") << " rendered in "
              << duration_text(report.seconds);
    if (report.kept > 0) std::cout << ", " << report.kept << " kept as they were";
    std::cout << std::endl;
    if (!report.stale.empty())
        std::cerr << "pelagic: in " << out << " the frames " << frames_text(report.stale)
                  << " are of another version of this shot, and were not asked for; render them again with "
                     "--frames, or without it for the whole shot\n";
    for (const std::string& line : report.foreign)
        std::cerr << "pelagic: in " << out << " lies " << line << "; nothing was deleted\n";
}

int run(const RenderArguments& arguments) {
    FixedSettings fixed;
    PictureOrder order = order_of(arguments, fixed);
    const RunOptions options = run_options(arguments, order.scene.shot);
    const auto out_of_memory = [&](int) {
        const glm::ivec2 size = order.scene.camera.resolution;
        return "out of memory; ask for a smaller picture with --size (now " + std::to_string(size.x) + "x" +
               std::to_string(size.y) +
               ") or lower the cascades' resolutions; files already written are whole";
    };
    const auto work = [&](RunOptions watched, Session& session) {
        const Settled settled = settled_for(watched, order.scene, Purpose::Pictures, session, fixed);
        settled.apply(order);
        settled.apply(watched);
        if (is_on(Effect::Spray, order.scene))
            if (const std::string thin =
                    spray_warning(order.scene, prepare(order.scene)->extent.significant_height_m);
                !thin.empty())
                std::cerr << line_text(arguments.shot) << ": note: " << thin << std::endl;
        return render_files(order, watched);
    };
    return run_frames(arguments, options,
                      {.name = "render",
                       .stopping = "stopping: the picture at hand is given up, computed ones are written",
                       .share_is = "the picture",
                       .out_of_memory = out_of_memory,
                       .work = work,
                       .report = [&](const RunReport& report, const std::string& out) {
                           print_rendered(report, order, options, out);
                       }});
}

}  // namespace

void add_picture_options(CLI::App& command, RenderArguments& arguments) {
    add_size(command, arguments.size, help::kSize);
    command.add_option("--exposure", arguments.exposure_stops, help::kExposure)->type_name("EV");
    command.add_option("--samples", arguments.samples, help::kSamples)->type_name("N");
    command.add_option("--sky-quality", arguments.sky_quality, help::kSkyQuality)->type_name("QUALITY");
    command.add_option("--terms", arguments.terms, help::kTerms)->type_name("TERMS");
    command.add_option("--shutter", arguments.shutter_frames, help::kShutter)->type_name("FRAMES");
    command.add_option("--overscan", arguments.overscan, help::kOverscan)->type_name("P%|PX");
    command.add_option("--region", arguments.region, help::kRegion)->type_name("X0,Y0,X1,Y1");
    command.add_flag("--alpha", arguments.alpha, help::kAlpha);
    command.add_flag("--deep", arguments.deep, help::kDeep);
    command.add_option("--layers", arguments.layers, help::kLayers)->type_name("LAYERS");
    command.add_option("--ocio", arguments.ocio, help::kOcio)->type_name("CONFIG");
    command.add_option("--ocio-display", arguments.display, help::kOcioDisplay)->type_name("NAME");
    command.add_option("--ocio-view", arguments.view, help::kOcioView)->type_name("NAME");
    command.add_option("--ocio-space", arguments.space, help::kOcioSpace)->type_name("NAME");
    command.add_option("--primaries", arguments.primaries, help::kPrimaries)->type_name("NAME");
}

Verb add_render(CLI::App& program) {
    CLI::App* command = program.add_subcommand("render", help::kRender)->footer(help::kRenderFooter);
    auto arguments = std::make_shared<RenderArguments>();
    command->add_option("SHOT.toml", arguments->shot, help::kShot)->required()->type_name("");
    add_run_options(*command, *arguments, help::kTrustPictures);
    add_picture_options(*command, *arguments);
    add_json(*command);
    return {command, [arguments] { return run(*arguments); }};
}

}  // namespace pelagic::cli
