// pelagic_trace SHOT.toml: a picture of the shot's sea, and of an object that floats in it, by rays.
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "plugin/files/files.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/render/picture_files.h"
#include "tracer.h"

namespace pelagic::trace {
namespace {

struct Arguments {
    std::string shot, object, out = ".", mode = "visibility";
    std::optional<int> frame, samples, threads;
    std::vector<int> size;
    std::vector<double> at_m{0.0, 0.0};
    double heading_deg = 0.0, exposure_stops = 0.0;
};

void run(const Arguments& arguments) {
    Scene scene = load_shot(arguments.shot, check_scene);
    if (!arguments.size.empty()) scene.camera.resolution = {arguments.size[0], arguments.size[1]};
    TraceOptions options{.picture = render_options(scene), .traced = arguments.mode == "traced"};
    options.picture.layers.reset();
    if (arguments.samples) options.picture.samples = *arguments.samples;
    std::optional<FloatingObject> object;
    if (!arguments.object.empty()) object = read_obj(arguments.object);
    options.object = object ? &*object : nullptr;
    options.placement = {.at_m = {arguments.at_m[0], arguments.at_m[1]},
                         .heading_rad = arguments.heading_deg * std::numbers::pi / 180.0};
    const int frame = arguments.frame.value_or(scene.shot.first_frame);
    const Sky sky = make_sky(scene);
    const std::filesystem::path folder(arguments.out);
    Tracer tracer(scene, options, sky, frame);
    const bool is_terminal = isatty(STDERR_FILENO) != 0;
    const TracedPicture traced = tracer.render([&](double done) {
        if (is_terminal) std::fprintf(stderr, "\r%3.0f %%", 100.0 * done);
    });
    if (is_terminal) std::fprintf(stderr, "\r     \r");
    std::filesystem::create_directories(folder);
    const PictureContext context{.scene = scene,
                                 .options = options.picture,
                                 .sky = sky,
                                 .made_of = "rays: " + arguments.mode,
                                 .exposure = shot_exposure(scene, sky, arguments.exposure_stops)};
    for (const char* extension : {"exr", "png"}) {
        const std::filesystem::path file = folder / picture_file(scene.shot, frame, extension);
        files::write_atomically(file, extension == std::string("exr")
                                          ? encode_exr(context, traced.picture, frame)
                                          : encode_png(context, traced.picture, frame));
        std::cout << file.string() << '\n';
    }
}

}  // namespace
}  // namespace pelagic::trace

int main(int argc, char** argv) {
    pelagic::trace::Arguments arguments;
    CLI::App program(
        "Renders a shot's sea with an object that floats in it by rays, with Embree, into NAME.####.exr and NAME.####.png.");
    program.add_option("shot", arguments.shot, "The shot file")->required()->check(CLI::ExistingFile);
    program
        .add_option("--object", arguments.object,
                    "An OBJ file: x forward, z up, z = 0 on the water; none without")
        ->check(CLI::ExistingFile);
    program.add_option("--at", arguments.at_m, "Where it floats: x and y in the world [m]")->expected(2);
    program.add_option("--heading", arguments.heading_deg,
                       "Where it points, counter-clockwise from +x [degrees]");
    program
        .add_option(
            "--mode", arguments.mode,
            "visibility: rays decide what hides what, the rest is as `pelagic render` has it; traced: mirrored and "
            "refracted rays and shadows as well")
        ->check(CLI::IsMember({"visibility", "traced"}));
    program.add_option("--frame", arguments.frame, "The frame; without, the shot's first");
    program.add_option("--size", arguments.size, "Width and height [pixels]")
        ->expected(2)
        ->check(CLI::Range(1, 65536));
    program.add_option("--samples", arguments.samples, "N x N rays a pixel")
        ->check(CLI::Range(1, pelagic::kMostSamples));
    program.add_option("--exposure", arguments.exposure_stops, "Brighter by so many stops")
        ->check(CLI::Range(-30.0, 30.0));
    program.add_option("--threads", arguments.threads, "At most so many")->check(CLI::Range(1, 4096));
    program.add_option("--out", arguments.out, "The folder of the pictures");
    CLI11_PARSE(program, argc, argv);
    try {
        const tbb::global_control threads(
            tbb::global_control::max_allowed_parallelism,
            static_cast<std::size_t>(arguments.threads.value_or(tbb::info::default_concurrency())));
        pelagic::trace::run(arguments);
        return 0;
    } catch (const std::exception& problem) {
        std::cerr << "pelagic_trace: " << problem.what() << '\n';
        return 1;
    }
}
