// The tools with a hint for the chosen one, grid and snapping.
import { App } from "../app";
import { Editor } from "../draw/editor";
import { ToolName } from "../draw/tools";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "../ui/dom";
import { folded, section } from "../ui/section";

const words = texts.draw;
const toolGroups: [string, ToolName[]][] = [
  ["", ["select"]],
  [words.groups.names, ["place", "base"]],
  [words.groups.walls, ["wall", "opening", "door"]],
  [words.groups.zones, ["no_go", "slow", "one_way", "preferred"]],
  [words.groups.rooms, ["split", "join", "rename"]],
];
const gridsM = [0, 0.05, 0.1, 0.25, 0.5, 1];

export class DrawToolbox {
  readonly element: HTMLElement;
  readonly snapping: HTMLElement;
  private readonly buttons = new Map<ToolName, HTMLButtonElement>();
  private readonly rooms: HTMLElement;
  private readonly how = h("p", { class: "quiet", id: "draw-how" });
  private readonly finish: HTMLButtonElement;
  private readonly cancel: HTMLButtonElement;
  private readonly cursor = h("p", { class: "quiet draw-cursor" });

  constructor(
    private readonly app: App,
    private readonly editor: Editor,
    private readonly choose: (tool: ToolName) => void,
    redraw: () => void,
  ) {
    const groups = toolGroups.map(([title, tools]) => this.group(title, tools));
    this.rooms = groups[groups.length - 1];
    this.finish = button(words.finish, () => editor.finish(), { class: "button primary" });
    this.cancel = button(words.cancel, () => editor.escape());
    this.element = section(
      words.tools,
      h("div", { class: "tools" }, ...groups),
      this.how,
      this.cursor,
      h("div", { class: "buttons" }, this.finish, this.cancel),
    );
    this.snapping = this.snapping_part(redraw);
  }

  update(): void {
    const { tool, at } = this.editor;
    for (const [name, element] of this.buttons) {
      set_attribute(element, "aria-pressed", String(name === tool));
    }
    show(this.rooms, !this.editor.alone && this.app.rights.can("room_shapes"));
    set_text(this.how, words.how[tool]);
    const { points, complete } = this.editor.progress();
    show(this.finish, complete);
    show(this.cancel, points > 0);
    show(this.cursor, at !== null);
    if (at) set_text(this.cursor, words.cursor(at.x, at.y));
  }

  private group(title: string, tools: ToolName[]): HTMLElement {
    const buttons = tools.map((tool) => {
      const element = button(words.tool[tool], () => this.choose(tool), {
        class: "button small tool",
        "aria-pressed": "false",
        "aria-describedby": "draw-how",
        "data-tool": tool,
      });
      this.buttons.set(tool, element);
      return element;
    });
    return h(
      "div",
      { class: "tool-group", role: "group", "aria-label": title || words.tools },
      title ? h("span", { class: "quiet", "aria-hidden": "true" }, title) : null,
      ...buttons,
    );
  }

  private snapping_part(redraw: () => void): HTMLElement {
    const { settings } = this.editor;
    const step = h(
      "select",
      { class: "field", id: "draw-grid" },
      ...gridsM.map((meters) => {
        const text = meters === 0 ? words.no_grid : words.step(meters);
        return h("option", { value: meters, selected: meters === settings.grid_m }, text);
      }),
    );
    step.addEventListener("change", () => {
      settings.grid_m = Number(step.value);
      redraw();
    });
    const box = (text: string, name: "corners" | "right_angles") => {
      const input = h("input", { type: "checkbox", checked: settings[name] });
      input.addEventListener("change", () => (settings[name] = input.checked));
      return h("label", { class: "check" }, input, text);
    };
    return folded(
      words.snapping,
      false,
      h("div", { class: "field-row" }, h("label", { for: "draw-grid" }, words.grid), step),
      box(words.to_corners, "corners"),
      box(words.to_angles, "right_angles"),
      h("p", { class: "quiet" }, words.keyboard),
    );
  }
}
