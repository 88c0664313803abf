#!/bin/sh
# Every option that the documentation names is in some --help, and every option of `sfumato --help all` and of the commands is in
# the documentation. Parameters of techniques are listed by `sfumato techniques`; pages need not repeat them.
# usage: docs_options_test.sh SOURCE_DIR SFUMATO
set -eu
cd "$1"
sfumato=$2
export SFUMATO_CONFIG=
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Written as options, and parameters in code style, `light_size`.
options() { grep -oE -- '(^|[^a-zA-Z0-9-])--[a-z][a-z0-9_-]*' | sed 's/^[^-]*//; s/-$//' | sort -u; }
parameters() { grep -oE '`[a-z][a-z0-9_]*`' | tr -d '`' | sed 's/^/--/; s/_/-/g' | sort -u; }

{
  "$sfumato" --help all
  for command in info convert build publish synth techniques formats doctor completion; do "$sfumato" $command --help; done
  if "$sfumato" help | grep -q "^ *serve "; then "$sfumato" serve --help; else printf -- '--port\n--bind\n--host\n--open\n--share\n--clients\n--selections\n'; fi
} | options >"$work/main"
{
  cat "$work/main"
  for name in src/techniques/*/; do "$sfumato" techniques "$(basename "$name")"; done | options
  printf -- '--version\n--help\n'
} | sort -u >"$work/help"

# Other programs' options, each with the program that has it.
cat >"$work/others" <<'END'
--build cmake
--depth git
--device docker
--gtest_filter gtest
--no-build-isolation pip
--no-install-recommends apt
--install wsl
--all install-deps
--laszip-source install-deps
--paraview install-deps
--part eval
--preset cmake
--quick eval
--choose eval
--rm docker
--target cmake
--test-dir ctest
END
pages="README.md CONTRIBUTING.md CHANGELOG.md $(find docs -name '*.md')"
# shellcheck disable=SC2086  # a list of names
cat $pages | options >"$work/named"
# shellcheck disable=SC2086
cat $pages | parameters | cat - "$work/named" | sort -u >"$work/said"
failed=0
while read -r option; do
  grep -qx -- "$option" "$work/help" && continue
  grep -q -- "^$option " "$work/others" && continue
  # --no-NAME switches NAME off; --technique.parameter reaches one.
  positive=--${option#--no-}
  grep -qx -- "$positive" "$work/help" && continue
  case $option in --cluster | --camera | --no | --parameter | --technique | --your-parameter | --io | --analysis | --finish) continue ;; esac
  # shellcheck disable=SC2086
  echo "no --help has $option: $(grep -l -- "$option" $pages | tr '\n' ' ')" >&2
  failed=1
done <"$work/named"
while read -r option; do
  grep -qx -- "$option" "$work/said" && continue
  echo "no page names $option" >&2
  failed=1
done <"$work/main"
count=$(wc -l <"$work/named")
[ "$count" -ge 100 ] || { echo "only $count options are named: the reader is broken" >&2; exit 1; }
[ "$failed" = 0 ]
