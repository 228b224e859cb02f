// Correct: set the pose, search the whole map, switch mapping, merge maps.
import { App, ViewPart } from "../app";
import { PoseMark } from "../map/robot_layer";
import { Merge } from "../protocol";
import { texts } from "../texts";
import { button, field, h, set_attribute, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";
import { once_a_frame } from "../ui/schedule";
import { section } from "../ui/section";

const words = texts.correct;
// 1 sigma: metres, radians.
const accuracies: Record<string, [number, number]> = {
  exact: [0.2, 0.1],
  about: [0.5, 0.3],
  roughly: [2, 0.8],
};

export class CorrectView implements ViewPart {
  readonly element: HTMLElement;
  private readonly note = h("p", { class: "note" }, words.spectator);
  private readonly parts: HTMLElement;
  private readonly start: HTMLButtonElement;
  private readonly apply = h("button", { type: "submit", class: "button primary" }, words.apply);
  private readonly search: HTMLButtonElement;
  private searching = false; // the order is on its way
  private readonly while_mapping = h("p", { class: "note" }, words.while_mapping);
  private readonly form: HTMLFormElement;
  private readonly x: HTMLInputElement;
  private readonly y: HTMLInputElement;
  private readonly theta: HTMLInputElement;
  private readonly sure: HTMLSelectElement;
  private readonly mode: HTMLButtonElement;
  private readonly mode_now = h("p", { role: "status" });
  private readonly no_merges = h("p", { class: "quiet" }, words.no_merges);
  private readonly merges: KeyedList<Merge>;

  constructor(private readonly app: App) {
    this.x = this.number_field("pose-x");
    this.y = this.number_field("pose-y");
    this.theta = this.number_field("pose-theta");
    this.sure = h(
      "select",
      { class: "field", id: "pose-sure" },
      h("option", { value: "exact" }, words.sure_exact),
      h("option", { value: "about", selected: true }, words.sure_about),
      h("option", { value: "roughly" }, words.sure_roughly),
    );
    this.start = button(words.pose_start, () => this.open_pose(), { class: "button primary" });
    this.form = this.pose_form();
    this.mode = button("", () => void this.switch_mode());
    this.merges = new KeyedList<Merge>(
      "merges",
      (number) => this.merge_entry(Number(number)),
      show_merge,
    );
    this.search = button(words.search_start, () => void this.start_search());
    const parts: [string, HTMLElement][] = [
      ["pose", section(words.pose, quiet(words.pose_hint), this.start, this.form)],
      ["search", section(words.search, quiet(words.search_hint), this.search)],
      ["mode", section(words.mode, quiet(words.mode_hint), this.mode_now, this.mode)],
      ["merge", section(words.merges, this.no_merges, this.merges.element)],
    ];
    this.parts = h("div", {}, ...parts.map(([, part]) => part));
    this.element = h("div", { class: "view" }, this.note, this.while_mapping, this.parts);
    const update = once_a_frame(() => {
      show(this.note, !app.rights.may_write);
      show(this.parts, app.rights.may_write);
      for (const [order, part] of parts) show(part, app.rights.offers(order));
      this.show_mode();
      this.show_merges();
    });
    app.rights.on_change(update);
    app.channels.on_value(["pose"], update);
    app.channels.on_table("merges", update);
    update();
  }

  shown(visible: boolean): void {
    if (!visible) this.close_pose();
  }

  private number_field(id: string): HTMLInputElement {
    return h("input", {
      type: "number",
      step: "any",
      class: "field",
      id,
      required: true,
      oninput: () => this.mark_fields(),
    });
  }

  private pose_form(): HTMLFormElement {
    const form = h(
      "form",
      { class: "card", hidden: true },
      h("p", {}, words.pose_drag),
      h(
        "div",
        { class: "field-grid" },
        field(words.x, this.x),
        field(words.y, this.y),
        field(words.theta, this.theta),
        field(words.sure, this.sure, "wide"),
      ),
      h(
        "div",
        { class: "buttons" },
        this.apply,
        button(words.cancel, () => this.close_pose()),
      ),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.apply_pose();
    });
    return form;
  }

  private open_pose(): void {
    const pose = this.app.channels.value("pose");
    show(this.start, false);
    show(this.form, true);
    this.show_fields({ x: pose?.x_m ?? 0, y: pose?.y_m ?? 0, theta: pose?.theta_rad ?? 0 });
    this.mark_fields();
    this.app.map.follow(false);
    this.app.map.start_pose((mark) => this.show_fields(mark));
  }

  private close_pose(): void {
    show(this.start, true);
    show(this.form, false);
    this.app.map.end_pose();
    this.app.map.scene.pose_mark = null;
    this.app.map.scene.refresh();
  }

  private show_fields(mark: PoseMark): void {
    this.x.value = mark.x.toFixed(2);
    this.y.value = mark.y.toFixed(2);
    this.theta.value = ((mark.theta * 180) / Math.PI).toFixed(1);
  }

  private read_fields(): PoseMark | null {
    const [x, y, degrees] = [this.x, this.y, this.theta].map((field) => field.valueAsNumber);
    if (![x, y, degrees].every(Number.isFinite)) return null;
    const theta = (degrees * Math.PI) / 180;
    return { x, y, theta: Math.atan2(Math.sin(theta), Math.cos(theta)) };
  }

  private mark_fields(): void {
    const mark = this.read_fields();
    if (!mark) return;
    this.app.map.scene.pose_mark = mark;
    this.app.map.scene.refresh();
  }

  private async apply_pose(): Promise<void> {
    const mark = this.read_fields();
    if (!mark) return;
    const [sigma_m, sigma_rad] = accuracies[this.sure.value];
    const pose = { x_m: mark.x, y_m: mark.y, theta_rad: mark.theta, sigma_m, sigma_rad };
    this.apply.disabled = true;
    const order = this.app.api.post("pose", pose);
    const taken = await this.app.notices.report(order, texts.done.pose);
    this.apply.disabled = false;
    if (taken) this.close_pose();
  }

  private async start_search(): Promise<void> {
    this.searching = true;
    this.show_mode();
    await this.app.notices.report(this.app.api.post("search"), texts.done.search);
    this.searching = false;
    this.show_mode();
  }

  private async switch_mode(): Promise<void> {
    const mode = this.app.channels.value("pose")?.mode === "mapping" ? "localization" : "mapping";
    await this.app.notices.report(this.app.api.post("mode", { mode }), texts.done.mode);
  }

  private show_mode(): void {
    const mode = this.app.channels.value("pose")?.mode;
    const mapping = mode === "mapping";
    show(this.while_mapping, mapping && this.app.rights.may_write);
    this.start.disabled = mapping;
    this.search.disabled = mapping || this.searching;
    if (mapping && !this.form.hidden) this.close_pose();
    show(this.mode, mode !== undefined);
    set_text(this.mode_now, mode ? words.mode_now[mode] : "");
    set_text(this.mode, mapping ? words.to_localization : words.to_mapping);
  }

  private show_merges(): void {
    const merges = [...this.app.channels.table("merges")];
    merges.sort((a, b) => Number(b[0]) - Number(a[0]));
    show(this.no_merges, merges.length === 0);
    this.merges.show(merges);
  }

  private merge_entry(number: number): HTMLElement {
    const answer = (accept: boolean) => {
      const order = this.app.api.post("merge", { number, accept });
      const done = accept ? texts.done.merge_accept : texts.done.merge_refuse;
      void this.app.notices.report(order, done);
    };
    return h(
      "li",
      { class: "card" },
      h("h3"),
      h("p", { class: "quiet" }),
      h("p", { class: "merge-state" }),
      h(
        "div",
        { class: "buttons" },
        button(words.accept, () => answer(true), { class: "button primary" }),
        button(words.refuse, () => answer(false)),
      ),
    );
  }
}

function show_merge(element: HTMLElement, merge: Merge): void {
  const [title, facts, state, buttons] = element.children as unknown as HTMLElement[];
  set_text(title, words.merge(merge.robot, merge.other_robot));
  set_text(facts, words.merge_facts(merge));
  set_text(state, words.merge_states[merge.state]);
  show(state, merge.state !== "open");
  show(buttons, merge.state === "open");
  set_attribute(element, "data-state", merge.state);
}

function quiet(text: string): HTMLElement {
  return h("p", { class: "quiet" }, text);
}
