// Editions: what a shot means where it doesn't say. Defaults get better with time; a shot that names its edition keeps those that it
// was made with.
//
// An edition changes defaults, and nothing else. A law that is replaced stays a choice of some key, so that an older edition is a few
// older values and nothing branches on its number.
#pragma once

#include <span>
#include <string_view>

#include "core/scene/keys.h"
#include "pelagic/scene.h"

namespace pelagic {

struct EditionChange {
    int edition;  // the first one with today's default, or the next row's
    std::string_view path;
    KeyValue before;
};

// By rising edition.
std::span<const EditionChange> edition_changes();

// The default of a key in an edition, 1 … kNewestEdition.
const KeyValue& fallback_in(int edition, const Key& key);

// A scene that says nothing: all defaults of an edition.
Scene scene_of_edition(int edition);

}  // namespace pelagic
