// See crate_file.h.
#include "plugin/format/usd/crate_file.h"

#include <algorithm>
#include <bit>

namespace pelagic::usd {

namespace {

static_assert(std::endian::native == std::endian::little, "memory goes into the file as it is");

constexpr CrateValue kArray = CrateValue{1} << 63;
constexpr CrateValue kInlined = CrateValue{1} << 62;
constexpr std::uint32_t kEndOfFieldSet = 0xffffffff;
constexpr std::size_t kBootstrapBytes = 88;

constexpr CrateValue value_of(ValueType type, CrateValue payload) {
    return static_cast<CrateValue>(type) << 48 | payload;
}
constexpr CrateValue inlined(ValueType type, std::uint32_t payload) {
    return kInlined | value_of(type, payload);
}

// A zero byte, which says that a single LZ4 block follows, and a block of literals only: its length (15 in
// four bits, then bytes of 255 until one is less) and the literals.
std::string packed(std::string_view bytes) {
    constexpr std::size_t kInToken = 15, kInByte = 255;
    std::string block(1, '\0');
    block += static_cast<char>(std::min(bytes.size(), kInToken) << 4);
    if (bytes.size() >= kInToken) {
        const std::size_t rest = bytes.size() - kInToken;
        block.append(rest / kInByte, '\xff');
        block += static_cast<char>(rest % kInByte);
    }
    block += bytes;
    return block;
}

// The format stores integers as differences: the most frequent difference first, then two bits for each
// integer that say how many bytes its difference takes, then the differences. Here all take four bytes.
std::string packed(std::span<const std::uint32_t> integers) {
    std::string bytes(sizeof(std::uint32_t), '\0');
    bytes.append((2 * integers.size() + 7) / 8, '\xff');
    std::uint32_t before = 0;
    for (const std::uint32_t integer : integers) {
        append(bytes, integer - before);
        before = integer;
    }
    return packed(bytes);
}

void append_sized(std::string& bytes, std::string_view block) {
    append(bytes, std::uint64_t{block.size()});
    bytes += block;
}

// The count, then each list of integers as its size and its bytes.
std::string counted(std::size_t count, std::initializer_list<std::vector<std::uint32_t>> lists) {
    std::string bytes;
    append(bytes, std::uint64_t{count});
    for (const std::vector<std::uint32_t>& list : lists) append_sized(bytes, packed(list));
    return bytes;
}

}  // namespace

Crate::Crate() : pieces_(1) {
    piece().resize(kBootstrapBytes, '\0');
}

CrateValue Crate::at(ValueType type, std::uint64_t position) {
    return value_of(type, position);
}

// Readers that map the file into memory use aligned values in place.
void Crate::align() {
    while (size() % sizeof(std::uint64_t) != 0) piece() += '\0';
}

std::uint32_t Crate::token_index(std::string_view text) {
    auto found = std::find(tokens_.begin(), tokens_.end(), text);
    if (found == tokens_.end()) found = tokens_.insert(tokens_.end(), std::string(text));
    return static_cast<std::uint32_t>(found - tokens_.begin());
}

CrateValue Crate::token(std::string_view text) {
    return inlined(ValueType::Token, token_index(text));
}

CrateValue Crate::string(std::string_view text) {
    strings_.push_back(token_index(text));
    return inlined(ValueType::String, static_cast<std::uint32_t>(strings_.size() - 1));
}

CrateValue Crate::real(double number) {
    const CrateValue value = at(ValueType::Double, size());
    append(piece(), number);
    return value;
}

CrateValue Crate::boolean(bool value) const {
    return inlined(ValueType::Bool, value ? 1 : 0);
}

CrateValue Crate::real32(float number) {
    return inlined(ValueType::Float, std::bit_cast<std::uint32_t>(number));
}

CrateValue Crate::specifier(Specifier value) const {
    return inlined(ValueType::Specifier, static_cast<std::uint32_t>(value));
}

CrateValue Crate::tokens(std::span<const std::string_view> texts) {
    const CrateValue value = at(ValueType::TokenVector, size());
    append(piece(), std::uint64_t{texts.size()});
    for (const std::string_view text : texts) append(piece(), token_index(text));
    return value;
}

CrateValue Crate::token_array(std::span<const std::string_view> texts) {
    align();
    const CrateValue value = kArray | at(ValueType::Token, size());
    append(piece(), std::uint64_t{texts.size()});
    for (const std::string_view text : texts) append(piece(), token_index(text));
    return value;
}

CrateValue Crate::dictionary(std::string_view key, CrateValue entry) {
    const CrateValue key_string = string(key);
    const CrateValue value = at(ValueType::Dictionary, size());
    append(piece(), std::uint64_t{1});
    append(piece(), static_cast<std::uint32_t>(key_string));
    append_indirect(entry);
    return value;
}

CrateValue Crate::array_of(std::string_view bytes, ValueType type, std::size_t count) {
    align();
    const CrateValue value = kArray | at(type, size());
    append(piece(), std::uint64_t{count});
    produced(bytes.size(), [bytes](const Sink& sink) {
        if (!bytes.empty()) sink(bytes);
    });
    return value;
}

std::uint64_t Crate::produced(std::uint64_t bytes, std::function<void(const Sink&)> produce) {
    const std::uint64_t begin = size();
    pieces_.back().then = std::move(produce);
    before_piece_ = begin + bytes;
    pieces_.emplace_back();
    return begin;
}

// A value as containers hold it: the distance from here to it, and then, eight bytes on, the value.
void Crate::append_indirect(CrateValue value) {
    append(piece(), std::int64_t{sizeof(std::int64_t)});
    append(piece(), value);
}

CrateValue Crate::time_samples(double time, CrateValue sample) {
    const CrateValue times = at(ValueType::DoubleVector, size());
    append(piece(), std::uint64_t{1});
    append(piece(), time);
    const CrateValue value = at(ValueType::TimeSamples, size());
    append_indirect(times);
    append(piece(), std::int64_t{sizeof(std::int64_t)});
    append(piece(), std::uint64_t{1});
    append(piece(), sample);
    return value;
}

CrateValue Crate::times(std::vector<double> times) {
    align();
    const CrateValue value = at(ValueType::DoubleVector, size());
    append(piece(), static_cast<std::uint64_t>(times.size()));
    const std::size_t bytes = times.size() * sizeof(double);
    produced(bytes, [times = std::move(times)](const Sink& sink) {
        PieceWriter writer(sink);
        for (const double time : times) writer.put(time);
        writer.flush();
    });
    return value;
}

CrateValue Crate::time_samples(CrateValue times, std::uint64_t count,
                               std::function<CrateValue(std::uint64_t index)> sample) {
    align();
    const CrateValue value = at(ValueType::TimeSamples, size());
    append_indirect(times);
    append(piece(), std::int64_t{sizeof(std::int64_t)});
    append(piece(), count);
    produced(count * sizeof(CrateValue), [count, sample = std::move(sample)](const Sink& sink) {
        PieceWriter writer(sink);
        for (std::uint64_t i = 0; i < count; ++i) writer.put(sample(i));
        writer.flush();
    });
    return value;
}

void Crate::spec(SpecType type, std::string_view name, const Fields& fields) {
    const std::uint32_t index = token_index(name);
    // The last token of a property's path is stored as its negative.
    path_tokens_.push_back(type == SpecType::Attribute ? -index : index);
    spec_types_.push_back(static_cast<std::uint32_t>(type));
    spec_field_sets_.push_back(static_cast<std::uint32_t>(field_sets_.size()));
    for (const auto& [key, value] : fields) {
        field_sets_.push_back(static_cast<std::uint32_t>(field_tokens_.size()));
        field_tokens_.push_back(token_index(key));
        append(field_values_, value);
    }
    field_sets_.push_back(kEndOfFieldSet);
}

void Crate::add_layer(std::string_view prim, double fps, Fields more) {
    const std::string_view prims[] = {prim};
    more.insert(more.end(), {{"defaultPrim", token(prim)},
                             {"framesPerSecond", real(fps)},
                             {"metersPerUnit", real(1.0)},
                             {"timeCodesPerSecond", real(fps)},
                             {"upAxis", token("Z")},
                             {"primChildren", tokens(prims)}});
    spec(SpecType::PseudoRoot, "", more);
}

void Crate::add_frame_layer(std::string_view prim, double fps, int frame, std::string_view fingerprint) {
    Fields layer;
    if (!fingerprint.empty())
        layer.push_back(
            {"customLayerData", dictionary("pelagic", dictionary("fingerprint", string(fingerprint)))});
    const CrateValue time = real(frame);
    layer.insert(layer.end(), {{"startTimeCode", time}, {"endTimeCode", time}});
    add_layer(prim, fps, layer);
}

void Crate::add_prim(std::string_view prim, Fields fields, const std::vector<Attribute>& attributes) {
    std::vector<std::string_view> names;
    for (const Attribute& attribute : attributes) names.push_back(attribute.name);
    fields.push_back({"properties", tokens(names)});
    spec(SpecType::Prim, prim, fields);
    for (const Attribute& attribute : attributes) {
        const auto variability = static_cast<std::uint32_t>(attribute.variability);
        Fields all{{"typeName", token(attribute.type)},
                   {"custom", boolean(false)},
                   {"variability", inlined(ValueType::Variability, variability)}};
        all.insert(all.end(), attribute.more.begin(), attribute.more.end());
        spec(SpecType::Attribute, attribute.name, all);
    }
}

void Crate::finish() {
    constexpr char kBegin[] = {'P', 'X', 'R', '-', 'U', 'S', 'D', 'C', 0, 8, 0};
    std::string begin(kBegin, sizeof kBegin);
    begin.resize(2 * sizeof(std::uint64_t), '\0');
    std::string contents;
    std::uint64_t sections = 0;
    const auto section = [&](std::string_view name, std::string_view bytes) {
        constexpr std::size_t kNameBytes = 16;
        contents += name;
        contents.append(kNameBytes - name.size(), '\0');
        append(contents, size());
        append(contents, std::uint64_t{bytes.size()});
        piece() += bytes;
        ++sections;
    };
    section("TOKENS", tokens_section());
    section("STRINGS", strings_section());
    section("FIELDS", fields_section());
    section("FIELDSETS", counted(field_sets_.size(), {field_sets_}));
    section("PATHS", paths_section());
    section("SPECS", counted(spec_types_.size(), {path_indices(), spec_field_sets_, spec_types_}));
    append(begin, size());
    append(piece(), sections);
    piece() += contents;
    pieces_.front().bytes.replace(0, begin.size(), begin);
}

void Crate::write(const Sink& sink) const {
    for (const Piece& piece : pieces_) {
        if (!piece.bytes.empty()) sink(piece.bytes);
        if (piece.then) piece.then(sink);
    }
}

// Paths are numbered as specs are.
std::vector<std::uint32_t> Crate::path_indices() const {
    std::vector<std::uint32_t> indices(path_tokens_.size());
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
    return indices;
}

std::string Crate::tokens_section() const {
    std::string text, bytes;
    for (const std::string& token : tokens_) text.append(token.c_str(), token.size() + 1);
    append(bytes, std::uint64_t{tokens_.size()});
    append(bytes, std::uint64_t{text.size()});
    append_sized(bytes, packed(text));
    return bytes;
}

std::string Crate::strings_section() const {
    std::string bytes;
    append(bytes, std::uint64_t{strings_.size()});
    for (const std::uint32_t index : strings_) append(bytes, index);
    return bytes;
}

std::string Crate::fields_section() const {
    std::string bytes = counted(field_tokens_.size(), {field_tokens_});
    append_sized(bytes, packed(field_values_));
    return bytes;
}

// Depth first. Each path has a jump that says what follows: its child (−1), its sibling (0) or neither (−2).
std::string Crate::paths_section() const {
    constexpr auto kChild = static_cast<std::uint32_t>(-1), kLeaf = static_cast<std::uint32_t>(-2);
    std::vector<std::uint32_t> jumps(path_tokens_.size(), 0);
    jumps[0] = jumps[1] = kChild;
    jumps.back() = kLeaf;
    std::string bytes;
    append(bytes, std::uint64_t{path_tokens_.size()});
    return bytes + counted(path_tokens_.size(), {path_indices(), path_tokens_, jumps});
}

std::string gathered(const Crate& crate) {
    std::string bytes;
    bytes.reserve(crate.size());
    crate.write([&bytes](std::string_view part) { bytes += part; });
    return bytes;
}

}  // namespace pelagic::usd
