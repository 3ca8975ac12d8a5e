// The settings: what the server offers becomes controls; a change is sent, and what holds is shown.

import { byId } from "./dom.js";

const PATIENCE = 3000; // ms for which a control shows what was asked for before it is told
const SIDES = [
  ["paper", "Paper's engine"], ["engine", "Chosen engine"], ["reference", "Exact reference"],
];
const UNMAPPED = ["default", "rgb"]; // colours that are in the file as they are
const FIRST_SPLIT = { left: "paper", right: "reference" };

/**
 * Bind the panel's controls.
 *
 * @param {(message: object) => boolean} send  says whether the message was sent
 * @returns {{offer: (hello: any) => void, show: (settings: any) => void, refuse: () => void}}
 *   `offer` fills the controls; `show` sets them to what holds at the server; `refuse` says that
 *   what was asked for may not come
 */
export function bindPanel(send) {
  const asked = new Asked();
  const set = (/** @type {string} */ name, value) => {
    if (send({ type: "set", name, value })) asked.add(name, value);
    clearTimeout(waiting);
    waiting = setTimeout(() => last && show(last), PATIENCE);
  };
  const changed = (/** @type {string} */ id, then) => byId(id).addEventListener("change", then);
  /** @type {any} */
  let offered = { presets: [], qualities: [], lights: [] };
  /** @type {any} */
  let last = null; // the settings that were told last
  let waiting = 0;
  const show = (/** @type {any} */ told) => {
    last = told;
    const settings = asked.over(told);
    showChoices(settings);
    showColour(settings.colour);
    byId("preset-title").textContent = titleOf(offered.presets, settings.preset);
    byId("quality").title = titleOf(offered.qualities, settings.quality);
    byId("lights").title = titleOf(offered.lights, settings.lights);
  };
  for (const name of ["preset", "quality", "lights"]) {
    changed(name, (event) => set(name, event.target.value));
  }
  changed("samples", (event) => set("samples", Number(event.target.value)));
  changed("background", (event) => set("background", event.target.value));
  for (const id of ["colour-by", "colour-map", "range-from", "range-to"]) {
    changed(id, () => set("colour", colour(id === "colour-by")));
  }
  changed("compare", (event) => set("split", event.target.checked ? FIRST_SPLIT : null));
  for (const id of ["side-left", "side-right"]) {
    changed(id, () => set("split", { left: byId("side-left").value, right: byId("side-right").value }));
  }
  byId("settings").addEventListener("submit", (/** @type {Event} */ event) => event.preventDefault());
  return {
    offer(hello) {
      offered = hello;
      fill("preset", hello.presets.map(({ name }) => [name, name]));
      fill("quality", hello.qualities.map(({ name }) => [name, name]));
      fill("lights", hello.lights.map(({ name }) => [name, name]));
      fill("colour-by", hello.colours.map(({ by, label }) => [by, label]));
      fill("colour-map", [["", "the usual"], ...hello.maps.map((/** @type {string} */ map) => [map, map])]);
      fill("side-left", SIDES);
      fill("side-right", SIDES);
      byId("samples").replaceChildren(...hello.samples.map(radio));
      if (last) show(last);
    },
    show,
    refuse() {
      asked.forget();
      if (last) show(last);
    },
  };
}

/** What was asked for and is not yet told: older settings on their way do not undo it. */
class Asked {
  /** @type {Map<string, {value: any, until: number}>} */
  #values = new Map();

  add(/** @type {string} */ name, value) {
    this.#values.set(name, { value, until: performance.now() + PATIENCE });
  }

  forget() {
    this.#values.clear();
  }

  /** Return settings with the values that were asked for since. */
  over(/** @type {any} */ told) {
    const settings = { ...told };
    for (const [name, { value, until }] of this.#values) {
      const arrived = JSON.stringify(told[name]) === JSON.stringify(value);
      if (arrived || performance.now() >= until) this.#values.delete(name);
      else settings[name] = value;
    }
    return settings;
  }
}

/** The name of a side of the split view. */
export function sideName(/** @type {string} */ side) {
  return SIDES.find(([name]) => name === side)?.[1] ?? side;
}

function showChoices(settings) {
  for (const name of ["preset", "quality", "lights"]) choose(name, settings[name]);
  byId("background").value = settings.background;
  byId("background-text").textContent = settings.background;
  for (const input of byId("samples").querySelectorAll("input")) {
    input.checked = Number(input.value) === settings.samples;
  }
  byId("compare").checked = settings.split !== null;
  for (const id of ["left-row", "right-row"]) byId(id).hidden = settings.split === null;
  if (settings.split) {
    byId("side-left").value = settings.split.left;
    byId("side-right").value = settings.split.right;
  }
}

function showColour({ by, map, range }) {
  choose("colour-by", by);
  choose("colour-map", map ?? "");
  const mapped = !UNMAPPED.includes(by);
  byId("map-row").hidden = !mapped;
  byId("range-row").hidden = !mapped;
  ["range-from", "range-to"].forEach((id, end) => {
    if (document.activeElement !== byId(id)) byId(id).value = range ? range[end] : "";
  });
}

/** What the controls say of colour; another field begins with its own range. */
function colour(/** @type {boolean} */ anew) {
  const ends = [byId("range-from").value, byId("range-to").value];
  const given = !anew && ends.every((end) => end !== "");
  return {
    by: byId("colour-by").value,
    map: byId("colour-map").value || null,
    range: given ? ends.map(Number) : null,
  };
}

const titleOf = (/** @type {any[]} */ offers, /** @type {string} */ name) =>
  offers.find((offer) => offer.name === name)?.title ?? "";

function fill(/** @type {string} */ id, /** @type {string[][]} */ options) {
  byId(id).replaceChildren(...options.map(([value, text]) => new Option(text, value)));
}

/** Choose a value, which the command line may have set to one that is not offered. */
function choose(/** @type {string} */ id, /** @type {string} */ value) {
  byId(id).value = value;
  if (byId(id).value !== value) byId(id).add(new Option(value, value, false, true));
}

function radio(/** @type {number} */ value) {
  const label = document.createElement("label");
  const input = Object.assign(document.createElement("input"), { type: "radio", name: "samples", value: String(value) });
  label.append(input, String(value));
  return label;
}
