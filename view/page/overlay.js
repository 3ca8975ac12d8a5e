// What lies over the picture: loading, nothing in view, errors, and a lost connection.

import { byId } from "./dom.js";

const TOAST = 8000; // ms for which an error stays
let leaving = 0;

/**
 * Show how far loading is.
 *
 * @param {string} text
 * @param {number | null} share  0..1; null: unknown
 */
export function showProgress(text, share) {
  const bar = byId("progress");
  card("loading", text);
  bar.hidden = false;
  if (share === null) bar.removeAttribute("value");
  else bar.value = share;
  byId("centre-share").hidden = share === null;
  byId("centre-share").textContent = share === null ? "" : `${Math.round(100 * share)} %`;
}

/** Say that nothing is in view, and how to come back. */
export function showEmpty() {
  card("empty", "Nothing is in view.");
  byId("centre-reset").hidden = false;
}

/** Show an error that leaves no picture to look at. */
export function showFailure(/** @type {string} */ text) {
  card("error", text);
}

/** Take the card in the middle away if it is in a state. */
export function hideCard(/** @type {string} */ state) {
  const centre = byId("centre");
  if (centre.dataset.state === state) {
    centre.hidden = true;
    centre.dataset.state = "";
  }
}

/** Show an error beside the picture for a while. */
export function showError(/** @type {string} */ text) {
  byId("toast-text").textContent = text;
  byId("toast").hidden = false;
  clearTimeout(leaving);
  leaving = setTimeout(hideError, TOAST);
}

function hideError() {
  byId("toast").hidden = true;
}

/** Show the state of the connection; empty: it stands. */
export function showLink(/** @type {string} */ text) {
  byId("link").textContent = text;
  byId("link").hidden = !text;
}

/** Bind the overlay's own buttons. */
export function bindOverlay(/** @type {(message: object) => void} */ send) {
  byId("toast-close").addEventListener("click", hideError);
  byId("centre-reset").addEventListener("click", () => send({ type: "reset" }));
}

function card(/** @type {string} */ state, /** @type {string} */ text) {
  const centre = byId("centre");
  centre.hidden = false;
  centre.dataset.state = state;
  byId("centre-text").textContent = text;
  for (const id of ["progress", "centre-share", "centre-reset"]) byId(id).hidden = true;
}
