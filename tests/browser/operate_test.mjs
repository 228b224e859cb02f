// The page with a stub service: signs of waiting for an answer, texts without contradictions, the keyboard alone, the
// panel on small screens.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { assert_accessible, close, kPictures, kSizes, launch, new_context, notice, open_page, text } from "./page.mjs";
import { hold_key, wait_for } from "./robot.mjs";
import { kAddress, StandIn } from "./stand_in.mjs";

const { TOPOGEO_BUILD: build } = process.env;
const kPose = {
  state: "TRACKING",
  reason: "What the laser sees fits the map.",
  mode: "localization",
  x_m: 1,
  y_m: 0,
  theta_rad: 0,
  covariance: [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01],
  confidence: 1,
};

const kBegun = { visited: 0, given_up: 0, ended: false };

let browser;

before(async () => {
  browser = await launch();
});

after(() => close(browser));

/** A robot whose localizer answers on the test's command. */
class SlowLocalizer extends StandIn {
  answers = []; // pending

  constructor() {
    super(join(build, "share/topogeo/web"));
    this.offers = [...this.offers, "pose", "search", "mode"];
  }

  /** Opens a page without waiting for a state. */
  async serve_with(of, use) {
    const context = await new_context(of, { viewport: kSizes.desk });
    await this.serve(context);
    const page = await open_page(context, `${kAddress}/#token=${"t".repeat(16)}`);
    await wait_for("the page is connected", () => this.ops.includes("hello"));
    await use(page);
    await end({ page, context });
  }

  answer(route) {
    const { pathname } = new URL(route.request().url());
    if (pathname !== "/api/pose" && pathname !== "/api/search") return super.answer(route);
    this.answers.push((status, json) => route.fulfill({ status, json }));
  }

  /** Answers the oldest pending order, once it has come. */
  async answer_next(status, json) {
    const reply = await wait_for("an order", () => this.answers.shift());
    await reply(status, json);
  }

  show(channel, value) {
    this.keep_showing({ channel, version: 1, value });
  }

  table(channel, set) {
    this.keep_showing({ channel, from: 0, version: 1, set, gone: [] });
  }

  /** A busy machine may interrupt the connection; then the page gets the message again. */
  keep_showing(message) {
    this.shown.set(message.channel, message);
    this.tell(message);
  }
}

/** Waits until a selector has a text, and repeats a value for so long, because values get old within seconds. */
async function text_of_fresh(page, service, channel, value, selector, pattern) {
  await wait_for(`${selector} with ${pattern}`, async () => {
    service.show(channel, value);
    return (await page.locator(selector).allInnerTexts()).some((entry) => pattern.test(entry));
  });
}

/** `script` runs in the page before its own. */
async function open({ path = "/", service = new SlowLocalizer(), script = () => {}, ...options } = {}) {
  const context = await new_context(browser, { viewport: kSizes.desk, colorScheme: "light", bypassCSP: true, ...options });
  await context.addInitScript(script);
  await service.serve(context);
  const page = await open_page(context, `${kAddress}${path}#token=${"t".repeat(16)}`);
  await text(page, ".state", /No position/i);
  await text_of_fresh(page, service, "pose", kPose, ".state-word", /Position known/i);
  return { page, service, context };
}

async function end({ page, context }) {
  assert.deepEqual(page.faults, []);
  await context.close();
}

/** A page gives an order up after ten seconds, which a busy machine may need for a few steps of a test. */
function wait_for_answers() {
  const set_timer = window.setTimeout;
  window.setTimeout = (run, ms, ...more) => set_timer(run, ms === 10_000 ? 3_600_000 : ms, ...more);
}

test("an order that is not answered shows that it waits, and at the end that nobody answers", async () => {
  const opened = await open({ script: wait_for_answers });
  const { page, service } = opened;
  await page.click("#tab-correct");
  await page.getByRole("button", { name: "Set on the map" }).click();
  const apply = page.getByRole("button", { name: "Apply" });
  await apply.click();
  await notice(page, /The order is sent\. The page waits for the answer/);
  assert.equal(await apply.isDisabled(), true);
  await notice(page, /The service has not answered yet/);
  await service.answer_next(503, { error: "no localizer has answered" });
  await notice(page, /No localizer has answered/);
  assert.equal(await page.getByText("The service has not answered yet").count(), 0);
  assert.equal(await apply.isEnabled(), true); // the numbers are unchanged
  await apply.click();
  await notice(page, /The order is sent/);
  await service.answer_next(200, { accepted: true });
  await notice(page, /The position is set/);
  assert.equal(await page.getByText("The order is sent").count(), 0);

  const search = page.getByRole("button", { name: "Search", exact: true });
  await search.click();
  await notice(page, /The order is sent/);
  assert.equal(await search.isDisabled(), true);
  await service.answer_next(200, { accepted: true });
  await notice(page, /The whole map is searched/);
  assert.equal(await search.isEnabled(), true);
  await end(opened);
});

test("why the state is what it is follows the header when poses stop", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-understand");
  await text_of_fresh(page, service, "pose", kPose, ".section p", /^Position known\. The laser fits the map/);
  await text_of_fresh(page, service, "pose", kPose, ".bar", /100 %/);
  await page.evaluate(() => {
    const now = performance.now.bind(performance);
    performance.now = () => now() + 20_000;
  });
  await text(page, ".state-word", /No position/i);
  await text(page, ".section p", /^No position\. No position for over ten/);
  assert.equal(await page.getByText("100 %").count(), 0);
  await end(opened);
});

test("a rejected loop that is probable says what decided", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-understand");
  const loop = { x_m: 0, y_m: 0, theta_rad: 0, source: "place", fitness: 0.8, probability: 0.98 };
  Object.assign(loop, { correction_m: 0.5, correction_rad: 0.1, step: 9, earlier: 1 });
  service.table("loops", {
    0: { ...loop, later: 8, accepted: false, outcome: "unconfirmed", explanation: "unconfirmed" },
    1: { ...loop, later: 9, accepted: true, outcome: "accepted", explanation: "" },
  });
  await text(page, ".loops li", /Scan point 8 at scan point 1[^]*estimated 98 % probable; would move the scan point by 0\.50 m/);
  await text(page, ".loops li", /Scan point 9 at scan point 1[^]*estimated 98 % probable; moves the scan point by 0\.50 m/);
  await page.getByRole("button", { name: "Scan point 8 at scan point 1" }).click();
  await text(page, ".loop-detail p", /probably right\. The reason above rejects the loop/);
  await page.getByRole("button", { name: "Scan point 9 at scan point 1" }).click();
  assert.equal(await page.getByText("the reason above decides").count(), 0);
  await end(opened);
});

test("while it explores, what is left is that to the next point", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  service.show("goals", { current: { text: "what is not mapped yet (a gap)" }, waiting: [], exploring: true, exploration: kBegun });
  const navigator = { state: "driving", reason: "none", message: "drives", rest_m: 0.24, rest_s: 2, driven_m: 3 };
  service.show("navigator", navigator);
  await text(page, ".section p", /0\.24 m to the next point, about 2 s\.$/);
  service.show("goals", { current: { text: "room A" }, waiting: [], exploring: false });
  await text(page, ".section p", /^0\.24 m left, about 2 s$/);
  await end(opened);
});

test("the header says what the robot does, or what it waits for", async () => {
  const opened = await open();
  const { page, service } = opened;
  const activity = (pattern) => text(page, "#activity", pattern);
  const navigator = { state: "driving", reason: "none", message: "drives", rest_m: 8, rest_s: 14, driven_m: 1 };
  const goals = { current: { text: "room 3" }, waiting: [], exploring: false };
  await activity(/^Idle$/);
  service.show("goals", goals);
  service.show("navigator", navigator);
  await activity(/^Driving to room 3 \(8\.00 m, 14 s\)$/);
  service.show("navigator", { ...navigator, rest_m: 0, rest_s: 0, message: "at the goal, checking its position" });
  await activity(/^At room 3, checking its position$/);
  service.show("navigator", { ...navigator, state: "stopped", reason: "waits_for_route" });
  await activity(/^Planning the route to room 3$/);
  service.show("navigator", { ...navigator, state: "blocked", reason: "obstacle" });
  await activity(/^Waiting for a free path to room 3$/);
  service.show("navigator", { ...navigator, state: "stopped", reason: "paused" });
  await activity(/^Paused on the way to room 3$/);
  service.show("navigator", { ...navigator, state: "arrived", message: "arrived" });
  service.show("goals", { ...goals, waiting: [{ text: "room 4" }], waits_s: 30_000, round: { now: 2, of: 3 } });
  await activity(/^Stays at room 3 \(8 h \d+ min left\)$/);
  await page.click("#tab-send");
  await text(page, ".section h3", /^Stays at room 3/);
  await text(page, ".section p", /^Round 2 of 3\. Then: room 4$/);
  await page.getByRole("button", { name: "Drive on now" }).click();
  await wait_for("the order", () => service.orders.includes("resume"));
  service.show("goals", { current: { text: "a gap" }, waiting: [], exploring: true });
  service.show("navigator", navigator);
  await activity(/^Exploring$/);
  service.show("drive", { held: true, linear_mps: 0.3, angular_radps: 0, free_ahead_m: 2, message: "" });
  await activity(/^Driven by hand$/);
  service.show("controls", { holder: { page: 2, name: "Anna" }, asking: null, stopped_by: "Ben" });
  await activity(/^Driven by hand by Anna$/);
  service.show("base", { ...kBase, state: "halted" });
  await activity(/^Held by Ben$/);
  service.show("base", { ...kBase, state: "emergency_stop" });
  await activity(/^Emergency stop$/);
  await assert_accessible(page, "an activity");
  service.cut();
  await wait_for("nothing is said of the robot", async () => !(await page.locator("#activity").isVisible()));
  await end(opened);
});

test("after a stop and its release, the page offers to resume what was interrupted", async () => {
  const opened = await open();
  const { page, service } = opened;
  await show_banners(page);
  const goals = { current: null, waiting: [], exploring: false };
  service.show("goals", { ...goals, interrupted: { text: "room 3", waiting: 1, exploring: false } });
  service.show("base", { ...kBase, state: "halted" });
  await text(page, ".banner", /Held\. Release it to drive\. It was on the way to room 3 and 1 more/);
  const resume = page.getByRole("button", { name: "Resume: to room 3 and 1 more" });
  assert.equal(await resume.isVisible(), false, "a held robot is released first");
  await page.getByRole("button", { name: "Release", exact: true }).click();
  await wait_for("the release", () => service.orders.includes("release"));
  service.show("base", { ...kBase, state: "ready" });
  await assert_accessible(page, "a goal that can be resumed");
  await resume.click();
  await wait_for("the order", () => service.orders.includes("resume"));
  service.show("goals", { ...goals, interrupted: { text: "", waiting: 0, exploring: true } });
  await page.getByRole("button", { name: "Resume: to places that are not mapped yet" }).waitFor();
  await page.getByRole("button", { name: "Forget it" }).click();
  await wait_for("the order", () => service.orders.includes("cancel"));
  service.show("goals", { ...goals, interrupted: null });
  await wait_for("the offer goes", async () => !(await page.getByRole("button", { name: /^Resume/ }).isVisible()));
  await end(opened);
});

test("an exploration says what it has done and when it is at its end", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  const goals = { current: { text: "a gap" }, waiting: [], exploring: true };
  const navigator = { state: "driving", reason: "none", message: "drives", rest_m: 0, rest_s: 1, driven_m: 3 };
  service.show("navigator", navigator);
  service.show("goals", { ...goals, exploration: { visited: 3, given_up: 1, ended: false } });
  const rest = ".section p.quiet";
  await text(page, rest, /^3 places visited, 1 of them not reached, 32\.0 m² mapped\. Choosing the next point …$/);
  service.show("navigator", { ...navigator, rest_m: 2, rest_s: 4 });
  await text(page, rest, /mapped\. 2\.00 m to the next point, about 4 s\.$/);
  const ended = { visited: 5, given_up: 0, ended: true };
  service.show("navigator", { ...navigator, state: "idle" });
  service.show("goals", { current: null, waiting: [], exploring: false, exploration: ended });
  await text(page, ".section h3", /^Exploration finished: everything that can be reached is mapped/);
  await text(page, rest, /^5 places visited, 32\.0 m² mapped\.$/);
  await end(opened);
});

test("driving by hand shows the free distance in the direction of motion alone", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  await page.getByText("Drive by hand", { exact: true }).click();
  const drive = { held: true, linear_mps: 0, angular_radps: 0, free_ahead_m: 0, free_behind_m: null, message: "" };
  service.show("drive", drive);
  await text(page, ".drive [role=status]", /^Stands\.$/);
  service.show("drive", { ...drive, linear_mps: 0.3, free_ahead_m: 2.5 });
  await text(page, ".drive [role=status]", /^0\.30 m\/s, 2\.50 m free ahead\.$/);
  service.show("drive", { ...drive, linear_mps: -0.2, free_ahead_m: null, free_behind_m: 1.5 });
  await text(page, ".drive [role=status]", /^-0\.20 m\/s, 1\.50 m free behind\.$/);
  await end(opened);
});

// The last size is a screen of 1366 x 768 at a zoom of 200 %.
for (const [width, height] of [[320, 568], [390, 844], [844, 390], [1920, 1080], [683, 384]]) {
  test(`on ${width} x ${height} the map has its share, and nothing is covered`, async () => {
    const opened = await open({ viewport: { width, height } });
    const { page, service } = opened;
    await page.addStyleTag({ content: ".header { height: auto !important; overflow: visible !important }" });
    service.show("goals", { current: { text: "room 3" }, waiting: [], exploring: false });
    service.show("navigator", { state: "driving", reason: "none", message: "drives", rest_m: 8, rest_s: 14 });
    await text(page, "#activity", /Driving to room 3/);
    for (const view of ["now", "send", "correct", "understand", "draw", "time"]) {
      await page.click(`#tab-${view}`);
      // All at once, because a busy machine may change the header's text meanwhile.
      const [map, panel, controls, wide, hidden] = await page.evaluate(() => {
        const box = (element) => element.getBoundingClientRect().toJSON();
        const one = (selector) => box(document.querySelector(selector));
        const all = [...document.querySelectorAll(".controls .control")].map(box);
        const { scrollWidth, clientWidth } = document.querySelector("#panel");
        return [one(".stage"), one("#panel"), all, document.documentElement.scrollWidth, scrollWidth - clientWidth];
      });
      assert.ok(map.height >= 0.4 * height || map.width >= 0.4 * width, `${view}: ${JSON.stringify(map)}`);
      assert.ok(map.height >= 0.3 * height && map.width >= 0.3 * width, `${view}: ${JSON.stringify(map)}`);
      assert.ok(wide <= width, `${view} is ${wide} wide`);
      assert.equal(hidden, 0, `${view}: pixels beyond the edge of the panel`);
      for (const at of controls) {
        assert.ok(at.top >= map.top && at.bottom <= map.bottom + 1, `${view}: ${JSON.stringify([at, map])}`);
      }
      assert.ok(panel.height >= 80, `${view}: its panel`);
      await assert_accessible(page, `${view}, ${width} x ${height}`);
    }
    const name = await page.locator(".robot-name").boundingBox();
    assert.ok(name.width > 20 && name.height > 8, "the robot's name");
    await page.click("#tab-send");
    await page.getByText("Drive by hand", { exact: true }).click();
    await page.getByRole("button", { name: "Take the controls" }).click();
    await page.locator("#drive-speed").waitFor();
    const speed = await page.locator("#drive-speed").boundingBox();
    const panel = await page.locator("#panel").boundingBox();
    assert.ok(speed.y >= panel.y && speed.y + speed.height <= panel.y + panel.height, "the speed is out of sight");
    await end(opened);
  });
}

test("a map without a robot says nothing of one", async () => {
  const opened = await open();
  const { page, service } = opened;
  const quiet = { state: "running", host: "desk", message: "", waits_for: "", input: "", faults: 0, last_error: "" };
  service.table("services", { 1: { ...quiet, service: "web" }, 2: { ...quiet, service: "map_store" } });
  service.show("pose", null);
  await text(page, ".state-word", /No robot/i);
  assert.equal(await page.locator("#stop").isVisible(), true); // a robot was heard since the page was opened
  service.show("navigator", null);
  await wait_for("nothing offers to stop a robot", async () => !(await page.locator("#stop").isVisible()));
  await page.keyboard.press("Space");
  await wait_for("Space sends a stop nevertheless", () => service.orders.includes("stop"));
  service.show("viewers", { viewers: 1, operators: 1 });
  await text(page, ".state-word", /No robot/i);
  await text(page, "p.quiet", /^1 page is open\.$/);
  for (const value of await page.getByText("unknown").all()) assert.equal(await value.isVisible(), false);
  const loop = { x_m: 0, y_m: 0, theta_rad: 0, source: "", fitness: null, probability: null, outcome: "accepted" };
  Object.assign(loop, { correction_m: null, correction_rad: null, step: 9, earlier: 1, later: 8 });
  service.table("loops", { 0: { ...loop, accepted: true, explanation: "" } });
  await page.click("#tab-understand");
  assert.equal(await page.getByText("Confidence of the position").last().isVisible(), false);
  await text(page, ".section p", /^1 accepted\. Nothing is kept about rejected ones\.$/);
  await text(page, ".loops li", /Accepted\.[^]*No evidence of it is kept with the map/);
  await end(opened);
});

test("where the laser does not fit, the header says so, and driving asks first", async () => {
  const opened = await open();
  const { page, service } = opened;
  service.show("navigator", { state: "idle", reason: "none", message: "" });
  const scan = { points_robot_m: [1, 0], x_m: 1, y_m: 0, theta_rad: 0 };
  await page.click("#tab-send");
  await page.getByRole("button", { name: "right room" }).click();
  await page.locator("#go:enabled").waitFor();
  service.show("scan", { ...scan, fits: false });
  await text(page, ".state", /Wrong position\s+The laser does not fit here\. Set the position/i);
  await page.click("#go");
  await text(page, "#misplaced", /probably elsewhere/);
  assert.equal(service.goal, undefined);
  await page.screenshot({ path: join(kPictures, "misplaced.png") });
  await assert_accessible(page, "misplaced");
  await page.locator("#misplaced").getByRole("button", { name: "Cancel" }).click();
  assert.equal(await page.locator("#misplaced").isVisible(), false);
  await page.click("#go");
  await page.getByRole("button", { name: "Drive all the same" }).click();
  await wait_for("the robot is sent", () => service.goal);
  // A position that fits is driven from without a question.
  service.goal = undefined;
  service.show("scan", { ...scan, fits: true });
  await text_of_fresh(page, service, "pose", kPose, ".state-word", /Position known/i);
  await page.getByRole("button", { name: "right room" }).click();
  await page.locator("#go:enabled").click();
  await wait_for("the robot is sent at once", () => service.goal);
  await end(opened);
});

test("events are filtered by level, and saved as a file", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-understand");
  const event = (time_s, level, source, words) => ({ time_s, level, source, text: words });
  service.table("events", {
    1: event(1000, "info", "web", "goal: room 3"),
    2: event(1001, "warning", "navigator", "blocked: something is in the way"),
    3: event(1002, "error", "localizer", "is gone"),
  });
  const list = page.locator(".events li");
  const filter = (name) => page.getByRole("group", { name: "Which events" }).getByRole("button", { name, exact: true });
  await wait_for("all events", async () => (await list.count()) === 3);
  await filter("Warnings and errors").click();
  await wait_for("two events", async () => (await list.count()) === 2);
  await filter("Errors").click();
  await wait_for("one event", async () => (await list.allInnerTexts()).join().includes("is gone"));
  await filter("All").click();
  const [download] = await Promise.all([page.waitForEvent("download"), filter("Save as a file").click()]);
  const lines = readFileSync(await download.path(), "utf8").split("\n");
  assert.equal(lines[0], "1970-01-01T00:16:40.000Z\tinfo\tweb\tgoal: room 3");
  assert.equal(lines.length, 4); // an empty one at the end
  await assert_accessible(page, "events");
  await end(opened);
});

test("an alarm stays in view until an operator acknowledges it, and then names who did", async () => {
  const opened = await open();
  const { page, service } = opened;
  await show_banners(page);
  const alarm = { level: "error", source: "base", text: "emergency_stop", first_s: 1000, time_s: 1000, count: 1 };
  const other = { ...alarm, level: "warning", source: "laser", text: "offline", time_s: 900, count: 3 };
  const pending = { acknowledged_by: "" };
  service.table("alarms", { 1: { ...other, ...pending }, 2: { ...alarm, ...pending } });
  await text(page, ".banner.alarm", /Drive unit: emergency.stop\./i);
  for (const [name, size] of Object.entries(kSizes)) {
    await page.setViewportSize(size);
    await page.screenshot({ path: join(kPictures, `alarm-${name}.png`) });
  }
  await page.setViewportSize(kSizes.desk);
  await page.getByRole("button", { name: "Show all 2 alarms" }).click();
  const list = page.locator(".alarms > li");
  await wait_for("both in the list", async () => (await list.count()) === 2);
  assert.match((await list.allInnerTexts())[1], /Laser: offline\.[^]*3 times, last at/i);
  await assert_accessible(page, "alarms");
  await page.locator(".banner.alarm").getByRole("button", { name: "Acknowledge", exact: true }).click();
  await wait_for("the order", () => service.acknowledged.length === 1);
  assert.deepEqual(service.acknowledged, [2]);
  await notice(page, /The alarm is acknowledged/);
  const done = { acknowledged_by: "Anna", acknowledged_s: 1010 };
  service.table("alarms", { 1: { ...other, ...pending }, 2: { ...alarm, ...done } });
  await text(page, ".banner.alarm", /Laser: offline/);
  assert.equal(await page.getByRole("button", { name: /^Show .*alarm/ }).count(), 0);
  await text(page, ".alarms > li", /Drive unit: emergency.stop\.[^]*Acknowledged by Anna at/i);
  assert.match((await list.allInnerTexts())[0], /Laser/, "the one that waits is on top");
  await page.locator(".alarms").getByRole("button", { name: /^Acknowledge: Laser/ }).click();
  await wait_for("the other order", () => service.acknowledged.length === 2);
  service.table("alarms", { 1: { ...other, ...done }, 2: { ...alarm, ...done } });
  await wait_for("the banner goes", async () => !(await page.locator(".banner.alarm").isVisible()));
  await page.locator(".alarms").scrollIntoViewIfNeeded();
  await page.screenshot({ path: join(kPictures, "alarms-acknowledged.png") });
  await end(opened);
});

test("a goal gets the heading that is typed", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  await page.getByRole("button", { name: "right room", exact: true }).click();
  await text(page, ".card [role=status]", /m, about/);
  await page.fill("#goal-heading", "90");
  await page.click("#go");
  await wait_for("the goal", () => service.goal);
  assert.ok(Math.abs(service.goal.heading_rad - Math.PI / 2) < 1e-9, JSON.stringify(service.goal));
  await page.getByRole("button", { name: "right room", exact: true }).click();
  await text(page, ".card [role=status]", /m, about/);
  assert.equal(await page.inputValue("#goal-heading"), "");
  service.goal = undefined;
  await page.click("#go");
  await wait_for("the goal", () => service.goal);
  assert.equal("heading_rad" in service.goal, false);
  await end(opened);
});

test("a distance is measured by two taps or a drag, the pointer's coordinates show, and the map turns", async () => {
  const opened = await open();
  const { page } = opened;
  const map = await page.locator("#map").boundingBox();
  const [x, y] = [map.x + map.width / 2, map.y + map.height / 2];
  const shown = async () => (await page.innerText(".under-pointer")).match(/-?[\d.]+/g).map(Number);
  await page.mouse.move(x, y);
  const from = await shown();
  await page.mouse.move(x + 100, y);
  const to = await shown();
  assert.ok(to[0] > from[0] && to[1] === from[1], `${from} ${to}`);
  const meters = to[0] - from[0];
  const is_distance = async () => {
    const found = /^([\d.]+) m$/.exec(await page.innerText(".map-note"));
    return found !== null && Math.abs(Number(found[1]) - meters) < 0.03 * meters;
  };
  const measure = page.getByRole("button", { name: "Measure a distance" });
  await measure.click();
  await text(page, ".map-note", /^Drag, or tap two points/);
  await page.mouse.click(x, y);
  await page.mouse.click(x + 100, y);
  await wait_for("the distance of two taps", is_distance);
  await page.mouse.move(x, y + 50);
  await page.mouse.down();
  await page.mouse.move(x + 100, y + 50, { steps: 4 });
  await page.mouse.up();
  await wait_for("the distance of a drag", is_distance);
  await assert_accessible(page, "a measured distance");
  await measure.click();
  assert.equal(await page.locator(".map-note").isVisible(), false);

  // Turned by a quarter, the same way on the screen leads down the map's y axis; the fourth quarter is the first.
  const turn = page.getByRole("button", { name: "Turn the map by 90°" });
  const way = async () => {
    await page.mouse.move(x, y);
    const [x0, y0] = await shown();
    await page.mouse.move(x + 100, y);
    const [x1, y1] = await shown();
    return [x1 - x0, y1 - y0];
  };
  for (const [right, up] of [[0, -meters], [-meters, 0], [0, meters], [meters, 0]]) {
    await turn.click();
    const [dx, dy] = await way();
    assert.ok(Math.hypot(dx - right, dy - up) < 0.03 * meters, `${dx} ${dy}`);
  }
  await turn.click();
  await page.reload();
  await wait_for("the map is turned as before", async () => {
    const [dx, dy] = await way().catch(() => [0, 0]);
    return Math.hypot(dx, dy + meters) < 0.03 * meters;
  });
  for (let i = 0; i < 3; ++i) await turn.click();
  await page.mouse.click(x, y);
  await text(page, ".card h3", /Point/); // a tap chooses a goal again
  await end(opened);
});

test("the page speaks the browser's language, or the one that is chosen", async () => {
  const context = await new_context(browser, { viewport: kSizes.desk, locale: "es-ES" });
  const service = new SlowLocalizer();
  await service.serve(context);
  const page = await open_page(context, `${kAddress}/#token=${"t".repeat(16)}`);
  await text(page, "#tab-send", /^Enviar$/);
  assert.equal(await page.getAttribute("html", "lang"), "es");
  await Promise.all([page.waitForNavigation(), page.selectOption("#language", "en")]);
  await text(page, "#tab-send", /^Send$/);
  assert.equal(await page.getAttribute("html", "lang"), "en");
  await end({ page, context });
});

test("a refused goal is named with what is in its way, and another one is offered only if it is reached", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  service.refusal = { found: false, goal: 0, message: "'no-go 1' and 'one-way 1' are in the way" };
  await page.getByRole("button", { name: "right room", exact: true }).click();
  await text(page, ".card [role=status]", /^No route to right room: 'no-go 1' and 'one-way 1' are in the way\.$/);
  const nearest = page.getByRole("button", { name: "Go to the nearest point that can be reached" });
  assert.equal(await nearest.count(), 0);
  assert.equal(await page.locator("#go").isDisabled(), true);
  const message = "the goal (2.00, 0.00) is in the no-go zone 'stairs'";
  service.refusal = { found: false, goal: 0, message, nearest_reachable: { x_m: 1, y_m: 1 } };
  await page.getByRole("button", { name: "right room", exact: true }).click();
  await text(page, ".card [role=status]", /^No route to right room: it is in the no-go zone 'stairs'\.$/);
  service.refusal = null;
  await nearest.click();
  await text(page, ".card h3", /Point 1\.00, 1\.00 m/);
  await wait_for("Go", () => page.locator("#go").isEnabled());
  await end(opened);
});

const kBase = { reason: "", battery_v: 12, battery_low: false, commands_taken: true, stands: true };

/** Shows the banners, which the stub hides so that the map keeps its size. */
const show_banners = (page) => page.addStyleTag({ content: ".banners { display: block !important }" });

test("a stop is not done before the base itself reports that it stands", async () => {
  const opened = await open();
  const { page, service } = opened;
  await show_banners(page);
  service.show("base", { ...kBase, state: "halted" });
  await text(page, ".banner", /Held\. Release it to drive/);
  service.show("base", { ...kBase, state: "moving", stands: false });
  await page.click("#stop");
  await text(page, "#stop-sent", /^Stop sent, not confirmed/);
  await wait_for("both orders", () => service.orders.includes("stop") && service.ops.includes("stop"));
  service.show("base", { ...kBase, state: "moving", stands: false });
  service.show("pose", kPose);
  await after_in_page(page, 100); // two frames, time for a wrong change
  assert.equal(await page.locator("#stop-sent").isVisible(), true);
  assert.equal(await page.getByText("The robot is held.").count(), 0);
  await assert_accessible(page, "a stop that is not confirmed");
  service.show("base", { ...kBase, state: "halted", stands: false });
  await text(page, "#stop-sent", /^Stopping: the robot still moves/);
  assert.equal(await page.getByText("The robot is held.").count(), 0);
  service.show("base", { ...kBase, state: "halted" });
  await notice(page, /The robot is held\./);
  await wait_for("the banner goes", async () => !(await page.locator("#stop-sent").isVisible()));
  await end(opened);
});

test("a base that was heard last before the stop confirms nothing", async () => {
  const opened = await open();
  const { page, service } = opened;
  await show_banners(page);
  service.show("base", { ...kBase, state: "halted" });
  await text(page, ".banner", /Held\. Release it to drive/);
  service.ages_s = { base: 30 };
  await page.click("#stop");
  await text(page, "#stop-sent", /not confirmed/);
  service.show("time", { time_s: 0, ages_s: { base: 30 } });
  await after_in_page(page, 100); // as above
  assert.equal(await page.locator("#stop-sent").isVisible(), true);
  service.ages_s = { base: 0 };
  await wait_for("the banner goes", async () => !(await page.locator("#stop-sent").isVisible()));
  await end(opened);
});

test("Space stops whatever has the focus, but in a text", async () => {
  const opened = await open();
  const { page, service } = opened;
  await wait_for("the rights", () => page.locator("#stop").isVisible());
  const rooms = Array.from({ length: 9 }, (_, i) => [i, { name: `room ${i}`, area_m2: 9, x_m: i, y_m: 0, color: 0 }]);
  service.table("rooms", Object.fromEntries(rooms));
  let stops = 0;
  const stops_by_space = async (what) => {
    await page.keyboard.press(" ");
    await wait_for(`a stop by Space on ${what}`, () => service.orders.filter((order) => order === "stop").length === stops + 1);
    ++stops;
  };
  await page.click("#tab-send");
  await stops_by_space("a tab");
  await page.getByRole("button", { name: "room 3", exact: true }).click();
  await text(page, ".card [role=status]", /m, about/);
  await page.locator("#go").focus();
  await stops_by_space("Go");
  assert.equal(service.goal, undefined, "Go was pressed");
  await page.getByText("Drive by hand", { exact: true }).click();
  await stops_by_space("a fold");
  const toggle = page.getByRole("button", { name: "Take the controls" });
  await toggle.click();
  await hold_key(page, "w", "orders to drive", () => service.ops.includes("drive"));
  await stops_by_space("the controls, while a key is held");
  assert.equal(await page.getByRole("button", { name: "Let go of the controls" }).isVisible(), true);
  await wait_for("the robot is let go", () => service.ops.at(-1) !== "drive" && service.ops.includes("release"));
  await page.keyboard.up("w");
  await page.locator("#drive-speed").focus();
  await stops_by_space("a slider");
  const layers = page.getByRole("button", { name: "Layers of the map" });
  await layers.click();
  const box = page.locator(".layer-menu input").first();
  const checked = await box.isChecked();
  await box.focus();
  await stops_by_space("a box");
  assert.equal(await box.isChecked(), checked);
  await page.keyboard.press("Enter");
  assert.equal(await box.isChecked(), !checked);
  await page.locator("input[type=search]").fill("room");
  await page.keyboard.press(" ");
  await page.keyboard.type("4");
  assert.equal(await page.inputValue("input[type=search]"), "room 4");
  assert.equal(service.orders.filter((order) => order === "stop").length, stops);
  await end(opened);
});

test("orders to drive have a time, and a page that stood still lets go", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  await page.getByText("Drive by hand", { exact: true }).click();
  await page.getByRole("button", { name: "Take the controls" }).click();
  const drives = () => service.messages.filter(({ op }) => op === "drive");
  await hold_key(page, "w", "orders to drive", () => drives().length > 2);
  const times = drives().map(({ page_ms }) => page_ms);
  assert.deepEqual(times, [...times].sort((a, b) => a - b));
  assert.ok(times.every((time) => time > 0));
  await page.evaluate(() => {
    const now = performance.now.bind(performance);
    performance.now = () => now() + 6000;
  });
  await wait_for("the robot is let go", () => service.ops.at(-1) === "release");
  await after_in_page(page, 300); // time for three wrong orders
  assert.equal(service.ops.at(-1), "release");
  await page.keyboard.up("w");
  await end(opened);
});

test("a page that is opened on old inputs shows how old they are", async () => {
  const service = new SlowLocalizer();
  service.ages_s = { pose: 125, base: 125, laser: 125, navigator: 125 };
  await service.serve_with(browser, async (page) => {
    service.show("pose", kPose);
    service.show("base", { ...kBase, state: "moving", stands: false });
    service.show("laser", { state: "running", reason: "", scans_per_s: 10 });
    service.show("navigator", { state: "driving", reason: "none", message: "drives", linear_mps: 0.4 });
    await text(page, ".facts dd", /^0\.40 m\/s \(2 min \d+ s old\)$/);
    await text(page, ".facts dd", /^running, 10\.0 \/s \(2 min \d+ s old\)$/);
    await text(page, ".facts dd", /^moving \(2 min \d+ s old\)$/);
    assert.match(await page.innerText(".state-word"), /No position/i);
    service.ages_s = {};
    await text_of_fresh(page, service, "pose", kPose, ".state-word", /Position known/i);
    const laser = { state: "running", reason: "", scans_per_s: 10 };
    await text_of_fresh(page, service, "laser", laser, ".facts dd", /^running, 10\.0 \/s$/);
  });
});

test("without a connection nothing is said of goals", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  service.show("goals", { current: { text: "room A" }, waiting: [], exploring: false });
  service.show("navigator", { state: "driving", reason: "none", message: "drives" });
  await text(page, ".section h3", /To room A/);
  service.cut();
  await text(page, ".state-word", /Offline/i);
  await text(page, ".section h3", /state is unknown/);
  assert.equal(await page.getByText("The robot has no goal").count(), 0);
  assert.equal(await page.getByText("its navigator is not running").filter({ visible: true }).count(), 0);
  service.reachable = true;
  await text(page, ".section h3", /The robot has no goal/);
  // The goal was sent from elsewhere, or before the service restarted.
  service.show("navigator", { state: "driving", reason: "none", message: "drives" });
  await text(page, ".section h3", /has a goal that was not sent from here/);
  await end(opened);
});

test("the release of a robot with a goal says what will happen, and asks", async () => {
  const opened = await open();
  const { page, service } = opened;
  await show_banners(page);
  service.show("base", { ...kBase, state: "halted" });
  const releases = () => service.orders.filter((order) => order === "release").length;
  const release = page.getByRole("button", { name: "Release", exact: true });
  await release.click();
  await wait_for("a release without a goal", () => releases() === 1);
  service.show("goals", { current: { text: "room A" }, waiting: [], exploring: false });
  await text(page, ".banner", /Held\. When released, the robot drives to room A at once/);
  await release.click();
  await text(page, ".banner", /When released, the robot drives to room A at once/);
  assert.equal(releases(), 1);
  await assert_accessible(page, "a release that asks");
  await page.getByRole("button", { name: "Keep it held" }).click();
  await release.click();
  await page.getByRole("button", { name: "Cancel the goal, then release" }).click();
  await wait_for("the release", () => releases() === 2);
  assert.deepEqual(service.orders.slice(-2), ["cancel", "release"]);
  service.show("goals", { current: { text: "room A" }, waiting: [], exploring: false });
  await release.click();
  await page.getByRole("button", { name: "Release and drive" }).click();
  await wait_for("the release", () => releases() === 3);
  await end(opened);
});

test("after a stop, a robot of ROS is driven neither by goals nor by hand until the release", async () => {
  const opened = await open();
  const { page, service } = opened;
  await show_banners(page);
  const drive = { held: false, linear_mps: 0, angular_radps: 0, free_ahead_m: 0, message: "stopped" };
  await page.click("#stop");
  await text(page, "#stop-sent", /^Stop sent, not confirmed/);
  service.show("drive", { ...drive, stopped: true });
  await text(page, ".banner", /Held, not confirmed by the drive unit/);
  service.show("goals", { current: { text: "room A" }, waiting: [], exploring: false });
  await text(page, ".banner", /Held, not confirmed[^]*the robot drives to room A at once/);
  await page.getByRole("button", { name: "Release", exact: true }).click();
  await text(page, ".banner", /When released, the robot drives to room A at once/);
  assert.equal(service.orders.includes("release"), false);
  await page.getByRole("button", { name: "Cancel the goal, then release" }).click();
  await wait_for("the release", () => service.orders.includes("release"));
  assert.deepEqual(service.orders.slice(-2), ["cancel", "release"]);
  service.show("drive", null);
  await wait_for("the banners go", async () => (await page.locator(".banner:visible").count()) === 0);
  await end(opened);
});

test("without a navigator the robot cannot be sent, which is said once", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  service.show("navigator", null);
  await text(page, ".note", /its navigator is not running/);
  assert.equal(await page.locator(".view").getByText("its navigator is not running").filter({ visible: true }).count(), 1);
  assert.equal(await page.getByRole("button", { name: "Explore" }).isDisabled(), true);
  await end(opened);
});

/** Waits in the page: when nothing must happen, a slow machine can only hide a fault. */
function after_in_page(page, ms) {
  // On a slow machine this timer of the page is late together with the rest of the page.
  return page.evaluate((time_ms) => new Promise((resolve) => setTimeout(resolve, time_ms)), ms);
}

/** A map of so many squares of 3.2 m, in rows of 32. */
function show_squares(service, count) {
  const info = { columns: 2048, rows: 2048, resolution_m: 0.05, x_m: 0, y_m: 0, theta_rad: 0 };
  service.show("map", info);
  service.table("tiles", Object.fromEntries(Array.from({ length: count }, (_, i) => [i, 1])));
}

test("the keyboard alone finds its way, and sees where it is", async () => {
  const opened = await open();
  const { page } = opened;
  const focused = () => page.evaluate(() => document.activeElement.id);
  await page.locator("#tab-now").focus();
  await page.keyboard.press("End");
  assert.equal(await focused(), "tab-time");
  await page.keyboard.press("Home");
  assert.equal(await focused(), "tab-now");
  await page.keyboard.press("ArrowUp");
  assert.equal(await focused(), "tab-time");

  // A map that was clicked also shows its keyboard focus, though Leaflet removes the outline.
  await page.locator("#map").click({ position: { x: 200, y: 300 } });
  await page.locator("#stop").focus();
  await page.keyboard.press("Tab");
  assert.equal(await focused(), "map");
  const ring = () => page.locator("#map").evaluate((map) => getComputedStyle(map).outlineStyle);
  assert.equal(await ring(), "solid");

  // A view's number key opens it and does not move the map; plus zooms and arrows move it.
  const scale = () => page.locator(".scale").innerText();
  const empty = await scale();
  show_squares(opened.service, 256);
  await wait_for("the map that grows is kept in view", async () => (await scale()) !== empty);
  const shown = await scale();
  for (const key of "123456") await page.keyboard.press(key);
  assert.equal(await page.getAttribute("#tab-time", "aria-selected"), "true");
  await after_in_page(page, 500); // a wrong zoom would last a quarter of a second
  assert.equal(await scale(), shown);
  await page.keyboard.press("+");
  await wait_for("the map is zoomed", async () => (await scale()) !== shown);
  const zoomed = await scale();
  await page.keyboard.press("ArrowLeft");
  // The view stays when the map grows, as after a drag.
  show_squares(opened.service, 1024);
  await after_in_page(page, 700); // as above
  assert.equal(await scale(), zoomed);

  // The scrolling list does not cut off the focus ring around a name.
  await page.click("#tab-send");
  const name = await page.locator(".names .button").first().boundingBox();
  const names = await page.locator(".names").boundingBox();
  assert.ok(name.x - names.x >= 5 && name.y - names.y >= 5, JSON.stringify([name, names]));

  const layers = page.getByRole("button", { name: "Layers of the map" });
  await layers.focus();
  await page.keyboard.press("Enter");
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.type), "checkbox");
  await page.keyboard.press("Escape");
  assert.equal(await page.locator(".layer-menu").isVisible(), false);
  assert.equal(await layers.evaluate((button) => button === document.activeElement), true);
  assert.equal(await layers.getAttribute("aria-expanded"), "false");
  await end(opened);
});

for (const [width, height] of [
  [480, 320],
  [320, 480],
  [800, 480],
  [390, 844],
]) {
  test(`the panel fits on a screen of ${width} x ${height}`, async () => {
    const opened = await open({ path: "/panel", viewport: { width, height } });
    const { page, service } = opened;
    const rooms = Array.from({ length: 9 }, (_, i) => [i, { name: `room ${i + 1}`, area_m2: 9, x_m: i, y_m: 0, color: 0 }]);
    service.table("rooms", Object.fromEntries(rooms));
    service.show("goals", { current: { text: "what is not mapped yet (a gap)" }, waiting: [], exploring: true });
    service.show("navigator", { state: "driving", reason: "none", message: "drives" });
    await text(page, ".panel-line", /^The robot explores by itself\. Driving\.$/);
    await text(page, ".panel-names", /room 9/);
    const boxes = [];
    for (const part of await page.locator(".header, .panel-line, .panel-display, .key, .panel-goals").all()) {
      boxes.push(await part.boundingBox());
    }
    boxes.forEach((box, i) => {
      assert.ok(box.x >= 0 && box.y >= 0, `part ${i}`);
      assert.ok(box.x + box.width <= width && box.y + box.height <= height, `part ${i} ends outside`);
      assert.ok(box.height >= 16, `part ${i} is ${box.height} high`);
      for (const other of boxes.slice(0, i)) {
        const apart =
          other.x + other.width <= box.x + 1 ||
          box.x + box.width <= other.x + 1 ||
          other.y + other.height <= box.y + 1 ||
          box.y + box.height <= other.y + 1;
        assert.ok(apart, `part ${i} lies on another`);
      }
    });
    for (const key of await page.locator(".key").all()) {
      assert.ok((await key.boundingBox()).height >= 36, "a key is too small for a finger");
    }
    assert.equal(await page.getByRole("button", { name: "Cancel" }).isEnabled(), true);
    await page.screenshot({ path: join(kPictures, `panel-${width}x${height}.png`) });
    await assert_accessible(page, `panel ${width} x ${height}`);
    await end(opened);
  });
}
