#!/usr/bin/env bash
# Two sites with security, joined only by a WireGuard tunnel: its addresses are the peers, because discovery servers
# carry no security. Sites are network namespaces. The map of a log equals that of one process.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/tunnel.sh"

need_tunnel
need ip openssl
need_programs
unshare --net true 2> /dev/null || skip "no network namespace can be made" "root, with CAP_SYS_ADMIN in a container,"
claim_domain
map_alone 100 "$work/alone"
"$source_dir/deploy/security/make_keys" "$work/keys" issue --robot robot robot
"$source_dir/deploy/security/make_keys" "$work/keys" issue --robot robot pc1 ga_worker

name_of() { echo "topogeo-$$-$1"; }
at() { ip netns exec "$(name_of "$1")" "${@:2}"; }  # SITE COMMAND...

step "a tunnel"
declare -A address=([robot]=10.77.0.1 [pc1]=10.77.0.2) tunnel_address=([robot]=10.99.0.1 [pc1]=10.99.0.2)
for site in robot pc1; do
  ip netns add "$(name_of $site)"
  cleanups+=("ip netns del $(name_of $site)")
  make_tunnel_key $site
done
at robot ip link add line type veth peer name line netns "$(name_of pc1)"
for site in robot pc1; do
  at $site ip address add "${address[$site]}/24" dev line
  at $site ip link set line up
  at $site ip link set lo up
done

# shellcheck disable=SC2034  # tunnel() uses it
enter() { inside=(ip netns exec "$(name_of "$1")"); }
tunnel robot "${tunnel_address[robot]}" pc1 "${tunnel_address[pc1]}" "${address[pc1]}"
tunnel pc1 "${tunnel_address[pc1]}" robot "${tunnel_address[robot]}" "${address[robot]}"

export TOPOGEO_DDS_PARTICIPANT=wan TOPOGEO_PEERS='10.99.0.1;10.99.0.2'
start_at() {  # SITE PROGRAM OPTIONS...
  TOPOGEO_SECURITY=$work/keys/$1 ip netns exec "$(name_of "$1")" "$bin/$2" "${@:3}" > "$work/$2.log" 2>&1 &
  cleanups+=("kill $!")
}
workers() { TOPOGEO_SECURITY=$work/keys/robot at robot "$bin/topogeo" workers 2>&1; }
is_there() { workers | grep "^pc1 " > /dev/null; }
has_worked() { workers | awk '$1 == "pc1" && $5 > 0 { found = 1 } END { exit !found }'; }

step "a log with a worker at the other site"
start_at pc1 ga_worker --slots 1 --name pc1
wait_for "the worker at the other site" is_there || { workers; fail "the worker at the other site is not found"; }
start_at robot map_store --out "$work/tunnelled" --title log.clf
start_at robot localizer --replay --wait-workers 1 --wait-seconds "$hang_limit_s"
start_at robot local_mapper --replay
start_at robot planner
start_at robot sensor_gateway --log "$work/log.clf" --rate lossless
wait_for "the trajectory" test -e "$work/tunnelled/trajectory.tum" || { tail -n 3 "$work"/*.log; fail "no trajectory"; }
wait_for "the map" test -e "$work/tunnelled/map.pb" || fail "no map"
wait_for "work of the worker at the other site" has_worked || { workers; fail "the worker at the other site had no work"; }
same_results "$work/tunnelled" "$work/alone"
step "the end"
