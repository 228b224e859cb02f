#!/usr/bin/env bash
# System calls of the services, and those that the units of deploy/systemd refuse: all services of a robot that explores
# a simulated room, each under strace and started as by its unit; with its keys when TOPOGEO_SECURITY is set.
#
#   tests/bench/system_calls.sh [BUILD]       needs strace and systemd-analyze; about two minutes
#
# A refused call gets EPERM (SystemCallErrorNumber=). Calls in `harmless` are accepted; any other refused one fails.
[ $# -gt 0 ] || set -- "$(dirname "${BASH_SOURCE[0]}")/../../build"
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

need strace systemd-analyze python3
need_programs
export TOPOGEO_DDS_PARTICIPANT=udp_only
claim_domain
# The gateway requests a high priority, which its unit (Nice=) has already set. SQLite changes the owner of files only
# as root, and no unit runs its service as root.
harmless=("sensor_gateway setpriority" "map_store fchown")

mkdir "$work/bin" "$work/calls"
for program in "$bin"/*; do ln -s "$program" "$work/bin/"; done
# `topogeo` finds the services beside its own executable.
cp --remove-destination "$bin/topogeo" "$work/bin/topogeo"
declare -A units=([sensor_gateway]=sensor-gateway [local_mapper]=local-mapper [localizer]=localizer [map_store]=map-store
  [planner]=planner [navigator]=navigator [ga_worker]=worker@)
for service in "${!units[@]}"; do
  rm "$work/bin/$service"
  # shellcheck disable=SC2016  # expanded in the wrapper, which stays the process that `topogeo run` ends
  printf '#!/bin/bash\nexec strace -D -f -c -U name,calls -o "%s.$$" "%s" "$@"\n' "$work/calls/$service" "$bin/$service" \
    > "$work/bin/$service"
  chmod +x "$work/bin/$service"
done

step "a robot explores a room, with watchdogs as of systemd"
export NOTIFY_SOCKET=@topogeo-calls-$$ WATCHDOG_USEC=60000000
timeout "$hang_limit_s" "$work/bin/topogeo" run --sim "$source_dir/share/worlds/room.world.yaml" --explore --workers 1 \
  --out "$work/out" > "$work/run.log" 2>&1 || { tail -n 5 "$work/run.log"; fail "the robot does not explore the room"; }

# allowed UNIT: the names of all calls that its filter lets through.
allowed() {
  python3 - "$source_dir/deploy/systemd/topogeo-$1.service" <<'PY'
import subprocess
import sys


def calls(name):
    """Those of a set of systemd, or the one of that name."""
    if not name.startswith("@"):
        return {name}
    text = subprocess.run(["systemd-analyze", "syscall-filter", name], check=True, capture_output=True, text=True).stdout
    names = [line.strip() for line in text.splitlines()]
    return set().union(*(calls(one) for one in names if one and not one.startswith("#") and one != name))


allowed = calls("@default")
with open(sys.argv[1]) as unit:
    for line in unit:
        if line.startswith("SystemCallFilter="):
            words = line.split("=", 1)[1].strip()
            some = set().union(*(calls(word) for word in words.lstrip("~").split()))
            allowed = allowed - some if words.startswith("~") else allowed | some
print("\n".join(sorted(allowed)))
PY
}

step "what their units refuse"
failed=0
for service in $(printf '%s\n' "${!units[@]}" | sort); do
  cat "$work/calls/$service".* | awk 'NF == 2 && $2 ~ /^[0-9]+$/ && $1 != "total" { print $1 }' | sort -u > "$work/made"
  [ -s "$work/made" ] || fail "$service has made no system call"
  allowed "${units[$service]}" > "$work/allowed"
  refused=$(LC_ALL=C comm -23 <(LC_ALL=C sort "$work/made") <(LC_ALL=C sort "$work/allowed") | xargs)
  printf '%-15s %3d system calls; refused: %s\n' "$service" "$(wc -l < "$work/made")" "${refused:-none}"
  for call in $refused; do
    printf '%s\n' "${harmless[@]}" | grep -Fqx "$service $call" || failed=1
  done
done
[ $failed = 0 ] || fail "a unit refuses what its service needs"
