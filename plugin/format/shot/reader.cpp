// What the reading of one shot file gathers. See reader.h.
#include "plugin/format/shot/reader.h"

#include <algorithm>
#include <sstream>

#include "core/scene/text.h"

namespace pelagic {

namespace {

// The key that a key belongs to: "a.b[1].c" → "a.b[1]" → "a.b" → "a" → "".
std::string parent_of(const std::string& key) {
    const std::size_t cut = key.find_last_of(".[");
    return cut == std::string::npos ? std::string() : key.substr(0, cut);
}

bool is_before(const toml::source_position& a, const toml::source_position& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
}

// toml++ knows no place for tables that only a dotted key or a sub-table implies.
toml::source_position or_start(const toml::source_position& place) {
    return place.line > 0 ? place : toml::source_position{1, 1};
}

void append_text(std::string& out, const toml::node& node);

// These texts are for messages: lists are cut at their length.
void append_list(std::string& out, const toml::array& list) {
    out += '[';
    bool first = true;
    for (const toml::node& element : list) {
        if (out.size() > kShort) break;
        out += first ? "" : ", ";
        append_text(out, element);
        first = false;
    }
    out += ']';
}

void append_table(std::string& out, const toml::table& table) {
    out += "{ ";
    bool first = true;
    for (const auto& [key, value] : table) {
        if (out.size() > kShort) break;
        out += first ? "" : ", ";
        out += line_text(shortened(key.str())) + " = ";
        append_text(out, value);
        first = false;
    }
    out += first ? "}" : " }";
}

void append_text(std::string& out, const toml::node& node) {
    if (const auto* list = node.as_array()) {
        append_list(out, *list);
    } else if (const auto* table = node.as_table()) {
        append_table(out, *table);
    } else if (const auto* text = node.as_string()) {
        out += quoted_text(shortened(text->get()));
    } else if (const auto* number = node.as_floating_point()) {
        out += number_text(number->get());
    } else if (const auto* integer = node.as_integer()) {
        out += std::to_string(integer->get());
    } else if (const auto* truth = node.as_boolean()) {
        out += truth->get() ? "true" : "false";
    } else {
        std::ostringstream date_or_time;
        if (const auto* date = node.as_date()) date_or_time << date->get();
        if (const auto* time = node.as_time()) date_or_time << time->get();
        if (const auto* both = node.as_date_time()) date_or_time << both->get();
        out += date_or_time.str();
    }
}

}  // namespace

std::string text_of(const toml::node& node) {
    std::string text;
    append_text(text, node);
    return shortened(text);
}

std::string type_of(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::table:
            return "a table";
        case toml::node_type::array:
            return "a list";
        case toml::node_type::string:
            return "a string";
        case toml::node_type::integer:
            return "an integer";
        case toml::node_type::floating_point:
            return "a number with a point";
        case toml::node_type::boolean:
            return "true or false";
        case toml::node_type::date:
            return "a date";
        case toml::node_type::time:
            return "a time of day";
        case toml::node_type::date_time:
            return "a date and time";
        case toml::node_type::none:
            break;
    }
    return "nothing";
}

bool Reader::is_listed(const toml::source_position& place) const {
    return listed_.size() < kMostListed || is_before(or_start(place), listed_.back().place);
}

void Reader::refuse(const toml::source_position& place, const Problem& problem) {
    mark_failed(problem.key);
    ++count_;
    if (!is_listed(place)) return;
    const Line line{or_start(place), text_of(problem)};
    listed_.insert(std::upper_bound(listed_.begin(), listed_.end(), line,
                                    [](const Line& a, const Line& b) { return is_before(a.place, b.place); }),
                   line);
    if (listed_.size() > kMostListed) listed_.pop_back();
}

void Reader::refuse(const Problem& problem) {
    std::string key = problem.key;
    while (!key.empty() && !places_.contains(key)) key = parent_of(key);
    const auto place = places_.find(key);
    refuse(place == places_.end() ? toml::source_position{} : place->second, problem);
}

void Reader::refuse_value(Problem problem) {
    const std::size_t end = problem.key.find(']') + 1;  // 0 where there is none
    if (const auto name = names_.find(problem.key.substr(0, end)); name != names_.end())
        problem.key = name->second + problem.key.substr(end);
    for (std::string key = problem.key; !key.empty(); key = parent_of(key)) {
        if (failed_.contains(key)) return;
    }
    if (!knows(problem.key)) {
        if (problem_count() > 0) return;
        problem.value += " (the default)";
    }
    refuse(problem);
}

std::string Reader::report() const {
    std::string out;
    for (const Line& line : listed_) {
        out += (out.empty() ? "" : "\n") + file_ + ':' + std::to_string(line.place.line) + ':' +
               std::to_string(line.place.column) + ": " + line.text;
    }
    if (count_ > listed_.size())
        out += '\n' + file_ + ": and " + std::to_string(count_ - listed_.size()) + " more problems";
    return out;
}

}  // namespace pelagic
