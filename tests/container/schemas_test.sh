#!/usr/bin/env bash
# Checks the Kubernetes manifests against the types of its API (from its OpenAPI description, as TypeScript) and the
# dashboard against the types of Grafana: an unknown key, a missing one or a value of a wrong type is an error.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

need npm tsc python3
packages=$build/tests/schemas
mkdir -p "$packages"
exec 4> "$packages/install.lock"
flock 4
if ! cmp -s "$source_dir/tests/container/schemas/package-lock.json" "$packages/installed.json"; then
  step "fetching the types"
  cp "$source_dir"/tests/container/schemas/package*.json "$packages"
  (cd "$packages" && npm ci --no-audit --no-fund --ignore-scripts > npm.log 2>&1) ||
    skip "npm cannot fetch the types, see $packages/npm.log" "a registry of npm that can be reached"
  cp "$packages/package-lock.json" "$packages/installed.json"
fi
exec 4>&-

step "the manifests and the dashboard, and some with a fault each"
ln -s "$packages/node_modules" "$work/node_modules"
python3 - "$work" "$source_dir/deploy/monitoring/grafana-dashboard.json" \
  "$source_dir"/deploy/kubernetes/*.yaml <<'PY' || fail "a file cannot be read"
import json, pathlib, sys, yaml

work = pathlib.Path(sys.argv[1])

def write(name, documents):
    lines = []
    for number, document in enumerate(documents):
        version, kind = document["apiVersion"], document["kind"]
        module = version if "/" in version else "core/" + version
        lines.append(f'import {{ {kind} as Kind{number} }} from "kubernetes-types/{module}";')
        lines.append(f"export const document{number}: Kind{number} = {json.dumps(document, indent=1)};")
    (work / f"{name}.ts").write_text("\n".join(lines))

def with_faults(text, faults):
    for name, (right, wrong) in faults.items():
        assert right in text, right
        yield "bad_" + name, text.replace(right, wrong, 1)

faults = {
    "misspelt": ("timeoutSeconds: ", "timeoutSecond: "),
    "missing": ("serviceName: ", "# "),
    "wrong_type": ("replicas: 4", "replicas: four"),
    "wrong_place": ("            runAsNonRoot: true", "            hostNetwork: true"),
    "wrong_version": ("apiVersion: apps/v1", "apiVersion: apps/v0"),
}
for path in map(pathlib.Path, sys.argv[3:]):
    text = path.read_text()
    write("good_" + path.stem, yaml.safe_load_all(text))
    if path.stem == "pool":
        for name, faulty in with_faults(text, faults):
            write(name, yaml.safe_load_all(faulty))

# JSON form of a type: an enumeration of texts becomes its texts.
dashboard = """import { Dashboard } from "@grafana/schema";
type Json<T> = T extends string ? `${T}` : T extends number ? number :
  T extends object ? { [K in keyof T]: Json<T[K]> } : T;
export const dashboard: Json<Dashboard> = """
faults = {
    "panel_misspelt": ('"fieldConfig": ', '"fieldconfig": '),
    "panel_without_type": ('"type": "stat",', ""),
    "place_of_wrong_type": ('"h": 4', '"h": "four"'),
    "variable_of_wrong_type": ('"refresh": 2', '"refresh": "two"'),
    "dashboard_misspelt": ('"timezone": ', '"timezones": '),
}
text = pathlib.Path(sys.argv[2]).read_text()
(work / "good_dashboard.ts").write_text(dashboard + text)
for name, faulty in with_faults(text, faults):
    (work / f"{name}.ts").write_text(dashboard + faulty)
PY
cat > "$work/tsconfig.json" <<'JSON'
{
  "compilerOptions": {"noEmit": true, "strict": true, "module": "es2020", "moduleResolution": "node", "types": []},
  "include": ["*.ts"]
}
JSON
(cd "$work" && tsc --project .) > "$work/tsc.log" || true
! grep '^good_' "$work/tsc.log" || fail "a file is not what Kubernetes or Grafana takes"
for file in "$work"/bad_*.ts; do
  grep -q "^$(basename "$file").*error" "$work/tsc.log" || fail "no fault is found in $(basename "$file")"
done
step "the end"
