#!/usr/bin/env bash
# The web service with a certificate: HTTPS and a WebSocket over TLS work, plain HTTP and old TLS do not.
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

need openssl curl python3
[ -x "$bin/web" ] || skip "web is not built" "./run build"

claim_domain
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -keyout "$work/key.pem" \
  -out "$work/cert.pem" -subj "/CN=localhost" -addext "subjectAltName=DNS:localhost,IP:127.0.0.1" 2> "$work/openssl.log" ||
  fail "openssl: $(cat "$work/openssl.log")"

step "no certificate for the wrong key, none of a file that is not there"
openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:prime256v1 -out "$work/other.pem" 2> /dev/null
! "$bin/web" --port 0 --certificate "$work/cert.pem" --key "$work/other.pem" > "$work/other.log" 2>&1 ||
  fail "it took the key of another certificate"
grep -q other.pem "$work/other.log" || fail "the error does not name the file: $(cat "$work/other.log")"

token="token-of-the-test"
TOPOGEO_DDS_PARTICIPANT=udp_only "$bin/web" --port 0 --bind 0.0.0.0 --certificate "$work/cert.pem" --key "$work/key.pem" --host localhost --token $token \
  > "$work/web.log" 2>&1 &
web=$!
cleanups+=("kill $web; wait $web")
wait_for "the link of the web service" grep -q "spectators: https://" "$work/web.log" || fail "no link: $(cat "$work/web.log")"
port=$(sed -nE 's|^spectators: https://[^:]+:([0-9]+)/$|\1|p' "$work/web.log")
address=https://localhost:$port
trusted=(curl -sS --max-time "$hang_limit_s" --cacert "$work/cert.pem")

step "HTTPS"
"${trusted[@]}" "$address/api/info" | grep -q '"protocol":1' || fail "no answer over TLS"
[ "$("${trusted[@]}" -o /dev/null -w '%{http_code}' -d '{}' "$address/api/pause")" = 401 ] || fail "written without the token"
[ "$("${trusted[@]}" -o /dev/null -w '%{http_code}' -H "Authorization: Bearer $token" -d '{}' "$address/api/pause")" = 202 ] ||
  fail "refused with the token"
! curl -sS --max-time "$hang_limit_s" -o /dev/null "$address/api/info" 2> "$work/untrusted.log" || fail "trusted a certificate of nobody"
! "${trusted[@]}" --tls-max 1.1 --ciphers DEFAULT@SECLEVEL=0 -o /dev/null "$address/api/info" 2> "$work/old.log" ||
  fail "took TLS 1.1"

step "plain HTTP"
! curl -sS --max-time "$hang_limit_s" -o /dev/null "http://localhost:$port/api/info" 2> "$work/plain.log" || fail "answered plain HTTP"
"${trusted[@]}" "$address/api/info" > /dev/null || fail "it does not go on after plain HTTP"

step "WebSocket over TLS"
python3 - "$port" "$work/cert.pem" "$hang_limit_s" << 'PYTHON' || fail "no WebSocket over TLS"
import base64, json, os, socket, ssl, sys

port, certificate, patience_s = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
context = ssl.create_default_context(cafile=certificate)
with socket.create_connection(("127.0.0.1", port), patience_s) as plain:
    with context.wrap_socket(plain, server_hostname="localhost") as tls:
        key = base64.b64encode(os.urandom(16)).decode()
        tls.sendall((f"GET /ws HTTP/1.1\r\nHost: localhost:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                     f"Origin: https://localhost:{port}\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n")
                    .encode())
        stream = tls.makefile("rb")
        status = stream.readline().decode()
        assert " 101 " in status, status
        while stream.readline().strip():
            pass
        # The first frame, unmasked: 1 to 125 bytes, or 2 bytes of length.
        _, length = stream.read(2)
        if length == 126:
            length = int.from_bytes(stream.read(2), "big")
        welcome = json.loads(stream.read(length))
        assert welcome["op"] == "welcome" and welcome["may_write"] is False, welcome
PYTHON
step "done"
