/**
 * Returns a function that runs `work` once in the next frame, however often it is called before.
 */
export function once_a_frame(work: () => void): () => void {
  let waiting = false;
  return () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      work();
    });
  };
}

/** The same, but at most once every period_ms. */
export function at_most_every(period_ms: number, work: () => void): () => void {
  let waiting = false;
  let last_ms = -Infinity;
  return () => {
    if (waiting) return;
    waiting = true;
    const wait_ms = Math.max(0, last_ms + period_ms - performance.now());
    window.setTimeout(() => {
      waiting = false;
      last_ms = performance.now();
      work();
    }, wait_ms);
  };
}
