// The layers about the mesh as crates of version 0.8.0, which OpenUSD writes where nothing newer is asked
// for. See crate.h.
//
// A crate (facts: OpenUSD's crateFile, and doc/usdc_format.md of tinyusdz):
//
//   bootstrap   88 bytes: "PXR-USDC", the version, where the table of contents is
//   values      what does not fit a value's eight bytes; arrays as their length (64 bits) and their elements
//   sections    TOKENS, STRINGS, FIELDS, FIELDSETS, PATHS, SPECS
//   contents    the sections' names, places and sizes; last, so that a file cut short is not a crate
//
// A spec is a path with a type and a set of fields, a field a token and a value. Eight bytes stand for a
// value: 48 bits of it or of its place in the file, a byte for the type, and flags.
//
// The sections are packed with LZ4, its blocks made of literals only: they come to a kilobyte or two, which
// is nothing beside the arrays, and need no library that way. The arrays are not packed: waves have no
// repeats.
#include "plugin/usd/crate.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <utility>

namespace pelagic::usd {

namespace {

static_assert(std::endian::native == std::endian::little, "memory goes into the file as it is");

// Numbers of the format.
enum class ValueType : std::uint64_t {
    Bool = 1,
    Int = 3,
    Float = 8,
    Double = 9,
    String = 10,
    Token = 11,
    Vec2f = 20,
    Vec3f = 24,
    Dictionary = 31,
    TokenVector = 41,
    Specifier = 42,
    Variability = 44,
    TimeSamples = 46,
    DoubleVector = 48
};
enum class SpecType : std::uint32_t { Attribute = 1, Prim = 6, PseudoRoot = 7 };
enum class Specifier : std::uint32_t { Def = 0, Over = 1 };
enum class Variability : std::uint32_t { Varying = 0, Uniform = 1 };

using Value = std::uint64_t;
constexpr Value kArray = Value{1} << 63;
constexpr Value kInlined = Value{1} << 62;
constexpr std::uint32_t kEndOfFieldSet = 0xffffffff;

constexpr Value value_of(ValueType type, Value payload) {
    return static_cast<Value>(type) << 48 | payload;
}
constexpr Value inlined(ValueType type, std::uint32_t payload) {
    return kInlined | value_of(type, payload);
}
constexpr Value boolean(bool value) {
    return inlined(ValueType::Bool, value ? 1 : 0);
}

template <class T>
void append(std::string& bytes, T number) {
    char memory[sizeof number];
    std::memcpy(memory, &number, sizeof number);
    bytes.append(memory, sizeof number);
}

// One LZ4 block after the zero byte that says there is only one: a length (15 in four bits, then bytes of 255
// until one is less) and that many literals.
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

// Integers are stored as their differences: the commonest difference, two bits for each integer, and the
// differences themselves. Here none is the commonest, and all two bits say "four bytes".
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

// A layer with one prim and its attributes.
class Crate {
  public:
    using Fields = std::vector<std::pair<std::string_view, Value>>;

    Crate() : pieces_(1) { piece().resize(kBootstrapBytes, '\0'); }

    Value token(std::string_view text) { return inlined(ValueType::Token, token_index(text)); }

    Value string(std::string_view text) {
        strings_.push_back(token_index(text));
        return inlined(ValueType::String, static_cast<std::uint32_t>(strings_.size() - 1));
    }

    Value real(double number) {
        const Value value = value_of(ValueType::Double, position());
        append(piece(), number);
        return value;
    }

    Value tokens(std::span<const std::string_view> texts) {
        const Value value = value_of(ValueType::TokenVector, position());
        append(piece(), std::uint64_t{texts.size()});
        for (const std::string_view text : texts) append(piece(), token_index(text));
        return value;
    }

    // A dictionary with one entry.
    Value dictionary(std::string_view key, Value entry) {
        const Value key_string = string(key);
        const Value value = value_of(ValueType::Dictionary, position());
        append(piece(), std::uint64_t{1});
        append(piece(), static_cast<std::uint32_t>(key_string));
        append_indirect(entry);
        return value;
    }

    // `elements` stays the caller's memory until the crate is written.
    template <class T>
    Value array(ValueType type, std::span<const T> elements, std::size_t count) {
        // Readers that map the file into memory use the array where it is.
        while (position() % sizeof(std::uint64_t) != 0) piece() += '\0';
        const Value value = kArray | value_of(type, position());
        append(piece(), std::uint64_t{count});
        const auto bytes = std::as_bytes(elements);
        pieces_.back().array = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
        before_piece_ += piece().size() + bytes.size();
        pieces_.emplace_back();
        return value;
    }

    // One sample.
    Value time_samples(double time, Value sample) {
        const Value times = value_of(ValueType::DoubleVector, position());
        append(piece(), std::uint64_t{1});
        append(piece(), time);
        const Value value = value_of(ValueType::TimeSamples, position());
        append_indirect(times);
        append(piece(), std::int64_t{sizeof(std::int64_t)});
        append(piece(), std::uint64_t{1});
        append(piece(), sample);
        return value;
    }

    // The layer itself (no name) first, then the prim, then its attributes.
    void spec(SpecType type, std::string_view name, const Fields& fields) {
        const std::uint32_t index = token_index(name);
        // Of a property, the path's last token is negative.
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

    // Once, when all values and specs are there.
    void finish() {
        constexpr char kBegin[] = {'P', 'X', 'R', '-', 'U', 'S', 'D', 'C', 0, 8, 0};
        std::string begin(kBegin, sizeof kBegin);
        begin.resize(2 * sizeof(std::uint64_t), '\0');
        std::string contents;
        std::uint64_t sections = 0;
        const auto section = [&](std::string_view name, std::string_view bytes) {
            constexpr std::size_t kNameBytes = 16;
            contents += name;
            contents.append(kNameBytes - name.size(), '\0');
            append(contents, std::uint64_t{position()});
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
        append(begin, std::uint64_t{position()});
        append(piece(), sections);
        piece() += contents;
        pieces_.front().bytes.replace(0, begin.size(), begin);
    }

    std::size_t size() const { return before_piece_ + pieces_.back().bytes.size(); }

    void write(const Sink& sink) const {
        for (const Piece& piece : pieces_) {
            sink(piece.bytes);
            if (!piece.array.empty()) sink(piece.array);
        }
    }

  private:
    static constexpr std::size_t kBootstrapBytes = 88;

    struct Piece {
        std::string bytes{};
        std::string_view array{};  // comes after them
    };

    std::string& piece() { return pieces_.back().bytes; }
    std::size_t position() const { return size(); }

    // How far it is from here to the value, and the value.
    void append_indirect(Value value) {
        append(piece(), std::int64_t{sizeof(std::int64_t)});
        append(piece(), value);
    }

    std::uint32_t token_index(std::string_view text) {
        auto found = std::find(tokens_.begin(), tokens_.end(), text);
        if (found == tokens_.end()) found = tokens_.insert(tokens_.end(), std::string(text));
        return static_cast<std::uint32_t>(found - tokens_.begin());
    }

    // A path's index is its spec's.
    std::vector<std::uint32_t> path_indices() const {
        std::vector<std::uint32_t> indices(path_tokens_.size());
        for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
        return indices;
    }

    // The count, then each list of integers as its size and itself.
    static std::string counted(std::size_t count, std::initializer_list<std::vector<std::uint32_t>> lists) {
        std::string bytes;
        append(bytes, std::uint64_t{count});
        for (const std::vector<std::uint32_t>& list : lists) append_sized(bytes, packed(list));
        return bytes;
    }

    static void append_sized(std::string& bytes, std::string_view block) {
        append(bytes, std::uint64_t{block.size()});
        bytes += block;
    }

    std::string tokens_section() const {
        std::string text, bytes;
        for (const std::string& token : tokens_) text.append(token.c_str(), token.size() + 1);
        append(bytes, std::uint64_t{tokens_.size()});
        append(bytes, std::uint64_t{text.size()});
        append_sized(bytes, packed(text));
        return bytes;
    }

    std::string strings_section() const {
        std::string bytes;
        append(bytes, std::uint64_t{strings_.size()});
        for (const std::uint32_t index : strings_) append(bytes, index);
        return bytes;
    }

    std::string fields_section() const {
        std::string bytes = counted(field_tokens_.size(), {field_tokens_});
        append_sized(bytes, packed(field_values_));
        return bytes;
    }

    // Depth first. A path's jump says what is next: its child (−1), its sibling (0) or neither (−2).
    std::string paths_section() const {
        constexpr auto kChild = static_cast<std::uint32_t>(-1), kLeaf = static_cast<std::uint32_t>(-2);
        std::vector<std::uint32_t> jumps(path_tokens_.size(), 0);
        jumps[0] = jumps[1] = kChild;
        jumps.back() = kLeaf;
        std::string bytes;
        append(bytes, std::uint64_t{path_tokens_.size()});
        return bytes + counted(path_tokens_.size(), {path_indices(), path_tokens_, jumps});
    }

    std::vector<Piece> pieces_;
    std::size_t before_piece_ = 0;         // bytes of all pieces but the last
    std::vector<std::string> tokens_{""};  // the first is no property's: −0 would not mark it
    std::vector<std::uint32_t> strings_;
    std::vector<std::uint32_t> field_tokens_, field_sets_;
    std::string field_values_;
    std::vector<std::uint32_t> path_tokens_, spec_types_, spec_field_sets_;
};

// The layer's own fields: space and time, and its one prim.
void add_layer(Crate& crate, double fps, Crate::Fields more) {
    const std::string_view prims[] = {kMeshName};
    more.insert(more.end(), {{"defaultPrim", crate.token(kMeshName)},
                             {"framesPerSecond", crate.real(fps)},
                             {"metersPerUnit", crate.real(1.0)},
                             {"timeCodesPerSecond", crate.real(fps)},
                             {"upAxis", crate.token("Z")},
                             {"primChildren", crate.tokens(prims)}});
    crate.spec(SpecType::PseudoRoot, "", more);
}

struct Attribute {
    std::string_view name;
    std::string type;
    Variability variability = Variability::Varying;
    Crate::Fields more{};
};

void add_prim(Crate& crate, Crate::Fields fields, const std::vector<Attribute>& attributes) {
    std::vector<std::string_view> names;
    for (const Attribute& attribute : attributes) names.push_back(attribute.name);
    fields.push_back({"properties", crate.tokens(names)});
    crate.spec(SpecType::Prim, kMeshName, fields);
    for (const Attribute& attribute : attributes) {
        const auto variability = static_cast<std::uint32_t>(attribute.variability);
        Crate::Fields all{{"typeName", crate.token(attribute.type)},
                          {"custom", boolean(false)},
                          {"variability", inlined(ValueType::Variability, variability)}};
        all.insert(all.end(), attribute.more.begin(), attribute.more.end());
        crate.spec(SpecType::Attribute, attribute.name, all);
    }
}

Value specifier(Specifier value) {
    return inlined(ValueType::Specifier, static_cast<std::uint32_t>(value));
}

std::string array_type(const VaryingAttribute& attribute) {
    return std::string(attribute.type) + "[]";
}

Crate topology_layer(const Topology& topology) {
    check(topology);
    check_rate(topology.fps);
    const bool cage = topology.scheme == SubdivisionScheme::CatmullClark;
    Crate crate;
    add_layer(crate, topology.fps, {});
    const Crate::Fields per_vertex{{"interpolation", crate.token(interpolation(topology.scheme))}};
    std::vector<Attribute> attributes{
        {"doubleSided", "bool", Variability::Uniform, {{"default", boolean(true)}}}};
    const auto add_token = [&](std::string_view name, Variability variability, std::string_view text) {
        attributes.push_back({name, "token", variability, {{"default", crate.token(text)}}});
    };
    if (cage) add_token("interpolateBoundary", Variability::Varying, "none");
    add_token("orientation", Variability::Uniform, "rightHanded");
    add_token("subdivisionScheme", Variability::Uniform, cage ? "catmullClark" : "none");
    // Without a value, as in the text.
    for (const VaryingAttribute& varying : varying_attributes(topology.attributes)) {
        attributes.push_back({.name = varying.name,
                              .type = array_type(varying),
                              .more = varying.interpolates ? per_vertex : Crate::Fields{}});
    }
    if (!topology.st.empty()) {
        Crate::Fields fields = per_vertex;
        fields.push_back({"default", crate.array(ValueType::Vec2f, topology.st, topology.st.size())});
        attributes.push_back({.name = "primvars:st", .type = "texCoord2f[]", .more = fields});
    }
    const auto add_integers = [&](std::string_view name, std::span<const std::int32_t> integers) {
        const Value value = crate.array(ValueType::Int, integers, integers.size());
        attributes.push_back({.name = name, .type = "int[]", .more = {{"default", value}}});
    };
    add_integers("faceVertexCounts", topology.face_vertex_counts);
    add_integers("faceVertexIndices", topology.face_vertex_indices);
    add_prim(crate, {{"specifier", specifier(Specifier::Def)}, {"typeName", crate.token("Mesh")}},
             attributes);
    crate.finish();
    return crate;
}

// A view of `extent` too, until it is written.
Crate frame_layer(const MeshSample& sample, const Extent& extent) {
    const std::vector<VaryingValues> all = varying_values(sample, extent);
    check_rate(sample.fps);
    Crate crate;
    Crate::Fields layer;
    if (!sample.fingerprint.empty()) {
        const Value ours = crate.dictionary("fingerprint", crate.string(sample.fingerprint));
        layer.push_back({"customLayerData", crate.dictionary("pelagic", ours)});
    }
    const Value frame = crate.real(sample.frame);
    layer.insert(layer.end(), {{"startTimeCode", frame}, {"endTimeCode", frame}});
    add_layer(crate, sample.fps, layer);
    std::vector<Attribute> attributes;
    for (const auto& [varying, values] : all) {
        const ValueType type = varying.components == 1 ? ValueType::Float : ValueType::Vec3f;
        const Value array =
            crate.array(type, values, values.size() / static_cast<std::size_t>(varying.components));
        attributes.push_back({.name = varying.name,
                              .type = array_type(varying),
                              .more = {{"timeSamples", crate.time_samples(sample.frame, array)}}});
    }
    add_prim(crate, {{"specifier", specifier(Specifier::Over)}}, attributes);
    crate.finish();
    return crate;
}

std::string gathered(const Crate& crate) {
    std::string bytes;
    bytes.reserve(crate.size());
    crate.write([&bytes](std::string_view part) { bytes += part; });
    return bytes;
}

}  // namespace

void write_topology_crate(const Topology& topology, const Sink& sink) {
    topology_layer(topology).write(sink);
}

std::string topology_crate(const Topology& topology) {
    return gathered(topology_layer(topology));
}

void write_frame_crate(const MeshSample& sample, const Sink& sink) {
    const Extent extent = extent_of(sample.points);
    frame_layer(sample, extent).write(sink);
}

std::string frame_crate(const MeshSample& sample) {
    const Extent extent = extent_of(sample.points);
    return gathered(frame_layer(sample, extent));
}

}  // namespace pelagic::usd
