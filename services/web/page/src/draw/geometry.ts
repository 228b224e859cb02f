// Plane geometry of drawn items. Metres, radians; lists of points are flat: x, y, x, y.

export interface Point {
  x: number;
  y: number;
}

export function point_at(points: number[], index: number): Point {
  return { x: points[2 * index], y: points[2 * index + 1] };
}

export function distance(a: Point, b: Point): number {
  return Math.hypot(a.x - b.x, a.y - b.y);
}

export function heading(from: Point, to: Point): number {
  return Math.atan2(to.y - from.y, to.x - from.x);
}

/** The segments of a line; a closed line includes that from the last point to the first. */
export function segments_of(points: number[], closed: boolean): [Point, Point][] {
  const count = points.length / 2;
  const segments: [Point, Point][] = [];
  for (let i = 0; i + 1 < count; ++i) segments.push([point_at(points, i), point_at(points, i + 1)]);
  if (closed && count > 2) segments.push([point_at(points, count - 1), point_at(points, 0)]);
  return segments;
}

export function length_of(points: number[], closed: boolean): number {
  return segments_of(points, closed).reduce((sum, [a, b]) => sum + distance(a, b), 0);
}

/** Area of a closed line that does not cross itself. */
export function area_of(corners: number[]): number {
  const twice = segments_of(corners, true).reduce((sum, [a, b]) => sum + a.x * b.y - b.x * a.y, 0);
  return Math.abs(twice) / 2;
}

/** The mean of the points. */
export function middle_of(points: number[]): Point {
  const count = Math.max(1, points.length / 2);
  let [x, y] = [0, 0];
  for (let i = 0; i + 1 < points.length; i += 2) {
    x += points[i] / count;
    y += points[i + 1] / count;
  }
  return { x, y };
}

/** The point of a segment that is nearest to a point. */
export function nearest_on(a: Point, b: Point, at: Point): Point {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const square = dx * dx + dy * dy;
  const share = square > 0 ? ((at.x - a.x) * dx + (at.y - a.y) * dy) / square : 0;
  const t = Math.max(0, Math.min(1, share));
  return { x: a.x + t * dx, y: a.y + t * dy };
}

export function distance_to(points: number[], closed: boolean, at: Point): number {
  if (points.length === 2) return distance(point_at(points, 0), at);
  return segments_of(points, closed).reduce(
    (least, [a, b]) => Math.min(least, distance(nearest_on(a, b, at), at)),
    Infinity,
  );
}

/** Whether a closed line encloses a point (by ray crossings). */
export function contains(corners: number[], at: Point): boolean {
  let inside = false;
  for (const [a, b] of segments_of(corners, true)) {
    if (a.y > at.y === b.y > at.y) continue;
    if (at.x < a.x + ((at.y - a.y) / (b.y - a.y)) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}
