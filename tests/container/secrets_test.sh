#!/usr/bin/env bash
# No file of the repository or of the image contains a private key.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need openssl
step "the repository"
openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 -out "$work/planted.key" 2> "$work/openssl.log" ||
  { cat "$work/openssl.log"; fail "openssl makes no key"; }
# Scripts and documents may name such lines within text; only a key has one as a whole line.
key_line='^[[:space:]]*-----BEGIN ([A-Z0-9]+ )*PRIVATE KEY( BLOCK)?-----[[:space:]]*$'
# keys_in FOLDER: files with private keys that git tracks there.
keys_in() {
  local status=0
  git -c safe.directory="$1" -C "$1" grep --text --files-with-matches --extended-regexp -e "$key_line" || status=$?
  [ $status -le 1 ] || fail "git cannot search $1"
}
if [ ! -e "$source_dir/.git" ]; then
  [ "${CI:-}" != true ] || fail "$source_dir is no repository"
  echo "$source_dir is no repository: it is not searched"
elif there git "the repository is not searched"; then
  git init -q "$work/repository"
  cp "$work/planted.key" "$work/repository/"
  git -C "$work/repository" add planted.key
  [ "$(keys_in "$work/repository")" = planted.key ] || fail "a key in a repository is not found"
  keys_in "$source_dir" > "$work/tracked"
  [ ! -s "$work/tracked" ] || { cat "$work/tracked"; fail "private keys in the repository"; }
fi

need_image
step "the image"
# Searches the image for the words in the project's files, and for key lines in all others; GnuTLS has keys for its
# self-test. One key is planted.
# shellcheck disable=SC2016  # the words of the inner shell
docker run --rm --interactive --user root --env key_line="$key_line" $image sh -euc '
  cat > /etc/topogeo/planted.key
  grep -rl "PRIVATE KEY" /etc/topogeo /usr/libexec/topogeo /usr/share/topogeo /usr/share/doc/topogeo* /home /map
  find / -xdev -type f ! -name "libgnutls.so*" -exec sh -c "grep -lE -e \"\$key_line\" \"\$@\" || [ \$? -eq 1 ]" - {} +
' < "$work/planted.key" > "$work/in_image" || fail "the image cannot be searched"
printf '/etc/topogeo/planted.key\n%.0s' 1 2 | diff - "$work/in_image" ||
  fail "the image has private keys (>) beside the planted one (<)"
step "the end"
