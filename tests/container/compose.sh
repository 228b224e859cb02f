#!/usr/bin/env bash
# Functions that the tests of compose.yaml share. Sourced after common.sh, with IMAGE, DOMAIN, SECURITY, LOG and OUT of
# compose.yaml set.
# shellcheck disable=SC2154  # common.sh sets these variables

export TOPOGEO_DDS_PARTICIPANT=udp_only PARTICIPANT=udp_only
profile=robot  # the active profile

# make_certificates FOLDER
make_certificates() {
  "$source_dir/deploy/security/make_keys" "$1" issue --robot robot robot > "$1.log" 2>&1 ||
    { tail -n 3 "$1.log"; fail "no certificates"; }
  chown -R 1000 "$1/robot"
}
secured() { TOPOGEO_SECURITY=$SECURITY "$bin/topogeo" "$@"; }

# Health checks more often than every 30 s.
{ echo "services:"; printf '  %s: {healthcheck: {interval: 4s}}\n' \
  sensor_gateway navigator local_mapper localizer map_store planner worker; } > "$work/often.yaml"
files=(-f "$source_dir/deploy/compose.yaml" -f "$work/often.yaml")
if [ ${#sanitized[@]} -gt 0 ]; then  # like common.sh for `docker run`, with more memory
  echo "services:" > "$work/sanitized.yaml"
  sed -nE '/^services:/,$ s/^  ([a-z_0-9]+):$/\1/p' "$source_dir/deploy/compose.yaml" | while read -r service; do
    printf '  %s:\n    mem_limit: 2g\n    cap_add: [SYS_PTRACE]\n    volumes: ["%s", "%s"]\n    environment:\n' "$service" \
      "$build/reports:$build/reports" "$source_dir/tests/sanitizers:$source_dir/tests/sanitizers:ro"
    printf '      %s:\n' "${sanitizer_options[@]}"
  done >> "$work/sanitized.yaml"
  files+=(-f "$work/sanitized.yaml")
fi
compose() { docker-compose -p "topogeo-$$" "${files[@]}" --profile "$profile" "$@"; }
# Services leave their state in the memory of the host, for their next lives.
forget_states() { rm -f /dev/shm/topogeo-robot-odometry* /dev/shm/topogeo-robot-*.stop; }
forget_states
cleanups+=(forget_states "compose down -t 5")
# shellcheck disable=SC2016  # expanded when it runs
keepers+=('compose logs --no-color > "$work/compose.log" 2>&1')
up() { compose up -d "$@" > "$work/up.log" 2>&1 || { tail -n 5 "$work/up.log"; fail "compose up, profile $profile"; }; }
down() { compose down -t "$hang_limit_s" > "$work/down.log" 2>&1 || { tail -n 5 "$work/down.log"; fail "compose down, profile $profile"; }; }
health() { docker inspect -f '{{ .State.Health.Status }}' "$@"; }  # CONTAINER...
is_health() { [ "$(health "$1")" = "$2" ]; }                        # CONTAINER STATUS
all_healthy() { [ "$(health "$@" | sort | uniq -c | xargs)" = "$# healthy" ]; }
# Sends a signal to the program of a container, below its init: signal NAME CONTAINER
signal() { docker exec "$2" sh -c "kill -$1 \$(cat /proc/1/task/1/children)"; }
# one_is_unhealthy CONTAINER OTHERS...: a service that hangs makes only its own container unhealthy.
one_is_unhealthy() {
  wait_for "healthy containers" all_healthy "$@" || { compose ps; fail "not all containers are healthy"; }
  signal STOP "$1"
  wait_for "an unhealthy container" is_health "$1" unhealthy || { compose ps; fail "a container whose service hangs is $(health "$1")"; }
  # A late health check on a busy machine is not counted as a failure.
  wait_for "healthy containers of the others" all_healthy "${@:2}" || { compose ps; fail "a service that hangs makes the containers of others unhealthy"; }
  signal CONT "$1"
  # A service that its peers have dropped meanwhile ends and is restarted.
  wait_for "healthy containers" all_healthy "$@" || { compose ps; fail "a container does not get well when its service goes on"; }
}
