// The pictures on a canvas: the newest one, and the second one of a split.

/** @typedef {{kind: number, frame: number, width: number, height: number, encoding: number,
 *   refined: boolean}} Header  One picture: kind 1, or 2 for the second of a split; encoding 0 is
 *   raw RGBA, 1 is PNG. */

/** The pictures on a canvas: the last one, and the second of a split. */
export class Picture {
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
