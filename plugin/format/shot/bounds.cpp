// What a shot file may be at most. See bounds.h.
#include "plugin/format/shot/bounds.h"

#include <algorithm>
#include <utility>

namespace pelagic {

namespace {

// Walks through the tokens of TOML. Knows strings, comments and brackets, which is enough to count; grammar is the
// parser's.
class Scan {
  public:
    explicit Scan(std::string_view text) : text_(text) {
        constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
        if (text_.starts_with(kByteOrderMark)) at_ = line_start_ = kByteOrderMark.size();
    }

    std::optional<BeyondBound> run() {
        while (at_ < text_.size() && !beyond_) step();
        return beyond_;
    }

  private:
    void step() {
        const char c = text_[at_];
        switch (c) {
            case '\n':
                ++at_;
                ++line_;
                line_start_ = at_;
                parts_ = 0;
                return;
            case '#':
                at_ = std::min(text_.find('\n', at_), text_.size());
                return;
            case '"':
            case '\'':
                return string(c);
            case '[':
            case '{':
                parts_ = 0;
                if (++nesting_ > kMostNesting)
                    return refuse(at_, "lists and tables are nested too deep",
                                  "at most " + std::to_string(kMostNesting) + " in each other");
                ++at_;
                return;
            case ']':
            case '}':
                nesting_ -= nesting_ > 0 ? 1 : 0;
                [[fallthrough]];
            case '=':
            case ',':
                parts_ = 0;
                ++at_;
                return;
            case '.':
                if (++parts_ >= kMostKeyParts)
                    return refuse(at_, "the key has too many parts",
                                  "at most " + std::to_string(kMostKeyParts) + " with dots between");
                ++at_;
                return;
            case ' ':
            case '\t':
            case '\r':
                ++at_;
                return;
            default:
                return word();
        }
    }

    void word() {
        const std::size_t start = at_;
        at_ = std::min(text_.find_first_of("\n#\"'[]{}=,. \t\r", at_), text_.size());
        if (at_ - start > kMostWordBytes)
            refuse(start, "a key or value without quotes is too long",
                   "at most " + std::to_string(kMostWordBytes) + " bytes");
    }

    void string(char quote) {
        const std::size_t start = at_, line = line_, line_start = line_start_;
        const bool is_long = text_.substr(at_, 3) == std::string(3, quote);
        at_ += is_long ? 3 : 1;
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '\\' && quote == '"' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n') {
                at_ += 2;
                continue;
            }
            if (c == '\n') {
                if (!is_long) break;  // no TOML: the parser says so
                ++line_;
                line_start_ = at_ + 1;
            }
            if (c == quote && (!is_long || text_.substr(at_, 3) == std::string(3, quote))) {
                at_ += is_long ? 3 : 1;
                // Up to two quotes before the closing three are the string's own.
                for (int own = 0; is_long && own < 2 && at_ < text_.size() && text_[at_] == quote; ++own)
                    ++at_;
                break;
            }
            ++at_;
        }
        if (at_ - start <= kMostStringBytes) return;
        line_ = line;
        line_start_ = line_start;
        refuse(start, "a string is too long", "at most " + std::to_string(kMostStringBytes) + " bytes");
    }

    void refuse(std::size_t at, std::string problem, std::string accepted) {
        std::size_t column = 1;
        for (std::size_t i = line_start_; i < at; ++i)
            column += (static_cast<unsigned char>(text_[i]) & 0xc0) != 0x80 ? 1 : 0;
        beyond_ = {line_, column, std::move(problem), std::move(accepted)};
    }

    std::string_view text_;
    std::size_t at_ = 0, line_ = 1, line_start_ = 0;
    int parts_ = 0, nesting_ = 0;
    std::optional<BeyondBound> beyond_;
};

}  // namespace

std::optional<BeyondBound> beyond_bounds(std::string_view toml) {
    return Scan(toml).run();
}

}  // namespace pelagic
