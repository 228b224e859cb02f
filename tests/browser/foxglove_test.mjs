// Foxglove's own client library with a simulated robot: decoded messages agree with the simulator's truth.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { wait_for, Robot } from "./robot.mjs";

const { TOPOGEO_BUILD: build, TOPOGEO_SOURCE: source } = process.env;
const packages = createRequire(join(build, "tests/browser/"));
const { FoxgloveClient } = packages("@foxglove/ws-protocol");
const schemas = packages("@foxglove/schemas/jsonschema");
const WebSocket = packages("ws");

// The map's origin is the robot's start, at (1, 1) of a room of 6 x 4 m, with the x axis ahead.
const kRoom = { left_m: -1, right_m: 5, lower_m: -1, upper_m: 3 };
const kNear_m = 0.15;
const kBegun_s = Date.now() / 1e3;

const robot = new Robot(join(build, "bin"), source, process.env.TOPOGEO_WORK);
let client;
const info = {};
const channels = new Map(); // by topic
const newest = new Map(); // by topic
const counts = new Map();
const log = [];
const statuses = [];
const entities = new Map(); // of /graph
let socket;

before(async () => {
  await robot.start();
  socket = new WebSocket(robot.address.replace("http", "ws"), [FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
  client = new FoxgloveClient({ ws: socket });
  const topics = new Map(); // by subscription
  client.on("serverInfo", (message) => Object.assign(info, message));
  client.on("status", (message) => statuses.push(message));
  client.on("advertise", (advertised) => {
    for (const channel of advertised) {
      channels.set(channel.topic, channel);
      topics.set(client.subscribe(channel.id), channel.topic);
    }
  });
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    const topic = topics.get(subscriptionId);
    const message = JSON.parse(new TextDecoder().decode(data));
    newest.set(topic, { timestamp, message });
    counts.set(topic, (counts.get(topic) ?? 0) + 1);
    if (topic === "/log") log.push(message);
    if (topic === "/graph") {
      for (const deletion of message.deletions) {
        if (deletion.type === 1) entities.clear();
        else entities.delete(deletion.id);
      }
      for (const entity of message.entities) entities.set(entity.id, entity);
    }
  });
  // Topics come one by one, the places of the map after its grid: wait for those that tests use.
  for (const topic of ["/pose", "/map", "/tf", "/scan", "/places"]) {
    await wait_for(`a message of ${topic}`, () => newest.has(topic));
  }
  await wait_for("the place of the map", () => place_names().includes("room A"));
});

after(async () => {
  client?.close();
  await robot.stop();
});

function message(topic) {
  return newest.get(topic).message;
}

function place_names() {
  return message("/places").entities.flatMap(({ texts }) => texts.map(({ text }) => text));
}

/** Our schema is a part of Foxglove's. */
function assert_part_of(ours, theirs, where) {
  assert.equal(ours.type, theirs.type, where);
  if (ours.oneOf) {
    const values = (schema) => schema.oneOf.map(({ title, const: value }) => `${title}=${value}`);
    assert.deepEqual(values(ours), values(theirs), where);
  }
  assert.equal(ours.contentEncoding, theirs.contentEncoding, where);
  if (ours.items) assert_part_of(ours.items, theirs.items, `${where}[]`);
  for (const [name, schema] of Object.entries(ours.properties ?? {})) {
    assert.ok(theirs.properties[name], `${where}.${name}`);
    assert_part_of(schema, theirs.properties[name], `${where}.${name}`);
  }
}

function transform_to_map(child) {
  const found = message("/tf").transforms.find((entry) => entry.child_frame_id === child);
  if (!found) return null;
  const { translation, rotation } = found;
  return { x: translation.x, y: translation.y, theta: 2 * Math.atan2(rotation.z, rotation.w) };
}

function compose(a, b) {
  const [c, s] = [Math.cos(a.theta), Math.sin(a.theta)];
  return { x: a.x + c * b.x - s * b.y, y: a.y + s * b.x + c * b.y, theta: a.theta + b.theta };
}

test("it greets with topics of Foxglove's own types", () => {
  assert.match(info.name, /topogeo/);
  assert.deepEqual(info.capabilities, []);
  assert.equal(channels.size, 11);
  for (const { schemaName, schema, encoding, schemaEncoding } of channels.values()) {
    assert.equal(encoding, "json");
    assert.equal(schemaEncoding, "jsonschema");
    const ours = JSON.parse(schema);
    const theirs = schemas[schemaName.replace("foxglove.", "")];
    assert.equal(ours.title, theirs.title);
    assert_part_of(ours, theirs, schemaName);
  }
});

test("the frames lead to the robot", async () => {
  await wait_for("map -> odom", () => transform_to_map("odom"));
  const in_map = compose(transform_to_map("odom"), transform_to_map("base_link"));
  const { position, orientation } = message("/pose").pose;
  assert.ok(Math.hypot(in_map.x - position.x, in_map.y - position.y) < kNear_m);
  assert.ok(Math.hypot(position.x, position.y) < kNear_m, "it stands where it started");
  assert.ok(Math.abs(orientation.z) < 0.05);
  assert.ok(transform_to_map("laser"));
});

test("the scan lies on the walls of the room", () => {
  const { data, point_stride, frame_id } = message("/scan");
  assert.equal(frame_id, "base_link");
  const bytes = Buffer.from(data, "base64");
  const points = bytes.length / point_stride;
  assert.ok(points > 50, `${points} points`);
  const pose = compose(transform_to_map("odom"), transform_to_map("base_link"));
  let on_walls = 0;
  for (let i = 0; i < points; ++i) {
    const point = { x: bytes.readFloatLE(i * point_stride), y: bytes.readFloatLE(i * point_stride + 4), theta: 0 };
    const { x, y } = compose(pose, point);
    assert.ok(x > kRoom.left_m - 0.3 && x < kRoom.right_m + 0.3 && y > kRoom.lower_m - 0.3 && y < kRoom.upper_m + 0.3);
    const distances = [x - kRoom.left_m, kRoom.right_m - x, y - kRoom.lower_m, kRoom.upper_m - y];
    if (Math.min(...distances.map(Math.abs)) < kNear_m) ++on_walls;
  }
  assert.ok(on_walls > 0.5 * points, `${on_walls} of ${points} on the walls; the others on table and column`);
});

/** Approximate length of the walls of a grid. */
function walls_m({ data, cell_stride, cell_size }) {
  const bytes = Buffer.from(data, "base64");
  let walls = 0;
  for (let i = 0; i < bytes.length; i += cell_stride) if (bytes[i + 3] === 255 && bytes[i] === 32) ++walls;
  return walls * cell_size.x;
}

test("the map has the room in its grid", async () => {
  await wait_for("a map of the first scan", () => walls_m(message("/map")) > 8); // of a room 20 m round
  const { column_count, cell_size, row_stride, cell_stride, fields, data, pose } = message("/map");
  assert.deepEqual(
    fields.map(({ name }) => name),
    ["red", "green", "blue", "alpha"],
  );
  const bytes = Buffer.from(data, "base64");
  assert.equal(row_stride, column_count * cell_stride);
  assert.equal(bytes.length % row_stride, 0);
  const cell = (x_m, y_m) => {
    const column = Math.floor((x_m - pose.position.x) / cell_size.x);
    const row = Math.floor((y_m - pose.position.y) / cell_size.y);
    return bytes.subarray(row * row_stride + column * cell_stride, row * row_stride + (column + 1) * cell_stride);
  };
  assert.deepEqual([...cell(0.5, 0)], [255, 255, 255, 255], "free before the robot");
});

test("a route comes and goes with its goal, and the pose follows the robot", async () => {
  assert.equal(await robot.post("goal", { place: "room A" }), 202);
  await wait_for("a route", () => newest.get("/route")?.message.entities.length === 1);
  const { points } = message("/route").entities[0].lines[0];
  assert.ok(Math.hypot(points.at(-1).x - 3, points.at(-1).y) < 0.5);
  await wait_for("the robot is at (3, 0)", () => {
    const { x, y } = message("/pose").pose.position;
    return Math.hypot(x - 3, y) < 0.3;
  });
  await wait_for("no route", () => message("/route").entities.length === 0);
  assert.ok(counts.get("/pose") > 10);
  // The stamp is the wall clock's, within this test.
  const stamp_s = Number(newest.get("/pose").timestamp) / 1e9;
  assert.ok(stamp_s > kBegun_s && stamp_s < Date.now() / 1e3 + 1, `${stamp_s}, begun at ${kBegun_s}`);
});

test("the graph is drawn in the room, places have their names, events are logged", async () => {
  const count = (part) => [...entities.values()].reduce((sum, entity) => sum + entity[part].length, 0);
  await wait_for("nodes and branches", () => count("spheres") > 1 && count("lines") > 0).catch((error) => {
    throw new Error(`${error.message}: ${JSON.stringify([...entities.values()])}`);
  });
  for (const entity of entities.values()) {
    const points = [...entity.spheres.map(({ pose }) => pose.position), ...entity.lines.flatMap(({ points }) => points)];
    for (const { x, y } of points) {
      assert.ok(x > kRoom.left_m && x < kRoom.right_m && y > kRoom.lower_m && y < kRoom.upper_m, `${x}, ${y}`);
    }
  }
  assert.ok(place_names().includes("room A"), place_names().join());
  await wait_for("the pose is in the log", () =>
    log.some(({ name, message: text }) => name === "localizer" && /TRACKING/.test(text)),
  );
});

test("what is not offered is answered by a status", async () => {
  socket.send(JSON.stringify({ op: "getParameters", parameterNames: [] }));
  await wait_for("a status", () => statuses.some(({ level, message: text }) => level === 2 && /getParameters/.test(text)));
});
