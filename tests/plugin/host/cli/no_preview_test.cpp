// The verb of a program that was built without the preview: no argument of it works, and each says why.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/verb.h"

namespace pelagic::cli {
namespace {

TEST(NoPreview, IsSaidWhateverIsAskedOfIt) {
    for (std::vector<std::string> arguments :
         std::vector<std::vector<std::string>>{{"preview"},
                                               {"preview", "a.toml"},
                                               {"preview", "a.toml", "--offscreen", "a.png", "--frame=3"}}) {
        CLI::App program("", "pelagic");
        const Verb verb = add_preview(program);
        std::vector<std::string> last_first(arguments.rbegin(), arguments.rend());
        program.parse(last_first);
        EXPECT_TRUE(verb.command->parsed());
        testing::internal::CaptureStderr();
        EXPECT_EQ(verb.run(), kWrongUsage);
        const std::string said = testing::internal::GetCapturedStderr();
        for (const char* const word : {"-DPELAGIC_PREVIEW=ON", "C library", "package pelagic"})
            EXPECT_NE(said.find(word), std::string::npos) << word;
        EXPECT_NE(program.help().find("preview"), std::string::npos);
        EXPECT_NE(verb.command->help().find("-DPELAGIC_PREVIEW=ON"), std::string::npos);
    }
}

}  // namespace
}  // namespace pelagic::cli
