#!/usr/bin/env bash
# The page in Chromium with a service that stands in: waiting, words, keyboard, small screens.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_browser
run_browser_test operate
