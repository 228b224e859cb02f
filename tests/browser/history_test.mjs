// The views Understand and Time in a browser: loops with both local maps, the drive played, snapshots, versions
// compared and restored, files for other programs. A map store and the web service run without a robot: first on a
// read-only map, then on a database.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { drive_log } from "./drive_log.mjs";
import { assert_accessible, close, kPictures, launch, new_context, notice, open_page } from "./page.mjs";
import { wait_for, Robot } from "./robot.mjs";
import { kAddress, StandIn } from "./stand_in.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source, TOPOGEO_WORK: work } = process.env;

const robot = new Robot(join(build, "bin"), source, work);
const file = (name) => join(work, name);
const topogeo = (...options) => execFileSync(join(build, "bin/topogeo"), options, { stdio: ["ignore", "pipe", "ignore"] });
let browser;
let page;

/** Stops and loops of a map file, from its report. */
function facts(folder) {
  const report = topogeo("store", "info", file(`${folder}/map.pb`)).toString();
  return { stops: Number(/stops\s+(\d+)/.exec(report)[1]), loops: Number(/loops\s+(\d+)/.exec(report)[1]) };
}

before(async () => {
  for (const [name, ...drive] of [
    ["round", 6],
    ["half", 2],
    ["morning", 2, { furnished: true }],
    ["evening", 4, { furnished: true, first: 1 }], // in the same building
    ["elsewhere", 3, { furnished: true, scale: 0.7 }],
  ]) {
    writeFileSync(file(`${name}.clf`), drive_log(...drive));
    topogeo("map", "--log", file(`${name}.clf`), "--out", file(name));
  }
  await robot.start_store("--map", file("round/map.pb"));
  browser = await launch();
  page = await open();
});

after(async () => {
  await close(browser);
  await robot.stop();
});

async function open(address = robot.address, service = null) {
  const context = await new_context(browser, {
    viewport: { width: 1280, height: 800 },
    colorScheme: "light",
    bypassCSP: true,
  });
  await service?.serve(context);
  return open_page(context, `${address}/#token=${robot.token}`);
}

/** Waits until a selector has a text, and returns it. */
function text(selector, pattern, on = page) {
  return wait_for(`${selector} with ${pattern}`, async () =>
    (await on.locator(selector).allInnerTexts()).find((entry) => pattern.test(entry)),
  );
}

async function get(path) {
  const answer = await fetch(`${robot.address}${path}`);
  return { status: answer.status, bytes: Buffer.from(await answer.arrayBuffer()) };
}

/** Takes a screenshot and fails when axe-core finds something serious. */
async function picture(name, on = page) {
  await on.screenshot({ path: join(kPictures, `${name}.png`) });
  await assert_accessible(on, name);
}

test("a loop of a stored map shows both local maps laid on each other", async () => {
  await page.click("#tab-understand");
  const { loops } = facts("round");
  const counts = await text(".section p", new RegExp(`^${loops} accepted, \\d+ rejected`));
  const rejected = Number(/(\d+) rejected/.exec(counts)[1]);
  const { loop_candidates } = JSON.parse(readFileSync(file("round/report.json")));
  assert.equal(rejected, loop_candidates.length - loops); // as the report beside the map has them
  await page.getByRole("button", { name: "Accepted", exact: true }).click();
  const row = page.locator(".loops .row-title").first();
  const [, later, earlier] = /Scan point (\d+) at scan point (\d+)/.exec(await row.innerText());
  await row.click();
  await text(".loop-detail dt", /in the earlier one/);
  const shares = await page.locator(".loop-detail dd").allInnerTexts();
  for (const share of shares.slice(0, 2)) assert.match(share, /^\d+ %$/, shares.join("; ")); // fitness, probability
  const [overlap, near] = shares.slice(2, 4).map((share) => Number(/^(\d+) %$/.exec(share)?.[1]));
  assert.ok(overlap > 5 && near > 80, shares.join("; ")); // it was accepted, perhaps looking elsewhere
  await picture("understand-loop");
  const served = JSON.parse((await get(`/api/local_map?stop=${later}`)).bytes);
  assert.equal(served.number, Number(later));
  assert.ok(served.points_m.length > 100 && served.branches.length > 0);
  assert.ok(Number(earlier) < Number(later));
  await row.click();
  assert.equal(await page.locator(".loop-detail").isVisible(), false);
  if (rejected > 0) {
    await page.getByRole("button", { name: "Rejected", exact: true }).click();
    await page.locator(".loops .row-title").first().click();
    await text(".loop-detail dt", /in the earlier one/);
    await picture("understand-stored");
    await page.locator(".loops .row-title").first().click();
  }
});

test("local maps that there are not, and requests that mean nothing, are refused", async () => {
  assert.equal((await get("/api/local_map?stop=100000")).status, 404);
  assert.equal((await get("/api/local_map?session=1&number=7")).status, 404);
  assert.equal((await get("/api/local_map?stop=-1")).status, 400);
  assert.equal((await get("/api/drive?first=x")).status, 400);
  assert.equal((await get("/api/compare?before=a/b&after=")).status, 400);
  assert.equal((await get("/api/export/pgm/..%2Fmap.pgm")).status, 404);
});

test("the drive plays: the floor grows with it", async () => {
  await page.click("#tab-time");
  await page.getByRole("button", { name: "Load the drive" }).click();
  const { stops } = facts("round");
  await text(".film-moment", new RegExp(`^Scan point ${stops} of ${stops}`));
  await text(".stage .map-note", /Replay of the drive, not the present robot/);
  await page.locator("#film-slider").fill("0");
  await text(".film-moment", new RegExp(`^Scan point 1 of ${stops}`));
  await page.locator("#film-slider").fill("400");
  await picture("time-film");
  await page.selectOption("#film-speed", "64");
  await page.click("#film-play");
  await text(".film-moment", new RegExp(`^Scan point ${stops} of ${stops}`));
  const frames = await page.evaluate(() =>
    performance.getEntriesByName("film-drawn").map((entry) => entry.duration),
  );
  frames.sort((a, b) => a - b);
  const [load] = await page.evaluate(() => performance.getEntriesByName("film-loaded").map((entry) => entry.duration));
  console.log(
    `${stops} stops loaded in ${load.toFixed(0)} ms, drawn in ${frames[frames.length >> 1].toFixed(1)} ms (median)`,
  );
  await page.getByRole("button", { name: "Back to now" }).click();
  assert.equal(await page.locator(".film-controls").isVisible(), false);
  assert.equal(await page.locator(".map-note:visible").count(), 0);
});

test("every format of the store is a download, with the bytes that the command writes", async () => {
  const { formats } = JSON.parse((await get("/api/export")).bytes);
  assert.equal(formats.length, 13);
  for (const { format, files } of formats) {
    for (const name of files) {
      const { status, bytes } = await get(`/api/export/${format}/${name}`);
      // Masks and zone sets contain no zones, because the map has none.
      assert.equal(status, 200, `${format}: ${bytes.toString().slice(0, 200)}`);
      assert.ok(bytes.length > 0, name);
    }
  }
  for (const [format, name] of [
    ["g2o", "map.g2o"],
    ["pgm", "map.pgm"],
    ["pb", "map.pb"],
  ]) {
    const out = file(name.replace(/\.pgm$/, ""));
    topogeo("store", "export", file("round/map.pb"), "--format", format, "--out", out);
    const written = readFileSync(file(name));
    assert.ok(written.equals((await get(`/api/export/${format}/${name}`)).bytes), `${name} differs`);
  }
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: "Download map.pb" }).click(),
  ]);
  assert.ok(readFileSync(await download.path()).equals(readFileSync(file("map.pb"))));
});

test("the report of the drive is one page that needs no other file", async () => {
  await page.click("#tab-time");
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: "Save the report" }).click(),
  ]);
  const report = readFileSync(await download.path(), "utf8");
  assert.equal(download.suggestedFilename(), "report.html");
  const has = (pattern) => assert.ok(pattern.test(report), `${pattern}: ${report.replace(/base64,[^"]*/, "")}`);
  has(/<img src="data:image\/png;base64,/);
  has(/^(?![^]*(src|href)="(?!data:))/);
  const { stops, loops } = facts("round");
  has(new RegExp(`<dt>Scan points</dt><dd>${stops}</dd>`));
  has(new RegExp(`${loops} accepted`));
  has(/<dd>[\d.]+ m in [^<]*without the pauses<\/dd>/);
  const printed = await page.context().newPage();
  await printed.setContent(report);
  const pages = (await printed.pdf({ format: "A4" })).toString("latin1").match(/\/Type\s*\/Page\b/g);
  assert.equal(pages.length, 1);
  await picture("report", printed);
  await printed.setViewportSize({ width: 390, height: 844 });
  await printed.screenshot({ path: join(kPictures, "report-phone.png") });
  await printed.close();
});

test("a map that is only shown has no snapshots, and says so", async () => {
  assert.equal(await robot.post("snapshot", { name: "one" }), 409);
  await text(".section p", /A map that is only shown has no snapshots/);
});

test("without a robot nothing says that one was stopped or explores", async () => {
  await text(".state", /NO ROBOT\s+No robot connected\. Map only/i);
  assert.equal(await robot.post("stop", {}), 503);
  assert.equal(await robot.post("release", {}), 202);
  assert.equal(await robot.post("release", {}), 503);
  assert.equal(await robot.post("explore", {}), 409);
  // Nothing offers to stop or to command a robot. Space still sends a stop, and the page says that nobody heard it.
  assert.equal(await page.locator("#stop").isVisible(), false);
  await page.keyboard.press("Space");
  await notice(page, /^Stop was not accepted: .* The robot may still move\./);
  assert.equal(await page.locator("#stop-sent").isVisible(), false);
  assert.equal(await page.getByText("The robot is held.").count(), 0);
  await page.click("#tab-now");
  await text(".view p", /1 page is open/i);
  assert.doesNotMatch(await page.locator(".view:visible").innerText(), /may command|at work|unknown/i);
  assert.deepEqual(page.console_errors.filter((error) => !/503 .*\/api\/stop$/.test(error)), []);
  assert.deepEqual(page.faults, []);
});

test("snapshots are made, compared and restored", async () => {
  // Stores half of the drive as a snapshot of the whole one: a snapshot is a database that may be copied elsewhere.
  await robot.end("web");
  await robot.end("map_store");
  await robot.start_store("--continue", file("half/map.pb"), "--out", file("store_half"), "--new");
  await wait_for("a snapshot of the half", async () => (await robot.post("snapshot", { name: "half" })) === 200);
  await robot.end("web");
  await robot.end("map_store");
  await robot.start_store("--continue", file("round/map.pb"), "--out", file("store"), "--new");
  await wait_for("the map store makes its folder", () => existsSync(file("store/map.sqlite")));
  mkdirSync(file("store/map.snapshots"));
  copyFileSync(file("store_half/map.snapshots/half.sqlite"), file("store/map.snapshots/half.sqlite"));
  await page.reload();
  await page.click("#tab-time");

  await page.fill("#snapshot-name", "whole");
  await page.getByRole("button", { name: "Make a snapshot" }).click();
  await text(".snapshots h3", /^whole$/);
  // Fields are wide enough for whole names.
  for (const [field, width] of [["#snapshot-name", 200], ["#compare-before", 300], ["#compare-after", 300]]) {
    assert.ok((await page.locator(field).boundingBox()).width >= width, field);
  }
  assert.equal(await robot.post("snapshot", { name: "whole" }), 409); // there is one
  assert.equal(await robot.post("snapshot", { name: "more" }, "wrong"), 401);
  assert.equal(await robot.post("restore", { name: "none" }), 409);

  const areas = async (before, after) => {
    await page.selectOption("#compare-before", before);
    await page.selectOption("#compare-after", after);
    await page.getByRole("button", { name: "Compare", exact: true }).click();
    await text("dl dt", /Seen since/);
    return JSON.parse((await get(`/api/compare?before=${before}&after=${after}`)).bytes);
  };
  const none = await areas("whole", "");
  assert.deepEqual([none.gone_m2, none.new_m2, none.seen_m2, none.lost_m2], [0, 0, 0, 0]);
  const grown = await areas("half", "");
  // Most of the 2 x 5 m behind the block, which the first two sides of the corridor do not show.
  assert.ok(grown.seen_m2 > 5 && grown.seen_m2 < 11, JSON.stringify(grown));
  assert.ok(grown.gone_m2 < 1 && grown.new_m2 < 1, JSON.stringify(grown));
  await picture("time-versions");

  const half = facts("half").stops;
  assert.notEqual(half, facts("round").stops);
  const row = page.locator(".snapshots li", { has: page.getByRole("heading", { name: "half", exact: true }) });
  await row.getByRole("button", { name: "Restore" }).click();
  await row.getByRole("button", { name: "Restore it" }).click();
  await notice(page, /restoring snapshot half/i);
  // The question is gone, and so are the differences from the previous map.
  assert.equal(await page.getByRole("button", { name: "Restore it" }).isVisible(), false);
  assert.equal(await page.getByText("Seen since").first().isVisible(), false);
  await wait_for("the map of half", async () => {
    const { status, bytes } = await get("/api/drive");
    return status === 200 && JSON.parse(bytes).total === half;
  });
  const { snapshots } = JSON.parse((await get("/api/snapshots")).bytes);
  assert.ok(snapshots.some((snapshot) => snapshot.name === "before-half" && snapshot.stops === facts("round").stops));
  assert.deepEqual(page.faults, []);
});

test("snapshots are renamed and deleted on the page", async () => {
  const entry = (name) => page.locator(".snapshots li", { has: page.getByRole("heading", { name, exact: true }) });
  await page.reload();
  await page.click("#tab-time");
  await entry("whole").getByRole("button", { name: "Rename", exact: true }).first().click();
  await picture("time-rename");
  await entry("whole").getByRole("textbox").fill("week-1");
  await page.keyboard.press("Enter");
  await text(".snapshots h3", /^week-1$/);
  assert.equal(await entry("whole").count(), 0);
  const names = async () => JSON.parse((await get("/api/snapshots")).bytes).snapshots.map(({ name }) => name);
  assert.ok((await names()).includes("week-1"));
  assert.equal(await robot.post("snapshot_rename", { name: "week-1", new_name: "half" }), 409);
  assert.equal(await robot.post("snapshot_rename", { name: "week-1", new_name: "a/b" }), 400);
  assert.equal(await robot.post("snapshot_delete", { name: "week-1" }, "wrong"), 401);
  await entry("week-1").getByRole("button", { name: "Delete", exact: true }).click();
  await entry("week-1").getByRole("button", { name: "Delete week-1 for good" }).click();
  await wait_for("the snapshot is gone", async () => (await entry("week-1").count()) === 0);
  assert.ok(!(await names()).includes("week-1"));
  assert.deepEqual(page.faults, []);
});

/** Offers a map file on the page, and returns the page's answer. */
async function offer(name, pattern) {
  await page.setInputFiles("#merge-file", name);
  return text(".merge-result", pattern);
}

test("what is no map, or of another place, is not merged and says why", async () => {
  await robot.end("web");
  await robot.end("map_store");
  await robot.start_store("--continue", file("morning/map.pb"), "--out", file("store_merged"), "--new");
  await page.reload();
  await page.click("#tab-time");
  writeFileSync(file("none.pb"), "this is no map");
  assert.match(await offer(file("none.pb"), /was not merged/), /none\.pb was not merged\. The file: /);
  const bytes = readFileSync(file("evening/map.pb"));
  writeFileSync(file("cut.pb"), bytes.subarray(0, bytes.length / 2));
  assert.match(await offer(file("cut.pb"), /was not merged/), /The file: /);
  assert.match(await offer(file("elsewhere/map.pb"), /was not merged/), /The maps do not join/);
  assert.match(await offer(file("morning/map.pb"), /was not merged/), /one is an earlier state of the other/);
  assert.equal(await robot.post("merge_map", {}, "wrong"), 401);
  assert.equal(await robot.post("merge_map_answer", { number: 1, accept: true }), 409);
  await page.setInputFiles("#merge-file", {
    name: "huge.pb",
    mimeType: "application/octet-stream",
    buffer: Buffer.alloc(2 ** 20),
  });
  await text(".merge-result", /huge\.pb was not merged/);
});

test("another map of the place is merged once the operator has seen and accepted it", async () => {
  const { total } = JSON.parse((await get("/api/drive")).bytes);
  assert.equal(total, facts("morning").stops);
  await offer(file("evening/map.pb"), /map\.pb joins the map/);
  await text(".merge-result dt", /Seen since/);
  await picture("time-merge");
  await page.getByRole("button", { name: "Discard it" }).click();
  await notice(page, /The map stays as it is/);
  assert.equal(JSON.parse((await get("/api/drive")).bytes).total, total);

  const shown = await offer(file("evening/map.pb"), /map\.pb joins the map/);
  const joined = Number(/(\d+) scan points of the smaller map/.exec(shown)[1]);
  assert.ok(joined > total / 2, shown); // the map of the morning is the smaller one
  await page.getByRole("button", { name: "Make it the map" }).click();
  await notice(page, /restoring snapshot merged-/i);
  await wait_for("the merged map", async () => {
    const { status, bytes } = await get("/api/drive");
    return status === 200 && JSON.parse(bytes).total === facts("evening").stops + joined;
  });
  const names = JSON.parse((await get("/api/snapshots")).bytes).snapshots.map(({ name }) => name);
  assert.ok(names.some((name) => name.startsWith("before-merged-")), names.join());
  assert.deepEqual(page.faults, []);
});

/** A service whose robot has seen two rooms that look alike. */
class TwoRooms extends StandIn {
  async answer(route) {
    const url = new URL(route.request().url());
    if (url.pathname !== "/api/local_map") return super.answer(route);
    const number = Number(url.searchParams.get("stop"));
    const walls = [];
    for (let s = -2; s <= 2; s += 0.05) walls.push(2, s, s, 2, s, -2);
    const branches = [[-1, 0, 0, 0, 1, 0.1]];
    const nodes = [[0, 0, "real"]];
    return route.fulfill({ json: { session: "1", number, laser_m: [0, 0], nodes, branches, points_m: walls } });
  }

  show(channel, value) {
    this.tell({ channel, version: 1, value });
  }
}

test("the search shows while it runs, and why a loop was rejected", async () => {
  const service = new TwoRooms(join(build, "share/topogeo/web"));
  const own = await open(kAddress, service);
  await own.click("#tab-understand");
  await text(".search-state", /There was no search yet/, own);
  const covariance = [0.09, 0, 0, 0, 0.04, 0, 0, 0, 0.01];
  const table = (channel, set) => service.tell({ channel, from: 0, version: 1, set, gone: [] });
  const stops = Array.from({ length: 9 }, (_, i) => [i - 4, 0, 0]);
  table("trail", { 0: stops });
  const loop = { step: 8, earlier: 1, later: 8, accepted: false, outcome: "gate", source: "place" };
  Object.assign(loop, { x_m: 6.2, y_m: 0.1, theta_rad: 0.02, fitness: 0.71, probability: 0.2 });
  Object.assign(loop, { predicted: { x_m: 7, y_m: 0, theta_rad: 0, covariance }, explanation: "the maps fit elsewhere" });
  table("loops", { 0: { ...loop, correction_m: 0.8, correction_rad: 0.02 } });
  const match = { x_m: 3, y_m: 0, theta_rad: 0, base_theta_rad: 0.1, half_widths: [1, 0.7, 0.3], covariance };
  service.show("search", { stamp_s: 1, tasks: 1, running: true, whole_map: false, matches: [{ ...match, done: false, hypotheses: [] }], hypotheses: [] });
  await text(".search-state", /1 match is worked on/, own);
  const hypotheses = [[2.4, 0.3, 0.1, 0.83], [3.6, -0.2, 3, 0.41]];
  const done = { ...match, done: true, accepted: true, fitness: 0.83, hypotheses };
  service.show("search", { stamp_s: 1, tasks: 1, running: false, whole_map: false, matches: [done], hypotheses: [] });
  await text(".search-state", /1 match, 1 accepted/, own);
  await own.screenshot({ path: join(kPictures, "understand-search.png") });
  service.show("search", { stamp_s: 2, tasks: 72, running: false, whole_map: true, matches: [], hypotheses });
  await text(".search-state", /2 places fit best/, own);

  await own.locator(".loops .row-title").click();
  await text(".loop-detail p", /The maps fit elsewhere/, own);
  await text(".loop-detail dd", /0\.81 m, 1\.1°/, own);
  await text(".loop-detail dd", /71 %/, own);
  await picture("understand-rejected", own);
  assert.deepEqual(own.faults, []);
});
