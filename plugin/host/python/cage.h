// pelagic.Cage as Python's scenes hold it.
#pragma once

#include <memory>
#include <string>

#include "pelagic/cage.h"

namespace pelagic::python {

struct PythonCage {
    std::shared_ptr<const Cage> cage;
    std::string file;  // where it was read, or empty
};

}  // namespace pelagic::python
