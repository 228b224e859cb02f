#!/usr/bin/env bash
# make_keys killed at each of its commands: nothing looks complete that is not, and the next call goes on. What it
# cannot do it says and fails. What services make of the keys is security_test.sh.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need openssl
make_keys=$source_dir/deploy/security/make_keys

# whole FOLDER SERVICE: the files in the folder belong together and to the authorities.
whole() {
  local ca=${1%/*/*}/ca file
  for file in identity_ca.pem permissions_ca.pem governance.p7s revoked.pem; do
    cmp "$1/$file" "$ca/$file" || return 1
  done
  openssl verify -CAfile "$1/identity_ca.pem" "$1/certificate.pem" > /dev/null || return 1
  [ "$(openssl x509 -in "$1/certificate.pem" -noout -pubkey)" = "$(openssl pkey -in "$1/key.pem" -pubout)" ] || return 1
  openssl smime -verify -text -purpose any -in "$1/permissions.p7s" -CAfile "$1/permissions_ca.pem" \
    2> "$work/smime.log" | grep -q "<grant name=\"$2\">"
}
# all_whole KEYS: what has a certificate is whole, and so are the authorities, where they are.
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

# Commands that end the process group of the N-th of them, before it does anything.
mkdir "$work/mortal"
cat > "$work/mortal/openssl" <<'SH'
#!/bin/bash
PATH=${PATH#*:}
echo >> "$STEPS"
[ "$(wc -l < "$STEPS")" != "$LAST_STEP" ] || kill -KILL 0
exec "${0##*/}" "$@"
SH
chmod +x "$work/mortal/openssl"
for command in mkdir mv cp rm; do cp "$work/mortal/openssl" "$work/mortal/$command"; done
# killed N COMMAND...: whether it was killed at its N-th step; it succeeds where it has fewer.
killed() {
  local code=0
  rm -f "$work/steps"
  { STEPS=$work/steps LAST_STEP=$1 PATH=$work/mortal:$PATH setsid --wait "${@:2}"; } > "$work/killed.log" 2>&1 ||
    code=$?
  [ $code -eq 0 ] || [ $code -eq 137 ] ||
    { cat "$work/killed.log"; fail "killed at step $1, it ends with $code: ${*:2}"; }
  [ $code -eq 137 ]
}

step "issue, killed at each step"
export TOPOGEO_PERMISSIONS=$work/permissions.txt
grep '^ga_worker' "$source_dir/deploy/security/permissions.txt" > "$work/permissions.txt"
one=./pc1/ga_worker/certificate.pem
last=0
while killed $((++last)) "$make_keys" "$work/keys" issue pc1; do
  all_whole "$work/keys" || fail "killed at step $last it leaves what looks complete"
  "$make_keys" "$work/keys" issue pc1 > "$work/again.log" || fail "killed at step $last it does not go on"
  { has "$work/keys" $one && all_whole "$work/keys"; } || fail "killed at step $last it does not make all"
  [ ! -e "$work/keys/.new" ] || fail "something is left beside the certificates"
  [ -z "$(find "$work/keys" -type f -perm /077)" ] || fail "others can read keys"
  rm -r "$work/keys"
done
[ $last -gt 20 ] || fail "only $last steps"

step "renew, killed at each step"
mv "$work/keys" "$work/issued"
last=0
cp -r "$work/issued" "$work/keys"
while killed $((++last)) "$make_keys" "$work/keys" renew pc1; do
  all_whole "$work/keys" || fail "killed at step $last it leaves what looks complete"
  "$make_keys" "$work/keys" renew pc1 || fail "killed at step $last it does not go on"
  { has "$work/keys" $one && all_whole "$work/keys"; } || fail "killed at step $last it does not renew all"
  rm -r "$work/keys"
  cp -r "$work/issued" "$work/keys"
done
[ $last -gt 10 ] || fail "only $last steps"

step "authorities that are half there"
rm "$work/keys/ca/revoked.pem"
if "$make_keys" "$work/keys" issue pc1 2> "$work/error"; then fail "half of the authorities are enough"; fi
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
expect "" issue pc1
grep '^status' "$source_dir/deploy/security/permissions.txt" >> "$work/permissions.txt"
both="$one ./pc1/status/certificate.pem"
cp -r "$keys/pc1/ga_worker" "$work/first"
expect "1 certificate is there already" issue pc1
diff -r "$work/first" "$keys/pc1/ga_worker" || fail "a certificate that is there is made again"
has "$keys" "$both" || fail "not all is issued"
expect "2 certificates are there already" issue pc1
refuses "'pc1' has a certificate for 'status'; renew it" issue pc1 status
echo "planner reads: *" >> "$work/permissions.txt"
expect "" renew pc1
has "$keys" "$both" || fail "a renewal issues more than there was"
if cmp -s "$work/first/certificate.pem" "$keys/pc1/ga_worker/certificate.pem"; then fail "nothing is renewed"; fi
expect "2 certificates are there already" issue pc1
[ -e "$keys/pc1/planner/certificate.pem" ] || fail "what is new in the table is not issued"
expect "" issue robot planner
all_whole "$keys" || fail "something is not whole"

step "what is not there"
find "$keys" -type f -exec sha256sum {} + | sort > "$work/before"
for command in renew revoke; do
  refuses "'pc7' has no certificates; hosts: pc1 robot" $command pc7
  refuses "'pc7' has no certificates; hosts: pc1 robot" $command pc7 status
  refuses "'robot' has no certificate for 'status'" $command robot status
done
refuses "'painter' is not in $work/permissions.txt, expected one of: ga_worker planner status" issue pc2 status painter
TOPOGEO_PERMISSIONS=$work/nowhere refuses "the table of permissions cannot be read: $work/nowhere" issue pc2
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
