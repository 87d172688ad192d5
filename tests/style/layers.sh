#!/usr/bin/env bash
# Checks that each room includes only rooms above it in the layer table of core/README.md (Rooms).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
bad=0
# allow FOLDER "OTHERS": files in FOLDER may include only from FOLDER and OTHERS.
allow() {
    local found
    # The scene, its cage and its pictures of masks are core/scene's, wherever their headers lie.
    found=$(grep -rnoE '#include "((core|plugin|plugin/format|plugin/host|tests)/[a-z]+/|pelagic/(scene|cage|mask_picture)\.h)' "$1" --include='*.h' --include='*.cpp' --include='*.inl' --include='*.glsl' |
        sed 's|"pelagic/[a-z._]*|"core/scene/|' |
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
allow plugin/format/exr ""
allow plugin/format/png ""
allow plugin/format/usd ""
allow plugin/format/vdb "plugin/files"
allow plugin/format/ocio "plugin/files"
allow plugin/format/obj "core/base core/scene"
allow plugin/format/shot "core/base core/scene plugin/format/exr plugin/format/obj plugin/format/png plugin/format/usd"
allow plugin/light "core/[a-z]+ plugin/format/exr plugin/format/shot"
allow plugin/run "core/[a-z]+ plugin/files plugin/format/exr plugin/format/png plugin/light plugin/format/usd"
allow plugin/bake "core/[a-z]+ plugin/machine plugin/files plugin/format/exr plugin/light plugin/format/usd plugin/format/vdb plugin/run"
allow plugin/render "core/[a-z]+ plugin/machine plugin/files plugin/format/exr plugin/light plugin/format/png plugin/run"
allow plugin/budget "core/[a-z]+ plugin/machine plugin/files plugin/light plugin/run plugin/bake plugin/render"
allow plugin/accuracy "core/[a-z]+ plugin/bake plugin/budget plugin/format/exr plugin/light plugin/render plugin/host/procedural"
allow plugin/host/gpu "core/[a-z]+"
allow plugin/host/preview "core/[a-z]+ plugin/machine plugin/files plugin/format/exr plugin/light plugin/format/png plugin/render plugin/host/gpu"
allow plugin/host/procedural "core/[a-z]+ plugin/machine plugin/format/shot plugin/light"
allow plugin/host/cli "core/[a-z]+ plugin/machine plugin/files plugin/format/ocio plugin/format/png plugin/format/shot plugin/light plugin/run plugin/bake plugin/render plugin/budget plugin/accuracy plugin/host/preview plugin/host/gpu"
allow plugin/host/python "core/[a-z]+ plugin/machine plugin/files plugin/format/obj plugin/format/shot plugin/light plugin/format/usd plugin/run plugin/bake plugin/render plugin/budget plugin/host/gpu"
exit $bad
