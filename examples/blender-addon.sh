#!/usr/bin/env bash
# Builds the Blender add-on as one zip, and says where it is and how to install it.
#   examples/blender-addon.sh [--install]     --install: puts it into this user's Blender as well, and enables it
set -euo pipefail
case "${1:-}" in
"" | --install) ;;
*)
    sed -n '2,3s/^# //p' "$0"
    [ "$1" = "--help" ] || [ "$1" = "-h" ]
    exit
    ;;
esac
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=setup.sh
source "$here/setup.sh"

install_packages program python blender
for python in 3.13 3.14; do # of later Blenders
    "$PELAGIC_ROOT/plugin/host/python/headers.sh" $python "$PELAGIC_PYTHONS/$python" ||
        echo "The headers of Python $python weren't to be had: the zip isn't for Blenders that have it" >&2
done
build release addon-zip
zip=$(ls "$PELAGIC_ROOT"/build/release/pelagic_ocean-*.zip)

if [ "${1:-}" = "--install" ]; then
    blender -b --python-exit-code 1 --python-expr "
import bpy
bpy.ops.preferences.addon_install(filepath='$zip')
bpy.ops.preferences.addon_enable(module='pelagic_ocean')
bpy.ops.wm.save_userpref()"
    echo
    echo "Installed and enabled. In Blender: Add > Mesh > Pelagic Ocean"
else
    cat <<EOT

The add-on is $zip
In Blender: Edit > Preferences > Add-ons > Install… (since 4.2 Install from Disk…), choose it, and tick Pelagic Ocean. Then
Add > Mesh > Pelagic Ocean
EOT
fi
