// What the reading of one shot file gathers: where each key stands, and every problem found so far.
#pragma once

#include <toml++/toml.h>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/scene/validate.h"

namespace pelagic {

// A node as the shot file would write it, on one line and of a length that fits into a message.
std::string text_of(const toml::node& node);

// "a string", "an integer", …
std::string type_of(const toml::node& node);

class Reader {
  public:
    // `file`: as messages call it.
    explicit Reader(std::string file) : file_(std::move(file)) {}

    // A spectrum's file and hour, a cage's file and a camera's, as asked for: they are parsed with their tables and loaded when all
    // is read.
    std::optional<std::string> spectrum_file, cage_file, camera_file;
    std::optional<std::chrono::sys_seconds> spectrum_time;

    // The value of this key stands here.
    void remember(const std::string& key, const toml::source_position& place) { places_[key] = place; }

    // The scene's "waves.cascades[0]" is the file's "waves.cascades[2]": lists that a file may give in any
    // order.
    void rename(const std::string& scene_key, const std::string& file_key) { names_[scene_key] = file_key; }

    bool knows(const std::string& key) const { return places_.contains(key); }
    bool has_failed(const std::string& key) const { return failed_.contains(key); }

    // The key has no usable value and the reason is reported: validate() need not complain about the default
    // instead.
    void mark_failed(const std::string& key) { failed_.insert(key); }

    // A problem of the text itself, at the place where it stands.
    void refuse(const toml::source_position& place, const Problem& problem);

    // A problem of a key's value, wherever the key stands: at its table, or the file's start, where it is a
    // default.
    void refuse(const Problem& problem);

    // A problem that validate() found; left out where a problem of the same key is known already, and for
    // defaults as long as the file has problems of its own.
    void refuse_value(Problem problem);

    std::size_t problem_count() const { return count_; }

    // Whether a problem at this place would be in the report, as far as is known. Texts that are costly to make
    // aren't made otherwise.
    bool is_listed(const toml::source_position& place) const;

    // The first problems in the order of the file, a line each, and how many more there are.
    std::string report() const;

  private:
    static constexpr std::size_t kMostListed = 20;

    struct Line {
        toml::source_position place;
        std::string text;
    };

    std::string file_;
    std::map<std::string, toml::source_position> places_;
    std::map<std::string, std::string> names_;
    std::set<std::string> failed_;
    std::size_t count_ = 0;
    std::vector<Line> listed_;  // in the order of the file
};

}  // namespace pelagic
