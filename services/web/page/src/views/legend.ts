// Explains the signs on the map and the keys.
import { draw_node } from "../map/graph_layer";
import { NodeKind } from "../protocol";
import { texts } from "../texts";
import { Facts } from "../ui/bar";
import { h } from "../ui/dom";
import { Palette } from "../ui/theme";

const sizePx = 20;

export function legend(palette: () => Palette): { element: HTMLElement; redraw: () => void } {
  const signs = (Object.keys(texts.legend) as (NodeKind & keyof typeof texts.legend)[]).map(
    (kind) => {
      const canvas = h("canvas", {
        width: 2 * sizePx,
        height: 2 * sizePx,
        "aria-hidden": "true",
      });
      return { kind, canvas };
    },
  );
  const redraw = () => {
    for (const { kind, canvas } of signs) {
      const context = canvas.getContext("2d");
      if (!context) continue;
      context.setTransform(2, 0, 0, 2, 0, 0);
      context.clearRect(0, 0, sizePx, sizePx);
      draw_node(context, kind, sizePx / 2, sizePx / 2, 5.5, palette());
    }
  };
  redraw();
  const list = signs.map(({ kind, canvas }) => h("li", {}, canvas, texts.legend[kind]));
  const keys = new Facts();
  for (const [key, effect] of texts.keys) keys.set(key, effect);
  const element = h("div", {}, h("ul", { class: "legend" }, ...list), keys.element);
  return { element, redraw };
}
