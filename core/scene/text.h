// How values are written in messages and in the canonical text: one spelling each, independent of the locale.
#pragma once

#include <string>

#include "core/base/text.h"

namespace pelagic {

// The shortest text that reads back as the same double: "24", "0.1", "1e8", "inf", "nan".
std::string number_text(double value);

// The same of the number to two digits, for people: "0.071", "120".
std::string rough_text(double value);

}  // namespace pelagic
