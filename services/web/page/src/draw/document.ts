// An edited drawing: undo history, last saved state, selection.
import { Drawing, empty_drawing, Item, item_of, ItemRef } from "./drawing";

const mostSteps = 200;

export class DrawingDocument {
  private current: Drawing = empty_drawing();
  private saved: Drawing = this.current;
  private done: Drawing[] = []; // the newest last
  private undone: Drawing[] = [];
  private before_drag: Drawing | null = null;
  private chosen: ItemRef | null = null;
  private readonly listeners: (() => void)[] = [];
  /** Version of the service's drawing that the edits are based on; empty: none was read. */
  version = "";

  get drawing(): Drawing {
    return this.current;
  }

  get selected(): ItemRef | null {
    return this.chosen;
  }

  selected_item(): Item | null {
    return (this.chosen && item_of(this.current, this.chosen)) ?? null;
  }

  /** Whether it differs from the saved drawing; undoing all edits makes them equal again. */
  get is_dirty(): boolean {
    return this.current !== this.saved;
  }

  get can_undo(): boolean {
    return this.done.length > 0;
  }

  get can_redo(): boolean {
    return this.undone.length > 0;
  }

  on_change(listener: () => void): void {
    this.listeners.push(listener);
  }

  select(ref: ItemRef | null): void {
    this.chosen = ref && item_of(this.current, ref) ? ref : null;
    this.notify();
  }

  /** Makes one step of the history; the selection becomes `selected`, or stays if possible. */
  edit(drawing: Drawing, selected: ItemRef | null = this.chosen): void {
    this.before_drag = null;
    this.push(this.current);
    this.show(drawing, selected);
  }

  /** During a drag: shown at once, but one step of the history at the end. */
  drag(drawing: Drawing): void {
    this.before_drag ??= this.current;
    this.show(drawing, this.chosen);
  }

  /** Ends the drag; false: cancels it. */
  end_drag(keep: boolean): void {
    const before = this.before_drag;
    this.before_drag = null;
    if (!before || before === this.current) return;
    if (keep) this.push(before);
    else this.current = before;
    this.notify();
  }

  undo(): void {
    const before = this.done.pop();
    if (!before) return;
    this.undone.push(this.current);
    this.show(before, this.chosen);
  }

  redo(): void {
    const after = this.undone.pop();
    if (!after) return;
    this.done.push(this.current);
    this.show(after, this.chosen);
  }

  /** Replaces the drawing; nothing can be undone. */
  load(drawing: Drawing, version: string): void {
    this.done = [];
    this.undone = [];
    this.before_drag = null;
    this.saved = drawing;
    this.version = version;
    this.show(drawing, null);
  }

  /** Replaces the drawing by the one that others have saved; undo restores it. */
  take_over(drawing: Drawing, version: string): void {
    this.saved = drawing;
    this.version = version;
    this.edit(drawing, null);
  }

  /** Returns to the saved drawing; undo restores the edits. */
  discard(): void {
    if (this.is_dirty) this.edit(this.saved, null);
  }

  /** The service now has `drawing` as `version`; edits may have continued meanwhile. */
  mark_saved(drawing: Drawing, version: string): void {
    this.saved = drawing;
    this.version = version;
    this.notify();
  }

  private push(drawing: Drawing): void {
    this.done.push(drawing);
    if (this.done.length > mostSteps) this.done.shift();
    this.undone = [];
  }

  private show(drawing: Drawing, selected: ItemRef | null): void {
    this.current = drawing;
    this.chosen = selected && item_of(drawing, selected) ? selected : null;
    this.notify();
  }

  private notify(): void {
    for (const listener of this.listeners) listener();
  }
}
