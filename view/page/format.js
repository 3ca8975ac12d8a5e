// Numbers as people read them.

const WHOLE = new Intl.NumberFormat("en-US", { maximumFractionDigits: 0 });
const FINE = new Intl.NumberFormat("en-US", { maximumSignificantDigits: 3 });

/** A count, with commas; a dash if there is none. */
export function count(/** @type {number | null | undefined} */ value) {
  return value === null || value === undefined ? "–" : WHOLE.format(value);
}

/** A measured value: three digits, or all digits before the point. */
export function measure(/** @type {number | null | undefined} */ value) {
  if (value === null || value === undefined) return "–";
  return Math.abs(value) >= 100 ? WHOLE.format(value) : FINE.format(value);
}

/** A time in milliseconds. */
export function milliseconds(/** @type {number} */ value) {
  return value < 1 ? "< 1 ms" : `${measure(value)} ms`;
}
