#!/usr/bin/env bash
# The operator's page in Chromium, driven by playwright-core.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_programs
for program in web sensor_gateway local_mapper localizer map_store planner; do
  [ -x "$bin/$program" ] || skip "the program $program is not built"
done
need_browser
claim_domain
run_browser_test page
