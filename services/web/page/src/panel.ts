// /panel: a keypad and a display for the robot's own small screen.
import { Api, take_token } from "./api";
import { Channels } from "./channels";
import { Connection } from "./connection";
import { Destination, destinations, numbered } from "./destinations";
import { Identity } from "./identity";
import { reason } from "./reasons";
import { Rights } from "./rights";
import { is_paused, navigator_text } from "./robot_state";
import { texts } from "./texts";
import { button, h, set_attribute, set_text, show } from "./ui/dom";
import { Header } from "./ui/header";
import { KeyedList } from "./ui/list";
import { Notices } from "./ui/notices";
import { once_a_frame } from "./ui/schedule";
import { Theme } from "./ui/theme";

const words = texts.panel;
const digits = 3;

class Panel {
  readonly element: HTMLElement;
  private readonly number = h("output", { class: "panel-number", "aria-label": words.prompt });
  private readonly name = h("span", { class: "panel-name" });
  private readonly line = h("p", { class: "panel-line", role: "status", "aria-label": words.line });
  private readonly go: HTMLButtonElement;
  private readonly pause: HTMLButtonElement;
  private readonly cancel: HTMLButtonElement;
  private readonly home: HTMLButtonElement;
  private readonly names: KeyedList<[number, Destination]>;
  private readonly empty = h("p", { class: "quiet" }, words.no_names);
  private entered = "";

  constructor(
    private readonly channels: Channels,
    private readonly rights: Rights,
    private readonly api: Api,
    private readonly notices: Notices,
  ) {
    this.go = button(words.go, () => void this.send(), { class: "button key primary" });
    this.pause = button(words.pause, () => void this.toggle_pause(), { class: "button key" });
    this.cancel = button(words.cancel, () => void this.order("cancel"), { class: "button key" });
    this.home = button(words.return, () => void this.order("return"), { class: "button key" });
    const digit = (text: string) =>
      button(text, () => this.type(text), { class: "button key digit" });
    const erase = button("⌫", () => this.type(""), {
      class: "button key digit",
      "aria-label": words.erase,
    });
    const keypad = h(
      "div",
      { class: "keypad", role: "group", "aria-label": words.keypad },
      ...["1", "2", "3", "4", "5", "6", "7", "8", "9"].map(digit),
      erase,
      digit("0"),
      this.go,
    );
    this.names = new KeyedList<[number, Destination]>(
      "panel-names",
      (key) =>
        h(
          "li",
          {},
          button("", () => this.type_whole(key), { class: "button" }),
        ),
      (element, [number, destination]) => {
        const text = `${number}  ${destination.name}`;
        set_text(element.firstElementChild as HTMLElement, text);
      },
    );
    this.element = h(
      "main",
      { class: "panel-page" },
      this.line,
      h("div", { class: "panel-display" }, this.number, this.name),
      keypad,
      h(
        "section",
        { class: "panel-goals", "aria-label": words.names },
        this.names.element,
        this.empty,
      ),
      h("div", { class: "panel-orders" }, this.pause, this.cancel, this.home),
    );
    const update = once_a_frame(() => this.update());
    channels.on_value(["navigator", "goals", "pose"], update);
    channels.on_table("places", update);
    channels.on_table("rooms", update);
    rights.on_change(update);
    document.addEventListener("keydown", (event) => this.on_key(event));
    this.update();
  }

  private goals(): Map<number, Destination> {
    return numbered(destinations(this.channels));
  }

  private type(digit: string): void {
    this.entered =
      digit === "" ? this.entered.slice(0, -1) : (this.entered + digit).slice(-digits);
    this.update();
  }

  private type_whole(number: string): void {
    this.entered = number;
    this.update();
  }

  private on_key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (/^\d$/.test(event.key)) this.type(event.key);
    else if (event.key === "Backspace") this.type("");
    else if (event.key === "Enter" && event.target === document.body) void this.send();
  }

  private async send(): Promise<void> {
    const goal = this.goals().get(Number(this.entered));
    if (!goal) return this.notices.show(words.unknown(this.entered), "error");
    const order = this.api.post("goal", { place: goal.name });
    if (await this.notices.report(order, texts.done.goal(goal.name))) {
      this.entered = "";
      this.update();
    }
  }

  private is_paused(): boolean {
    return is_paused(this.channels);
  }

  private toggle_pause(): Promise<void> {
    return this.order(this.is_paused() ? "resume" : "pause");
  }

  private async order(what: string): Promise<void> {
    try {
      await this.api.post(what);
    } catch (error) {
      this.notices.show(error instanceof Error ? error.message : String(error), "error");
    }
  }

  private update(): void {
    const goals = this.goals();
    const chosen = goals.get(Number(this.entered));
    set_text(this.number, this.entered || "–");
    const missing = this.entered ? words.unknown(this.entered) : words.prompt;
    set_text(this.name, chosen?.name ?? missing);
    set_attribute(this.name, "data-level", this.entered && !chosen ? "bad" : "plain");
    const goals_now = this.channels.value("goals");
    const current = goals_now?.current;
    const to = goals_now?.exploring
      ? `${texts.send.exploring} `
      : current
        ? `${texts.send.to(current.text)}. `
        : "";
    set_text(this.line, to + navigator_text(this.channels, this.rights));
    this.go.disabled = !chosen || !this.rights.can("goal");
    set_text(this.pause, this.is_paused() ? words.resume : words.pause);
    this.pause.disabled = !(current || goals_now?.exploring) || !this.rights.can("pause");
    this.cancel.disabled = !(current || goals_now?.exploring) || !this.rights.can("cancel");
    this.home.disabled = !this.rights.can("return");
    const list = [...goals];
    this.names.show(list.map((entry) => [String(entry[0]), entry] as const));
    show(this.empty, list.length === 0);
  }
}

function start(): void {
  document.documentElement.lang = texts.language;
  const token = take_token();
  new Theme();
  const channels = new Channels();
  const rights = new Rights();
  const identity = new Identity();
  const api = new Api(token, identity.id);
  const notices = new Notices();
  const title = h("h1", { class: "unseen" }, words.title);
  const header = new Header(channels, rights, api, notices, [title]);
  const panel = new Panel(channels, rights, api, notices);
  const root = h("div", { class: "app panel-app" }, header.element, header.banners, panel.element);
  root.append(notices.element);
  document.body.replaceChildren(root);
  document.title = `${words.title} – ${texts.title}`;
  const names = [
    ...["pose", "navigator", "goals", "base", "drive", "controls"],
    ...["places", "rooms", "services", "time"],
  ];
  const connection = new Connection(channels, token, identity, names, {
    connected: (may_write, error, page) => {
      rights.set_connected(true, may_write, page);
      if (error) header.show_token_error();
    },
    disconnected: () => {
      rights.set_connected(false, false);
      channels.forget_moment();
    },
    refused: (_, error) => notices.show(reason(error), "error"),
  });
  header.on_stop = () => void connection.send({ op: "stop" });
}

start();
