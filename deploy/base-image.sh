#!/usr/bin/env bash
# base-image.sh [NAME]: makes the base image (default debian:bookworm) with debootstrap from the package mirror
# of this machine, if no image can be pulled. Needs root, debootstrap and a running docker.
set -euo pipefail

name=${1:-debian:bookworm}
[ "$(id -u)" -eq 0 ] || { echo "base-image.sh: needs root" >&2; exit 1; }
command -v debootstrap > /dev/null || { echo "base-image.sh: needs debootstrap" >&2; exit 1; }
mirror=$(awk '/^URIs:/ { print $2; exit } /^deb / { print $2; exit }' \
  /etc/apt/sources.list.d/*.sources /etc/apt/sources.list 2> /dev/null || true)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
log=$folder/log
root=$folder/root
debootstrap --variant=minbase bookworm "$root" "${mirror:-http://deb.debian.org/debian}" > "$log" 2>&1 ||
  { tail -n 20 "$log" >&2; exit 1; }
# The image installs from the same sources as this machine, through the same proxies.
rm -f "$root/etc/apt/sources.list"
for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.sources /etc/apt/sources.list.d/*.list; do
  [ ! -e "$file" ] || cp "$file" "$root$file"
done
mkdir -p "$root/etc/apt/keyrings" "$root/usr/share/keyrings"
cp -rn /etc/apt/keyrings/. "$root/etc/apt/keyrings/" 2> /dev/null || true
cp -rn /usr/share/keyrings/. "$root/usr/share/keyrings/"
for file in /etc/apt/apt.conf.d/*; do
  if grep -qE '^ *Acquire::' "$file" 2> /dev/null; then cp "$file" "$root$file"; fi
done
rm -rf "$root"/var/cache/apt/archives/*.deb "$root"/var/lib/apt/lists/*
tar -C "$root" -c . | docker import --change 'CMD ["bash"]' - "$name" > /dev/null
echo "base-image.sh: made $name" >&2
