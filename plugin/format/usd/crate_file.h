// Builds a crate, OpenUSD's binary layer (usdc), of version 0.8.0: the version that OpenUSD itself writes
// when a layer uses nothing newer. The layers' contents are in crate.cpp and camera_crate.cpp.
//
// The structure of a crate (from OpenUSD's crateFile.cpp and tinyusdz's doc/usdc_format.md):
//
//   bootstrap   88 bytes: "PXR-USDC", the version, and where the table of contents is
//   values      those that don't fit into eight bytes; an array is its length (64 bits) and its elements
//   sections    TOKENS, STRINGS, FIELDS, FIELDSETS, PATHS, SPECS
//   contents    name, place and size of each section; at the end, so that a truncated file is not a crate
//
// A spec is a path with a type and a set of fields. A field is a token and a value. A value takes eight
// bytes: 48 bits hold the value itself or its place in the file, one byte its type, and the rest is flags.
//
// The format packs its sections with LZ4. Here the LZ4 blocks hold literals only, which needs no library: the
// sections are a kilobyte or two, nothing beside the arrays. The arrays are not packed; waves don't repeat.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "plugin/format/usd/layers.h"

namespace pelagic::usd {

// Numbers of the format.
enum class ValueType : std::uint64_t {
    Bool = 1,
    Int = 3,
    Int64 = 5,
    Float = 8,
    Double = 9,
    String = 10,
    Token = 11,
    Vec2f = 20,
    Vec3d = 23,
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

// A value as the file holds it.
using CrateValue = std::uint64_t;

template <class T>
void append(std::string& bytes, const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    char memory[sizeof value];
    std::memcpy(memory, &value, sizeof value);
    bytes.append(memory, sizeof value);
}

// Hands values to a sink one after another, in pieces of at most kPieceBytes.
class PieceWriter {
  public:
    static constexpr std::size_t kPieceBytes = std::size_t{64} << 10;

    explicit PieceWriter(const Sink& sink) : sink_(sink) { piece_.reserve(kPieceBytes); }

    template <class T>
    void put(const T& value) {
        if (piece_.size() + sizeof value > kPieceBytes) flush();
        append(piece_, value);
    }
    void flush() {
        if (!piece_.empty()) sink_(piece_);
        piece_.clear();
    }

  private:
    const Sink& sink_;
    std::string piece_;
};

// A layer with one prim and the prim's attributes. First all values and specs are added, then finish() is
// called, then write(). Until write() returns, the arrays that were added must stay where they are.
class Crate {
  public:
    using Fields = std::vector<std::pair<std::string_view, CrateValue>>;
    struct Attribute {
        std::string_view name;
        std::string type;  // as text declares it: "float3[]"
        Variability variability = Variability::Varying;
        Fields more{};  // its value, samples and metadata
    };

    Crate();

    CrateValue token(std::string_view text);
    CrateValue string(std::string_view text);
    CrateValue real(double number);
    CrateValue boolean(bool value) const;
    static CrateValue real32(float number);
    CrateValue specifier(Specifier value) const;
    CrateValue tokens(std::span<const std::string_view> texts);       // a list among the metadata
    CrateValue token_array(std::span<const std::string_view> texts);  // an attribute's value, token[]
    // A dictionary with one entry.
    CrateValue dictionary(std::string_view key, CrateValue entry);

    // Values of fixed size that are stored by their place: Vec2f, Vec3d.
    template <class T>
    CrateValue stored(ValueType type, const T& value) {
        align();
        const CrateValue result = at(type, size());
        append(piece(), value);
        return result;
    }

    // `elements` stays in the caller's memory; `count` is the number of USD's elements in it.
    template <class T>
    CrateValue array(ValueType type, std::span<const T> elements, std::size_t count) {
        const auto bytes = std::as_bytes(elements);
        return array_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, type, count);
    }

    // `bytes` bytes that don't exist yet: write() calls `produce`, which hands exactly that many to the sink.
    // Returns where in the file they begin.
    std::uint64_t produced(std::uint64_t bytes, std::function<void(const Sink&)> produce);

    // A single sample.
    CrateValue time_samples(double time, CrateValue sample);
    // Rising times. Attributes may share them.
    CrateValue times(std::vector<double> times);
    // Where the samples of an attribute are in the file: at `first`, `first + stride`, and so on.
    struct Stored {
        ValueType type;
        std::uint64_t first;
        std::uint64_t stride;
        CrateValue operator()(std::uint64_t index) const { return at(type, first + index * stride); }
    };
    // A sample at each of these `count` times. write() asks for them one after another: a Stored, or
    // values that need no place of their own, such as real32().
    CrateValue time_samples(CrateValue times, std::uint64_t count,
                            std::function<CrateValue(std::uint64_t index)> sample);

    // The layer's own fields: those of space and time, `more`, and its only prim.
    void add_layer(std::string_view prim, double fps, Fields more);
    // The same of one whose samples are at this frame. An empty fingerprint isn't written.
    void add_frame_layer(std::string_view prim, double fps, int frame, std::string_view fingerprint);
    void add_prim(std::string_view prim, Fields fields, const std::vector<Attribute>& attributes);

    // Once, after everything was added.
    void finish();

    // The whole file's bytes, after finish().
    std::uint64_t size() const { return before_piece_ + pieces_.back().bytes.size(); }
    void write(const Sink& sink) const;

  private:
    struct Piece {
        std::string bytes{};
        std::function<void(const Sink&)> then{};  // hands over what follows these bytes
    };

    static CrateValue at(ValueType type, std::uint64_t position);

    std::string& piece() { return pieces_.back().bytes; }
    void align();
    CrateValue array_of(std::string_view bytes, ValueType type, std::size_t count);
    void append_indirect(CrateValue value);
    std::uint32_t token_index(std::string_view text);
    // The layer itself (no name) first, then the prim, then its attributes.
    void spec(SpecType type, std::string_view name, const Fields& fields);

    std::vector<std::uint32_t> path_indices() const;
    std::string tokens_section() const;
    std::string strings_section() const;
    std::string fields_section() const;
    std::string paths_section() const;

    std::vector<Piece> pieces_;
    std::uint64_t before_piece_ = 0;  // bytes before the last piece
    // The first token is empty, so that no property has the index 0: its negative would be 0 too.
    std::vector<std::string> tokens_{""};
    std::vector<std::uint32_t> strings_;
    std::vector<std::uint32_t> field_tokens_, field_sets_;
    std::string field_values_;
    std::vector<std::uint32_t> path_tokens_, spec_types_, spec_field_sets_;
};

// The whole file in memory.
std::string gathered(const Crate& crate);

}  // namespace pelagic::usd
