// The chosen goals in their order, each with the time that the robot stays there.
import { Goal } from "../protocol";
import { texts } from "../texts";
import { button, h } from "../ui/dom";

const words = texts.send;
const of_missions = texts.missions;
const longestWaitS = 86400;

/** A chosen goal with its name, at this position of the map. */
export interface Choice {
  goal: Goal;
  text: string;
  x_m: number;
  y_m: number;
}

/** The same choices with one of them moved by `steps`; unchanged if that is not possible. */
export function moved<Entry>(choices: readonly Entry[], index: number, steps: number): Entry[] {
  const to = index + steps;
  const out = [...choices];
  if (to < 0 || to >= out.length) return out;
  out.splice(to, 0, ...out.splice(index, 1));
  return out;
}

/** drop: called with an index; move: with an index and -1 (up) or 1; on_wait: a time has changed. */
export function chosen_list(
  choices: readonly Choice[],
  drop: (index: number) => void,
  move: (index: number, steps: number) => void,
  on_wait: () => void,
): HTMLElement {
  const small = (sign: string, label: string, action: () => void, disabled = false) =>
    button(sign, action, { class: "button small", "aria-label": label, disabled });
  const wait = (choice: Choice) => {
    const input = h("input", {
      type: "number",
      class: "field",
      min: 0,
      max: longestWaitS,
      step: 1,
      value: choice.goal.wait_s ?? "",
      "aria-label": of_missions.wait_at(choice.text),
      oninput: () => {
        const seconds = input.valueAsNumber;
        const known = seconds > 0 && seconds <= longestWaitS;
        choice.goal.wait_s = known ? seconds : undefined;
        on_wait();
      },
    });
    return h("label", { class: "wait" }, of_missions.wait, input);
  };
  const entry = (choice: Choice, index: number) =>
    h(
      "li",
      {},
      h("span", {}, choice.text),
      h(
        "div",
        { class: "chosen-tools" },
        wait(choice),
        small("↑", of_missions.earlier(choice.text), () => move(index, -1), index === 0),
        small("↓", of_missions.later(choice.text), () => move(index, 1), index === choices.length - 1),
        small("×", words.remove(choice.text), () => drop(index)),
      ),
    );
  return h("ol", { class: "chosen" }, ...choices.map(entry));
}
