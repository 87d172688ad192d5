#!/usr/bin/env bash
# Formats every C++ file with clang-format 14, or lists the files that it would change.
#   tests/style/format.sh [--check [PROGRAM]]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
mode=(-i)
[ "${1:-}" != "--check" ] || mode=(--dry-run -Werror)
find core plugin tests examples -name node_modules -prune -o \( -name '*.cpp' -o -name '*.h' -o -name '*.inl' \) -print0 |
    xargs -0 "${2:-clang-format-14}" "${mode[@]}"
