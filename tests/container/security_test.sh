#!/usr/bin/env bash
# DDS security with the material of make_keys: a whole run is that of one process; strangers get nothing and are
# counted and named: without certificate, of a foreign authority, expired, revoked; a worker that writes what is
# not its own is denied, even if its own side lets it.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need openssl
need_programs
export TOPOGEO_DDS_PARTICIPANT=udp_only
make_keys=$source_dir/deploy/security/make_keys
keys=$work/keys
claim_domain  # the participants of other tests would be strangers, too
partition=security-$$

secured() { TOPOGEO_SECURITY=$1 "${@:2}"; }
status() { secured "$1" "$bin/topogeo" status --partition $partition "${@:2}" 2>&1; }
start() {  # FOLDER SERVICE OPTIONS...
  TOPOGEO_SECURITY=$1 "$bin/$2" --partition $partition --log-level debug "${@:3}" \
    > "$work/$2.log" 2>&1 &
  pid=$!
  cleanups+=("kill $pid")
}
stop() { kill "$pid"; wait "$pid" || fail "a service ended with $?"; }
refused() {  # how often peers were refused, says the planner
  status "$keys/robot" planner | awk '/^  fault .* peer refused/ { print $2; found = 1 } END { if (!found) print 0 }'
}
# A planner that is late with its status on a busy machine fails one look.
count_refused() { before=$(refused); }
more_refused_than() { [ "$(refused)" -gt "$1" ]; }

step "keys"
"$make_keys" "$keys" issue robot
"$make_keys" "$keys" issue pc1 ga_worker status
"$make_keys" "$work/foreign" issue pc1 ga_worker status
[ -z "$(find "$keys" -name '*.key' -not -path '*/ca/*')" ] || fail "a key of an authority leaves ca"
[ -z "$(find "$keys" -type f -perm /077)" ] || fail "others can read keys"
sed -nE 's/^TOPOGEO_TOPIC\(\w+, *"(\w+)".*/\1/p' "$source_dir/libs/messaging/include/topogeo/messaging/topics.def" |
  sort > "$work/topics"
awk '!/^#/ && $2 == "writes:" { for (i = 3; i <= NF; i++) print $i }' "$source_dir/deploy/security/permissions.txt" |
  sort -u > "$work/written"
diff "$work/topics" "$work/written" || fail "topics (<) and the table of permissions (>) differ"

step "a whole run"
make_log 80 "$work/log.clf"
"$bin/topogeo" map --log "$work/log.clf" --out "$work/alone" > /dev/null 2>&1
secured "$keys/robot" "$bin/topogeo" run --log "$work/log.clf" --out "$work/run" > "$work/run.log" 2>&1 ||
  { cat "$work/run.log"; fail "the secured run"; }
same_results "$work/run" "$work/alone"
grep -q ' 0 sent to workers' "$work/run.log" && fail "the workers had no work"

# What the services themselves send must not look like a stranger's.
drops_unprotected() { status "$keys/robot" planner | grep unprotected_packet; }

step "without multicast"
# A network of its own: lo has no route for multicast there. Two addresses of hosts, as two hosts would have.
if unshare --net true 2> /dev/null; then
  # shellcheck disable=SC2016  # the words of the inner shell
  TOPOGEO_SECURITY=$keys/robot TOPOGEO_PEERS='127.0.0.1;localhost' unshare --net bash -c \
    'ip link set lo up && exec "$0" run --log "$1" --out "$2"' "$bin/topogeo" "$work/log.clf" "$work/peers" \
    > "$work/peers.log" 2>&1 || { cat "$work/peers.log"; fail "the secured run without multicast"; }
  same_results "$work/peers" "$work/alone"
fi
ROS_DISCOVERY_SERVER=127.0.0.1:11811 status "$keys/robot" > "$work/servers" && fail "security with servers"
grep -q "carry no security" "$work/servers" || { cat "$work/servers"; fail "no clear error with servers"; }

step "strangers"
start "$keys/robot" planner
planner=$pid
eventually 20 status "$keys/robot" > /dev/null || fail "the owner gets no status"
status "$keys/pc1" > /dev/null || fail "another host of the owner gets no status"
drops_unprotected && fail "the owner's packets are taken for a stranger's"
# A heartbeat that is not encrypted, as if a peer had sent it, to each participant that this host may have.
heartbeat='RTPS\x02\x02\x01\x0f\x01\x0f\x09\x09\x09\x09\x09\x09\x09\x09\x09\x09\x07\x01\x1c\x00\x00\x00\x00\x00'
heartbeat+='\x00\x00\x01\x02\x00\x00\x00\x00\xe8\x03\x00\x00\x00\x00\x00\x00\xe8\x03\x00\x00\x01\x00\x00\x00'
for number in {0..9}; do
  printf '%b' "$heartbeat" > "/dev/udp/127.0.0.1/$((7411 + 250 * TOPOGEO_DOMAIN + 2 * number))" || true
done
eventually 10 drops_unprotected || fail "a plain message in the name of a peer is not refused"
eventually 10 count_refused || fail "the planner does not say what it refused"
status "" > "$work/plain" && fail "a stranger without certificate gets a status"
eventually 10 more_refused_than "$before" || fail "the stranger without certificate is not counted"
status "$keys/robot" > "$work/named"
grep -q "peer refused: 'topogeo" "$work/named" || fail "the stranger is not named"
eventually 10 count_refused || fail "the planner does not say what it refused"
TOPOGEO_SECURITY=$work/foreign/pc1 "$bin/topogeo" status --partition $partition --watch \
  > "$work/foreign.log" 2>&1 &
pid=$!
cleanups+=("kill $pid")
eventually 20 more_refused_than "$before" || fail "the stranger of a foreign authority is not counted"
kill $pid
grep -q running "$work/foreign.log" && fail "a stranger of a foreign authority gets a status"

step "expired, renewed, revoked"
STARTDATE=20240101000000Z ENDDATE=20250101000000Z "$make_keys" "$keys" renew pc1 status
status "$keys/pc1" > "$work/expired" && fail "an expired certificate is accepted"
grep -q "was refused" "$work/expired" || { cat "$work/expired"; fail "an expired certificate has no clear error"; }
"$make_keys" "$keys" renew pc1 status
status "$keys/pc1" > /dev/null || fail "a renewed certificate is refused"
cp -r "$keys/pc1" "$work/stolen"
"$make_keys" "$keys" revoke pc1 status
"$make_keys" "$keys" list > "$work/list"
grep -q '^pc1/status .*, revoked$' "$work/list" || fail "the list does not show what is revoked"
told_of_list() { status "$keys/robot" planner | grep "new revocations" > /dev/null; }
eventually 10 told_of_list || fail "a running service does not notice a new list"
pid=$planner
stop
start "$keys/robot" planner  # reads the list of revoked certificates at its start
planner=$pid
eventually 20 status "$keys/robot" > /dev/null || fail "the owner gets no status"
eventually 10 count_refused || fail "the planner does not say what it refused"
status "$work/stolen" > /dev/null && fail "a revoked certificate is accepted"
eventually 10 more_refused_than "$before" || fail "the revoked certificate is not counted"
pid=$planner
stop

step "a worker that writes the map"
mkdir "$work/thief"
cp -r "$keys/pc1/ga_worker" "$work/thief/map_store"
secured "$work/thief" "$bin/map_store" --out "$work/thief/out" --partition $partition \
  > "$work/thief.log" 2>&1 && fail "a worker may write the map"
grep -q "denied by security" "$work/thief.log" || { cat "$work/thief.log"; fail "no clear error"; }
# Its own side no longer forbids it: a governance without access control, as if its program were changed.
sed 's#\(enable_write_access_control>\)true#\1false#; s#\(enable_read_access_control>\)true#\1false#;
  s#\(enable_join_access_control>\)true#\1false#' "$keys/ca/governance.xml" > "$work/governance.xml"
openssl smime -sign -text -in "$work/governance.xml" -out "$work/thief/map_store/governance.p7s" \
  -signer "$keys/ca/permissions_ca.pem" -inkey "$keys/ca/permissions_ca.key"
start "$keys/robot" local_mapper
mapper=$pid
eventually 20 status "$keys/robot" local_mapper > /dev/null || fail "the local mapper does not start"
start "$work/thief" map_store --out "$work/thief/out"
thief=$pid
sleep 5
if grep -q 'waiting: for scans' "$work/local_mapper.log"; then
  cat "$work/local_mapper.log"
  fail "the local mapper believes a worker"
fi
grep "peer refused" "$work/local_mapper.log" > "$work/refusals" || fail "the worker that writes the map is not counted"
pid=$thief
kill "$pid" 2> /dev/null || { cat "$work/map_store.log"; fail "the changed map store did not even start"; }
wait "$pid" 2> /dev/null || true
start "$keys/robot" map_store --out "$work/out"
believes() { grep -q 'waiting: for scans' "$work/local_mapper.log"; }
eventually 20 believes || { cat "$work/local_mapper.log"; fail "the local mapper does not hear the map store"; }
stop
pid=$mapper
stop
cat "$work/refusals"; step "the end"
