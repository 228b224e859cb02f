// List of all drawn items, to select them without the map.
import { DrawingDocument } from "../draw/document";
import { all_items, Item, ItemRef, points_of } from "../draw/drawing";
import { middle_of } from "../draw/geometry";
import { MapView } from "../map/map_view";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";
import { folded } from "../ui/section";
import { size_text, title_of } from "./draw_item";

const words = texts.draw;

export class DrawList {
  readonly element: HTMLElement;
  private readonly title: HTMLElement;
  private readonly none = h("p", { class: "quiet" }, words.no_items);
  private readonly list: KeyedList<{ ref: ItemRef; item: Item }>;
  private entries = new Map<string, { ref: ItemRef; item: Item }>();

  constructor(
    private readonly open: () => DrawingDocument,
    map: MapView,
  ) {
    const choose = (key: string) => {
      const entry = this.entries.get(key);
      if (!entry) return;
      const { x, y } = middle_of(points_of(entry.item));
      map.show(x, y);
      this.open().select(entry.ref);
    };
    this.list = new KeyedList(
      "draw-items",
      (key) => h("li", {}, button("", () => choose(key), { class: "row-title" }), h("span")),
      (element, { ref, item }) => {
        const [name, size] = element.children as unknown as HTMLElement[];
        const { selected } = this.open();
        const chosen = selected?.list === ref.list && selected.index === ref.index;
        set_text(name, title_of(ref, item));
        set_attribute(name, "aria-pressed", String(chosen));
        set_text(size, size_text(ref, item));
        size.className = "quiet";
      },
    );
    const details = folded(words.items(0), false, this.none, this.list.element);
    this.title = details.querySelector("h2") as HTMLElement;
    this.element = details;
    this.update();
  }

  update(): void {
    const items = all_items(this.open().drawing);
    this.entries = new Map(items.map((entry) => [`${entry.ref.list} ${entry.ref.index}`, entry]));
    set_text(this.title, words.items(items.length));
    show(this.none, items.length === 0);
    this.list.show([...this.entries]);
  }
}
