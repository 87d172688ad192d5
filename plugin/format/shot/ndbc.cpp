// Directional wave spectra of the NDBC archive. See ndbc.h.
#include "plugin/format/shot/ndbc.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "plugin/format/shot/text_file.h"

namespace pelagic {

namespace {

constexpr std::size_t kMostBytes = std::size_t{64} << 20;  // a year of hours with 47 bins is 3 MiB
constexpr std::size_t kMostColumns = 1024;                 // the archive's have at most 52

[[noreturn]] void fail(std::string problem, std::string accepted) {
    throw NdbcError({std::move(problem), std::move(accepted), false});
}

// The line's words; of a hostile line the first kMostColumns + 1.
std::vector<std::string_view> words(std::string_view line) {
    constexpr std::string_view kSpace = " \t\r";
    std::vector<std::string_view> out;
    for (std::size_t at = line.find_first_not_of(kSpace);
         at != std::string_view::npos && out.size() <= kMostColumns;) {
        const std::size_t end = std::min(line.find_first_of(kSpace, at), line.size());
        out.push_back(line.substr(at, end - at));
        at = line.find_first_not_of(kSpace, end);
    }
    return out;
}

std::string columns_text(std::size_t words) {
    return words > kMostColumns ? "more than " + std::to_string(kMostColumns) + " columns"
                                : std::to_string(words) + " columns";
}

// A word of a file, for messages.
std::string shown(std::string_view word) {
    return quoted_text(shortened(word));
}

template <class Number>
std::optional<Number> parsed(std::string_view word) {
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

// The name of a w file, taken apart around its letter: what stands before, what after.
struct NameParts {
    std::string before, after, station;
};

NameParts taken_apart(const std::filesystem::path& w_file) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto is_letter_or_digit = [&](char c) {
        return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    };
    const std::string name = w_file.filename().string();
    constexpr std::size_t kYearDigits = 4;
    for (std::size_t at = name.size(); at-- > 0;) {
        const std::size_t year_end = at + 1 + kYearDigits;
        if (name[at] != 'w' || year_end > name.size()) continue;
        const std::string_view year = std::string_view(name).substr(at + 1, kYearDigits);
        if (!std::all_of(year.begin(), year.end(), is_digit)) continue;
        if (year_end < name.size() && is_digit(name[year_end])) continue;
        std::size_t station = at;
        while (station > 0 && is_letter_or_digit(name[station - 1])) --station;
        return {name.substr(0, at), name.substr(at + 1), name.substr(station, at - station)};
    }
    fail(line_text(shortened(w_file.string(), 300)) + " is not named like a file of spectral densities",
         "a name with the letter w before the year, such as 41010w2019.txt");
}

struct Row {
    int line;
    std::vector<std::string> values;  // one for each frequency
};

struct Table {
    std::filesystem::path file;
    std::vector<double> frequencies_hz;
    std::vector<std::chrono::sys_seconds> times;  // of all rows
    std::optional<Row> row;                       // the first of the time that is asked for

    std::string name() const { return line_text(file.string()); }  // for messages
    std::string place(int line) const { return name() + ':' + std::to_string(line) + ": "; }
};

std::vector<double> parsed_header(const Table& table, int line, std::span<const std::string_view> columns) {
    std::vector<double> frequencies_hz;
    for (const std::string_view column : columns) {
        const std::optional<double> frequency = parsed<double>(column);
        if (!frequency || !limits::kMeasuredFrequency_hz.holds(*frequency)) {
            fail(table.place(line) + shown(column) + " is no frequency",
                 "a header of frequencies, each " + text_of(limits::kMeasuredFrequency_hz) + " Hz");
        }
        if (!frequencies_hz.empty() && *frequency <= frequencies_hz.back()) {
            fail(table.place(line) + "the frequency " + shown(column) + " is not above the one before",
                 "rising frequencies");
        }
        frequencies_hz.push_back(*frequency);
    }
    if (frequencies_hz.size() < 2) {
        fail(table.place(line) + "the header names fewer than two frequencies",
             "a header such as \"#YY MM DD hh mm .0200 .0325 …\"");
    }
    return frequencies_hz;
}

std::chrono::sys_seconds parsed_time(const Table& table, int line,
                                     std::span<const std::string_view> columns) {
    std::array<int, 5> parts{};  // year, month, day, hour, minute; older files have no minutes
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const std::optional<int> part = parsed<int>(columns[i]);
        if (!part) {
            fail(table.place(line) + shown(columns[i]) + " is no part of a date",
                 "year month day hour [minute]");
        }
        parts[i] = *part;
    }
    auto [year, month, day, hour, minute] = parts;
    // Two digits were written until 1998; the archive begins in the 1970s.
    if (year >= 0 && year < 100) year += year < 70 ? 2000 : 1900;
    const std::chrono::year_month_day date{std::chrono::year{year},
                                           std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    const bool in_range = year > 0 && year < 10000 && month > 0 && month < 13 && day > 0 && day < 32;
    if (!in_range || !date.ok() || hour < 0 || hour > 23 || minute < 0 || minute > 59) {
        fail(table.place(line) + "the row does not begin with a date",
             "year month day hour [minute], in UTC");
    }
    return std::chrono::sys_days{date} + std::chrono::hours{hour} + std::chrono::minutes{minute};
}

// The columns before the frequencies have names instead of numbers: year, month, day, hour and, in later
// years, minute.
std::size_t time_columns(const Table& table, int line, std::span<const std::string_view> header) {
    std::size_t count = 0;
    while (count < header.size() && !parsed<double>(header[count])) ++count;
    if (count != 4 && count != 5) {
        fail(table.place(line) + "this is not the header of an NDBC spectrum file",
             "a first line such as \"#YY MM DD hh mm .0200 .0325 …\"");
    }
    return count;
}

Table read_table(const std::filesystem::path& file, std::chrono::sys_seconds asked) {
    Table table{.file = file, .frequencies_hz = {}, .times = {}, .row = {}};
    std::string whole;
    try {
        std::error_code ignored;
        if (std::filesystem::is_fifo(file, ignored)) throw TextFileError("is a pipe, not a file");
        whole = read_text_file(file, kMostBytes);
    } catch (const TextFileError& error) {
        fail(table.name() + ' ' + error.what(),
             "NDBC's five files of a buoy and year in one folder, those with the letters w, d, i, j and k");
    }
    std::size_t times = 0;
    int line_number = 0;
    const std::string_view text = whole;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        std::string_view line = text.substr(at, end - at);
        at = end + 1;
        ++line_number;
        const bool is_comment = line.starts_with('#');
        if (is_comment) line.remove_prefix(1);
        const std::vector<std::string_view> columns = words(line);
        if (columns.empty()) continue;
        if (times == 0) {
            if (columns.size() > kMostColumns)
                fail(table.place(line_number) + "the header has " + columns_text(columns.size()),
                     "at most " + std::to_string(kMostColumns));
            times = time_columns(table, line_number, columns);
            table.frequencies_hz = parsed_header(table, line_number, std::span(columns).subspan(times));
        } else if (!is_comment) {
            if (columns.size() != times + table.frequencies_hz.size()) {
                fail(table.place(line_number) + "the row has " + columns_text(columns.size()),
                     "as many as the header: " + std::to_string(times + table.frequencies_hz.size()));
            }
            table.times.push_back(parsed_time(table, line_number, std::span(columns).first(times)));
            if (table.times.back() == asked && !table.row)
                table.row = {line_number,
                             {columns.begin() + static_cast<std::ptrdiff_t>(times), columns.end()}};
        }
    }
    if (table.times.empty()) fail(table.name() + " has no rows", "a header and at least one row");
    return table;
}

// The file's times that stand nearest to the one asked for.
std::string nearest_times(const Table& table, std::chrono::sys_seconds time) {
    std::vector<std::chrono::sys_seconds> times = table.times;
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    const auto after = std::lower_bound(times.begin(), times.end(), time);
    std::string nearest;
    if (after != times.begin()) nearest = time_text(*std::prev(after));
    if (after != times.end()) nearest += (nearest.empty() ? "" : " and ") + time_text(*after);
    return "one of its " + std::to_string(times.size()) + " times, " + time_text(times.front()) + " … " +
           time_text(times.back()) + "; nearest: " + nearest;
}

const Row& row_at(const Table& table, std::chrono::sys_seconds time) {
    if (!table.row)
        throw NdbcError({table.name() + " has no row of that time", nearest_times(table, time), true});
    return *table.row;
}

// A value of the table, within the range; nothing where it is missing: "MM", 999 in any spelling, or for
// densities also 99.00, which older files use. (A true density of exactly 99.00 m²/Hz is bridged by its
// neighbours then.)
struct Column {
    const char* what;
    Range range;
    bool missing_at_99 = false;
};

std::optional<double> value_at(const Table& table, const Row& row, std::size_t index, const Column& column) {
    const std::string& word = row.values.at(index);
    if (word == "MM") return std::nullopt;
    const std::optional<double> value = parsed<double>(word);
    constexpr double kMissing = 999.0;
    if (value && (*value == kMissing || (column.missing_at_99 && *value == 99.0))) return std::nullopt;
    if (!value || !column.range.holds(*value)) {
        fail(table.place(row.line) + shown(word) + " at " + number_text(table.frequencies_hz[index]) +
                 " Hz is no " + column.what,
             text_of(column.range) + ", or 999 for a missing value");
    }
    return *value;
}

}  // namespace

std::string time_text(std::chrono::sys_seconds time) {
    const auto day = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date{day};
    const std::chrono::hh_mm_ss clock{time - day};
    std::array<char, 64> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%04d-%02u-%02uT%02d:%02d:%02dZ",
                  static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                  static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()),
                  static_cast<int>(clock.minutes().count()), static_cast<int>(clock.seconds().count()));
    return buffer.data();
}

MeasuredSpectrum load_ndbc(const std::filesystem::path& w_file, std::chrono::sys_seconds time) {
    const NameParts name = taken_apart(w_file);
    const Table densities = read_table(w_file, time);
    std::vector<Table> directional;  // d, i, j, k
    for (const char letter : {'d', 'i', 'j', 'k'}) {
        directional.push_back(read_table(w_file.parent_path() / (name.before + letter + name.after), time));
        if (directional.back().frequencies_hz != densities.frequencies_hz) {
            fail(directional.back().name() + " has other frequencies than " + densities.name(),
                 "five files with the same frequencies");
        }
    }
    const Row& density_row = row_at(densities, time);
    std::array<const Row*, 4> rows{};
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = &row_at(directional[i], time);

    constexpr Column kDensity{"spectral density in m²/Hz", {0.0, 1e4}, true};
    constexpr Column kDirection{"direction in degrees", {0.0, 360.0}};
    constexpr Column kSpread{"directional coefficient × 100", {0.0, 100.0}};
    constexpr std::array kColumns{kDirection, kDirection, kSpread, kSpread};

    MeasuredSpectrum spectrum{
        .bins = {}, .station = name.station, .time = time_text(time), .file = w_file.string()};
    for (std::size_t f = 0; f < densities.frequencies_hz.size(); ++f) {
        const std::optional<double> density = value_at(densities, density_row, f, kDensity);
        std::array<std::optional<double>, 4> values;
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = value_at(directional[i], *rows[i], f, kColumns[i]);
        if (!density) continue;
        MeasuredSpectrum::Bin bin{densities.frequencies_hz[f], *density, 0.0, 0.0, 0.0, 0.0, false};
        if (std::all_of(values.begin(), values.end(), [](const auto& value) { return value.has_value(); })) {
            const auto [alpha1_deg, alpha2_deg, r1_percent, r2_percent] = values;
            const double theta1 = (270.0 - *alpha1_deg) * (std::numbers::pi / 180.0);
            const double theta2 = (270.0 - *alpha2_deg) * (std::numbers::pi / 180.0);
            bin.c1_re = *r1_percent / 100.0 * std::cos(theta1);
            bin.c1_im = *r1_percent / 100.0 * std::sin(theta1);
            bin.c2_re = *r2_percent / 100.0 * std::cos(2.0 * theta2);
            bin.c2_im = *r2_percent / 100.0 * std::sin(2.0 * theta2);
            bin.has_direction = true;
        }
        spectrum.bins.push_back(bin);
    }
    if (spectrum.bins.size() < 2) {
        throw NdbcError(
            {densities.place(density_row.line) + "fewer than two densities were measured at that time",
             nearest_times(densities, time), true});
    }
    return spectrum;
}

}  // namespace pelagic
