#!/usr/bin/env bash
# The files of --instruction-set sse4 and avx2 against those of emulated CPUs that have no more: equal, byte by byte.
#   tests/farm/older_cpus.sh
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../../examples/setup.sh
source "$here/../../examples/setup.sh"
install_packages program emulator
build release pelagic
program=$PELAGIC_ROOT/build/release/pelagic
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >small.toml <<'TOML'
[shot]
name = "small"
frames = [1, 2]
[waves]
second_order = 1
cascades = [{ size_m = 200, resolution = 192 }, { size_m = 23, resolution = 64 }]
[surface]
size_m = 20
resolution = 32
[output]
maps = ["displacement", "slope-variance", "whitecaps"]
map_resolution = 64
TOML
differing=0
# A CPU without AES, of which Highway says less; one of AVX alone, which FFTW would use; one of AVX2.
for cpu in Nehalem:sse4 SandyBridge:sse4 Haswell:avx2; do
    set=${cpu#*:} cpu=${cpu%:*}
    for verb in bake render; do
        options=(small.toml)
        [ $verb = bake ] || options+=(--size 64x36 --samples 1)
        "$program" $verb "${options[@]}" --out "$set.$verb" --instruction-set "$set" >/dev/null
        qemu-x86_64 -cpu $cpu "$program" $verb "${options[@]}" --out "$cpu.$verb" --threads 1
        if diff -r "$set.$verb" "$cpu.$verb"; then
            echo "$verb: an emulated $cpu makes the bytes of --instruction-set $set"
        else
            differing=$((differing + 1))
        fi
    done
done
exit $((differing > 0))
