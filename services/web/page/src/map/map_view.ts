// The map on the page: pan, zoom, fit, follow, and the handling of taps and drags.
import * as L from "leaflet";
import { Channels } from "../channels";
import { Theme } from "../ui/theme";
import { Box } from "./grid_frame";
import { MapCanvas } from "./map_canvas";
import { MapScene } from "./map_scene";
import { MapPointer, MapTool, ToolListener } from "./map_tool";
import { MeasureTool } from "./measure_tool";
import { PoseTool } from "./pose_tool";
import { PoseMark } from "./robot_layer";
import { Turn } from "./turn";

const turnKey = "topogeo-turn";
const measureAbove = "measure";
const firstZoom = 4; // 16 pixels per metre
const largestFitZoom = 6;

export class MapView {
  readonly scene: MapScene;
  readonly stage: HTMLElement; // around the map, holds notes on it
  private readonly map: L.Map;
  private readonly turn = new Turn();
  private readonly still: MapCanvas;
  private readonly moving: MapCanvas;
  private readonly scale_bar: HTMLElement;
  private moved = false; // by a person: until then a growing map is kept in view
  private following = false;
  private measuring = false;
  private fitted = ""; // the last fitted box
  private readonly tools: ToolListener;

  on_tap: (x_m: number, y_m: number, pixels_per_m: number) => void = () => undefined;
  /** Another tool has ended a measurement. */
  on_tool: () => void = () => undefined;
  /** The pointer of a mouse is at this point, metres; null: it has left the map. */
  on_point: (point: { x_m: number; y_m: number } | null) => void = () => undefined;
  on_follow: (following: boolean) => void = () => undefined;

  /** container: filled by the map; scale_bar: gets width and text. */
  constructor(
    container: HTMLElement,
    scale_bar: HTMLElement,
    private readonly channels: Channels,
    theme: Theme,
  ) {
    this.scale_bar = scale_bar;
    this.stage = scale_bar.parentElement ?? container;
    this.turn.quarter = Number(localStorage.getItem(turnKey) ?? 0) || 0;
    this.map = L.map(container, {
      crs: this.turn.crs,
      center: [0, 0],
      zoom: firstZoom,
      minZoom: -5,
      maxZoom: 9,
      zoomSnap: 0.25,
      zoomDelta: 1,
      wheelPxPerZoomLevel: 90,
      zoomControl: false,
      attributionControl: false,
      tap: false,
    });
    this.scene = new MapScene(
      channels,
      theme,
      () => this.on_still_change(),
      () => this.on_moving_change(),
    );
    this.still = new MapCanvas(this.map, this.turn, 1, 0.25, (c, view) => this.scene.draw_still(c, view));
    this.moving = new MapCanvas(this.map, this.turn, 2, 0.1, (c, view) => this.scene.draw_moving(c, view));
    this.map.on("click", (event) => {
      if (this.tools.active) return;
      this.on_tap(event.latlng.lng, event.latlng.lat, 2 ** this.map.getZoom());
    });
    container.addEventListener("pointermove", (event) => {
      if (event.pointerType !== "mouse") return;
      const { lng, lat } = this.map.mouseEventToLatLng(event);
      this.on_point({ x_m: lng, y_m: lat });
    });
    container.addEventListener("pointerleave", () => this.on_point(null));
    this.map.on("dragstart", () => {
      this.moved = true;
      this.follow(false);
    });
    // Leaflet uses the key 6 as "minus"; here it opens a view.
    const { keyboard } = this.map as unknown as { keyboard: { _zoomKeys: Record<number, number> } };
    delete keyboard._zoomKeys[54];
    container.addEventListener("keydown", (event) => {
      if (this.tools.active || !/^(Arrow.*|[-+=])$/.test(event.key)) return;
      this.moved = true;
      if (event.key.startsWith("Arrow")) this.follow(false);
    });
    container.addEventListener("wheel", () => (this.moved = true), { passive: true });
    container.addEventListener("touchmove", () => (this.moved = true), { passive: true });
    this.map.on("resize", () => {
      this.fitted = "";
      this.on_still_change();
    });
    this.map.on("zoom zoomend move resize", () => this.show_scale());
    new ResizeObserver(() => this.map.invalidateSize({ pan: false })).observe(container);
    this.tools = new ToolListener(this.map);
    this.show_scale();
  }

  zoom_in(): void {
    this.moved = true;
    this.map.zoomIn();
  }

  zoom_out(): void {
    this.moved = true;
    this.map.zoomOut();
  }

  /** Turns the map by a quarter, counter-clockwise. This browser keeps it. */
  turn_on(): void {
    const { lat, lng } = this.map.getCenter();
    this.turn.quarter += 1;
    localStorage.setItem(turnKey, String(this.turn.quarter));
    this.map.setView([lat, lng], this.map.getZoom(), { reset: true });
    this.fitted = "";
    this.on_still_change();
  }

  /** A step on the screen (to the right, up) in the map frame. */
  on_map(right: number, up: number): [number, number] {
    return this.turn.back(right, up);
  }

  /** Shows the whole known floor, also while it grows. */
  fit(animate = true): void {
    this.moved = false;
    const box = this.scene.box();
    if (!box) return;
    const key = JSON.stringify(box);
    if (key === this.fitted && !animate) return;
    this.fitted = key;
    const bounds = L.latLngBounds([
      [box.min_y, box.min_x],
      [box.max_y, box.max_x],
    ]);
    const options = { animate, maxZoom: largestFitZoom };
    this.map.fitBounds(bounds, {
      ...options,
      paddingTopLeft: [24, 24],
      paddingBottomRight: [64, 40],
    });
  }

  follow(following: boolean): void {
    if (this.following === following) return;
    this.following = following;
    this.on_follow(following);
    this.moved = true;
    if (following) this.center_on_robot();
  }

  is_following(): boolean {
    return this.following;
  }

  /** Brings a point into view. */
  show(x_m: number, y_m: number): void {
    if (!this.map.getBounds().contains([y_m, x_m])) this.map.panTo([y_m, x_m]);
  }

  /** Brings a rectangle into view. */
  show_box(box: Box): void {
    this.follow(false);
    this.moved = true;
    const bounds = L.latLngBounds([
      [box.min_y, box.min_x],
      [box.max_y, box.max_x],
    ]);
    this.map.fitBounds(bounds, { padding: [32, 32], maxZoom: largestFitZoom });
  }

  /** Sets whether arrow keys move the map. */
  take_keys(take: boolean): void {
    if (take) this.map.keyboard.enable();
    else this.map.keyboard.disable();
  }

  /**
   * Lets a press and drag on the map set a pose: position at its start, heading towards its end.
   */
  start_pose(on_change: (mark: PoseMark) => void): void {
    const before = () => this.scene.pose_mark?.theta ?? 0;
    const show = (mark: PoseMark) => {
      this.scene.pose_mark = mark;
      this.moving.redraw();
      on_change(mark);
    };
    this.leave_measuring();
    this.tools.set(new PoseTool(before, show), "setting-pose");
  }

  end_pose(): void {
    this.end_tool();
  }

  /** Gives presses and drags to a tool. drawing: it draws, else it grabs existing items. */
  start_tool(tool: MapTool, drawing: boolean): void {
    this.leave_measuring();
    this.tools.set(tool, drawing ? "drawing" : "selecting");
  }

  /** Measures distances until stop_measuring(); on_change gets the length, metres. */
  start_measuring(on_change: (meters: number | null) => void): void {
    const tool = new MeasureTool((meters) => {
      on_change(meters);
      this.moving.redraw();
    });
    this.scene.above.set(measureAbove, (context, view, palette) => tool.draw(context, view, palette));
    this.tools.set(tool, "drawing");
    this.measuring = true;
  }

  // Another tool takes the place of the measure.
  private leave_measuring(): void {
    if (!this.measuring) return;
    this.stop_measuring();
    this.on_tool();
  }

  stop_measuring(): void {
    if (!this.measuring) return;
    this.measuring = false;
    this.scene.above.delete(measureAbove);
    this.tools.set(null);
    this.moving.redraw();
  }

  end_tool(): void {
    this.tools.set(null);
  }

  /** The point in the middle of the view, metres, and its scale. */
  middle(): MapPointer {
    const { lng, lat } = this.map.getCenter();
    return { x: lng, y: lat, pixels_per_m: 2 ** this.map.getZoom(), tapped: true };
  }

  /** Shows or hides an empty plane for a new floor. Returns true for a change. */
  show_plane(plane: boolean): boolean {
    const { classList } = this.map.getContainer();
    const changed = classList.contains("plane") !== plane;
    classList.toggle("plane", plane);
    return changed;
  }

  /** Redraws the moving parts. */
  redraw_moving(): void {
    this.moving.redraw();
  }

  private on_still_change(): void {
    if (!this.moved && !this.following) this.fit(false);
    this.still?.redraw();
  }

  private on_moving_change(): void {
    if (this.following) this.center_on_robot();
    this.moving?.redraw();
  }

  private center_on_robot(): void {
    const pose = this.channels.value("pose");
    if (!pose || pose.state === "SEARCHING" || pose.state === "LOST") return;
    const center = this.map.getCenter();
    const off_px =
      Math.hypot(pose.x_m - center.lng, pose.y_m - center.lat) * 2 ** this.map.getZoom();
    if (off_px > 2) this.map.panTo([pose.y_m, pose.x_m], { animate: off_px > 60, duration: 0.3 });
  }

  // A bar of 1, 2 or 5 times a power of ten metres, at most 120 pixels long.
  private show_scale(): void {
    const scale = 2 ** this.map.getZoom();
    const most = 120 / scale;
    const power = 10 ** Math.floor(Math.log10(most));
    const meters = [5, 2, 1].map((step) => step * power).find((step) => step <= most) ?? power;
    this.scale_bar.style.width = `${Math.round(meters * scale)}px`;
    const text = meters >= 1000 ? `${meters / 1000} km` : `${Number(meters.toPrecision(1))} m`;
    if (this.scale_bar.textContent !== text) this.scale_bar.textContent = text;
  }
}
