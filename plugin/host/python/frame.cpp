// pelagic.Frame: a sea at one time, evaluated on numpy arrays.
#include "core/waves/frame.h"

#include <pybind11/stl.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <shared_mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/effects/sea_at_time.h"
#include "core/evaluate/surface_above.h"
#include "core/scene/limits.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/sea.h"
#include "plugin/host/python/task.h"
#include "plugin/host/python/watch.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

// A point further out is a mistake: the finest waves need their phase, and indices their range.
constexpr Range kRest_m = limits::kCameraCoordinate_m;

struct Arguments {
    py::object cell_m, pixel_m, cell_axis_m, pixel_axis_m, rest_normal;
    std::array<py::object, kProductCount> arrays;  // in the order of kProductTable
    std::optional<Names> outputs;
};

struct Footprints {
    float number = 0.0f;
    Strided<const float> view{};
};

// None, a number for all points, or an array of each point's own.
void read_footprints(Footprints& footprints, const py::object& object, const Asked& asked, Copies& copies) {
    if (object.is_none()) return;
    py::ssize_t numbers = 1;
    if (!py::isinstance<py::array>(object) && PyNumber_Check(object.ptr()) != 0) {
        footprints.number = static_cast<float>(py::float_(object));
        footprints.view = {&footprints.number, 0};
    } else {
        footprints.view = readable_numbers(object, asked, copies);
        numbers = *asked.count;
    }
    for (py::ssize_t i = 0; i < numbers; ++i)
        if (!(footprints.view[static_cast<std::size_t>(i)] >= 0.0f))
            throw py::value_error(asked.name + ": accepted: numbers from 0 up");
}

// What evaluate() was asked, without Python. It stays where it is: footprints point into it.
struct Evaluation {
    Copies copies;
    Points<float> points;
    Footprints cell, pixel;
    Results<float> results;
};

void write_to(Evaluation& asked, std::size_t output, const py::object& array, py::ssize_t count) {
    const ProductRow& row = kProductTable[output];
    const Asked of{row.identifier, count};
    if (row.components == 3)
        asked.results.set(VectorProduct::checked(static_cast<Product>(output)),
                          writable_vectors(array, of, asked.copies));
    else
        asked.results.set(NumberProduct::checked(static_cast<Product>(output)),
                          writable_numbers(array, of, asked.copies));
}

// None, or an array of each point's own.
Strided<const glm::vec2> axes(const py::object& object, const Asked& asked, Copies& copies) {
    if (object.is_none()) return {};
    const Strided<const glm::vec2> view = readable_points(object, asked, copies).view;
    for (py::ssize_t i = 0; i < *asked.count; ++i) {
        const glm::vec2 axis = view[static_cast<std::size_t>(i)];
        if (!std::isfinite(axis.x) || !std::isfinite(axis.y))
            throw py::value_error(asked.name + ": accepted: finite numbers");
    }
    return view;
}

glm::dvec2 origin_of(std::array<double, 2> given_m) {
    for (const double metres : given_m)
        if (!kRest_m.holds(metres))
            throw py::value_error("origin: accepted: (x, y), " + text_of(kRest_m) + " m");
    return {given_m[0], given_m[1]};
}

// Of an array that lives as long as they do.
Points<float> points_of(const py::object& array, std::array<double, 2> origin_m, const char* name,
                        Copies& copies) {
    const auto [points, count] = readable_points(array, {name}, copies);
    return {.origin_m = origin_of(origin_m), .count = static_cast<std::size_t>(count), .rest_m = points};
}

// While the work waits for its parts, this thread takes up nobody else's: Blender runs drivers as tasks of the same TBB,
// and one that asked this frame would wait for the lock that its own thread holds.
template <class Work>
void alone(const Work& work) {
    tbb::this_task_arena::isolate(work);
}

// Points between which one may be cancelled.
constexpr std::size_t kPiece = std::size_t{1} << 18;

template <class T>
Strided<T> from(const Strided<T>& view, std::size_t first) {
    return view ? Strided<T>{&view[first], view.stride_bytes} : view;
}

Results<float> from(const Results<float>& results, std::size_t first) {
    Results<float> rest;
    for (const ProductRow& row : kProductTable) {
        if (!results.given()[index(row.product)]) continue;
        if (row.components == 3) {
            const auto product = VectorProduct::checked(row.product);
            rest.set(product, from(results.vectors(product), first));
        } else {
            const auto product = NumberProduct::checked(row.product);
            rest.set(product, from(results.numbers(product), first));
        }
    }
    return rest;
}

// Places in squares, each with its middle as its points' origin, so that single precision rounds none by more than a
// quarter of a millimetre, whichever others there are. Throws std::invalid_argument for what is no place on the sea.
class Squares {
  public:
    struct Square {
        glm::dvec2 middle_m;
        std::size_t first = 0, count = 0;  // of the places, square by square
    };

    Squares(std::span<const double> xy_m, Strided<const float> footprint_m) : order_(xy_m.size() / 2) {
        constexpr double kSide_m = 8192.0;
        const auto place_m = [&](std::size_t i) { return glm::dvec2(xy_m[2 * i], xy_m[2 * i + 1]); };
        const auto middle_m = [&](std::size_t i) { return kSide_m * glm::round(place_m(i) / kSide_m); };
        for (std::size_t i = 0; i < order_.size(); ++i)
            if (!kRest_m.holds(place_m(i).x) || !kRest_m.holds(place_m(i).y))
                throw std::invalid_argument("xy: point " + std::to_string(i) +
                                            " is no place on the sea; accepted: " + text_of(kRest_m) + " m");
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        const auto is_before = [&](std::size_t a, std::size_t b) {
            const glm::dvec2 of_a = middle_m(a), of_b = middle_m(b);
            return std::tuple(of_a.x, of_a.y, a) < std::tuple(of_b.x, of_b.y, b);
        };
        is_sorted_ = std::is_sorted(order_.begin(), order_.end(), is_before);
        if (!is_sorted_) std::sort(order_.begin(), order_.end(), is_before);
        for (const std::size_t i : order_) {
            if (all.empty() || all.back().middle_m != middle_m(i))
                all.push_back({middle_m(i), offset_m_.size(), 0});
            ++all.back().count;
            offset_m_.emplace_back(place_m(i) - middle_m(i));
            if (footprint_m) footprint_m_.push_back(footprint_m[i]);
        }
    }

    // Relative to the square's middle.
    Points<float> points(const Square& square) const {
        Points<float> points{
            .origin_m = square.middle_m, .count = square.count, .rest_m = {&offset_m_[square.first]}};
        if (!footprint_m_.empty()) points.cell_m = points.pixel_m = {&footprint_m_[square.first]};
        return points;
    }

    // Values of the places in the caller's order.
    template <class T>
    void put_back(Strided<T> values) const {
        if (is_sorted_) return;
        std::vector<T> in_order(order_.size());
        for (std::size_t k = 0; k < order_.size(); ++k) in_order[order_[k]] = values[k];
        for (std::size_t k = 0; k < order_.size(); ++k) values[k] = in_order[k];
    }

    std::vector<Square> all;

  private:
    std::vector<std::size_t> order_;
    bool is_sorted_ = true;
    std::vector<glm::vec2> offset_m_;
    std::vector<float> footprint_m_;
};

class PythonFrame {
  public:
    explicit PythonFrame(const PythonSea& sea) : sea_(sea), state_(sea.sea) {}

    void set(double t_s) {
        constexpr std::size_t kSeconds_bytes = std::size_t{1} << 28;  // of transforms, the first time
        Watch watch{py::none(), py::none()};
        try {
            work(sea_.plan().frame_bytes() > kSeconds_bytes, watch, [&] {
                const std::unique_lock writing(mutex_);
                alone([&] { state_.set(t_s, watch.flag()); });
            });
        } catch (const BuildCancelled&) {
            throw Cancelled("setting the time was cancelled");
        }
    }

    py::dict evaluate(const py::object& rest, std::array<double, 2> origin_m, const Arguments& given,
                      const py::object& progress, const py::object& cancel) const {
        Evaluation asked;
        py::dict written = read(asked, rest, origin_m, given);
        Watch watch(progress, cancel);
        try {
            work(takes_long(asked, asked.points.count), watch, [&] {
                require_on_the_sea(asked.points, "rest");
                const std::shared_lock reading(mutex_);
                run(asked, watch_of(watch));
            });
        } catch (const BuildCancelled&) {
            watch.rethrow();
            throw Cancelled("evaluating was cancelled");
        }
        watch.rethrow();
        return written;
    }

    // set() and evaluate() of the frame that `self` is.
    static std::unique_ptr<Task> begin(const py::object& self, double t_s, const py::object& rest,
                                       std::array<double, 2> origin_m, const Arguments& given) {
        auto& frame = self.cast<PythonFrame&>();
        const auto asked = std::make_shared<Evaluation>();
        py::dict written = frame.read(*asked, rest, origin_m, given);
        return std::make_unique<Task>(
            [&frame, asked, t_s](Task& task) -> Task::Made {
                require_on_the_sea(asked->points, "rest");
                const std::unique_lock writing(frame.mutex_);
                alone([&] { frame.state_.set(t_s, task.flag()); });
                frame.run(*asked, watch_of(task));
                return {};
            },
            py::make_tuple(self, rest, given.cell_m, given.pixel_m, given.cell_axis_m, given.pixel_axis_m,
                           given.rest_normal),
            written);
    }

    py::dict heights(const py::object& xy, std::array<double, 2> origin_m, const py::object& footprint_m,
                     const std::optional<Names>& outputs, const py::object& progress,
                     const py::object& cancel) const {
        require_output(index(Product::Position));
        const auto places = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(xy);
        if (!places || places.ndim() != 2 || places.shape(1) != 2)
            throw py::value_error("xy: accepted: numbers of shape (n, 2)");
        const py::ssize_t count = places.shape(0);
        const glm::dvec2 origin = origin_of(origin_m);
        Evaluation asked;
        Footprints footprints;
        read_footprints(footprints, footprint_m, {"footprint_m", count}, asked.copies);
        ProductSet wanted;
        if (outputs)
            for (const std::string& name : outputs->all) wanted.set(output_of(name));
        else
            for (const Product product : {Product::Normal, Product::Velocity})
                wanted[index(product)] = sea_.outputs[index(product)];
        py::dict written;
        for (std::size_t i = 0; i < kProductCount; ++i) {
            if (!wanted[i]) continue;
            require_output(i);
            const py::array array = fresh(i, count);
            write_to(asked, i, array, count);
            written[kProductTable[i].identifier] = array;
        }
        const auto size = static_cast<std::size_t>(count);
        const double* const xy_m = places.data();
        std::vector<glm::vec2> rest_m(size);
        std::vector<float> residual_m(size), height_m(size);
        Watch watch(progress, cancel);
        try {
            work(takes_long(asked, size), watch, [&] {
                const Squares squares({xy_m, 2 * size}, footprints.view);
                const std::shared_lock reading(mutex_);
                require_time();
                ProductSet summed = asked.results.given() & ~lasting_products();
                summed.set(index(Product::Displacement));
                if ((asked.results.given() & lasting_products()).any()) summed.set(index(Product::Breaking));
                std::vector<glm::vec3> displacement_m(size);
                if (!asked.results.holds(Product::Displacement))
                    asked.results.set(Product::Displacement, {displacement_m.data()});
                for (const Squares::Square& square : squares.all) {
                    Points<float> points = squares.points(square);
                    points.origin_m += origin;
                    const PreparedQuery<float> query(state_.frame(), 0, summed, points.origin_m);
                    for (std::size_t first = 0; first < points.count; first += kPiece) {
                        if (*watch.flag()) throw BuildCancelled();
                        const Points<float> piece{.origin_m = points.origin_m,
                                                  .count = std::min(kPiece, points.count - first),
                                                  .rest_m = from(points.rest_m, first),
                                                  .cell_m = from(points.cell_m, first),
                                                  .pixel_m = from(points.pixel_m, first)};
                        alone([&] {
                            find_highest_rest(bounds_, query, piece, {}, {&rest_m[square.first + first]},
                                              {&residual_m[square.first + first]});
                        });
                    }
                    points.rest_m = {&rest_m[square.first]};
                    const Results<float> results = from(asked.results, square.first);
                    const auto tell = [&](double done) {
                        watch.tell(
                            (static_cast<double>(square.first) + done * static_cast<double>(square.count)) /
                            static_cast<double>(size));
                    };
                    alone([&] {
                        state_.evaluate(query, points, results, {.progress = tell, .cancel = watch.flag()});
                    });
                    // What counts from the square's middle is to count from the origin.
                    const auto position_m = results.vectors(Product::Position);
                    for (std::size_t i = 0; i < points.count; ++i) {
                        rest_m[square.first + i] += glm::vec2(square.middle_m);
                        if (position_m) position_m[i] += glm::vec3(square.middle_m, 0.0);
                    }
                }
                const Strided<glm::vec3> displaced_m = asked.results.vectors(Product::Displacement);
                for (std::size_t i = 0; i < size; ++i) height_m[i] = displaced_m[i].z;
                squares.put_back(Strided<glm::vec2>{rest_m.data()});
                squares.put_back(Strided<float>{residual_m.data()});
                squares.put_back(Strided<float>{height_m.data()});
                for (const ProductRow& row : kProductTable) {
                    if (!asked.results.given()[index(row.product)]) continue;
                    if (row.components == 3)
                        squares.put_back(asked.results.vectors(VectorProduct::checked(row.product)));
                    else
                        squares.put_back(asked.results.numbers(NumberProduct::checked(row.product)));
                }
            });
        } catch (const BuildCancelled&) {
            watch.rethrow();
            throw Cancelled("finding heights was cancelled");
        }
        watch.rethrow();
        written["height_m"] = array_of<float>(std::move(height_m));
        written["rest_m"] = array_of<float>(std::move(rest_m));
        written["residual_m"] = array_of<float>(std::move(residual_m));
        return written;
    }

    PythonSea sea() const { return sea_; }
    double time_s() const { return state_.frame().time_s(); }
    long executed_transforms() const { return state_.frame().executed_transforms(); }

  private:
    // The caller's arrays, and new ones for the outputs that he names, or, if he does neither, for all
    // that the sea holds.
    std::array<py::object, kProductCount> with_fresh(const Arguments& given, py::ssize_t count) const {
        auto arrays = given.arrays;
        ProductSet wanted;
        bool none_given = true;
        for (const py::object& array : arrays) none_given = none_given && array.is_none();
        if (given.outputs)
            for (const std::string& name : given.outputs->all) wanted.set(output_of(name));
        else if (none_given)
            wanted = sea_.outputs;
        for (std::size_t i = 0; i < kProductCount; ++i)
            if (wanted[i] || !arrays[i].is_none()) require_output(i);
        for (std::size_t i = 0; i < kProductCount; ++i)
            if (wanted[i] && arrays[i].is_none()) arrays[i] = fresh(i, count);
        return arrays;
    }

    static py::array_t<float> fresh(std::size_t output, py::ssize_t count) {
        const auto components = static_cast<py::ssize_t>(kProductTable[output].components);
        if (components == 1) return py::array_t<float>(count);
        return py::array_t<float>({count, components});
    }

    void require_output(std::size_t output) const {
        if (!sea_.outputs[output])
            throw py::value_error(std::string(kProductTable[output].identifier) +
                                  ": the sea was built without it; accepted: what its products name");
    }

    // A dict of the arrays that will be written.
    py::dict read(Evaluation& asked, const py::object& rest, std::array<double, 2> origin_m,
                  const Arguments& given) const {
        asked.points = points_of(rest, origin_m, "rest", asked.copies);
        const auto count = static_cast<py::ssize_t>(asked.points.count);
        read_footprints(asked.cell, given.cell_m, {"cell_m", count}, asked.copies);
        read_footprints(asked.pixel, given.pixel_m, {"pixel_m", count}, asked.copies);
        asked.points.cell_m = asked.cell.view;
        asked.points.pixel_m = asked.pixel.view;
        asked.points.cell_axis_m = axes(given.cell_axis_m, {"cell_axis_m", count}, asked.copies);
        asked.points.pixel_axis_m = axes(given.pixel_axis_m, {"pixel_axis_m", count}, asked.copies);
        if (!given.rest_normal.is_none())
            asked.points.rest_normal =
                readable_vectors(given.rest_normal, {"rest_normal", count}, asked.copies).view;

        const auto arrays = with_fresh(given, count);
        py::dict written;
        for (std::size_t i = 0; i < kProductCount; ++i) {
            if (arrays[i].is_none()) continue;
            write_to(asked, i, arrays[i], count);
            for (const auto& [name, other] : written)
                if (overlap(py::reinterpret_borrow<py::array>(other),
                            py::reinterpret_borrow<py::array>(arrays[i])))
                    throw py::value_error(std::string(kProductTable[i].identifier) + ": overlaps " +
                                          name.cast<std::string>() +
                                          "; accepted: arrays that share no memory");
            written[kProductTable[i].identifier] = arrays[i];
        }
        return written;
    }

    // Of a Watch or a Task.
    template <class Watching>
    static BuildWatch watch_of(Watching& watch) {
        return {.progress = [&](double done) { watch.tell(done); }, .cancel = watch.flag()};
    }

    // What takes a moment needs no thread of its own.
    template <class Work>
    void work(bool takes_long, Watch& watch, const Work& work) const {
        if (takes_long) return beside_others(watch, work);
        const OthersMayRun others_may_run;
        work();
    }
    bool takes_long(const Evaluation& asked, std::size_t points) const {
        return points > kPiece || ((asked.results.given() & lasting_products()).any() && state_.has_past(0));
    }

    // Whoever calls it holds the lock. Throws BuildCancelled.
    void run(Evaluation& asked, const BuildWatch& watch) const {
        require_time();
        alone([&] { state_.evaluate(0, asked.points, asked.results, watch); });
        asked.copies.give_back();
    }

    void require_time() const {
        if (!state_.frame().is_set())
            throw std::invalid_argument("the frame has no time yet: call set(t) first");
    }

    static void require_on_the_sea(const Points<float>& points, const std::string& name) {
        const std::size_t bad = first_off_the_sea(points);
        if (bad < points.count)
            throw std::invalid_argument(name + ": point " + std::to_string(bad) +
                                        " is no place on the sea; accepted: " + text_of(kRest_m) + " m");
    }

    // The count, where all are on it. On all threads: of a million points it would be a tenth of their
    // evaluation.
    static std::size_t first_off_the_sea(const Points<float>& points) {
        using Range = tbb::blocked_range<std::size_t>;
        return tbb::parallel_reduce(
            Range(0, points.count, 16384), points.count,
            [&](const Range& range, std::size_t first) {
                for (std::size_t i = range.begin(); i < std::min(range.end(), first); ++i) {
                    const glm::vec2 rest = points.rest_m[i];
                    if (!kRest_m.holds(rest.x) || !kRest_m.holds(rest.y)) return i;
                }
                return first;
            },
            [](std::size_t a, std::size_t b) { return std::min(a, b); });
    }

    PythonSea sea_;
    SeaAtTime<float> state_;
    BoundsByLevel<float> bounds_{state_.frame(), 0};
    mutable std::shared_mutex mutex_;
};

// A line about each output's array.
std::string output_lines() {
    std::string lines;
    for (const ProductRow& row : kProductTable)
        lines += row.identifier + std::string(row.components == 1 ? ": (n,), " : ": (n, 3), ") +
                 row.description + ".\n";
    return lines;
}

const std::string kEvaluateDoc =
    "The sea at points, into the caller's arrays: a dict of what was written.\n\n"
    "rest: float32 (n, 2), the points at rest [m], relative to origin.\n"
    "origin: (x, y) [m], in double precision, as far out as points: a sea a million metres away loses nothing.\n"
    "cell_m, pixel_m: footprints [m], a number or float32 (n,), held within the sea's levels; default its "
    "first.\n"
    "cell_axis_m, pixel_axis_m: float32 (n, 2), for footprints that are ellipses: the long axis [m], where it is "
    "longer than cell_m or pixel_m, which then is the short one's length.\n"
    "rest_normal: float32 (n, 3), normals of the surface that the sea lies on, where that isn't flat: then normals are those of "
    "the waves on it.\n" +
    output_lines() +
    "Velocities are orbital, of linear waves: no Stokes drift is in them. They are per second of the frame's time; shot.time_scale of those make a second of the screen.\n"
    "outputs: names; arrays of those not given are made anew. With neither arrays nor outputs: all of the "
    "sea's products.\n\n"
    "Arrays are float32, of any strides; nothing between their numbers is touched. They are read and written in place, but "
    "through a copy where the components of a point aren't adjacent or numbers don't lie at multiples of 4 bytes. Outputs must "
    "not overlap. Any thread may call; others run meanwhile.\n\n"
    "Coverage is all foam: where it lives, with what earlier breaking has left. That is a sum over earlier times, of which the "
    "frame keeps what it can from one time to the next; a time far from those before it takes several times as long. "
    "progress: called with the share of those times that is done, 0 to 1, where they are many. cancel: a Cancel, or a callable "
    "that is asked as often and is true when it is enough; Cancelled is then raised, and the arrays hold nothing of use.";

// An output's array by its name, None where it isn't wanted.
py::object none() {
    return py::none();
}

// evaluate() and begin() with an argument for each output's array, under its identifier: a parameter for each
// number in the pack.
template <std::size_t>
using ArrayArgument = const py::object&;
template <std::size_t... kRows>
void add_evaluate(py::class_<PythonFrame>& frame, std::index_sequence<kRows...>) {
    frame.def(
        "evaluate",
        [](const PythonFrame& self, const py::object& rest, std::array<double, 2> origin,
           const py::object& cell_m, const py::object& pixel_m, const py::object& cell_axis_m,
           const py::object& pixel_axis_m, const py::object& rest_normal, ArrayArgument<kRows>... arrays,
           const std::optional<Names>& outputs, const py::object& progress, const py::object& cancel) {
            return self.evaluate(
                rest, origin, {cell_m, pixel_m, cell_axis_m, pixel_axis_m, rest_normal, {arrays...}, outputs},
                progress, cancel);
        },
        py::arg("rest"), py::arg("origin") = std::array{0.0, 0.0}, py::kw_only(), py::arg("cell_m") = none(),
        py::arg("pixel_m") = none(), py::arg("cell_axis_m") = none(), py::arg("pixel_axis_m") = none(),
        py::arg("rest_normal") = none(), (py::arg(kProductTable[kRows].identifier) = none())...,
        py::arg("outputs") = none(), py::arg("progress") = none(), py::arg("cancel") = none(),
        kEvaluateDoc.c_str());
    frame.def(
        "begin",
        [](const py::object& self, double t, const py::object& rest, std::array<double, 2> origin,
           const py::object& cell_m, const py::object& pixel_m, const py::object& cell_axis_m,
           const py::object& pixel_axis_m, const py::object& rest_normal, ArrayArgument<kRows>... arrays,
           const std::optional<Names>& outputs) {
            return PythonFrame::begin(
                self, t, rest, origin,
                {cell_m, pixel_m, cell_axis_m, pixel_axis_m, rest_normal, {arrays...}, outputs});
        },
        py::arg("t"), py::arg("rest"), py::arg("origin") = std::array{0.0, 0.0}, py::kw_only(),
        py::arg("cell_m") = none(), py::arg("pixel_m") = none(), py::arg("cell_axis_m") = none(),
        py::arg("pixel_axis_m") = none(), py::arg("rest_normal") = none(),
        (py::arg(kProductTable[kRows].identifier) = none())..., py::arg("outputs") = none(),
        "Begins set(t) and evaluate() with the rest: a Task whose result is evaluate()'s, and whose progress is what that "
        "calls progress with. It keeps the arrays alive; nobody may write to them meanwhile.");
}

}  // namespace

void add_frame(py::module_& module) {
    py::class_<PythonFrame> frame(
        module, "Frame", py::module_local(),
        "The state of a sea at one time. Its buffers are made once and reused: who needs two "
        "times at once makes two frames.");
    add_evaluate(frame, std::make_index_sequence<kProductCount>());
    frame.def(py::init<const PythonSea&>(), py::arg("sea"))
        .def(
            "set", &PythonFrame::set, py::arg("t"),
            "Makes it the sea at any finite time t [s], whatever it was before. Other threads run meanwhile. Interrupted by Ctrl-C it has no time.")
        .def(
            "heights", &PythonFrame::heights, py::arg("xy"), py::arg("origin") = std::array{0.0, 0.0},
            py::kw_only(), py::arg("footprint_m") = none(), py::arg("outputs") = none(),
            py::arg("progress") = none(), py::arg("cancel") = none(),
            "The sea above places of the world: what evaluate() gives at the points at rest that are displaced "
            "there, found by iteration; where the sea has folded over itself, at the highest. The sea must hold positions.\n\n"
            "xy: numbers of shape (n, 2), relative to origin [m], in double precision. footprint_m: as cell_m and pixel_m "
            "of evaluate().\n"
            "A dict: height_m, float32 (n,); rest_m, float32 (n, 2), the points at rest, relative to origin, and so rounded where "
            "they are far from it; residual_m, float32 "
            "(n,), how far from its place each one's surface is, below a millimetre but for a few places of a sea that "
            "has folded over; and the outputs named, by default normal and velocity, of "
            "those that the sea holds. All are finite. progress, cancel: as evaluate()'s.")
        .def_property_readonly("sea", &PythonFrame::sea, "The sea that it is of.")
        .def_property_readonly("time_s", &PythonFrame::time_s, "The time that was set [s].")
        .def_property_readonly("executed_transforms", &PythonFrame::executed_transforms,
                               "Transforms run since the frame was made: calls of set() times the sea's "
                               "transforms_per_frame.");
}

}  // namespace pelagic::python
