#!/usr/bin/env bash
# Sends a simulated robot to 200 random goals on three floors and prints a table, as in docs/results.md; floors and runs
# are reported on standard error.
#   tests/bench/arrival.sh [MORE OPTIONS OF topogeo_arrival]
# TOPOGEO_ARRIVAL names the program; default build/bin/topogeo_arrival.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
program=${TOPOGEO_ARRIVAL:-$root/build/bin/topogeo_arrival}
[ -x "$program" ] || { printf 'arrival: there is no %s; build it with ./run build\n' "'$program'" >&2; exit 1; }
exec "$program" --runs 200 "$@"
