#!/usr/bin/env bash
# DDS security with the keys of make_keys: a whole run equals that of one process; strangers get nothing and are counted
# and named: without certificate, of a foreign authority, expired, revoked; a worker that writes the map or motion
# commands is denied, even if its own side permits it. Packets show only what the specification leaves plain.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need openssl faketime python3
need_programs
export TOPOGEO_DDS_PARTICIPANT=udp_only
make_keys=$source_dir/deploy/security/make_keys
keys=$work/keys
claim_domain  # the participants of other tests would be strangers, too
partition=security-$$
robot=rumpelstiltskin  # in each message, and in the name of each participant

secured() { TOPOGEO_SECURITY=$1 "${@:2}"; }
status() { secured "$1" "$bin/topogeo" status --partition $partition "${@:2}" 2>&1; }
start() {  # FOLDER SERVICE OPTIONS...
  TOPOGEO_SECURITY=$1 "$bin/$2" --partition $partition --log-level debug "${@:3}" \
    > "$work/$2.log" 2>&1 &
  pid=$!
  cleanups+=("kill $pid")
}
gives_status() { status "$@" > /dev/null; }
answers() { wait_for "a status of ${*:2}" gives_status "$@"; }  # FOLDER [SERVICE]
stop() { kill "$pid"; wait "$pid" || fail "a service ended with $?"; }

before=0  # peers that the planner had refused
heard=0   # log lines until then
# counts NAME: whether the planner has refused more peers than before, including NAME. Its log has the name, because its
# last error may already be another one.
counts() {
  status "$keys/robot" planner > "$work/planner.status" || return 1
  local refused
  refused=$(awk '/^  fault .* peer refused/ { print $2 }' "$work/planner.status")
  [ "${refused:-0}" -gt "$before" ] || return 1
  tail -n "+$((heard + 1))" "$work/planner.log" | grep -q "peer refused: $1" || return 1
  before=$refused
  heard=$(wc -l < "$work/planner.log")
}

# refuses WHO NAME ENVIRONMENT...: a program that requests the status with this environment gets nothing, and the
# planner counts and names it.
refuses() {
  env "${@:3}" "$bin/topogeo" status --partition $partition --watch > "$work/$1.log" 2>&1 &
  pid=$!
  cleanups+=("kill $pid")
  wait_for "the refusal of $1" counts "$2" ||
    { cat "$work/$1.log" "$work/planner.status"; tail -n 20 "$work/planner.log"; fail "the stranger is not counted and named: $1"; }
  kill $pid || fail "the stranger ended by itself: $1"
  # The planner runs on this host, so that its process alone gives a silent row after some seconds.
  ! grep '^planner' "$work/$1.log" | grep -Ev '^planner +silent +- +- +-' || fail "a stranger gets a status: $1"
}

# Sets the clock back by 400 days, except the steady clock. The command `faketime` would be another process to end.
past=(LD_PRELOAD="$(find /usr/lib -name libfaketimeMT.so.1 | head -n 1)" FAKETIME=-400d
  FAKETIME_DONT_FAKE_MONOTONIC=1)

step "keys"
# One certificate was issued 400 days ago and is still valid; the other was valid for a month.
env "${past[@]}" "$make_keys" "$keys" issue --robot all robot
env "${past[@]}" DAYS=30 "$make_keys" "$keys" issue --robot all old status
"$make_keys" "$keys" issue --robot all pc1 ga_worker status
"$make_keys" "$work/foreign" issue --robot all abroad status
[ -z "$(find "$keys" -name '*.key' -not -path '*/ca/*')" ] || fail "a key of an authority leaves ca"
[ -z "$(find "$keys" -type f -perm /077)" ] || fail "others can read keys"
sed -nE 's/^TOPOGEO_TOPIC\(\w+, *"(\w+)".*/\1/p' "$source_dir/libs/messaging/include/topogeo/messaging/topics.def" |
  sort > "$work/topics"
awk '!/^#/ && $2 == "writes:" { for (i = 3; i <= NF; i++) print $i }' "$source_dir/deploy/security/permissions.txt" |
  sort -u > "$work/written"
diff "$work/topics" "$work/written" || fail "topics (<) and the table of permissions (>) differ"

step "a whole run"
make_log 80 "$work/log.clf"
"$bin/topogeo" map --log "$work/log.clf" --robot $robot --out "$work/alone" > /dev/null 2>&1
secured "$keys/robot" "$bin/topogeo" run --log "$work/log.clf" --robot $robot --out "$work/run" \
  > "$work/run.log" 2>&1 ||
  { cat "$work/run.log"; fail "the secured run"; }
same_results "$work/run" "$work/alone"

# Packets of the services themselves must not look like those of a stranger.
drops_unprotected() { status "$keys/robot" planner | grep unprotected_packet; }

step "packets, without multicast"
# overheard NAME FOLDER: writes what a listener can read while a log is mapped to $work/NAME.readable. It has a network
# of its own, where lo has no route for multicast, and two host addresses, like two hosts.
overheard() {
  # shellcheck disable=SC2016  # the words of the inner shell
  TOPOGEO_SECURITY=$2 TOPOGEO_PEERS='127.0.0.1;localhost' unshare --net bash -c 'ip link set lo up && exec "$@"' - \
    python3 "$source_dir/tests/container/packets.py" $robot "$work/log.clf" \
    "$bin/topogeo" run --log "$work/log.clf" --robot $robot --out "$work/$1" > "$work/$1.readable" 2> "$work/$1.log" ||
    { cat "$work/$1.log"; fail "the $1 run without multicast"; }
  same_results "$work/$1" "$work/alone"
}
if unshare --net true 2> /dev/null; then
  overheard secured "$keys/robot"
  echo AES-256-GCM | diff - "$work/secured.readable" || fail "packets of secured services are not as expected (<)"
  overheard plain ""
  # A short run may have no liveliness messages.
  grep -vx liveliness "$work/plain.readable" | diff <(printf '%s\n' "discovery of topics" "key of the robot" \
    match_tasks "messages of topics" "name of a topic" "name of a type" "name of a worker" "name of the robot" \
    "ranges of a scan" service_status) - || fail "a listener does not read plain packets as expected (<)"
else
  [ "${CI:-}" != true ] || fail "no network namespace can be made"
  echo "no network namespace can be made: packets are not examined"
fi
ROS_DISCOVERY_SERVER=127.0.0.1:11811 status "$keys/robot" > "$work/servers" && fail "security with servers"
grep -q "carry no security" "$work/servers" || { cat "$work/servers"; fail "no clear error with servers"; }

step "strangers"
start "$keys/robot" planner
planner=$pid
answers "$keys/robot" || fail "the owner gets no status"
answers "$keys/pc1" || fail "another host of the owner gets no status"
drops_unprotected && fail "the owner's packets are taken for a stranger's"
# An unencrypted heartbeat, as if from a peer, to each possible participant of this host.
heartbeat='RTPS\x02\x02\x01\x0f\x01\x0f\x09\x09\x09\x09\x09\x09\x09\x09\x09\x09\x07\x01\x1c\x00\x00\x00\x00\x00'
heartbeat+='\x00\x00\x01\x02\x00\x00\x00\x00\xe8\x03\x00\x00\x00\x00\x00\x00\xe8\x03\x00\x00\x01\x00\x00\x00'
for number in {0..9}; do
  printf '%b' "$heartbeat" > "/dev/udp/127.0.0.1/$((7411 + 250 * TOPOGEO_DOMAIN + 2 * number))" || true
done
wait_for "the refusal of a plain message" drops_unprotected || fail "a plain message in the name of a peer is not refused"
refuses "no certificate" "'topogeo status' ([0-9a-f.]*)" TOPOGEO_SECURITY=
refuses "foreign authority" "'topogeo status' (/O=topogeo/CN=status.abroad;" TOPOGEO_SECURITY="$work/foreign/abroad"

step "expired, renewed, revoked"
# The client's clock is in the past: its certificate is valid there, and it accepts the planner.
refuses expired "'topogeo status' (/O=topogeo/CN=status.old;" TOPOGEO_SECURITY="$keys/old" "${past[@]}"
STARTDATE=20240101000000Z ENDDATE=20250101000000Z "$make_keys" "$keys" renew pc1 status
status "$keys/pc1" > "$work/expired" && fail "an expired certificate is accepted"
grep -q "was refused" "$work/expired" || { cat "$work/expired"; fail "an expired certificate has no clear error"; }
"$make_keys" "$keys" renew pc1 status
answers "$keys/pc1" || fail "a renewed certificate is refused"
# The stolen certificate may be older than the last renewal.
cp -r "$keys/pc1" "$work/stolen"
"$make_keys" "$keys" renew pc1 status
"$make_keys" "$keys" revoke pc1 status
"$make_keys" "$keys" list > "$work/list"
grep -q '^pc1/status .*, revoked$' "$work/list" || fail "the list does not show what is revoked"
told_of_list() { status "$keys/robot" planner | grep "new revocations" > /dev/null; }
wait_for "the notice of a new list" told_of_list || fail "a running service does not notice a new list"
pid=$planner
stop
start "$keys/robot" planner  # reads the list of revoked certificates at its start
planner=$pid
before=0
heard=0
answers "$keys/robot" || fail "the owner gets no status"
refuses revoked "'topogeo status' (/O=topogeo/CN=status.pc1;" TOPOGEO_SECURITY="$work/stolen"
pid=$planner
stop

step "a worker that writes the map and motion commands"
write_commands() {  # FOLDER ENVIRONMENT...: writes as the navigator
  env TOPOGEO_SECURITY="$1" "${@:2}" "$build/tests/command_writer" "$TOPOGEO_DOMAIN" $partition \
    > "$work/commands" 2> "$work/command_writer.log" &
  pid=$!
  cleanups+=("kill $pid")
}
has_written() { [ "$(wc -l < "$work/commands")" -ge "$1" ]; }
ask() { status "$keys/robot" "$1" > "$work/$1.status"; }  # SERVICE
hears_commands() { ask sensor_gateway && grep -Eq '^  received +motion_command +[1-9]' "$work/sensor_gateway.status"; }
believes() { grep -q 'waiting: for scans' "$work/local_mapper.log"; }
# denies SERVICE NAME WHAT: whether the service has refused the worker under this name.
denies() {
  ask "$1" && grep -q '^  fault .* peer refused' "$work/$1.status" &&
    grep -q "refused: 'robot/$2' (/O=topogeo/CN=ga_worker.pc1; [0-9a-f.]*) may not $3" "$work/$1.log"
}

"$bin/topogeo" config --devices > "$work/devices.yaml"
start "$keys/robot" sensor_gateway --devices "$work/devices.yaml" \
  --laser-port "$work/no_laser" --base-port "$work/no_base"
gateway=$pid
start "$keys/robot" local_mapper
mapper=$pid
answers "$keys/robot" sensor_gateway || fail "the sensor gateway does not start"
answers "$keys/robot" local_mapper || fail "the local mapper does not start"
mkdir "$work/thief"
cp -r "$keys/pc1/ga_worker" "$work/thief/map_store"
cp -r "$keys/pc1/ga_worker" "$work/thief/navigator"
denied_by_itself() {  # PROGRAM OPTIONS...
  secured "$work/thief" timeout "$hang_limit_s" "$@" > "$work/thief.log" 2>&1 && fail "a worker may do the work of another"
  grep -q "denied by security" "$work/thief.log" || { cat "$work/thief.log"; fail "no clear error of $1"; }
}
denied_by_itself "$bin/map_store" --out "$work/thief/out" --partition $partition
denied_by_itself "$build/tests/command_writer" "$TOPOGEO_DOMAIN" $partition

# steal HOW ENVIRONMENT...: the worker's own side no longer forbids it.
steal() {
  write_commands "$work/thief" "${@:2}"
  local commands=$pid
  wait_for "the refusal of a worker as navigator" denies sensor_gateway navigator "write topogeo/v[0-9]*/motion_command$why" ||
    { cat "$work/sensor_gateway.status"; fail "the worker that writes motion commands is not counted and named: $1"; }
  env TOPOGEO_SECURITY="$work/thief" "${@:2}" "$bin/map_store" --out "$work/thief/out" --partition $partition \
    > "$work/map_store.log" 2>&1 &
  local store=$!
  cleanups+=("kill $store")
  wait_for "the refusal of a worker as map store" denies local_mapper map_store "$why" ||
    { cat "$work/local_mapper.status"; fail "the worker that writes the map is not counted and named: $1"; }
  wait_for "motion commands of the worker" has_written $(($(wc -l < "$work/commands") + 40)) || fail "the worker ends its motion commands: $1"
  wait_for "a status of the gateway" ask sensor_gateway || fail "the sensor gateway gives no status"
  grep -Eq '^  received +motion_command +0,' "$work/sensor_gateway.status" ||
    { cat "$work/sensor_gateway.status"; fail "the gateway takes a worker's motion commands: $1"; }
  believes && { cat "$work/local_mapper.log"; fail "the local mapper believes a worker: $1"; }
  for pid in "$store" "$commands"; do
    kill "$pid" || { cat "$work/map_store.log"; fail "a changed program did not even start: $1"; }
  done
  wait "$store" "$commands" || true
}
why=""
steal "changed program" LD_PRELOAD="$build/tests/permissive.so"
# A governance without access control.
sed 's#\(enable_write_access_control>\)true#\1false#; s#\(enable_read_access_control>\)true#\1false#;
  s#\(enable_join_access_control>\)true#\1false#' "$keys/ca/governance.xml" > "$work/governance.xml"
for service in map_store navigator; do
  openssl smime -sign -text -in "$work/governance.xml" -out "$work/thief/$service/governance.p7s" \
    -signer "$keys/ca/permissions_ca.pem" -inkey "$keys/ca/permissions_ca.key"
done
why=".*: its governance differs"
steal "changed governance"

write_commands "$keys/robot"
navigator=$pid
wait_for "commands of the navigator at the gateway" hears_commands || fail "the gateway does not hear the navigator"
start "$keys/robot" map_store --out "$work/out"
wait_for "the map store at the local mapper" believes ||
  { cat "$work/local_mapper.log"; fail "the local mapper does not hear the map store"; }
stop
for pid in $navigator $gateway $mapper; do stop; done
step "the end"
