// Texts of the view Draw in Spanish, part of spanish.ts.
import { area, length, point } from "./format";
import type { Texts } from "./texts";

export const spanish_draw_texts: Texts["draw"] = {
  spectator: "Usted mira. Para dibujar hace falta el enlace del operador.",
  not_offered: "Este servicio no guarda dibujos.",
  hint: "Lo dibujado se guarda aparte de los datos medidos. La planificación y la protección obedecen el dibujo guardado.",
  floor_hint: "Una planta nueva, aparte del mapa del robot. Queda en esta página hasta que la cargue o la exporte.",
  undo: "Deshacer", redo: "Rehacer", save: "Guardar", discard: "Descartar", clean: "Todo está guardado.",
  dirty: "Aún sin guardar.", saved: "El dibujo está guardado.",
  kept: "La vista Dibujar tiene un dibujo que aún no está guardado.",
  conflict: "Otra persona ha guardado el dibujo entretanto.", take_theirs: "Usar su versión",
  save_over: "Sustituirla por la mía", theirs_taken: "La página muestra el otro dibujo. Deshacer devuelve el suyo.",
  tools: "Herramientas", groups: { names: "Nombres", walls: "Paredes", zones: "Zonas", rooms: "Salas" },
  tool: {
    select: "Elegir", place: "Lugar", base: "Casa", wall: "Pared", opening: "Abertura", door: "Puerta",
    no_go: "Prohibida", slow: "Lenta", one_way: "Dirección única", preferred: "Carril", split: "Dividir", join: "Unir",
    rename: "Renombrar", measure: "Medir", shift: "Mover",
  },
  how: {
    select: "Toque un elemento y arrastre él o sus esquinas. Los puntos pequeños crean esquinas. Arrastre al lado para mover el mapa.",
    place: "Toque su posición.", base: "Pulse donde está el robot y arrastre hacia donde mira.",
    wall: "Toque cada esquina; la última otra vez para acabar, la primera para cerrar. O arrastre una sola pared.",
    opening: "Arrastre por el tramo de pared que está abierto.", door: "Arrastre por el paso, de jamba a jamba.",
    no_go: "Arrastre un rectángulo, o toque cada esquina y luego otra vez la primera.",
    slow: "Arrastre un rectángulo, o toque cada esquina y luego otra vez la primera.",
    one_way: "Arrastre un rectángulo, o toque cada esquina y luego otra vez la primera. Después gire su flecha.",
    preferred: "Arrastre un rectángulo a lo largo del carril, o toque cada esquina y luego otra vez la primera.",
    split: "Arrastre una línea por la sala, de pared a pared.", join: "Toque una sala y luego la otra.",
    rename: "Toque la sala.", measure: "Toque dos puntos de la imagen cuya distancia conoce.", shift: "Arrastre la imagen.",
  },
  keyboard:
    "En el mapa: las flechas mueven la cruz, Intro fija un punto, otra vez Intro acaba, Retroceso lo quita, Escape deja la herramienta. Dos dedos o la rueda mueven el mapa.",
  finish: "Acabar", cancel: "Cancelar", cursor: (x, y) => point(x, y), snapping: "Rejilla y ajuste", grid: "Rejilla",
  no_grid: "sin", step: (meters) => (meters < 1 ? `${Math.round(100 * meters)} cm` : `${meters} m`),
  to_corners: "A esquinas", to_angles: "A ángulos rectos",
  kinds: {
    place: "lugar", base: "casa", wall: "pared", opening: "abertura", door: "puerta", room: "sala",
    no_go: "prohibida", slow: "lenta", one_way: "dirección única", preferred: "carril",
  },
  titles: {
    place: "Lugar", base: "Casa", wall: "Pared", opening: "Abertura", door: "Puerta", room: "Sala",
    no_go: "Zona prohibida", slow: "Zona lenta", one_way: "Zona de dirección única", preferred: "Carril preferente",
  },
  item: "Elegido", name: "Nombre", name_taken: "Otro elemento tiene este nombre.",
  no_name: "El elemento necesita un nombre.", speed: "Límite de velocidad (m/s)", heading: "Rumbo (°)",
  corners: "Esquinas", corner_x: (n) => `x de la esquina ${n} (m)`, corner_y: (n) => `y de la esquina ${n} (m)`,
  remove_corner: (n) => `Quitar la esquina ${n}`, x: "x (m)", y: "y (m)", remove: "Borrar",
  measures: (line, floor) =>
    floor === null ? `${length(line)} de largo` : `${area(floor)}, ${length(line)} de contorno`,
  drawn: (kind, size) => (size ? `${kind}: ${size}.` : `${kind}: hecho.`),
  items: (n) => `Todos los elementos (${n})`, no_items: "Aún no hay nada dibujado.", numbered: (kind, n) => `${kind} ${n}`,
  rooms: {
    none_here: "Aquí no hay ninguna sala. Toque dentro de una.",
    none_along: "La línea no cruza ninguna sala. Arrástrela a través de una, de pared a pared.",
    save_first: "Esta sala aún no está guardada. Guarde antes el dibujo.",
    not_split:
      "La línea no divide la sala. Arrástrela de pared a pared. Una línea no puede dividir una sala en forma de anillo.",
    same_room: "Ambos puntos están en la misma sala.", not_joined: "Estas salas no se tocan.",
    split: "La sala está dividida.", joined: "Las salas están unidas.", rename: "Escriba el nuevo nombre.",
  },
  floor: {
    title: "Planta nueva", start: "Dibujar una planta nueva", back: "Volver al mapa", name: "Nombre de la planta",
    first_name: "planta nueva", simulator: "Cargar en el simulador", robot: "Cargar en el robot",
    simulator_sure: "El robot simulado pasa a esta planta y su mapa empieza de nuevo.",
    robot_sure: "Esta planta sustituye el dibujo actual del robot.", yes: "Sí, cargarla", no: "No",
    no_start: "Fije antes la casa, porque el robot arranca allí.", no_walls: "Dibuje antes paredes.",
    loaded: "La planta está cargada.", not_offered: "Este servicio no puede cargar plantas.",
    picture: "Imagen de fondo", choose: "Elegir una imagen (PNG, JPEG)",
    no_picture: "El navegador no puede mostrar este archivo como imagen.", known: "Distancia conocida (m)",
    known_hint: "Los dos puntos distan:", apply: "Aplicar", opacity: "Opacidad", remove: "Quitar la imagen",
    files: "Archivo", export: "Exportar", import: "Importar",
    imported: "El archivo está leído. Deshacer devuelve el dibujo anterior.",
    no_json: "Este archivo no es un dibujo exportado por esta página.",
  },
  parse: {
    no_drawing: "Esto no es un dibujo.", no_list: (list) => `«${list}» no es una lista.`,
    too_many: (list, most) => `«${list}» tiene más de ${most} entradas.`,
    wrong_item: (list, index) => `La entrada ${index + 1} de «${list}» no está completa.`,
  },
};
