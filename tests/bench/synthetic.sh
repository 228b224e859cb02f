#!/usr/bin/env bash
# Maps 20 drives through each of five synthetic floors and prints a table, as in docs/results.md; each run is reported
# on standard error.
#   tests/bench/synthetic.sh [MORE OPTIONS OF topogeo_synthetic]
# TOPOGEO_SYNTHETIC names the program; default build/bin/topogeo_synthetic.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
program=${TOPOGEO_SYNTHETIC:-$root/build/bin/topogeo_synthetic}
[ -x "$program" ] || { printf 'synthetic: there is no %s; build it with ./run build\n' "'$program'" >&2; exit 1; }
exec "$program" --seeds 20 --markdown "$@"
