# Completion for bash: what the program's own help says, so that a new option is completed as soon as it is there.

_pelagic() {
    local cur prev words cword split
    _init_completion -s || return
    if [ "$cword" -eq 1 ]; then
        local verbs
        verbs=$("$1" --help 2>/dev/null | sed -n '/^Verbs:/,/^$/s/^  \([a-z]\+\) .*/\1/p')
        mapfile -t COMPREPLY < <(compgen -W "$verbs --help --version" -- "$cur")
        return
    fi
    case $prev in
    --out | --status) _filedir -d && return ;;
    --ocio) _filedir && return ;;
    esac
    $split && return
    if [[ $cur == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_parse_help "$1" "${words[1]} --help")" -- "$cur")
        return
    fi
    case ${words[1]} in
    verify) _filedir -d ;;
    presets) mapfile -t COMPREPLY < <(compgen -W "$("$1" presets 2>/dev/null | sed -n 's/^\([a-z0-9-]\+\)  .*/\1/p')" -- "$cur") ;;
    *) _filedir toml ;;
    esac
} && complete -F _pelagic pelagic
