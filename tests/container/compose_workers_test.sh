#!/usr/bin/env bash
# Workers off the robot and the demo from compose.yaml map a log as one process does. A worker that hangs makes its own
# container unhealthy.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need_engine
need docker-compose openssl
need_image
claim_domain
chmod 755 "$work"
export IMAGE=$image DOMAIN=$TOPOGEO_DOMAIN SECURITY=$work/keys/robot DEVICES=$work/devices.yaml MAP=$work/map
export LOG=$work/log.clf OUT=$work/demo
source "$(dirname "${BASH_SOURCE[0]}")/compose.sh"
make_certificates "$work/keys"

step "a log with two workers of profile offboard"
map_alone 60 "$work/alone"
chmod 644 "$LOG"
profile=offboard
up --scale worker=2
both_there() { secured workers --json > "$work/workers" && [ "$(grep -c '"worker_id"' "$work/workers")" = 2 ]; }
wait_for "both workers" both_there || { cat "$work/workers"; fail "not both workers are there"; }
both_worked() { secured workers --json > "$work/workers" && [ "$(grep -c '"tasks_done": [1-9]' "$work/workers")" = 2 ]; }
# Workers have a small share of the cores: on a busy machine a robot may be done before they are.
mapped_by_both() {
  rm -rf "$work/helped"
  secured run --log "$LOG" --out "$work/helped" --workers 0 --wait-workers 2 > "$work/run.log" 2>&1 ||
    { tail -n 5 "$work/run.log"; fail "topogeo run"; }
  same_results "$work/helped" "$work/alone"
  both_worked  # workers report twice a second; after a late report the run is repeated
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
