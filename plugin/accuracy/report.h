// Measured rows as a table for people, as CSV, and as a page with plots.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plugin/accuracy/accuracy.h"

namespace pelagic {

// One line a setting, with a heading for each row; `now` (UTC, as MeasuredRow::when) tells how old what was recorded is.
std::string text_report(const std::vector<MeasuredRow>& rows, std::string_view now, const std::string& shot);

// One line a setting: row, shot, when, machine, setting, whether it is the shot's, ms, bytes, transforms, and the row's
// errors; of a row of parts the shot without each. Reads back exactly. RFC 4180, with a line of names.
std::string csv_report(const std::vector<MeasuredRow>& rows);
// Throws std::invalid_argument, naming the line, for text that isn't such a table. Rows that this program doesn't have, and
// rows of parts that were cut, are left out.
std::vector<MeasuredRow> read_csv_report(std::string_view text);

// A page that needs nothing beside it: what to learn in a minute, then each row with its plot, error against time on
// logarithmic axes, the settings that no other beats in both joined by a line. Points name their settings. Of parts bars.
std::string html_report(const std::vector<MeasuredRow>& rows, std::string_view now,
                        const std::string& shot_name, const std::string& shot);

// A row's plot as a file of its own, for other pages; empty for a row without settings.
std::string svg_report(const MeasuredRow& row);

}  // namespace pelagic
