// Parts of the page that need no browser: the copy of the tables, the frame of the pictures, numbers of goals, units;
// drawing_test.mjs tests those of the edit mode.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { load } from "./load_module.mjs";

const { Channels } = await load("channels");
const grid = await load("map/grid_frame");
const { destinations, numbered } = await load("destinations");
const format = await load("format");
const { navigator_text, pose_of_now, robot_state } = await load("robot_state");
const { agreement, apart, compose } = await load("map/match_layer");
const { Film } = await load("map/film");
const { Stopping } = await load("stopping");
const { drive_facts, goal_facts, report_page } = await load("report");
const { moved } = await load("views/chosen_list");
const { stick_order } = await load("views/drive_stick");
const { with_stays } = await load("views/rounds");
const { pending_alarms } = await load("alarms");
const { translated } = await load("reasons");
const { spanish_reasons } = await load("spanish_reasons");
const { english, languages, texts } = await load("texts");

const delta = (from, version, set, gone = []) => ({ channel: "events", from, version, set, gone });

test("tables follow deltas, and nothing is taken on a version that is not held", () => {
  const channels = new Channels();
  const seen = [];
  channels.on_table("events", (change) => seen.push(change));
  assert.equal(channels.apply(delta(0, 3, { a: 1, b: 2 })), true);
  assert.equal(channels.apply(delta(3, 4, { b: 5, c: 6 }, ["a"])), true);
  assert.deepEqual(Object.fromEntries(channels.table("events")), { b: 5, c: 6 });
  assert.equal(channels.apply(delta(3, 5, { d: 1 })), false);
  assert.deepEqual(Object.fromEntries(channels.table("events")), { b: 5, c: 6 });
  assert.deepEqual(channels.held(), { events: 4 });
  // A snapshot replaces the whole value.
  assert.equal(channels.apply(delta(0, 1, { z: 9 })), true);
  assert.deepEqual(Object.fromEntries(channels.table("events")), { z: 9 });
  assert.deepEqual(
    seen.map((change) => change.all),
    [true, false, true],
  );
});

test("a random series of deltas ends as the table that made them", () => {
  let seed = 1;
  const random = (end) => (seed = (48271 * seed) % 2147483647) % end;
  const channels = new Channels();
  const truth = new Map();
  channels.apply(delta(0, 1, {}));
  for (let version = 2; version < 500; ++version) {
    const set = {};
    const gone = [];
    for (let i = random(4); i >= 0; --i) {
      const key = `k${random(20)}`;
      if (random(3) > 0) set[key] = version;
      else if (!(key in set) && truth.has(key)) gone.push(key);
    }
    gone.forEach((key) => truth.delete(key));
    const wanted = Object.entries(set).filter(([key]) => !gone.includes(key));
    wanted.forEach(([key, value]) => truth.set(key, value));
    assert.equal(channels.apply(delta(version - 1, version, Object.fromEntries(wanted), gone)), true);
  }
  assert.deepEqual(new Map(channels.table("events")), truth);
});

test("what is of the moment goes with the connection, the map and the tables stay", () => {
  const channels = new Channels();
  channels.apply({ channel: "map", version: 1, value: { columns: 3 } });
  channels.apply({ channel: "pose", version: 1, value: { state: "TRACKING" } });
  channels.apply(delta(0, 1, { a: 1 }));
  channels.forget_moment();
  assert.equal(channels.value("pose"), null);
  assert.deepEqual(channels.value("map"), { columns: 3 });
  assert.equal(channels.table("events").size, 1);
});

test("what a service that is new does not send is gone after a while", () => {
  const channels = new Channels();
  channels.apply({ channel: "map", version: 1, value: { columns: 3 } });
  channels.apply(delta(0, 7, { a: 1 }));
  channels.apply({ channel: "places", from: 0, version: 2, set: { base: {} }, gone: [] });
  channels.begin_anew();
  assert.equal(channels.apply(delta(7, 8, { b: 1 })), false);
  assert.equal(channels.apply(delta(0, 1, { c: 1 })), true);
  assert.equal(channels.table("places").size, 1);
  channels.drop_unconfirmed();
  assert.deepEqual(Object.fromEntries(channels.table("events")), { c: 1 });
  assert.equal(channels.table("places").size, 0);
  assert.equal(channels.value("map"), null);
  assert.deepEqual(channels.held(), { events: 1 });
});

const kGrid = { columns: 1000, rows: 700, resolution_m: 0.05, x_m: 3, y_m: -2, theta_rad: 0.7 };

test("points go to the grid and back", () => {
  assert.deepEqual(
    grid.to_map({ ...kGrid, theta_rad: Math.PI / 2 }, 20, 0).map((v) => Number(v.toFixed(9))),
    [3, -1],
  );
  for (const cell of [
    [0, 0],
    [17, 400],
    [999.5, 3],
  ]) {
    const back = grid.to_grid(kGrid, ...grid.to_map(kGrid, ...cell));
    back.forEach((value, i) => assert.ok(Math.abs(value - cell[i]) < 1e-9));
  }
});

test("the version of a picture is the largest of its squares, as counted one by one", () => {
  const in_row = Math.ceil(kGrid.columns / 64);
  const squares = new Map();
  for (let i = 0; i < 120; ++i) squares.set((37 * i) % (in_row * 11), 1 + ((7 * i) % 50));
  const versions = new grid.TileVersions();
  for (const [square, version] of squares) versions.add(kGrid, square, version);
  for (let level = 0; level <= 3; ++level) {
    const side = 4 * 2 ** level;
    for (let row = 0; row < 3; ++row) {
      for (let column = 0; column < 4; ++column) {
        let most;
        for (const [square, version] of squares) {
          const inside =
            Math.floor((square % in_row) / side) === column && Math.floor(Math.floor(square / in_row) / side) === row;
          if (inside) most = Math.max(version, most ?? 0);
        }
        assert.equal(versions.of(level, column, row), most, `${level}/${column}/${row}`);
      }
    }
  }
});

test("the pictures of a view are those that have a pixel in it", () => {
  const box = { min_x: 8, max_x: 15, min_y: 0, max_y: 9 };
  const range = grid.tiles_in(kGrid, 0, box);
  for (let row = 0; row < kGrid.rows; row += 10) {
    for (let column = 0; column < kGrid.columns; column += 10) {
      const [x, y] = grid.to_map(kGrid, column, row);
      if (x < box.min_x || x > box.max_x || y < box.min_y || y > box.max_y) continue;
      const [c, r] = [Math.floor(column / 256), Math.floor(row / 256)];
      assert.ok(c >= range.first_column && c <= range.last_column && r >= range.first_row && r <= range.last_row);
    }
  }
  assert.equal(grid.level_for(1), 0);
  assert.equal(grid.level_for(0.5), 1);
  assert.equal(grid.level_for(0.3), 1);
  assert.equal(grid.level_for(1e-9), 8);
});

test("rooms keep their numbers on the keypad, places count from 101", () => {
  const channels = new Channels();
  const table = (channel, set) => channels.apply({ channel, from: 0, version: 1, set, gone: [] });
  table("places", { kitchen: { x_m: 1, y_m: 2 }, base: { x_m: 0, y_m: 0 } });
  table("rooms", {
    0: { name: "room 12", x_m: 0, y_m: 0 },
    1: { name: "kitchen", x_m: 0, y_m: 0 },
    2: { name: "room 3", x_m: 0, y_m: 0 },
  });
  const names = [...numbered(destinations(channels))].map(([number, { name }]) => `${number} ${name}`);
  assert.deepEqual(names, ["101 base", "102 kitchen", "3 room 3", "12 room 12"]);
});

test("numbers have units, and what is not known is a dash", () => {
  assert.equal(format.length(3.456), "3.46 m");
  assert.equal(format.length(1234), "1.23 km");
  assert.equal(format.duration(125), "2 min 5 s");
  assert.equal(format.duration(59.7), "1 min 0 s");
  assert.equal(format.degrees(Math.PI / 2), "90.0°");
  assert.equal(format.point(-0.001, -0.006), "0.00, -0.01 m");
  assert.equal(format.length(null), "–");
  assert.equal(format.speed(undefined), "–");
  assert.deepEqual(
    [0, 1, 2, 1200, null].map((number) => format.counted(number, "branch", "branches")),
    ["0 branches", "1 branch", "2 branches", "1,200 branches", "– branches"],
  );
});

test("a time of another day has its day, so that an old alarm does not look like one of today", () => {
  const at = (day, hour) => new Date(2026, 10, day, hour, 5, 9).getTime() / 1000;
  assert.equal(format.clock(at(30, 14), at(30, 23)), "14:05:09");
  assert.equal(format.clock(at(30, 14), at(31, 0)), "30/11/2026 14:05:09");
  assert.equal(format.clock(at(30, 14), at(60, 14)), "30/11/2026 14:05:09");
});

/** A square room of 4 x 4 m seen from its middle: points every 5 cm. */
function room_points() {
  const points = [];
  for (let s = -2; s < 2; s += 0.05) points.push(2, s);
  for (let s = -2; s < 2; s += 0.05) points.push(-s, 2);
  for (let s = -2; s < 2; s += 0.05) points.push(-2, -s);
  for (let s = -2; s < 2; s += 0.05) points.push(s, -2);
  return points;
}

test("two stops agree as far as they see the same walls", () => {
  const room = { points_m: room_points(), laser_m: [0, 0] };
  const at = (x_m, y_m, theta_rad = 0) => ({ x_m, y_m, theta_rad });
  const same = agreement(room, room, at(0, 0));
  assert.deepEqual(same, { overlap: 1, near: 1 });
  assert.deepEqual(agreement(room, room, at(0, 0, Math.PI / 2)), { overlap: 1, near: 1 });
  assert.equal(agreement(room, room, at(50, 0)).overlap, 0);
  // Shifted by half a room: half of its points lie in the other's view, and half of these on its walls.
  const shifted = agreement(room, room, at(2, 0));
  assert.ok(Math.abs(shifted.overlap - 0.5) < 0.05, JSON.stringify(shifted));
  assert.ok(Math.abs(shifted.near - 0.5) < 0.07, JSON.stringify(shifted));
});

test("poses are composed and compared", () => {
  const composed = compose({ x_m: 1, y_m: 2, theta_rad: Math.PI / 2 }, { x_m: 3, y_m: 0, theta_rad: Math.PI });
  assert.ok(Math.abs(composed.x_m - 1) < 1e-12 && Math.abs(composed.y_m - 5) < 1e-12);
  assert.ok(Math.abs(composed.theta_rad + Math.PI / 2) < 1e-12);
  const [meters, turn] = apart({ x_m: 0, y_m: 0, theta_rad: 3 }, { x_m: 3, y_m: 4, theta_rad: -3 });
  assert.equal(meters, 5);
  assert.ok(Math.abs(turn - (2 * Math.PI - 6)) < 1e-12);
});

test("a drive plays by its stamps, without long pauses, and shows what was seen until then", () => {
  globalThis.document = { createElement: () => ({}) };
  const outline_cm = room_points().map((value) => Math.round(100 * value));
  const stop = (stamp_s, x_m) => ({ stamp_s, x_m, y_m: 0, theta_rad: 0, outline_cm });
  const film = new Film([stop(10, 0), stop(12, 10), stop(500, 20), { stamp_s: 501 }], [0, 0]);
  assert.deepEqual(film.times_s, [0, 2, 7, 8]);
  assert.deepEqual([0, 1.9, 2, 7.5, 8].map((time_s) => film.stop_at(time_s)), [0, 0, 1, 2, 3]);
  assert.equal(film.pose_at(1).x_m, 5);
  assert.equal(film.pose_at(7.5).x_m, 20); // on the path to an unknown pose
  assert.equal(film.pose_at(8), null);
  film.see(0, 4);
  for (const [index, rooms] of [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 3],
  ]) {
    const { known, walls } = film.count(index);
    // 40 x 40 cells of 10 cm, and a row of walls around them.
    assert.ok(Math.abs(known / rooms - 1640) < 60, `${known} cells of ${rooms} rooms`);
    assert.ok(Math.abs(walls / rooms - 160) < 12, `${walls} wall cells of ${rooms} rooms`);
  }
});

test("what the navigator does is said once", () => {
  const said = (state, reason, message) => {
    const channels = new Channels();
    channels.value = () => ({ state, reason, message });
    return navigator_text(channels, { connected: true });
  };
  assert.equal(
    said("stopped", "paused", "paused; drives on after a resume"),
    "Paused. “Resume” lets it drive on.",
  );
  assert.equal(
    said("stopped", "base_not_ready", "the drive unit takes no orders: held; release it to drive"),
    "Held. Release it to drive.",
  );
  assert.equal(
    said("stopped", "base_not_ready", "the drive unit takes no orders: stopped by an operator until the release"),
    "Held. Release it to drive.",
  );
  assert.equal(
    said("stopped", "base_not_ready", "the drive unit takes no orders: a bumper was pressed"),
    "Stopped. The drive unit takes no orders: a bumper was pressed.",
  );
  assert.equal(
    said("stopped", "waits_for_route", "waits for the planner"),
    "Planning the route.",
  );
  assert.equal(
    said("relocalizing", "pose_lost", "the localizer does not track the pose: AMBIGUOUS"),
    "Position unsure. The robot finds its position before it drives.",
  );
  assert.equal(
    said("blocked", "obstacle", "0.4 m ahead"),
    "Blocked. An obstacle that is not on the map is in the way. 0.4 m ahead.",
  );
  assert.equal(said("driving", "none", "drives, 3.0 m to go"), "Driving.");
});

test("a pose that is old is not said to be known", (t) => {
  const channels = new Channels();
  const rights = { connected: true };
  let now_ms = 5000;
  t.mock.method(performance, "now", () => now_ms);
  assert.equal(robot_state(channels, rights).name, "none");
  const pose = { state: "TRACKING", reason: "What the laser sees fits the map." };
  channels.apply({ channel: "pose", version: 1, value: pose });
  now_ms += 9000;
  assert.equal(robot_state(channels, rights).name, "TRACKING");
  assert.equal(pose_of_now(channels, rights).state, "TRACKING");
  now_ms += 2000;
  assert.equal(robot_state(channels, rights).name, "silent");
  assert.equal(pose_of_now(channels, rights), null);
  channels.apply({ channel: "pose", version: 2, value: pose });
  assert.equal(robot_state(channels, rights).name, "TRACKING");
  rights.connected = false;
  assert.equal(robot_state(channels, rights).name, "offline");
});

test("the first value of a connection is as old as the service says, the next one is new", (t) => {
  const channels = new Channels();
  const rights = { connected: true };
  let now_ms = 5000;
  t.mock.method(performance, "now", () => now_ms);
  const pose = { state: "TRACKING", reason: "What the laser sees fits the map." };
  const tell = (channel, value) => channels.apply({ channel, version: 1, value });
  tell("time", { time_s: 1, ages_s: { pose: 120, base: 4 } });
  tell("pose", pose);
  tell("base", { state: "ready" });
  assert.equal(robot_state(channels, rights).name, "silent");
  assert.equal(channels.age_ms("base"), 4000);
  now_ms += 500;
  tell("pose", pose);
  assert.equal(channels.age_ms("pose"), 0);
  assert.equal(robot_state(channels, rights).name, "TRACKING");
  // An unchanged report of the base is not sent again, only its age.
  tell("time", { time_s: 2, ages_s: { pose: 3, base: 0.2 } });
  assert.equal(channels.age_ms("base"), 200);
  assert.match(robot_state(channels, rights).reason, /\(3 s old\)$/);
  channels.forget_moment();
  tell("time", { time_s: 3, ages_s: { pose: 60 } });
  tell("pose", pose);
  assert.equal(robot_state(channels, rights).name, "silent");
});

test("a stop is done when the base is held and stands", async (t) => {
  const channels = new Channels();
  let now_ms = 5000;
  t.mock.method(performance, "now", () => now_ms);
  let done = 0;
  const api = { post: () => Promise.resolve({}) };
  const stopping = new Stopping(channels, { may_write: true }, api, () => {}, () => ++done);
  const tell = (state, stands) => {
    now_ms += 100;
    channels.apply({ channel: "base", version: 1, value: { state, stands } });
  };
  tell("halted", true);
  now_ms += 100;
  await stopping.stop(() => {});
  assert.match(stopping.text(), /^Stop sent/, "the report is from before the stop");
  tell("moving", false);
  assert.match(stopping.text(), /^Stop sent/);
  tell("halted", false);
  assert.match(stopping.text(), /^Stopping: the robot still moves/);
  assert.equal(done, 0);
  tell("halted", true);
  assert.equal(stopping.text(), null);
  assert.equal(done, 1);
});

test("a map that is shown alone has no robot, one whose localizer has not spoken yet has", () => {
  const channels = new Channels();
  const named = (...services) => {
    const set = Object.fromEntries(services.map(([service, state], i) => [`${i}`, { service, state }]));
    channels.apply({ channel: "services", from: 0, version: 1, set, gone: [] });
    return robot_state(channels, { connected: true }).name;
  };
  assert.equal(named(), "none"); // nothing is known of services yet
  assert.equal(named(["web", "running"], ["map_store", "running"]), "absent");
  assert.equal(named(["web", "running"], ["map_store", "running"], ["localizer", "waiting"]), "none");
  assert.equal(named(["web", "running"], ["sensor_gateway", "running"]), "none");
  assert.equal(named(["web", "running"], ["sensor_gateway", "lost"]), "absent");
});

test("alarms that nobody has acknowledged come newest first", () => {
  const channels = new Channels();
  const alarm = (time_s, acknowledged_by) => ({ time_s, first_s: 1, count: 1, source: "base", text: "", acknowledged_by });
  const set = { 1: alarm(30, ""), 2: alarm(10, ""), 3: alarm(40, "Anna"), 11: alarm(30, "") };
  channels.apply({ channel: "alarms", from: 0, version: 1, set, gone: [] });
  assert.deepEqual(pending_alarms(channels).map(([number]) => number), ["11", "1", "2"]);
});

test("a thumb on the stick drives ahead and to the left, the faster the farther, and stands in the middle", () => {
  const close_to = (order, ahead, left) =>
    assert.ok(Math.hypot(order.ahead - ahead, order.left - left) < 1e-9, JSON.stringify(order));
  close_to(stick_order(0, 0, 80), 0, 0);
  close_to(stick_order(8, -8, 80), 0, 0);
  close_to(stick_order(0, -80, 80), 1, 0);
  close_to(stick_order(0, -400, 80), 1, 0);
  close_to(stick_order(0, 80, 80), -1, 0);
  close_to(stick_order(80, 0, 80), 0, -1);
  const half = stick_order(-30, -30, 80);
  assert.ok(half.ahead > 0.2 && half.ahead < 0.5 && Math.abs(half.ahead - half.left) < 1e-9, JSON.stringify(half));
  let before = 0;
  for (let far = 12; far <= 80; ++far) {
    const { ahead } = stick_order(0, -far, 80);
    assert.ok(ahead >= before && ahead - before < 0.03, "no jump");
    before = ahead;
  }
});

test("goals move in their list, and the times at them count but at the last one", () => {
  assert.deepEqual(moved(["a", "b", "c"], 2, -1), ["a", "c", "b"]);
  assert.deepEqual(moved(["a", "b", "c"], 0, 1), ["b", "a", "c"]);
  assert.deepEqual(moved(["a", "b", "c"], 0, -1), ["a", "b", "c"]);
  assert.deepEqual(moved(["a", "b", "c"], 2, 1), ["a", "b", "c"]);
  const choices = [{ goal: { wait_s: 30 } }, { goal: {} }, { goal: { wait_s: 5 } }];
  assert.equal(with_stays(choices, 1, 60), 90);
  assert.equal(with_stays(choices, 0, 60), 95);
  assert.equal(with_stays(choices, 1, null), null);
});

test("a report counts the drive without its pauses and jumps", () => {
  assert.equal(drive_facts([]), null);
  const stop = (stamp_s, x_m, more = {}) => ({ stamp_s, x_m, y_m: 0, theta_rad: 0, ...more });
  const stops = [
    stop(100, 0), stop(102, 3), stop(200, 3), { stamp_s: 201 }, stop(202, 4), stop(5000, 50, { starts_drive: true }),
    stop(5001, 51),
  ];
  assert.deepEqual(drive_facts(stops), { length_m: 4, time_s: 10, first_s: 100, last_s: 5001 });
  const event = (text, level = "info") => ({ time_s: 1000, level, source: "web", text });
  const events = [
    event("goal: room 1"), event("arrived: room 1"), event("goal: room 2"),
    event("Anna: stops and holds the robot", "warning"), event("stopped by the operator", "warning"),
  ];
  assert.deepEqual(goal_facts(events), { sent: 2, reached: 1, stopped: 1 });
});

test("a report is one page whose texts are texts, and keeps the newest lines", () => {
  const event = (text, level) => ({ time_s: 1000, level, source: "web", text });
  const many = Array.from({ length: 30 }, (_, i) => event(`trouble ${i}`, "error"));
  const data = {
    robot: "<script>robot</script>", made_s: 2e9, stops: [], floor_m2: 20, rooms: 1, loops: [], picture: "data:,",
    events: [event('goal: a "b" <i>', "info"), ...many],
    alarms: [{ ...event("is gone", "error"), source: "localizer", first_s: 1, count: 1, acknowledged_by: "Anna & Ben", acknowledged_s: 9 }],
  };
  const page = report_page(data);
  assert.doesNotMatch(page, /<script|<i>/);
  assert.match(page, /Goal: a &#34;b&#34; &#60;i&#62;/);
  assert.match(page, /Localizer: is gone\. Acknowledged by Anna &#38; Ben at /);
  assert.match(page, /Trouble 29\./);
  assert.doesNotMatch(page, /Trouble 1\./);
  assert.match(page, /20 earlier ones are not listed/);
});

test("a battery shows per cent only where the base measures its charge", () => {
  const { battery_value } = texts.now;
  assert.equal(battery_value(15.1, false, 64.4), "64 %, 15.1 V");
  assert.equal(battery_value(15.1, true, null), "15.1 V, low");
});

/** All texts of an object; functions are called with arguments that any of them can show. */
function all_texts(value) {
  if (typeof value === "string") return [value];
  if (typeof value === "function") {
    const shown = (argument) => {
      try {
        return [String(value(...Array(8).fill(argument)))];
      } catch {
        return [];
      }
    };
    return [...shown(2), ...shown("x")];
  }
  return Object.values(value).flatMap(all_texts);
}

test("one thing has one name on the page", () => {
  // The button Stop is the only stop: places where a scan was taken are scan points.
  const forbidden = {
    "a scan point is no stop": /\bstops\b(?! (at once|when|and holds|the robot|if))|\b(earlier|later|this|last|first) stop\b/,
    "names of states are words": /TRACKING|AMBIGUOUS|SEARCHING|LOST/,
    "a drive unit is no base": /\bbase\b/i,
    "pages do not hear": /\bhears?\b(?! nothing although)|\bheard\b/,
    "a position is known, not tracked": /\btracks?\b|\bposes?\b(?! graph)/i,
    "topics belong to technical details": /topogeo\/v\d/,
  };
  for (const text of all_texts(texts)) {
    for (const [rule, words] of Object.entries(forbidden)) {
      assert.doesNotMatch(text.replace("The robot stops when you let go", ""), words, rule);
    }
  }
});

/** The paths of all texts, and the number of parameters of those that are functions. */
function shape(value, path = "") {
  if (typeof value === "function") return [`${path}()`];
  if (typeof value !== "object") return [path];
  return Object.entries(value).flatMap(([key, part]) => shape(part, `${path}.${key}`));
}

test("no language lacks a text, and none is English", () => {
  assert.equal(texts, english); // without a browser
  for (const [code, language] of Object.entries(languages)) {
    assert.equal(language.language, code);
    assert.deepEqual(shape(language).sort(), shape(english).sort(), code);
    const empty = all_texts(language).filter((text) => text === "");
    assert.ok(empty.length <= 2, `${code}: ${empty.length} empty texts`);
    if (code === "en") continue;
    const sentences = new Set(all_texts(english).filter((text) => /[a-z] [a-z]+ [a-z]/.test(text)));
    assert.deepEqual(all_texts(language).filter((text) => sentences.has(text)), [], code);
  }
});

test("each state of a laser and a drive unit has a word in each language", () => {
  const file = join(process.env.TOPOGEO_SOURCE, "services/web/channels/protocol_names.cpp");
  const code = readFileSync(file, "utf8");
  for (const [type, texts_of] of [["LaserState", "laser_states"], ["BaseState", "base_states"]]) {
    const words = code.match(new RegExp(`name_of\\(msg::${type} [^=]*= \\{([^}]*)\\}`))[1];
    const states = words.match(/\w+/g).sort();
    for (const [language, { now }] of Object.entries(languages)) {
      assert.deepEqual(Object.keys(now[texts_of] ?? {}).sort(), states, `${language}: ${type}`);
    }
  }
});

// Sources of the reasons and events that reach the page. A new reason needs a line in spanish_reasons.ts.
const kReasonSources = {
  "libs/navigation/src": [
    "arrival", "collision_guard", "exploration_tour", "guarded_base", "input_delays", "navigation_step", "navigator",
    "navigator_inputs", "pose_keeper", "route_driver", "route_keeper",
  ],
  "libs/planning/src": ["drawn_obstructions", "goal_planner", "goal_target", "outline_planner", "route_ends"],
  "libs/devices/src": ["base_interlocks", "base_link", "base_status", "create_driver", "kobuki_driver", "pioneer_driver", "roboteq_driver", "two_wheel_driver", "vesc_driver"],
  "services/planner": ["answer"],
  "services/localizer": ["localizer_commands"],
  "services/map_store": ["archive_channel", "drawing_order"],
  "services/web/channels": ["drive_view", "event_log", "health_view", "protocol_names", "robot_view"],
  "services/web/history": ["archive_requests", "history", "map_merge"],
  "services/web/orders": [
    "drawing_editor", "exploration", "exploration_sender", "goal_sender", "localizer_requests", "manual_drive_sender",
    "manual_drive_thread",
  ],
  "services/web/server": ["controls", "viewer"],
};
// Names of faults in the status of a service, lines of logs, and parts of texts that are listed with their other parts.
const kNoReasons = /^(stored |deleted snapshot |renamed snapshot |the uploaded map|refused: |base command|motion command|inside: expected|(base )?\w+ (command|off|expired)$)/;

/** Texts of a C++ source, with {} for each part that varies; neighbouring literals are one text. */
function texts_of_source(source) {
  const code = source.replace(/^\s*(\/\/|#).*$/gm, "").replace(/ \/\/ .*$/gm, "");
  const literal = /"(?:[^"\\\n]|\\.)*"/g;
  return [...code.matchAll(/"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*/g)]
    .map(([all]) => all.match(literal).map((part) => part.slice(1, -1)).join("").replace(/\{[^{}]*\}/g, "{}"))
    .filter((text) => /[a-z]/.test(text) && text.trim().includes(" ") && !kNoReasons.test(text));
}

test("no reason of a service lacks its translation", () => {
  const known = spanish_reasons.map(([from]) => from).join("\n");
  const is_known = (text) => known.includes(text) || text.split("{}").every((part) => known.includes(part));
  const missing = Object.entries(kReasonSources).flatMap(([folder, names]) =>
    names.flatMap((name) => {
      const source = readFileSync(join(process.env.TOPOGEO_SOURCE, folder, `${name}.cpp`), "utf8");
      return texts_of_source(source).filter((text) => !is_known(text)).map((text) => `${name}.cpp: ${text}`);
    }),
  );
  assert.deepEqual(missing, []);
});

test("a reason is translated with its parts, and one that is not known stays", () => {
  const spanish = (text) => translated(text, "es");
  assert.equal(translated("no goal"), "no goal"); // without a browser the page is English
  assert.equal(spanish("no goal"), "sin destino");
  assert.equal(
    spanish("the drive unit takes no orders: held; release it to drive"),
    "la tracción no acepta órdenes: retenido; libérelo para conducir",
  );
  assert.equal(
    spanish("it is 0.20 m from the no-go zone 'no-go 1': too near"),
    "el destino está a 0.20 m de la zona prohibida 'no-go 1': demasiado cerca",
  );
  assert.equal(spanish("navigator is out of its mind"), "navigator is out of its mind");
  for (const [from, to] of spanish_reasons) {
    const parts = from.split("{}").length - 1;
    for (let part = 1; part <= parts; ++part) assert.ok(to.includes(`{${part}}`), `${from}: {${part}}`);
  }
});
