// Named destinations for the robot.
import { Channels } from "./channels";

export interface Destination {
  name: string;
  is_place: boolean;
  x_m: number;
  y_m: number;
}

/** Places, then rooms, each sorted by name; a room with the name of a place is left out. */
export function destinations(channels: Channels): Destination[] {
  const by_name = (a: Destination, b: Destination) =>
    a.name.localeCompare(b.name, "en", { numeric: true });
  const places = [...channels.table("places")].map(([name, place]) => ({
    name,
    is_place: true,
    x_m: place.x_m,
    y_m: place.y_m,
  }));
  const taken = new Set(places.map((place) => place.name));
  const rooms: Destination[] = [];
  for (const { name, x_m, y_m } of channels.table("rooms").values()) {
    if (name === "" || taken.has(name)) continue;
    taken.add(name);
    rooms.push({ name, is_place: false, x_m, y_m });
  }
  return [...places.sort(by_name), ...rooms.sort(by_name)];
}

const firstPlaceNumber = 101;

/**
 * Numbers for a keypad, in the order of the list: "room 7" keeps its own, all others count from
 * 101.
 */
export function numbered(list: Destination[]): Map<number, Destination> {
  const numbers = new Map<number, Destination>();
  let next = firstPlaceNumber;
  for (const destination of list) {
    const own = /^room (\d{1,2})$/.exec(destination.name);
    if (own) numbers.set(Number(own[1]), destination);
    else numbers.set(next++, destination);
  }
  return numbers;
}
