#!/usr/bin/env bash
# Shared functions of the page's tests in Chromium; sourced.
# shellcheck disable=SC2317  # scripts that source it call its functions
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

# Skips where there is no browser, page or playwright-core.
need_browser() {
  need chromium-headless-shell
  [ -e "$build/share/topogeo/web/app.js" ] || skip "the page is not built" "./run build"
  need_node_packages
}

# Needs the programs of a simulated robot with all its services, and of the web service.
need_robot() {
  need_programs
  local program
  for program in web sensor_gateway local_mapper localizer map_store planner; do
    [ -x "$bin/$program" ] || skip "$program is not built" "./run build"
  done
}

# Fetched once; npm installs only packages that the lock file pins by hash.
need_node_packages() {
  need node npm
  [ "$(node -p 'parseInt(process.versions.node)')" -ge 18 ] || skip "Node $(node --version) is older than 18" "Node 18"
  local packages=$build/tests/browser
  mkdir -p "$packages"
  exec {lock}> "$packages/install.lock"
  flock "$lock"
  if ! cmp -s "$source_dir/tests/browser/package-lock.json" "$packages/installed.json"; then
    cp "$source_dir"/tests/browser/package*.json "$packages"
    (cd "$packages" && npm ci --no-audit --no-fund --ignore-scripts > npm.log 2>&1) ||
      skip "npm cannot fetch what the test needs, see $packages/npm.log" "a registry of npm that can be reached"
    cp "$packages/package-lock.json" "$packages/installed.json"
  fi
  exec {lock}>&-
}

# run_browser_test NAME: tests of NAME_test.mjs.
run_browser_test() {
  local chromium
  chromium=$(command -v chromium-headless-shell) || true
  if [ -n "$chromium" ]; then
    step "tests in $("$chromium" --version --no-sandbox)"
    # Chromium renders without a graphics card, on the robot's cores: a low priority keeps it out of the robot's way.
    printf '#!/bin/sh\nexec nice -n 10 %s "$@"\n' "$chromium" > "$work/chromium"
    chmod +x "$work/chromium"
    chromium=$work/chromium
  fi
  TOPOGEO_BUILD=$build TOPOGEO_SOURCE=$source_dir TOPOGEO_WORK=$work TOPOGEO_CHROMIUM=$chromium TOPOGEO_HANG_LIMIT_S=$hang_limit_s \
    node --test "$source_dir/tests/browser/$1_test.mjs" || { tail -n 5 "$work"/*.log; fail "$1"; }
}
