// Every view of the operator's page with a robot that stands still: accessible to screen readers, keyboards and eyes,
// in all sizes and both schemes. Takes screenshots of all views.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { assert_accessible, kColorRules, kPictures, kSizes, new_context, open_page, text, WatchedRobot } from "./page.mjs";
import { Robot } from "./robot.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source } = process.env;

const kViews = ["now", "send", "correct", "understand", "draw", "time"];

const robot = new Robot(join(build, "bin"), source, process.env.TOPOGEO_WORK);
const run = new WatchedRobot(robot);

before(() => run.start());

after(() => run.stop());

// Both schemes have the same elements, in other colours.
for (const [scheme, rules] of [["light", undefined], ["dark", kColorRules]]) {
  test(`every view is accessible, ${scheme}`, async () => {
    for (const [size, viewport] of Object.entries(kSizes)) {
      const options = { viewport, colorScheme: scheme, bypassCSP: true };
      const context = await new_context(run.browser, options);
      const page = await open_page(context, `${robot.address}/#token=${robot.token}`);
      await text(page, ".state-word", /POSITION KNOWN/i);
      for (const view of kViews) {
        await page.click(`#tab-${view}`);
        if (view === "send") {
          await page.getByRole("button", { name: "room A", exact: true }).click();
          await text(page, ".card [role=status]", /m, about|no /i);
        }
        await page.screenshot({ path: join(kPictures, `${view}-${size}-${scheme}.png`) });
        if (size !== "tablet") await assert_accessible(page, `${view}, ${size}`, rules);
      }
      await page.goto(`${robot.address}/panel`);
      await text(page, ".panel-names", /room A/);
      await page.screenshot({ path: join(kPictures, `panel-${size}-${scheme}.png`) });
      if (size !== "tablet") await assert_accessible(page, `panel, ${size}`, rules);
      assert.deepEqual(page.faults, []);
      await context.close();
    }
  });
}
