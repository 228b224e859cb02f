// Missions: lists of goals that this browser keeps, for the same drive on another day.
import { texts } from "../texts";
import { button, field, fill, h, set_text, show } from "../ui/dom";
import { folded } from "../ui/section";
import { Choice } from "./chosen_list";

const key = "topogeo-missions";
const words = texts.missions;

interface Mission {
  name: string;
  choices: Choice[];
  rounds?: number; // missing: once
}

function is_mission(value: unknown): value is Mission {
  const { name, choices, rounds } = (value ?? {}) as Partial<Mission>;
  const is_choice = (choice: Partial<Choice> | null) =>
    typeof choice?.goal === "object" &&
    typeof choice.text === "string" &&
    Number.isFinite(choice.x_m) &&
    Number.isFinite(choice.y_m);
  const of_rounds = rounds === undefined || Number.isInteger(rounds);
  return of_rounds && typeof name === "string" && Array.isArray(choices) && choices.every(is_choice);
}

function stored(): Mission[] {
  try {
    const value: unknown = JSON.parse(localStorage.getItem(key) ?? "[]");
    return Array.isArray(value) ? value.filter(is_mission) : [];
  } catch {
    return [];
  }
}

export class Missions {
  readonly element: HTMLElement;
  private readonly list = h("ul", { class: "rows missions" });
  private readonly none = h("p", { class: "quiet" }, words.none);
  private readonly name = h("input", { class: "field", id: "mission-name", maxlength: 64 });
  private readonly save_button = button(words.save, () => this.save());
  private readonly form: HTMLElement;

  /** choices, rounds: of the present list; on_load: shows a mission as the present list. */
  constructor(
    private readonly choices: () => readonly Choice[],
    private readonly rounds: () => number,
    private readonly on_load: (choices: Choice[], rounds: number) => void,
  ) {
    this.form = h("div", {}, field(words.name, this.name), this.save_button);
    this.element = folded(words.title, false, this.none, this.list, this.form);
    this.update();
  }

  /** The present list may have changed. */
  update(): void {
    show(this.form, this.choices().length > 0);
    const missions = stored();
    show(this.none, missions.length === 0);
    fill(this.list, ...missions.map((mission) => this.entry(mission)));
  }

  private entry({ name, choices, rounds = 1 }: Mission): HTMLElement {
    const load = button(name, () => this.on_load(choices, rounds), { class: "button small" });
    const facts = h("span", { class: "quiet" });
    const often = rounds === 1 ? "" : `, ${words.rounds(rounds)}`;
    set_text(facts, ` ${words.goals(choices.length)}${often} `);
    const remove = button("×", () => this.keep(stored().filter((other) => other.name !== name)), {
      class: "button small",
      "aria-label": words.remove(name),
    });
    return h("li", { class: "export" }, h("span", {}, load, facts), remove);
  }

  // A mission of the same name is replaced.
  private save(): void {
    const choices = [...this.choices()];
    const name = this.name.value.trim() || choices.map((choice) => choice.text).join(", ").slice(0, 64);
    const mission = { name, choices, rounds: this.rounds() };
    this.keep([...stored().filter((other) => other.name !== name), mission]);
    this.name.value = "";
  }

  private keep(missions: Mission[]): void {
    localStorage.setItem(key, JSON.stringify(missions));
    this.update();
  }
}
