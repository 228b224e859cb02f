// Nodes and branches of the topo-geometric map. 100,000 branch points are drawn in one pass over
// typed arrays, skipping branches out of view and points closer than a pixel to the last one drawn.
import { NodeKind } from "../protocol";
import { Palette } from "../ui/theme";
import { View } from "./map_canvas";
import { pixel_x, pixel_y, to_pixels } from "./to_pixels";

export interface GraphNode {
  id: number;
  kind: NodeKind;
  x: number; // metres, map frame
  y: number;
}

interface Branch {
  points: Float32Array; // x, y of each point, metres, map frame
  is_virtual: boolean;
  min_x: number;
  min_y: number;
  max_x: number;
  max_y: number;
}

const smallestStepPx = 1.2;

export class GraphLayer {
  private readonly nodes = new Map<number, GraphNode>();
  private readonly branches = new Map<number, Branch>();

  clear(): void {
    this.nodes.clear();
    this.branches.clear();
  }

  set_node(node: GraphNode): void {
    this.nodes.set(node.id, node);
  }

  remove_node(id: number): void {
    this.nodes.delete(id);
  }

  /** points: x, y of each point, metres, map frame. */
  set_branch(id: number, points: Float32Array, is_virtual: boolean): void {
    let [min_x, min_y, max_x, max_y] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let i = 0; i + 1 < points.length; i += 2) {
      min_x = Math.min(min_x, points[i]);
      max_x = Math.max(max_x, points[i]);
      min_y = Math.min(min_y, points[i + 1]);
      max_y = Math.max(max_y, points[i + 1]);
    }
    this.branches.set(id, { points, is_virtual, min_x, min_y, max_x, max_y });
  }

  remove_branch(id: number): void {
    this.branches.delete(id);
  }

  count(): { nodes: number; branches: number } {
    return { nodes: this.nodes.size, branches: this.branches.size };
  }

  draw(context: CanvasRenderingContext2D, view: View, palette: Palette): void {
    context.lineCap = "round";
    context.lineJoin = "round";
    context.strokeStyle = palette.branch;
    context.lineWidth = view.scale > 30 ? 2 : 1.4;
    this.stroke_branches(context, view, false);
    context.setLineDash([4, 5]);
    context.strokeStyle = palette.branch_virtual;
    this.stroke_branches(context, view, true);
    context.setLineDash([]);
    if (view.scale >= 6) this.draw_nodes(context, view, palette);
  }

  private stroke_branches(
    context: CanvasRenderingContext2D,
    view: View,
    is_virtual: boolean,
  ): void {
    context.beginPath();
    for (const branch of this.branches.values()) {
      if (branch.is_virtual !== is_virtual) continue;
      if (branch.max_x < view.min_x || branch.min_x > view.max_x) continue;
      if (branch.max_y < view.min_y || branch.min_y > view.max_y) continue;
      trace(context, view, branch.points);
    }
    context.stroke();
  }

  private draw_nodes(context: CanvasRenderingContext2D, view: View, palette: Palette): void {
    const size = Math.max(2.5, Math.min(6, view.scale / 8));
    for (const node of this.nodes.values()) {
      const [x, y] = to_pixels(view, node.x, node.y);
      if (x < -10 || y < -10 || x > view.width + 10 || y > view.height + 10) continue;
      draw_node(context, node.kind, x, y, size, palette);
    }
  }
}

function trace(context: CanvasRenderingContext2D, view: View, points: Float32Array): void {
  const last = points.length - 2;
  let last_x = 0;
  let last_y = 0;
  for (let i = 0; i <= last; i += 2) {
    const x = pixel_x(view, points[i], points[i + 1]);
    const y = pixel_y(view, points[i], points[i + 1]);
    if (i === 0) {
      context.moveTo(x, y);
    } else {
      const step = Math.abs(x - last_x) + Math.abs(y - last_y);
      if (step < smallestStepPx && i !== last) continue;
      context.lineTo(x, y);
    }
    last_x = x;
    last_y = y;
  }
}

/** The sign for a kind of node, also used in the legend. Centre and size in pixels. */
export function draw_node(
  context: CanvasRenderingContext2D,
  kind: NodeKind,
  x: number,
  y: number,
  size: number,
  palette: Palette,
): void {
  context.beginPath();
  switch (kind) {
    case "door":
      context.rect(x - size, y - size, 2 * size, 2 * size);
      break;
    case "narrowing":
      context.moveTo(x - size, y - size);
      context.lineTo(x + size, y + size);
      context.lineTo(x + size, y - size);
      context.lineTo(x - size, y + size);
      context.closePath();
      break;
    case "hall_corridor":
      context.moveTo(x, y - 1.3 * size);
      context.lineTo(x + 1.3 * size, y);
      context.lineTo(x, y + 1.3 * size);
      context.lineTo(x - 1.3 * size, y);
      context.closePath();
      break;
    default:
      context.arc(x, y, kind === "real" ? size : 0.75 * size, 0, 2 * Math.PI);
  }
  const hollow = kind === "fictitious" || kind === "virtual";
  context.fillStyle = hollow ? palette.free : palette.nodes[kind];
  context.fill();
  context.strokeStyle = hollow ? palette.nodes[kind] : palette.free;
  context.lineWidth = hollow ? 1.5 : 1;
  context.stroke();
}
