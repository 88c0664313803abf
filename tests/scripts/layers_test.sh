#!/bin/sh
# Files include what docs/pipeline.md says their layer sees, and nothing above; OpenGL is called in src/gl: layers_test.sh SOURCE
set -eu
cd "$1"
fail() { echo "layers_test: $1" >&2; exit 1; }
sees() { # all layers below one
  for below in $(sed -nE "s/^\| \`src\/$1\` \| ([a-z, -]+) \|.*/\1/p" docs/pipeline.md | tr -d ,-); do
    echo "$below"
    sees "$below"
  done
}
rooms=$(find src -mindepth 1 -maxdepth 1 -type d -printf '%f\n' | sort)
for room in $rooms; do
  grep -q "^| \`src/$room\` |" docs/pipeline.md || fail "docs/pipeline.md has no row for src/$room"
  [ "$room" = apps ] && continue
  allowed=" $room core $(sees "$room" | sort -u | tr '\n' ' ') sfumato "
  # Files of the room's own folder are included by their names alone; io's library is below scene.
  for included in $(grep -rhoE '^#include "[a-z_]+/' "src/$room" --include=*.cpp --include=*.h | sed 's/.*"//; s/\///' | sort -u); do
    case "$allowed" in
      *" $included "*) ;;
      *) fail "src/$room includes src/$included, which docs/pipeline.md does not let it see" ;;
    esac
  done
done
if grep -rnE '\bgl[A-Z][A-Za-z0-9]*\(' src --include=*.cpp --include=*.h | grep -v '^src/gl/'; then
  fail "src outside src/gl calls OpenGL: gl/commands.h and gl/draw.h do"
fi
if grep -rnE '#include "(\.\./)*apps|#include "\.\./(cli|viewer)' src/view src/session; then fail "a library includes a front end"; fi
for front_end in viewer serve publish picture; do
  [ -d "src/apps/$front_end" ] || fail "there is no src/apps/$front_end"
  if grep -rnE '#include "(\.\./|apps/)cli/' "src/apps/$front_end"; then fail "src/apps/$front_end includes the command"; fi
done
