#!/usr/bin/env bash
# Parts of the operator's page without a browser.
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

need node esbuild
[ "$(node -p 'parseInt(process.versions.node)')" -ge 18 ] || skip "Node $(node --version) is older than 18" "Node 18"
TOPOGEO_BUILD=$build TOPOGEO_SOURCE=$source_dir node --test "$source_dir"/tests/browser/{modules,drawing}_test.mjs
