// Makes the report of the drive behind the map, as a file.
import { newest_alarms } from "../alarms";
import { App } from "../app";
import { DrivePart, DriveStop, Info } from "../protocol";
import { report_page } from "../report";
import { texts } from "../texts";
import { button, h, set_text } from "../ui/dom";
import { section } from "../ui/section";

const words = texts.report;
const patienceMs = 120000; // for large maps

export class ReportPart {
  readonly element: HTMLElement;
  private readonly make = button(words.make, () => void this.save());
  private readonly status = h("p", { class: "quiet", role: "status" });

  constructor(private readonly app: App) {
    this.element = section(words.title, h("p", { class: "quiet" }, words.hint), this.make, this.status);
  }

  private async save(): Promise<void> {
    this.make.disabled = true;
    set_text(this.status, words.making);
    try {
      const page = new Blob([await this.page()], { type: "text/html" });
      const link = h("a", { href: URL.createObjectURL(page), download: "report.html" });
      link.click();
      window.setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    } catch (error) {
      this.app.notices.fail(error);
    } finally {
      this.make.disabled = false;
      set_text(this.status, "");
    }
  }

  private async page(): Promise<string> {
    const { api, channels } = this.app;
    const [info, stops, picture] = await Promise.all([
      api.get<Info>("/api/info"),
      this.stops(),
      api.download("/api/export/png/map.png", patienceMs).then(address_of),
    ]);
    const rooms = [...channels.table("rooms").values()];
    const events = [...channels.table("events")].sort((a, b) => Number(a[0]) - Number(b[0]));
    return report_page({
      robot: info.robot_id || texts.no_robot,
      made_s: Date.now() / 1000,
      stops,
      floor_m2: rooms.reduce((sum, { area_m2 }) => sum + area_m2, 0),
      rooms: rooms.filter(({ name }) => name).length,
      loops: [...channels.table("loops").values()],
      events: events.map(([, event]) => event),
      alarms: newest_alarms(channels).map(([, alarm]) => alarm),
      picture,
    });
  }

  private async stops(): Promise<DriveStop[]> {
    const stops: DriveStop[] = [];
    for (;;) {
      const part = await this.app.api.get<DrivePart>(`/api/drive?first=${stops.length}`, patienceMs);
      stops.push(...part.stops);
      if (part.stops.length === 0 || stops.length >= part.total) return stops;
    }
  }
}

/** A picture as an address that holds it. */
function address_of(picture: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result));
    reader.onerror = () => reject(reader.error ?? new Error("the picture cannot be read"));
    reader.readAsDataURL(new Blob([picture], { type: "image/png" })); // exports have no type of their own
  });
}
