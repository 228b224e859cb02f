// Space stops the robot wherever the focus is, except in text fields. Enter does what Space usually
// does.
const noTexts = ["checkbox", "radio", "range", "button", "submit", "color", "file"];

function types_text(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement) return !noTexts.includes(target.type);
  return target instanceof Element && target.closest("textarea, [contenteditable]") !== null;
}

/** stop: returns false if this page may not stop; Space then keeps its usual function. */
export function listen_for_stop_key(stop: () => boolean): void {
  let taken = false;
  // Registered before all other listeners, some of which consume keys.
  document.addEventListener(
    "keydown",
    (event) => {
      if (event.key !== " " || types_text(event.target)) return press_by_enter(event);
      if (!event.repeat) taken = stop();
      if (!taken) return;
      event.preventDefault();
      event.stopPropagation();
    },
    { capture: true },
  );
  // Browsers press a button when Space is released.
  document.addEventListener(
    "keyup",
    (event) => {
      if (event.key === " " && taken && !types_text(event.target)) event.preventDefault();
    },
    { capture: true },
  );
}

function press_by_enter(event: KeyboardEvent): void {
  const { target } = event;
  const box = target instanceof HTMLInputElement && ["checkbox", "radio"].includes(target.type);
  if (event.key !== "Enter" || event.repeat || !box) return;
  event.preventDefault();
  target.click();
}
