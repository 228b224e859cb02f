// Dark and light: follows the system until the operator chooses. Colours are defined in style.css,
import { NodeKind } from "../protocol";
// where canvases read them.

export interface Palette {
  free: string;
  occupied: string;
  branch: string;
  branch_virtual: string;
  nodes: Record<NodeKind, string>;
  rooms: string[]; // six
  room_alpha: number;
  label: string;
  halo: string;
  robot: string;
  robot_edge: string;
  ellipse: string;
  scan: string;
  trail: string;
  route: string;
  route_edge: string;
  goal: string;
  no_go: string;
  slow: string;
  one_way: string;
  preferred: string;
  drawn: string; // by people
  selected: string;
  grid: string;
  loop: string;
  local: string;
  earlier: string; // for two compared stops
  later: string;
  search: string;
}

const themeKey = "topogeo-theme";
type Choice = "light" | "dark";

export class Theme {
  palette: Palette;
  private readonly listeners: (() => void)[] = [];
  private readonly system = window.matchMedia("(prefers-color-scheme: dark)");

  constructor() {
    this.apply();
    this.palette = read_palette();
    this.system.addEventListener("change", () => this.update());
  }

  is_dark(): boolean {
    return document.documentElement.dataset.theme === "dark";
  }

  toggle(): void {
    localStorage.setItem(themeKey, this.is_dark() ? "light" : "dark");
    this.update();
  }

  on_change(listener: () => void): void {
    this.listeners.push(listener);
  }

  private update(): void {
    this.apply();
    this.palette = read_palette();
    for (const listener of this.listeners) listener();
  }

  private apply(): void {
    const chosen = localStorage.getItem(themeKey) as Choice | null;
    document.documentElement.dataset.theme = chosen ?? (this.system.matches ? "dark" : "light");
  }
}

function read_palette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const color = (name: string) => style.getPropertyValue(`--${name}`).trim();
  return {
    free: color("map-free"),
    occupied: color("map-occupied"),
    branch: color("map-branch"),
    branch_virtual: color("map-branch-virtual"),
    nodes: {
      real: color("map-node-real"),
      fictitious: color("map-node-fictitious"),
      virtual: color("map-node-fictitious"),
      door: color("map-node-door"),
      narrowing: color("map-node-narrowing"),
      hall_corridor: color("map-node-hall"),
    },
    rooms: [0, 1, 2, 3, 4, 5].map((i) => color(`map-room-${i}`)),
    room_alpha: Number(color("map-room-alpha")),
    label: color("map-label"),
    halo: color("map-halo"),
    robot: color("map-robot"),
    robot_edge: color("map-robot-edge"),
    ellipse: color("map-ellipse"),
    scan: color("map-scan"),
    trail: color("map-trail"),
    route: color("map-route"),
    route_edge: color("map-route-edge"),
    goal: color("map-goal"),
    no_go: color("map-no-go"),
    slow: color("map-slow"),
    one_way: color("map-one-way"),
    preferred: color("map-preferred"),
    drawn: color("map-drawn"),
    selected: color("map-selected"),
    grid: color("map-grid"),
    loop: color("map-loop"),
    local: color("map-local"),
    earlier: color("map-earlier"),
    later: color("map-later"),
    search: color("map-search"),
  };
}
