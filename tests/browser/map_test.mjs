// The map of the page with a stub service: zones with a rule in every view, pictures to download; and
// missions, which the browser keeps.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { assert_accessible, close, kPictures, kSizes, launch, new_context, open_page } from "./page.mjs";
import { wait_for } from "./robot.mjs";
import { kAddress, StandIn } from "./stand_in.mjs";

const { TOPOGEO_BUILD: build } = process.env;

const kViews = ["now", "send", "correct", "understand", "draw", "time"];
const kBox = (x, y) => [x - 1, y - 1, x + 1, y - 1, x + 1, y + 1, x - 1, y + 1];
const kZones = [
  { name: "wet floor", kind: "no_go", value: 0, corners_m: kBox(-3, 0) },
  { name: "ramp", kind: "slow", value: 0.3, corners_m: kBox(0, 0) },
  { name: "aisle", kind: "one_way", value: 0, corners_m: kBox(3, 0) },
  { name: "main road", kind: "preferred", value: 0, corners_m: kBox(0, 3) },
];

let browser;

before(async () => {
  browser = await launch();
});

after(() => close(browser));

/** A service whose map has a zone of each kind, and which serves pictures. */
class ZonedFloor extends StandIn {
  downloads = [];

  constructor() {
    super(join(build, "share/topogeo/web"));
    this.drawing = { ...this.drawing, zones: kZones };
    const set = Object.fromEntries(kZones.map(({ name, ...rule }) => [name, rule]));
    this.shown.set("rules", { channel: "rules", from: 0, version: 1, set, gone: [] });
  }

  answer(route) {
    const { pathname, search } = new URL(route.request().url());
    if (pathname === "/api/snapshots") return route.fulfill({ json: { snapshots: [] } });
    if (pathname === "/api/export") {
      const formats = ["png", "pb"].map((format) => ({ format, files: [`map.${format}`] }));
      return route.fulfill({ json: { formats } });
    }
    if (!pathname.startsWith("/api/export/")) return super.answer(route);
    this.downloads.push(pathname + search);
    return route.fulfill({ body: "picture" });
  }

  async open(scheme) {
    const context = await new_context(browser, { viewport: kSizes.desk, colorScheme: scheme, bypassCSP: true });
    await this.serve(context);
    return open_page(context, `${kAddress}/#token=${"t".repeat(16)}`);
  }
}

/** Pixels of the map with exactly the colours of the zones, and those of the arrow ahead of a one-way zone's middle. */
function zone_pixels(page) {
  return page.evaluate(() => {
    const style = getComputedStyle(document.documentElement);
    const wanted = Object.fromEntries(
      ["no-go", "slow", "one-way", "preferred"].map((kind) => {
        const hex = style.getPropertyValue(`--map-${kind}`).trim();
        return [kind, [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16))];
      }),
    );
    const found = { "no-go": 0, slow: 0, "one-way": 0, preferred: 0 };
    for (const canvas of document.querySelectorAll("#map canvas")) {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      for (let i = 0; i < data.length; i += 4) {
        if (data[i + 3] < 255) continue;
        for (const [kind, [r, g, b]] of Object.entries(wanted)) {
          if (data[i] === r && data[i + 1] === g && data[i + 2] === b) ++found[kind];
        }
      }
    }
    return found;
  });
}

const kOutline = 100; // pixels; each zone has a border of 64 pixels a side, two pixels wide

for (const scheme of ["light", "dark"]) {
  test(`zones with a rule are seen in every view, whatever layers are chosen, ${scheme}`, async () => {
    const floor = new ZonedFloor();
    const page = await floor.open(scheme);
    const all_seen = async (what) => {
      const found = await wait_for(`zones in ${what}`, async () => {
        const pixels = await zone_pixels(page);
        return Object.values(pixels).every((count) => count > kOutline) && pixels;
      });
      // The arrow adds to the border of a zone of the same size.
      assert.ok(found["one-way"] > found.slow + 30, `${what}: no arrow, ${JSON.stringify(found)}`);
    };
    for (const view of kViews) {
      await page.click(`#tab-${view}`);
      await all_seen(view);
      await page.screenshot({ path: join(kPictures, `zones-${view}-${scheme}.png`) });
    }
    await page.click("#tab-now");
    await page.getByRole("button", { name: "Layers" }).click();
    await page.getByRole("button", { name: "Turn the map" }).click();
    await all_seen("a turned map");
    await page.screenshot({ path: join(kPictures, `zones-turned-${scheme}.png`) });
    for (const box of await page.locator(".layer-menu input").all()) await box.uncheck();
    await all_seen("a map without layers");
    assert.deepEqual(page.faults, []);
    await page.context().close();
  });
}

test("a picture of the map shows odometry and loops on demand", async () => {
  const floor = new ZonedFloor();
  const page = await floor.open("light");
  await page.click("#tab-time");
  const download = async (file, address) => {
    await page.getByRole("button", { name: `Download ${file}` }).click();
    await wait_for(`the download of ${address}`, () => floor.downloads.includes(address));
  };
  await download("map.png", "/api/export/png/map.png");
  await page.getByLabel("odometry", { exact: true }).check();
  await download("map.png", "/api/export/png/map.png?odometry=1");
  await page.getByLabel("loops", { exact: true }).check();
  await download("map.png", "/api/export/png/map.png?odometry=1&loops=1");
  await download("map.pb", "/api/export/pb/map.pb");
  await page.screenshot({ path: join(kPictures, "export-light.png") });
  assert.deepEqual(page.faults, []);
  await page.context().close();
});

test("a mission is saved in the browser, put in another order, and loaded after a restart of the page", async () => {
  const floor = new ZonedFloor();
  const page = await floor.open("light");
  await page.click("#tab-send");
  const choose = (name) => page.getByRole("button", { name, exact: true }).click();
  const route = async (goals) => {
    await page.getByRole("button", { name: `Go to all ${goals.length} in this order` }).waitFor();
    assert.deepEqual(await page.locator(".chosen li > span").allInnerTexts(), goals);
  };
  await choose("left room");
  await page.getByRole("button", { name: "Add to the list" }).click();
  await choose("right room");
  await route(["left room", "right room"]);
  await page.getByRole("button", { name: "Move right room one up" }).click();
  await route(["right room", "left room"]);
  await page.getByRole("button", { name: "Move right room one down" }).click();
  await route(["left room", "right room"]);
  await page.getByRole("button", { name: "Move right room one up" }).click();
  await route(["right room", "left room"]);
  await page.getByLabel("Seconds to stay at right room").fill("30");
  await page.locator(".card p", { hasText: "about 39 s" }).waitFor(); // 9 s of the stub's route
  await page.getByLabel("Drive this list").selectOption("3 times");
  await page.getByText("Missions", { exact: true }).click();
  await page.getByLabel("Name of the mission").fill("evening round");
  await page.getByRole("button", { name: "Save these goals" }).click();
  await page.getByRole("button", { name: "evening round", exact: true }).waitFor();
  await page.screenshot({ path: join(kPictures, "missions-light.png") });
  await assert_accessible(page, "missions");
  await page.setViewportSize(kSizes.phone);
  await page.locator(".chosen").scrollIntoViewIfNeeded();
  await page.screenshot({ path: join(kPictures, "missions-phone.png") });
  await page.setViewportSize(kSizes.desk);

  await page.reload();
  await page.click("#tab-send");
  await page.getByText("Missions", { exact: true }).click();
  await page.getByRole("button", { name: "evening round", exact: true }).click();
  await route(["right room", "left room"]);
  await page.click("#go");
  await wait_for("the mission is sent", () => floor.goal);
  assert.deepEqual(floor.goal, { goals: [{ place: "right room", wait_s: 30 }, { place: "left room" }], repeat: 3 });
  await page.getByRole("button", { name: "Remove the mission evening round" }).click();
  await page.getByText("No mission is saved yet.").waitFor();
  assert.deepEqual(page.faults, []);
  await page.context().close();
});
