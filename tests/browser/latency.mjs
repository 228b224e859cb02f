// Latency of a pose from its message to the screen, in parts, and the cost of viewers for the localizer. Prints a
// table; asserts nothing.
//
//   TOPOGEO_BUILD=$PWD/build TOPOGEO_SOURCE=$PWD node tests/browser/latency.mjs [SECONDS=20] [VIEWERS=20]
//
// A simulated robot turns on the spot; all clocks are that of this machine. The stamp of a pose is the time at which
// the base sent its odometry. The localizer sends the pose, the web service receives it, the page receives it, and it
// is on the screen when the frame after the one that draws it begins.
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { wait_for, Robot } from "./robot.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source, TOPOGEO_CHROMIUM: chromium = "/usr/bin/chromium-headless-shell" } = process.env;
const seconds = Number(process.argv[2] ?? 20);
const viewers = Number(process.argv[3] ?? 20);
const { chromium: browsers } = createRequire(join(build, "tests/browser/"))("playwright-core");

const work = mkdtempSync(join(tmpdir(), "topogeo-latency-"));
const robot = new Robot(join(build, "bin"), source, work);
const browser = await browsers.launch({
  executablePath: chromium,
  args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"],
});

/** In a page: logs the ages of each pose in ms since its odometry, its message, the web service, the page. */
function watch_poses() {
  window.drawn = [];
  const Plain = window.WebSocket;
  window.WebSocket = class extends Plain {
    set onmessage(handler) {
      super.onmessage = (event) => {
        const came = performance.timeOrigin + performance.now();
        handler(event);
        const message = JSON.parse(event.data);
        if (message.channel !== "pose" || !message.value) return;
        const { stamp_s, sent_s, heard_s } = message.value;
        // The page draws with the next frame; the one after that begins when it is on the screen.
        requestAnimationFrame(() =>
          requestAnimationFrame(() => {
            const now = performance.timeOrigin + performance.now();
            window.drawn.push({
              odometry: 1000 * (sent_s - stamp_s),
              service: 1000 * (heard_s - sent_s),
              page: came - 1000 * heard_s,
              screen: now - came,
              all: now - 1000 * sent_s,
            });
          }),
        );
      };
    }
  };
}

/** In a page: opens viewers that get everything and show nothing. */
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
  await wait_for("the robot has a pose", () => page.evaluate(() => window.drawn.length > 10));
  await page.click("#tab-send");
  await page.getByText("Drive by hand", { exact: true }).click();
  await page.getByRole("button", { name: "Take the controls" }).click();
  await page.keyboard.down("a");
  console.log(`median, 95 % in ms; CPU in ms a second
| viewers | poses | message to screen | odometry to message | message to web service | to page | to screen | CPU of localizer | of web |
|---|---|---|---|---|---|---|---|---|`);
  const crowd = await browser.newPage();
  await crowd.goto(`${robot.address}/icon.svg`);
  for (const others of [0, viewers]) {
    await crowd.evaluate(open_viewers, others);
    await page.evaluate(() => (window.drawn.length = 0));
    const before = { localizer: robot.cpu_s("localizer"), web: robot.cpu_s("web") };
    await new Promise((resolve) => setTimeout(resolve, 1000 * seconds)); // poses of these seconds are measured
    const cpu = (name) => ((1000 * (robot.cpu_s(name) - before[name])) / seconds).toFixed(1);
    const drawn = await page.evaluate(() => window.drawn);
    const quantiles = (part) => {
      const values = drawn.map((pose) => pose[part]).sort((a, b) => a - b);
      return [0.5, 0.95].map((share) => values[Math.floor(share * (values.length - 1))]?.toFixed(0)).join(", ");
    };
    const parts = ["all", "odometry", "service", "page", "screen"].map(quantiles).join(" | ");
    console.log(`| ${others + 1} | ${drawn.length} | ${parts} | ${cpu("localizer")} | ${cpu("web")} |`);
    await crowd.evaluate(() => window.sockets.forEach((socket) => socket.close()));
  }
  await page.keyboard.up("a");
} finally {
  await browser.close();
  await robot.stop();
  rmSync(work, { recursive: true, force: true });
}
