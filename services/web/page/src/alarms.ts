// Alarms of the robot: which ones wait for an acknowledgment, and the order to acknowledge them.
import { Api } from "./api";
import { Channels } from "./channels";
import { sentence } from "./format";
import { Alarm } from "./protocol";
import { translated } from "./reasons";
import { texts } from "./texts";
import { Notices } from "./ui/notices";

/** All alarms with their numbers, the newest first. */
export function newest_alarms(channels: Channels): [string, Alarm][] {
  const alarms = [...channels.table("alarms")];
  return alarms.sort((a, b) => b[1].time_s - a[1].time_s || Number(b[0]) - Number(a[0]));
}

/** The alarms that nobody has acknowledged. */
export function pending_alarms(channels: Channels): [string, Alarm][] {
  return newest_alarms(channels).filter(([, alarm]) => alarm.acknowledged_by === "");
}

/** "Drive unit: emergency stop." */
export function alarm_text({ source, text }: Alarm): string {
  // States of devices are names of the protocol.
  const words = translated(text).replace(/^[a-z]+_[a-z]+(?=:|$)/, (name) => name.replace("_", " "));
  return sentence(`${texts.alarms.sources[source] ?? source}: ${words}`);
}

/** numbers: keys of the table. */
export async function acknowledge(api: Api, notices: Notices, numbers: string[]): Promise<void> {
  const order = api.post("alarms", { acknowledge: numbers.map(Number) });
  await notices.report(order, texts.alarms.done);
}
