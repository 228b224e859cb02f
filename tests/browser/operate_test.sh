#!/usr/bin/env bash
# The page in Chromium with a stub service: waiting, texts, keyboard, small screens.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

need_browser
run_browser_test operate
