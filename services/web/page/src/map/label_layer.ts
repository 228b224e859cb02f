// Names of rooms, places and zones with a rule, on the map.
import { PointM, Room, Rule } from "../protocol";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { to_pixels } from "./to_pixels";

const labelFont = "13px system-ui, sans-serif";
const linePx = 17; // from one name to the next one below
const goalPx = 14; // from the middle of a goal's ring to the names
const besideGoalPx = 24; // from there to the middle of a name above or below

export interface Label {
  text: string;
  x: number; // pixels, of its middle
  y: number;
  width: number;
}

/**
 * Places first, then zones, then large rooms. A name that would cover another is left out; one
 * under a goal moves above or below it.
 */
export function draw_labels(
  context: CanvasRenderingContext2D,
  view: View,
  names: {
    rooms: Iterable<Room>;
    places: ReadonlyMap<string, PointM>;
    rules: ReadonlyMap<string, Rule>;
    goals: readonly PointM[];
  },
  palette: Palette,
): void {
  const { rooms, places, rules } = names;
  const goals = names.goals.map((goal) => to_pixels(view, goal.x_m, goal.y_m));
  context.font = labelFont;
  context.textAlign = "center";
  context.textBaseline = "middle";
  const drawn: Label[] = [];
  const draw_name = (label: Label) => {
    label.width = context.measureText(label.text).width;
    keep_off(label, goals);
    draw_label(context, label, drawn, palette);
  };
  for (const [name, place] of places) {
    const [x, y] = to_pixels(view, place.x_m, place.y_m);
    draw_pin(context, x, y, palette);
    draw_name({ text: name, x, y: y - 15, width: 0 });
  }
  for (const [name, rule] of rules) {
    const [x, y] = to_pixels(view, ...middle(rule.corners_m));
    draw_name({ text: name, x, y, width: 0 });
  }
  const by_area = [...rooms].sort((a, b) => b.area_m2 - a.area_m2);
  for (const room of by_area) {
    if (room.name === "") continue;
    if (Math.sqrt(room.area_m2) * view.scale < 34) continue;
    const [x, y] = to_pixels(view, room.x_m, room.y_m);
    draw_name({ text: room.name, x, y, width: 0 });
  }
}

function middle(corners: number[]): [number, number] {
  let [x, y] = [0, 0];
  for (let i = 0; i + 1 < corners.length; i += 2) {
    x += corners[i];
    y += corners[i + 1];
  }
  const count = Math.max(1, corners.length / 2);
  return [x / count, y / count];
}

function draw_pin(context: CanvasRenderingContext2D, x: number, y: number, palette: Palette): void {
  context.beginPath();
  context.arc(x, y, 4.5, 0, 2 * Math.PI);
  context.fillStyle = palette.goal;
  context.fill();
  context.strokeStyle = palette.halo;
  context.lineWidth = 2;
  context.stroke();
}

// Goals are drawn above the names, which would be hidden there.
function keep_off(label: Label, goals: readonly (readonly [number, number])[]): void {
  const covering = goals.find(
    ([x, y]) =>
      Math.abs(label.x - x) < label.width / 2 + goalPx &&
      Math.abs(label.y - y) < linePx / 2 + goalPx,
  );
  if (!covering) return;
  const [, y] = covering;
  label.y = label.y < y - 1 ? y - besideGoalPx : y + besideGoalPx;
}

/** Draws text of this width in the context's font, unless it would cover one in `drawn`. */
export function draw_label(
  context: CanvasRenderingContext2D,
  label: Label,
  drawn: Label[],
  palette: Palette,
): void {
  const covers = (other: Label) =>
    Math.abs(label.x - other.x) < (label.width + other.width) / 2 + 6 &&
    Math.abs(label.y - other.y) < linePx;
  if (drawn.some(covers)) return;
  drawn.push(label);
  context.lineJoin = "round";
  context.lineWidth = 3.5;
  context.strokeStyle = palette.halo;
  context.strokeText(label.text, label.x, label.y);
  context.fillStyle = palette.label;
  context.fillText(label.text, label.x, label.y);
}
