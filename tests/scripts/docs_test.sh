#!/bin/sh
# Every link from one page of the documentation to a file of the checkout leads somewhere, and every technique has its
# page, a row in the README and rows in the benchmarks (its reference picture: golden_test).
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
for folder in src/techniques/*/; do
  name=$(basename "$folder")
  [ -f "docs/techniques/$name.md" ] || { echo "technique $name: no page docs/techniques/$name.md" >&2; broken=1; }
  grep -q "^| \`$name\`" README.md || { echo "technique $name: no row in the table of README.md" >&2; broken=1; }
  [ -f "bench/$name.json" ] || { echo "technique $name: no rows bench/$name.json" >&2; broken=1; }
done
[ "$broken" = 0 ]
