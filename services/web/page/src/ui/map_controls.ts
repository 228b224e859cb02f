// Buttons on the map: zoom, fit, follow, visible layers.
import { layerNames } from "../map/map_scene";
import { MapView } from "../map/map_view";
import { point } from "../format";
import { texts } from "../texts";
import { h, icon, IconName, set_text, show } from "./dom";

const layersKey = "topogeo-layers";

export function map_controls(map: MapView): HTMLElement {
  const control = (name: string, picture: IconName, action: () => void) => {
    const element = h("button", {
      type: "button",
      class: "control",
      title: name,
      "aria-label": name,
      onclick: action,
    });
    element.append(icon(picture));
    return element;
  };
  const words = texts.controls;
  const follow = control(words.follow, "follow", () => map.follow(!map.is_following()));
  map.on_follow = (following) => follow.setAttribute("aria-pressed", String(following));
  map.on_follow(false);
  const menu = layer_menu(map);
  const layers = control(words.layers, "layers", () => {
    show(menu, menu.hidden);
    layers.setAttribute("aria-expanded", String(!menu.hidden));
  });
  layers.setAttribute("aria-expanded", "false");
  const note = h("div", { class: "map-note", role: "status", hidden: true });
  const measure = control(words.measure, "measure", () => {
    const on = note.hidden;
    show(note, on);
    measure.setAttribute("aria-pressed", String(on));
    set_text(note, words.measuring);
    const tell = (meters: number | null) =>
      set_text(note, meters ? words.measured(meters) : words.measuring);
    if (on) map.start_measuring(tell);
    else map.stop_measuring();
  });
  measure.setAttribute("aria-pressed", "false");
  map.on_tool = () => {
    show(note, false);
    measure.setAttribute("aria-pressed", "false");
  };
  const under_pointer = h("div", { class: "under-pointer", "aria-hidden": "true" });
  map.on_point = (at) => set_text(under_pointer, at ? point(at.x_m, at.y_m) : "");
  map.stage.append(note, under_pointer);
  listen(map);
  const element = h(
    "div",
    { class: "controls" },
    h(
      "div",
      { class: "control-group" },
      control(words.zoom_in, "plus", () => map.zoom_in()),
      control(words.zoom_out, "minus", () => map.zoom_out()),
    ),
    h(
      "div",
      { class: "control-group" },
      control(words.fit, "fit", () => map.fit()),
      follow,
      control(words.turn, "turn", () => map.turn_on()),
      measure,
      layers,
    ),
    menu,
  );
  element.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || menu.hidden) return;
    layers.click();
    layers.focus();
  });
  return element;
}

function layer_menu(map: MapView): HTMLElement {
  const { visible } = map.scene;
  Object.assign(visible, stored_layers());
  const boxes = layerNames.map((name) => {
    const box = h("input", { type: "checkbox", checked: visible[name] });
    box.addEventListener("change", () => {
      visible[name] = box.checked;
      localStorage.setItem(layersKey, JSON.stringify(visible));
      map.scene.refresh();
    });
    return h("label", {}, box, texts.layers[name]);
  });
  return h(
    "div",
    { class: "layer-menu", role: "group", "aria-label": texts.controls.layers, hidden: true },
    ...boxes,
  );
}

function stored_layers(): Record<string, boolean> {
  try {
    const stored: unknown = JSON.parse(localStorage.getItem(layersKey) ?? "{}");
    const known = Object.entries(stored as Record<string, unknown>).filter(
      ([name, value]) => layerNames.some((layer) => layer === name) && typeof value === "boolean",
    );
    return Object.fromEntries(known) as Record<string, boolean>;
  } catch {
    return {};
  }
}

function listen(map: MapView): void {
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (target.closest("input, select, textarea")) return;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "f") map.fit();
    if (event.key === "r") map.follow(!map.is_following());
  });
}
