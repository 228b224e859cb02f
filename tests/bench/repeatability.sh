#!/usr/bin/env bash
# Prints the share of a local map that is found again half a metre farther on: for each input with the default
# configuration, then for all inputs together with one setting of it changed at a time (and with all of them as in the
# Thesis). The defaults are chosen by these tables (docs/decisions/perception.md).
#   tests/bench/repeatability.sh [DATA_FOLDER]
# Inputs are the simulated floor (share/worlds/floor.world.yaml) and each X.clf.gz with its X.ref.tum in
# DATA_FOLDER, default ../shared/data beside the project. REPEATABILITY names the program; default
# build/bin/topogeo_repeatability.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
tool=${REPEATABILITY:-$root/build/bin/topogeo_repeatability}
data=${1:-$root/../shared/data}
inputs=()
# shellcheck disable=SC1091  # found by its full path
source "$root/tests/bench/inputs.sh"

[ -x "$tool" ] || { echo "repeatability: there is no '$tool'; build it with ./run bench NONE" >&2; exit 1; }
name_inputs "$root" "$data"

config=$(mktemp --suffix=.yaml)
trap 'rm -f "$config"' EXIT

echo "### Default configuration"
"$tool" --header "${inputs[@]}"
echo
echo "### All inputs together, one setting changed"
"$tool" --header --total default "${inputs[@]}"
while IFS='|' read -r name settings; do
  printf 'local_map:\n  %s\n' "${settings:-$name}" | sed 's/; /\n  /g' > "$config"
  "$tool" --total "$name" --config "$config" "${inputs[@]}"
done <<'SETTINGS'
rules of the Thesis, 10 m|on_wall_m: 0; site_spacing_m: 0; alternate_behind_only: false; alternate_large_only: false; join_again: false; join_hidden_zones: true; window_of_groups: true; largest_hidden_share: 1; remove_off_main_graph: true; min_main_graph_m: 0
rules of the Thesis, 4 m|on_wall_m: 0; site_spacing_m: 0; alternate_behind_only: false; alternate_large_only: false; join_again: false; join_hidden_zones: true; window_of_groups: true; largest_hidden_share: 1; remove_off_main_graph: true; min_main_graph_m: 0; range_limit_m: 4
split_discontinuities: false
discontinuity_m: 0.3
discontinuity_m: 1.0
on_wall_m: 0
join_contiguous: false
contiguous_m: 0.45
contiguous_m: 0.65
join_alternate: false
alternate_behind_only: false
alternate_large_only: false
drop_small: false
min_group_points: 1
min_group_points: 4
join_again: false
join_hidden_zones: true
site_spacing_m: 0
window_of_groups: true
resolution_m: 0.025
resolution_m: 0.1
node_merge_m: 0.1
node_merge_m: 0.25
largest_hidden_share: 0.1
largest_hidden_share: 0.15
largest_hidden_share: 0.25
largest_hidden_share: 0.3
largest_hidden_share: 1
remove_off_main_graph: true
state_rise_m: 0.05
state_rise_m: 0.15
state_rise_m: 0.25
corridor_length_m: 1.0
corridor_length_m: 2.5
plateau_m: 0.2
range_limit_m: 4
range_limit_m: 6
range_limit_m: 8
range_limit_m: 12
SETTINGS
