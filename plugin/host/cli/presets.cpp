// pelagic presets
#include "core/scene/presets.h"

#include <algorithm>
#include <iostream>
#include <memory>

#include "core/scene/shot_text.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/verb.h"

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

// Its keys, as a shot file has them.
int print_one(const std::string& name) {
    const Preset* preset = find_preset(name);
    if (!preset) {
        std::cerr << "pelagic: " << text_of(unknown_preset("preset", name)) << std::endl;
        return kWrongUsage;
    }
    std::cout << "# " << preset->label << ": " << preset->help << '\n';
    const KeyTable* last = nullptr;
    for (const KeyTable& table : key_tables())
        for (const Key& key : table.keys)
            for (const auto& [path, value] : preset->values) {
                if (path != key.path) continue;
                const std::string text = value_text(key, value);
                if (text.empty()) continue;
                if (last != &table) std::cout << '[' << table.name << "]\n";
                last = &table;
                std::cout << key.name << " = " << text << '\n';
            }
    std::cout << std::flush;
    return kDone;
}

}  // namespace

Verb add_presets(CLI::App& program) {
    CLI::App* command = program.add_subcommand("presets", help::kPresets)->footer(help::kPresetsFooter);
    auto name = std::make_shared<std::string>();
    command->add_option("NAME", *name, help::kPresetName)->type_name("");
    return {command, [name] {
                if (!name->empty()) return print_one(*name);
                print_all();
                return int{kDone};
            }};
}

}  // namespace pelagic::cli
