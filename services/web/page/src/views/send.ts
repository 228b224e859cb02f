// Send: choose goals, see the route, go; the current goals; driving by hand.
import { App, ViewPart } from "../app";
import { Destination, destinations } from "../destinations";
import { Preview } from "../protocol";
import { hand_is_stopped, held_text, is_misplaced } from "../robot_state";
import { translated } from "../reasons";
import { texts } from "../texts";
import { button, field, fill, h, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";
import { once_a_frame } from "../ui/schedule";
import { folded, section } from "../ui/section";
import { Choice, chosen_list, moved } from "./chosen_list";
import { DrivePad } from "./drive_pad";
import { Missions } from "./missions";
import { rounds_field, with_stays } from "./rounds";
import { Underway } from "./underway";

const words = texts.send;
const plannerTimeMs = 1000; // time until the planner has a new drawing
const namedPx = 18; // a tap this near to a place selects the place

export class SendView implements ViewPart {
  readonly element: HTMLElement;
  private readonly drive: DrivePad;
  private readonly orders: HTMLElement;
  private readonly card = h("div", { class: "card", hidden: true });
  private choices: Choice[] = [];
  private readonly missions = new Missions(
    () => this.choices,
    () => this.rounds,
    (choices, rounds) => this.take(choices, rounds),
  );
  private readonly names: KeyedList<Destination>;
  private readonly no_names = h("p", { class: "quiet" });
  private readonly filter: HTMLInputElement;
  private readonly note = h("p", { class: "note" });
  private rounds = 1; // of the list; 0: until it is cancelled
  private adding = false;
  private visible = false;
  private replan = 0; // timer
  private last: Preview | null = null; // null while planning
  private readonly doubt = h("div", { class: "card", id: "misplaced", hidden: true });
  private asked = 0; // number of the last preview: answers to earlier ones are ignored

  constructor(private readonly app: App) {
    this.drive = new DrivePad(app);
    this.filter = h("input", {
      type: "search",
      class: "field",
      placeholder: words.search,
      "aria-label": words.search,
      oninput: () => this.show_names(),
      onkeydown: (event: KeyboardEvent) => {
        if (event.key === "Enter") this.choose_first();
      },
    });
    this.names = new KeyedList<Destination>(
      "names",
      (name) => h("li", {}, this.name_button(name)),
      (element, entry) => {
        element.classList.toggle("is-place", entry.is_place);
      },
    );
    const explore = button(words.explore, () => this.ask_if_misplaced(() => void this.order("explore")), {
      title: words.explore_title,
      "data-order": "explore",
    });
    const go_back = () => this.ask_if_misplaced(() => void this.order("return"));
    const back = button(words.return, go_back, { "data-order": "return" });
    this.orders = h(
      "div",
      {},
      section(
        words.heading,
        h("p", { class: "quiet" }, words.hint),
        this.card,
        this.doubt,
        this.filter,
        this.names.element,
        this.no_names,
        h("div", { class: "buttons" }, explore, back),
      ),
      this.missions.element,
      folded(words.drive, false, this.drive.element),
    );
    this.element = h("div", { class: "view" }, this.note, new Underway(app).element, this.orders);
    const names = once_a_frame(() => this.show_names());
    app.channels.on_table("places", names);
    app.channels.on_table("rooms", names);
    const rights = once_a_frame(() => this.show_rights());
    app.channels.on_value(["drawing"], () => {
      window.clearTimeout(this.replan);
      this.replan = window.setTimeout(() => this.plan_again(), plannerTimeMs);
    });
    app.rights.on_change(rights);
    app.channels.on_value(["navigator", "goals"], rights);
    this.show_names();
    this.show_rights();
  }

  shown(visible: boolean): void {
    this.visible = visible;
    if (!visible) this.drive.set_active(false);
    this.show_on_map(visible);
  }

  /** Stop also releases the manual controls. */
  let_go(): void {
    this.drive.let_go_of_all();
  }

  /** A tap on the map. */
  choose_point(x_m: number, y_m: number, pixels_per_m: number): void {
    if (!this.app.rights.may_write) return;
    const near = destinations(this.app.channels).find(
      (entry) =>
        entry.is_place && Math.hypot(entry.x_m - x_m, entry.y_m - y_m) * pixels_per_m < namedPx,
    );
    if (near) return this.choose(near);
    const choice: Choice = { goal: { x_m, y_m }, text: words.point(x_m, y_m), x_m, y_m };
    this.choices = [...this.kept(), choice];
    void this.preview();
    void this.name_point(choice);
  }

  private choose(entry: Destination): void {
    const { name, x_m, y_m } = entry;
    this.choices = [...this.kept(), { goal: { place: name }, text: name, x_m, y_m }];
    this.app.map.show(x_m, y_m);
    void this.preview();
  }

  // While a list is being built, a choice is added to it; otherwise it replaces the previous one.
  private kept(): Choice[] {
    const kept = this.adding ? this.choices : [];
    this.adding = false;
    return kept;
  }

  private choose_first(): void {
    const found = this.matching(destinations(this.app.channels));
    if (this.filter.value.trim() !== "" && found.length > 0) this.choose(found[0]);
  }

  // An edited drawing may open or close the shown route.
  private plan_again(): void {
    if (this.choices.length > 0) void this.preview();
  }

  private async name_point(choice: Choice): Promise<void> {
    const { x_m, y_m } = choice;
    const path = `/api/at?x_m=${x_m.toFixed(3)}&y_m=${y_m.toFixed(3)}`;
    const at = await this.app.api.get<{ room?: string }>(path).catch(() => null);
    if (!at?.room) return;
    choice.text = words.point_in(at.room, x_m, y_m);
    if (this.last) this.show_card(this.last);
  }

  private async preview(): Promise<void> {
    const asked = ++this.asked;
    this.last = null;
    this.missions.update();
    this.show_on_map(this.visible);
    this.show_card(null);
    if (this.choices.length === 0) return;
    const goals = this.choices.map((choice) => choice.goal);
    const body = goals.length === 1 ? goals[0] : { goals };
    if (goals.length === 1) this.rounds = 1;
    let answer: Preview;
    try {
      answer = await this.app.api.post<Preview>("preview", body);
    } catch (error) {
      answer = { found: false, message: error instanceof Error ? error.message : String(error) };
    }
    if (asked !== this.asked) return;
    this.last = answer;
    this.show_on_map(this.visible);
    this.show_card(answer);
  }

  private show_on_map(visible: boolean): void {
    const { scene } = this.app.map;
    scene.marks = visible ? this.choices : [];
    scene.preview = visible && this.last?.found ? (this.last.points_m ?? []) : [];
    scene.refresh();
  }

  // answer: null while planning.
  private show_card(answer: Preview | null): void {
    show(this.card, this.choices.length > 0);
    if (this.choices.length === 0) return fill(this.card);
    const several = this.choices.length > 1;
    const title = several ? words.list : this.choices[0].text;
    const text = !answer
      ? words.planning
      : answer.found
        ? several
          ? this.list_text(answer)
          : words.route(answer.length_m, answer.time_s, answer.min_clearance_m)
        : this.why_not(answer);
    const ready = answer?.found === true;
    const go = button(
      several ? words.go_all(this.choices.length) : words.go,
      () => this.ask_if_misplaced(() => void this.go()),
      { class: "button primary", disabled: !ready, id: "go" },
    );
    const near = answer?.nearest_reachable;
    fill(
      this.card,
      h("h3", {}, title),
      several ? this.list() : null,
      h("p", { class: answer?.found === false ? "bad-text" : "", role: "status" }, text),
      several ? rounds_field(this.rounds, (n) => this.show_time(n)) : null,
      ready ? this.heading_field() : null,
      near ? button(words.nearest, () => this.take_nearest(near.x_m, near.y_m)) : null,
      h(
        "div",
        { class: "buttons" },
        go,
        button(words.append, () => this.begin_list(), { disabled: !ready }),
        button(words.clear, () => this.clear()),
      ),
      this.adding ? h("p", { class: "quiet" }, words.hint) : null,
    );
  }

  // The heading at the last goal; the robot looks anywhere without one.
  private heading_field(): HTMLElement {
    const choice = this.choices[this.choices.length - 1];
    const { heading_rad } = choice.goal;
    const input = h("input", {
      type: "number",
      class: "field",
      id: "goal-heading",
      step: "any",
      min: -360,
      max: 360,
      value: heading_rad === undefined ? "" : Math.round((heading_rad * 180) / Math.PI),
      oninput: () => {
        const degrees = input.valueAsNumber;
        const known = Number.isFinite(degrees) && Math.abs(degrees) <= 360;
        choice.goal.heading_rad = known ? (degrees * Math.PI) / 180 : undefined;
        this.app.map.scene.refresh();
      },
    });
    return field(words.heading_at_goal, input);
  }

  // An answer to a list names the goal that fails.
  private why_not(answer: Preview): string {
    if (!answer.message) return words.no_route;
    if (answer.goal === undefined) return translated(answer.message);
    const failed = this.choices[answer.goal] ?? this.choices[0];
    const why = answer.message.replace(/^the goal \([^)]*\) /, "it ");
    return words.no_route_to(failed.text, translated(why));
  }

  private begin_list(): void {
    this.adding = true;
    this.show_card(this.last);
    this.filter.focus();
  }

  private drop(index: number): void {
    this.choices = this.choices.filter((_, i) => i !== index);
    void this.preview();
  }

  private list(): HTMLElement {
    return chosen_list(
      this.choices,
      (index) => this.drop(index),
      (index, steps) => {
        this.choices = moved(this.choices, index, steps);
        void this.preview();
      },
      () => this.show_time(),
    );
  }

  private list_text({ length_m, time_s }: Preview): string {
    return words.list_length(length_m, with_stays(this.choices, this.rounds, time_s));
  }

  // Only the text, because the card has the focus.
  private show_time(rounds = this.rounds): void {
    this.rounds = rounds;
    const text = this.card.querySelector<HTMLElement>("p[role=status]");
    const answer = this.last;
    if (!text || !answer?.found) return;
    set_text(text, this.list_text(answer));
  }

  // A room or place lies where the map has it now.
  private take(choices: readonly Choice[], rounds: number): void {
    const now = destinations(this.app.channels);
    this.adding = false;
    this.choices = choices.map((choice) => {
      const entry = now.find((other) => "place" in choice.goal && other.name === choice.goal.place);
      const copy = { ...choice, goal: { ...choice.goal } };
      return entry ? { ...copy, x_m: entry.x_m, y_m: entry.y_m } : copy;
    });
    this.rounds = rounds;
    void this.preview();
  }

  private take_nearest(x_m: number, y_m: number): void {
    this.choices[this.choices.length - 1] = {
      goal: { x_m, y_m },
      text: words.point(x_m, y_m),
      x_m,
      y_m,
    };
    void this.preview();
  }

  private clear(): void {
    this.choices = [];
    this.rounds = 1;
    this.adding = false;
    void this.preview();
  }

  private async go(): Promise<void> {
    const goals = this.choices.map((choice) => choice.goal);
    const on_the_way =
      goals.length === 1 ? texts.done.goal(this.choices[0].text) : texts.done.goals(goals.length);
    const { channels } = this.app;
    const held = held_text(channels) !== null || hand_is_stopped(channels);
    const done = held ? texts.done.goal_held : on_the_way;
    const list = this.rounds === 1 ? { goals } : { goals, repeat: this.rounds };
    const order = this.app.api.post("goal", goals.length === 1 ? goals[0] : list);
    if (await this.app.notices.report(order, done)) this.clear();
  }

  // A robot that stands elsewhere drives into what is there.
  private ask_if_misplaced(drive: () => void): void {
    show(this.doubt, false);
    if (!is_misplaced(this.app.channels)) return drive();
    const answer = (drives: boolean) => {
      show(this.doubt, false);
      if (drives) drive();
    };
    fill(
      this.doubt,
      h("p", { class: "bad-text", role: "alert" }, words.misplaced),
      h(
        "div",
        { class: "buttons" },
        button(words.drive_misplaced, () => answer(true)),
        button(texts.correct.cancel, () => answer(false)),
      ),
    );
    show(this.doubt, true);
  }

  private async order(what: "explore" | "return"): Promise<void> {
    await this.app.notices.report(this.app.api.post(what), texts.done[what]);
  }

  private name_button(name: string): HTMLButtonElement {
    return button(name, () => {
      const entry = destinations(this.app.channels).find((other) => other.name === name);
      if (entry) this.choose(entry);
    });
  }

  private matching(all: Destination[]): Destination[] {
    const wanted = this.filter.value.trim().toLowerCase();
    return all.filter((entry) => entry.name.toLowerCase().includes(wanted));
  }

  private show_names(): void {
    const all = destinations(this.app.channels);
    const found = this.matching(all);
    this.names.show(found.map((entry) => [entry.name, entry] as const));
    show(this.filter, all.length > 6);
    show(this.no_names, found.length === 0);
    set_text(this.no_names, all.length === 0 ? words.no_names : words.no_match);
  }

  private show_rights(): void {
    const { rights, channels } = this.app;
    const navigator = channels.value("navigator") !== null;
    const missing = navigator || !rights.connected ? "" : words.no_navigator;
    const note = rights.may_write ? missing : words.spectator;
    show(this.note, note !== "");
    set_text(this.note, note);
    show(this.orders, rights.may_write);
    for (const element of this.orders.querySelectorAll<HTMLButtonElement>("[data-order]")) {
      const order = element.dataset.order ?? "";
      const running = order === "explore" && channels.value("goals")?.exploring === true;
      show(element, rights.offers(order) && !running);
      element.disabled = !navigator;
    }
  }
}
