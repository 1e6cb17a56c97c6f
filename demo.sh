#!/usr/bin/env bash
# Installs what is missing, builds abbe, measures the three axes of a virtual machine with the five-probe
# head over Modbus TCP, and writes the report. Can be run again at any time.
set -euo pipefail
cd "$(dirname "$0")"
speed=20 # the virtual machine runs this many times faster than a real one
out=out
./setup/install setup/build_packages
./setup/build release -DABBE_TESTS=OFF
abbe=build/release/apps/abbe

rm -rf "$out"
mkdir -p "$out/rig"
"$abbe" rig --machine machines/demo_mill.toml --seed "${ABBE_DEMO_SEED:-$(date +%Y%m%d)}" --port 0 --speed "$speed" \
  --ready-file "$out/rig/port" --truth "$out/rig/truth.json" >"$out/rig/log" 2>&1 &
rig=$!
trap 'kill "$rig" 2>/dev/null || true' EXIT
for _ in $(seq 100); do
  [ -s "$out/rig/port" ] && break
  kill -0 "$rig" 2>/dev/null || { cat "$out/rig/log" >&2; exit 3; }
  sleep 0.1
done
sed "s/^port = .*/port = $(cat "$out/rig/port")/" machines/demo_mill.toml >"$out/machine.toml"

for axis in X Y Z; do
  "$abbe" sweep --axis "$axis" --machine "$out/machine.toml" --clock-speed "$speed" --out "$out"
done
"$abbe" rig compare "$out/rig/truth.json" "$out"/sweep_{X,Y,Z}.json
"$abbe" report "$out" --out "$out/report.html"
