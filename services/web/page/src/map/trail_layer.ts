// Stops of the corrected trajectory, and the loops closed between them.
import { Loop, Tables } from "../protocol";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { to_pixels } from "./to_pixels";

const chunkStops = 32;

export class TrailLayer {
  private chunks = new Map<number, Tables["trail"]>();

  clear(): void {
    this.chunks.clear();
  }

  set_chunk(number: number, stops: Tables["trail"]): void {
    this.chunks.set(number, stops);
  }

  remove_chunk(number: number): void {
    this.chunks.delete(number);
  }

  /** Number of stops. */
  size(): number {
    let stops = 0;
    for (const [number, chunk] of this.chunks) {
      stops = Math.max(stops, chunkStops * number + chunk.length);
    }
    return stops;
  }

  /** x, y (metres), theta (radians) of a stop; null when its pose is not known. */
  stop(number: number): [number, number, number] | null {
    return this.chunks.get(Math.floor(number / chunkStops))?.[number % chunkStops] ?? null;
  }

  draw(context: CanvasRenderingContext2D, view: View, palette: Palette): void {
    context.strokeStyle = palette.trail;
    context.lineWidth = 1.6;
    context.lineJoin = "round";
    context.beginPath();
    let pen_down = false;
    const numbers = [...this.chunks.keys()].sort((a, b) => a - b);
    for (const number of numbers) {
      for (const stop of this.chunks.get(number) ?? []) {
        if (!stop) {
          pen_down = false;
          continue;
        }
        const [x, y] = to_pixels(view, stop[0], stop[1]);
        if (pen_down) context.lineTo(x, y);
        else context.moveTo(x, y);
        pen_down = true;
      }
    }
    context.stroke();
  }

  /**
   * Lines between the stops of accepted loops; the chosen loop is thick, even if it was rejected.
   */
  draw_loops(
    context: CanvasRenderingContext2D,
    view: View,
    loops: Iterable<Loop>,
    chosen: Loop | null,
    palette: Palette,
  ): void {
    context.strokeStyle = palette.loop;
    context.lineWidth = 1.5;
    context.beginPath();
    for (const loop of loops) {
      if (loop.accepted) this.trace_loop(context, view, loop);
    }
    context.stroke();
    if (!chosen) return;
    context.beginPath();
    this.trace_loop(context, view, chosen);
    context.lineWidth = 4;
    if (!chosen.accepted) context.setLineDash([7, 6]);
    context.stroke();
    context.setLineDash([]);
    for (const number of [chosen.earlier, chosen.later]) {
      const stop = this.stop(number);
      if (!stop) continue;
      context.beginPath();
      context.arc(...to_pixels(view, stop[0], stop[1]), 7, 0, 2 * Math.PI);
      context.fillStyle = palette.loop;
      context.fill();
      context.strokeStyle = palette.halo;
      context.lineWidth = 2;
      context.stroke();
      context.strokeStyle = palette.loop;
    }
  }

  private trace_loop(context: CanvasRenderingContext2D, view: View, loop: Loop): void {
    const [from, to] = [this.stop(loop.earlier), this.stop(loop.later)];
    if (!from || !to) return;
    context.moveTo(...to_pixels(view, from[0], from[1]));
    context.lineTo(...to_pixels(view, to[0], to[1]));
  }
}
