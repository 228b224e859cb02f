#!/usr/bin/env bash
# `topogeo doctor` finds faults that need a network, mounts and users of their own. Each case has its own namespaces, so
# the machine stays unchanged.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

[ -x "$bin/topogeo" ] || skip "topogeo is not built" "./run build"
need unshare ip setpriv python3
unshare -m -n true 2> /dev/null || skip "this user may not make namespaces" "root, with CAP_SYS_ADMIN in a container,"
chmod 755 "$work"

# A machine without faults; each case breaks one of these.
# shellcheck disable=SC2016  # expanded in the namespace
well='
  ip link set lo up multicast on
  ip route add 239.255.0.0/16 dev lo
  mount -t tmpfs -o size=256m,mode=1777 tmpfs /dev/shm
  echo 4194304 > "$work/buffer"
  [ ! -e /proc/sys/net/core/rmem_default ] || mount --bind "$work/buffer" /proc/sys/net/core/rmem_default
  mkdir -p "$work/map"
'

# examine NAME COMMANDS [PREFIX...]: runs the commands in new namespaces, then doctor after the prefix. Its report is in
# $work/NAME.json, its exit code in $work/NAME.code.
examine() {
  local name=$1 commands=$2
  shift 2
  # shellcheck disable=SC2016
  work=$work bin=$bin unshare -m -n bash -euc '
    mount --make-rprivate /
    eval "$1"
    eval "$2"
    shift 2
    name=$1
    shift
    code=0
    "$@" "$bin/topogeo" doctor --alone --json --map "${map:-$work/map}" ${devices:+--devices "$devices"} \
      > "$work/$name.json" || code=$?
    echo $code > "$work/$name.code"
  ' bash "$well" "$commands" "$name" "$@" || fail "$name: the case cannot be made"
}

# expect NAME CHECK SEVERITY TEXT: the finding is present; a problem makes the exit code 1.
expect() {
  python3 - "$work/$1.json" "$(cat "$work/$1.code")" "$2" "$3" "$4" << 'PYTHON' || fail "$1"
import json, sys
report = json.load(open(sys.argv[1]))
code, check, severity, text = int(sys.argv[2]), *sys.argv[3:]
found = [f for f in report["findings"] if f["check"] == check and f["severity"] == severity and text in f["what"]]
if not found:
    sys.exit(f"no {severity} of {check} with '{text}' in {json.dumps(report['findings'], indent=1)}")
if severity != "ok" and not (found[0]["why"] and found[0]["remedy"]):
    sys.exit(f"no reason or remedy: {found[0]}")
if code != (1 if report["problems"] else 0):
    sys.exit(f"exit code {code} with {report['problems']} problems")
PYTHON
  step "$1: $2 is $3"
}

examine healthy ''
expect healthy multicast ok 'come back on lo'
expect healthy route ok '239.255.0.1'
expect healthy 'map folder' ok 'can write'
[ "$(cat "$work/healthy.code")" = 0 ] || { cat "$work/healthy.json"; fail "a healthy machine has a problem"; }

examine no_interface 'ip link set lo down'
expect no_interface multicast problem 'no network interface'

examine lo_only 'ip route del 239.255.0.0/16; ip link set lo multicast off'
expect lo_only multicast ok 'come back on lo'
expect lo_only route ok 'only lo is up'

examine no_route 'ip route del 239.255.0.0/16; ip link add v0 type veth peer name v1; ip link set v0 up; ip address add 10.77.0.1/24 dev v0'
expect no_route route problem 'no route leads to 239.255.0.1'

if command -v iptables > /dev/null; then
  examine firewall 'iptables -A INPUT -d 239.255.0.1 -j DROP'
  expect firewall multicast problem 'nothing comes back'
fi

# shellcheck disable=SC2016
examine port_taken '
  python3 -c "
import signal, socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind((\"0.0.0.0\", 7400))
open(\"$work/bound\", \"w\").close()
signal.pause()" &
  trap "kill $!" EXIT
  until [ -e "$work/bound" ]; do kill -0 $! && sleep 0.05; done  # between two checks'
expect port_taken ports problem 'python3'

if unshare -n test -e /proc/sys/net/core/rmem_default; then
  # shellcheck disable=SC2016
  examine small_buffer 'echo 65536 > "$work/buffer"'
  expect small_buffer 'UDP buffers' problem '65 KB'
  expect healthy 'UDP buffers' ok '4194 KB'
fi

examine small_memory 'export TOPOGEO_DDS_PARTICIPANT=local; mount -t tmpfs -o size=4m,mode=1777 tmpfs /dev/shm'
expect small_memory 'shared memory' problem '4 MB are free'

# A segment of a killed program: no process holds the lock beside it.
examine left_behind '
  export TOPOGEO_DDS_PARTICIPANT=local
  head -c 4000000 /dev/zero > /dev/shm/fastrtps_0123456789abcdef
  touch -d "1 hour ago" /dev/shm/fastrtps_0123456789abcdef_el'
expect left_behind 'shared memory' problem '1 segments (4 MB)'

nobody=(setpriv --reuid nobody --regid nogroup --clear-groups)
if "${nobody[@]}" "$bin/topogeo" --version > /dev/null 2>&1; then
  # shellcheck disable=SC2016
  examine not_in_dialout '
    mknod "$work/ttyUSB0" c 1 3
    chgrp dialout "$work/ttyUSB0"
    chmod 660 "$work/ttyUSB0"
    printf "laser:\n  port: %s\n" "$work/ttyUSB0" > "$work/devices.yaml"
    chown nobody "$work/map"
    export devices=$work/devices.yaml' "${nobody[@]}"
  expect not_in_dialout 'serial ports' problem 'belongs to group dialout'
  expect not_in_dialout 'map folder' ok 'nobody can write'

  # shellcheck disable=SC2016
  examine closed_folder 'chown root "$work/map"; chmod 755 "$work/map"' "${nobody[@]}"
  expect closed_folder 'map folder' problem 'nobody cannot write'
else
  step "others may not run what is built here: no cases with other users"
fi

# shellcheck disable=SC2016
examine small_disk 'mkdir "$work/disk"; mount -t tmpfs -o size=50m tmpfs "$work/disk"; export map=$work/disk/map'
expect small_disk disk problem 'MB are free'

examine few_files 'ulimit -n 64'
expect few_files 'open files' problem '64 files'

# A sanitizer reserves terabytes of address space.
if [ ${#sanitized[@]} -eq 0 ]; then
  examine memory_limit 'ulimit -v 240000'
  expect memory_limit memory problem 'no more than 246 MB'
fi
