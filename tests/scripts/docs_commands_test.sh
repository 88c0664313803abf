#!/bin/sh
# Every command in a code block of the documentation, and in `sfumato help`, runs: on scenes made here, with small
# pictures. Lines with words in capitals (FILE, TECHNIQUE) show a form and are not run.
# usage: docs_commands_test.sh SOURCE_DIR SFUMATO
set -eu
cd "$1"
source_dir=$PWD
sfumato=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Scenes with the names that the pages use.
mkdir -p "$work/bin" "$work/scene/scans" "$work/scene/pictures"
ln -s "$sfumato" "$work/bin/sfumato"
PATH=$work/bin:$PATH
export PATH SFUMATO_CONFIG=
cd "$work/scene"
sfumato synth courtyard --points 6k -o scan.ply --quiet
sfumato convert scan.ply -o scan.las --quiet
sfumato convert scan.ply -o scan.laz --quiet
for name in a b before after city dense street forest; do cp scan.laz "$name.laz"; done
sfumato convert scan.ply --show-classes 2,3,5,6 -o city.laz --quiet  # four classes
cp scan.laz scans/one.laz
cp scan.laz scans/two.laz
# The column `confidence` of scan.ply, and others that pages speak of.
sfumato convert scan.ply -o columns.csv --quiet
sed '1s/scanner/confidence/' columns.csv >named.csv
cut -d , -f 1-3 columns.csv | tail -n +2 | tr , ' ' >scan.xyz
sfumato convert named.csv -o scan.ply --quiet
{ # a scanner over a floor: columns, rows, its place and axes, the pose, then a point and its intensity each
  printf '60\n60\n0 0 2\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 2 1\n'
  awk 'BEGIN { for (c = 0; c < 60; c++) for (r = 0; r < 60; r++) print (c - 30) / 5, (r - 30) / 5, -2 + (c % 7) / 99, 0.5 }'
} >scan.ptx
for name in tower hull engine mesh frame_0 frame_1 frame_2; do cp scan.ply "$name.ply"; done
sfumato scan.ply --output-camera camera.json --save-preset look.json -t points -o x.png --resolution 32x24 --quiet
cp camera.json C.json
printf '{"cameras": [%s, %s]}' "$(cat camera.json)" "$(cat camera.json)" >path.json
printf '{"options": {"resolution": "48x24"}}' >config.json
export SFUMATO_CONFIG=$work/scene/config.json

# What stands in code blocks, fenced or indented, without its explanation (behind two blanks or #).
commands_of() {
  awk '
    /^```/ { fence = !fence; next }
    fence || /^    / {
      line = $0
      sub(/^ +/, "", line); sub(/^\$ /, "", line)
      if (line !~ /^(sfumato|\.\/sfumato|cat [a-z.]+ \| sfumato) /) next
      sub(/^\.\//, "", line)
      sub(/  .*/, "", line); sub(/ +# .*/, "", line)
      if (line ~ /(^|[ \[=<])[A-Z][A-Z]+(_[a-z{}]*)?(\.[A-Za-z]+)?($|[ .,\]])/ || line ~ /\.\.\.( |$)/) { print "FORM " line; next }
      print "RUN " line
    }' "$1"
}

ran=0 forms=0 failed=0
try() { # PAGE COMMAND
  ran=$((ran + 1))
  if ! sh -c "$2 --quiet" >"$work/out" 2>"$work/err" </dev/null; then
    # Commands without work to do know no --quiet.
    if ! grep -q 'unknown option --quiet' "$work/err" || ! sh -c "$2" >"$work/out" 2>"$work/err" </dev/null; then
      echo "$1: $2" >&2
      sed 's/^/    /' "$work/err" >&2
      failed=$((failed + 1))
    fi
  fi
}

pages() {
  (cd "$source_dir" && ls README.md CONTRIBUTING.md docs/*.md docs/techniques/*.md)
  sfumato help presets >/dev/null && echo help
}
for page in $(pages); do
  if [ "$page" = help ]; then
    COLUMNS=120 sfumato help | sed -n 's/^  \(sfumato .*\)/    \1/p' >"$work/page"
    for topic in views selections colours batches presets; do
      COLUMNS=120 sfumato help $topic | sed -n 's/^  \(sfumato .*\)/    \1/p' >>"$work/page"
    done
  else
    cp "$source_dir/$page" "$work/page"
  fi
  commands_of "$work/page" >"$work/lines"
  while read -r kind command <&3; do
    if [ "$kind" = FORM ]; then forms=$((forms + 1)); else try "$page" "$command"; fi
  done 3<"$work/lines"
done
echo "$ran commands ran, $forms forms were passed over, $failed failed"
[ "$ran" -ge 40 ] || { echo "fewer commands than the pages have: the reader of pages is broken" >&2; exit 1; }
[ "$failed" = 0 ]
