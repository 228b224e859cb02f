// The picture of a plan behind the drawing, placed by two points of known distance. The picture is
// not sent to the service.
import { View } from "../map/map_canvas";
import { rotation, to_pixels } from "../map/to_pixels";
import { distance, heading, Point } from "./geometry";

/** Placement of a picture: its upper left corner, and the size of its pixels. */
export interface Placement {
  x_m: number; // upper left corner, map frame
  y_m: number;
  metres_per_pixel: number;
  angle_rad: number; // direction of its rows, counter-clockwise
}

const firstWidthM = 20;
const straightRad = 0.15; // largest rotation that is taken for a plan scanned slightly askew

/** Places a picture of this size in pixels around a point, until two points of it are measured. */
export function first_placement(width: number, height: number, centre: Point): Placement {
  const metres_per_pixel = firstWidthM / width;
  return {
    x_m: centre.x - (width * metres_per_pixel) / 2,
    y_m: centre.y + (height * metres_per_pixel) / 2,
    metres_per_pixel,
    angle_rad: 0,
  };
}

/**
 * Scales the picture so that the present distance from a to b becomes distance_m; a stays in place.
 * A line that is nearly parallel to an axis is rotated onto it.
 */
export function measured(at: Placement, a: Point, b: Point, distance_m: number): Placement {
  const factor = distance_m / distance(a, b);
  const angle = heading(a, b);
  const axis = (Math.PI / 2) * Math.round(angle / (Math.PI / 2));
  const turn = Math.abs(axis - angle) <= straightRad ? axis - angle : 0;
  const [cos, sin] = [factor * Math.cos(turn), factor * Math.sin(turn)];
  const [dx, dy] = [at.x_m - a.x, at.y_m - a.y];
  return {
    x_m: a.x + cos * dx - sin * dy,
    y_m: a.y + sin * dx + cos * dy,
    metres_per_pixel: at.metres_per_pixel * factor,
    angle_rad: at.angle_rad + turn,
  };
}

export class Background {
  placement: Placement;
  opacity = 0.5;

  constructor(
    private readonly picture: ImageBitmap,
    centre: Point,
  ) {
    this.placement = first_placement(picture.width, picture.height, centre);
  }

  draw(context: CanvasRenderingContext2D, view: View): void {
    const { x_m, y_m, metres_per_pixel, angle_rad } = this.placement;
    context.save();
    context.globalAlpha = this.opacity;
    context.translate(...to_pixels(view, x_m, y_m));
    context.rotate(rotation(view, angle_rad));
    context.scale(view.scale * metres_per_pixel, view.scale * metres_per_pixel);
    context.drawImage(this.picture, 0, 0);
    context.restore();
  }
}
