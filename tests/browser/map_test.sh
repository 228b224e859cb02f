#!/usr/bin/env bash
# The map of the operator's page in Chromium, without a robot.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_browser
run_browser_test map
