#!/usr/bin/env bash
# Foxglove's own client library with the web service of a simulated robot.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_robot
need_node_packages
claim_domain
run_browser_test foxglove
