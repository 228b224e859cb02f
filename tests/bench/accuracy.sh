#!/usr/bin/env bash
# Maps every log of a data folder with one process and prints the errors of odometry and of the corrected trajectory
# against the reference, as in docs/results.md, and how many revisited places were recognized (topogeo compare --help).
#   tests/bench/accuracy.sh [--mode graph|thesis] EVALUATION_TOOL [DATA_FOLDER]
# --mode sets localizer.mode; default: the default configuration.
# EVALUATION_TOOL compares two TUM trajectories and prints JSON (evaluate_trajectory.py).
# DATA_FOLDER holds X.clf.gz, X.ref.tum and X.relations; default ../shared/data beside the project.
# TOPOGEO names the executable; default build/bin/topogeo.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
topogeo=${TOPOGEO:-$root/build/bin/topogeo}

die() { printf 'accuracy: %s\n' "$*" >&2; exit 1; }

mode=
if [ "${1-}" = --mode ]; then
  mode=${2-}
  case $mode in graph | thesis) shift 2 ;; *) die "--mode '$mode': expected graph or thesis" ;; esac
fi
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
  die "usage: accuracy.sh [--mode graph|thesis] EVALUATION_TOOL [DATA_FOLDER]"
fi
tool=$1
data=${2:-$root/../shared/data}
[ -r "$tool" ] || die "cannot read the evaluation tool '$tool'"
[ -x "$topogeo" ] || die "there is no '$topogeo'; build it with ./run build"
shopt -s nullglob
logs=("$data"/*.clf.gz)
[ ${#logs[@]} -gt 0 ] || die "no *.clf.gz in '$data'"

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
configuration=()
if [ -n "$mode" ]; then
  printf 'localizer:\n  mode: %s\n' "$mode" > "$out/config.yaml"
  configuration=(--config "$out/config.yaml")
fi

# One row: log, which trajectory, the figures of the tool's JSON, then those of the loops.
row() {
  local log=$1 which=$2 estimate=$3 seconds=$4 loops=$5
  local reference=${log%.clf.gz}.ref.tum relations=${log%.clf.gz}.relations arguments=()
  [ ! -r "$relations" ] || arguments=(--relations "$relations")
  python3 "$tool" "$estimate" "$reference" "${arguments[@]}" --json |
    python3 -c '
import json, sys
log, which, seconds, loops = sys.argv[1:]
figures = json.load(sys.stdin)
relations = figures.get("relations") or {}
def metres(group, digits):
    return "-" if not group else "%.*f" % (digits, group["m"])
recall = json.loads(loops)
recall = [str(recall.get(key, "-")) for key in ("revisits", "tried", "accepted", "in_view", "accepted_in_view", "wrong")]
print("| %s | %s | %.3f | %s | %.3f | %s | %s | %s | %s |" % (
    log, which, figures["ate"], metres(figures["loop"], 3), figures["end"],
    metres(relations.get("all"), 4), metres(relations.get("far"), 4), " | ".join(recall), seconds))
' "$(basename "${log%.clf.gz}")" "$which" "$seconds" "$loops"
}

printf '| log | trajectory | ate m | loop m | end m | relations, all m | relations, far m | revisits | tried | accepted | in view | of them accepted | wrong | wall / CPU s |\n'
printf '|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n'
TIMEFORMAT='%1R / %1U'
for log in "${logs[@]}"; do
  [ -r "${log%.clf.gz}.ref.tum" ] || continue
  folder=$out/$(basename "${log%.clf.gz}")
  { time "$topogeo" map --log "$log" --out "$folder" "${configuration[@]}" \
    > "$out/said" 2>&1; } 2> "$out/time" ||
    { cat "$out/said" >&2; die "topogeo failed on '$log'"; }
  loops=$("$topogeo" compare "$folder/map.pb" "${log%.clf.gz}.ref.tum" --loops --json)
  row "$log" odometry "$folder/odometry.tum" - '{}'
  row "$log" "${mode:-corrected}" "$folder/trajectory.tum" "$(tail -n 1 "$out/time")" "$loops"
done
