#!/bin/sh
# Every link from one page of the documentation to a file of the checkout leads somewhere.
# usage: docs_test.sh SOURCE_DIR
set -eu
cd "$1"
broken=0
for page in README.md CONTRIBUTING.md CHANGELOG.md docs/*.md docs/*/*.md bench/*.md bench/*/*.md; do
  [ -f "$page" ] || continue
  # [text](target), without what lies elsewhere and without the place inside the page.
  for link in $(grep -o '](\([^) ]*\))' "$page" | sed 's/^](//; s/)$//; s/#.*//' | grep -v '^[a-z]*:' | sort -u); do
    [ -e "$(dirname "$page")/$link" ] || { echo "$page: no $link" >&2; broken=1; }
  done
done
[ "$broken" = 0 ]
