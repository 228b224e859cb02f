// The operator's page in a browser, for tests: the pages of a robot and their contents.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { ends, in_map, kHangLimit_ms, wait_for } from "./robot.mjs";
import { watch } from "./watcher.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_CHROMIUM: chromium } = process.env;
const packages = createRequire(join(build, "tests/browser/"));
const playwright = packages("playwright-core");
const axe = packages.resolve("axe-core/axe.min.js");

/** Folder for screenshots. */
export const kPictures = join(build, "tests/browser/screenshots");
mkdirSync(kPictures, { recursive: true });

export const kSizes = {
  desk: { width: 1280, height: 800 },
  tablet: { width: 820, height: 1180 },
  phone: { width: 390, height: 844 },
};

export function launch() {
  return playwright.chromium.launch({
    executablePath: chromium,
    args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"],
    timeout: kHangLimit_ms,
  });
}

/** A context whose pages wait for the target of a click up to the hang limit. */
export async function new_context(browser, options) {
  const context = await browser.newContext(options);
  context.setDefaultTimeout(kHangLimit_ms);
  return context;
}

/** Closes a browser, if there is one; kills it when it hangs while closing, which is not the page's fault. */
export async function close(browser) {
  if (!browser) return;
  const closed = browser.close();
  if (await ends(closed)) return;
  console.log("the browser does not end: killed");
  spawnSync("pkill", ["-KILL", "-P", String(process.pid), "chrom"]);
  await closed;
}

/** A browser beside a simulated robot; both run from start() to stop(). */
export class WatchedRobot {
  constructor(robot) {
    this.robot = robot;
  }

  /** Returns once the robot has a pose. */
  async start() {
    await this.robot.start();
    this.browser = await launch();
    this.context = await new_context(this.browser, { viewport: kSizes.desk, colorScheme: "light" });
    this.channels = await watch(this.context, this.robot.address);
    await wait_for("the robot has a pose", async () => (await this.newest("pose"))?.state === "TRACKING");
  }

  async stop() {
    try {
      await close(this.browser);
    } finally {
      await this.robot.stop(); // this process waits for its end
    }
  }

  newest(channel) {
    return this.channels.newest(channel);
  }

  /** Waits for some more poses, one for each scan. */
  async pass_poses(count) {
    for (let i = 0; i < count; ++i) {
      const last_s = (await this.newest("pose"))?.sent_s;
      await wait_for("another pose", async () => (await this.newest("pose"))?.sent_s !== last_s);
    }
  }

  /** True position of the robot, map frame. */
  async true_place() {
    return in_map(await this.newest("truth"));
  }
}

/** Records in the page the texts of its notices, which vanish after some seconds. */
function record_notices() {
  window.notices = [];
  window.notices_seen = 0;
  const recorded = new WeakMap();
  new MutationObserver(() => {
    for (const words of document.querySelectorAll(".notice > span")) {
      if (recorded.get(words) === words.textContent) continue;
      recorded.set(words, words.textContent);
      window.notices.push(words.textContent);
    }
  }).observe(document, { childList: true, subtree: true, characterData: true });
}

/** A page that collects its errors. */
export async function open_page(context, address) {
  const page = await context.newPage();
  await page.addInitScript(record_notices);
  page.faults = [];
  page.on("pageerror", (error) => page.faults.push(error.stack));
  page.console_errors = []; // with the requests that the service refused
  page.on("console", (line) => {
    if (line.type() === "error") page.console_errors.push(`${line.text()} ${line.location().url}`);
  });
  await page.goto(address);
  return page;
}

/** Waits until a selector has a text. */
export async function text(page, selector, pattern) {
  let found = [];
  try {
    await wait_for(`${selector} with ${pattern}`, async () => {
      found = await page.locator(selector).allInnerTexts();
      return found.some((entry) => pattern.test(entry));
    });
  } catch (error) {
    throw new Error(`${error.message}; there is ${JSON.stringify(found)}`);
  }
}

/**
 * Waits for a notice with a text: one that is shown, or that was since the last such wait, because a busy machine may
 * be slower than a notice vanishes.
 */
export async function notice(page, pattern) {
  const was_shown = ([source, flags]) => {
    const expected = new RegExp(source, flags);
    const at = window.notices.slice(window.notices_seen).findIndex((entry) => expected.test(entry));
    if (at >= 0) window.notices_seen += at + 1;
    const words = [...document.querySelectorAll(".notice > span")];
    return at >= 0 || words.some(({ textContent }) => expected.test(textContent));
  };
  await wait_for(`a notice with ${pattern}`, () => page.evaluate(was_shown, [pattern.source, pattern.flags]));
}

/** The rules of axe-core that check colours. */
export const kColorRules = ["color-contrast", "link-in-text-block"];

/** Fails when axe-core finds something serious on a page, by all its rules or by `rules`. */
export async function assert_accessible(page, what, rules = undefined) {
  if (!(await page.evaluate(() => "axe" in window))) await page.addScriptTag({ path: axe });
  const options = { resultTypes: ["violations"], ...(rules && { runOnly: rules }) };
  const { violations } = await page.evaluate((of_run) => window.axe.run(of_run), options);
  const serious = violations
    .filter((finding) => ["serious", "critical"].includes(finding.impact))
    .map((finding) => `${finding.id}: ${finding.nodes.map((node) => node.target).join(", ")}`);
  assert.deepEqual(serious, [], what);
}

/**
 * Watches whether the page freezes for a quarter of a second, or gets a press so late: after 0.3 s it releases the
 * robot. Returns a function that returns whether it did since the last call with "forget".
 */
export async function watch_standstill(page) {
  await page.evaluate(() => {
    let before = performance.now();
    const note = (since) => (window.stood_still ||= performance.now() - since > 250);
    setInterval(() => {
      note(before);
      before = performance.now();
    }, 50);
    document.addEventListener("pointerdown", (event) => note(event.timeStamp), true);
  });
  return (forget) =>
    page.evaluate((begins_anew) => {
      const stood_still = Boolean(window.stood_still);
      if (begins_anew) window.stood_still = false;
      return stood_still;
    }, forget === "forget");
}
