#!/bin/sh
# What can be known of the Debian packages without building them: every file that `make install` puts into place is in just one
# package, what is built with is what scripts/install-deps installs, and versions agree.
# usage: debian_test.sh SOURCE BUILD
set -eu
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$source"
failed=0
fail() {
  echo "FAILED: $*" >&2
  failed=1
}

# The version of the packages is that of the project.
project=$(sed -n 's/^project(sfumato VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
package=$(sed -n '1s/^sfumato (\(.*\)) .*/\1/p' debian/changelog)
[ "$project" = "$package" ] || fail "debian/changelog has version $package, the project $project"

# What is built with, but for the tools that build packages, is what everybody builds with. (pybind11 and others bring their own.)
sed -n '/^Build-Depends:/,/^[^ ]/s/^ \([a-z0-9.+-]*\).*/\1/p' debian/control | grep -v '^debhelper-compat$\|^dh-python$' | sort >"$work/needs"
sed -n '/^packages="/,/^"/p' scripts/install-deps | tr ' ' '\n' | grep '^[a-z]' | grep -v '^packages=' | sort >"$work/installs"
missing=$(comm -23 "$work/needs" "$work/installs")
[ -z "$missing" ] || fail "debian/control builds with what scripts/install-deps does not install: $(echo "$missing" | tr '\n' ' ')"
# And libraries that are used where they are there are there.
grep -- '-dev$' "$work/installs" | grep -v '^libgtest-dev$\|^libgmock-dev$\|^libbenchmark-dev$' >"$work/libraries"
missing=$(comm -13 "$work/needs" "$work/libraries")
[ -z "$missing" ] || fail "scripts/install-deps installs what debian/control does not build with: $(echo "$missing" | tr '\n' ' ')"
[ "$(wc -l <"$work/needs")" -ge 20 ] || fail "fewer packages to build with than there are: the reader of debian/control is broken"
# What the CMake package asks for comes with libsfumato-dev.
for words in "glm libglm-dev" "TBB libtbb-dev" "Eigen3 libeigen3-dev" "PNG libpng-dev" "JPEG libjpeg62-turbo-dev" "pugixml libpugixml-dev" \
  "nlohmann_json nlohmann-json3-dev" "LASzip liblaszip-dev" "PkgConfig pkgconf" "epoxy libepoxy-dev" "openexr libopenexr-dev" \
  "webp libwebp-dev" "ZLIB zlib1g-dev" "lzf liblzf-dev" "Threads libc6-dev"; do
  echo "$words"
done >"$work/finds"
sed -n 's/^foreach(package IN ITEMS \(.*\))/\1/p; s/^pkg_check_modules(\([a-z]*\) .*/\1/p' cmake/sfumatoConfig.cmake.in | tr ' ' '\n' >"$work/asked"
sed -n '/^Package: libsfumato-dev/,/^Recommends/p' debian/control >"$work/dev"
while read -r name; do
  package=$(sed -n "s/^$name //p" "$work/finds")
  [ -n "$package" ] || fail "tests/scripts/debian_test.sh does not know which package has $name, which sfumatoConfig.cmake asks for"
  [ "$package" = libc6-dev ] || grep -q "^ $package,\$" "$work/dev" || fail "libsfumato-dev does not depend on $package"
done <"$work/asked"

# Every file is in one package, and no line of the lists is in vain.
DESTDIR=$work/tmp cmake --install "$build" --prefix /usr >/dev/null
rm "$work/tmp/usr/share/doc/sfumato/LICENSE"  # debian/rules
# Debian's folders, where this build has others.
[ -d "$work/tmp/usr/lib/sfumato" ] && mkdir "$work/tmp/usr/lib/any" && mv "$work/tmp/usr/lib/sfumato" "$work/tmp/usr/lib/cmake" "$work/tmp/usr/lib/any"
(cd "$work/tmp" && find . -type f | sed 's|^\./||' | sort) >"$work/files"
: >"$work/claims"
for list in debian/*.install; do
  [ "$list" != debian/python3-sfumato.install ] || [ -n "$(find "$work/tmp/usr/lib" -name 'python3*')" ] ||
    { echo "SKIPPED python3-sfumato: the Python package is not built here"; continue; }
  while read -r pattern _; do
    # shellcheck disable=SC2086  # a pattern
    found=$(cd "$work/tmp" && find $pattern -type f 2>/dev/null) || true
    if [ -z "$found" ]; then
      case $pattern in
        *.desktop | *.svg | *mime*)
          if ldd "$build/bin/sfumato" | grep -q glfw; then
            fail "$list: $pattern is not installed"
          else
            echo "SKIPPED $pattern: the command is built without its window"
          fi
          ;;
        *) fail "$list: $pattern is not installed" ;;
      esac
    fi
    echo "$found"
  done <"$list" >"$work/claimed"
  grep -v '^$\|^SKIPPED' "$work/claimed" >>"$work/claims" || true
  grep '^SKIPPED' "$work/claimed" || true
done
sort "$work/claims" >"$work/sorted"
unclaimed=$(comm -23 "$work/files" "$work/sorted")
[ -z "$unclaimed" ] || fail "installed, but in no package: $(echo "$unclaimed" | tr '\n' ' ')"
twice=$(uniq -d "$work/sorted")
[ -z "$twice" ] || fail "in two packages: $(echo "$twice" | tr '\n' ' ')"

# The tests of the packages are programs that parse.
for name in $(sed -n 's/^Tests: //p' debian/tests/control); do
  [ -x "debian/tests/$name" ] || fail "debian/tests/$name is no program"
  sh -n "debian/tests/$name" || fail "debian/tests/$name does not parse"
done
make -n -f debian/rules build >/dev/null || fail "debian/rules does not parse"

# Files for the desktop.
if command -v desktop-file-validate >/dev/null; then
  said=$(desktop-file-validate src/apps/desktop/sfumato.desktop) || fail "sfumato.desktop: $said"
else
  echo "SKIPPED desktop-file-validate: install desktop-file-utils"
fi
/usr/bin/python3 - src/apps/desktop <<'END' || fail "files for the desktop"
import sys
import xml.etree.ElementTree as xml

folder = sys.argv[1]
assert xml.parse(folder + "/sfumato.svg").getroot().tag.endswith("svg")
types = {each.get("type") for each in xml.parse(folder + "/sfumato.xml").getroot()}
with open(folder + "/sfumato.desktop", encoding="utf-8") as file:
    entry = dict(line.rstrip("\n").split("=", 1) for line in file if "=" in line)
assert entry["Icon"] == "sfumato" and entry["Exec"].split()[0] == "sfumato"
# A type that the entry takes and nobody describes would never be opened.
assert set(filter(None, entry["MimeType"].split(";"))) == types, types
END
[ "$failed" = 0 ]
