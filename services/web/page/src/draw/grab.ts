// Finds the item or handle under a press, and applies a drag to it.
import {
  all_items,
  Drawing,
  fewest_points,
  is_closed,
  is_extensible,
  Item,
  item_of,
  ItemRef,
  mostCorners,
  ListName,
  points_of,
  to_mm,
  with_points,
} from "./drawing";
import { area_of, contains, distance, distance_to, heading, middle_of, Point, point_at } from "./geometry";
import { snap_heading } from "./snapping";

export type Part =
  | { what: "corner"; index: number }
  | { what: "middle"; index: number } // of the segment after this corner; a drag makes it a corner
  | { what: "heading" }
  | { what: "whole" };

export interface Grip {
  ref: ItemRef;
  part: Part;
}

export interface Handle extends Point {
  part: Part;
}

/** Heading of the arrow of a base station or a one-way zone; null for other items. */
export function heading_of(item: Item): number | null {
  if ("kind" in item) return item.kind === "one_way" ? item.value : null;
  return "x_m" in item ? (item.heading_rad ?? null) : null;
}

export function with_heading(item: Item, heading_rad: number): Item {
  const rounded = to_mm(Math.atan2(Math.sin(heading_rad), Math.cos(heading_rad)));
  if ("kind" in item) return { ...item, value: rounded };
  return "x_m" in item ? { ...item, heading_rad: rounded } : item;
}

/** Handles of a selected item. arrow_m: length of an arrow at this zoom. */
export function handles_of(list: ListName, item: Item, arrow_m: number): Handle[] {
  const points = points_of(item);
  const count = points.length / 2;
  const handles: Handle[] = [];
  const angle = heading_of(item);
  if (angle !== null) {
    const { x, y } = middle_of(points);
    const part: Part = { what: "heading" };
    handles.push({ x: x + arrow_m * Math.cos(angle), y: y + arrow_m * Math.sin(angle), part });
  }
  for (let index = 0; index < count && list !== "places"; ++index) {
    handles.push({ ...point_at(points, index), part: { what: "corner", index } });
  }
  if (!is_extensible(list) || count >= mostCorners) return handles;
  for (let index = 0; index < (is_closed(list) ? count : count - 1); ++index) {
    const [a, b] = [point_at(points, index), point_at(points, (index + 1) % count)];
    const part: Part = { what: "middle", index };
    handles.push({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, part });
  }
  return handles;
}

/** The item at a point: the smallest if several zones overlap. */
export function item_at(drawing: Drawing, at: Point, reach_m: number): ItemRef | null {
  let zone: ItemRef | null = null;
  let least = Infinity;
  for (const { ref, item } of all_items(drawing)) {
    const points = points_of(item);
    const closed = is_closed(ref.list);
    const touched = distance_to(points, closed, at) <= reach_m;
    if (!closed && touched) return ref;
    if (!closed || !(touched || contains(points, at)) || area_of(points) >= least) continue;
    zone = ref;
    least = area_of(points);
  }
  return zone;
}

/** A handle of the selected item, or an item; null if there is none. */
export function grip_at(
  drawing: Drawing,
  selected: ItemRef | null,
  at: Point,
  reach_m: number,
  arrow_m: number,
): Grip | null {
  const item = selected && item_of(drawing, selected);
  if (selected && item) {
    // Corners have precedence over the midpoints between them.
    const near = handles_of(selected.list, item, arrow_m).find((h) => distance(h, at) <= reach_m);
    if (near) return { ref: selected, part: near.part };
  }
  const ref = item_at(drawing, at, reach_m);
  return ref ? { ref, part: { what: "whole" } } : null;
}

/** The point that snaps in a drag: a corner itself; for a whole item, its first point. */
export function anchor_of(item: Item, part: Part): Point | null {
  if (part.what === "heading" || part.what === "middle") return null;
  return point_at(points_of(item), part.what === "corner" ? part.index : 0);
}

/** The corner before a dragged one, for right angles; null if there is none. */
export function neighbour_of(list: ListName, item: Item, part: Part): Point | null {
  if (part.what !== "corner") return null;
  const points = points_of(item);
  const count = points.length / 2;
  const index = part.index > 0 ? part.index - 1 : is_closed(list) ? count - 1 : 1;
  return index < count ? point_at(points, index) : null;
}

/** The item after a drag of its anchor to `to`. */
export function moved(item: Item, part: Part, to: Point): Item {
  const points = [...points_of(item)];
  switch (part.what) {
    case "heading":
      return with_heading(item, snap_heading(heading(middle_of(points), to)));
    case "corner":
      points.splice(2 * part.index, 2, to.x, to.y);
      break;
    case "middle":
      points.splice(2 * part.index + 2, 0, to.x, to.y);
      break;
    case "whole": {
      const [dx, dy] = [to.x - points[0], to.y - points[1]];
      return with_points(
        item,
        points.map((value, i) => value + (i % 2 === 0 ? dx : dy)),
      );
    }
  }
  return with_points(item, points);
}

/** The item without a corner; null if it needs all of them. */
export function without_corner(list: ListName, item: Item, index: number): Item | null {
  const points = [...points_of(item)];
  if (points.length / 2 <= fewest_points(list)) return null;
  points.splice(2 * index, 2);
  return with_points(item, points);
}
