// A canvas on the map that is redrawn only when the view leaves it or the zoom changes: during a
// drag of the map, the browser shifts the drawn picture, whatever its content.
import * as L from "leaflet";
import { Turn } from "./turn";

/**
 * Conversion from metres of the map frame to pixels of a canvas, see to_pixels().
 */
export interface View {
  scale: number; // pixels per metre
  offset_x: number;
  offset_y: number;
  turn_rad: number; // of the map, counter-clockwise: a multiple of 90 degrees
  cos: number;
  sin: number;
  width: number; // pixels
  height: number;
  // The visible part, metres.
  min_x: number;
  min_y: number;
  max_x: number;
  max_y: number;
}

export type Draw = (context: CanvasRenderingContext2D, view: View) => void;

export class MapCanvas {
  private readonly canvas = document.createElement("canvas");
  private readonly context: CanvasRenderingContext2D;
  private top_left: L.LatLng = { lat: 0, lng: 0 };
  private painted = { min_x: 0, max_x: 0, min_y: 0, max_y: 0 };
  private zoom = Number.NaN;
  private frame = 0;
  private zooming = false; // animated: the picture is scaled until the end

  /** padding: margin of the canvas beyond the view on each side, as a share of the view. */
  constructor(
    private readonly map: L.Map,
    private readonly turn: Turn,
    z_index: number,
    private readonly padding: number,
    private readonly draw: Draw,
  ) {
    const context = this.canvas.getContext("2d");
    if (!context) throw new Error("this browser has no 2D canvas");
    this.context = context;
    this.canvas.className = "map-canvas leaflet-zoom-animated";
    this.canvas.style.zIndex = String(z_index);
    this.canvas.setAttribute("aria-hidden", "true");
    map.getPane("overlayPane").append(this.canvas);
    map.on("zoomanim", (event) => {
      this.zooming = true;
      this.transform(event.center, event.zoom);
    });
    map.on("zoom", () => this.transform(map.getCenter(), map.getZoom()));
    map.on("move", () => this.redraw_if_left());
    map.on("moveend", () => this.redraw_if_left());
    map.on("zoomend viewreset resize", () => {
      this.zooming = false;
      this.redraw();
    });
    this.redraw();
  }

  /** Redraws with the next frame. */
  redraw(): void {
    if (this.frame !== 0) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      if (!this.zooming) this.paint();
    });
  }

  private redraw_if_left(): void {
    if (this.map.getZoom() !== this.zoom) return; // during a zoom the old picture is scaled
    const bounds = this.map.getBounds();
    const low = bounds.getSouthWest();
    const high = bounds.getNorthEast();
    const inside =
      low.lng >= this.painted.min_x &&
      high.lng <= this.painted.max_x &&
      low.lat >= this.painted.min_y &&
      high.lat <= this.painted.max_y;
    if (!inside) this.redraw();
  }

  private paint(): void {
    const size = this.map.getSize();
    if (size.x === 0 || size.y === 0) return;
    const margin = L.point(Math.ceil(size.x * this.padding), Math.ceil(size.y * this.padding));
    const width = size.x + 2 * margin.x;
    const height = size.y + 2 * margin.y;
    const corner = this.map.containerPointToLayerPoint(margin.multiplyBy(-1)).round();
    this.zoom = this.map.getZoom();
    const origin = this.map.getPixelOrigin().add(corner);
    const scale = 2 ** this.zoom;
    const { turn } = this;
    const [x0, y0] = turn.back(origin.x / scale, -origin.y / scale); // upper left
    const [x1, y1] = turn.back((origin.x + width) / scale, -(origin.y + height) / scale);
    const view: View = {
      scale,
      offset_x: -origin.x,
      offset_y: -origin.y,
      turn_rad: turn.angle_rad,
      cos: turn.cos,
      sin: turn.sin,
      width,
      height,
      min_x: Math.min(x0, x1),
      max_x: Math.max(x0, x1),
      min_y: Math.min(y0, y1),
      max_y: Math.max(y0, y1),
    };
    this.top_left = { lat: y0, lng: x0 };
    this.painted = view;

    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const columns = Math.round(width * ratio);
    const rows = Math.round(height * ratio);
    if (this.canvas.width !== columns || this.canvas.height !== rows) {
      this.canvas.width = columns;
      this.canvas.height = rows;
      this.canvas.style.width = `${width}px`;
      this.canvas.style.height = `${height}px`;
    }
    L.DomUtil.setTransform(this.canvas, corner, 1);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    this.draw(this.context, view);
  }

  // Scales the drawn picture to an intermediate zoom.
  private transform(center: L.LatLng, zoom: number): void {
    if (Number.isNaN(this.zoom)) return;
    const pane = L.DomUtil.getPosition(this.map.getPane("mapPane"));
    const half = this.map.getSize().divideBy(2);
    const origin = this.map.project(center, zoom).subtract(half).add(pane).round();
    const offset = this.map.project(this.top_left, zoom).subtract(origin);
    L.DomUtil.setTransform(this.canvas, offset, this.map.getZoomScale(zoom, this.zoom));
  }
}
