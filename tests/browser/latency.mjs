// How old a pose is when the page has drawn it, and what viewers cost the localizer. Prints a table; asserts nothing.
//
//   TOPOGEO_BUILD=$PWD/build TOPOGEO_SOURCE=$PWD node tests/browser/latency.mjs [SECONDS=20] [VIEWERS=20]
//
// A simulated robot turns on the spot. The stamp of a pose is the clock of this machine when the base sent its odometry,
// so gateway and localizer are in the figure, too.
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { eventually, Robot } from "./robot.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source, TOPOGEO_CHROMIUM: chromium = "/usr/bin/chromium" } = process.env;
const seconds = Number(process.argv[2] ?? 20);
const viewers = Number(process.argv[3] ?? 20);
const { chromium: browsers } = createRequire(join(build, "tests/browser/"))("playwright-core");

const work = mkdtempSync(join(tmpdir(), "topogeo-latency-"));
const robot = new Robot(join(build, "bin"), source, work);
const browser = await browsers.launch({
  executablePath: chromium,
  args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"],
});

/** Counts, in a page, how old each pose is when its frame has been drawn. */
function watch_poses() {
  window.ages_ms = [];
  window.arrived_ms = [];
  const Plain = window.WebSocket;
  window.WebSocket = class extends Plain {
    set onmessage(handler) {
      super.onmessage = (event) => {
        handler(event);
        const message = JSON.parse(event.data);
        if (message.channel !== "pose" || !message.value) return;
        window.arrived_ms.push(Date.now() - 1000 * message.value.stamp_s);
        // The page draws with the next frame; the one after that begins when it is on the screen.
        requestAnimationFrame(() =>
          requestAnimationFrame(() => window.ages_ms.push(Date.now() - 1000 * message.value.stamp_s)),
        );
      };
    }
  };
}

/** In a page: so many that get everything and show nothing. */
function open_viewers(count) {
  window.sockets = Array.from({ length: count }, () => {
    const socket = new WebSocket(`ws://${location.host}/ws`);
    socket.onopen = () => socket.send('{"op":"hello"}');
    return socket;
  });
}

try {
  await robot.start();
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.addInitScript(watch_poses);
  await page.goto(`${robot.address}/#token=${robot.token}`);
  await eventually("the robot has a pose", () => page.evaluate(() => window.ages_ms.length > 10), 120);
  await page.click("#tab-send");
  await page.getByText("Drive by hand", { exact: true }).click();
  await page.getByRole("button", { name: "Take the controls" }).click();
  await page.keyboard.down("a");
  console.log("| viewers | poses | age on the screen: median, 95 %, ms | age when the page has it | CPU of localizer, ms a second | of web |\n|---|---|---|---|---|---|");
  const crowd = await browser.newPage();
  await crowd.goto(`${robot.address}/icon.svg`);
  for (const others of [0, viewers]) {
    await crowd.evaluate(open_viewers, others);
    await page.evaluate(() => (window.ages_ms.length = window.arrived_ms.length = 0));
    const before = { localizer: robot.cpu_s("localizer"), web: robot.cpu_s("web") };
    await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
    const cpu = (name) => ((1000 * (robot.cpu_s(name) - before[name])) / seconds).toFixed(1);
    const ages = await page.evaluate(() => window.ages_ms);
    const arrived = await page.evaluate(() => window.arrived_ms);
    const quantiles = (values) => {
      values.sort((a, b) => a - b);
      return [0.5, 0.95].map((share) => values[Math.floor(share * (values.length - 1))]?.toFixed(0)).join(", ");
    };
    const costs = `${cpu("localizer")} | ${cpu("web")}`;
    console.log(`| ${others + 1} | ${ages.length} | ${quantiles(ages)} | ${quantiles(arrived)} | ${costs} |`);
    await crowd.evaluate(() => window.sockets.forEach((socket) => socket.close()));
  }
  await page.keyboard.up("a");
} finally {
  await browser.close();
  await robot.stop();
  rmSync(work, { recursive: true, force: true });
}
