#!/usr/bin/env bash
# The packages on a machine with systemd, as the page of deployment has it: the units come up and find each other,
# root sees them, and what dies or hangs is started again.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need_image
claim_domain
machine=topogeo-machine-$$

step "a machine with systemd"
printf 'FROM %s\nUSER root\nRUN apt-get update -q && apt-get install -q -y --no-install-recommends %s\n' "$image" \
  "systemd systemd-sysv sudo procps" | docker build -q --network host -t "$image-systemd" - > "$work/build.log" 2>&1 ||
  { tail -n 5 "$work/build.log"; fail "the image of the machine cannot be made"; }
cleanups+=("docker rm -f $machine")
boot() {
  docker rm -f $machine > /dev/null 2>&1 || true
  docker run -d --name $machine --hostname robot -e TOPOGEO_DOMAIN --no-healthcheck --tmpfs /run --tmpfs /run/lock "$@" \
    "$image-systemd" /sbin/init > "$work/boot.log" 2>&1
}
here() { docker exec $machine "$@"; }
is_up() { here systemctl is-system-running 2> /dev/null | grep -qE 'running|degraded'; }
# An engine without all privileges of root cannot give them; a part is enough for control groups of version 1.
{ boot --privileged && eventually 30 is_up; } ||
  { boot --cap-add SYS_ADMIN --cap-add SYS_NICE --security-opt seccomp=unconfined --security-opt apparmor=unconfined \
    --cgroupns host -v /sys/fs/cgroup:/sys/fs/cgroup && eventually 30 is_up; } ||
  skip "systemd does not start in a container here: $(tail -n 1 "$work/boot.log")"

state() { here systemctl show -P "$2" "$1"; }
is_state() { [ "$(state "$1" "$2")" = "$3" ]; }

step "a wrong file of devices"
here sed -i "s/^TOPOGEO_DOMAIN=.*/TOPOGEO_DOMAIN=$TOPOGEO_DOMAIN/" /etc/topogeo/topogeo.env /etc/topogeo/worker.env
here sh -c 'topogeo config --devices > /etc/topogeo/devices.yaml'
here systemctl enable --now topogeo.target topogeo-worker@1 > /dev/null 2>&1
eventually 30 is_state topogeo-sensor-gateway ActiveState failed || fail "a gateway without ports goes on"
here journalctl -u topogeo-sensor-gateway --no-pager | grep -q "expected at least one port" || fail "without a reason"

step "a laser and a base"
docker cp "$source_dir/tests/data/room.world.yaml" $machine:/root/ > /dev/null
docker exec -d $machine /usr/libexec/topogeo/simulator --domain 101 --world /root/room.world.yaml --laser-port /root/laser \
  --base-port /root/base
eventually 20 here test -L /root/base || fail "the simulator makes no ports"
# shellcheck disable=SC2016  # expanded in the container
here sh -ec 'for device in laser base; do
    port=$(readlink /root/$device)
    chgrp dialout $port
    chmod 660 $port
    sed -i "/^$device:/,/port:/s#port: .*#port: $port#" /etc/topogeo/devices.yaml
  done'
here systemctl restart topogeo.target
# All seven, as root and as the user of the services.
all_run() { here topogeo status > "$work/status" 2>&1 && [ "$(grep -c ' running ' "$work/status")" = 7 ]; }
eventually 90 all_run || { cat "$work/status"; fail "not all services are well"; }
all_run_for_their_user() { here sudo -u topogeo --preserve-env=TOPOGEO_DOMAIN topogeo status > /dev/null; }
eventually 30 all_run_for_their_user || fail "not all services are well for their user"
eventually 30 here test -e /var/lib/topogeo/map/map.sqlite || fail "no map"

step "what dies or hangs"
others=$(state topogeo-local-mapper MainPID)
for signal in KILL STOP; do
  before=$(state topogeo-navigator MainPID)
  here kill -$signal "$before"
  replaced() { ! is_state topogeo-navigator MainPID "$before" && ! is_state topogeo-navigator MainPID 0; }
  eventually 60 replaced || fail "SIG$signal: the navigator is not started again"
  eventually 60 all_run || { cat "$work/status"; fail "SIG$signal: not all services are well"; }
  step "SIG$signal"
done
is_state topogeo-local-mapper MainPID "$others" || fail "another service was started again, too"

step "a backup, and the end"
here sudo -u topogeo topogeo store snapshot /var/lib/topogeo/map before-the-fair > /dev/null
here systemctl stop topogeo-map-store
here sudo -u topogeo topogeo store restore /var/lib/topogeo/map before-the-fair > /dev/null
here systemctl start topogeo-map-store
eventually 60 all_run || { cat "$work/status"; fail "not all services are well after the map was restored"; }
here systemctl stop topogeo.target topogeo-worker@1
for unit in navigator sensor-gateway local-mapper localizer map-store planner; do
  eventually 60 is_state topogeo-$unit ActiveState inactive || fail "topogeo-$unit ended with $(state topogeo-$unit Result)"
done
here test -s /var/lib/topogeo/map/map.pb || fail "no map at the end"
step "the end"
