// The operator's page in a browser, with a simulated robot: the test clicks as a person does, and checks the result by
// the simulator's truth.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { kSizes, new_context, notice, open_page, text, WatchedRobot } from "./page.mjs";
import { hold_key, wait_for, Robot } from "./robot.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source } = process.env;

const robot = new Robot(join(build, "bin"), source, process.env.TOPOGEO_WORK);
const run = new WatchedRobot(robot);

before(() => run.start());

after(() => run.stop());

/** A page of the operator (or of a spectator) that collects its errors. */
async function open(view, { token = robot.token, path = "/", options = undefined } = {}) {
  const own = options ? await new_context(run.browser, options) : run.context;
  const page = await open_page(own, `${robot.address}${path}${token ? `#token=${token}` : ""}`);
  if (view) await page.click(`#tab-${view}`);
  page.close_all = () => (options ? own.close() : page.close());
  return page;
}

async function end(page) {
  assert.deepEqual(page.faults, []);
  await page.close_all();
}

async function stands() {
  const from = await run.true_place();
  await run.pass_poses(2);
  const to = await run.true_place();
  return Math.hypot(to.x_m - from.x_m, to.y_m - from.y_m) < 0.002;
}

test("shows the map", async () => {
  const page = await open("now");
  await text(page, ".state-word", /POSITION KNOWN/i);
  const mark = () => performance.getEntriesByName("map-shown")[0]?.startTime;
  const shown_ms = await wait_for("a picture of the map", () => page.evaluate(mark));
  console.log(`map on the screen ${Math.round(shown_ms)} ms after opening`);
  assert.equal(await page.locator(".empty-map").isVisible(), false);
  await end(page);
});

test("without the token it only watches", async () => {
  const page = await open("send", { token: "", options: { viewport: kSizes.desk } });
  await text(page, ".view-only", /view only/i);
  assert.equal(await page.locator("#stop").isVisible(), false);
  assert.equal(await page.getByRole("button", { name: "room A" }).count(), 0);
  await page.mouse.click(300, 400);
  assert.equal(await page.locator("#go").count(), 0);
  const status = await page.evaluate(async () => {
    const answer = await fetch("/api/goal", { method: "POST", body: '{"place":"room A"}' });
    return answer.status;
  });
  assert.equal(status, 401);
  assert.equal(await robot.post("goal", { place: "room A" }, "wrong"), 401);
  await end(page);
});

test("a click on room A brings the robot there", async () => {
  const page = await open("send");
  await page.getByRole("button", { name: "room A", exact: true }).click();
  await text(page, ".card [role=status]", /\d m, about/);
  await page.click("#go");
  await text(page, ".section h3", /To room A/);
  await text(page, ".section [role=status]", /Arrived/);
  const at = await run.true_place();
  assert.ok(Math.hypot(at.x_m - 3, at.y_m) < 0.3, JSON.stringify(at));
  await end(page);
});

test("a click on the map makes a goal of the point", async () => {
  const page = await open("now");
  const box = await page.locator("#map").boundingBox();
  await page.evaluate(() => performance.getEntriesByName("map-shown").length);
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await text(page, "#tab-send[aria-selected=true]", /Send/);
  await text(page, ".card h3", /Point/);
  await end(page);
});

test("a held key drives, letting go stops", async () => {
  const page = await open("send");
  await page.getByText("Drive by hand", { exact: true }).click();
  await page.getByRole("button", { name: "Take the controls" }).click();
  const from = await run.true_place();
  await hold_key(
    page,
    "s",
    "the robot moves",
    async () => {
      const at = await run.true_place();
      return Math.hypot(at.x_m - from.x_m, at.y_m - from.y_m) > 0.1;
    },
  );
  await page.keyboard.up("s");
  await wait_for("the robot stands", stands);
  await wait_for("nobody drives by hand", async () => (await run.newest("drive")) === null);
  await end(page);
});

test("a page that goes away while it drives stops the robot", async () => {
  const page = await open("send", { options: { viewport: kSizes.desk } });
  await page.getByText("Drive by hand", { exact: true }).click();
  await page.getByRole("button", { name: "Take the controls" }).click();
  const from = (await run.newest("truth")).theta_rad;
  await hold_key(page, "a", "the robot turns", async () => Math.abs((await run.newest("truth")).theta_rad - from) > 0.1);
  await page.close_all();
  await wait_for(
    "the robot stands",
    async () => {
      const before = (await run.newest("truth")).theta_rad;
      await run.pass_poses(2);
      return Math.abs((await run.newest("truth")).theta_rad - before) < 0.002;
    },
  );
});

test("Stop holds the robot until it is released", async () => {
  const page = await open("send");
  await page.getByRole("button", { name: "base", exact: true }).click();
  await page.click("#go");
  await wait_for("the robot drives", async () => !(await stands()));
  await page.click("#stop");
  await notice(page, /The robot is held\./);
  await wait_for("the robot stands", stands);
  await text(page, ".banner", /Held\. Release it to drive/); // its goal is cancelled
  await page.getByRole("button", { name: "Release" }).click();
  await wait_for(
    "the banner goes",
    async () =>
      (await page.getByText("Held. Release it to drive").count()) === 0 ||
      !(await page.getByText("Held. Release it to drive").isVisible()),
  );
  await end(page);
});

test("a restored map stays without what the drive under way has mapped since", async () => {
  // Null while the map store or the localizer restart.
  const stops_stored = async () => {
    const answer = await fetch(`${robot.address}/api/drive`);
    return answer.ok ? (await answer.json()).total : null;
  };
  const go_to = async (place) => {
    // Refused until a map with this place is published.
    const goal = await wait_for(`${place} is known`, async () => (await robot.ask("goal", { place })).goal_id);
    await wait_for(
      `the robot is at ${place}`,
      async () => {
        const { goal_id, state } = (await run.newest("navigator")) ?? {};
        return goal_id === goal && state === "arrived"; // not that of a goal before
      },
    );
  };
  await go_to("base");
  // The snapshot may miss stops that were in transit when the robot arrived.
  const { snapshots } = await robot.ask("snapshot", { name: "before-the-tour" });
  const before = snapshots.find(({ name }) => name === "before-the-tour").stops;
  await go_to("room A");
  await wait_for("stops of the tour", async () => (await stops_stored()) > before + 1);
  assert.equal(await robot.post("restore", { name: "before-the-tour" }), 200);
  await wait_for("the localizer to restart", () => robot.has_logged("localizer", "restarting with the new map"));
  const begun_s = Date.now() / 1000; // earlier poses are those of the previous localizer
  await wait_for(
    "the robot knows where it is",
    async () => {
      const pose = await run.newest("pose");
      if (pose?.state !== "TRACKING" || pose.sent_s < begun_s) return false;
      const at = await run.true_place();
      return Math.hypot(at.x_m - pose.x_m, at.y_m - pose.y_m) < 0.3;
    },
  );
  // The robot continues in the restored map from its position, with one more stop. The tour's stops do not come back.
  const stops = await wait_for("the restored map", stops_stored);
  assert.ok(stops >= before && stops <= before + 1, `${stops} stops, ${before} in the snapshot`);
  await go_to("base");
  await wait_for("the map grows again", async () => (await stops_stored()) > stops);
});

test("the page goes on after the web service was replaced", async () => {
  const page = await open("now");
  await text(page, ".state-word", /POSITION KNOWN/i);
  await robot.end("web", "SIGKILL");
  await text(page, ".banner", /Connection lost/);
  await text(page, ".state-word", /OFFLINE/i);
  await robot.start_web();
  await text(page, ".state-word", /POSITION KNOWN/i);
  await page.reload();
  await text(page, ".state-word", /POSITION KNOWN/i);
  assert.equal(await page.locator("#stop").isVisible(), true);
  await end(page);
});

test("the panel sends by number", async () => {
  const page = await open(null, { path: "/panel", options: { viewport: { width: 800, height: 480 } } });
  await text(page, ".panel-names", /102\s+room A/);
  const keys = await page.locator(".keypad .key").last().boundingBox();
  const orders = await page.locator(".panel-orders").boundingBox();
  assert.ok(keys.y + keys.height <= orders.y && orders.y + orders.height <= 480, "the keys do not fit on the screen");
  for (const digit of "102") await page.getByRole("button", { name: digit, exact: true }).click();
  await text(page, ".panel-name", /room A/);
  await page.getByRole("button", { name: "Go", exact: true }).click();
  await text(page, ".panel-line", /To room A/);
  await page.getByRole("button", { name: "Cancel", exact: true }).click();
  await end(page);
});

// Near the end, because the standing robot then has a pose that is confirmed only at its next stop.
test("the pose is set by dragging, in a map that stays as it is", async () => {
  const page = await open("correct");
  await wait_for("no pose is chosen while the robot maps", () =>
    page.getByRole("button", { name: "Set on the map" }).isDisabled(),
  );
  await page.getByRole("button", { name: "Stop mapping" }).click();
  await text(page, "button", /Start mapping/);
  await page.getByRole("button", { name: "Set on the map" }).click();
  const at = await run.newest("pose");
  // A drag on the map fills the fields; then the true pose is typed, so that the robot stays localized.
  const shown = await page.inputValue("#pose-x");
  const box = await page.locator("#map").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2 - 60, { steps: 4 });
  await page.mouse.up();
  assert.equal(await page.inputValue("#pose-theta"), "90.0");
  assert.notEqual(await page.inputValue("#pose-x"), shown);
  await page.fill("#pose-x", at.x_m.toFixed(3));
  await page.fill("#pose-y", at.y_m.toFixed(3));
  await page.fill("#pose-theta", ((at.theta_rad * 180) / Math.PI).toFixed(3));
  await page.selectOption("#pose-sure", "exact");
  await page.getByRole("button", { name: "Apply" }).click();
  await notice(page, /continues from this pose/i);
  assert.equal(await page.getByRole("button", { name: "Apply" }).isVisible(), false);
  await page.getByRole("button", { name: "Start mapping" }).click();
  await text(page, "button", /Stop mapping/);
  await end(page);
});

// The last of all, because the robot then has a wrong position.
test("a position 20 m off is doubted at once, and driving from it asks first", async () => {
  const page = await open("send");
  assert.equal(await robot.post("mode", { mode: "localization" }), 200);
  await wait_for("the map stays as it is", async () => (await run.newest("pose")).mode === "localization");
  const { x_m, y_m, theta_rad } = await run.newest("pose");
  assert.equal(await robot.post("pose", { x_m: x_m + 20, y_m, theta_rad, sigma_m: 0.1, sigma_rad: 0.05 }), 200);
  const set_ms = Date.now();
  await text(page, ".state", /Wrong position\s+The laser does not fit here/i);
  console.log(`doubted ${Date.now() - set_ms} ms after it was set`);
  await page.getByRole("button", { name: "Return home" }).click();
  await text(page, "#misplaced", /probably elsewhere/);
  await page.locator("#misplaced").getByRole("button", { name: "Cancel" }).click();
  assert.notEqual((await run.newest("navigator")).state, "driving");
  await end(page);
});
