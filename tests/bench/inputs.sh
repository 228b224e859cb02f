# Sourced by the scripts beside it: sets `inputs` to the options that name the simulated floor and
# each X.clf.gz with its X.ref.tum in the folder $2. $1 is the root of the project.
# shellcheck shell=bash
name_inputs() {
  local root=$1 data=$2 log reference
  inputs=(--world "$root/share/worlds/floor.world.yaml")
  for log in "$data"/*.clf.gz; do
    reference=${log%.clf.gz}.ref.tum
    [ ! -r "$reference" ] || inputs+=(--log "$log" --reference "$reference")
  done
}
