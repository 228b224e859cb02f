// Overlays of the edit mode besides the drawing: grid, handles, lengths, unfinished item.
import { is_closed, Item, ItemRef, points_of } from "../draw/drawing";
import { area_of, distance, middle_of, Point, segments_of } from "../draw/geometry";
import { Handle } from "../draw/grab";
import { Sketch } from "../draw/sketch";
import * as format from "../format";
import { Palette } from "../ui/theme";
import { draw_arrow, trace_line } from "./drawing_layer";
import { View } from "./map_canvas";
import { pixel_x, pixel_y, to_pixels } from "./to_pixels";

const labelFont = "600 13px system-ui, sans-serif";
const fewestGridPx = 9;
const mostGridLines = 400;
const handlePx = 6;
const shortestLabelledPx = 56;
const besidePx = 32;

/** Lines of the grid; only every 5th or 10th where they would be too dense. */
export function draw_grid(
  context: CanvasRenderingContext2D,
  view: View,
  step_m: number,
  palette: Palette,
): void {
  if (step_m <= 0) return;
  const step = [1, 5, 10, 50, 100].map((n) => n * step_m).find((s) => s * view.scale >= fewestGridPx);
  if (!step || (view.max_x - view.min_x) / step > mostGridLines) return;
  context.beginPath();
  for (let x = step * Math.ceil(view.min_x / step); x <= view.max_x; x += step) {
    context.moveTo(...to_pixels(view, x, view.min_y));
    context.lineTo(...to_pixels(view, x, view.max_y));
  }
  for (let y = step * Math.ceil(view.min_y / step); y <= view.max_y; y += step) {
    context.moveTo(...to_pixels(view, view.min_x, y));
    context.lineTo(...to_pixels(view, view.max_x, y));
  }
  context.strokeStyle = palette.grid;
  context.lineWidth = 1;
  context.stroke();
}

/** Handles of the selected item, and its lengths. */
export function draw_selection(
  context: CanvasRenderingContext2D,
  view: View,
  ref: ItemRef,
  item: Item,
  handles: Handle[],
  palette: Palette,
): void {
  const points = points_of(item);
  const closed = is_closed(ref.list);
  if (ref.list === "places") {
    ring(context, to_pixels(view, points[0], points[1]), 17, palette.selected);
  }
  for (const handle of handles) {
    const at = to_pixels(view, handle.x, handle.y);
    const middle = handle.part.what === "middle";
    context.beginPath();
    context.arc(...at, middle ? handlePx - 2 : handlePx, 0, 2 * Math.PI);
    context.fillStyle = middle ? palette.halo : palette.selected;
    context.fill();
    context.strokeStyle = middle ? palette.selected : palette.halo;
    context.lineWidth = 2;
    context.stroke();
  }
  draw_lengths(context, view, points, closed, palette);
}

/** The unfinished item. */
export function draw_sketch(
  context: CanvasRenderingContext2D,
  view: View,
  sketch: Sketch,
  color: string,
  palette: Palette,
): void {
  const { base, cursor } = sketch;
  if (base && cursor) {
    draw_arrow(context, view, base, sketch.heading_rad(), color);
    ring(context, to_pixels(view, base.x, base.y), 8, color);
  }
  const points = sketch.shown().flatMap(({ x, y }) => [x, y]);
  const closed = sketch.shape === "polygon" && points.length > 4;
  if (points.length >= 4) {
    trace_line(context, view, points, closed);
    if (closed) {
      context.fillStyle = color;
      context.globalAlpha = 0.15;
      context.fill();
      context.globalAlpha = 1;
    }
    context.strokeStyle = palette.halo;
    context.lineWidth = 6;
    context.stroke();
    context.strokeStyle = color;
    context.lineWidth = 3;
    context.stroke();
    draw_lengths(context, view, points, closed, palette);
  }
  for (const point of sketch.points) {
    ring(context, to_pixels(view, point.x, point.y), 5, color);
  }
}

/** Position of the next point. */
export function draw_cursor(
  context: CanvasRenderingContext2D,
  view: View,
  at: Point,
  snapped: boolean,
  palette: Palette,
): void {
  const [x, y] = to_pixels(view, at.x, at.y);
  context.beginPath();
  for (const [dx, dy] of [
    [1, 0],
    [-1, 0],
    [0, 1],
    [0, -1],
  ]) {
    context.moveTo(x + 4 * dx, y + 4 * dy);
    context.lineTo(x + 12 * dx, y + 12 * dy);
  }
  context.strokeStyle = palette.selected;
  context.lineWidth = 2;
  context.stroke();
  if (snapped) ring(context, [x, y], 9, palette.selected);
}

function ring(
  context: CanvasRenderingContext2D,
  at: [number, number],
  radius: number,
  color: string,
): void {
  context.beginPath();
  context.arc(...at, radius, 0, 2 * Math.PI);
  context.strokeStyle = color;
  context.lineWidth = 2;
  context.stroke();
}

function draw_lengths(
  context: CanvasRenderingContext2D,
  view: View,
  points: number[],
  closed: boolean,
  palette: Palette,
): void {
  const middle = middle_of(points);
  for (const [a, b] of segments_of(points, closed)) {
    const meters = distance(a, b);
    if (meters * view.scale < shortestLabelledPx) continue;
    const at = { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
    if (closed) {
      // Beside vertical sides, so that the inside stays free for the name.
      const upright = Math.abs(pixel_y(view, b.x, b.y) - pixel_y(view, a.x, a.y)) / (meters * view.scale);
      const side = Math.sign(pixel_x(view, at.x, at.y) - pixel_x(view, middle.x, middle.y));
      const shift = (side * upright * besidePx) / view.scale;
      at.x += shift * view.cos;
      at.y -= shift * view.sin;
    }
    draw_text(context, view, at, format.length(meters), palette);
  }
  if (closed && points.length >= 6 && Math.sqrt(area_of(points)) * view.scale > 90) {
    draw_text(context, view, middle, format.area(area_of(points)), palette);
  }
}

export function draw_text(
  context: CanvasRenderingContext2D,
  view: View,
  at: Point,
  text: string,
  palette: Palette,
): void {
  const [x, y] = to_pixels(view, at.x, at.y);
  context.font = labelFont;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = palette.halo;
  context.strokeText(text, x, y - 12);
  context.fillStyle = palette.label;
  context.fillText(text, x, y - 12);
}
