// Any program's crate (usdc) as a tree of prims and properties with the values that a static mesh needs. It composes nothing: no
// references, no sublayers, no variants. crate_file.h says how a crate is built; this reads what OpenUSD packs, too: LZ4, integers by their
// differences, floats by a table.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/format/usd/read_mesh.h"

namespace pelagic::usd {

class CrateLayer {
  public:
    // The bytes must outlive it. Throws ReadError for what is no whole crate of version 0.7 or later, whatever the bytes are.
    explicit CrateLayer(std::string_view bytes);

    // Prims and properties by their number; 0 is the layer itself.
    using Node = std::uint32_t;
    std::string_view name(Node node) const { return tokens_[nodes_[node].token]; }
    // As its primChildren have them.
    std::vector<Node> prims_of(Node node) const;
    std::optional<Node> property(Node prim, std::string_view name) const;

    // A field of a prim's or a property's: "typeName", "default". No value where it isn't there, or is of another type.
    bool has(Node node, std::string_view field) const;
    std::optional<std::string_view> token(Node node, std::string_view field) const;
    std::optional<double> number(Node node, std::string_view field) const;  // also of bool and of integers
    std::optional<glm::dvec3> vector(Node node, std::string_view field) const;
    std::optional<glm::dmat4> matrix(Node node,
                                     std::string_view field) const;  // its columns are the file's rows
    std::optional<std::vector<double>> quaternion(
        Node node, std::string_view field) const;  // i, j, k, and the real part
    std::optional<std::vector<std::string_view>> tokens(Node node, std::string_view field) const;
    // Of arrays; at most so many elements.
    std::optional<std::vector<std::int32_t>> integers(Node node, std::string_view field,
                                                      std::size_t most) const;
    std::optional<std::vector<glm::vec3>> vectors(Node node, std::string_view field, std::size_t most) const;

  private:
    struct Item {
        std::uint32_t token = 0;
        bool is_property = false, is_there = false;
        std::uint32_t field_set = ~std::uint32_t{0};
        std::vector<Node> children{};
    };
    std::optional<std::uint64_t> field(Node node, std::string_view name) const;
    std::string_view token_text(std::uint64_t index) const;

    std::string_view bytes_;
    std::string token_bytes_;
    std::vector<std::string_view> tokens_;
    std::vector<std::uint32_t> field_tokens_, field_sets_;
    std::vector<std::uint64_t> field_values_;
    std::vector<Item> nodes_;
};

}  // namespace pelagic::usd
