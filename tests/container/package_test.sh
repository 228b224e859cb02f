#!/usr/bin/env bash
# The packages: lintian finds no errors, they install in a clean container, the programs run there, and nothing is left
# after removal. The same holds for the workers alone; a subscriber compiles against topogeo-dev.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need_packages
if there lintian "the packages are not checked by it"; then
  step "lintian"
  lintian --fail-on error "$build"/packages/*.deb > "$work/lintian" 2>&1 ||
    { grep '^E' "$work/lintian"; fail "lintian finds errors"; }
fi

need_image
step "running what is installed"
map_alone 60 "$work/here"
chmod 755 "$work"
# shellcheck disable=SC2016
docker run --rm -i --user root -v "$work:/exchange" $image bash -euo pipefail -c '
  [ "$(topogeo --version)" = "topogeo 0.1.0" ]
  cd /tmp
  # Runs as the user of the services.
  install -d -o topogeo /tmp/out
  setpriv --reuid topogeo --regid topogeo --clear-groups env HOME=/tmp \
    topogeo run --log /exchange/log.clf --out /tmp/out --workers 1 > /tmp/run.log 2>&1 || { cat /tmp/run.log; exit 1; }
  cp /tmp/out/map.pb /tmp/out/trajectory.tum /exchange/
  for command in topogeo ga_worker topogeo-localizer topogeo-map-store topogeo-planner; do
    gzip -dc /usr/share/man/man1/$command.1.gz > /tmp/page
    grep -q "^.SH OPTIONS" /tmp/page || { echo "no manual page of $command"; exit 1; }
    $command --help > /dev/null
  done
  . /usr/share/bash-completion/completions/topogeo
  COMP_WORDS=(topogeo stat) COMP_CWORD=1
  _topogeo
  [ "${COMPREPLY[*]}" = status ]
  [ -e /usr/share/topogeo/worlds/room.world.yaml ] && [ -e /usr/share/topogeo/thesis/printed.config.yaml ]
  [ -e /etc/topogeo/topogeo.env ] && [ -e /usr/lib/systemd/system/topogeo.target ]
  [ "$(stat -c "%a %U:%G" /etc/topogeo/topogeo.env)" = "640 root:topogeo" ] || { echo "settings are for all"; exit 1; }
  [ "$(stat -c "%a %U:%G" /etc/topogeo/web.env)" = "600 root:root" ] || { echo "the token is for all"; exit 1; }
  [ "$(getent group dialout | cut -d: -f4)" = topogeo-sensor-gateway ] || { getent group dialout; exit 1; }
  # Each service gets its own keys and no others.
  mkdir -p /tmp/keys/web /tmp/keys/map_store /tmp/keys/ga_worker
  for service in web map_store ga_worker; do echo key > /tmp/keys/$service/key.pem; done
  /usr/share/topogeo/security/own_keys /tmp/keys
  [ "$(cd /tmp/keys && stat -c "%n %a %U" * */key.pem | LC_ALL=C sort | xargs)" = \
    "ga_worker 700 topogeo-worker ga_worker/key.pem 600 topogeo-worker map_store 700 topogeo map_store/key.pem 600 topogeo \
web 700 topogeo-web web/key.pem 600 topogeo-web" ] || { ls -lR /tmp/keys; exit 1; }
  for user in topogeo topogeo-planner; do
    if setpriv --reuid $user --regid $user --clear-groups cat /tmp/keys/web/key.pem 2> /dev/null; then exit 1; fi
  done
  # The output that docker keeps of a health check names the reason of its failure.
  if health ga_worker > /tmp/health 2>&1; then exit 1; fi
  grep -q "no service has written .*/ga_worker" /tmp/health || { echo "no reason of a failed health check:"; cat /tmp/health; exit 1; }
  # Creates the links of systemctl enable; a unit outside the project stays enabled.
  enabled=/etc/systemd/system
  mkdir -p $enabled/multi-user.target.wants $enabled/topogeo.target.wants
  touch /lib/systemd/system/topography.service
  for unit in topogeo.target topogeo-worker@1.service topogeo-discovery@0.service topography.service; do
    ln -s "/lib/systemd/system/${unit/@*./@.}" "$enabled/multi-user.target.wants/$unit"
  done
  ln -s /lib/systemd/system/topogeo-web.service $enabled/topogeo.target.wants/
  for link in $enabled/*.wants/*; do [ -e "$link" ] || { echo "no unit of $link"; exit 1; }; done
  apt-get purge -q -y topogeo > /dev/null
  [ "$(cd $enabled && echo *.wants/topogeo*)" = \
    "$(echo multi-user.target.wants/topogeo-{discovery@0,worker@1}.service)" ] ||
    { echo "enabled without topogeo:"; ls $enabled/*.wants; exit 1; }
  apt-get purge -q -y topogeo-workers > /dev/null
  [ -e $enabled/multi-user.target.wants/topography.service ] || { echo "another unit is disabled"; exit 1; }
  left=$(find / -xdev -iname "*topogeo*" -not -path "/proc/*" -not -path "/tmp/*" -not -path "/exchange/*" \
    -not -path "/var/log/*" -not -path "/var/lib/apt/*" -not -path "/var/cache/*" -not -path "/home/robot/*")
  [ -z "$left" ] || { echo "left behind:"; echo "$left"; exit 1; }
' || fail "in the container"
mkdir "$work/there"
mv "$work/map.pb" "$work/trajectory.tum" "$work/there"
same_results "$work/there" "$work/here"

base=$(docker image inspect -f '{{ .Size }}' "${BASE:-debian:bookworm}")
all=$(docker image inspect -f '{{ .Size }}' $image)
step "the image has $(((all - base) / 1000000)) MB beyond its base"
[ $(((all - base) / 1000000)) -le 250 ] || fail "the image has more than 250 MB beyond its base"
[ "$(docker image inspect -f '{{ .Config.User }}' $image)" = robot ] || fail "the image runs as root"

step "topogeo-workers alone, and a subscriber that hears one"
claim_domain
# Uses the network of the host, because that of the engine may not reach a mirror or proxy.
# shellcheck disable=SC2016
docker run --rm --network host -v "$build/packages:/packages:ro" -v "$source_dir/tests/container/subscriber:/subscriber:ro" \
  -e DEBIAN_FRONTEND=noninteractive -e TOPOGEO_DOMAIN -e hang_limit_s="$hang_limit_s" "${BASE:-debian:bookworm}" bash -euo pipefail -c '
  apt-get update -q
  install() { apt-get install -q -y --no-install-recommends -o Dpkg::Options::=--force-unsafe-io "$@"; }
  install /packages/topogeo-workers_*.deb
  dpkg -L topogeo-workers > /tmp/files
  if command -v topogeo; then exit 1; fi
  [ -e /etc/topogeo/worker.env ] && [ -e "/lib/systemd/system/topogeo-discovery@.service" ]
  ga_worker --help > /dev/null
  ga_worker &
  install /packages/topogeo-dev_*.deb g++ cmake make
  cmake -S /subscriber -B /tmp/subscriber
  cmake --build /tmp/subscriber
  heard=$(timeout "$hang_limit_s" /tmp/subscriber/subscriber "$TOPOGEO_DOMAIN" "*") || true
  [ "$heard" = ga_worker ] || { echo "the subscriber heard \"$heard\""; exit 1; }
  kill %1
  wait %1
  rm -r /tmp/subscriber
  apt-get purge -q -y topogeo-workers topogeo-dev
  while read -r file; do
    [ ! -f "$file" ] && [ ! -L "$file" ] || { echo "left behind: $file"; exit 1; }
  done < /tmp/files
  left=$(find / -xdev -iname "*topogeo*" -not -path "/proc/*" -not -path "/var/log/*" -not -path "/var/lib/apt/*" \
    -not -path "/var/cache/*")
  [ -z "$left" ] || { echo "left behind: $left"; exit 1; }
' > "$work/clean.log" 2>&1 || { tail -n 20 "$work/clean.log"; fail "in a clean container"; }
step "the end"
