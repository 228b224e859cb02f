// The part of Leaflet 1.7 that the page uses; Debian's package has no types.
declare module "leaflet" {
  export class Point {
    x: number;
    y: number;
    subtract(other: Point): Point;
    add(other: Point): Point;
    multiplyBy(factor: number): Point;
    divideBy(factor: number): Point;
    distanceTo(other: Point): number;
    round(): Point;
  }
  export function point(x: number, y: number): Point;

  // In CRS.Simple: lat is y, lng is x, in metres.
  export interface LatLng {
    lat: number;
    lng: number;
  }
  export function latLng(lat: number, lng: number): LatLng;
  export type LatLngTuple = [number, number];
  export interface LatLngBounds {
    isValid(): boolean;
    contains(bounds: LatLngBounds | LatLngTuple): boolean;
    getSouthWest(): LatLng;
    getNorthEast(): LatLng;
  }
  export function latLngBounds(corners: LatLngTuple[]): LatLngBounds;

  export interface MapEvent {
    center: LatLng;
    zoom: number;
    latlng: LatLng;
    containerPoint: Point;
    originalEvent: MouseEvent;
  }
  export interface Handler {
    enable(): void;
    disable(): void;
    enabled(): boolean;
  }
  export interface MapOptions {
    crs?: unknown;
    center?: LatLngTuple;
    zoom?: number;
    minZoom?: number;
    maxZoom?: number;
    zoomSnap?: number;
    zoomDelta?: number;
    wheelPxPerZoomLevel?: number;
    zoomControl?: boolean;
    attributionControl?: boolean;
    keyboard?: boolean;
    boxZoom?: boolean;
    zoomAnimation?: boolean;
    inertia?: boolean;
    tap?: boolean;
  }
  export class Map {
    dragging: Handler;
    doubleClickZoom: Handler;
    keyboard: Handler;
    on(types: string, handler: (event: MapEvent) => void): this;
    off(types: string, handler: (event: MapEvent) => void): this;
    getContainer(): HTMLElement;
    getPane(name: string): HTMLElement;
    createPane(name: string): HTMLElement;
    getSize(): Point;
    getZoom(): number;
    getZoomScale(to: number, from: number): number;
    getCenter(): LatLng;
    getPixelOrigin(): Point;
    getBounds(): LatLngBounds;
    project(at: LatLng | LatLngTuple, zoom: number): Point;
    containerPointToLayerPoint(at: Point): Point;
    containerPointToLatLng(at: Point): LatLng;
    latLngToContainerPoint(at: LatLng | LatLngTuple): Point;
    mouseEventToLatLng(event: MouseEvent): LatLng;
    setView(center: LatLngTuple, zoom?: number, options?: { animate?: boolean; reset?: boolean }): this;
    panTo(center: LatLngTuple, options?: { animate?: boolean; duration?: number }): this;
    fitBounds(
      bounds: LatLngBounds,
      options?: {
        animate?: boolean;
        padding?: [number, number];
        paddingTopLeft?: [number, number];
        paddingBottomRight?: [number, number];
        maxZoom?: number;
      },
    ): this;
    zoomIn(): this;
    zoomOut(): this;
    invalidateSize(options?: { pan?: boolean }): this;
  }
  export function map(container: HTMLElement, options?: MapOptions): Map;

  export const CRS: { Simple: unknown };
  export const DomUtil: {
    setPosition(element: HTMLElement, at: Point): void;
    getPosition(element: HTMLElement): Point;
    setTransform(element: HTMLElement, offset: Point, scale?: number): void;
  };
  export const Browser: { any3d: boolean };
}
