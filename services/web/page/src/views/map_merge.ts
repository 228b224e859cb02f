// Merges another map file with the current map: upload, review, accept or refuse.
import { App } from "../app";
import { reason } from "../reasons";
import { MergedMap, Snapshots } from "../protocol";
import { texts } from "../texts";
import { button, fill, h, show } from "../ui/dom";
import { section } from "../ui/section";
import { hide_difference, show_difference } from "./difference";

const words = texts.time;
const mostBytes = 64 * 1024 * 1024; // limit of the service
const patienceMs = 600000; // for large maps

export class MapMerge {
  readonly element: HTMLElement;
  private readonly file = h("input", {
    type: "file",
    class: "field",
    id: "merge-file",
    accept: ".pb",
    onchange: () => void this.offer(),
  });
  private readonly result = h("div", { hidden: true, class: "card merge-result" });

  /** on_restored: the map was replaced. */
  constructor(
    private readonly app: App,
    private readonly on_restored: () => void,
  ) {
    this.element = section(
      words.merge,
      h("p", { class: "quiet" }, words.merge_hint),
      h("label", { for: "merge-file" }, words.merge_file),
      this.file,
      this.result,
    );
  }

  /** available: the map store keeps snapshots. */
  update(available: boolean): void {
    show(this.element, available && this.app.rights.can("merge_map"));
  }

  /** Removes the review from the map. */
  close(): void {
    hide_difference(this.app.map.scene);
    show(this.result, false);
  }

  private say(...what: (string | Node)[]): void {
    show(this.result, true);
    fill(this.result, h("p", { role: "status" }, ...what));
  }

  private async offer(): Promise<void> {
    const file = this.file.files?.[0];
    if (!file) return;
    this.close();
    if (file.size > mostBytes) {
      this.say(words.merge_too_large(file.name));
      this.file.value = "";
      return;
    }
    this.file.disabled = true;
    this.say(words.merging(file.name));
    try {
      const made = await this.app.api.send_file<MergedMap>("merge_map", file, patienceMs);
      await this.show_result(file.name, made);
    } catch (error) {
      const why = error instanceof Error ? error.message : String(error);
      this.say(h("strong", {}, words.not_merged(file.name)), ` ${reason(why)}`);
    } finally {
      this.file.disabled = false;
      this.file.value = ""; // allows choosing the same file again
    }
  }

  private async show_result(name: string, made: MergedMap): Promise<void> {
    const difference = await show_difference(this.app.map.scene, made);
    fill(
      this.result,
      h("h3", { role: "status" }, words.merged(name)),
      h("p", {}, words.merged_facts(made)),
      difference,
      h("p", {}, words.merge_warning),
      h(
        "div",
        { class: "buttons" },
        button(words.merge_accept, () => void this.answer(made.number, true), {
          class: "button primary",
        }),
        button(words.merge_refuse, () => void this.answer(made.number, false)),
      ),
    );
    this.result.scrollIntoView({ block: "nearest" });
  }

  private async answer(number: number, accept: boolean): Promise<void> {
    const order = this.app.api.post<Snapshots>("merge_map_answer", { number, accept }, patienceMs);
    const done = accept ? words.merge_accepted : words.merge_refused;
    this.close();
    if ((await this.app.notices.report(order, done)) && accept) this.on_restored();
  }
}
