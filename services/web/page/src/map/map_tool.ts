// A tool that takes presses and drags on the map. Two fingers, and presses that the tool refuses,
// still move the map.
import * as L from "leaflet";

/** Position of a pointer. */
export interface MapPointer {
  x: number; // metres, map frame
  y: number;
  pixels_per_m: number;
  tapped: boolean; // it has not moved since the press
}

export interface MapTool {
  /** A press; true: the following drag belongs to the tool, not to the map. */
  press(at: MapPointer): boolean;
  /** The pointer moves; pressed: after an accepted press. */
  move(at: MapPointer, pressed: boolean): void;
  lift(at: MapPointer): void;
  /** The press was not intended: another finger has come. */
  cancel(): void;
}

const tapPx = 8;

export class ToolListener {
  private tool: MapTool | null = null;
  private pressed: { id: number; x: number; y: number; tapped: boolean } | null = null;
  private readonly down = new Set<number>();

  constructor(private readonly map: L.Map) {
    const container = map.getContainer();
    // Handled before Leaflet.
    container.addEventListener("pointerdown", (event) => this.on_down(event), true);
    container.addEventListener("pointermove", (event) => this.on_move(event));
    window.addEventListener("pointerup", (event) => this.on_up(event));
    window.addEventListener("pointercancel", (event) => {
      this.down.delete(event.pointerId);
      if (this.pressed?.id === event.pointerId) this.give_up();
    });
  }

  get active(): boolean {
    return this.tool !== null;
  }

  /** null: the map only moves. class_name: of the map's element while the tool is active. */
  set(tool: MapTool | null, class_name = ""): void {
    if (this.pressed) this.give_up();
    const container = this.map.getContainer();
    container.classList.remove("setting-pose", "drawing", "selecting");
    if (class_name) container.classList.add(class_name);
    if (tool) this.map.doubleClickZoom.disable();
    else this.map.doubleClickZoom.enable();
    this.tool = tool;
  }

  private at(event: PointerEvent): MapPointer {
    const { lng, lat } = this.map.mouseEventToLatLng(event);
    const tapped = this.pressed?.tapped ?? false;
    return { x: lng, y: lat, pixels_per_m: 2 ** this.map.getZoom(), tapped };
  }

  private on_down(event: PointerEvent): void {
    this.down.add(event.pointerId);
    if (!this.tool || event.button !== 0) return;
    if (this.pressed || this.down.size > 1) return this.give_up();
    this.pressed = { id: event.pointerId, x: event.clientX, y: event.clientY, tapped: true };
    if (!this.tool.press(this.at(event))) {
      this.pressed = null;
      return;
    }
    this.map.dragging.disable();
    const container = this.map.getContainer();
    if (event.pointerType === "mouse") container.setPointerCapture(event.pointerId);
    container.focus({ preventScroll: true });
  }

  private on_move(event: PointerEvent): void {
    const { tool, pressed } = this;
    if (!tool || (pressed && pressed.id !== event.pointerId)) return;
    if (pressed && Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > tapPx) {
      pressed.tapped = false;
    }
    tool.move(this.at(event), pressed !== null);
  }

  private on_up(event: PointerEvent): void {
    this.down.delete(event.pointerId);
    if (!this.tool || this.pressed?.id !== event.pointerId) return;
    const at = this.at(event);
    this.pressed = null;
    this.map.dragging.enable();
    this.tool.lift(at);
  }

  private give_up(): void {
    if (!this.pressed) return;
    this.pressed = null;
    this.map.dragging.enable();
    this.tool?.cancel();
  }
}
