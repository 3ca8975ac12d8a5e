// The split view: a seam between two pictures, moved by hand or by keys.

const STEP = 0.02; // share of the width for an arrow key

/**
 * Bind the seam.
 *
 * @param {HTMLElement} seam  the slider; it lies over the picture
 * @param {HTMLElement} stage  what it slides along
 * @param {(share: number | null) => void} place  told where the seam is; null: there is none
 * @returns {{show: (names: string[] | null) => void}}  `show` takes the names of the left and the
 *   right picture; null: one picture
 */
export function bindSeam(seam, stage, place) {
  let share = 0.5;
  let shown = false;
  const move = (/** @type {number} */ to) => {
    share = Math.min(Math.max(to, 0), 1);
    seam.style.left = `${100 * share}%`;
    seam.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    place(shown ? share : null);
  };
  seam.addEventListener("pointerdown", (event) => {
    seam.setPointerCapture(event.pointerId);
    seam.focus();
    event.preventDefault();
  });
  seam.addEventListener("pointermove", (event) => {
    if (!seam.hasPointerCapture(event.pointerId)) return;
    const box = stage.getBoundingClientRect();
    move((event.clientX - box.left) / box.width);
  });
  seam.addEventListener("keydown", (event) => {
    const to = { ArrowLeft: share - STEP, ArrowRight: share + STEP, Home: 0, End: 1 }[event.key];
    if (to === undefined) return;
    move(to);
    event.preventDefault();
    event.stopPropagation();
  });
  return {
    show(names) {
      shown = names !== null;
      seam.hidden = !shown;
      [...seam.querySelectorAll(".seam-side")].forEach((side, index) => {
        side.textContent = names?.[index] ?? "";
      });
      move(share);
    },
  };
}
