// The search of the localizer: where it looks (rectangle), where the poses expect the robot (ellipse),
// and what it has found (hypotheses, the darker the fitter).
import { Search, SearchedMatch } from "../protocol";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { ellipse_of } from "./robot_layer";

const kSigmas = 2;
const kArrowPx = 16;
const kLabelled = 3; // hypotheses with their fitness in numbers

export function draw_search(
  context: CanvasRenderingContext2D,
  view: View,
  search: Search,
  palette: Palette,
): void {
  for (const match of search.matches) draw_match(context, view, match, palette);
  draw_hypotheses(context, view, search.hypotheses, palette);
}

function draw_match(
  context: CanvasRenderingContext2D,
  view: View,
  match: SearchedMatch,
  palette: Palette,
): void {
  const [x, y] = [view.scale * match.x_m + view.offset_x, view.offset_y - view.scale * match.y_m];
  context.save();
  context.translate(x, y);
  context.rotate(-match.base_theta_rad);
  context.strokeStyle = palette.search;
  context.lineWidth = 1.5;
  context.setLineDash([6, 4]);
  const [width, height] = [match.half_widths[0] * view.scale, match.half_widths[1] * view.scale];
  context.strokeRect(-width, -height, 2 * width, 2 * height);
  context.setLineDash([]);
  const ellipse = ellipse_of(match.covariance);
  if (ellipse) {
    context.beginPath();
    const [a, b] = [kSigmas * ellipse[0] * view.scale, kSigmas * ellipse[1] * view.scale];
    context.ellipse(0, 0, Math.max(1, a), Math.max(1, b), -ellipse[2], 0, 2 * Math.PI);
    context.globalAlpha = 0.15;
    context.fillStyle = palette.search;
    context.fill();
    context.globalAlpha = 1;
    context.stroke();
  }
  context.restore();
  draw_hypotheses(context, view, match.hypotheses, palette);
}

function draw_hypotheses(
  context: CanvasRenderingContext2D,
  view: View,
  hypotheses: Search["hypotheses"],
  palette: Palette,
): void {
  context.lineWidth = 2.5;
  context.font = "bold 12px system-ui, sans-serif";
  context.textAlign = "left";
  context.textBaseline = "middle";
  hypotheses.forEach(([x_m, y_m, theta, fitness], i) => {
    const [x, y] = [view.scale * x_m + view.offset_x, view.offset_y - view.scale * y_m];
    context.globalAlpha = 0.25 + 0.75 * Math.max(0, Math.min(1, fitness ?? 0));
    context.strokeStyle = palette.search;
    context.fillStyle = palette.search;
    context.beginPath();
    context.arc(x, y, 4, 0, 2 * Math.PI);
    context.fill();
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + kArrowPx * Math.cos(theta), y - kArrowPx * Math.sin(theta));
    context.stroke();
    context.globalAlpha = 1;
    if (i >= kLabelled || fitness === null) return;
    const text = fitness.toFixed(2);
    context.strokeStyle = palette.halo;
    context.strokeText(text, x + 8, y + 12);
    context.fillStyle = palette.label;
    context.fillText(text, x + 8, y + 12);
  });
}
