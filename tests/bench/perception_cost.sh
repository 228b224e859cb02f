#!/usr/bin/env bash
# Prints the cost of the diagram and the local map of one scan against range limit and cell size, beside the numbers of
# the Thesis (Thesis, fig. 4.18 and 5.2), as the table of docs/decisions/perception.md.
#   tests/bench/perception_cost.sh
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)

"$root/run" bench '^perception_cost/' | awk '
  $1 ~ /^perception_cost\// {
    split($1, name, "/")
    cost[name[2] "/" name[3] "/" name[4]] = $4
  }
  END {
    if (length(cost) == 0) { print "perception_cost: the benchmarks printed nothing" > "/dev/stderr"; exit 1 }
    source["diagram/4m/2cm"] = "1,373"; source["diagram/4m/10cm"] = "57"
    source["local_map/4m/5cm"] = "400-900"
    print "| | range limit | cell | ms | Thesis, ms (400 MHz PC) |"
    print "|---|---|---|---|---|"
    n = split("diagram local_map", kinds, " ")
    for (k = 1; k <= n; k++)
      for (r = 1; r <= split("4m 8m 10m", ranges, " "); r++)
        for (c = 1; c <= split("2cm 5cm 10cm", cells, " "); c++) {
          key = kinds[k] "/" ranges[r] "/" cells[c]
          printf "| %s | %s | %s | %.2f | %s |\n", kinds[k] == "diagram" ? "diagram" : "diagram and local map",
            ranges[r], cells[c], cost[key], key in source ? source[key] : "-"
        }
  }'
