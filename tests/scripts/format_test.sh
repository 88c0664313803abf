#!/bin/sh
# C++ is laid out by .clang-format (make format) in lines of at most 110 columns. usage: format_test.sh SOURCE
set -eu
cd "$1"
files=$(find src include bench examples tests -name '*.cpp' -o -name '*.h')
# Raw strings of tests hold whole lines of files.
long=$(find src include bench examples \( -name '*.cpp' -o -name '*.h' \) -exec env LC_ALL=C.UTF-8 grep -nE '^.{111,}' {} + || true)
[ -z "$long" ] || { echo "$long"; echo "lines of more than 110 columns (make format)"; exit 1; }
# Each version lays out a little differently: ours is that of Debian 12.
version=$(clang-format --version 2>/dev/null | sed -n 's/.*version \([0-9]*\).*/\1/p')
[ "$version" = 14 ] || { echo "SKIPPED: clang-format 14 is not installed (it is ${version:-absent}); lines are short enough"; exit 0; }
# shellcheck disable=SC2086  # no blanks in names
found=$(clang-format --dry-run -Werror $files 2>&1 | grep 'error:' | head -20 || true)
[ -z "$found" ] || { echo "$found"; echo "laid out differently (make format)"; exit 1; }
echo "$(echo "$files" | wc -l) files are laid out by .clang-format"
