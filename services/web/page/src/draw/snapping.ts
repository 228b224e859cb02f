// Snaps a point drawn by hand to an existing corner, to a right angle with the drawing, or to the
// grid.
import { distance, heading, Point } from "./geometry";

export interface SnapSettings {
  grid_m: number; // 0: no grid
  corners: boolean;
  right_angles: boolean;
}

export interface SnapContext {
  corners: Point[]; // existing ones
  from: Point | null; // previous point of the line
  before: Point | null; // the point before that
  reach_m: number; // reach of the attraction of a corner or a direction
}

export interface Snapped extends Point {
  to: "corner" | "angle" | "grid" | "free";
}

const quarterTurn = Math.PI / 2;
const sameDirection = 1e-9;
const headingNearRad = 0.12;

/** Corners have precedence over right angles, and right angles over the grid. */
export function snap(at: Point, settings: SnapSettings, context: SnapContext): Snapped {
  if (settings.corners) {
    const corner = nearest(context.corners, at);
    if (corner && distance(corner, at) <= context.reach_m) return { ...corner, to: "corner" };
  }
  const on_angle = settings.right_angles ? at_right_angle(at, settings.grid_m, context) : null;
  if (on_angle) return { ...on_angle, to: "angle" };
  if (settings.grid_m > 0) return { ...on_grid(at, settings.grid_m), to: "grid" };
  return { ...at, to: "free" };
}

export function on_grid(at: Point, step_m: number): Point {
  return { x: to_step(at.x, step_m), y: to_step(at.y, step_m) };
}

/** The nearest multiple of 45 degrees if it is close, else the angle itself. */
export function snap_heading(angle: number): number {
  const eighth = (Math.PI / 4) * Math.round(angle / (Math.PI / 4));
  return Math.abs(angle - eighth) <= headingNearRad ? eighth : angle;
}

function to_step(value: number, step: number): number {
  return step * Math.round(value / step);
}

function nearest(points: Point[], at: Point): Point | null {
  let best: Point | null = null;
  for (const point of points) {
    if (!best || distance(point, at) < distance(best, at)) best = point;
  }
  return best;
}

// On a ray from the last point, parallel to an axis or at a right angle to the previous segment.
function at_right_angle(at: Point, grid_m: number, context: SnapContext): Point | null {
  const { from, before, reach_m } = context;
  if (!from || distance(from, at) <= reach_m) return null;
  const bases = before ? [0, heading(before, from)] : [0];
  let best: Point | null = null;
  for (const base of bases) {
    const angle = base + quarterTurn * Math.round((heading(from, at) - base) / quarterTurn);
    const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
    const along = (at.x - from.x) * dx + (at.y - from.y) * dy;
    const ray = on_ray(from, dx, dy, along, grid_m);
    const aside = Math.abs((at.x - from.x) * dy - (at.y - from.y) * dx);
    if (aside > reach_m) continue;
    if (!best || distance(ray, at) < distance(best, at) - sameDirection) best = ray;
  }
  return best;
}

// Parallel to an axis the end lies on the grid; otherwise the length is a multiple of its step.
function on_ray(from: Point, dx: number, dy: number, along: number, grid_m: number): Point {
  const length = grid_m > 0 ? to_step(along, grid_m) : along;
  if (Math.abs(dy) < sameDirection) {
    return { x: grid_m > 0 ? to_step(from.x + along * dx, grid_m) : from.x + along * dx, y: from.y };
  }
  if (Math.abs(dx) < sameDirection) {
    return { x: from.x, y: grid_m > 0 ? to_step(from.y + along * dy, grid_m) : from.y + along * dy };
  }
  return { x: from.x + length * dx, y: from.y + length * dy };
}
