// A stick for a thumb: the farther from its middle, the faster. It stops the robot when the thumb lets go.
import { h } from "../ui/dom";

const idleShare = 0.15; // of the radius around the middle, in which the robot stands

/** Share of the largest speeds in [-1, 1]: ahead, and to the left. */
export interface StickOrder {
  ahead: number;
  left: number;
}

/** The order of a thumb that is so many pixels right of and below the middle of a stick with this radius. */
export function stick_order(right: number, below: number, radius: number): StickOrder {
  const far = Math.hypot(right, below);
  const share = Math.min(1, (far / radius - idleShare) / (1 - idleShare));
  if (!(share > 0)) return { ahead: 0, left: 0 };
  return { ahead: (-below / far) * share || 0, left: (-right / far) * share || 0 };
}

export class DriveStick {
  readonly element: HTMLElement;
  private readonly knob = h("span", { class: "stick-knob" });
  private pointer: number | null = null;
  order: StickOrder = { ahead: 0, left: 0 };

  /** on_hold: a thumb presses; on_let_go: it has gone. accepts: whether a press counts. */
  constructor(
    private readonly on_hold: () => void,
    private readonly on_let_go: () => void,
    accepts: (event: Event) => boolean,
  ) {
    // The buttons below are for those who cannot use it, so screen readers skip it.
    this.element = h("div", { class: "drive-stick", "aria-hidden": "true" }, this.knob);
    this.element.addEventListener("pointerdown", (event) => {
      if (this.pointer !== null || !accepts(event)) return;
      this.pointer = event.pointerId;
      this.element.setPointerCapture(event.pointerId);
      this.follow(event);
      this.on_hold();
    });
    this.element.addEventListener("pointermove", (event) => {
      if (event.pointerId === this.pointer) this.follow(event);
    });
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
      this.element.addEventListener(type, (event) => {
        if (event.pointerId !== this.pointer) return;
        this.reset();
        this.on_let_go();
      });
    }
    this.element.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** Lets go although the thumb is there: it must press again. */
  reset(): void {
    this.pointer = null;
    this.order = { ahead: 0, left: 0 };
    this.knob.style.transform = "";
  }

  private follow(event: PointerEvent): void {
    const box = this.element.getBoundingClientRect();
    const radius = box.width / 2;
    const right = event.clientX - box.left - radius;
    const below = event.clientY - box.top - box.height / 2;
    this.order = stick_order(right, below, radius);
    const shrink = Math.min(1, radius / Math.max(1, Math.hypot(right, below)));
    this.knob.style.transform = `translate(${right * shrink}px, ${below * shrink}px)`;
  }
}
