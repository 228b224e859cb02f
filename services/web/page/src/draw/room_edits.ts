// Splits, joins and renames rooms of the map: the service computes their outlines, which become
// zones of the kind room.
import { Api } from "../api";
import { Room } from "../protocol";
import { texts } from "../texts";
import { Drawing, DrawnZone, free_name, with_new } from "./drawing";
import { contains, Point } from "./geometry";

type Rooms = ReadonlyMap<string, Room>;

const lineShares = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8]; // along a line, where a room is searched

/** For people: why a room cannot be edited. */
export class RoomError extends Error {}

/** Number of the room at a point; undefined if there is none. */
async function zone_at(
  api: Api,
  rooms: Rooms,
  drawing: Drawing,
  at: Point,
): Promise<number | undefined> {
  const drawn = drawing.zones.find(
    (zone) => zone.kind === "room" && contains(zone.corners_m, at),
  );
  const known = [...rooms.values()].map((room) => room.name);
  if (drawn && !known.includes(drawn.name)) throw new RoomError(texts.draw.rooms.save_first);
  const path = `/api/at?x_m=${at.x.toFixed(3)}&y_m=${at.y.toFixed(3)}`;
  return (await api.get<{ zone?: number }>(path)).zone;
}

/** The same. Throws a RoomError if there is none. */
async function room_at(api: Api, rooms: Rooms, drawing: Drawing, at: Point): Promise<number> {
  const zone = await zone_at(api, rooms, drawing, at);
  if (zone === undefined) throw new RoomError(texts.draw.rooms.none_here);
  return zone;
}

/** The room at the middle of a line or near it, because a table may stand in the middle. */
async function room_along(
  api: Api,
  rooms: Rooms,
  drawing: Drawing,
  [from, to]: [Point, Point],
): Promise<number> {
  for (const share of lineShares) {
    const at = { x: from.x + share * (to.x - from.x), y: from.y + share * (to.y - from.y) };
    const zone = await zone_at(api, rooms, drawing, at);
    if (zone !== undefined) return zone;
  }
  throw new RoomError(texts.draw.rooms.none_along);
}

async function shapes_of(api: Api, zones: number[], cut?: [Point, Point]): Promise<number[][]> {
  const cut_m = cut?.flatMap(({ x, y }) => [x, y]);
  const body = cut_m ? { zones, cut_m } : { zones };
  const { shapes } = await api.post<{ shapes: { corners_m: number[] }[] }>("room_shapes", body);
  return shapes.map((shape) => shape.corners_m);
}

function name_of(rooms: Rooms, zone: number): string {
  return rooms.get(String(zone))?.name ?? "";
}

// The new rooms replace drawn ones with the names of the edited rooms.
function replace(drawing: Drawing, names: string[], zones: { name: string; corners_m: number[] }[]): Drawing {
  const kept = drawing.zones.filter((zone) => zone.kind !== "room" || !names.includes(zone.name));
  let edited: Drawing = { ...drawing, zones: kept };
  for (const { name, corners_m } of zones) {
    const free = name === "" || edited.zones.some((zone) => zone.name === name);
    const zone: DrawnZone = {
      name: free ? free_name(edited, "zones", name || texts.draw.kinds.room) : name,
      kind: "room",
      value: 0,
      corners_m,
    };
    edited = with_new(edited, "zones", zone);
  }
  return edited;
}

/** Splits the room that a line crosses. */
export async function split_room(
  api: Api,
  rooms: Rooms,
  drawing: Drawing,
  line: [Point, Point],
): Promise<Drawing> {
  const zone = await room_along(api, rooms, drawing, line);
  const shapes = await shapes_of(api, [zone], line);
  if (shapes.length < 2) throw new RoomError(texts.draw.rooms.not_split);
  const name = name_of(rooms, zone);
  return replace(
    drawing,
    [name],
    shapes.map((corners_m) => ({ name, corners_m })),
  );
}

/** Joins two rooms; the result has the name of the first. */
export async function join_rooms(
  api: Api,
  rooms: Rooms,
  drawing: Drawing,
  [a, b]: [Point, Point],
): Promise<Drawing> {
  const zones = [await room_at(api, rooms, drawing, a), await room_at(api, rooms, drawing, b)];
  if (zones[0] === zones[1]) throw new RoomError(texts.draw.rooms.same_room);
  const shapes = await shapes_of(api, zones);
  if (shapes.length !== 1) throw new RoomError(texts.draw.rooms.not_joined);
  const names = zones.map((zone) => name_of(rooms, zone));
  return replace(drawing, names, [{ name: names[0], corners_m: shapes[0] }]);
}

/** The room at a point as a zone of the drawing, added at the end, which can then be named. */
export async function room_to_rename(
  api: Api,
  rooms: Rooms,
  drawing: Drawing,
  at: Point,
): Promise<Drawing> {
  const zone = await room_at(api, rooms, drawing, at);
  const name = name_of(rooms, zone);
  const [corners_m] = await shapes_of(api, [zone]);
  if (!corners_m) throw new RoomError(texts.draw.rooms.none_here);
  return replace(drawing, [name], [{ name, corners_m }]);
}
