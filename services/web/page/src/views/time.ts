// Time: replay of the drive, versions of the map, files for other programs.
import { App, ViewPart } from "../app";
import { ExportFormats } from "../protocol";
import { texts } from "../texts";
import { button, h } from "../ui/dom";
import { KeyedList } from "../ui/list";
import { section } from "../ui/section";
import { FilmPlayer } from "./film_player";
import { MapMerge } from "./map_merge";
import { ReportPart } from "./report_part";
import { Versions } from "./versions";

const words = texts.time;
const patienceMs = 120000; // for large maps

const pictures = ["svg", "png"];

interface ExportFile {
  format: string;
  file: string;
}

export class TimeView implements ViewPart {
  readonly element: HTMLElement;
  private readonly film: FilmPlayer;
  private readonly versions: Versions;
  private readonly merge: MapMerge;
  private readonly files: KeyedList<ExportFile>;
  private readonly picture_parts = {
    odometry: h("input", { type: "checkbox" }),
    loops: h("input", { type: "checkbox" }),
  };

  constructor(private readonly app: App) {
    this.film = new FilmPlayer(app);
    this.versions = new Versions(app, (available) => this.merge.update(available));
    this.merge = new MapMerge(app, () => this.versions.update_soon());
    this.files = new KeyedList<ExportFile>(
      "rows exports",
      (key) => this.entry(key),
      () => undefined,
    );
    const hint = h("p", { class: "quiet" }, words.export_hint);
    this.element = h(
      "div",
      { class: "view" },
      this.film.element,
      this.versions.element,
      this.merge.element,
      new ReportPart(app).element,
      section(words.export, hint, this.picture_choice(), this.files.element),
    );
  }

  shown(visible: boolean): void {
    if (visible) {
      void this.versions.update();
      void this.list_files();
    } else {
      this.film.close();
      this.versions.close();
      this.merge.close();
    }
  }

  private picture_choice(): HTMLElement {
    const { odometry, loops } = this.picture_parts;
    return h(
      "div",
      { class: "picture-choice", role: "group", "aria-label": words.picture_shows },
      h("span", {}, words.picture_shows),
      h("label", {}, odometry, words.picture_odometry),
      h("label", {}, loops, words.picture_loops),
    );
  }

  /** The address of a file, for pictures with what they show. */
  private address(key: string): string {
    const path = `/api/export/${key}`;
    if (!pictures.includes(key.split("/")[0])) return path;
    const shown = Object.entries(this.picture_parts).filter(([, box]) => box.checked);
    return shown.length === 0 ? path : `${path}?${shown.map(([part]) => `${part}=1`).join("&")}`;
  }

  private async list_files(): Promise<void> {
    const answer = await this.app.api.get<ExportFormats>("/api/export").catch(() => null);
    if (!answer) return;
    this.files.show(
      answer.formats.flatMap(({ format, files }) =>
        files.map((file) => [`${format}/${file}`, { format, file }] as const),
      ),
    );
  }

  private entry(key: string): HTMLElement {
    const [format, file] = key.split("/");
    const download = button(words.download, () => void this.download(key, file, download), {
      "aria-label": words.download_file(file),
      class: "button small",
    });
    const what = words.formats[format] ?? format;
    return h("li", { class: "export" }, h("span", {}, h("strong", {}, file), ` ${what}`), download);
  }

  private async download(key: string, file: string, element: HTMLButtonElement): Promise<void> {
    element.disabled = true;
    try {
      const blob = await this.app.api.download(this.address(key), patienceMs);
      const link = h("a", { href: URL.createObjectURL(blob), download: file });
      link.click();
      window.setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    } catch (error) {
      this.app.notices.show(error instanceof Error ? error.message : String(error), "error");
    } finally {
      element.disabled = false;
    }
  }
}
