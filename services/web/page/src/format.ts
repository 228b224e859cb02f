// Formats numbers with their units, and messages of services, for people.

const noValue = "–";

export type Maybe = number | null | undefined;

function known(value: Maybe): value is number {
  return typeof value === "number" && Number.isFinite(value);
}

/** "3.4 m", "120 m", "1.25 km"; a dash for an unknown value. */
export function length(meters: Maybe): string {
  if (!known(meters)) return noValue;
  if (meters >= 1000) return `${(meters / 1000).toFixed(2)} km`;
  if (meters >= 100) return `${meters.toFixed(0)} m`;
  return meters >= 10 ? `${meters.toFixed(1)} m` : `${meters.toFixed(2)} m`;
}

/** "12 s", "3 min 5 s", "2 h 10 min". */
export function duration(seconds: Maybe): string {
  if (!known(seconds)) return noValue;
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole} s`;
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
  return `${Math.floor(whole / 3600)} h ${Math.floor((whole % 3600) / 60)} min`;
}

export function speed(meters_per_second: Maybe): string {
  return known(meters_per_second) ? `${meters_per_second.toFixed(2)} m/s` : noValue;
}

export function degrees(radians: Maybe): string {
  return known(radians) ? `${fixed((radians * 180) / Math.PI, 1)}°` : noValue;
}

export function area(square_meters: Maybe): string {
  if (!known(square_meters)) return noValue;
  return `${square_meters >= 100 ? count(square_meters) : square_meters.toFixed(1)} m²`;
}

export function percent(share: Maybe): string {
  return known(share) ? `${Math.round(100 * share)} %` : noValue;
}

/** 12345 as "12,345". */
export function count(number: Maybe): string {
  return known(number) ? Math.round(number).toLocaleString("en") : noValue;
}

/** "1 node", "2 nodes". */
export function counted(number: Maybe, one: string, several: string): string {
  return `${count(number)} ${number === 1 ? one : several}`;
}

export function rate(per_second: Maybe): string {
  if (!known(per_second)) return noValue;
  return `${per_second >= 100 ? per_second.toFixed(0) : per_second.toFixed(1)} /s`;
}

export function memory(bytes: Maybe): string {
  return known(bytes) ? `${(bytes / 1e6).toFixed(0)} MB` : noValue;
}

/** Time of day of seconds since 1970, after the day unless that is the day of now_s. */
export function clock(time_s: number, now_s: number = Date.now() / 1000): string {
  const date = new Date(1000 * time_s);
  const is_today = date.toDateString() === new Date(1000 * now_s).toDateString();
  return is_today ? date.toLocaleTimeString("en-GB") : moment(time_s);
}

/** Day and time for seconds since 1970; seconds for a source that counts from elsewhere. */
export function moment(time_s: number): string {
  if (time_s < 1e8) return `${time_s.toFixed(1)} s`;
  const date = new Date(1000 * time_s);
  return `${date.toLocaleDateString("en-GB")} ${date.toLocaleTimeString("en-GB")}`;
}

/** "3.20, -1.05 m". */
export function point(x_m: number, y_m: number): string {
  return `${fixed(x_m, 2)}, ${fixed(y_m, 2)} m`;
}

// Like toFixed, but without a minus before a zero.
function fixed(value: number, digits: number): string {
  return value.toFixed(digits).replace(/^-(?=[0.]+$)/, "");
}

/** A message of a service, with a capital letter and a full stop. */
export function sentence(text: string): string {
  if (text === "") return "";
  const capital = text[0].toUpperCase() + text.slice(1);
  return /[.!?…]$/.test(capital) ? capital : `${capital}.`;
}
