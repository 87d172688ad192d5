#!/usr/bin/env bash
# Builds the benchmarks and prints their tables: stages of a frame, price of sampling, what resolution hides,
# crate against text, a bake. A few minutes.
#   tests/bench/run.sh
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=../../examples/setup.sh
source "$here/../../examples/setup.sh"
install_packages
build release pelagic bench_stages bench_sampling bench_conservation bench_trains bench_crate >/dev/null
bin=$PELAGIC_ROOT/build/release
"$bin/bench/bench_stages"
"$bin/bench/bench_sampling"
"$bin/bench/bench_conservation"
"$bin/bench/bench_trains"
"$bin/bench/bench_crate"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
printf '\nA bake, mesh and two maps, to %s\n  %-8s %-8s %10s %14s\n' "$scratch" quads frames "frames/s" "peak memory"
for quads in 512 1024; do
    for frames in 8 16; do
        cat >"$scratch/shot.toml" <<EOF
[shot]
frames = [1, $frames]
[surface]
size_m = 400.0
resolution = $quads
[output]
maps = ["displacement", "whitecaps"]
map_resolution = $quads
EOF
        /usr/bin/python3 - "$bin/pelagic" "$scratch" "$quads" "$frames" <<'EOF'
import resource, subprocess, sys, time
program, scratch, quads, frames = sys.argv[1:]
start = time.monotonic()
subprocess.run([program, "bake", f"{scratch}/shot.toml", "--out", f"{scratch}/{quads}-{frames}"], check=True,
               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
rate = int(frames) / (time.monotonic() - start)
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
print(f"  {quads:<8} {frames:<8} {rate:10.2f} {peak:10.0f} MiB")
EOF
    done
done
