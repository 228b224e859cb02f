// Measures the page with a large map, without a robot: a floor of 2 x 2 km with 100,000 branch points.
//   ctest --test-dir build -R browser.page    fetches the browser driver
//   TOPOGEO_BUILD=build node tests/browser/large_map.mjs
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { extname, join, resolve } from "node:path";
import { deflateSync } from "node:zlib";

const build = resolve(process.env.TOPOGEO_BUILD ?? "build");
const { chromium } = createRequire(join(build, "tests/browser/"))("playwright-core");
const kOrigin = "http://127.0.0.1:1";
const kTypes = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const kSide_m = 2000;
const kResolution_m = 0.25; // 125 x 125 squares of 64 x 64 cells
const kBranches = 2000;
const kBranchPoints = 50;

// A picture of 256 x 256 pixels: free, with lines of occupied cells.
function picture() {
  const table = Array.from({ length: 256 }, (_, n) => {
    for (let bit = 0; bit < 8; ++bit) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
    return n >>> 0;
  });
  const crc = (bytes) => ~bytes.reduce((sum, byte) => table[(sum ^ byte) & 255] ^ (sum >>> 8), ~0) >>> 0;
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]);
    const frame = Buffer.alloc(8);
    frame.writeUInt32BE(data.length, 0);
    frame.writeUInt32BE(crc(body), 4);
    return Buffer.concat([frame.subarray(0, 4), body, frame.subarray(4)]);
  };
  const header = Buffer.alloc(13);
  header.writeUInt32BE(256, 0);
  header.writeUInt32BE(256, 4);
  header.set([8, 0], 8); // grey
  const rows = Buffer.alloc(256 * 257, 255);
  for (let row = 0; row < 256; ++row) {
    rows[257 * row] = 0;
    for (let column = 0; column < 256; column += row % 32 === 0 ? 1 : 64) rows[257 * row + 1 + column] = 32;
  }
  const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
  return Buffer.concat([
    signature,
    chunk("IHDR", header),
    chunk("IDAT", deflateSync(rows)),
    chunk("IEND", Buffer.alloc(0)),
  ]);
}

// A path in steps of 0.3 m from a lattice point; it is the same in each run.
function branch(number) {
  const points = [];
  let x = (number % 45) * (kSide_m / 45);
  let y = Math.floor(number / 45) * (kSide_m / 45);
  for (let i = 0; i < kBranchPoints; ++i) {
    points.push(Number(x.toFixed(3)), Number(y.toFixed(3)));
    const heading = number + 0.6 * Math.sin(0.3 * i + number);
    x += 0.3 * Math.cos(heading);
    y += 0.3 * Math.sin(heading);
  }
  return { a: number, b: number + 1, virtual: false, seen: 1, points_m: points };
}

function snapshots() {
  const cells = kSide_m / kResolution_m;
  const value = (channel, content) => ({ channel, version: 1, value: content });
  const table = (channel, set) => ({ channel, from: 0, version: 1, set, gone: [] });
  const graph = Object.fromEntries(Array.from({ length: kBranches }, (_, i) => [`b${i}`, branch(i)]));
  const squares = Math.ceil(cells / 64) ** 2;
  return [
    value("map", {
      version: "1",
      columns: cells,
      rows: cells,
      resolution_m: kResolution_m,
      frame: "00000000",
      x_m: 0,
      y_m: 0,
      theta_rad: 0,
    }),
    table("tiles", Object.fromEntries(Array.from({ length: squares }, (_, i) => [i, 1]))),
    table("graph", graph),
  ];
}

async function open(browser) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  const tile = picture();
  await page.route("**/*", (route) => {
    const { pathname } = new URL(route.request().url());
    if (pathname.startsWith("/tiles/")) return route.fulfill({ contentType: "image/png", body: tile });
    if (pathname.startsWith("/api/")) return route.fulfill({ json: {} });
    const file = join(build, "share/topogeo/web", pathname === "/" ? "index.html" : pathname);
    if (!existsSync(file)) return route.fulfill({ status: 404 });
    return route.fulfill({ contentType: kTypes[extname(file)], body: readFileSync(file) });
  });
  await page.routeWebSocket("**/ws", (socket) => {
    socket.onMessage((text) => {
      if (JSON.parse(text).op !== "hello") return;
      socket.send(JSON.stringify({ op: "welcome", protocol: 1, life: "x", may_write: false, robot_id: "robot" }));
      for (const message of snapshots()) socket.send(JSON.stringify(message));
    });
  });
  await page.goto(`${kOrigin}/`);
  await page.waitForFunction(() => performance.getEntriesByName("map-shown").length > 0);
  return page;
}

// Milliseconds of script and of layout for each frame while the map is dragged back and forth.
async function drag(page) {
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable");
  const metrics = async () => {
    const { metrics: list } = await session.send("Performance.getMetrics");
    return Object.fromEntries(list.map(({ name, value }) => [name, value]));
  };
  await page.evaluate(() => {
    window.frames_ms = [];
    let last = performance.now();
    const count = () => {
      window.frames_ms.push(performance.now() - last);
      last = performance.now();
      requestAnimationFrame(count);
    };
    requestAnimationFrame(count);
  });
  const before = await metrics();
  await page.mouse.move(400, 400);
  await page.mouse.down();
  for (let i = 0; i < 200; ++i) {
    await page.mouse.move(400 + 350 * Math.sin(i / 12), 400 + 280 * Math.sin(i / 17));
  }
  await page.mouse.up();
  const after = await metrics();
  const frames = (await page.evaluate(() => window.frames_ms)).sort((a, b) => a - b);
  const per_frame = (...names) =>
    (1000 * names.reduce((sum, name) => sum + after[name] - before[name], 0)) / frames.length;
  return {
    script_ms: per_frame("ScriptDuration"),
    layout_ms: per_frame("LayoutDuration", "RecalcStyleDuration"),
    median_ms: frames[frames.length >> 1],
    p95_ms: frames[Math.floor(0.95 * frames.length)],
  };
}

const browser = await chromium.launch({
  executablePath: process.env.TOPOGEO_CHROMIUM ?? "/usr/bin/chromium-headless-shell",
  args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"],
});
try {
  const page = await open(browser);
  const shown_ms = await page.evaluate(() => performance.getEntriesByName("map-shown")[0].startTime);
  console.log(`map on the screen ${shown_ms.toFixed(0)} ms after opening`);
  for (const [name, zooms] of [
    ["all of it", 0],
    ["zoomed in", 5],
  ]) {
    for (let i = 0; i < zooms; ++i) {
      await page.getByRole("button", { name: "Zoom in" }).click();
      await page.waitForTimeout(400); // the animation of the zoom is not measured
    }
    const { script_ms, layout_ms, median_ms, p95_ms } = await drag(page);
    console.log(
      `dragged, ${name}: script ${script_ms.toFixed(2)} ms and layout ${layout_ms.toFixed(2)} ms a frame; ` +
        `between frames ${median_ms.toFixed(1)} ms (median), ${p95_ms.toFixed(1)} ms (95 %)`,
    );
  }
} finally {
  await browser.close();
}
