// Press at the robot's position, drag in the direction of its heading.
import { MapPointer, MapTool } from "./map_tool";
import { PoseMark } from "./robot_layer";

export class PoseTool implements MapTool {
  private from: MapPointer | null = null;

  /** heading: used until the drag gives one; on_change: called at each move. */
  constructor(
    private readonly heading: () => number,
    private readonly on_change: (mark: PoseMark) => void,
  ) {}

  press(at: MapPointer): boolean {
    this.from = at;
    this.pass_on(at);
    return true;
  }

  move(at: MapPointer, pressed: boolean): void {
    if (pressed) this.pass_on(at);
  }

  lift(at: MapPointer): void {
    this.pass_on(at);
    this.from = null;
  }

  cancel(): void {
    this.from = null;
  }

  private pass_on(at: MapPointer): void {
    if (!this.from) return;
    const { x, y } = this.from;
    const theta = at.tapped ? this.heading() : Math.atan2(at.y - y, at.x - x);
    this.on_change({ x, y, theta });
  }
}
