// Geometry of the map's grid: squares of 64 x 64 cells, pictures of 256 x 256 pixels in levels.
import { MapInfo } from "../protocol";

export const squareCells = 64;
export const tilePixels = 256;
export const largestLevel = 8;
const squaresPerTile = tilePixels / squareCells;

/** A range of pictures of a level, both ends included. */
export interface TileRange {
  first_column: number;
  last_column: number;
  first_row: number;
  last_row: number;
}

/** A rectangle of the map frame, metres. */
export interface Box {
  min_x: number;
  min_y: number;
  max_x: number;
  max_y: number;
}

/** A point of the grid (cells from its lower left corner) in the map frame. */
export function to_map(info: MapInfo, column: number, row: number): [number, number] {
  const x = column * info.resolution_m;
  const y = row * info.resolution_m;
  const [cos, sin] = [Math.cos(info.theta_rad), Math.sin(info.theta_rad)];
  return [info.x_m + cos * x - sin * y, info.y_m + sin * x + cos * y];
}

/** A point of the map frame in cells of the grid. */
export function to_grid(info: MapInfo, x_m: number, y_m: number): [number, number] {
  const [dx, dy] = [x_m - info.x_m, y_m - info.y_m];
  const [cos, sin] = [Math.cos(info.theta_rad), Math.sin(info.theta_rad)];
  return [(cos * dx + sin * dy) / info.resolution_m, (cos * dy - sin * dx) / info.resolution_m];
}

/** The box around a rectangle of cells. */
export function box_of_cells(info: MapInfo, low: [number, number], high: [number, number]): Box {
  const corners = [low, high, [low[0], high[1]], [high[0], low[1]]].map(([c, r]) =>
    to_map(info, c, r),
  );
  const xs = corners.map((corner) => corner[0]);
  const ys = corners.map((corner) => corner[1]);
  return {
    min_x: Math.min(...xs),
    max_x: Math.max(...xs),
    min_y: Math.min(...ys),
    max_y: Math.max(...ys),
  };
}

/** Ends of a rectangle of cells. */
export interface CellBox {
  low: [number, number]; // column, row
  high: [number, number];
}

/** The box around the known squares; null without any. */
export function known_box(info: MapInfo, squares: Iterable<string>): Box | null {
  const in_row = Math.ceil(info.columns / squareCells);
  let [low_c, low_r, high_c, high_r] = [Infinity, Infinity, -1, -1];
  for (const key of squares) {
    const column = Number(key) % in_row;
    const row = Math.floor(Number(key) / in_row);
    low_c = Math.min(low_c, column);
    high_c = Math.max(high_c, column);
    low_r = Math.min(low_r, row);
    high_r = Math.max(high_r, row);
  }
  if (high_c < 0) return null;
  const low: [number, number] = [squareCells * low_c, squareCells * low_r];
  return box_of_cells(info, low, [
    Math.min(squareCells * (high_c + 1), info.columns),
    Math.min(squareCells * (high_r + 1), info.rows),
  ]);
}

/** The level whose pixels are at least as fine as screen pixels at `pixels_per_cell`. */
export function level_for(pixels_per_cell: number): number {
  return Math.max(0, Math.min(largestLevel, Math.floor(-Math.log2(pixels_per_cell))));
}

/** The pictures of a level that touch a box. */
export function tiles_in(info: MapInfo, level: number, box: Box): TileRange {
  const corners = [
    to_grid(info, box.min_x, box.min_y),
    to_grid(info, box.max_x, box.max_y),
    to_grid(info, box.min_x, box.max_y),
    to_grid(info, box.max_x, box.min_y),
  ];
  const cells = tilePixels * 2 ** level;
  const clamp = (value: number, end: number) =>
    Math.max(0, Math.min(Math.ceil(end / cells) - 1, Math.floor(value / cells)));
  const columns = corners.map((corner) => corner[0]);
  const rows = corners.map((corner) => corner[1]);
  return {
    first_column: clamp(Math.min(...columns), info.columns),
    last_column: clamp(Math.max(...columns), info.columns),
    first_row: clamp(Math.min(...rows), info.rows),
    last_row: clamp(Math.max(...rows), info.rows),
  };
}

export function tile_key(level: number, column: number, row: number): string {
  return `${level}/${column}/${row}`;
}

/** Versions of pictures: the largest among the squares that they cover. */
export class TileVersions {
  private readonly versions = new Map<string, number>();

  clear(): void {
    this.versions.clear();
  }

  /** Takes the version of a square into account on all levels. */
  add(info: MapInfo, square: number, version: number): void {
    const in_row = Math.ceil(info.columns / squareCells);
    let column = Math.floor((square % in_row) / squaresPerTile);
    let row = Math.floor(Math.floor(square / in_row) / squaresPerTile);
    for (let level = 0; level <= largestLevel; ++level) {
      const key = tile_key(level, column, row);
      this.versions.set(key, Math.max(version, this.versions.get(key) ?? 0));
      column >>= 1;
      row >>= 1;
    }
  }

  /** Number of pictures of a level. */
  count(level: number): number {
    const prefix = `${level}/`;
    return [...this.versions.keys()].filter((key) => key.startsWith(prefix)).length;
  }

  /** undefined if nothing is known. */
  of(level: number, column: number, row: number): number | undefined {
    return this.versions.get(tile_key(level, column, row));
  }
}
