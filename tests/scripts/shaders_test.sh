#!/bin/sh
# Every variant of every shader that the tests of the techniques compiled passes Khronos' own compiler, which knows the language
# and no driver. usage: shaders_test.sh FOLDER SOURCE
set -eu
folder=$1 source=$2
command -v glslangValidator >/dev/null || { echo "SKIPPED: glslangValidator is not installed (scripts/install-deps)"; exit 0; }
count=0 failed=0 others=0
for shader in "$folder"/*.comp "$folder"/*.vert "$folder"/*.frag; do
  [ -e "$shader" ] || continue
  # What only one vendor's drivers know, other compilers need not.
  if grep -q '^#extension GL_NV_' "$shader"; then others=$((others + 1)); continue; fi
  count=$((count + 1))
  glslangValidator "$shader" >"$folder/log" 2>&1 || { failed=$((failed + 1)); cat "$folder/log"; }
done
# A shader that no test compiles would pass unseen.
for file in $(cd "$source/src" && find gl passes techniques \( -name '*.comp' -o -name '*.vert' -o -name '*.frag' \)); do
  name=$(echo "$file" | tr / .)
  ls "$folder/$name".* >/dev/null 2>&1 || { failed=$((failed + 1)); echo "no test has compiled $file"; }
done
echo "$count variants, $failed faults, $others left out for extensions of NVIDIA"
[ "$count" -gt 0 ] && [ "$failed" = 0 ]
