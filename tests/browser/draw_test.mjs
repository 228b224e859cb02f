// Drawing with a simulated robot: the robot obeys the drawing. It explores its room first, so that there is floor for
// detours.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { kPictures, notice, open_page, text, WatchedRobot } from "./page.mjs";
import { wait_for, SimulatedRun } from "./robot.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source } = process.env;

const kBegin = { x_m: 0, y_m: 0 }; // the robot's start
const kAhead = { x_m: 3, y_m: 0 };

const robot = new SimulatedRun(join(build, "bin"), source, process.env.TOPOGEO_WORK);
const run = new WatchedRobot(robot);
let page;

before(async () => {
  await run.start();
  page = await open_page(run.context, `${robot.address}/#token=${robot.token}`);
});

after(() => run.stop());

test("the robot explores its room by itself", async () => {
  await page.click("#tab-send");
  await page.getByRole("button", { name: "Explore", exact: true }).click();
  await page.getByText("The robot explores by itself.").waitFor();
  const from = await run.true_place();
  await wait_for(
    "it drives",
    async () => {
      const at = await run.true_place();
      return Math.hypot(at.x_m - from.x_m, at.y_m - from.y_m) > 0.3;
    },
  );
  // It explores until all is seen, including the far side of the room behind the table.
  await text(page, ".section h3", /Exploration finished/);
  await page.click("#tab-understand");
  await text(page, ".events .text", /explored: .*no reachable target is left/);
});

/** Maps points of the map frame to the screen, in the view Draw, from two positions of the cursor. */
async function screen_of_map() {
  await page.locator(".tool[data-tool=place]").click();
  const box = await page.locator("#map").boundingBox();
  const read = async (x, y) => {
    await page.mouse.move(x, y);
    const before_move = await page.locator(".draw-cursor").innerText().catch(() => "");
    await page.mouse.move(x + 1, y + 1);
    return wait_for("the cursor says where it is", async () => {
      const numbers = (await page.locator(".draw-cursor").innerText()).match(/-?[\d.]+/g);
      return numbers?.length >= 2 && numbers.join() !== before_move && numbers.map(Number);
    });
  };
  const [u0, v0, u1, v1] = [box.x + 60, box.y + 60, box.x + box.width - 120, box.y + box.height - 60];
  const [x0, y0] = await read(u0, v0);
  const [x1, y1] = await read(u1, v1);
  await page.locator(".tool[data-tool=select]").click();
  return ([x, y]) => [
    u0 + 1 + ((x - x0) / (x1 - x0)) * (u1 - u0),
    v0 + 1 + ((y - y0) / (y1 - y0)) * (v1 - v0),
  ];
}

async function drag(from, to) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps: 6 });
  await page.mouse.up();
}

/** Length of the route from the robot's position; null without one. */
async function route_length(goal) {
  const answer = await robot.ask("preview", goal);
  return answer.found ? answer.length_m : null;
}

async function save() {
  await page.getByRole("button", { name: "Save", exact: true }).click();
  await notice(page, /drawing is saved/);
}

async function is_at(what, x_m, y_m) {
  await wait_for(what, async () => {
    const at = await run.true_place();
    return Math.hypot(at.x_m - x_m, at.y_m - y_m) < 0.35;
  });
}

// The table leaves a passage below, where the robot starts, and one above.
test("a no-go zone across the way is gone round, and driven through when it is gone", async () => {
  await wait_for("the goal is taken", async () => (await robot.post("goal", kBegin)) === 202);
  await is_at("the robot is back", 0, 0);
  const direct_m = await wait_for("a route to the point ahead", () => route_length(kAhead));
  assert.ok(direct_m < 3.6, `${direct_m} m`);

  await page.click("#tab-draw");
  await page.locator(".tool[data-tool=no_go]").waitFor();
  const at = await screen_of_map();
  await page.locator(".tool[data-tool=no_go]").click();
  await drag(at([1.4, 0.7]), at([2.2, -1.2]));
  await page.locator(".tool[data-tool=door]").click();
  await drag(at([3.4, -1]), at([4.2, -1]));
  await page.locator(".tool[data-tool=base]").click();
  await drag(at([-0.5, 2.4]), at([1, 2.4]));
  await page.locator(".tool[data-tool=select]").click();
  await page.screenshot({ path: join(kPictures, "draw-docs.png"), scale: "css" });
  await save();
  await wait_for("the route goes round", async () => {
    const length_m = await route_length(kAhead);
    return length_m === null || length_m > direct_m + 1;
  });
  await wait_for("the next goal is taken", async () => (await robot.post("goal", kAhead)) === 202);
  let entered = false;
  const watched = setInterval(async () => {
    const { x_m, y_m } = await run.true_place();
    entered ||= x_m > 1.5 && x_m < 2.1 && y_m < 0.6;
  }, 50); // as often as the place is published; a missed sample cannot fail the test
  try {
    await is_at("the robot arrives", 3, 0);
  } finally {
    clearInterval(watched); // this process would not end beside it
  }
  assert.equal(entered, false, "the robot was in the no-go zone");

  // Chosen in the list, for users who do not see the map.
  await page.getByText(/^All items/).click();
  await page.locator(".draw-items").getByText("no-go 1").click();
  await page.click("#draw-delete");
  await save();
  await wait_for("the route leads through again", async () => ((await route_length(kBegin)) ?? 9) < direct_m + 0.5);
});

test("a floor of two rooms is drawn, loaded into the simulator, and driven in", async () => {
  await page.getByText("New floor", { exact: true }).click();
  await page.getByRole("button", { name: "Draw a new floor" }).click();
  await page.locator("#map.plane").waitFor();
  const at = await screen_of_map();
  await page.locator(".tool[data-tool=wall]").click();
  for (const corner of [[1, 1], [9, 1], [9, 5], [1, 5], [1, 1]]) await page.mouse.click(...at(corner));
  await drag(at([5, 1]), at([5, 2.4]));
  await drag(at([5, 3.6]), at([5, 5]));
  await page.locator(".tool[data-tool=door]").click();
  await drag(at([5, 2.4]), at([5, 3.6]));
  await page.locator(".tool[data-tool=base]").click();
  await drag(at([2.5, 3]), at([4, 3]));
  await page.getByText("All items (5)").waitFor();
  await page.screenshot({ path: join(kPictures, "draw-floor-light.png") });
  await page.getByRole("button", { name: "Load into the simulator" }).click();
  await page.getByRole("button", { name: "Yes, load it" }).click();
  await notice(page, /floor is loaded/);
  // A new map, which begins at the base station, with the x axis ahead.
  await wait_for(
    "the robot stands in the new floor",
    async () => {
      const at_now = await run.newest("truth");
      return Math.hypot(at_now.x_m - 2.5, at_now.y_m - 3) < 0.2;
    },
  );
  await wait_for("it has a pose", async () => (await run.newest("pose"))?.state === "TRACKING");
  await wait_for("it is sent through the door", async () => (await robot.ask("preview", { x_m: 4, y_m: 0 })).found);
  // Until the page is connected with the navigator that has started again, it takes no goal.
  await wait_for("the goal is taken", async () => (await robot.post("goal", { x_m: 4, y_m: 0 })) === 202);
  await wait_for(
    "it is in the other room",
    async () => (await run.newest("truth")).x_m > 6.1,
  );
  assert.equal((await run.newest("truth")).collisions, 0);
  assert.deepEqual(page.faults, []);
});
