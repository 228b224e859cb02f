/**
 * A function that has `work` done once with the next frame, however often it is called until then.
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
