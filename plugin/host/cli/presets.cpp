// pelagic presets
#include "core/scene/presets.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <iostream>
#include <memory>
#include <vector>

#include "core/lighting/tone.h"
#include "core/scene/shot_text.h"
#include "core/scene/text.h"
#include "plugin/files/files.h"
#include "plugin/format/png/png.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/progress.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/verb.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render.h"

namespace pelagic::cli {
namespace {

void print_all() {
    std::size_t widest = 0;
    for (const Preset& preset : presets()) widest = std::max(widest, preset.name.size());
    for (const Preset& preset : presets())
        std::cout << preset.name << std::string(widest + 2 - preset.name.size(), ' ') << preset.label << ": "
                  << preset.help << '\n';
    std::cout << std::flush;
}

// Its keys in the newest edition, as a shot file has them.
int print_one(const std::string& name) {
    const Preset* preset = find_preset(name);
    if (!preset) {
        std::cerr << "pelagic: " << text_of(unknown_preset("preset", name)) << std::endl;
        return kWrongUsage;
    }
    std::cout << "# " << preset->label << ": " << preset->help << '\n';
    const KeyTable* last = nullptr;
    for (const KeyTable& table : key_tables())
        for (const Key& key : table.keys) {
            const auto given = std::ranges::find(preset->values.rbegin(), preset->values.rend(), key.path,
                                                 &PresetValue::path);
            if (given == preset->values.rend()) continue;
            const std::string text = value_text(key, given->value);
            if (text.empty()) continue;
            if (last != &table) std::cout << '[' << table.name << "]\n";
            last = &table;
            std::cout << key.name << " = " << text << '\n';
        }
    std::cout << std::flush;
    return kDone;
}

// A small picture of each, in rows, in the order of the list.
int draw_sheet(const std::filesystem::path& file) {
    constexpr glm::ivec2 kSize{320, 180};
    constexpr int kAcross = 4, kGap = 4, kTime = 12;
    const auto count = static_cast<int>(presets().size());
    const glm::ivec2 cells(kAcross, (count + kAcross - 1) / kAcross);
    const glm::ivec2 size = cells * (kSize + kGap) - kGap;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size.x) * size.y * 3, 255);
    Progress progress;
    for (int i = 0; i < count; ++i) {
        const Preset& preset = presets()[static_cast<std::size_t>(i)];
        progress.show(preset.name + ": " + std::to_string(i + 1) + " of " + std::to_string(count));
        Scene scene;
        apply(preset, scene);
        scene.camera.resolution = kSize;
        RenderOptions options = render_options(scene);
        options.samples = 2;
        Renderer renderer(scene, options, make_sky(scene), std::vector<int>{kTime});
        Picture picture;
        renderer.render(kTime, picture);
        const float exposure = shot_exposure(scene, renderer.sky());
        const std::vector<glm::vec3> glaring = glaring_light(scene.camera, picture, kTime);
        const glm::ivec2 corner = glm::ivec2(i % kAcross, i / kAcross) * (kSize + kGap);
        for (int y = 0; y < kSize.y; ++y)
            for (int x = 0; x < kSize.x; ++x) {
                const std::size_t at = static_cast<std::size_t>(y) * kSize.x + x;
                const auto shown =
                    display_bytes(glaring.empty() ? light_of(picture, at) : glaring[at], exposure, {x, y});
                std::copy(
                    shown.begin(), shown.end(),
                    bytes.begin() + 3 * (static_cast<std::ptrdiff_t>(corner.y + y) * size.x + corner.x + x));
            }
    }
    progress.clear();
    files::write_atomically(file, png::encode({.width = size.x, .height = size.y, .bytes = bytes}));
    std::cout << "sheet: " << line_text(file.string()) << std::endl;
    return kDone;
}

}  // namespace

Verb add_presets(CLI::App& program) {
    CLI::App* command = program.add_subcommand("presets", help::kPresets)->footer(help::kPresetsFooter);
    auto name = std::make_shared<std::string>();
    command->add_option("NAME", *name, help::kPresetName)->type_name("");
    auto sheet = std::make_shared<std::string>();
    command->add_option("--sheet", *sheet, help::kPresetSheet)->type_name("FILE.png");
    return {command, [name, sheet] {
                if (!sheet->empty()) {
                    if (std::filesystem::path(*sheet).extension() != ".png")
                        throw WrongUsage("--sheet " + quoted_text(*sheet) +
                                         "; accepted: a file that ends in .png");
                    if (!name->empty())
                        throw WrongUsage("--sheet shows all presets; leave " + quoted_text(*name) + " out");
                    return draw_sheet(*sheet);
                }
                if (!name->empty()) return print_one(*name);
                print_all();
                return int{kDone};
            }};
}

}  // namespace pelagic::cli
