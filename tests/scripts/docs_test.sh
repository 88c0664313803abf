#!/bin/sh
# Every link from one page of the documentation to a file of the checkout, and to a heading in it, leads somewhere; every picture
# of docs/images is shown on a page; every technique has its page, a row in the README and rows in the benchmarks (its reference picture: golden_test).
# usage: docs_test.sh SOURCE_DIR
set -eu
cd "$1"
broken=0
for page in README.md CONTRIBUTING.md CHANGELOG.md SECURITY.md CODE_OF_CONDUCT.md docs/*.md docs/*/*.md bench/*.md bench/*/*.md; do
  [ -f "$page" ] || continue
  # [text](target), without what lies elsewhere and without the place inside the page.
  for link in $(grep -o '](\([^) ]*\))' "$page" | sed 's/^](//; s/)$//; s/#.*//' | grep -v '^[a-z]*:' | sort -u); do
    [ -e "$(dirname "$page")/$link" ] || { echo "$page: no $link" >&2; broken=1; }
  done
  # Places inside a page: headings as the forges make anchors of them.
  for link in $(grep -o '](\([^) ]*\.md\)\{0,1\}#[^) ]*)' "$page" | sed 's/^](//; s/)$//' | grep -v '^[a-z]*:' | sort -u); do
    target=${link%%#*} anchor=${link#*#}
    file=$page
    [ -z "$target" ] || file=$(dirname "$page")/$target
    [ -f "$file" ] || continue
    grep '^##* ' "$file" | sed 's/^#* *//' | tr 'A-Z' 'a-z' | sed "s/[^a-z0-9 _-]//g; s/ /-/g" | grep -qx -- "$anchor" ||
      { echo "$page: no heading for $link" >&2; broken=1; }
  done
done
for picture in docs/images/*.jpg docs/images/*.png docs/images/*.webp; do
  grep -q "images/$(basename "$picture")" README.md docs/*.md docs/*/*.md || { echo "no page shows $picture" >&2; broken=1; }
done
# A page begins with what it is for, a picture and its commands, then come the details.
for page in docs/*.md docs/techniques/*.md; do
  case $page in docs/glossary.md | docs/stability.md) continue ;; esac
  awk '
    /^##/ { exit }
    /^# / { next }
    !picture && /^[A-Za-z`*]/ && length > 40 { purpose = 1 }
    /^!\[/ { picture = 1 }
    /^    [a-z.]/ || /^```/ { code = 1 }
    END { exit !(purpose && picture && code) }' "$page" || { echo "$page does not begin with its purpose, a picture and commands" >&2; broken=1; }
done
# Targets of make, scripts and presets that pages and the forge's workflows name exist.
named=$(grep -rhoE '(^|[`( &])make [a-z][a-z-]+' README.md CONTRIBUTING.md SECURITY.md docs .github --include=*.md --include=*.yml | sed 's/.*make //' | sort -u)
for target in $named; do
  grep -qE "^$target:" Makefile || case $target in cmake | it) ;; *) echo "no target of make: $target" >&2; broken=1 ;; esac
done
for script in $(grep -rhoE --include=*.md --include=*.yml '(tests/)?scripts/[a-z_.-]*[a-z]' README.md CONTRIBUTING.md SECURITY.md docs .github | sort -u); do
  [ -e "$script" ] || { echo "no $script" >&2; broken=1; }
done
for preset in $(grep -rhoE --include=*.md -e '--preset [a-z]+( |`|$)' CONTRIBUTING.md docs | sed 's/.*--preset //; s/`//' | sort -u); do
  grep -q "\"name\": \"$preset\"" CMakePresets.json || { echo "no preset $preset" >&2; broken=1; }
done
for folder in src/techniques/*/; do
  name=$(basename "$folder")
  [ -f "docs/techniques/$name.md" ] || { echo "technique $name: no page docs/techniques/$name.md" >&2; broken=1; }
  grep -q "^| \`$name\`" README.md || { echo "technique $name: no row in the table of README.md" >&2; broken=1; }
  [ -f "bench/$name.json" ] || { echo "technique $name: no rows bench/$name.json" >&2; broken=1; }
done
# Few enough words to be read: decisions and measurements stand apart.
words=$(cat README.md CHANGELOG.md docs/*.md docs/techniques/*.md | wc -w)
[ "$words" -le 25000 ] || { echo "the pages have $words words; 25000 at most: say it once, and move figures to docs/measurements" >&2; broken=1; }
[ "$broken" = 0 ]
