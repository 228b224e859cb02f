// Modules of the page for tests without a browser.
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source } = process.env;

/** esbuild strips the types, as for the page. */
export async function load(module) {
  const out = join(build, "tests/browser/modules", `${module.replace("/", "_")}.mjs`);
  const file = join(source, "services/web/page/src", `${module}.ts`);
  execFileSync("esbuild", [file, "--bundle", "--format=esm", "--log-level=warning", `--outfile=${out}`]);
  return import(pathToFileURL(out));
}
