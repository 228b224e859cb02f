// The selected item: its name, its numbers, its size.
import { DrawingDocument } from "../draw/document";
import {
  fewest_points,
  is_closed,
  Item,
  ItemRef,
  kind_of,
  name_is_free,
  points_of,
  with_item,
  with_points,
} from "../draw/drawing";
import { area_of, length_of } from "../draw/geometry";
import { heading_of, with_heading, without_corner } from "../draw/grab";
import { texts } from "../texts";
import { button, field, fill, h, set_text, show } from "../ui/dom";
import { folded } from "../ui/section";

const words = texts.draw;

/** "4.50 m long", "12.0 m², 14.0 m around"; empty for a place. */
export function size_text(ref: ItemRef, item: Item): string {
  const points = points_of(item);
  const closed = is_closed(ref.list);
  if (points.length < 4) return "";
  return words.measures(length_of(points, closed), closed ? area_of(points) : null);
}

/** Title of an item: its name, or its kind with its number. */
export function title_of(ref: ItemRef, item: Item): string {
  const kind = words.titles[kind_of(ref.list, item)];
  return "name" in item && item.name ? item.name : words.numbered(kind, ref.index + 1);
}

export class DrawItem {
  readonly element = h("section", { class: "section", "aria-label": words.item });
  private shown = ""; // the item shown, and its structure
  private readonly updates: ((item: Item) => void)[] = [];
  private readonly size = h("p", { class: "quiet" });

  constructor(
    private readonly open: () => DrawingDocument,
    private readonly remove: () => void,
  ) {
    this.update();
  }

  update(): void {
    const { selected } = this.open();
    const item = this.open().selected_item();
    show(this.element, item !== null);
    const kind = selected && item ? kind_of(selected.list, item) : "";
    const key = selected && item ? `${kind} ${selected.index} ${points_of(item).length}` : "";
    if (key !== this.shown) {
      this.shown = key;
      this.updates.length = 0;
      if (selected && item) this.build(selected, item);
    }
    if (!selected || !item) return;
    for (const update of this.updates) update(item);
    set_text(this.size, size_text(selected, item));
  }

  private build(ref: ItemRef, item: Item): void {
    const kind = kind_of(ref.list, item);
    const fields: (HTMLElement | null)[] = [
      "name" in item ? this.name_field(ref) : null,
      kind === "slow" ? this.speed_field(ref) : null,
      heading_of(item) !== null ? this.heading_field(ref) : null,
      ...(ref.list === "places" ? this.point_fields(ref, 0, words.x, words.y) : []),
    ];
    fill(
      this.element,
      h("h2", {}, words.titles[kind]),
      this.size,
      h("div", { class: "field-grid" }, ...fields),
      ref.list === "places" ? null : this.corners(ref, item),
      h("div", { class: "buttons" }, button(words.remove, this.remove, { id: "draw-delete" })),
    );
  }

  private set(ref: ItemRef, item: Item): void {
    const document = this.open();
    document.edit(with_item(document.drawing, ref, item), ref);
  }

  private name_field(ref: ItemRef): HTMLElement {
    const input = h("input", { class: "field", id: "draw-name", maxlength: 60, autocomplete: "off" });
    input.addEventListener("input", () => input.setCustomValidity(""));
    input.addEventListener("change", () => {
      const { drawing } = this.open();
      const item = this.open().selected_item();
      const name = input.value.trim();
      const free = name_is_free(drawing, ref.list, name, ref);
      input.setCustomValidity(name === "" ? words.no_name : free ? "" : words.name_taken);
      if (input.reportValidity() && item && "name" in item && item.name !== name) {
        this.set(ref, { ...item, name });
      }
    });
    this.updates.push((item) => show_value(input, ("name" in item && item.name) || ""));
    return field(words.name, input, "wide");
  }

  private speed_field(ref: ItemRef): HTMLElement {
    const input = number_input("draw-speed", { min: 0.01, max: 5 });
    this.on_number(input, (value) => {
      const item = this.open().selected_item();
      if (item && "kind" in item) this.set(ref, { ...item, value });
    });
    this.updates.push((item) => show_value(input, "kind" in item ? String(item.value) : ""));
    return field(words.speed, input, "wide");
  }

  private heading_field(ref: ItemRef): HTMLElement {
    const input = number_input("draw-heading");
    this.on_number(input, (degrees) => {
      const item = this.open().selected_item();
      if (item) this.set(ref, with_heading(item, (degrees * Math.PI) / 180));
    });
    this.updates.push((item) => {
      show_value(input, (((heading_of(item) ?? 0) * 180) / Math.PI).toFixed(1));
    });
    return field(words.heading, input, "wide");
  }

  private point_fields(ref: ItemRef, index: number, x: string, y: string): HTMLElement[] {
    return [x, y].map((label, i) => {
      const at = 2 * index + i;
      const input = number_input(`draw-point-${at}`);
      this.on_number(input, (value) => {
        const item = this.open().selected_item();
        if (!item) return;
        const points = [...points_of(item)];
        points[at] = value;
        this.set(ref, with_points(item, points));
      });
      this.updates.push((item) => show_value(input, (points_of(item)[at] ?? 0).toFixed(3)));
      return field(label, input);
    });
  }

  private corners(ref: ItemRef, item: Item): HTMLElement {
    const count = points_of(item).length / 2;
    const rows = Array.from({ length: count }, (_, i) => {
      const [x, y] = this.point_fields(ref, i, words.corner_x(i + 1), words.corner_y(i + 1));
      const remove = () => {
        const now = this.open().selected_item();
        const rest = now && without_corner(ref.list, now, i);
        if (rest) this.set(ref, rest);
      };
      const cross = button("×", remove, {
        class: "button small",
        "aria-label": words.remove_corner(i + 1),
        disabled: count <= fewest_points(ref.list),
      });
      return h("div", { class: "field-grid corner" }, x, y, cross);
    });
    const element = folded(words.corners, false, ...rows);
    element.className = "corners";
    return element;
  }

  private on_number(input: HTMLInputElement, act: (value: number) => void): void {
    input.addEventListener("change", () => {
      if (input.reportValidity() && Number.isFinite(input.valueAsNumber)) act(input.valueAsNumber);
    });
  }
}

function number_input(id: string, limits: Record<string, number> = {}): HTMLInputElement {
  return h("input", { type: "number", step: "any", class: "field", id, required: true, ...limits });
}

// Does not overwrite the input being typed in.
function show_value(input: HTMLInputElement, value: string): void {
  if (document.activeElement !== input && input.value !== value) input.value = value;
}
