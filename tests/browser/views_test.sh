#!/usr/bin/env bash
# Every view of the operator's page in Chromium, driven by playwright-core.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_robot
need_browser
claim_domain
run_browser_test views
