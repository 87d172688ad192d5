// pelagic.Sea and the projected grids of its views.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/plan/products.h"
#include "core/surface/projected_grid.h"
#include "core/waves/sea_over_time.h"

namespace pelagic::python {

// Of products, as a caller lists them. One text alone is refused in words.
struct Names {
    std::vector<std::string> all;
};

// What Python holds: a Sea is immutable, and frames keep it alive. Its plan has one query, number 0, of these
// products, and of displacements wherever positions are, which are the same sums.
struct PythonSea {
    std::shared_ptr<const SeaOverTime<float>> sea;
    ProductSet outputs;  // that may be asked for
    const Plan& plan() const { return sea->plan(); }
    const Query& query() const { return plan().queries.front().query; }
};

// The index of the output of this identifier. pybind11::value_error, with the nearest, where there is none.
std::size_t output_of(const std::string& name);
// All identifiers: "position, normal, …".
std::string output_names();

// View's grids: Sea.projected_grid() and what it returns.
void add_grids(pybind11::module_& module, pybind11::class_<PythonSea>& sea);

}  // namespace pelagic::python

template <>
struct pybind11::detail::type_caster<pelagic::python::Names> {
    using All = make_caster<std::vector<std::string>>;
    PYBIND11_TYPE_CASTER(pelagic::python::Names, All::name);

    bool load(handle from, bool convert) {
        if (PyUnicode_Check(from.ptr()) != 0)
            throw type_error("\"" + from.cast<std::string>() +
                             "\" is one text; accepted: a list or a tuple of names");
        All all;
        if (!all.load(from, convert)) return false;
        value.all = cast_op<std::vector<std::string>&&>(std::move(all));
        return true;
    }
};
