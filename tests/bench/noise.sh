#!/usr/bin/env bash
# Maps every log of a data folder with the errors of its odometry multiplied by 1, 2 and 4 and prints the errors against
# the reference, as in docs/results.md.
#   tests/bench/noise.sh EVALUATION_TOOL [DATA_FOLDER]
# EVALUATION_TOOL compares two TUM trajectories and prints JSON (evaluate_trajectory.py).
# DATA_FOLDER holds X.clf.gz, X.ref.tum and X.relations; default ../shared/data beside the project.
# TOPOGEO_BIN names the folder of topogeo and topogeo_noisy_log; default build/bin.
# FACTORS, default "1 2 4".
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
bin=${TOPOGEO_BIN:-$root/build/bin}

die() { printf 'noise: %s\n' "$*" >&2; exit 1; }

if [ $# -lt 1 ] || [ $# -gt 2 ]; then die "usage: noise.sh EVALUATION_TOOL [DATA_FOLDER]"; fi
tool=$1
data=${2:-$root/../shared/data}
[ -r "$tool" ] || die "cannot read the evaluation tool '$tool'"
for program in topogeo topogeo_noisy_log; do
  [ -x "$bin/$program" ] || die "there is no '$bin/$program'; build it with ./run build"
done
shopt -s nullglob
logs=("$data"/*.clf.gz)
[ ${#logs[@]} -gt 0 ] || die "no *.clf.gz in '$data'"

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# The figures of one trajectory: ate, loop, end, relations all and far.
figures() {
  local estimate=$1 log=$2 relations=${2%.clf.gz}.relations arguments=()
  [ ! -r "$relations" ] || arguments=(--relations "$relations")
  python3 "$tool" "$estimate" "${log%.clf.gz}.ref.tum" "${arguments[@]}" --json | python3 -c '
import json, sys
f = json.load(sys.stdin)
relations = f.get("relations") or {}
def metres(group, digits):
    return "-" if not group else "%.*f" % (digits, group["m"])
print("%.3f | %s | %.3f | %s | %s" % (f["ate"], metres(f["loop"], 3), f["end"],
    metres(relations.get("all"), 4), metres(relations.get("far"), 4)))'
}

printf '| log | errors times | odometry ate m | ate m | loop m | end m | relations, all m | relations, far m | loop closures | CPU s |\n'
printf '|---|---|---|---|---|---|---|---|---|---|\n'
TIMEFORMAT='%1U'
for log in "${logs[@]}"; do
  [ -r "${log%.clf.gz}.ref.tum" ] || continue
  for factor in ${FACTORS:-1 2 4}; do
    folder=$out/map noisy=$out/noisy.clf.gz
    "$bin/topogeo_noisy_log" --log "$log" --reference "${log%.clf.gz}.ref.tum" --factor "$factor" --out "$noisy"
    { time "$bin/topogeo" map --log "$noisy" --out "$folder" > "$out/said" 2>&1; } 2> "$out/time" ||
      { cat "$out/said" >&2; die "topogeo failed on '$log'"; }
    odometry=$(figures "$folder/odometry.tum" "$log")
    closures=$(python3 -c 'import json, sys; print(len(json.load(open(sys.argv[1]))["loop_closures"]))' "$folder/report.json")
    printf '| %s | %s | %s | %s | %s | %s |\n' "$(basename "${log%.clf.gz}")" "$factor" "${odometry%% |*}" \
      "$(figures "$folder/trajectory.tum" "$log")" "$closures" "$(tail -n 1 "$out/time")"
  done
done
