// Undo, redo, save, discard, and conflicts with others who have saved meanwhile.
import { ApiError } from "../api";
import { App } from "../app";
import { DrawingStore } from "../draw/drawing_store";
import { Editor } from "../draw/editor";
import { reason } from "../reasons";
import { texts } from "../texts";
import { button, h, icon, IconName, set_text, show } from "../ui/dom";

const words = texts.draw;

export class DrawSave {
  readonly element: HTMLElement;
  private readonly state = h("span", { class: "quiet", role: "status" });
  private readonly conflict: HTMLElement;
  private readonly undo: HTMLButtonElement;
  private readonly redo: HTMLButtonElement;
  private readonly save: HTMLButtonElement;
  private readonly discard: HTMLButtonElement;
  private saving = false;

  constructor(
    private readonly app: App,
    private readonly editor: Editor,
    private readonly store: DrawingStore,
  ) {
    this.undo = picture_button(words.undo, "undo", () => editor.document.undo());
    this.redo = picture_button(words.redo, "redo", () => editor.document.redo());
    this.save = button(words.save, () => void this.save_now(editor.document.version), {
      class: "button primary",
    });
    this.discard = button(words.discard, () => editor.document.discard());
    this.conflict = h(
      "div",
      { class: "card", role: "alert", hidden: true },
      h("p", {}, words.conflict),
      h(
        "div",
        { class: "buttons" },
        button(words.take_theirs, () => this.take_theirs()),
        button(words.save_over, () => void this.save_now(store.version)),
      ),
    );
    this.element = h(
      "div",
      { class: "draw-save" },
      h("div", { class: "buttons" }, this.undo, this.redo, this.save, this.discard),
      this.state,
      this.conflict,
    );
    store.on_change(() => this.take_newest());
  }

  update(): void {
    const { document, alone } = this.editor;
    this.undo.disabled = !document.can_undo;
    this.redo.disabled = !document.can_redo;
    this.discard.disabled = !document.is_dirty;
    const can_save = this.app.rights.can("drawing") && !this.saving;
    this.save.disabled = !document.is_dirty || !can_save;
    show(this.save, !alone);
    show(this.state, !alone);
    set_text(this.state, document.is_dirty ? words.dirty : words.clean);
    show(this.conflict, !alone && document.is_dirty && this.is_behind() && !this.saving);
  }

  /** Shows the drawing saved last, unless there are edits here. */
  take_newest(): void {
    const { document, alone } = this.editor;
    if (alone || this.saving) return;
    if (!document.is_dirty && this.is_behind()) {
      document.load(this.store.drawing, this.store.version);
    }
    this.update();
  }

  /** Saves on top of a version. */
  async save_now(version: string): Promise<void> {
    const { document } = this.editor;
    if (this.saving || !document.is_dirty) return;
    const { drawing } = document;
    this.saving = true;
    this.update();
    try {
      const saved = await this.store.save(drawing, version);
      document.mark_saved(drawing, saved.version);
      this.app.notices.show(saved.message ? reason(saved.message) : words.saved);
    } catch (error) {
      if (error instanceof ApiError && error.status === 409) await this.store.read();
      this.app.notices.fail(error);
    }
    this.saving = false;
    this.take_newest();
  }

  private is_behind(): boolean {
    return this.store.version !== this.editor.document.version;
  }

  private take_theirs(): void {
    this.editor.document.take_over(this.store.drawing, this.store.version);
    this.app.notices.show(words.theirs_taken);
  }
}

function picture_button(text: string, picture: IconName, act: () => void): HTMLButtonElement {
  const element = button("", act, { title: text, "aria-label": text });
  element.append(icon(picture));
  return element;
}
