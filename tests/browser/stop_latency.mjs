// Time from Stop to "held" as the base itself reports it, at a page's connection. Prints a table; asserts nothing.
//
//   TOPOGEO_BUILD=$PWD/build TOPOGEO_SOURCE=$PWD node tests/browser/stop_latency.mjs [STOPS=20]
//
// A simulated robot is driven by hand, forwards and backwards in turn, and stopped while it moves. `answered`: the
// service has answered the order; `held`: the base reports that it is held; `stands`: and that it stands, which takes
// the time in which it brakes. `silence`: the longest time without any message of the service until `held`, of which a
// moving robot sends dozens a second: a long one is a standstill of the machine. A stop that takes more than 200 ms is
// named with the states that the base has reported meanwhile.
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Robot, wait_for } from "./robot.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source } = process.env;
const stops = Number(process.argv[2] ?? 20);
const WebSocket = createRequire(join(build, "tests/browser/"))("ws");

const work = mkdtempSync(join(tmpdir(), "topogeo-stop-latency-"));
const robot = new Robot(join(build, "bin"), source, work);
let base = null;
let pose = null;
let waiting = []; // for a value of the base
let heard_ms = 0; // time of the last message
let silence_ms = 0; // longest since it was set to 0
let states = []; // of the base since it was emptied

/** The time at which the base first reports something. */
function when(is_so) {
  return new Promise((resolve) => waiting.push({ is_so, resolve }));
}

function on_message(data) {
  const { channel, value } = JSON.parse(data);
  silence_ms = Math.max(silence_ms, performance.now() - heard_ms);
  heard_ms = performance.now();
  if (channel === "pose") pose = value;
  if (channel !== "base") return;
  base = value;
  if (value && value.state !== states.at(-1)) states.push(value.state);
  const now_ms = performance.now();
  const done = waiting.filter(({ is_so }) => base && is_so(base));
  waiting = waiting.filter((entry) => !done.includes(entry));
  for (const { resolve } of done) resolve(now_ms);
}

try {
  await robot.start();
  const socket = new WebSocket(robot.address.replace("http", "ws") + "/ws", ["topogeo"]);
  socket.on("message", on_message);
  await wait_for("the connection", () => socket.readyState === WebSocket.OPEN);
  const send = (message) => socket.send(JSON.stringify(message));
  send({ op: "hello", token: robot.token, page_ms: performance.now() });
  await wait_for("the robot has a pose", () => pose?.state === "TRACKING");
  const times = { answered: [], held: [], stands: [], silence: [] };
  for (let i = 0; i < stops; ++i) {
    const speed = i % 2 === 0 ? 0.3 : -0.3;
    const hold = setInterval(
      () => send({ op: "drive", linear_mps: speed, angular_radps: 0, page_ms: performance.now() }),
      100,
    );
    await wait_for("the base moves", () => base?.state === "moving");
    await new Promise((resolve) => setTimeout(resolve, 800 + 37 * i)); // it drives at its speed, in any phase of timers
    const held = when(({ state }) => state === "halted");
    const stands = when((now) => now.state === "halted" && now.stands);
    const begun_ms = performance.now();
    silence_ms = 0;
    states = [base.state];
    clearInterval(hold);
    await robot.post("stop", {});
    times.answered.push(performance.now() - begun_ms);
    times.held.push((await held) - begun_ms);
    times.silence.push(silence_ms);
    const late_ms = times.held.at(-1);
    if (late_ms > 200) console.log(`stop ${i}: held after ${late_ms.toFixed(0)} ms; base: ${states.join(", ")}`);
    times.stands.push((await stands) - begun_ms);
    await robot.post("release", {});
    await wait_for("the base is released", () => base?.state === "ready");
  }
  socket.close();
  console.log("ms after Stop | median | 95 % | slowest\n|---|---|---|---|");
  for (const [name, values] of Object.entries(times)) {
    values.sort((a, b) => a - b);
    const at = (share) => values[Math.floor(share * (values.length - 1))].toFixed(0);
    console.log(`| ${name} | ${at(0.5)} | ${at(0.95)} | ${at(1)} |`);
  }
} finally {
  await robot.stop();
  rmSync(work, { recursive: true, force: true });
}
