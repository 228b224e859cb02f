#!/usr/bin/env bash
# The examples: map_a_log makes the files of `topogeo map`, and follow_in_python follows a map by the web protocol.
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

need_programs
need python3
[ -x "$bin/map_a_log" ] || skip "map_a_log is not built"
map_alone 100 "$work/alone"

step "map_a_log"
"$bin/map_a_log" "$work/log.clf" "$work/mapped" > "$work/mapped.log" || fail "map_a_log"
same_results "$work/alone" "$work/mapped"

step "follow_in_python"
claim_domain
"$bin/topogeo" view "$work/mapped/map.pb" --no-browser --port 0 --domain "$TOPOGEO_DOMAIN" > "$work/view.log" 2>&1 &
cleanups+=("kill $!")
wait_for "the link of topogeo view" grep -q 'spectators: ' "$work/view.log" ||
  { cat "$work/view.log"; fail "topogeo view prints no link"; }
address=$(sed -n 's#^spectators: *http://\([^/]*\)/.*#\1#p' "$work/view.log")
followed=$(timeout "$hang_limit_s" python3 "$source_dir/examples/follow_in_python/follow_map.py" "$address" once) ||
  fail "follow_map.py shows no map"
# "12 stops, 9 nodes, 8 branches" and "version 3: 9 nodes, 8 branches".
[ "${followed#*: }" = "$(sed 's/^[0-9]* stops, //' "$work/mapped.log")" ] ||
  fail "the map has '$(cat "$work/mapped.log")', follow_map.py shows '$followed'"
