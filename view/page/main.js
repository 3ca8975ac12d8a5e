// The page: what the server says goes to the canvas, the panel and the figures, and back.

import { attachCanvas, DIRECTIONS } from "./canvas.js";
import { byId } from "./dom.js";
import { count } from "./format.js";
import { showNotes, showNumbers } from "./numbers.js";
import { bindOverlay, hideCard, showEmpty, showError, showFailure, showLink, showProgress } from "./overlay.js";
import { bindPanel, sideName } from "./panel.js";
import { bindSaves } from "./saves.js";
import { bindSheet } from "./sheet.js";
import { keepConnected, socketAddress } from "./socket.js";
import { bindSeam } from "./split.js";

const RESTORED = ["preset", "quality", "samples", "lights", "background", "colour", "show", "split"];

/** @type {any} */
let hello = null; // what the server offers; null until it knows the cloud
/** @type {any} */
let settings = null; // what held last
/** @type {any} */
let before = null; // what held when the connection was lost

const send = (/** @type {object} */ message) => link.send(message);
const help = () => byId("help").open || byId("help").showModal();
const canvas = attachCanvas(byId("picture"), send, { keys: document, help });
const panel = bindPanel(send);
const saves = bindSaves(send);
const seam = bindSeam(byId("seam"), byId("stage"), (share) => canvas.split(share));
bindOverlay(send);
bindSheet(byId("panel"), byId("sheet"));
bindTools();

const received = {
  hello(message) {
    const same = hello?.name === message.name && hello?.points === message.points;
    hello = message;
    delete document.body.dataset.waiting;
    document.title = `${message.name} · Splatline`;
    byId("cloud").textContent = message.name;
    byId("facts").textContent = `${count(message.points)} points`;
    panel.offer(message);
    showNotes(message.notes);
    hideCard("error");
    if (before && same) restore(before);
    before = null;
  },
  settings(message) {
    settings = message;
    panel.show(message);
    canvas.settings(message);
    byId("depth").setAttribute("aria-pressed", String(message.show === "depth"));
    seam.show(message.split && [sideName(message.split.left), sideName(message.split.right)]);
  },
  progress({ text, share }) {
    if (share === 1) hideCard("loading");
    else showProgress(text, share);
  },
  numbers(message) {
    showNumbers(message, hello?.presets.find(({ name }) => name === settings?.preset));
    if (message.elements === 0) showEmpty();
    else hideCard("empty");
  },
  error({ text }) {
    hideCard("loading");
    panel.refuse();
    if (hello) showError(text);
    else showFailure(text);
  },
  file: (message) => saves.expect(message),
  command: ({ text }) => saves.command(text),
};

const link = keepConnected(socketAddress(), {
  opened() {
    canvas.restart();
    canvas.announce();
    showLink("");
  },
  closed(attempts) {
    before ??= settings;
    panel.refuse();
    hideCard("loading");
    showLink(attempts < 4 ? "The connection is lost. Trying again …" : "The server does not answer. Still trying …");
  },
  message: (message) => received[message.type]?.(message),
  binary: async (header, payload) => {
    if (header.kind === 3) return saves.file(payload);
    try {
      if (await canvas.show(header, payload)) drawn(header);
    } catch {
      showError(`Frame ${header.frame} could not be drawn.`);
    }
  },
});

/** Note what the canvas shows. */
function drawn(/** @type {import("./picture.js").Header} */ header) {
  hideCard("loading");
  const stage = byId("stage").dataset;
  stage.frame = String(header.frame);
  stage.kind = String(header.kind);
  stage.refined = String(header.refined);
}

/** Bring a new session to the settings and the camera of the old one. */
function restore(/** @type {any} */ old) {
  for (const name of RESTORED) send({ type: "set", name, value: old[name] });
  if (old.camera) {
    const { target, distance, azimuth, elevation } = old.camera;
    send({ type: "camera", target, distance, azimuth, elevation });
  }
}

function bindTools() {
  const direction = byId("direction");
  direction.append(...DIRECTIONS.map(([name], index) => new Option(`${index + 1}  ${name}`, String(index))));
  direction.addEventListener("change", () => {
    const [, azimuth, elevation] = DIRECTIONS[Number(direction.value)];
    send({ type: "orbit", azimuth, elevation });
    direction.value = "";
  });
  byId("reset").addEventListener("click", () => send({ type: "reset" }));
  byId("depth").addEventListener("click", () => {
    send({ type: "set", name: "show", value: settings?.show === "depth" ? "picture" : "depth" });
  });
  byId("help-open").addEventListener("click", help);
}
