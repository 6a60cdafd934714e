# SPDX-License-Identifier: MIT
# bash completion of pmesh. Asks the program for its commands, options and
# choices, so there is no list here to fall behind.
# shellcheck shell=bash

# Options of a command, one a line: --name, and its choices behind a blank.
_pmesh_options() {
    "$1" "$2" -h 2>/dev/null | sed -n -E \
        's/^ {2,6}(-[a-zA-Z], )?(--[a-z0-9-]+)( ([a-z0-9|]+\|[a-z0-9|]+))?.*/\2 \4/p'
}

_pmesh() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
    local command=${COMP_WORDS[1]} words
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ] || [ "$before" = help ]; then
        words=$("$1" help 2>/dev/null |
            sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
    else
        words=$(_pmesh_options "$1" "$command" |
            sed -n "s/^$before \(..*\)/\1/p" | tr '|' ' ')
        if [ -z "$words" ] && [[ $word == -* ]]; then
            words=$(_pmesh_options "$1" "$command" | cut -d ' ' -f 1)
        fi
    fi
    if [ -n "$words" ]; then
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    else
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
    fi
}

complete -F _pmesh pmesh
