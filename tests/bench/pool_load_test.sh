#!/usr/bin/env bash
# Some seconds of tests/bench/pool_load.cpp: 64 workers whose search is stubbed, four robots, one of which floods them;
# every task is answered and every worker gets some. The speed is measured elsewhere (docs/results.md).
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

claim_domain
"$bin/topogeo_pool_load" --domain "$TOPOGEO_DOMAIN" --workers 64 --per-process 8 --robots 4 --seconds 3 --lead-seconds 5
