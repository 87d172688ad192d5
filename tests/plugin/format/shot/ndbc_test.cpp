// The NDBC archive's spectra: conventions by hand, both header styles, missing values, refusals; and a real
// buoy.
#include "plugin/format/shot/ndbc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "core/scene/validate.h"
#include "temporary_folder.h"

namespace pelagic {
namespace {

using std::chrono::sys_seconds;

const std::filesystem::path kBuoys =
    std::filesystem::path(PELAGIC_SOURCE_DIR) / "tests/plugin/format/shot/data";

sys_seconds at(int year, unsigned month, unsigned day, int hour, int minute) {
    return std::chrono::sys_days{std::chrono::year(year) / std::chrono::month(month) /
                                 std::chrono::day(day)} +
           std::chrono::hours(hour) + std::chrono::minutes(minute);
}

std::string buoy_refusal(const std::filesystem::path& file, sys_seconds time) {
    try {
        load_ndbc(file, time);
    } catch (const NdbcError& error) {
        return error.what();
    }
    return "";
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

// Ten times the rounding of a sine near a multiple of π (2π × 1.1e-16).
constexpr double kRounding = 1e-14;

// α = 90° is from the east: towards the west, −x; α = 180° from the south: towards +y; α = 270° from the
// west: towards +x. Second harmonic of α2 = 225°: θ = 45°, e^{2iθ} = i.
TEST(Ndbc, DirectionsBecomeTowardsCounterClockwiseFromEast) {
    const MeasuredSpectrum sea = load_ndbc(kBuoys / "made-99001w2021.txt", at(2021, 3, 1, 0, 50));
    EXPECT_EQ(sea.station, "99001");
    EXPECT_EQ(sea.time, "2021-03-01T00:50:00Z");
    ASSERT_EQ(sea.bins.size(), 4u);
    const MeasuredSpectrum::Bin& east = sea.bins[0];
    EXPECT_EQ(east.frequency_hz, 0.05);
    EXPECT_EQ(east.density_m2_per_hz, 0.0);
    EXPECT_TRUE(east.has_direction);
    EXPECT_NEAR(east.c1_re, -1.0, kRounding);
    EXPECT_NEAR(east.c1_im, 0.0, kRounding);
    EXPECT_NEAR(east.c2_re, 1.0, kRounding);
    EXPECT_NEAR(east.c2_im, 0.0, kRounding);
    const MeasuredSpectrum::Bin& south = sea.bins[1];
    EXPECT_EQ(south.density_m2_per_hz, 4.0);
    EXPECT_NEAR(south.c1_re, 0.0, kRounding);
    EXPECT_NEAR(south.c1_im, 0.5, kRounding);
    EXPECT_NEAR(south.c2_re, 0.0, kRounding);
    EXPECT_NEAR(south.c2_im, 0.4, kRounding);
    const MeasuredSpectrum::Bin& west = sea.bins[2];
    EXPECT_NEAR(west.c1_re, 0.8, kRounding);
    EXPECT_NEAR(west.c1_im, 0.0, kRounding);
    EXPECT_NEAR(west.c2_re, 0.6, kRounding);
    // α1 is missing: the density counts, without a direction.
    const MeasuredSpectrum::Bin& unknown = sea.bins[3];
    EXPECT_EQ(unknown.density_m2_per_hz, 0.5);
    EXPECT_FALSE(unknown.has_direction);
    EXPECT_EQ(unknown.c1_re, 0.0);
    EXPECT_EQ(unknown.c2_im, 0.0);
}

TEST(Ndbc, BinsWithoutDensityAreLeftOut) {
    const MeasuredSpectrum sea = load_ndbc(kBuoys / "made-99001w2021.txt", at(2021, 3, 1, 1, 50));
    ASSERT_EQ(sea.bins.size(), 3u);
    EXPECT_EQ(sea.bins[1].frequency_hz, 0.1);
    EXPECT_EQ(sea.bins[2].frequency_hz, 0.4);
    EXPECT_FALSE(sea.bins[2].has_direction);
    // All but one missing (999.00, 99.00, MM): no spectrum, and the hours that have one are named.
    const std::string text = buoy_refusal(kBuoys / "made-99001w2021.txt", at(2021, 3, 1, 2, 50));
    EXPECT_TRUE(has(text, "w2021.txt:4: fewer than two densities")) << text;
    EXPECT_TRUE(has(text, "nearest: 2021-03-01T01:50:00Z")) << text;
}

TEST(Ndbc, ATimeThatIsNotThere) {
    const std::string text = buoy_refusal(kBuoys / "made-99001w2021.txt", at(2021, 3, 1, 1, 0));
    EXPECT_TRUE(has(text, "has no row of that time")) << text;
    EXPECT_TRUE(has(text,
                    "one of its 3 times, 2021-03-01T00:50:00Z … 2021-03-01T02:50:00Z; nearest: "
                    "2021-03-01T00:50:00Z and 2021-03-01T01:50:00Z"))
        << text;
    try {
        load_ndbc(kBuoys / "made-99001w2021.txt", at(1970, 1, 1, 0, 0));
        FAIL();
    } catch (const NdbcError& error) {
        EXPECT_TRUE(error.parts().about_time);
        EXPECT_TRUE(error.parts().accepted.ends_with("nearest: 2021-03-01T00:50:00Z")) << error.what();
    }
}

// Five files of one text each; changes to one of them are the test's.
struct Files {
    TemporaryFolder folder;
    std::filesystem::path w;

    Files(const std::string& header, const std::string& time) : Files(header, time, "1.5 2.5") {}
    Files(const std::string& header, const std::string& time, const std::string& densities) {
        w = folder.write("12345w1998.txt", header + '\n' + time + ' ' + densities + '\n');
        for (const char letter : {'d', 'i', 'j', 'k'}) {
            folder.write(std::string("12345") + letter + "1998.txt", header + '\n' + time + " 10 20\n");
        }
    }
};

TEST(Ndbc, OlderHeaders) {
    const Files without_minutes("YYYY MM DD hh  .03 .04", "1999 12 31 23");
    EXPECT_EQ(load_ndbc(without_minutes.w, at(1999, 12, 31, 23, 0)).bins[1].density_m2_per_hz, 2.5);
    const Files two_digits("YY MM DD hh 0.030 0.040", "96 02 29 00\r");
    EXPECT_EQ(load_ndbc(two_digits.w, at(1996, 2, 29, 0, 0)).time, "1996-02-29T00:00:00Z");
    const Files with_units("#YY MM DD hh mm .03 .04\n#yr mo dy hr mn Hz Hz\n", "2007 01 01 00 00");
    EXPECT_EQ(load_ndbc(with_units.w, at(2007, 1, 1, 0, 0)).bins.size(), 2u);
}

TEST(Ndbc, MalformedFilesNameFileAndLine) {
    const std::string header = "#YY MM DD hh mm .03 .04";
    const sys_seconds time = at(2007, 1, 1, 0, 0);
    const auto refused = [&](const std::string& a_header, const std::string& date,
                             const std::string& densities) {
        const Files files(a_header, date, densities);
        return buoy_refusal(files.w, time);
    };
    const std::string date = "2007 01 01 00 00";
    EXPECT_EQ(refused(header, date, "1 2"), "");
    std::string text;
    EXPECT_TRUE(
        has(text = refused(header, date, "1 x"), "w1998.txt:2: \"x\" at 0.04 Hz is no spectral density"))
        << text;
    EXPECT_TRUE(has(text = refused(header, date, "1 -2"), "0 … 10000, or 999")) << text;
    EXPECT_TRUE(has(text = refused(header, date, "1 nan"), "\"nan\"")) << text;
    EXPECT_TRUE(has(text = refused(header, date, "1"),
                    ":2: the row has 6 columns; accepted: as many as the header: 7"))
        << text;
    EXPECT_TRUE(
        has(text = refused(header, "2007 13 01 00 00", "1 2"), ":2: the row does not begin with a date"))
        << text;
    EXPECT_TRUE(
        has(text = refused(header, "2007 02 29 00 00", "1 2"), ":2: the row does not begin with a date"))
        << text;
    EXPECT_TRUE(has(text = refused(header, "2007 x 01 00 00", "1 2"), ":2: \"x\" is no part of a date"))
        << text;
    EXPECT_TRUE(
        has(text = refused("#YY MM DD hh mm .04 .03", date, "1 2"), ":1: the frequency \".03\" is not above"))
        << text;
    EXPECT_TRUE(has(text = refused("#YY MM DD hh mm .04 Hz", date, "1 2"), ":1: \"Hz\" is no frequency"))
        << text;
    EXPECT_TRUE(has(text = refused("#YY MM DD hh mm .04", date, "1"), ":1: the header names fewer than two"))
        << text;
    EXPECT_TRUE(has(text = refused("some words of a text", date, "1 2"), ":1: ")) << text;
    EXPECT_TRUE(has(text = refused("1 2 3", date, "1 2"), ":1: this is not the header of an NDBC")) << text;
    EXPECT_TRUE(has(text = refused(header, "#2007 01 01 00 00", "1 2"), "has no rows")) << text;
}

TEST(Ndbc, AllFiveFilesAreNeeded) {
    const sys_seconds time = at(2007, 1, 1, 0, 0);
    const std::string header = "#YY MM DD hh mm .03 .04", date = "2007 01 01 00 00";
    for (const char letter : {'d', 'i', 'j', 'k', 'w'}) {
        const Files files(header, date);
        const std::string name = std::string("12345") + letter + "1998.txt";
        std::filesystem::remove(files.folder.path() / name);
        EXPECT_TRUE(has(buoy_refusal(files.w, time), name + " does not exist; accepted: NDBC's five files"))
            << letter;
    }
    const Files files(header, date);
    files.folder.write("12345j1998.txt", header + "\n2007 01 01 01 00 10 20\n");
    EXPECT_TRUE(has(buoy_refusal(files.w, time), "12345j1998.txt has no row of that time"));
    files.folder.write("12345j1998.txt", "#YY MM DD hh mm .03 .05\n" + date + " 10 20\n");
    EXPECT_TRUE(has(buoy_refusal(files.w, time), "12345j1998.txt has other frequencies than"));
    files.folder.write("12345j1998.txt", header + '\n' + date + " 10 101\n");
    EXPECT_TRUE(has(buoy_refusal(files.w, time),
                    "12345j1998.txt:2: \"101\" at 0.04 Hz is no directional coefficient"));
    files.folder.write("12345j1998.txt", header + '\n' + date + " 10 20\n");
    files.folder.write("12345d1998.txt", header + '\n' + date + " 10 361\n");
    EXPECT_TRUE(
        has(buoy_refusal(files.w, time), "12345d1998.txt:2: \"361\" at 0.04 Hz is no direction in degrees"));
    EXPECT_TRUE(has(buoy_refusal(files.folder.path() / "12345d1998.txt", time), "is not named like"));
    EXPECT_TRUE(has(buoy_refusal(files.folder.path(), time), "is not named like"));
}

// Independent of the parser: the archive's columns have fixed places in a row. The 99 hours of the real buoy
// load, and their energy is the rows' own.
TEST(Ndbc, ARealBuoy) {
    const std::filesystem::path w =
        std::filesystem::path(PELAGIC_SOURCE_DIR) / "../shared/data/ndbc-41010w2019.txt";
    if (!std::filesystem::exists(w)) GTEST_SKIP() << w << " is not there";
    std::ifstream in(w);
    std::string line;
    std::getline(in, line);
    int hours = 0;
    int directions = 0;
    while (std::getline(in, line)) {
        std::istringstream row(line);
        int year = 0, month = 0, day = 0, hour = 0, minute = 0;
        row >> year >> month >> day >> hour >> minute;
        double sum = 0.0;
        for (double density = 0.0; row >> density;) sum += density;
        const MeasuredSpectrum sea =
            load_ndbc(w, at(year, static_cast<unsigned>(month), static_cast<unsigned>(day), hour, minute));
        EXPECT_EQ(sea.station, "41010");
        ASSERT_EQ(sea.bins.size(), 47u);
        double loaded = 0.0;
        for (const MeasuredSpectrum::Bin& bin : sea.bins) {
            loaded += bin.density_m2_per_hz;
            directions += bin.has_direction ? 1 : 0;
        }
        EXPECT_NEAR(loaded, sum, 1e-12 * sum);  // the same 47 additions
        Scene scene;
        scene.sea.spectrum = SpectrumKind::File;
        scene.sea.measured = sea;
        EXPECT_TRUE(validate(scene).empty()) << line;
        ++hours;
    }
    EXPECT_EQ(hours, 99);
    EXPECT_GT(directions, 99 * 40);
    // Read off the file by eye, 2019-02-06 00:40, the peak at 0.11 Hz: α1 = 29°, r1 = 0.88: from
    // north-north-east.
    const MeasuredSpectrum sea = load_ndbc(w, at(2019, 2, 6, 0, 40));
    EXPECT_EQ(sea.bins[15].frequency_hz, 0.11);
    EXPECT_EQ(sea.bins[15].density_m2_per_hz, 5.8);
    EXPECT_NEAR(sea.bins[15].c1_re, -0.88 * std::sin(29.0 * std::numbers::pi / 180.0), kRounding);
    EXPECT_NEAR(sea.bins[15].c1_im, -0.88 * std::cos(29.0 * std::numbers::pi / 180.0), kRounding);
}

}  // namespace
}  // namespace pelagic
