# Sourced by examples/bake-first-shot.sh and tests/run.sh: installs what is missing and builds. Debian 12, as root or with sudo.
# shellcheck shell=bash

PELAGIC_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

missing_packages() {
    local line package command
    sed 's/#.*//' "$PELAGIC_ROOT/examples/packages.txt" | while read -r line; do
        [ -n "$line" ] || continue
        package=${line%%:*} command=${line#*:}
        [ "$command" != "$line" ] && command -v "$command" >/dev/null 2>&1 && continue
        dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
    done
}

install_packages() {
    local missing
    missing=$(missing_packages)
    [ -n "$missing" ] || return 0
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || {
            echo "These packages are missing, and this user is neither root nor has sudo:" $missing >&2
            return 1
        }
        as_root=(sudo)
    fi
    echo "Installing:" $missing
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
    # shellcheck disable=SC2086
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing
}

# build PRESET [TARGET…]: configures and builds build/PRESET.
build() {
    local preset=$1
    shift
    local targets=()
    [ $# -eq 0 ] || targets=(--target "$@")
    (cd "$PELAGIC_ROOT" && cmake --preset "$preset" && cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}")
}
