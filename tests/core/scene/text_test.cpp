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
}

}  // namespace
}  // namespace pelagic
