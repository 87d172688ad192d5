// The crates of crate_file.h, read back. Every number of the file is checked before it is used as a place or
// a size.
#include <cmath>
#include <cstring>

#include "plugin/format/usd/crate_cursor.h"
#include "plugin/format/usd/crate_file.h"
#include "plugin/format/usd/read_mesh.h"

namespace pelagic::usd {

namespace {

// Well-formed, perhaps, but packed as Pelagic doesn't pack.
[[noreturn]] void refuse_foreign() {
    throw ReadError("is not a mesh that Pelagic wrote, or it is damaged");
}

template <class T>
const T& element(const std::vector<T>& values, std::uint64_t index) {
    if (index >= values.size()) refuse_cut();
    return values[index];
}

// A size and an LZ4 block of literals only.
std::string_view unpacked(CrateCursor& section) {
    CrateCursor block(section.take(section.number<std::uint64_t>()));
    constexpr unsigned kInToken = 15, kInByte = 255;
    if (block.number<std::uint8_t>() != 0) refuse_foreign();
    const auto token = block.number<std::uint8_t>();
    if ((token & 0xf) != 0) refuse_foreign();
    std::uint64_t length = token >> 4;
    if (length == kInToken) {
        std::uint8_t more = 0;
        do {
            more = block.number<std::uint8_t>();
            length += more;
        } while (more == kInByte);
    }
    if (length != block.left()) refuse_foreign();
    return block.take(length);
}

// Differences of four bytes each, behind the codes that say so.
std::vector<std::uint32_t> unpacked_integers(CrateCursor& section, std::uint64_t count) {
    CrateCursor bytes(unpacked(section));
    if (count > bytes.left()) refuse_cut();
    if (bytes.number<std::uint32_t>() != 0) refuse_foreign();
    for (const char codes : bytes.take((2 * count + 7) / 8))
        if (codes != '\xff') refuse_foreign();
    auto integers = bytes.numbers<std::uint32_t>(count);
    std::uint32_t before = 0;
    for (std::uint32_t& integer : integers) before = integer += before;
    return integers;
}

struct Tables {
    std::vector<std::string_view> tokens;
    std::vector<std::uint32_t> field_tokens, field_sets;
    std::vector<CrateValue> field_values;
    std::vector<std::uint32_t> paths;  // the last token of each, by the path's index; negative: a property
    std::vector<std::uint32_t> spec_paths, spec_field_sets, spec_types;
};

std::vector<std::string_view> read_tokens(CrateCursor section) {
    const auto count = section.number<std::uint64_t>();
    const auto size = section.number<std::uint64_t>();
    std::string_view text = unpacked(section);
    if (text.size() != size) refuse_cut();
    std::vector<std::string_view> tokens;
    for (std::size_t end = 0; (end = text.find('\0')) != std::string_view::npos; text.remove_prefix(end + 1))
        tokens.push_back(text.substr(0, end));
    if (tokens.size() != count || !text.empty()) refuse_cut();
    return tokens;
}

std::vector<std::uint32_t> read_paths(CrateCursor section) {
    const auto count = section.number<std::uint64_t>();
    if (section.number<std::uint64_t>() != count) refuse_cut();
    const auto indices = unpacked_integers(section, count);
    const auto tokens = unpacked_integers(section, count);
    std::vector<std::uint32_t> paths(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (indices[i] >= count) refuse_cut();
        paths[indices[i]] = tokens[i];
    }
    return paths;
}

Tables read_tables(std::string_view file) {
    constexpr std::size_t kContentsPlace = 16, kNameBytes = 16;
    // The version of the format, major, minor and patch, is that of crate_file.h.
    if (CrateCursor(file, kCrateMagic.size()).take(3) != std::string_view("\0\10\0", 3)) refuse_foreign();
    CrateCursor contents(file, CrateCursor(file, kContentsPlace).number<std::uint64_t>());
    const auto sections = contents.number<std::uint64_t>();
    const auto section = [&](std::string_view wanted) {
        CrateCursor list = contents;
        for (std::uint64_t i = 0; i < sections; ++i) {
            const std::string_view padded = list.take(kNameBytes);
            const auto place = list.number<std::uint64_t>();
            const auto size = list.number<std::uint64_t>();
            if (padded.substr(0, padded.find('\0')) == wanted)
                return CrateCursor(CrateCursor(file, place).take(size));
        }
        refuse_cut();
    };
    Tables tables;
    tables.tokens = read_tokens(section("TOKENS"));
    CrateCursor fields = section("FIELDS");
    const auto field_count = fields.number<std::uint64_t>();
    tables.field_tokens = unpacked_integers(fields, field_count);
    tables.field_values = CrateCursor(unpacked(fields)).numbers<CrateValue>(field_count);
    CrateCursor field_sets = section("FIELDSETS");
    const auto set_count = field_sets.number<std::uint64_t>();
    tables.field_sets = unpacked_integers(field_sets, set_count);
    tables.paths = read_paths(section("PATHS"));
    CrateCursor specs = section("SPECS");
    const auto spec_count = specs.number<std::uint64_t>();
    tables.spec_paths = unpacked_integers(specs, spec_count);
    tables.spec_field_sets = unpacked_integers(specs, spec_count);
    tables.spec_types = unpacked_integers(specs, spec_count);
    return tables;
}

// Where a value is, if it is of this type and not packed in a way of its own.
std::uint64_t place_of(CrateValue value, CrateValue kind) {
    constexpr int kPlaceBits = 48;
    if (value >> kPlaceBits != kind) refuse_foreign();
    return value & ((CrateValue{1} << kPlaceBits) - 1);
}

constexpr CrateValue kind_of(ValueType type, bool is_array = false) {
    return static_cast<CrateValue>(type) | (is_array ? CrateValue{1} << 15 : 0);
}

MeshArray read_array(std::string_view file, const VaryingAttribute& attribute, CrateValue value) {
    MeshArray array{.name = std::string(attribute.name), .components = attribute.components};
    const auto components = static_cast<std::uint64_t>(attribute.components);
    ValueType type = components == 1   ? ValueType::Float
                     : components == 2 ? ValueType::Vec2f
                                       : ValueType::Vec3f;
    if (is_integer(attribute)) type = ValueType::Int;
    CrateCursor from(file, place_of(value, kind_of(type, true)));
    const auto count = from.number<std::uint64_t>();
    if (count > file.size()) refuse_cut();
    if (is_integer(attribute))
        array.values = from.numbers<std::int32_t>(count);
    else
        array.values = from.numbers<float>(count * components);
    return array;
}

glm::dvec3 read_origin(std::string_view file, CrateValue value) {
    CrateCursor from(file, place_of(value, kind_of(ValueType::Vec3d)));
    return from.number<glm::dvec3>();
}

struct Sample {
    double time;
    CrateValue value;
};

// The only sample of an attribute that varies.
Sample read_sample(std::string_view file, CrateValue samples) {
    CrateCursor from(file, place_of(samples, kind_of(ValueType::TimeSamples)));
    if (from.number<std::int64_t>() != sizeof(std::int64_t)) refuse_foreign();
    CrateCursor times(file, place_of(from.number<CrateValue>(), kind_of(ValueType::DoubleVector)));
    if (from.number<std::int64_t>() != sizeof(std::int64_t)) refuse_foreign();
    if (times.number<std::uint64_t>() != 1 || from.number<std::uint64_t>() != 1) refuse_foreign();
    const auto time = times.number<double>();
    if (!std::isfinite(time)) refuse_cut();
    return {time, from.number<CrateValue>()};
}

}  // namespace

MeshLayer read_crate(std::string_view file) {
    constexpr std::uint32_t kEndOfFieldSet = 0xffffffff;
    const Tables tables = read_tables(file);
    MeshLayer layer;
    for (std::size_t spec = 0; spec < tables.spec_types.size(); ++spec) {
        const std::uint32_t path = element(tables.paths, tables.spec_paths[spec]);
        if (tables.spec_types[spec] == static_cast<std::uint32_t>(SpecType::Prim) &&
            element(tables.tokens, path) != kMeshName)
            throw ReadError("is not the layer of a sea's mesh");
        if (tables.spec_types[spec] != static_cast<std::uint32_t>(SpecType::Attribute)) continue;
        const std::string_view name = element(tables.tokens, std::uint32_t{0} - path);
        std::string_view type;
        std::optional<CrateValue> value, samples;
        for (std::uint64_t at = tables.spec_field_sets[spec];; ++at) {
            const std::uint32_t field = element(tables.field_sets, at);
            if (field == kEndOfFieldSet) break;
            const std::string_view key = element(tables.tokens, element(tables.field_tokens, field));
            const CrateValue held = element(tables.field_values, field);
            if (key == "typeName") type = element(tables.tokens, held & 0xffffffff);
            if (key == "default") value = held;
            if (key == "timeSamples") samples = held;
        }
        const std::optional<VaryingAttribute> attribute = mesh_attribute(name, type);
        if (!attribute && !is_origin(name, type)) continue;
        if (samples) {
            const Sample sample = read_sample(file, *samples);
            if (layer.frame.value_or(sample.time) != sample.time) refuse_foreign();
            layer.frame = sample.time;
            value = sample.value;
        }
        if (!value) continue;
        refuse_twice(layer, name);
        if (!attribute) {
            layer.origin_m = read_origin(file, *value);
            continue;
        }
        layer.arrays.push_back(read_array(file, *attribute, *value));
    }
    return layer;
}

}  // namespace pelagic::usd
