// Shows the differences between two versions of the map in colours on the map.
import { beside_page } from "../address";
import * as format from "../format";
import { MapScene } from "../map/map_scene";
import { draw_picture } from "../map/to_pixels";
import { Comparison } from "../protocol";
import { texts } from "../texts";
import { Facts } from "../ui/bar";
import { h } from "../ui/dom";

const words = texts.time;
const layerAbove = "difference";
const changes = ["gone", "new", "seen", "lost"] as const;

/** Removes the difference from the map. */
export function hide_difference(scene: MapScene): void {
  scene.above.delete(layerAbove);
  scene.refresh();
}

/**
 * Lays a difference over the map; returns its legend and figures. Throws if the picture is gone.
 */
export async function show_difference(scene: MapScene, made: Comparison): Promise<HTMLElement> {
  const picture = new Image();
  picture.src = beside_page(made.picture);
  await picture.decode();
  const [width, height] = [made.columns * made.resolution_m, made.rows * made.resolution_m];
  scene.above.set(layerAbove, (context, view) => {
    context.imageSmoothingEnabled = false;
    draw_picture(context, view, picture, { x: made.x_m, y: made.y_m + height, width, height });
    context.imageSmoothingEnabled = true;
  });
  scene.refresh();
  const facts = new Facts();
  facts.set(words.stops, words.stops_value(made.before.stops, made.after.stops));
  for (const change of changes) {
    facts.set(words.changes[change], format.area(made[`${change}_m2`]));
  }
  const signs = changes.map((change) =>
    h(
      "span",
      { class: "sign" },
      h("span", { class: `sign-color change-${change}` }),
      words.changes[change],
    ),
  );
  return h("div", {}, h("p", { class: "signs" }, ...signs), facts.element);
}
