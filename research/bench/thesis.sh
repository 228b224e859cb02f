#!/usr/bin/env bash
# The accuracy table of the Thesis's algorithm alone (localizer.mode: thesis), for comparison with
# that of the default.
#   research/bench/thesis.sh EVALUATION_TOOL [DATA_FOLDER]
# Usage as for accuracy.sh, which does the work.
set -euo pipefail
exec "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../tests/bench/accuracy.sh" --mode thesis "$@"
