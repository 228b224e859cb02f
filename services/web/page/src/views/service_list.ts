// Services with their health.
import { App } from "../app";
import * as format from "../format";
import { reason } from "../reasons";
import { Service } from "../protocol";
import { texts } from "../texts";
import { h, set_attribute, set_text, show } from "../ui/dom";
import { KeyedList } from "../ui/list";

const words = texts.understand;

const levelClasses: Record<string, string> = {
  running: "good",
  finished: "good",
  starting: "fair",
  waiting: "fair",
  failed: "bad",
  lost: "bad",
};

export class ServiceList {
  readonly element: HTMLElement;
  private readonly empty = h("p", { class: "quiet" }, words.no_services);
  private readonly list: KeyedList<Service>;

  constructor(private readonly app: App) {
    this.list = new KeyedList<Service>(
      "rows services",
      () =>
        h(
          "li",
          {},
          h("h3"),
          h("span", { class: "badge" }),
          h("p"),
          h("p", { class: "bad-text" }),
          h(
            "details",
            { class: "technical" },
            h("summary", {}, words.technical),
            h("p", { class: "quiet" }),
          ),
        ),
      show_service,
    );
    this.element = h("div", {}, this.empty, this.list.element);
  }

  update(): void {
    const services = [...this.app.channels.table("services")];
    services.sort((a, b) => a[1].service.localeCompare(b[1].service) || (a[0] < b[0] ? -1 : 1));
    show(this.empty, services.length === 0);
    this.list.show(services);
  }
}

function show_service(element: HTMLElement, service: Service): void {
  const [name, state, message, faults, technical] = element.children as unknown as HTMLElement[];
  set_text(name, service.service);
  set_text(state, words.service_states[service.state] ?? service.state);
  set_attribute(element, "data-level", levelClasses[service.state] ?? "plain");
  const waits = service.waits_for ? words.waits_for(service.waits_for) : "";
  const text = [reason(service.message), waits].filter(Boolean).join(" ");
  set_text(message, text);
  show(message, text !== "");
  const parts = [service.host];
  if (service.input) parts.push(words.input(service.input, format.rate(service.input_rate_per_s)));
  if (service.memory_bytes) parts.push(format.memory(service.memory_bytes));
  if (service.cpu_s) parts.push(`CPU ${format.duration(service.cpu_s)}`);
  set_text(technical.lastElementChild as HTMLElement, parts.join(" · "));
  const last = service.last_error ? ` ${words.last_error(reason(service.last_error))}` : "";
  set_text(faults, service.faults > 0 ? `${words.faults(service.faults)}.${last}` : "");
  show(faults, service.faults > 0);
}
