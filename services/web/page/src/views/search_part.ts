// The current search of the localizer: on the map, and as a sentence.
import { App } from "../app";
import { draw_search } from "../map/search_layer";
import { texts } from "../texts";
import { h, set_text, show } from "../ui/dom";

const words = texts.understand;
const layerAbove = "search";
const oldMs = 5000; // after that the search has ended

export class SearchPart {
  readonly element: HTMLElement;
  private readonly state = h("p", { class: "search-state" });
  private readonly best = h("p", { class: "quiet" });
  private heard_ms = -Infinity;
  private visible = false;
  private timer = 0;

  constructor(private readonly app: App) {
    this.element = h("div", {}, h("p", { class: "quiet" }, words.search_hint), this.state, this.best);
    app.channels.on_value(["search"], () => {
      if (app.channels.value("search")) this.heard_ms = performance.now();
      if (this.visible) this.update();
    });
  }

  set_visible(visible: boolean): void {
    this.visible = visible;
    window.clearInterval(this.timer);
    if (visible) this.timer = window.setInterval(() => this.update(), 1000);
    this.update();
  }

  private update(): void {
    const { channels, map } = this.app;
    const search = channels.value("search");
    const age_ms = performance.now() - this.heard_ms;
    const is_new = this.visible && search !== null && age_ms < oldMs;
    if (is_new && search) {
      map.scene.above.set(layerAbove, (context, view, palette) =>
        draw_search(context, view, search, palette),
      );
    } else if (!map.scene.above.delete(layerAbove)) {
      if (!search) set_text(this.state, words.no_search);
    }
    map.scene.refresh();
    if (!search) return;
    const found = search.matches.filter((match) => match.accepted).length;
    set_text(
      this.state,
      search.whole_map
        ? words.search_map(search.hypotheses.length, search.running)
        : words.search_matches(search.tasks, found, search.running),
    );
    const hypotheses = search.whole_map
      ? search.hypotheses
      : search.matches.flatMap((match) => match.hypotheses);
    const fitness = Math.max(...hypotheses.map((hypothesis) => hypothesis[3] ?? 0), 0);
    show(this.best, hypotheses.length > 0);
    set_text(this.best, words.search_best(fitness, age_ms >= oldMs));
  }
}
