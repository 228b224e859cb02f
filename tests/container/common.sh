#!/usr/bin/env bash
# Shared functions of the tests of this folder. Sourced with the build folder as first argument of the test.
set -euo pipefail

source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(cd "${1:?"expected the build folder"}" && pwd)
bin=$build/bin
work=$(mktemp -d)
cleanups=()
keepers=()  # commands that add logs to $work before a test that failed cleans up

# keep_files: copies files that explain a failure, logs of services included, to build/tests/failed/NAME when ctest runs
# the test, else to $TOPOGEO_TEST_KEEP/NAME. With KEEP alone, all files stay in place and it fails. Maps, logs of scans
# and programs are left out, because they can be made again.
keep_files() {
  local keeper kept
  for keeper in "${keepers[@]}"; do eval "$keeper" > /dev/null 2>&1 || true; done
  if [ -z "${TOPOGEO_TEST_KEEP:-}${TOPOGEO_TEST_NAME:-}" ]; then
    [ -n "${KEEP:-}" ] || return 0
    echo "kept: $work" >&2
    return 1
  fi
  kept=${TOPOGEO_TEST_KEEP:-$build/tests/failed}/${TOPOGEO_TEST_NAME:-$(basename "$0" .sh)}
  rm -rf "$kept"
  mkdir -p "$kept"
  tar -C "$work" --exclude='*.clf' --exclude='*.pb' --exclude='*.sqlite*' --exclude='*.key' --exclude='key.pem' \
    --exclude='./root' --exclude='./nodes' --exclude='node_modules' -cf - . 2> /dev/null |
    tar -C "$kept" -xf - 2> /dev/null || true
  find "$kept" \( -type p -o -type s -o -type l -o -empty -o -size +20M \) -delete
  echo "kept: $kept" >&2
}

# Runs the last cleanup first; keeps files before that, while containers still exist.
clean_up() {
  local status=$? stays='' i
  if [ $status -ne 0 ] && [ $status -ne 77 ]; then keep_files || stays=1; fi
  for ((i = ${#cleanups[@]} - 1; i >= 0; --i)); do eval "${cleanups[i]}" > /dev/null 2>&1 || true; done
  [ -n "$stays" ] || rm -rf "$work"
}
trap clean_up EXIT

step() { printf '%3d s: %s\n' $SECONDS "$*"; }
fail() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }

# skip REASON [COMMAND]: ends the test as skipped; COMMAND makes it run. Other programs parse this output.
skip() {
  [ "${TOPOGEO_NO_SKIPS:-}" != 1 ] || fail "it would be skipped, and TOPOGEO_NO_SKIPS is 1: $1"
  printf 'skipped: %s; %s makes it run\n' "$1" "${2:-./run build}"
  exit 77  # SKIP_RETURN_CODE
}
# installs PROGRAM...: prints the command that installs them.
installs() {
  local program stage stages=''
  for program in "$@"; do
    case $program in
      chromium-headless-shell | node | npm) stage=browser ;;
      tsc | lintian | systemd-analyze | git) stage=check ;;
      esbuild | dpkg-shlibdeps) stage=build ;;
      curl | setpriv | unshare | nsenter) echo "apt-get install curl util-linux"; return ;;
      *) stage=container ;;
    esac
    [[ " $stages " == *" $stage "* ]] || stages+=" $stage"
  done
  echo "./run packages --install$stages"
}
# need PROGRAM...: skips the test unless all of them are installed.
need() {
  local program absent=()
  for program in "$@"; do command -v "$program" > /dev/null || absent+=("$program"); done
  [ ${#absent[@]} -eq 0 ] || skip "without ${absent[*]}" "$(installs "${absent[@]}")"
}
# there PROGRAM WITHOUT: for a part of a test; prints what is WITHOUT it; fails when CI is true, because CI installs
# all.
there() {
  ! command -v "$1" > /dev/null || return 0
  [ "${CI:-}" != true ] || fail "$1 is not installed: $2"
  echo "$1 is not installed: $2; $(installs "$1") makes it run"
  return 1
}

# Containers with a sanitizer report to the folder of this build. The leak checker traces its process.
sanitizer_options=(ASAN_OPTIONS LSAN_OPTIONS UBSAN_OPTIONS TSAN_OPTIONS)
sanitized=()
if [ -n "${ASAN_OPTIONS:-}${TSAN_OPTIONS:-}" ]; then
  mkdir -p "$build/reports"
  chmod 1777 "$build/reports"
  sanitized=(-v "$build/reports:$build/reports" -v "$source_dir/tests/sanitizers:$source_dir/tests/sanitizers:ro"
    --cap-add SYS_PTRACE "${sanitizer_options[@]/#/--env=}")
  ! command -v docker > /dev/null || docker() {
    if [ "$1" = run ]; then command docker run "${sanitized[@]}" "${@:2}"; else command docker "$@"; fi
  }
fi

# A longer wait is a hang: five minutes, longer on a slow machine. No verdict depends on it.
hang_limit_s=$(awk -v factor="${TOPOGEO_TIME_FACTOR:-1}" 'BEGIN { print int(300 * (factor > 1 ? factor : 1)) }')

# wait_for WHAT COMMAND...: until the command succeeds. Prints every ten seconds what it waits for; fails after a hang.
wait_for() {
  local what=$1 start=$SECONDS report=$((SECONDS + 10))
  shift
  until "$@"; do
    if [ $SECONDS -ge $((start + hang_limit_s)) ]; then
      printf '%3d s: gave up after %d s: %s\n' $SECONDS $((SECONDS - start)) "$what" >&2
      return 1
    fi
    if [ $SECONDS -ge $report ]; then
      report=$((SECONDS + 10))
      printf '%3d s: still waiting for %s\n' $SECONDS "$what"
    fi
    sleep 0.2  # between two checks
  done
}
# Patience of our programs, as options: they give up when wait_for would.
# shellcheck disable=SC2034  # used by the tests
patient=(--wait-seconds "$hang_limit_s" --patience "$hang_limit_s")

# arrives COMMAND...: whether `topogeo goto` has brought the robot there; its output is in $work/goto.log. It gives up
# after ten seconds without the navigator, for instance on a busy machine: then the goal must be sent again.
arrives() {
  ! "$@" "${patient[@]}" > "$work/goto.log" 2>&1 || return 0
  tail -n 1 "$work/goto.log" | grep -q 'the navigator is gone\|the navigator does not take the goal' ||
    { tail -n 5 "$work/goto.log"; fail "the robot does not arrive: $*"; }
  return 1
}

now_ms() { echo $(($(date +%s%N) / 1000000)); }

# Sets VARIABLE to a DDS domain that no other test uses.
claim_domain_as() {  # VARIABLE
  local lock number
  for number in {1..100}; do
    exec {lock}>> "${TMPDIR:-/tmp}/topogeo_test_domain_$number.lock"
    if flock -n "$lock"; then
      printf -v "$1" %s "$number"
      return
    fi
    exec {lock}>&-
  done
  fail "no free DDS domain from 1 to 100"
}

# One domain for all that is started from here on, because a worker serves each partition of its domain, and this
# machine receives what containers send to a bridge.
claim_domain() {
  claim_domain_as TOPOGEO_DOMAIN
  export TOPOGEO_DOMAIN
}

need_programs() {
  local program
  for program in topogeo navigator simulator ga_worker; do
    [ -x "$bin/$program" ] || skip "$program is not built"
  done
}

# Concurrent calls of Ninja in one folder would corrupt each other's work.
lock_build() { exec 8> "$build/.packages.lock"; flock 8; }
unlock_build() { exec 8>&-; }

make_manuals() {  # with the build locked
  ninja -C "$build" manuals > "$work/ninja.log" 2>&1 || { cat "$work/ninja.log"; fail "manual pages"; }
}

# Makes packages of the current programs if needed.
need_packages() {
  need dpkg-shlibdeps
  need_programs
  lock_build
  local newest
  newest=$(find "$bin" "$source_dir/cmake" "$source_dir/deploy" -newer "$build/packages/topogeo_0.1.0_amd64.deb" -type f \
    2> /dev/null | head -n 1) || true
  if [ ! -e "$build/packages/topogeo_0.1.0_amd64.deb" ] || [ -n "$newest" ]; then
    step "making packages"
    make_manuals
    (cd "$build" && cpack > "$work/cpack.log" 2>&1) || { cat "$work/cpack.log"; fail "cpack"; }
  fi
  unlock_build
}

need_engine() {
  need docker
  # A limit of GCC 12; outside containers ./run starts it with fixed addresses.
  [ -z "${TSAN_OPTIONS:-}${ASAN_OPTIONS:-}" ] || [ "$(cat /proc/sys/vm/mmap_rnd_bits)" -le 28 ] ||
    skip "the sanitizer does not know the addresses here" "sysctl vm.mmap_rnd_bits=28"
  docker info > /dev/null 2>&1 || skip "no container engine runs" tests/container/start_engine
}

image=topogeo-test

# The image with the packages; the tests share it.
need_image() {
  need_engine
  need_packages
  exec 7> "$build/.image.lock"
  flock 7
  local key
  key=$(sha256sum "$build"/packages/*.deb "$source_dir"/deploy/{Dockerfile,health,install-packages} |
    sha256sum | cut -c1-16)
  if [ "$(docker image inspect -f '{{ index .Config.Labels "key" }}' $image 2> /dev/null)" != "$key" ]; then
    local base=${BASE:-debian:bookworm}
    # Without a registry, a mirror of packages is the fallback, after two minutes.
    docker image inspect "$base" > /dev/null 2>&1 || timeout 120 docker pull -q "$base" > /dev/null 2>&1 ||
      "$source_dir/deploy/base-image.sh" "$base" > "$work/base.log" 2>&1 ||
      { tail -n 5 "$work/base.log"; skip "no base image can be pulled or made" "docker pull $base"; }
    step "making the image"
    BUILD=$build "$source_dir/deploy/image" $image --label key="$key" > "$work/image.log" 2>&1 ||
      { tail -n 30 "$work/image.log"; fail "the image cannot be made"; }
    step "made the image"
  fi
  exec 7>&-
}

# make_log N FILE: writes the first N scans of a log of the synthetic floor.
make_log() {
  local all=$build/tests/container-floor.clf
  exec 6> "$build/.log.lock"
  flock 6
  if [ ! -e "$all" ]; then
    # The demo writes the log first; its map is not needed here.
    "$bin/topogeo" demo --out "$work/made_log" --workers 0 > "$work/made_log.log" 2>&1 ||
      { cat "$work/made_log.log"; fail "topogeo demo"; }
    gunzip -c "$work/made_log/floor.clf.gz" > "$all.new"
    mv "$all.new" "$all"
  fi
  exec 6>&-
  awk -v most="$1" '/^FLASER/ && ++scans > most { exit } { print }' "$all" > "$2"
}

# map_alone N DIR: the results of one process on the first N scans, in a log named log.clf. Made once for all tests.
map_alone() {
  local kept
  make_log "$1" "$work/log.clf"
  kept=$build/tests/alone-$(cat "$bin/topogeo" "$work/log.clf" | sha256sum | cut -c1-16)
  exec 5>> "$build/.alone.lock"
  flock 5
  if [ ! -e "$kept" ]; then
    "$bin/topogeo" map --log "$work/log.clf" --out "$kept.new" > "$work/alone.log" 2>&1 ||
      { cat "$work/alone.log"; fail "topogeo map"; }
    mv -T "$kept.new" "$kept"
  fi
  exec 5>&-
  cp -r "$kept" "$2"
}

same_results() {  # DIR DIR
  local file
  for file in map.pb trajectory.tum; do
    [ -s "$1/$file" ] || fail "$1/$file is missing"
    cmp "$1/$file" "$2/$file" || fail "$file differs from that of one process"
  done
}
