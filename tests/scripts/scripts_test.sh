#!/bin/sh
# The shell scripts parse, and install-deps does what it promises. Every program that could reach the network or
# change the system is a stub here; each stub notes that it was called.
# usage: scripts_test.sh SOURCE_DIR
set -eu
source_dir=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
calls=$work/calls

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

stub() { # NAME BODY
  rm -f "$work/bin/$1"
  printf '#!/bin/sh\necho "%s $*" >>"%s"\n%s\n' "$1" "$calls" "$2" >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}

# Only stubs and a few harmless tools are on the PATH, so sudo is absent whatever the machine has.
fresh_machine() { # MISSING_PACKAGE USER_ID
  rm -rf "${work:?}/bin"
  mkdir "$work/bin"
  : >"$calls"
  for tool in sh env head; do ln -s "$(command -v $tool)" "$work/bin/$tool"; done
  stub dpkg-query "for last; do :; done; [ \"\$last\" = '$1' ] || printf installed"
  stub id "echo $2"
  # shellcheck disable=SC2016  # expanded by the stub
  stub apt-get 'case "$*" in *indextargets*) echo http://mirror.example/debian/ ;; esac'
  stub apt-cache 'exit 100' # knows no package
  # shellcheck disable=SC2016
  stub tee 'while read -r line; do echo "$1: $line"; done >>'"$work/written"
  : >"$work/written"
}

install_deps() { PATH=$work/bin "$source_dir/scripts/install-deps" >"$work/output" 2>&1; }

for script in demo test $(cd "$source_dir" && grep -l '^#!/bin/sh' scripts/*); do
  sh -n "$source_dir/$script" || fail "$script does not parse"
  [ -x "$source_dir/$script" ] || fail "$script is not executable"
done

# Nothing missing: no root, no network, not a word.
fresh_machine none 1000
install_deps || fail "exit code $? with nothing missing"
if grep -q -E 'apt|tee' "$calls" || [ -s "$work/output" ]; then fail "did something with nothing missing"; fi

# Missing, neither root nor sudo: a clear line, nothing called.
fresh_machine liblzf-dev 1000
if install_deps; then fail "succeeded without root"; fi
grep -q 'missing packages: liblzf-dev$' "$work/output" || fail "did not name the package"
grep -q 'as root' "$work/output" || fail "did not say what to do"
if grep -q apt "$calls"; then fail "called apt without root"; fi

# With sudo it goes through sudo.
# shellcheck disable=SC2016
stub sudo 'exec "$@"'
install_deps || fail "exit code $? with sudo"
grep -q '^sudo .*apt-get .*install .* liblzf-dev$' "$calls" || fail "did not install through sudo"

# Root: exactly what is missing is installed, and no source is added for it.
fresh_machine liblzf-dev 0
install_deps || fail "exit code $? as root"
grep -q '^apt-get .*install -y --no-install-recommends liblzf-dev$' "$calls" || fail "did not install the package"
[ ! -s "$work/written" ] || fail "added a source for a package that needs none"

# LASzip on Debian 12: the next release from apt's own mirror, with everything else of it pinned away.
if grep -q '^VERSION_CODENAME=bookworm' /etc/os-release; then
  fresh_machine liblaszip-dev 0
  install_deps || fail "exit code $? for LASzip"
  for wanted in 'sources: URIs: http://mirror.example/debian/' 'sources: Suites: trixie' 'trixie: Package: \*$' \
    'trixie: Pin-Priority: -1$' 'trixie: Package: liblaszip-dev liblaszip8 liblaszip-api8$'; do
    grep -q "$wanted" "$work/written" || fail "did not write '$wanted'"
  done
  grep -q 'adding the source http://mirror.example/debian/ trixie' "$work/output" || fail "did not name the source"
else
  echo "SKIPPED: the LASzip source is for Debian 12"
fi
# ./demo says what is wrong, and what it is for, before anything is installed or built.
fresh_machine liblzf-dev 1000
for tool in cat dirname; do ln -sf "$(command -v $tool)" "$work/bin/$tool"; done
demo() { (cd "$work" && PATH=$work/bin "$source_dir/demo" "$@") >"$work/output" 2>&1; }
demo --help || fail "demo --help"
grep -q '^usage: ./demo' "$work/output" || fail "demo --help does not say how it is used"
if demo "my scan.laz"; then fail "demo took a missing file"; fi
grep -q '^demo: my scan.laz: there is no such file' "$work/output" || fail "demo does not name the missing file"
if demo a b; then fail "demo took two files"; fi
if [ -s "$calls" ]; then fail "demo asked for packages before it looked at its arguments"; fi
# A name with blanks, relative to where the user stands, reaches the build.
fresh_machine none 1000
for tool in cat dirname; do ln -sf "$(command -v $tool)" "$work/bin/$tool"; done
# shellcheck disable=SC2016
stub make 'echo "FILE=$FILE"'
: >"$work/my scan.laz"
demo "my scan.laz" || fail "demo with a blank in the name"
grep -q "^FILE=$work/my scan.laz" "$work/output" || fail "demo does not pass on a relative name with a blank"

# What containers do without goes, in the named root only; licences stay.
root=$work/root
mkdir -p "$root/usr/share/doc/libx" "$root/usr/share/man/man1" "$root/usr/lib/any/gconv" "$root/var/lib/apt/lists/x"
touch "$root/usr/share/doc/libx/copyright" "$root/usr/share/doc/libx/README"
"$source_dir/scripts/slim" "$root" || fail "slim"
[ -z "$(find "$root" -name 'README' -o -name man1 -o -name gconv -o -name x)" ] || fail "slim left what no container needs"
[ -e "$root/usr/share/doc/libx/copyright" ] || fail "slim removed a licence"
if "$source_dir/scripts/slim" 2>/dev/null; then fail "slim without a root"; fi

echo "all scripts keep their promises"

# What was installed can be taken away again, and nothing else.
copy=$work/checkout
mkdir -p "$copy/build/release" "$copy/prefix/include/sfumato/layers" "$copy/prefix/include/others" "$copy/prefix/bin"
cp "$source_dir/Makefile" "$copy"
touch "$copy/prefix/bin/sfumato" "$copy/prefix/include/sfumato/layers/a.h" "$copy/prefix/bin/another"
printf '%s\n%s' "$copy/prefix/bin/sfumato" "$copy/prefix/include/sfumato/layers/a.h" >"$copy/build/release/install_manifest.txt"
make -C "$copy" uninstall >/dev/null || fail "make uninstall"
[ ! -e "$copy/prefix/bin/sfumato" ] || fail "make uninstall left the command"
[ ! -e "$copy/prefix/include/sfumato" ] || fail "make uninstall left a folder of ours"
[ -e "$copy/prefix/bin/another" ] && [ -e "$copy/prefix/include/others" ] || fail "make uninstall took what is not ours"
make -C "$copy" clean >/dev/null || fail "make clean"
[ ! -e "$copy/build" ] || fail "make clean left build/"
if make -C "$copy" uninstall >/dev/null 2>"$work/output"; then fail "make uninstall without an installation"; fi
grep -q 'nothing was installed' "$work/output" || fail "did not say why"
make -C "$copy" help | grep -q '^  uninstall' || fail "make help does not know uninstall"

# What follows commits.
command -v git >/dev/null || { echo "SKIPPED: scripts/release needs git"; exit 0; }

# A release: refuses what does not agree, and packs what was committed, with the notes of its version.
checkout=$work/release
mkdir -p "$checkout/scripts" "$checkout/debian"
cp "$source_dir/scripts/release" "$checkout/scripts"
printf 'cmake_minimum_required(VERSION 3.25)\nproject(sfumato VERSION 2.3.4 LANGUAGES NONE)\n' >"$checkout/CMakeLists.txt"
printf '{"version": 6, "configurePresets": [{"name": "release", "generator": "Ninja", "binaryDir": "build"}]}' >"$checkout/CMakePresets.json"
printf 'sfumato (2.3.4) unstable; urgency=medium\n' >"$checkout/debian/changelog"
printf 'version: 2.3.4\n' >"$checkout/CITATION.cff"
printf '# Changes\n\n## Unreleased\n\n- waits\n\n## 2.3.4\n\n- new\n\n## 2.3.3\n\n- old\n' >"$checkout/CHANGELOG.md"
echo /build/ >"$checkout/.gitignore"
in_checkout() { git -C "$checkout" -c user.name=test -c user.email=test@example.org "$@" >/dev/null; }
in_checkout init -q && in_checkout add -A && in_checkout commit -q -m first
release() { CHECKS=none "$checkout/scripts/release" "$@" >"$work/output" 2>&1; }
if release; then fail "release without a version"; fi
if release 2.3.5; then fail "release of another version"; fi
grep -q 'CMakeLists.txt has version 2.3.4' "$work/output" || fail "release does not say which version there is"
if release 2.3.4; then fail "release with unreleased lines"; fi
grep -q 'lines under Unreleased' "$work/output" || fail "release does not say what waits"
sed -i '/waits/d' "$checkout/CHANGELOG.md"
if release 2.3.4; then fail "release of changes that are not committed"; fi
in_checkout commit -q -a -m second
release 2.3.4 || { cat "$work/output" >&2; fail "release"; }
out=$checkout/build/release-2.3.4
[ "$(cat "$out/notes.md")" = "- new" ] || fail "the notes of the release"
(cd "$out" && sha256sum -c --quiet SHA256SUMS) || fail "the checksums of the release"
tar -tzf "$out/sfumato-2.3.4.tar.gz" | grep -qx 'sfumato-2.3.4/CHANGELOG.md' || fail "the tarball of the release"
