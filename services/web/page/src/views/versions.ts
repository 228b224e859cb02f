// Snapshots of the map: make, restore, and compare them with each other and the current map.
import { App } from "../app";
import * as format from "../format";
import { reason } from "../reasons";
import { Comparison, Snapshot, Snapshots } from "../protocol";
import { texts } from "../texts";
import { button, fill, h, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";
import { section } from "../ui/section";
import { hide_difference, show_difference } from "./difference";

const words = texts.time;
const nameRule = "[A-Za-z0-9_\\-][A-Za-z0-9._\\-]*";
const patienceMs = 60000; // for large maps

export class Versions {
  readonly element: HTMLElement;
  private readonly none = h("p", { class: "quiet" }, words.no_snapshots);
  private readonly name: HTMLInputElement;
  private readonly form: HTMLFormElement;
  private readonly list: KeyedList<Snapshot>;
  private readonly before = h("select", { class: "field", id: "compare-before" });
  private readonly after = h("select", { class: "field", id: "compare-after" });
  private readonly compare: HTMLElement;
  private readonly result = h("div", { hidden: true });
  private snapshots: Snapshot[] = [];
  private available = false; // the map store keeps snapshots

  /** on_update: whether the map store keeps snapshots. */
  constructor(
    private readonly app: App,
    private readonly on_update: (available: boolean) => void,
  ) {
    this.name = h("input", {
      class: "field",
      id: "snapshot-name",
      required: true,
      maxlength: 64,
      pattern: nameRule,
      title: words.name_rule,
      "aria-describedby": "snapshot-rule",
    });
    this.form = h(
      "form",
      { class: "field-row snapshot-form" },
      h("label", { for: "snapshot-name" }, words.name),
      this.name,
      h("button", { type: "submit", class: "button" }, words.make),
      h("p", { class: "quiet", id: "snapshot-rule" }, words.name_rule),
    );
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.make();
    });
    this.list = new KeyedList<Snapshot>(
      "rows snapshots",
      (name) => this.entry(name),
      (element, snapshot) => this.show_entry(element, snapshot),
    );
    this.compare = section(
      words.comparison,
      h("p", { class: "quiet" }, words.compare_hint),
      h(
        "div",
        { class: "field-grid compared" },
        pair(words.before, this.before),
        pair(words.after, this.after),
      ),
      button(words.compare, () => void this.compare_now()),
      this.result,
    );
    this.element = h(
      "div",
      {},
      section(words.snapshots, this.none, this.form, this.list.element),
      this.compare,
    );
    app.rights.on_change(() => this.show_all());
  }

  async update(): Promise<void> {
    try {
      const answer = await this.app.api.get<Snapshots>("/api/snapshots", patienceMs);
      this.snapshots = answer.snapshots;
      this.available = answer.kept !== false;
      const why = this.available ? "" : reason(answer.message ?? "");
      set_text(this.none, why || words.no_snapshots);
    } catch (error) {
      this.snapshots = [];
      this.available = false;
      set_text(this.none, reason(error instanceof Error ? error.message : String(error)));
    }
    this.show_all();
  }

  /** Removes the difference from the map. */
  close(): void {
    hide_difference(this.app.map.scene);
    show(this.result, false);
  }

  /** Updates after the map store has restarted with another map. */
  update_soon(): void {
    window.setTimeout(() => void this.update(), 3000);
  }

  private show_all(): void {
    this.on_update(this.available);
    show(this.none, this.snapshots.length === 0);
    show(this.form, this.available && this.app.rights.can("snapshot"));
    this.list.show([...this.snapshots].reverse().map((snapshot) => [snapshot.name, snapshot]));
    const sound = this.snapshots.filter((snapshot) => !snapshot.damage);
    show(this.compare, sound.length > 0);
    const options = (select: HTMLSelectElement, otherwise: string) => {
      const chosen = select.value || otherwise;
      const names = sound.map((snapshot) => h("option", { value: snapshot.name }, snapshot.name));
      fill(select, ...names, h("option", { value: "" }, words.now));
      select.value = sound.some((snapshot) => snapshot.name === chosen) ? chosen : "";
    };
    options(this.before, sound[sound.length - 1]?.name ?? "");
    options(this.after, "");
  }

  private async make(): Promise<void> {
    const order = this.app.api.post("snapshot", { name: this.name.value }, patienceMs);
    if (!(await this.app.notices.report(order, words.made))) return;
    this.name.value = "";
    await this.update();
  }

  private entry(name: string): HTMLElement {
    const ask = (asked: boolean) => {
      show(restore, !asked);
      show(sure, asked);
    };
    const restore = button(words.restore, () => ask(true));
    const sure = h(
      "div",
      { hidden: true },
      h("p", {}, words.restore_warning),
      h(
        "div",
        { class: "buttons" },
        button(words.restore_sure, () => void this.restore(name, () => ask(false)), {
          class: "button primary",
        }),
        button(texts.correct.cancel, () => ask(false)),
      ),
    );
    return h(
      "li",
      {},
      h("h3", {}, name),
      h("p", { class: "quiet" }),
      h("div", { class: "buttons" }, restore, this.change_buttons(name)),
      sure,
    );
  }

  // Rename and delete; the deletion asks first.
  private change_buttons(name: string): HTMLElement {
    const input = h("input", {
      class: "field",
      required: true,
      maxlength: 64,
      pattern: nameRule,
      value: name,
      title: words.name_rule,
      "aria-label": words.new_name(name),
    });
    const close = () => {
      show(form, false);
      show(sure, false);
    };
    const form = h(
      "form",
      { class: "field-row", hidden: true },
      input,
      h("button", { type: "submit", class: "button" }, words.rename),
      button(texts.correct.cancel, close),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.change("snapshot_rename", { name, new_name: input.value }, close);
    });
    const sure = h(
      "div",
      { class: "buttons", hidden: true },
      button(words.delete_sure(name), () => void this.change("snapshot_delete", { name }, close)),
      button(texts.correct.cancel, close),
    );
    const open = (part: HTMLElement) => {
      close();
      show(part, true);
    };
    return h(
      "div",
      { class: "snapshot-changes" },
      button(words.rename, () => open(form), { class: "button small" }),
      button(words.delete, () => open(sure), { class: "button small" }),
      form,
      sure,
    );
  }

  private async change(order: string, body: Record<string, string>, on_done: () => void): Promise<void> {
    const answer = this.app.api.post(order, body, patienceMs);
    if (!(await this.app.notices.report(answer, words.changed))) return;
    on_done();
    await this.update();
  }

  private show_entry(element: HTMLElement, snapshot: Snapshot): void {
    const [, facts, buttons, sure] = element.children as unknown as HTMLElement[];
    const [restore, changes] = buttons.children as unknown as HTMLElement[];
    const when = format.moment(snapshot.time_s);
    set_text(
      facts,
      snapshot.damage ?? words.snapshot_facts(when, snapshot.stops ?? 0, snapshot.bytes),
    );
    show(changes, this.app.rights.can("snapshot_rename"));
    show(restore, this.app.rights.can("restore") && !snapshot.damage && sure.hidden);
  }

  private async restore(name: string, on_done: () => void): Promise<void> {
    const order = this.app.api.post("restore", { name }, patienceMs);
    if (!(await this.app.notices.report(order, words.restored))) return;
    on_done();
    this.close(); // its difference refers to the previous map
    this.update_soon();
  }

  private async compare_now(): Promise<void> {
    const query = `before=${this.before.value}&after=${this.after.value}`;
    show(this.result, true);
    fill(this.result, h("p", { class: "quiet", role: "status" }, words.comparing));
    try {
      const made = await this.app.api.get<Comparison>(`/api/compare?${query}`, patienceMs);
      fill(
        this.result,
        await show_difference(this.app.map.scene, made),
        button(words.hide, () => this.close()),
      );
    } catch (error) {
      const text = error instanceof Error ? error.message : String(error);
      fill(this.result, h("p", { class: "quiet", role: "status" }, text));
    }
  }
}

function pair(label: string, input: HTMLElement): HTMLElement {
  return h("div", { class: "field-pair" }, h("label", { for: input.id }, label), input);
}
