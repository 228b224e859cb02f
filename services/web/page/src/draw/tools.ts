// The tools of the edit mode: the shape that each draws, and the resulting item.
import { texts } from "../texts";
import { Drawing, free_name, Item, ItemKind, ListName, name_is_free, to_mm, ZoneKind } from "./drawing";
import { distance, heading, point_at } from "./geometry";
import { Finished, Shape } from "./sketch";

/** Tools that make an item. */
export type ItemTool = Exclude<ItemKind, "room">;
/** Tools for rooms of the map, and for the background picture. */
export type OtherTool = "split" | "join" | "rename" | "measure" | "shift";
export type ToolName = "select" | ItemTool | OtherTool;

const toolShapes: Record<Exclude<ToolName, "select">, Shape> = {
  place: "point",
  base: "arrow",
  wall: "line",
  opening: "segment",
  door: "segment",
  no_go: "polygon",
  slow: "polygon",
  one_way: "polygon",
  preferred: "polygon",
  split: "segment",
  join: "segment",
  rename: "point",
  measure: "segment",
  shift: "segment",
};

const itemTools: readonly ItemTool[] = [
  "place",
  "base",
  "wall",
  "opening",
  "door",
  "no_go",
  "slow",
  "one_way",
  "preferred",
];
const slowMps = 0.2;

export function shape_of(tool: ToolName): Shape | null {
  return tool === "select" ? null : toolShapes[tool];
}

export function is_item_tool(tool: ToolName): tool is ItemTool {
  return itemTools.some((known) => known === tool);
}

/** Whether a tool draws exactly on the grid and corners. */
export function snaps(tool: ToolName): boolean {
  return is_item_tool(tool) || tool === "split";
}

/** Makes a tool's item from its points, with a name unique in the drawing. */
export function make_item(
  tool: ItemTool,
  drawn: Finished,
  drawing: Drawing,
): { list: ListName; item: Item } {
  const points = drawn.points.map(to_mm);
  switch (tool) {
    case "place":
    case "base":
      return { list: "places", item: make_place(tool, points, drawn.heading_rad, drawing) };
    case "wall":
      return { list: "walls", item: { points_m: points } };
    case "opening":
      return { list: "openings", item: { points_m: points } };
    case "door": {
      const name = free_name(drawing, "doors", texts.draw.kinds.door);
      return { list: "doors", item: { name, points_m: points } };
    }
    default:
      return { list: "zones", item: make_zone(tool, points, drawing) };
  }
}

function make_place(
  tool: "place" | "base",
  [x_m, y_m]: number[],
  heading_rad: number,
  drawing: Drawing,
): Item {
  if (tool === "place") {
    return { name: free_name(drawing, "places", texts.draw.kinds.place), x_m, y_m };
  }
  // The service looks for this name when the robot returns home.
  const name = name_is_free(drawing, "places", "home") ? "home" : free_name(drawing, "places", "home");
  return { name, x_m, y_m, heading_rad: to_mm(heading_rad) };
}

function make_zone(kind: ZoneKind, corners_m: number[], drawing: Drawing): Item {
  const name = free_name(drawing, "zones", texts.draw.kinds[kind]);
  const value = { room: 0, no_go: 0, slow: slowMps, one_way: to_mm(along(corners_m)), preferred: 0 }[kind];
  return { name, kind, value, corners_m };
}

// Direction of the longer one of the first two edges.
function along(corners: number[]): number {
  const [a, b, c] = [point_at(corners, 0), point_at(corners, 1), point_at(corners, 2)];
  return distance(a, b) >= distance(b, c) ? heading(a, b) : heading(b, c);
}
