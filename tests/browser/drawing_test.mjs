// The model of the edit mode, without a browser: drawing and history, snapping, sketches, grips, placing a picture.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load_module.mjs";

const drawing = await load("draw/drawing");
const { DrawingDocument } = await load("draw/document");
const geometry = await load("draw/geometry");
const { snap } = await load("draw/snapping");
const { Sketch } = await load("draw/sketch");
const grab = await load("draw/grab");
const { measured } = await load("draw/background");
const tools = await load("draw/tools");

const wall = (...points_m) => ({ points_m });
const zone = (name, ...corners_m) => ({ name, kind: "no_go", value: 0, corners_m });
const kSquare = [0, 0, 4, 0, 4, 4, 0, 4];

test("a random series of edits, undone and redone, shows each state that there was", () => {
  let seed = 7;
  const random = (end) => (seed = (48271 * seed) % 2147483647) % end;
  const edited = new DrawingDocument();
  edited.load(drawing.empty_drawing(), "1");
  const states = [JSON.stringify(edited.drawing)]; // the oracle: every state, in a row
  let now = 0;
  for (let i = 0; i < 400; ++i) {
    const what = random(4);
    if (what === 0 && now > 0) {
      edited.undo();
      --now;
    } else if (what === 1 && now + 1 < states.length) {
      edited.redo();
      ++now;
    } else {
      const { walls } = edited.drawing;
      const remove = what === 2 && walls.length > 0;
      const ref = { list: "walls", index: remove ? random(walls.length) : 0 };
      edited.edit(remove ? drawing.without(edited.drawing, ref) : drawing.with_new(edited.drawing, "walls", wall(0, 0, i, 1)));
      states.splice(++now, Infinity, JSON.stringify(edited.drawing));
    }
    assert.equal(JSON.stringify(edited.drawing), states[now]);
    assert.equal(edited.can_undo, now > 0);
    assert.equal(edited.can_redo, now + 1 < states.length);
    assert.equal(edited.is_dirty, now !== 0);
  }
});

test("a drag is one step, and one that is cancelled is none", () => {
  const edited = new DrawingDocument();
  const first = { ...drawing.empty_drawing(), walls: [wall(0, 0, 1, 0)] };
  edited.load(first, "1");
  const to = (x) => drawing.with_item(first, { list: "walls", index: 0 }, wall(0, 0, x, 0));
  for (const x of [2, 3, 4]) edited.drag(to(x));
  edited.end_drag(true);
  assert.deepEqual(edited.drawing.walls, [wall(0, 0, 4, 0)]);
  for (const x of [5, 6]) edited.drag(to(x));
  edited.end_drag(false);
  assert.deepEqual(edited.drawing.walls, [wall(0, 0, 4, 0)]);
  edited.undo();
  assert.equal(edited.drawing, first);
  assert.equal(edited.can_undo, false);
});

test("saving keeps the history, and what others have saved can be undone", () => {
  const edited = new DrawingDocument();
  edited.load(drawing.empty_drawing(), "1");
  const mine = drawing.with_new(edited.drawing, "walls", wall(0, 0, 1, 0));
  edited.edit(mine);
  edited.mark_saved(mine, "2");
  assert.equal(edited.is_dirty, false);
  edited.undo();
  assert.equal(edited.is_dirty, true);
  edited.redo();
  const theirs = { ...drawing.empty_drawing(), walls: [wall(9, 9, 8, 8)] };
  edited.take_over(theirs, "3");
  assert.equal(edited.is_dirty, false);
  edited.undo();
  assert.deepEqual([edited.drawing, edited.version, edited.is_dirty], [mine, "3", true]);
});

test("names are free or get a number", () => {
  let edited = drawing.empty_drawing();
  for (const expected of ["no-go 1", "no-go 2"]) {
    const { list, item } = tools.make_item("no_go", { points: kSquare, heading_rad: 0 }, edited);
    assert.equal(item.name, expected);
    edited = drawing.with_new(edited, list, item);
  }
  assert.equal(drawing.name_is_free(edited, "zones", "no-go 2"), false);
  assert.equal(drawing.name_is_free(edited, "zones", "no-go 2", { list: "zones", index: 1 }), true);
  const oneway = tools.make_item("one_way", { points: [0, 0, 1, 0, 1, 3, 0, 3], heading_rad: 0 }, edited);
  assert.equal(oneway.item.value, 1.571); // along its longer side
  const lane = tools.make_item("preferred", { points: kSquare, heading_rad: 0 }, edited);
  assert.deepEqual([lane.item.kind, lane.item.value, lane.item.name], ["preferred", 0, "lane 1"]);
});

test("a drawing goes to JSON and back, and a wrong one is refused by the item's number", () => {
  const good = {
    places: [{ name: "base", x_m: 1, y_m: 2, heading_rad: 0.5 }, { name: "desk", x_m: 0, y_m: 0 }],
    zones: [zone("a", ...kSquare)],
    walls: [wall(0, 0, 1, 1, 2, 0)],
    openings: [wall(0, 0, 1, 1)],
    doors: [{ name: "d", points_m: [0, 0, 1, 0] }],
  };
  assert.deepEqual(drawing.parse_drawing(JSON.parse(JSON.stringify(good))), good);
  assert.deepEqual(drawing.start_of(good), { x_m: 1, y_m: 2, heading_rad: 0.5 });
  const refused = (change, pattern) =>
    assert.throws(() => drawing.parse_drawing({ ...good, ...change }), (error) => pattern.test(error.message));
  refused({ walls: [wall(0, 0, 1, 1), wall(0, 0, 1)] }, /Entry 2 of .walls/);
  refused({ zones: [{ ...zone("a", ...kSquare), kind: "lava" }] }, /Entry 1 of .zones/);
  refused({ zones: [zone("", ...kSquare)] }, /Entry 1 of .zones/);
  refused({ openings: [wall(0, 0, 1, 1, 2, 2)] }, /Entry 1 of .openings/);
  refused({ places: 3 }, /places/);
  const many = { ...good, walls: Array(4096).fill(wall(0, 0, 1, 1)) };
  assert.deepEqual(drawing.parse_drawing(many), many);
  refused({ walls: [...many.walls, wall(0, 0, 1, 1)] }, /more than 4096/);
  refused({ walls: [wall(...Array(2 * 257).fill(0))] }, /Entry 1 of .walls/);
  for (const nothing of [null, [], "x"]) assert.throws(() => drawing.parse_drawing(nothing));
});

test("area, length and inside, by hand and by counting points", () => {
  assert.equal(geometry.area_of(kSquare), 16);
  assert.equal(geometry.length_of(kSquare, true), 16);
  assert.equal(geometry.length_of(kSquare, false), 12);
  const l_shape = [0, 0, 4, 0, 4, 2, 2, 2, 2, 4, 0, 4];
  let inside = 0;
  for (let x = 0.05; x < 4; x += 0.1) {
    for (let y = 0.05; y < 4; y += 0.1) inside += geometry.contains(l_shape, { x, y }) ? 0.01 : 0;
  }
  assert.ok(Math.abs(inside - geometry.area_of(l_shape)) < 1e-6);
  assert.equal(geometry.distance_to(wall(0, 0, 4, 0).points_m, false, { x: 7, y: 4 }), 5);
});

const kAll = { grid_m: 0.5, corners: true, right_angles: true };

test("corners count more than right angles, these more than the grid", () => {
  const context = { corners: [{ x: 1.03, y: 1.02 }], from: null, before: null, reach_m: 0.2 };
  assert.deepEqual(snap({ x: 1.1, y: 1 }, kAll, context), { x: 1.03, y: 1.02, to: "corner" });
  assert.deepEqual(snap({ x: 2.6, y: 1.3 }, kAll, context), { x: 2.5, y: 1.5, to: "grid" });
  // Along an axis from a point that is not on the grid.
  const from = { ...context, from: { x: 0.1, y: 0.13 } };
  assert.deepEqual(snap({ x: 3.2, y: 0.25 }, kAll, from), { x: 3, y: 0.13, to: "angle" });
  assert.deepEqual(snap({ x: 3.2, y: 0.6 }, kAll, from).to, "grid");
  const none = { grid_m: 0, corners: false, right_angles: false };
  assert.deepEqual(snap({ x: 1.1, y: 1 }, none, from), { x: 1.1, y: 1, to: "free" });
});

test("a wall at an angle is followed at a right angle", () => {
  const before = { x: 0, y: 0 };
  const from = { x: 2, y: 1 };
  const free = { grid_m: 0, corners: false, right_angles: true };
  const snapped = snap({ x: 1.05, y: 3.05 }, free, { corners: [], from, before, reach_m: 0.2 });
  assert.equal(snapped.to, "angle");
  assert.ok(Math.abs((from.x - before.x) * (snapped.x - from.x) + (from.y - before.y) * (snapped.y - from.y)) < 1e-9);
});

test("taps and drags make shapes", () => {
  const kNear = 0.1;
  const tap = (sketch, x, y) => {
    sketch.press({ x, y });
    return sketch.lift({ x, y }, true, kNear);
  };
  const stroke = (sketch, from, to) => {
    sketch.press(from);
    sketch.move(to);
    return sketch.lift(to, false, kNear);
  };
  const a = { x: 0, y: 0 };
  const b = { x: 3, y: 2 };
  assert.deepEqual(stroke(new Sketch("polygon"), a, b).points, [0, 0, 3, 0, 3, 2, 0, 2]);
  assert.equal(stroke(new Sketch("polygon"), a, { x: 3, y: 0 }), null); // no area
  for (const shape of ["segment", "line"]) assert.deepEqual(stroke(new Sketch(shape), a, b).points, [0, 0, 3, 2]);
  const arrow = stroke(new Sketch("arrow"), a, { x: 0.1, y: 3 });
  assert.deepEqual(arrow, { points: [0, 0], heading_rad: Math.PI / 2 });
  const polygon = new Sketch("polygon");
  for (const [x, y] of [[0, 0], [3, 0], [3, 3]]) assert.equal(tap(polygon, x, y), null);
  assert.deepEqual(tap(polygon, 0.05, 0).points, [0, 0, 3, 0, 3, 3]);
  const line = new Sketch("line");
  assert.equal(tap(line, 0, 0), null);
  assert.equal(tap(line, 0, 0), null); // a line of one point does not end
  assert.equal(line.finish(), null);
  assert.equal(tap(line, 2, 0), null);
  assert.deepEqual(tap(line, 2, 0.05).points, [0, 0, 2, 0]);
  line.press({ x: 5, y: 5 });
  line.cancel_press();
  assert.equal(line.points.length, 2);
  assert.equal(line.step_back() && line.points.length, 1);
});

test("a press takes hold of handles first, then of the smallest item", () => {
  const edited = {
    ...drawing.empty_drawing(),
    zones: [zone("large", ...kSquare), zone("small", 1, 1, 2, 1, 2, 2, 1, 2)],
    walls: [wall(0, 3, 4, 3)],
    places: [{ name: "p", x_m: 2, y_m: 3 }],
  };
  const name = (x, y) => {
    const ref = grab.item_at(edited, { x, y }, 0.1);
    return ref && `${ref.list} ${ref.index}`;
  };
  assert.equal(name(1.5, 1.5), "zones 1");
  assert.equal(name(3, 1.5), "zones 0");
  assert.equal(name(1, 3.05), "walls 0");
  assert.equal(name(2, 3), "places 0");
  assert.equal(name(9, 9), null);
  const grip = (x, y) => grab.grip_at(edited, { list: "zones", index: 0 }, { x, y }, 0.1, 1).part;
  assert.deepEqual(grip(4, 4), { what: "corner", index: 2 });
  assert.deepEqual(grip(2, 4), { what: "middle", index: 2 });
  assert.deepEqual(grip(3, 1.5), { what: "whole" });
  const item = edited.zones[0];
  const moved = (part, x, y) => grab.moved(item, part, { x, y }).corners_m;
  assert.deepEqual(moved({ what: "corner", index: 2 }, 5, 5), [0, 0, 4, 0, 5, 5, 0, 4]);
  assert.deepEqual(moved({ what: "middle", index: 3 }, -1, 2), [...kSquare, -1, 2]);
  assert.deepEqual(moved({ what: "whole" }, 1, 1), kSquare.map((value) => value + 1));
  assert.deepEqual(grab.without_corner("zones", item, 1).corners_m, [0, 0, 4, 4, 0, 4]);
  assert.equal(grab.without_corner("walls", edited.walls[0], 0), null);
});

test("a picture is scaled and turned so that the points are as far apart as they should be", () => {
  const at = { x_m: -3, y_m: 7, metres_per_pixel: 0.05, angle_rad: 0 };
  // Where a pixel of the picture lies; lines count downwards.
  const place = ({ x_m, y_m, metres_per_pixel: s, angle_rad }, [u, v]) => {
    const [cos, sin] = [s * Math.cos(angle_rad), s * Math.sin(angle_rad)];
    return { x: x_m + cos * u + sin * v, y: y_m + sin * u - cos * v };
  };
  for (const pixels of [[[10, 20], [110, 24]], [[10, 20], [90, 80]], [[30, 10], [26, 210]]]) {
    const [a, b] = pixels.map((pixel) => place(at, pixel));
    const after = measured(at, a, b, 12.5);
    const [a2, b2] = pixels.map((pixel) => place(after, pixel));
    assert.ok(geometry.distance(a, a2) < 1e-9);
    assert.ok(Math.abs(geometry.distance(a2, b2) - 12.5) < 1e-9);
    const near_axis = Math.min(Math.abs(b.x - a.x), Math.abs(b.y - a.y)) < 0.1 * geometry.distance(a, b);
    if (near_axis) assert.ok(Math.min(Math.abs(b2.x - a2.x), Math.abs(b2.y - a2.y)) < 1e-9);
    else assert.equal(after.angle_rad, 0);
  }
});
