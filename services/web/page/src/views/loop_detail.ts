// The chosen loop: both local maps overlaid on the map, and the evidence as text.
import { App } from "../app";
import { reason } from "../reasons";
import { agreement, apart, compose, draw_laid_maps, LaidMaps } from "../map/match_layer";
import { LocalMap, Loop } from "../protocol";
import { texts } from "../texts";
import { Facts } from "../ui/bar";
import { h, set_text, show } from "../ui/dom";

const words = texts.understand;
const layerAbove = "loop";

export class LoopDetail {
  readonly element: HTMLElement;
  private readonly title = h("h3");
  private readonly why = h("p");
  private readonly meaning = h("p", { class: "quiet" });
  private readonly facts = new Facts();
  private readonly legend: HTMLElement;
  private readonly status = h("p", { class: "quiet", role: "status" });
  private chosen: Loop | null = null;

  constructor(private readonly app: App) {
    const sign = (name: string, text: string) =>
      h("span", { class: "sign" }, h("span", { class: `sign-color ${name}` }), text);
    this.legend = h(
      "p",
      { class: "signs" },
      sign("earlier", words.key_earlier),
      sign("later", words.key_later),
      sign("predicted", words.key_predicted),
    );
    this.element = h(
      "div",
      { class: "card loop-detail", hidden: true },
      this.title,
      this.why,
      this.meaning,
      this.status,
      this.legend,
      this.facts.element,
    );
  }

  /** Shows a loop; null: none. */
  show(loop: Loop | null): void {
    if (loop === this.chosen) return;
    this.chosen = loop;
    this.app.map.scene.above.delete(layerAbove);
    this.app.map.scene.refresh();
    show(this.element, loop !== null);
    if (!loop) return;
    set_text(this.title, words.loop(loop.later, loop.earlier));
    set_text(this.why, reason(loop.explanation || words.outcomes[loop.outcome]));
    const probable = !loop.accepted && (loop.probability ?? 0) > 0.5;
    const meaning = [meaning_of(loop.explanation), probable ? words.probable_but_rejected : ""];
    set_text(this.meaning, meaning.join(" ").trim());
    show(this.meaning, this.meaning.textContent !== "");
    show(this.legend, false);
    show(this.facts.element, false);
    show(this.status, true);
    set_text(this.status, words.loading_maps);
    void this.load(loop);
  }

  private async load(loop: Loop): Promise<void> {
    const get = (stop: number) => this.app.api.get<LocalMap>(`/api/local_map?stop=${stop}`);
    try {
      const [earlier, later] = await Promise.all([get(loop.earlier), get(loop.later)]);
      if (loop === this.chosen) this.show_maps(loop, earlier, later);
    } catch (error) {
      if (loop !== this.chosen) return;
      set_text(this.status, reason(error instanceof Error ? error.message : String(error)));
    }
  }

  private show_maps(loop: Loop, earlier: LocalMap, later: LocalMap): void {
    const stop = this.app.map.scene.trail.stop(loop.earlier);
    const T_map_earlier = stop
      ? { x_m: stop[0], y_m: stop[1], theta_rad: stop[2] }
      : { x_m: 0, y_m: 0, theta_rad: 0 };
    const laid: LaidMaps = { loop, earlier, later, T_map_earlier };
    this.app.map.scene.above.set(layerAbove, (context, view, palette) =>
      draw_laid_maps(context, view, laid, palette),
    );
    this.show_all(laid);
    show(this.status, false);
    show(this.legend, true);
    show(this.facts.element, true);
    const { overlap, near } = agreement(earlier, later, loop);
    this.facts.set(words.fitness, words.share(loop.fitness));
    this.facts.set(words.probability, words.share(loop.probability));
    this.facts.set(words.overlap, words.share(overlap));
    this.facts.set(words.near, overlap > 0 ? words.share(near) : words.none);
    const [meters, turn] = loop.predicted ? apart(loop.predicted, loop) : [null, null];
    this.facts.set(words.moved, words.moved_value(meters, turn));
    this.facts.set(words.corrected, words.moved_value(loop.correction_m, loop.correction_rad));
    this.app.map.scene.refresh();
  }

  // Brings both maps into view.
  private show_all(laid: LaidMaps): void {
    const box = { min_x: Infinity, min_y: Infinity, max_x: -Infinity, max_y: -Infinity };
    for (const { map, at } of [
      { map: laid.earlier, at: laid.T_map_earlier },
      { map: laid.later, at: compose(laid.T_map_earlier, laid.loop) },
    ]) {
      for (let i = 0; i + 1 < map.points_m.length; i += 2) {
        const p = compose(at, { x_m: map.points_m[i], y_m: map.points_m[i + 1], theta_rad: 0 });
        box.min_x = Math.min(box.min_x, p.x_m);
        box.max_x = Math.max(box.max_x, p.x_m);
        box.min_y = Math.min(box.min_y, p.y_m);
        box.max_y = Math.max(box.max_y, p.y_m);
      }
    }
    if (box.min_x <= box.max_x) this.app.map.show_box(box);
  }
}

/** Explains the last part of "match not accepted: few inliers"; empty for an accepted loop. */
export function meaning_of(explanation: string): string {
  return words.meanings[explanation.replace(/^.*: /, "")] ?? "";
}
