// Texts of alarms, missions and the report of a drive in Spanish, parts of spanish.ts.
import { area, duration, length } from "./format";
import type { Texts } from "./texts";

export const spanish_alarm_texts: Texts["alarms"] = {
  title: "Alarmas", none: "No ha habido alarmas.", acknowledge: "Confirmar",
  acknowledge_all: (n) => `Confirmar las ${n}`, acknowledge_one: (text) => `Confirmar: ${text}`,
  all: (n) => `Las ${n}`, show: (n) => `Ver las ${n} alarmas`,
  repeated: (times, last) => `${times} veces, la última: ${last}`,
  acknowledged: (who, when) => `Confirmada por ${who}: ${when}`, done: "La alarma está confirmada.",
  sources: { base: "tracción", laser: "láser", navigator: "navegador", localizer: "localizador" },
};

export const spanish_mission_texts: Texts["missions"] = {
  title: "Misiones", none: "Aún no hay misiones. Elija destinos y guárdelos aquí para otro día.",
  name: "Nombre de la misión", save: "Guardar estos destinos",
  goals: (n) => `${n} ${n === 1 ? "destino" : "destinos"}`, remove: (name) => `Quitar la misión ${name}`,
  wait: "espera (s)", wait_at: (name) => `Segundos de espera en ${name}`, repeat: "Recorrer esta lista",
  rounds: (n) => (n === 0 ? "hasta que se anule" : n === 1 ? "una vez" : `${n} veces`),
  earlier: (name) => `Subir ${name} un puesto`, later: (name) => `Bajar ${name} un puesto`,
  stays: (goal, seconds) => `Espera en ${goal} (quedan ${duration(seconds)})`, drive_on: "Seguir ya",
  round: (now, of) => (of === 0 ? `Vuelta ${now}, hasta que se anule` : `Vuelta ${now} de ${of}`),
};

export const spanish_report_texts: Texts["report"] = {
  title: "Informe del recorrido",
  hint: "Una página para imprimir o enviar: mapa, distancia, tiempo, destinos, alarmas y sucesos.",
  make: "Guardar el informe", making: "Haciendo el informe …", made_at: (when) => `Hecho el ${when}`,
  from_to: "Desde, hasta", driven: "Recorrido",
  distance: (meters, seconds) => `${length(meters)} en ${duration(seconds)} sin las pausas`,
  points: "Puntos de medida", map: "Mapa",
  map_value: (floor, rooms) => `${area(floor)}, ${rooms} ${rooms === 1 ? "sala" : "salas"}`, loops: "Bucles",
  loops_value: (accepted, rejected) => `${accepted} aceptados, ${rejected} descartados`, held: "Se pulsó Parar",
  times: (n) => (n === 1 ? "una vez" : `${n} veces`), reached: "Destinos alcanzados",
  reached_value: (reached, sent) => `${reached} de ${sent}`, goals: "Destinos", alarms: "Alarmas",
  events: "Avisos y errores", nothing: "Ninguno.", more: (n) => `${n} anteriores no se muestran.`,
  picture: "Mapa de la planta",
};
