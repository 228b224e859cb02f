// Draws a new floor and loads it into simulator or robot; handles drawing files and the background
// picture.
import { App } from "../app";
import { Background, measured } from "../draw/background";
import { parse_drawing, start_of } from "../draw/drawing";
import { Editor } from "../draw/editor";
import { distance, Point, point_at } from "../draw/geometry";
import { Finished } from "../draw/sketch";
import { ToolName } from "../draw/tools";
import { texts } from "../texts";
import { button, h, show } from "../ui/dom";
import { folded } from "../ui/section";

const words = texts.draw.floor;
const fileFormat = "topogeo drawing";

type Target = "simulator" | "robot";

export interface FloorHooks {
  choose(tool: ToolName): void;
  /** The plane of the new floor is opened or left. */
  open_plane(alone: boolean): void;
  redraw(): void;
}

export class DrawFloor {
  readonly element: HTMLElement;
  private readonly start: HTMLElement;
  private readonly plane: HTMLElement;
  private readonly name: HTMLInputElement;
  private readonly sure = h("div", { class: "card", role: "alert", hidden: true });
  private readonly picture: HTMLElement;
  private readonly distance_form: HTMLFormElement;
  private readonly loads: HTMLElement;
  private readonly not_offered = h("p", { class: "quiet" }, words.not_offered);
  private pair: [Point, Point] | null = null; // measuring points on the picture

  constructor(
    private readonly app: App,
    private readonly editor: Editor,
    private readonly hooks: FloorHooks,
  ) {
    this.name = h("input", { class: "field", id: "floor-name", value: words.first_name });
    this.distance_form = this.make_distance_form();
    this.picture = this.picture_tools();
    this.start = button(words.start, () => hooks.open_plane(true));
    this.loads = h(
      "div",
      { class: "buttons" },
      button(words.simulator, () => this.ask("simulator"), { class: "button primary" }),
      button(words.robot, () => this.ask("robot")),
    );
    this.plane = h(
      "div",
      { hidden: true },
      h("label", { for: "floor-name", class: "quiet" }, words.name),
      this.name,
      this.loads,
      this.not_offered,
      this.sure,
      this.picture_part(),
      h("div", { class: "buttons" }, button(words.back, () => hooks.open_plane(false))),
    );
    this.element = folded(words.title, false, this.start, this.plane, this.files());
  }

  update(): void {
    const { alone, background } = this.editor;
    show(this.start, !alone);
    show(this.plane, alone);
    const offered = this.app.rights.can("floor");
    show(this.loads, offered);
    show(this.not_offered, !offered);
    show(this.picture, background !== null);
    if (alone) (this.element as HTMLDetailsElement).open = true;
  }

  /** The picture's tools have their points. */
  asked(tool: "measure" | "shift", drawn: Finished): void {
    const { background } = this.editor;
    const [a, b] = [point_at(drawn.points, 0), point_at(drawn.points, 1)];
    if (!background || distance(a, b) === 0) return;
    if (tool === "shift") {
      const { placement } = background;
      const { x_m, y_m } = placement;
      background.placement = { ...placement, x_m: x_m + b.x - a.x, y_m: y_m + b.y - a.y };
      this.hooks.redraw();
      return;
    }
    this.pair = [a, b];
    show(this.distance_form, true);
    const input = this.distance_form.querySelector("input") as HTMLInputElement;
    input.value = distance(a, b).toFixed(2);
    input.select();
    input.focus();
  }

  // ---- load

  private ask(target: Target): void {
    const { drawing } = this.editor.document;
    if (drawing.walls.length === 0) return this.app.notices.show(words.no_walls, "error");
    if (!start_of(drawing)) return this.app.notices.show(words.no_start, "error");
    const close = () => show(this.sure, false);
    const yes = button(words.yes, () => {
      close();
      void this.load(target);
    });
    yes.className = "button primary";
    const text = target === "simulator" ? words.simulator_sure : words.robot_sure;
    this.sure.replaceChildren(
      h("p", {}, text),
      h("div", { class: "buttons" }, yes, button(words.no, close)),
    );
    show(this.sure, true);
    yes.focus();
  }

  private async load(target: Target): Promise<void> {
    const { document } = this.editor;
    const { drawing } = document;
    const name = this.name.value.trim() || words.first_name;
    const order = { target, name, ...drawing, start: start_of(drawing) };
    const loaded = await this.app.notices.report(this.app.api.post("floor", order), words.loaded);
    if (!loaded) return;
    document.mark_saved(drawing, document.version);
    this.hooks.open_plane(false);
  }

  // ---- files

  private files(): HTMLElement {
    return h(
      "div",
      { class: "buttons", role: "group", "aria-label": words.files },
      button(words.export, () => this.export_file()),
      file_button(words.import, "application/json,.json", (file) => void this.import_file(file)),
    );
  }

  private export_file(): void {
    const { document: edited, alone } = this.editor;
    const name = this.name.value.trim() || words.first_name;
    const content = { format: fileFormat, name, ...edited.drawing };
    const blob = new Blob([JSON.stringify(content, null, 1)], { type: "application/json" });
    const link = h("a", { href: URL.createObjectURL(blob), download: `${name}.json` });
    link.click();
    window.setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    if (alone) edited.mark_saved(edited.drawing, edited.version);
  }

  private async import_file(file: File): Promise<void> {
    let content: unknown;
    try {
      content = JSON.parse(await file.text());
    } catch {
      return this.app.notices.show(words.no_json, "error");
    }
    try {
      this.editor.document.edit(parse_drawing(content), null);
    } catch (error) {
      return this.app.notices.fail(error);
    }
    const { name } = content as { name?: unknown };
    if (typeof name === "string") this.name.value = name;
    this.app.notices.show(words.imported);
  }

  // ---- picture

  private picture_part(): HTMLElement {
    const choose = file_button(words.choose, "image/png,image/jpeg", (file) => {
      void this.take_picture(file);
    });
    return h("div", { class: "card" }, h("h3", {}, words.picture), choose, this.picture);
  }

  private picture_tools(): HTMLElement {
    const { tool } = texts.draw;
    const opacity = h("input", {
      type: "range",
      id: "picture-opacity",
      min: 0.1,
      max: 1,
      step: 0.05,
      value: 0.5,
    });
    opacity.addEventListener("input", () => {
      if (this.editor.background) this.editor.background.opacity = Number(opacity.value);
      this.hooks.redraw();
    });
    return h(
      "div",
      { hidden: true },
      h(
        "div",
        { class: "buttons" },
        button(tool.measure, () => this.hooks.choose("measure")),
        button(tool.shift, () => this.hooks.choose("shift")),
        button(words.remove, () => this.remove_picture()),
      ),
      this.distance_form,
      h(
        "div",
        { class: "field-row" },
        h("label", { for: "picture-opacity" }, words.opacity),
        opacity,
      ),
    );
  }

  private make_distance_form(): HTMLFormElement {
    const input = h("input", {
      type: "number",
      step: "any",
      min: 0.01,
      required: true,
      class: "field",
      id: "known-distance",
      "aria-label": words.known,
    });
    const form = h(
      "form",
      { hidden: true },
      h("label", { for: "known-distance", class: "quiet" }, words.known_hint),
      input,
      h(
        "div",
        { class: "buttons" },
        h("button", { type: "submit", class: "button primary" }, words.apply),
      ),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const { background } = this.editor;
      if (!background || !this.pair) return;
      const [a, b] = this.pair;
      background.placement = measured(background.placement, a, b, input.valueAsNumber);
      show(form, false);
      this.hooks.choose("select");
      this.hooks.redraw();
    });
    return form;
  }

  private async take_picture(file: File): Promise<void> {
    try {
      const picture = await createImageBitmap(file);
      this.editor.background = new Background(picture, this.app.map.middle());
    } catch {
      this.app.notices.show(words.no_picture, "error");
    }
    this.update();
    this.hooks.redraw();
  }

  private remove_picture(): void {
    this.editor.background = null;
    this.update();
    this.hooks.redraw();
  }
}

// A button to choose a file from the disk.
function file_button(text: string, accept: string, take: (file: File) => void): HTMLElement {
  const input = h("input", { type: "file", accept, hidden: true, "aria-label": text });
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file) take(file);
  });
  const open = button(text, () => input.click());
  return h("span", {}, open, input);
}
