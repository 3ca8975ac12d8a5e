// In a narrow window the panel is a sheet at the bottom: a tap or a swipe opens and closes it.

const SWIPE = 24; // CSS pixels

/**
 * Bind the sheet.
 *
 * @param {HTMLElement} panel
 * @param {HTMLElement} handle  the button at its top
 */
export function bindSheet(panel, handle) {
  let from = 0;
  let swiped = false;
  const open = (/** @type {boolean} */ wanted) => {
    panel.toggleAttribute("data-open", wanted);
    handle.setAttribute("aria-expanded", String(wanted));
  };
  handle.addEventListener("pointerdown", (event) => {
    handle.setPointerCapture(event.pointerId);
    from = event.clientY;
    swiped = false;
  });
  handle.addEventListener("pointerup", (event) => {
    swiped = Math.abs(event.clientY - from) > SWIPE;
    if (swiped) open(event.clientY < from);
  });
  handle.addEventListener("click", () => {
    if (!swiped) open(!panel.hasAttribute("data-open"));
    swiped = false;
  });
  panel.addEventListener("keydown", (event) => {
    if (event.key === "Escape") open(false);
  });
}
