#include "plugin/accuracy/report.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <optional>
#include <stdexcept>

#include "core/scene/text.h"

namespace pelagic {
namespace {

const ApproximationRow& row_of(const MeasuredRow& measured) {
    for (const ApproximationRow& row : approximation_table())
        if (measured.name == row.name) return row;
    throw std::logic_error("no approximation is called " + measured.name);
}

template <class... Values>
std::string print(const char* format, Values... values) {
    std::array<char, 256> text{};
    std::snprintf(text.data(), text.size(), format, values...);
    return text.data();
}

std::string error_text(double error) {
    if (error == 0.0) return "0";
    return std::abs(error) >= 1e-3 ? print("%.3g", error) : print("%.1e", error);
}

std::string bytes_of(std::int64_t bytes) {
    if (bytes == 0) return "";
    const auto size = static_cast<double>(bytes);
    if (std::abs(size) < 1024.0 * 1024.0) return print("%.0f KiB", size / 1024.0);
    return print("%.1f MiB", size / (1024.0 * 1024.0));
}
std::string bytes_of(std::size_t bytes) {
    return bytes_of(static_cast<std::int64_t>(bytes));
}

std::time_t time_of(std::string_view utc) {
    std::tm parts{};
    const std::string text(utc);
    if (!strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts)) return 0;
    return timegm(&parts);
}

// How old a row is, and whether it is of this shot. With its date: reports are read later than they are written.
std::string age_text(const MeasuredRow& row, std::string_view now, const std::string& shot) {
    const double days = std::difftime(time_of(now), time_of(row.when)) / 86400.0;
    std::string text = "measured on " + row.when.substr(0, std::string_view("2026-11-21").size());
    if (days >= 1.0)
        text += print(days < 2.0 ? ", %.0f day before this report" : ", %.0f days before this report",
                      std::floor(days));
    if (row.shot != shot) text += ", of the shot as it was then";
    return text;
}

// A line of a row of parts: the price of one, or a sum.
struct Price {
    std::string name;
    double ms = 0.0;
    int transforms = 0;
    std::int64_t bytes = 0;
    std::vector<double> errors;  // of the shot without the part; none of a sum
    bool is_part = false;
};

Price price_of(const std::string& name, const MeasuredSetting& setting) {
    return {name, setting.ms, setting.transforms, static_cast<std::int64_t>(setting.bytes), {}};
}

constexpr const char* kRest = "the rest";

// The parts, the dearest first; what is left without them; their sum; the whole; and the same again less the whole,
// which shows how exact all this is.
std::vector<Price> prices_of(const MeasuredRow& row) {
    const Price whole = price_of(kWholeShot, row.settings.front()),
                rest = price_of(kRest, row.settings.back());
    Price sum = rest, again;
    sum.name = "parts and rest together";
    std::vector<Price> prices;
    for (auto setting = row.settings.begin() + 1; setting + 1 < row.settings.end(); ++setting) {
        const Price without = price_of("", *setting);
        Price part{.name = setting->setting,
                   .ms = whole.ms - without.ms,
                   .transforms = whole.transforms - without.transforms,
                   .bytes = whole.bytes - without.bytes,
                   .errors = setting->errors,
                   .is_part = true};
        if (setting->setting == kShotAgain) {
            again = {.name = "the shot less the same again", .ms = part.ms, .errors = {}};
            continue;
        }
        part.name.erase(0, std::string_view(kWithout).size());
        sum.ms += part.ms;
        sum.transforms += part.transforms;
        sum.bytes += part.bytes;
        prices.push_back(std::move(part));
    }
    std::stable_sort(prices.begin(), prices.end(),
                     [](const Price& a, const Price& b) { return a.ms > b.ms; });
    for (const Price& last : {rest, sum, whole, again}) prices.push_back(last);
    return prices;
}

// Whether a row of parts has all its lines: a table that was cut hasn't.
bool is_complete(const ApproximationRow& row, const MeasuredRow& measured) {
    return row.kind != RowKind::Parts || !measured.why_none.empty() ||
           (measured.settings.size() >= 3 && measured.settings[0].setting == kWholeShot &&
            measured.settings[1].setting == kShotAgain && measured.settings.back().setting == kBareShot);
}

int width_of(const std::vector<std::string>& names) {
    std::size_t widest = 7;
    for (const std::string& name : names) widest = std::max(widest, name.size());
    return static_cast<int>(widest);
}

// In that many columns; "×" and "²" take more bytes than columns.
std::string padded(const std::string& text, int columns) {
    const auto wide = std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) == 0x80; });
    return print("%-*s", columns + static_cast<int>(wide), text.c_str());
}

std::string text_of_sweep(const ApproximationRow& row, const MeasuredRow& measured) {
    std::vector<std::string> names;
    for (const MeasuredSetting& setting : measured.settings) names.push_back(setting.setting);
    const int width = width_of(names);
    std::string text = print("    %-*s %10s", width, "setting", "ms");
    for (std::size_t e = 0; e < row.errors.size(); ++e) text += print(" %9s %zu", "error", e + 1);
    text += row.bytes ? "      bytes\n" : "\n";
    for (const MeasuredSetting& setting : measured.settings) {
        text += (setting.is_shots ? "  * " : "    ") + padded(setting.setting, width) +
                print(" %10.3f", setting.ms);
        for (const double error : setting.errors) text += print(" %11s", error_text(error).c_str());
        if (row.bytes) text += print(" %10s", bytes_of(setting.bytes).c_str());
        text += "\n";
    }
    return text;
}

std::string text_of_parts(const ApproximationRow& row, const MeasuredRow& measured) {
    const std::vector<Price> prices = prices_of(measured);
    std::vector<std::string> names;
    for (const Price& price : prices) names.push_back(price.name);
    const int width = width_of(names);
    std::string text =
        print("    %-*s %10s %11s %10s %10s", width, "part", "ms", "of the shot", "transforms", "bytes");
    for (std::size_t e = 0; e < row.errors.size(); ++e) text += print(" %9s %zu", "error", e + 1);
    text += '\n';
    const double whole_ms = measured.settings.front().ms;
    for (const Price& price : prices) {
        if (price.name == kRest) text += '\n';
        text += "    " + padded(price.name, width) +
                print(" %10.3f %9.1f %% %10d %10s", price.ms, 100.0 * price.ms / whole_ms, price.transforms,
                      price.bytes == 0 ? "0" : bytes_of(price.bytes).c_str());
        for (const double error : price.errors) text += print(" %11s", error_text(error).c_str());
        text += '\n';
    }
    return text;
}

// What the table says of a row, below its title.
std::string text_of(const MeasuredRow& measured, std::string_view now, const std::string& shot) {
    const ApproximationRow& row = row_of(measured);
    std::string text = std::string("  knob       ") + row.knob + "\n";
    if (!measured.why_none.empty()) return text + "  " + measured.why_none + "\n\n";
    text += std::string("  against    ") + row.reference + "\n  time       " + row.time + "\n";
    for (std::size_t e = 0; e < row.errors.size(); ++e)
        text += "  error " + std::to_string(e + 1) + "    " + row.errors[e] + "\n";
    text += "  " + age_text(measured, now, shot) + ", " + measured.machine + "\n\n";
    text += row.kind == RowKind::Parts ? text_of_parts(row, measured) : text_of_sweep(row, measured);
    return text + "\n  " + row.lesson + "\n\n";
}

}  // namespace

std::string text_report(const std::vector<MeasuredRow>& rows, std::string_view now, const std::string& shot) {
    std::string text;
    for (const MeasuredRow& measured : rows)
        text +=
            std::string(row_of(measured).title) + " (" + measured.name + ")\n" + text_of(measured, now, shot);
    return text + "* the shot's own setting\n";
}

// ---- CSV

namespace {

constexpr std::size_t kErrors = 3;
constexpr std::string_view kNames =
    "row,shot,when,machine,setting,is_shots,ms,bytes,transforms,error_1,error_2,error_3,why_none";

std::string csv_quoted(std::string_view field) {
    std::string text = "\"";
    for (const char c : field) text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return text + '"';
}

// The fields of a line; lines have no line ends within quotes, since no field of ours has any.
std::optional<std::vector<std::string>> fields_of_line(std::string_view line) {
    std::vector<std::string> fields(1);
    bool is_quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (is_quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"')
            fields.back() += line[++i];
        else if (c == '"')
            is_quoted = !is_quoted;
        else if (c == ',' && !is_quoted)
            fields.emplace_back();
        else
            fields.back() += c;
    }
    if (is_quoted) return {};
    return fields;
}

template <class Number>
Number number_of(const std::string& field) {
    Number number{};
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
    if (error != std::errc() || end != field.data() + field.size())
        throw std::invalid_argument("\"" + field + "\" is no number");
    return number;
}

void add_line(std::vector<MeasuredRow>& rows, const std::vector<std::string>& fields) {
    if (fields.size() != 13)
        throw std::invalid_argument("it has " + std::to_string(fields.size()) + " fields, not 13");
    const auto table = approximation_table();
    const auto known = std::find_if(table.begin(), table.end(),
                                    [&](const ApproximationRow& row) { return fields[0] == row.name; });
    if (known == table.end()) return;
    if (rows.empty() || rows.back().name != fields[0])
        rows.push_back(
            {.name = fields[0], .shot = fields[1], .when = fields[2], .machine = fields[3], .settings = {}});
    rows.back().why_none = fields[12];
    if (!fields[12].empty()) return;
    MeasuredSetting setting{.setting = fields[4],
                            .is_shots = fields[5] == "1",
                            .errors = {},
                            .ms = number_of<double>(fields[6]),
                            .bytes = number_of<std::size_t>(fields[7]),
                            .transforms = number_of<int>(fields[8])};
    for (std::size_t e = 0; e < known->errors.size(); ++e)
        setting.errors.push_back(number_of<double>(fields[9 + e]));
    rows.back().settings.push_back(std::move(setting));
}

}  // namespace

std::string csv_report(const std::vector<MeasuredRow>& rows) {
    std::string text = std::string(kNames) + "\r\n";
    for (const MeasuredRow& row : rows) {
        const std::string begin = csv_quoted(row.name) + ',' + csv_quoted(row.shot) + ',' +
                                  csv_quoted(row.when) + ',' + csv_quoted(row.machine) + ',';
        if (!row.why_none.empty()) text += begin + ",,,,,,,," + csv_quoted(row.why_none) + "\r\n";
        for (const MeasuredSetting& setting : row.settings) {
            text += begin + csv_quoted(setting.setting) + (setting.is_shots ? ",1," : ",0,") +
                    number_text(setting.ms) + ',' + std::to_string(setting.bytes) + ',' +
                    std::to_string(setting.transforms);
            for (std::size_t e = 0; e < kErrors; ++e)
                text += ',' + (e < setting.errors.size() ? number_text(setting.errors[e]) : std::string());
            text += ",\r\n";
        }
    }
    return text;
}

std::vector<MeasuredRow> read_csv_report(std::string_view text) {
    std::vector<MeasuredRow> rows;
    int number = 0;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.ends_with('\r')) line.remove_suffix(1);
        const auto fail = [&](const std::string& why) {
            throw std::invalid_argument("line " + std::to_string(number) + ": " + why);
        };
        if (++number == 1) {
            if (line != kNames) fail("it doesn't begin with the names of this program's columns");
            continue;
        }
        if (line.empty()) continue;
        const auto fields = fields_of_line(line);
        if (!fields) fail("a quotation mark is missing");
        try {
            add_line(rows, *fields);
        } catch (const std::invalid_argument& error) {
            fail(error.what());
        }
    }
    if (number == 0) throw std::invalid_argument("it is empty");
    std::erase_if(rows, [](const MeasuredRow& row) { return !is_complete(row_of(row), row); });
    return rows;
}

// ---- The page

namespace {

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '&')
            out += "&amp;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

// A logarithmic axis over whole decades, or parts of one where the values are close together.
struct Axis {
    double low = 0.0, high = 1.0;  // of log10
    double from_px = 0.0, to_px = 1.0;

    Axis(const std::vector<double>& values, double from, double to) : from_px(from), to_px(to) {
        low = 1e300, high = -1e300;
        for (const double v : values) {
            low = std::min(low, std::log10(v));
            high = std::max(high, std::log10(v));
        }
        if (!(low <= high)) low = 0.0, high = 1.0;
        low = std::floor(low + 1e-9), high = std::ceil(high - 1e-9);
        if (high <= low) high = low + 1.0;
    }
    double at(double value) const {
        const double log = value > 0.0 ? std::clamp(std::log10(value), low, high) : low;
        return from_px + (log - low) / (high - low) * (to_px - from_px);
    }
};

constexpr double kWidth = 640.0, kHeight = 320.0, kLeft = 70.0, kRight = 200.0, kTop = 16.0, kBottom = 44.0;

// Settings that no other one beats in both error and time, fastest first.
std::vector<const MeasuredSetting*> pareto_front(const MeasuredRow& row) {
    std::vector<const MeasuredSetting*> sorted;
    for (const MeasuredSetting& setting : row.settings) sorted.push_back(&setting);
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) {
        return a->ms != b->ms ? a->ms < b->ms : a->errors[0] < b->errors[0];
    });
    std::vector<const MeasuredSetting*> front;
    for (const MeasuredSetting* setting : sorted)
        if (front.empty() || std::abs(setting->errors[0]) < std::abs(front.back()->errors[0]))
            front.push_back(setting);
    return front;
}

std::string plot(const ApproximationRow& row, const MeasuredRow& measured) {
    std::vector<double> times, errors;
    for (const MeasuredSetting& setting : measured.settings) {
        if (setting.ms > 0.0) times.push_back(setting.ms);
        if (setting.errors[0] != 0.0) errors.push_back(std::abs(setting.errors[0]));
    }
    const Axis x(times, kLeft, kWidth - kRight), y(errors, kHeight - kBottom, kTop);
    std::string svg = print("<svg viewBox=\"0 0 %.0f %.0f\" role=\"img\">\n<title>", kWidth, kHeight) +
                      escaped(row.title) + ": error against time</title>\n";
    const auto decades = [](const Axis& axis, const auto& mark) {
        for (int decade = static_cast<int>(axis.low); decade <= static_cast<int>(axis.high); ++decade)
            mark(axis.at(std::pow(10.0, decade)), print("1e%d", decade));
    };
    decades(x, [&](double at, const std::string& label) {
        svg += print("<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>", at, at, kTop,
                     kHeight - kBottom);
        svg += print("<text class=\"tick\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">", at,
                     kHeight - kBottom + 16.0) +
               label + "</text>\n";
    });
    decades(y, [&](double at, const std::string& label) {
        svg += print("<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\"/>", kLeft,
                     kWidth - kRight, at, at);
        svg +=
            print("<text class=\"tick\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", kLeft - 6.0, at + 4.0) +
            label + "</text>\n";
    });
    svg += print("<text class=\"axis\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">ms: ",
                 0.5 * (kLeft + kWidth - kRight), kHeight - 8.0) +
           escaped(row.time) + "</text>\n<path class=\"front\" d=\"";
    bool is_first = true;
    for (const MeasuredSetting* setting : pareto_front(measured)) {
        svg += print("%c%.1f %.1f ", is_first ? 'M' : 'L', x.at(setting->ms),
                     y.at(std::abs(setting->errors[0])));
        is_first = false;
    }
    svg += "\"/>\n";
    // Labels keep a line's height from each other, top to bottom.
    std::vector<const MeasuredSetting*> by_height;
    for (const MeasuredSetting& setting : measured.settings) by_height.push_back(&setting);
    std::stable_sort(by_height.begin(), by_height.end(), [&](const auto* a, const auto* b) {
        return y.at(std::abs(a->errors[0])) < y.at(std::abs(b->errors[0]));
    });
    double label_y = kTop - 6.0;
    for (const MeasuredSetting* setting : by_height) {
        const double px = x.at(setting->ms), py = y.at(std::abs(setting->errors[0]));
        label_y = std::max(py + 4.0, label_y + 13.0);
        svg += print("<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"><title>",
                     setting->is_shots ? "own" : "point", px, py, setting->is_shots ? 6.0 : 4.0) +
               escaped(setting->setting) + ": " + error_text(setting->errors[0]) + ", " +
               print("%.3g ms", setting->ms) + "</title></circle>";
        svg += print("<text class=\"label\" x=\"%.1f\" y=\"%.1f\">", kWidth - kRight + 10.0, label_y) +
               escaped(setting->setting) + "</text>";
        svg += print("<line class=\"lead\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n", px, py,
                     kWidth - kRight + 6.0, label_y - 4.0);
    }
    return svg + "</svg>\n";
}

// Of a row of parts: a bar for each, and for what they add up to.
std::string bars(const ApproximationRow& row, const MeasuredRow& measured) {
    constexpr double kLine = 22.0, kNameWidth = 210.0, kNumberWidth = 80.0;
    const std::vector<Price> prices = prices_of(measured);
    double longest = 1e-12;
    for (const Price& price : prices) longest = std::max(longest, price.ms);
    const double height = kTop + kLine * static_cast<double>(prices.size() - 1) + kBottom;
    std::string svg = print("<svg viewBox=\"0 0 %.0f %.0f\" role=\"img\">\n<title>", kWidth, height) +
                      escaped(row.title) + ": time</title>\n";
    double y = kTop;
    for (std::size_t p = 0; p + 1 < prices.size(); ++p) {
        const Price& price = prices[p];
        const double length = std::max(price.ms, 0.0) / longest * (kWidth - kNameWidth - kNumberWidth);
        svg += print("<text class=\"label\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">", kNameWidth - 8.0,
                     y + 0.68 * kLine) +
               escaped(price.name) + "</text>";
        svg += print("<rect class=\"%s\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>",
                     price.is_part ? "point" : "own", kNameWidth, y + 3.0, length, kLine - 6.0);
        svg += print("<text class=\"label\" x=\"%.1f\" y=\"%.1f\">%.1f ms</text>\n",
                     kNameWidth + length + 6.0, y + 0.68 * kLine, price.ms);
        y += kLine;
    }
    svg += print("<text class=\"axis\" x=\"%.1f\" y=\"%.1f\">ms: ", 8.0, y + 20.0) + escaped(row.time) +
           "</text>\n";
    return svg + "</svg>\n";
}

std::string drawing(const ApproximationRow& row, const MeasuredRow& measured) {
    return row.kind == RowKind::Parts ? bars(row, measured) : plot(row, measured);
}

std::string setting_text(const MeasuredSetting& setting) {
    return escaped(setting.setting) + ": " + error_text(setting.errors[0]) + ", " +
           print("%.3g ms", setting.ms);
}

std::string summary_line(const ApproximationRow& row, const MeasuredRow& measured) {
    std::string cells =
        "<tr><td><a href=\"#" + std::string(row.name) + "\">" + escaped(row.title) + "</a></td>";
    if (!measured.why_none.empty())
        return cells + "<td colspan=\"3\">" + escaped(measured.why_none) + "</td></tr>\n";
    if (row.kind == RowKind::Parts) {
        const Price dearest = prices_of(measured).front();
        cells += "<td colspan=\"3\">" +
                 (dearest.is_part ? "dearest: " + escaped(dearest.name) +
                                        print(", %.1f of %.1f ms", dearest.ms, measured.settings.front().ms)
                                  : std::string("nothing is on")) +
                 "</td></tr>\n";
        return cells;
    }
    const auto own = std::find_if(measured.settings.begin(), measured.settings.end(),
                                  [](const MeasuredSetting& setting) { return setting.is_shots; });
    const auto front = pareto_front(measured);
    cells += "<td>" +
             (own == measured.settings.end() ? std::string("not among the settings") : setting_text(*own)) +
             "</td><td>" + setting_text(*front.front()) + "</td><td>" + setting_text(*front.back()) +
             "</td></tr>\n";
    return cells;
}

constexpr const char* kStyle = R"css(
body { font: 15px/1.5 system-ui, sans-serif; max-width: 56rem; margin: 2rem auto; padding: 0 1rem; color: #1c2b36; }
h1, h2 { line-height: 1.2; } h2 { margin-top: 3rem; border-top: 1px solid #ccd6dd; padding-top: 1.5rem; }
table { border-collapse: collapse; margin: 1rem 0; width: 100%; } th, td { text-align: left; padding: .2rem .7rem .2rem 0; vertical-align: top; }
tbody tr { border-top: 1px solid #e4eaee; } pre { font-size: 12px; white-space: pre-wrap; }
svg { width: 100%; height: auto; }
)css";
constexpr const char* kPlotStyle = R"css(
.grid { stroke: #dbe3e8; } .tick, .axis, .label { font: 11px system-ui, sans-serif; fill: #4d6272; }
.front { fill: none; stroke: #1673a5; stroke-width: 1.5; } .point { fill: #1673a5; } .own { fill: #d2691e; } .lead { stroke: #c6d2da; stroke-width: .6; }
)css";

}  // namespace

std::string html_report(const std::vector<MeasuredRow>& rows, std::string_view now,
                        const std::string& shot_name, const std::string& shot) {
    std::string page =
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>What accuracy costs: " +
        escaped(shot_name) + "</title>\n<style>" + kStyle + kPlotStyle +
        "</style></head><body>\n<h1>What accuracy costs: " + escaped(shot_name) +
        "</h1>\n<p>Each row is an approximation with its knob: what its settings differ from the reference by, and how "
        "long a frame takes with each. Times are of one machine and compare only within a row.</p>\n"
        "<table><thead><tr><th>Approximation</th><th>the shot's setting</th><th>fastest</th><th>most accurate</th>"
        "</tr></thead><tbody>\n";
    for (const MeasuredRow& measured : rows) page += summary_line(row_of(measured), measured);
    page += "</tbody></table>\n";
    for (const MeasuredRow& measured : rows) {
        const ApproximationRow& row = row_of(measured);
        page += "<h2 id=\"" + std::string(row.name) + "\">" + escaped(row.title) + "</h2>\n";
        if (measured.why_none.empty()) page += drawing(row, measured);
        page += "<pre>" + escaped(text_of(measured, now, shot)) + "</pre>\n";
    }
    return page + "</body></html>\n";
}

std::string svg_report(const MeasuredRow& measured) {
    if (!measured.why_none.empty()) return {};
    const ApproximationRow& row = row_of(measured);
    std::string svg = drawing(row, measured);
    const std::size_t at = svg.find('>'), style = svg.find('\n', at) + 1;
    svg.insert(style,
               std::string("<style>") + kPlotStyle +
                   "</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>" +
                   print("<text class=\"axis\" x=\"%.1f\" y=\"11\">", kLeft) + escaped(row.title) +
                   (row.kind == RowKind::Parts ? std::string() : std::string(": ") + escaped(row.errors[0])) +
                   "</text>\n");
    return svg.insert(4, " xmlns=\"http://www.w3.org/2000/svg\"");
}

}  // namespace pelagic
