// pelagic.bake, pelagic.render_files and pelagic.Maps: what `pelagic bake` and `pelagic render` run, into files, and a bake's maps
// as arrays.
#include "plugin/bake/bake.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/precision.h"
#include "core/plan/plan.h"
#include "core/waves/frame.h"
#include "plugin/bake/output_part.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/picture.h"
#include "plugin/host/python/task.h"
#include "plugin/host/python/values.h"
#include "plugin/host/python/watch.h"
#include "plugin/run/verify.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

// ---- Files

// In the order of RunStage.
constexpr std::array kStages{"planning", "checking", "building", "looking", "frames", "waiting"};

using FramesAsked = std::variant<int, std::string, std::vector<int>>;

std::vector<int> frames_of(const std::optional<FramesAsked>& asked, const Shot& shot) {
    if (!asked) return {};
    if (const auto* text = std::get_if<std::string>(&*asked)) return parse_frames(*text, shot);
    if (const int* one = std::get_if<int>(&*asked)) return {*one};
    std::vector<int> frames = std::get<std::vector<int>>(*asked);
    if (frames.empty())
        throw py::value_error("frames: are none; accepted: frames, or None for the whole shot");
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return frames;
}

using Out = std::optional<std::filesystem::path>;
using Frames = std::optional<FramesAsked>;
using Bytes = std::optional<std::size_t>;

// A run that was asked for; what is wrong with it is said before any work.
struct RunOrder {
    RunOrder(std::function<RunReport(const RunOptions&)> of, const Shot& shot, const Out& out,
             const Frames& frames, bool trust_times, Bytes max_memory)
        : work(std::move(of)) {
        options.out = out.value_or(shot.name);
        options.frames = frames_of(frames, shot);
        options.max_memory_bytes = max_memory.value_or(0);
        options.trust_times = trust_times;
    }
    // Without the interpreter. watch: a Watch or a Task.
    template <class Watching>
    RunReport run(Watching& watch) const {
        RunOptions watched = options;
        watched.progress = [&](const RunProgress& now) {
            watch.tell(kStages[static_cast<std::size_t>(now.stage)], now.frame, now.done, now.kept, now.total,
                       now.share);
        };
        watched.cancel = watch.flag();
        return work(watched);
    }

    std::function<RunReport(const RunOptions&)>
        work;  // of a copy: others may change the caller's scene meanwhile
    RunOptions options;
};

// The run with what its budget asks for.
template <class Work>
RunReport settled_run(RunOptions options, const Scene& scene, Purpose purpose, const FixedSettings& fixed,
                      const Work& work) {
    try {
        const Settled settled = settle_for(options, scene, purpose,
                                           {.fixed = fixed,
                                            .max_memory_bytes = options.max_memory_bytes,
                                            .watch = {.progress = {}, .cancel = options.cancel}},
                                           purpose == Purpose::Pictures ? kByName : "");
        settled.apply(options);
        RunReport report = work(settled, options);
        report.note = settled.note;
        return report;
    } catch (const BuildCancelled&) {
        RunReport none;
        none.cancelled = true;
        return none;
    }
}

RunOrder bake_order(const Scene& scene, const Out& out, const Frames& frames, bool trust_times,
                    Bytes max_memory) {
    require_valid(scene);
    const auto work = [scene](const RunOptions& options) {
        return settled_run(
            options, scene, Purpose::Mesh, {},
            [](const Settled& settled, const RunOptions& run) { return bake(settled.scene, run); });
    };
    return {work, scene.shot, out, frames, trust_times, max_memory};
}

RunOrder pictures_order(const Scene& scene, const Out& out, const Frames& frames, bool trust_times,
                        Bytes max_memory, const PictureSize& size, std::optional<int> samples,
                        const std::optional<std::string>& sky_quality, const std::vector<std::string>& layers,
                        double shutter, bool alpha, const PictureSides& overscan, const PictureRegion& region,
                        double exposure) {
    const auto work = [asked = picture_request(scene, size, samples, sky_quality, layers, shutter, alpha,
                                               overscan, region, exposure)](const RunOptions& options) {
        return settled_run(options, asked.scene, Purpose::Pictures, asked.fixed,
                           [&](const Settled& settled, const RunOptions& run) {
                               PictureOrder order = asked;
                               settled.apply(order);
                               return render_files(order, run);
                           });
    };
    return {work, scene.shot, out, frames, trust_times, max_memory};
}

// NAME, which waits for the run, and begin_NAME, which doesn't. arguments: those of them that the order takes after max_memory.
template <class... Asked, class... Arguments>
void define_run(py::module_& module, const std::string& name,
                RunOrder (*order)(const Scene&, const Out&, const Frames&, bool, Bytes, Asked...),
                const char* doc, const char* begin_doc, const Arguments&... arguments) {
    const auto define = [&](const std::string& named, const auto& function, const char* says,
                            const auto&... watching) {
        module.def(named.c_str(), function, py::arg("scene"), py::arg("out") = py::none(),
                   py::arg("frames") = py::none(), watching..., py::kw_only(), py::arg("trust_times") = false,
                   py::arg("max_memory_bytes") = py::none(), arguments..., says);
    };
    define(
        name,
        [order](const Scene& scene, const Out& out, const Frames& frames, const py::object& progress,
                const py::object& cancel, bool trust_times, Bytes max_memory, Asked... asked) {
            const auto watch = shared_watch(progress, cancel);
            const auto report = std::make_shared<RunReport>();
            beside_others(watch, [=, run = order(scene, out, frames, trust_times, max_memory, asked...)] {
                *report = run.run(*watch);
            });
            watch->rethrow();
            return *report;
        },
        doc, py::arg("progress") = py::none(), py::arg("cancel") = py::none());
    define(
        "begin_" + name,
        [order](const Scene& scene, const Out& out, const Frames& frames, bool trust_times, Bytes max_memory,
                Asked... asked) {
            return std::make_unique<Task>([run = order(scene, out, frames, trust_times, max_memory,
                                                       asked...)](Task& task) -> Task::Made {
                return [report = run.run(task)] { return py::cast(report); };
            });
        },
        begin_doc);
}

void add_bake_report(py::module_& module) {
    py::class_<RunReport> report(module, "BakeReport", py::module_local(),
                                 "What a bake did, or render_files().");
    const auto add_path = [&](const char* name, std::filesystem::path RunReport::*path, const char* doc) {
        report.def_property_readonly(
            name, [path](const RunReport& self) { return (self.*path).empty() ? Out() : Out(self.*path); },
            doc);
    };
    add_path("root", &RunReport::root, "The stage, DIR/NAME.usda; None without a mesh.");
    add_path("maps", &RunReport::maps, "The folder of the maps; None without maps.");
    add_path("volumes", &RunReport::volumes, "The folder of the volumes; None without volumes.");
    add_path("record", &RunReport::record, "DIR/NAME.json; None of pictures, which have none.");
    report.def_readonly("done", &RunReport::done, "Frames that were baked or rendered.")
        .def_readonly("kept", &RunReport::kept, "Frames that were whole already.")
        .def_readonly("total", &RunReport::total, "Frames that were asked for.")
        .def_readonly(
            "note", &RunReport::note,
            "Where files that are there were made with other settings than the budget asks for today, and those stay: in words.")
        .def_readonly("cancelled", &RunReport::cancelled,
                      "Whether it was cancelled; what is in the files is whole, and the next run goes on.")
        .def_readonly("seconds", &RunReport::seconds, "From the call to its end.")
        .def_readonly(
            "stale", &RunReport::stale,
            "Frames of the shot that lie there and belong to another version of it, or whose entry in the record was "
            "altered, not asked for.")
        .def_readonly("foreign", &RunReport::foreign,
                      "Files that lie there and aren't the shot's, a line each.")
        .def_readonly(
            "unlocked", &RunReport::unlocked,
            "Why the folder can't be locked against other bakes into it; empty where it can, as far as the "
            "system says.")
        .def_readonly("damaged", &RunReport::damaged,
                      "What wasn't as it was recorded, and was made again, a line each.")
        .def_property_readonly("times", &time_text,
                               "Where the time went, a line; empty where nothing was baked.");
}

std::vector<Finding> run_verify(const std::filesystem::path& folder, const py::object& progress,
                                const py::object& cancel) {
    Watch watch(progress, cancel);
    const BuildWatch checking{.progress = [&](double done) { watch.tell(done); }, .cancel = watch.flag()};
    Verification found;
    beside_others(
        watch, [&] { found = verify(folder, checking); }, "the check was cancelled");
    return found.findings;
}

void add_verify(py::module_& module) {
    py::class_<Finding>(module, "Finding", py::module_local(),
                        "What verify() found: a file that isn't as it was written.")
        .def_readonly("path", &Finding::path, "Below the folder, with /.")
        .def_property_readonly(
            "flaw", [](const Finding& self) { return word_of(self.flaw); },
            "\"missing\", \"damaged\", \"stale\" (frames of another version of the shot), \"foreign\" (in no "
            "record) or \"interrupted\" (of a bake that was stopped before it wrote its record).")
        .def_readonly("what", &Finding::what, "In words: the end of a sentence that begins with the path.")
        .def("__repr__", [](const Finding& self) {
            return std::string("<") + word_of(self.flaw) + ": " + self.path + ' ' + self.what + '>';
        });
    module.def(
        "verify", &run_verify, py::arg("dir"), py::arg("progress") = py::none(),
        py::arg("cancel") = py::none(),
        "Reads everything that was baked or rendered into a folder, as `pelagic verify` does: a list of "
        "findings, empty where all is as it was written. Of a shot that is whole, what its runs have recorded beside "
        "NAME.json is taken into that.\n\n"
        "progress: called with the share that was read, 0 to 1, from the first second on. cancel: as bake()'s. "
        "Cancelled; FileError where there is no such folder.");
}

void add_render_files(py::module_& module) {
    define_run(
        module, "render_files", &pictures_order,
        "Renders pictures of a scene into files, DIR/NAME.####.exr and .png, as `pelagic render` does, and the same "
        "bits. Those that are whole already, and made of the same, are kept. Other threads run meanwhile.\n\n"
        "out, frames, max_memory_bytes, progress, cancel, what it raises, and Ctrl-C: as bake()'s; progress is told "
        "\"looking\" as well (share: of the cameras, those that are known to be above water), and in \"frames\" the "
        "share of the picture at hand. size, samples, sky_quality, layers, shutter, alpha, overscan, region: as render()'s. exposure: "
        "how much brighter the PNGs are [stops], -30 to 30.\n"
        "trust_times: pictures count as whole by what they say at their beginning and end; otherwise each is read "
        "in full.",
        "Begins what render_files() does: a Task whose result is the BakeReport, and whose progress is what "
        "render_files() calls progress with.",
        py::arg("size") = py::none(), py::arg("samples") = py::none(), py::arg("sky_quality") = py::none(),
        py::arg("layers") = std::vector<std::string>(), py::arg("shutter") = 0.0, py::arg("alpha") = false,
        py::arg("overscan") = PictureSides{}, py::arg("region") = py::none(), py::arg("exposure") = 0.0);
}

// ---- Arrays

using Slots = std::vector<std::unique_ptr<OutputSlot>>;

// The maps of a scene at any time.
class Maps {
  public:
    virtual ~Maps() = default;
    // Each output's, in the plan's order. Throws BuildCancelled.
    virtual Slots at(double t_s, const BuildWatch& watch) = 0;
    virtual const Plan& plan() const = 0;
};

template <class T>
class MapsOf final : public Maps {
  public:
    MapsOf(Plan plan, const BuildWatch& watch)
        : state_(std::make_shared<const Sea<T>>(std::move(plan), watch)),
          parts_(make_parts(state_.sea().plan())) {}

    Slots at(double t_s, const BuildWatch& watch) override {
        const std::lock_guard alone(mutex_);
        return tbb::this_task_arena::isolate([&] { return made_at(t_s, watch); });
    }
    const Plan& plan() const override { return state_.sea().plan(); }

  private:
    Slots made_at(double t_s, const BuildWatch& watch) {
        state_.set(t_s, watch.cancel);
        Slots slots;
        for (const auto& part : parts_) {
            slots.push_back(part->make_slot());
            // The number is for surfaces that a camera shapes.
            part->compute(state_, 0, *slots.back(), watch);
        }
        return slots;
    }

    std::mutex mutex_;
    SeaAtTime<T> state_;
    std::vector<std::unique_ptr<OutputPart>> parts_;
};

std::unique_ptr<Maps> make_maps(const Scene& scene, const std::vector<std::string>& maps, bool tiles,
                                const py::object& progress, const py::object& cancel) {
    if (maps.empty()) throw py::value_error("maps: are none; accepted: names of output.maps");
    Scene asked = scene;
    asked.output.mesh = MeshFormat::None;
    asked.output.cascade_tiles = tiles;
    asked.output.drops = false;
    set_from_python(asked, key_at("output.maps"), py::cast(maps));
    require_valid(asked);
    Watch watch(progress, cancel);
    const BuildWatch building{.progress = [&](double done) { watch.tell(done); }, .cancel = watch.flag()};
    std::unique_ptr<Maps> made;
    const auto make = [&] {
        Plan plan = plan_bake(held(settle(asked, Purpose::Mesh, with_rates(recorded_rates()))).scene);
        made = with_precision(plan.knobs.double_precision, [&]<class T>(T) -> std::unique_ptr<Maps> {
            return std::make_unique<MapsOf<T>>(std::move(plan), building);
        });
    };
    beside_others(watch, make, "building the sea was cancelled");
    return made;
}

// The arrays of one output, n × n texels, by name.
void add_arrays(py::dict& arrays, OutputSlot& slot) {
    const auto add = [&](const char* name, auto& values) {
        if (values.empty()) return;
        const auto n = static_cast<py::ssize_t>(std::llround(std::sqrt(static_cast<double>(values.size()))));
        arrays[name] = array_of<float>(std::move(values), {n, n});
    };
    add("floor_light", slot.floor_light);
    for (const ProductRow& row : kProductTable)
        if (row.components == 1)
            add(row.identifier, slot.values.numbers(NumberProduct::checked(row.product)));
        else
            add(row.identifier, slot.values.vectors(VectorProduct::checked(row.product)));
}

// By square: the patch first, then each cascade's tile.
py::tuple maps_at(const std::shared_ptr<Maps>& self, double t_s, const py::object& progress,
                  const py::object& cancel) {
    const auto watch = shared_watch(progress, cancel);
    const auto made = std::make_shared<Slots>();
    const auto make = [=] {
        *made = self->at(t_s, {.progress = [&](double done) { watch->tell(done); }, .cancel = watch->flag()});
    };
    beside_others(watch, make, "computing the maps was cancelled");
    const Slots& slots = *made;
    py::dict patch;
    py::list tiles;
    for (std::size_t i = 0; i < slots.size(); ++i) {
        const std::optional<int> cascade = self->plan().outputs[i].cascade;
        while (cascade && static_cast<int>(tiles.size()) <= *cascade) tiles.append(py::dict());
        py::dict to = cascade ? tiles[*cascade].cast<py::dict>() : patch;
        add_arrays(to, *slots[i]);
    }
    return py::make_tuple(patch, tiles);
}

}  // namespace

void add_bake(py::module_& module) {
    add_bake_report(module);
    add_verify(module);
    define_run(
        module, "bake", &bake_order,
        "Bakes a scene into files, as `pelagic bake` does, and the same bits. Files that are whole "
        "already are kept. Other threads run meanwhile.\n\n"
        "out: the folder, made where it is missing; by default ./NAME. frames: a frame, a list, a text like "
        "\"1-48x5\" or \"1,5,10-20x5\", or None for the whole shot.\n"
        "progress: called as progress(stage, frame, done, kept, total, share) from any thread: \"planning\", "
        "\"checking\" (share: of the files, those that were read), \"building\" (share: of the sea), \"frames\" (share: of the "
        "earlier times that the foam of the frame at hand comes from, while it goes through many, otherwise 0) or "
        "\"waiting\" (for another bake that writes into the folder); the frame finished last; frames "
        "written, kept, and asked for. cancel: a Cancel, or a callable that is asked as often and is true "
        "when it is enough: the bake ends soon, and its report says so.\n"
        "max_memory_bytes: MemoryError, before anything is written, for a bake that needs more; by default "
        "what the system gives this process.\n"
        "trust_times: files of the recorded size that are no newer than the record count as whole; otherwise each is "
        "read, and its checksum compared.\n"
        "FileError where a file can't be written, ShotError for a scene that is refused, ValueError for "
        "frames outside the shot.\n"
        "Ctrl-C: KeyboardInterrupt, within a second. Frames that are whole are kept, and the next bake goes on; a step that "
        "takes longer ends by itself meanwhile.",
        "Begins what bake() does: a Task whose result is the BakeReport, and whose progress is what bake() "
        "calls progress with.");
    add_render_files(module);
    py::class_<Maps, std::shared_ptr<Maps>>(
        module, "Maps", py::module_local(),
        "The maps of a scene as arrays, the values that a bake writes, in the quality's precision.\n\n"
        "maps: names of output.maps: what is computed at output.map_resolution over the patch of "
        "surface.size_m. tiles: the same over each cascade's periodic tile. progress, cancel: as "
        "Sea's.")
        .def(py::init(&make_maps), py::arg("scene"),
             py::arg("maps") = py::make_tuple("displacement", "normal", "slope-variance", "whitecaps"),
             py::kw_only(), py::arg("tiles") = false, py::arg("progress") = py::none(),
             py::arg("cancel") = py::none())
        .def(
            "at", &maps_at, py::arg("t"), py::kw_only(), py::arg("progress") = py::none(),
            py::arg("cancel") = py::none(),
            "(patch, tiles) at a time [s]: the patch's arrays, and a list of each cascade's, the largest first. "
            "Each is a dict of float32 (n, n, 3): displacement [m], normal, slope_variance (of tiles slope_variance_at_rest: what carries it is the whole "
            "sea), jacobian, and (n, n): coverage, floor_light; where foam lives the patch's is all foam, with what of it breaks now and its "
            "age [s] under evaluate()'s names, and a tile's is what breaks now. Row j, column i is the point i·L/n − L/2, j·L/n − L/2: rows from the south. Any "
            "thread may call; calls wait for each other. progress, cancel: as Frame.evaluate()'s.");
}

}  // namespace pelagic::python
