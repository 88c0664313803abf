#!/bin/sh
# Whether the files of each target compile as one, whatever `make` puts together: parsed only, without code.
# usage: unity_test.sh SOURCE FOLDER COMPILER
set -eu
source=$1 folder=$2 compiler=$3
mkdir -p "$folder"
cat >"$folder/parse" <<'END'
#!/bin/sh
# A compiler launcher: the object is empty.
"$@" -fsyntax-only || exit 1
while [ "$1" != -o ]; do shift; done
: >"$2"
END
chmod +x "$folder/parse"
cmake -G Ninja -S "$source" -B "$folder" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_COMPILER_LAUNCHER="$folder/parse" \
  -DSFUMATO_UNITY=ON -DSFUMATO_UNITY_FILES=0 -DSFUMATO_TESTS=OFF -DSFUMATO_BENCH=OFF -DSFUMATO_PYTHON=OFF >/dev/null
units=$(ninja -C "$folder" -t targets all | sed -n 's|^\(src/.*/Unity/[^:]*\.o\): .*|\1|p')
[ "$(echo "$units" | wc -l)" -ge 12 ] || { echo "too few units: $units" >&2; exit 1; }
# One at a time: ctest keeps the other processors busy.
# shellcheck disable=SC2086  # a list of names
ninja -C "$folder" -j 1 -k 0 $units >"$folder/log" || {
  grep -E 'error|note' "$folder/log" || cat "$folder/log"
  echo "two files of one target (src/techniques: of one folder) clash; give one of the names a more telling one" >&2
  exit 1
}
