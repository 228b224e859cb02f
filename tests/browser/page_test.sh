#!/usr/bin/env bash
# The operator's page in Chromium, driven by playwright-core.
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

need node
need npm
need chromium
need_programs
for program in web sensor_gateway local_mapper localizer map_store planner; do
  [ -x "$bin/$program" ] || skip "the program $program is not built"
done
[ -e "$build/share/topogeo/web/app.js" ] || skip "the page is not built"
[ "$(node -p 'parseInt(process.versions.node)')" -ge 18 ] || skip "Node $(node --version) is older than 18"

# Fetched once; npm takes nothing else than what the lock file names by its hash.
packages=$build/tests/browser
mkdir -p "$packages"
if ! cmp -s "$source_dir/tests/browser/package-lock.json" "$packages/installed.json"; then
  cp "$source_dir"/tests/browser/package*.json "$packages"
  (cd "$packages" && npm ci --no-audit --no-fund --ignore-scripts > npm.log 2>&1) ||
    skip "npm cannot fetch playwright-core and axe-core, see $packages/npm.log"
  cp "$packages/package-lock.json" "$packages/installed.json"
fi

claim_domain
step "tests in $(chromium --version --no-sandbox)"
TOPOGEO_BUILD=$build TOPOGEO_SOURCE=$source_dir TOPOGEO_WORK=$work TOPOGEO_CHROMIUM=$(command -v chromium) \
  node --test "$source_dir/tests/browser/page_test.mjs" || { tail -n 5 "$work"/*.log; fail "the page"; }
