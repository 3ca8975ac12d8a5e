// The canvas: draws pictures, and turns gestures and keys into messages of the protocol.

import { Gestures } from "./gestures.js";
import { Picture } from "./picture.js";

const LARGEST = 4096; // sides of a picture in device pixels
const SMALLEST = 16;
const DENSEST = 2; // device pixels for a CSS pixel; more cannot be seen, and take longer

/** Azimuth and elevation in degrees of the keys 1 to 9, with a name for people. */
export const DIRECTIONS = [
  ["Front", 0, 0], ["Back", 180, 0], ["Left", -90, 0],
  ["Right", 90, 0], ["Top", 0, 90], ["Bottom", 0, -90],
  ["Corner", 45, 35.264], ["Left corner", -45, 35.264], ["Back corner", 135, 35.264],
];

/**
 * Fill an element with a canvas that shows pictures and sends what the hand does.
 *
 * @param {HTMLElement} element  has a size of its own; the canvas fills it
 * @param {(message: object) => void} send  takes one message of the protocol
 * @param {{keys?: EventTarget, help?: () => void, label?: string}} [options]  `keys`: where keys
 *   are listened for (the canvas itself, unless given); `help`: called by the key ?
 * @returns the canvas; `show(header, payload)` draws a picture and acknowledges it, and says
 *   whether it was drawn; `settings(values)` tells it a settings message; `restart()` begins a new
 *   session; `split(share)` places the seam (null: none); `detach()` removes everything
 */
export function attachCanvas(element, send, options = {}) {
  const canvas = document.createElement("canvas");
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  canvas.setAttribute("aria-label", options.label ?? "Point cloud. Arrow keys turn it, + and - zoom.");
  canvas.style.cssText = "display:block;width:100%;height:100%;touch-action:none;user-select:none;cursor:grab";
  element.append(canvas);

  const picture = new Picture(canvas);
  const gestures = new Gestures(canvas, send);
  const state = { show: "picture" };
  const announce = () => send({ type: "resize", width: canvas.width, height: canvas.height });
  const resized = new ResizeObserver((entries) => {
    if (picture.resize(...deviceSize(entries[entries.length - 1]))) announce();
  });
  resized.observe(canvas);

  const keys = options.keys ?? canvas;
  const pressed = (/** @type {KeyboardEvent} */ event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
    if (event.key === "?" && options.help) options.help();
    else if (!gestures.key(event)) {
      const message = keyMessage(event.key, state.show);
      if (!message) return;
      state.show = message.name === "show" ? message.value : state.show;
      send(message);
    }
    event.preventDefault();
    event.stopPropagation();
  };
  keys.addEventListener("keydown", pressed);

  return {
    canvas,
    announce,
    show(/** @type {import("./picture.js").Header} */ header, payload) {
      const acknowledge = () => header.kind === 1 && send({ type: "shown", frame: header.frame });
      return picture.show(header, payload).finally(acknowledge);
    },
    settings(values) { state.show = values.show ?? state.show; },
    restart() { picture.last = 0; },
    split(/** @type {number | null} */ share) { picture.seam = share; picture.paint(); },
    detach() {
      resized.disconnect();
      gestures.detach();
      keys.removeEventListener("keydown", pressed);
      canvas.remove();
    },
  };
}

/** The message of a key, or null. */
function keyMessage(/** @type {string} */ key, /** @type {string} */ shown) {
  if (key >= "1" && key <= "9") {
    const [, azimuth, elevation] = DIRECTIONS[Number(key) - 1];
    return { type: "orbit", azimuth, elevation };
  }
  if (key === "r") return { type: "reset" };
  if (key === "d") return { type: "set", name: "show", value: shown === "depth" ? "picture" : "depth" };
  return key === "s" ? { type: "save", what: "png" } : null;
}

/** Whether keys belong to a field that is being edited. */
function isTyping(target) {
  return target instanceof HTMLElement && target.closest("input:not([type=range], [type=radio], [type=checkbox]), select, textarea") !== null;
}

/** Width and height in device pixels, within the protocol's bounds. */
function deviceSize(/** @type {ResizeObserverEntry} */ entry) {
  const density = Math.min(window.devicePixelRatio || 1, DENSEST);
  const { width, height } = entry.contentRect;
  return [width, height].map((side) => Math.min(Math.max(Math.round(side * density), SMALLEST), LARGEST));
}
