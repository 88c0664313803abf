#!/bin/sh
# Every variant of every shader that the tests of the techniques compiled passes Khronos' own compiler, which knows the language
# and no driver. usage: shaders_test.sh FOLDER SOURCE
set -eu
folder=$1 source=$2
command -v glslangValidator >/dev/null || { echo "SKIPPED: glslangValidator is not installed (scripts/install-deps)"; exit 0; }
cd "$folder"
find . -maxdepth 1 \( -name '*.comp' -o -name '*.vert' -o -name '*.frag' \) >all
# What only one vendor's drivers know, other compilers need not.
xargs -r grep -L '^#extension GL_NV_' <all >list || true  # the status of grep differs by its release
count=$(wc -l <list) failed=0
# One process for many files: each spends a fifth of a second on the built-in functions.
xargs -r glslangValidator <list >log 2>&1 || {
  # A file's name stands before what is wrong with it.
  awk '/^(ERROR|WARNING)/ { if (name) print name; name = ""; print; next } { name = $0 }' log
  failed=$(grep -c 'compilation errors' log) || { tail -n 5 log; failed=1; }
}
# A shader that no test compiles would pass unseen.
for file in $(cd "$source/src" && find gl passes techniques \( -name '*.comp' -o -name '*.vert' -o -name '*.frag' \)); do
  name=$(echo "$file" | tr / .)
  ls "$name".* >/dev/null 2>&1 || { failed=$((failed + 1)); echo "no test has compiled $file"; }
done
echo "$count variants, $failed faults, $(($(wc -l <all) - count)) left out for extensions of NVIDIA"
[ "$count" -gt 0 ] && [ "$failed" = 0 ]
