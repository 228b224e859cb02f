#!/usr/bin/env bash
# The services of a robot from compose.yaml, with certificates, as the page of deployment has it: all are well and
# healthy, the robot drives, who has no certificate sees nothing, and at the end the map is there. A service that hangs
# makes its own container unhealthy. Workers off the robot and the demo map a log as one process does.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need_engine
need docker-compose openssl
need_image
claim_domain
claim_domain_as truth  # of the simulator, which is not of the robot, and has no certificate
export TOPOGEO_DDS_PARTICIPANT=udp_only
chmod 755 "$work"

step "certificates, a laser and a base"
"$source_dir/deploy/security/make_keys" "$work/keys" issue robot > "$work/keys.log" 2>&1 ||
  { tail -n 3 "$work/keys.log"; fail "no certificates"; }
mkdir "$work/map"
chown -R 1000 "$work/keys/robot" "$work/map"
# shellcheck disable=SC2154  # claim_domain_as sets it
"$bin/simulator" --domain "$truth" --world "$source_dir/tests/data/room.world.yaml" --laser-port "$work/laser" \
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
export IMAGE=$image DOMAIN=$TOPOGEO_DOMAIN SECURITY=$work/keys/robot DEVICES=$work/devices.yaml MAP=$work/map
export PARTICIPANT=udp_only LOG=$work/log.clf OUT=$work/demo
# Health checks more often than each 30 s.
{ echo "services:"; printf '  %s: {healthcheck: {interval: 4s}}\n' \
  sensor_gateway navigator local_mapper localizer map_store planner worker; } > "$work/often.yaml"
files=(-f "$source_dir/deploy/compose.yaml" -f "$work/often.yaml")
if [ ${#sanitized[@]} -gt 0 ]; then  # as common.sh does with `docker run`; and more memory
  echo "services:" > "$work/sanitized.yaml"
  sed -nE '/^services:/,$ s/^  ([a-z_0-9]+):$/\1/p' "$source_dir/deploy/compose.yaml" | while read -r service; do
    printf '  %s:\n    mem_limit: 2g\n    cap_add: [SYS_PTRACE]\n    volumes: ["%s", "%s"]\n    environment:\n' "$service" \
      "$build/reports:$build/reports" "$source_dir/tests/sanitizers:$source_dir/tests/sanitizers:ro"
    printf '      %s:\n' "${sanitizer_options[@]}"
  done >> "$work/sanitized.yaml"
  files+=(-f "$work/sanitized.yaml")
fi
compose() { docker-compose -p "topogeo-$$" "${files[@]}" --profile "$profile" "$@"; }
profile=robot
cleanups+=("compose down -t 5")
# shellcheck disable=SC2016  # expanded when it is done
keepers+=('compose logs --no-color > "$work/compose.log" 2>&1')
up() { compose up -d "$@" > "$work/up.log" 2>&1 || { tail -n 5 "$work/up.log"; fail "compose up, profile $profile"; }; }
down() { compose down -t "$hang_limit_s" > "$work/down.log" 2>&1 || { tail -n 5 "$work/down.log"; fail "compose down, profile $profile"; }; }
health() { docker inspect -f '{{ .State.Health.Status }}' "$@"; }  # CONTAINER...
is_health() { [ "$(health "$1")" = "$2" ]; }                        # CONTAINER STATUS
all_healthy() { [ "$(health "$@" | sort | uniq -c | xargs)" = "$# healthy" ]; }
# To what runs in a container, below its init.
signal() { docker exec "$2" sh -c "kill -$1 \$(cat /proc/1/task/1/children)"; }
# What hangs makes its own container unhealthy and no other one: one_is_unhealthy CONTAINER OTHERS...
one_is_unhealthy() {
  wait_for "healthy containers" all_healthy "$@" || { compose ps; fail "not all containers are healthy"; }
  signal STOP "$1"
  wait_for "an unhealthy container" is_health "$1" unhealthy || { compose ps; fail "a container whose service hangs is $(health "$1")"; }
  # A check that a busy machine held up is no sign of it.
  wait_for "healthy containers of the others" all_healthy "${@:2}" || { compose ps; fail "a service that hangs makes the containers of others unhealthy"; }
  signal CONT "$1"
  # One that its peers have forgotten meanwhile ends, and is started again.
  wait_for "healthy containers" all_healthy "$@" || { compose ps; fail "a container does not get well when its service goes on"; }
}
up
secured() { TOPOGEO_SECURITY=$SECURITY "$bin/topogeo" "$@"; }
all_run() { secured status > "$work/status" 2>&1 && [ "$(grep -c ' running ' "$work/status")" = 6 ]; }
wait_for "all services to be well" all_run || { cat "$work/status"; compose logs --tail 5; fail "not all services are well"; }

step "a drive"
wait_for "the robot at 3,0" arrives secured goto 3,0 || fail "no drive"
! "$bin/topogeo" status > "$work/stranger" 2>&1 || { cat "$work/stranger"; fail "a stranger sees the services"; }

step "a planner that hangs"
mapfile -t containers < <(compose ps -q planner; for service in sensor_gateway navigator local_mapper localizer map_store; do
  compose ps -q $service; done)
one_is_unhealthy "${containers[@]}"
down
[ -s "$work/map/map.pb" ] || fail "no map at the end"

step "a log with two workers of profile offboard"
map_alone 60 "$work/alone"
chmod 644 "$LOG"
profile=offboard
up --scale worker=2
both_there() { secured workers --json > "$work/workers" && [ "$(grep -c '"worker_id"' "$work/workers")" = 2 ]; }
wait_for "both workers" both_there || { cat "$work/workers"; fail "not both workers are there"; }
both_worked() { secured workers --json > "$work/workers" && [ "$(grep -c '"tasks_done": [1-9]' "$work/workers")" = 2 ]; }
# Workers have a small share of the cores: where others want all of them, a robot may well be done before they are.
mapped_by_both() {
  rm -rf "$work/helped"
  secured run --log "$LOG" --out "$work/helped" --workers 0 --wait-workers 2 > "$work/run.log" 2>&1 ||
    { tail -n 5 "$work/run.log"; fail "topogeo run"; }
  same_results "$work/helped" "$work/alone"
  both_worked  # they report twice a second; after a report that came too late there is another run
}
wait_for "a run with work for both workers" mapped_by_both || { cat "$work/workers"; fail "not both workers had work"; }
step "a worker that hangs"
mapfile -t containers < <(compose ps -q)
one_is_unhealthy "${containers[@]}"
down

step "profile demo"
mkdir "$OUT"
profile=demo
up
wait_for "the map of the demo" test -e "$OUT/map.pb" || { compose logs --tail 5; fail "the demo makes no map"; }
down
same_results "$OUT" "$work/alone"
step "the end"
