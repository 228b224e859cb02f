// Time to load and to draw a long drive in the view Time. Prints numbers; asserts nothing.
//
//   TOPOGEO_BUILD=$PWD/build node tests/browser/film.mjs [STOPS=2000]
//
// A stub service plays a robot that maps a floor of 100 m x 60 m in rows 3 m apart: a stop each metre, 120 points each.
import { createRequire } from "node:module";
import { join } from "node:path";
import { kAddress, StandIn } from "./stand_in.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_CHROMIUM: chromium = "/usr/bin/chromium-headless-shell" } = process.env;
const count = Number(process.argv[2] ?? 2000);
const { chromium: browsers } = createRequire(join(build, "tests/browser/"))("playwright-core");
const kRow = 100;
const kPart = 200;

function stop(index) {
  const row = Math.floor(index / kRow);
  const along = index % kRow;
  const outline_cm = [];
  for (let i = 0; i < 120; ++i) {
    const angle = (i / 120 - 0.5) * Math.PI;
    const range = 400 + 300 * Math.sin(7 * angle + index);
    outline_cm.push(Math.round(range * Math.cos(angle)), Math.round(range * Math.sin(angle)));
  }
  const back = row % 2 === 1;
  return {
    stamp_s: index,
    x_m: back ? kRow - along : along,
    y_m: 3 * row,
    theta_rad: back ? Math.PI : 0,
    outline_cm,
  };
}

class LongDrive extends StandIn {
  async answer(route) {
    const url = new URL(route.request().url());
    if (url.pathname === "/api/drive") {
      const first = Number(url.searchParams.get("first"));
      const stops = Array.from({ length: Math.min(kPart, count - first) }, (_, i) => stop(first + i));
      return route.fulfill({ json: { total: count, version: "1", first, laser_m: [0, 0], stops } });
    }
    if (url.pathname === "/api/snapshots") return route.fulfill({ json: { snapshots: [] } });
    if (url.pathname === "/api/export") return route.fulfill({ json: { formats: [] } });
    return super.answer(route);
  }
}

const browser = await browsers.launch({
  executablePath: chromium,
  args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"],
});
try {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  await new LongDrive(join(build, "share/topogeo/web")).serve(context);
  const page = await context.newPage();
  await page.goto(`${kAddress}/#token=a`);
  await page.click("#tab-time");
  await page.getByRole("button", { name: "Load the drive" }).click();
  await page.locator("#film-slider").waitFor({ timeout: 120000 });
  await page.selectOption("#film-speed", "64");
  await page.click("#film-play");
  await new Promise((resolve) => setTimeout(resolve, 8000)); // the frames of these seconds are measured
  await page.screenshot({ path: join(build, "tests/browser/screenshots/film.png") });
  const measured = (name) =>
    page.evaluate((of) => performance.getEntriesByName(of).map((entry) => entry.duration), name);
  const [load] = await measured("film-loaded");
  const frames = (await measured("film-drawn")).sort((a, b) => a - b);
  const quantile = (share) => frames[Math.floor(share * (frames.length - 1))].toFixed(1);
  console.log(`${count} stops: loaded in ${(load / 1000).toFixed(1)} s`);
  console.log(`${frames.length} frames of 8 s: median ${quantile(0.5)} ms, 95 % ${quantile(0.95)} ms`);
} finally {
  await browser.close();
}
