# SPDX-License-Identifier: MIT
# Sourced by tests/*/run.sh: `suite` is its name. Makes the scratch folder $dir.
# shellcheck shell=sh
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
passed=0
failed=0

# try NAME [COMMAND...]: one test; without a command NAME is the command.
try() {
    label=$*
    [ $# -eq 1 ] || shift
    if "$@" >"$dir/log" 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "$suite: $label failed"
        head -n 20 "$dir/log"
    fi
}

# The last line of a suite, and its exit status.
summary() {
    echo "$passed passed, $failed failed"
    [ "$failed" = 0 ]
}
