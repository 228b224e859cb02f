// Draw: the edit mode, with tools, selected item, saving, editing of rooms, and a new floor.
import { App, ViewPart } from "../app";
import { DrawingDocument } from "../draw/document";
import { Drawing, Item, kind_of } from "../draw/drawing";
import { DrawingStore } from "../draw/drawing_store";
import { Editor } from "../draw/editor";
import { point_at } from "../draw/geometry";
import { join_rooms, room_to_rename, split_room } from "../draw/room_edits";
import { Finished } from "../draw/sketch";
import { OtherTool, ToolName } from "../draw/tools";
import { texts } from "../texts";
import { h, set_text, show } from "../ui/dom";
import { once_a_frame } from "../ui/schedule";
import { DrawFloor } from "./draw_floor";
import { DrawItem, size_text } from "./draw_item";
import { DrawList } from "./draw_list";
import { DrawSave } from "./draw_save";
import { DrawToolbox } from "./draw_toolbox";

const words = texts.draw;

export class DrawView implements ViewPart {
  readonly element: HTMLElement;
  private readonly on_map = new DrawingDocument();
  private readonly floor_document = new DrawingDocument();
  private readonly store: DrawingStore;
  private readonly editor: Editor;
  private readonly save: DrawSave;
  private readonly toolbox: DrawToolbox;
  private readonly item: DrawItem;
  private readonly list: DrawList;
  private readonly floor: DrawFloor;
  private readonly note = h("p", { class: "note" });
  private readonly parts: HTMLElement;
  private readonly hint = h("p", { class: "quiet" });
  private readonly spoken = h("p", { class: "unseen", role: "status" });
  private readonly update: () => void;
  private visible = false;

  constructor(private readonly app: App) {
    const redraw = () => app.map.redraw_moving();
    this.update = once_a_frame(() => this.update_now());
    this.store = new DrawingStore(app.api, app.channels, app.rights);
    this.editor = new Editor(this.on_map, app.theme, {
      redraw,
      changed: this.update,
      drawn: (item) => this.say_drawn(item),
      asked: (tool, drawn) => void this.on_asked(tool, drawn),
      middle: () => app.map.middle(),
      on_map: (right, up) => app.map.on_map(right, up),
    });
    const choose = (tool: ToolName) => this.choose(tool);
    const redraw_all = () => app.map.scene.refresh();
    const open = () => this.editor.document;
    this.save = new DrawSave(app, this.editor, this.store);
    this.toolbox = new DrawToolbox(app, this.editor, choose, redraw_all);
    this.item = new DrawItem(open, () => this.editor.delete_selected());
    this.list = new DrawList(open, app.map);
    this.floor = new DrawFloor(app, this.editor, {
      choose,
      open_plane: (alone) => this.open_plane(alone),
      redraw: redraw_all,
    });
    this.parts = h(
      "div",
      {},
      this.save.element,
      this.hint,
      this.toolbox.element,
      this.item.element,
      this.toolbox.snapping,
      this.list.element,
      this.floor.element,
    );
    this.element = h("div", { class: "view" }, this.note, this.parts, this.spoken);
    for (const document of [this.on_map, this.floor_document]) {
      document.on_change(() => {
        redraw();
        this.update();
      });
    }
    this.store.on_change(() => {
      app.map.scene.drawn = this.store.drawing;
      app.map.scene.refresh();
    });
    app.rights.on_change(() => this.show_on_map());
    this.listen();
    this.update_now();
  }

  shown(visible: boolean): void {
    this.visible = visible;
    if (!visible && this.on_map.is_dirty) this.app.notices.show(words.kept);
    if (visible) this.save.take_newest();
    this.show_on_map();
  }

  private get may_draw(): boolean {
    const { rights } = this.app;
    return rights.may_write && (rights.knows("drawing") || rights.knows("floor"));
  }

  private show_on_map(): void {
    const { map } = this.app;
    const shown = this.visible && this.may_draw;
    const had = map.scene.overlay;
    map.scene.overlay = shown ? this.editor : null;
    if (shown !== (had !== null)) {
      if (shown) this.choose(this.editor.tool);
      else map.end_tool();
      map.take_keys(true);
      this.show_plane();
      map.scene.refresh();
    }
    this.update();
  }

  private show_plane(): void {
    const alone = this.app.map.scene.overlay?.alone ?? false;
    if (this.app.map.show_plane(alone)) this.app.map.fit(false);
  }

  private choose(tool: ToolName): void {
    this.editor.switch_to(tool);
    const drawing = tool !== "select";
    this.app.map.start_tool(this.editor, drawing);
    this.app.map.take_keys(!drawing);
  }

  private open_plane(alone: boolean): void {
    this.editor.open(alone ? this.floor_document : this.on_map, alone);
    this.choose("select");
    this.save.take_newest();
    if (alone) this.hint.after(this.floor.element);
    else this.parts.append(this.floor.element);
    this.show_plane();
    this.app.map.scene.refresh();
  }

  private update_now(): void {
    show(this.parts, this.may_draw);
    show(this.note, !this.may_draw);
    set_text(this.note, this.app.rights.may_write ? words.not_offered : words.spectator);
    set_text(this.hint, this.editor.alone ? words.floor_hint : words.hint);
    this.save.update();
    this.toolbox.update();
    this.item.update();
    this.list.update();
    this.floor.update();
    document.getElementById("tab-draw")?.toggleAttribute("data-unsaved", this.on_map.is_dirty);
  }

  private say_drawn(item: Item): void {
    const { selected } = this.editor.document;
    if (!selected) return;
    const kind = words.titles[kind_of(selected.list, item)];
    set_text(this.spoken, words.drawn(kind, size_text(selected, item)));
  }

  private async on_asked(tool: OtherTool, drawn: Finished): Promise<void> {
    if (tool === "measure" || tool === "shift") return this.floor.asked(tool, drawn);
    const { api, channels, notices } = this.app;
    const { document } = this.editor;
    const before = document.drawing;
    const [a, b] = [point_at(drawn.points, 0), point_at(drawn.points, 1)];
    const edits: Record<typeof tool, () => Promise<Drawing>> = {
      split: () => split_room(api, channels.table("rooms"), before, [a, b]),
      join: () => join_rooms(api, channels.table("rooms"), before, [a, b]),
      rename: () => room_to_rename(api, channels.table("rooms"), before, a),
    };
    const done = { split: words.rooms.split, join: words.rooms.joined, rename: words.rooms.rename };
    try {
      const edited = await edits[tool]();
      if (document.drawing !== before) return; // edited meanwhile
      document.edit(edited, { list: "zones", index: edited.zones.length - 1 });
      notices.show(done[tool]);
      if (tool === "rename") this.ask_name();
    } catch (error) {
      notices.fail(error);
    }
  }

  private ask_name(): void {
    this.choose("select");
    this.update_now();
    const input = document.getElementById("draw-name") as HTMLInputElement | null;
    input?.focus();
    input?.select();
  }

  private listen(): void {
    document.addEventListener("keydown", (event) => {
      const target = event.target as HTMLElement;
      if (!this.visible || !this.may_draw) return;
      if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "s") {
        event.preventDefault();
        if (!this.editor.alone) void this.save.save_now(this.on_map.version);
        return;
      }
      if (target.closest("input, select, textarea")) return;
      const on_map = target.closest("#map") !== null && !event.ctrlKey && !event.altKey;
      if (this.editor.key(event) || (on_map && this.editor.map_key(event.key))) {
        event.preventDefault();
        // Escape may have changed the tool.
        this.app.map.start_tool(this.editor, this.editor.tool !== "select");
        this.app.map.take_keys(this.editor.tool === "select");
      }
    });
    window.addEventListener("beforeunload", (event) => {
      if (!this.on_map.is_dirty && !this.floor_document.is_dirty) return;
      event.preventDefault();
      event.returnValue = "";
    });
  }
}
