// A past drive: when each stop was reached, and the part of the floor seen until then. Cells keep
// the first stop that saw them, so that any moment is one pass over the cells.
import { DriveStop, Pose2 } from "../protocol";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { compose } from "./match_layer";
import { draw_body, draw_points } from "./robot_layer";
import { draw_picture, to_pixels } from "./to_pixels";

const finestM = 0.1; // side of a cell
const mostCells = 4e6;
const marginM = 0.5;
const widestGapRad = 0.3; // between two points of an outline where the laser saw no wall
const longestPauseS = 5; // between two stops, in the replay
const neverSeen = 0xffffffff;

export class Film {
  /** Seconds from the beginning at which each stop is reached, in the replay. */
  readonly times_s: number[] = [];
  private resolution_m = finestM;
  private left = 0; // metres
  private bottom = 0;
  private columns = 0;
  private rows = 0;
  private free_since = new Uint32Array(0);
  private wall_since = new Uint32Array(0);
  private readonly picture = document.createElement("canvas");
  private pictured = ""; // stop and colours of the picture

  /** stops: all of a drive; laser: its position on the robot, metres. */
  constructor(
    readonly stops: DriveStop[],
    private readonly laser: [number, number],
  ) {
    let time_s = 0;
    stops.forEach((stop, i) => {
      const step = i === 0 || stop.starts_drive ? 0 : stop.stamp_s - stops[i - 1].stamp_s;
      time_s += Math.max(0, Math.min(longestPauseS, step));
      this.times_s.push(time_s);
    });
    this.lay_out();
  }

  get duration_s(): number {
    return this.times_s[this.times_s.length - 1] ?? 0;
  }

  /** The last stop reached by then. */
  stop_at(time_s: number): number {
    let [low, high] = [0, this.times_s.length - 1];
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.times_s[middle] <= time_s) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Enters the views of the stops first to last, without last itself. Call it in this order. */
  see(first: number, last: number): void {
    for (let i = first; i < Math.min(last, this.stops.length); ++i) this.see_stop(i);
  }

  box() {
    return {
      min_x: this.left,
      min_y: this.bottom,
      max_x: this.left + this.columns * this.resolution_m,
      max_y: this.bottom + this.rows * this.resolution_m,
    };
  }

  /** Number of cells known at a stop, and of walls among them. */
  count(stop: number): { known: number; walls: number } {
    let [known, walls] = [0, 0];
    for (let i = 0; i < this.free_since.length; ++i) {
      if (this.wall_since[i] <= stop) ++walls;
      if (this.wall_since[i] <= stop || this.free_since[i] <= stop) ++known;
    }
    return { known, walls };
  }

  draw(context: CanvasRenderingContext2D, view: View, time_s: number, palette: Palette): void {
    if (this.stops.length === 0) return;
    const stop = this.stop_at(time_s);
    this.paint(stop, palette);
    const { min_x, max_y } = this.box();
    const [width, height] = [this.resolution_m * this.columns, this.resolution_m * this.rows];
    context.imageSmoothingEnabled = false;
    draw_picture(context, view, this.picture, { x: min_x, y: max_y, width, height });
    context.imageSmoothingEnabled = true;
    const pose = this.pose_at(time_s);
    this.draw_trail(context, view, stop, pose, palette);
    const seen = this.stops[stop];
    if (is_located(seen)) {
      const points = (seen.outline_cm ?? []).map((value) => value / 100);
      draw_points(context, view, points, seen.x_m, seen.y_m, seen.theta_rad, palette.scan);
    }
    if (!pose) return;
    const at = { x: pose.x_m, y: pose.y_m, theta: pose.theta_rad };
    draw_body(context, view, at, palette.robot, palette);
  }

  /** Interpolated between two stops; null while the robot was not located. */
  pose_at(time_s: number): Pose2 | null {
    const stop = this.stop_at(time_s);
    const [from, to] = [this.stops[stop], this.stops[stop + 1]];
    if (!from || !is_located(from)) return null;
    const span = this.times_s[stop + 1] - this.times_s[stop];
    if (!to || !is_located(to) || to.starts_drive || !(span > 0)) return from;
    const share = Math.min(1, (time_s - this.times_s[stop]) / span);
    const turn = to.theta_rad - from.theta_rad;
    return {
      x_m: from.x_m + share * (to.x_m - from.x_m),
      y_m: from.y_m + share * (to.y_m - from.y_m),
      theta_rad: from.theta_rad + share * Math.atan2(Math.sin(turn), Math.cos(turn)),
    };
  }

  private lay_out(): void {
    let [min_x, min_y, max_x, max_y] = [Infinity, Infinity, -Infinity, -Infinity];
    for (const stop of this.stops) {
      if (!is_located(stop)) continue;
      const outline = [0, 0, ...(stop.outline_cm ?? [])];
      for (let i = 0; i + 1 < outline.length; i += 2) {
        const at = on_map(stop, outline[i] / 100, outline[i + 1] / 100);
        min_x = Math.min(min_x, at.x_m);
        max_x = Math.max(max_x, at.x_m);
        min_y = Math.min(min_y, at.y_m);
        max_y = Math.max(max_y, at.y_m);
      }
    }
    if (min_x > max_x) return;
    const [width, height] = [max_x - min_x + 2 * marginM, max_y - min_y + 2 * marginM];
    while ((width / this.resolution_m) * (height / this.resolution_m) > mostCells) {
      this.resolution_m *= 2;
    }
    this.left = min_x - marginM;
    this.bottom = min_y - marginM;
    this.columns = Math.ceil(width / this.resolution_m);
    this.rows = Math.ceil(height / this.resolution_m);
    this.free_since = new Uint32Array(this.columns * this.rows).fill(neverSeen);
    this.wall_since = new Uint32Array(this.columns * this.rows).fill(neverSeen);
    this.picture.width = this.columns;
    this.picture.height = this.rows;
  }

  private see_stop(index: number): void {
    const stop = this.stops[index];
    const outline = stop.outline_cm;
    if (!is_located(stop) || !outline) return;
    const cells = (x: number, y: number): [number, number] => {
      const at = on_map(stop, x, y);
      return [(at.x_m - this.left) / this.resolution_m, (at.y_m - this.bottom) / this.resolution_m];
    };
    const eye = cells(...this.laser);
    let before: { cell: [number, number]; bearing: number } | null = null;
    for (let i = 0; i + 1 < outline.length; i += 2) {
      const [x, y] = [outline[i] / 100, outline[i + 1] / 100];
      const cell = cells(x, y);
      const bearing = Math.atan2(y - this.laser[1], x - this.laser[0]);
      if (before && Math.abs(bearing - before.bearing) < widestGapRad) {
        this.fill(eye, before.cell, cell, index);
      }
      const wall = Math.floor(cell[1]) * this.columns + Math.floor(cell[0]);
      if (this.wall_since[wall] === neverSeen) this.wall_since[wall] = index;
      before = { cell, bearing };
    }
  }

  // The cells whose centres lie in a triangle, row by row.
  private fill(a: number[], b: number[], c: number[], index: number): void {
    const low = Math.max(0, Math.floor(Math.min(a[1], b[1], c[1])));
    const high = Math.min(this.rows - 1, Math.ceil(Math.max(a[1], b[1], c[1])));
    for (let row = low; row <= high; ++row) {
      const y = row + 0.5;
      let [from, to] = [Infinity, -Infinity];
      for (const [p, q] of [
        [a, b],
        [b, c],
        [c, a],
      ]) {
        if (p[1] > y === q[1] > y) continue;
        const x = p[0] + ((y - p[1]) * (q[0] - p[0])) / (q[1] - p[1]);
        from = Math.min(from, x);
        to = Math.max(to, x);
      }
      const end = Math.min(this.columns - 1, Math.floor(to));
      for (let column = Math.max(0, Math.floor(from)); column <= end; ++column) {
        const cell = row * this.columns + column;
        if (this.free_since[cell] === neverSeen) this.free_since[cell] = index;
      }
    }
  }

  private paint(stop: number, palette: Palette): void {
    const key = `${stop} ${palette.free} ${palette.occupied}`;
    const context = this.picture.getContext("2d");
    if (key === this.pictured || !context || this.columns === 0) return;
    this.pictured = key;
    const image = context.createImageData(this.columns, this.rows);
    const pixels = new Uint32Array(image.data.buffer);
    const [free, occupied] = [pixel_of(palette.free), pixel_of(palette.occupied)];
    for (let row = 0; row < this.rows; ++row) {
      const line = (this.rows - 1 - row) * this.columns;
      const from = row * this.columns;
      for (let column = 0; column < this.columns; ++column) {
        if (this.wall_since[from + column] <= stop) pixels[line + column] = occupied;
        else if (this.free_since[from + column] <= stop) pixels[line + column] = free;
      }
    }
    context.putImageData(image, 0, 0);
  }

  private draw_trail(
    context: CanvasRenderingContext2D,
    view: View,
    stop: number,
    robot: Pose2 | null,
    palette: Palette,
  ): void {
    context.strokeStyle = palette.trail;
    context.lineWidth = 2;
    context.beginPath();
    let pen_down = false;
    const go_to = (at: Pose2) => {
      const [x, y] = to_pixels(view, at.x_m, at.y_m);
      if (pen_down) context.lineTo(x, y);
      else context.moveTo(x, y);
      pen_down = true;
    };
    for (let i = 0; i <= stop; ++i) {
      const at = this.stops[i];
      if (at.starts_drive || !is_located(at)) pen_down = false;
      if (is_located(at)) go_to(at);
    }
    if (robot) go_to(robot);
    context.stroke();
  }
}

function is_located(stop: DriveStop): stop is DriveStop & Pose2 {
  return stop.x_m !== undefined && stop.y_m !== undefined && stop.theta_rad !== undefined;
}

function on_map(stop: Pose2, x_m: number, y_m: number): Pose2 {
  return compose(stop, { x_m, y_m, theta_rad: 0 });
}

// A colour "#rrggbb" as a pixel of an ImageData seen as 32-bit words (little-endian).
function pixel_of(color: string): number {
  const value = Number.parseInt(color.slice(1, 7), 16);
  const [red, green, blue] = [(value >> 16) & 255, (value >> 8) & 255, value & 255];
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}
