// The report of a drive: one page of HTML without other files, to print or to send.
import { alarm_text } from "./alarms";
import { clock, count, moment, sentence } from "./format";
import { Alarm, DriveStop, LogEvent, Loop } from "./protocol";
import { translated } from "./reasons";
import { texts } from "./texts";

const words = texts.report;
const longestPauseS = 5; // as in the film
const mostGoals = 14; // lines that one page holds
const mostAlarms = 6;
const mostEvents = 10;

export interface ReportData {
  robot: string;
  made_s: number; // seconds since 1970
  stops: readonly DriveStop[];
  floor_m2: number;
  rooms: number;
  loops: readonly Loop[];
  events: readonly LogEvent[]; // the oldest first
  alarms: readonly Alarm[]; // the newest first
  picture: string; // address of an image; empty: none
}

export interface DriveFacts {
  length_m: number;
  time_s: number; // without pauses
  first_s: number;
  last_s: number;
}

/** How far and how long a drive went from scan point to scan point; null without any. */
export function drive_facts(stops: readonly DriveStop[]): DriveFacts | null {
  if (stops.length === 0) return null;
  const facts = { length_m: 0, time_s: 0, first_s: stops[0].stamp_s, last_s: stops[0].stamp_s };
  stops.slice(1).forEach((stop, i) => {
    const before = stops[i];
    facts.last_s = stop.stamp_s;
    if (stop.starts_drive) return;
    facts.time_s += Math.min(longestPauseS, Math.max(0, stop.stamp_s - before.stamp_s));
    const [dx, dy] = [(stop.x_m ?? NaN) - (before.x_m ?? NaN), (stop.y_m ?? NaN) - (before.y_m ?? NaN)];
    facts.length_m += Math.hypot(dx, dy) || 0; // 0: one of them is not located
  });
  return facts;
}

/** Goals that were sent and reached, and how often somebody stopped the robot. */
export function goal_facts(events: readonly LogEvent[]): { sent: number; reached: number; stopped: number } {
  const number = (pattern: RegExp) => events.filter(({ text }) => pattern.test(text)).length;
  return {
    sent: number(/^goal: /),
    reached: number(/^arrived: /),
    stopped: number(/: stops and holds the robot$/),
  };
}

function escaped(text: string): string {
  return text.replace(/[&<>"']/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

type Row = [time: string, text: string];

/** A titled table of the newest rows, the oldest first; all: the oldest first. */
function table(title: string, all: readonly Row[], most: number): string {
  const rows = all.slice(-most).map((cells) => `<tr>${cells.map((cell) => `<td>${escaped(cell)}</td>`).join("")}</tr>`);
  const content = rows.length > 0 ? `<table>${rows.join("")}</table>` : `<p>${escaped(words.nothing)}</p>`;
  const more = all.length > most ? `<p>${escaped(words.more(all.length - most))}</p>` : "";
  return `<section><h2>${escaped(title)}</h2>${more}${content}</section>`;
}

const style = `
@page { size: A4; margin: 14mm }
body { font: 10.5pt/1.35 system-ui, sans-serif; color: #18212b; max-width: 190mm; margin: 0 auto; padding: 8px }
h1 { font-size: 17pt; margin: 0 } h2 { font-size: 11.5pt; margin: 8px 0 2px; border-bottom: 1px solid #999 }
p { margin: 2px 0; color: #56626f }
.top { display: grid; grid-template-columns: 3fr 2fr; gap: 16px; align-items: start; margin-top: 8px }
img { width: 100%; max-height: 105mm; object-fit: contain; border: 1px solid #ccc }
dl { display: grid; grid-template-columns: auto 1fr; gap: 2px 12px; margin: 0 } dt { color: #56626f } dd { margin: 0 }
.lists { display: grid; grid-template-columns: 1fr 1fr; gap: 0 16px }
table { border-collapse: collapse; font-size: 9.5pt } td { padding: 1px 8px 1px 0; vertical-align: top }
td:first-child { white-space: nowrap; color: #56626f }
@media (max-width: 600px) { .top, .lists { display: block } }`;

/** A whole HTML document. */
export function report_page(data: ReportData): string {
  const drive = drive_facts(data.stops);
  const goals = goal_facts(data.events);
  const accepted = data.loops.filter((loop) => loop.accepted).length;
  const facts: [string, string][] = [
    [words.points, count(data.stops.length)],
    [words.map, words.map_value(data.floor_m2, data.rooms)],
    [words.loops, words.loops_value(accepted, data.loops.length - accepted)],
    [words.reached, words.reached_value(goals.reached, goals.sent)],
    [words.held, words.times(goals.stopped)],
  ];
  if (drive) {
    facts.unshift(
      [words.from_to, `${moment(drive.first_s)} – ${moment(drive.last_s)}`],
      [words.driven, words.distance(drive.length_m, drive.time_s)],
    );
  }
  const at = (time_s: number) => clock(time_s, data.made_s);
  const row = ({ time_s, text }: LogEvent): Row => [at(time_s), sentence(translated(text))];
  const of_goals = data.events.filter(({ text }) => /^(goal|arrived|waits \d+ s at|explore[sd])\b/.test(text));
  const trouble = data.events.filter(({ level }) => level !== "info");
  const alarms = [...data.alarms].reverse().map((alarm): Row => {
    const { acknowledged_by: who, acknowledged_s: when } = alarm;
    const done = who ? ` ${sentence(texts.alarms.acknowledged(who, at(when ?? 0)))}` : "";
    return [at(alarm.first_s), `${alarm_text(alarm)}${done}`];
  });
  const title = escaped(`${words.title}: ${data.robot}`);
  const picture = data.picture
    ? `<img src="${escaped(data.picture)}" alt="${escaped(words.picture)}">`
    : `<p>${escaped(words.nothing)}</p>`;
  const list = facts.map(([name, value]) => `<dt>${escaped(name)}</dt><dd>${escaped(value)}</dd>`).join("");
  return `<!DOCTYPE html>
<html lang="${texts.language}"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>${title}</title><style>${style}</style></head>
<body><h1>${title}</h1><p>${escaped(words.made_at(moment(data.made_s)))}</p>
<div class="top">${picture}<dl>${list}</dl></div>
<div class="lists">${table(words.goals, of_goals.map(row), mostGoals)}<div>
${table(words.alarms, alarms, mostAlarms)}${table(words.events, trouble.map(row), mostEvents)}</div></div>
</body></html>
`;
}
