// The search of the localizer: the search space (rectangle), the predicted pose (ellipse), and the
// solutions found (hypotheses, the darker the fitter).
import { Hypothesis, Search, SearchedMatch } from "../protocol";
import { Palette } from "../ui/theme";
import { draw_label, Label } from "./label_layer";
import { View } from "./map_canvas";
import { ellipse_of } from "./robot_layer";
import { rotation, to_pixels } from "./to_pixels";

const sigmas = 2;
const arrowPx = 16;
const mostLabelled = 3; // hypotheses with fitness numbers

export function draw_search(
  context: CanvasRenderingContext2D,
  view: View,
  search: Search,
  palette: Palette,
): void {
  for (const match of search.matches) draw_match(context, view, match, palette);
  draw_hypotheses(context, view, search.hypotheses, palette);
  draw_figures(context, view, search, palette);
}

function draw_match(
  context: CanvasRenderingContext2D,
  view: View,
  match: SearchedMatch,
  palette: Palette,
): void {
  const [x, y] = to_pixels(view, match.x_m, match.y_m);
  context.save();
  context.translate(x, y);
  context.rotate(rotation(view, match.base_theta_rad));
  context.strokeStyle = palette.search;
  context.lineWidth = 1.5;
  context.setLineDash([6, 4]);
  const [width, height] = [match.half_widths[0] * view.scale, match.half_widths[1] * view.scale];
  context.strokeRect(-width, -height, 2 * width, 2 * height);
  context.setLineDash([]);
  const ellipse = ellipse_of(match.covariance);
  if (ellipse) {
    context.beginPath();
    const [a, b] = [sigmas * ellipse[0] * view.scale, sigmas * ellipse[1] * view.scale];
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
  for (const [x_m, y_m, theta, fitness] of hypotheses) {
    const [x, y] = to_pixels(view, x_m, y_m);
    context.globalAlpha = 0.25 + 0.75 * Math.max(0, Math.min(1, fitness ?? 0));
    context.strokeStyle = palette.search;
    context.fillStyle = palette.search;
    context.beginPath();
    context.arc(x, y, 4, 0, 2 * Math.PI);
    context.fill();
    context.beginPath();
    context.moveTo(x, y);
    const angle = rotation(view, theta);
    context.lineTo(x + arrowPx * Math.cos(angle), y + arrowPx * Math.sin(angle));
    context.stroke();
  }
  context.globalAlpha = 1;
}

// Numbers of the fittest hypotheses of each search; a number that would cover a better one is left
// out.
function draw_figures(
  context: CanvasRenderingContext2D,
  view: View,
  search: Search,
  palette: Palette,
): void {
  context.font = "bold 12px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  const fitness_of = ([, , , fitness]: Hypothesis) => fitness ?? -1;
  const labelled = [search.hypotheses, ...search.matches.map((match) => match.hypotheses)]
    .flatMap((hypotheses) => hypotheses.slice(0, mostLabelled))
    .filter((hypothesis) => fitness_of(hypothesis) >= 0)
    .sort((a, b) => fitness_of(b) - fitness_of(a));
  const drawn: Label[] = [];
  for (const hypothesis of labelled) {
    const [x, y] = to_pixels(view, hypothesis[0], hypothesis[1]);
    const text = fitness_of(hypothesis).toFixed(2);
    const width = context.measureText(text).width;
    draw_label(context, { text, x: x + 8 + width / 2, y: y + 12, width }, drawn, palette);
  }
}
