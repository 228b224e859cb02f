// The operators: who has the controls, and the name of this page's one.
import { App } from "../app";
import { choose_language } from "../language";
import { is_map_alone } from "../robot_state";
import { languages, texts } from "../texts";
import { Facts } from "../ui/bar";
import { button, field, h, show } from "../ui/dom";
import { section } from "../ui/section";

const words = texts.controls_of_robot;

export class Operators {
  readonly element: HTMLElement;
  private readonly own: HTMLElement; // of an operator's page
  private readonly facts = new Facts();
  private readonly let_go: HTMLButtonElement;

  constructor(private readonly app: App) {
    const name = h("input", {
      type: "text",
      class: "field",
      id: "operator-name",
      maxlength: 24,
      autocomplete: "name",
      placeholder: words.no_name,
      value: app.identity.name,
      onchange: () => {
        app.identity.name = name.value;
        void this.order({ do: "rename", name: app.identity.name });
      },
    });
    this.let_go = button(words.let_go, () => void this.order({ do: "let_go" }));
    const language: HTMLSelectElement = h(
      "select",
      { class: "field", id: "language", onchange: () => choose_language(language.value) },
      ...Object.keys(languages).map((code) =>
        h(
          "option",
          { value: code, lang: code, selected: code === texts.language },
          words.language_names[code] ?? code,
        ),
      ),
    );
    this.own = h(
      "div",
      {},
      this.facts.element,
      field(words.your_name, name),
      h("div", { class: "buttons" }, this.let_go),
    );
    this.element = section(words.title, this.own, field(words.language, language));
    this.update();
  }

  update(): void {
    const { rights, channels } = this.app;
    const holder = channels.value("controls")?.holder ?? null;
    const mine = holder !== null && holder.page === rights.page;
    show(this.own, rights.may_write && rights.page !== 0 && !is_map_alone(channels));
    this.facts.set(words.holder, holder === null ? words.nobody : mine ? words.mine : holder.name);
    show(this.let_go, mine);
  }

  private async order(what: Record<string, string>): Promise<void> {
    try {
      await this.app.api.post("controls", what);
    } catch (error) {
      this.app.notices.fail(error);
    }
  }
}
