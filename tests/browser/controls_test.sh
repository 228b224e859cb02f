#!/usr/bin/env bash
# Two operators' pages in Chromium with the web service, without a robot.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_browser
for program in web map_store; do
  [ -x "$bin/$program" ] || skip "$program is not built" "./run build"
done
claim_domain
run_browser_test controls
