#!/usr/bin/env bash
# The services of a robot from compose.yaml, with certificates, as the page of deployment has it: all are well and
# healthy, the robot drives, who has no certificate sees nothing, and at the end the map is there.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need docker-compose
need openssl
need_image
claim_domain
export TOPOGEO_DDS_PARTICIPANT=udp_only
chmod 755 "$work"

step "certificates, a laser and a base"
"$source_dir/deploy/security/make_keys" "$work/keys" issue robot > "$work/keys.log" 2>&1 ||
  { tail -n 3 "$work/keys.log"; fail "no certificates"; }
mkdir "$work/map"
chown -R 1000 "$work/keys/robot" "$work/map"
# Its own domain: it is not of the robot, and has no certificate.
"$bin/simulator" --domain 101 --world "$source_dir/tests/data/room.world.yaml" --laser-port "$work/laser" \
  --base-port "$work/base" > "$work/simulator.log" 2>&1 &
cleanups+=("kill $!")
eventually 20 test -L "$work/base" || { tail -n 3 "$work/simulator.log"; fail "the simulator makes no ports"; }
"$bin/topogeo" config --devices > "$work/devices.yaml"
for device in laser base; do
  port=$(readlink "$work/$device")
  chmod 666 "$port"
  sed -i "/^$device:/,/port:/s#port: .*#port: $port#" "$work/devices.yaml"
done

step "the services"
export IMAGE=$image DOMAIN=$TOPOGEO_DOMAIN SECURITY=$work/keys/robot DEVICES=$work/devices.yaml MAP=$work/map
export PARTICIPANT=udp_only
compose() { docker-compose -p "topogeo-$$" -f "$source_dir/deploy/compose.yaml" --profile robot "$@"; }
cleanups+=("compose down -t 5")
compose up -d > "$work/up.log" 2>&1 || { tail -n 5 "$work/up.log"; fail "compose up"; }
secured() { TOPOGEO_SECURITY=$SECURITY "$bin/topogeo" "$@"; }
all_run() { secured status > "$work/status" 2>&1 && [ "$(grep -c ' running ' "$work/status")" = 6 ]; }
eventually 90 all_run || { cat "$work/status"; compose logs --tail 5; fail "not all services are well"; }

step "a drive"
secured goto 3,0 --wait-seconds 60 --patience 120 > "$work/goto.log" 2>&1 || { tail -n 5 "$work/goto.log"; fail "no drive"; }
! "$bin/topogeo" status > "$work/stranger" 2>&1 || { cat "$work/stranger"; fail "a stranger sees the services"; }
are_healthy() { [ "$(compose ps -q | xargs docker inspect -f '{{ .State.Health.Status }}' | grep -c '^healthy')" = 6 ]; }
eventually 90 are_healthy || { compose ps; fail "not all containers are healthy"; }
compose down -t 60 > "$work/down.log" 2>&1 || { tail -n 5 "$work/down.log"; fail "compose down"; }
[ -s "$work/map/map.pb" ] || fail "no map at the end"
step "the end"
