// The operator's page: the map with the views beside it.
import { Api, take_token } from "./api";
import { App, ViewPart } from "./app";
import { Channels } from "./channels";
import { Connection } from "./connection";
import { Identity } from "./identity";
import { MapView } from "./map/map_view";
import { Info } from "./protocol";
import { reason } from "./reasons";
import { Rights } from "./rights";
import { texts } from "./texts";
import { fill, h, icon, set_text, show } from "./ui/dom";
import { Header } from "./ui/header";
import { map_controls } from "./ui/map_controls";
import { Notices } from "./ui/notices";
import { once_a_frame } from "./ui/schedule";
import { Theme } from "./ui/theme";
import { CorrectView } from "./views/correct";
import { DrawView } from "./views/draw";
import { NowView } from "./views/now";
import { SendView } from "./views/send";
import { TimeView } from "./views/time";
import { UnderstandView } from "./views/understand";

type ViewName = keyof typeof texts.views;

// Views as tabs, following the ARIA practices: arrows move between tabs.
class Tabs {
  readonly element: HTMLElement;
  private readonly panel: HTMLElement;
  private readonly tabs = new Map<ViewName, HTMLButtonElement>();
  private current: ViewName | null = null;

  constructor(private readonly views: Record<ViewName, ViewPart>) {
    this.panel = h("div", { class: "panel", id: "panel", role: "tabpanel", tabindex: 0 });
    const names = Object.keys(views) as ViewName[];
    for (const name of names) {
      const tab = h(
        "button",
        {
          type: "button",
          role: "tab",
          id: `tab-${name}`,
          "aria-controls": "panel",
          class: "tab",
          onclick: () => this.open(name),
        },
        texts.views[name],
      );
      tab.prepend(icon(name));
      this.tabs.set(name, tab);
    }
    const bar = h(
      "div",
      { class: "tabs", role: "tablist", "aria-label": texts.views_label },
      ...this.tabs.values(),
    );
    this.element = h("aside", { class: "side" }, bar, this.panel);
    bar.addEventListener("keydown", (event) => {
      const at = this.current ? names.indexOf(this.current) : 0;
      const to = {
        ...{ ArrowRight: at + 1, ArrowDown: at + 1, ArrowLeft: at - 1, ArrowUp: at - 1 },
        ...{ Home: 0, End: names.length - 1 },
      }[event.key];
      if (to === undefined) return;
      const next = names[(to + names.length) % names.length];
      this.open(next);
      this.tabs.get(next)?.focus();
      event.preventDefault();
    });
  }

  open(name: ViewName): void {
    if (this.current === name) return;
    if (this.current) this.views[this.current].shown?.(false);
    this.current = name;
    for (const [other, tab] of this.tabs) {
      tab.setAttribute("aria-selected", String(other === name));
      tab.tabIndex = other === name ? 0 : -1;
    }
    this.panel.setAttribute("aria-labelledby", `tab-${name}`);
    fill(this.panel, this.views[name].element);
    this.panel.scrollTop = 0;
    this.views[name].shown?.(true);
    sessionStorage.setItem("topogeo-view", name);
  }

  /** Keys 1 to 6 open the views. */
  listen(): void {
    const names = [...this.tabs.keys()];
    document.addEventListener("keydown", (event) => {
      const target = event.target as HTMLElement;
      if (target.closest("input, select, textarea") || event.ctrlKey || event.altKey) return;
      const name = names[Number(event.key) - 1];
      if (name) this.open(name);
    });
  }

  is_open(name: ViewName): boolean {
    return this.current === name;
  }
}

// Placeholder shown until a map arrives.
function empty_map(channels: Channels): HTMLElement {
  const services = h("p");
  const element = h(
    "div",
    { class: "empty-map" },
    h("h2", {}, texts.empty_map.title),
    h("p", {}, texts.empty_map.text),
    services,
  );
  const update = once_a_frame(() => {
    const running = [...channels.table("services").values()].filter(
      (service) => service.state !== "lost" && service.service !== "web",
    );
    const names = running.map((service) => service.service).join(", ");
    set_text(services, names ? texts.empty_map.services(names) : texts.empty_map.no_services);
    show(element, channels.table("tiles").size === 0 && channels.table("graph").size === 0);
  });
  channels.on_table("services", update);
  channels.on_table("tiles", update);
  channels.on_table("graph", update);
  update();
  return element;
}

function start(): void {
  document.documentElement.lang = texts.language;
  const token = take_token();
  const theme = new Theme();
  const channels = new Channels();
  const rights = new Rights();
  const identity = new Identity();
  const api = new Api(token, identity.id);
  const notices = new Notices();

  const robot = h("h1", { class: "robot-name" }, texts.title);
  const theme_button = h("button", {
    type: "button",
    class: "control flat",
    title: texts.controls.theme,
    "aria-label": texts.controls.theme,
    onclick: () => theme.toggle(),
  });
  theme_button.append(icon("sun"));
  const header = new Header(channels, rights, api, notices, [robot, theme_button]);
  const canvas = h("div", {
    class: "map",
    id: "map",
    role: "application",
    "aria-label": texts.map_label,
    tabindex: 0,
  });
  const scale = h("div", { class: "scale", "aria-hidden": "true" });
  const stage = h("main", { class: "stage" }, canvas, scale, empty_map(channels));
  const root = h("div", { class: "app" }, header.element, header.banners, stage);
  document.body.replaceChildren(root);

  const read_info = async () => {
    const info = await api.get<Info>("/api/info").catch(() => null);
    if (!info) return;
    if (info.offers) rights.set_offers(info.offers);
    set_text(robot, info.robot_id || texts.no_robot);
    document.title = `${info.robot_id || texts.no_robot} – ${texts.title}`;
  };
  const connection = new Connection(channels, token, identity, [], {
    connected: (may_write, error, page) => {
      rights.set_connected(true, may_write, page);
      if (error) header.show_token_error();
      void read_info();
    },
    disconnected: () => {
      rights.set_connected(false, false);
      channels.forget_moment();
    },
    refused: (_, error) => notices.show(reason(error), "error"),
  });
  const map = new MapView(canvas, scale, channels, theme);
  const app: App = { channels, api, notices, rights, connection, identity, map, theme };
  const send = new SendView(app);
  header.on_stop = () => {
    connection.send({ op: "stop" });
    send.let_go();
  };
  const views = {
    now: new NowView(app),
    send,
    correct: new CorrectView(app),
    understand: new UnderstandView(app),
    draw: new DrawView(app),
    time: new TimeView(app),
  };
  const tabs = new Tabs(views);
  header.on_show_alarms = () => {
    tabs.open("understand");
    views.understand.show_alarms();
  };
  stage.append(map_controls(map));
  tabs.listen();
  root.append(tabs.element, notices.element);
  map.on_tap = (x_m, y_m, pixels_per_m) => {
    if (!tabs.is_open("now") && !tabs.is_open("send")) return;
    if (rights.may_write) tabs.open("send");
    send.choose_point(x_m, y_m, pixels_per_m);
  };
  const stored = sessionStorage.getItem("topogeo-view") as ViewName | null;
  tabs.open(stored && stored in views ? stored : "now");
}

start();
