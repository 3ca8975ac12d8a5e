// Files that the server sends, and the command line of the picture.

import { byId } from "./dom.js";
import { download } from "./download.js";

/**
 * Bind the buttons that save.
 *
 * @param {(message: object) => void} send
 * @returns {{expect: (file: any) => void, file: (payload: Uint8Array) => void,
 *   command: (text: string) => Promise<void>}}  `expect` is told the name of the file whose bytes
 *   follow; `command` shows and copies a command line
 */
export function bindSaves(send) {
  let expected = { name: "picture.png", mime: "image/png" };
  byId("save-png").addEventListener("click", () => send({ type: "save", what: "png" }));
  byId("save-words").addEventListener("click", () => send({ type: "save", what: "words" }));
  byId("copy").addEventListener("click", () => send({ type: "command" }));
  return {
    expect(file) {
      expected = file;
    },
    file(payload) {
      download(expected.name, expected.mime, payload);
    },
    async command(text) {
      const shown = byId("command");
      shown.textContent = text;
      shown.hidden = false;
      const copied = await copy(text, shown);
      byId("copy").textContent = copied ? "Copied" : "Copy it above";
      setTimeout(() => { byId("copy").textContent = "Copy command"; }, 2000);
    },
  };
}

/** Copy a text; where the browser keeps the clipboard from the page, select it instead. */
async function copy(/** @type {string} */ text, /** @type {HTMLElement} */ shown) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    getSelection()?.selectAllChildren(shown);
    return false;
  }
}
