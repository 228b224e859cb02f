#!/usr/bin/env bash
# The edit mode of the operator's page in Chromium, with a simulated robot.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_robot
need_browser
claim_domain
run_browser_test draw
