// An unfinished item: applies presses, drags and taps on the map to a tool's shape. The points
// passed in are already snapped.
import { distance, heading, Point } from "./geometry";
import { snap_heading } from "./snapping";

/**
 * point: one tap; arrow: press and drag; segment: two points; line, polygon: any number of points.
 */
export type Shape = "point" | "arrow" | "segment" | "line" | "polygon";

export interface Finished {
  points: number[]; // x, y of each, metres
  heading_rad: number; // for an arrow
}

export class Sketch {
  readonly points: Point[] = [];
  /** Position of the pointer: the end of the rubber band. */
  cursor: Point | null = null;
  private pressed: Point | null = null;

  constructor(readonly shape: Shape) {}

  /** The last point, from which right angles are measured. */
  get from(): Point | null {
    return this.points[this.points.length - 1] ?? (this.is_drag() ? this.pressed : null);
  }

  get before(): Point | null {
    return this.points[this.points.length - 2] ?? null;
  }

  get is_empty(): boolean {
    return this.points.length === 0;
  }

  /** Start of an arrow while it is dragged. */
  get base(): Point | null {
    return this.shape === "arrow" ? this.pressed : null;
  }

  heading_rad(): number {
    const { base, cursor } = this;
    return base && cursor ? snap_heading(heading(base, cursor)) : 0;
  }

  press(at: Point): void {
    this.pressed = at;
    this.cursor = at;
  }

  move(at: Point): void {
    this.cursor = at;
  }

  /**
   * Ends a press; tapped: it did not move. near_m: a tap so near to the first or last point ends a
   * line. Returns the item when it is complete, else null.
   */
  lift(at: Point, tapped: boolean, near_m: number): Finished | null {
    const pressed = this.pressed ?? at;
    this.cursor = at;
    const done = tapped ? this.tap(pressed, near_m) : this.stroke(pressed, at, near_m);
    this.pressed = null;
    return done;
  }

  /** The current item; null while points are missing. */
  finish(): Finished | null {
    const fewest = this.shape === "polygon" ? 3 : this.shape === "point" ? 1 : 2;
    return this.points.length >= fewest ? this.done() : null;
  }

  /** Removes the last point; false if there is none. */
  step_back(): boolean {
    return this.points.pop() !== undefined;
  }

  /** A second finger begins a pinch: the press was not intended. */
  cancel_press(): void {
    this.pressed = null;
  }

  /** The visible points: those so far, and the one at the pointer. */
  shown(): Point[] {
    const { cursor, pressed } = this;
    if (this.shape === "arrow" || this.shape === "point") return [];
    if (this.points.length === 0 && pressed && cursor) {
      return this.shape === "polygon" ? rectangle(pressed, cursor) : [pressed, cursor];
    }
    return cursor && this.points.length > 0 ? [...this.points, cursor] : [...this.points];
  }

  private is_drag(): boolean {
    return this.pressed !== null && this.shape !== "polygon";
  }

  private tap(at: Point, near_m: number): Finished | null {
    const first = this.points[0];
    const last = this.points[this.points.length - 1];
    if (this.shape === "arrow") return { points: [at.x, at.y], heading_rad: 0 };
    if (last && distance(at, last) <= near_m && this.points.length > 1) return this.finish();
    if (last && distance(at, last) <= near_m) return null;
    if (this.shape === "polygon" && this.points.length > 2 && distance(at, first) <= near_m) {
      return this.finish();
    }
    const closes = this.shape === "line" && this.points.length > 2 && distance(at, first) <= near_m;
    this.points.push(closes ? first : at);
    return closes || this.is_full() ? this.finish() : null;
  }

  private stroke(from: Point, to: Point, near_m: number): Finished | null {
    if (this.shape === "point") return { points: [to.x, to.y], heading_rad: 0 };
    if (this.shape === "arrow") {
      return { points: [from.x, from.y], heading_rad: this.heading_rad() };
    }
    if (this.points.length > 0) return this.tap(to, near_m);
    if (distance(from, to) <= near_m) return this.tap(from, near_m);
    if (this.shape === "polygon") {
      if (Math.min(Math.abs(from.x - to.x), Math.abs(from.y - to.y)) <= near_m) return null;
      this.points.push(...rectangle(from, to));
      return this.finish();
    }
    this.points.push(from, to);
    return this.finish();
  }

  private is_full(): boolean {
    if (this.shape === "point") return this.points.length === 1;
    return this.shape === "segment" && this.points.length === 2;
  }

  private done(): Finished {
    return { points: this.points.flatMap(({ x, y }) => [x, y]), heading_rad: 0 };
  }
}

function rectangle(a: Point, b: Point): Point[] {
  return [a, { x: b.x, y: a.y }, b, { x: a.x, y: b.y }];
}
