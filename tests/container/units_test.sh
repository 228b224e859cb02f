#!/usr/bin/env bash
# The packages on a machine with systemd, as on the deployment page: the units come up and find each other, root sees
# them, a service that dies or hangs is restarted, and busy workers do not starve the services that drive the robot.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need_image
claim_domain
# Domain of the simulator and of the program that watches the true motion, which are outside the robot.
claim_domain_as truth
machine=topogeo-machine-$$

step "a machine with systemd"
printf 'FROM %s\nUSER root\nRUN apt-get update -q && apt-get install -q -y --no-install-recommends %s\n' "$image" \
  "systemd systemd-sysv sudo procps iproute2" | docker build -q --network host -t "$image-systemd" - > "$work/build.log" 2>&1 ||
  { tail -n 5 "$work/build.log"; fail "the image of the machine cannot be made"; }
cleanups+=("docker rm -f $machine")
# shellcheck disable=SC2016  # expanded when it runs
keepers+=('docker logs $machine > "$work/machine.log" 2>&1; docker exec $machine journalctl --no-pager > "$work/journal.log"')
boot() {
  docker rm -f $machine > /dev/null 2>&1 || true
  docker run -d --name $machine --hostname robot --no-healthcheck --tmpfs /run --tmpfs /run/lock "$@" \
    "$image-systemd" /sbin/init > "$work/boot.log" 2>&1
}
here() { docker exec $machine "$@"; }
is_up() { here systemctl is-system-running 2> /dev/null | grep -qE 'running|degraded'; }
has_settled() {
  is_up || [ "$(docker inspect -f '{{ .State.Running }}' $machine)" != true ] ||
    docker logs $machine 2>&1 | grep -q 'Freezing execution'
}
boots() { boot "$@" && wait_for "systemd" has_settled && is_up; }
# An engine without all privileges cannot grant them; some are enough for control groups of version 1.
boots --privileged ||
  boots --cap-add SYS_ADMIN --cap-add SYS_NICE --security-opt seccomp=unconfined --security-opt apparmor=unconfined \
    --cgroupns host -v /sys/fs/cgroup:/sys/fs/cgroup ||
  skip "systemd does not start in a container here: $(tail -n 1 "$work/boot.log")" "an engine that allows --privileged"

# Units have neither the environment of the container nor a place for reports, and too little memory for a sanitizer.
if [ ${#sanitized[@]} -gt 0 ]; then
  {
    printf '[Service]\nPrivateTmp=no\nReadWritePaths=%s\nMemoryMax=infinity\n' "$build/reports"
    printf 'AmbientCapabilities=CAP_SYS_PTRACE\nCapabilityBoundingSet=CAP_SYS_PTRACE\nSystemCallFilter=\n'
    env | sed -nE 's/^((A|L|UB|T)SAN_OPTIONS=.*)/Environment="\1"/p'
  } > "$work/sanitized.conf"
  for unit in $(here ls /usr/lib/systemd/system | grep '^topogeo.*service$'); do
    here mkdir -p "/etc/systemd/system/$unit.d"
    docker cp "$work/sanitized.conf" "$machine:/etc/systemd/system/$unit.d/" > /dev/null
  done
  here systemctl daemon-reload
fi

kept=$(IFS=,; echo "TOPOGEO_DOMAIN,${sanitizer_options[*]}")
as_topogeo() { here sudo -u topogeo --preserve-env="$kept" "$@"; }
state() { here systemctl show -P "$2" "$1"; }
is_state() { [ "$(state "$1" "$2")" = "$3" ]; }

step "a wrong file of devices"
# Commands also read domain and robot from these files, which are the only source here.
here sed -i "s/^TOPOGEO_DOMAIN=.*/TOPOGEO_DOMAIN=$TOPOGEO_DOMAIN/; s/^TOPOGEO_ROBOT=.*/TOPOGEO_ROBOT=anna/" \
  /etc/topogeo/topogeo.env /etc/topogeo/worker.env
here sh -c 'topogeo config --devices > /etc/topogeo/devices.yaml'
here systemctl enable --now topogeo.target topogeo-worker@1 > /dev/null 2>&1
wait_for "the failure of the gateway" is_state topogeo-sensor-gateway ActiveState failed || fail "a gateway without ports goes on"
gives_reason() { here journalctl -u topogeo-sensor-gateway --no-pager | grep "expected at least one port" > /dev/null; }
wait_for "the reason in the journal, which is written later" gives_reason || fail "without a reason"
if here topogeo status > "$work/status" 2>&1; then fail "a unit that has failed is called well"; fi
grep -q '^topogeo-sensor-gateway *failed' "$work/status" || { cat "$work/status"; fail "it is not listed"; }

step "a laser and a base"
docker cp "$source_dir/share/worlds/room.world.yaml" $machine:/root/ > /dev/null
# shellcheck disable=SC2154  # claim_domain_as sets it
docker exec -d $machine /usr/libexec/topogeo/simulator --domain "$truth" --world /root/room.world.yaml \
  --laser-port /root/laser --base-port /root/base
wait_for "the ports of the simulator" here test -L /root/base || fail "the simulator makes no ports"
# shellcheck disable=SC2016  # expanded in the container
here sh -ec 'for device in laser base; do
    port=$(readlink /root/$device)
    chgrp dialout $port
    chmod 660 $port
    sed -i "/^$device:/,/port:/s#port: .*#port: $port#" /etc/topogeo/devices.yaml
  done'
here systemctl restart topogeo.target
# All seven, queried as root and as the user of the services.
all_run() { here topogeo status > "$work/status" 2>&1 && [ "$(grep -c ' running ' "$work/status")" = 7 ]; }
wait_for "all services to be well" all_run || { cat "$work/status"; fail "not all services are well"; }
all_run_for_their_user() { as_topogeo topogeo status > /dev/null; }
wait_for "the services to be well for their user" all_run_for_their_user || fail "not all services are well for their user"
wait_for "the map" here test -e /var/lib/topogeo/map/map.sqlite || fail "no map"

[ -x "$build/tests/drive_watch" ] || fail "drive_watch is not built"
docker cp "$build/tests/drive_watch" $machine:/root/ > /dev/null
docker exec -d $machine sh -c "exec nice -n -20 /root/drive_watch --domain $truth --log-level off > /root/motion"
docker exec -d $machine sh -c "exec nice -n -20 /root/drive_watch --domain $TOPOGEO_DOMAIN --robot anna --commands --log-level off \
  > /root/commands"
drives() { here tail -n 1 /root/motion | awk '{ exit !($2 > 0.1) }'; }
is_new() { ! is_state topogeo-navigator MainPID "$1" && ! is_state topogeo-navigator MainPID 0; }

# Prints the intervals of the commands during the drive.
drive_to() {  # X,Y
  local from
  from=$(now_ms)
  wait_for "the robot at $1" arrives here topogeo goto "$1" || { here topogeo status || true; fail "the robot does not get to $1"; }
  here cat /root/commands | awk -v from="$from" '$1 > from && ($2 > 0 || $3 > 0) {
      if (n++) { sum += $1 - last; if ($1 - last > most) most = $1 - last }
      last = $1
    }
    END { printf "       %d commands, every %.1f ms, at most %d ms apart\n", n, (n > 1 ? sum / (n - 1) : 0), most }'
}

# Shows the motion since MS, every half second, and the services' logs.
show_drive() {
  local file
  for file in motion commands; do
    echo "$file:"
    here cat /root/$file | awk -v from="$1" '$1 > from - 1000 && $1 > next_ms { print $1 - from, $2, $3; next_ms = $1 + 500 }'
  done
  here journalctl -u 'topogeo-*' --no-pager -o short-unix | tail -n 40
}

# The navigator freezes on the path to X,Y: the gateway stops the robot before systemd starts another navigator.
freeze_on_the_way_to() {  # X,Y
  local navigator from until drive
  navigator=$(state topogeo-navigator MainPID)
  here topogeo goto "$1" --wait-seconds "$hang_limit_s" > "$work/goto.log" 2>&1 &
  drive=$!
  wait_for "the robot to drive" drives || fail "the robot does not set out for $1"
  from=$(now_ms)
  here kill -STOP "$navigator"
  wait_for "another navigator" is_new "$navigator" || fail "the navigator that hangs is not started again"
  until=$(here systemctl show --timestamp=unix -P ExecMainStartTimestamp topogeo-navigator)
  # The robot stands still for at least the last ten lines, half a second.
  here cat /root/motion | awk -v from="$from" -v until="${until#@}000" '$1 > from && $1 < until {
      if ($2 > 0.005 || $3 > 0.005) { last = $1; still = 0 } else { ++still }
    }
    END { printf "       stands after %d ms\n", (last ? last - from : 0); exit still < 10 }' ||
    { show_drive "$from"; fail "the robot drives on without its navigator"; }
  wait_for "all services to be well" all_run || { cat "$work/status"; fail "not all services are well after the navigator hung"; }
  wait $drive || true  # succeeds if the new navigator came before `goto` gave up
}

step "what dies or hangs"
others=$(state topogeo-local-mapper MainPID)
before=$(state topogeo-navigator MainPID)
here kill -KILL "$before"
wait_for "another navigator" is_new "$before" || fail "the navigator that died is not started again"
wait_for "all services to be well" all_run || { cat "$work/status"; fail "not all services are well after the navigator died"; }
step "the navigator hangs on a drive"
freeze_on_the_way_to 3,0
is_state topogeo-local-mapper MainPID "$others" || fail "another service was started again, too"

step "eight busy workers"
# The workers' unit with all its settings, but fully busy.
here sh -c 'sed "s/^Type=.*/Type=exec/; /^WatchdogSec=/d; s|^ExecStart=.*|ExecStart=/bin/sh -c \"while :; do :; done\"|" \
    /lib/systemd/system/topogeo-worker@.service > /etc/systemd/system/busy-worker@.service
  systemctl daemon-reload
  systemctl start busy-worker@1 busy-worker@2 busy-worker@3 busy-worker@4 busy-worker@5 busy-worker@6 busy-worker@7 \
    busy-worker@8'
# The kernel's value, in control groups of version 1 or 2. All workers together are one group beside the services.
weight() {  # UNIT
  local group
  group=$(state "$1" ControlGroup)
  here cat "/sys/fs/cgroup/cpu$group/cpu.shares" "/sys/fs/cgroup$group/cpu.weight" 2> /dev/null || true
}
# A container has as much weight as all other programs together: without a quota the loops would take half of the machine
# from other tests.
here systemctl set-property --runtime "$(state busy-worker@1 Slice)" CPUQuota=60%
worker_weight=$(weight "$(state busy-worker@1 Slice)")
[ -n "$worker_weight" ] || fail "the group of workers has no weight"
for unit in navigator:50 sensor-gateway:50 local-mapper:25 localizer:25 map-store:10 planner:10; do
  [ "$(weight "topogeo-${unit%:*}")" -ge $((worker_weight * ${unit#*:})) ] ||
    fail "topogeo-${unit%:*} weighs less than ${unit#*:} times as much as all workers together"
done
drive_to 0.4,0.2
freeze_on_the_way_to 3,0
is_state busy-worker@8 ActiveState active || fail "the workers were not busy"
here systemctl stop 'busy-worker@*'

step "a discovery server that dies"
here systemctl start topogeo-discovery@0
before=$(state topogeo-discovery@0 MainPID)
here kill -KILL "$before"
comes_back() { here ss -Hlun 'sport = :11811' | grep -q . && ! is_state topogeo-discovery@0 MainPID "$before"; }
wait_for "another discovery server" comes_back || fail "the discovery server is not started again"
here systemctl stop topogeo-discovery@0

step "a backup, and the end"
as_topogeo topogeo store snapshot /var/lib/topogeo/map before-the-fair > /dev/null
here systemctl stop topogeo-map-store
as_topogeo topogeo store restore /var/lib/topogeo/map before-the-fair > /dev/null
here systemctl start topogeo-map-store
wait_for "all services to be well" all_run || { cat "$work/status"; fail "not all services are well after the map was restored"; }
here systemctl stop topogeo.target topogeo-worker@1
for unit in navigator sensor-gateway local-mapper localizer map-store planner; do
  wait_for "the end of topogeo-$unit" is_state topogeo-$unit ActiveState inactive || fail "topogeo-$unit ended with $(state topogeo-$unit Result)"
done
here test -s /var/lib/topogeo/map/map.pb || fail "no map at the end"

step "removed, but not the workers"
here systemctl enable --now topogeo-discovery@0 topogeo-worker@1 topogeo-web > /dev/null 2>&1
here apt-get purge -q -y topogeo > "$work/purge.log" 2>&1 || { cat "$work/purge.log"; fail "topogeo cannot be purged"; }
is_state topogeo-web ActiveState inactive || fail "a service goes on without its package"
for unit in topogeo-discovery@0 topogeo-worker@1; do
  { is_state $unit ActiveState active && here systemctl -q is-enabled $unit; } ||
    fail "$unit ends or is disabled with a package that is not its own"
done
here apt-get purge -q -y topogeo-workers > "$work/purge.log" 2>&1 ||
  { cat "$work/purge.log"; fail "topogeo-workers cannot be purged"; }
for unit in topogeo-discovery@0 topogeo-worker@1; do
  is_state $unit ActiveState inactive || fail "$unit goes on without its package"
done
left=$(here find /etc/systemd/system -lname '*topogeo*')
[ -z "$left" ] || fail "enabled without a package: $left"
step "the end"
