// Values as text: exact, short, on one line.
#include "core/scene/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

namespace pelagic {
namespace {

TEST(Text, NumbersAreWrittenAsPeopleWriteThem) {
    EXPECT_EQ(number_text(0.0), "0");
    EXPECT_EQ(number_text(-3.0), "-3");
    EXPECT_EQ(number_text(0.1), "0.1");
    EXPECT_EQ(number_text(300e3), "300000");
    EXPECT_EQ(number_text(1e8), "1e8");
    EXPECT_EQ(number_text(2.5e-10), "2.5e-10");
    EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
    EXPECT_EQ(number_text(-std::numeric_limits<double>::infinity()), "-inf");
    EXPECT_EQ(number_text(-std::numeric_limits<double>::quiet_NaN()), "nan");
}

// The fingerprint rests on it: no two doubles share a text.
TEST(Text, NumbersReadBackAsTheSameBits) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        const double mantissa = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
        const double value = std::ldexp(mantissa, std::uniform_int_distribution<int>(-1070, 1023)(random));
        EXPECT_EQ(std::strtod(number_text(value).c_str(), nullptr), value) << number_text(value);
    }
    for (const double value : {std::numeric_limits<double>::min(), std::numeric_limits<double>::max(),
                               std::numeric_limits<double>::denorm_min(), 9999999.999999998, 1e-4, 1e7}) {
        EXPECT_EQ(std::strtod(number_text(value).c_str(), nullptr), value) << number_text(value);
    }
}

TEST(Text, QuotedTextStaysOnOneLine) {
    EXPECT_EQ(quoted_text("sea"), "\"sea\"");
    EXPECT_EQ(quoted_text("a\"b\\c\nd\x7f"), "\"a\\\"b\\\\c\\u000ad\\u007f\"");
    EXPECT_EQ(quoted_text("é"), "\"é\"");
    // A terminal's escape sequences, a line separator and what turns the writing direction are no text.
    EXPECT_EQ(quoted_text("\x1b[31m\u009b\u2028\u202e"), "\"\\u001b[31m\\u009b\\u2028\\u202e\"");
    // Bytes that aren't UTF-8: stray, cut off, overlong, a surrogate, beyond Unicode.
    EXPECT_EQ(quoted_text("caf\xe9/"), "\"caf\\\\xe9/\"");
    EXPECT_EQ(quoted_text("\xe2\x82"), "\"\\\\xe2\\\\x82\"");
    EXPECT_EQ(quoted_text("\xc0\xaf"), "\"\\\\xc0\\\\xaf\"");
    EXPECT_EQ(quoted_text("\xed\xa0\x80"), "\"\\\\xed\\\\xa0\\\\x80\"");
    EXPECT_EQ(quoted_text("\xf4\x90\x80\x80"), "\"\\\\xf4\\\\x90\\\\x80\\\\x80\"");
    EXPECT_EQ(quoted_text("水 🌊 \u07ff"), "\"水 🌊 \u07ff\"");
}

TEST(Text, PathsInMessagesAndRecords) {
    EXPECT_EQ(line_text("a\nb\x1b[2J\xe9 \"é\".toml"), "a\\u000ab\\u001b[2J\\xe9 \"é\".toml");
    EXPECT_EQ(utf8_text("caf\xe9\n\"é\""), "caf\\xe9\n\"é\"");
}

TEST(Text, Shortened) {
    EXPECT_EQ(shortened("abc", 3), "abc");
    EXPECT_EQ(shortened("abcd", 3), "abc…");
    EXPECT_EQ(shortened("ab€d", 3), "ab…") << "not in the middle of a character";
    EXPECT_EQ(shortened(std::string(1000, '\x80'), 3).size(), std::string("…").size() + 0u);
}

}  // namespace
}  // namespace pelagic
