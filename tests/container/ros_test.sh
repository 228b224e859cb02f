#!/usr/bin/env bash
# A robot with ROS 2 (on Cyclone DDS, on a host of its own, without security) drives to the goal of a ROS node with our
# secured services: bridge, mapping and planning on one host, a search worker on another, the page on a third. The nodes
# get map, pose and plan; a stranger on their host gets none of our data.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source "$(dirname "${BASH_SOURCE[0]}")/hosts.sh"

need openssl python3
need_image
[ -x "$build/tests/ros_peer" ] || skip "the nodes of ROS are not built" "ninja -C build ros_peer"
chmod 777 "$work"

step "keys, and the nodes of ROS with what they need"
make_keys=$source_dir/deploy/security/make_keys
"$make_keys" "$work/keys" issue --robot robot robot
"$make_keys" "$work/keys" issue --robot all pc1 ga_worker status
"$make_keys" "$work/keys" issue --robot robot page web status
chmod -R a+rX "$work/keys"
mkdir "$work/nodes"
cp "$build/tests/ros_peer" "$source_dir/share/worlds/room.world.yaml" "$work/nodes"
ldd "$build/tests/ros_peer" | awk '$2 == "=>" && $3 ~ /^\// { print $3 }' | grep -v '/lib\(c\|m\|gcc_s\|stdc++\)\.so' |
  xargs -I{} cp {} "$work/nodes"

make_network
secured() { start_host "$1" -e TOPOGEO_SECURITY=/exchange/keys/"$1" -e ROS_DOMAIN_ID="$TOPOGEO_DOMAIN"; }
secured robot
secured pc1
secured page
start_host nodes -e LD_LIBRARY_PATH=/exchange/nodes

start_node() {  # NAME COMMAND...
  start_on nodes "$1" /exchange/nodes/ros_peer "$TOPOGEO_DOMAIN" "${@:2}"
}
heard() { grep -q "$1" "$work/log/nodes.user" 2> /dev/null; }
show() { tail -n 4 "$work"/log/* >&2; }

step "robot, worker, page and nodes"
start_node robot drive /exchange/nodes/room.world.yaml
start_node user watch
printf 'qos: {scan: reliable, odometry: reliable}\nodometry: {wait_s: 0.5}\n' > "$work/ros.yaml"
start_on robot map_store map_store --out /exchange/map --new
start_on robot localizer localizer --wait-workers 1 --wait-seconds "$hang_limit_s"
for service in local_mapper planner navigator; do start_on robot $service $service; done
start_on robot ros_bridge ros_bridge --ros /exchange/ros.yaml
start_worker pc1
start_on page web web --port 8080
wait_for "a pose at the nodes of ROS" heard '^pose map ' || { show; fail "the nodes get no pose"; }
wait_for "a map at the nodes of ROS" heard '^map map ' || { show; fail "the nodes get no map"; }
wait_for "a transform at the nodes of ROS" heard '^tf map odom ' || { show; fail "the nodes get no transform"; }

step "a goal of a node"
on nodes /exchange/nodes/ros_peer "$TOPOGEO_DOMAIN" goal 1.5 0 0 > "$work/goal.log" 2>&1 ||
  { cat "$work/goal.log"; show; fail "no plan for the node's goal"; }
# Uses the robot's ground truth, not our estimate.
arrived() {
  awk '/^truth/ { near = ($2 - 1.5) ^ 2 + $3 ^ 2 < 0.16 && $5 == "stands"; collisions = $7 }
    END { exit !(near && collisions == 0) }' "$work/log/nodes.robot"
}
wait_for "the robot at its goal" arrived || { tail -n 1 "$work/log/nodes.robot"; show; fail "the robot does not arrive"; }

step "worker, page, and a stranger"
worked() { [ "$(workers_done)" -ge 1 ]; }
wait_for "work of the worker" worked || { on robot topogeo workers; fail "the worker had no work"; }
page_answers() {
  # shellcheck disable=SC2016  # expanded in the container
  on page bash -c 'exec 3<> /dev/tcp/127.0.0.1/8080
    printf "GET /api/info HTTP/1.0\r\nHost: 127.0.0.1:8080\r\n\r\n" >&3; cat <&3' > "$work/info" 2>&1 &&
    grep -q '200 OK' "$work/info"
}
wait_for "an answer of the page" page_answers || { cat "$work/info"; fail "the page does not answer"; }
# A single check may come before the newcomer has met all others, because authentication takes time.
all_are_seen() {
  on robot topogeo status > "$work/status" 2>&1 || true
  for service in ros_bridge map_store localizer planner navigator web ga_worker; do
    grep -q "^$service " "$work/status" || { missing=$service; return 1; }
  done
}
wait_for "all services in the status" all_are_seen || { cat "$work/status"; fail "$missing is not seen"; }
on nodes topogeo status > "$work/stranger" 2>&1 || true
! grep -q 'map_store\|localizer' "$work/stranger" || { cat "$work/stranger"; fail "a stranger sees our services"; }
step "the end"
