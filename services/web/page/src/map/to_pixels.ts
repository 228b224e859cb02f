import { View } from "./map_canvas";

/** A point of the map frame (metres) on the canvas. */
export function to_pixels(view: View, x: number, y: number): [number, number] {
  return [pixel_x(view, x, y), pixel_y(view, x, y)];
}

export function pixel_x(view: View, x: number, y: number): number {
  return view.scale * (view.cos * x - view.sin * y) + view.offset_x;
}

export function pixel_y(view: View, x: number, y: number): number {
  return view.offset_y - view.scale * (view.sin * x + view.cos * y);
}

/** The angle of context.rotate() for a direction in the map frame. */
export function rotation(view: View, theta: number): number {
  return -(theta + view.turn_rad);
}

/** Draws a picture whose upper left corner lies at a point of the map frame; width and height in metres. */
export function draw_picture(
  context: CanvasRenderingContext2D,
  view: View,
  picture: CanvasImageSource,
  at: { x: number; y: number; width: number; height: number },
): void {
  context.save();
  context.translate(...to_pixels(view, at.x, at.y));
  context.rotate(rotation(view, 0));
  context.drawImage(picture, 0, 0, view.scale * at.width, view.scale * at.height);
  context.restore();
}
