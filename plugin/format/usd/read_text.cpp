// The text layers of text.h, read back: a line for each attribute, and in frames a line for its only sample.
#include <algorithm>
#include <charconv>

#include "plugin/format/usd/read_mesh.h"

namespace pelagic::usd {

namespace {

// Taken off the front of `text` up to the separator, which is gone too; all of it without one.
std::string_view taken_until(std::string_view& text, std::string_view separator) {
    const std::size_t end = text.find(separator);
    const std::string_view taken = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + separator.size());
    return taken;
}

template <class T>
T parsed(std::string_view& text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) throw ReadError("has a number that is none");
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

// "[(a, b), (c, d)]": the brackets between numbers must be there, but are all alike here.
template <class T>
std::vector<T> parsed_array(std::string_view text, int components) {
    if (!text.starts_with('[')) throw ReadError("is not a mesh that Pelagic wrote");
    std::vector<T> values;
    for (;;) {
        const std::size_t next = text.find_first_not_of("[(), ");
        if (next == std::string_view::npos) throw ReadError("is cut short");
        text.remove_prefix(next);
        if (text.starts_with(']')) break;
        values.push_back(parsed<T>(text));
    }
    if (values.size() % static_cast<std::size_t>(components) != 0) throw ReadError("is damaged");
    return values;
}

// "(x, y, z),"
glm::dvec3 parsed_origin(std::string_view text) {
    glm::dvec3 origin_m;
    for (int i = 0; i < 3; ++i) {
        const std::string_view before = i == 0 ? "(" : ", ";
        if (!text.starts_with(before)) throw ReadError("is not a mesh that Pelagic wrote");
        text.remove_prefix(before.size());
        origin_m[i] = parsed<double>(text);
    }
    return origin_m;
}

}  // namespace

MeshLayer read_text(std::string_view text) {
    if (!text.ends_with("\n}\n")) throw ReadError("is cut short");
    if (text.find("\"" + std::string(kMeshName) + "\"\n") == std::string_view::npos)
        throw ReadError("is not the layer of a sea's mesh");
    MeshLayer layer;
    while (!text.empty()) {
        std::string_view line = taken_until(text, "\n");
        line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
        const std::string_view type = taken_until(line, " ");
        const std::string_view name = line.substr(0, line.find_first_of(". ="));
        const std::optional<VaryingAttribute> attribute = mesh_attribute(name, type);
        if (!attribute && !is_origin(name, type)) continue;
        line.remove_prefix(name.size());
        if (line == ".timeSamples = {") {
            line = taken_until(text, "\n");
            line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
            const auto time = parsed<double>(line);
            if (layer.frame.value_or(time) != time) throw ReadError("has samples of several frames");
            layer.frame = time;
            taken_until(line, ": ");
        } else if (line.starts_with(" = ")) {
            line.remove_prefix(3);
        } else {
            continue;  // declared without a value
        }
        refuse_twice(layer, name);
        if (!attribute) {
            layer.origin_m = parsed_origin(line);
            continue;
        }
        MeshArray array{.name = std::string(name), .components = attribute->components};
        if (is_integer(*attribute))
            array.values = parsed_array<std::int32_t>(line, array.components);
        else
            array.values = parsed_array<float>(line, array.components);
        layer.arrays.push_back(std::move(array));
    }
    return layer;
}

}  // namespace pelagic::usd
