#!/usr/bin/env bash
# Commands of README.md, deploy/README.md and docs/ name what the programs have, and those that need no live robot run as
# they are written.
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

step "a map of the demo"
"$bin/topogeo" demo --out "$work/demo" > "$work/demo.log" 2>&1 || fail "topogeo demo fails"

step "the commands of the pages"
TMPDIR=$work python3 "$source_dir/tests/integration/documented_commands.py" "$source_dir" "$bin" "$work/demo" ||
  fail "a command of a page does not work as it is written"
