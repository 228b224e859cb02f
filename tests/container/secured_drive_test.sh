#!/usr/bin/env bash
# Repeats tests with a driving robot, with keys: each service killed with -9, short emergency stops, a gateway that is
# gone, halts, Stop among hostile connections. Prints how long services take to work again.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need openssl
need_programs
export TOPOGEO_DDS_PARTICIPANT=udp_only
# The tests also publish as a base.
{ cat "$source_dir/deploy/security/permissions.txt"; echo "topogeo writes: base_status"; } > "$work/permissions.txt"
TOPOGEO_PERMISSIONS=$work/permissions.txt "$source_dir/deploy/security/make_keys" "$work/keys" issue --robot robot robot
export TOPOGEO_SECURITY=$work/keys/robot

# again PROGRAM TEST...: runs these tests with keys. An unknown test name is an error.
again() {
  local name
  for name in "${@:2}"; do
    "$build/tests/$1" --gtest_filter="$name" > "$work/$1.log" 2>&1 ||
      { tail -n 40 "$work/$1.log"; fail "with keys: $1 $name"; }
    grep -q '^\[  PASSED  \] [1-9]' "$work/$1.log" || fail "$1 has no test $name"
    grep -hE '^\[       OK \]|is at work again after|the slowest of' "$work/$1.log" || true
  done
}

step "without keys nobody hears these services"
claim_domain
"$bin/planner" --partition "secured-drive-$$" > "$work/planner.log" 2>&1 &
planner=$!
cleanups+=("kill $planner")
hears() { "$@" "$bin/topogeo" status planner --partition "secured-drive-$$" > /dev/null 2>&1; }
wait_for "a status of a secured service" hears env || fail "the keys do not work"
! hears env -u TOPOGEO_SECURITY || fail "the services are not secured"
kill "$planner"

step "each service killed while the robot drives to a goal"
again integration_navigator 'GotoLives.*'
step "each service killed while the robot maps"
again integration_simulation SimulationTest.TheMapEndsCompleteAndRightAfterEachServiceWasKilled
step "emergency stops, halts and the end of the gateway"
again integration_gateway 'GatewayInEmergency.*' GatewayOnDevices.HaltHoldsUntilReset GatewayOnDevices.EndOfTheGatewayStopsTheBase
step "Stop among hostile connections"
again unit_web_requests 'WebStop.*'
step "the end"
