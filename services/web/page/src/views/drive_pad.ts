// Driving by hand: sends an order every 100 ms while a button or a key is held; silence means stop.
import { App } from "../app";
import * as format from "../format";
import { reason } from "../reasons";
import { texts } from "../texts";
import { button, h, icon, IconName, set_text, show } from "../ui/dom";
import { DriveStick } from "./drive_stick";

const periodMs = 100;
const lateMs = 300; // an order or a key press older than this is ignored
const turnRadps = 0.6;
const fastestMps = 0.6;
const firstMps = 0.3;

type Direction = "forward" | "backward" | "turn_left" | "turn_right";

const keyDirections: Record<string, Direction> = {
  w: "forward",
  s: "backward",
  a: "turn_left",
  d: "turn_right",
  ArrowUp: "forward",
  ArrowDown: "backward",
  ArrowLeft: "turn_left",
  ArrowRight: "turn_right",
};

const words = texts.send;

function is_late(event: Event): boolean {
  return performance.now() - event.timeStamp > lateMs;
}

export class DrivePad {
  readonly element: HTMLElement;
  // Held pointers and keys, each with its direction, and the stick.
  private readonly held = new Set<string>();
  private readonly pad: HTMLElement;
  private readonly stick = new DriveStick(
    () => this.hold("stick"),
    () => this.let_go("stick"),
    (event) => !is_late(event),
  );
  private readonly state = h("p", { class: "quiet", role: "status" });
  private readonly toggle: HTMLButtonElement;
  private readonly speed: HTMLInputElement;
  private timer = 0;
  private due_ms = 0;
  private active = false;

  constructor(private readonly app: App) {
    this.speed = h("input", {
      type: "range",
      min: 0.1,
      max: fastestMps,
      step: 0.05,
      value: firstMps,
      id: "drive-speed",
    });
    const value = h("output", { for: "drive-speed" }, format.speed(firstMps));
    this.speed.addEventListener("input", () =>
      set_text(value, format.speed(Number(this.speed.value))),
    );
    this.toggle = button(words.drive_on, () => this.set_active(!this.active), {
      "aria-pressed": "false",
    });
    this.pad = h(
      "div",
      { class: "drive-hands", hidden: true },
      h(
        "div",
        { class: "drive-pad" },
        this.direction("forward", "up"),
        this.direction("turn_left", "left"),
        this.direction("turn_right", "right"),
        this.direction("backward", "down"),
      ),
      this.stick.element,
    );
    this.element = h(
      "div",
      { class: "drive" },
      this.toggle,
      h(
        "div",
        { class: "field-row" },
        h("label", { for: "drive-speed" }, words.drive_speed),
        this.speed,
        value,
      ),
      this.pad,
      this.state,
      h("p", { class: "quiet" }, words.drive_hint),
    );
    this.listen();
    app.channels.on_value(["drive"], () => this.show_state());
    this.show_state();
  }

  /** Releases everything when it becomes inactive. */
  set_active(active: boolean): void {
    if (this.active === active) return;
    this.active = active;
    if (!active) this.release();
    show(this.pad, active);
    if (active) this.toggle.scrollIntoView({ block: "start" });
    set_text(this.toggle, active ? words.drive_off : words.drive_on);
    this.toggle.setAttribute("aria-pressed", String(active));
    this.app.map.take_keys(!active);
  }

  private direction(direction: Direction, picture: IconName): HTMLButtonElement {
    const element = h("button", {
      type: "button",
      class: `button drive-button ${direction}`,
      "aria-label": words[direction],
    });
    element.append(icon(picture));
    const name = (event: PointerEvent) => `${direction}:pointer${event.pointerId}`;
    element.addEventListener("pointerdown", (event) => {
      if (is_late(event)) return;
      element.setPointerCapture(event.pointerId);
      this.hold(name(event));
    });
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
      element.addEventListener(type, (event) => this.let_go(name(event)));
    }
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    // With the keyboard, the button itself is held.
    element.addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return; // Space stops
      event.preventDefault();
      event.stopPropagation();
      this.hold(`${direction}:button`);
    });
    element.addEventListener("keyup", () => this.let_go(`${direction}:button`));
    element.addEventListener("blur", () => this.let_go(`${direction}:button`));
    return element;
  }

  private listen(): void {
    const key_name = (event: KeyboardEvent): string | null => {
      const direction = keyDirections[event.key.length === 1 ? event.key.toLowerCase() : event.key];
      return direction ? `${direction}:key${event.code}` : null;
    };
    document.addEventListener("keydown", (event) => {
      const name = key_name(event);
      if (!this.active || !name || event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement)
        return;
      event.preventDefault();
      if (is_late(event)) return;
      this.hold(name);
    });
    document.addEventListener("keyup", (event) => {
      const name = key_name(event);
      if (name) this.let_go(name);
    });
    window.addEventListener("blur", () => this.release());
    window.addEventListener("pagehide", () => this.release());
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) this.release();
    });
    this.app.rights.on_change(() => {
      if (!this.app.rights.connected) this.set_active(false);
    });
  }

  private hold(name: string): void {
    this.held.add(name);
    if (this.timer !== 0) return;
    this.timer = window.setInterval(() => this.go_on(), periodMs);
    this.go_on();
  }

  private let_go(name: string): void {
    if (this.held.delete(name) && this.held.size === 0) this.release();
  }

  /** Stops the robot although something is held: a new press is needed. */
  let_go_of_all(): void {
    this.release();
  }

  private release(): void {
    this.held.clear();
    this.stick.reset();
    if (this.timer === 0) return;
    window.clearInterval(this.timer);
    this.timer = 0;
    this.due_ms = 0;
    this.app.connection.send({ op: "release" });
  }

  // A page that stood still does not know which keys were released meanwhile.
  private go_on(): void {
    const now_ms = performance.now();
    const late = this.due_ms !== 0 && now_ms - this.due_ms > lateMs;
    this.due_ms = now_ms + periodMs;
    if (late) this.release();
    else this.send();
  }

  private send(): void {
    const wants = (direction: Direction) =>
      [...this.held].some((name) => name.startsWith(`${direction}:`)) ? 1 : 0;
    const within = (share: number) => Math.max(-1, Math.min(1, share));
    const { ahead, left } = this.stick.order;
    const speed = Number(this.speed.value) * within(ahead + wants("forward") - wants("backward"));
    // Also when driving backwards, a key to the left turns the robot's front to the left.
    const turn = turnRadps * within(left + wants("turn_left") - wants("turn_right"));
    this.app.connection.drive(speed, turn);
  }

  private show_state(): void {
    const drive = this.app.channels.value("drive");
    if (!drive) return set_text(this.state, words.drive_idle);
    const { linear_mps, angular_radps, free_ahead_m, free_behind_m } = drive;
    const stands = !linear_mps && !angular_radps;
    const now = stands
      ? words.drive_stands
      : `${words.drive_state(linear_mps, linear_mps ? free_ahead_m : null, free_behind_m)}.`;
    set_text(this.state, drive.message ? `${now} ${reason(drive.message)}` : now);
  }
}
