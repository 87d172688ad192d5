#!/usr/bin/env bash
# Manual pages from the program's own help: pelagic.1, and pelagic-VERB.1 for each verb that it names.
#   packages/man.sh PROGRAM FOLDER
set -euo pipefail
program=$1 folder=$2
mkdir -p "$folder"
# Help of somebody else's language or width would be another page.
export LC_ALL=C COLUMNS=100
version=$("$program" --version | sed -n 1p)
# page NAME [VERB]
page() {
    local summary
    summary=$("$program" ${2:+"$2"} --help | sed -n 1p)
    summary=${summary#Pelagic } && summary=${summary%.}
    # A page's name has no blank: that is how man and whatis look for it.
    help2man --no-info --version-string="${version#pelagic }" --name="${summary,}" --manual="Pelagic" --source="$version" "$program${2:+ $2}" </dev/null |
        sed -E "s/^$(basename "$program")( ([a-z]+))? +\\\\- /$1 \\\\- /; s/^\.TH [^ ]+( [A-Z]+)?\"? /.TH ${1^^} /" >"$folder/$1.1"
}
page pelagic
"$program" --help | sed -n '/^Verbs:/,/^$/s/^  \([a-z]\+\) .*/\1/p' | while read -r verb; do
    page "pelagic-$verb" "$verb"
done
