// Pointers, wheel and arrow keys on a canvas become messages of the protocol.

/** @typedef {(message: object) => void} Send */

const SLACK = 3; // CSS pixels that a click may move before it is a drag
const DOUBLE = { time: 350, distance: 24 }; // ms and CSS pixels between two taps
const SETTLE = 180; // ms without wheel or key after which the motion has ended
const STEP = 24; // CSS pixels for which an arrow key stands

/** Pointers, wheel and arrow keys; what they do within one frame of the display is sent at once. */
export class Gestures {
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
