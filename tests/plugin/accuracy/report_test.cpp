// Tables, CSV and the page, from rows that are made up.
#include "plugin/accuracy/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace pelagic {
namespace {

std::vector<MeasuredRow> made_up() {
    MeasuredRow sky{.name = "sky",
                    .shot = "0123456789abcdef",
                    .when = "2026-11-20T10:00:00Z",
                    .machine = "avx2, 2 threads",
                    .settings = {{"one", false, {0.1, 0.03}, 10.25, 0},
                                 {"nine, \"quoted\", <b>", true, {0.1 / 3.0, 1e-300}, 11.5, 0},
                                 {"integral", false, {0.0, 0.0}, 1234.0, 0}}};
    MeasuredRow none{.name = "whitecap-moments",
                     .shot = "0123456789abcdef",
                     .when = "2026-11-23T09:00:00Z",
                     .machine = "avx2, 2 threads",
                     .settings = {},
                     .why_none = "has nothing to sweep: the shot has no whitecaps"};
    // 1000 ms, of which the foam takes 600, the air 100 and both leave 250: 50 are in neither's price.
    MeasuredRow effects{.name = "picture-effects",
                        .shot = "0123456789abcdef",
                        .when = "2026-11-23T09:00:00Z",
                        .machine = "avx2, 2 threads",
                        .settings = {{kWholeShot, true, {0.0, 0.0}, 1000.0, 9 << 20, 30},
                                     {kShotAgain, false, {0.0, 0.0}, 995.0, 9 << 20, 30},
                                     {"without <air>", false, {0.1, 0.2}, 900.0, 9 << 20, 30},
                                     {"without foam", false, {0.3, 0.4}, 400.0, 5 << 20, 22},
                                     {kBareShot, false, {0.5, 0.6}, 250.0, 4 << 20, 20}}};
    return {sky, none, effects};
}

constexpr const char* kNow = "2026-11-23T10:00:00Z";
constexpr const char* kShot = "0123456789abcdef";

std::string problem_of(const std::string& csv) {
    try {
        read_csv_report(csv);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

TEST(AccuracyReport, CsvComesBackToTheBit) {
    const std::vector<MeasuredRow> rows = made_up(), back = read_csv_report(csv_report(rows));
    ASSERT_EQ(back.size(), rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
        EXPECT_EQ(back[r].name, rows[r].name);
        EXPECT_EQ(back[r].shot, rows[r].shot);
        EXPECT_EQ(back[r].when, rows[r].when);
        EXPECT_EQ(back[r].machine, rows[r].machine);
        EXPECT_EQ(back[r].why_none, rows[r].why_none);
        ASSERT_EQ(back[r].settings.size(), rows[r].settings.size());
        for (std::size_t s = 0; s < rows[r].settings.size(); ++s) {
            EXPECT_EQ(back[r].settings[s].setting, rows[r].settings[s].setting);
            EXPECT_EQ(back[r].settings[s].is_shots, rows[r].settings[s].is_shots);
            EXPECT_EQ(back[r].settings[s].errors, rows[r].settings[s].errors);
            EXPECT_EQ(back[r].settings[s].ms, rows[r].settings[s].ms);
            EXPECT_EQ(back[r].settings[s].bytes, rows[r].settings[s].bytes);
            EXPECT_EQ(back[r].settings[s].transforms, rows[r].settings[s].transforms);
        }
    }
    EXPECT_EQ(csv_report(back), csv_report(rows));
}

TEST(AccuracyReport, DamagedTablesAreRefusedWithTheirLine) {
    const std::string csv = csv_report(made_up());
    const std::size_t second = csv.find('\n') + 1;
    EXPECT_NE(problem_of("").find("empty"), std::string::npos);
    EXPECT_NE(problem_of("a,b\n").find("line 1"), std::string::npos);
    EXPECT_NE(problem_of(csv.substr(0, second) + "\"sky\",\"x\"\n").find("line 2: it has 2 fields"),
              std::string::npos);
    EXPECT_NE(problem_of(csv.substr(0, second) + "\"sky\n").find("line 2: a quotation mark"),
              std::string::npos);
    std::string wrong = csv;
    wrong.replace(wrong.find("10.25"), 5, "ten");
    EXPECT_NE(problem_of(wrong).find("\"ten\" is no number"), std::string::npos) << problem_of(wrong);
    // Rows of another version are left out.
    std::string other = csv;
    for (std::size_t at; (at = other.find("\"sky\"")) != std::string::npos;)
        other.replace(at, 5, "\"skies\"");
    EXPECT_EQ(read_csv_report(other).size(), 2u);
    // Of parts without their end nothing can be said.
    const std::size_t bare = csv.rfind("\"picture-effects\"");
    EXPECT_EQ(read_csv_report(csv.substr(0, bare)).size(), 2u);
    EXPECT_EQ(read_csv_report(csv).size(), 3u);
    // Cut anywhere, it is read or refused.
    for (std::size_t length = 0; length < csv.size(); ++length) problem_of(csv.substr(0, length));
}

TEST(AccuracyReport, TextSaysWhatEachNumberIsAndHowOldItIs) {
    const std::string text = text_report(made_up(), kNow, kShot);
    for (const char* part :
         {"Lookups of the reflected sky (sky)", "the integral", "measured on 2026-11-20, 3 days before",
          "  * nine", "the shot has no whitecaps"})
        EXPECT_NE(text.find(part), std::string::npos) << part << '\n' << text;
    EXPECT_EQ(text.find("as it was then"), std::string::npos);
    // Parts, the dearest first, with their shares; what is left; the sum; the whole; how exact it is.
    std::size_t at = 0;
    for (
        const char* line : {
            "    foam                            600.000      60.0 %          8    4.0 MiB         0.3         0.4\n",
            "    <air>                           100.000      10.0 %          0          0         0.1         0.2\n",
            "    the rest                        250.000      25.0 %         20    4.0 MiB\n",
            "    parts and rest together         950.000      95.0 %         28    8.0 MiB\n",
            "    the shot                       1000.000     100.0 %         30    9.0 MiB\n",
            "    the shot less the same again      5.000       0.5 %          0          0\n",
        }) {
        const std::size_t found = text.find(line, at);
        ASSERT_NE(found, std::string::npos) << line << text;
        at = found;
    }
    EXPECT_NE(text_report(made_up(), kNow, "another").find("of the shot as it was then"), std::string::npos);
}

// The page needs nothing beside it, its elements are closed, and names of settings are no markup.
TEST(AccuracyReport, ThePageStandsAlone) {
    const std::string page = html_report(made_up(), kNow, "a <shot>", kShot);
    for (const char* outside : {"http:", "https:", "src=", "<link", "<script", "url("})
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    EXPECT_EQ(page.find("<b>"), std::string::npos);
    EXPECT_EQ(page.find("<shot>"), std::string::npos);
    EXPECT_EQ(page.find("<air>"), std::string::npos);
    EXPECT_NE(page.find("dearest: foam, 600.0 of 1000.0 ms"), std::string::npos);
    EXPECT_NE(page.find("nine, &quot;quoted&quot;, &lt;b&gt;: 0.0333, 11.5 ms"), std::string::npos);
    for (const std::string number : {"nan", "inf\""})
        EXPECT_EQ(page.find(number), std::string::npos) << number;
    std::vector<std::string> open;
    for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at + 1)) {
        const std::string tag = page.substr(at + 1, page.find_first_of(" >/", at + 2) - at - 1);
        const bool closes_itself = page[page.find('>', at) - 1] == '/' || tag == "!doctype" || tag == "meta";
        if (page[at + 1] == '/') {
            const std::string name = page.substr(at + 2, page.find('>', at) - at - 2);
            ASSERT_FALSE(open.empty()) << name;
            EXPECT_EQ(open.back(), name);
            open.pop_back();
        } else if (!closes_itself) {
            open.push_back(tag);
        }
    }
    EXPECT_TRUE(open.empty());
}

TEST(AccuracyReport, PlotsAreFilesOfTheirOwn) {
    const std::string svg = svg_report(made_up()[0]);
    EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=")) << svg.substr(0, 80);
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
    EXPECT_NE(svg.find("<style>"), std::string::npos);
    EXPECT_EQ(svg_report(made_up()[1]), "");
    // A bar as long as the longest is 1000 ms.
    const std::string bars = svg_report(made_up()[2]);
    EXPECT_NE(bars.find("width=\"350.0\""), std::string::npos);
    EXPECT_NE(bars.find("width=\"210.0\""), std::string::npos) << bars;
}

}  // namespace
}  // namespace pelagic
