// The edit mode of the page in a browser, with a stub service: drawing by mouse, finger and keyboard, undo, saving,
// saves of other editors, rooms, a new floor with a picture, files.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import {
  assert_accessible,
  close,
  kPictures,
  kSizes,
  launch,
  new_context,
  notice,
  open_page,
  watch_standstill,
} from "./page.mjs";
import { wait_for } from "./robot.mjs";
import { kAddress, StandIn } from "./stand_in.mjs";

const { TOPOGEO_BUILD: build } = process.env;
const kPixelsPerMetre = 16; // scale of a page without a map, whose middle is (0, 0)

let browser;

before(async () => {
  browser = await launch();
});

after(() => close(browser));

/** The view Draw of a page with a service of its own. */
async function open(options = {}, prepare = () => {}) {
  const service = new StandIn(join(build, "share/topogeo/web"));
  prepare(service);
  const context = await new_context(browser, { viewport: kSizes.desk, colorScheme: "light", bypassCSP: true, ...options });
  await service.serve(context);
  const page = await open_page(context, `${kAddress}/#token=${"t".repeat(16)}`);
  await page.click("#tab-draw");
  await page.locator(".tool[data-tool=select]").waitFor();
  return { page, service, context };
}

test("the page works below the path of a proxy", async () => {
  const service = new StandIn(join(build, "share/topogeo/web"), "/robots/anna/");
  const context = await new_context(browser, { viewport: kSizes.desk, bypassCSP: true });
  await service.serve(context);
  const page = await open_page(context, `${kAddress}/robots/anna/#token=${"t".repeat(16)}`);
  await wait_for("a connection", async () => service.ops.includes("hello"));
  await page.click("#tab-draw");
  await page.locator(".tool[data-tool=select]").waitFor();
  await end({ page, context });
});

async function end({ page, context }) {
  assert.deepEqual(page.faults, []);
  await context.close();
}

/** Position of a point of the map frame on the screen. */
async function on_screen(page, [x, y]) {
  const box = await page.locator("#map").boundingBox();
  return [box.x + box.width / 2 + kPixelsPerMetre * x, box.y + box.height / 2 - kPixelsPerMetre * y];
}

const choose = (page, tool) => page.click(`.tool[data-tool=${tool}]`);

async function drag(page, from, to) {
  await page.mouse.move(...(await on_screen(page, from)));
  await page.mouse.down();
  await page.mouse.move(...(await on_screen(page, to)), { steps: 6 });
  await page.mouse.up();
}

async function click(page, at) {
  await page.mouse.click(...(await on_screen(page, at)));
}

const press = (page, name) => page.getByRole("button", { name, exact: true }).click();

/** Saves, and returns the drawing that the service has then. */
async function saved({ page, service }) {
  const before_save = service.version;
  await press(page, "Save");
  await wait_for("the drawing is saved", () => service.version > before_save);
  return service.drawing;
}

test("a rectangle becomes a no-go zone or a preferred lane, with names of their own", async () => {
  const opened = await open();
  const { page } = opened;
  await choose(page, "no_go");
  await drag(page, [-3, 2], [1, -1]);
  await drag(page, [3, 2], [5, 1]);
  await choose(page, "preferred");
  await drag(page, [-3, -2], [5, -3]);
  const { zones } = await saved(opened);
  assert.deepEqual(
    zones.map(({ name, kind, value }) => [name, kind, value]),
    [
      ["no-go 1", "no_go", 0],
      ["no-go 2", "no_go", 0],
      ["lane 1", "preferred", 0],
    ],
  );
  assert.deepEqual(zones[0].corners_m, [-3, 2, 1, 2, 1, -1, -3, -1]);
  await end(opened);
});

test("a wall of corners, closed at the first, snaps to grid and right angles", async () => {
  const opened = await open();
  const { page } = opened;
  await choose(page, "wall");
  // Each click is a few pixels off.
  for (const at of [[-6.04, -4.03], [5.97, -3.8], [6.15, 4.04], [-6.03, 3.9], [-6.1, -3.9]]) await click(page, at);
  const { walls } = await saved(opened);
  assert.deepEqual(walls, [{ points_m: [-6, -4, 6, -4, 6, 4, -6, 4, -6, -4] }]);
  await end(opened);
});

test("undo and redo go through every step, and undone to the start nothing is unsaved", async () => {
  const opened = await open();
  const { page } = opened;
  await choose(page, "place");
  await click(page, [1, 1]);
  await choose(page, "door");
  await drag(page, [-1, 0], [-2, 0]);
  const list = () => page.locator(".draw-items li").count();
  await wait_for("both are drawn", async () => (await list()) === 2);
  await page.keyboard.press("Control+z");
  await press(page, "Undo");
  await wait_for("all is undone", async () => (await list()) === 0);
  assert.equal(await page.getByRole("button", { name: "Save", exact: true }).isDisabled(), true);
  await page.keyboard.press("Control+Shift+z");
  await press(page, "Redo");
  await wait_for("all is back", async () => (await list()) === 2);
  await press(page, "Discard");
  await wait_for("all is discarded", async () => (await list()) === 0);
  await press(page, "Undo");
  await wait_for("discarding is undone", async () => (await list()) === 2);
  await end(opened);
});

test("items are moved by their corners, named, and deleted", async () => {
  const opened = await open({}, (service) => {
    service.drawing.zones = [{ name: "kitchen floor", kind: "slow", value: 0.2, corners_m: [-4, -2, 0, -2, 0, 2, -4, 2] }];
    service.drawing.walls = [{ points_m: [2, 2, 6, 2] }];
  });
  const { page } = opened;
  await click(page, [4, 2]);
  await wait_for("the wall is chosen", () => page.getByText("4.00 m long").first().isVisible());
  await drag(page, [6, 2], [6, 5]);
  await press(page, "Select");
  await click(page, [-2, 1]);
  await page.fill("#draw-name", "workshop");
  await page.fill("#draw-speed", "0.35");
  await page.locator("#draw-speed").blur();
  let drawing = await saved(opened);
  assert.deepEqual(drawing.walls, [{ points_m: [2, 2, 6, 5] }]);
  assert.equal(drawing.zones[0].name, "workshop");
  assert.equal(drawing.zones[0].value, 0.35);
  await page.click("#draw-delete");
  drawing = await saved(opened);
  assert.deepEqual(drawing.zones, []);
  await end(opened);
});

test("a base station gets its arrow by a drag", async () => {
  const opened = await open();
  await choose(opened.page, "base");
  await drag(opened.page, [1, 1], [1.1, 4]);
  const { places } = await saved(opened);
  assert.deepEqual(places, [{ name: "home", x_m: 1, y_m: 1, heading_rad: 1.571 }]);
  await end(opened);
});

test("the keyboard alone draws a wall", async () => {
  const opened = await open();
  const { page } = opened;
  await page.focus(".tool[data-tool=wall]");
  await page.keyboard.press("Enter");
  await page.focus("#map");
  for (const key of ["ArrowRight", "Enter", ...Array(10).fill("ArrowRight"), "Enter", "Enter"]) {
    await page.keyboard.press(key);
  }
  const { walls } = await saved(opened);
  assert.equal(walls.length, 1);
  const [ax, ay, bx, by] = walls[0].points_m;
  assert.ok(Math.abs(bx - ax - 1) < 1e-6 && ay === by, JSON.stringify(walls));
  await end(opened);
});

test("when somebody else has saved, theirs is taken or mine saved over it", async () => {
  const opened = await open();
  const { page, service } = opened;
  await choose(page, "place");
  await click(page, [1, 1]);
  service.save_elsewhere({ places: [{ name: "theirs", x_m: 0, y_m: 0 }] });
  await page.getByText("Somebody else has saved").waitFor();
  await press(page, "Use their version");
  await page.locator(".draw-items li").getByText("theirs").waitFor({ state: "attached" });
  await press(page, "Undo");
  service.save_elsewhere({ places: [{ name: "again", x_m: 0, y_m: 0 }] });
  await page.getByText("Somebody else has saved").waitFor();
  await press(page, "Replace it with mine");
  await wait_for("mine is saved", () => service.drawing.places[0].name === "place 1");
  // Without edits here, a save from elsewhere is loaded by itself.
  service.save_elsewhere({ places: [{ name: "later", x_m: 0, y_m: 0 }] });
  await page.locator(".draw-items li").getByText("later").waitFor({ state: "attached" });
  await end(opened);
});

test("a save that crosses another one is refused, and offers both", async () => {
  const opened = await open();
  const { page, service } = opened;
  await choose(page, "place");
  await click(page, [1, 1]);
  ++service.version; // without a message to the page
  service.drawing.places = [{ name: "theirs", x_m: 0, y_m: 0 }];
  await press(page, "Save");
  await page.getByText("Somebody else has saved").waitFor();
  assert.equal(service.drawing.places[0].name, "theirs");
  await end(opened);
});

test("leaving with something unsaved is asked about", async () => {
  const opened = await open();
  const { page } = opened;
  await choose(page, "place");
  await click(page, [1, 1]);
  await page.click("#tab-now");
  await notice(page, /The view Draw has a drawing that is not saved/);
  const asked = page.waitForEvent("dialog");
  // The reload never ends, because the page stays.
  const reloaded = page.reload({ timeout: 2000 }).catch(() => null);
  const dialog = await asked;
  assert.equal(dialog.type(), "beforeunload");
  await dialog.dismiss();
  await reloaded;
  await page.click("#tab-draw");
  await wait_for("it is still there", async () => (await page.locator(".draw-items li").count()) === 1);
  await opened.context.close();
});

test("rooms are split, joined and renamed", async () => {
  const opened = await open();
  const { page, service } = opened;
  const rooms = () => service.drawing.zones.map(({ name, kind, corners_m }) => [name, kind, corners_m[0], corners_m[2]]);
  await choose(page, "split");
  await drag(page, [-3, 2], [-3, -2]); // over the table in the middle
  await notice(page, /The room is split\./);
  await saved(opened);
  assert.deepEqual(rooms(), [
    ["left room", "room", -4, -3],
    ["left room 1", "room", -3, 0],
  ]);
  service.save_elsewhere({});
  await choose(page, "join");
  await click(page, [-2, 0]);
  await click(page, [2, 0]);
  await notice(page, /The rooms are joined\./);
  await saved(opened);
  assert.deepEqual(rooms(), [["left room", "room", -4, 4]]);
  service.save_elsewhere({});
  await choose(page, "rename");
  await click(page, [2, 0]);
  await wait_for("the name is asked for", () => page.evaluate(() => document.activeElement.id === "draw-name"));
  await page.keyboard.type("library");
  await page.keyboard.press("Enter");
  await saved(opened);
  assert.deepEqual(rooms(), [["library", "room", 0, 4]]);
  await choose(page, "split");
  await drag(page, [7, 2], [7, -2]);
  await notice(page, /The line crosses no room\./);
  await end(opened);
});

test("a new floor is drawn, exported, imported and loaded", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.getByText("New floor", { exact: true }).click();
  await press(page, "Draw a new floor");
  await wait_for("the plane is there", () => page.locator("#map.plane").isVisible());
  await page.locator(".tool[data-tool=wall]").click();
  const box = await page.locator("#map").boundingBox();
  const at = (x, y) => [box.x + box.width * x, box.y + box.height * y];
  await page.mouse.click(...at(0.3, 0.3));
  await page.mouse.click(...at(0.7, 0.3));
  await page.mouse.click(...at(0.7, 0.7));
  await press(page, "Finish");
  await press(page, "Load into the simulator");
  await notice(page, /Set the home first/);
  await choose(page, "base");
  await page.mouse.click(...at(0.5, 0.5));
  const download = page.waitForEvent("download");
  await press(page, "Export");
  const file = await (await download).path();
  const content = JSON.parse(readFileSync(file, "utf8"));
  assert.equal(content.walls[0].points_m.length, 6);
  await press(page, "Undo");
  await page.locator("input[type=file][accept*=json]").setInputFiles(file);
  await notice(page, /The file is read/);
  await press(page, "Load into the simulator");
  await press(page, "Yes, load it");
  await wait_for("the floor is sent", () => service.floors.length === 1);
  const [floor] = service.floors;
  assert.equal(floor.target, "simulator");
  assert.deepEqual(floor.walls, content.walls);
  assert.equal(floor.start.x_m, content.places[0].x_m);
  await wait_for("the map is back", async () => !(await page.locator("#map.plane").count()));
  await end(opened);
});

test("a picture is measured by two points of known distance", async () => {
  const opened = await open();
  const { page } = opened;
  await page.getByText("New floor", { exact: true }).click();
  await press(page, "Draw a new floor");
  const picture = await page.evaluate(async () => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [400, 200];
    const context = canvas.getContext("2d");
    context.fillStyle = "#f00";
    context.fillRect(0, 0, 400, 200);
    return canvas.toDataURL("image/png").split(",")[1];
  });
  const files = { name: "plan.png", mimeType: "image/png", buffer: Buffer.from(picture, "base64") };
  await page.locator("input[type=file][accept*=png]").setInputFiles(files);
  await page.locator("#picture-opacity").waitFor();
  const red = () =>
    page.evaluate(() => {
      const [canvas] = document.querySelectorAll("canvas.map-canvas");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i] > 200 && data[i + 1] < 80 && data[i + 3] > 60) ++count;
      return count;
    });
  const before_measure = await wait_for("the picture is shown", red);
  await press(page, "Measure");
  const box = await page.locator("#map").boundingBox();
  await page.mouse.click(box.x + box.width * 0.45, box.y + box.height / 2);
  await page.mouse.click(box.x + box.width * 0.55, box.y + box.height / 2);
  const now = Number(await page.inputValue("#known-distance"));
  await page.fill("#known-distance", String(now / 2));
  await press(page, "Apply");
  // Half the distance: half the size in both directions.
  await wait_for("the picture is smaller", async () => Math.abs((await red()) / before_measure - 0.25) < 0.02);
  await press(page, "Remove picture");
  await wait_for("it is gone", async () => (await red()) === 0);
  await end(opened);
});

test("a finger draws a zone, two fingers zoom", async () => {
  const opened = await open({ viewport: kSizes.phone, hasTouch: true, isMobile: true });
  const { page, context } = opened;
  const touch = await context.newCDPSession(page);
  const send = (type, points) =>
    touch.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  await page.locator(".tool[data-tool=no_go]").tap();
  const [from, to] = [await on_screen(page, [-4, 3]), await on_screen(page, [4, -3])];
  await send("touchStart", [from]);
  for (let i = 1; i <= 5; ++i) await send("touchMove", [from.map((v, k) => v + ((to[k] - v) * i) / 5)]);
  await send("touchEnd", []);
  // A pinch is no stroke: it draws nothing and enlarges the map.
  const [x, y] = await on_screen(page, [0, 0]);
  const scale = () => page.locator(".scale").innerText();
  const before_pinch = await scale();
  await send("touchStart", [[x - 30, y]]);
  await send("touchStart", [[x - 30, y], [x + 30, y]]);
  for (let i = 1; i <= 6; ++i) await send("touchMove", [[x - 30 - 15 * i, y], [x + 30 + 15 * i, y]]);
  await send("touchEnd", []);
  await wait_for("the map is larger", async () => (await scale()) !== before_pinch);
  const { zones } = await saved(opened);
  assert.equal(zones.length, 1);
  const [left, top, right, , , bottom] = zones[0].corners_m;
  assert.deepEqual([right - left, top - bottom], [8, 6]);
  await end(opened);
});

test("a tap sends the robot, a finger that is held drives it", async () => {
  const opened = await open({ viewport: kSizes.phone, hasTouch: true, isMobile: true });
  const { page, service, context } = opened;
  await page.locator("#tab-send").tap();
  await page.touchscreen.tap(...(await on_screen(page, [3, 1])));
  await page.locator("#go").tap();
  await wait_for("the robot is sent", () => service.goal);
  assert.ok(Math.abs(service.goal.x_m - 3) < 0.2, JSON.stringify(service.goal));
  await page.getByText("Drive by hand", { exact: true }).tap();
  await page.getByRole("button", { name: "Take the controls" }).tap();
  const forward = page.getByRole("button", { name: "Forward" });
  await forward.scrollIntoViewIfNeeded();
  const box = await forward.boundingBox();
  const touch = await context.newCDPSession(page);
  const point = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  const drives = () => service.ops.filter((op) => op === "drive").length;
  const send = (type, ...touchPoints) => touch.send("Input.dispatchTouchEvent", { type, touchPoints });
  const stood_still = await watch_standstill(page);
  // A page that froze releases the controls by itself, or ignores the finger. Then the finger presses again.
  for (let slipped = false; !slipped; ) {
    await send("touchStart", point);
    const at_start = { drives: drives(), ops: service.ops.length };
    await wait_for("it drives for as long as the finger is there", async () =>
      drives() > at_start.drives + 5 || stood_still());
    // A finger that slips still holds.
    await send("touchMove", { ...point, y: point.y + 15 });
    const before_slip = drives();
    await wait_for("it goes on", async () => drives() > before_slip + 2 || stood_still());
    slipped = !(await stood_still("forget"));
    if (slipped) assert.equal(service.ops.slice(at_start.ops).includes("release"), false);
    else await send("touchEnd");
  }
  await send("touchEnd");
  await wait_for("it stops", () => service.ops[service.ops.length - 1] === "release");

  const stick = page.locator(".drive-stick");
  await stick.scrollIntoViewIfNeeded();
  const round = await stick.boundingBox();
  const middle = { x: round.x + round.width / 2, y: round.y + round.height / 2 };
  // Ahead and to the left, as far as it goes; a page that froze needs another press.
  const drives_so = () => {
    const { linear_mps, angular_radps } = service.messages.findLast(({ op }) => op === "drive");
    return Math.hypot(linear_mps - 0.3 * Math.SQRT1_2, angular_radps - 0.6 * Math.SQRT1_2) < 0.01;
  };
  await stood_still("forget");
  for (let drives = false; !drives; ) {
    await send("touchStart", middle);
    await send("touchMove", { x: middle.x - 200, y: middle.y - 200 });
    await wait_for("the thumb drives", async () => drives_so() || stood_still());
    drives = !(await stood_still("forget"));
    if (!drives) await send("touchEnd");
  }
  await page.screenshot({ path: join(kPictures, "stick-phone.png") });
  await send("touchEnd");
  await wait_for("it stops without the thumb", () => service.ops.at(-1) === "release");
  await end(opened);
});

test("the route that is shown is planned again when somebody has drawn", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  await page.getByRole("button", { name: "right room" }).click();
  await page.locator("#go:enabled").waitFor();
  const before = service.previews;
  service.save_elsewhere({});
  await wait_for("it is planned again", () => service.previews > before);
  await end(opened);
});

test("the first name that is found is chosen by the keyboard", async () => {
  const opened = await open();
  const { page, service } = opened;
  const names = ["alpha", "beta", "gamma", "delta", "epsilon", "zeta"];
  const places = Object.fromEntries(names.map((name, i) => [name, { x_m: i, y_m: 0 }]));
  await page.click("#tab-send");
  service.tell({ channel: "places", from: 0, version: 2, set: places, gone: [] });
  await page.getByRole("searchbox").fill("delt");
  await page.keyboard.press("Enter");
  await page.locator("#go:enabled").click();
  await wait_for("the robot is sent", () => service.goal?.place === "delta");
  await end(opened);
});

test("exploring is started, shown and ended", async () => {
  const opened = await open();
  const { page, service } = opened;
  await page.click("#tab-send");
  await press(page, "Explore");
  await page.getByText("The robot explores by itself.").waitFor();
  await press(page, "Cancel");
  await wait_for("it ends", () => !service.exploring);
  await page.getByText("The robot has no goal.").waitFor();
  await end(opened);
});

for (const scheme of ["light", "dark"]) {
  test(`the edit mode is accessible, ${scheme}`, async () => {
    const opened = await open({ colorScheme: scheme }, (service) => {
      service.drawing.zones = [{ name: "hall", kind: "one_way", value: 1, corners_m: [-4, -2, 0, -2, 0, 2, -4, 2] }];
      service.drawing.walls = [{ points_m: [2, 2, 6, 2] }];
    });
    const { page } = opened;
    await click(page, [-2, 1]);
    for (const title of ["Grid and snapping", "Corners", /^All items/, "New floor"]) {
      await page.getByText(title, { exact: typeof title === "string" }).first().click();
    }
    for (const plane of [false, true]) {
      if (plane) await press(page, "Draw a new floor");
      await assert_accessible(page, plane ? "floor" : "map");
      await page.screenshot({ path: join(kPictures, `edit-${plane ? "floor" : "map"}-${scheme}.png`) });
    }
    await end(opened);
  });
}
