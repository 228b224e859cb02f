#!/usr/bin/env bash
# fetch_packages.sh FOLDER: installs the npm packages for the scripts beside this one, once, into FOLDER. Exit code 77
# without npm or the network.
set -euo pipefail
folder=$1
done=$folder/done-2  # increase the number when the list changes
[ -e "$done" ] && exit 0
if ! command -v npm > /dev/null || ! command -v node > /dev/null; then
  echo "no node or npm"
  exit 77
fi
mkdir -p "$folder"
timeout 90 npm install --prefix "$folder" --no-audit --no-fund --ignore-scripts --fetch-retries 1 \
  @mcap/core@2.2.2 @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0 \
  @foxglove/rosmsg-msgs-common@3.2.3 fzstd@0.1.1 \
  || { echo "npm cannot fetch the packages"; exit 77; }
touch "$done"
