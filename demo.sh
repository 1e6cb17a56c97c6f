#!/usr/bin/env bash
# Installs what is missing, builds abbe, measures the three axes of a virtual machine with the five-probe
# head over Modbus TCP, calibrates its linkage, measures circles with it, fuses all into one error map, hides an
# effect of the day in the machine and finds it, follows another machine over a month, and writes the report. Can be
# run again at any time. `./demo.sh --live [PORT]` shows the sweeps on a page while they are measured (port 8080).
set -euo pipefail
cd "$(dirname "$0")"
live=()
case ${1:-} in
  "") ;;
  --live) live=(--live --live-port "${2:-8080}") ;;
  *) echo "usage: ./demo.sh [--live [PORT]]" >&2; exit 2 ;;
esac
speed=20 # the virtual machine runs this many times faster than a real one
out=out
./setup/install setup/build_packages
./setup/build release -DABBE_TESTS=OFF -DABBE_PYTHON_MODULE=OFF
abbe=build/release/apps/abbe

rm -rf "$out"
mkdir -p "$out/rig"
seed=${ABBE_DEMO_SEED:-$(date +%Y%m%d)}
"$abbe" rig --machine machines/demo_mill.toml --seed "$seed" --port 0 --speed "$speed" \
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
  "$abbe" sweep --axis "$axis" --machine "$out/machine.toml" --clock-speed "$speed" --mounting demo --out "$out" \
    ${live[@]+"${live[@]}"}
done

# The linkage: a grid of places beside a grid encoder, then circles at two feeds.
course() { # FILE MACHINE OPTIONS...
  "$abbe" rig record --seed "$seed" --out "$1" --machine "$2" "${@:3}" >"$out/rig/log"
}
demo=machines/demo_mill.toml
course "$out/cube.csv" "$demo" --course cube --size 45 --points 5,5,5 --dwell 0.2 --feed 2000 --reference
course "$out/circle.csv" "$demo" --course circle --feed 300
course "$out/circle_fast.csv" "$demo" --course circle --feed 2000
"$abbe" calibrate "$out/cube.csv" --machine "$demo" -o "$out/linkage.toml" --json "$out/linkage.json" --quiet
"$abbe" circle "$out"/circle{,_fast}.csv --machine "$demo" --calibration "$out/linkage.toml" --filter 50 --out "$out"

# All of it together, with the linkage over the volume and one line of lengths: the error map.
course "$out/volume.csv" "$demo" --course cube --size 57 --points 6,6,6 --dwell 0.2 --feed 6000
course "$out/line.csv" "$demo" --length X
"$abbe" fuse "$out"/sweep_{X,Y,Z}.csv "$out"/{volume,line}.csv --machine "$demo" -o "$out/map.toml" --json "$out/fuse.json"
for format in isg vtk sinumerik; do
  "$abbe" export "$out/map.toml" --format "$format" --json "$out/export_$format.json" --quiet
done
for test in circle diagonals; do
  "$abbe" simulate "$out/map.toml" --test "$test" --corrected --json "$out/simulate_$test.json" --quiet
done

# Something is wrong with the machine, another thing every day: a campaign, and what the diagnosis says of it.
wrong=(backlash:object=X:width_um=4 servo-lag:object=Y:delay_ms=0.3 leadscrew-cyclic:object=Y:pitch_mm=6:amplitude_um=0.8
  mains-pickup:object=probe_d:frequency_hz=50:amplitude_um=0.2 load-coupling:object=XY:coefficient_nm_per_mm2=2
  reversal-spike:object=X:height_um=2:decay_mm=0.3
  clock-skew:object=linkage:delay_ms=3 vibration:object=X:frequency_hz=17:amplitude_um=0.5
  target-form:object=target_top:rms_um=0.4)
hidden=${ABBE_DEMO_HIDE:-${wrong[$((10#$(date +%j) % ${#wrong[@]}))]}}
# Its ball moves in the cap without drag, or the diagnosis would find that too.
{ cat "$demo"; printf '\n[rig]\ncap_um = 0.0\n'; } >"$out/rig/no_drag.toml"
"$abbe" rig record --seed "$seed" --machine "$out/rig/no_drag.toml" --campaign full --reduced --hide "$hidden" \
  --truth "$out/rig/hidden.json" --out "$out/campaign" >"$out/rig/log"
# Of the full campaign the standard one, the gap steps and the target mounted again.
rm "$out"/campaign/{19,2?,3?}_*
"$abbe" diagnose "$out"/campaign/*.h5 --machine "$out/rig/no_drag.toml" -o "$out/causes.toml" --json "$out/diagnosis.json" --quiet
# What such a campaign would show of other causes.
"$abbe" diagnose --plan "$out"/campaign/*.h5 --machine "$out/rig/no_drag.toml" --json "$out/plan.json" --quiet

# A month of another machine, whose backlash grows: a circle every three days, kept in a history.
mkdir -p "$out/history"
{ cat "$demo"; printf '\n[limits]\ncircularity_um = 8.0\n'; } >"$out/history/mill.toml"
history() { "$abbe" history "$@" --store "$out/history/history.db" --quiet; }
for day in $(seq 0 3 27); do
  folder=$out/history/day_$day
  mkdir -p "$folder"
  width=$(LC_ALL=C awk "BEGIN { print 1 + 0.15 * $day }")
  "$abbe" rig record --machine "$demo" --seed 7 --run $((day + 1)) --kind reference --course circle --passes 1 --rate 30 \
    --hide "backlash:object=X:width_um=$width" --out "$folder/circle.csv" >"$out/rig/log"
  "$abbe" circle "$folder/circle.csv" --filter 50 --out "$folder" --quiet
  history add "$folder" --machine "$out/history/mill.toml" \
    --measured "$(date -u -d "$((30 - day)) days ago" +%Y-%m-%dT08:00:00Z)"
done
history trend XY --json "$out/history_trend.json"
history compare 1 latest --json "$out/history_compare.json"
history check latest --machine "$out/history/mill.toml" --json "$out/history_check.json" || [ $? = 1 ]

# What the rig knows: the same circle by a grid encoder without noise.
sed 's/^reference_um = .*/reference_um = 0.0001/' "$demo" >"$out/rig/exact.toml"
course "$out/rig/circle.csv" "$out/rig/exact.toml" --course circle --feed 300 --kind reference
"$abbe" circle "$out/rig/circle.csv" --filter 50 --json "$out/rig/circle.json" --quiet

number() { # FILE KEY: of the top level; OBJECT.KEY: one level down, in um
  case $2 in
    *.*) sed -n "/^ \"${2%%.*}\": {/,/^ }/s/^  \"${2#*.}\": \([-0-9.e]*\).*/\1/p" "$1" ;;
    *) sed -n "s/^ \"$2\": \([-0-9.e]*\).*/\1/p" "$1" ;;
  esac
}
echo
"$abbe" rig compare "$out/rig/truth.json" "$out"/sweep_{X,Y,Z}.json
LC_ALL=C printf 'linkage: off by %.1f um (rms in space), calibrated %.2f um at poses that took no part\n' \
  "$(number "$out/linkage.json" before.rms_um)" "$(number "$out/linkage.json" held_out.rms_um)"
for figure in G_b F_max F_min D; do
  LC_ALL=C printf 'circle %-5s by the linkage %6.2f um, standard uncertainty %.2f um; the truth %6.2f um\n' "$figure" \
    "$(number "$out/circle_circle.json" "${figure}_um")" "$(number "$out/circle_circle.json" "u.${figure}_um")" \
    "$(number "$out/rig/circle.json" "${figure}_um")"
done
"$abbe" rig compare "$out/rig/hidden.json" "$out/diagnosis.json"
"$abbe" report "$out" --out "$out/report.html"
