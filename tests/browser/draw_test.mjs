// Drawing with a simulated robot: what is drawn is obeyed. It explores its room first, so that there is floor to go
// round.
import assert from "node:assert/strict";
import { copyFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { kPictures, kSizes, launch, open_page, text } from "./page.mjs";
import { eventually, in_map, Robot } from "./robot.mjs";
import { watch } from "./watcher.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source } = process.env;

const robot = new Robot(join(build, "bin"), source, process.env.TOPOGEO_WORK);
let browser;
let context;
let truth;
let page;

before(async () => {
  await robot.start();
  browser = await launch();
  context = await browser.newContext({ viewport: kSizes.desk, colorScheme: "light" });
  truth = await watch(context, robot.address);
  await eventually("the robot has a pose", async () => (await truth.newest("pose"))?.state === "TRACKING", 120);
  page = await open_page(context, `${robot.address}/#token=${robot.token}`);
});

after(async () => {
  await browser?.close();
  await robot.stop();
});

async function true_place() {
  return in_map(await truth.newest("truth"));
}

test("the robot explores its room by itself", async () => {
  await page.click("#tab-send");
  await page.getByRole("button", { name: "Explore", exact: true }).click();
  await page.getByText("The robot explores by itself.").waitFor();
  const from = await true_place();
  await eventually(
    "it drives",
    async () => {
      const at = await true_place();
      return Math.hypot(at.x_m - from.x_m, at.y_m - from.y_m) > 0.3;
    },
    60,
  );
  // Goes on until all is seen: the far side of the room, behind the table, too.
  await text(page, ".section h3", /has no goal/, 300);
  await page.click("#tab-understand");
  await text(page, ".events .text", /explored: .*nothing is left/);
});
