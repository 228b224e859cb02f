import { h } from "./dom";

/** A part of a view under a heading. */
export function section(title: string, ...children: (Node | string | null)[]): HTMLElement {
  return h("section", { class: "section" }, h("h2", {}, title), ...children);
}

/** The same, foldable. */
export function folded(title: string, open: boolean, ...children: Node[]): HTMLDetailsElement {
  return h(
    "details",
    { class: "section", open },
    h("summary", {}, h("h2", {}, title)),
    ...children,
  );
}
