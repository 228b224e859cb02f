// Two operators at one robot: one has the controls, the other asks for them or takes them over; events and the audit
// log name who ordered. The robot has a local mapper alone: orders need no more, and a page without a robot has no Stop.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { assert_accessible, close, kSizes, launch, new_context, notice, open_page, text } from "./page.mjs";
import { Robot, wait_for } from "./robot.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source, TOPOGEO_WORK: work } = process.env;

const robot = new Robot(join(build, "bin"), source, work);
const audit = join(work, "orders.jsonl");
let browser;

before(async () => {
  robot.web_options = ["--audit-log", audit];
  await robot.start_store("--out", join(work, "map"));
  robot.run("local_mapper");
  browser = await launch();
});

after(async () => {
  await close(browser);
  await robot.stop();
});

/** A page of an operator with this name, in a browser of its own. */
async function open(name) {
  const context = await new_context(browser, { viewport: kSizes.desk, colorScheme: "light", bypassCSP: true });
  await context.addInitScript((own) => localStorage.setItem("topogeo-operator", own), name);
  const page = await open_page(context, `${robot.address}/#token=${robot.token}`);
  await wait_for(`${name} may command`, () => page.locator("#stop").isVisible());
  page.post = (order, body = {}) =>
    page.evaluate(
      async ([path, json, token]) => {
        const headers = { Authorization: `Bearer ${token}`, "X-Topogeo-Page": sessionStorage.getItem("topogeo-page") };
        const answer = await fetch(`/api/${path}`, { method: "POST", headers, body: JSON.stringify(json) });
        return { status: answer.status, ...(await answer.json()) };
      },
      [order, body, robot.token],
    );
  return page;
}

const press = (page, name) => page.getByRole("button", { name, exact: true }).click();

test("one operator has the controls, the other asks for them or takes them over, and both are told", async () => {
  const anna = await open("Anna");
  const ben = await open("Ben");
  assert.equal((await anna.post("pause")).status, 202); // takes the free controls
  await text(ben, "#controls", /^Anna has the controls\. You can watch, and stop the robot\./);
  await assert_accessible(ben, "another operator has the controls");
  const refused = await ben.post("pause");
  assert.equal(refused.status, 409);
  assert.match(refused.error, /Anna has the controls/);
  assert.equal((await ben.post("release")).status, 409);

  await press(ben, "Ask for them");
  await text(anna, "#controls", /^Ben asks for the controls\./);
  await text(ben, "#controls", /^You asked Anna for the controls/);
  await assert_accessible(anna, "another operator asks for the controls");
  await press(anna, "Keep them");
  await notice(ben, /Anna keeps the controls/);
  await press(ben, "Ask for them");
  await press(anna, "Give them");
  await notice(ben, /You have the controls now/);
  await notice(anna, /Ben has the controls now/);
  assert.equal((await ben.post("pause")).status, 202);
  assert.equal((await anna.post("pause")).status, 409);

  await press(anna, "Take over");
  await notice(anna, /You have the controls now/);
  await notice(ben, /Anna has the controls now/);

  // Anybody stops, and a page that is gone holds nothing.
  await ben.click("#stop");
  await text(ben, "#stop-sent", /No base and no navigator is connected/);
  await anna.context().close();
  await wait_for("the controls are free", async () => (await ben.post("pause")).status === 202);

  await ben.click("#tab-understand");
  assert.equal(await ben.getByText("Ben: stops and holds the robot").count(), 1, "one stop by two connections");
  for (const line of [/^Anna: pauses the drive$/, /Anna: takes the controls from Ben$/, /Ben: stops and holds the robot$/]) {
    await text(ben, ".events .text", line);
  }
  const orders = readFileSync(audit, "utf8").trim().split("\n").map((line) => JSON.parse(line));
  const has = (who, order) => orders.some((entry) => entry.who === who && entry.order === order);
  assert.ok(has("Anna", "/api/pause") && has("Ben", "/api/stop") && has("Anna", "/api/controls"), JSON.stringify(orders));
  assert.ok(!has("Ben", "/api/release"), "a refused order is none");
  assert.deepEqual(ben.faults, []);
});
