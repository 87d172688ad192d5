// Shot files: a valid scene or a refusal; what is taken can be written and read again.
#include <string>

#include "core/scene/canonical.h"
#include "core/scene/shot_text.h"
#include "core/scene/validate.h"
#include "plugin/format/shot/edit_shot.h"
#include "plugin/format/shot/shot.h"
#include "tests/fuzz/fuzz.h"
#include "tests/plugin/format/shot/no_check.h"

using namespace pelagic;
using fuzz::hold;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // Buoys lie in this folder; pictures of skies are another target's.
    static const std::filesystem::path file = PELAGIC_SOURCE_DIR "/tests/plugin/format/shot/data/fuzz.toml";
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const Scene scene = parse_shot(text, file, no_check);
        hold(validate(scene).empty(), "a scene that is taken is valid");
        const std::string written = shot_text(scene);
        try {
            hold(canonical(parse_shot(written, file, no_check)) == canonical(scene),
                 "a scene's own text gives the scene", written);
        } catch (const ShotError& error) {
            hold(false, "a scene's own text is a shot", error.what() + ("\n" + written));
        }
        // Its answer is to be read again: it may come out wrong, but in no other way.
        Scene other = scene;
        other.sea.wind_speed_mps = 33.25;
        other.surface.resolution = 77;
        other.sea.swell.push_back({1.5, 9.0, 20.0});
        try {
            edited_shot(text, other, scene);
        } catch (const ShotError&) {
        }
    } catch (const ShotError& error) {
        const std::string_view message = error.what();
        hold(message.find("fuzz.toml:") != std::string_view::npos, "a refusal names the file", message);
        hold(message.find("; accepted: ") != std::string_view::npos, "a refusal says what is accepted",
             message);
        hold(message.size() < 65536, "a refusal is short", message.substr(0, 1000));
    }
    return 0;
}
