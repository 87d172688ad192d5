#!/usr/bin/env bash
# Checks that each room includes only rooms above it in the layer table of core/README.md (Rooms).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
bad=0
# allow FOLDER "OTHERS": files in FOLDER may include only from FOLDER and OTHERS.
allow() {
    local found
    found=$(grep -rnoE '#include "(core|plugin|tests)/[a-z]+/' "$1" --include='*.h' --include='*.cpp' --include='*.inl' --include='*.glsl' |
        grep -vE "\"($(echo "$1 $2" | tr ' ' '|'))/" || true)
    [ -z "$found" ] || { echo "$found: not below $1"; bad=1; }
}
# What others may use includes nothing else of ours; and ocean.h is of core/evaluate.
found=$(grep -rnE '#include "' core/include | grep -v '"pelagic/' || true)
found+=$(grep -rnl '"pelagic/ocean.h"' core/{base,scene,spectrum,surface,plan,waves,lighting} || true)
[ -z "$found" ] || { echo "$found: not for core/include, or not below it"; bad=1; }
allow core/base ""
allow core/scene "core/base"
allow core/spectrum "core/base core/scene"
allow core/plan "core/base core/scene core/spectrum core/surface"
allow core/waves "core/base core/scene core/spectrum core/plan"
allow core/surface "core/base core/scene"
allow core/lighting "core/base"
allow core/evaluate "core/base core/scene core/spectrum core/plan core/waves core/surface"
allow core/effects "core/base core/scene core/spectrum core/plan core/waves core/surface core/evaluate"
allow plugin/files "core/base"
allow plugin/machine "core/base core/scene core/spectrum core/surface core/plan"
allow plugin/exr ""
allow plugin/png ""
allow plugin/usd ""
allow plugin/vdb ""
allow plugin/obj "core/base core/scene"
allow plugin/shot "core/base core/scene plugin/obj"
allow plugin/light "core/[a-z]+ plugin/exr"
allow plugin/run "core/[a-z]+ plugin/files plugin/exr plugin/png plugin/light plugin/usd"
allow plugin/bake "core/[a-z]+ plugin/machine plugin/files plugin/exr plugin/light plugin/usd plugin/vdb plugin/run"
allow plugin/render "core/[a-z]+ plugin/machine plugin/files plugin/exr plugin/light plugin/png plugin/run"
allow plugin/budget "core/[a-z]+ plugin/machine plugin/files plugin/light plugin/run plugin/bake plugin/render"
allow plugin/accuracy "core/[a-z]+ plugin/bake plugin/budget plugin/exr plugin/light plugin/render plugin/procedural"
allow plugin/gpu "core/[a-z]+"
allow plugin/preview "core/[a-z]+ plugin/machine plugin/files plugin/exr plugin/light plugin/png plugin/render plugin/gpu"
allow plugin/procedural "core/[a-z]+ plugin/machine plugin/shot plugin/light"
allow plugin/cli "core/[a-z]+ plugin/machine plugin/files plugin/shot plugin/light plugin/run plugin/bake plugin/render plugin/budget plugin/accuracy plugin/preview plugin/gpu"
allow plugin/python "core/[a-z]+ plugin/machine plugin/files plugin/obj plugin/shot plugin/light plugin/usd plugin/run plugin/bake plugin/render plugin/budget plugin/gpu"
exit $bad
