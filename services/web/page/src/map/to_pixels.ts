import { View } from "./map_canvas";

/** A point of the map frame (metres) on the canvas. */
export function to_pixels(view: View, x: number, y: number): [number, number] {
  return [view.scale * x + view.offset_x, view.offset_y - view.scale * y];
}
