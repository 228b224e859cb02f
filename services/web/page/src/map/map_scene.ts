// The content of the map: follows the channels, draws the static and the moving parts.
import { Channels } from "../channels";
import { Loop, PointM, Rule } from "../protocol";
import { Drawing, empty_drawing } from "../draw/drawing";
import { recolor_grid, recolor_rooms, TileLayer } from "./tile_layer";
import { Palette, Theme } from "../ui/theme";
import { Box, box_of_cells, known_box, TileVersions } from "./grid_frame";
import { draw_drawing, draw_rules } from "./drawing_layer";
import { GraphLayer } from "./graph_layer";
import { draw_labels } from "./label_layer";
import { View } from "./map_canvas";
import {
  draw_body,
  draw_goal,
  draw_heading,
  draw_local_map,
  draw_robot,
  draw_route,
  draw_scan,
  PoseMark,
} from "./robot_layer";
import { TrailLayer } from "./trail_layer";

export const layerNames = [
  "rooms",
  "names",
  "drawing",
  "graph",
  "trail",
  "loops",
  "scan",
  "local_map",
] as const;
const boxStepM = 1;
const emptyPlane: Box = { min_x: -2, min_y: -2, max_x: 18, max_y: 12 };

export type LayerName = (typeof layerNames)[number];

export type DrawAbove = (
  context: CanvasRenderingContext2D,
  view: View,
  palette: Palette,
) => void;

/** A chosen goal that has not been given yet. */
export interface Mark {
  x_m: number;
  y_m: number;
  goal?: { heading_rad?: number };
}

/** Drawn on the map in edit mode, in place of the saved drawing. */
export interface Overlay {
  /** The robot's map is hidden. */
  readonly alone: boolean;
  draw_still(context: CanvasRenderingContext2D, view: View): void;
  draw_moving(context: CanvasRenderingContext2D, view: View): void;
}

export class MapScene {
  readonly visible: Record<LayerName, boolean> = {
    rooms: true,
    names: true,
    drawing: true,
    graph: true,
    trail: true,
    loops: false,
    scan: true,
    local_map: false,
  };
  // Set by the views.
  marks: Mark[] = [];
  preview: number[] = []; // x, y of each route point, metres
  pose_mark: PoseMark | null = null;
  chosen_loop: Loop | null = null;
  drawn: Drawing = empty_drawing(); // the saved one
  overlay: Overlay | null = null;
  readonly above = new Map<string, DrawAbove>(); // of the views: drawn above the map

  private readonly versions = new TileVersions();
  private readonly grid: TileLayer;
  private readonly rooms: TileLayer;
  private readonly graph = new GraphLayer();
  readonly trail = new TrailLayer();
  private frame = "";
  private room_colors = ""; // of all rooms: their pictures change with them
  private shown = false;

  constructor(
    private readonly channels: Channels,
    private readonly theme: Theme,
    private readonly still_changed: () => void,
    private readonly moving_changed: () => void,
  ) {
    this.grid = new TileLayer("grid", () => recolor_grid(theme.palette), still_changed);
    this.rooms = new TileLayer("rooms", () => recolor_rooms(theme.palette), still_changed);
    theme.on_change(() => this.forget_pictures());
    this.follow_grid();
    this.follow_graph();
    this.follow_trail();
    const still = () => still_changed();
    channels.on_table("places", still);
    channels.on_table("rules", still);
    channels.on_table("loops", still);
    channels.on_value(["pose", "scan", "route", "goals", "local_map"], moving_changed);
    let named_for = ""; // goals that the names avoid
    channels.on_value(["route", "goals"], () => {
      const goals = JSON.stringify(this.goals());
      if (goals !== named_for) still_changed();
      named_for = goals;
    });
  }

  /** The box around the known floor; null without a map. */
  box(): Box | null {
    if (this.overlay?.alone) return emptyPlane;
    const info = this.channels.value("map");
    if (!info) return null;
    const cells = this.grid.known_cells(this.versions);
    if (!cells) return known_box(info, this.channels.table("tiles").keys());
    const box = box_of_cells(info, cells.low, cells.high);
    // In steps, so that a growing map does not shift with each cell.
    return {
      min_x: boxStepM * Math.floor(box.min_x / boxStepM),
      min_y: boxStepM * Math.floor(box.min_y / boxStepM),
      max_x: boxStepM * Math.ceil(box.max_x / boxStepM),
      max_y: boxStepM * Math.ceil(box.max_y / boxStepM),
    };
  }

  draw_still(context: CanvasRenderingContext2D, view: View): void {
    if (!this.overlay?.alone) this.draw_map(context, view);
    this.overlay?.draw_still(context, view);
  }

  private draw_map(context: CanvasRenderingContext2D, view: View): void {
    const palette = this.theme.palette;
    const info = this.channels.value("map");
    if (info) {
      const complete = this.grid.draw(context, view, info, this.versions);
      if (complete && this.channels.table("tiles").size > 0) this.mark_shown();
      if (this.visible.rooms && this.channels.table("rooms").size > 0) {
        context.globalAlpha = palette.room_alpha;
        this.rooms.draw(context, view, info, this.versions, this.room_colors);
        context.globalAlpha = 1;
      }
    }
    const drawn = this.visible.drawing && !this.overlay;
    // In edit mode, the editor draws them.
    const rules = this.overlay ? new Map<string, Rule>() : this.channels.table("rules");
    draw_rules(context, view, rules.values(), palette);
    if (drawn) draw_drawing(context, view, this.drawn, palette, null, false);
    if (this.visible.trail) this.trail.draw(context, view, palette);
    if (this.visible.graph) this.graph.draw(context, view, palette);
    const loops = this.visible.loops ? this.channels.table("loops").values() : [];
    this.trail.draw_loops(context, view, loops, this.chosen_loop, palette);
    if (this.visible.names) {
      const named = this.channels.table("places");
      const rooms = [...this.channels.table("rooms").values()].filter(
        (room) => !named.has(room.name),
      );
      // In edit mode, the editor names the drawing's places and zones.
      const places = this.overlay ? new Map<string, PointM>() : named;
      draw_labels(context, view, { rooms, places, rules, goals: this.goals() }, palette);
    }
  }

  draw_moving(context: CanvasRenderingContext2D, view: View): void {
    if (!this.overlay?.alone) this.draw_robot(context, view);
    this.overlay?.draw_moving(context, view);
  }

  private draw_robot(context: CanvasRenderingContext2D, view: View): void {
    const palette = this.theme.palette;
    const pose = this.channels.value("pose");
    const located = pose !== null && pose.state !== "SEARCHING" && pose.state !== "LOST";
    const route = this.channels.value("route");
    const local = this.channels.value("local_map");
    if (local && this.visible.local_map) draw_local_map(context, view, local, palette.local);
    const end = this.route_end();
    if (route && end) {
      draw_route(context, view, route.points_m, palette, false);
      draw_goal(context, view, end.x_m, end.y_m, palette);
    }
    if (this.preview.length > 0) draw_route(context, view, this.preview, palette, true);
    this.marks.forEach((mark, i) => {
      const number = this.marks.length > 1 ? String(i + 1) : "";
      draw_goal(context, view, mark.x_m, mark.y_m, palette, number);
      const theta = mark.goal?.heading_rad;
      if (theta !== undefined) draw_heading(context, view, mark.x_m, mark.y_m, theta, palette);
    });
    const scan = this.channels.value("scan");
    if (scan && located && this.visible.scan) draw_scan(context, view, scan, palette);
    if (pose && located) {
      const color = pose.state === "TRACKING" ? palette.robot : palette.ellipse;
      draw_robot(context, view, pose, palette, color);
    }
    if (this.pose_mark) draw_body(context, view, this.pose_mark, palette.goal, palette);
    for (const draw of this.above.values()) draw(context, view, palette);
  }

  /** Redraws everything after a change of a choice. */
  refresh(): void {
    this.still_changed();
    this.moving_changed();
  }

  /** Destination of the robot; null without a goal or a route. */
  private route_end(): PointM | null {
    const route = this.channels.value("route");
    if (!route?.found || !this.channels.value("goals")?.current) return null;
    const last = route.points_m.length - 2;
    return last < 0 ? null : { x_m: route.points_m[last], y_m: route.points_m[last + 1] };
  }

  private goals(): PointM[] {
    const end = this.route_end();
    return end ? [end, ...this.marks] : this.marks;
  }

  private forget_pictures(): void {
    this.grid.clear();
    this.rooms.clear();
    this.refresh();
  }

  private follow_grid(): void {
    const rebuild = () => {
      const info = this.channels.value("map");
      this.versions.clear();
      if (!info) return;
      for (const [key, version] of this.channels.table("tiles")) {
        this.versions.add(info, Number(key), version);
      }
    };
    this.channels.on_value(["map"], () => {
      const frame = this.channels.value("map")?.frame ?? "";
      if (frame !== "" && frame !== this.frame) {
        this.frame = frame;
        this.grid.clear();
        this.rooms.clear();
        rebuild();
      }
      this.still_changed();
    });
    this.channels.on_table("tiles", (change) => {
      const info = this.channels.value("map");
      // After a change of the frame, all squares arrive again.
      if (change.gone.length > 0 || change.set.length === this.channels.table("tiles").size) {
        rebuild();
      } else if (info) {
        const tiles = this.channels.table("tiles");
        for (const key of change.set) this.versions.add(info, Number(key), tiles.get(key) ?? 0);
      }
      this.still_changed();
    });
    this.channels.on_table("rooms", () => {
      const rooms = [...this.channels.table("rooms")].sort((a, b) => Number(a[0]) - Number(b[0]));
      this.room_colors = `.${rooms.map(([, room]) => room.color).join("")}`;
      this.still_changed();
    });
  }

  // For measuring the time until the map is on the screen.
  private mark_shown(): void {
    if (this.shown) return;
    this.shown = true;
    performance.mark("map-shown");
  }

  private follow_graph(): void {
    const table = this.channels.table("graph");
    this.channels.on_table("graph", (change) => {
      if (change.all) this.graph.clear();
      for (const key of change.gone) {
        if (key.startsWith("n")) this.graph.remove_node(Number(key.slice(1)));
        else if (key.startsWith("b")) this.graph.remove_branch(Number(key.slice(1)));
      }
      for (const key of change.set) {
        const id = Number(key.slice(1));
        const value = table.get(key);
        if (key === "map" || !value) continue;
        if (key.startsWith("n")) {
          const { kind = "real", x_m = 0, y_m = 0 } = value;
          this.graph.set_node({ id, kind, x: x_m, y: y_m });
        } else {
          const points = new Float32Array(value.points_m ?? []);
          this.graph.set_branch(id, points, value.virtual === true);
        }
      }
      this.still_changed();
    });
  }

  private follow_trail(): void {
    const table = this.channels.table("trail");
    this.channels.on_table("trail", (change) => {
      if (change.all) this.trail.clear();
      for (const key of change.gone) this.trail.remove_chunk(Number(key));
      for (const key of change.set) this.trail.set_chunk(Number(key), table.get(key) ?? []);
      this.still_changed();
    });
  }
}
