// The edit mode on the map: passes presses and keys to the chosen tool, and draws the edited items.
import { draw_drawing, arrowPx, zone_color } from "../map/drawing_layer";
import {
  draw_cursor,
  draw_grid,
  draw_selection,
  draw_sketch,
  draw_text,
} from "../map/edit_layer";
import { View } from "../map/map_canvas";
import { Overlay } from "../map/map_scene";
import { MapPointer, MapTool } from "../map/map_tool";
import { Theme } from "../ui/theme";
import { Background } from "./background";
import { DrawingDocument } from "./document";
import {
  all_items,
  is_closed,
  Item,
  item_of,
  points_of,
  with_item,
  with_new,
  without,
} from "./drawing";
import { middle_of, Point, point_at } from "./geometry";
import { anchor_of, Grip, grip_at, handles_of, moved, neighbour_of } from "./grab";
import { Sketch, Finished } from "./sketch";
import { snap, Snapped, SnapSettings } from "./snapping";
import { is_item_tool, make_item, OtherTool, shape_of, snaps, ToolName } from "./tools";

const reachPx = 11; // reach of a press, and of the pull of corners
const namePx = 12; // distance of names above lines and places
const keyStepM = 0.1; // step of the cursor without a grid

export interface EditorHooks {
  /** Redraws the map. */
  redraw(): void;
  /** The tool, the current item or the cursor has changed. */
  changed(): void;
  drawn(item: Item): void;
  /** A tool that makes no item itself has its points. */
  asked(tool: OtherTool, drawn: Finished): void;
  /** The point in the middle of the map. */
  middle(): MapPointer;
  /** A step on the screen, to the right and up, in the map frame. */
  on_map(right: number, up: number): [number, number];
}

interface Drag {
  grip: Grip;
  item: Item; // before the drag
  from: Point;
}

export class Editor implements MapTool, Overlay {
  readonly settings: SnapSettings = { grid_m: 0.1, corners: true, right_angles: true };
  background: Background | null = null;
  /** The robot's map is hidden. */
  alone = false;
  private name: ToolName = "select";
  private sketch: Sketch | null = null;
  private held: Drag | null = null;
  private cursor: Snapped | null = null;

  constructor(
    private edited: DrawingDocument,
    private readonly theme: Theme,
    private readonly hooks: EditorHooks,
  ) {}

  get document(): DrawingDocument {
    return this.edited;
  }

  get tool(): ToolName {
    return this.name;
  }

  /** Position of the next point; null while the pointer is off the map. */
  get at(): Point | null {
    return this.cursor;
  }

  /** Opens another document; drops the unfinished item. */
  open(document: DrawingDocument, alone: boolean): void {
    this.choose("select");
    this.edited = document;
    this.alone = alone;
    this.hooks.redraw();
  }

  choose(tool: ToolName): void {
    this.held = null;
    this.edited.end_drag(false);
    this.name = tool;
    const shape = shape_of(tool);
    this.sketch = shape ? new Sketch(shape) : null;
    this.cursor = null;
    this.refresh();
  }

  /** Whether an item is unfinished, and whether it could end here. */
  progress(): { points: number; complete: boolean } {
    const complete = this.sketch !== null && !this.sketch.is_empty && this.sketch.finish() !== null;
    return { points: this.sketch?.points.length ?? 0, complete };
  }

  /** Selects another tool; an item that could end here is finished and kept. */
  switch_to(tool: ToolName): void {
    this.finish();
    this.choose(tool);
  }

  finish(): void {
    const drawn = this.sketch?.finish();
    if (drawn) this.complete(drawn);
  }

  /** Drops the unfinished item, or else the selection. */
  escape(): void {
    if (this.sketch && !this.sketch.is_empty) this.choose(this.name);
    else if (this.name !== "select") this.choose("select");
    else this.edited.select(null);
  }

  delete_selected(): void {
    const { selected, drawing } = this.edited;
    if (selected) this.edited.edit(without(drawing, selected), null);
  }

  // ---- pointer

  press(at: MapPointer): boolean {
    const reach_m = reachPx / at.pixels_per_m;
    if (this.sketch) {
      this.sketch.press(this.snapped(at));
      this.refresh();
      return true;
    }
    const arrow_m = arrowPx / at.pixels_per_m;
    const { drawing, selected } = this.edited;
    const grip = grip_at(drawing, selected, at, reach_m, arrow_m);
    const item = grip && item_of(drawing, grip.ref);
    if (!grip || !item) {
      if (selected) this.edited.select(null);
      return false;
    }
    this.held = { grip, item, from: at };
    this.edited.select(grip.ref);
    return true;
  }

  move(at: MapPointer, pressed: boolean): void {
    if (this.sketch) {
      this.sketch.move(this.snapped(at));
      this.refresh();
    } else if (pressed && this.held && !at.tapped) {
      this.drag(this.held, at);
    }
  }

  lift(at: MapPointer): void {
    if (this.sketch) {
      const drawn = this.sketch.lift(this.snapped(at), at.tapped, reachPx / at.pixels_per_m);
      if (drawn) this.complete(drawn);
      else this.refresh();
      return;
    }
    this.held = null;
    this.edited.end_drag(true);
  }

  cancel(): void {
    this.sketch?.cancel_press();
    this.held = null;
    this.edited.end_drag(false);
    this.refresh();
  }

  // ---- keys; true: the editor has handled it

  key(event: KeyboardEvent): boolean {
    const control = event.ctrlKey || event.metaKey;
    const letter = event.key.toLowerCase();
    if (control && letter === "z" && !event.shiftKey) this.edited.undo();
    else if (control && (letter === "y" || letter === "z")) this.edited.redo();
    else if (control || event.altKey) return false;
    else if (event.key === "Escape") this.escape();
    else if (event.key === "Delete" || event.key === "Backspace") this.take_back();
    else return false;
    return true;
  }

  /** Arrows and Enter on the map: the cursor draws like a pointer. */
  map_key(key: string): boolean {
    if (!this.sketch) return false;
    const steps: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const middle = this.hooks.middle();
    const at = this.cursor ?? this.snapped(middle);
    if (steps[key]) {
      const step_m = this.settings.grid_m || keyStepM;
      const [dx, dy] = this.hooks.on_map(...steps[key]);
      this.cursor = { x: at.x + step_m * dx, y: at.y + step_m * dy, to: "grid" };
      this.sketch.move(this.cursor);
    } else if (key === "Enter") {
      this.sketch.press(at);
      // Enter at the last point ends a line.
      const drawn = this.sketch.lift(at, true, (this.settings.grid_m || keyStepM) / 4);
      if (drawn) this.complete(drawn);
    } else {
      return false;
    }
    this.refresh();
    return true;
  }

  // ---- overlay

  draw_still(context: CanvasRenderingContext2D, view: View): void {
    this.background?.draw(context, view);
    draw_grid(context, view, this.settings.grid_m, this.theme.palette);
  }

  draw_moving(context: CanvasRenderingContext2D, view: View): void {
    const { palette } = this.theme;
    const { drawing, selected } = this.edited;
    draw_drawing(context, view, drawing, palette, selected);
    for (const { ref, item } of all_items(drawing)) {
      if (!("name" in item) || !item.name) continue;
      const shift = is_closed(ref.list) ? 0 : namePx / view.scale;
      const at = middle_of(points_of(item));
      draw_text(context, view, { x: at.x, y: at.y + shift }, item.name, palette);
    }
    const item = this.edited.selected_item();
    if (selected && item) {
      const handles = this.sketch ? [] : handles_of(selected.list, item, arrowPx / view.scale);
      draw_selection(context, view, selected, item, handles, palette);
    }
    if (!this.sketch) return;
    const { name } = this;
    const zone =
      name === "no_go" || name === "slow" || name === "one_way" || name === "preferred";
    const color = zone ? zone_color(name, palette) : palette.drawn;
    draw_sketch(context, view, this.sketch, color, palette);
    if (this.cursor) draw_cursor(context, view, this.cursor, this.cursor.to === "corner", palette);
  }

  private complete(drawn: Finished): void {
    const tool = this.name;
    this.choose(tool);
    if (is_item_tool(tool)) {
      const { drawing } = this.edited;
      const { list, item } = make_item(tool, drawn, drawing);
      const ref = { list, index: drawing[list].length };
      this.edited.edit(with_new(drawing, list, item), ref);
      this.hooks.drawn(item);
    } else if (tool !== "select") {
      this.hooks.asked(tool, drawn);
    }
  }

  private drag({ grip, item, from }: Drag, at: MapPointer): void {
    const anchor = anchor_of(item, grip.part);
    let to: Point = at;
    if (anchor) {
      // The anchor keeps its offset from the pointer.
      const wanted = { ...at, x: anchor.x + at.x - from.x, y: anchor.y + at.y - from.y };
      to = this.snapped(wanted, neighbour_of(grip.ref.list, item, grip.part), item);
    } else if (grip.part.what === "middle") {
      to = this.snapped(at, null, item);
    }
    const drawing = with_item(this.edited.drawing, grip.ref, moved(item, grip.part, to));
    this.edited.drag(drawing);
  }

  // own: the dragged item, whose own corners do not attract it.
  private snapped(at: MapPointer, from: Point | null = null, own: Item | null = null): Snapped {
    const wanted = !this.sketch || snaps(this.name);
    const none: SnapSettings = { grid_m: 0, corners: false, right_angles: false };
    const snapped = snap(at, wanted ? this.settings : none, {
      corners: this.corners(own),
      from: this.sketch ? this.sketch.from : from,
      before: this.sketch?.before ?? null,
      reach_m: reachPx / at.pixels_per_m,
    });
    if (this.sketch) this.cursor = snapped;
    return snapped;
  }

  private corners(own: Item | null): Point[] {
    const { drawing, selected } = this.edited;
    const points: Point[] = [...(this.sketch?.points ?? [])];
    for (const { ref, item } of all_items(drawing)) {
      const dragged = own && ref.list === selected?.list && ref.index === selected.index;
      if (dragged || ref.list === "places") continue;
      const flat = points_of(item);
      for (let i = 0; 2 * i + 1 < flat.length; ++i) points.push(point_at(flat, i));
    }
    return points;
  }

  private take_back(): void {
    if (this.sketch && !this.sketch.is_empty) this.sketch.step_back();
    else this.delete_selected();
    this.refresh();
  }

  private refresh(): void {
    this.hooks.redraw();
    this.hooks.changed();
  }
}
