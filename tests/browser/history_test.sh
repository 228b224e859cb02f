#!/usr/bin/env bash
# Loops, the drive, versions and exports on the operator's page in Chromium.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_browser
for program in web map_store topogeo; do
  [ -x "$bin/$program" ] || skip "$program is not built" "./run build"
done
claim_domain
run_browser_test history
