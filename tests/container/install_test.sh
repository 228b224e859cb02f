#!/usr/bin/env bash
# Result of cmake --install: units that systemd accepts, and headers and libraries with which a program outside the
# project receives from a service.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need_programs
need curl
step "installing"
lock_build
make_manuals
DESTDIR=$work/root cmake --install "$build" --strip > "$work/install.log" 2>&1 ||
  { tail -n 5 "$work/install.log"; fail "cmake --install"; }
unlock_build
prefix=$work/root$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$build/CMakeCache.txt")

step "units"
# Certificates have dates: on machines that wait for a clock, no service starts before it is set.
late=$(grep -L '^After=.*time-sync\.target' "$prefix"/lib/systemd/system/*.service) || true
[ -z "$late" ] || fail "not after time-sync.target: $late"
if there systemd-analyze "the units are not checked"; then
  cp -r "$prefix/lib/systemd/system" "$work/units"
  # systemd looks programs up in the system's folders; here they are elsewhere.
  sed -Ei "s#^ExecStart=([^/ ][^ ]*)#ExecStart=$prefix/bin/\\1#" "$work"/units/*.service
  # Its package may be missing here.
  sed -i 's#^ExecStart=/usr/bin/fast-discovery-server#ExecStart=/bin/true#' "$work"/units/*.service
  for unit in "$work"/units/*@.service; do mv "$unit" "${unit/@/@1}"; done
  for unit in "$work"/units/*; do
    # Errors in other units of this machine are ignored.
    MANPATH=$prefix/share/man systemd-analyze verify "$unit" 2>&1 | grep -F topogeo > "$work/verify" || true
    [ ! -s "$work/verify" ] || { cat "$work/verify"; fail "$(basename "$unit")"; }
  done
  sed -i 's/^Restart=always/Restart=nonsense/' "$work/units/topogeo-worker@1.service"
  MANPATH=$prefix/share/man systemd-analyze verify "$work/units/topogeo-worker@1.service" 2>&1 | grep -q nonsense ||
    fail "systemd-analyze verify finds nothing wrong with a unit that is wrong"
fi

step "users and rights"
units=("$prefix"/lib/systemd/system/*.service)
shared=$(grep -h '^User=' "${units[@]}" | sort | uniq -d)
[ -z "$shared" ] || fail "several services have one user: $shared"
[ "$(grep -c '^User=' "${units[@]}" | grep -vc ':1$')" = 0 ] || fail "a service has no user"
[ "$(grep -l dialout "${units[@]}")" = "$prefix/lib/systemd/system/topogeo-sensor-gateway.service" ] ||
  fail "others than the gateway have the serial ports"
if there systemd-analyze "the rights of units are not checked"; then
  for unit in "${units[@]}"; do
    name=$(basename "$unit")
    cp "$unit" "$work/${name/@/@1}"
    # The threshold is in tenths. A unit without any restriction has 9 or more.
    systemd-analyze security --offline=true --threshold=30 "$work/${name/@/@1}" > "$work/exposure" 2>&1 ||
      { tail -n 1 "$work/exposure"; fail "$name can do too much"; }
  done
  sed '/^\(Protect\|Restrict\|Private\|SystemCall\|Capab\)/d' "${units[0]}" > "$work/topogeo-open.service"
  if systemd-analyze security --offline=true --threshold=30 "$work/topogeo-open.service" > "$work/exposure" 2>&1; then
    fail "a unit that can do much passes"
  fi
fi

step "compose file and manifests"
if there docker-compose "the compose file is not checked"; then
  for profile in robot ros web offboard demo; do
    DOMAIN=7 docker-compose -f "$source_dir/deploy/compose.yaml" --profile $profile config > "$work/$profile.yaml" ||
      fail "compose.yaml, $profile"
  done
  # A service uses the configured domain, and its health check names it.
  python3 - "$work"/{robot,ros,web,offboard,demo}.yaml <<'PY' || fail "compose.yaml"
import sys, yaml

for path in sys.argv[1:]:
    with open(path) as file:
        services = yaml.safe_load(file)["services"]
    for name, service in services.items():
        assert service["environment"]["TOPOGEO_DOMAIN"] == "7", (name, service["environment"])
        program = {"worker": "ga_worker"}.get(name, name)
        if service.get("network_mode") == "host":
            test = " ".join(service["healthcheck"]["test"])
            assert f"health {program}" in test, (name, test)
PY
fi
python3 - "$source_dir"/deploy/kubernetes/*.yaml <<'PY' || fail "manifests"
import sys, yaml

for path in sys.argv[1:]:
    with open(path) as file:
        documents = list(yaml.safe_load_all(file))
    labels = []
    for document in documents:
        assert {"apiVersion", "kind", "metadata"} <= set(document), document
        template = document.get("spec", {}).get("template")
        if template:
            assert document["spec"]["selector"]["matchLabels"] == template["metadata"]["labels"]
            labels.append(template["metadata"]["labels"])
            for container in template["spec"]["containers"]:
                assert container["resources"]["limits"]["memory"]
                assert container["securityContext"]["runAsNonRoot"]
    for document in documents:
        if document["kind"] == "Service":
            assert document["spec"]["selector"] in labels, document
PY

step "a subscriber"
if ! { cmake -S "$source_dir/tests/container/subscriber" -B "$work/subscriber" -G Ninja \
  -DCMAKE_PREFIX_PATH="$prefix" && ninja -C "$work/subscriber"; } > "$work/subscriber.log" 2>&1; then
  tail -n 30 "$work/subscriber.log"
  fail "the subscriber does not compile"
fi
step "the examples, each alone"
for example in follow_map publish_scans; do
  if ! { cmake -S "$source_dir/examples/$example" -B "$work/$example" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" &&
    ninja -C "$work/$example"; } > "$work/$example.log" 2>&1; then
    tail -n 30 "$work/$example.log"
    fail "$example does not compile alone"
  fi
  [ -x "$work/$example/$example" ] || fail "there is no program $example"
done
claim_domain
partition=install-test-$$
"$prefix/bin/topogeo-planner" --partition "$partition" --log-level off &
cleanups+=("kill $!")
heard=$(timeout "$hang_limit_s" "$work/subscriber/subscriber" "$TOPOGEO_DOMAIN" "$partition") || fail "the subscriber heard nothing"
[ "$heard" = planner ] || fail "the subscriber heard '$heard'"

step "health checks"
export TOPOGEO_HEALTH=$work/health TOPOGEO_LONGEST_FREEZE_S=$hang_limit_s
"$prefix/bin/topogeo-planner" --partition "$partition-health" --log-level off &
planner=$!
cleanups+=("kill $planner")
health() { "$source_dir/deploy/health" "$@" > "$work/health.log" 2>&1; }
# unwell REASON [SERVICE]: the check fails and gives this reason.
unwell() {
  ! health "${@:2}" || fail "healthy: $1"
  grep -q "$1" "$work/health.log" || { cat "$work/health.log"; fail "the health check does not say '$1'"; }
}
wait_for "a service that is well" health planner || { cat "$work/health.log"; fail "a service that runs is not well"; }
wait_for "all services to be well" health || { cat "$work/health.log"; fail "the services that run are not well"; }
unwell 'no service has written .*/localizer' localizer
# The age of a file is set, so that nothing waits until it is old.
kill -STOP $planner
wait_for "a service that stands" grep -q '^State:.T' /proc/$planner/status || fail "the planner does not stop"
touch -d '1 hour ago' "$TOPOGEO_HEALTH/planner.$planner"
unwell "planner.$planner has not reported for [0-9]* s: " planner
touch -d '1 hour' "$TOPOGEO_HEALTH/planner.$planner"
unwell "planner.$planner has not reported for -[0-9]* s: " planner
kill -CONT $planner
wait_for "a service that is well again" health planner || { cat "$work/health.log"; fail "a service that goes on is not well"; }
echo 'failed: no odometry' > "$TOPOGEO_HEALTH/localizer.1"
unwell 'localizer.1 has failed: no odometry'
wait_for "a service beside one that has failed" health planner || { cat "$work/health.log"; fail "a service is blamed for another one"; }
rm "$TOPOGEO_HEALTH/localizer.1"
# This shell has the number of a dead service, which started at another time.
printf 'running\n1\n' > "$TOPOGEO_HEALTH/localizer.$$"
unwell "localizer.$$ is of a process that has died: running" localizer
rm "$TOPOGEO_HEALTH/localizer.$$"
kill -9 $planner
wait $planner || true
touch -d '1 hour ago' "$TOPOGEO_HEALTH/planner.$planner"
unwell "planner.$planner has not reported"
# The next one removes the file that the killed one left, and its own at its end.
"$prefix/bin/topogeo-planner" --partition "$partition-health" --log-level off &
cleanups+=("kill $!")
wait_for "a service in place of the killed one" health || { cat "$work/health.log"; fail "a killed service is blamed on the next one"; }
kill $!
wait $! || fail "the planner ends with $?"
unwell 'no service has written'
unset TOPOGEO_HEALTH TOPOGEO_LONGEST_FREEZE_S

step "the operator's page"
make_log 60 "$work/log.clf"
"$prefix/bin/topogeo" map --log "$work/log.clf" --out "$work/map" > "$work/map.log" 2>&1 || { cat "$work/map.log"; fail "map"; }
# page_is_whole COMMAND...: every file that the served pages name exists.
page_is_whole() {
  local log=$work/$1.page file address
  "$prefix/bin/topogeo" "$@" --port 0 --domain "$TOPOGEO_DOMAIN" > "$log" 2>&1 &
  cleanups+=("kill $!")
  wait_for "the link of topogeo $1" grep -q 'spectators: ' "$log" || { cat "$log"; fail "topogeo $1 prints no link"; }
  address=$(sed -n 's/^spectators: *//p' "$log")
  for file in "" panel; do
    curl -sf "$address$file" > "$work/page.html" || fail "topogeo $1: /$file"
    grep -oE '(src|href)="[^"#]+"' "$work/page.html" | cut -d'"' -f2 > "$work/assets"
    { grep -q '\.js$' "$work/assets" && grep -q '\.css$' "$work/assets"; } || fail "topogeo $1: /$file names no script or style"
    while read -r asset; do
      { curl -sf "$address${asset#/}" -o "$work/asset" && [ -s "$work/asset" ]; } || fail "topogeo $1: /$file has no $asset"
    done < "$work/assets"
  done
}
page_is_whole view "$work/map/map.pb" --no-browser
page_is_whole web

step "signs of life for systemd"
# A socket of the service manager, as systemd creates it.
python3 - "$prefix/libexec/topogeo/planner" "$partition" "$hang_limit_s" <<'PY' || fail "sd_notify"
import os, socket, subprocess, sys, tempfile

path = os.path.join(tempfile.mkdtemp(), "notify")
manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
manager.bind(path)
manager.settimeout(int(sys.argv[3]))
planner = subprocess.Popen(
    [sys.argv[1], "--partition", sys.argv[2], "--log-level", "off"],
    env=dict(os.environ, NOTIFY_SOCKET=path, WATCHDOG_USEC="600000"))
seen = []
while not {"READY=1", "WATCHDOG=1"} <= set(seen) or not any(s.startswith("STATUS=") for s in seen):
    seen.append(manager.recv(4096).decode())
assert seen[0] == "READY=1", seen
planner.terminate()
while seen[-1] != "STOPPING=1":
    seen.append(manager.recv(4096).decode())
assert planner.wait() == 0
PY
