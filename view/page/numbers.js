// What the picture means in hardware: the words, the cycles, and what the engine takes.

import { byId } from "./dom.js";
import { count, measure, milliseconds } from "./format.js";

/** Words for the reasons to leave points out; other reasons are shown as they come. */
const REASONS = {
  outside: "outside the picture",
  facing_away: "facing away",
  no_pixel: "between pixel centres",
  overdrawn: "behind another in one pixel",
  hidden: "wholly hidden",
  too_far: "far from the rest",
};

/**
 * Show the figures of a refined frame.
 *
 * @param {any} numbers  the message
 * @param {any} preset  the engine that drew it, as of `hello`
 */
export function showNumbers(numbers, preset) {
  byId("fps").textContent = measure(numbers.elements ? numbers.fps : null);
  byId("clock").textContent = clockNote(numbers, preset);
  const tiles = numbers.tiles > 1 ? ` in ${count(numbers.tiles)} tiles` : "";
  byId("size").textContent = ` · ${numbers.width} × ${numbers.height}${tiles}`;
  const psnr = numbers.psnr ?? null;
  const figures = [
    ...(psnr === null ? [] : [["PSNR to the reference", `${psnr.toFixed(1)} dB`]]),
    ["Code words", count(numbers.codewords)],
    ["Cycles", count(numbers.cycles)],
    ["Per element", measure(numbers.cycles_per_element)],
    ["Elements", count(numbers.elements)],
    ["LUTs", count(preset?.lut4)],
    ["Block RAMs", count(preset?.bram)],
    ["Flip-flops", count(preset?.ff)],
    ["Multipliers", count(preset?.mult)],
    ["Drawn here in", milliseconds(numbers.host_ms + numbers.golden_ms)],
  ];
  fill(byId("figures"), figures);
  showLeftOut(numbers);
}

/** Show what a person should know about the cloud; each note is one line. */
export function showNotes(/** @type {string[]} */ notes) {
  byId("notes").replaceChildren(...notes.map((note) => element("li", note)));
}

function clockNote(numbers, preset) {
  if (numbers.clock_mhz === null) return `${preset?.name ?? "This engine"} has no routed clock`;
  const device = preset?.device ? ` on ${shortDevice(preset.device)}` : "";
  return `${preset?.name ?? ""} at ${measure(numbers.clock_mhz)} MHz${device}`;
}

/** A device without its speed grade and package: LFE5U-25F of LFE5U-25F-6BG381. */
const shortDevice = (/** @type {string} */ device) => device.replace(/^(LFE5U\w*-\d+F).*/, "$1");

function showLeftOut(numbers) {
  const reasons = Object.entries(numbers.left_out ?? {}).filter(([, points]) => points > 0);
  const total = reasons.reduce((sum, [, points]) => sum + points, 0);
  byId("left-out-total").textContent = total
    ? `${count(total)} of ${count(numbers.points * numbers.samples)} points left out`
    : "No point was left out";
  fill(byId("left-out-list"), reasons.map(([reason, points]) => [
    REASONS[reason] ?? reason.replaceAll("_", " "), count(points),
  ]));
}

/** Fill a list of descriptions with names and values. */
function fill(/** @type {HTMLElement} */ list, /** @type {string[][]} */ pairs) {
  list.replaceChildren(...pairs.map(([name, value]) => {
    const pair = document.createElement("div");
    pair.append(element("dt", name), element("dd", value));
    return pair;
  }));
}

function element(/** @type {string} */ tag, /** @type {string} */ text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}
