// How often a list of goals is driven, and the time that the robot stays at its goals.
import { Maybe } from "../format";
import { texts } from "../texts";
import { field, h } from "../ui/dom";
import { Choice } from "./chosen_list";

const words = texts.missions;
const offered = [1, 2, 3, 5, 10, 0]; // times, 0: until it is cancelled

/** The time of one round with its stays, where the robot drives for time_s. It does not stay at the last goal of all. */
export function with_stays(choices: readonly Choice[], rounds: number, time_s: Maybe): Maybe {
  if (typeof time_s !== "number") return time_s;
  const stays = rounds === 1 ? choices.slice(0, -1) : choices;
  return stays.reduce((sum, choice) => sum + (choice.goal.wait_s ?? 0), time_s);
}

/** on_change: gets the chosen number of rounds. */
export function rounds_field(rounds: number, on_change: (rounds: number) => void): HTMLElement {
  const known = offered.includes(rounds) ? offered : [...offered, rounds];
  const option = (value: number) => h("option", { value, selected: value === rounds }, words.rounds(value));
  const select = h("select", { class: "field", id: "repeat" }, ...known.map(option));
  select.addEventListener("change", () => on_change(Number(select.value)));
  return field(words.repeat, select);
}
