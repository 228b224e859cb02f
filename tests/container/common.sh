#!/usr/bin/env bash
# What the tests of this folder have in common. Sourced with the build folder as first argument of the test.
set -euo pipefail

source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(cd "${1:?"expected the build folder"}" && pwd)
bin=$build/bin
work=$(mktemp -d)
cleanups=()

# Keeps the files of a failed test, logs of services included: below the build folder when ctest runs it, else where
# they are if KEEP is set. Fails when they must stay there.
keep_files() {
  local folder=$build/tests/failed/${TOPOGEO_TEST_NAME:-}
  if [ -n "${TOPOGEO_TEST_NAME:-}" ]; then
    mkdir -p "$folder"
    # Device nodes, sockets and what other programs made there may stay behind.
    cp -a "$work/." "$folder" 2> /dev/null || true
    echo "kept: $folder" >&2
  elif [ -n "${KEEP:-}" ]; then
    echo "kept: $work" >&2
    return 1
  fi
}

# The last thing that was to be cleaned up goes first.
clean_up() {
  local status=$? i
  for ((i = ${#cleanups[@]} - 1; i >= 0; --i)); do eval "${cleanups[i]}" > /dev/null 2>&1 || true; done
  [ $status -eq 0 ] || [ $status -eq 77 ] || keep_files || return 0
  rm -rf "$work"
}
trap clean_up EXIT

step() { printf '%3d s: %s\n' $SECONDS "$*"; }
fail() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
skip() {
  [ "${TOPOGEO_NO_SKIPS:-}" != 1 ] || fail "it would be skipped, and TOPOGEO_NO_SKIPS is 1: $*"
  printf 'skipped: %s\n' "$*"
  exit 77  # SKIP_RETURN_CODE
}
need() { command -v "$1" > /dev/null || skip "$1 is not installed"; }
# there PROGRAM WITHOUT: for a part of a test; says what is WITHOUT it, and fails where CI is true, which installs all.
there() {
  ! command -v "$1" > /dev/null || return 0
  [ "${CI:-}" != true ] || fail "$1 is not installed: $2"
  echo "$1 is not installed: $2"
  return 1
}

# Programs with a sanitizer in containers report where others of this build do. What looks for leaks traces its process.
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

# eventually SECONDS COMMAND...: until the command succeeds.
eventually() {
  local end=$((SECONDS + $1 * ${TOPOGEO_TIME_FACTOR:-1}))
  shift
  until "$@"; do
    [ $SECONDS -lt $end ] || return 1
    sleep 0.2
  done
}

# A DDS domain that no other test has, in VARIABLE.
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

# One for all that is started from here on: a worker serves each partition of its domain, and this machine hears what
# containers say to a bridge.
claim_domain() {
  claim_domain_as TOPOGEO_DOMAIN
  export TOPOGEO_DOMAIN
}

need_programs() {
  local program
  for program in topogeo navigator simulator ga_worker; do
    [ -x "$bin/$program" ] || skip "the services are not built"
  done
}

# Two calls of Ninja in one folder would spoil each other's work.
lock_build() { exec 8> "$build/.packages.lock"; flock 8; }
unlock_build() { exec 8>&-; }

make_manuals() {  # with the build locked
  ninja -C "$build" manuals > "$work/ninja.log" 2>&1 || { cat "$work/ninja.log"; fail "manual pages"; }
}

# Packages of the programs as they are now.
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
  # Of GCC 12; elsewhere than in a container ./run starts it with fixed addresses.
  [ -z "${TSAN_OPTIONS:-}${ASAN_OPTIONS:-}" ] || [ "$(cat /proc/sys/vm/mmap_rnd_bits)" -le 28 ] ||
    skip "the sanitizer does not know the addresses here (sysctl vm.mmap_rnd_bits=28)"
  docker info > /dev/null 2>&1 || skip "no container engine runs (tests/container/start_engine starts one)"
}

image=topogeo-test

# The image of the packages; the tests share it.
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
    docker image inspect "$base" > /dev/null 2>&1 || timeout 120 docker pull -q "$base" > /dev/null 2>&1 ||
      "$source_dir/deploy/base-image.sh" "$base" > "$work/base.log" 2>&1 ||
      { tail -n 5 "$work/base.log"; skip "no base image can be pulled or made"; }
    step "making the image"
    BUILD=$build "$source_dir/deploy/image" $image --label key="$key" > "$work/image.log" 2>&1 ||
      { tail -n 30 "$work/image.log"; fail "the image cannot be made"; }
    step "made the image"
  fi
  exec 7>&-
}

# A log of the synthetic floor, its first N scans: log N FILE.
make_log() {
  local all=$build/tests/container-floor.clf
  exec 6> "$build/.log.lock"
  flock 6
  if [ ! -e "$all" ]; then
    # The demo writes the log first; what it makes of it is not needed here.
    "$bin/topogeo" demo --out "$work/made_log" --workers 0 > "$work/made_log.log" 2>&1 ||
      { cat "$work/made_log.log"; fail "topogeo demo"; }
    gunzip -c "$work/made_log/floor.clf.gz" > "$all.new"
    mv "$all.new" "$all"
  fi
  exec 6>&-
  awk -v most="$1" '/^FLASER/ && ++scans > most { exit } { print }' "$all" > "$2"
}

same_results() {  # DIR DIR
  local file
  for file in map.pb trajectory.tum; do
    [ -s "$1/$file" ] || fail "$1/$file is missing"
    cmp "$1/$file" "$2/$file" || fail "$file differs from that of one process"
  done
}
