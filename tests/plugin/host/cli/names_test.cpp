// What a path's characters do to messages: nothing. Over every verb, with what it prints when all is well and when it isn't.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/plugin/host/cli/program.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

// An escape, a line's end, a character of C1, a byte that isn't UTF-8, one that turns the writing direction, and an é.
constexpr const char* kName =
    "a\x1b[31m\nb\xc2\x9b"
    "c\xff\xe2\x80\xae\xc3\xa9";
constexpr const char* kShown = "a\\u001b[31m\\u000ab\\u009bc\\xff\\u202eé";

// The first byte or character that a terminal would obey, as a number; 0 where there is none. Line ends are the messages' own.
int command_in(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if ((byte < 0x20 && byte != '\n') || byte == 0x7f || byte == 0xff) return byte;
        if (byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0)
            return 0xc2;
    }
    return text.find("\xe2\x80\xae") == std::string::npos ? 0 : 0x202e;
}

class Names : public ::testing::Test {
  protected:
    void SetUp() override {
        fs::create_directory(hostile());
        write_shot("shot", "");
        write_shot("sky", "[light]\nsky = \"nowhere.exr\"\n");
        write_shot("buoy", "[sea]\nspectrum = \"file\"\nspectrum_file = \"nowhere.txt\"\n");
        write_shot("cage", "[surface]\nkind = \"cage\"\ncage_file = \"nowhere.obj\"\n");
        write_file(hostile() / "broken.toml", "[shot\n");
        write_file(hostile() / "file", "x");
        write_file(hostile() / "notes.json", "{}");
    }
    void write_shot(const std::string& name, const std::string& more) const {
        write_file(
            hostile() / (name + ".toml"),
            "[shot]\nname = \"s\"\nframes = [1, 1]\n[waves]\ncascades = [{ size_m = 100, resolution = 32 }]\n"
            "[camera]\nresolution = [16, 9]\n[output]\nmaps = [\"displacement\"]\nmap_resolution = 8\n" +
                (more.empty() ? "[surface]\nresolution = 8\n[quality]\nlevel = \"draft\"\n" : more));
    }
    fs::path hostile() const { return folder_.path() / kName; }

    TempFolder folder_;
};

TEST_F(Names, MessagesObeyNoPath) {
    const std::string shot = "shot.toml";
    std::vector<std::vector<std::string>> commands{{"bake", shot, "--out", "out"},
                                                   {"bake", shot, "--out", "out"},  // all kept
                                                   {"verify", "out"},
                                                   {"bake", shot, "--out", "file"},
                                                   {"bake", shot, "--out", "out/s.json/x"},
                                                   {"render", shot, "--out", "pictures", "--samples", "1"},
                                                   {"verify", "pictures"},
                                                   {"verify", "nowhere"},
                                                   {"farm", shot, "--out", "out"},
                                                   {"farm", "--status", "out"},
                                                   {"verify", "."},  // foreign and unread ones
                                                   {"render", shot, "--out", "file"},
                                                   {"accuracy", shot, "--out", "file"},
                                                   {"bake", shot, "--out", "out", "--max-memory", "1K"}};
    if (kHasPreview) {
        commands.push_back({"preview", shot, "--offscreen", "file/x.png"});
        commands.push_back({"preview", shot, "--offscreen", "x.png", "--max-memory", "1K"});
    }
    for (const char* verb : {"bake", "render", "validate", "explain", "preview", "accuracy"})
        for (const char* file :
             {"nowhere.toml", "broken.toml", "file", "sky.toml", "buoy.toml", "cage.toml", "shot.toml/x"})
            commands.push_back({verb, file});
    bool is_shown = false;
    for (std::vector<std::string> command : commands) {
        std::string line;
        for (std::size_t i = 0; i < command.size(); ++i) {
            const bool is_path =
                i > 0 && !command[i].starts_with("--") && command[i] != "1K" && command[i] != "1";
            if (is_path) command[i] = (fs::path(kName) / command[i]).string();
            line += command[i] + ' ';
        }
        const Ended ended = run({.arguments = command, .folder = folder_.path()});
        EXPECT_LT(ended.status, 128) << line << ended.err;
        EXPECT_NE(ended.status, 1) << "known: " << line << ended.err;
        EXPECT_EQ(command_in(ended.out), 0) << line << ended.out;
        EXPECT_EQ(command_in(ended.err), 0) << line << ended.err;
        is_shown = is_shown || (ended.out + ended.err).find(kShown) != std::string::npos;
    }
    EXPECT_TRUE(is_shown) << "no message names the folder";
}

TEST_F(Names, ALetterOutsideAsciiIsOneCharacterOfItsMessage) {
    write_file(folder_.path() / "s.toml", "[shot]\nname = \"caf\xc3\xa9\"\n");
    const Ended ended = run({.arguments = {"validate", "s.toml"}, .folder = folder_.path()});
    EXPECT_EQ(ended.status, 2);
    EXPECT_NE(ended.err.find("it has \"\xc3\xa9\" in it"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace pelagic::test
