// Two local maps overlaid as a loop was matched, and their agreement.
import { LocalMap, Loop, Pose2 } from "../protocol";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { draw_body, draw_local_map, draw_points, ellipse_of } from "./robot_layer";
import { rotation, to_pixels } from "./to_pixels";

const nearM = 0.1; // between points of both maps on one wall

/** The composition of two poses: a and b as T_map_a, T_a_b. */
export function compose(a: Pose2, b: Pose2): Pose2 {
  const [cos, sin] = [Math.cos(a.theta_rad), Math.sin(a.theta_rad)];
  const theta = a.theta_rad + b.theta_rad;
  return {
    x_m: a.x_m + cos * b.x_m - sin * b.y_m,
    y_m: a.y_m + sin * b.x_m + cos * b.y_m,
    theta_rad: Math.atan2(Math.sin(theta), Math.cos(theta)),
  };
}

/** Distance between two poses of one frame: metres, radians. */
export function apart(a: Pose2, b: Pose2): [number, number] {
  const turn = b.theta_rad - a.theta_rad;
  return [
    Math.hypot(b.x_m - a.x_m, b.y_m - a.y_m),
    Math.abs(Math.atan2(Math.sin(turn), Math.cos(turn))),
  ];
}

function inside(polygon: number[], x: number, y: number): boolean {
  let is_inside = false;
  for (let i = 0, j = polygon.length - 2; i + 1 < polygon.length; j = i, i += 2) {
    const [xi, yi, xj, yj] = [polygon[i], polygon[i + 1], polygon[j], polygon[j + 1]];
    if (yi > y !== yj > y && x < xi + ((y - yi) * (xj - xi)) / (yj - yi)) is_inside = !is_inside;
  }
  return is_inside;
}

export interface Agreement {
  overlap: number; // share of the later stop's view that the earlier one could see
  near: number; // share of that within 0.1 m of the earlier view
}

/** T_earlier_later: as matched. Points are in the frames of their stops. */
export function agreement(earlier: LocalMap, later: LocalMap, T_earlier_later: Pose2): Agreement {
  const [laser_x, laser_y] = earlier.laser_m ?? [0, 0];
  const walls = earlier.points_m;
  const view = [laser_x, laser_y, ...walls];
  const [cos, sin] = [Math.cos(T_earlier_later.theta_rad), Math.sin(T_earlier_later.theta_rad)];
  let [all, seen, near] = [0, 0, 0];
  for (let i = 0; i + 1 < later.points_m.length; i += 2) {
    const [px, py] = [later.points_m[i], later.points_m[i + 1]];
    const x = T_earlier_later.x_m + cos * px - sin * py;
    const y = T_earlier_later.y_m + sin * px + cos * py;
    let least = Infinity;
    for (let k = 0; k + 1 < walls.length; k += 2) {
      least = Math.min(least, (walls[k] - x) ** 2 + (walls[k + 1] - y) ** 2);
    }
    ++all;
    const is_near = least <= nearM * nearM;
    if (!is_near && !inside(view, x, y)) continue;
    ++seen;
    if (is_near) ++near;
  }
  return { overlap: all > 0 ? seen / all : 0, near: seen > 0 ? near / seen : 0 };
}

/** An overlay: both maps and their poses on the map. */
export interface LaidMaps {
  loop: Loop;
  earlier: LocalMap;
  later: LocalMap;
  T_map_earlier: Pose2;
}

export function draw_laid_maps(
  context: CanvasRenderingContext2D,
  view: View,
  laid: LaidMaps,
  palette: Palette,
): void {
  const { loop, T_map_earlier } = laid;
  const matched = compose(T_map_earlier, loop);
  context.globalAlpha = 0.75; // fades what lies below
  context.fillStyle = palette.free;
  context.fillRect(0, 0, view.width, view.height);
  context.globalAlpha = 1;
  draw_local_map(context, view, { ...laid.earlier, ...T_map_earlier }, palette.earlier);
  draw_local_map(context, view, { ...laid.later, ...matched }, palette.later);
  if (loop.predicted) draw_prediction(context, view, laid, matched, palette);
  const at = (pose: Pose2) => ({ x: pose.x_m, y: pose.y_m, theta: pose.theta_rad });
  draw_body(context, view, at(T_map_earlier), palette.earlier, palette);
  draw_body(context, view, at(matched), palette.later, palette);
}

// The predicted place of the later stop, with 2 sigma, and a line from there to the match.
function draw_prediction(
  context: CanvasRenderingContext2D,
  view: View,
  { loop, later, T_map_earlier }: LaidMaps,
  matched: Pose2,
  palette: Palette,
): void {
  const predicted = compose(T_map_earlier, loop.predicted ?? loop);
  context.globalAlpha = 0.4;
  const { x_m, y_m, theta_rad } = predicted;
  draw_points(context, view, later.points_m, x_m, y_m, theta_rad, palette.label);
  context.globalAlpha = 1;
  const [x, y] = to_pixels(view, x_m, y_m);
  context.strokeStyle = palette.label;
  context.lineWidth = 1.5;
  context.setLineDash([5, 4]);
  const ellipse = ellipse_of(loop.predicted?.covariance ?? []);
  if (ellipse) {
    const [a, b] = [2 * ellipse[0] * view.scale, 2 * ellipse[1] * view.scale];
    context.beginPath();
    const turn = rotation(view, ellipse[2] + T_map_earlier.theta_rad);
    context.ellipse(x, y, Math.max(1, a), Math.max(1, b), turn, 0, 2 * Math.PI);
    context.stroke();
  }
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(...to_pixels(view, matched.x_m, matched.y_m));
  context.stroke();
  context.setLineDash([]);
}
