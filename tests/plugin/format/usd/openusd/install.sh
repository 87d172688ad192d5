#!/bin/sh
# Installs what read-stage.mjs needs into node_modules beside it, as package-lock.json pins it. Does nothing when that
# is already there. Needs npm; the reader itself needs node 18.17 or later and Chromium.
set -eu
cd "$(dirname "$0")"
if ! command -v npm >/dev/null 2>&1; then
    echo "install.sh: npm is missing; on Debian: apt-get install nodejs npm" >&2
    exit 1
fi
# The stamp is written last and holds what was installed, so that a broken-off install is done again.
stamp=node_modules/.installed-lock
if [ -f "$stamp" ] && cmp -s package-lock.json "$stamp"; then
    exit 0
fi
npm ci --no-audit --no-fund --ignore-scripts
cp package-lock.json "$stamp"
