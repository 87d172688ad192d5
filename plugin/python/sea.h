// pelagic.Sea and the projected grids of its views.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "core/surface/projected_grid.h"
#include "core/waves/sea.h"

namespace pelagic::python {

// What Python holds: a Sea is immutable, and frames keep it alive. Its plan has one query, number 0, of these
// products and of displacements wherever positions are: those are the same sums.
struct PythonSea {
    std::shared_ptr<const Sea<float>> sea;
    ProductSet products;
    const Plan& plan() const { return sea->plan(); }
    const Query& query() const { return plan().queries.front().query; }
};

// The product of this identifier. pybind11::value_error, with the nearest, where there is none.
const ProductRow& product_of(const std::string& name);
// All identifiers: "position, normal, …".
std::string product_names();

// View's grids: Sea.projected_grid() and what it returns.
void add_grids(pybind11::module_& module, pybind11::class_<PythonSea>& sea);

}  // namespace pelagic::python
