# Sourced by examples/bake-first-shot.sh and tests/run.sh: installs what is missing and builds. Debian 12, as root or with sudo.
# shellcheck shell=bash

PELAGIC_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
PELAGIC_PYTHONS=$PELAGIC_ROOT/build/pythons # headers of others than this machine's, once plugin/host/python/headers.sh has fetched them

# debian_mirror: where apt has this Debian's packages from, which most likely has other Debians' too; nothing if it can't be told.
debian_mirror() {
    # shellcheck disable=SC2016
    apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Codename: bookworm' | head -n 1
}

# missing_packages [SECTION…]: those of the list's sections that aren't installed; of all without an argument.
missing_packages() {
    local section="" line package command
    for section; do
        grep -qx "\[$section\]" "$PELAGIC_ROOT/examples/packages.txt" ||
            { echo "setup.sh: packages.txt has no section [$section]" >&2 && return 1; }
    done
    sed 's/#.*//' "$PELAGIC_ROOT/examples/packages.txt" | while read -r line; do
        case $line in
        "") continue ;;
        "["*) section=${line//[][]/} && continue ;;
        esac
        [ $# -eq 0 ] || [[ " $* " == *" $section "* ]] || continue
        package=${line%%:*} command=${line#*:}
        [ "$command" != "$line" ] && command -v "$command" >/dev/null 2>&1 && continue
        dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
    done
}

# install_packages [SECTION…]: those that are missing.
install_packages() {
    local missing
    missing=$(missing_packages "$@")
    # shellcheck disable=SC2086
    [ -z "$missing" ] || apt_install $missing
}

# apt_install PACKAGE…
apt_install() {
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || {
            echo "These packages are missing, and this user is neither root nor has sudo:" "$@" >&2
            return 1
        }
        as_root=(sudo)
    fi
    echo "Installing:" "$@"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@"
}

# installed SECTION: ON or OFF, for an option of the build.
installed() {
    local missing
    missing=$(missing_packages "$1")
    [ -z "$missing" ] && echo ON || echo OFF
}

# build PRESET [TARGET…]: configures and builds build/PRESET. What is built follows from what is installed, each time
# anew: so a script with a short list neither needs the rest nor takes it out of a folder that had it.
build() {
    local preset=$1
    shift
    local targets=()
    [ $# -eq 0 ] || targets=(--target "$@")
    (cd "$PELAGIC_ROOT" &&
        cmake --preset "$preset" -DPELAGIC_PREVIEW="$(installed preview)" -DPELAGIC_PYTHON="$(installed python)" \
            -DPELAGIC_TESTS="$(installed tests)" -DPELAGIC_BLENDER_TESTS="$(installed blender)" \
            -DPELAGIC_PYTHON_HEADERS="$(find "$PELAGIC_PYTHONS" -mindepth 1 -maxdepth 1 2>/dev/null | sort | paste -sd ';')" &&
        cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}")
}

# in_memory: what this shell's programs write for a while lies in memory, where there is room and programs may lie there: bakes wait
# for the disk at each file.
in_memory() {
    [ "$(df --output=avail --block-size=1M /dev/shm 2>/dev/null | tail -n 1)" -ge 4096 ] 2>/dev/null || return 0
    local memory
    memory=$(mktemp -d /dev/shm/pelagic-tests.XXXXXX) || return 0
    # shellcheck disable=SC2064
    trap "rm -rf '$memory'" EXIT
    if cp /bin/true "$memory/true" && "$memory/true"; then export TMPDIR=$memory; fi
}
