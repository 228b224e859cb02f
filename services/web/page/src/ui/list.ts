// A list that keeps its elements while their entries change, so that focus and scroll position
// stay.
import { h } from "./dom";

export class KeyedList<Entry> {
  readonly element: HTMLElement;
  private readonly elements = new Map<string, HTMLElement>();

  /** create: makes an element for a key; update: shows an entry in it. */
  constructor(
    class_name: string,
    private readonly create: (key: string) => HTMLElement,
    private readonly update: (element: HTMLElement, entry: Entry, key: string) => void,
  ) {
    this.element = h("ul", { class: class_name });
  }

  /** Shows these entries in this order. */
  show(entries: readonly (readonly [string, Entry])[]): void {
    const wanted = new Set(entries.map(([key]) => key));
    for (const [key, element] of this.elements) {
      if (wanted.has(key)) continue;
      element.remove();
      this.elements.delete(key);
    }
    let place: Element | null = this.element.firstElementChild;
    for (const [key, entry] of entries) {
      let element = this.elements.get(key);
      if (!element) {
        element = this.create(key);
        this.elements.set(key, element);
      }
      this.update(element, entry, key);
      if (element === place) place = place.nextElementSibling;
      else this.element.insertBefore(element, place);
    }
  }
}
