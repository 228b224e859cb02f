// A stub service inside the test, for the page's behaviour without a robot: files of the page, the drawing with its
// versions, outlines of rooms. It has no process and no port: it answers the browser's requests here.
import { readFileSync } from "node:fs";
import { extname, join } from "node:path";

const kTypes = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
export const kAddress = "http://stand-in.test";
const kRobot = "stand-in";
const kTable = { x_m: -3, y_m: 0 }; // in the left room
// The map keeps its size, so that tests can compute screen positions.
const kSteady = ".banners { display: none } .header { height: 72px; overflow: hidden }";

const empty = () => ({ places: [], zones: [], walls: [], openings: [], doors: [] });

export class StandIn {
  drawing = empty();
  version = 1;
  floors = [];
  exploring = false;
  previews = 0; // number of requested previews
  refusal = null; // answer to previews
  ops = []; // of messages that pages sent
  messages = []; // the same messages, whole
  controls = []; // orders about the controls
  acknowledged = []; // alarms
  orders = []; // sent by pages by POST and only recorded
  reachable = true; // through the WebSocket
  ages_s = undefined; // time since each value was received
  offers = ["goal", "preview", "drawing", "room_shapes", "floor", "explore", "cancel", "resume", "stop", "release", "alarms"];
  /** Two rooms of 4 x 4 m that meet at x = 0; zone 0 lies left. */
  rooms = {
    0: { name: "left room", area_m2: 16, x_m: -2, y_m: 0, color: 0 },
    1: { name: "right room", area_m2: 16, x_m: 2, y_m: 0, color: 1 },
  };
  sockets = new Set();
  shown = new Map(); // messages for a page that connects again, by channel

  /** page_files: folder of the built page. path: below which a proxy serves it. */
  constructor(page_files, path = "/") {
    this.page_files = page_files;
    this.path = path;
  }

  /** Answers all requests of a browser context's pages. */
  async serve(context) {
    await context.route("**/*", (route) => this.answer(route));
    await context.routeWebSocket(`${kAddress.replace("http", "ws")}${this.path}ws`, (socket) => this.connect(socket));
  }

  /** Saves as another editor. */
  save_elsewhere(drawing) {
    this.drawing = { ...empty(), ...drawing };
    ++this.version;
    this.tell({ channel: "drawing", version: this.version, value: { version: String(this.version) } });
  }

  /** Ends all connections; pages cannot reconnect before `reachable` is set. */
  cut() {
    this.reachable = false;
    this.shown.clear();
    for (const socket of this.sockets) socket.close();
    this.sockets.clear();
  }

  tell(message) {
    for (const socket of this.sockets) socket.send(JSON.stringify(message));
  }

  connect(socket) {
    if (!this.reachable) return void socket.close();
    this.sockets.add(socket);
    socket.onClose(() => this.sockets.delete(socket));
    const send = (message) => socket.send(JSON.stringify(message));
    const table = (channel, set) => send({ channel, from: 0, version: 1, set, gone: [] });
    socket.onMessage((text) => {
      const message = JSON.parse(text);
      const { op } = message;
      this.ops.push(op);
      this.messages.push(message);
      if (op === "ping") send({ op: "pong", time_s: 0 });
      if (op !== "hello") return;
      send({ op: "welcome", protocol: 1, life: "a", may_write: true, robot_id: kRobot, page: message.page ? 1 : 0 });
      const time = () =>
        send({ channel: "time", version: 1, value: { time_s: Date.now() / 1000, ages_s: this.ages_s } });
      time();
      table("rooms", this.rooms);
      table("places", {});
      table("rules", {});
      send({ channel: "drawing", version: 1, value: { version: String(this.version) } });
      send({ channel: "navigator", version: 1, value: { state: "idle", reason: "none", message: "" } });
      for (const repeated of this.shown.values()) send(repeated);
      const beat = setInterval(() => {
        if (!this.sockets.has(socket)) return clearInterval(beat);
        time();
      }, 1000);
    });
  }

  async answer(route) {
    const request = route.request();
    const { pathname: whole, searchParams } = new URL(request.url());
    if (!whole.startsWith(this.path)) return route.fulfill({ status: 404, json: { error: `another site: ${whole}` } });
    const pathname = `/${whole.slice(this.path.length)}`;
    const body = request.method() === "POST" ? JSON.parse(request.postData() || "{}") : null;
    const json = (status, value) => route.fulfill({ status, json: value });
    const goals = () => ({ current: null, waiting: [], exploring: this.exploring });
    switch (pathname) {
      case "/api/info":
        return json(200, {
          protocol: 1,
          robot_id: kRobot,
          version: "0",
          life: "a",
          may_write: true,
          offers: this.offers,
        });
      case "/api/at": {
        const x = Number(searchParams.get("x_m"));
        const y = Number(searchParams.get("y_m"));
        const on_table = Math.hypot(x - kTable.x_m, y - kTable.y_m) < 0.3;
        const inside = Math.abs(x) < 4 && Math.abs(y) < 2 && !on_table;
        return json(200, inside ? { inside, zone: x < 0 ? 0 : 1 } : { inside });
      }
      case "/api/drawing":
        if (!body) return json(200, { version: String(this.version), ...this.drawing });
        if (body.version !== String(this.version)) {
          return json(409, { error: "made on an older version", version: String(this.version) });
        }
        delete body.version;
        this.save_elsewhere(body);
        return json(200, { version: String(this.version) });
      case "/api/room_shapes":
        return json(200, { shapes: room_shapes(body) });
      case "/api/preview":
        ++this.previews;
        if (this.refusal) return json(200, this.refusal);
        return json(200, { found: true, length_m: 3, time_s: 9, min_clearance_m: 1, points_m: [0, 0, 3, 0] });
      case "/api/goal":
        this.goal = body;
        return json(202, { goal_id: "1", waiting: 0 });
      case "/api/floor":
        this.floors.push(body);
        return json(202, {});
      case "/api/stop":
      case "/api/resume":
      case "/api/release":
        this.orders.push(pathname.slice("/api/".length));
        return json(202, {});
      case "/api/alarms":
        this.acknowledged.push(...body.acknowledge);
        return json(202, {});
      case "/api/controls":
        this.controls.push(body.do);
        return json(202, {});
      case "/api/explore":
      case "/api/cancel":
        this.orders.push(pathname.slice("/api/".length));
        this.exploring = pathname === "/api/explore";
        this.tell({ channel: "goals", version: 2, value: goals() });
        return json(202, {});
      default:
        return this.answer_file(route, pathname);
    }
  }

  answer_file(route, pathname) {
    const name = { "/": "/index.html", "/panel": "/panel.html" }[pathname] ?? pathname;
    try {
      const file = readFileSync(join(this.page_files, name));
      const body = name === "/style.css" ? `${file}${kSteady}` : file;
      return route.fulfill({ body, contentType: kTypes[extname(name)] ?? "application/octet-stream" });
    } catch {
      return route.fulfill({ status: 404, json: { error: `there is no ${pathname}` } });
    }
  }
}

// The two rooms, joined, or cut by a vertical line.
function room_shapes({ zones, cut_m }) {
  const left = zones.includes(0) ? -4 : 0;
  const right = zones.includes(1) ? 4 : 0;
  const box = (a, b) => ({ corners_m: [a, -2, b, -2, b, 2, a, 2] });
  return cut_m ? [box(left, cut_m[0]), box(cut_m[0], right)] : [box(left, right)];
}
