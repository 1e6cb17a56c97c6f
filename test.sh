#!/usr/bin/env bash
# Installs what the tests need, builds, runs every test. `./test.sh --long [--shard k/n]` runs the long
# statistical suites instead, `./test.sh --fuzz MINUTES [TARGET...]` fuzzes every reader for so long, two at a
# time. Shows how far it is, details only when something fails; can be run again at any time.
set -euo pipefail
cd "$(dirname "$0")"
select=(-LE long)
options=()
while [ $# -gt 0 ]; do
  case $1 in
    --long) select=(-L long) options=(-DABBE_LONG_TESTS=ON) ;;
    --fuzz)
      shift
      ./setup/install setup/build_packages setup/test_packages setup/fuzz_packages
      exec ./setup/fuzz "$@"
      ;;
    --shard) export ABBE_SHARD=${2:?--shard needs k/n}; shift ;;
    *) echo "usage: ./test.sh [--long [--shard k/n] | --fuzz MINUTES [TARGET...]]" >&2; exit 2 ;;
  esac
  shift
done
./setup/install setup/build_packages setup/test_packages
./setup/build dev ${options[@]+"${options[@]}"}
./setup/ctest dev "${select[@]}"
