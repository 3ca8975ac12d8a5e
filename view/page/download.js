// A file that was received goes where the browser saves downloads.

const KEPT = 10_000; // ms for which the browser may read the file

/** Save a file. */
export function download(/** @type {string} */ name, /** @type {string} */ mime, data) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([data], { type: mime }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT);
}
