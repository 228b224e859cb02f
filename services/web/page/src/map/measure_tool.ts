// Measures a distance on the map: from a press to its release, or between two taps.
import { length } from "../format";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { MapPointer, MapTool } from "./map_tool";
import { to_pixels } from "./to_pixels";

export class MeasureTool implements MapTool {
  private from: MapPointer | null = null;
  private to: MapPointer | null = null;
  private fixed = true; // the second point is set

  /** on_change: gets the length, metres; null: there is none yet. */
  constructor(private readonly on_change: (meters: number | null) => void) {}

  press(at: MapPointer): boolean {
    if (this.fixed) {
      this.from = at;
      this.fixed = false;
    }
    this.pass_on(at);
    return true;
  }

  move(at: MapPointer): void {
    if (!this.fixed) this.pass_on(at);
  }

  lift(at: MapPointer): void {
    this.pass_on(at);
    if (this.meters() > 0 && !(at.tapped && this.is_first_tap())) this.fixed = true;
  }

  cancel(): void {
    this.from = this.to = null;
    this.fixed = true;
    this.on_change(null);
  }

  draw(context: CanvasRenderingContext2D, view: View, palette: Palette): void {
    if (!this.from || !this.to) return;
    const [x0, y0] = to_pixels(view, this.from.x, this.from.y);
    const [x1, y1] = to_pixels(view, this.to.x, this.to.y);
    for (const [width, color] of [[6, palette.halo], [3, palette.selected]] as const) {
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      context.lineWidth = width;
      context.strokeStyle = color;
      context.stroke();
    }
    context.font = "bold 14px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "bottom";
    context.lineWidth = 4;
    context.strokeStyle = palette.halo;
    const text = length(this.meters());
    const [x, y] = [(x0 + x1) / 2, (y0 + y1) / 2 - 6];
    context.strokeText(text, x, y);
    context.fillStyle = palette.selected;
    context.fillText(text, x, y);
  }

  private is_first_tap(): boolean {
    return this.from === null || this.meters() * this.from.pixels_per_m < 8;
  }

  private meters(): number {
    if (!this.from || !this.to) return 0;
    return Math.hypot(this.to.x - this.from.x, this.to.y - this.from.y);
  }

  private pass_on(at: MapPointer): void {
    if (!this.from) return;
    this.to = at;
    this.on_change(this.meters());
  }
}
