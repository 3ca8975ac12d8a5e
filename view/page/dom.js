// What all parts of the page need of the browser.

/** The element of an id, of whatever kind. */
export const byId = (/** @type {string} */ id) => /** @type {any} */ (document.getElementById(id));
