// The moving objects: the robot with its covariance ellipse, its scan, its route and its goals.
import { LocalMap, Pose, Scan } from "../protocol";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { rotation, to_pixels } from "./to_pixels";

const bodyRadiusM = 0.27;
const smallestBodyPx = 9;
const sigmas = 2; // of the ellipse

export interface PoseMark {
  x: number; // metres, map frame
  y: number;
  theta: number; // radians
}

/**
 * Half axes (metres) and direction (radians) of a covariance ellipse; null for an invalid
 * covariance.
 */
export function ellipse_of(covariance: (number | null)[]): [number, number, number] | null {
  const [xx, xy, , , yy] = covariance;
  if (typeof xx !== "number" || typeof xy !== "number" || typeof yy !== "number") return null;
  const middle = (xx + yy) / 2;
  const spread = Math.hypot((xx - yy) / 2, xy);
  if (!(middle >= 0)) return null;
  return [
    Math.sqrt(Math.max(0, middle + spread)),
    Math.sqrt(Math.max(0, middle - spread)),
    Math.atan2(2 * xy, xx - yy) / 2,
  ];
}

export function draw_robot(
  context: CanvasRenderingContext2D,
  view: View,
  pose: Pose,
  palette: Palette,
  color: string,
): void {
  const [x, y] = to_pixels(view, pose.x_m, pose.y_m);
  const ellipse = ellipse_of(pose.covariance);
  if (ellipse) {
    context.beginPath();
    const [a, b] = [sigmas * ellipse[0] * view.scale, sigmas * ellipse[1] * view.scale];
    context.ellipse(x, y, Math.max(1, a), Math.max(1, b), rotation(view, ellipse[2]), 0, 2 * Math.PI);
    context.globalAlpha = 0.22;
    context.fillStyle = color;
    context.fill();
    context.globalAlpha = 1;
    context.strokeStyle = color;
    context.lineWidth = 1.5;
    context.stroke();
  }
  const at = { x: pose.x_m, y: pose.y_m, theta: pose.theta_rad };
  draw_body(context, view, at, color, palette, pose.footprint_m);
}

/** A body with its heading: round, or with an outline (robot frame, metres). */
export function draw_body(
  context: CanvasRenderingContext2D,
  view: View,
  at: PoseMark,
  color: string,
  palette: Palette,
  footprint_m: [number, number][] = [],
): void {
  const [x, y] = to_pixels(view, at.x, at.y);
  const radius = Math.max(smallestBodyPx, bodyRadiusM * view.scale);
  context.save();
  context.translate(x, y);
  context.rotate(rotation(view, at.theta));
  context.beginPath();
  if (footprint_m.length > 2 && bodyRadiusM * view.scale >= smallestBodyPx) {
    for (const [ahead, left] of footprint_m) context.lineTo(ahead * view.scale, -left * view.scale);
    context.closePath();
  } else {
    context.arc(0, 0, radius, 0, 2 * Math.PI);
  }
  context.fillStyle = color;
  context.fill();
  context.strokeStyle = palette.robot_edge;
  context.lineWidth = 2;
  context.stroke();
  context.beginPath();
  context.moveTo(0.68 * radius, 0);
  context.lineTo(-0.42 * radius, 0.5 * radius);
  context.lineTo(-0.16 * radius, 0);
  context.lineTo(-0.42 * radius, -0.5 * radius);
  context.closePath();
  context.fillStyle = palette.robot_edge;
  context.fill();
  context.restore();
}

export function draw_scan(
  context: CanvasRenderingContext2D,
  view: View,
  scan: Scan,
  palette: Palette,
): void {
  if (scan.x_m === undefined || scan.y_m === undefined || scan.theta_rad === undefined) return;
  draw_points(context, view, scan.points_robot_m, scan.x_m, scan.y_m, scan.theta_rad, palette.scan);
}

/** Points of a scan, in the frame of a robot at this pose. */
export function draw_points(
  context: CanvasRenderingContext2D,
  view: View,
  points: number[],
  x_m: number,
  y_m: number,
  theta: number,
  color: string,
): void {
  const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
  const size = view.scale > 40 ? 3 : 2;
  context.fillStyle = color;
  for (let i = 0; i + 1 < points.length; i += 2) {
    const [x, y] = to_pixels(
      view,
      x_m + cos * points[i] - sin * points[i + 1],
      y_m + sin * points[i] + cos * points[i + 1],
    );
    context.fillRect(x - size / 2, y - size / 2, size, size);
  }
}

/** points: x, y of each, metres. The line has an edge, so that it is visible on any ground. */
export function draw_route(
  context: CanvasRenderingContext2D,
  view: View,
  points: number[],
  palette: Palette,
  dashed: boolean,
): void {
  if (points.length < 4) return;
  context.lineJoin = "round";
  context.lineCap = "round";
  context.beginPath();
  for (let i = 0; i + 1 < points.length; i += 2) {
    context.lineTo(...to_pixels(view, points[i], points[i + 1]));
  }
  context.strokeStyle = palette.route_edge;
  context.lineWidth = 7;
  context.stroke();
  context.strokeStyle = palette.route;
  context.lineWidth = 4;
  if (dashed) context.setLineDash([9, 8]);
  context.stroke();
  context.setLineDash([]);
}

/** An arrow at a goal in the direction in which the robot will look. */
export function draw_heading(
  context: CanvasRenderingContext2D,
  view: View,
  x_m: number,
  y_m: number,
  theta: number,
  palette: Palette,
): void {
  const [x, y] = to_pixels(view, x_m, y_m);
  const angle = theta + view.turn_rad;
  const at = (along: number, left: number): [number, number] => [
    x + along * Math.cos(angle) - left * Math.sin(angle),
    y - along * Math.sin(angle) - left * Math.cos(angle),
  ];
  context.beginPath();
  context.moveTo(...at(26, 0));
  context.lineTo(...at(13, 8));
  context.lineTo(...at(13, -8));
  context.closePath();
  context.fillStyle = palette.goal;
  context.fill();
}

/** A goal of the robot: a ring with a point; number: position in a sequence. */
export function draw_goal(
  context: CanvasRenderingContext2D,
  view: View,
  x_m: number,
  y_m: number,
  palette: Palette,
  number = "",
): void {
  const [x, y] = to_pixels(view, x_m, y_m);
  context.beginPath();
  context.arc(x, y, 11, 0, 2 * Math.PI);
  context.fillStyle = number ? palette.goal : palette.halo;
  context.fill();
  context.lineWidth = 3;
  context.strokeStyle = palette.goal;
  context.stroke();
  if (number) {
    context.font = "bold 13px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = palette.halo;
    context.fillText(number, x, y + 0.5);
  } else {
    context.beginPath();
    context.arc(x, y, 4, 0, 2 * Math.PI);
    context.fillStyle = palette.goal;
    context.fill();
  }
}

/** The local Voronoi diagram of a stop, and the scan points behind it. */
export function draw_local_map(
  context: CanvasRenderingContext2D,
  view: View,
  local: LocalMap,
  color: string,
): void {
  if (local.x_m === undefined || local.y_m === undefined || local.theta_rad === undefined) return;
  const { x_m, y_m, theta_rad } = local;
  const [cos, sin] = [Math.cos(theta_rad), Math.sin(theta_rad)];
  const place = (x: number, y: number) =>
    to_pixels(view, x_m + cos * x - sin * y, y_m + sin * x + cos * y);
  draw_points(context, view, local.points_m, x_m, y_m, theta_rad, color);
  context.strokeStyle = color;
  context.lineWidth = 2.5;
  context.beginPath();
  for (const branch of local.branches) {
    for (let i = 0; i + 1 < branch.length; i += 2) {
      const at = place(branch[i], branch[i + 1]);
      if (i === 0) context.moveTo(...at);
      else context.lineTo(...at);
    }
  }
  context.stroke();
  context.fillStyle = color;
  for (const [x, y] of local.nodes) {
    context.beginPath();
    context.arc(...place(x, y), 4, 0, 2 * Math.PI);
    context.fill();
  }
}
