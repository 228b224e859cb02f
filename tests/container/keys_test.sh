#!/usr/bin/env bash
# make_keys killed at each of its commands: nothing incomplete looks complete, and the next call continues. A request
# that it cannot fulfil fails with a message. security_test.sh tests the keys in services.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need openssl
make_keys=$source_dir/deploy/security/make_keys

# The robots of a folder's certificate, of its permissions and of its file, each as one line.
robots_of_certificate() { openssl x509 -in "$1/certificate.pem" -noout -subject -nameopt multiline |
  sed -n 's/^ *organizationalUnitName *= //p' | xargs; }
robots_of_permissions() {  # each appears twice, once for writing and once for reading
  sed -n 's#^ *<partition>\(.*\)</partition>.*#\1#p' "$1/permissions.p7s" | sed 's#^[*]/##; s#^[*]$#all#' | awk '!seen[$0]++' | xargs
}
robots_of_file() { xargs < "$1/robots"; }
is_for() {  # FOLDER ROBOTS
  local in_certificate=$2
  [ "$2" != all ] || in_certificate=
  [ "$(robots_of_certificate "$1")" = "$in_certificate" ] && [ "$(robots_of_permissions "$1")" = "$2" ] && [ "$(robots_of_file "$1")" = "$2" ]
}

# whole FOLDER SERVICE: the files in the folder match each other and the authorities.
whole() {
  local ca=${1%/*/*}/ca file
  for file in identity_ca.pem permissions_ca.pem governance.p7s revoked.pem; do
    cmp "$1/$file" "$ca/$file" || return 1
  done
  openssl verify -CAfile "$1/identity_ca.pem" "$1/certificate.pem" > /dev/null || return 1
  [ "$(openssl x509 -in "$1/certificate.pem" -noout -pubkey)" = "$(openssl pkey -in "$1/key.pem" -pubout)" ] || return 1
  openssl smime -verify -text -purpose any -in "$1/permissions.p7s" -CAfile "$1/permissions_ca.pem" \
    2> "$work/smime.log" | grep -q "<grant name=\"$2\">" || return 1
  is_for "$1" "$(robots_of_file "$1")"
}
# all_whole KEYS: every folder with a certificate is whole, and so are existing authorities.
all_whole() {
  local certificate folder file
  for file in identity_ca.key permissions_ca.key governance.p7s openssl.cnf index.txt revoked.pem; do
    [ ! -e "$1/ca" ] || [ -s "$1/ca/$file" ] || [ $file = index.txt ] || return 1
  done
  for certificate in "$1"/*/*/certificate.pem; do
    folder=${certificate%/*}
    [ ! -e "$certificate" ] || whole "$folder" "${folder##*/}" || return 1
  done
}
has() { [ "$(cd "$1" && echo ./*/*/certificate.pem)" = "$2" ]; }  # KEYS CERTIFICATES

# Wrappers that copy $KEYS to $STATES/N before the N-th command does anything, and kill their process group when N is
# LAST_STEP: the copy is the state after a kill at that step.
mkdir "$work/mortal"
cat > "$work/mortal/openssl" <<'SH'
#!/bin/bash
PATH=${PATH#*:}
states=("$STATES"/*)
n=$((10#${states[-1]##*/} + 1))
printf -v state '%s/%03d' "$STATES" $n
mkdir "$state"
[ ! -e "$KEYS" ] || cp -a "$KEYS" "$state/keys"
[ "$n" != "${LAST_STEP:-}" ] || kill -KILL 0
exec "${0##*/}" "$@"
SH
chmod +x "$work/mortal/openssl"
for command in mkdir mv cp rm; do cp "$work/mortal/openssl" "$work/mortal/$command"; done
# record STATES COMMAND...: runs the command on $work/keys and returns its exit code; the states go to $work/STATES.
record() {
  mkdir -p "$work/$1/000"
  { STATES=$work/$1 KEYS=$work/keys PATH=$work/mortal:$PATH setsid --wait "${@:2}"; } > "$work/record.log" 2>&1
}
files_of() { (cd "$1" && find . | sort); }
# make_keys first removes leftovers in DIR/.new, so states that differ only there count as one.
essence() { (cd "$1" && find . -path ./keys/.new -prune -o -type f -exec sha256sum {} + -o -print | sort | sha256sum); }

# killed_at_each_step STATES LEAST COMMAND...: runs make_keys on the present $work/keys. No state may look complete that
# is not, and the same command must continue from each.
killed_at_each_step() {
  local states=$work/$1 least=$2 state last=0 first=$work/before-$1 middle code=0 n=0
  shift 2
  [ ! -e "$work/keys" ] || cp -a "$work/keys" "$first"
  record "${states##*/}" "$make_keys" "$work/keys" "$@" || { cat "$work/record.log"; fail "$* fails"; }
  rm -r "$states/000"
  last=$(find "$states" -mindepth 1 -maxdepth 1 | wc -l)
  [ "$last" -gt "$least" ] || fail "only $last steps of $*"
  # A real kill at half of the steps leaves the recorded state.
  middle=$((last / 2))
  rm -r "$work/keys"
  [ ! -e "$first" ] || cp -a "$first" "$work/keys"
  LAST_STEP=$middle record killed "$make_keys" "$work/keys" "$@" || code=$?
  [ $code -eq 137 ] || { cat "$work/record.log"; fail "killed at step $middle, it ends with $code: $*"; }
  diff <(files_of "$(printf '%s/%03d/keys' "$states" $middle)") <(files_of "$work/keys") ||
    fail "a kill at step $middle of $* leaves not what was there (<)"
  rm -r "$work/killed"
  local -A newest=()
  for state in "$states"/*; do newest[$(essence "$state")]=$state; done
  for state in "${newest[@]}"; do
    n=$((n + 1))
    all_whole "$state/keys" || fail "killed at step ${state##*/} it leaves what looks complete: $*"
    rm -rf "$work/keys"
    [ ! -e "$state/keys" ] || cp -a "$state/keys" "$work/keys"
    "$make_keys" "$work/keys" "$@" > "$work/again.log" || fail "killed at step ${state##*/} it does not go on: $*"
    { has "$work/keys" $one && all_whole "$work/keys"; } || fail "killed at step ${state##*/} it does not make all: $*"
    [ ! -e "$work/keys/.new" ] || fail "something is left beside the certificates"
    [ -z "$(find "$work/keys" -type f -perm /077)" ] || fail "others can read keys"
  done
  step "$last steps, $n different states"
}

step "issue, killed at each step"
export TOPOGEO_PERMISSIONS=$work/permissions.txt
grep '^ga_worker' "$source_dir/deploy/security/permissions.txt" > "$work/permissions.txt"
one=./pc1/ga_worker/certificate.pem
killed_at_each_step issue 20 issue --robot anna --robot bert pc1

step "renew, killed at each step"
killed_at_each_step renew 10 renew pc1

step "authorities that are half there"
rm "$work/keys/ca/revoked.pem"
if "$make_keys" "$work/keys" issue --robot all pc1 2> "$work/error"; then fail "half of the authorities are enough"; fi
grep -q "'.*/ca' is not complete" "$work/error" || { cat "$work/error"; fail "no clear error"; }
rm -r "$work/keys"

step "issue what is missing"
keys=$work/keys
expect() {  # TEXT ARGUMENTS...
  "$make_keys" "$keys" "${@:2}" > "$work/out" 2>&1 || { cat "$work/out"; fail "${*:2} fails"; }
  diff <(printf '%s' "${1:+$1$'\n'}") "$work/out" || fail "${*:2} prints not what is expected (<)"
}
refuses() {  # TEXT ARGUMENTS...
  local code=0
  "$make_keys" "$keys" "${@:2}" > "$work/out" 2>&1 || code=$?
  [ $code -eq 1 ] || { cat "$work/out"; fail "${*:2} ends with $code, expected 1"; }
  diff <(echo "make_keys: $1") "$work/out" || fail "${*:2} prints not what is expected (<)"
}
refuses "'$keys' has no certificates" renew pc1
[ ! -e "$keys" ] || fail "a renewal makes folders"
expect "" issue --robot all pc1
grep '^status' "$source_dir/deploy/security/permissions.txt" >> "$work/permissions.txt"
both="$one ./pc1/status/certificate.pem"
cp -r "$keys/pc1/ga_worker" "$work/first"
expect "1 certificate is there already" issue --robot all pc1
diff -r "$work/first" "$keys/pc1/ga_worker" || fail "a certificate that is there is made again"
has "$keys" "$both" || fail "not all is issued"
expect "2 certificates are there already" issue --robot all pc1
refuses "'pc1' has a certificate for 'status'; renew it" issue --robot all pc1 status
echo "planner reads: *" >> "$work/permissions.txt"
expect "" renew pc1
has "$keys" "$both" || fail "a renewal issues more than there was"
if cmp -s "$work/first/certificate.pem" "$keys/pc1/ga_worker/certificate.pem"; then fail "nothing is renewed"; fi
expect "2 certificates are there already" issue --robot all pc1
[ -e "$keys/pc1/planner/certificate.pem" ] || fail "what is new in the table is not issued"
expect "" issue --robot anna robot planner
all_whole "$keys" || fail "something is not whole"

step "robots"
names=$keys/robot/planner
is_for "$names" anna || fail "the keys are not for the robot that is named"
is_for "$keys/pc1/status" all || fail "the keys are not for all robots"
expect "" renew robot
is_for "$names" anna || fail "a renewal changes the robots"
expect "" renew --robot bert --robot anna robot
is_for "$names" "bert anna" || fail "a renewal does not take other robots"
expect "" renew --robot all robot
is_for "$names" all || fail "a renewal for all robots is for some"
rm "$names/robots"  # as keys have none that were made before robots were named
expect "" renew robot planner
is_for "$names" all || fail "a renewal of older keys is not for all robots"
expect "" renew --robot anna robot
expect_line() { "$make_keys" "$keys" list | grep "$1" > /dev/null || fail "not in the list: $1"; }
expect_line '^robot/planner .*, robots anna$'
expect_line '^pc1/status .*, robots all$'

step "what is not there"
find "$keys" -type f -exec sha256sum {} + | sort > "$work/before"
for command in renew revoke; do
  refuses "'pc7' has no certificates; hosts: pc1 robot" $command pc7
  refuses "'pc7' has no certificates; hosts: pc1 robot" $command pc7 status
  refuses "'robot' has no certificate for 'status'" $command robot status
done
refuses "'painter' is not in $work/permissions.txt, expected one of: ga_worker planner status" issue --robot all pc2 status painter
refuses "issue: expected --robot ROBOT for each robot that the services work for, or --robot all" issue pc2
refuses "robot 'a/b': expected 1 to 32 letters, digits, -, _ and ., or 'all'" issue --robot a/b pc2
refuses "robot '*': expected 1 to 32 letters, digits, -, _ and ., or 'all'" renew --robot '*' robot
refuses "--robot: expected the name of a robot, or 'all'" issue pc2 --robot
refuses "--robot all: expected no other robot beside it" issue --robot all --robot anna pc2
mapfile -t many < <(printf -- '--robot\nr%d\n' {1..25})
refuses "25 robots: expected 24 at most, or --robot all" issue "${many[@]}" pc2
refuses "revoke: expected no --robot; it is for all robots of the keys" revoke --robot anna robot
TOPOGEO_PERMISSIONS=$work/nowhere refuses "the table of permissions cannot be read: $work/nowhere" issue --robot all pc2
TOPOGEO_PERMISSIONS=/dev/null refuses "no service is in /dev/null" renew pc1
find "$keys" -type f -exec sha256sum {} + | sort | diff "$work/before" - || fail "a call that fails changes something"

step "a host that is lost, with its folder here"
revoked() { openssl crl -in "$1" -noout -text | grep -c 'Serial Number'; }
rm -r "$keys/pc1"
mv "$keys" "$work/moved"  # the folder may move, too
keys=$work/moved
expect "" revoke pc1
[ "$(revoked "$keys/robot/planner/revoked.pem")" = 5 ] || fail "not all certificates of the host are revoked"
echo nonsense > "$keys/robot/planner/certificate.pem"
if "$make_keys" "$keys" list > "$work/out" 2>&1; then fail "a broken certificate is listed"; fi
grep -q "planner/certificate.pem' is no certificate" "$work/out" || { cat "$work/out"; fail "no clear error"; }
step "the end"
