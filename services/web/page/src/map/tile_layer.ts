// Pictures of the grid and of the rooms, in the colours of the theme. A picture stays until its
// next version arrives, and one of another level until those of the wanted level arrive.
import { beside_page } from "../address";
import { MapInfo } from "../protocol";
import { Palette } from "../ui/theme";
import {
  CellBox,
  tilePixels,
  level_for,
  tile_key,
  tiles_in,
  TileVersions,
  to_map,
} from "./grid_frame";
import { View } from "./map_canvas";
import { to_pixels } from "./to_pixels";

const retryMs = 2000;
const keptTiles = 220;

interface Tile {
  picture: HTMLCanvasElement | null;
  known: CellBox | null; // around the visible pixels
  version: string; // shown or on its way
  used: number;
}

type Recolor = (pixels: Uint8ClampedArray) => void;

export class TileLayer {
  private readonly tiles = new Map<string, Tile>();
  private shown_level = 0;
  private uses = 0;
  private generation = 0; // changes when all pictures become invalid

  /** layer: as in the address; on_load: called when a redraw is due. */
  constructor(
    private readonly layer: "grid" | "rooms",
    private readonly recolor: () => Recolor,
    private readonly on_load: () => void,
  ) {}

  clear(): void {
    this.tiles.clear();
    ++this.generation;
  }

  /**
   * extra: further state that the pictures depend on. Returns true when the whole view is
   * available.
   */
  draw(
    context: CanvasRenderingContext2D,
    view: View,
    info: MapInfo,
    versions: TileVersions,
    extra = "",
  ): boolean {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const level = level_for(view.scale * info.resolution_m * ratio);
    const complete = this.load(view, info, versions, level, extra);
    context.save();
    // Maps grid cells, rows upwards, to pixels.
    const angle = info.theta_rad + view.turn_rad;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const cell = view.scale * info.resolution_m;
    const [x, y] = to_map(info, 0, 0);
    context.transform(
      cell * cos,
      -cell * sin,
      -cell * sin,
      -cell * cos,
      ...to_pixels(view, x, y),
    );
    context.imageSmoothingEnabled = cell * 2 ** level < 1;
    if (complete) {
      this.shown_level = level;
    } else if (this.shown_level !== level) {
      this.paint(context, view, info, this.shown_level);
    }
    this.paint(context, view, info, level);
    context.restore();
    this.forget();
    return complete;
  }

  private paint(context: CanvasRenderingContext2D, view: View, info: MapInfo, level: number): void {
    const range = tiles_in(info, level, view);
    const side = tilePixels * 2 ** level;
    for (let row = range.first_row; row <= range.last_row; ++row) {
      for (let column = range.first_column; column <= range.last_column; ++column) {
        const tile = this.tiles.get(tile_key(level, column, row));
        if (!tile?.picture) continue;
        tile.used = ++this.uses;
        context.save();
        context.translate(column * side, (row + 1) * side);
        context.scale(1, -1);
        context.drawImage(tile.picture, 0, 0, side, side);
        context.restore();
      }
    }
  }

  // Fetches missing pictures; returns true when the view is complete.
  private load(
    view: View,
    info: MapInfo,
    versions: TileVersions,
    level: number,
    extra: string,
  ): boolean {
    const range = tiles_in(info, level, view);
    let complete = true;
    for (let row = range.first_row; row <= range.last_row; ++row) {
      for (let column = range.first_column; column <= range.last_column; ++column) {
        const version = versions.of(level, column, row);
        if (version === undefined) continue;
        const key = tile_key(level, column, row);
        const wanted = `${version}${extra}`;
        const tile = this.tiles.get(key);
        if (tile?.version !== wanted) this.fetch(info, key, wanted);
        if (!tile?.picture) complete = false;
      }
    }
    return complete;
  }

  private fetch(info: MapInfo, key: string, version: string): void {
    const generation = this.generation;
    const before = this.tiles.get(key);
    const tile: Tile = {
      picture: before?.picture ?? null,
      known: before?.known ?? null,
      version,
      used: ++this.uses,
    };
    this.tiles.set(key, tile);
    const image = new Image();
    image.onload = () => {
      if (generation !== this.generation || tile.version !== version) return;
      this.paint_tile(tile, key, image);
      this.on_load();
    };
    image.onerror = () => {
      // The service may be restarting.
      window.setTimeout(() => {
        if (tile.version === version) tile.version = "";
        this.on_load();
      }, retryMs);
    };
    image.src = beside_page(`/tiles/${this.layer}/${info.frame}/${key}.png?v=${version}`);
  }

  /** The box around the known part; null while one of its pictures is missing. */
  known_cells(versions: TileVersions): CellBox | null {
    const prefix = `${this.shown_level}/`;
    const tiles = [...this.tiles].filter(([key, tile]) => tile.picture && key.startsWith(prefix));
    if (tiles.length === 0 || tiles.length < versions.count(this.shown_level)) return null;
    const boxes = tiles.flatMap(([, { known }]) => (known ? [known] : []));
    const least = (i: 0 | 1) => Math.min(...boxes.map((box) => box.low[i]));
    const most = (i: 0 | 1) => Math.max(...boxes.map((box) => box.high[i]));
    return boxes.length > 0 ? { low: [least(0), least(1)], high: [most(0), most(1)] } : null;
  }

  private paint_tile(tile: Tile, key: string, image: HTMLImageElement): void {
    const canvas = document.createElement("canvas");
    canvas.width = tilePixels;
    canvas.height = tilePixels;
    const context = canvas.getContext("2d", { willReadFrequently: true });
    if (!context) return;
    context.drawImage(image, 0, 0);
    const pixels = context.getImageData(0, 0, tilePixels, tilePixels);
    tile.known = known_of(key, pixels.data);
    this.recolor()(pixels.data);
    context.putImageData(pixels, 0, 0);
    tile.picture = canvas;
  }

  private forget(): void {
    if (this.tiles.size <= keptTiles) return;
    const oldest = [...this.tiles.entries()].sort((a, b) => a[1].used - b[1].used);
    for (const [key] of oldest.slice(0, this.tiles.size - keptTiles)) this.tiles.delete(key);
  }
}

function known_of(key: string, pixels: Uint8ClampedArray): CellBox | null {
  let [left, right, top, bottom] = [tilePixels, -1, tilePixels, -1];
  for (let i = 0; i < tilePixels * tilePixels; ++i) {
    if (pixels[4 * i + 3] === 0) continue;
    const line = Math.floor(i / tilePixels);
    left = Math.min(left, i % tilePixels);
    right = Math.max(right, i % tilePixels);
    top = Math.min(top, line);
    bottom = line;
  }
  if (right < 0) return null;
  const [level, column, row] = key.split("/").map(Number);
  const cells = 2 ** level;
  const above = tilePixels * (row + 1); // the first line of a picture is the top one
  return {
    low: [cells * (tilePixels * column + left), cells * (above - bottom - 1)],
    high: [cells * (tilePixels * column + right + 1), cells * (above - top)],
  };
}

// Colours that the service paints.
const roomColors = [0x8dd3c7, 0xffffb3, 0xbebada, 0xfb8072, 0x80b1d3, 0xfdb462];

function rgb(color: string): [number, number, number] {
  const value = parseInt(color.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}

/** Free and occupied cells in the colours of the theme ("#rrggbb"). */
export function recolor_grid(palette: Palette): Recolor {
  const free = rgb(palette.free);
  const occupied = rgb(palette.occupied);
  return (pixels) => {
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] === 0) continue;
      const color = pixels[i] > 127 ? free : occupied;
      [pixels[i], pixels[i + 1], pixels[i + 2]] = color;
    }
  };
}

/** Rooms in the colours of the theme. */
export function recolor_rooms(palette: Palette): Recolor {
  const colors = new Map(roomColors.map((color, i) => [color, rgb(palette.rooms[i])]));
  return (pixels) => {
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] === 0) continue;
      const color = colors.get((pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2]);
      if (color) [pixels[i], pixels[i + 1], pixels[i + 2]] = color;
    }
  };
}
