#!/bin/sh
# The words that docs/glossary.md replaces (its third column) stand nowhere a user or developer reads: pages, CHANGELOG, string
# literals of the sources (help, notes, errors), comments in headers.
# usage: words_test.sh SOURCE_DIR
set -eu
cd "$1"
words=$(awk -F'|' '/^\| / && NR > 8 { print $4 }' docs/glossary.md | tr ',' '\n' | sed 's/^ *//; s/ *$//' | grep -v -e '^$' -e '^-*$' -e '^not$' | tr '\n' '|' | sed 's/|$//')
entries=$(grep -c '^| [A-Za-z]' docs/glossary.md)
[ "$entries" -ge 41 ] || { echo "docs/glossary.md has fewer than 40 entries" >&2; exit 1; }
count=$(echo "$words" | tr '|' '\n' | wc -l)
[ "$count" -ge 15 ] || { echo "the reader of docs/glossary.md finds $count words: it is broken" >&2; exit 1; }
failed=0
found() { # WHAT HITS; in this shell, so that `failed` is kept
  [ -z "$2" ] || { echo "$1:" >&2; echo "$2" | head -40 >&2; failed=1; }
}
pages=$(ls README.md CONTRIBUTING.md CHANGELOG.md SECURITY.md CODE_OF_CONDUCT.md docs/*.md docs/*/*.md .github/*.md .github/*/*.md bench/*.md | grep -v '^docs/glossary.md$')
# shellcheck disable=SC2086  # a list of names
found "in pages" "$(grep -nwiE "$words" $pages || true)"
found "in texts of the program" \
  "$(grep -rnoE '"[^"]*"' src --include='*.cpp' --include='*.h' --include='*.py' | grep -wiE "$words" || true)"
found "in comments of headers" "$(grep -rnE '^ *//' src include --include='*.h' | grep -wiE "$words" || true)"
[ "$failed" = 0 ]
