// The drawing on the map: places, zones, walls, openings, doors, kept apart from the mapped data.
// Metres and radians, map frame; lists of points are flat: x, y, x, y. A drawing is never changed
// in place: each edit makes a new drawing, so undo needs only a list of drawings.
import { texts } from "../texts";

export interface DrawnPlace {
  name: string;
  x_m: number;
  y_m: number;
  heading_rad?: number; // a base station: heading of the robot that stands there
}

export type ZoneKind = "room" | "no_go" | "slow" | "one_way" | "preferred";

export interface DrawnZone {
  name: string;
  kind: ZoneKind;
  value: number; // slow: speed in m/s; one_way: heading in rad; otherwise 0
  corners_m: number[];
}

export interface DrawnLine {
  name?: string;
  points_m: number[];
}

export interface DrawnDoor extends DrawnLine {
  name: string;
}

export interface Drawing {
  places: DrawnPlace[];
  zones: DrawnZone[];
  walls: DrawnLine[];
  openings: DrawnLine[];
  doors: DrawnDoor[];
}

export type ListName = keyof Drawing;
export type Item = Drawing[ListName][number];
/** The kind of an item as the page shows it; the tool that draws it has the same name. */
export type ItemKind = "place" | "base" | "wall" | "opening" | "door" | ZoneKind;

/** One item of a drawing. */
export interface ItemRef {
  list: ListName;
  index: number;
}

// Upper layers first.
export const listNames: readonly ListName[] = ["places", "doors", "openings", "walls", "zones"];
const zoneKinds: readonly ZoneKind[] = ["room", "no_go", "slow", "one_way", "preferred"];

/** Limits of the service: items of a list, and corners of an item. */
export const mostItems = 4096;
export const mostCorners = 256;

export function empty_drawing(): Drawing {
  return { places: [], zones: [], walls: [], openings: [], doors: [] };
}

export function item_of(drawing: Drawing, ref: ItemRef): Item | undefined {
  return drawing[ref.list][ref.index];
}

/** All items, upper layers first. */
export function all_items(drawing: Drawing): { ref: ItemRef; item: Item }[] {
  return listNames.flatMap((list) =>
    (drawing[list] as Item[]).map((item, index) => ({ ref: { list, index }, item })),
  );
}

export function kind_of(list: ListName, item: Item): ItemKind {
  if ("kind" in item) return item.kind;
  if ("x_m" in item) return item.heading_rad === undefined ? "place" : "base";
  return list === "doors" ? "door" : list === "openings" ? "opening" : "wall";
}

/** The points of an item; for a place its position. */
export function points_of(item: Item): number[] {
  if ("corners_m" in item) return item.corners_m;
  return "points_m" in item ? item.points_m : [item.x_m, item.y_m];
}

export function with_points<Some extends Item>(item: Some, points: number[]): Some {
  const rounded = points.map(to_mm);
  if ("corners_m" in item) return { ...item, corners_m: rounded };
  if ("points_m" in item) return { ...item, points_m: rounded };
  return { ...item, x_m: rounded[0], y_m: rounded[1] };
}

export function is_closed(list: ListName): boolean {
  return list === "zones";
}

/** Smallest number of points of an item in a list. */
export function fewest_points(list: ListName): number {
  return list === "places" ? 1 : list === "zones" ? 3 : 2;
}

/** Whether an item of a list may have more points than the smallest number. */
export function is_extensible(list: ListName): boolean {
  return list === "zones" || list === "walls";
}

export function with_item(drawing: Drawing, ref: ItemRef, item: Item): Drawing {
  const items = (drawing[ref.list] as Item[]).map((old, i) => (i === ref.index ? item : old));
  return { ...drawing, [ref.list]: items };
}

/** Appends the item to its list. */
export function with_new(drawing: Drawing, list: ListName, item: Item): Drawing {
  return { ...drawing, [list]: [...drawing[list], item] };
}

export function without(drawing: Drawing, ref: ItemRef): Drawing {
  const items = (drawing[ref.list] as Item[]).filter((_, i) => i !== ref.index);
  return { ...drawing, [ref.list]: items };
}

/** Whether a name is free in a list: unique among places, and among zones and doors together. */
export function name_is_free(
  drawing: Drawing,
  list: ListName,
  name: string,
  own: ItemRef | null = null,
): boolean {
  const named = drawing[list] as { name?: string }[];
  return named.every((item, i) => item.name !== name || (own?.list === list && own.index === i));
}

/** Appends the first number that makes the name unique: "slow 2". */
export function free_name(drawing: Drawing, list: ListName, base: string): string {
  for (let number = 1; ; ++number) {
    const name = `${base} ${number}`;
    if (name_is_free(drawing, list, name)) return name;
  }
}

/** Pose in which the robot starts: the first base station. */
export function start_of(
  drawing: Drawing,
): { x_m: number; y_m: number; heading_rad: number } | null {
  for (const { x_m, y_m, heading_rad } of drawing.places) {
    if (heading_rad !== undefined) return { x_m, y_m, heading_rad };
  }
  return null;
}

export function to_mm(value: number): number {
  return Math.round(1000 * value) / 1000 + 0; // + 0 turns -0 into 0
}

/** Parses the JSON of the service or of a file. Throws an Error that names the faulty item. */
export function parse_drawing(json: unknown): Drawing {
  const words = texts.draw.parse;
  if (!is_object(json)) throw new Error(words.no_drawing);
  const drawing = empty_drawing();
  for (const list of listNames) {
    const items = json[list] ?? [];
    if (!Array.isArray(items)) throw new Error(words.no_list(list));
    if (items.length > mostItems) throw new Error(words.too_many(list, mostItems));
    items.forEach((item, index) => {
      const parsed = is_object(item) ? parse_item(list, item) : null;
      if (!parsed) throw new Error(words.wrong_item(list, index));
      (drawing[list] as Item[]).push(parsed);
    });
  }
  return drawing;
}

type Fields = Record<string, unknown>;

function is_object(value: unknown): value is Fields {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function is_number(value: unknown): value is number {
  return typeof value === "number" && Number.isFinite(value);
}

function numbers(value: unknown, fewest: number): number[] | null {
  if (!Array.isArray(value) || !value.every(is_number)) return null;
  const good = value.length % 2 === 0 && value.length >= 2 * fewest;
  return good && value.length <= 2 * mostCorners ? value : null;
}

// Returns null if a field is missing or out of range.
function parse_item(list: ListName, fields: Fields): Item | null {
  const name = typeof fields.name === "string" ? fields.name : "";
  if (list === "places") {
    const { x_m, y_m, heading_rad } = fields;
    if (name === "" || !is_number(x_m) || !is_number(y_m)) return null;
    return is_number(heading_rad) ? { name, x_m, y_m, heading_rad } : { name, x_m, y_m };
  }
  if (list === "zones") {
    const corners_m = numbers(fields.corners_m, 3);
    const kind = zoneKinds.find((known) => known === fields.kind);
    if (name === "" || !corners_m || !kind) return null;
    return { name, kind, value: is_number(fields.value) ? fields.value : 0, corners_m };
  }
  const points_m = numbers(fields.points_m, 2);
  if (!points_m || (list !== "walls" && points_m.length !== 4)) return null;
  return list === "doors" || name !== "" ? { name, points_m } : { points_m };
}
