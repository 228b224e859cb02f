// Replays the drive behind the map: a slider, speeds, pause.
import { App } from "../app";
import * as format from "../format";
import { reason } from "../reasons";
import { Film } from "../map/film";
import { DrivePart, DriveStop } from "../protocol";
import { texts } from "../texts";
import { button, h, set_attribute, set_text, show } from "../ui/dom";
import { section } from "../ui/section";

const words = texts.time;
const playSpeeds = [1, 4, 16, 64];
const sliceStops = 100; // processed without a pause for the page
const sliderSteps = 1000;

export class FilmPlayer {
  readonly element: HTMLElement;
  private readonly start: HTMLButtonElement;
  private readonly status = h("p", { class: "quiet", role: "status" });
  private readonly controls: HTMLElement;
  private readonly play: HTMLButtonElement;
  private readonly slider: HTMLInputElement;
  private readonly speed: HTMLSelectElement;
  private readonly moment = h("p", { class: "film-moment" });
  private readonly note = h("p", { class: "map-note" }, words.film_note); // above the film
  private film: Film | null = null;
  private time_s = 0;
  private frame = 0;
  private last_ms = 0;
  private loads = 0; // counts loads, so that an earlier one stops when another begins

  constructor(private readonly app: App) {
    this.start = button(words.load, () => void this.load(), { class: "button primary" });
    this.play = button(words.play, () => this.set_playing(this.frame === 0), { id: "film-play" });
    this.slider = h("input", {
      type: "range",
      min: 0,
      max: sliderSteps,
      step: 1,
      value: 0,
      id: "film-slider",
      "aria-label": words.slider,
    });
    this.slider.addEventListener("input", () => {
      this.time_s = (Number(this.slider.value) / sliderSteps) * (this.film?.duration_s ?? 0);
      this.show_moment();
    });
    this.speed = h(
      "select",
      { class: "field", id: "film-speed", "aria-label": words.speed },
      ...playSpeeds.map((speed) =>
        h("option", { value: speed, selected: speed === playSpeeds[1] }, words.times(speed)),
      ),
    );
    this.controls = h(
      "div",
      { class: "film-controls", hidden: true },
      this.slider,
      this.moment,
      h("div", { class: "buttons" }, this.play, this.speed, button(words.close, () => this.close())),
    );
    const hint = h("p", { class: "quiet" }, words.film_hint);
    this.element = section(words.film, hint, this.start, this.status, this.controls);
  }

  /** Shows the current map again. */
  close(): void {
    ++this.loads;
    this.set_playing(false);
    this.film = null;
    this.app.map.scene.overlay = null;
    this.app.map.scene.refresh();
    this.note.remove();
    show(this.start, true);
    show(this.controls, false);
    set_text(this.status, "");
  }

  private async load(): Promise<void> {
    const load = ++this.loads;
    show(this.start, false);
    const begin_ms = performance.now();
    try {
      const { stops, laser_m } = await this.fetch(load);
      if (load !== this.loads) return;
      if (stops.length === 0) {
        set_text(this.status, words.no_drive);
        show(this.start, true);
        return;
      }
      const film = new Film(stops, laser_m);
      for (let first = 0; first < stops.length; first += sliceStops) {
        film.see(first, first + sliceStops);
        set_text(this.status, words.loading(Math.min(first + sliceStops, stops.length), stops.length));
        await new Promise((resolve) => window.setTimeout(resolve));
        if (load !== this.loads) return;
      }
      performance.measure("film-loaded", { start: begin_ms });
      this.open(film);
    } catch (error) {
      if (load !== this.loads) return;
      set_text(this.status, reason(error instanceof Error ? error.message : String(error)));
      show(this.start, true);
    }
  }

  private async fetch(load: number): Promise<{ stops: DriveStop[]; laser_m: [number, number] }> {
    const stops: DriveStop[] = [];
    for (;;) {
      const part = await this.app.api.get<DrivePart>(`/api/drive?first=${stops.length}`, 60000);
      stops.push(...part.stops);
      set_text(this.status, words.fetching(stops.length, part.total));
      if (part.stops.length === 0 || stops.length >= part.total || load !== this.loads) {
        return { stops, laser_m: part.laser_m ?? [0, 0] };
      }
    }
  }

  private open(film: Film): void {
    this.film = film;
    this.time_s = film.duration_s;
    set_text(this.status, words.drive(film.stops.length, film.duration_s));
    show(this.controls, true);
    this.app.map.scene.overlay = {
      alone: true,
      draw_still: () => undefined,
      draw_moving: (context, view) => {
        const begin_ms = performance.now();
        film.draw(context, view, this.time_s, this.app.theme.palette);
        performance.measure("film-drawn", { start: begin_ms });
      },
    };
    this.app.map.show_box(film.box());
    this.app.map.stage.append(this.note);
    this.show_moment();
  }

  private set_playing(playing: boolean): void {
    if (!playing) {
      cancelAnimationFrame(this.frame);
      this.frame = 0;
    } else if (this.film) {
      if (this.time_s >= this.film.duration_s) this.time_s = 0;
      this.last_ms = performance.now();
      this.frame = requestAnimationFrame((now) => this.step(now));
    }
    set_text(this.play, playing ? words.pause : words.play);
  }

  private step(now_ms: number): void {
    if (!this.film) return;
    const passed_s = Math.max(0, now_ms - this.last_ms) / 1000;
    this.last_ms = now_ms;
    this.time_s = Math.min(
      this.film.duration_s,
      this.time_s + passed_s * Number(this.speed.value),
    );
    this.show_moment();
    if (this.time_s >= this.film.duration_s) this.set_playing(false);
    else this.frame = requestAnimationFrame((next) => this.step(next));
  }

  private show_moment(): void {
    if (!this.film) return;
    const stop = this.film.stop_at(this.time_s);
    const { duration_s } = this.film;
    const value = duration_s > 0 ? Math.round((this.time_s / duration_s) * sliderSteps) : 0;
    if (Number(this.slider.value) !== value) this.slider.value = String(value);
    const stamp = format.moment(this.film.stops[stop].stamp_s);
    const text = words.moment(stop + 1, this.film.stops.length, stamp);
    set_text(this.moment, text);
    set_attribute(this.slider, "aria-valuetext", text);
    this.app.map.scene.refresh();
  }
}
