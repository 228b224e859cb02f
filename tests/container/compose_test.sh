#!/usr/bin/env bash
# The services of a robot from compose.yaml, with certificates, as on the deployment page: all are well and healthy, the
# robot drives, a client without a certificate sees nothing, and the map is there at the end. A service that hangs makes
# its own container unhealthy.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need_engine
need docker-compose openssl
need_image
claim_domain
claim_domain_as truth  # domain of the simulator, which is outside the robot and has no certificate
chmod 755 "$work"

step "certificates, a laser and a base"
export IMAGE=$image DOMAIN=$TOPOGEO_DOMAIN SECURITY=$work/keys/robot DEVICES=$work/devices.yaml MAP=$work/map
export LOG=$work/log.clf OUT=$work/demo
source "$(dirname "${BASH_SOURCE[0]}")/compose.sh"
make_certificates "$work/keys"
mkdir "$work/map"
chown -R 1000 "$work/map"
# shellcheck disable=SC2154  # claim_domain_as sets it
"$bin/simulator" --domain "$truth" --world "$source_dir/share/worlds/room.world.yaml" --laser-port "$work/laser" \
  --base-port "$work/base" > "$work/simulator.log" 2>&1 &
cleanups+=("kill $!")
wait_for "the ports of the simulator" test -L "$work/base" || { tail -n 3 "$work/simulator.log"; fail "the simulator makes no ports"; }
"$bin/topogeo" config --devices > "$work/devices.yaml"
for device in laser base; do
  port=$(readlink "$work/$device")
  chmod 666 "$port"
  sed -i "/^$device:/,/port:/s#port: .*#port: $port#" "$work/devices.yaml"
done

step "the services"
# shellcheck disable=SC2119  # no argument: the whole profile
up
all_run() { secured status > "$work/status" 2>&1 && [ "$(grep -c ' running ' "$work/status")" = 6 ]; }
wait_for "all services to be well" all_run || { cat "$work/status"; compose logs --tail 5; fail "not all services are well"; }

step "a drive"
wait_for "the robot at 3,0" arrives secured goto 3,0 || fail "no drive"

step "a stranger"
refusals() { { secured status planner 2> /dev/null || true; } | awk '/^  fault .* peer refused/ { n = $2 } END { print n + 0 }'; }
before=$(refusals)
is_refused() { [ "$(refusals)" -gt "$before" ]; }
"$bin/topogeo" status --watch > "$work/stranger" 2>&1 &
stranger=$!
cleanups+=("kill $stranger")
tables() { grep -cE '^[0-9]+ services?' "$work/stranger" || true; }
wait_for "the refusal of a stranger" is_refused || { cat "$work/stranger"; secured status planner; fail "the planner does not refuse a stranger"; }
shown=$(tables)
shows_more() { [ "$(tables)" -ge $((shown + 5)) ]; }
wait_for "five more tables of the stranger" shows_more || { cat "$work/stranger"; fail "the stranger shows no tables"; }
kill $stranger || { cat "$work/stranger"; fail "the stranger ended by itself"; }
# It may list processes of its host, but no state of a service.
! grep -E ' (starting|waiting|running) ' "$work/stranger" || fail "a stranger sees the services"

step "a planner that hangs"
mapfile -t containers < <(compose ps -q planner; for service in sensor_gateway navigator local_mapper localizer map_store; do
  compose ps -q $service; done)
one_is_unhealthy "${containers[@]}"
step "a gateway that is started again in its container"
docker restart -t "$hang_limit_s" "${containers[1]}" > /dev/null
wait_for "a healthy gateway" is_health "${containers[1]}" healthy || { docker inspect "${containers[1]}"; fail "a gateway is unhealthy after its restart"; }
down
[ -s "$work/map/map.pb" ] || fail "no map at the end"
step "the end"
