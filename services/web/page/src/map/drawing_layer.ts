// The drawing, with a style of its own: hatched zones, thick walls, gaps and leaves of doors.
import { Drawing, DrawnDoor, DrawnLine, DrawnPlace, DrawnZone, ItemRef } from "../draw/drawing";
import { heading_of } from "../draw/grab";
import { middle_of } from "../draw/geometry";
import { Rule } from "../protocol";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { rotation, to_pixels } from "./to_pixels";

const hatchPx = 11;
const noGoShade = 0.35;
const otherShade = 0.15;
/** Length of arrows at every zoom. */
export const arrowPx = 30;
const stationPx = 11;

export function trace_line(
  context: CanvasRenderingContext2D,
  view: View,
  points: number[],
  closed: boolean,
): void {
  context.beginPath();
  for (let i = 0; i + 1 < points.length; i += 2) {
    context.lineTo(...to_pixels(view, points[i], points[i + 1]));
  }
  if (closed) context.closePath();
}

export function zone_color(kind: DrawnZone["kind"], palette: Palette): string {
  const { no_go, slow, one_way, preferred, drawn } = palette;
  return { no_go, slow, one_way, preferred, room: drawn }[kind];
}

/** selected: drawn stronger. zones: whether to draw zones with a rule, too. */
export function draw_drawing(
  context: CanvasRenderingContext2D,
  view: View,
  drawing: Drawing,
  palette: Palette,
  selected: ItemRef | null = null,
  zones = true,
): void {
  context.save();
  context.lineJoin = "round";
  context.lineCap = "round";
  const is_selected = (list: ItemRef["list"], index: number) =>
    selected?.list === list && selected.index === index;
  drawing.zones.forEach((zone, i) => {
    if (zones || zone.kind === "room") {
      draw_zone(context, view, zone, palette, is_selected("zones", i));
    }
  });
  drawing.walls.forEach((wall, i) => {
    const width = is_selected("walls", i) ? 7 : 5;
    stroke(context, view, wall, palette.halo, width + 4);
    stroke(context, view, wall, palette.drawn, width);
  });
  drawing.openings.forEach((gap, i) => {
    draw_gap(context, view, gap, palette, is_selected("openings", i));
  });
  drawing.doors.forEach((door, i) => {
    draw_door(context, view, door, palette, is_selected("doors", i));
  });
  for (const place of drawing.places) draw_place(context, view, place, palette);
  context.restore();
}

/** Zones with a rule that the robot obeys; never hidden. */
export function draw_rules(
  context: CanvasRenderingContext2D,
  view: View,
  rules: Iterable<Rule>,
  palette: Palette,
): void {
  context.save();
  context.lineJoin = "round";
  context.lineCap = "round";
  for (const rule of rules) {
    draw_zone(context, view, { ...rule, name: "", value: rule.value ?? 0 }, palette, false);
  }
  context.restore();
}

function stroke(
  context: CanvasRenderingContext2D,
  view: View,
  line: DrawnLine,
  color: string,
  width: number,
): void {
  trace_line(context, view, line.points_m, false);
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
}

function draw_zone(
  context: CanvasRenderingContext2D,
  view: View,
  zone: DrawnZone,
  palette: Palette,
  selected: boolean,
): void {
  const color = zone_color(zone.kind, palette);
  trace_line(context, view, zone.corners_m, true);
  if (zone.kind !== "room") {
    context.fillStyle = color;
    // Stronger where the robot must not go, so that it stands out on coloured rooms.
    const shade = zone.kind === "no_go" ? noGoShade : otherShade;
    context.globalAlpha = shade + (selected ? 0.15 : 0);
    context.fill();
    hatch(context, view, zone.corners_m, color, zone.kind === "no_go" ? 0.9 : 0.5);
    context.globalAlpha = 1;
  }
  trace_line(context, view, zone.corners_m, true);
  if (zone.kind !== "room") {
    context.strokeStyle = palette.halo;
    context.lineWidth = 5;
    context.stroke();
  }
  context.strokeStyle = color;
  context.lineWidth = selected ? 3 : 2;
  if (zone.kind === "room") context.setLineDash([10, 5, 2, 5]);
  context.stroke();
  context.setLineDash([]);
  const angle = heading_of(zone);
  if (angle !== null) draw_arrow(context, view, middle_of(zone.corners_m), angle, color);
}

// Lines at 45 degrees within the zone.
function hatch(
  context: CanvasRenderingContext2D,
  view: View,
  corners: number[],
  color: string,
  alpha: number,
): void {
  let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i + 1 < corners.length; i += 2) {
    const [x, y] = to_pixels(view, corners[i], corners[i + 1]);
    [left, right] = [Math.min(left, x), Math.max(right, x)];
    [top, bottom] = [Math.min(top, y), Math.max(bottom, y)];
  }
  [left, right] = [Math.max(left, 0), Math.min(right, view.width)];
  [top, bottom] = [Math.max(top, 0), Math.min(bottom, view.height)];
  if (left >= right || top >= bottom) return;
  context.save();
  context.clip();
  context.beginPath();
  const first = hatchPx * Math.floor((left - (bottom - top)) / hatchPx);
  for (let x = first; x < right; x += hatchPx) {
    context.moveTo(x, bottom);
    context.lineTo(x + (bottom - top), top);
  }
  context.strokeStyle = color;
  context.lineWidth = 1.5;
  context.globalAlpha = alpha;
  context.stroke();
  context.restore();
}

/** An arrow from a point, of the same length at every zoom. */
export function draw_arrow(
  context: CanvasRenderingContext2D,
  view: View,
  at: { x: number; y: number },
  angle: number,
  color: string,
): void {
  context.save();
  context.translate(...to_pixels(view, at.x, at.y));
  context.rotate(rotation(view, angle));
  context.beginPath();
  context.moveTo(0, 0);
  context.lineTo(arrowPx, 0);
  context.moveTo(arrowPx - 9, -7);
  context.lineTo(arrowPx, 0);
  context.lineTo(arrowPx - 9, 7);
  context.strokeStyle = color;
  context.lineWidth = 3.5;
  context.stroke();
  context.restore();
}

// An open stretch: two posts, and the gap between them.
function draw_gap(
  context: CanvasRenderingContext2D,
  view: View,
  gap: DrawnLine,
  palette: Palette,
  selected: boolean,
): void {
  stroke(context, view, gap, palette.free, selected ? 10 : 8);
  context.setLineDash([2, 7]);
  stroke(context, view, gap, palette.drawn, selected ? 4 : 3);
  context.setLineDash([]);
  draw_posts(context, view, gap, palette.drawn);
}

// The leaf and its swing, as on architects' plans.
function draw_door(
  context: CanvasRenderingContext2D,
  view: View,
  door: DrawnDoor,
  palette: Palette,
  selected: boolean,
): void {
  stroke(context, view, door, palette.free, selected ? 10 : 8);
  const [ax, ay] = to_pixels(view, door.points_m[0], door.points_m[1]);
  const [bx, by] = to_pixels(view, door.points_m[2], door.points_m[3]);
  const angle = Math.atan2(by - ay, bx - ax);
  const width = Math.hypot(bx - ax, by - ay);
  context.beginPath();
  context.arc(ax, ay, width, angle - Math.PI / 2, angle);
  context.moveTo(ax, ay);
  context.lineTo(ax + width * Math.sin(angle), ay - width * Math.cos(angle));
  context.strokeStyle = palette.nodes.door;
  context.lineWidth = selected ? 3.5 : 2;
  context.stroke();
  draw_posts(context, view, door, palette.nodes.door);
}

function draw_posts(
  context: CanvasRenderingContext2D,
  view: View,
  line: DrawnLine,
  color: string,
): void {
  context.fillStyle = color;
  for (let i = 0; i + 1 < line.points_m.length; i += 2) {
    const [x, y] = to_pixels(view, line.points_m[i], line.points_m[i + 1]);
    context.fillRect(x - 4, y - 4, 8, 8);
  }
}

function draw_place(
  context: CanvasRenderingContext2D,
  view: View,
  place: DrawnPlace,
  palette: Palette,
): void {
  const [x, y] = to_pixels(view, place.x_m, place.y_m);
  if (place.heading_rad !== undefined) {
    draw_arrow(context, view, { x: place.x_m, y: place.y_m }, place.heading_rad, palette.goal);
    context.fillStyle = palette.goal;
    context.fillRect(x - stationPx, y - stationPx, 2 * stationPx, 2 * stationPx);
    context.strokeStyle = palette.halo;
    context.lineWidth = 2;
    context.strokeRect(x - stationPx, y - stationPx, 2 * stationPx, 2 * stationPx);
    return;
  }
  context.beginPath();
  context.arc(x, y, 6, 0, 2 * Math.PI);
  context.fillStyle = palette.goal;
  context.fill();
  context.strokeStyle = palette.halo;
  context.lineWidth = 2;
  context.stroke();
}
