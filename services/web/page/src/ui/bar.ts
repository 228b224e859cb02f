// A name, a bar like that of a battery, and the value as text.
import { h, set_attribute, set_text } from "./dom";

export type Level = "good" | "fair" | "bad" | "plain";

export class Bar {
  readonly element: HTMLElement;
  private readonly value = h("span", { class: "bar-value" });
  private readonly meter: HTMLElement;
  private readonly fill = h("span", { class: "bar-fill" });

  constructor(name: string) {
    this.meter = h(
      "span",
      {
        class: "bar-meter",
        role: "meter",
        "aria-label": name,
        "aria-valuemin": 0,
        "aria-valuemax": 100,
      },
      this.fill,
    );
    this.element = h(
      "div",
      { class: "bar" },
      h("span", { class: "bar-name" }, name),
      this.value,
      this.meter,
    );
  }

  /** share: filled part, [0, 1]. */
  set(share: number, text: string, level: Level = "plain"): void {
    const percent = Math.round(100 * Math.max(0, Math.min(1, share)));
    this.fill.style.width = `${percent}%`;
    set_text(this.value, text);
    set_attribute(this.meter, "aria-valuenow", String(percent));
    set_attribute(this.meter, "aria-valuetext", text);
    set_attribute(this.element, "data-level", level);
  }
}

/** Two columns of names and values. */
export class Facts {
  readonly element = h("dl", { class: "facts" });
  private readonly values = new Map<string, HTMLElement>();

  /** level: "bad" marks the value. */
  set(name: string, text: string, level: Level = "plain"): void {
    let value = this.values.get(name);
    if (!value) {
      value = h("dd");
      this.values.set(name, value);
      this.element.append(h("dt", {}, name), value);
    }
    set_text(value, text);
    set_attribute(value, "data-level", level);
  }
}
