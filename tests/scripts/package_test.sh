#!/bin/sh
# Installs a built tree into a folder of its own and builds an example there with find_package(sfumato).
# usage: package_test.sh SOURCE BUILD
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cp -r "$source/examples" "$work/examples"  # nothing of the checkout is in reach
(cd "$work/prefix/include" && find sfumato -name '*.h' -printf '#include <%p>\n') >>"$work/examples/depth_of_points.cpp"
cmake -G Ninja -S "$work/examples" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/build" --target example_depth_of_points
"$work/build/example_depth_of_points"
"$work/prefix/bin/sfumato" --version
for file in share/man/man1/sfumato.1 share/bash-completion/completions/sfumato share/zsh/site-functions/_sfumato \
  share/fish/vendor_completions.d/sfumato.fish share/doc/sfumato/LICENSE share/doc/sfumato/docs/command.md; do
  [ -s "$work/prefix/$file" ] || { echo "not installed: $file" >&2; exit 1; }
done
if grep -rq --include='*.cmake' "$source" "$work/prefix"; then
  echo "the package names the folder it was built from" >&2
  exit 1
fi
