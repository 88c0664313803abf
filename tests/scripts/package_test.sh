#!/bin/sh
# Installs a built tree into a folder of its own and builds an example there with find_package(sfumato).
# usage: package_test.sh SOURCE BUILD
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cp -r "$source/examples" "$work/examples"  # nothing of the checkout is in reach
cmake -G Ninja -S "$work/examples" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/build" --target example_depth_of_points
"$work/build/example_depth_of_points"
"$work/prefix/bin/sfumato" --version
if grep -rq --include='*.cmake' "$source" "$work/prefix"; then
  echo "the package names the folder it was built from" >&2
  exit 1
fi
