// The structure of a crate is from OpenUSD's crateFile.cpp, integerCoding.cpp and fastCompression.cpp; the blocks of LZ4 from its
// lz4_Block_format.md. Every number of the file is checked before it is used as a place or a size.
#include "plugin/format/usd/crate_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <limits>
#include <unordered_map>

#include "plugin/format/usd/crate_cursor.h"

namespace pelagic::usd {
namespace {

enum class LayerType : std::uint32_t {
    Bool = 1,
    UChar = 2,
    Int = 3,
    UInt = 4,
    Int64 = 5,
    UInt64 = 6,
    Half = 7,
    Float = 8,
    Double = 9,
    Token = 11,
    Matrix4d = 15,
    Quatd = 16,
    Quatf = 17,
    Quath = 18,
    Vec3d = 23,
    Vec3f = 24,
    Vec3h = 25,
    TokenVector = 41,
    Specifier = 42,
};
constexpr std::uint64_t kIsArray = std::uint64_t{1} << 63, kIsInlined = std::uint64_t{1} << 62,
                        kIsPacked = std::uint64_t{1} << 61, kPayload = (std::uint64_t{1} << 48) - 1;

LayerType type_of(std::uint64_t value) {
    return static_cast<LayerType>(value >> 48 & 0xff);
}

// A block of LZ4, onto `out`, which becomes at most so long.
void unpack_lz4(std::string_view block, std::size_t most, std::string& out) {
    CrateCursor in(block);
    const auto length_of = [&](std::size_t length) {
        if (length < 15) return length;
        for (std::uint8_t more = 255; more == 255; length += more) more = in.number<std::uint8_t>();
        return length;
    };
    const std::size_t begin = out.size();
    while (in.left() > 0) {
        const auto token = in.number<std::uint8_t>();
        const std::string_view literals = in.take(length_of(token >> 4));
        if (literals.size() > most - out.size()) refuse_cut();
        out += literals;
        if (in.left() == 0) break;  // the last sequence has no match
        const std::size_t offset = in.number<std::uint16_t>(), length = length_of(token & 15) + 4;
        if (offset == 0 || offset > out.size() - begin || length > most - out.size()) refuse_cut();
        for (std::size_t i = 0; i < length; ++i) out += out[out.size() - offset];  // may repeat itself
    }
}

// Its size, and one block, or several with their number and sizes.
std::string unpacked_bytes(CrateCursor& section, std::uint64_t most) {
    CrateCursor packed(section.take(section.number<std::uint64_t>()));
    // LZ4 packs no more than 255 bytes in one.
    if (most / 256 > packed.left() + 16) most = 256 * (packed.left() + 16);
    std::string out;
    const auto chunks = packed.number<std::uint8_t>();
    if (chunks == 0) {
        unpack_lz4(packed.take(packed.left()), most, out);
    } else {
        for (std::uint8_t i = 0; i < chunks; ++i) {
            const auto size = packed.number<std::int32_t>();
            if (size < 0) refuse_cut();
            unpack_lz4(packed.take(static_cast<std::uint64_t>(size)), most, out);
        }
    }
    return out;
}

// Of a layer's tables: a small file may promise many, which take memory before they are read.
constexpr std::uint64_t kMostEntries = std::uint64_t{1} << 22;

// Differences: two bits each say whether one is the commonest, or of 1, 2 or 4 bytes.
std::vector<std::uint32_t> unpacked_numbers(CrateCursor& section, std::uint64_t count,
                                            std::uint64_t most = kMostEntries) {
    if (count == 0) return {};
    if (count > most) refuse_cut();
    const std::string bytes = unpacked_bytes(section, 4 + (2 * count + 7) / 8 + 4 * count);
    CrateCursor in(bytes);
    const auto common = in.number<std::uint32_t>();
    const std::string_view codes = in.take((2 * count + 7) / 8);
    std::vector<std::uint32_t> numbers(count);
    std::uint32_t before = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        switch (static_cast<std::uint8_t>(codes[i / 4]) >> 2 * (i % 4) & 3) {
            case 0:
                before += common;
                break;
            case 1:
                before += static_cast<std::uint32_t>(in.number<std::int8_t>());
                break;
            case 2:
                before += static_cast<std::uint32_t>(in.number<std::int16_t>());
                break;
            default:
                before += in.number<std::uint32_t>();
        }
        numbers[i] = before;
    }
    return numbers;
}

// An array's elements begin after their number.
CrateCursor elements(std::string_view file, std::uint64_t value, std::size_t most, std::uint64_t& count) {
    const std::uint64_t place = value & kPayload;
    count = 0;
    if (place == 0) return CrateCursor({});
    CrateCursor in(file, place);
    count = in.number<std::uint64_t>();
    if (count > most)
        throw ReadError("has an array of " + std::to_string(count) + " elements, more than a body may have");
    return in;
}

}  // namespace

CrateLayer::CrateLayer(std::string_view bytes) : bytes_(bytes) {
    constexpr std::size_t kVersionPlace = 8, kContentsPlace = 16, kNameBytes = 16;
    constexpr std::uint64_t kMostTokenBytes = std::uint64_t{1} << 30;
    const std::string_view version = CrateCursor(bytes, kVersionPlace).take(2);
    if (version[0] != 0 || version[1] < 7)
        throw ReadError("is a crate of version " + std::to_string(version[0]) + '.' +
                        std::to_string(version[1]) + ", which isn't read");
    CrateCursor contents(bytes, CrateCursor(bytes, kContentsPlace).number<std::uint64_t>());
    const auto sections = contents.number<std::uint64_t>();
    const auto section = [&](std::string_view wanted) {
        CrateCursor list = contents;
        for (std::uint64_t i = 0; i < sections; ++i) {
            const std::string_view padded = list.take(kNameBytes);
            const auto place = list.number<std::uint64_t>(), size = list.number<std::uint64_t>();
            if (padded.substr(0, padded.find('\0')) == wanted)
                return CrateCursor(CrateCursor(bytes, place).take(size));
        }
        refuse_cut();
    };

    CrateCursor tokens = section("TOKENS");
    const auto token_count = tokens.number<std::uint64_t>(), token_size = tokens.number<std::uint64_t>();
    if (token_count > kMostEntries) refuse_cut();
    token_bytes_ = unpacked_bytes(tokens, std::min(token_size, kMostTokenBytes));
    std::string_view text = token_bytes_;
    for (std::size_t end = 0;
         tokens_.size() <= token_count && (end = text.find('\0')) != std::string_view::npos;
         text.remove_prefix(end + 1))
        tokens_.push_back(text.substr(0, end));
    if (token_bytes_.size() != token_size || tokens_.size() != token_count) refuse_cut();

    CrateCursor fields = section("FIELDS");
    const auto field_count = fields.number<std::uint64_t>();
    field_tokens_ = unpacked_numbers(fields, field_count);
    const std::string values = unpacked_bytes(fields, sizeof(std::uint64_t) * field_count);
    field_values_ = CrateCursor(values).numbers<std::uint64_t>(field_count);
    CrateCursor sets = section("FIELDSETS");
    field_sets_ = unpacked_numbers(sets, sets.number<std::uint64_t>());

    CrateCursor paths = section("PATHS");
    const auto path_count = paths.number<std::uint64_t>(), encoded = paths.number<std::uint64_t>();
    const auto places = unpacked_numbers(paths, encoded), names = unpacked_numbers(paths, encoded),
               jumps = unpacked_numbers(paths, encoded);
    if (path_count > encoded || encoded == 0) refuse_cut();
    // The first is the layer; then each is followed by its first child, and says how far away its next sibling is.
    nodes_.resize(path_count);
    constexpr Node kNobody = ~Node{0};
    std::vector<Node> numbered(path_count,
                               kNobody);  // by the path's index: its number here, in the order of the tree
    std::vector<std::pair<std::uint64_t, Node>> later{{0, kNobody}};
    Node count = 0;
    while (!later.empty()) {
        auto [at, parent] = later.back();
        later.pop_back();
        for (;;) {
            if (at >= encoded || places[at] >= path_count || numbered[places[at]] != kNobody) refuse_cut();
            const Node node = numbered[places[at]] = count++;
            const auto name = static_cast<std::int32_t>(names[at]);
            Item& item = nodes_[node];
            item.is_property = name < 0;
            item.token = parent == kNobody
                             ? 0
                             : static_cast<std::uint32_t>(item.is_property ? -std::int64_t{name} : name);
            if (item.token >= tokens_.size()) refuse_cut();
            if (parent != kNobody) nodes_[parent].children.push_back(node);
            const auto jump = static_cast<std::int32_t>(jumps[at]);
            const bool has_child = jump > 0 || jump == -1, has_sibling = jump >= 0;
            if (has_child && has_sibling) later.emplace_back(at + static_cast<std::uint64_t>(jump), parent);
            if (has_child) parent = node;
            if (!has_child && !has_sibling) break;
            ++at;
        }
    }

    CrateCursor specs = section("SPECS");
    const auto spec_count = specs.number<std::uint64_t>();
    const auto spec_paths = unpacked_numbers(specs, spec_count),
               spec_sets = unpacked_numbers(specs, spec_count);
    for (std::uint64_t i = 0; i < spec_count; ++i) {
        if (spec_paths[i] >= path_count || numbered[spec_paths[i]] == kNobody ||
            spec_sets[i] >= field_sets_.size())
            refuse_cut();
        Item& item = nodes_[numbered[spec_paths[i]]];
        item.is_there = true;
        item.field_set = spec_sets[i];
    }
}

std::string_view CrateLayer::token_text(std::uint64_t index) const {
    if (index >= tokens_.size()) refuse_cut();
    return tokens_[index];
}

std::optional<std::uint64_t> CrateLayer::field(Node node, std::string_view name) const {
    constexpr std::uint32_t kEnd = ~std::uint32_t{0};
    for (std::uint64_t at = nodes_[node].field_set; at < field_sets_.size() && field_sets_[at] != kEnd;
         ++at) {
        const std::uint32_t number = field_sets_[at];
        if (number >= field_tokens_.size()) refuse_cut();
        if (token_text(field_tokens_[number]) == name) return field_values_[number];
    }
    return std::nullopt;
}

bool CrateLayer::has(Node node, std::string_view name) const {
    return field(node, name).has_value();
}

std::vector<CrateLayer::Node> CrateLayer::prims_of(Node node) const {
    std::unordered_map<std::string_view, Node> left;
    for (const Node child : nodes_[node].children)
        if (!nodes_[child].is_property && nodes_[child].is_there) left.emplace(name(child), child);
    std::vector<Node> prims;
    for (const std::string_view each : tokens(node, "primChildren").value_or(std::vector<std::string_view>()))
        if (const auto found = left.find(each); found != left.end()) {
            prims.push_back(found->second);
            left.erase(found);
        }
    return prims;
}

std::optional<CrateLayer::Node> CrateLayer::property(Node prim, std::string_view wanted) const {
    for (const Node child : nodes_[prim].children)
        if (nodes_[child].is_property && nodes_[child].is_there && name(child) == wanted) return child;
    return std::nullopt;
}

std::optional<std::string_view> CrateLayer::token(Node node, std::string_view name) const {
    const auto value = field(node, name);
    if (!value || (*value & kIsArray) != 0 || type_of(*value) != LayerType::Token) return std::nullopt;
    return token_text(*value & kPayload);
}

std::optional<double> CrateLayer::number(Node node, std::string_view name) const {
    const auto value = field(node, name);
    if (!value || (*value & kIsArray) != 0) return std::nullopt;
    const std::uint64_t payload = *value & kPayload;
    const auto bits = static_cast<std::uint32_t>(payload);
    const auto as_float = [&] {
        float read;
        std::memcpy(&read, &bits, sizeof read);
        return static_cast<double>(read);
    };
    switch (type_of(*value)) {
        case LayerType::Bool:
        case LayerType::UChar:
        case LayerType::UInt:
        case LayerType::Specifier:
            return static_cast<double>(bits);
        case LayerType::Int:
            return static_cast<double>(static_cast<std::int32_t>(bits));
        case LayerType::Half:
            return static_cast<double>(glm::unpackHalf1x16(static_cast<std::uint16_t>(bits)));
        case LayerType::Float:
            return as_float();
        case LayerType::Double:
            return (*value & kIsInlined) != 0 ? as_float() : CrateCursor(bytes_, payload).number<double>();
        default:
            return std::nullopt;
    }
}

// Small whole numbers are a byte each, in the value itself.
std::optional<glm::dvec3> CrateLayer::vector(Node node, std::string_view name) const {
    const auto value = field(node, name);
    if (!value || (*value & kIsArray) != 0) return std::nullopt;
    const LayerType type = type_of(*value);
    if (type != LayerType::Vec3d && type != LayerType::Vec3f && type != LayerType::Vec3h) return std::nullopt;
    glm::dvec3 read(0.0);
    CrateCursor in(bytes_, (*value & kIsInlined) != 0 ? 0 : *value & kPayload);
    for (int i = 0; i < 3; ++i) {
        if ((*value & kIsInlined) != 0)
            read[i] = static_cast<double>(static_cast<std::int8_t>(*value >> 8 * i & 0xff));
        else if (type == LayerType::Vec3d)
            read[i] = in.number<double>();
        else if (type == LayerType::Vec3f)
            read[i] = static_cast<double>(in.number<float>());
        else
            read[i] = static_cast<double>(glm::unpackHalf1x16(in.number<std::uint16_t>()));
    }
    return read;
}

std::optional<glm::dmat4> CrateLayer::matrix(Node node, std::string_view name) const {
    const auto value = field(node, name);
    if (!value || (*value & kIsArray) != 0 || type_of(*value) != LayerType::Matrix4d) return std::nullopt;
    glm::dmat4 read(0.0);
    if ((*value & kIsInlined) != 0) {  // its diagonal
        for (int i = 0; i < 4; ++i)
            read[i][i] = static_cast<double>(static_cast<std::int8_t>(*value >> 8 * i & 0xff));
        return read;
    }
    CrateCursor in(bytes_, *value & kPayload);
    for (int row = 0; row < 4; ++row)
        for (int i = 0; i < 4; ++i) read[row][i] = in.number<double>();
    return read;
}

std::optional<std::vector<double>> CrateLayer::quaternion(Node node, std::string_view name) const {
    const auto value = field(node, name);
    if (!value || (*value & (kIsArray | kIsInlined)) != 0) return std::nullopt;
    CrateCursor in(bytes_, *value & kPayload);
    std::vector<double> read;
    for (int i = 0; i < 4; ++i) {
        switch (type_of(*value)) {
            case LayerType::Quatd:
                read.push_back(in.number<double>());
                break;
            case LayerType::Quatf:
                read.push_back(static_cast<double>(in.number<float>()));
                break;
            case LayerType::Quath:
                read.push_back(static_cast<double>(glm::unpackHalf1x16(in.number<std::uint16_t>())));
                break;
            default:
                return std::nullopt;
        }
    }
    return read;
}

std::optional<std::vector<std::string_view>> CrateLayer::tokens(Node node, std::string_view name) const {
    const auto value = field(node, name);
    if (!value) return std::nullopt;
    const bool is_array = (*value & kIsArray) != 0 && type_of(*value) == LayerType::Token;
    if (!is_array && type_of(*value) != LayerType::TokenVector) return std::nullopt;
    std::uint64_t count = 0;
    CrateCursor in = elements(bytes_, *value, std::numeric_limits<std::uint32_t>::max(), count);
    std::vector<std::string_view> read;
    for (const std::uint32_t index : in.numbers<std::uint32_t>(count)) read.push_back(token_text(index));
    return read;
}

std::optional<std::vector<std::int32_t>> CrateLayer::integers(Node node, std::string_view name,
                                                              std::size_t most) const {
    const auto value = field(node, name);
    if (!value || (*value & kIsArray) == 0 || type_of(*value) != LayerType::Int) return std::nullopt;
    constexpr std::uint64_t kLeastPacked = 16;
    std::uint64_t count = 0;
    CrateCursor in = elements(bytes_, *value, most, count);
    if ((*value & kIsPacked) == 0 || count < kLeastPacked) return in.numbers<std::int32_t>(count);
    const auto read = unpacked_numbers(in, count, most);
    return std::vector<std::int32_t>(read.begin(), read.end());
}

std::optional<std::vector<glm::vec3>> CrateLayer::vectors(Node node, std::string_view name,
                                                          std::size_t most) const {
    const auto value = field(node, name);
    if (!value || (*value & kIsArray) == 0) return std::nullopt;
    const LayerType type = type_of(*value);
    if (type != LayerType::Vec3f && type != LayerType::Vec3d && type != LayerType::Vec3h) return std::nullopt;
    if ((*value & kIsPacked) != 0) throw ReadError("has vectors that are packed in a way that isn't read");
    std::uint64_t count = 0;
    CrateCursor in = elements(bytes_, *value, most, count);
    std::vector<glm::vec3> read;
    const auto take = [&](const auto& numbers, const auto& of) {
        for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
            read.emplace_back(of(numbers[i]), of(numbers[i + 1]), of(numbers[i + 2]));
    };
    if (type == LayerType::Vec3f)
        take(in.numbers<float>(3 * count), [](float each) { return each; });
    else if (type == LayerType::Vec3d)
        take(in.numbers<double>(3 * count), [](double each) { return static_cast<float>(each); });
    else
        take(in.numbers<std::uint16_t>(3 * count),
             [](std::uint16_t each) { return glm::unpackHalf1x16(each); });
    return read;
}

}  // namespace pelagic::usd
