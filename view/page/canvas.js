// The canvas: draws pictures, and turns gestures and keys into messages of the protocol.
// It imports nothing, so that a notebook's widget can load this one file.

/** @typedef {{kind: number, frame: number, width: number, height: number, encoding: number,
 *   refined: boolean}} Header  One picture: kind 1, or 2 for the second of a split; encoding 0 is
 *   raw RGBA, 1 is PNG. */
/** @typedef {(message: object) => void} Send */

const LARGEST = 4096; // sides of a picture in device pixels
const SMALLEST = 16;
const DENSEST = 2; // device pixels for a CSS pixel; more cannot be seen, and take longer
const SLACK = 3; // CSS pixels that a click may move before it is a drag
const DOUBLE = { time: 350, distance: 24 }; // ms and CSS pixels between two taps
const SETTLE = 180; // ms without wheel or key after which the motion has ended
const STEP = 24; // CSS pixels for which an arrow key stands

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
 * @param {Send} send  takes one message of the protocol
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
    show(/** @type {Header} */ header, payload) {
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

/** The pictures on a canvas: the last one, and the second of a split. */
class Picture {
  constructor(/** @type {HTMLCanvasElement} */ canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.last = 0; // the newest frame
    /** @type {{frame: number, image: any}[]} */
    this.shown = [{ frame: 0, image: null }, { frame: 0, image: null }];
    /** @type {number | null} */
    this.seam = null; // share of the width at which the second picture begins
  }

  /** Draw a picture, unless a newer one was drawn; resolves to whether it was. */
  async show(/** @type {Header} */ header, payload) {
    const first = header.kind === 1;
    if (first ? header.frame <= this.last : header.frame !== this.last) return false;
    this.last = header.frame;
    const image = header.encoding === 0 ? rawImage(header, payload) : await pngImage(payload);
    if (header.frame !== this.last) return false; // a newer one came while this one was decoded
    this.shown[header.kind - 1] = { frame: header.frame, image };
    this.paint();
    return true;
  }

  paint() {
    const { width, height } = this.canvas;
    const [first, second] = this.shown;
    if (!first.image) return;
    this.#stretch(first.image);
    if (this.seam === null || second.frame !== first.frame || !second.image) return;
    const from = Math.round(this.seam * width);
    this.context.save();
    this.context.beginPath();
    this.context.rect(from, 0, width - from, height);
    this.context.clip();
    this.#stretch(second.image);
    this.context.restore();
  }

  /** Give the canvas a size in device pixels; returns whether it is another one. */
  resize(/** @type {number} */ width, /** @type {number} */ height) {
    if (this.canvas.width === width && this.canvas.height === height) return false;
    this.canvas.width = width;
    this.canvas.height = height;
    this.paint();
    return true;
  }

  #stretch(image) {
    const { width, height } = this.canvas;
    this.context.imageSmoothingEnabled = image.width !== width || image.height !== height;
    this.context.drawImage(image, 0, 0, width, height);
  }
}

/** Pointers, wheel and arrow keys; what they do within one frame of the display is sent at once. */
class Gestures {
  constructor(/** @type {HTMLCanvasElement} */ canvas, /** @type {Send} */ send) {
    this.canvas = canvas;
    this.send = send;
    /** @type {Map<number, {x: number, y: number}>} */
    this.pointers = new Map();
    this.mode = "turn";
    this.travel = 0; // CSS pixels since the first pointer came down
    this.moving = false;
    this.tap = { time: -Infinity, x: 0, y: 0 };
    this.settling = 0;
    this.frame = 0;
    this.pending = nothing();
    this.leave = new AbortController();
    const on = (type, handler, more = {}) =>
      canvas.addEventListener(type, handler, { signal: this.leave.signal, ...more });
    on("pointerdown", (event) => this.#down(event));
    on("pointermove", (event) => this.#move(event));
    on("pointerup", (event) => this.#up(event, true));
    on("pointercancel", (event) => this.#up(event, false));
    on("wheel", (event) => this.#wheel(event), { passive: false });
    on("contextmenu", (event) => event.preventDefault());
  }

  detach() {
    this.leave.abort();
    clearTimeout(this.settling);
    cancelAnimationFrame(this.frame);
  }

  /** Do what an arrow key, + or - stands for; returns whether the key is one of them. */
  key(/** @type {KeyboardEvent} */ event) {
    if (event.target !== this.canvas && event.target !== document.body) return false;
    const step = STEP * this.#scale();
    const arrows = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    const arrow = arrows[event.key];
    const zoom = { "+": 0.8, "=": 0.8, "-": 1.25 }[event.key];
    if (arrow) this.#add(event.shiftKey ? "pan" : "turn", ...arrow);
    else if (zoom) this.#zoom(zoom, this.canvas.width / 2, this.canvas.height / 2);
    else return false;
    this.#settle();
    return true;
  }

  #down(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    if (!this.pointers.size) {
      this.mode = event.shiftKey || event.button > 0 ? "pan" : "turn";
      this.travel = 0;
      this.canvas.style.cursor = this.mode === "pan" ? "move" : "grabbing";
    } else {
      this.mode = "none"; // two fingers are no click, nor is the one that stays
      this.travel = Infinity;
    }
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  #move(event) {
    const old = this.pointers.get(event.pointerId);
    if (!old) return;
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId);
    const now = { x: event.clientX, y: event.clientY };
    const scale = this.#scale();
    const [dx, dy] = [now.x - old.x, now.y - old.y];
    this.travel += Math.hypot(dx, dy);
    if (this.travel <= SLACK) return; // the way so far counts once the drag begins
    this.pointers.set(event.pointerId, now);
    if (others.length === 0 && this.mode !== "none") {
      this.#add(this.mode, dx * scale, dy * scale);
    } else if (others.length === 1) {
      const fixed = others[0][1];
      this.#add("pan", (dx / 2) * scale, (dy / 2) * scale);
      const ratio = Math.hypot(old.x - fixed.x, old.y - fixed.y) / Math.hypot(now.x - fixed.x, now.y - fixed.y);
      this.#zoom(ratio, ...this.#place((now.x + fixed.x) / 2, (now.y + fixed.y) / 2));
    }
    this.#beginMotion();
  }

  #up(event, finished) {
    if (!this.pointers.delete(event.pointerId) || this.pointers.size) return;
    this.canvas.style.cursor = "grab";
    this.#flush();
    if (this.moving) this.#endMotion();
    if (!finished || this.travel > SLACK || event.button !== 0) return;
    const { time, x, y } = this.tap;
    const near = Math.hypot(event.clientX - x, event.clientY - y) < DOUBLE.distance;
    if (near && event.timeStamp - time < DOUBLE.time) {
      const [column, line] = this.#place(event.clientX, event.clientY);
      this.send({ type: "look", x: column, y: line });
      this.tap.time = -Infinity;
    } else {
      this.tap = { time: event.timeStamp, x: event.clientX, y: event.clientY };
    }
  }

  #wheel(event) {
    event.preventDefault();
    const pixels = event.deltaY * [1, 20, 400][event.deltaMode];
    const rate = event.ctrlKey ? 0.01 : 0.0015; // a pinch on a touch pad is a wheel with ctrl
    this.#zoom(Math.exp(pixels * rate), ...this.#place(event.clientX, event.clientY));
    this.#settle();
  }

  #add(what, dx, dy) {
    this.pending[what][0] += dx;
    this.pending[what][1] += dy;
    this.frame ||= requestAnimationFrame(() => this.#flush());
  }

  #zoom(factor, x, y) {
    if (!(factor > 0 && factor < Infinity)) return;
    this.pending.zoom = [this.pending.zoom[0] * factor, x, y];
    this.frame ||= requestAnimationFrame(() => this.#flush());
  }

  #flush() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const { turn, pan, zoom } = this.pending;
    this.pending = nothing();
    if (turn[0] || turn[1]) this.send({ type: "turn", dx: turn[0], dy: turn[1] });
    if (pan[0] || pan[1]) this.send({ type: "pan", dx: pan[0], dy: pan[1] });
    const factor = Math.min(Math.max(zoom[0], 0.1), 10);
    if (factor !== 1) this.send({ type: "zoom", factor, x: zoom[1], y: zoom[2] });
  }

  /** The motion of a wheel or a key ends when nothing came for a while. */
  #settle() {
    this.#beginMotion();
    this.settling = setTimeout(() => this.pointers.size || this.#endMotion(), SETTLE);
  }

  #beginMotion() {
    clearTimeout(this.settling);
    if (!this.moving) this.send({ type: "moving", value: true });
    this.moving = true;
  }

  #endMotion() {
    this.#flush();
    this.moving = false;
    this.send({ type: "moving", value: false });
  }

  /** Device pixels for a CSS pixel. */
  #scale() {
    return this.canvas.width / this.canvas.getBoundingClientRect().width;
  }

  /** Column and line of the picture below a place in the window. */
  #place(x, y) {
    const box = this.canvas.getBoundingClientRect();
    return [((x - box.left) / box.width) * this.canvas.width, ((y - box.top) / box.height) * this.canvas.height];
  }
}

const nothing = () => ({ turn: [0, 0], pan: [0, 0], zoom: [1, 0, 0] });

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

/** A canvas that holds raw RGBA. */
function rawImage(/** @type {Header} */ { width, height }, payload) {
  const image = document.createElement("canvas");
  image.width = width;
  image.height = height;
  const bytes = payload instanceof ArrayBuffer
    ? new Uint8ClampedArray(payload)
    : new Uint8ClampedArray(payload.buffer, payload.byteOffset, payload.byteLength);
  image.getContext("2d", { alpha: false }).putImageData(new ImageData(bytes, width, height), 0, 0);
  return image;
}

/** An image that a PNG holds, with its very levels. */
function pngImage(payload) {
  return createImageBitmap(new Blob([payload], { type: "image/png" }), {
    colorSpaceConversion: "none", premultiplyAlpha: "none",
  });
}
