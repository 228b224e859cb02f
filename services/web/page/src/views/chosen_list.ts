// The chosen goals in their order.
import { Goal } from "../protocol";
import { texts } from "../texts";
import { button, h } from "../ui/dom";

const words = texts.send;

/** A chosen goal with its name, at this position of the map. */
export interface Choice {
  goal: Goal;
  text: string;
  x_m: number;
  y_m: number;
}

/** drop, move_up: called with an index. */
export function chosen_list(
  choices: readonly Choice[],
  drop: (index: number) => void,
  move_up: (index: number) => void,
): HTMLElement {
  const small = (sign: string, label: string, action: () => void) =>
    button(sign, action, { class: "button small", "aria-label": label });
  const entry = ({ text }: Choice, index: number) =>
    h(
      "li",
      {},
      h("span", {}, text),
      small("×", words.remove(text), () => drop(index)),
      index > 0 ? small("↑", words.earlier(text), () => move_up(index)) : null,
    );
  return h("ol", { class: "chosen" }, ...choices.map(entry));
}
