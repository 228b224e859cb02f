#!/usr/bin/env bash
# Prints the accuracy of matches of two local maps, and how many wrong ones are accepted: the tables of
# docs/decisions/match_form.md. A few minutes; --quick takes a small sample of the pairs.
#   tests/bench/matching.sh [OPTION...]
# Options go to the program: --quick, --no-accuracy, --no-look-alikes, --config FILE, --samples FILE.
# Inputs are the simulated floor (share/worlds/floor.world.yaml) and each X.clf.gz with its X.ref.tum in
# the folder that TOPOGEO_LOG_DIR names, default ../shared/data beside the project. MATCHING names the
# program; default build/bin/topogeo_match_quality.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
tool=${MATCHING:-$root/build/bin/topogeo_match_quality}
inputs=()
# shellcheck disable=SC1091  # found by its full path
source "$root/tests/bench/inputs.sh"

[ -x "$tool" ] || { echo "matching: there is no '$tool'; build it with ./run bench NONE" >&2; exit 1; }
name_inputs "$root" "${TOPOGEO_LOG_DIR:-$root/../shared/data}"
"$tool" "${inputs[@]}" "$@"
