#!/usr/bin/env bash
# Builds Debian's oneTBB with the thread sanitizer, into build/tsan/onetbb/lib, from where the tests of the preset tsan load it.
# Debian's own is built without: the sanitizer doesn't see how it hands a task from one thread to another, and finds races
# in every loop that aren't there. Takes the source from Debian's archive, and a minute on two cores; does nothing where the
# installed version has been built already.
#   tests/sanitizers/onetbb.sh
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
version=$(dpkg-query -W -f='${Version}' libtbb-dev)
folder=$root/build/tsan/onetbb
# The stamp is written last, so that a broken-off build is done again.
[ "$(cat "$folder/version" 2>/dev/null)" != "$version" ] || exit 0
rm -rf "$folder"
mkdir -p "$folder/apt/lists/partial" "$folder/lib"
cd "$folder"

# The archive that Debian's packages come from, asked for sources: with lists of our own, since a machine rarely has them.
mkdir apt/parts
touch apt/sources.list
[ ! -f /etc/apt/sources.list ] || sed -n 's/^deb /deb-src /p' /etc/apt/sources.list >apt/sources.list
[ ! -f /etc/apt/sources.list.d/debian.sources ] ||
    sed 's/^Types:.*/Types: deb-src/' /etc/apt/sources.list.d/debian.sources >apt/parts/debian.sources
apt=(apt-get -q -o "Dir::Etc::sourcelist=$folder/apt/sources.list" -o "Dir::Etc::sourceparts=$folder/apt/parts"
    -o "Dir::State::lists=$folder/apt/lists" -o "Dir::Cache=$folder/apt" -o APT::Sandbox::User=)
"${apt[@]}" update
"${apt[@]}" source "onetbb=$version" || {
    echo "onetbb.sh: the archive has no source of onetbb $version" >&2
    exit 1
}

cmake -S onetbb-*/ -B built -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=/usr/bin/c++ \
    -DTBB_SANITIZE=thread -DTBB_TEST=OFF -DTBB_STRICT=OFF
cmake --build built --parallel "$(nproc)" --target tbb
cp -P built/*/libtbb.so* lib/
rm -rf apt built onetbb*
echo "$version" >version
