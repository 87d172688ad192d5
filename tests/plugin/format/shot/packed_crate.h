// Crates of USD as OpenUSD packs them, for tests: sections in LZ4 with matches, integers by the shortest differences. Written from the
// format's description alone, apart from the program's own writer, which packs nothing.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pelagic {

class PackedCrate {
  public:
    using Fields = std::vector<std::pair<std::string, std::uint64_t>>;
    static constexpr std::uint64_t kArray = std::uint64_t{1} << 63, kInlined = std::uint64_t{1} << 62,
                                   kPacked = std::uint64_t{1} << 61;
    enum Type : std::uint64_t {
        kBool = 1,
        kInt = 3,
        kFloat = 8,
        kDouble = 9,
        kToken = 11,
        kMatrix = 15,
        kVec3d = 23,
        kVec3f = 24,
        kTokens = 41,
        kSpecifier = 42
    };

    explicit PackedCrate(Fields layer = {}) {
        file_.assign(88, '\0');
        nodes_.push_back({.name = "", .fields = std::move(layer)});
    }

    // Values.
    static std::uint64_t inlined(Type type, std::uint32_t bits) { return kInlined | type << 48 | bits; }
    std::uint64_t token(const std::string& text) { return inlined(kToken, index_of(text)); }
    static std::uint64_t boolean(bool is) { return inlined(kBool, is); }
    static std::uint64_t real(float number) {  // a double that is a float
        std::uint32_t bits;
        std::memcpy(&bits, &number, sizeof bits);
        return inlined(kDouble, bits);
    }
    template <class T>
    std::uint64_t stored(Type type, const std::vector<T>& numbers) {
        const std::uint64_t at = file_.size();
        for (const T& number : numbers) append(file_, number);
        return type << 48 | at;
    }
    template <class T>
    std::uint64_t array(Type type, const std::vector<T>& numbers, std::size_t components = 1) {
        const std::uint64_t at = file_.size();
        append(file_, static_cast<std::uint64_t>(numbers.size() / components));
        for (const T& number : numbers) append(file_, number);
        return kArray | type << 48 | at;
    }
    std::uint64_t integers(const std::vector<std::int32_t>& numbers) {
        if (numbers.size() < 16) return kPacked | array(kInt, numbers);
        const std::uint64_t at = file_.size();
        append(file_, static_cast<std::uint64_t>(numbers.size()));
        append_integers(file_, {numbers.begin(), numbers.end()});
        return kArray | kPacked | kInt << 48 | at;
    }
    std::uint64_t tokens(const std::vector<std::string>& texts, bool is_array = true) {
        std::vector<std::uint32_t> indices;
        for (const std::string& text : texts) indices.push_back(index_of(text));
        return is_array ? array(kToken, indices) : array(kTokens, indices) & ~kArray;
    }

    // Prims and properties, whose parents come before them.
    int prim(int parent, const std::string& name, const std::string& type, Fields more = {}) {
        more.insert(more.begin(), {{"specifier", inlined(kSpecifier, 0)}, {"typeName", token(type)}});
        return add(parent, {.name = name, .fields = std::move(more)});
    }
    void property(int parent, const std::string& name, std::uint64_t value, Fields more = {}) {
        more.emplace_back("default", value);
        add(parent, {.name = name, .is_property = true, .fields = std::move(more)});
    }

    std::string bytes() {
        for (Node& node : nodes_) {
            std::vector<std::string> prims;
            for (const int child : node.children)
                if (!nodes_[child].is_property) prims.push_back(nodes_[child].name);
            if (!prims.empty()) node.fields.emplace_back("primChildren", tokens(prims, false));
        }
        std::vector<std::uint32_t> field_tokens, sets, spec_paths, spec_sets, spec_types;
        std::string values;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            spec_paths.push_back(static_cast<std::uint32_t>(i));
            spec_sets.push_back(static_cast<std::uint32_t>(sets.size()));
            spec_types.push_back(i == 0 ? 7 : nodes_[i].is_property ? 1 : 6);
            for (const auto& [name, value] : nodes_[i].fields) {
                sets.push_back(static_cast<std::uint32_t>(field_tokens.size()));
                field_tokens.push_back(index_of(name));
                append(values, value);
            }
            sets.push_back(~std::uint32_t{0});
        }
        write_paths(0, true);
        std::vector<std::pair<std::string, std::string>> sections;
        std::string text;
        for (const std::string& each : tokens_) text += each + '\0';
        std::string& token_section = sections.emplace_back("TOKENS", "").second;
        append(token_section, static_cast<std::uint64_t>(tokens_.size()));
        append(token_section, static_cast<std::uint64_t>(text.size()));
        append_bytes(token_section, text);
        append(sections.emplace_back("STRINGS", "").second, std::uint64_t{0});
        std::string& fields = sections.emplace_back("FIELDS", "").second;
        append(fields, static_cast<std::uint64_t>(field_tokens.size()));
        append_integers(fields, field_tokens);
        append_bytes(fields, values);
        std::string& set_section = sections.emplace_back("FIELDSETS", "").second;
        append(set_section, static_cast<std::uint64_t>(sets.size()));
        append_integers(set_section, sets);
        std::string& paths = sections.emplace_back("PATHS", "").second;
        append(paths, static_cast<std::uint64_t>(nodes_.size()));
        append(paths, static_cast<std::uint64_t>(nodes_.size()));
        for (const auto* list : {&path_places_, &path_names_, &path_jumps_}) append_integers(paths, *list);
        std::string& specs = sections.emplace_back("SPECS", "").second;
        append(specs, static_cast<std::uint64_t>(nodes_.size()));
        for (const auto* list : {&spec_paths, &spec_sets, &spec_types}) append_integers(specs, *list);
        std::string contents;
        append(contents, static_cast<std::uint64_t>(sections.size()));
        for (const auto& [name, section] : sections) {
            contents += name + std::string(16 - name.size(), '\0');
            append(contents, static_cast<std::uint64_t>(file_.size()));
            append(contents, static_cast<std::uint64_t>(section.size()));
            file_ += section;
        }
        const auto place = static_cast<std::uint64_t>(file_.size());
        file_ += contents;
        std::memcpy(file_.data(), "PXR-USDC\0\x08\0", 11);
        std::memcpy(file_.data() + 16, &place, sizeof place);
        return file_;
    }

  private:
    struct Node {
        std::string name;
        bool is_property = false;
        Fields fields{};
        std::vector<int> children{};
    };

    template <class T>
    static void append(std::string& to, const T& value) {
        to.append(reinterpret_cast<const char*>(&value), sizeof value);
    }

    std::uint32_t index_of(const std::string& text) {
        const auto [at, is_new] = index_.try_emplace(text, static_cast<std::uint32_t>(tokens_.size()));
        if (is_new) tokens_.push_back(text);
        return at->second;
    }
    int add(int parent, Node node) {
        nodes_.push_back(std::move(node));
        nodes_[static_cast<std::size_t>(parent)].children.push_back(static_cast<int>(nodes_.size() - 1));
        return static_cast<int>(nodes_.size() - 1);
    }
    void write_paths(int node, bool is_last) {
        const std::size_t here = path_places_.size();
        path_places_.push_back(static_cast<std::uint32_t>(node));
        const Node& of = nodes_[static_cast<std::size_t>(node)];
        const std::uint32_t name = index_of(of.name);
        path_names_.push_back(of.is_property ? 0 - name : name);
        path_jumps_.push_back(0);
        for (std::size_t i = 0; i < of.children.size(); ++i)
            write_paths(of.children[i], i + 1 == of.children.size());
        const auto size = static_cast<std::uint32_t>(path_places_.size() - here);
        path_jumps_[here] = of.children.empty() ? (is_last ? ~std::uint32_t{1} : 0)
                            : is_last           ? ~std::uint32_t{0}
                                                : size;
    }

    static void append_bytes(std::string& to, const std::string& bytes) {
        std::string packed(1, '\0');
        const auto length = [&](std::size_t more) {
            for (; more >= 255; more -= 255) packed += '\xff';
            packed += static_cast<char>(more);
        };
        std::map<std::string_view, std::size_t> seen;
        std::size_t from = 0, at = 0;
        const std::string_view all = bytes;
        const auto sequence = [&](std::size_t literals, std::size_t offset, std::size_t match) {
            const std::size_t more = offset > 0 ? match - 4 : 0;
            packed +=
                static_cast<char>(std::min<std::size_t>(literals, 15) << 4 | std::min<std::size_t>(more, 15));
            if (literals >= 15) length(literals - 15);
            packed += all.substr(from, literals);
            if (offset == 0) return;
            append(packed, static_cast<std::uint16_t>(offset));
            if (more >= 15) length(more - 15);
        };
        while (at + 4 <= all.size()) {
            const auto [before, is_new] = seen.try_emplace(all.substr(at, 4), at);
            const std::size_t place = before->second;
            before->second = at;
            if (is_new || at - place > 65535) {
                ++at;
                continue;
            }
            std::size_t match = 4;
            while (at + match < all.size() && all[place + match] == all[at + match]) ++match;
            sequence(at - from, at - place, match);
            from = at += match;
        }
        sequence(all.size() - from, 0, 0);
        append(to, static_cast<std::uint64_t>(packed.size()));
        to += packed;
    }

    static void append_integers(std::string& to, const std::vector<std::uint32_t>& numbers) {
        std::map<std::uint32_t, int> counts;
        std::uint32_t before = 0;
        for (const std::uint32_t number : numbers) ++counts[number - before], before = number;
        const std::uint32_t common = std::max_element(counts.begin(), counts.end(), [](auto& a, auto& b) {
                                         return a.second < b.second;
                                     })->first;
        std::string codes((2 * numbers.size() + 7) / 8, '\0'), rest;
        before = 0;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const auto step = static_cast<std::int32_t>(numbers[i] - before);
            before = numbers[i];
            int code = 0;
            if (static_cast<std::uint32_t>(step) == common) {
            } else if (step >= -128 && step < 128) {
                code = 1;
                append(rest, static_cast<std::int8_t>(step));
            } else if (step >= -32768 && step < 32768) {
                code = 2;
                append(rest, static_cast<std::int16_t>(step));
            } else {
                code = 3;
                append(rest, step);
            }
            codes[i / 4] = static_cast<char>(codes[i / 4] | code << 2 * (i % 4));
        }
        std::string bytes;
        append(bytes, common);
        append_bytes(to, bytes + codes + rest);
    }

    std::string file_;
    std::vector<Node> nodes_;
    std::vector<std::string> tokens_{""};
    std::map<std::string, std::uint32_t> index_{{"", 0}};
    std::vector<std::uint32_t> path_places_, path_names_, path_jumps_;
};

}  // namespace pelagic
