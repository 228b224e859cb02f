// All texts of the page, in Spanish. modules_test.mjs compares its keys with those of the English texts.
import { area, count, degrees, duration, length, Maybe, percent, point, speed } from "./format";
import { spanish_draw_texts } from "./spanish_draw";
import { spanish_alarm_texts, spanish_mission_texts, spanish_report_texts } from "./spanish_shift";
import type { Texts } from "./texts";

const plural = (n: Maybe, one: string, several: string) => `${count(n)} ${n === 1 ? one : several}`;
const to = (goal: string) => (goal ? ` a ${goal}` : "");

export const spanish: Texts = {
  title: "topogeo", language: "es", no_robot: "robot",
  states: {
    TRACKING: "Posición conocida", AMBIGUOUS: "Posición dudosa", SEARCHING: "Buscando", LOST: "Posición perdida", misplaced: "Posición errónea",
    none: "Sin posición", absent: "Sin robot", silent: "Sin posición", offline: "Sin conexión",
  },
  reasons: {
    TRACKING: "El láser coincide con el mapa.",
    AMBIGUOUS: "No sabe bien dónde está: el láser coincide con varios lugares, o con ninguno.",
    SEARCHING: "Busca su lugar en el mapa. Muévalo un poco, o fije su posición.",
    LOST: "El láser contradice este lugar. Fije la posición, o busque en todo el mapa.",
    misplaced: "El láser no encaja aquí. Fije la posición, o busque en todo el mapa.",
    none: "El robot aún no ha comunicado su posición.", absent: "Ningún robot conectado. Solo el mapa.",
    silent: "Sin posición desde hace más de diez segundos. El mapa muestra la última.",
    offline: "No llega nada del robot. La página muestra su último estado.",
  },
  activity: {
    idle: "En reposo", arrived: "Ha llegado", emergency: "Parada de emergencia",
    held: (by) => (by ? `Retenido por ${by}` : "Retenido"),
    by_hand: (by) => (by ? `Conducido a mano por ${by}` : "Conducido a mano"),
    driving: (goal, meters, seconds) =>
      `En camino${to(goal)}` + (typeof meters === "number" ? ` (${length(meters)}, ${duration(seconds)})` : ""),
    at_goal: (goal) => `En ${goal || "el destino"}, comprueba su posición`, exploring: "Explorando",
    paused: (goal) => (goal ? `En pausa camino de ${goal}` : "En pausa"),
    planning: (goal) => `Planea la ruta${to(goal)}`, finding: "Busca su posición",
    blocked: (goal) => `Espera paso libre${to(goal)}`, stopped: "Espera", no_navigator: "No está listo para moverse",
    base: {
      offline: "Tracción no conectada", starting: "La tracción arranca",
      watchdog_expired: "Tracción parada: no llegaron órdenes", bumped: "Ha chocado con algo",
      joystick: "Movido con su mando", motors_off: "Motores apagados",
    },
    waiting: {
      no_route: "Espera: no hay ruta al destino", pose_lost: "Espera: posición perdida", no_map: "Espera un mapa",
      outside_map: "Espera: fuera del mapa", obstacle: "Espera: hay algo en el camino", no_scan: "Espera al láser",
      sonar_silent: "Espera a los sonares", no_odometry: "Espera a la tracción",
      base_not_ready: "Espera a la tracción", base_stuck: "Atascado: la tracción no se mueve",
    },
  },
  views: {
    now: "Ahora", send: "Enviar", correct: "Corregir", understand: "Entender", draw: "Dibujar", time: "Archivo",
  },
  map_label: "Mapa de la planta. Las flechas lo mueven, más y menos cambian el zoom.", views_label: "Vistas",
  stop: "Parar", stop_title: "Para el robot al instante y lo retiene (espacio)", view_only: "Solo ver",
  view_only_title: "Abra el enlace del operador, que tiene un código, para mandar al robot.",
  held: "Retenido. Libérelo para moverlo.",
  held_with_goal: (goal) => `Retenido. Al liberarlo, el robot va${to(goal)} al instante.`,
  hand_stopped: "Retenido, sin confirmación de la tracción. Libérelo para moverlo.",
  hand_stopped_with_goal: (goal) =>
    `Retenido, sin confirmación de la tracción. Al liberarlo, el robot va${to(goal)} al instante.`,
  interrupted_held: (text, goal) => `${text} Iba camino de ${goal}; tras liberarlo puede continuar.`,
  interrupted: (goal) => `Parado camino de ${goal}.`,
  resume_to: (goal) => `Continuar: a ${goal}`,
  forget: "Olvidarlo",
  and_more: (goal, more) => (more > 0 ? `${goal} y ${more} más` : goal),
  stop_sent: "Parada enviada, sin confirmación de la tracción. El robot quizá aún se mueve.",
  stop_moves: "Parando: el robot aún se mueve.",
  stop_failed: (why) => `La parada no fue aceptada: ${why} El robot quizá aún se mueve.`,
  release_asks: (goal) => `Al liberarlo, el robot va${to(goal)} al instante.`,
  release_and_drive: "Liberar y seguir", release_and_cancel: "Anular el destino y liberar",
  keep_held: "Seguir reteniéndolo",
  aged: (text, age_s) => `${text} (hace ${duration(age_s)})`,
  emergency: "La parada de emergencia está pulsada. Suéltela en el robot y libérelo aquí.", release: "Liberar",
  low_battery: "La batería está baja.", reconnecting: "Conexión perdida. Nuevo intento …",
  wrong_token: "Este enlace es erróneo o ha caducado. Solo puede mirar.",
  controls_of_robot: {
    other: (name) => `${name} tiene el mando. Usted puede mirar y parar el robot.`,
    waiting: (name) => `Ha pedido el mando a ${name} …`, asks: (name) => `${name} pide el mando.`,
    ask: "Pedirlo", take: "Tomarlo", give: "Darlo", keep: "Conservarlo", got: "Ahora tiene usted el mando.",
    lost: (name) => `${name} tiene ahora el mando.`, kept: (name) => `${name} conserva el mando.`,
    title: "Operadores", holder: "Mando", nobody: "libre: lo toma la próxima orden", mine: "suyo",
    your_name: "Su nombre, para otros operadores", no_name: "un operador", let_go: "Dejar el mando",
    language: "Idioma", language_names: { en: "English", es: "Español" },
  },
  controls: {
    zoom_in: "Acercar", zoom_out: "Alejar", fit: "Mostrar todo el mapa (F)", follow: "Seguir al robot (R)",
    layers: "Capas del mapa", turn: "Girar el mapa 90°", measure: "Medir una distancia", measuring: "Arrastre, o toque dos puntos.",
    measured: (meters) => length(meters), theme: "Oscuro o claro",
  },
  layers: {
    rooms: "Salas en colores", names: "Nombres", drawing: "Elementos dibujados", graph: "Nodos y ramas",
    trail: "Recorrido de puntos de medida", loops: "Bucles aceptados", scan: "Medida del láser",
    local_map: "Diagrama de Voronoi del último punto de medida",
  },
  empty_map: {
    title: "Aún no hay mapa", text: "La planta aparece aquí en cuanto el robot ha cartografiado sus primeros metros.",
    services: (names) => `Servicios en marcha: ${names}.`,
    no_services: "Ningún robot conectado. «topogeo run» arranca uno.",
  },
  now: {
    robot: "Robot", mode: "Modo",
    modes: { mapping: "Haciendo el mapa", localization: "Sin hacer mapa: el mapa no cambia" },
    position: "Posición", heading: "Rumbo", precision: "Exactitud (1 sigma)", speed: "Velocidad",
    sigma: (a, b, theta) => `${length(a)} × ${length(b)}, ${degrees(theta)}`,
    unknown: "desconocido", health: "De un vistazo", confidence: "Confianza en la posición", workers: "Buscadores",
    workers_value: (busy, slots, workers) =>
      `${plural(workers, "buscador", "buscadores")}, ` + (busy > 0 ? `${busy} de ${slots} búsquedas a la vez` : "en reposo"),
    no_workers: "ninguno conectado", map: "Mapa", no_map: "aún ninguno",
    map_value: (nodes, branches, floor) =>
      `${area(floor)}, ${plural(nodes, "nodo", "nodos")}, ${plural(branches, "rama", "ramas")}`,
    loop: "Último bucle aceptado",
    loop_value: (ago) =>
      ago === 0 ? "en este punto de medida" : `hace ${plural(ago, "punto de medida", "puntos de medida")}`,
    no_loop: "aún ninguno", battery: "Batería",
    battery_value: (volts, low, percent) =>
      (typeof percent === "number" ? `${Math.round(percent)} %, ` : "") +
      `${typeof volts === "number" ? `${volts.toFixed(1)} V` : "–"}${low ? ", baja" : ""}`,
    devices: "Láser y tracción", laser: "Láser", base: "Tracción",
    base_states: {
      ready: "lista", moving: "en movimiento", offline: "no conectada", starting: "arranca",
      emergency_stop: "parada de emergencia", halted: "retenida", watchdog_expired: "parada: no llegaron órdenes",
      bumped: "ha chocado", joystick: "movida con su mando", motors_off: "motores apagados",
    },
    laser_states: {
      running: "en marcha", offline: "no conectado", starting: "arranca", fault: "no envía medidas útiles",
    },
    not_heard: "no conectado", simulated: "Posición verdadera del robot simulado",
    simulated_hint:
      "Coordenadas del archivo del mundo. La posición y el rumbo de arriba son los del mapa, que empieza donde " +
      "arrancó el robot, así que los números difieren aunque la posición sea correcta.",
    in_world: "En su mundo", collisions: (n) => plural(n, "choque", "choques"), legend: "Leyenda y teclas",
    viewers: (viewers, operators) =>
      `${plural(viewers, "página abierta", "páginas abiertas")}` +
      (operators === undefined ? "." : `, ${operators} con permiso para mandar.`),
  },
  keys: [["Espacio", "Parar"], ["F", "Mostrar todo el mapa"], ["R", "Seguir al robot"], ["1 – 6", "Las vistas"]],
  legend: {
    real: "Cruce", door: "Puerta", narrowing: "Estrechamiento", hall_corridor: "Sala con pasillo",
    fictitious: "Nodo ficticio: fin de la vista",
  },
  alarms: spanish_alarm_texts,
  missions: spanish_mission_texts,
  report: spanish_report_texts,
  send: {
    heading: "¿Adónde?", hint: "Toque el mapa, o elija un nombre.", search: "Buscar una sala o un lugar",
    no_names: "El mapa aún no tiene salas ni lugares. Toque un punto del mapa.", no_match: "Ningún nombre coincide.",
    place: "lugar", point: (x, y) => `Punto ${point(x, y)}`,
    point_in: (room, x, y) => `Punto en ${room} (${point(x, y)})`, planning: "Planeando …",
    route: (meters, seconds, clearance) =>
      `${length(meters)}, unos ${duration(seconds)}` +
      (typeof clearance === "number" ? `, paso más estrecho ${length(2 * clearance)}` : ""),
    no_route: "No hay ruta.", no_route_to: (name, reason) => `No hay ruta a ${name}: ${reason}.`,
    nearest: "Ir al punto más cercano al que se llega", go: "Ir",
    misplaced: "El láser no encaja en esta posición: el robot está probablemente en otro lugar y conduciría mal.",
    drive_misplaced: "Conducir de todos modos", go_all: (n) => `Ir a los ${n} en este orden`,
    heading_at_goal: "Rumbo en el destino (°), vacío: cualquiera", append: "Añadir a la lista", clear: "Borrar",
    remove: (name) => `Quitar ${name}`, list: "Destinos seguidos",
    list_length: (meters, seconds) => `En total ${length(meters)}, unos ${duration(seconds)}`,
    explore: "Explorar", explore_title: "Va a todos los lugares que aún no están en el mapa",
    return: "Volver a casa", underway: "En curso", idle: "El robot no tiene destino.",
    foreign: "El robot tiene un destino que no se envió desde aquí.",
    not_heard: "No llega nada del robot, así que su estado se desconoce.",
    to_explore: "lugares que aún no están en el mapa", to_foreign: "un destino que no se envió desde aquí",
    exploring: "El robot explora por sí mismo.", explored: "Exploración terminada: todo lo alcanzable está en el mapa.",
    explored_facts: (visited, given_up, floor) =>
      plural(visited, "lugar visitado", "lugares visitados") +
      (given_up > 0 ? `, ${given_up} de ellos no alcanzados` : "") + `, ${area(floor)} en el mapa`,
    to: (goal) => `A ${goal}`, rest: (meters, seconds) => `Faltan ${length(meters)}, unos ${duration(seconds)}`,
    rest_exploring: (meters, seconds) => `${length(meters)} hasta el próximo punto, unos ${duration(seconds)}`,
    next_point: "Elige el próximo punto …", waiting: (names) => `Después: ${names}`,
    progress: "Parte recorrida de la ruta", pause: "Pausa", resume: "Continuar", cancel: "Anular",
    spectator: "Usted mira. Con el enlace del operador puede enviar al robot desde aquí.",
    no_navigator: "No se puede enviar al robot: su navegador no está en marcha.", drive: "Conducir a mano",
    drive_hint:
      "Mantenga pulsado un botón, W A S D, una flecha o la palanca de una pantalla táctil. El robot para cuando la " +
      "suelta, deja la página o se corta la conexión. La barra espaciadora lo para y lo retiene.",
    drive_on: "Tomar los controles", drive_off: "Soltar los controles", drive_speed: "Velocidad",
    forward: "Adelante", backward: "Atrás", turn_left: "Girar a la izquierda", turn_right: "Girar a la derecha",
    drive_idle: "Nadie conduce.", drive_stands: "Parado.",
    drive_state: (now, ahead, behind) =>
      speed(now) + (typeof ahead === "number" ? `, ${length(ahead)} libres delante` : "") +
      (typeof behind === "number" ? `, ${length(behind)} libres detrás` : ""),
  },
  navigator: {
    idle: "Sin destino", driving: "En camino", relocalizing: "Busca su posición", blocked: "Bloqueado",
    arrived: "Ha llegado", stopped: "Parado",
  },
  halts: {
    no_route: "No hay ruta al destino.", cancelled: "El destino fue anulado.", pose_lost: "La posición se ha perdido.",
    no_map: "No hay mapa.", outside_map: "El robot no está en el mapa.",
    obstacle: "Un obstáculo que no está en el mapa cierra el paso.", no_scan: "El láser no envía nada.",
    sonar_silent: "Los sonares no oyen nada aunque hay un obstáculo cerca.",
    base_not_ready: "La tracción no acepta órdenes.", base_stuck: "La tracción no se mueve.",
  },
  whole_halts: {
    waits_for_route: "Planea la ruta.", paused: "En pausa. «Continuar» lo deja seguir.",
    no_odometry: "Parado. La tracción no comunica su movimiento.",
  },
  unsure: "Posición dudosa. El robot busca su posición antes de moverse.",
  correct: {
    pose: "Fijar la posición", pose_hint: "Fije posición y rumbo del robot en el mapa si no son los mostrados.",
    pose_start: "Fijar en el mapa",
    pose_drag: "Pulse donde está el robot y arrastre hacia donde mira. Pulse otra vez para cambiarlo.",
    x: "x (m)", y: "y (m)", theta: "Rumbo (°)", sure: "Exactitud", sure_exact: "exactamente ahí (0,2 m)",
    sure_about: "más o menos ahí (0,5 m)", sure_roughly: "por ahí cerca (2 m)", apply: "Aplicar", cancel: "Cancelar",
    while_mapping:
      "Mientras el robot hace el mapa, su posición no se puede fijar ni buscar. Pulse antes «Dejar de hacer mapa».",
    search: "Buscar en todo el mapa",
    search_hint:
      "Descarta la posición y compara las medidas del robot con todos los lugares. Mueva el robot unos metros " +
      "entretanto: «Conducir a mano» está en la vista Enviar.",
    search_start: "Buscar", mode: "Mapa",
    mode_hint: "Mientras el robot hace el mapa, los nuevos puntos de medida lo cambian. Si no, queda como está.",
    mode_now: { mapping: "El robot hace el mapa ahora.", localization: "El mapa queda ahora como está." },
    to_mapping: "Empezar a hacer mapa", to_localization: "Dejar de hacer mapa", merges: "Unión de mapas",
    no_merges: "No se propone unir dos mapas.", merge: (robot, other) => `${robot} parece estar donde estuvo ${other}.`,
    merge_facts: (m) =>
      `Confianza ${percent(m.confidence)}; coinciden ${m.matches} de ${m.stops} puntos de medida en ` +
      `${length(m.distance_m)}; ${percent(m.contradicted)} de la vista común contradice.`,
    accept: "Hacer un solo mapa", refuse: "Dejarlos separados",
    merge_states: {
      open: "abierta", accepted: "aceptada: los mapas son uno", refused: "rechazada",
      withdrawn: "retirada: uno de los mapas ya no existe",
    },
    spectator: "Usted mira. Para corregir hace falta el enlace del operador.",
  },
  understand: {
    why: "Por qué este estado", loops: "Bucles",
    loops_hint: "Lugares a los que el robot quizá ha vuelto. Elija uno para ver ambos puntos de medida.",
    loops_kept: (accepted) => `${count(accepted)} aceptados. De los rechazados no se guarda nada.`,
    loops_count: (accepted, rejected) => `${count(accepted)} aceptados, ${count(rejected)} rechazados`,
    no_loops: "El robot aún no ha vuelto a un lugar anterior, así que no hay bucles.",
    filters: { all: "Todos", accepted: "Aceptados", rejected: "Rechazados" }, filter_label: "Qué bucles",
    loop: (later, earlier) => `Punto de medida ${later} en el punto ${earlier}`,
    outcomes: {
      accepted: "Aceptado", gate: "Coincidencia no aceptada", unconfirmed: "Sin confirmar",
      no_closing: "No encaja en el bucle", outvoted: "Descartado después",
    },
    sources: {
      prediction: "Comparados porque las posiciones predicen este bucle.",
      place: "Comparados porque los últimos metros se parecen a ese lugar.",
      window: "Comparados porque los últimos metros, en conjunto, se parecen a ese lugar.",
    },
    accepted: "Aceptado.", not_kept: "No se guardan pruebas de él con el mapa.",
    meanings: {
      "nothing in common": "Los dos puntos de medida apenas ven la misma parte de la planta.",
      "little overlap": "Los dos puntos de medida ven muy poco de la misma planta.",
      "few inliers": "Muy pocos puntos de la medida posterior caen en paredes de la anterior.",
      doubtful: "Ninguna medida falla por sí sola, pero juntas dejan demasiada duda.",
      "far from the prediction": "La coincidencia está más lejos de la posición prevista de lo que cabe esperar.",
      "second solution": "Otra solución encaja casi igual de bien.",
      unconfirmed: "El bucle movería mucho al robot, y ningún otro bucle lo confirma aún.",
      "no consistent closing": "Ninguna posición a lo largo del bucle encaja con lo visto.",
      outvoted: "El bucle se aceptó al principio, pero el resto del mapa lo contradijo.",
    },
    loop_facts: (fitness, probability, moved, turned, accepted) =>
      `Ajuste ${percent(fitness)}, probabilidad estimada ${percent(probability)}; ` +
      `${accepted ? "mueve" : "movería"} el punto de medida ${length(moved)}, ${degrees(turned)}.`,
    loading_maps: "Cargando ambos mapas locales …", key_earlier: "punto de medida anterior",
    key_later: "punto posterior, donde coincide", key_predicted: "punto posterior, según la predicción",
    fitness: "Ajuste", probability: "Probabilidad estimada de que sea correcto",
    probable_but_rejected:
      "La coincidencia es probablemente correcta. La razón de arriba rechaza el bucle igualmente, porque un bucle " +
      "erróneo deforma el mapa.",
    share: (value) => (typeof value === "number" ? percent(value) : "no guardado"),
    overlap: "Parte de la vista posterior en la anterior", near: "Parte común a menos de 10 cm de las paredes anteriores",
    moved: "Diferencia entre coincidencia y predicción", none: "nada",
    moved_value: (meters, turn) => (typeof meters === "number" ? `${length(meters)}, ${degrees(turn)}` : "no guardado"),
    corrected: "Desplazamiento del punto por el bucle", search: "Búsqueda",
    search_hint:
      "Muestra la búsqueda actual: el rectángulo en que se busca, la elipse donde se espera al robot (2 sigma) y " +
      "los resultados.",
    no_search: "Aún no hubo búsquedas.",
    search_map: (places, running) =>
      running && places === 0
        ? "Se busca en todo el mapa …"
        : `Búsqueda en todo el mapa: ${plural(places, "lugar encaja", "lugares encajan")} mejor.`,
    search_matches: (tasks, accepted, running) =>
      running ? `${plural(tasks, "comparación", "comparaciones")} en curso …`
        : `${plural(tasks, "comparación", "comparaciones")}, ${accepted} aceptadas.`,
    search_best: (fitness, old) =>
      `Mejor ajuste ${fitness.toFixed(2)}.` + (old ? " La próxima búsqueda empieza cuando el robot avance un poco." : ""),
    more: (n) => `No se muestran ${count(n)} anteriores.`, workers: "Buscadores",
    no_workers: "Ningún buscador conectado: el localizador busca por sí mismo.", load: "Carga",
    worker_facts: (slots, done, rate, failures) =>
      `${plural(slots, "hueco", "huecos")}, ${count(done)} tareas hechas, ${rate}, ${count(failures)} fallidas`,
    draining: "acaba sus tareas y termina", services: "Servicios", no_services: "Ningún servicio conectado.",
    service_states: {
      starting: "arranca", waiting: "espera", running: "en marcha", finished: "terminado", failed: "fallido",
      stopped: "parado", lost: "perdido: no comunica nada",
    },
    waits_for: (what) => `Espera ${what}.`, technical: "Detalles técnicos", input: (topic, rate) => `${topic} ${rate}`,
    faults: (n) => plural(n, "fallo", "fallos"), last_error: (text) => `Último: ${text}`, events: "Sucesos",
    no_events: "Aún no ha pasado nada.", no_such_events: "No hay sucesos de estos.",
    event_filters: { all: "Todos", trouble: "Avisos y errores", errors: "Errores" },
    event_filter_label: "Qué sucesos", save_events: "Guardar en un archivo", levels: { info: "Información", warning: "Aviso", error: "Error" },
  },
  draw: spanish_draw_texts,
  time: {
    film: "Reproducir el recorrido",
    film_hint: "Repite el recorrido que hizo el mapa: el robot, sus medidas y la planta conocida hasta entonces.",
    film_note: "Repetición del recorrido, no el robot de ahora", load: "Cargar el recorrido",
    fetching: (stops, total) => `Recibidos ${count(stops)} de ${count(total)} puntos de medida …`,
    loading: (stops, total) => `Colocados ${count(stops)} de ${count(total)} puntos de medida …`,
    no_drive: "El mapa no tiene puntos de medida, así que no hay recorrido.",
    drive: (stops, seconds) => `${count(stops)} puntos de medida, ${duration(seconds)} sin las pausas.`,
    slider: "Momento del recorrido", play: "Reproducir", pause: "Pausa", speed: "Velocidad",
    times: (times) => `${times} ×`, close: "Volver a ahora",
    moment: (stop, total, when) => `Punto de medida ${count(stop)} de ${count(total)}, ${when}`,
    snapshots: "Copias", no_snapshots: "Aún no hay copias.", name: "Nombre",
    name_rule: "Letras, cifras, '.', '-' y '_'; sin espacios, sin '.' al principio.", make: "Hacer una copia",
    made: "La copia está hecha.",
    snapshot_facts: (when, stops, bytes) => `${when}, ${count(stops)} puntos de medida, ${(bytes / 1e6).toFixed(1)} MB`,
    restore: "Restaurar", rename: "Cambiar el nombre", new_name: (name) => `Nombre nuevo de ${name}`,
    delete: "Borrar", delete_sure: (name) => `Borrar ${name} para siempre`, changed: "Las copias han cambiado.",
    restore_warning:
      "La copia sustituye el mapa actual, que se guarda como otra copia. Lo medido desde entonces queda fuera. Un robot " +
      "en camino sigue en el mapa restaurado, así que anule antes su destino.",
    restore_sure: "Restaurarla", restored: "El mapa está restaurado.", merge: "Unir con otro mapa",
    merge_hint:
      "Elija un archivo de mapa (map.pb) del mismo lugar, de este robot o de otro. La página muestra los cambios antes " +
      "de que los acepte.",
    merge_file: "Archivo de mapa", merge_too_large: (name) => `${name} pesa más de 64 MB, que es el límite aquí.`,
    merging: (name) => `Alineando ${name} con el mapa …`, not_merged: (name) => `${name} no se unió.`,
    merged: (name) => `${name} se une al mapa`,
    merged_facts: (made) =>
      `${count(made.joined)} puntos de medida del mapa menor se unen al mayor` +
      (made.left_out > 0 ? `, ${count(made.left_out)} no y quedan fuera` : "") +
      `. Confianza ${(100 * made.confidence).toFixed(0)} %: ${count(made.agreeing)} de ` +
      `${count(made.searched)} lugares coinciden, a menos de ${(100 * made.sigma_m).toFixed(0)} cm.`,
    merge_warning:
      "El mapa unido sustituye el actual si lo acepta; el actual se guarda como copia. Un robot en camino busca su " +
      "posición en el mapa unido.",
    merge_accept: "Que sea el mapa", merge_refuse: "Descartarlo", merge_accepted: "Los mapas están unidos.",
    merge_refused: "El mapa queda como está.", comparison: "Comparar",
    compare_hint: "Muestra en colores las diferencias entre dos versiones del mapa.", before: "Antes", after: "Después",
    now: "mapa actual", compare: "Comparar", comparing: "Comparando …", hide: "Ocultar", stops: "Puntos de medida",
    stops_value: (before, after) => `${count(before)} antes, ${count(after)} después`,
    changes: { gone: "Desaparecido", new: "Nuevo", seen: "Visto desde entonces", lost: "Ya no conocido" },
    export: "Exportar", export_hint: "Guarda el mapa actual como archivo para otros programas.", download: "Descargar",
    picture_shows: "Las imágenes muestran", picture_odometry: "odometría", picture_loops: "bucles",
    download_file: (file) => `Descargar ${file}`,
    formats: {
      pgm: "rejilla, para map_server de ROS", masks: "zonas como máscaras, para filtros de Nav2",
      geojson: "grafo, lugares y zonas, para el servidor de rutas de Nav2",
      lif: "grafo y lugares, Layout Interchange Format", zones: "zonas, VDA 5050", rmf: "grafo, para Open-RMF",
      graphml: "grafo sin pérdidas, para programas de grafos", g2o: "grafo de posiciones de los puntos de medida",
      svg: "imagen", png: "imagen", tum: "posición corregida de cada medida",
      carmen: "medidas de los puntos de medida como registro", pb: "el mapa entero",
    },
  },
  panel: {
    title: "Panel", prompt: "Número de un destino", names: "Destinos",
    unknown: (number) => `Ningún destino tiene el número ${number}.`, go: "Ir", erase: "Borrar", pause: "Pausa",
    resume: "Continuar", cancel: "Anular", return: "Casa", keypad: "Teclado", line: "Estado",
    no_names: "El mapa aún no tiene salas ni lugares.",
  },
  errors: {
    status: (status) => `El servicio rechazó la petición (HTTP ${status}).`,
    unreachable: "No se puede alcanzar el servicio.", slow: "El servicio no respondió a tiempo.",
    number: (name) => `${name}: introduzca un número.`,
  },
  done: {
    stop: "El robot está retenido.", goal_held: "El robot está retenido. Va allí en cuanto se libere.",
    release: "El robot puede moverse de nuevo.", cancel: "El destino está anulado.", resume: "El robot sigue.",
    forget: "El destino interrumpido está olvidado.", goal: (name) => `En camino a ${name}.`,
    goals: (n) => `En camino a ${n} destinos.`, appended: (name) => `${name} está añadido.`,
    explore: "El robot explora.", return: "El robot vuelve a casa.", pose: "La posición está fijada.",
    search: "Se busca en todo el mapa.", mode: "El modo cambia.", merge_accept: "Los mapas están unidos.",
    merge_refuse: "Los mapas quedan separados.",
  },
  waiting: {
    sent: "La orden está enviada. La página espera la respuesta …",
    slow: "El servicio aún no ha respondido. La página sigue esperando …",
  },
  close: "Cerrar",
};
