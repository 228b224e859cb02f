// A simulated robot in one room with all its services and the web service, for tests in a browser.
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, openSync, readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { join } from "node:path";

/** A longer wait is a hang, see tests/container/common.sh. No verdict depends on it. */
export const kHangLimit_ms = 1000 * Number(process.env.TOPOGEO_HANG_LIMIT_S ?? 300);

/**
 * Waits until `check` returns something true, and returns it. Prints every ten seconds what it waits for, and fails
 * with that text after a hang.
 */
export async function wait_for(what, check) {
  const begun_ms = performance.now();
  for (let report_ms = 10_000; ; ) {
    const found = await check();
    if (found) return found;
    const passed_ms = performance.now() - begun_ms;
    if (passed_ms > kHangLimit_ms) throw new Error(`gave up after ${Math.round(passed_ms / 1000)} s: ${what}`);
    if (passed_ms > report_ms) {
      report_ms += 10_000;
      console.log(`${Math.round(passed_ms / 1000)} s: still waiting for: ${what}`);
    }
    await new Promise((resolve) => setTimeout(resolve, 100)); // between two checks
  }
}

/**
 * Holds a key until `check` returns something true, like wait_for. It repeats the key, as keyboards do: a page that
 * froze releases the robot and needs the key again.
 */
export function hold_key(page, key, what, check) {
  return wait_for(what, async () => {
    await page.keyboard.down(key);
    return check();
  });
}

/** Whether a promise is fulfilled within the hang limit. */
export function ends(promise) {
  let timer;
  const late = new Promise((resolve) => {
    timer = setTimeout(() => resolve(false), kHangLimit_ms); // expires only in a hang
  });
  return Promise.race([promise.then(() => true), late]).finally(() => clearTimeout(timer));
}

/** Ends a process by a signal; if it hangs, kills it and fails with the stacks of its threads. */
async function end_process(name, { process: running, ended }, signal) {
  running.kill(signal);
  if (await ends(ended)) return;
  const { stdout } = spawnSync("eu-stack", ["-p", String(running.pid)], { encoding: "utf8" });
  running.kill("SIGKILL");
  throw new Error(`${name} does not end by ${signal}\n${stdout ?? "eu-stack is not there to say where it waits"}`);
}

function free_port() {
  return new Promise((resolve, reject) => {
    const server = createServer();
    server.on("error", reject);
    server.listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

// The map's origin is the robot's start, at (1, 1) of the world, with the x axis ahead.
const kStart = { x_m: 1, y_m: 1 };
const kPlaces = `places:
  - {name: room A, at: [3, 0]}
  - {name: base, at: [0, 0]}
`;

/** Requests to its web service. */
class Orders {
  token = "token-of-the-test";

  get address() {
    return `http://127.0.0.1:${this.port}`;
  }

  /** Posts an order and returns the status code. */
  async post(order, body, token = this.token) {
    return (await this.send(order, body, token)).status;
  }

  /** Posts a request and returns the answer. */
  async ask(order, body) {
    return (await this.send(order, body, this.token)).json();
  }

  send(order, body, token) {
    const headers = { "Content-Type": "application/json" };
    if (token) headers.Authorization = `Bearer ${token}`;
    return fetch(`${this.address}/api/${order}`, { method: "POST", headers, body: JSON.stringify(body) });
  }
}

/** All services as separate processes, which can be ended one by one. */
export class Robot extends Orders {
  processes = new Map();
  web_options = []; // further ones

  /** bin: folder of the programs; source: of the project; work: where files go, made if missing. */
  constructor(bin, source, work) {
    super();
    this.bin = bin;
    this.world = join(source, "share/worlds/room.world.yaml");
    this.work = work;
    mkdirSync(work, { recursive: true });
  }

  /** Starts everything; the web service last. */
  async start() {
    const file = (name) => join(this.work, name);
    writeFileSync(file("places.yaml"), kPlaces);
    this.run("simulator", "--world", this.world, "--laser-port", file("laser"), "--base-port", file("base"));
    await wait_for("ports of the simulator", () => existsSync(file("laser")) && existsSync(file("base")));
    const devices = spawn(join(this.bin, "topogeo"), ["config", "--devices"], {
      stdio: ["ignore", openSync(file("devices.yaml"), "w"), "inherit"],
    });
    await new Promise((resolve) => devices.on("exit", resolve));
    this.run(
      "sensor_gateway",
      "--devices",
      file("devices.yaml"),
      "--laser-port",
      file("laser"),
      "--base-port",
      file("base"),
    );
    this.run("local_mapper");
    this.run("localizer");
    this.run("ga_worker", "--name", "helper");
    this.run("map_store", "--out", file("map"), "--places", file("places.yaml"));
    this.run("planner");
    this.run("navigator");
    this.port = await free_port();
    await this.start_web();
  }

  /** Starts a map store with these options, and the web service, without a robot. */
  async start_store(...options) {
    this.run("map_store", ...options);
    this.port ??= await free_port();
    await this.start_web();
  }

  /** Starts the web service at its previous port. */
  async start_web() {
    this.run("web", "--port", String(this.port), "--token", this.token, ...this.web_options);
    await wait_for("the web service answers", () => fetch(`${this.address}/api/info`).catch(() => null));
  }

  run(name, ...options) {
    const log = openSync(join(this.work, `${name}.log`), "a");
    const started = spawn(join(this.bin, name), options, {
      stdio: ["ignore", log, log],
      // Killed programs leave shared memory behind, and others can wait at its locks. A stop that holds
      // must not reach another test.
      env: { ...process.env, TOPOGEO_DDS_PARTICIPANT: "udp_only", RUNTIME_DIRECTORY: this.work },
    });
    const ended = new Promise((resolve) => started.on("exit", resolve));
    this.processes.set(name, { process: started, ended });
  }

  /** CPU time of a service since its start. */
  cpu_s(name) {
    const { pid } = this.processes.get(name).process;
    const fields = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1].split(" ");
    return (Number(fields[11]) + Number(fields[12])) / 100; // user and system, in ticks of 10 ms
  }

  /** Ends a service by a signal. */
  async end(name, signal = "SIGTERM") {
    const running = this.processes.get(name);
    if (!running) return;
    this.processes.delete(name);
    await end_process(name, running, signal);
  }

  async stop() {
    const names = [...this.processes.keys()].reverse();
    const ends = await Promise.allSettled(names.map((name) => this.end(name)));
    const failed = ends.find(({ status }) => status === "rejected");
    if (failed) throw failed.reason;
  }

  /** Whether a service has logged this text since the test began. */
  has_logged(name, text) {
    return this.output(name).includes(text);
  }

  output(name) {
    return readFileSync(join(this.work, `${name}.log`), "utf8");
  }

  /** The last lines of a service. */
  log(name) {
    return this.output(name)
      .split("\n")
      .slice(-15)
      .join("\n");
  }
}

/** The same robot started by `topogeo run`, which accepts floors for its simulator. */
export class SimulatedRun extends Orders {
  /** bin: folder of the programs; source: of the project; work: where files go. */
  constructor(bin, source, work) {
    super();
    this.bin = bin;
    this.world = join(source, "share/worlds/room.world.yaml");
    this.work = work;
  }

  async start() {
    this.port = await free_port();
    const log = openSync(join(this.work, "run.log"), "a");
    const options = ["run", "--sim", this.world, "--web", "--port", String(this.port), "--token", this.token];
    this.process = spawn(join(this.bin, "topogeo"), [...options, "--out", join(this.work, "run")], {
      stdio: ["ignore", log, log],
    });
    this.ended = new Promise((resolve) => this.process.on("exit", resolve));
    await wait_for("the web service answers", () => fetch(`${this.address}/api/info`).catch(() => null));
  }

  async stop() {
    if (this.process) await end_process("topogeo run", this, "SIGTERM");
  }
}

/** True position of the robot, map frame, from the channel `truth`. */
export function in_map(truth) {
  return { x_m: truth.x_m - kStart.x_m, y_m: truth.y_m - kStart.y_m };
}
