// pelagic.Sea: one query over one scene, in single precision.
#include "plugin/host/python/sea.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/plan/plan.h"
#include "core/scene/names.h"
#include "plugin/budget/budget.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/task.h"
#include "plugin/host/python/watch.h"
#include "plugin/light/light.h"

namespace pelagic::python {

namespace py = pybind11;

std::size_t output_of(const std::string& name) {
    std::vector<std::string> names;
    std::string accepted;
    for (std::size_t i = 0; i < kProductCount; ++i) {
        if (name == kProductTable[i].identifier) return i;
        names.emplace_back(kProductTable[i].identifier);
        accepted += (accepted.empty() ? "" : " ") + names.back();
    }
    const std::string near = nearest(name, names);
    throw py::value_error("\"" + name + "\" is no product" +
                          (near.empty() ? "" : ", the nearest is \"" + near + "\"") +
                          "; accepted: " + accepted);
}

std::string output_names() {
    std::string names;
    for (const ProductRow& row : kProductTable)
        names += (names.empty() ? "" : ", ") + std::string(row.identifier);
    return names;
}

namespace {

using Levels = std::variant<double, std::vector<double>>;

struct SeaRequest {
    Names products;
    std::optional<Levels> cell_m, pixel_m;
    std::optional<std::vector<double>> lattice;
    std::vector<View> views;
    bool pixels = false;
};

// name: the caller's, for messages.
std::vector<double> levels(const std::optional<Levels>& levels, const char* name, const Surface& surface) {
    if (!levels) return {surface.size_m / surface.resolution};
    const double* const one = std::get_if<double>(&*levels);
    std::vector<double> given = one ? std::vector{*one} : std::get<std::vector<double>>(*levels);
    double before_m = -1.0;
    for (const double level_m : given) {
        if (!(level_m >= 0.0 && level_m > before_m && std::isfinite(level_m)))
            throw py::value_error(std::string(name) +
                                  ": accepted: a finite number from 0 up [m], or such that rise");
        before_m = level_m;
    }
    if (given.empty())
        throw py::value_error(std::string(name) + ": is empty; accepted: a number [m], or rising ones");
    return given;
}

Query plain_query(const Scene& scene, const SeaRequest& request) {
    Query query;
    query.cell_m = levels(request.cell_m, "cell_m", scene.surface);
    query.pixel_m = levels(request.pixel_m, "pixel_m", scene.surface);
    if (request.lattice) {
        const std::vector<double>& given = *request.lattice;
        Lattice lattice;
        if (given.size() == 2 || given.size() == 3) {
            lattice = {.first_m = given[0], .spacing_m = given[1]};
            if (given.size() == 3) lattice.last_m = given[2];
        }
        const bool is_finite =
            std::all_of(given.begin(), given.end(), [](double v) { return std::isfinite(v); });
        if (given.size() < 2 || given.size() > 3 || !is_finite || !(lattice.spacing_m > 0.0) ||
            !(lattice.last_m >= lattice.first_m))
            throw py::value_error(
                "lattice: accepted: (first_m, spacing_m) or (first_m, spacing_m, last_m), finite, spacing_m > 0, "
                "last_m ≥ first_m");
        query.lattice = lattice;
    }
    return query;
}

// The levels of footprints that the views' projected grids need.
Query query_of_views(const PreparedScene& prepared, const SeaRequest& request, ProductSet products) {
    const ProjectedGridNeeds needs = projected_grid_needs(request.views, projected_grid_options(prepared));
    return view_query(prepared,
                      {.products = products,
                       .finest_cell_m = needs.finest_cell_m,
                       .finest_pixel_m = request.pixels ? needs.finest_pixel_m : needs.finest_cell_m,
                       .points = points_of(needs.size)});
}

// What a sea is built from; bad requests throw before any work.
struct SeaOrder {
    Scene scene;  // a copy: other threads may change the caller's meanwhile
    ProductSet asked;
    ProductSet held;
    std::optional<Query> plain;
    SeaRequest request;
};

SeaOrder order_of(const Scene& scene, SeaRequest request) {
    require_valid(scene);
    SeaOrder order{.scene = held(settle(scene, Purpose::Mesh, with_rates(recorded_rates()))).scene,
                   .asked = {},
                   .held = {},
                   .plain = {},
                   .request = std::move(request)};
    for (const std::string& name : order.request.products.all) order.asked.set(output_of(name));
    order.held = order.asked;
    if (order.asked[index(Product::Position)]) order.held.set(index(Product::Displacement));
    const SeaRequest& kept = order.request;
    if (!kept.views.empty() && (kept.cell_m || kept.pixel_m || kept.lattice))
        throw py::value_error(
            "views: have footprints of their own; accepted: without cell_m, pixel_m and lattice");
    if (kept.views.empty()) order.plain = plain_query(order.scene, kept);
    return order;
}

// Without the interpreter. BuildCancelled. watch: a Watch or a Task.
template <class Watching>
PythonSea built(const SeaOrder& order, Watching& watch) {
    const BuildWatch building{.progress = [&](double done) { watch.tell(done); }, .cancel = watch.flag()};
    const auto prepared = prepare(order.scene);
    Query query = order.plain ? *order.plain : query_of_views(*prepared, order.request, order.held);
    query.name = "python";
    query.products = order.held;
    // Whatever the level, arrays are float32.
    Plan plan = make_plan(prepared, {query}, {.double_precision = false});
    return {std::make_shared<const SeaOverTime<float>>(std::move(plan), building), order.asked};
}

PythonSea build_sea(const SeaOrder& order, Watch& watch) {
    std::optional<PythonSea> sea;
    beside_others(
        watch, [&] { sea = built(order, watch); }, "building the sea was cancelled");
    return *sea;
}

std::pair<float, float> dense_foam(const PythonSea& self) {
    const Sea<float>& sea = *self.sea->first();
    const Scene& scene = sea.plan().from->scene;
    const FoamLook look = make_foam(scene, nullptr, active_foam(scene, sea.residual_coverage()));
    return {look.fresh_opacity, look.old_opacity};
}

const std::string kSeaDoc =
    "A sea, built once from a scene, for one kind of question: immutable, shared by threads and frames. Where "
    "sea.wind_speed_mps or another of its numbers has keys it is that of each frame's time. "
    "Single precision.\n\n"
    "scene: a valid Scene (ShotError otherwise); later changes to it don't matter here.\n"
    "products: what evaluate() may be asked for, and so what each frame computes: " +
    output_names() +
    ". Coverage is all foam: where effects.foam_decay_s is above 0 with what earlier breaking has left; without, all foam breaks "
    "now.\n"
    "cell_m, pixel_m: footprints [m], of positions and velocities and of everything that comes from "
    "derivatives: waves too short for them are left out, and counted in slope_variance and coverage. A "
    "number for all points, or rising levels, between which each point's own footprint is blended; 0 "
    "filters nothing. Default: the spacing of the scene's patch.\n"
    "lattice: (first_m, spacing_m, last_m) where all points are known to lie at first + i·spacing in x and in y, none beyond "
    "last, seen from the world's origin: sampling may then be free of error. Only with points that do. Without last_m they go "
    "on for ever, which costs more.\n"
    "views: Views whose projected grids it is for, instead of the three above: footprints from the finest cell in them up "
    "to the horizon's. Their levels are the same for all views, so that a point's answer doesn't depend on "
    "which other views there are. pixels: as fine as the views' pixels, for normals finer than the cells.\n"
    "progress: called with the share that is done, 0 … 1, from any thread. cancel: a Cancel, or a callable "
    "that is asked as often and is true when it is enough; Cancelled is then raised.";

}  // namespace

void add_sea(py::module_& module) {
    py::class_<PythonSea> sea(module, "Sea", py::module_local(), kSeaDoc.c_str());
    const auto with_request = [&](const auto& define) {
        define(py::arg("scene"),
               py::arg("products") =
                   py::make_tuple("position", "normal", "velocity", "slope_variance", "coverage"),
               py::kw_only(), py::arg("cell_m") = py::none(), py::arg("pixel_m") = py::none(),
               py::arg("lattice") = py::none(), py::arg("views") = py::tuple(), py::arg("pixels") = false);
    };
    with_request([&](const auto&... arguments) {
        sea.def(py::init([](const Scene& scene, Names products, std::optional<Levels> cell_m,
                            std::optional<Levels> pixel_m, std::optional<std::vector<double>> lattice,
                            std::vector<View> views, bool pixels, const py::object& progress,
                            const py::object& cancel) {
                    Watch watch(progress, cancel);
                    return build_sea(order_of(scene, {std::move(products), std::move(cell_m),
                                                      std::move(pixel_m), lattice, std::move(views), pixels}),
                                     watch);
                }),
                arguments..., py::arg("progress") = py::none(), py::arg("cancel") = py::none());
        sea.def_static(
            "begin",
            [](const Scene& scene, Names products, std::optional<Levels> cell_m,
               std::optional<Levels> pixel_m, std::optional<std::vector<double>> lattice,
               std::vector<View> views, bool pixels) {
                return std::make_unique<Task>(
                    [order = order_of(scene, {std::move(products), std::move(cell_m), std::move(pixel_m),
                                              lattice, std::move(views), pixels})](Task& task) -> Task::Made {
                        return [sea = built(order, task)] { return py::cast(sea); };
                    });
            },
            arguments..., "Begins to build one: a Task whose result is the Sea.");
    });
    sea.def_property_readonly(
           "significant_height_m",
           [](const PythonSea& self) { return self.sea->first()->total().significant_height_m(); },
           "4 times the root of the variance of the whole spectrum [m]. Of a scene whose sea has keys this and mss, "
           "whitecap_threshold and dense_foam are those of the first key.")
        .def(
            "significant_height_at",
            [](const PythonSea& self, double t_s) { return self.sea->significant_height_m(t_s); },
            py::arg("t"), "significant_height_m at a time [s], of a sea that changes between its keys.")
        .def_property_readonly(
            "mss", [](const PythonSea& self) { return self.sea->first()->total().mss(); },
            "Mean square slope of the whole spectrum, capillary tail included.")
        .def_property_readonly(
            "whitecap_threshold",
            [](const PythonSea& self) { return self.sea->first()->whitecap_threshold(); },
            "The Jacobian below which there is foam, without gusts, which move it from place to place; -inf: there "
            "never is.")
        .def_property_readonly(
            "dense_foam", &dense_foam,
            "(active, left): the share of its area that foam hides, where waves break now, and in what they left; the "
            "rest is bubbles over water. effects.foam_new_opaque and foam_old_opaque, or such that the mean over a "
            "law's foam is 0.4, as both are where foam doesn't live (Koepke 1984).")
        .def_property_readonly(
            "products",
            [](const PythonSea& self) {
                py::list names;
                for (std::size_t i = 0; i < kProductCount; ++i)
                    if (self.outputs[i]) names.append(kProductTable[i].identifier);
                return py::tuple(names);
            },
            "What evaluate() may be asked for.")
        .def_property_readonly(
            "transforms_per_frame", [](const PythonSea& self) { return self.plan().transforms_per_frame(); },
            "Fourier transforms that each Frame.set() runs.")
        .def_property_readonly(
            "bytes", [](const PythonSea& self) { return self.plan().sea_bytes(); },
            "Memory that the sea holds, once for all its frames [bytes].")
        .def_property_readonly(
            "frame_bytes", [](const PythonSea& self) { return self.plan().frame_bytes(); },
            "Memory that each of its frames holds, without what foam that lives keeps of earlier times [bytes].");
    add_grids(module, sea);
}

}  // namespace pelagic::python
