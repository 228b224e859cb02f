#!/usr/bin/env bash
# The accuracy table of the Thesis's algorithm alone (localizer.mode: thesis), for comparison with
# that of the default.
#   tests/bench/thesis.sh EVALUATION_TOOL [DATA_FOLDER]
# Usage as for accuracy.sh, which does the work.
set -euo pipefail
exec "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/accuracy.sh" --mode thesis "$@"
